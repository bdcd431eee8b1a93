"""Common planes of opposite faces, within a tolerance.

A bed joint lies on one plane, because every block of a course lies on several blocks below. So faces are gathered in
groups. The pair that is most nearly parallel comes first, then every pair whose two groups still fit a common plane, and
finally faces that lie side by side. The plane is fitted to the points half way between the faces.
"""

from dataclasses import dataclass

import numpy as np

from la_core.geometry import Blocks
from la_core.repair.facing import Facing, face_areas

OWN_CORNERS = 1e-3  # weight of the corners of the faces over the points half way: they decide the plane where an overlap is only a strip
ROUNDS = 3  # a pair refused at first may fit once its groups have grown
SAME_ANGLE = 0.01  # rad: step of the angles by which pairs are ordered; pairs in one step are ordered by the area of their overlap


@dataclass
class Group:
    """Faces with a common plane, while groups grow.

    weight, first (3,), second (3, 3): sum of the weights of its points, and their first and second moments. normal (3,), offset (m): the
    plane. faces, corners (q, 3), limits (q,): faces, their corners, and the largest distance of each corner from the plane, m. They are
    arrays, so that two long groups are joined without a loop.
    """

    weight: float
    first: np.ndarray
    second: np.ndarray
    normal: np.ndarray
    offset: float
    faces: np.ndarray
    corners: np.ndarray
    limits: np.ndarray


def planes_closing_most(
    parts: Blocks, owner: np.ndarray, pairs: Facing, twins: np.ndarray, limit: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Common planes by `common_planes`, fitted with or without the cuts between parts of one block, whichever closes more pairs.

    A cut in line with a joint keeps the common plane where it was drawn. But it may also prevent the faces of a thin part from moving.
    owner: (P,), the block of each part; the other parameters are those of `common_planes`.
    """
    block = owner[parts.face_block]
    inner = block[pairs.face_a] == block[pairs.face_b]
    tried = [common_planes(parts, pairs, twins, limit, idle) for idle in ((None, inner) if inner.any() else (None,))]
    return max(tried, key=lambda planes: int(planes[2].sum()))


def common_planes(
    parts: Blocks, pairs: Facing, twins: np.ndarray, limit: np.ndarray, idle: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Gather faces on common planes.

    Parameters
    ----------
    parts : Blocks
        Convex parts with F faces.
    pairs : Facing
        L pairs of opposite faces.
    twins : (T, 2) array of int
        Pairs of faces of one block that lie on one plane and must stay there.
    limit : (F,) array
        Largest distance of the corners of each face from the common plane, m.
    idle : (L,) array of bool, optional
        Pairs that have no influence on the plane of their group.

    Returns
    -------
    normal : (F, 3) array
        Unit normal of each face, also of faces in no group.
    offset : (F,) array
        Offset of the plane of each face, m.
    closed : (L,) array of bool
        Pairs that now lie on one plane.
    """
    groups = _Groups(parts, np.unique(np.concatenate([pairs.face_a, pairs.face_b, pairs.aligned.ravel(), twins.ravel()])), limit)
    nothing = (0.0, np.zeros(3), np.zeros((3, 3)))
    for face, other in twins.tolist():
        groups.join(face, other, nothing, opposite=False)
    closed = np.zeros(len(pairs), dtype=bool)
    is_idle = np.zeros(len(pairs), dtype=bool) if idle is None else idle
    left = np.lexsort((-pairs.area, np.floor(pairs.angle / SAME_ANGLE)))
    for _ in range(ROUNDS):
        for k in left.tolist():
            points = pairs.middle[pairs.start[k] : pairs.start[k + 1]]
            share = pairs.area[k] / len(points)
            sums = (float(pairs.area[k]), share * points.sum(axis=0), share * points.T @ points)
            sums = nothing if is_idle[k] else sums
            closed[k] = groups.join(int(pairs.face_a[k]), int(pairs.face_b[k]), sums, opposite=True)
        if not closed[left].any() or closed.all():
            break
        left = left[~closed[left]]
    for face, other in pairs.aligned.tolist():
        groups.join(face, other, nothing, opposite=True)
    return *groups.planes(), closed


class _Groups:
    """Groups of faces while they are joined. The number of a group is the number of one of its faces.

    members: faces (M,) that may be joined; each is a group of its own at first. limit: as for `common_planes`.
    """

    def __init__(self, parts: Blocks, members: np.ndarray, limit: np.ndarray) -> None:
        areas = face_areas(parts)[members]
        self._parts = parts
        self._groups = {face: _single(parts, face, area, limit[face]) for face, area in zip(members.tolist(), areas, strict=True)}
        self._place = np.arange(len(parts.face_normal))  # group of each face
        self._side = np.ones(len(self._place))  # 1 where the normal of a face points as that of its group, else -1

    def join(self, face: int, other: int, sums: tuple[float, np.ndarray, np.ndarray], opposite: bool) -> bool:
        """Join the groups of two faces if they fit a common plane. Return whether the faces lie on one plane with the stated directions.

        sums: weight, first and second moments of the points half way between the faces. opposite: whether the normals must be opposite.
        """
        number, merged = int(self._place[face]), int(self._place[other])
        one, two = self._groups[number], self._groups[merged]
        sign = float(self._side[face] * self._side[other]) * (-1.0 if opposite else 1.0)
        if one is two:
            return sign > 0.0
        joined = _joined(one, two, sums)
        if joined is None:
            return False
        self._groups[number] = joined
        del self._groups[merged]
        self._place[two.faces] = number
        self._side[two.faces] *= sign
        return True

    def planes(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the unit normal (F, 3) of every face and the offset (F,) of its plane, m; a face that was not joined keeps its plane."""
        normal, offset = self._parts.face_normal.copy(), self._parts.face_offset.copy()
        for group in self._groups.values():
            if len(group.faces) > 1:
                signs = self._side[group.faces]
                normal[group.faces], offset[group.faces] = signs[:, None] * group.normal, signs * group.offset
        return normal, offset


def _single(parts: Blocks, face: int, area: float, limit: float) -> Group:
    corners = parts.vertices[parts.face_vertex[parts.face_start[face] : parts.face_start[face + 1]]]
    share = OWN_CORNERS * area / len(corners)
    sums = share * len(corners), share * corners.sum(axis=0), share * corners.T @ corners
    return Group(*sums, parts.face_normal[face], parts.face_offset[face], np.array([face]), corners, np.full(len(corners), limit))


def _joined(one: Group, two: Group, sums: tuple[float, np.ndarray, np.ndarray]) -> Group | None:
    """Both groups on one plane, or None where a corner would lie farther from it than its limit. sums: as in `_Groups.join`."""
    weight, first, second = one.weight + two.weight + sums[0], one.first + two.first + sums[1], one.second + two.second + sums[2]
    centre = first / weight
    faces, corners, limits = (np.concatenate([getattr(group, name) for group in (one, two)]) for name in ("faces", "corners", "limits"))
    _, axes = np.linalg.eigh(second / weight - np.outer(centre, centre))
    normal = axes[:, 0] * (1.0 if axes[:, 0] @ one.normal >= 0.0 else -1.0)
    if np.any(np.abs((corners - centre) @ normal) > limits):
        return None
    return Group(weight, first, second, normal, float(normal @ centre), faces, corners, limits)
