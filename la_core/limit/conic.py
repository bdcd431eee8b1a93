"""The one place that talks to clarabel: maximise a linear power subject to velocities in cones."""

import enum
import time
from dataclasses import dataclass, replace

import clarabel
import numpy as np
from scipy import sparse

TOLERANCE = 1e-9  # feasibility and gap asked of the solver; what was reached is recomputed by the caller
MOST_ITERATIONS = 300
SUPERNODAL_ROWS = 100_000  # about 10,000 blocks in the plane, 2,800 in 3D: from here on faer's factorisation overtakes qdldl's


class ProgrammeOutcome(enum.Enum):
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
class ProgrammeAnswer:
    """x: velocities (a ray where outcome is RAY); multipliers of the cone rows; iterations; seconds inside the solver."""

    outcome: ProgrammeOutcome
    x: np.ndarray
    multipliers: np.ndarray
    iterations: int
    seconds: float


_OUTCOMES = {
    clarabel.SolverStatus.Solved: ProgrammeOutcome.OPTIMUM,
    clarabel.SolverStatus.AlmostSolved: ProgrammeOutcome.OPTIMUM,
    clarabel.SolverStatus.DualInfeasible: ProgrammeOutcome.RAY,
    clarabel.SolverStatus.AlmostDualInfeasible: ProgrammeOutcome.RAY,
    clarabel.SolverStatus.PrimalInfeasible: ProgrammeOutcome.EMPTY,
    clarabel.SolverStatus.AlmostPrimalInfeasible: ProgrammeOutcome.EMPTY,
}


class Programme:
    """A programme set up once and solved for one power and offset after another: rows, cones and quadratic term stay.

    Maximise power . x - x . diag(quadratic) x / 2 subject to matrix x + offset in the product of `cones`. The solver keeps the
    ordering and symbolic factorisation of the first solve; there is no warm start.
    The caller scales the problem: entries of order one. equilibrate: let the solver scale it once more. refine: correct the solution
    of every linear system, a quarter of the time, by which digits are gained that a caller who checks the answer can do without.
    """

    def __init__(
        self,
        matrix: sparse.csr_matrix,
        cones: Cones,
        quadratic: np.ndarray | None = None,
        tolerance: float = TOLERANCE,
        equilibrate: bool = True,
        refine: bool = True,
    ) -> None:
        rows, size = matrix.shape
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_iter = MOST_ITERATIONS
        settings.tol_gap_abs = settings.tol_feas = tolerance
        settings.tol_gap_rel = np.finfo(float).eps  # it is the absolute gap that callers look at
        settings.direct_solve_method = "faer" if rows > SUPERNODAL_ROWS else "qdldl"
        settings.max_threads = 1
        settings.presolve_enable = False  # else a programme cannot be updated; there is nothing to remove
        settings.equilibrate_enable = equilibrate
        settings.iterative_refinement_enable = refine
        if not refine:
            settings.static_regularization_constant = 1e-10  # the default, 1e-8, needs refinement
        kinds = [clarabel.ZeroConeT(cones.equalities)] if cones.equalities else []
        kinds += [clarabel.NonnegativeConeT(cones.inequalities)] if cones.inequalities else []
        kinds += [clarabel.SecondOrderConeT(3)] * cones.second_order
        square = sparse.csc_matrix((size, size)) if quadratic is None else sparse.diags(quadratic).tocsc()
        self._solver = clarabel.DefaultSolver(square, np.zeros(size), sparse.csc_matrix(-matrix), np.zeros(rows), kinds, settings)

    def solve(self, power: np.ndarray, offset: np.ndarray) -> ProgrammeAnswer:
        """Solve for this power (n,) and offset (rows,)."""
        start = time.perf_counter()
        self._solver.update(q=-power, b=offset)
        solution = self._solver.solve()
        seconds = time.perf_counter() - start
        outcome = _OUTCOMES.get(solution.status, ProgrammeOutcome.STALLED)
        return ProgrammeAnswer(outcome, np.array(solution.x), np.array(solution.z), int(solution.iterations), seconds)


def maximise(
    power: np.ndarray,
    matrix: sparse.csr_matrix,
    offset: np.ndarray,
    cones: Cones,
    tolerance: float = TOLERANCE,
    equilibrate: bool = True,
    refine: bool = True,
) -> ProgrammeAnswer:
    """Maximise power . x subject to matrix x + offset in the product of `cones`, once."""
    start = time.perf_counter()
    answer = Programme(matrix, cones, tolerance=tolerance, equilibrate=equilibrate, refine=refine).solve(power, offset)
    return replace(answer, seconds=time.perf_counter() - start)


def optimum(power: np.ndarray, matrix: sparse.csr_matrix, offset: np.ndarray, cones: Cones) -> ProgrammeAnswer:
    """`maximise`, and again without equilibration where that finds none: it blows up rows of joints almost without friction."""
    first = maximise(power, matrix, offset, cones)
    if first.outcome is ProgrammeOutcome.OPTIMUM:
        return first
    second = maximise(power, matrix, offset, cones, equilibrate=False)
    best = second if second.outcome is ProgrammeOutcome.OPTIMUM else first
    return replace(best, seconds=first.seconds + second.seconds, iterations=first.iterations + second.iterations)
