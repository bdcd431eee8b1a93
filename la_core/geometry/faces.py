"""Pairs of blocks near each other, pairs of faces of convex blocks that may lie opposite each other, and overlaps of such faces."""

import numpy as np
import shapely

from la_core.geometry.blocks import Blocks
from la_core.geometry.polygons import group_members, overlap_of, plane_axes, polygons_of, true_corners


def near_pairs(blocks: Blocks, margin: np.ndarray) -> np.ndarray:
    """Pairs (P, 2) of blocks, a < b, whose bounding boxes touch when each is enlarged by its block's margin (B,), m.

    A tree of rectangles finds the boxes that touch in two directions. The third direction is compared for these boxes only: the one
    along which the fewest blocks follow each other. A wall has one or two leaves in its thickness, so the search grows as N log N.
    """
    low, high = blocks.low - margin[:, None], blocks.high + margin[:, None]
    follow = (high.max(axis=0) - low.min(axis=0)) / np.median(high - low, axis=0)
    third, *seen = np.argsort(follow, kind="stable").tolist()
    boxes = shapely.box(low[:, seen[0]], low[:, seen[1]], high[:, seen[0]], high[:, seen[1]])
    a, b = shapely.STRtree(boxes).query(boxes)
    meet = (a < b) & (low[a, third] <= high[b, third]) & (low[b, third] <= high[a, third])
    pairs = np.stack([a[meet], b[meet]], axis=1)
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def near_parts(blocks: Blocks, share: float) -> tuple[np.ndarray, np.ndarray]:
    """Size (P,), m, of the block of each convex part, and the pairs (N, 2) of parts of different blocks that are near each other.

    The size is the diagonal of the block's bounding box. Two parts are near where their bounding boxes touch, each enlarged by `share`
    of this size.
    """
    owner = blocks.part_block
    size = np.linalg.norm(blocks.high - blocks.low, axis=1)[owner]
    pairs = near_pairs(blocks.parts, share * size)
    return size, pairs[owner[pairs[:, 0]] != owner[pairs[:, 1]]]


def face_pairs(blocks: Blocks, pairs: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Combine every face of the first block with every face of the second block of pairs (P, 2).

    Returns the pair of each combination, its face of the first block, and its face of the second block, (K,) each.
    """
    face_start = blocks.part_face_start
    counts = np.diff(face_start)
    pair, place = group_members(counts[pairs[:, 0]] * counts[pairs[:, 1]])
    of_second = counts[pairs[pair, 1]]
    return pair, face_start[pairs[pair, 0]] + place // of_second, face_start[pairs[pair, 1]] + place % of_second


def opposite_faces(
    blocks: Blocks, pairs: np.ndarray, tolerance: np.ndarray, size: np.ndarray, angle: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Face pairs that may be closer than `tolerance` (P,), m, at an angle of at most `angle`, rad.

    Returns the pair of blocks of each face pair, its face of the first block, and its face of the second block. size: (B,), size of the
    blocks, m.
    """
    pair, face_a, face_b = face_pairs(blocks, pairs)
    normal_a, normal_b = blocks.face_normal[face_a], blocks.face_normal[face_b]
    opposite = np.linalg.norm(normal_a + normal_b, axis=1) <= angle
    pair, face_a, face_b = pair[opposite], face_a[opposite], face_b[opposite]
    middle = blocks.vertices[blocks.face_vertex[blocks.face_start[face_b]]]
    gap = np.abs(np.einsum("ij,ij->i", middle, blocks.face_normal[face_a]) - blocks.face_offset[face_a])
    near = gap <= tolerance[pair] + angle * size[pairs[pair, 1]]
    return pair[near], face_a[near], face_b[near]


def face_corners(blocks: Blocks, face: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Row (Q,) in `face` (N,) of each corner of these faces, and the corners (Q, 3), m."""
    row, place = group_members(np.diff(blocks.face_start)[face])
    return row, blocks.vertices[blocks.face_vertex[blocks.face_start[face[row]] + place]]


def face_polygons(blocks: Blocks, face: np.ndarray, plane: np.ndarray) -> np.ndarray:
    """Faces (N,) as polygons in the planes of the faces `plane` (N,), whose first corners are the origins."""
    first, second = plane_axes(blocks.face_normal[plane])
    origin = blocks.vertices[blocks.face_vertex[blocks.face_start[plane]]]
    row, corners = face_corners(blocks, face)
    arm = corners - origin[row]
    flat = np.stack([np.sum(arm * first[row], axis=1), np.sum(arm * second[row], axis=1)], axis=1)
    return polygons_of(flat, np.diff(blocks.face_start)[face])


def face_overlaps(
    blocks: Blocks, face_a: np.ndarray, face_b: np.ndarray, tolerance: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Overlaps of face pairs in the plane of face a that are wider than `tolerance` (N,), m.

    Returns the indices of the pairs with such an overlap, the corners (Q, 3) of the overlaps, m, the overlap of each corner (Q,), and the
    largest distance of face b from the corners of each overlap, m. Nearly coplanar faces touch only if they are close at every corner.
    """
    first, second = plane_axes(blocks.face_normal[face_a])
    origin = blocks.vertices[blocks.face_vertex[blocks.face_start[face_a]]]
    overlap = overlap_of(face_polygons(blocks, face_a, face_a), face_polygons(blocks, face_b, face_a))
    wide = shapely.area(overlap) > tolerance * shapely.length(overlap) / 2.0
    kept = np.flatnonzero(wide & (shapely.get_type_id(overlap) == shapely.GeometryType.POLYGON))
    flat, owner = true_corners(overlap[kept], tolerance[kept])
    row = kept[owner]
    corners = origin[row] + flat[:, :1] * first[row] + flat[:, 1:] * second[row]
    gap = np.zeros(len(kept))
    distance = np.einsum("ij,ij->i", corners, blocks.face_normal[face_b[row]]) - blocks.face_offset[face_b[row]]
    np.maximum.at(gap, owner, np.abs(distance))
    return kept, corners, owner, gap
