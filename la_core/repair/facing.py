"""Pairs of faces that lie opposite each other and nearly touch."""

from dataclasses import dataclass

import numpy as np
import shapely

from la_core.geometry import Blocks, face_pairs, face_polygons, near_pairs, next_corners, overlap_of, owners, plane_axes, ring_corners

WEDGE = np.cos(np.radians(25.0))  # cosine of the largest angle between two faces across a wedge-shaped joint
TOUCH = 1e-6  # of a block's size: largest gap between touching parts of one block
LEAST_OVERLAP = 1e-6  # of a face's area: a smaller overlap is only an edge
EXACT = 1e-7  # m: faces this close touch as drawn
BENT = 1e-3  # rad: faces side by side at a larger angle are chords of a curve, or a drawn bend
COVERED = 0.999  # of a face's area: a face that touches others with this share touches them everywhere


@dataclass(frozen=True)
class Facing:
    """The L pairs of faces that lie opposite each other, with the polygons in which they overlap.

    Attributes
    ----------
    face_a, face_b : (L,) arrays of int
        The two faces of each pair.
    angle : (L,) array
        Angle between them, rad.
    area : (L,) array
        Area of the overlap, m2.
    middle : (Q, 3) array
        Corners of the overlap, pair after pair, half way between both faces, m.
    gap : (Q,) array
        Distance between the faces at each of these corners, m; negative where the blocks overlap.
    start : (L + 1,) array of int
        Pair i has middle[start[i]:start[i + 1]].
    aligned : (A, 2) array of int
        Pairs of faces with opposite normals that lie side by side, nearly on one plane and nearly touching, as where four blocks meet.
    """

    face_a: np.ndarray
    face_b: np.ndarray
    angle: np.ndarray
    area: np.ndarray
    middle: np.ndarray
    gap: np.ndarray
    start: np.ndarray
    aligned: np.ndarray

    def __len__(self) -> int:
        return len(self.face_a)

    @property
    def widest(self) -> np.ndarray:
        """Index (L,) of the corner of each pair where its faces are farthest apart, or overlap the most."""
        owner = owners(self.start)
        order = np.lexsort((np.abs(self.gap), owner))
        return np.asarray(order[self.start[1:] - 1])


def facing_faces(parts: Blocks, owner: np.ndarray, reach: np.ndarray) -> Facing:
    """Find all pairs of faces that lie opposite each other at a distance of at most `reach`, and overlap seen along their normal.

    Parameters
    ----------
    parts : Blocks
        P convex parts.
    owner : (P,) array of int
        Block of each part. Parts of one block count as opposite only where they touch.
    reach : (P,) array
        Largest distance from another part, m; of two parts, the larger value counts.
    """
    size = np.linalg.norm(parts.high - parts.low, axis=1)
    pairs = near_pairs(parts, np.full(len(parts), reach.max()))
    same = owner[pairs[:, 0]] == owner[pairs[:, 1]]
    limit = np.where(same, TOUCH * size[pairs[:, 0]], reach[pairs].max(axis=1))
    pair, face_a, face_b = face_pairs(parts, pairs)
    cosine = -np.sum(parts.face_normal[face_a] * parts.face_normal[face_b], axis=1)
    first = parts.vertices[parts.face_vertex[parts.face_start[face_b]]]
    height = np.abs(np.sum(first * parts.face_normal[face_a], axis=1) - parts.face_offset[face_a])
    slope = np.sqrt(np.maximum(0.0, 1.0 - np.minimum(cosine, 1.0) ** 2)) * size[pairs[pair]].sum(axis=1)
    near = (cosine >= WEDGE) & (height <= limit[pair] + slope)
    pair, face_a, face_b, cosine = pair[near], face_a[near], face_b[near], cosine[near]
    overlap, corners, ring = _overlaps(parts, face_a, face_b, 0.0)
    beside = np.setdiff1d(np.flatnonzero(~same[pair]), overlap)
    aligned = _aligned(parts, face_a[beside], face_b[beside], limit[pair[beside]])
    bent = np.sum(parts.face_normal[aligned[:, 0]] * parts.face_normal[aligned[:, 1]], axis=1) > -np.cos(BENT)
    pair, face_a, face_b, cosine = pair[overlap], face_a[overlap], face_b[overlap], cosine[overlap]
    normal_a, normal_b = parts.face_normal[face_a], parts.face_normal[face_b]
    gap = parts.face_offset[face_b[ring]] - np.sum(normal_b[ring] * corners, axis=1)
    gap /= np.sum(normal_b * normal_a, axis=1)[ring]
    widest = np.zeros(len(pair))
    np.maximum.at(widest, ring, np.abs(gap))
    area = np.zeros(len(pair))
    near = np.flatnonzero(widest <= limit[pair])
    if len(near):
        polygons, others = (face_polygons(parts, face[near], face_a[near]) for face in (face_a, face_b))
        area[near] = shapely.area(overlap_of(polygons, others))
    whole = _is_whole(parts, face_a, face_b, area, widest)
    aligned = aligned[~(bent & whole[aligned].all(axis=1))]  # chords of a curve stay as drawn where they touch already
    needless = (widest > EXACT) & (whole[face_a] | whole[face_b])
    kept = (widest <= limit[pair]) & ~needless
    of_kept, area = kept[ring], area[kept]
    sizes = np.bincount(ring, minlength=len(pair))[kept]
    middle = corners + 0.5 * gap[:, None] * normal_a[ring]
    angle = np.arccos(np.clip(cosine[kept], -1.0, 1.0))
    start = np.concatenate([[0], np.cumsum(sizes)])
    return Facing(face_a[kept], face_b[kept], angle, area, middle[of_kept], gap[of_kept], start, aligned)


def _is_whole(parts: Blocks, face_a: np.ndarray, face_b: np.ndarray, area: np.ndarray, widest: np.ndarray) -> np.ndarray:
    """Mask (F,) of the faces that touch other faces everywhere. A pair with a gap needs no closing where one of its faces does.

    A chord of a curve touches the equal chord of the next block. It also faces the chords before and after that one across narrow wedges.
    area: (L,), area of the overlap of each pair, m2. widest: (L,), its largest gap, m.
    """
    touches = (widest <= EXACT) & (area > 0.0)
    covered = np.zeros(len(parts.face_normal))
    for face in (face_a, face_b):
        np.add.at(covered, face[touches], area[touches])
    whole: np.ndarray = covered >= COVERED * face_areas(parts)
    return whole


def face_areas(parts: Blocks) -> np.ndarray:
    """Area (F,) of every face, m2."""
    first = np.repeat(parts.face_start[:-1], np.diff(parts.face_start))
    origin = parts.vertices[parts.face_vertex[first]]
    corner, after = parts.vertices[parts.face_vertex] - origin, parts.vertices[parts.face_vertex[next_corners(parts.face_start)]] - origin
    return 0.5 * np.linalg.norm(np.add.reduceat(np.cross(corner, after), parts.face_start[:-1]), axis=1)


def _aligned(parts: Blocks, face_a: np.ndarray, face_b: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Pairs (A, 2) of the faces that would overlap if face b were larger by `reach` (N,), m, and that lie on one plane within `reach`."""
    found, corners, ring = _overlaps(parts, face_a, face_b, reach)
    gap = parts.face_offset[face_b[found][ring]] - np.sum(parts.face_normal[face_b[found][ring]] * corners, axis=1)
    widest = np.zeros(len(found))
    np.maximum.at(widest, ring, np.abs(gap))
    level = found[widest <= reach[found]]
    return np.stack([face_a[level], face_b[level]], axis=1)


def _overlaps(
    parts: Blocks, face_a: np.ndarray, face_b: np.ndarray, grown: np.ndarray | float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pairs of faces that overlap: their indices, the corners (Q, 3) of the overlaps on face a, and the row of each corner (Q,).

    grown: distance by which the faces b are larger, m.
    """
    polygons, others = face_polygons(parts, face_a, face_a), face_polygons(parts, face_b, face_a)
    overlap = overlap_of(polygons, shapely.buffer(others, grown, join_style="mitre") if np.any(grown) else others)
    is_polygon = shapely.get_type_id(overlap) == shapely.GeometryType.POLYGON
    found = np.flatnonzero(is_polygon & (shapely.area(overlap) > LEAST_OVERLAP * shapely.area(polygons)))
    flat, row = ring_corners(overlap[found])
    first, second = plane_axes(parts.face_normal[face_a[found]])
    origin = parts.vertices[parts.face_vertex[parts.face_start[face_a[found]]]]
    return found, origin[row] + flat[:, :1] * first[row] + flat[:, 1:] * second[row], row
