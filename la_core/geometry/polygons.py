"""Plane polygons in space: overlaps, corners, areas; and groups of rows in flat arrays."""

import numpy as np
import shapely

ROUND_OFF = 1e-9  # of the sum of the perimeters of two polygons


def group_members(counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Group of each member, and its place within the group, for groups of the sizes `counts` (N,) laid end to end."""
    group = np.repeat(np.arange(len(counts)), counts)
    return group, np.arange(len(group)) - np.repeat(np.cumsum(counts) - counts, counts)


def owners(start: np.ndarray) -> np.ndarray:
    """Group (Q,) of each row of a flat array, where group i has the rows start[i]:start[i + 1]."""
    return np.repeat(np.arange(len(start) - 1), np.diff(start))


def next_corners(start: np.ndarray) -> np.ndarray:
    """Row (Q,) of the corner after each corner, where loop i has the rows start[i]:start[i + 1]; its first corner follows its last."""
    loop = owners(start)
    row = np.arange(len(loop))
    return np.where(row == start[1:][loop] - 1, start[loop], row + 1)


def plane_axes(normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit tangents, (N, 3) each, that are right-handed with the unit normals (N, 3).

    For a normal in the xz plane the first tangent lies in that plane and the second along y.
    """
    seed = np.where(np.abs(normal[:, 1:2]) < 0.9, np.array([[0.0, 1.0, 0.0]]), np.array([[0.0, 0.0, 1.0]]))
    first = np.cross(seed, normal)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return first, np.cross(normal, first)


def polygons_of(flat: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Polygons (N,) from their corners `flat` (Q, 2), polygon after polygon, with `counts` (N,) corners each."""
    row, place = group_members(counts + 1)  # shapely repeats the first corner at the end
    start = np.cumsum(counts) - counts
    closed = flat[start[row] + place % counts[row]]
    rings = np.concatenate([[0], np.cumsum(counts + 1)])
    return np.asarray(shapely.from_ragged_array(shapely.GeometryType.POLYGON, closed, (rings, np.arange(len(rings)))))


def ring_corners(polygons: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners (Q, 2) of polygons (N,), each once, and the polygon (Q,) of each."""
    flat, row = shapely.get_coordinates(polygons, return_index=True)
    closing = np.append(row[1:] != row[:-1], True) if len(row) else np.zeros(0, dtype=bool)  # shapely repeats the first corner at the end
    return flat[~closing], row[~closing]


def overlap_of(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Intersections (N,) of convex polygons (N,) with convex polygons (N,), also of polygons that meet in an edge within round-off.

    For these, GEOS may return one of the two polygons as a whole, or only points where they share a part of an edge. The areas of its
    answers are therefore compared with those of polygons cut by half-planes, which replace wrong answers.
    """
    found = np.asarray(shapely.intersection(first, second))
    cut = _cut(shapely.convex_hull(first), shapely.convex_hull(second))  # corners of bent faces may lie inside the face by round-off
    size = shapely.length(first) + shapely.length(second)
    moved = ROUND_OFF * size * (shapely.length(found) + shapely.length(cut))  # area that round-off of the corners may change
    is_polygon = shapely.get_type_id(found) == shapely.GeometryType.POLYGON
    wrong = np.abs(np.where(is_polygon, shapely.area(found), 0.0) - shapely.area(cut)) > moved
    return np.where(wrong, cut, found)


def _cut(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Convex polygons (N,) cut by the half-planes of the edges of convex polygons (N,), edge by edge for all at once.

    Sutherland and Hodgman, Reentrant polygon clipping (Communications of the ACM 17, 1974).
    """
    flat, row, _ = _counterclockwise(first)
    corners, _, start = _counterclockwise(second)
    counts, done = np.diff(start), []
    for k in range(counts.max(initial=0)):
        left = k < counts[row]  # polygons whose second polygon has no further edge are finished
        done.append((flat[~left], row[~left]))
        flat, row = flat[left], row[left]
        tail, head = corners[start[row] + k], corners[start[row] + (k + 1) % counts[row]]
        edge, arm = head - tail, flat - tail
        height = edge[:, 0] * arm[:, 1] - edge[:, 1] * arm[:, 0]
        after, inside = _ring_neighbours(row)[1], height >= 0.0
        crosses, kept = np.flatnonzero(inside != inside[after]), np.flatnonzero(inside)
        share = height[crosses] / (height[crosses] - height[after[crosses]])
        met = flat[crosses] + share[:, None] * (flat[after[crosses]] - flat[crosses])
        order = np.argsort(np.concatenate([2 * kept, 2 * crosses + 1]), kind="stable")
        flat, row = np.concatenate([flat[kept], met])[order], np.concatenate([row[kept], row[crosses]])[order]
    flat, row = (np.concatenate(some) for some in zip(*done, (flat, row), strict=True))
    order = np.argsort(row, kind="stable")
    flat, row = flat[order], row[order]
    sizes = np.bincount(row, minlength=len(first))
    cut = np.full(len(first), shapely.Polygon())
    some = (sizes >= 3) & (counts >= 3)
    cut[some] = polygons_of(flat[some[row]], sizes[some])
    return cut


def _counterclockwise(polygons: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Corners (Q, 2) of polygons (N,) counterclockwise, the polygon (Q,) of each corner, and the first corner of each polygon (N + 1,)."""
    turned = shapely.is_ccw(shapely.get_exterior_ring(polygons))
    flat, row = ring_corners(np.where(turned, polygons, shapely.reverse(polygons)))
    return flat, row, np.concatenate([[0], np.cumsum(np.bincount(row, minlength=len(polygons)))])


def true_corners(polygons: np.ndarray, tolerance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """True corners (Q, 2) of convex polygons (N,), and the polygon (Q,) of each corner.

    Repeated vertices, and vertices on a straight edge, are dropped; `tolerance` (N,) is a distance in m.
    """
    flat, owner = ring_corners(polygons)
    before, _ = _ring_neighbours(owner)
    doubled = np.linalg.norm(flat - flat[before], axis=1) <= tolerance[owner]
    flat, owner = flat[~doubled], owner[~doubled]
    before, after = _ring_neighbours(owner)
    chord, arm = flat[after] - flat[before], flat - flat[before]
    height = np.abs(chord[:, 0] * arm[:, 1] - chord[:, 1] * arm[:, 0])
    straight = height <= tolerance[owner] * np.linalg.norm(chord, axis=1)
    straight &= (np.bincount(owner[~straight], minlength=len(polygons)) >= 3)[owner]  # all corners of a circle of thousands look straight
    return flat[~straight], owner[~straight]


def _ring_neighbours(owner: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Indices of the vertex before and after each vertex of its ring; `owner` (Q,) is sorted."""
    _, ring, count = np.unique(owner, return_inverse=True, return_counts=True)
    start, place = (np.cumsum(count) - count)[ring], group_members(count)[1]
    return start + (place - 1) % count[ring], start + (place + 1) % count[ring]


def polygon_areas(corners: np.ndarray, start: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Areas (I,) of plane polygons in space, m2, by the shoelace formula about their first corner.

    Parameters
    ----------
    corners : (Q, 3) array
        Corners, polygon after polygon, m.
    start : (I + 1,) array of int
        Polygon i has corners[start[i]:start[i + 1]].
    normal : (I, 3) array
        Unit normal of each polygon.
    """
    ring = owners(start)
    arm = corners - corners[start[ring]]
    doubled = np.zeros((len(normal), 3))
    np.add.at(doubled, ring, np.cross(arm, arm[next_corners(start)]))
    return np.abs(np.sum(doubled * normal, axis=1)) / 2.0
