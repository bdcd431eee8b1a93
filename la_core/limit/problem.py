"""The kinematic problem of an assembly in scaled numbers: flow rule, cones, the drive, and limits on velocities."""

import enum
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from la_core.limit.conic import Cones
from la_core.limit.no_sliding import no_sliding_rows
from la_core.model import PLANE_FREEDOMS, Assembly, columns, scaled_load, support_motion

ACCEPTED = 1e-6  # every recomputed residual of an answer called "solved" is below this
SMOOTH = 0.1 * ACCEPTED  # friction up to here is solved as none, which the residuals do not notice and the solver needs


class Drive(enum.Enum):
    """What drives the structure to collapse."""

    YIELDING = 1.0  # the support moves by its unit motion: least reaction
    PUSHING = -1.0  # the support moves against it: greatest reaction
    LIVE = 0.0  # a load grows: collapse multiplier


@dataclass(frozen=True)
class ScaledProblem:
    """The kinematic problem with lengths over the mean block size and weights over the total weight.

    power (n,): of the weights per unknown; rows: unknowns to flow-rule velocities; imposed_rows: all blocks' columns to the same;
    flow_rule: local relative velocities to flow-rule velocities, its transpose turns multipliers into contact forces.
    """

    power: np.ndarray
    rows: sparse.csr_matrix
    imposed_rows: sparse.csr_matrix
    flow_rule: sparse.csr_matrix
    cones: Cones


@dataclass(frozen=True)
class DrivenProblem:
    """Maximise power . x subject to rows x + offset in `cones`: the scaled problem under one drive, powers relative to the mean block.

    x (n,) are the scaled twists of the free blocks without the imposed ones (B, 6); twists are (x + imposed) times `speed`. A live
    load adds a first row, its power less the unit one.
    """

    power: np.ndarray
    rows: sparse.csr_matrix
    offset: np.ndarray
    cones: Cones
    imposed: np.ndarray
    speed: float


def scaled_problem(assembly: Assembly, every_point: bool = False) -> ScaledProblem:
    """Set up the kinematic problem of an assembly, the same for every drive.

    every_point: where sliding is excluded, say so at every contact point, though a few say it for all.
    """
    flow_rule, cones = _flow_rule(assembly, every_point)
    freedoms = len(PLANE_FREEDOMS) if assembly.effects.plane else 6
    free = np.repeat(assembly.blocks.free, freedoms)
    imposed_rows = (flow_rule @ assembly.kinematic_matrix(assembly.length)).tocsr()
    power = scaled_load(assembly, assembly.dead_load)
    return ScaledProblem(power, imposed_rows[:, free], imposed_rows, flow_rule, cones)


def driven_problem(assembly: Assembly, problem: ScaledProblem, drive: Drive) -> DrivenProblem:
    """The scaled problem under one drive."""
    speed, imposed = support_motion(assembly, drive.value)
    rows, cones = problem.rows, problem.cones
    offset = problem.imposed_rows @ columns(assembly, imposed)
    if drive is Drive.LIVE:
        live = scaled_load(assembly, assembly.live_load)
        rows = sparse.vstack([sparse.csr_matrix(live), rows]).tocsr()
        offset = np.concatenate([[-1.0], offset])
        cones = replace(cones, equalities=cones.equalities + 1)
        speed = 1.0 / assembly.weight  # unit power of the unit live load, which was scaled by the weight
    blocks = int(assembly.blocks.free.sum())  # turns powers relative to the weight into ones relative to the mean block, as residuals are
    return DrivenProblem(problem.power * blocks, rows, offset, cones, imposed, speed)


def _flow_rule(assembly: Assembly, every_point: bool) -> tuple[sparse.csr_matrix, Cones]:
    """Rows T with T u in the flow rule's cone; contact forces are T' times the multipliers.

    Frictionless points need only u_n >= 0; where sliding is excluded (Heyman), u_t = 0 and u_n >= 0; in the plane the cone is
    two inequalities u_n -+ mu u_t >= 0; else one second-order cone. Rows are scaled to unit length, which leaves cones as they are.
    """
    friction, count = assembly.points.friction, len(assembly.points)
    width = 2 if assembly.effects.plane else 3
    normal_row = np.arange(count) * width
    scale = 1.0 / np.hypot(1.0, friction)
    no_slip = assembly.effects.sliding_excluded
    rough = np.flatnonzero(friction > SMOOTH) if not no_slip else np.zeros(0, dtype=int)
    smooth = np.flatnonzero(friction <= SMOOTH) if not no_slip else np.arange(count)
    tangents = [normal_row + k for k in range(1, width)]
    pick = sparse.identity(count * width, format="csr")
    equalities = pick[:0]
    if no_slip:
        equalities = sparse.vstack([pick[rows] for rows in tangents]) if every_point else no_sliding_rows(assembly)
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


def box_limits(problem: ScaledProblem) -> tuple[sparse.csr_matrix, np.ndarray, Cones]:
    """Rows, offset and cones with every unknown limited to -1..1 and the supports at rest; the limits stand after the equalities."""
    size, split = len(problem.power), problem.cones.equalities
    limits = sparse.vstack([sparse.identity(size), -sparse.identity(size)])
    rows = sparse.vstack([problem.rows[:split], limits, problem.rows[split:]]).tocsr()
    offset = np.zeros(rows.shape[0])
    offset[split : split + 2 * size] = 1.0
    return rows, offset, replace(problem.cones, inequalities=problem.cones.inequalities + 2 * size)
