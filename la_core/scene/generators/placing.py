"""Profiles extruded between two faces that may lean, and solids turned in plan."""

import math
from collections.abc import Sequence

import numpy as np

from la_core.geometry import Shape, prism

Corner = tuple[float, float]  # x and z, m
QUARTER = {0: (1.0, 0.0), 1: (0.0, 1.0), 2: (-1.0, 0.0), 3: (0.0, -1.0)}  # cosine and sine of quarter turns, without round-off


def leaning(profile: Sequence[Corner], foot: tuple[float, float], head: tuple[float, float], height: tuple[float, float]) -> Shape:
    """Solid of a profile between a plane front face and a plane back face that may lean; a compound where the profile is not convex.

    Parameters
    ----------
    profile : sequence of Corner
        Corners (x, z), m.
    foot, head : tuple of float
        y of the front and of the back at the two heights, m.
    height : tuple of float
        z of the foot and of the head, m.

    Raises ValueError for a profile that crosses itself or has no area.
    """
    if foot == head:
        return prism(profile, foot)

    def lean(points: np.ndarray) -> np.ndarray:
        """Positions (..., 3) in the solid, m, of points (..., 3) in an upright prism of unit depth."""
        share, side = (points[..., 2] - height[0]) / (height[1] - height[0]), points[..., 1]
        front, back = ((1.0 - share) * foot[k] + share * head[k] for k in (0, 1))
        return np.stack([points[..., 0], np.where(side == 0.0, front, back), points[..., 2]], axis=-1)

    return prism(profile, (0.0, 1.0)).moved(lean)


def turned(shape: Shape, about: Sequence[float], degrees: float) -> Shape:
    """The shape after a turn about the vertical through a point (m), from x towards y; itself for a turn of 0."""
    if degrees == 0.0:
        return shape
    angle = math.radians(degrees)
    cosine, sine = QUARTER[int(degrees // 90.0) % 4] if degrees % 90.0 == 0.0 else (math.cos(angle), math.sin(angle))
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return shape.moved(lambda points: (points - about) @ turn.T + about)
