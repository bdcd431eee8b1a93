"""Limit analysis with polygonal friction cones, a linear programme solved by HiGHS: bounds of the conic answer by another solver.

A pyramid replaces every cone |t| <= mu n of `la_core.limit`. Its section is a regular polygon of F corners, with the
first corner along the first tangent (`la_core.geometry.plane_axes`). With corners at n (mu cos a, mu sin a) the
pyramid is inscribed: its forces are safe, so R_min is an upper bound of the conic R_min, and R_max and the multiplier
are lower bounds of theirs. With corners farther out by 1 / cos(pi / F) the pyramid is circumscribed, and each value
bounds the conic one from the other side. The two values bracket the conic one however joints slide, but not
symmetrically: where joints slide towards a corner, as when a wall slides in its own plane, the inscribed value is
exact. Both values lie between the conic answers for mu cos(pi / F) and mu / cos(pi / F), so the width of the bracket
decreases as 1 / F^2. A single value may get worse with more facets, because the polygons need not be nested. In the
plane the cone is two lines, exact for any F. Frictionless joints, and joints that cannot slide, have no second-order
cone.

HiGHS is given the static form, with forces along the edges of the pyramids as unknowns,
    least offset . z   subject to   rows' z = -power,   z >= 0
(rows, offset and power as in `la_core.limit.problem.DrivenProblem`); the multipliers are the mechanism. The kinematic form
takes as long, and the static form keeps the forces exactly within the pyramids. (Linear programmes of limit analysis:
Livesley 1978; HiGHS: Huangfu & Hall 2018, doi 10.1007/s12532-017-0130-5.)
"""

import time
from dataclasses import replace

import numpy as np
import scipy
from scipy import sparse

from la_core.limit.associated import Solution, Status, solution_of, without_value
from la_core.limit.conic import TOLERANCE, Cones, ProgrammeAnswer, ProgrammeOutcome
from la_core.limit.falling import falling_blocks
from la_core.limit.problem import ACCEPTED, Drive, DrivenProblem, ScaledProblem, driven_problem, scaled_problem
from la_core.measures import fastest_speed
from la_core.model import Assembly, twists_of

LEAST_FACETS = 4
METHODS = ("highs-ipm", "highs-ds")  # interior point with crossover to a corner, dual simplex
_OUTCOMES = {
    0: ProgrammeOutcome.OPTIMUM,
    2: ProgrammeOutcome.RAY,
    3: ProgrammeOutcome.EMPTY,
}  # outcome of the kinematic form, which is dual to the static one: no equilibrium is a RAY, an unbounded force is EMPTY


def solve_linearised(assembly: Assembly, drive: Drive, facets: int, inscribed: bool, method: str = "highs-ipm") -> Solution:
    """Solve one limit analysis with friction pyramids instead of cones, as a linear programme.

    Parameters
    ----------
    assembly : Assembly
        Structure with its weights, and its support motion or live load.
    drive : Drive
        Bound to compute.
    facets : int
        Sides of every pyramid, at least 4.
    inscribed : bool
        Whether the pyramids are inscribed in Coulomb's cones, or circumscribed about them.
    method : str
        One of METHODS.

    Returns
    -------
    Solution
        Units and signs as in every `Solution`. The residuals refer to the true cone: circumscribed pyramids leave a
        cone_violation and inscribed ones a mechanism_violation, both of order 1 / facets^2. The status refers to the
        pyramids. SOLVED: equilibrium, duality gap and the polygonal flow rule are within ACCEPTED. INFEASIBLE: no
        equilibrium within the pyramids; the true cones may allow one where the pyramids are inscribed. seconds and
        iterations are those of HiGHS, without the iterations of its crossover.

    Raises
    ------
    ValueError
        Too few facets, or an unknown method.
    """
    if facets < LEAST_FACETS:
        raise ValueError(f"facets = {facets}: a friction pyramid has at least {LEAST_FACETS} sides")
    if method not in METHODS:
        raise ValueError(f'method = "{method}": must be one of {", ".join(METHODS)}')
    problem = linearised_problem(assembly, facets, inscribed)
    driven = driven_problem(assembly, problem, drive)
    answer = _least_forces(driven, method)
    if answer.outcome is not ProgrammeOutcome.OPTIMUM:
        status = Status.UNBOUNDED if answer.outcome is ProgrammeOutcome.EMPTY else Status.FAILED
        return _unless_it_falls(assembly, problem, method, without_value(assembly, status, answer))
    solution = _confirmed(assembly, driven, answer, solution_of(assembly, problem, drive, driven, answer))
    if drive is Drive.LIVE:  # the live load alone may hold the structure up
        return _unless_it_falls(assembly, problem, method, solution)
    return solution


def linearised_problem(assembly: Assembly, facets: int, inscribed: bool) -> ScaledProblem:
    """The kinematic problem with an inequality for each edge of a pyramid in place of every second-order cone."""
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
    """Solve the static form. Its multipliers are the velocities x; its unknowns are the kinematic form's multipliers."""
    lowest = np.zeros(len(driven.offset))
    lowest[: driven.cones.equalities] = -np.inf
    bounds = np.stack([lowest, np.full_like(lowest, np.inf)], axis=1)
    programme = {"c": driven.offset, "A_eq": driven.rows.T.tocsc(), "b_eq": -driven.power, "bounds": bounds}
    result, seconds = _linprog(method, **programme)
    outcome = _OUTCOMES.get(result.status, ProgrammeOutcome.STALLED)
    if outcome is not ProgrammeOutcome.OPTIMUM:
        return ProgrammeAnswer(outcome, np.zeros(0), np.zeros(0), int(result.nit), seconds)
    return ProgrammeAnswer(outcome, -result.eqlin.marginals, np.maximum(result.x, lowest), int(result.nit), seconds)


def _unless_it_falls(assembly: Assembly, problem: ScaledProblem, method: str, solution: Solution) -> Solution:
    """The solution, or INFEASIBLE with the falling blocks where blocks fall; the cost of this test is added.

    The certificate is a motion that the pyramids admit, with velocities of at most one and the greatest work of the
    weights.
    """
    split = problem.cones.equalities
    equalities, inequalities = problem.rows[:split], problem.rows[split:]
    programme = {
        "A_eq": equalities,
        "b_eq": np.zeros(equalities.shape[0]),
        "A_ub": -inequalities,
        "b_ub": np.zeros(inequalities.shape[0]),
        "bounds": (-1.0, 1.0),
    }
    result, seconds = _linprog(method, c=-problem.power * int(assembly.blocks.free.sum()), **programme)
    names = falling_blocks(assembly, twists_of(assembly, result.x)) if result.status == 0 else ()
    seconds, iterations = solution.seconds + seconds, solution.iterations + int(result.nit)
    if not names:
        return replace(solution, seconds=seconds, iterations=iterations)
    nothing = np.zeros(0)
    return without_value(assembly, Status.INFEASIBLE, ProgrammeAnswer(ProgrammeOutcome.RAY, nothing, nothing, iterations, seconds), names)


def _linprog(method: str, **programme: object) -> "tuple[scipy.optimize.OptimizeResult, float]":
    """Result of HiGHS and its time in seconds."""
    options = {"primal_feasibility_tolerance": TOLERANCE, "dual_feasibility_tolerance": TOLERANCE}
    start = time.perf_counter()
    result = scipy.optimize.linprog(method=method, options=options, **programme)
    return result, time.perf_counter() - start


def _confirmed(assembly: Assembly, driven: DrivenProblem, answer: ProgrammeAnswer, solution: Solution) -> Solution:
    """The solution with the status of the linearised problem; its forces are in the pyramids by construction."""
    flow, split = driven.rows @ answer.x + driven.offset, driven.cones.equalities
    violation = max(np.abs(flow[:split]).max(initial=0.0), -flow[split:].min(initial=0.0))
    fastest = fastest_speed(assembly, solution.twists) / driven.speed
    worst = max(solution.equilibrium_residual, solution.duality_gap, violation / fastest if fastest > 0.0 else 0.0)
    return replace(solution, status=Status.SOLVED if worst <= ACCEPTED else Status.INACCURATE)
