"""Outlines that lines enclose or divide, once ends of lines are joined and curves pass through the ends of lines on them."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy
import shapely

from la_core.drawing.curves import Curves, reaching, through_ends, with_points

SAMPLES = 8  # points of a line from which its position is judged
TOUCHING = 1e-4  # m: outlines drawn without a joint are no farther apart
FREE = 0.05  # of an outline drawn as lines of its own: share of its area that others may cover, and of its length that may be open
SAME_AREA = 0.01  # relative difference of an outline's area before and after its corners are joined
MOST_CROSSINGS = 200_000  # crossings of lines: they enclose about as many outlines, and a scene has at most 50,000 blocks
SAMPLED, COMMON = 300, 0.9  # number of lines whose crossings are counted, and share of them that is used: a few lines may cross all others
SPREAD = 2.0  # over the distance within which ends meet: largest extent along x or z of ends that are joined to one point
CLOSING = 0.5  # of a line's length: the ends of a ring are closer than this
EXACT = 0.05  # of the largest error of coordinates: an end this near to a line is drawn on it


@dataclass(frozen=True)
class Enclosed:
    """Outlines that lines enclose together, and lines that bound no outline.

    Attributes
    ----------
    faces : list of (n, 2) array
        Outlines that the lines enclose.
    idle : array of bool
        Mask of the lines that bound no outline.
    around : list of (n, 2) array
        Outlines around others.
    rests : list of (n, 2) array
        Parts of the other lines that bound no outline.
    """

    faces: list[np.ndarray]
    idle: np.ndarray
    around: list[np.ndarray]
    rests: list[np.ndarray]


def enclosed(lines: Sequence[np.ndarray], snap: float, curves: Curves, outlines: Sequence[np.ndarray] = ()) -> Enclosed:
    """Find the outlines that lines (n, 2) enclose together.

    Coordinates are wrong by up to `snap` (m), so `_joined` makes ends and corners of lines meet. An end that meets no other one is extended
    by twice `snap`, so that a line that stops just short of another line meets it. Where a line ends on a curve of the drawing, the chords
    of the curve go through this end. Closed outlines (n, 2) take part: lines may divide them, or end on them. A line that runs along an
    undivided outline does not bound it. Raises ValueError where lines cross each other more than MOST_CROSSINGS times.
    """
    _refuse_a_tangle(lines)
    every = [*lines, *(np.concatenate([outline, outline[:1]]) for outline in outlines)]
    joined, lone = _joined(every, snap)
    joined = through_ends(joined, lone, snap, curves)
    drawn = np.array([reaching(line, free, 2.0 * snap) for line, free in zip(joined, lone, strict=True)])
    faces, cuts, dangles, _ = shapely.polygonize_full(shapely.get_parts(shapely.unary_union(drawn)))
    faces = shapely.get_parts(faces)
    is_around = shapely.get_num_interior_rings(faces) > 0
    inner = faces[~is_around]
    idle = share_near(drawn[: len(lines)], shapely.boundary(inner[~_is_whole(inner, outlines)]), snap) < 0.5
    loose = np.concatenate([shapely.get_parts(cuts), shapely.get_parts(dangles)]) if not idle.all() else np.zeros(0, dtype=object)
    loose = loose[shapely.length(loose) > 4.0 * snap]  # shorter pieces are careless ends, or extensions of ends
    rests = loose[share_near(loose, drawn[: len(lines)][idle], snap) < 0.5]
    return Enclosed(_corners(inner), idle, _corners(faces[is_around]), [shapely.get_coordinates(rest) for rest in rests])


def _refuse_a_tangle(lines: Sequence[np.ndarray]) -> None:
    """Raise ValueError for lines that cross each other far too often for joints, because following them would take minutes."""
    strings = strings_of(lines)
    some = strings[:: -(-len(strings) // SAMPLED)]
    crossed, _ = shapely.STRtree(strings).query(some, predicate="crosses")
    counts = np.sort(np.bincount(crossed, minlength=len(some)))[: int(np.ceil(COMMON * len(some)))]
    crossings = float(counts.mean()) * len(strings) / 2.0
    if crossings > MOST_CROSSINGS:
        raise ValueError(
            f"its {len(strings)} lines cross each other some {round(crossings, -5):,.0f} times; at most {MOST_CROSSINGS:,} are followed: "
            "list layers of hatches and other things that are no joints in `ignore`"
        )


def _is_whole(faces: np.ndarray, outlines: Sequence[np.ndarray]) -> np.ndarray:
    """Mask of the faces that are a whole outline (n, 2), not a part of one."""
    mask = np.zeros(len(faces), dtype=bool)
    if len(faces) and outlines:
        polygons = outline_polygons(outlines)
        face, outline = shapely.STRtree(polygons).query(shapely.point_on_surface(faces), predicate="within")
        mask[face[np.isclose(shapely.area(faces[face]), shapely.area(polygons[outline]), rtol=SAME_AREA, atol=0.0)]] = True
    return mask


def touched(outlines: Sequence[np.ndarray], lines: Sequence[np.ndarray], near: float) -> np.ndarray:
    """Mask of the outlines (n, 2) that a line touches or crosses, to within `near` (m)."""
    mask = np.zeros(len(outlines), dtype=bool)
    if outlines and lines:
        rings = np.array([shapely.LinearRing(outline) for outline in outlines])
        mask[shapely.STRtree(rings).query(strings_of(lines), predicate="dwithin", distance=near)[1]] = True
    return mask


def of_own_lines(lines: Sequence[np.ndarray], snap: float, curves: Curves, outlines: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Outlines (n, 2) that lines of their own enclose outside all other outlines (n, 2): stones drawn as lines between closed outlines.

    A line that runs on beyond the outline, such as a bed joint drawn past an opening, does not count. snap, curves: as in `enclosed`.
    """
    faces = enclosed(lines, snap, curves).faces
    if not faces:
        return []
    others = shapely.union_all(shapely.make_valid(outline_polygons(outlines)))  # an outline that crosses itself is refused later
    found, strings = outline_polygons(faces), strings_of(lines)
    bounds = shapely.buffer(shapely.boundary(found), 2.0 * snap)
    line, face = shapely.STRtree(bounds).query(strings, predicate="covered_by")
    own = [shapely.buffer(shapely.union_all(strings[line[face == k]]), 2.0 * snap) for k in range(len(found))]
    covered = shapely.length(shapely.intersection(shapely.boundary(found), own)) / shapely.length(shapely.boundary(found))
    is_free = shapely.area(shapely.intersection(found, others)) < FREE * shapely.area(found)
    return [faces[k] for k in np.flatnonzero(is_free & (covered > 1.0 - FREE))]


def dividing(outlines: Sequence[np.ndarray], lines: Sequence[np.ndarray], near: float) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of a line (n, 2) and an outline (n, 2) that the line may divide: index (m,) of the line and index (m,) of the outline.

    The middle of the line lies in the outline, and both ends lie on the outline or on another line, to within `near` (m). An axis of the
    structure goes beyond the outline, and a crack or a tool mark ends inside it, so neither divides it.
    """
    if not outlines or not lines:
        return np.zeros(0, dtype=int), np.zeros(0, dtype=int)
    polygons, drawn = outline_polygons(outlines), strings_of(lines)
    line, outline = shapely.STRtree(polygons).query(shapely.line_interpolate_point(drawn, 0.5, normalized=True), predicate="within")
    boundary = shapely.boundary(polygons)[outline]
    for end in (0, -1):
        tip = shapely.get_point(drawn, end)[line]
        met, meets = shapely.STRtree(drawn).query(tip, predicate="dwithin", distance=near)
        is_on_line = np.isin(np.arange(len(line)), met[meets != line[met]]) & shapely.dwithin(tip, polygons[outline], near)
        kept = shapely.dwithin(tip, boundary, near) | is_on_line
        line, outline, boundary = line[kept], outline[kept], boundary[kept]
    return line, outline


def divided(outline: np.ndarray, lines: Sequence[np.ndarray], snap: float, curves: Curves) -> list[np.ndarray]:
    """Outlines (n, 2) into which lines divide an outline (n, 2); the outline alone where they do not divide it."""
    found = enclosed(lines, snap, curves, [outline])
    return found.faces if len(found.faces) > 1 and not found.around else [outline]


def conforming(outlines: Sequence[np.ndarray], snap: float, curves: Curves) -> list[np.ndarray]:
    """Outlines (n, 2) with the corners of neighbours on their curves inserted, so that both neighbours have the same chords.

    Stones on both sides of a curve have corners at different places of the curve. Without the other stone's corners, their chords would
    overlap, or leave gaps, by up to the sagitta of the curve.
    """
    curved = [k for k, outline in enumerate(outlines) if curves.lines and curves.along(_round(outline), snap).any()]
    if not curved:
        return list(outlines)
    start = np.cumsum([0, *(len(outline) for outline in outlines)])
    owner = np.repeat(np.arange(len(outlines)), np.diff(start))
    rings = np.array([shapely.LinearRing(outlines[k]) for k in curved])
    corners = np.concatenate(outlines)
    corner, on = shapely.STRtree(rings).query(shapely.points(corners), predicate="dwithin", distance=snap + curves.sagitta)
    polygons = outline_polygons(outlines)
    pairs, pair = np.unique(np.stack([owner[corner], on]), axis=1, return_inverse=True)
    touch = shapely.dwithin(polygons[pairs[0]], polygons[curved][pairs[1]], TOUCHING)  # open joints stay as they are drawn
    corner, on = corner[touch[pair.ravel()]], on[touch[pair.ravel()]]
    shared = np.unique(corner)
    corners[shared] = _merged(corners[shared], snap, owner[shared])  # corners of neighbours meet
    conformed = [corners[first:last] for first, last in pairwise(start)]
    for k, outline in enumerate(curved):
        near = np.unique(corners[corner[(on == k) & (owner[corner] != outline)]], axis=0)
        apart = scipy.spatial.cKDTree(conformed[outline]).query(near)[0] > snap
        through = with_points(_round(conformed[outline]), near[apart], snap, curves)[:-2]
        conformed[outline] = through if shapely.Polygon(through).is_valid else conformed[outline]
    return [new if shapely.Polygon(new).is_valid else old for new, old in zip(conformed, outlines, strict=True)]


def _round(outline: np.ndarray) -> np.ndarray:
    """An outline (n, 2) with its first two corners repeated at the end, so that every corner lies between two chords."""
    return np.concatenate([outline, outline[:2]])


def outline_polygons(outlines: Sequence[np.ndarray]) -> np.ndarray:
    """Outlines (n, 2) as polygons."""
    return np.asarray(shapely.polygons([shapely.linearrings(outline) for outline in outlines]))


def strings_of(lines: Sequence[np.ndarray]) -> np.ndarray:
    """Lines (n, 2) as line strings."""
    return np.array([shapely.LineString(line) for line in lines])


def _corners(faces: np.ndarray) -> list[np.ndarray]:
    return [shapely.get_coordinates(shapely.get_exterior_ring(face))[:-1] for face in faces]


def share_near(lines: np.ndarray, shapes: np.ndarray, near: float) -> np.ndarray:
    """Share (n,) of the length of each line that lies within shapes, or closer to them than `near` (m), judged at SAMPLES points."""
    shares = (np.arange(SAMPLES) + 0.5) / SAMPLES
    points = shapely.line_interpolate_point(lines[:, None], shares, normalized=True).ravel()
    hit = np.zeros(len(points), dtype=bool)
    hit[shapely.STRtree(shapes).query(points, predicate="dwithin", distance=near)[0]] = True
    return np.asarray(hit.reshape(-1, SAMPLES).mean(axis=1))


def _is_ring(line: np.ndarray, near: float) -> bool:
    """Whether a line (n, 2) is a ring: its ends are closer than `near` (m), and closer than CLOSING times its length."""
    apart = float(np.hypot(*(line[-1] - line[0])))
    return len(line) > 3 and apart <= near and apart < CLOSING * float(np.hypot(*np.diff(line, axis=0).T).sum())


def _joined(lines: Sequence[np.ndarray], snap: float) -> tuple[list[np.ndarray], np.ndarray]:
    """Join ends and corners of lines (n, 2) within `snap` (m). Return the lines, and the mask (lines, 2) of the ends that meet nothing.

    Two ends that are each wrong by `snap` lie within twice `snap`. So an end that is not drawn exactly on another line also meets ends and
    corners at up to twice `snap`. Other ends and corners do not, because they may lie on both sides of an open joint.
    """
    is_ring = np.array([_is_ring(line, 2.0 * snap) for line in lines])
    open_lines = [line[:-1] if ring else line for line, ring in zip(lines, is_ring, strict=True)]
    stop = np.cumsum([len(line) for line in open_lines])
    start = np.concatenate([[0], stop[:-1]])
    owner = np.repeat(np.arange(len(lines)), stop - start)
    points = np.concatenate(open_lines)
    ends = np.stack([start, stop - 1], axis=1)[~is_ring].ravel()
    tip, line = shapely.STRtree(strings_of(lines)).query(shapely.points(points[ends]), predicate="dwithin", distance=EXACT * snap)
    seeking = np.zeros(len(points), dtype=bool)
    seeking[ends] = True
    seeking[ends[tip[owner[ends[tip]] != line]]] = False
    points = _merged(_merged(points, snap, owner), 2.0 * snap, owner, seeking)
    _, number, uses = np.unique(points, axis=0, return_inverse=True, return_counts=True)
    lone = np.zeros((len(lines), 2), dtype=bool)
    lone[~is_ring] = (uses[number.ravel()[ends]] == 1).reshape(-1, 2)
    joined = (points[first:last] for first, last in zip(start, stop, strict=True))
    return [_without_repeats(np.concatenate([line, line[:1]]) if ring else line) for line, ring in zip(joined, is_ring, strict=True)], lone


def _without_repeats(line: np.ndarray) -> np.ndarray:
    """A line (n, 2) without points that repeat the point before them; at least two points are kept."""
    kept = np.concatenate([[True], (np.diff(line, axis=0) != 0.0).any(axis=1)])
    return line[kept] if kept.sum() > 1 else line[[0, -1]]


def _merged(points: np.ndarray, snap: float, owner: np.ndarray | None = None, seeking: np.ndarray | None = None) -> np.ndarray:
    """Points (n, 2), m, with all points of a chain replaced by its first point. Neighbours in a chain are closer than `snap` (m).

    With a mask `seeking` (n,), one of two neighbours must be in the mask, unless the two points are equal. `owner` (n,) numbers the line or
    outline of each point; neighbours have different owners. A curve drawn as many short lines is a chain, too, and would shrink to a point.
    So a chain is divided if it is wider than SPREAD times `snap`, or has several points of one owner.
    """
    owner = np.arange(len(points)) if owner is None else owner
    pairs = scipy.spatial.cKDTree(points).query_pairs(snap, output_type="ndarray") if snap > 0.0 else np.zeros((0, 2), dtype=int)
    pairs = pairs[owner[pairs[:, 0]] != owner[pairs[:, 1]]]
    if seeking is not None:
        pairs = pairs[seeking[pairs].any(axis=1) | (points[pairs[:, 0]] == points[pairs[:, 1]]).all(axis=1)]
    joined = scipy.sparse.coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(points), len(points)))
    count, group = scipy.sparse.csgraph.connected_components(joined, directed=False)
    first = np.unique(group, return_index=True)[1][group]
    order = np.argsort(group, kind="stable")
    starts = np.searchsorted(group[order], np.arange(count))
    extent = np.maximum.reduceat(points[order], starts) - np.minimum.reduceat(points[order], starts)
    is_crowd = extent.max(axis=1) > SPREAD * snap
    alike, times = np.unique(np.stack([group, owner]), axis=1, return_counts=True)
    is_crowd[alike[0][times > 1]] = True
    if is_crowd.any():
        first = _divided_chains(points, pairs[is_crowd[group[pairs[:, 0]]]], first, np.flatnonzero(is_crowd[group]), SPREAD * snap, owner)
    return np.asarray(points[first])


def _divided_chains(
    points: np.ndarray, pairs: np.ndarray, first: np.ndarray, crowd: np.ndarray, widest: float, owner: np.ndarray
) -> np.ndarray:
    """Index (n,) of the point that replaces each point. Points of a crowd (indices) are joined pair by pair, the nearest pair first.

    Joined points have different owners, and lie within `widest` (m) of each other along x and z.
    """
    root, owners = first.tolist(), {}
    boxes: dict[int, tuple[float, float, float, float]] = {}
    for k, x, z, number in zip(crowd.tolist(), *points[crowd].T.tolist(), owner[crowd].tolist(), strict=True):
        root[k], owners[k], boxes[k] = k, {number}, (x, x, z, z)

    def found(k: int) -> int:
        while root[k] != k:
            root[k] = k = root[root[k]]
        return k

    near = np.argsort(np.hypot(*(points[pairs[:, 0]] - points[pairs[:, 1]]).T), kind="stable")
    for j, k in pairs[near].tolist():
        one, other = sorted((found(j), found(k)))
        if one == other or not owners[one].isdisjoint(owners[other]):
            continue
        (a, b, c, d), (e, f, g, h) = boxes[one], boxes[other]
        box = min(a, e), max(b, f), min(c, g), max(d, h)
        if max(box[1] - box[0], box[3] - box[2]) <= widest:
            root[other], boxes[one] = one, box
            owners[one] |= owners.pop(other)
    return np.array([found(k) for k in root])
