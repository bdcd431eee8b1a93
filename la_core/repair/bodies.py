"""Convex bodies bounded by planes, and plane faces for bodies whose faces are bent by inexact corners.

The corners of a face of a surveyed body do not lie exactly on one plane. The hull of the body therefore has several facets there, and
slivers along the edges. Each of them would move by itself when joints are closed. A facet that does not move would cut off a part of the
joint, and the normal of a sliver is arbitrary.
"""

import heapq
from dataclasses import dataclass

import numpy as np
import scipy

from la_core.geometry import Shape, polyhedron

PLANE = 1e-7  # of a block's size: a corner this close to a plane lies on it
FIT = 1.5  # over the tolerance: largest distance of the corners of a narrow face from the plane of the face that it joins
NARROW = 2.0  # over the tolerance: the normal of a narrower face is arbitrary, and joints this short are dropped
FOLD = np.cos(np.radians(25.0))  # cosine of the largest angle between facets of one face: edges of blocks turn by more
FARTHEST = 2.0  # over the tolerance: largest distance of the new body beyond the old one, because deeper overlaps are not cut


def between(normal: np.ndarray, offset: np.ndarray, near: np.ndarray, least: float) -> Shape | None:
    """The convex body of all points with normal . x <= offset, m; None where no ball of more than the radius `least` (m) fits in it.

    normal (F, 3): outward unit normals of its faces. near (3,): a point close to the body, m.
    """
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
    """Facets of a hull with a common plane: corners, plane (4,), and second moments (4, 4) of their corners (x, y, z, 1) by area."""

    corners: np.ndarray
    plane: np.ndarray
    moments: np.ndarray

    @property
    def width(self) -> float:
        """Width of the face, m: the smaller of its two extents."""
        middle = self.moments[:3, 3] / self.moments[3, 3]
        spread = np.linalg.eigvalsh(self.moments[:3, :3] / self.moments[3, 3] - np.outer(middle, middle))
        return 2.0 * float(np.sqrt(max(spread[1], 0.0)))


def without_bent_faces(shape: Shape, tolerance: float) -> Shape:
    """Return a convex body with plane faces, for a convex body whose corners are right to the tolerance (m).

    With a tolerance of 0, or without triangles, the body is returned unchanged. Inexact corners split a face into triangles. A body without
    triangles keeps the facets of its curves.
    """
    return with_plane_faces(shape, tolerance) if tolerance > 0.0 and any(len(face) == 3 for face in shape.faces) else shape


def with_plane_faces(shape: Shape, tolerance: float) -> Shape:
    """Return a convex body with plane faces in place of faces bent by inexact corners; a body without bent faces is returned unchanged.

    Facets become one face where no corner is farther from its plane than the tolerance (m). The normal of a face narrower than twice the
    tolerance is arbitrary. Such a face joins a neighbour, and its corners may lie up to 1.5 times the tolerance off the common plane. The
    body is also returned unchanged where its new faces would meet far from it, as at the tip of a thin wedge.
    """
    centre = shape.vertices.mean(axis=0)
    hull = scipy.spatial.ConvexHull(shape.vertices - centre)
    planes = np.array([face.plane for face in _faces(hull, tolerance)])
    beyond = (hull.points @ planes[:, :3].T + planes[:, 3]).max(axis=0)
    planes = planes[beyond <= FIT * tolerance]  # the others are slivers that joined no face
    if not 4 <= len(planes) < len(shape.faces):
        return shape
    body = between(planes[:, :3], -planes[:, 3], np.zeros(3), tolerance)
    if body is None or np.max(body.vertices @ hull.equations[:, :3].T + hull.equations[:, 3]) > FARTHEST * tolerance:
        return shape
    return body.moved(lambda corners: corners + centre)


# The type is in quotes, so that scipy.spatial is loaded only where a body needs it.
def _faces(hull: "scipy.spatial.ConvexHull", tolerance: float) -> list[_Face]:
    """Faces of a hull: neighbouring facets are joined by the rules of `with_plane_faces`, the facets that fit best first."""
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
    """Join two faces on the plane that fits their facets best. Return the largest distance of a corner from it, m, and the joined face."""
    moments, corners = one.moments + two.moments, np.union1d(one.corners, two.corners)
    middle = moments[:3, 3] / moments[3, 3]
    normal = np.linalg.eigh(moments[:3, :3] / moments[3, 3] - np.outer(middle, middle))[1][:, 0]
    outward = one.moments[3, 3] * one.plane[:3] + two.moments[3, 3] * two.plane[:3]
    normal = normal if normal @ outward > 0.0 else -normal
    return float(np.abs((points[corners] - middle) @ normal).max()), _Face(corners, np.append(normal, -normal @ middle), moments)
