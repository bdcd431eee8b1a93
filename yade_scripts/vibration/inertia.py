"""The inertia of the blocks in a quasi-static run. It may be chosen freely, because only the balance of forces counts.

The fastest vibration of a few blocks determines the time step of all. So their inertia is increased, and their weight is kept. A block on
corner contacts vibrates up to 1.7 times as fast in rotation as in translation: its moment of inertia is increased until the rotation
vibrates as slowly as the translation. The blocks with the fastest vibration in translation are light for the stiffness of their contacts:
they gain inert mass, up to a share of the mass of all blocks.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from yade_scripts.case import Case
from yade_scripts.vibration.springs import Springs

# Largest factor on a block's mass. Its weight must still accelerate it as the supports move, on the ramp by about 1e-3 g.
MOST = 100.0
# Largest factor under a live load. The multiplier grows until the moving blocks have gained their speed. With more inertia on a light block
# it would grow farther, up to a load at which heavier blocks move, too.
MOST_PUSHED = 10.0
_BISECTIONS = 60


@dataclass(frozen=True)
class Inertia:
    """Resistance of B blocks to acceleration.

    Attributes
    ----------
    mass : np.ndarray
        Inert mass (B,), kg; the weights are those of the true mass.
    tensor : np.ndarray
        Moment of inertia (B, 3, 3) about the centroid in global axes, kg m2; in plane cases the moment in the plane about every axis.
    """

    mass: np.ndarray
    tensor: np.ndarray

    def accelerations(self, wrenches: np.ndarray) -> np.ndarray:
        """Return the accelerations (B, 6), m/s2 and rad/s2, under forces and moments (B, 6), N and N m."""
        return np.hstack([wrenches[:, :3] / self.mass[:, None], np.einsum("bij,bj->bi", self._inverse, wrenches[:, 3:])])

    @cached_property
    def _inverse(self) -> np.ndarray:
        return np.linalg.inv(self.tensor)


def slowed(case: Case, springs: Springs, added: float, most: float = MOST) -> Inertia:
    """Return the inertia of a run: rotations vibrate as slowly as translations, and the fastest free blocks have added mass.

    Parameters
    ----------
    case : Case
        B blocks.
    springs : Springs
        Springs at the contact points.
    added : float
        Added mass over the mass of all free blocks; 0 for the true inertia.
    most : float
        Largest factor on a mass, and on a moment of inertia.
    """
    true = Inertia(case.mass, case.inertia[:, 1, 1, None, None] * np.eye(3) if case.plane else case.inertia)
    if added == 0.0:
        return true
    free, (shifting, turning) = case.free, springs.of_blocks()
    stiffness = np.linalg.eigvalsh(shifting[free])[:, -1]
    mass = true.mass.copy()
    mass[free] = _levelled(stiffness, true.mass[free], added, most)
    fastest = np.linalg.eigvals(np.linalg.solve(true.tensor[free], turning[free])).real.max(axis=1)
    ratio = np.divide(fastest * mass[free], stiffness, out=np.ones(len(free)), where=stiffness > 0.0)
    factor = np.ones(len(mass))
    factor[free] = np.clip(ratio, 1.0, most)
    return Inertia(mass, factor[:, None, None] * true.tensor)


def _levelled(stiffness: np.ndarray, mass: np.ndarray, added: float, most: float = MOST) -> np.ndarray:
    """Return masses (n,) with the lowest possible maximum of stiffness over mass, for an added mass of at most `added` times the total.

    most: largest factor on a mass.
    """
    high = float((stiffness / mass).max())
    low = high / most  # the fastest block cannot become slower than this, so slower other blocks would not help
    for _ in range(_BISECTIONS if high > 0.0 else 0):
        level = 0.5 * (low + high)
        if (np.maximum(mass, stiffness / level) - mass).sum() > added * mass.sum():
            low = level
        else:
            high = level
    return np.maximum(mass, stiffness / high) if high > 0.0 else mass
