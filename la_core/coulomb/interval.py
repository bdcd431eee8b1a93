"""The interval of reactions, or multipliers, that a mechanism without dilatancy allows over all histories of friction.

A parting joint carries no force. A sliding joint carries friction mu n against its slip. A sticking joint carries any
force in its cone. The forces of this kind in equilibrium form a convex set, so the least and the greatest reaction
are two cone programmes: those of `la_core.limit`, with (n - mu tau) . u >= 0 in place of the flow rule at a sliding
joint (n: normal, tau: direction of slip).
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain

import numpy as np
from scipy import sparse

from la_core.coulomb import plateau
from la_core.coulomb.path.elastic_joints import ElasticJoints, JointState
from la_core.coulomb.path.implicit_step import State
from la_core.coulomb.path.joint_rates import JointRates, joint_rates
from la_core.limit import ProgrammeAnswer, ProgrammeOutcome, optimum, scaled_problem
from la_core.model import Assembly, columns, scaled_load, support_motion

# Of the support's motion: slower slip and parting count as sticking. The first threshold gives the interval, which is unknown if the second
# one moves it.
THRESHOLDS = (0.01, 0.003)
LOADED = 1e-5  # of the weight: normal force of a loaded joint; residuals of an unloaded one are smaller
# Friction with a coefficient below SLIGHT may act in any direction. This hardly moves an end; exact directions may contradict equilibrium.
SLIGHT = 1e-5
ROUND_OFF = 1e-6  # of a scaled value: accuracy of the programmes. A reaction of 0 is certain to far more digits than the two ends.
# Width of an interval over the value, up to which a mechanism counts as allowing one value. Of 563 random scenes whose prediction is known
# for both rotations, 24 change by more than 1 %. The mechanism of 23 has an interval of 0.022 or more, or an unknown one; the 24th changes
# its mechanism.
ONE_VALUE = 0.01
FAN = 0.01  # rad: accuracy of the direction of slip; in 3D, many exact directions at once would contradict equilibrium


def reaction_interval(joints: ElasticJoints, rates: JointRates, state: JointState, threshold: float) -> tuple[float, float]:
    """Least and greatest reaction (N, N m) or multiplier that a mechanism allows.

    An end is infinite where nothing limits it, and NaN where no state of forces fits the mechanism.

    Parameters
    ----------
    joints : ElasticJoints
        Structure on its elastic joints.
    rates : JointRates
        Parting and slip in the mechanism.
    state : JointState
        Joints in that mechanism.
    threshold : float
        Least speed of slip and of parting, over the motion of the fastest support point.
    """
    speed = np.linalg.norm(rates.slip, axis=1)
    parting = (state.force[:, 0] <= LOADED) & (rates.gap > threshold)
    sliding = ~parting & (speed > threshold) & (joints.friction > SLIGHT)
    direction = rates.slip / np.where(speed > 0.0, speed, 1.0)[:, None]
    return _ends(joints.assembly, parting, sliding, direction)


def interval_status(interval: tuple[float, float]) -> str:
    """Status of an interval: "not stated" where an end is NaN, "unlimited" where one is infinite, else "limited"."""
    if np.isnan(interval).any():
        return "not stated"
    return "limited" if np.isfinite(interval).all() else "unlimited"


def relative_width(interval: tuple[float, float], value: float, unit: float) -> float:
    """Width of an interval over its value; NaN where the interval is not stated. unit: value whose scaled value is 1."""
    low, high = interval
    return (high - low) / unit / plateau.reference_size(value / unit)


def stated_interval(
    joints: ElasticJoints, mechanisms: Sequence[tuple[State, State]], value: float, uncertainty: float
) -> tuple[float, float]:
    """Interval of the first of several mechanisms, scaled; NaN where it is uncertain or does not contain the value.

    It is uncertain where an end moves by more than ALIKE with the threshold of slip and parting, or from mechanism to mechanism.

    Parameters
    ----------
    joints : ElasticJoints
        Structure on its elastic joints.
    mechanisms : sequence of (State, State)
        States at the start and at the end of each mechanism.
    value, uncertainty : float
        Reaction or multiplier that the interval has to contain, scaled.
    """
    unit = joints.value_in_units(1.0)

    def ends(mechanism: tuple[State, State], threshold: float) -> np.ndarray:
        before, last = mechanism
        return np.array(reaction_interval(joints, joint_rates(joints, before, last), last.joints, threshold)) / unit

    low, high = stated = np.sort(ends(mechanisms[0], THRESHOLDS[0]))  # equal ends may come in either order; NaN stays
    within = uncertainty + ROUND_OFF * max(1.0, abs(value))
    if not low - within <= value <= high + within:
        return float("nan"), float("nan")
    others = chain([(mechanisms[0], THRESHOLDS[1])], ((other, THRESHOLDS[0]) for other in mechanisms[1:]))
    allowed = plateau.ALIKE * plateau.reference_size(value)
    # Two infinite ends are the same. The first interval that differs ends the search: each is two cone programmes.
    near = all(np.isclose(ends(*other), stated, rtol=0.0, atol=allowed).all() for other in others)
    return (float(low), float(high)) if near else (float("nan"), float("nan"))


def _ends(assembly: Assembly, parting: np.ndarray, sliding: np.ndarray, direction: np.ndarray) -> tuple[float, float]:
    """Least and greatest value (N, N m or multiplier) where the points of two masks (C,) part or slide, along `direction` (C, 1 or 2)."""
    sticking = replace(assembly, points=assembly.points.subset(~parting & ~sliding))
    problem = scaled_problem(sticking)
    guided = sparse.vstack([_guide(assembly, edge)[sliding] for edge in _fan(direction)]).tocsr()
    split = problem.cones.equalities
    imposed = sparse.vstack([problem.imposed_rows[:split], guided, problem.imposed_rows[split:]]).tocsr()
    cones = replace(problem.cones, inequalities=problem.cones.inequalities + guided.shape[0])
    free = np.repeat(assembly.blocks.free, imposed.shape[1] // len(assembly.blocks))
    ends = []
    for sign in (1.0, -1.0):
        if assembly.has_live_load:
            live = sparse.csr_matrix(scaled_load(assembly, assembly.live_load))
            matrix = sparse.vstack([live, imposed[:, free]]).tocsr()
            offset = np.concatenate([[sign], np.zeros(imposed.shape[0])])
            answer = optimum(problem.power, matrix, offset, replace(cones, equalities=split + 1))
        else:
            _, motion = support_motion(assembly, sign)
            answer = optimum(problem.power, imposed[:, free], imposed @ columns(assembly, motion), cones)
        ends.append(sign * _value(answer, problem.power) * assembly.in_value_unit(assembly.weight))
    return ends[0], ends[1]


def _fan(direction: np.ndarray) -> list[np.ndarray]:
    """Directions of slip, each (C, 1 or 2), that friction may oppose; in 3D a fan about the computed direction."""
    if direction.shape[1] == 1:
        return [direction]
    across = direction[:, ::-1] * [-1.0, 1.0]
    return [np.cos(turn) * direction + np.sin(turn) * across for turn in (-FAN, 0.0, FAN)]


def _guide(assembly: Assembly, direction: np.ndarray) -> sparse.csr_matrix:
    """Matrix from the scaled twists of all blocks to (n - mu tau) . u at every contact point, tau = `direction`."""
    count, width = len(direction), direction.shape[1] + 1
    local = np.concatenate([np.ones((count, 1)), -assembly.points.friction[:, None] * direction], axis=1)
    rows = np.repeat(np.arange(count), width)
    pick = sparse.csr_matrix((local.ravel(), (rows, np.arange(count * width))), shape=(count, count * width))
    return (pick @ assembly.kinematic_matrix(assembly.length)).tocsr()


def _value(answer: ProgrammeAnswer, power: np.ndarray) -> float:
    """The optimum; minus infinity where no velocity is admissible, NaN where no state of forces exists.

    Without an admissible velocity nothing limits the force.
    """
    if answer.outcome is ProgrammeOutcome.OPTIMUM:
        return float(power @ answer.x)
    return -np.inf if answer.outcome is ProgrammeOutcome.EMPTY else float("nan")
