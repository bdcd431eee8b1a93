"""Choose the block that carries the sphere of each contact point; the other block offers its face."""

import itertools

import numpy as np

_BOX_TOLERANCE = 1e-9  # of the block's size: vertices of an axis-aligned box agree to rounding
_DEEPER = 1e-6  # relative: rounding must not distinguish equal depths


def box_extents(vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Return low and high corner (3,), m, of an axis-aligned box with these vertices (n, 3), or None for any other block."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    tolerance = _BOX_TOLERANCE * float((high - low).max())
    at_high = np.abs(vertices - high) <= tolerance
    on_corner = np.all(at_high | (np.abs(vertices - low) <= tolerance), axis=1)
    corners = {tuple(row) for row in at_high.tolist()}
    return (low, high) if len(vertices) == 8 and on_corner.all() and len(corners) == 8 else None


def hosts(is_box: np.ndarray, block_a: np.ndarray, block_b: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Return the block (C,) that carries the sphere of each contact point; the other block offers its face.

    A box is preferred for the face, because it is YADE's exact and cheapest target. Otherwise the face is that of the block in which
    the point lies farther from the edges, so that slip does not carry the sphere off it.

    Parameters
    ----------
    is_box : np.ndarray
        Whether each block (B,) is an axis-aligned box.
    block_a, block_b : np.ndarray
        Blocks (C,) of each contact point.
    depth : np.ndarray
        Distance (C, 2) of each point to the nearest edge of the face on a and on b, m.
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
    """Return the distance (C,), m, of every contact point to the nearest face plane of its block, without the face in contact.

    Parameters
    ----------
    position : np.ndarray
        Contact points (C, 3), m.
    normal : np.ndarray
        Contact normals (C, 3), outward from the block.
    block : np.ndarray
        Block (C,) of each contact point.
    faces : tuple of np.ndarray
        Owning block (F,), outward unit normal (F, 3) and offset (F,), m, of each face.
    plane : bool
        Whether the case is plane; faces across y then do not count, because all points lie at mid depth.
    """
    owner, face_normal, face_offset = faces
    depth = np.empty(len(position))
    for number in np.unique(block):
        rows, of_block = np.flatnonzero(block == number), np.flatnonzero(owner == number)
        distance = face_offset[of_block] - position[rows] @ face_normal[of_block].T
        in_contact = normal[rows] @ face_normal[of_block].T > 1.0 - 1e-6
        across = plane & (np.abs(face_normal[of_block, 1]) > 0.5)
        depth[rows] = np.where(in_contact | across, np.inf, distance).min(axis=1)
    return depth


def face_planes(vertices: np.ndarray, face_vertex: np.ndarray, face_start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return outward unit normals (F, 3) and offsets (F,), m, of face loops that run counter-clockwise seen from outside.

    vertices (V, 3), m; face_vertex: vertex numbers of all loops; face_start (F + 1,): where each loop begins in it.
    """
    normals, offsets = np.empty((len(face_start) - 1, 3)), np.empty(len(face_start) - 1)
    for face, (first, last) in enumerate(itertools.pairwise(face_start)):
        points = vertices[face_vertex[first:last]]
        arms = points - points.mean(axis=0)
        area = np.cross(arms, np.roll(arms, -1, axis=0)).sum(axis=0)
        normals[face] = area / np.linalg.norm(area)
        offsets[face] = normals[face] @ points.mean(axis=0)
    return normals, offsets
