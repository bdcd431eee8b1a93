"""Convex parts of blocks, the planes of their faces, and which of these faces lie within a block."""

import itertools
from collections.abc import Mapping
from typing import Any

import numpy as np

from yade_scripts.contacts.rows import rows_of

Faces = tuple[np.ndarray, np.ndarray, np.ndarray]  # owning block (F,), outward unit normal (F, 3), offset (F,), m

_BEYOND = 1e-6  # of the block's size: distance of the test points beyond a face
_BOX_TOLERANCE = 1e-9  # of the block's size: vertices of an axis-aligned box agree with its corners to rounding


def box_extents(vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """Return low and high corner (3,), m, of an axis-aligned box with these vertices (n, 3), or None for any other block."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    tolerance = _BOX_TOLERANCE * float((high - low).max())
    at_high = np.abs(vertices - high) <= tolerance
    on_corner = np.all(at_high | (np.abs(vertices - low) <= tolerance), axis=1)
    corners = {tuple(row) for row in at_high.tolist()}
    return (low, high) if len(vertices) == 8 and on_corner.all() and len(corners) == 8 else None


def face_planes(vertices: np.ndarray, face_vertex: np.ndarray, face_start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return outward unit normals (F, 3) and offsets (F,), m, of face loops that run counter-clockwise seen from outside.

    vertices (V, 3), m; face_vertex: vertex numbers of all loops; face_start (F + 1,): start of each loop in `face_vertex`.
    """
    normals, offsets = np.empty((len(face_start) - 1, 3)), np.empty(len(face_start) - 1)
    for face, (first, last) in enumerate(itertools.pairwise(face_start)):
        points = vertices[face_vertex[first:last]]
        arms = points - points.mean(axis=0)
        area = np.cross(arms, np.roll(arms, -1, axis=0)).sum(axis=0)
        normals[face] = area / np.linalg.norm(area)
        offsets[face] = normals[face] @ points.mean(axis=0)
    return normals, offsets


def parts_of(data: Mapping[str, Any], index: np.ndarray, vertices: tuple[np.ndarray, ...]) -> tuple[tuple[np.ndarray, ...], ...]:
    """Return the vertices of the convex parts of each block in `index` (B,); the file lists parts only if some block has several."""
    if "parts/block" not in data:
        return tuple((points,) for points in vertices)
    start, points = data["parts/vertex_start"], data["blocks/vertices"]
    of_block = rows_of(data["parts/block"], len(data["blocks/role"]))
    return tuple(tuple(points[start[part] : start[part + 1]] for part in of_block[block]) for block in index)


def faces_of_parts(data: Mapping[str, Any], index: np.ndarray, faces: Faces) -> tuple[tuple[np.ndarray, ...], ...]:
    """Return the face planes of the convex parts of each block in `index` (B,)."""
    planes, total = np.column_stack(faces[1:]), len(data["blocks/role"])
    if "parts/block" not in data:
        of_block = rows_of(faces[0], total)
        return tuple((planes[of_block[block]],) for block in index)
    start, of_block = data["parts/face_start"], rows_of(data["parts/block"], total)
    return tuple(tuple(planes[start[part] : start[part + 1]] for part in of_block[block]) for block in index)


def are_within(data: Mapping[str, Any], faces: Faces) -> np.ndarray:
    """Return whether each face (F,) lies within its block: other parts of the block cover it from outside.

    The parts of a non-convex block are extruded profiles, so the faces where two parts meet have four corners.
    """
    owner, normal, offset = faces
    within = np.zeros(len(owner), dtype=bool)
    if "parts/block" not in data:
        return within
    points, corner, first, start = (data[f"blocks/{name}"] for name in ("vertices", "face_vertex", "face_start", "vertex_start"))
    part = np.searchsorted(data["parts/face_start"], np.arange(len(owner)), side="right") - 1
    for block in np.flatnonzero(np.bincount(data["parts/block"]) > 1).tolist():
        of_block = np.arange(*np.searchsorted(owner, [block, block + 1]))
        vertices = points[start[block] : start[block + 1]]
        beyond = _BEYOND * np.ptp(vertices, axis=0).max()
        for face in of_block[np.diff(first)[of_block] == 4].tolist():
            others = of_block[part[of_block] != part[face]]
            meets = (normal[others] @ normal[face] < -1.0 + _BEYOND) & (np.abs(offset[others] + offset[face]) < beyond)
            if meets.any():
                places = _between(points[corner[first[face] : first[face + 1]]], vertices) + beyond * normal[face]
                outside = places @ normal[others].T - offset[others] > beyond
                parts = [outside[:, part[others] == one].any(axis=1) for one in np.unique(part[others])]
                within[face] = not np.all(parts, axis=0).any()
    return within


def _between(loop: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """Return test points (n, 3) on a face with four corners (4, 3): one in each cell of the grid that the vertices (V, 3) form on it."""
    middles = []
    for side in (loop[1] - loop[0], loop[3] - loop[0]):
        share = np.unique(np.clip([0.0, 1.0, *((vertices - loop[0]) @ side / (side @ side))], 0.0, 1.0))
        share = share[np.diff(share, prepend=-1.0) > _BEYOND]
        middles.append(0.5 * (share[1:] + share[:-1]))
    along, across = middles[0][:, None, None], middles[1][None, :, None]
    edge, opposite = ((1.0 - along) * loop[first] + along * loop[last] for first, last in ((0, 1), (3, 2)))
    return ((1.0 - across) * edge + across * opposite).reshape(-1, 3)
