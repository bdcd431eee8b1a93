"""The one place that talks to clarabel: maximise a linear power subject to velocities in cones."""

import enum
import time
from dataclasses import dataclass

import clarabel
import numpy as np
from scipy import sparse

TOLERANCE = 1e-9  # relative feasibility and gap asked of the solver; what was reached is recomputed by the caller
MOST_ITERATIONS = 300


class Outcome(enum.Enum):
    """What the solver believes: an optimum, a ray along which the power grows for ever, no feasible point, or neither."""

    OPTIMUM = "optimum"
    RAY = "ray"
    EMPTY = "empty"
    STALLED = "stalled"


@dataclass(frozen=True)
class Cones:
    """Sizes of the product cone, in the order of the rows: equalities, then inequalities, then second-order cones of three."""

    equalities: int
    inequalities: int
    second_order: int


@dataclass(frozen=True)
class Answer:
    """x: velocities (a ray where outcome is RAY); multipliers of the cone rows; iterations; seconds inside the solver."""

    outcome: Outcome
    x: np.ndarray
    multipliers: np.ndarray
    iterations: int
    seconds: float


_OUTCOMES = {
    clarabel.SolverStatus.Solved: Outcome.OPTIMUM,
    clarabel.SolverStatus.AlmostSolved: Outcome.OPTIMUM,
    clarabel.SolverStatus.DualInfeasible: Outcome.RAY,
    clarabel.SolverStatus.AlmostDualInfeasible: Outcome.RAY,
    clarabel.SolverStatus.PrimalInfeasible: Outcome.EMPTY,
    clarabel.SolverStatus.AlmostPrimalInfeasible: Outcome.EMPTY,
}


def maximise(power: np.ndarray, matrix: sparse.csr_matrix, offset: np.ndarray, cones: Cones) -> Answer:
    """Maximise power . x subject to matrix x + offset in the product of `cones`.

    The caller scales the problem: entries of order one, `power` relative to the total weight.
    """
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_iter = MOST_ITERATIONS
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = TOLERANCE
    settings.direct_solve_method = "qdldl"  # "auto" picks one that is 2-3 times slower on these problems
    settings.max_threads = 1
    kinds = [clarabel.ZeroConeT(cones.equalities)] if cones.equalities else []
    kinds += [clarabel.NonnegativeConeT(cones.inequalities)] if cones.inequalities else []
    kinds += [clarabel.SecondOrderConeT(3)] * cones.second_order
    size = len(power)
    start = time.perf_counter()
    solver = clarabel.DefaultSolver(sparse.csc_matrix((size, size)), -power, sparse.csc_matrix(-matrix), offset, kinds, settings)
    solution = solver.solve()
    seconds = time.perf_counter() - start
    outcome = _OUTCOMES.get(solution.status, Outcome.STALLED)
    return Answer(outcome, np.array(solution.x), np.array(solution.z), int(solution.iterations), seconds)
