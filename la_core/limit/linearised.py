"""Limit analysis with polygonal friction cones, a linear programme solved by HiGHS: bounds of the conic answer by another solver.

Every cone |t| <= mu n of `la_core.limit` becomes a pyramid with a regular polygon of F corners as its section, the first of them
along the first tangent (`la_core.geometry.plane_axes`). With the corners at n (mu cos a, mu sin a) it is inscribed: its forces are
safe, so that R_min comes out from above, R_max and the multiplier from below. With corners at 1/cos(pi / F) times as much it is
circumscribed, and they come out from the other side. The bracket holds however joints slide, and either side may bear
more of its width: where joints slide towards a corner the inscribed value is exact, as when a wall slides in its own plane. Both
values lie between the conic answers for mu cos(pi / F) and mu / cos(pi / F), so the width falls as 1 / F^2; one value alone may
move away when facets are added, as the polygons need not be nested.
In the plane the cone is two lines, exact for any F; frictionless joints, and joints that cannot slide, have no cone to cut.

HiGHS is given the static form, with forces along the edges of the pyramids as unknowns,
    least offset . z   subject to   rows' z = -power,   z >= 0
(rows, offset and power as in `la_core.limit.DrivenProblem`); the multipliers are the mechanism. The kinematic form takes HiGHS as
long, and here the forces are in the pyramids exactly.
(Linear programmes of limit analysis: Livesley 1978; HiGHS: Huangfu & Hall 2018, doi 10.1007/s12532-017-0130-5.)
"""

import time
from dataclasses import replace

import numpy as np
from scipy import sparse
from scipy.optimize import OptimizeResult, linprog

from la_core.limit.associated import Solution, Status, falling_blocks, solution_of, without_value
from la_core.limit.conic import TOLERANCE, Cones, ProgrammeAnswer, ProgrammeOutcome
from la_core.limit.problem import ACCEPTED, Drive, DrivenProblem, ScaledProblem, driven_problem, scaled_problem
from la_core.measures import block_speeds
from la_core.model import Assembly, twists_of

LEAST_FACETS = 4
METHODS = ("highs-ipm", "highs-ds")  # interior point with crossover to a corner, dual simplex
_OUTCOMES = {
    0: ProgrammeOutcome.OPTIMUM,
    2: ProgrammeOutcome.RAY,
    3: ProgrammeOutcome.EMPTY,
}  # of the kinematic form, dual to the static one: no force, any force


def solve_linearised(assembly: Assembly, drive: Drive, facets: int, inscribed: bool, method: str = "highs-ipm") -> Solution:
    """Solve one limit analysis with pyramids of `facets` (at least 4) sides, inscribed in Coulomb's cones or circumscribed about them.

    Units, signs and residuals are those of `Solution`, held against the true cone: circumscribed pyramids leave a cone_violation,
    inscribed ones a mechanism_violation, both of order 1 / facets^2. So the status is that of the linearised problem: SOLVED says
    that equilibrium, duality gap and the mechanism's polygonal flow rule are within ACCEPTED, the forces being in the pyramids;
    INFEASIBLE that no equilibrium lies within the pyramids, which the true cones may still allow where they are inscribed.
    seconds: in HiGHS alone; iterations: as HiGHS counts them, without those of the crossover. method: one of METHODS.
    Raises ValueError for too few facets or another method.
    """
    if facets < LEAST_FACETS:
        raise ValueError(f"facets = {facets}: a friction pyramid has at least {LEAST_FACETS}")
    if method not in METHODS:
        raise ValueError(f'method = "{method}": one of {", ".join(METHODS)} is needed')
    problem = linearised_problem(assembly, facets, inscribed)
    driven = driven_problem(assembly, problem, drive)
    answer = _least_forces(driven, method)
    if answer.outcome is not ProgrammeOutcome.OPTIMUM:
        status = Status.UNBOUNDED if answer.outcome is ProgrammeOutcome.EMPTY else Status.FAILED
        return _cannot_stand(assembly, problem, method, answer) or without_value(assembly, status, answer)
    solution = _confirmed(assembly, driven, answer, solution_of(assembly, problem, drive, driven, answer))
    if drive is Drive.LIVE:  # it may be the load that holds the structure up
        return _cannot_stand(assembly, problem, method, answer) or solution
    return solution


def linearised_problem(assembly: Assembly, facets: int, inscribed: bool) -> ScaledProblem:
    """The kinematic problem with every second-order cone replaced by `facets` inequalities, one for each edge of its pyramid."""
    problem = scaled_problem(assembly)
    cones = problem.cones
    angle = 2.0 * np.pi * np.arange(facets) / facets
    radius = 1.0 if inscribed else 1.0 / np.cos(np.pi / facets)
    edges = np.stack([np.ones(facets), radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    others = cones.equalities + cones.inequalities
    cut = sparse.block_diag([sparse.identity(others), sparse.kron(sparse.identity(cones.second_order), edges)]).tocsr()
    linear = Cones(cones.equalities, cones.inequalities + facets * cones.second_order, 0)
    return ScaledProblem(problem.power, cut @ problem.rows, cut @ problem.imposed_rows, cut @ problem.flow_rule, linear)


def _least_forces(driven: DrivenProblem, method: str) -> ProgrammeAnswer:
    """Answer of the static form: its multipliers are the velocities x, its unknowns the multipliers of the kinematic form."""
    lowest = np.zeros(len(driven.offset))
    lowest[: driven.cones.equalities] = -np.inf
    bounds = np.stack([lowest, np.full_like(lowest, np.inf)], axis=1)
    programme = {"c": driven.offset, "A_eq": driven.rows.T.tocsc(), "b_eq": -driven.power, "bounds": bounds}
    result, seconds = _linprog(method, **programme)
    outcome = _OUTCOMES.get(result.status, ProgrammeOutcome.STALLED)
    if outcome is not ProgrammeOutcome.OPTIMUM:
        return ProgrammeAnswer(outcome, np.zeros(0), np.zeros(0), int(result.nit), seconds)
    return ProgrammeAnswer(outcome, -result.eqlin.marginals, np.maximum(result.x, lowest), int(result.nit), seconds)


def _cannot_stand(assembly: Assembly, problem: ScaledProblem, method: str, answer: ProgrammeAnswer) -> Solution | None:
    """INFEASIBLE with the blocks that fall in a motion of limited velocities that the pyramids admit, or None where none falls."""
    split = problem.cones.equalities
    rest, part = np.zeros(split), np.zeros(problem.rows.shape[0] - split)
    programme = {"A_eq": problem.rows[:split], "b_eq": rest, "A_ub": -problem.rows[split:], "b_ub": part, "bounds": (-1.0, 1.0)}
    result, seconds = _linprog(method, c=-problem.power * int(assembly.blocks.free.sum()), **programme)
    names = falling_blocks(assembly, twists_of(assembly, result.x)) if result.status == 0 else ()
    if not names:
        return None
    total = replace(answer, seconds=answer.seconds + seconds, iterations=answer.iterations + int(result.nit))
    return without_value(assembly, Status.INFEASIBLE, total, names)


def _linprog(method: str, **programme: object) -> tuple[OptimizeResult, float]:
    """Answer of HiGHS and the seconds it took."""
    options = {"primal_feasibility_tolerance": TOLERANCE, "dual_feasibility_tolerance": TOLERANCE}
    start = time.perf_counter()
    result = linprog(method=method, options=options, **programme)
    return result, time.perf_counter() - start


def _confirmed(assembly: Assembly, driven: DrivenProblem, answer: ProgrammeAnswer, solution: Solution) -> Solution:
    """The solution with the status of the linearised problem; its forces are in the pyramids by construction."""
    flow, split = driven.rows @ answer.x + driven.offset, driven.cones.equalities
    violation = max(np.abs(flow[:split]).max(initial=0.0), -flow[split:].min(initial=0.0))
    fastest = float(block_speeds(assembly.blocks, solution.twists).max()) / driven.speed
    worst = max(solution.equilibrium_residual, solution.duality_gap, violation / fastest if fastest > 0.0 else 0.0)
    return replace(solution, status=Status.SOLVED if worst <= ACCEPTED else Status.INACCURATE)
