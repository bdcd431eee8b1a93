"""Choose the block that carries the sphere of each contact point, and the sphere's size; the other block has the face in contact."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from la_core.exchange import RADIUS_OVER_INSET
from yade_scripts.contacts.convex_parts import Faces, are_within
from yade_scripts.contacts.rows import rows_of

CLEAR = 0.5  # of its radius: least gap between a sphere and the other faces of its block, so that moving blocks do not close it
# Least cosine between the normals of one face; least |y| of the normal of a face across y, which a plane motion never reaches.
_ALONG, _ACROSS = 1.0 - 1e-6, 0.5
_IN_PLANE = 1e-9  # of the distance to the farthest face: a point this close to a plane lies in the plane
_DEEPER = 1e-6  # relative: rounding must not distinguish equal depths


def spheres(data: Mapping[str, Any], boxes: np.ndarray, faces: Faces) -> tuple[np.ndarray, np.ndarray]:
    """Return host (C,) and inset (C,), m, of each contact point's sphere; hosts, `boxes` and `faces` have block numbers of the file.

    Faces between two parts of one block do not count: a sphere that sticks out of such a face stays within the block.
    """
    within = are_within(data, faces)
    faces = faces[0][~within], faces[1][~within], faces[2][~within]
    interface, position, plane = data["contacts/interface"], data["contacts/position"], bool(data["scene/plane"])
    block_a, block_b, normal = (data[f"interfaces/{name}"][interface] for name in ("block_a", "block_b", "normal"))
    on_a = depth_in_faces(position, normal, block_a, faces, plane)
    on_b = depth_in_faces(position, -normal, block_b, faces, plane)
    is_box = np.isin(np.arange(len(data["blocks/role"])), boxes)
    host = hosts(is_box, block_a, block_b, np.column_stack([on_a, on_b]))
    outward = np.where((host == block_a)[:, None], normal, -normal)
    room = largest_radius(position, outward, host, faces, plane) / RADIUS_OVER_INSET
    return host, np.minimum(data.get("contacts/inset", float(data["scene/inset"])), room)


def hosts(is_box: np.ndarray, block_a: np.ndarray, block_b: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Return the block (C,) that carries the sphere of each contact point; the other block has the face in contact.

    A box is preferred for the face, because it is YADE's exact and cheapest body. Otherwise the face belongs to the block in which the
    point lies farther from the edges, so that the sphere does not slip off it.

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


def depth_in_faces(position: np.ndarray, normal: np.ndarray, block: np.ndarray, faces: Faces, plane: bool) -> np.ndarray:
    """Return the distance (C,), m, of every contact point to the nearest face plane of its block other than the face in contact.

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
    depth = np.empty(len(position))
    for rows, distance, _ in _other_faces(position, normal, block, faces, plane):
        depth[rows] = distance.min(axis=1)
    return depth


def largest_radius(position: np.ndarray, normal: np.ndarray, block: np.ndarray, faces: Faces, plane: bool) -> np.ndarray:
    """Return the radius (C,), m, up to which the sphere of a contact point stays clear of the other faces of its block.

    In a sharp corner a sphere that is tangent to one face would stick out of the other face and touch another block. With a radius of half
    the inset this occurs in corners of less than 53 degrees. The sphere of radius r has its centre at *point* - r *normal*. Its gap to a
    face with the normal m at the distance g from the point is g + r n.m - r. The parameters are those of `depth_in_faces`, for the blocks
    that carry the spheres.
    """
    radius = np.empty(len(position))
    for rows, distance, along in _other_faces(position, normal, block, faces, plane):
        level = _IN_PLANE * np.where(np.isfinite(distance), np.abs(distance), 0.0).max(axis=1, keepdims=True)
        behind = np.where(distance > level, distance, np.inf)  # a point lies outside the planes of a compound block's inner corners
        radius[rows] = (behind / (1.0 + CLEAR - along)).min(axis=1)
    return radius


def _other_faces(
    position: np.ndarray, normal: np.ndarray, block: np.ndarray, faces: Faces, plane: bool
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Yield for each block its contact points, their distances (n, F), m, to its other faces, and the cosines (n, F) between normals.

    The distance to the face in contact, and in plane cases to faces across y, is inf.
    """
    owner, face_normal, face_offset = faces
    count = 1 + max(block.max(initial=0), owner.max(initial=0))
    for rows, of_block in zip(rows_of(block, count), rows_of(owner, count), strict=True):
        if not len(rows):
            continue
        distance = face_offset[of_block] - position[rows] @ face_normal[of_block].T
        along = normal[rows] @ face_normal[of_block].T
        yield rows, np.where(are_others(face_normal[of_block], normal[rows], plane), distance, np.inf), along


def are_others(faces: np.ndarray, normal: np.ndarray, plane: bool) -> np.ndarray:
    """Return (n, F) whether faces with outward normals (F, 3) differ from the faces with the normals (n, 3).

    In plane cases faces across y do not count as others.
    """
    across = plane & (np.abs(faces[:, 1]) > _ACROSS)
    return (normal @ faces.T <= _ALONG) & ~across
