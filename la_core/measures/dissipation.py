"""Measures of a mechanism: what every contact point does, where friction dissipates, and how widely.

A mechanism's twists are per unit motion of its drive, and so is every power here: N m/s per m/s, that is N, where the support
moves straight, N m where it turns, and a pure number per unit power of a live load.
"""

import enum
from dataclasses import dataclass

import numpy as np

from la_core.measures import mechanism
from la_core.model import Assembly

THRESHOLD = 0.03  # of the fastest block: elastic joints leave strain rates of a per cent or less of the support's motion. What
# slides slower is lost; a mechanism of rigid blocks has no such noise, and a much lower threshold counts all it dissipates.
LOADED = 1e-4  # of the mean block weight: least compression that counts; residuals of accepted forces are far below it


class ContactState(enum.IntEnum):
    """What a contact point does in a mechanism."""

    UNKNOWN = -1  # no mechanism is known
    STICKING = 0  # at rest and compressed
    IDLE = 1  # at rest without force
    SLIDING = 2
    OPENING = 3


@dataclass(frozen=True)
class MechanismMeasures:
    """Measures of one mechanism; numbers that are undefined are NaN, also the counts where no mechanism is known.

    states (C,): ContactState of each contact point; opening, sliding, sticking, idle: how many points do so.
    dissipation_per_interface (I,) and dissipated_power, their sum: power of friction per unit motion of the drive.
    dissipated_share: dissipated_power over the work of the weights that settle.
    participation_index: of the interfaces in the dissipation, see `participation_index`. moving_mass_share: of the free blocks.
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
    """Measure a mechanism with twists (B, 6) and contact forces (C, 3) on b; speeds up to `threshold` of the fastest block's are rest."""
    known = bool(np.isfinite(twists).all() and np.isfinite(forces).all())
    states = contact_states(assembly, twists, forces, threshold)
    dissipation = interface_dissipation(assembly, twists, forces, states)
    total, settling = float(dissipation.sum()), settling_power(assembly, twists)

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


def contact_states(assembly: Assembly, twists: np.ndarray, forces: np.ndarray, threshold: float = THRESHOLD) -> np.ndarray:
    """State (C,) of each contact point for twists (B, 6) and contact forces (C, 3); all UNKNOWN where one of them is NaN.

    A point opens when it parts without force. Parting alone is no proof: a point that slides by the associated flow rule parts
    at mu |u_t| and stays compressed; only what parts faster than that opens whatever force it is said to carry.
    """
    if not (np.isfinite(twists).all() and np.isfinite(forces).all()):
        return np.full(len(assembly.points), int(ContactState.UNKNOWN))
    parting, slip = mechanism.contact_speeds(assembly, twists)
    rest = threshold * float(mechanism.block_speeds(assembly.blocks, twists).max())
    loaded = loaded_compression(assembly, forces) > 0.0
    dilation = np.where(loaded, assembly.points.friction * slip, 0.0)
    states = np.where(loaded, int(ContactState.STICKING), int(ContactState.IDLE))
    states[slip > rest] = ContactState.SLIDING
    states[parting > dilation + rest] = ContactState.OPENING
    return states


def loaded_compression(assembly: Assembly, forces: np.ndarray) -> np.ndarray:
    """Normal force (C,) in N of the contact points that carry force, else 0: what a solver leaves on idle points is no load."""
    compression, _ = assembly.split(forces)
    return np.where(compression > LOADED * assembly.mean_weight, compression, 0.0)


def interface_dissipation(assembly: Assembly, twists: np.ndarray, forces: np.ndarray, states: np.ndarray) -> np.ndarray:
    """Power (I,) of friction in each interface, sum of mu n |u_t| over its points that slide under load; NaN where states are unknown."""
    if np.any(states == ContactState.UNKNOWN):
        return np.full(len(assembly.interfaces), np.nan)
    _, slip = mechanism.contact_speeds(assembly, twists)
    limit = assembly.points.friction * loaded_compression(assembly, forces)
    power = np.where(states == ContactState.SLIDING, limit * slip, 0.0)
    return np.bincount(assembly.points.interface, weights=power, minlength=len(assembly.interfaces))


def settling_power(assembly: Assembly, twists: np.ndarray) -> float:
    """Power of the weights that settle, sum of max(w . v, 0) over the blocks; weights that are lifted do not count."""
    return float(np.maximum(np.sum(assembly.dead_load * twists, axis=1), 0.0).sum())


def participation_index(dissipation: np.ndarray) -> float:
    """How evenly J interfaces share a dissipation p (J,): (sum p)^2 / (J sum p^2), from 1/J (one alone) to 1 (all alike).

    Portioli & Cascini (2016), doi 10.1016/j.engstruct.2016.02.002, speak of "a distribution index of the energy dissipated in
    the failure mechanism". Its formula is not at hand: this one, a participation ratio, is this project's own definition, and
    its values are not comparable with theirs. NaN where nothing dissipates.
    """
    largest = float(dissipation.max(initial=0.0))
    if not largest > 0.0:
        return float("nan")
    share = dissipation / largest  # squares of small powers must not vanish
    return float(share.sum() ** 2 / (len(share) * np.sum(share**2)))
