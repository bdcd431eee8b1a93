"""The upper faces of blocks in plan, and the share of a load on each face."""

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.sparse.csgraph import connected_components

from la_core.geometry import Blocks, face_corners, face_polygons, near_parts, opposite_faces, overlap_of, plane_axes, polygons_of

UPWARD = 0.1  # least z of the normal of a top face; the extrados of an arch carries its fill down to steep flanks
STEEPEST = 1e-3  # least z of the normal of a flank that replaces a top face, as at the foot of a semicircular arch of 1,500 voussoirs
COVERED = 0.9  # of the area of a face: a face that other blocks cover to at least this share is a joint
OPPOSITE, NEAR = 1e-2, 1e-3  # rad, and of the size of a block: greatest angle and gap between faces of a joint, for typed coordinates
ROUND_OFF = 1e-9  # of the extent of the faces: lines this close to an edge lie on it
LAST_DIGITS = 1e-14  # of the largest coordinate: round-off of double precision after a few operations
SHORTEST = 4.0  # times round-off: a shorter stretch of a line does not count
COUNTED_TWICE = 1e-6  # of the whole loaded area or length: a larger overlap in plan is more than round-off


@dataclass(frozen=True)
class Carried:
    """Shares of a load on N faces.

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
    """Shares of a load on the top faces of blocks, for a load along a line or on the whole area of the faces.

    Parameters
    ----------
    blocks : Blocks
        Blocks of the scene.
    chosen : (B,) array of bool
        Loaded blocks.
    line : two points (x, y), or None
        Line of the load in plan, m; None for the whole area.
    """
    face, seen, origin, grid = _seen_faces(blocks, chosen)
    rows = _carrying_rows(blocks, face, seen, origin, grid, chosen)
    face, plan = face[rows], seen[rows]
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
    point = np.column_stack([middle, _height(blocks, face, middle)])
    return Carried(blocks.face_block[face], point, share, twice > COUNTED_TWICE * whole)


def _stretches(plan: np.ndarray, block: np.ndarray, line: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Stretches of a line (2, 2) over polygons (N,) of blocks (N,), and the length of the line that counts more than once, m.

    Returns the polygon of each stretch and the distances of both its ends from the start of the line. A line lies over a polygon up to
    `reach` (m) beside it, as along its edge. A stretch over two faces of one block, as along a ridge, counts on one of them.
    """
    start, length = line[0], float(np.linalg.norm(line[1] - line[0]))
    over = shapely.intersection(shapely.buffer(plan, reach, join_style="mitre"), shapely.LineString(line))
    pieces, row = shapely.get_parts(np.atleast_1d(over), return_index=True)
    kept = shapely.length(pieces) > SHORTEST * reach  # a shorter piece is a corner that the line touches
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
    crossed = (shared > 0.0) & (shared <= SHORTEST * reach)  # strips at joints: they would count twice, and add up
    low[every[crossed]] = reached[crossed]
    return row, low, high, float(shared[shared > SHORTEST * reach].sum())


def _reached(high: np.ndarray, group: np.ndarray, length: float) -> np.ndarray:
    """Farthest end of the stretches before each one (N,) in its group, m; negative for the first one of a group.

    high: ends of the stretches, at most `length`, m; the stretches are in the order of their groups (N,), and of their starts.
    """
    shift = 2.0 * length * np.unique(group, return_inverse=True)[1]
    return np.concatenate([[-np.inf], np.maximum.accumulate(high + shift)[:-1]])[: len(high)] - shift


def _seen_faces(blocks: Blocks, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """The upward faces (N,) of the chosen blocks (B,) that are visible from above, and the visible part of each.

    Returns the faces, their visible parts as polygons (N,), the origin (2,) of the polygons, m, and the length of round-off, m. A compound
    block has upward faces within it, on the cuts between its convex parts. A cut lies under the top of a part, which may be a steep face.
    So every upward face of a compound block hides what lies under it. Its steep faces then carry nothing.
    """
    rise = np.where(chosen[blocks.face_block], blocks.face_normal[:, 2], 0.0)
    face = np.flatnonzero(rise > np.where(blocks.is_compound[blocks.face_block], ROUND_OFF, STEEPEST))
    plan, origin, grid = _in_plan(blocks, face)
    seen = _uncovered(blocks, face, plan, origin, grid)
    is_seen = shapely.area(seen) > SHORTEST * grid * shapely.length(seen)
    is_seen &= (rise[face] > UPWARD) | ~blocks.is_compound[blocks.face_block[face]]
    return face[is_seen], seen[is_seen], origin, grid


def _carrying_rows(blocks: Blocks, face: np.ndarray, seen: np.ndarray, origin: np.ndarray, grid: float, chosen: np.ndarray) -> np.ndarray:
    """Rows of the faces (N,) that carry the loads of their blocks. seen, origin and grid: see `_seen_faces`.

    The top faces of a block carry its loads. Where a block has an open top face, its top faces under other blocks carry nothing. So a
    voussoir of an arch carries its fill on its outer face, and not on the joint with its neighbour, which faces up as well. The blocks
    of a course carry a floor on their only top face, under the course above.

    The lowest voussoir of an arch has a joint with the next voussoir, and an outer face that is too steep for a top face. Where both
    voussoirs carry the fill, the fill lies on their outer faces: open steep faces replace the joint between two chosen blocks.
    """
    owner, is_top = blocks.face_block[face], blocks.face_normal[face, 2] > UPWARD
    if is_top.all() and not (np.bincount(owner, minlength=len(blocks)) > 1).any():
        return np.arange(len(face))
    covered, covered_by_chosen = _covered(blocks, face, seen, origin, grid, chosen)
    is_open = covered < COVERED
    carries = is_top & (is_open | ~_some(owner[is_top & is_open], len(blocks))[owner])
    flank = ~is_top & is_open
    is_replaced = _some(owner[flank], len(blocks)) & ~_some(owner[carries & (covered_by_chosen < COVERED)], len(blocks))
    return np.flatnonzero(np.where(is_replaced[owner], flank, carries))


def _some(owner: np.ndarray, count: int) -> np.ndarray:
    """Mask (count,) of the blocks that own at least one of N faces. owner: block of each face (N,)."""
    return np.bincount(owner, minlength=count) > 0


def _covered(
    blocks: Blocks, face: np.ndarray, seen: np.ndarray, origin: np.ndarray, grid: float, chosen: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Covered shares (N,) of the visible parts of faces (N,): under any other blocks, and under other chosen blocks (B,).

    The pieces of a face that is cut into convex parts have the share of the whole face. seen, origin and grid: see `_seen_faces`.
    """
    parts = blocks.parts
    size, pairs = near_parts(blocks, NEAR)
    both = np.concatenate([pairs, pairs[:, ::-1]])
    _, below, above = opposite_faces(parts, both, NEAR * size[both].min(axis=1), size, OPPOSITE)
    kept = np.isin(below, face)
    below, above = below[kept], above[kept]
    overlap = overlap_of(face_polygons(parts, below, below), face_polygons(parts, above, below))
    row, area = np.searchsorted(face, below), shapely.area(overlap) * blocks.face_normal[below, 2]
    cut = blocks.is_compound[blocks.face_block[below]]
    area[cut] = shapely.area(shapely.intersection(_lowered(blocks, overlap[cut], below[cut], origin), seen[row[cut]], grid_size=grid))
    whole = _whole_faces(blocks, face, seen, grid)
    total = np.bincount(whole, shapely.area(seen), len(face))
    by_all, by_chosen = (np.bincount(whole[row], area * counts, len(face)) for counts in (1.0, chosen[blocks.face_block[above]]))
    return by_all[whole] / total[whole], by_chosen[whole] / total[whole]


def _lowered(blocks: Blocks, polygons: np.ndarray, plane: np.ndarray, origin: np.ndarray) -> np.ndarray:
    """Polygons (N,) from `face_polygons` in the planes of upward faces (N,), projected into plan, with `origin` (2,) as their origin, m."""
    first, second = plane_axes(blocks.face_normal[plane])
    corner = blocks.vertices[blocks.face_vertex[blocks.face_start[plane]]]
    flat, row = shapely.get_coordinates(polygons, return_index=True)
    plan = corner[row, :2] - origin + flat[:, :1] * first[row, :2] + flat[:, 1:] * second[row, :2]
    return np.asarray(shapely.set_coordinates(polygons.copy(), plan))


def _whole_faces(blocks: Blocks, face: np.ndarray, seen: np.ndarray, grid: float) -> np.ndarray:
    """Number (N,) of the whole face of each upward face (N,). Faces of one block in one plane that share an edge form one whole face.

    seen: visible parts of the faces, polygons (N,). grid: length of round-off, m.
    """
    whole, owner = np.arange(len(face)), blocks.face_block[face]
    for block in np.flatnonzero(blocks.is_compound):
        own = np.flatnonzero(owner == block)
        normal, reach = blocks.face_normal[face[own]], NEAR * float(np.linalg.norm(blocks.high[block] - blocks.low[block]))
        corner = blocks.vertices[blocks.face_vertex[blocks.face_start[face[own]]]]
        height = np.abs(np.einsum("ik,ijk->ij", normal, corner[None, :] - corner[:, None]))  # of a corner of each face above each plane
        alike = np.linalg.norm(normal[:, None] - normal[None, :], axis=2) <= OPPOSITE
        first, second = np.nonzero(alike & (np.maximum(height, height.T) <= reach))
        edge = shapely.length(shapely.intersection(seen[own[first]], seen[own[second]], grid_size=grid))
        meet = np.zeros(alike.shape, dtype=bool)
        meet[first, second] = edge > SHORTEST * grid
        whole[own] = own[connected_components(meet, directed=False)[1]]
    return whole


def _in_plan(blocks: Blocks, face: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Polygons (N,) of the faces (N,) in plan, the origin (2,) of the polygons, m, and the length of round-off, m.

    The origin is the middle of the faces, so that results do not depend on the origin of the scene. GEOS is robust on a grid of the
    length of round-off.
    """
    if not len(face):
        return np.zeros(0, dtype=object), np.zeros(2), ROUND_OFF
    corners = face_corners(blocks, face)[1][:, :2]
    low, high = corners.min(axis=0), corners.max(axis=0)
    origin = 0.5 * (low + high)
    grid = max(ROUND_OFF * float((high - low).max()), LAST_DIGITS * float(np.abs(corners).max()))
    plan = polygons_of(corners - origin, np.diff(blocks.face_start)[face])
    for row in np.flatnonzero(~shapely.is_valid(plan)):  # a steep face of rounded corners may cross itself
        plan[row] = _areas(shapely.make_valid(plan[row]))
    return plan, origin, grid


def _uncovered(blocks: Blocks, face: np.ndarray, plan: np.ndarray, origin: np.ndarray, grid: float) -> np.ndarray:
    """The polygons (N,) of faces (N,) without their parts under a higher face of the same block; only compound blocks have such parts.

    Two convex parts of a block do not overlap. Where both lie over one region in plan, the same part is the upper one everywhere in it, so
    one point of the region tells which.
    """
    uncovered, owner = plan.copy(), blocks.face_block[face]
    for block in np.flatnonzero(blocks.is_compound):
        own = np.flatnonzero(owner == block)
        first, second = own[shapely.STRtree(plan[own]).query(plan[own])]
        common = shapely.intersection(plan[first], plan[second], grid_size=grid)
        kept = (first != second) & (shapely.area(common) > SHORTEST * grid * shapely.length(common))
        first, second, common = first[kept], second[kept], common[kept]
        middle = origin + shapely.get_coordinates(shapely.centroid(common)).reshape(-1, 2)
        is_under = _height(blocks, face[first], middle) < _height(blocks, face[second], middle)
        for under in np.unique(first[is_under]):
            above = shapely.union_all(plan[second[is_under & (first == under)]], grid_size=grid)
            uncovered[under] = _areas(shapely.difference(plan[under], above, grid_size=grid))
    return uncovered


def _areas(shape: shapely.Geometry) -> shapely.Geometry:
    """The polygons of a shape, without the lines and points that an operation on a grid leaves beside them."""
    pieces = shapely.get_parts(shapely.get_parts(shape))  # also those of a multipolygon in a collection
    return shapely.multipolygons(pieces[shapely.get_type_id(pieces) == shapely.GeometryType.POLYGON])


def _height(blocks: Blocks, face: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Height (N,) of the planes of upward faces (N,) at points (N, 2) in plan, m."""
    normal = blocks.face_normal[face]
    return (blocks.face_offset[face] - np.sum(normal[:, :2] * point, axis=1)) / normal[:, 2]
