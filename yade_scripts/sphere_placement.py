"""Which block carries the contact sphere of each contact point, and which one offers its face."""

import itertools

import numpy as np

_BOX_TOLERANCE = 1e-9  # of the block's size: vertices of an axis-aligned box agree to rounding
_DEEPER = 1e-6  # relative: equal depths must not be told apart by rounding


def box_extents(vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Low and high corner (3,), m, when the vertices are those of an axis-aligned box, else None."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    tolerance = _BOX_TOLERANCE * float((high - low).max())
    at_high = np.abs(vertices - high) <= tolerance
    on_corner = np.all(at_high | (np.abs(vertices - low) <= tolerance), axis=1)
    corners = {tuple(row) for row in at_high.tolist()}
    return (low, high) if len(vertices) == 8 and on_corner.all() and len(corners) == 8 else None


def hosts(is_box: np.ndarray, block_a: np.ndarray, block_b: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Block (C,) that carries the sphere of each contact point; the other block offers its face.

    Prefers a box for the face (YADE's exact and cheapest target), then the block in whose face the point lies deeper:
    the sphere then stands for an arris of its host, and slip does not carry it off the face.
    is_box (B,); block_a, block_b (C,); depth (C, 2): distance, m, of each point to the nearest edge of the face on a and on b.
    """
    a_box, b_box = is_box[block_a], is_box[block_b]
    a_deeper = depth[:, 0] > depth[:, 1] * (1.0 + _DEEPER)
    face_on_a = np.where(a_box == b_box, a_deeper, a_box)
    return np.where(face_on_a, block_b, block_a)


def depth_in_faces(
    position: np.ndarray,
    normal: np.ndarray,
    block: np.ndarray,
    faces: tuple[np.ndarray, np.ndarray, np.ndarray],
    plane: bool,
) -> np.ndarray:
    """Distance (C,), m, of every contact point to the nearest face plane of its `block`, the face in contact left out.

    position (C, 3), m; normal (C, 3): outward from `block` (C,); faces: owning block (F,), outward normal (F, 3), offset (F,).
    In plane cases the faces across y do not count: all points lie at mid depth.
    """
    owner, face_normal, face_offset = faces
    depth = np.empty(len(position))
    for one in np.unique(block):
        rows, own = np.flatnonzero(block == one), np.flatnonzero(owner == one)
        distance = face_offset[own] - position[rows] @ face_normal[own].T
        in_contact = normal[rows] @ face_normal[own].T > 1.0 - 1e-6
        across = plane & (np.abs(face_normal[own, 1]) > 0.5)
        depth[rows] = np.where(in_contact | across, np.inf, distance).min(axis=1)
    return depth


def face_planes(vertices: np.ndarray, face_vertex: np.ndarray, face_start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Outward unit normals (F, 3) and offsets (F,), m, of face loops that run counter-clockwise from outside."""
    normals, offsets = np.empty((len(face_start) - 1, 3)), np.empty(len(face_start) - 1)
    for face, (first, last) in enumerate(itertools.pairwise(face_start)):
        points = vertices[face_vertex[first:last]]
        arms = points - points.mean(axis=0)
        area = np.cross(arms, np.roll(arms, -1, axis=0)).sum(axis=0)
        normals[face] = area / np.linalg.norm(area)
        offsets[face] = normals[face] @ points.mean(axis=0)
    return normals, offsets
