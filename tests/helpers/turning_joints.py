"""Elastic joints on blocks that turn by more than an infinitesimal angle: what limit analysis leaves out, and YADE does not."""

import numpy as np

from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.model import twists_of


class TurningJoints(ElasticJoints):
    """Joints whose displacements are of second order in the rotations of the blocks; all forces balance on the geometry as laid.

    A point at r on a block that turns by w moves by w x r + w x (w x r) / 2, and the axes of a joint turn with block b. The second
    order is small beside a block, but not beside the strain of stiff joints, which holds a thrust.
    """

    def displacement(self, blocks: np.ndarray, progress: float) -> np.ndarray:
        """Relative displacements (C, k) for displacements (n,) of the free blocks and the support's motion over its travel."""
        first = super().displacement(blocks, progress)
        assembly = self.assembly
        rotations = self.unit * twists_of(assembly, blocks)[:, 3:]
        axes = assembly.axes[:, : self.width]
        curved = np.zeros_like(assembly.points.position)
        for block, sign in zip(assembly.contact_blocks, (-1.0, 1.0), strict=True):
            turn, arm = rotations[block], assembly.points.position - assembly.blocks.centroid[block]
            curved += 0.5 * sign * np.cross(turn, np.cross(turn, arm))
        turned = np.cross(rotations[assembly.contact_blocks[1]][:, None, :], axes)
        moved = self.unit * np.einsum("ck,ckj->cj", first, axes)
        second: np.ndarray = np.einsum("cj,ckj->ck", curved, axes) + np.einsum("cj,ckj->ck", moved, turned)
        return first + second / self.unit
