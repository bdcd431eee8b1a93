"""Limit analysis with associated friction: bounds of the reaction, or the multiplier of a live load, and the mechanism.

Kinematic form: the unknowns are the twists of the free blocks; the relative velocity u at every contact point obeys the
associated flow rule u_n >= mu |u_t| (dual of Coulomb's cone |t| <= mu n); the contact forces are the multipliers.
With K* the cone of the flow rule, w the weights and d the support's unit motion, virtual power gives for every equilibrium
with forces in the cones and every such velocity
    settlement, support yields (d):          R      >=  w . v    so  R_min  = max   w . v
    settlement, support pushes back (-d):    R      <= -w . v    so  R_max  = min  -w . v
    live load l, with l . v = 1:             lambda <= -w . v    so  lambda = min  -w . v
(Livesley 1978; Portioli & Cascini 2016, doi 10.1016/j.engstruct.2016.02.002).
"""

import enum
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from la_core.limit.conic import TOLERANCE, ProgrammeAnswer, ProgrammeOutcome, maximise, optimum
from la_core.limit.no_sliding import shared_friction
from la_core.limit.problem import ACCEPTED, Drive, DrivenProblem, ScaledProblem, box_limits, driven_problem, scaled_problem
from la_core.measures import residuals
from la_core.model import Assembly, global_forces, support_motion, twists_of

SHARE_ASKED = 0.25  # of ACCEPTED, asked of a quick solve: the solver's tests are close to the recomputed ones, not the same
REFINED_SHARE = 0.1  # of that, asked of a refined solve
ATTEMPTS = ((False, False), (True, True), (False, True))  # equilibrate, refine: quick, thorough, and for joints almost without friction
FALLING_SHARE = 1e-3  # of the fastest falling block: blocks with at least this fall in a certificate
HEAD_SCALE = 10.0  # of the rows of joints along gravity, against 1 for joints that it presses straight on
LEAST_FALL = 1e-8  # of the weight: power at unit speed that a certificate needs, above the solver's tolerance


class Status(enum.StrEnum):
    """Outcome of limit analysis; only SOLVED comes with a value.

    The program recomputes all residuals from the returned forces and velocities. The solver's own status decides nothing.

    Attributes
    ----------
    SOLVED
        A value exists, and its residuals confirm it.
    INFEASIBLE
        The structure cannot stand under its own weight: no equilibrium obeys the friction law.
    UNBOUNDED
        No mechanism follows the support's motion, or the live load, so nothing limits the value.
    INACCURATE
        The solver returned a solution, but its residuals are too large.
    FAILED
        The solver returned no solution.
    """

    SOLVED = "solved"
    INFEASIBLE = "infeasible"
    UNBOUNDED = "unbounded"
    INACCURATE = "inaccurate"
    FAILED = "failed"


@dataclass(frozen=True)
class Solution:
    """Answer of one limit analysis with its recomputed evidence. Undefined numbers are NaN.

    value: reaction in N (N m for a rotation) or multiplier. twists (B, 6): mechanism for the support's unit motion, or for
    unit power of the unit live load. forces (C, 3): contact forces on b in N, global axes.
    Residuals (equilibrium_residual, cone_violation, duality_gap) are relative to the mean free-block weight;
    mechanism_violation is the flow rule's, relative to the largest speed of a block.
    falling: names of blocks that fall when the status is INFEASIBLE.
    """

    status: Status
    value: float
    twists: np.ndarray
    forces: np.ndarray
    equilibrium_residual: float
    cone_violation: float
    mechanism_violation: float
    duality_gap: float
    seconds: float
    iterations: int
    falling: tuple[str, ...] = ()


def solve_associated(assembly: Assembly, drive: Drive, problem: ScaledProblem | None = None, accuracy: float = ACCEPTED) -> Solution:
    """Solve one limit analysis; never raises for a structure that cannot stand, the status says so.

    A quick solve comes first; an answer that the evidence does not confirm calls for the next of the ATTEMPTS. problem:
    `scaled_problem(assembly)`, for callers with several drives. accuracy: residual up to which an answer is called solved, and for
    which the solver works.
    """
    problem = problem or scaled_problem(assembly)
    tried: list[Solution] = []
    for equilibrate, refine in ATTEMPTS:
        tried.append(_attempt(assembly, problem, drive, accuracy, equilibrate, refine))
        status = tried[-1].status
        if status in (Status.SOLVED, Status.INFEASIBLE) or (refine and status is Status.UNBOUNDED):
            break
    best = min(tried, key=_worst_residual) if tried[-1].status in (Status.INACCURATE, Status.FAILED) else tried[-1]
    return replace(best, seconds=sum(one.seconds for one in tried), iterations=sum(one.iterations for one in tried))


def _worst_residual(solution: Solution) -> float:
    each = (solution.equilibrium_residual, solution.cone_violation, solution.mechanism_violation, solution.duality_gap)
    return float(np.nan_to_num(np.max(each), nan=np.inf))


def _attempt(assembly: Assembly, problem: ScaledProblem, drive: Drive, accuracy: float, equilibrate: bool, refine: bool) -> Solution:
    driven = driven_problem(assembly, problem, drive)
    count = len(driven.offset)
    tolerance = min(SHARE_ASKED * ACCEPTED, TOLERANCE * int(assembly.blocks.free.sum())) * (accuracy / ACCEPTED)
    tolerance *= REFINED_SHARE if refine else 1.0
    scale = sparse.diags(np.ones(count) if refine else _starting_scale(assembly, problem, count))
    answer = maximise(driven.power, scale @ driven.rows, scale @ driven.offset, driven.cones, tolerance, equilibrate, refine)
    if answer.outcome is ProgrammeOutcome.EMPTY:
        return _cannot_stand(assembly, problem, answer) or without_value(assembly, Status.UNBOUNDED, answer)
    if answer.outcome is ProgrammeOutcome.RAY:
        return _cannot_stand(assembly, problem, answer) or without_value(assembly, Status.FAILED, answer)
    if not (np.isfinite(answer.x).all() and np.isfinite(answer.multipliers).all()):
        return without_value(assembly, Status.FAILED, answer)
    scaled = replace(answer, multipliers=scale @ answer.multipliers)
    solution = solution_of(assembly, problem, drive, driven, scaled, accuracy)
    # The solver may stall on its way along a ray; a live load may be what holds the structure up.
    if solution.status is not Status.SOLVED or drive is Drive.LIVE:
        return _cannot_stand(assembly, problem, answer) or solution
    return solution


def _starting_scale(assembly: Assembly, problem: ScaledProblem, count: int) -> np.ndarray:
    """Scale (count,) of the rows, the last of them those of the contact points, alike at each point, which leaves cones as they are.

    The solver starts from forces and velocities of one size in all rows; with those of head joints scaled up it takes a tenth to a
    fifth fewer iterations.
    """
    gravity = assembly.dead_load[:, :3].sum(axis=0)
    pressed = np.abs(assembly.normal @ gravity) / np.linalg.norm(gravity)
    point = problem.flow_rule.indices[problem.flow_rule.indptr[:-1]] // (problem.flow_rule.shape[1] // len(pressed))
    scale = np.ones(count)
    scale[count - len(point) :] = HEAD_SCALE ** (1.0 - pressed[point])
    return scale


def without_value(assembly: Assembly, status: Status, answer: ProgrammeAnswer, falling: tuple[str, ...] = ()) -> Solution:
    """Solution of which only the status, the cost and the falling blocks are known."""
    nan = float("nan")
    twists, forces = np.full((len(assembly.blocks), 6), nan), np.full((len(assembly.points), 3), nan)
    return Solution(status, nan, twists, forces, nan, nan, nan, nan, answer.seconds, answer.iterations, falling)


def _cannot_stand(assembly: Assembly, problem: ScaledProblem, answer: ProgrammeAnswer) -> Solution | None:
    """The certificate, or None: an admissible motion with the supports at rest on which the weights do positive work.

    Velocities are limited to one and the work is greatest, so that all that can fall does, wherever it stands.
    """
    rows, offset, cones = box_limits(problem)
    fall = optimum(problem.power, rows, offset, cones)
    twists = twists_of(assembly, fall.x)
    names = falling_blocks(assembly, twists)
    if not names or residuals.flow_rule_violation(assembly, twists) > ACCEPTED:
        return None
    return without_value(assembly, Status.INFEASIBLE, answer, names)


def falling_blocks(assembly: Assembly, twists: np.ndarray) -> tuple[str, ...]:
    """Names of the blocks that sink in a motion (B, 6) of order one; none where the weights do no positive work on it."""
    power, weight = np.sum(assembly.dead_load * twists, axis=1), np.linalg.norm(assembly.dead_load[:, :3], axis=1)
    if not power.sum() > LEAST_FALL * assembly.weight:
        return ()
    sinking = np.divide(power, weight, out=np.zeros_like(power), where=weight > 0.0)
    return tuple(assembly.blocks.names[k] for k in np.flatnonzero(sinking >= FALLING_SHARE * sinking.max()))


def solution_of(
    assembly: Assembly, problem: ScaledProblem, drive: Drive, driven: DrivenProblem, answer: ProgrammeAnswer, accuracy: float = ACCEPTED
) -> Solution:
    """Forces, twists and their evidence from the solver's answer to the driven problem."""
    multipliers = answer.multipliers[-problem.rows.shape[0] :] / int(assembly.blocks.free.sum())
    forces = global_forces(assembly, problem.flow_rule.T @ multipliers)
    if assembly.effects.sliding_excluded:
        forces = shared_friction(assembly, forces)
    return _with_evidence(assembly, drive, (twists_of(assembly, answer.x) + driven.imposed) * driven.speed, forces, answer, accuracy)


def _with_evidence(
    assembly: Assembly, drive: Drive, twists: np.ndarray, forces: np.ndarray, answer: ProgrammeAnswer, accuracy: float
) -> Solution:
    """Solution with residuals recomputed from its forces and twists; one residual above the accuracy makes it inaccurate."""
    from_work = float(np.sum(assembly.dead_load * twists)) * (1.0 if drive is Drive.YIELDING else -1.0)
    if drive is Drive.LIVE:
        value, from_forces, unit = from_work, residuals.multiplier(assembly, forces), 1.0
    else:
        value = from_forces = residuals.reaction(assembly, forces)
        unit = assembly.mean_weight * support_motion(assembly, drive.value)[0]  # the speed turns a moment into a force
    recomputed = {
        "equilibrium_residual": residuals.equilibrium_residual(assembly, forces, value if drive is Drive.LIVE else 0.0),
        "cone_violation": residuals.cone_violation(assembly, forces),
        "mechanism_violation": residuals.flow_rule_violation(assembly, twists),
        "duality_gap": abs(from_forces - from_work) / unit,
    }
    confirmed = max(recomputed.values()) <= accuracy  # whatever the solver says of itself
    status = Status.SOLVED if confirmed else Status.INACCURATE
    return Solution(status, value, twists, forces, seconds=answer.seconds, iterations=answer.iterations, falling=(), **recomputed)
