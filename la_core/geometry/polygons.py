"""Plane polygons in space: overlaps, corners, areas; and groups of rows in flat arrays."""

import numpy as np
import shapely

ROUND_OFF = 1e-9  # of the length around two polygons


def group_members(counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Group of each member, and its place within the group, for groups of the sizes `counts` (N,) laid end to end."""
    group = np.repeat(np.arange(len(counts)), counts)
    return group, np.arange(len(group)) - np.repeat(np.cumsum(counts) - counts, counts)


def owners(start: np.ndarray) -> np.ndarray:
    """Group (Q,) of each row of a flat array, where group i has the rows start[i]:start[i + 1]."""
    return np.repeat(np.arange(len(start) - 1), np.diff(start))


def next_corners(start: np.ndarray) -> np.ndarray:
    """Row (Q,) of the corner after each corner, where loop i has the rows start[i]:start[i + 1]; its first one follows its last."""
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


def overlap_of(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Intersections (N,) of polygons (N,) with polygons (N,), also where they meet in an edge but for round-off.

    GEOS may then return one of the two polygons whole. Such a result leaves the bounds of the other one, and is
    computed again on a grid.
    """
    found = np.asarray(shapely.intersection(first, second))
    for attempt in range(2):
        size = shapely.length(first) + shapely.length(second)
        bounds = shapely.bounds(found)
        low = np.maximum(shapely.bounds(first), shapely.bounds(second))[:, :2] - ROUND_OFF * size[:, None]
        high = np.minimum(shapely.bounds(first), shapely.bounds(second))[:, 2:] + ROUND_OFF * size[:, None]
        wrong = np.flatnonzero((bounds[:, :2] < low).any(axis=1) | (bounds[:, 2:] > high).any(axis=1))  # false for an empty one
        for k in wrong:
            found[k] = shapely.intersection(first[k], second[k], grid_size=ROUND_OFF * size[k]) if attempt == 0 else shapely.Polygon()
        if not len(wrong):
            break
    return found


def true_corners(polygons: np.ndarray, tolerance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """True corners (Q, 2) of convex polygons (N,), and the polygon (Q,) of each corner.

    Repeated vertices, and vertices on a straight edge, are dropped; `tolerance` (N,) is a distance in m.
    """
    flat, owner = shapely.get_coordinates(polygons, return_index=True)
    closing = np.append(owner[1:] != owner[:-1], True) if len(owner) else np.zeros(0, dtype=bool)
    flat, owner = flat[~closing], owner[~closing]
    before, _ = _ring_neighbours(owner)
    doubled = np.linalg.norm(flat - flat[before], axis=1) <= tolerance[owner]
    flat, owner = flat[~doubled], owner[~doubled]
    before, after = _ring_neighbours(owner)
    chord, arm = flat[after] - flat[before], flat - flat[before]
    height = np.abs(chord[:, 0] * arm[:, 1] - chord[:, 1] * arm[:, 0])
    straight = height <= tolerance[owner] * np.linalg.norm(chord, axis=1)
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
