"""Force sums over sections: what two methods can share although single contact forces are not unique."""

from dataclasses import replace

import numpy as np
from scipy import sparse

from la_core.exchange import SUPPORT
from la_core.limit.conic import ProgrammeOutcome, optimum
from la_core.limit.problem import scaled_problem
from la_core.model import Assembly, columns

LEVELS = (0.25, 0.5, 0.75)  # of the structure's height: where it is cut


def support_force(assembly: Assembly, forces: np.ndarray) -> np.ndarray:
    """Force (3,) in N of the supports on the structure, for contact forces (C, 3)."""
    return -assembly.contact_wrenches(forces)[assembly.blocks.role == SUPPORT, :3].sum(axis=0)


def support_force_range(assembly: Assembly, direction: np.ndarray, reaction: float, tolerance: float) -> tuple[float, float]:
    """Least and greatest component of the support's force along `direction` (3,) that equilibrium and friction allow, N.

    The reaction (N or N m) is held within `tolerance`. An end is infinite where nothing limits it, NaN where no state exists.
    The dual unknowns are the twists of the free blocks, as in `la_core.limit`, a motion of the support along its own direction
    (two of one sign, the multipliers of the reaction's two limits) and a unit dislocation along `direction`.
    """
    problem = scaled_problem(assembly)
    speed = assembly.support_speed
    driven = problem.imposed_rows @ columns(assembly, assembly.support_twist / speed)
    dislocation = np.zeros_like(assembly.support_twist)
    dislocation[assembly.blocks.role == SUPPORT, :3] = direction
    apart = problem.imposed_rows @ columns(assembly, dislocation)
    scaled = np.array([reaction - tolerance, reaction + tolerance]) / (assembly.weight * speed)
    power = np.concatenate([problem.power, scaled * (1.0, -1.0)])
    # Rows above the cones keep the two multipliers positive.
    count = len(problem.power)
    positive = sparse.csr_matrix(([1.0, 1.0], ([0, 1], [count, count + 1])), shape=(2, count + 2))
    cone_rows = sparse.hstack([problem.rows, sparse.csr_matrix(np.stack([-driven, driven], axis=1))])
    cones = problem.cones
    split = cones.equalities
    rows = sparse.vstack([cone_rows.tocsr()[:split], positive, cone_rows.tocsr()[split:]]).tocsr()
    cones = replace(cones, inequalities=cones.inequalities + 2)
    ends = []
    for sign in (1.0, -1.0):
        offset = np.concatenate([sign * apart[:split], [0.0, 0.0], sign * apart[split:]])
        answer = optimum(power, rows, offset, cones)
        bound = {ProgrammeOutcome.OPTIMUM: float(power @ answer.x) * assembly.weight, ProgrammeOutcome.EMPTY: -np.inf}.get(
            answer.outcome, np.nan
        )
        ends.append(sign * bound)
    # The dislocation moves the support, so the sums above are of the force on the support: turn them.
    return -ends[1], -ends[0]


def level_sums(assembly: Assembly, forces: np.ndarray) -> np.ndarray:
    """Force (levels, 3) in N that the part above each level receives from below and from held blocks, for forces (C, 3).

    Levels cut the free blocks at LEVELS of their height against gravity.
    """
    up = -assembly.dead_load[:, :3].sum(axis=0)
    height = assembly.blocks.centroid @ (up / np.linalg.norm(up))
    free_height = height[assembly.blocks.free]
    a, b = assembly.contact_blocks
    sums = []
    for level in LEVELS:
        above = assembly.blocks.free & (height > free_height.min() + level * np.ptp(free_height))
        sums.append(((above[b].astype(float) - above[a].astype(float))[:, None] * forces).sum(axis=0))
    return np.array(sums)
