"""The kinematic problem of an assembly in scaled numbers: flow rule, cones, the drive, and limits on velocities."""

import enum
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from la_core.limit.conic import Cones
from la_core.limit.no_sliding import no_sliding_rows
from la_core.model import PLANE_FREEDOMS, Assembly, columns, local_forces, scaled_load, support_motion

ACCEPTED = 1e-6  # every recomputed residual of an answer called "solved" is below this
SMOOTH = 0.1 * ACCEPTED  # a smaller friction coefficient counts as 0: the solver needs this, and the residuals do not show the change


class Drive(enum.Enum):
    """The action that drives the structure to collapse. Each action yields one bound, and this table names the bounds:

    ========  =====  ==================================  ========  ============  ======
    drive     value  action and bound                    group     key           symbol
    ========  =====  ==================================  ========  ============  ======
    YIELDING   1.0   support moves with the settlement:  least     reaction      R_min
                     least reaction
    PUSHING   -1.0   support moves against it: greatest  greatest  reaction_max  R_max
                     reaction
    LIVE       0.0   live load grows: collapse           collapse  multiplier    λ
                     multiplier
    ========  =====  ==================================  ========  ============  ======

    `value` is the factor of the support's unit motion. `group` names the HDF5 group and, for a reaction, the Python
    attribute; `key` is the JSON key; `symbol` stands in figures and reports.
    """

    YIELDING = 1.0
    PUSHING = -1.0
    LIVE = 0.0

    @property
    def group(self) -> str:
        """HDF5 group of the bound."""
        return {Drive.YIELDING: "least", Drive.PUSHING: "greatest", Drive.LIVE: "collapse"}[self]

    @property
    def key(self) -> str:
        """JSON key of the bound."""
        return {Drive.YIELDING: "reaction", Drive.PUSHING: "reaction_max", Drive.LIVE: "multiplier"}[self]

    @property
    def symbol(self) -> str:
        """Symbol of the bound in figures and reports."""
        return {Drive.YIELDING: "R_min", Drive.PUSHING: "R_max", Drive.LIVE: "λ"}[self]


@dataclass(frozen=True)
class ScaledProblem:
    """The kinematic problem with lengths over the mean block size and forces over the weight of the free blocks.

    The n unknowns are the scaled twists of the free blocks (see `la_core.model.columns`); the m flow-rule velocities
    lie in `cones`.

    Attributes
    ----------
    power : (n,) array
        Power of the weights per unit of each unknown.
    rows : (m, n) sparse matrix
        From the unknowns to the flow-rule velocities.
    imposed_rows : (m, 3 B or 6 B) sparse matrix
        From the scaled twists of all B blocks to the flow-rule velocities.
    flow_rule : (m, 2 C or 3 C) sparse matrix
        From the local relative velocities at the C contact points to the flow-rule velocities.
        Its transpose turns multipliers into local contact forces.
    cones : Cones
        Sizes of the cones that hold the flow-rule velocities.
    """

    power: np.ndarray
    rows: sparse.csr_matrix
    imposed_rows: sparse.csr_matrix
    flow_rule: sparse.csr_matrix
    cones: Cones


@dataclass(frozen=True)
class DrivenProblem:
    """The scaled problem under one drive: maximise power . x subject to rows x + offset in `cones`.

    The unknowns x (n,) are the scaled twists of the free blocks. Twists per unit of the drive are (twists of x +
    imposed) times `speed`. A live load adds a first row: its power minus 1, which must vanish.

    Attributes
    ----------
    power : (n,) array
        Power of the weights per unit of each unknown, relative to the mean weight of a free block.
    rows : (m, n) sparse matrix
        From the unknowns to the flow-rule velocities; (m + 1, n) for a live load.
    offset : (m,) array
        Flow-rule velocities that the support's motion imposes; (m + 1,) for a live load.
    cones : Cones
        Sizes of the cones that hold rows x + offset.
    imposed : (B, 6) array
        Twists of the support blocks for unit speed of the fastest support point; zero for all other blocks.
    speed : float
        Factor from scaled twists to twists per unit motion of the support, or per unit power of the live load.
    """

    power: np.ndarray
    rows: sparse.csr_matrix
    offset: np.ndarray
    cones: Cones
    imposed: np.ndarray
    speed: float


def scaled_problem(assembly: Assembly) -> ScaledProblem:
    """Set up the kinematic problem of an assembly; it is the same for every drive."""
    flow_rule, cones = _flow_rule(assembly)
    freedoms = len(PLANE_FREEDOMS) if assembly.effects.plane else 6
    free = np.repeat(assembly.blocks.free, freedoms)
    imposed_rows = (flow_rule @ assembly.kinematic_matrix(assembly.length)).tocsr()
    power = scaled_load(assembly, assembly.dead_load)
    return ScaledProblem(power, imposed_rows[:, free], imposed_rows, flow_rule, cones)


def driven_problem(assembly: Assembly, problem: ScaledProblem, drive: Drive) -> DrivenProblem:
    """Add one drive to the scaled problem of an assembly.

    Parameters
    ----------
    assembly : Assembly
        Structure with its support motion, or its live load for `Drive.LIVE`.
    problem : ScaledProblem
        `scaled_problem(assembly)`, which several drives can share.
    drive : Drive
        Direction of the support's motion, or the live load.

    Returns
    -------
    DrivenProblem
        The problem that the conic solver takes: power, rows, offset and cones, and the imposed twists.
    """
    speed, imposed = support_motion(assembly, drive.value)
    rows, cones = problem.rows, problem.cones
    offset = problem.imposed_rows @ columns(assembly, imposed)
    if drive is Drive.LIVE:
        live = scaled_load(assembly, assembly.live_load)
        rows = sparse.vstack([sparse.csr_matrix(live), rows]).tocsr()
        offset = np.concatenate([[-1.0], offset])
        cones = replace(cones, equalities=cones.equalities + 1)
        speed = 1.0 / assembly.weight  # unit power of the unit live load, which was scaled by the weight
    free_blocks = int(assembly.blocks.free.sum())  # makes powers relative to the mean block weight, as residuals are
    return DrivenProblem(problem.power * free_blocks, rows, offset, cones, imposed, speed)


def _flow_rule(assembly: Assembly) -> tuple[sparse.csr_matrix, Cones]:
    """Rows T: local relative velocities u obey the flow rule where T u lies in the cones.

    Contact forces are T' times the multipliers. A frictionless point needs only u_n >= 0. Where sliding is excluded
    (Heyman 1966), u_t = 0 and u_n >= 0. In the plane the cone is two inequalities, u_n -+ mu u_t >= 0; in space it is
    one second-order cone. Rows are scaled to unit length, which does not change the cones.
    """
    friction, count = assembly.points.friction, len(assembly.points)
    width = 2 if assembly.effects.plane else 3
    normal_row = np.arange(count) * width
    scale = 1.0 / np.hypot(1.0, friction)
    no_slip = assembly.effects.sliding_excluded
    is_rough = (friction > SMOOTH) & (not no_slip)
    rough, smooth = np.flatnonzero(is_rough), np.flatnonzero(~is_rough)
    tangents = [normal_row + k for k in range(1, width)]
    pick = sparse.identity(count * width, format="csr")
    equalities = no_sliding_rows(assembly) if no_slip else pick[:0]
    unilateral = pick[normal_row[smooth]]
    n, scaled_n = normal_row[rough], sparse.diags(scale[rough])
    slope = sparse.diags((scale * friction)[rough])
    if assembly.effects.plane:
        t = slope @ pick[tangents[0][rough]]
        pairs = sparse.vstack([scaled_n @ pick[n] - t, scaled_n @ pick[n] + t])
        inequalities, second_order = sparse.vstack([unilateral, pairs]), pick[:0]
    else:
        triples = sparse.vstack([scaled_n @ pick[n], *(slope @ pick[rows[rough]] for rows in tangents)]).tocsr()
        order = np.arange(3 * len(rough)).reshape(3, -1).T.ravel()
        inequalities, second_order = unilateral, triples[order]
    rows = sparse.vstack([equalities, inequalities, second_order]).tocsr()
    return rows, Cones(equalities.shape[0], inequalities.shape[0], len(rough) if not assembly.effects.plane else 0)


def points_of_rows(assembly: Assembly, problem: ScaledProblem) -> np.ndarray:
    """Contact point (m,) of each flow-rule velocity."""
    width = problem.flow_rule.shape[1] // len(assembly.points)
    return np.asarray(problem.flow_rule.indices[problem.flow_rule.indptr[:-1]] // width)


def multipliers_of(assembly: Assembly, problem: ScaledProblem, forces: np.ndarray) -> np.ndarray:
    """Multipliers (m,) whose contact forces are `forces` (C, 3), N.

    The rows of inequalities and cones form a matrix with orthogonal columns, so the least multipliers follow without a
    solution of equations. Where sliding is excluded, the multipliers have only roughly the right size.
    """
    flow_rule = problem.flow_rule
    squares = np.asarray(flow_rule.multiply(flow_rule).sum(axis=0)).ravel()
    local = local_forces(assembly, forces, len(squares) // len(assembly.points))
    return np.asarray(flow_rule @ np.divide(local, squares, out=np.zeros_like(local), where=squares > 0.0))


def box_limits(problem: ScaledProblem) -> tuple[sparse.csr_matrix, np.ndarray, Cones]:
    """Rows, offset and cones of the problem with the supports at rest and every unknown between -1 and 1.

    The rows of these limits follow the equalities.
    """
    size, split = len(problem.power), problem.cones.equalities
    limits = sparse.vstack([sparse.identity(size), -sparse.identity(size)])
    rows = sparse.vstack([problem.rows[:split], limits, problem.rows[split:]]).tocsr()
    offset = np.zeros(rows.shape[0])
    offset[split : split + 2 * size] = 1.0
    return rows, offset, replace(problem.cones, inequalities=problem.cones.inequalities + 2 * size)
