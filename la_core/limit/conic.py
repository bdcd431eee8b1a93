"""The one place that talks to clarabel: maximise a linear power subject to velocities in cones."""

import enum
import time
from dataclasses import dataclass, replace

import clarabel
import numpy as np
from scipy import sparse

TOLERANCE = 1e-9  # on feasibility and gap in the solver; the caller recomputes the residuals of the answer
MOST_ITERATIONS = 300
REGULARISATION = 1e-10  # of linear systems that are not refined; the solver's own, 1e-8, needs refinement
SUPERNODAL_ROWS = 100_000  # about 10,000 blocks in the plane, 2,800 in 3D: beyond it faer factorises faster than qdldl


class ProgrammeOutcome(enum.Enum):
    """Outcome as the solver reports it; the caller confirms it by residuals."""

    OPTIMUM = "optimum"
    RAY = "ray"  # the power grows without bound along x
    EMPTY = "empty"  # no feasible point
    STALLED = "stalled"  # the solver stopped without a decision


@dataclass(frozen=True)
class Cones:
    """Sizes of the product cone, in the order of the rows.

    Attributes
    ----------
    equalities : int
        Rows that vanish.
    inequalities : int
        Rows that are at least 0.
    second_order : int
        Cones of three rows each, first >= norm of the other two.
    """

    equalities: int
    inequalities: int
    second_order: int


@dataclass(frozen=True)
class ProgrammeAnswer:
    """Answer of the solver.

    Attributes
    ----------
    outcome : ProgrammeOutcome
        Outcome as the solver reports it.
    x : (n,) array
        Velocities; a ray where the outcome is RAY.
    multipliers : (rows,) array
        Multipliers of the cone rows.
    iterations : int
        Iterations of the solver.
    seconds : float
        Time in the solver.
    """

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
    """A conic programme that is set up once and solved for several powers and offsets.

    It maximises power . x - x . diag(quadratic) x / 2 subject to matrix x + offset in the product of `cones`. The
    solver keeps the ordering and symbolic factorisation of the first solve; there is no warm start. The caller scales
    all entries to order one. The solver is set up at the first solve, with its power and offset: on small problems an
    update of a solver that is already set up takes a fifth of the whole time.

    Parameters
    ----------
    matrix : (rows, n) sparse matrix
        Rows of the constraints, in the order of `cones`.
    cones : Cones
        Sizes of the product cone.
    quadratic : (n,) array, optional
        Diagonal of the quadratic term, at least 0; absent for a linear objective.
    tolerance : float
        On feasibility and absolute gap.
    equilibrate : bool
        Let the solver scale the rows and columns once more.
    refine : bool
        Correct the solution of every linear system iteratively. This takes a quarter of the time. A caller who
        checks the answer seldom needs the digits gained.
    regularisation : float
        Number that the solver adds to the diagonals of linear systems that it does not refine.
    """

    def __init__(
        self,
        matrix: sparse.csr_matrix,
        cones: Cones,
        quadratic: np.ndarray | None = None,
        tolerance: float = TOLERANCE,
        equilibrate: bool = True,
        refine: bool = True,
        regularisation: float = REGULARISATION,
    ) -> None:
        rows, size = matrix.shape
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_iter = MOST_ITERATIONS
        settings.tol_gap_abs = settings.tol_feas = tolerance
        settings.tol_gap_rel = np.finfo(float).eps  # callers judge by the absolute gap
        settings.direct_solve_method = "faer" if rows > SUPERNODAL_ROWS else "qdldl"
        settings.max_threads = 1
        settings.presolve_enable = False  # a presolved programme cannot be updated; there is nothing to remove
        settings.equilibrate_enable = equilibrate
        settings.iterative_refinement_enable = refine
        if not refine:
            settings.static_regularization_constant = regularisation
        kinds = [clarabel.ZeroConeT(cones.equalities)] if cones.equalities else []
        kinds += [clarabel.NonnegativeConeT(cones.inequalities)] if cones.inequalities else []
        kinds += [clarabel.SecondOrderConeT(3)] * cones.second_order
        self._square = sparse.csc_matrix((size, size)) if quadratic is None else sparse.diags(quadratic).tocsc()
        negative = matrix.tocsc(copy=True)
        negative.data *= -1.0  # SciPy's negation of a small matrix takes three times as long as the conversion
        self._rows, self._kinds, self._settings = negative, kinds, settings
        self._solver: clarabel.DefaultSolver | None = None

    def solve(self, power: np.ndarray, offset: np.ndarray) -> ProgrammeAnswer:
        """Maximise for this power (n,) and offset (rows,)."""
        start = time.perf_counter()
        if self._solver is None:
            self._solver = clarabel.DefaultSolver(self._square, -power, self._rows, offset, self._kinds, self._settings)
        else:
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
    regularisation: float = REGULARISATION,
) -> ProgrammeAnswer:
    """Solve a linear conic programme once: maximise power . x subject to matrix x + offset in the product of `cones`.

    power (n,), matrix (rows, n) and offset (rows,) have entries of order one; the other parameters are those of
    `Programme`.
    """
    start = time.perf_counter()
    answer = Programme(matrix, cones, None, tolerance, equilibrate, refine, regularisation).solve(power, offset)
    return replace(answer, seconds=time.perf_counter() - start)


def optimum(power: np.ndarray, matrix: sparse.csr_matrix, offset: np.ndarray, cones: Cones) -> ProgrammeAnswer:
    """Answer of `maximise`; where it finds no optimum, a second attempt without equilibration follows.

    Equilibration enlarges the rows of joints with very little friction so much that the solver may stall. The
    parameters are those of `maximise`; seconds and iterations are those of both attempts.
    """
    first = maximise(power, matrix, offset, cones)
    if first.outcome is ProgrammeOutcome.OPTIMUM:
        return first
    second = maximise(power, matrix, offset, cones, equilibrate=False)
    best = second if second.outcome is ProgrammeOutcome.OPTIMUM else first
    return replace(best, seconds=first.seconds + second.seconds, iterations=first.iterations + second.iterations)
