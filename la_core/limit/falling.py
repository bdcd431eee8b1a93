"""Fall of a structure that cannot stand: the blocks that fall, and the acceleration over free fall."""

import numpy as np

from la_core.limit.conic import Programme
from la_core.limit.problem import scaled_problem
from la_core.measures import block_speeds, corner_speeds
from la_core.model import Assembly, twists_of

FALLING_SHARE = 1e-3  # of the greatest speed of sinking: blocks at least this fast count as falling in a certificate
LEAST_FALL = 1e-8  # of the weight: power at unit speed that a certificate needs, above the solver's tolerance


def falling_blocks(assembly: Assembly, twists: np.ndarray) -> tuple[str, ...]:
    """Names of the blocks that sink, or tip over, in a motion (B, 6) of order one; empty where the weights do no positive work.

    A block counts where any part of it sinks: the lower stones of a corbel tip with the corbel although their centroids rise.
    """
    power, weight = np.sum(assembly.dead_load * twists, axis=1), assembly.block_weight
    if not power.sum() > LEAST_FALL * assembly.weight:
        return ()
    sinking = np.divide(power, weight, out=np.zeros_like(power), where=weight > 0.0)
    fastest = np.maximum(sinking, np.where(assembly.blocks.free, corner_speeds(assembly.blocks, twists, assembly.down), 0.0))
    return tuple(assembly.blocks.names[k] for k in np.flatnonzero(fastest >= FALLING_SHARE * fastest.max()))


def share_of_free_fall(assembly: Assembly) -> float:
    """Acceleration of a structure that starts to fall, over free fall: 1 in free fall, near 0 where it almost stands.

    It is the power of the weights, loads and ties in the motion into which they accelerate the structure, over the sum of the weight of
    every block times the speed of its fastest corner. It may exceed 1 where loads or ties do not count as weight. The motion is the
    nearest one to free motion that the joints allow (Gauss's principle of least constraint). The mass of a block is that of its
    weight and of the dead loads on it. Its moments of inertia are this mass times the square of the mean block size.
    """
    problem = scaled_problem(assembly)
    free_blocks = int(assembly.blocks.free.sum())
    masses = assembly.block_weight[assembly.blocks.free] / assembly.weight * free_blocks  # over the mean mass, so of order one
    programme = Programme(problem.rows, problem.cones, np.repeat(masses, len(problem.power) // free_blocks))
    twists = twists_of(assembly, programme.solve(problem.power * free_blocks, np.zeros(problem.rows.shape[0])).x)
    power = float(np.sum(assembly.dead_load * twists))
    return power / float(assembly.block_weight @ block_speeds(assembly.blocks, twists))
