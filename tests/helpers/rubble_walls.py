"""Rubble walls whose shortest joints shrink: stones are about 1 m long, joints 1 m down to less than 1 mm."""

from itertools import pairwise
from typing import Any

import numpy as np
import scenes

from la_core.scene import Scene

Corner = tuple[float, float]  # x and z, m

SIZE, DEPTH, STONES, SETTLING = (5.0, 3.0), 0.5, 14, 3.1  # m
SHRUNK = 3  # number of joints that shrink
INSET = 0.001  # m
DROPPED = 0.00048  # m, less than half the inset


def profiles(seed: int) -> list[list[Corner]]:
    """Return the corners of the stones of a rubble wall. A shared corner has equal coordinates in each stone."""
    table = scenes.table("[rubble]", origin=(0.0, 0.0, 0.0), size=SIZE, depth=DEPTH, stones=STONES, seed=seed)
    blocks = scenes.build(*scenes.base(SETTLING, SIZE[0], DEPTH), table).blocks
    spans = [blocks.vertices[slice(*blocks.vertex_start[k : k + 2])] for k in np.flatnonzero(blocks.free)]
    fronts = [vertices[: len(vertices) // 2, [0, 2]] for vertices in spans]  # a prism has its front corners first
    return [[(float(x), float(z)) for x, z in np.round(front, 9)] for front in fronts]


def inner_joints(stones: list[list[Corner]]) -> list[tuple[float, Corner, Corner]]:
    """Return length and ends of every joint whose ends both lie inside the wall, shortest first."""
    edges = {tuple(sorted(edge)) for stone in stones for edge in pairwise([*stone, stone[0]])}
    inside = [(a, b) for a, b in edges if all(0.0 < p < most for end in (a, b) for p, most in zip(end, SIZE, strict=True))]
    return sorted((float(np.hypot(b[0] - a[0], b[1] - a[1])), a, b) for a, b in inside)


def shrunk(stones: list[list[Corner]], length: float) -> list[list[Corner]]:
    """Return the stones with their shortest joints shrunk about their middles to `length`, m."""
    moved: dict[Corner, Corner] = {}
    for now, *ends in inner_joints(stones):
        if len(moved) < 2 * SHRUNK and not moved.keys() & set(ends):
            middle = np.mean(ends, axis=0)
            for end in ends:
                x, z = middle + (np.array(end) - middle) * length / now
                moved[end] = (float(x), float(z))
    assert len(moved) == 2 * SHRUNK
    return [[moved.get(corner, corner) for corner in stone] for stone in stones]


def wall(stones: list[list[Corner]], tolerance: float = 0.0, **options: Any) -> Scene:
    """Build the stones on a base whose right part settles. tolerance: joints shorter than twice this length are dropped, m."""
    blocks = [scenes.block(f"stone {k}", prism=(stone, (0.0, DEPTH))) for k, stone in enumerate(stones)]
    geometry = [scenes.table("geometry", tolerance=tolerance)] if tolerance else []
    return scenes.build(*scenes.base(SETTLING, SIZE[0], DEPTH), *blocks, *geometry, inset=INSET, **options)
