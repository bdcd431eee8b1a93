"""Faces near a contact sphere that it does not touch: a run looks for no new contact while none can form.

With finite displacements a sphere may meet any face of any block. To look for such contacts YADE needs a collider and, for blocks that
are no boxes along the axes, polyhedra, which it searches triangle by triangle. Most runs end long before a sphere comes near another face.
Each sphere lies beyond a face plane of each convex part near it, which separates the two as long as neither block has moved by the gap
between sphere and plane. So an attempt begins with the listed contacts alone, and is repeated with the search where such a gap is used up.
"""

import numpy as np

from yade_scripts.case import FREE, Case
from yade_scripts.settings import Settings

NEAR = 10.0  # travels: parts farther from a sphere are met only after their blocks moved by half of this, which is looked at as well
LEFT = 0.1  # of the gap: what must be left of it, for blocks move on between two looks


class NearFaces:
    """The gaps between spheres and the parts of blocks that they do not touch, at the start of an attempt and as it goes on.

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
        Those of the plane that is farthest from the sphere.
    """

    def __init__(self, case: Case, settings: Settings) -> None:
        self.case = case
        host, on_b = case.host, case.host == case.block_b
        radius = settings.sphere_radius * case.own_inset / case.inset
        centre = case.position + radius[:, None] * np.where(on_b[:, None], case.normal, -case.normal)
        self._reach = NEAR * settings.max_travel * case.support_speed
        found, self.faces = [], []
        for block, parts in enumerate(case.parts):
            other = (host != block) & (case.target != block) & ((case.role[host] == FREE) | (case.role[block] == FREE))
            for vertices, faces in zip(parts, case.faces[block], strict=True):
                low, high = vertices.min(axis=0) - self._reach, vertices.max(axis=0) + self._reach
                near = np.flatnonzero(other & ((centre > low) & (centre < high)).all(axis=1))
                beyond = centre[near] @ faces[:, :3].T - faces[:, 3] - radius[near, None]
                best = beyond.argmax(axis=1)
                found.append((near, np.full(len(near), block), faces[best, :3], beyond.max(axis=1)))
                self.faces += [np.column_stack([faces[:, :3], distances]) for distances in beyond]
        self.sphere, self.block, self.normal, self.gap = (np.concatenate(arrays) for arrays in zip(*found, strict=True))
        self._arm_host = centre[self.sphere] - case.centroid[host[self.sphere]]
        self._arm_block = centre[self.sphere] - case.centroid[self.block]
        around = zip(case.vertices, case.centroid, strict=True)
        self._size = np.array([np.linalg.norm(vertices - centroid, axis=1).max() for vertices, centroid in around])

    def are_met(self, displacement: np.ndarray, rotation: np.ndarray) -> bool:
        """Whether a sphere may have come to another face, for displacements (B, 3), m, and rotations (B, 3), rad, of the blocks."""
        if (np.linalg.norm(displacement, axis=1) + np.linalg.norm(rotation, axis=1) * self._size).max() > 0.5 * self._reach:
            return True
        host = self.case.host[self.sphere]
        moved = displacement[host] - displacement[self.block]
        moved += np.cross(rotation[host], self._arm_host) - np.cross(rotation[self.block], self._arm_block)
        used_up = self.gap + np.einsum("ni,ni->n", moved, self.normal) <= LEFT * self.gap
        for pair in np.flatnonzero(used_up).tolist():  # another plane may still be between the two
            normal, distance = self.faces[pair][:, :3], self.faces[pair][:, 3]
            if (distance + normal @ moved[pair]).max() <= LEFT * self.gap[pair]:
                return True
        return False
