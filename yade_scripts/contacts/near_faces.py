"""Faces near a contact sphere that it does not touch: a run does not look for new contacts while none can form.

With finite displacements a sphere may touch any face of any block. To find such contacts YADE needs a collider. For blocks that are no
boxes along the axes it also needs polyhedra, which it searches triangle by triangle. Most runs end long before a sphere comes near another
face. At the start a face plane lies between each sphere and each convex part near it. No contact forms until the two blocks have approached
each other across this plane by the gap between sphere and plane. So an attempt begins with the listed contacts alone. It is repeated with
the search if such a gap is used up, or if a contact point comes to the edge of its face.
"""

from collections.abc import Iterator

import numpy as np

from la_core.exchange import FREE
from yade_scripts.case import Case
from yade_scripts.contacts.rows import rows_of
from yade_scripts.contacts.sphere_placement import are_others
from yade_scripts.settings import Settings

NEAR = 10.0  # distance in travels beyond which parts are not watched; the attempt ends if a block has moved by half of this
LEFT = 0.1  # least remaining share of a gap, because blocks move on between two tests
_SAME_FACE = 0.05  # of a sphere's radius: a part of the partner block with a smaller gap continues the plane of the contact


class NearFaces:
    """Gaps between spheres and parts of blocks that they do not touch, and between contact points and the edges of their faces.

    Parameters
    ----------
    case : Case
        The case that runs.
    settings : Settings
        Settings of the attempt.

    Attributes
    ----------
    sphere, block : (N,) arrays
        Contact points whose spheres are near a part, and the blocks of these parts.
    faces : list of (f, 4) arrays
        Outward normals of the part's face planes, and their distances from the sphere at the start, m.
    normal, gap : (N, 3) and (N,) arrays
        Normal and distance, m, of the plane that is farthest from the sphere.
    on_face : (E,) array
        Contact points on faces that YADE models as the top of a wider box; one entry for each edge.
    edge : (E, 4) array
        Outward normal across the edge, and the distance of the contact point from it, m.
    """

    def __init__(self, case: Case, settings: Settings) -> None:
        self.case = case
        self._radius = settings.sphere_radius * case.own_inset / case.inset
        into_host = np.where((case.host == case.block_b)[:, None], case.normal, -case.normal)
        self._centre = case.position + self._radius[:, None] * into_host
        self._reach = NEAR * settings.max_travel * case.support_speed
        found = list(self._near_parts())
        self.faces = [planes for _, _, _, many in found for planes in many]
        self.sphere = np.concatenate([spheres for spheres, *_ in found])
        self.block = np.concatenate([np.full(len(spheres), block) for spheres, block, *_ in found])
        best = np.concatenate([np.zeros((0, 4)), *(nearest for _, _, nearest, _ in found)])
        self.normal, self.gap = best[:, :3], best[:, 3]
        self.on_face, self.edge = self._edges(into_host)
        around = zip(case.vertices, case.centroid, strict=True)
        self._size = np.array([np.linalg.norm(vertices - centroid, axis=1).max() for vertices, centroid in around])

    def _near_parts(self) -> Iterator[tuple[np.ndarray, int, np.ndarray, list[np.ndarray]]]:
        """Yield for each convex part its block, the spheres near it, and for each sphere the farthest plane and all planes of the part."""
        case, reach = self.case, self._reach + self._radius[:, None]
        axis = int(np.ptp(case.centroid, axis=0).argmax())  # along the longest axis the fewest spheres lie between the ends of a part
        order = np.argsort(self._centre[:, axis], kind="stable")
        centre, reach, host = self._centre[order], reach[order], case.host[order]
        along, farthest = centre[:, axis].copy(), reach.max(initial=0.0)
        for block, parts in enumerate(case.parts):
            for vertices, faces in zip(parts, case.faces[block], strict=True):
                low, high = vertices.min(axis=0), vertices.max(axis=0)
                first, last = along.searchsorted(low[axis] - farthest, "right"), along.searchsorted(high[axis] + farthest, "left")
                beside = slice(first, last)
                other = (host[beside] != block) & ((case.role[host[beside]] == FREE) | (case.role[block] == FREE))
                inside = (centre[beside] > low - reach[beside]) & (centre[beside] < high + reach[beside])
                spheres = np.sort(order[beside][other & inside.all(axis=1)])
                distance = self._centre[spheres] @ faces[:, :3].T - faces[:, 3] - self._radius[spheres, None]
                gap = distance.max(axis=1)
                of_partner = case.target[spheres] == block
                kept = np.flatnonzero(~of_partner | (gap > _SAME_FACE * self._radius[spheres]))
                planes = [np.column_stack([faces[:, :3], distance[one]]) for one in kept]
                yield spheres[kept], block, np.array([one[one[:, 3].argmax()] for one in planes]).reshape(-1, 4), planes

    def _edges(self, into_host: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the contact points on faces of convex blocks that are no boxes, and the planes across the edges of these faces."""
        case, points, planes = self.case, [np.zeros(0, dtype=int)], [np.zeros((0, 4))]
        for block, touching in enumerate(rows_of(case.target, len(case.parts))):
            if case.boxes[block] is not None or len(case.parts[block]) > 1:
                continue  # a box is exact; a compound block is watched part by part
            faces = case.faces[block][0]
            for point, is_other in zip(touching.tolist(), are_others(faces[:, :3], into_host[touching], case.plane), strict=True):
                others = faces[is_other]
                points.append(np.full(len(others), point))
                planes.append(np.column_stack([others[:, :3], others[:, 3] - others[:, :3] @ case.position[point]]))
        return np.concatenate(points), np.concatenate(planes)

    def are_met(self, displacement: np.ndarray, rotation: np.ndarray) -> bool:
        """Whether a sphere may have reached another face, for displacements (B, 3), m, and rotations (B, 3), rad, of the blocks."""
        if (np.linalg.norm(displacement, axis=1) + np.linalg.norm(rotation, axis=1) * self._size).max() > 0.5 * self._reach:
            return True
        moved = self._approach(self.sphere, self.block, self._centre, displacement, rotation)
        used_up = self.gap + np.einsum("ni,ni->n", moved, self.normal) <= LEFT * self.gap
        for pair in np.flatnonzero(used_up).tolist():  # another plane may still lie between the sphere and the part
            normal, distance = self.faces[pair][:, :3], self.faces[pair][:, 3]
            if (distance + normal @ moved[pair]).max() <= LEFT * self.gap[pair]:
                return True
        slid = self._approach(self.on_face, self.case.target[self.on_face], self.case.position, displacement, rotation)
        normal = self.case.normal[self.on_face]
        slid -= np.einsum("ni,ni->n", slid, normal)[:, None] * normal
        return bool((self.edge[:, 3] - np.einsum("ni,ni->n", slid, self.edge[:, :3]) <= LEFT * self.edge[:, 3]).any())

    def _approach(
        self, points: np.ndarray, blocks: np.ndarray, place: np.ndarray, displacement: np.ndarray, rotation: np.ndarray
    ) -> np.ndarray:
        """Return the motion (N, 3), m, of the hosts of contact points (N,) relative to blocks (N,), at the `place` (C, 3) of each point."""
        case, host, at = self.case, self.case.host[points], place[points]
        of_host = displacement[host] + np.cross(rotation[host], at - case.centroid[host])
        return of_host - displacement[blocks] - np.cross(rotation[blocks], at - case.centroid[blocks])
