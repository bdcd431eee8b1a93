"""Springs or dashpots at the contact points, as an operator on the blocks' twists."""

from dataclasses import dataclass

import numpy as np

from yade_scripts.case import Case

_PLANE_FREEDOMS = np.array([1.0, 0.0, 1.0, 0.0, 1.0, 0.0])


@dataclass(frozen=True)
class Springs:
    """Bilateral springs, or dashpots, at every contact point, as an operator K. No matrix of the structure is built.

    The operator acts on the twists (B, 6) of the blocks about their centroids; the twists of held blocks stay 0.

    Attributes
    ----------
    case : Case
        B blocks and C contact points.
    normal, shear : np.ndarray
        Stiffness (C,) of every contact point along its normal and across it, N/m; for dashpots the viscosity, N s/m.
    arm_a, arm_b : np.ndarray
        Arms (C, 3) from the centroids of blocks a and b to the contact points, m.
    freedoms : np.ndarray
        1.0 for each free component of the twists (B, 6), 0.0 for the others.
    """

    case: Case
    normal: np.ndarray
    shear: np.ndarray
    arm_a: np.ndarray
    arm_b: np.ndarray
    freedoms: np.ndarray

    def contact_forces(self, twists: np.ndarray) -> np.ndarray:
        """Return the spring forces (C, 3), N, as stiffness times the displacement of b relative to a; twists (B, 6), m and rad."""
        case = self.case
        of_a, of_b = twists[case.block_a], twists[case.block_b]
        relative = of_b[:, :3] + _cross(of_b[:, 3:], self.arm_b) - of_a[:, :3] - _cross(of_a[:, 3:], self.arm_a)
        along = np.einsum("ci,ci->c", relative, case.normal)[:, None] * case.normal
        return self.shear[:, None] * relative + (self.normal - self.shear)[:, None] * along

    def stiffness(self, twists: np.ndarray) -> np.ndarray:
        """Return K times twists (B, 6): generalised forces (B, 6), N and N m."""
        force = self.contact_forces(twists)
        case = self.case
        on_b = np.hstack([force, _cross(self.arm_b, force)])
        on_a = -np.hstack([force, _cross(self.arm_a, force)])
        blocks = np.concatenate([case.block_a, case.block_b])
        weights = np.vstack([on_a, on_b])
        total = np.column_stack([np.bincount(blocks, weights[:, i], len(case.mass)) for i in range(6)])
        return total * self.freedoms

    def of_blocks(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the stiffness (B, 3, 3) of every block in translation, N/m, and in rotation, N m/rad, with all other blocks held."""
        case, normal = self.case, self.case.normal
        along = normal[:, :, None] * normal[:, None, :]
        each = self.shear[:, None, None] * np.eye(3) + (self.normal - self.shear)[:, None, None] * along
        shifting, turning = np.zeros((2, len(case.mass), 3, 3))
        for block, arm in ((case.block_a, self.arm_a), (case.block_b, self.arm_b)):
            lever = np.cross(np.eye(3)[None], arm[:, None])  # displacement at the contact point by a unit rotation about each axis
            np.add.at(shifting, block, each)
            np.add.at(turning, block, lever @ each @ np.swapaxes(lever, 1, 2))
        movable = self.freedoms[:, :, None] * self.freedoms[:, None, :]
        return shifting * movable[:, :3, :3], turning * movable[:, 3:, 3:]


def _cross(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return the cross products of vectors (n, 3); numpy.cross spends most of its time on axes if there are few vectors."""
    return left[:, [1, 2, 0]] * right[:, [2, 0, 1]] - left[:, [2, 0, 1]] * right[:, [1, 2, 0]]


def springs_of(case: Case, normal: np.ndarray | float, shear: np.ndarray | float) -> Springs:
    """Return springs of `normal` and `shear` stiffness (N/m), one value for all contact points or one (C,) for each."""
    freedoms = np.outer(np.isin(np.arange(len(case.mass)), case.free), _PLANE_FREEDOMS if case.plane else np.ones(6))
    arm_a, arm_b = case.position - case.centroid[case.block_a], case.position - case.centroid[case.block_b]
    normal, shear = (np.broadcast_to(stiffness, len(case.position)) for stiffness in (normal, shear))
    return Springs(case, normal, shear, arm_a, arm_b, freedoms.astype(float))
