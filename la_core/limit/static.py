"""Static form of limit analysis under any friction limits |t| <= intercept + slope n: contact forces are the unknowns.

The kinematic form of `la_core.limit` is smaller, but only for Coulomb's cone. Here the limits need not be cones, and
they may change from solve to solve. With f the contact forces, r . f their work on the support's unit motion, w the
weights and l the live load,
    settlement:  least (support yields) or greatest (support pushes back) r . f   subject to   equilibrium(f) + w = 0
    live load:   greatest lambda                                                  subject to   equilibrium(f) + w + lambda l = 0
and n >= 0, |t| <= intercept + slope n at every contact point (Portioli & Cascini 2016, doi
10.1016/j.engstruct.2016.02.002). The multipliers of equilibrium are the twists of the mechanism; its flow is normal
to the given limits.
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from la_core.limit.associated import Status
from la_core.limit.conic import Cones, ProgrammeAnswer, ProgrammeOutcome, maximise
from la_core.limit.problem import ACCEPTED, SMOOTH, Drive
from la_core.measures import contact_speeds, residuals
from la_core.model import Assembly, columns, global_forces, scaled_load, support_motion, twists_of

USABLE = 1e-3  # largest residual of a usable answer; a solver may break off where hardly any equilibrium exists
_WITHOUT_VALUE = {ProgrammeOutcome.EMPTY: Status.INFEASIBLE, ProgrammeOutcome.RAY: Status.UNBOUNDED}


@dataclass(frozen=True)
class StaticSolution:
    """Answer of one static programme with its recomputed residuals. Undefined numbers are NaN.

    Attributes
    ----------
    status : Status
        SOLVED where all residuals are within ACCEPTED.
    value : float
        Reaction (N; N m for a rotation) or multiplier.
    forces : (C, 3) array
        Contact forces on block b, N, global axes.
    twists : (B, 6) array
        Mechanism for the support's unit motion, or for unit power of the unit live load.
    equilibrium_residual : float
        Largest unbalanced force on a free block over the mean free-block weight.
    limit_violation : float
        Largest tension or excess of |t| over its limit, over the mean free-block weight.
    flow_violation : float
        Largest violation of the flow rule over the speed of the fastest block.
    duality_gap : float
        Difference between the value and its bound by the mechanism, over the mean free-block weight (a multiplier:
        as it is).
    seconds : float
        Time in the solver.
    iterations : int
        Iterations of the solver.
    """

    status: Status
    value: float
    forces: np.ndarray
    twists: np.ndarray
    equilibrium_residual: float
    limit_violation: float
    flow_violation: float
    duality_gap: float
    seconds: float
    iterations: int


def solve_static(assembly: Assembly, drive: Drive, intercept: np.ndarray, slope: np.ndarray) -> StaticSolution:
    """Find the least or greatest reaction, or the greatest multiplier, under the limits |t| <= intercept + slope n.

    Parameters
    ----------
    assembly : Assembly
        Structure with its weights, and its support motion or live load.
    drive : Drive
        Bound to compute.
    intercept : (C,) array
        Tangential strength of each contact point at n = 0, N; infinite for a point that cannot slide.
    slope : (C,) array
        Increase of that strength with the normal force; negative for a limit that falls.

    Returns
    -------
    StaticSolution
        INFEASIBLE where no equilibrium lies within the limits.
    """
    kinematics = assembly.kinematic_matrix(assembly.length)
    speed, driven = support_motion(assembly, drive.value)
    equilibrium, load = _equilibrium(assembly, kinematics)
    limits, limits_offset, cones = _limits(assembly, intercept / assembly.weight, slope)
    power = -(kinematics @ columns(assembly, driven))
    unit = _units(assembly, intercept, slope)
    equilibrium, limits, power = equilibrium @ sparse.diags(unit), limits @ sparse.diags(unit), unit * power
    if drive is Drive.LIVE:
        live = scaled_load(assembly, assembly.live_load)
        equilibrium = sparse.hstack([equilibrium, sparse.csr_matrix(live).T]).tocsr()
        limits.resize(limits.shape[0], limits.shape[1] + 1)
        power, speed = np.append(np.zeros_like(power), 1.0), 1.0 / assembly.weight
    count = len(load)
    cones = Cones(cones.equalities + count, cones.inequalities, cones.second_order)
    answer = maximise(power, sparse.vstack([equilibrium, limits]).tocsr(), np.concatenate([load, limits_offset]), cones)
    if answer.outcome in _WITHOUT_VALUE:
        return _without_value(assembly, _WITHOUT_VALUE[answer.outcome], answer)
    if not (np.isfinite(answer.x).all() and np.isfinite(answer.multipliers).all()):
        return _without_value(assembly, Status.FAILED, answer)
    forces = global_forces(assembly, unit * answer.x[: len(unit)])
    twists = (twists_of(assembly, -answer.multipliers[:count]) + driven) * speed
    with np.errstate(over="ignore", invalid="ignore"):  # a solver that broke off may return any numbers
        return _with_evidence(assembly, drive, forces, twists, (intercept, slope), answer)


def coulomb_limits(assembly: Assembly) -> tuple[np.ndarray, np.ndarray]:
    """Intercept (C,), N, and slope (C,) of Coulomb's cone at each contact point; infinite where sliding is excluded."""
    count = len(assembly.points)
    if assembly.effects.sliding_excluded:
        return np.full(count, np.inf), np.zeros(count)
    return np.zeros(count), assembly.points.friction


def consistent_reaction(assembly: Assembly, normal_forces: np.ndarray) -> StaticSolution:
    """Least reaction with |t| <= mu N for given normal forces N (C,) in N, such as those of a discrete-element run.

    Under a live load it is the greatest multiplier. With a fixed strength the associated flow rule has no dilatancy. A quasi-static
    run in which joints slide by Coulomb's law therefore has this value.
    """
    no_sliding, _ = coulomb_limits(assembly)
    strength = assembly.points.friction * np.maximum(normal_forces, 0.0)
    drive = Drive.LIVE if assembly.has_live_load else Drive.YIELDING
    return solve_static(assembly, drive, np.maximum(no_sliding, strength), np.zeros(len(assembly.points)))


def _equilibrium(assembly: Assembly, kinematics: sparse.csr_matrix) -> tuple[sparse.csr_matrix, np.ndarray]:
    """Rows that sum scaled local contact forces on each free block, and the scaled weights of the free blocks."""
    freedoms = kinematics.shape[1] // len(assembly.blocks)
    return kinematics[:, np.repeat(assembly.blocks.free, freedoms)].T.tocsr(), scaled_load(assembly, assembly.dead_load)


def _limits(assembly: Assembly, intercept: np.ndarray, slope: np.ndarray) -> tuple[sparse.csr_matrix, np.ndarray, Cones]:
    """Rows and offset of the limits on local forces: t = 0 without friction, n >= 0, |t| <= intercept + slope n."""
    width = 2 if assembly.effects.plane else 3
    pick = sparse.identity(len(assembly.points) * width, format="csr")
    normal = np.arange(len(assembly.points)) * width
    smooth = (intercept == 0.0) & (np.abs(slope) <= SMOOTH)
    rough = np.flatnonzero(~smooth & np.isfinite(intercept))
    pressed = pick[normal[(intercept > 0.0) | (slope <= SMOOTH)]]  # elsewhere the friction limit implies n >= 0
    tangents = [pick[normal[rough] + k] for k in range(1, width)]
    strength, fixed = sparse.diags(slope[rough]) @ pick[normal[rough]], intercept[rough]
    frictionless = sparse.vstack([pick[normal[smooth] + k] for k in range(1, width)])
    if assembly.effects.plane:
        rows = [strength - tangents[0], strength + tangents[0]]
        offset = np.concatenate([fixed, fixed])
        cones = Cones(frictionless.shape[0], pressed.shape[0] + 2 * len(rough), 0)
    else:
        order = np.arange(3 * len(rough)).reshape(3, -1).T.ravel()
        rows = [sparse.vstack([strength, *tangents]).tocsr()[order]]
        offset = np.stack([fixed, np.zeros_like(fixed), np.zeros_like(fixed)], axis=1).ravel()
        cones = Cones(frictionless.shape[0], pressed.shape[0], len(rough))
    above = np.zeros(frictionless.shape[0] + pressed.shape[0])
    return sparse.vstack([frictionless, pressed, *rows]).tocsr(), np.concatenate([above, offset]), cones


def _units(assembly: Assembly, intercept: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """Units (n,) of the local forces; a friction force with a small slope and no intercept is in shares of its limit."""
    units = np.ones((len(assembly.points), 2 if assembly.effects.plane else 3))
    small = (intercept == 0.0) & (slope > SMOOTH)
    units[small, 1:] = np.minimum(slope[small], 1.0)[:, None]
    return units.ravel()


def _without_value(assembly: Assembly, status: Status, answer: ProgrammeAnswer) -> StaticSolution:
    nan = float("nan")
    forces, twists = np.full((len(assembly.points), 3), nan), np.full((len(assembly.blocks), 6), nan)
    return StaticSolution(status, nan, forces, twists, nan, nan, nan, nan, answer.seconds, answer.iterations)


def _with_evidence(
    assembly: Assembly,
    drive: Drive,
    forces: np.ndarray,
    twists: np.ndarray,
    limits: tuple[np.ndarray, np.ndarray],
    answer: ProgrammeAnswer,
) -> StaticSolution:
    """Solution with residuals recomputed from forces and twists: INACCURATE above ACCEPTED, FAILED above USABLE."""
    live = drive is Drive.LIVE
    value = residuals.multiplier(assembly, forces) if live else residuals.reaction(assembly, forces)
    unit = assembly.in_value_unit(assembly.mean_weight)
    recomputed = {
        "equilibrium_residual": residuals.equilibrium_residual(assembly, forces, value if live else 0.0),
        "limit_violation": _limit_violation(assembly, forces, limits) / assembly.mean_weight,
        "flow_violation": _flow_violation(assembly, twists, limits),
        "duality_gap": abs(value - _value_of_mechanism(assembly, drive, forces, twists, limits)) / unit,
    }
    worst = np.max(list(recomputed.values()))
    if not worst <= USABLE:
        return _without_value(assembly, Status.FAILED, answer)
    status = Status.SOLVED if worst <= ACCEPTED else Status.INACCURATE
    return StaticSolution(status, value, forces, twists, seconds=answer.seconds, iterations=answer.iterations, **recomputed)


def _limit_violation(assembly: Assembly, forces: np.ndarray, limits: tuple[np.ndarray, np.ndarray]) -> float:
    """Largest tension or excess of |t| over intercept + slope n, N."""
    normal, friction_force = assembly.split(forces)
    tangential = np.linalg.norm(friction_force, axis=1)
    return float(np.max([0.0, -normal.min(), (tangential - limits[0] - limits[1] * normal).max()]))


def _flow_violation(assembly: Assembly, twists: np.ndarray, limits: tuple[np.ndarray, np.ndarray]) -> float:
    """Largest violation of u_n >= slope |u_t| over the speed of the fastest block.

    Limits that fall with n bound the normal force. Every motion is then admissible, and meets a resistance of finite power.
    """
    parting, sliding = contact_speeds(assembly, twists)
    unlimited, slope = np.isinf(limits[0]), np.maximum(limits[1], 0.0)
    held = np.where(unlimited, sliding, (slope * sliding - parting) / np.hypot(1.0, slope))
    violation = np.where((limits[1] < 0.0) & ~unlimited, 0.0, np.maximum(held, -parting))
    return residuals.over_fastest(assembly, twists, violation)


def _value_of_mechanism(
    assembly: Assembly, drive: Drive, forces: np.ndarray, twists: np.ndarray, limits: tuple[np.ndarray, np.ndarray]
) -> float:
    """Bound of the value by virtual power: of the weights, and of the forces within the limits that resist the mechanism least.

    At these forces n = 0 and |t| = intercept. Where the limit falls with n, the largest n may resist less. This n is
    taken no larger than the largest force of the state.
    """
    parting, sliding = contact_speeds(assembly, twists)
    intercept, slope = np.where(np.isinf(limits[0]), 0.0, limits[0]), limits[1]
    most = np.divide(intercept, -slope, out=np.zeros_like(slope), where=slope < 0.0).clip(max=np.abs(forces).max())
    pressed = most * parting - (intercept + slope * most) * sliding
    power = float(np.sum(assembly.dead_load * twists) + np.minimum(-intercept * sliding, pressed).sum())
    return power if drive is Drive.YIELDING else -power
