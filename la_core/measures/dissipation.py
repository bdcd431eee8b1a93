"""Measures of a mechanism: the state of every contact point, the dissipation of friction, and its distribution.

The twists of a mechanism are per unit motion of its drive, and so is every power here. Its unit is N for a
translation of the support, N m for a rotation, and 1 for a live load (per unit power of the load).
"""

import enum
from dataclasses import dataclass

import numpy as np

from la_core.measures import mechanism
from la_core.model import Assembly

# Least speed of a moving contact point, over `mechanism.fastest_speed`. Strain rates of elastic joints are a per cent or less of the
# support's motion. A loaded point whose friction is used up slides from SLOWEST on: over many loaded points slow slip adds up to a tenth of
# the power. On 200 random scenes limit analysis' power of friction then lacks at most 2e-4 of the weight, before 1.5e-2, and YADE's 1.7e-3.
THRESHOLD, SLOWEST = 0.03, 1e-3
USED_UP = 0.98  # of mu n: friction that resists slip; YADE's forces are means over a plateau
LOADED = 1e-4  # of the mean block weight: least compression that counts; residuals of accepted forces are far below it


class ContactState(enum.IntEnum):
    """State of a contact point in a mechanism."""

    UNKNOWN = -1  # the mechanism is undefined
    STICKING = 0  # at rest and compressed
    IDLE = 1  # at rest without force
    SLIDING = 2
    OPENING = 3


@dataclass(frozen=True, eq=False)
class MechanismMeasures:
    """Measures of one mechanism. Undefined numbers are NaN, and so are the counts where the mechanism is undefined.

    Attributes
    ----------
    states : (C,) array of int
        ContactState of each contact point.
    opening, sliding, sticking, idle : float
        Number of contact points in each state.
    dissipation_per_interface : (I,) array
        Power of friction in each interface per unit motion of the drive.
    dissipated_power : float
        Sum of these powers.
    dissipated_share : float
        Dissipated power over the power of the sinking weights. NaN where no weight sinks, and under a live load, which then does the work.
    participation_index : float
        Distribution of the dissipation over the interfaces, see `participation_index`.
    moving_mass_share : float
        Mass of the moving blocks over the mass of all free blocks.
    """

    states: np.ndarray
    opening: float
    sliding: float
    sticking: float
    idle: float
    dissipation_per_interface: np.ndarray
    dissipated_power: float
    dissipated_share: float
    participation_index: float
    moving_mass_share: float


def measure(assembly: Assembly, twists: np.ndarray, forces: np.ndarray, threshold: float = THRESHOLD) -> MechanismMeasures:
    """Measure a mechanism.

    Parameters
    ----------
    assembly : Assembly
        Structure.
    twists : (B, 6) array
        Twists of the blocks per unit motion of the drive; NaN where undefined.
    forces : (C, 3) array
        Contact forces on block b, N, global axes.
    threshold : float
        As in `contact_states`.
    """
    states = contact_states(assembly, twists, forces, threshold)
    known = not np.any(states == ContactState.UNKNOWN)
    dissipation = interface_dissipation(assembly, twists, forces, states)
    total, settling = float(dissipation.sum()), 0.0 if assembly.has_live_load else settling_power(assembly, twists, threshold)

    def count(state: ContactState) -> float:
        return float(np.sum(states == state)) if known else float("nan")

    return MechanismMeasures(
        states,
        opening=count(ContactState.OPENING),
        sliding=count(ContactState.SLIDING),
        sticking=count(ContactState.STICKING),
        idle=count(ContactState.IDLE),
        dissipation_per_interface=dissipation,
        dissipated_power=total,
        dissipated_share=total / settling if settling > 0.0 else float("nan"),
        participation_index=participation_index(dissipation),
        moving_mass_share=mechanism.moving_mass_share(assembly, twists) if known else float("nan"),
    )


def contact_states(
    assembly: Assembly, twists: np.ndarray, forces: np.ndarray, threshold: float = THRESHOLD, slow_slip: bool = True
) -> np.ndarray:
    """State (C,) of each contact point; all UNKNOWN where a twist or a force is NaN.

    A point opens when it parts without force. A compressed point that slides by the associated flow rule also parts,
    at mu |u_t|. It opens only if it parts faster. A compressed point whose friction is used up slides at a thousandth of the
    fastest speed already, because its friction dissipates there, too.

    Parameters
    ----------
    assembly : Assembly
        Structure.
    twists : (B, 6) array
        Twists of the blocks per unit motion of the drive.
    forces : (C, 3) array
        Contact forces on block b, N, global axes.
    threshold : float
        Other contact points are at rest up to this share of `mechanism.fastest_speed`.
    slow_slip : bool
        Whether points whose friction is used up slide at a lower speed.
    """
    if not (np.isfinite(twists).all() and np.isfinite(forces).all()):
        return np.full(len(assembly.points), int(ContactState.UNKNOWN))
    parting, slip = mechanism.contact_speeds(assembly, twists)
    fastest = mechanism.fastest_speed(assembly, twists)
    rest, compression = threshold * fastest, loaded_compression(assembly, forces)
    loaded = compression > 0.0
    shear = np.linalg.norm(assembly.split(forces)[1], axis=1)
    friction = assembly.points.friction
    used_up = loaded & (friction > 0.0) & (shear >= USED_UP * friction * compression) & slow_slip
    dilation = np.where(loaded, friction * slip, 0.0)
    states = np.where(loaded, int(ContactState.STICKING), int(ContactState.IDLE))
    states[(slip > rest) | (used_up & (slip > SLOWEST * fastest))] = ContactState.SLIDING
    states[parting > dilation + rest] = ContactState.OPENING
    return states


def loaded_compression(assembly: Assembly, forces: np.ndarray) -> np.ndarray:
    """Normal force (C,), N, of the loaded contact points; 0 where the force is only a residual of the solver."""
    compression, _ = assembly.split(forces)
    return np.where(compression > LOADED * assembly.mean_weight, compression, 0.0)


def interface_dissipation(assembly: Assembly, twists: np.ndarray, forces: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Power (I,) of friction in each interface, sum of mu n |u_t| over its loaded sliding points; NaN if states are UNKNOWN.

    Parameters
    ----------
    assembly : Assembly
        Structure.
    twists : (B, 6) array
        Twists of the blocks per unit motion of the drive.
    forces : (C, 3) array
        Contact forces on block b, N, global axes.
    states : (C,) array of int
        ContactState of each contact point.
    """
    if np.any(states == ContactState.UNKNOWN):
        return np.full(len(assembly.interfaces), np.nan)
    _, slip = mechanism.contact_speeds(assembly, twists)
    limit = assembly.points.friction * loaded_compression(assembly, forces)
    power = np.where(states == ContactState.SLIDING, limit * slip, 0.0)
    return np.bincount(assembly.points.interface, weights=power, minlength=len(assembly.interfaces))


def settling_power(assembly: Assembly, twists: np.ndarray, threshold: float = THRESHOLD) -> float:
    """Power of the sinking weights, sum of max(w . v, 0) over the blocks; lifted weights do not count.

    It is 0 where no block sinks faster than `threshold` times the fastest speed: slower motions are strain and rounding errors.
    """
    power = np.sum(assembly.dead_load * twists, axis=1)
    noise = threshold * mechanism.fastest_speed(assembly, twists) * np.linalg.norm(assembly.dead_load[:, :3], axis=1)
    return float(np.maximum(power, 0.0).sum()) if np.any(power > noise) else 0.0


def participation_index(dissipation: np.ndarray) -> float:
    """Evenness of a dissipation p (J,) over J interfaces: (sum p)^2 / (J sum p^2).

    It is 1/J if one interface dissipates alone, and 1 if all dissipate alike. NaN where nothing dissipates.

    Portioli & Cascini (2016), doi 10.1016/j.engstruct.2016.02.002, speak of "a distribution index of the energy
    dissipated in the failure mechanism". Its formula is not at hand. The formula here, a participation ratio, is this
    project's own definition, and its values are not comparable with theirs.
    """
    largest = float(dissipation.max(initial=0.0))
    if not largest > 0.0:
        return float("nan")
    share = dissipation / largest  # squares of small powers must not vanish
    return float(share.sum() ** 2 / (len(share) * np.sum(share**2)))
