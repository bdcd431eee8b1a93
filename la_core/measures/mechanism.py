"""Measures of a mechanism: moving blocks, sliding joints, and the similarity of two mechanisms."""

import numpy as np

from la_core.geometry import Blocks
from la_core.model import Assembly

MOVING_SHARE = 0.05  # of `fastest_speed`: slower blocks count as at rest; elastic strain is far below this
LEAST_EXCHANGE = 1e-6  # of the weight at the fastest speed: a mechanism with less power has rounding errors only


def point_velocity(blocks: Blocks, twists: np.ndarray, position: np.ndarray, block: np.ndarray) -> np.ndarray:
    """Velocity (N, 3) of material points of blocks.

    Parameters
    ----------
    blocks : Blocks
        B blocks.
    twists : (B, 6) array
        Their twists about the centroids.
    position : (N, 3) array
        Positions of the points, m.
    block : (N,) array of int
        Block of each point.
    """
    return twists[block, :3] + np.cross(twists[block, 3:], position - blocks.centroid[block])


def contact_speeds(assembly: Assembly, twists: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Parting speed (C,), positive where a joint opens, and sliding speed (C,) at the contact points for twists (B, 6)."""
    parting, sliding = assembly.split(assembly.relative_velocity(twists))
    return parting, np.linalg.norm(sliding, axis=1)


def block_speeds(blocks: Blocks, twists: np.ndarray) -> np.ndarray:
    """Largest speed (B,) over the vertices of each block, for twists (B, 6) about the centroids; in the twists' unit."""
    velocity = point_velocity(blocks, twists, blocks.vertices, blocks.vertex_block)
    return np.maximum.reduceat(np.linalg.norm(velocity, axis=1), blocks.vertex_start[:-1])


def corner_speeds(blocks: Blocks, twists: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Largest velocity (B,) along a unit vector over the vertices of each block, for twists (B, 6); in the twists' unit."""
    along = point_velocity(blocks, twists, blocks.vertices, blocks.vertex_block) @ direction
    return np.maximum.reduceat(along, blocks.vertex_start[:-1])


def fastest_speed(assembly: Assembly, twists: np.ndarray) -> float:
    """Largest speed over the vertices of the free blocks and the contact points of the supports, for twists (B, 6), in their unit.

    Supports count, because all other speeds are noise where a support moves away alone. Only their contact points count, because a strip of
    ground that turns may reach far beyond the structure.
    """
    blocks = assembly.blocks
    at_contacts = np.linalg.norm(assembly.relative_velocity(np.where(blocks.free[:, None], 0.0, twists)), axis=1)
    return float(np.concatenate([block_speeds(blocks, twists)[blocks.free], at_contacts]).max(initial=0.0))


def moving(assembly: Assembly, twists: np.ndarray) -> np.ndarray:
    """Mask (B,) of the free blocks that move in a mechanism with twists (B, 6)."""
    return assembly.blocks.free & (block_speeds(assembly.blocks, twists) > MOVING_SHARE * fastest_speed(assembly, twists))


def moving_mass_share(assembly: Assembly, twists: np.ndarray) -> float:
    """Mass of the moving blocks over that of all free blocks of the scene."""
    return float(assembly.blocks.mass[moving(assembly, twists)].sum() / assembly.movable_mass)


def similarity(blocks: Blocks, first: np.ndarray, second: np.ndarray) -> float:
    """Similarity of two mechanisms: the mass-weighted modal assurance criterion (a'Mb)^2 / ((a'Ma)(b'Mb)).

    a and b are the twists of the free blocks, and M = diag(m, m, m, I) holds their masses and inertias. The result is
    1 for mechanisms that differ by a factor, 0 for orthogonal ones, and NaN where one of them is at rest.

    Parameters
    ----------
    blocks : Blocks
        B blocks with mass and inertia.
    first, second : (B, 6) arrays
        Twists of the two mechanisms.

    References
    ----------
    R. J. Allemang, D. L. Brown, A correlation coefficient for modal vector analysis, Proc. 1st International Modal
    Analysis Conference, 1982, 110-116.
    """
    free = blocks.free
    mass, inertia = blocks.mass[free], blocks.inertia[free]

    def product(a: np.ndarray, b: np.ndarray) -> float:
        translation = np.sum(mass[:, None] * a[free, :3] * b[free, :3])
        rotation = np.einsum("bi,bij,bj->", a[free, 3:], inertia, b[free, 3:])
        return float(translation + rotation)

    norms = product(first, first) * product(second, second)
    return product(first, second) ** 2 / norms if norms > 0.0 else float("nan")


def friction_power(assembly: Assembly, twists: np.ndarray, forces: np.ndarray) -> float:
    """Power of friction, sum of mu n |u_t|, of contact forces (C, 3), N, in a mechanism with twists (B, 6); 0 if no loaded joint slides."""
    _, sliding = contact_speeds(assembly, twists)
    compression = np.maximum(assembly.split(forces)[0], 0.0)
    return float(np.sum(assembly.points.friction * compression * sliding))


def sliding_share(assembly: Assembly, twists: np.ndarray, forces: np.ndarray) -> float:
    """Power of friction over the power that the weights exchange, sum of |w . v|.

    It is 0 where no loaded joint slides. Dilatancy then has no effect, and the associated answer is also Coulomb's.
    If the weights of a mechanism exchange less than LEAST_EXCHANGE, this limit replaces their power. Otherwise the share of
    a motion without power would be a ratio of rounding errors.
    twists (B, 6) and forces (C, 3), N: the mechanism and its contact forces.
    """
    exchanged = np.abs(np.sum(assembly.dead_load * twists, axis=1)).sum()
    exchanged = max(exchanged, LEAST_EXCHANGE * assembly.weight * fastest_speed(assembly, twists))
    if exchanged == 0.0:
        return 0.0
    return friction_power(assembly, twists, forces) / exchanged
