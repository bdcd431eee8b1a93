"""Displacements of second order in the rotations of the blocks.

A point at r on a block that turns by w moves by w x r + w x (w x r) / 2, and the axes of a joint turn with one of its blocks. The centroid
of a support that turns about an axis moves on a circle, too, by v + w x v / 2. The second order is tiny beside a block, but not beside the
strain of stiff joints: friction may lock in a thrust that rests on this strain alone, and turning blocks release it. Forces balance on
the geometry as laid, so that every plateau is one of limit analysis.
"""

import copy
from itertools import combinations_with_replacement

import numpy as np

from la_core.model import Assembly, twists_of

# Stiffness of the joints that a path represents, over that of its own joints. Only displacement over strain counts, so displacements on the
# path are STIFFER times those of the stiffer joints. The second order grows as their square, so a share of 1 / STIFFER of it counts.
STIFFER = 16.0


class Turning:
    """Second order of the displacements at the contact points of an assembly; the axes of its joints turn with block b.

    Parameters
    ----------
    assembly : Assembly
        Structure.
    unit : float
        Unit of displacement, m.
    motion : (B, 6) array
        Twists of the supports for their whole travel, m and rad.
    share : float
        Share of the second order that counts, above 0: 1 for the joints as they are, 1 / STIFFER for stiffer ones.
    """

    def __init__(self, assembly: Assembly, unit: float, motion: np.ndarray, share: float) -> None:
        self.share = share
        self._assembly, self._size, self._turns = assembly, share * unit, motion[:, 3:] / unit
        self._axes, self._width = assembly.axes, 2 if assembly.effects.plane else 3
        self._factors = np.array([[1, 1]] if assembly.effects.plane else list(combinations_with_replacement(range(3), 2))).T
        shown = self._axes[:, : self._width]
        a, b = assembly.contact_blocks
        self._axes_of = b
        arms = [assembly.points.position - assembly.blocks.centroid[block] for block in (a, b)]
        self._curved = np.concatenate([-self._curvature(shown, arms[0]), self._curvature(shown, arms[1])], axis=2)
        circled = 0.5 * np.cross(motion[:, 3:], motion[:, :3]) / unit**2
        self._circled = np.einsum("cj,ckj->ck", circled[b] - circled[a], shown)

    def with_axes_of_first(self) -> "Turning":
        """Return a copy whose axes turn with block a. Where corners meet, only the order of the blocks in the scene tells a from b."""
        other = copy.copy(self)
        other._axes_of = self._assembly.contact_blocks[0]
        return other

    def displacement(self, blocks: np.ndarray, progress: float, first: np.ndarray) -> np.ndarray:
        """Second order (C, k), over the unit.

        Parameters
        ----------
        blocks : (n,) array
            Displacements of the free blocks, scaled as in `ElasticJoints`.
        progress : float
            Motion of the supports over their travel.
        first : (C, k) array
            Relative displacements of first order, over the unit.
        """
        turns = twists_of(self._assembly, blocks)[:, 3:] + progress * self._turns
        a, b = self._assembly.contact_blocks
        products = turns[:, self._factors[0]] * turns[:, self._factors[1]]
        curved = np.einsum("ckp,cp->ck", self._curved, np.concatenate([products[a], products[b]], axis=1))
        second: np.ndarray = self._size * (curved + progress**2 * self._circled + self._as_axes_turn(first, turns[self._axes_of]))
        return second

    def _curvature(self, axes: np.ndarray, arm: np.ndarray) -> np.ndarray:
        """Part along each axis of w x (w x r) / 2 = (w (w r) - r w^2) / 2, as factors (C, k, p) of the products of components of w."""
        outer = axes[..., :, None] * arm[:, None, None, :]
        along = np.einsum("ckj,cj->ck", axes, arm)
        form = 0.5 * (outer - along[..., None, None] * np.eye(3))
        i, j = self._factors
        twice: np.ndarray = form[..., i, j] + np.where(i == j, 0.0, form[..., j, i])
        return twice

    def _as_axes_turn(self, first: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """Change (C, k) of the components of displacements (C, k) as the axes turn by (C, 3)."""
        about = np.einsum("ckj,cj->ck", self._axes, turn)
        return about[:, 2:] * first[:, ::-1] * np.array([1.0, -1.0]) if self._width == 2 else np.cross(first, about)
