"""Division of a profile that is not convex into convex parts.

A straight cut leads from a corner that turns inwards to another corner or to an edge. The first corner then turns
inwards on neither side of the cut. The shortest of these cuts is taken. A cut counts half its length if it ends at a second
inward corner and that corner, too, then turns inwards on neither side. Both sides are divided further. Every cut removes
an inward corner and makes none, so the division ends.
"""

import numpy as np

FLATNESS = 1e-9  # of the size: corners closer than this to a line lie on it
AT_CORNER = 1e-6  # of the size: a cut that ends so close to a corner ends there
SHALLOW = 3e-6  # of the size: shallower dents are filled. A neighbour, which touches within 1e-5, would touch the cut behind them, too.
INDIVISIBLE = "the profile cannot be divided into convex parts; correct its corners, or state their error by [geometry] tolerance"
MOST_AT_A_TIME = 1_000_000  # rays times edges that are computed together, to save memory


def convex_parts(profile: np.ndarray) -> list[np.ndarray]:
    """Convex parts (m, 2) of a simple, counter-clockwise profile (n, 2); a convex profile is its own part.

    Shallow dents are filled: a stone drawn to three decimals of a millimetre has such dents where its neighbours meet it. Raises ValueError
    for a profile that cannot be divided.
    """
    left, parts = [profile], []
    while left:
        points = _without_shallow_dents(without_straight_corners(left.pop()))
        inward = np.flatnonzero(_turns(points) < 0.0)
        if not len(inward):
            parts.append(points)
            continue
        sides = [_without_shallow_dents(without_straight_corners(side)) for side in _cut(points, inward)]
        if sum(int(np.sum(_turns(side) < 0.0)) for side in sides) >= len(inward):
            raise ValueError(INDIVISIBLE)
        left += sides
    return parts


def without_straight_corners(points: np.ndarray, flatness: float = FLATNESS) -> np.ndarray:
    """The profile (n, 2) without corners that lie on the line between their neighbours, and without repeated corners.

    flatness: largest distance from the line at which a corner lies on it, over the size of the profile.
    """
    size = np.ptp(points, axis=0).max()
    while len(points) > 2:
        arm_in, arm_out = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
        reach = np.maximum(np.hypot(*arm_in.T), np.hypot(*arm_out.T))
        straight = np.abs(_turns(points)) <= flatness * size * reach
        if not straight.any():
            break
        # One corner is removed at a time, because its neighbours must then be tested again.
        first = int(np.argmax(straight))
        points = np.delete(points, first, axis=0)
    return points


def _without_shallow_dents(points: np.ndarray) -> np.ndarray:
    """The profile (n, 2) without inward corners that lie nearly on an edge between two others; at least four corners are left."""
    count, kept, size = len(points), np.arange(len(points)), np.ptp(points, axis=0).max()
    while len(kept) > 4:
        for corner in np.flatnonzero(_turns(points[kept]) < 0.0).tolist():
            start, end = kept[corner - 1], kept[(corner + 1) % len(kept)]
            edge, filled = points[end] - points[start], np.arange(start + 1, end if end > start else end + count) % count
            arms = points[filled] - points[start]  # also of corners left out before, or a curve would be filled bit by bit
            if np.abs(edge[0] * arms[:, 1] - edge[1] * arms[:, 0]).max() <= SHALLOW * size * np.hypot(*edge):
                kept = np.delete(kept, corner)
                break
        else:
            break
    return points[kept]


def _turns(points: np.ndarray) -> np.ndarray:
    """Cross product (n,) of the edges before and after each corner: negative where the corner turns inwards."""
    arm_in, arm_out = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    return np.asarray(arm_in[:, 0] * arm_out[:, 1] - arm_in[:, 1] * arm_out[:, 0])


def _cut(points: np.ndarray, inward: np.ndarray) -> list[np.ndarray]:
    """Both sides of the shortest cut that begins at an inward corner."""
    best: tuple[float, int, int, np.ndarray | None] = (np.inf, 0, 0, None)
    for corner in inward.tolist():
        for length, edge, meeting in _cuts_from(points, corner):
            if length / 2.0 >= best[0]:
                continue
            cost = length / 2.0 if _resolves(points, inward, corner, meeting) else length
            if cost < best[0]:
                best = (cost, corner, edge, meeting)
    _, corner, edge, end = best
    if end is None:
        raise ValueError(INDIVISIBLE)
    count = len(points)
    rolled = np.roll(points, -corner, axis=0)  # the inward corner comes first
    after = (edge - corner) % count  # the cut ends on the edge from this corner to the next
    meets_corner = np.array_equal(end, rolled[(after + 1) % count])
    one = np.concatenate([rolled[: after + 1], end[None]])
    other = np.concatenate([rolled[:1], end[None], rolled[after + 1 + meets_corner :]])
    return [one, other]


def _resolves(points: np.ndarray, inward: np.ndarray, corner: int, end: np.ndarray) -> bool:
    """Whether a cut from a corner ends at an inward corner, `end` (2,), and leaves that corner inward on neither side.

    A corner that stays inward needs another cut, which takes a sliver off.
    """
    for met in inward[(points[inward] == end).all(axis=1)].tolist():
        arm, edge_in, edge_out = points[corner] - end, end - points[met - 1], points[(met + 1) % len(points)] - end
        slack = FLATNESS * np.ptp(points, axis=0).max()
        unit = arm / np.hypot(*arm)
        return bool(edge_in[0] * unit[1] - edge_in[1] * unit[0] >= -slack and unit[0] * edge_out[1] - unit[1] * edge_out[0] <= slack)
    return False


def _cuts_from(points: np.ndarray, corner: int) -> list[tuple[float, int, np.ndarray]]:
    """Cuts from a corner that leave it inward on neither side: length of each cut, edge at which it ends, and end point (2,)."""
    origin, size = points[corner], np.ptp(points, axis=0).max()
    edge_in, edge_out = origin - points[corner - 1], points[(corner + 1) % len(points)] - origin
    directions = np.concatenate([[edge_in, -edge_out], points - origin])
    unit = directions / np.maximum(np.hypot(*directions.T), np.finfo(float).tiny)[:, None]
    slack = FLATNESS * size
    to_left = edge_in[0] * unit[:, 1] - edge_in[1] * unit[:, 0] >= -slack
    to_right = unit[:, 1] * edge_out[0] - unit[:, 0] * edge_out[1] >= -slack
    kept = unit[to_left & to_right & (np.hypot(*directions.T) > slack)]
    rows = max(1, MOST_AT_A_TIME // len(points))
    found = []
    for start in range(0, len(kept), rows):
        some = kept[start : start + rows]
        edges, ends = _ends(points, corner, some, *_first_hits(points, corner, some, size), size)
        found += list(zip(np.hypot(*(ends - origin).T).tolist(), edges.tolist(), ends, strict=True))
    return found


def _first_hits(points: np.ndarray, corner: int, directions: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Edges (d,) that rays from a corner along directions (d, 2) meet first, -1 for none, and their distances (d,)."""
    origin, following = points[corner], np.roll(points, -1, axis=0)
    (along_x, along_z), (across_x, across_z) = (points - origin).T, (following - points).T
    x, z = directions[:, :1], directions[:, 1:]
    steepness = x * across_z - z * across_x
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = (along_x * across_z - along_z * across_x) / steepness
        share = (along_x * z - along_z * x) / steepness
    reach = np.hypot(across_x, across_z)
    slack = AT_CORNER * size / np.maximum(reach, AT_CORNER * size)
    meets = (distance > AT_CORNER * size) & (share >= -slack) & (share <= 1.0 + slack) & (np.abs(steepness) > FLATNESS * reach)
    meets[:, [corner, corner - 1]] = False
    first = np.argmin(np.where(meets, distance, np.inf), axis=1)
    return np.where(meets.any(axis=1), first, -1), distance[np.arange(len(first)), first]


def _ends(
    points: np.ndarray, corner: int, directions: np.ndarray, edges: np.ndarray, distances: np.ndarray, size: float
) -> tuple[np.ndarray, np.ndarray]:
    """Edges (d,) and ends (d, 2) of the cuts that meet an edge. An end near a corner moves to this corner, on the edge before it."""
    met = edges >= 0
    edges, following = edges[met], (edges[met] + 1) % len(points)
    ends = points[corner] + distances[met, None] * directions[met]
    at_next = np.hypot(*(ends - points[following]).T) <= AT_CORNER * size
    at_first = np.hypot(*(ends - points[edges]).T) <= AT_CORNER * size
    ends = np.where(at_first[:, None], points[edges], np.where(at_next[:, None], points[following], ends))
    return np.where(at_first, (edges - 1) % len(points), edges), ends
