"""The upper faces of blocks in plan, and the parts of loads that each of them carries."""

from dataclasses import dataclass

import numpy as np
import shapely

from la_core.geometry import Blocks, face_corners, face_polygons, near_parts, opposite_faces, overlap_of, polygons_of

UPWARD = 0.1  # z of a normal from which on a face is a top face; the extrados of an arch carries its fill down to steep flanks
STEEPEST = 1e-3  # the same of the flank of a block that has no other open top face: the lowest voussoir of a semicircular arch of 1,500
COVERED = 0.9  # of its area: a face that other blocks cover so far is a joint
OPPOSITE, NEAR = 1e-2, 1e-3  # rad, and of the size of a block: faces of a joint, with the errors of typed coordinates
ROUND_OFF = 1e-9  # of the extent of the faces: lines this close to an edge lie on it
LAST_DIGITS = 1e-14  # of the largest coordinate: what double precision leaves of it, after a few operations
SHORTEST = 4.0  # times round-off: a shorter stretch of a line does not count
COUNTED_TWICE = 1e-6  # of the whole: overlap in plan that is more than round-off


@dataclass(frozen=True)
class Carried:
    """What N faces carry of a load.

    Attributes
    ----------
    block : (N,) array of int
        Block of each face.
    point : (N, 3) array
        Middle of the loaded part of the face, m.
    share : (N,) array
        Loaded length, m, or area in plan, m2.
    overlaps : bool
        Whether loaded parts lie above each other in plan, so that the load would count more than once.
    """

    block: np.ndarray
    point: np.ndarray
    share: np.ndarray
    overlaps: bool


def carried(blocks: Blocks, chosen: np.ndarray, line: tuple[tuple[float, float], tuple[float, float]] | None) -> Carried:
    """What the top faces of blocks carry of a load along a line, or of one on all their area.

    Parameters
    ----------
    blocks : Blocks
        Blocks of the scene.
    chosen : (B,) array of bool
        Loaded blocks.
    line : two points (x, y), or None
        Line of the load in plan, m; None for the whole area.
    """
    rise = np.where(chosen[blocks.face_block], blocks.face_normal[:, 2], 0.0)
    face = _without_joints(blocks, np.flatnonzero(rise > UPWARD))
    face = _with_flanks(blocks, face, np.flatnonzero((rise > STEEPEST) & (rise <= UPWARD)), chosen)
    plan, origin, grid = _in_plan(blocks, face)
    plan = _uncovered(blocks, face, plan, grid)
    if line is None:
        union = shapely.union_all(plan, grid_size=grid)
        share, whole = shapely.area(plan), float(shapely.area(union))
        twice = float(share.sum()) - whole - grid * float(shapely.length(union))  # the grid moves the edges of the union
        kept = share > 0.0
        face, share = face[kept], share[kept]
        middle = origin + shapely.get_coordinates(shapely.centroid(plan[kept])).reshape(-1, 2)
    else:
        row, low, high, twice = _stretches(plan, blocks.face_block[face], np.array(line) - origin, grid)
        face, share = face[row], high - low
        whole = float(share.sum()) - twice
        start, end = np.array(line)
        middle = start + 0.5 * (low + high)[:, None] * (end - start) / np.linalg.norm(end - start)
    normal, offset = blocks.face_normal[face], blocks.face_offset[face]
    height = (offset - np.sum(normal[:, :2] * middle, axis=1)) / normal[:, 2]
    return Carried(blocks.face_block[face], np.column_stack([middle, height]), share, twice > COUNTED_TWICE * whole)


def _stretches(plan: np.ndarray, block: np.ndarray, line: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Stretches of a line (2, 2) over polygons (N,) of blocks (N,), and the length of the line that counts more than once, m.

    Returns the polygon of each stretch and the distances of both its ends from the start of the line. A line lies over a polygon up to
    `reach` (m) beside it, as along its edge. A stretch over two faces of one block, as along a ridge, counts on one of them.
    """
    start, length = line[0], float(np.linalg.norm(line[1] - line[0]))
    over = shapely.intersection(shapely.buffer(plan, reach, join_style="mitre"), shapely.LineString(line))
    pieces, row = shapely.get_parts(np.atleast_1d(over), return_index=True)
    kept = shapely.length(pieces) > SHORTEST * reach  # less is a corner that the line touches
    pieces, row = pieces[kept], row[kept]
    ends = np.stack([shapely.get_coordinates(shapely.get_point(pieces, end)).reshape(-1, 2) for end in (0, -1)])
    along = np.sort((ends - start) @ (line[1] - start) / length, axis=0)
    order = np.lexsort((along[0], block[row]))
    row, (low, high) = row[order], along[:, order]
    low = np.maximum(low, _reached(high, block[row], length))
    left = high - low > SHORTEST * reach
    row, low, high = row[left], low[left], high[left]
    every = np.argsort(low, kind="stable")
    reached = _reached(high[every], np.zeros(len(low), dtype=int), length)
    shared = np.minimum(high[every], reached) - low[every]
    return row, low, high, float(shared[shared > SHORTEST * reach].sum())  # less is a joint that the line crosses


def _reached(high: np.ndarray, group: np.ndarray, length: float) -> np.ndarray:
    """Farthest end of the stretches before each one (N,) in its group, m; negative for the first one of a group.

    high: ends of the stretches, at most `length`, m; the stretches are in the order of their groups (N,), and of their starts.
    """
    shift = 2.0 * length * np.unique(group, return_inverse=True)[1]
    return np.concatenate([[-np.inf], np.maximum.accumulate(high + shift)[:-1]])[: len(high)] - shift


def _without_joints(blocks: Blocks, face: np.ndarray) -> np.ndarray:
    """The faces (N,) without those that other blocks cover, where their block has an open one, too.

    A voussoir of an arch carries its fill on its outer face, and not on the joint with its neighbour, which faces up as well. The
    blocks of a course carry a floor on their only top face, under the course above.
    """
    owner = blocks.face_block[face]
    if not (np.bincount(owner, minlength=len(blocks)) > 1).any():
        return face
    is_open = _covered(blocks, face) < COVERED
    has_open = np.zeros(len(blocks), dtype=bool)
    has_open[owner[is_open]] = True
    return face[is_open | ~has_open[owner]]


def _with_flanks(blocks: Blocks, face: np.ndarray, steep: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """The top faces (N,), with the open ones of the steep faces (M,) in place of joints between two loaded blocks.

    The lowest voussoir of an arch has a joint with the next one, and an outer face that is too steep for a top face. Where both
    voussoirs carry the fill, it lies on their outer faces.
    """
    if not len(steep):
        return face
    is_joint = _covered(blocks, face, chosen) >= COVERED
    is_whole = ~blocks.is_compound[blocks.face_block[steep]]  # a steep face of a compound block may lie inside of it
    flanks = steep[is_whole & (_covered(blocks, steep) < COVERED)]
    carries, has_flank = (np.zeros(len(blocks), dtype=bool) for _ in range(2))
    carries[blocks.face_block[face[~is_joint]]] = True
    has_flank[blocks.face_block[flanks]] = True
    is_replaced = has_flank & ~carries
    return np.sort(np.concatenate([face[~is_replaced[blocks.face_block[face]]], flanks[is_replaced[blocks.face_block[flanks]]]]))


def _covered(blocks: Blocks, face: np.ndarray, by: np.ndarray | None = None) -> np.ndarray:
    """Share (N,) of each of some faces (N,) that faces of other blocks cover. by: mask (B,) of blocks that count; None for all."""
    parts = blocks.parts
    size, pairs = near_parts(blocks, NEAR)
    both = np.concatenate([pairs, pairs[:, ::-1]])
    _, below, above = opposite_faces(parts, both, NEAR * size[both].min(axis=1), size, OPPOSITE)
    counts = np.isin(below, face) if by is None else np.isin(below, face) & by[blocks.face_block[above]]
    below, above = below[counts], above[counts]
    area = np.zeros(len(parts.face_block))
    np.add.at(area, below, shapely.area(overlap_of(face_polygons(parts, below, below), face_polygons(parts, above, below))))
    return np.asarray(area[face] / shapely.area(face_polygons(parts, face, face)))


def _in_plan(blocks: Blocks, face: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Polygons (N,) of the faces (N,) seen from above, the place (2,) that they are drawn from, m, and the length that is round-off, m.

    They are drawn from their own middle, so that nothing depends on where the scene has its origin. GEOS is sure of what it computes on
    a grid of the length that is round-off.
    """
    if not len(face):
        return np.zeros(0, dtype=object), np.zeros(2), ROUND_OFF
    corners = face_corners(blocks, face)[1][:, :2]
    low, high = corners.min(axis=0), corners.max(axis=0)
    origin = 0.5 * (low + high)
    grid = max(ROUND_OFF * float((high - low).max()), LAST_DIGITS * float(np.abs(corners).max()))
    return polygons_of(corners - origin, np.diff(blocks.face_start)[face]), origin, grid


def _uncovered(blocks: Blocks, face: np.ndarray, plan: np.ndarray, grid: float) -> np.ndarray:
    """The polygons (N,) without what lies under a higher face of the same block: only compound blocks have such parts."""
    uncovered, owner = plan.copy(), blocks.face_block[face]
    for block in np.flatnonzero(blocks.is_compound):
        own = np.flatnonzero(owner == block)
        top = [blocks.vertices[blocks.face_vertex[blocks.face_start[k] : blocks.face_start[k + 1]], 2].max() for k in face[own]]
        above = shapely.Polygon()
        for k in own[np.argsort(top, kind="stable")[::-1]]:
            uncovered[k] = shapely.difference(plan[k], above, grid_size=grid)
            above = shapely.union(above, plan[k], grid_size=grid)
    return uncovered
