"""Blocks that are not convex: the corners of their outline follow the faces of the block, and the outline is divided anew.

The cuts between the convex parts of a block are not in the drawing. Where a cut is nearly parallel to a face, a corner that had to stay on
both would slide far along them. So would a corner between two nearly parallel faces of which only one moves. Such a corner becomes a step,
with one corner on each face.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from la_core.geometry import Shape, divided_loft

ON_LINE = 1e-7  # of a block's size: an edge of a part this close to one of the outline lies on it
PARALLEL = 1e-6  # of the greatest eigenvalue: planes this nearly parallel do not fix a corner along the line in which they meet


@dataclass(frozen=True)
class MovedOutline:
    """Convex parts of a block whose outline moved.

    Attributes
    ----------
    parts : tuple of Shape
        The parts.
    largest_move : float
        Largest displacement of a corner, m.
    """

    parts: tuple[Shape, ...]
    largest_move: float


def moved_outline(shape: Shape, normal: np.ndarray, offset: np.ndarray, limit: float) -> MovedOutline | None:
    """Move the outline of a block onto the moved planes of its faces, and divide it anew.

    None where the moved outline crosses itself or cannot be divided by plane cuts, or a corner would move by more than `limit` (m).

    Parameters
    ----------
    shape : Shape
        The block, of several parts between the same front and back.
    normal, offset : (F, 3) and (F,) arrays
        Moved planes of the faces of all parts; offsets in m.
    limit : float
        Largest motion of a corner, m. A corner that would slide farther along its faces becomes a step between them.
    """
    face = None if shape.outline is None else _faces_of_edges(shape, shape.outline[0])
    if shape.outline is None or face is None:
        return None
    sides = np.stack([np.roll(face, 1), face], axis=1)
    outline, moved = shape.outline, _moved(shape.outline, sides, normal, offset)
    slides = np.linalg.norm(moved - outline, axis=2).max(axis=0) > limit
    if slides.any():
        outline = np.repeat(outline, 1 + slides, axis=1)
        sides = np.concatenate([np.tile(both[:, None], 2) if apart else both[None] for both, apart in zip(sides, slides, strict=True)])
        moved = _moved(outline, sides, normal, offset)
    largest_move = float(np.linalg.norm(moved - outline, axis=2).max())
    if largest_move > limit:
        return None
    try:
        parts = divided_loft(moved[0], moved[1], normal[0]).parts
    except ValueError:
        return None
    return MovedOutline(parts, largest_move)


def _moved(outline: np.ndarray, sides: np.ndarray, normal: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """The outline (2, n, 3), each corner moved onto three planes: the faces before and after it, `sides` (n, 2), and front or back."""
    planes = np.concatenate([np.column_stack([sides, np.full(len(sides), cap)]) for cap in (0, 1)])  # faces 0 and 1 are front and back
    point = np.repeat(np.arange(len(planes)), 3)
    return onto_planes(outline.reshape(-1, 3), point, normal[planes.ravel()], offset[planes.ravel()]).reshape(outline.shape)


def onto_planes(points: np.ndarray, point: np.ndarray, normal: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """Points (n, 3), m, each moved by the shortest way onto all of its planes.

    point (p,): index of the point of each plane. normal (p, 3), offset (p,): the planes, offsets in m.
    """
    lack = offset - np.sum(normal * points[point], axis=1)
    matrix, right = np.zeros((len(points), 3, 3)), np.zeros((len(points), 3))
    np.add.at(matrix, point, normal[:, :, None] * normal[:, None, :])
    np.add.at(right, point, normal * lack[:, None])
    values, axes = np.linalg.eigh(matrix)
    inverse = np.where(values > PARALLEL * values[:, -1:], 1.0 / np.maximum(values, np.finfo(float).tiny), 0.0)
    return np.asarray(points + np.einsum("vij,vj,vkj,vk->vi", axes, inverse, axes, right))


def _faces_of_edges(shape: Shape, corners: np.ndarray) -> np.ndarray | None:
    """A face (n,) of a part along each edge of the outline with these corners (n, 3); None where an edge has no face along it."""
    sides = list(_sides(shape))
    face, first, last = np.array([side[0] for side in sides]), np.array([side[1] for side in sides]), np.array([side[2] for side in sides])
    along = np.roll(corners, -1, axis=0) - corners
    length = np.linalg.norm(along, axis=1)
    unit = along / length[:, None]
    near = ON_LINE * float(np.ptp(corners, axis=0).max())
    ends = [point[None] - corners[:, None] for point in (first, last)]
    start, end = (np.einsum("ksi,ki->ks", arm, unit) for arm in ends)
    off = np.maximum(*(np.linalg.norm(np.cross(arm, unit[:, None]), axis=2) for arm in ends))
    shared = np.minimum(end, length[:, None]) - np.maximum(start, 0.0)  # negative where the side runs the other way
    is_along = (off <= near) & (shared > near)
    return face[is_along.argmax(axis=1)] if is_along.any(axis=1).all() else None


def _sides(shape: Shape) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
    """Yield the number of each face between front and back, and both ends of its front edge, m, in the order of the front."""
    start = 0
    for part in shape.parts:
        front = part.vertices[: len(part.vertices) // 2]
        for k, (first, last) in enumerate(zip(front, np.roll(front, -1, axis=0), strict=True)):
            yield start + 2 + k, first, last
        start += len(part.faces)
