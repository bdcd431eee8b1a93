"""The order in which the blocks of a scene in space are drawn.

Convex blocks that touch each other hide each other in a known order; they are drawn back to front in that order. Mplot3d sorts
single faces by their mean depth instead, and draws a long foundation over the short blocks on it.
"""

import heapq

import numpy as np

from la_core.geometry import Blocks
from la_core.model import Assembly

NEAR = 1e-4  # of the largest extent of a block: boxes that are nearer than this touch
AT_A_TIME = 500  # blocks that are held against all others in one array


def back_to_front(assembly: Assembly, toward: np.ndarray) -> np.ndarray:
    """Return the blocks (B,) in drawing order, for a unit vector (3,) `toward` the viewer.

    Of two blocks that touch, the one on the viewer's side comes later. Other blocks are ordered by depth, the farthest first.
    """
    interfaces = assembly.interfaces
    a, b = _touching(assembly.blocks, np.flatnonzero(assembly.aside), toward)
    facing = interfaces.normal @ toward > 0.0
    behind = np.concatenate([np.where(facing, interfaces.block_a, interfaces.block_b), a])
    before = np.concatenate([np.where(facing, interfaces.block_b, interfaces.block_a), b])
    depth = assembly.blocks.centroid @ toward
    waiting = np.bincount(before, minlength=len(depth))
    hides: list[list[int]] = [[] for _ in depth]
    for back, front in zip(behind, before, strict=True):
        hides[back].append(int(front))
    # No order is right where blocks interlock in a ring: the block that waits for the fewest others goes first, the farthest of these.
    queue = [(int(waiting[k]), float(depth[k]), k) for k in range(len(depth))]
    heapq.heapify(queue)
    order: list[int] = []
    drawn = np.zeros(len(depth), dtype=bool)
    while queue:
        count, _, block = heapq.heappop(queue)
        if drawn[block] or count != waiting[block]:
            continue
        drawn[block] = True
        order.append(block)
        for other in hides[block]:
            waiting[other] -= 1
            heapq.heappush(queue, (int(waiting[other]), float(depth[other]), other))
    return np.array(order)


def _touching(blocks: Blocks, aside: np.ndarray, toward: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return pairs of blocks, the one behind and the one before it, of which at least one was set aside.

    A model has no interfaces of blocks that it sets aside. Their bounding boxes tell the order where they touch.
    """
    near = NEAR * float((blocks.high - blocks.low).max())
    behind, before = [np.zeros(0, dtype=int)], [np.zeros(0, dtype=int)]
    for some in np.array_split(aside, len(aside) // AT_A_TIME + 1):
        low, high = blocks.low[some, None], blocks.high[some, None]
        laps = np.minimum(high, blocks.high) - np.maximum(low, blocks.low)  # (some, B, 3): extents that two boxes share
        for axis in range(3):
            beside = (laps[:, :, [k for k in range(3) if k != axis]] > near).all(axis=2) & (np.abs(laps[:, :, axis]) <= near)
            one, other = np.nonzero(beside)
            after = (blocks.centroid[other, axis] - blocks.centroid[some[one], axis]) * toward[axis] > 0.0
            behind.append(np.where(after, some[one], other))
            before.append(np.where(after, other, some[one]))
    pairs = np.unique(np.stack([np.concatenate(behind), np.concatenate(before)], axis=1), axis=0)  # each pair once
    return pairs[:, 0], pairs[:, 1]
