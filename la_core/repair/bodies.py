"""Convex bodies behind planes, and bodies whose faces inexact corners have bent.

A face of a surveyed body has corners beside its plane, so that its hull has several facets there, and slivers along its edges. Each would
move by itself when joints are closed: a facet that stays cuts a part of the joint off, and a sliver has no direction of its own.
"""

import heapq
from dataclasses import dataclass

import numpy as np
import scipy

from la_core.geometry import Shape, polyhedron

PLANE = 1e-7  # of a block's size: a corner this close to a plane lies on it
FIT = 1.5  # over the tolerance: largest distance of the corners of a narrow face from that which takes it in
NARROW = 2.0  # over the tolerance: a narrower face has no direction, and joints as short as this are dropped
FOLD = np.cos(np.radians(25.0))  # of the angle between facets that may be one face: edges of blocks turn by more
FARTHEST = 2.0  # over the tolerance: so far a body may reach beyond its facets at its edges, for deeper overlaps are not parted


def between(normal: np.ndarray, offset: np.ndarray, near: np.ndarray, least: float) -> Shape | None:
    """The convex body behind all these planes; None where no ball of the radius `least` (m) fits in it. near: a point (3,) beside it."""
    height = offset - normal @ near
    ball = scipy.optimize.linprog(
        [0.0, 0.0, 0.0, -1.0], A_ub=np.column_stack([normal, np.ones(len(normal))]), b_ub=height, bounds=[(None, None)] * 4
    )
    if not ball.success or ball.x[3] <= least:
        return None
    try:
        with np.errstate(divide="ignore", invalid="ignore"):  # planes that enclose no body meet at infinity
            found = scipy.spatial.HalfspaceIntersection(np.column_stack([normal, -offset]), near + ball.x[:3])
        # The planes are exact: a cut that takes little off a corner must not tilt the face beside it.
        return polyhedron(np.unique(np.round(found.intersections, 12), axis=0).tolist(), flatness=PLANE)
    except (scipy.spatial.QhullError, ValueError):
        return None


@dataclass(frozen=True)
class _Face:
    """Facets of a hull with a common plane: corners, plane (4,), and moments (4, 4) of their corners by area."""

    corners: np.ndarray
    plane: np.ndarray
    moments: np.ndarray

    @property
    def width(self) -> float:
        """Width, m: the lesser of its two extents."""
        middle = self.moments[:3, 3] / self.moments[3, 3]
        spread = np.linalg.eigvalsh(self.moments[:3, :3] / self.moments[3, 3] - np.outer(middle, middle))
        return 2.0 * float(np.sqrt(max(spread[1], 0.0)))


def without_bent_faces(shape: Shape, tolerance: float) -> Shape:
    """A convex body of corners that are right to the tolerance (m), with plane faces; itself without a tolerance or without triangles.

    Inexact corners split a face into triangles. A body without triangles keeps the facets of its curves.
    """
    return with_plane_faces(shape, tolerance) if tolerance > 0.0 and any(len(face) == 3 for face in shape.faces) else shape


def with_plane_faces(shape: Shape, tolerance: float) -> Shape:
    """A convex body whose faces are plane, for one with faces that inexact corners have bent; itself where it has no such face.

    Facets become one face where no corner is farther from it than the tolerance (m). A face narrower than twice the tolerance has no
    direction of its own: it becomes a part of one beside it, from which its corners may be farther, by 1.5 times the tolerance. The body
    stays as it is where its faces would meet far from it, as at the tip of a thin wedge.
    """
    centre = shape.vertices.mean(axis=0)
    hull = scipy.spatial.ConvexHull(shape.vertices - centre)
    planes = np.array([face.plane for face in _faces(hull, tolerance)])
    beyond = (hull.points @ planes[:, :3].T + planes[:, 3]).max(axis=0)
    planes = planes[beyond <= FIT * tolerance]  # others are slivers that no face took in
    if not 4 <= len(planes) < len(shape.faces):
        return shape
    body = between(planes[:, :3], -planes[:, 3], np.zeros(3), tolerance)
    if body is None or np.max(body.vertices @ hull.equations[:, :3].T + hull.equations[:, 3]) > FARTHEST * tolerance:
        return shape
    return body.moved(lambda corners: corners + centre)


# The type is in quotes, so that scipy.spatial is loaded only where a body needs it.
def _faces(hull: "scipy.spatial.ConvexHull", tolerance: float) -> list[_Face]:
    """Faces of neighbouring facets of a hull, joined as `with_plane_faces` says; those that fit best are joined first."""
    corners = hull.points[hull.simplices]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    columns = np.concatenate([corners, np.ones((len(area), 3, 1))], axis=2)
    moments = area[:, None, None] * np.einsum("fki,fkj->fij", columns, columns)
    faces = {number: _Face(*face) for number, face in enumerate(zip(hull.simplices, hull.equations, moments, strict=True))}
    beside = {number: set(row) for number, row in enumerate(hull.neighbors.tolist())}

    def misfit(one: int, two: int) -> tuple[float, int, int]:
        is_narrow = min(faces[one].width, faces[two].width) < NARROW * tolerance
        return _joined(hull.points, faces[one], faces[two])[0] / ((FIT if is_narrow else 1.0) * tolerance), one, two

    queue = [misfit(one, two) for one in faces for two in beside[one] if one < two]
    heapq.heapify(queue)
    number = len(faces)
    while queue:
        least, one, two = heapq.heappop(queue)
        if least > 1.0:
            break
        if one not in faces or two not in faces:
            continue
        face = _joined(hull.points, faces[one], faces[two])[1]
        larger = max(faces[one], faces[two], key=lambda some: float(some.moments[3, 3]))
        if face.plane[:3] @ larger.plane[:3] < FOLD:
            continue
        del faces[one], faces[two]
        faces[number], beside[number] = face, (beside.pop(one) | beside.pop(two)) - {one, two}
        for other in beside[number]:
            beside[other] = beside[other] - {one, two} | {number}
            heapq.heappush(queue, misfit(number, other))
        number += 1
    return list(faces.values())


def _joined(points: np.ndarray, one: _Face, two: _Face) -> tuple[float, _Face]:
    """Both faces as one, on the plane that fits their facets best, and the largest distance of a corner from it, m."""
    moments, corners = one.moments + two.moments, np.union1d(one.corners, two.corners)
    middle = moments[:3, 3] / moments[3, 3]
    normal = np.linalg.eigh(moments[:3, :3] / moments[3, 3] - np.outer(middle, middle))[1][:, 0]
    outward = one.moments[3, 3] * one.plane[:3] + two.moments[3, 3] * two.plane[:3]
    normal = normal if normal @ outward > 0.0 else -normal
    return float(np.abs((points[corners] - middle) @ normal).max()), _Face(corners, np.append(normal, -normal @ middle), moments)
