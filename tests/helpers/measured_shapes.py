"""Measures of shapes: volume, area of the faces without a joint, and reaction on a support."""

from itertools import pairwise

import numpy as np

from la_core.geometry.interfaces import find_interfaces
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble
from la_core.scene.scene import Scene

ROUND_OFF = 1e-9  # relative, of a length, an area or a volume
EXACT = 1e-6  # share of the weight: residuals up to 1e-6 of a block's weight are accepted
DEPTH = 0.4  # m, of walls
SPREADS = (1.0, 0.0, 0.0)


def free_volume(scene: Scene) -> float:
    return float(scene.blocks.volume[scene.blocks.free].sum())


def exposed(scene: Scene) -> float:
    """Return the area of the free blocks' faces without joints, m2. A joint covers its area on each free block that it connects."""
    blocks, joints = scene.blocks, find_interfaces(scene.blocks)
    total = 0.0
    for face, block in enumerate(blocks.face_block):
        corners = blocks.vertices[blocks.face_vertex[blocks.face_start[face] : blocks.face_start[face + 1]]]
        arms = corners[1:] - corners[0]
        area = np.linalg.norm(np.sum([np.cross(a, b) for a, b in pairwise(arms)], axis=0)) / 2.0
        total += area if blocks.free[block] else 0.0
    sides = blocks.free[joints.block_a].astype(int) + blocks.free[joints.block_b]
    return float(total - np.sum(sides * joints.area))


def reaction(scene: Scene, drive: Drive = Drive.YIELDING) -> float:
    solution = solve_associated(assemble(scene), drive)
    assert solution.status is Status.SOLVED
    return solution.value / scene.weight


def upright(area: float, edges: float, depth: float = DEPTH) -> tuple[float, float]:
    """Return volume and exposed surface of a wall. area: of its face; edges: length of its free edges, without its foot."""
    return area * depth, 2.0 * area + edges * depth
