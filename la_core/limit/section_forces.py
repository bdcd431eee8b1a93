"""Sums of contact forces over sections: two methods can agree on them although single forces are not unique."""

from dataclasses import replace

import numpy as np
from scipy import sparse

from la_core.exchange import SUPPORT
from la_core.limit.conic import ProgrammeOutcome, optimum
from la_core.limit.problem import scaled_problem
from la_core.model import Assembly, columns

LEVELS = (0.25, 0.5, 0.75)  # of the height between the lowest and the highest centroid of a free block: horizontal cuts


def support_force(assembly: Assembly, forces: np.ndarray) -> np.ndarray:
    """Force (3,) in N of the supports on the structure, for contact forces (C, 3)."""
    return -assembly.contact_wrenches(forces)[assembly.blocks.role == SUPPORT, :3].sum(axis=0)


def support_force_range(assembly: Assembly, direction: np.ndarray, reaction: float, tolerance: float) -> tuple[float, float]:
    """Least and greatest component of the support's force along a direction that equilibrium and friction allow, N.

    An end is infinite where nothing limits it, and NaN where no state of equilibrium exists or the solver found no
    optimum. The unknowns of the kinematic programme are the twists of the free blocks and two motions of the support
    along its own direction, at least 0: the multipliers of the two limits on the reaction. A unit dislocation along
    `direction` drives the programme.

    Parameters
    ----------
    assembly : Assembly
        Structure on a moving support.
    direction : (3,) array
        Unit direction of the force component.
    reaction : float
        Reaction of the support, N or N m.
    tolerance : float
        Largest deviation from that reaction, N or N m.
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
        optimum_value = float(power @ answer.x) * assembly.weight
        bound = {ProgrammeOutcome.OPTIMUM: optimum_value, ProgrammeOutcome.EMPTY: -np.inf}.get(answer.outcome, np.nan)
        ends.append(sign * bound)
    # The dislocation moves the support, so the ends bound the force on the support. The signs turn them into bounds for the structure.
    return -ends[1], -ends[0]


def level_sums(assembly: Assembly, forces: np.ndarray) -> np.ndarray:
    """Force (levels, 3), N, on the blocks above each level from the blocks below it and from held blocks.

    forces (C, 3): contact forces, N.
    """
    a, b = assembly.contact_blocks
    above = _above(assembly).astype(float)
    return (above[:, b] - above[:, a]) @ forces


def sums_in_equilibrium(assembly: Assembly, multiplier: float) -> np.ndarray:
    """Force (levels, 3), N, that `level_sums` returns in equilibrium with the loads. multiplier: of the live load, 0 without one."""
    loads = assembly.dead_load[:, :3] + multiplier * assembly.live_load[:, :3]
    return -(_above(assembly).astype(float) @ loads)


def _above(assembly: Assembly) -> np.ndarray:
    """Mask (levels, B) of the free blocks whose centroid lies above each level.

    LEVELS are shares of the height of the free blocks' centroids, against gravity.
    """
    height = assembly.blocks.centroid @ -assembly.down
    free_height = height[assembly.blocks.free]
    levels = free_height.min() + np.array(LEVELS) * np.ptp(free_height)
    return np.asarray(assembly.blocks.free & (height > levels[:, None]))
