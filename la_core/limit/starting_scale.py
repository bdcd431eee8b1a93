"""Scale of the rows of a programme, from which the conic solver starts nearer to its answer.

The solver starts from velocities and forces of one size in all rows. Equal scales of the rows of a cone do not change the
cone. They change only the start and, where several answers are possible, the answer that the solver returns.
"""

import numpy as np

from la_core.limit.problem import ScaledProblem, multipliers_of, points_of_rows
from la_core.model import Assembly

HEAD_SCALE = 10.0  # of the rows of joints parallel to gravity; joints perpendicular to it have 1
NEAR_SCALE = 15.0  # largest scale from the forces of a similar problem, and inverse of the least scale: larger scales cost accuracy
NEAR_REGULARISATION = 1e-9  # of the linear systems of rows with such scales; a smaller one leaves forces out of balance


def starting_scale(assembly: Assembly, problem: ScaledProblem, count: int, forces: np.ndarray | None) -> np.ndarray:
    """Scale (count,) of the rows; the rows of the contact points come last.

    With forces of a similar problem the solver mostly takes half to nine tenths of its iterations. Without them, larger
    scales at head joints save a tenth to a fifth.

    forces: contact forces (C, 3), N, of a similar problem with as many contact points; forces that are all 0 are ignored.
    """
    rows = problem.rows.shape[0]
    sizes = np.zeros(0) if forces is None else _sizes_of_multipliers(assembly, problem, forces)
    if sizes.max(initial=0.0) > 0.0:
        by_row = np.maximum(NEAR_SCALE * sizes / sizes.max(), 1.0 / NEAR_SCALE)
    else:
        pressed = np.abs(assembly.normal @ assembly.down)
        by_row = HEAD_SCALE ** (1.0 - pressed[points_of_rows(assembly, problem)])
    return np.concatenate([np.ones(count - rows), by_row])


def _sizes_of_multipliers(assembly: Assembly, problem: ScaledProblem, forces: np.ndarray) -> np.ndarray:
    """Sizes (m,) of the multipliers whose contact forces are `forces` (C, 3), N; all three rows of a cone have the size of the first."""
    sizes = np.abs(multipliers_of(assembly, problem, forces))
    cones = 3 * problem.cones.second_order
    if cones:
        sizes[-cones:] = np.repeat(sizes[-cones::3], 3)
    return sizes
