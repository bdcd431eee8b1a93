"""Limit analysis with associated friction: bounds of the reaction, or the multiplier of a live load, and the mechanism.

Kinematic form: the unknowns are the twists of the free blocks; the relative velocity u at every contact point obeys
the associated flow rule u_n >= mu |u_t| (dual of Coulomb's cone |t| <= mu n); the contact forces are the multipliers.
Let w be the weights and d the support's unit motion. Virtual power bounds the reaction R, or the multiplier lambda,
of every equilibrium with forces in the cones by the power of every such velocity v:
    settlement, support yields (d):          R      >=  w . v    so  R_min  = max   w . v
    settlement, support pushes back (-d):    R      <= -w . v    so  R_max  = min  -w . v
    live load l, with l . v = 1:             lambda <= -w . v    so  lambda = min  -w . v
(Livesley 1978; Portioli & Cascini 2016, doi 10.1016/j.engstruct.2016.02.002).
"""

import enum
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from la_core.geometry import Held
from la_core.limit.conic import REGULARISATION, TOLERANCE, ProgrammeAnswer, ProgrammeOutcome, maximise, optimum
from la_core.limit.falling import falling_blocks
from la_core.limit.no_sliding import shared_friction
from la_core.limit.problem import ACCEPTED, Drive, DrivenProblem, ScaledProblem, box_limits, driven_problem, scaled_problem
from la_core.limit.starting_scale import NEAR_REGULARISATION, starting_scale
from la_core.limit.symmetric_part import SymmetricPart, symmetric_part
from la_core.measures import residuals
from la_core.model import Assembly, global_forces, twists_of

SHARE_ASKED = 0.25  # of ACCEPTED: tolerance of a quick solve, because the solver's residuals differ a little from the recomputed ones
REFINED_SHARE = 0.1  # of that tolerance: the tolerance of a refined solve
# Of the value, and of the weight: a quick attempt with a larger error of its value is followed by a thorough one. An answer called solved
# may have a larger error where the blocks that load the support are light beside the others.
PRECISE, LEAST_PRECISE = 1e-4, 1e-8
FIRST_ORDER = 2.0  # times the error of first order: in 76 solves of a stone beside a cube the error was up to 1.12 times this
ATTEMPTS = ((False, False), (True, True), (False, True))  # equilibrate, refine: quick, thorough, and for joints almost without friction


class Status(enum.StrEnum):
    """Outcome of a bound or of the prediction. A bound has a value where it is SOLVED, a prediction also where it is INACCURATE.

    The program recomputes all residuals from the returned forces and velocities. The solver's own status decides nothing.

    Attributes
    ----------
    SOLVED
        A value exists, and its residuals confirm it. That of a prediction is known to 25 %.
    INFEASIBLE
        The structure cannot stand under its weight and dead loads: no equilibrium obeys the friction law.
    UNBOUNDED
        No mechanism with dilatancy follows the support's motion, or the live load, so nothing limits the value.
    INACCURATE
        The residuals are too large, or the uncertainty of a prediction is more than 25 % of its value.
    FAILED
        The solver returned no bound, or the paths came to no prediction, mostly because blocks fall.
    """

    SOLVED = "solved"
    INFEASIBLE = "infeasible"
    UNBOUNDED = "unbounded"
    INACCURATE = "inaccurate"
    FAILED = "failed"


@dataclass(frozen=True, eq=False, repr=False)
class Solution(Held):
    """Answer of one limit analysis with its recomputed evidence. Undefined numbers are NaN.

    Attributes
    ----------
    status : Status
        Outcome; the other values are defined only for SOLVED and INACCURATE, unless stated otherwise.
    value : float
        Reaction (N; N m for a rotation) or multiplier.
    twists : (B, 6) array
        Mechanism for the support's unit motion, or for unit power of the unit live load.
    forces : (C, 3) array
        Contact forces on block b, N, global axes.
    equilibrium_residual : float
        Largest unbalanced force on a free block over the mean free-block weight.
    cone_violation : float
        Largest tension or excess of |t| over mu n, over the mean free-block weight.
    mechanism_violation : float
        Largest violation of the flow rule over the largest speed of a block.
    duality_gap : float
        Difference between the values from forces and from work, over the mean free-block weight (a multiplier: as it is).
    seconds : float
        Time in the solver, all attempts; always defined.
    iterations : int
        Solver iterations, all attempts; always defined.
    falling : tuple of str
        Names of the blocks that fall, where the status is INFEASIBLE.
    error : float
        Estimated error of the value, in its unit, from the duality gap and the unbalanced forces; NaN from a file without it.
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
    error: float = float("nan")


def solve_associated(
    assembly: Assembly,
    drive: Drive,
    problem: ScaledProblem | None = None,
    accuracy: float = ACCEPTED,
    near: Solution | None = None,
) -> Solution:
    """Solve one limit analysis. A structure that cannot stand raises no error: its status is INFEASIBLE.

    A quick attempt comes first, from a nearby answer where there is one. Where the residuals do not confirm its answer, or leave its value
    imprecise, the next of the ATTEMPTS follows. A large structure that is its own mirror image is solved by its symmetric part; the
    residuals are those of the whole structure.

    Parameters
    ----------
    assembly : Assembly
        Structure with its weights, and its support motion or live load.
    drive : Drive
        Bound to compute.
    problem : ScaledProblem, optional
        `scaled_problem(assembly)`, for callers that solve several drives.
    accuracy : float
        Largest residual of an answer called SOLVED; the solver's tolerance is derived from it.
    near : Solution, optional
        Answer of a similar problem with as many contact points, such as the same drive at another inset. It saves up to
        half the iterations of the quick attempt and does not change the problem. It is ignored where it is not
        SOLVED or has another number of contact points.

    Returns
    -------
    Solution
        An INFEASIBLE last attempt; else the accepted attempt with the smallest error of its value; else an UNBOUNDED last attempt; else
        the attempt with the smallest residuals. Seconds and iterations are sums over all attempts.
    """
    problem = problem or scaled_problem(assembly)
    driven = driven_problem(assembly, problem, drive)
    part = symmetric_part(assembly, problem, driven)
    attempts: list[Solution] = []
    trials: list[tuple[bool, bool, np.ndarray | None]] = [(*attempt, None) for attempt in ATTEMPTS]
    if near is not None and near.status is Status.SOLVED and len(near.forces) == len(assembly.points):
        trials.insert(0, (*ATTEMPTS[0], near.forces))
    for equilibrate, refine, forces in trials:
        if attempts and attempts[-1].status is Status.SOLVED and not refine:
            continue  # another quick attempt would be as imprecise
        attempts.append(_attempt(assembly, problem, drive, driven, part, accuracy, equilibrate, refine, forces))
        status = attempts[-1].status
        is_precise = status is Status.SOLVED and _is_precise(assembly, attempts[-1])
        if is_precise or status is Status.INFEASIBLE or (refine and status is Status.UNBOUNDED):
            break
    last, solved = attempts[-1], [attempt for attempt in attempts if attempt.status is Status.SOLVED]
    best = last
    if solved and last.status is not Status.INFEASIBLE:
        best = min(solved, key=lambda attempt: attempt.error)
    elif last.status in (Status.INACCURATE, Status.FAILED):  # UNBOUNDED from a quick attempt does not count unless confirmed
        best = min((attempt for attempt in attempts if attempt.status is not Status.UNBOUNDED), key=_worst_residual)
    seconds, iterations = sum(attempt.seconds for attempt in attempts), sum(attempt.iterations for attempt in attempts)
    return replace(best, seconds=seconds, iterations=iterations)


def _worst_residual(solution: Solution) -> float:
    of_forces = (solution.equilibrium_residual, solution.cone_violation)
    of_mechanism = (solution.mechanism_violation, solution.duality_gap)
    return float(np.nan_to_num(np.max(of_forces + of_mechanism), nan=np.inf))


def _attempt(
    assembly: Assembly,
    problem: ScaledProblem,
    drive: Drive,
    driven: DrivenProblem,
    part: SymmetricPart | None,
    accuracy: float,
    equilibrate: bool,
    refine: bool,
    forces: np.ndarray | None,
) -> Solution:
    """Solve once, by the symmetric part where there is one. forces: contact forces (C, 3), N, of a nearby answer to start from."""
    count = len(driven.offset)
    tolerance = min(SHARE_ASKED * ACCEPTED, TOLERANCE * int(assembly.blocks.free.sum())) * (accuracy / ACCEPTED)
    tolerance *= REFINED_SHARE if refine else 1.0
    scale = np.ones(count) if refine else starting_scale(assembly, problem, count, forces)
    regularisation = REGULARISATION if forces is None else NEAR_REGULARISATION
    posed = driven
    if part is not None:
        posed, scale = part.of(driven), scale[part.kept]
    scaled_rows, scaled_offset = sparse.diags(scale) @ posed.rows, scale * posed.offset
    answer = maximise(posed.power, scaled_rows, scaled_offset, posed.cones, tolerance, equilibrate, refine, regularisation)
    if answer.outcome is ProgrammeOutcome.EMPTY:
        return _unless_it_falls(assembly, problem, part, without_value(assembly, Status.UNBOUNDED, answer))
    if answer.outcome is ProgrammeOutcome.RAY:
        return _unless_it_falls(assembly, problem, part, without_value(assembly, Status.FAILED, answer))
    if not (np.isfinite(answer.x).all() and np.isfinite(answer.multipliers).all()):
        return without_value(assembly, Status.FAILED, answer)
    whole = replace(answer, multipliers=scale * answer.multipliers)
    if part is not None:
        whole = part.whole(assembly, problem, whole)
    solution = solution_of(assembly, problem, drive, driven, whole, accuracy)
    # The solver may stall on a ray. A live load may hold up a structure that cannot stand without it.
    if solution.status is not Status.SOLVED or drive is Drive.LIVE:
        return _unless_it_falls(assembly, problem, part, solution)
    return solution


def _is_precise(assembly: Assembly, solution: Solution) -> bool:
    return solution.error <= max(PRECISE * abs(solution.value), LEAST_PRECISE * assembly.in_value_unit(assembly.weight))


def without_value(assembly: Assembly, status: Status, answer: ProgrammeAnswer, falling: tuple[str, ...] = ()) -> Solution:
    """Solution without a value: its status, its cost and the blocks that fall; all numbers are NaN.

    Parameters
    ----------
    assembly : Assembly
        Structure, which gives the shapes of the arrays.
    status : Status
        Reason for the missing value.
    answer : ProgrammeAnswer
        Answer of the solver, for its seconds and iterations.
    falling : tuple of str
        Names of the blocks that fall.
    """
    nan = float("nan")
    twists, forces = np.full((len(assembly.blocks), 6), nan), np.full((len(assembly.points), 3), nan)
    return Solution(status, nan, twists, forces, nan, nan, nan, nan, answer.seconds, answer.iterations, falling)


def _unless_it_falls(assembly: Assembly, problem: ScaledProblem, part: SymmetricPart | None, solution: Solution) -> Solution:
    """The solution, or INFEASIBLE with the falling blocks where the structure cannot stand; the cost of this test is added.

    The certificate is an admissible motion with the supports at rest and positive work of the weights. Velocities are
    at most one and the work is the greatest possible, so that every block falls whose fall does work.
    """
    posed = problem if part is None else part.at_rest(problem)
    fall = optimum(posed.power, *box_limits(posed))
    twists = twists_of(assembly, fall.x if part is None else part.basis @ fall.x)
    names = falling_blocks(assembly, twists)
    cost = replace(fall, seconds=solution.seconds + fall.seconds, iterations=solution.iterations + fall.iterations)
    if names and residuals.flow_rule_violation(assembly, twists) <= ACCEPTED:
        return without_value(assembly, Status.INFEASIBLE, cost, names)
    return replace(solution, seconds=cost.seconds, iterations=cost.iterations)


def solution_of(
    assembly: Assembly, problem: ScaledProblem, drive: Drive, driven: DrivenProblem, answer: ProgrammeAnswer, accuracy: float = ACCEPTED
) -> Solution:
    """Turn the solver's answer into forces, twists and a value, with residuals recomputed from them.

    Parameters
    ----------
    assembly : Assembly
        Structure of the problem.
    problem : ScaledProblem
        Problem without drive, whose flow rule turns multipliers into contact forces.
    drive : Drive
        Drive of the problem.
    driven : DrivenProblem
        Problem that was solved.
    answer : ProgrammeAnswer
        Its velocities x and multipliers.
    accuracy : float
        Largest residual of an answer called SOLVED; otherwise it is INACCURATE.
    """
    multipliers = answer.multipliers[-problem.rows.shape[0] :] / int(assembly.blocks.free.sum())
    forces = global_forces(assembly, problem.flow_rule.T @ multipliers)
    if assembly.effects.sliding_excluded:
        forces = shared_friction(assembly, forces)
    return _with_evidence(assembly, drive, (twists_of(assembly, answer.x) + driven.imposed) * driven.speed, forces, answer, accuracy)


@np.errstate(over="ignore", invalid="ignore")  # a solver that broke off may return any numbers
def _with_evidence(
    assembly: Assembly, drive: Drive, twists: np.ndarray, forces: np.ndarray, answer: ProgrammeAnswer, accuracy: float
) -> Solution:
    """Solution with residuals recomputed from forces and twists; a residual above the accuracy makes it INACCURATE."""
    from_work = float(np.sum(assembly.dead_load * twists)) * (1.0 if drive is Drive.YIELDING else -1.0)
    if drive is Drive.LIVE:
        value, from_forces = from_work, residuals.multiplier(assembly, forces)
    else:
        value = from_forces = residuals.reaction(assembly, forces)
    recomputed = {
        "equilibrium_residual": residuals.equilibrium_residual(assembly, forces, value if drive is Drive.LIVE else 0.0),
        "cone_violation": residuals.cone_violation(assembly, forces),
        "mechanism_violation": residuals.flow_rule_violation(assembly, twists),
        "duality_gap": abs(from_forces - from_work) / assembly.in_value_unit(assembly.mean_weight),
    }
    unbalanced = residuals.power_of_unbalanced(assembly, twists, forces, value if drive is Drive.LIVE else 0.0)
    error = FIRST_ORDER * (abs(from_forces - from_work) + unbalanced)
    confirmed = np.max(list(recomputed.values())) <= accuracy  # the solver's own status does not count
    status = Status.SOLVED if confirmed else Status.INACCURATE
    seconds, iterations = answer.seconds, answer.iterations
    return Solution(status, value, twists, forces, seconds=seconds, iterations=iterations, falling=(), error=error, **recomputed)
