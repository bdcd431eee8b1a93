"""Shapes of single blocks: boxes, prisms, lofts and polyhedra as vertices and faces, and compounds of such convex parts."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy
import shapely

from la_core.errors import SceneError
from la_core.geometry.division import FLATNESS, convex_parts, without_straight_corners
from la_core.geometry.polygons import plane_axes

ROUND_OFF = 1e-12  # of the distance from the origin: least thickness of a block, which then still has four digits
STEEP = 0.1  # sine of the angle to a face: a steeper edge leads away from the face, however short it is
PLANE_CUTS = 1e-7  # of the size: largest distance of a back from an affine image of the front
# Shares of the flatness that are tried in turn, until each part of the surface belongs to one face only: narrow facets of a curve lie
# within the flatness of several faces.
FLATTER = (1.0, 1e-2, 1e-4)
# Largest volume between bent faces and the hull, over flatness times surface. It was at most 0.21 for 3,000 inexact boxes, prisms and
# frusta that needed no other flatness, and 3.8 for a ball of 60 x 60 corners, whose facets were counted twice.
BENT = 0.4
SAME_VOLUME = 1e-6  # of the volume: a difference that changes no weight
FACE_FLATNESS = 1e-4  # of the size: corners this close to a plane lie on it; inexact corners must not split a face


@dataclass(frozen=True)
class Shape:
    """One convex polyhedron, or several that move as one block.

    Attributes
    ----------
    vertices : (n, 3) array
        Vertices, part after part, m.
    faces : tuple of tuples of int
        Loop of vertices of each face, part after part, counter-clockwise seen from outside.
    part_sizes : tuple of pairs of int
        Number of vertices and of faces of each convex part; () where there is one part.
    outline : (2, n, 3) array or None
        Corners of the front and of the back, m, of a body of several parts between front and back. The front is counter-clockwise seen from
        outside. None for any other body.
    """

    vertices: np.ndarray
    faces: tuple[tuple[int, ...], ...]
    part_sizes: tuple[tuple[int, int], ...] = ()
    outline: np.ndarray | None = None

    def moved(self, motion: Callable[[np.ndarray], np.ndarray]) -> "Shape":
        """The shape after a motion that maps points (..., 3), m."""
        outline = None if self.outline is None else motion(self.outline)
        return replace(self, vertices=motion(self.vertices), outline=outline)

    @property
    def parts(self) -> "tuple[Shape, ...]":
        """The convex parts, each as a shape; the shape itself where it is convex."""
        if not self.part_sizes:
            return (self,)
        parts, vertex, face = [], 0, 0
        for vertices, faces in self.part_sizes:
            loops = tuple(tuple(corner - vertex for corner in loop) for loop in self.faces[face : face + faces])
            parts.append(Shape(self.vertices[vertex : vertex + vertices], loops))
            vertex, face = vertex + vertices, face + faces
        return tuple(parts)


def compound(parts: Sequence[Shape], outline: np.ndarray | None = None) -> Shape:
    """One shape of convex parts that touch each other in faces; they move as one block. outline: see `Shape`."""
    if len(parts) == 1:
        return parts[0]
    start = np.cumsum([0, *(len(part.vertices) for part in parts)])
    faces = [tuple(corner + int(first) for corner in loop) for part, first in zip(parts, start, strict=False) for loop in part.faces]
    sizes = tuple((len(part.vertices), len(part.faces)) for part in parts)
    return Shape(np.concatenate([part.vertices for part in parts]), tuple(faces), sizes, outline)


def box(low: Sequence[float], high: Sequence[float]) -> Shape:
    """Box with edges along the axes, from corner `low` to corner `high` (m)."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    return _extruded([(x0, z0), (x1, z0), (x1, z1), (x0, z1)], (y0, y1))


def _extruded(points: Sequence[Sequence[float]], y: Sequence[float]) -> Shape:
    """Prism of a convex (x, z) profile whose corners turn from x to z."""
    front, back = (np.array([(px, depth, pz) for px, pz in points]) for depth in y)
    return loft(front, back)


def loft(front: np.ndarray, back: np.ndarray) -> Shape:
    """Body between two plane loops of n corners each, `front` and `back` (n, 3), m.

    `front` is counter-clockwise seen from outside; an edge joins each of its corners to the same corner of `back`.
    The caller guarantees that the faces between the loops are plane and that the body is convex.
    """
    n = len(front)
    sides = tuple(((i + 1) % n, i, n + i, n + (i + 1) % n) for i in range(n))
    return Shape(np.concatenate([front, back]), (tuple(range(n)), tuple(range(2 * n - 1, n - 1, -1)), *sides))


def prism(profile: Sequence[Sequence[float]], y: Sequence[float]) -> Shape:
    """Prism of an (x, z) profile, in either orientation, from y[0] to y[1] (m); a compound where the profile is not convex.

    Raises ValueError when the profile crosses itself or has no area.
    """
    points = np.array(profile, dtype=float)
    following = np.roll(points, -1, axis=0)
    if np.sum(points[:, 0] * following[:, 1] - following[:, 0] * points[:, 1]) < 0.0:
        points = points[::-1]
    points = without_straight_corners(points)
    if len(points) < 3:
        raise ValueError("the profile has no area")
    if not shapely.is_valid(shapely.Polygon(points)):
        raise ValueError("the profile crosses itself")
    outline = np.array([[(x, depth, z) for x, z in points] for depth in y])
    return compound([_extruded(part.tolist(), y) for part in convex_parts(points)], outline)


def divided_loft(front: np.ndarray, back: np.ndarray, normal: np.ndarray) -> Shape:
    """Body between two plane outlines of n corners each, `front` and `back` (n, 3), m; a compound where the outlines are not convex.

    `front` is counter-clockwise seen from outside, where its unit normal (3,) points. Raises ValueError where it crosses itself, and where
    `back` is no affine image of it, because the cuts would not be plane.
    """
    flat = (front - front[0]) @ np.concatenate(plane_axes(normal[None])).T
    if not (shapely.Polygon(flat).is_valid and shapely.LinearRing(flat).is_ccw):
        raise ValueError("the outline crosses itself")
    columns = np.column_stack([flat, np.ones(len(flat))])
    maps = [np.linalg.lstsq(columns, side, rcond=None)[0] for side in (front, back)]
    if np.abs(columns @ maps[1] - back).max() > PLANE_CUTS * np.ptp(flat, axis=0).max():
        raise ValueError("the cuts are not plane")
    parts = [loft(*_on_both(part, flat, (front, back), maps)) for part in convex_parts(flat)]
    return compound(parts, np.stack([front, back]))


def _on_both(part: np.ndarray, flat: np.ndarray, sides: Sequence[np.ndarray], maps: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Corners (m, 2) of a part mapped to front and back, (m, 3) each, m. Corners of the outline `flat` keep their exact places on both."""
    both = [np.column_stack([part, np.ones(len(part))]) @ to_side for to_side in maps]
    corner, of_outline = np.nonzero((part[:, None] == flat[None]).all(axis=2))
    for points, side in zip(both, sides, strict=True):
        points[corner] = side[of_outline]
    return both


def polyhedron(vertices: Sequence[Sequence[float]], flatness: float = FACE_FLATNESS) -> Shape:
    """Convex hull of vertices (n, 3) in m, coplanar triangles merged into faces.

    flatness: largest distance of a face's corner from its plane, over the size of the hull; less where facets are narrow. Raises ValueError
    when the hull has no volume, or facets that are too narrow.
    """
    points = np.array(vertices, dtype=float)
    centre, size = points.mean(axis=0), np.ptp(points, axis=0).max()
    if not size > 0.0:
        raise ValueError("the polyhedron has no volume")
    try:
        hull = scipy.spatial.ConvexHull((points - centre) / size)
    except scipy.spatial.QhullError as error:
        raise ValueError("the polyhedron has no volume") from error
    for share in FLATTER:
        faces = _faces(hull, share * flatness)
        if abs(_volume(hull.points, faces) - hull.volume) <= max(BENT * share * flatness * hull.area, SAME_VOLUME * hull.volume):
            used = sorted({vertex for face in faces for vertex in face})
            renumber = {old: new for new, old in enumerate(used)}
            return Shape(points[used], tuple(tuple(renumber[v] for v in face) for face in faces))
    raise ValueError("the polyhedron has facets that are too narrow to tell apart; draw its curves with fewer corners")


# The type is in quotes, so that scipy.spatial is loaded only where a body needs it.
def _faces(hull: "scipy.spatial.ConvexHull", flatness: float) -> list[tuple[int, ...]]:
    """Loop of vertices of each face of a hull, where facets on one plane are one face."""
    edges = hull.points[hull.simplices[:, 1:]] - hull.points[hull.simplices[:, :1]]
    area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    faces, remaining = [], np.argsort(-area, kind="stable").tolist()  # the largest triangle of a face gives its plane best
    while remaining:
        plane = hull.equations[remaining[0]]
        corners = _corners_on(plane, hull.points, hull.vertices, flatness)
        faces.append(_ordered(hull.points, corners, plane[:3]))
        members = {*corners.tolist(), *hull.simplices[remaining[0]].tolist()}
        remaining = [k for k in remaining if not members.issuperset(hull.simplices[k].tolist())]
    return [face for face in faces if face]


def _volume(points: np.ndarray, faces: list[tuple[int, ...]]) -> float:
    """Volume between plane faces: the sum of the pyramids from the origin to the faces."""
    volume = 0.0
    for face in faces:
        arms = points[list(face[1:])] - points[face[0]]
        volume += float(points[face[0]] @ np.cross(arms[:-1], arms[1:]).sum(axis=0)) / 6.0
    return volume


def _corners_on(plane: np.ndarray, points: np.ndarray, vertices: np.ndarray, flatness: float) -> np.ndarray:
    """The vertices (indices into points) within `flatness` of a plane (4,), without vertices behind other ones.

    Where a body is thinner than `flatness`, as a sheet or the tip of a wedge, its far side would otherwise count as a part of this face.
    """
    depth = -(points[vertices] @ plane[:3] + plane[3])
    near = np.abs(depth) <= flatness
    corners, depth = vertices[near], depth[near]
    deeper = depth[:, None] - depth[None, :]
    apart = np.linalg.norm(points[corners][:, None] - points[corners][None, :], axis=2)
    is_behind = (deeper > STEEP * apart) & (deeper > 0.0)  # behind a less deep corner, on a line that leads away from the plane
    return np.asarray(corners[~is_behind.any(axis=1)])


def _ordered(points: np.ndarray, corners: np.ndarray, normal: np.ndarray) -> tuple[int, ...]:
    """Corners of a face counter-clockwise about its outward normal, without corners inside the face; empty if they lie on one line."""
    if len(corners) < 3:
        return ()
    arms = points[corners] - points[corners].mean(axis=0)
    across = np.cross(normal, arms[0])
    flat = np.stack([arms @ across, arms @ np.cross(across, normal)], axis=1)
    order = np.argsort(np.arctan2(*flat.T))
    edge = np.roll(flat[order], -1, axis=0) - flat[order]
    after = np.roll(edge, -1, axis=0)
    if np.any(edge[:, 0] * after[:, 1] >= edge[:, 1] * after[:, 0]):  # angles count from the second axis, so a convex ring turns right
        try:
            order = order[np.isin(order, scipy.spatial.ConvexHull(flat).vertices)]
        except scipy.spatial.QhullError:
            return ()
    return tuple(corners[order].tolist())


def refuse_slivers(names: Sequence[str], shapes: Sequence[Shape]) -> None:
    """Raise SceneError for a block so thin that round-off decides the positions of its faces."""
    vertices = np.concatenate([shape.vertices for shape in shapes])
    start = np.concatenate([[0], np.cumsum([len(shape.vertices) for shape in shapes])[:-1]])
    low, high = np.minimum.reduceat(vertices, start), np.maximum.reduceat(vertices, start)
    extent, farthest = high - low, np.maximum(np.abs(low), np.abs(high)).max(axis=1)
    thin = ~(extent.min(axis=1) > np.maximum(FLATNESS * extent.max(axis=1), ROUND_OFF * farthest))
    if thin.any():
        k = int(np.argmax(thin))
        rule = f"is {extent[k].min():.3g} m thin, which is round-off beside its length or its distance from the origin"
        raise SceneError(f'block "{names[k]}"', rule, hint="make it thicker, or move the scene to the origin", blocks=[names[k]])
