"""Interfaces between blocks.

Two blocks share an interface where two of their faces are opposite and coplanar and overlap; convex blocks share at
most one, and so do the convex parts of two compound blocks.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np
import scipy
import shapely

from la_core.errors import SceneError
from la_core.geometry.blocks import Blocks, Held
from la_core.geometry.polygons import group_members, plane_axes, polygon_areas, true_corners
from la_core.geometry.touching import OPPOSITE, TOUCH, touching_faces  # noqa: F401  TOUCH is read from here, too

CLOSED_BY = "[geometry] tolerance closes gaps of up to twice the tolerance, and `joints` of a [[drawing]] its mortar"
MOST_MORTAR = 0.05  # m: a wider gap is no joint, and a deeper overlap no error of coordinates
NO_GAP = 1e-9  # m
MOST_NAMED, MOST_SOUGHT = 4, 300  # overlaps that one message names, and overlaps whose depth is computed for it


@dataclass(frozen=True, eq=False, repr=False)
class Interfaces(Held):
    """The I interfaces of a structure as flat arrays.

    Attributes
    ----------
    block_a, block_b : (I,) arrays of int
        Blocks on both sides, block_a < block_b.
    normal : (I, 3) array
        Unit normal from block a to block b.
    area : (I,) array
        Area of the overlap of the two faces, m2.
    polygon : (Q, 3) array
        Corners of the overlaps, interface after interface, m.
    polygon_start : (I + 1,) array of int
        Interface i has polygon[polygon_start[i]:polygon_start[i + 1]].
    dropped : int
        Interfaces that were left out because they are too short to count.
    """

    block_a: np.ndarray
    block_b: np.ndarray
    normal: np.ndarray
    area: np.ndarray
    polygon: np.ndarray
    polygon_start: np.ndarray
    dropped: int = 0

    def __len__(self) -> int:
        return len(self.block_a)

    def subset(self, kept: np.ndarray) -> "Interfaces":
        """The interfaces in a mask (I,)."""
        corners = np.diff(self.polygon_start)
        polygon, start = self.polygon[np.repeat(kept, corners)], np.concatenate([[0], np.cumsum(corners[kept])])
        return Interfaces(self.block_a[kept], self.block_b[kept], self.normal[kept], self.area[kept], polygon, start)


def find_interfaces(blocks: Blocks) -> Interfaces:
    """Find all interfaces that have a free block on at least one side.

    Raises SceneError, with the blocks' names, for blocks that overlap and for blocks that touch no other block.
    """
    parts, found = blocks.parts, touching_faces(blocks)
    untouched = np.setdiff1d(np.arange(len(found.near)), found.pair)  # parts on either side of a joint do not overlap
    _refuse_overlaps(parts, found.near[untouched], found.tolerance[untouched])
    owner = blocks.part_block[found.parts]
    _refuse_floating(blocks, owner)
    normal = parts.face_normal[found.face_a]
    area = polygon_areas(found.corners, found.start, normal)
    keep = blocks.free[owner].any(axis=1)
    interfaces = Interfaces(owner[:, 0], owner[:, 1], normal, area, found.corners, found.start).subset(keep)
    return interfaces if parts is blocks else _joined_over_parts(interfaces, found.tolerance[found.pair[keep]])


def _joined_over_parts(found: Interfaces, tolerance: np.ndarray) -> Interfaces:
    """Join interfaces that lie side by side on one plane between the same two blocks, where the joined interface is convex.

    tolerance: (I,), largest distance between such interfaces, m. Only compound blocks have them, because their parts divide their faces.
    """
    groups: dict[tuple[int, int], list[int]] = {}
    for k, pair in enumerate(zip(found.block_a.tolist(), found.block_b.tolist(), strict=True)):
        groups.setdefault(pair, []).append(k)
    loops: list[np.ndarray] = []
    kept: list[int] = []
    for members in groups.values():
        left = list(members)
        while left:
            k = left.pop(0)
            side_by_side = [k, *(i for i in left if _is_on_plane_of(found, k, i, tolerance[k]))]
            corners = [found.polygon[found.polygon_start[i] : found.polygon_start[i + 1]] for i in side_by_side]
            loop, joined = _union(corners, found.normal[k], tolerance[k]) if len(corners) > 1 else (corners[0], [])
            loops.append(loop)
            kept.append(k)
            left = np.setdiff1d(left, [side_by_side[member] for member in joined]).tolist()
    order = np.argsort(kept)
    polygon, counts = np.concatenate([loops[i] for i in order]), np.array([len(loops[i]) for i in order])
    rows = np.array(kept)[order]
    start = np.concatenate([[0], np.cumsum(counts)])
    area = polygon_areas(polygon, start, found.normal[rows])
    return Interfaces(found.block_a[rows], found.block_b[rows], found.normal[rows], area, polygon, start)


def _is_on_plane_of(found: Interfaces, one: int, other: int, tolerance: float) -> bool:
    """Whether the corners of the other interface lie on the plane of one, within a tolerance, m, and both have one direction.

    Offsets of the planes are not compared: far from the origin those of nearly parallel planes differ.
    """
    corners = found.polygon[found.polygon_start[other] : found.polygon_start[other + 1]]
    distance = np.abs((corners - found.polygon[found.polygon_start[one]]) @ found.normal[one]).max()
    return bool(distance <= tolerance and found.normal[other] @ found.normal[one] > 1.0 - OPPOSITE**2)


def _union(corners: list[np.ndarray], normal: np.ndarray, tolerance: float) -> tuple[np.ndarray, list[int]]:
    """Corners (n, 3), m, of the union of the first of several polygons on one plane and the polygons connected to it.

    Also returns the indices of all polygons in the union. Where the union is not convex, returns the corners of the first polygon and no
    indices.
    """
    (first,), (second,) = plane_axes(normal[None])
    origin = corners[0][0]
    flat = [np.column_stack([(loop - origin) @ first, (loop - origin) @ second]) for loop in corners]
    wider = shapely.buffer([shapely.Polygon(loop) for loop in flat], tolerance, join_style="mitre")
    apart = shapely.get_parts(shapely.union_all(wider))  # two blocks may meet in several places of one plane
    whole = apart[shapely.intersects(apart, wider[0])][0]
    hull = shapely.convex_hull(whole)
    if shapely.area(hull) - shapely.area(whole) > tolerance * shapely.length(hull):
        return corners[0], []
    connected = np.flatnonzero(shapely.intersects(whole, wider)).tolist()
    points = shapely.MultiPoint(np.concatenate([flat[i] for i in connected]))
    outline, _ = true_corners(np.array([shapely.convex_hull(points)]), np.array([tolerance]))
    return np.asarray(origin + outline[:, :1] * first + outline[:, 1:] * second), connected


def _refuse_overlaps(blocks: Blocks, pairs: np.ndarray, tolerance: np.ndarray) -> None:
    """Raise SceneError for blocks that overlap. The message names the first pair, and others that a reader can correct with it."""
    found: dict[tuple[str, str], tuple[float, tuple[float, float, float]]] = {}
    is_hole, sought = False, overlaps(blocks, pairs, tolerance)
    for a, b, depth, middle in islice(sought, MOST_SOUGHT):
        if not found:
            inset = np.concatenate([blocks.low[b] - blocks.low[a], blocks.high[a] - blocks.high[b]])
            is_hole = bool((inset >= 0.0).all() or (inset <= 0.0).all())  # one lies within the other
        found.setdefault((blocks.names[a], blocks.names[b]), (depth, middle))
    if not found:
        return
    (pair, (depth, _)), *others = found.items()
    more = ", ".join(f'"{one}" and "{other}" by {far:.3g} m' for (one, other), (far, _) in others[: MOST_NAMED - 1])
    rule = f"overlap by about {depth:.3g} m" + (f"; so do {more}" if more else "")
    if unnamed := [far for _, (far, _) in others[MOST_NAMED - 1 :]]:  # the deepest overlap gives the tolerance that would remove all
        least = "" if next(sought, None) is None else "at least "
        rule += f", and {least}{len(unnamed)} other{'s' * (len(unnamed) > 1)} by up to {max(unnamed):.3g} m"
    hint = "blocks may touch but not share volume"
    if depth <= MOST_MORTAR:
        hint += "; [geometry] tolerance removes overlaps of up to twice the tolerance"
    elif is_hole and not inset.any():
        hint += "; these two fill the same place: remove one of them"
    elif is_hole:
        hint += "; draw a hole within the outline of its block, with a slit of 1 mm from the hole to an edge"
    raise SceneError(
        f'blocks "{pair[0]}" and "{pair[1]}"',
        rule,
        hint=hint,
        blocks=pair,
        spots=[middle for _, middle in found.values()][: MOST_NAMED + 1],
    )


def overlaps(blocks: Blocks, pairs: np.ndarray, tolerance: np.ndarray) -> Iterator[tuple[int, int, float, tuple[float, float, float]]]:
    """Yield both blocks, depth and middle, m, of each pair (P, 2) of convex blocks that overlap by more than its tolerance (P,), m.

    Separating faces decide almost every pair. For the others a linear programme finds the largest ball within both
    blocks; its diameter is the depth.
    """
    apart = np.maximum(separation_by_faces(blocks, pairs), separation_by_faces(blocks, pairs[:, ::-1])) >= -tolerance
    for (a, b), limit in zip(pairs[~apart].tolist(), tolerance[~apart], strict=True):
        faces = np.isin(blocks.face_block, (a, b))
        normal, offset = blocks.face_normal[faces], blocks.face_offset[faces]
        centre = (blocks.centroid[a] + blocks.centroid[b]) / 2.0
        rows = np.column_stack([normal, np.ones(len(normal))])
        ball = scipy.optimize.linprog(
            [0.0, 0.0, 0.0, -1.0], A_ub=rows, b_ub=offset - normal @ centre, bounds=[(None, None)] * 3 + [(0.0, None)]
        )
        if ball.success and ball.x[3] > limit:
            x, y, z = (centre + ball.x[:3]).tolist()
            yield a, b, 2.0 * float(ball.x[3]), (x, y, z)


def separation_by_faces(blocks: Blocks, pairs: np.ndarray) -> np.ndarray:
    """Largest distance (P,), m, of the second block of each pair (P, 2) from a face plane of the first, positive outside.

    The distance is negative where no face plane separates the blocks.
    """
    face_start = np.searchsorted(blocks.face_block, np.arange(len(blocks) + 1))
    first, second = pairs.T
    pair, place = group_members(np.diff(face_start)[first])
    face = face_start[first[pair]] + place
    row, place = group_members(np.diff(blocks.vertex_start)[second[pair]])
    vertex = blocks.vertices[blocks.vertex_start[second[pair[row]]] + place]
    distance = np.einsum("ij,ij->i", vertex, blocks.face_normal[face[row]]) - blocks.face_offset[face[row]]
    nearest = np.full(len(face), np.inf)
    np.minimum.at(nearest, row, distance)
    apart = np.full(len(pairs), -np.inf)
    np.maximum.at(apart, pair, nearest)
    return apart


def nearest_gap(blocks: Blocks, some: np.ndarray, others: np.ndarray) -> str:
    """A sentence about the nearest pair of a block in `some` and one in `others` (indices), with their gap.

    For a gap of at most MOST_MORTAR, the sentence also says how to close it.
    """
    one, near, gap = _nearest(blocks.parts, *(np.flatnonzero(np.isin(blocks.part_block, group)) for group in (some, others)))
    told = f'"{blocks.names[blocks.part_block[near]]}" is nearest to "{blocks.names[blocks.part_block[one]]}"'
    if gap <= NO_GAP:
        edge = "at most in an edge or a corner, which carries nothing, or in faces that do not fit each other"
        return f"{told} and meets it {edge}; [geometry] tolerance fits faces that are apart or overlap by up to twice the tolerance"
    told += f", about {gap:.3g} m away"
    return f"{told}; {CLOSED_BY}" if gap <= MOST_MORTAR else told


def _nearest(blocks: Blocks, some: np.ndarray, others: np.ndarray) -> tuple[int, int, float]:
    """The nearest pair of a convex block in `some` and one in `others` (indices), and its gap by `gaps`, m."""
    low, high = blocks.low, blocks.high

    def boxes_apart(one: int) -> np.ndarray:
        return _distance(np.maximum(low[others] - high[one], low[one] - high[others]))

    def nearest_within(reach: float) -> tuple[int, int, float]:
        """The nearest of the pairs whose boxes are at most `reach` (m) apart, and its gap, m."""
        # Block by block: a table of all pairs of a large scene takes gigabytes.
        pairs = np.array([(one, other) for one in some for other in others[boxes_apart(one) <= reach]])
        gap = gaps(blocks, pairs)
        nearest = int(np.argmin(gap))
        return int(pairs[nearest, 0]), int(pairs[nearest, 1]), float(gap[nearest])

    _, _, reach = nearest_within(min(boxes_apart(one).min() for one in some))
    return nearest_within(reach)  # boxes of leaning blocks may overlap where the blocks are far apart: others are then nearer


def gaps(blocks: Blocks, pairs: np.ndarray) -> np.ndarray:
    """Lower bound (P,), m, of the gap of each pair (P, 2) of convex blocks, exact between faces.

    It is the larger of the distance of their boxes and of the distance of one block from a face plane of the other.
    """
    (a, b), low, high = pairs.T, blocks.low, blocks.high
    faces = np.maximum(separation_by_faces(blocks, pairs), separation_by_faces(blocks, pairs[:, ::-1]))
    return np.asarray(np.maximum(_distance(np.maximum(low[a] - high[b], low[b] - high[a])), faces))


def _distance(apart: np.ndarray) -> np.ndarray:
    """Distance (P,), m, of boxes from their gaps along the axes (P, 3), m; a gap is negative where the boxes overlap along its axis."""
    return np.asarray(np.linalg.norm(np.maximum(apart, 0.0), axis=1))


def _refuse_floating(blocks: Blocks, touching: np.ndarray) -> None:
    alone = np.setdiff1d(np.arange(len(blocks)), touching)
    if len(alone):
        block = int(alone[np.argmax(blocks.free[alone])])  # the first free one, if any is free
        more = f" and {len(alone) - 10} more" if len(alone) > 10 else ""
        names = ", ".join(f'"{blocks.names[i]}"' for i in alone[:10]) + more
        raise SceneError(
            f"block{'s' if len(alone) > 1 else ''} {names}",
            f"touch{'' if len(alone) > 1 else 'es'} nothing: no face lies on another block's face",
            hint=nearest_gap(blocks, np.array([block]), np.delete(np.arange(len(blocks)), block)),
            blocks=[blocks.names[i] for i in alone],
            spots=[tuple(blocks.centroid[i].tolist()) for i in alone],
        )
