"""The inertia of the blocks in a quasi-static run: free to choose, because only forces that balance count.

The fastest swing of a few blocks dictates the time step of all. So their inertia is made larger, and their weight stays. A block on
corner contacts turns up to 1.7 times as fast as it shifts: its moment of inertia grows until it turns as slowly as it shifts. And the
blocks that shift fastest, which are light for their contacts, gain inert mass, up to a share of the mass of all blocks.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from yade_scripts.case import Case
from yade_scripts.vibration.springs import Springs

# Largest factor on a block's mass. Its weight must still accelerate it as the supports move, on the ramp by about 1e-3 g.
MOST = 100.0
_BISECTIONS = 60


@dataclass(frozen=True)
class Inertia:
    """Resistance of B blocks to acceleration.

    Attributes
    ----------
    mass : np.ndarray
        Mass (B,), kg; weights are not those of this mass.
    tensor : np.ndarray
        Moment of inertia (B, 3, 3) about the centroid in global axes, kg m2; of plane cases that of the plane in every direction.
    """

    mass: np.ndarray
    tensor: np.ndarray

    def accelerations(self, wrenches: np.ndarray) -> np.ndarray:
        """Return the accelerations (B, 6), m/s2 and rad/s2, by forces and moments (B, 6), N and N m."""
        return np.hstack([wrenches[:, :3] / self.mass[:, None], np.einsum("bij,bj->bi", self._inverse, wrenches[:, 3:])])

    @cached_property
    def _inverse(self) -> np.ndarray:
        return np.linalg.inv(self.tensor)


def slowed(case: Case, springs: Springs, added: float) -> Inertia:
    """Return the inertia of a run: rotations as slow as translations, and `added` times the mass of the free blocks on the fastest of them.

    Parameters
    ----------
    case : Case
        B blocks.
    springs : Springs
        Springs at the contact points.
    added : float
        Share of the mass of all free blocks; 0 for the true inertia.
    """
    true = Inertia(case.mass, case.inertia[:, 1, 1, None, None] * np.eye(3) if case.plane else case.inertia)
    if added == 0.0:
        return true
    free, (shifting, turning) = case.free, springs.of_blocks()
    stiffness = np.linalg.eigvalsh(shifting[free])[:, -1]
    mass = true.mass.copy()
    mass[free] = _levelled(stiffness, true.mass[free], added)
    fastest = np.linalg.eigvals(np.linalg.solve(true.tensor[free], turning[free])).real.max(axis=1)
    ratio = np.divide(fastest * mass[free], stiffness, out=np.ones(len(free)), where=stiffness > 0.0)
    factor = np.ones(len(mass))
    factor[free] = np.clip(ratio, 1.0, MOST)
    return Inertia(mass, factor[:, None, None] * true.tensor)


def _levelled(stiffness: np.ndarray, mass: np.ndarray, added: float) -> np.ndarray:
    """Return masses (n,) that lower the largest of stiffness over mass as far as `added` times the whole mass allows."""
    high = float((stiffness / mass).max())
    low = high / MOST  # the fastest block cannot be made slower than this, and to slow the others down further would be of no use
    for _ in range(_BISECTIONS if high > 0.0 else 0):
        level = 0.5 * (low + high)
        if (np.maximum(mass, stiffness / level) - mass).sum() > added * mass.sum():
            low = level
        else:
            high = level
    return np.maximum(mass, stiffness / high) if high > 0.0 else mass
