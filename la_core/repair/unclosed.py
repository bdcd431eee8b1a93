"""Places that a repair leaves open: faces that stay apart, and joints that lost more area than the errors of their edges explain."""

from collections.abc import Iterator, Sequence

import numpy as np

from la_core.geometry import Blocks, joint_areas, next_corners, owners
from la_core.repair.facing import Facing, facing_faces
from la_core.repair.repairs import Unclosed

WIDER = 1.5  # over the greatest distance at which faces are brought together: a gap that is only a little wider is seldom meant


def unclosed(
    names: Sequence[str], parts: Blocks, owner: np.ndarray, pairs: Facing, is_open: np.ndarray, tolerance: float
) -> list[Unclosed]:
    """Open pairs of faces of different blocks whose joint would be wider than twice the tolerance (m), the widest gap first.

    pairs: L pairs of faces. is_open: mask (L,) of the pairs that stay open.
    """
    widest = pairs.widest
    blocks = owner[parts.face_block[pairs.face_a]], owner[parts.face_block[pairs.face_b]]
    open_pairs = np.flatnonzero(is_open & (_widths(pairs) > 2.0 * tolerance) & (blocks[0] != blocks[1]))
    order = open_pairs[np.argsort(-np.abs(pairs.gap[widest[open_pairs]]), kind="stable")]
    return [
        Unclosed(
            (names[blocks[0][k]], names[blocks[1][k]]),
            tuple(float(value) for value in pairs.middle[widest[k]]),  # type: ignore[arg-type]
            float(pairs.gap[widest[k]]),
        )
        for k in order
    ]


def lost_joints(
    names: Sequence[str], parts: Blocks, owner: np.ndarray, reach: np.ndarray, left: Blocks, tolerance: float
) -> Iterator[Unclosed]:
    """Yield once each pair of blocks whose faces lay opposite each other, but share much less area after the repair.

    The cut of a corner may continue through the joint beside it, or faces may lie a little too far apart to be brought together. Errors of
    the edges of a joint remove at most a strip along the edges that is as wide as the reach.

    Parameters
    ----------
    names : sequence of str
        Names of the blocks.
    parts, owner : Blocks and (P,) array of int
        Convex parts as drawn, and the block of each.
    reach : (P,) array
        Greatest distance at which faces of each part are brought together, m.
    left : Blocks
        The blocks after the repair.
    tolerance : float
        Largest error of the coordinates, m.
    """
    pairs = facing_faces(parts, owner, WIDER * reach)
    if not len(pairs):
        return
    number = _numbers(owner[parts.face_block[np.stack([pairs.face_a, pairs.face_b], axis=1)]], len(names))
    both, row = np.unique(number, return_inverse=True)
    strip = reach.max() * np.bincount(row, _perimeters(pairs))
    blocks, area = joint_areas(left)
    kept = np.zeros(len(both))
    place = np.searchsorted(both, _numbers(blocks, len(names))).clip(max=len(both) - 1)
    is_same = both[place] == _numbers(blocks, len(names))
    np.add.at(kept, place[is_same], area[is_same])
    is_lost = np.bincount(row, pairs.area) - kept > strip
    told: set[frozenset[str]] = set()
    for one in unclosed(names, parts, owner, pairs, is_lost[row], tolerance):
        if frozenset(one.blocks) not in told:
            told.add(frozenset(one.blocks))
            yield one


def _perimeters(pairs: Facing) -> np.ndarray:
    """Length (L,) of the outline of the polygon in which the faces of each pair overlap, m."""
    sides = np.linalg.norm(pairs.middle[next_corners(pairs.start)] - pairs.middle, axis=1)
    return np.bincount(owners(pairs.start), sides, minlength=len(pairs))


def _widths(pairs: Facing) -> np.ndarray:
    """Width (L,), m, of the polygon of `_perimeters` in any direction: the shorter side of the rectangle with this area and perimeter."""
    quarter = _perimeters(pairs) / 4.0
    return np.asarray(quarter - np.sqrt(np.maximum(quarter**2 - pairs.area, 0.0)))


def _numbers(blocks: np.ndarray, count: int) -> np.ndarray:
    """One number for each pair (N, 2) of `count` blocks, in either order."""
    return np.asarray(np.sort(blocks, axis=1) @ np.array([count, 1]))
