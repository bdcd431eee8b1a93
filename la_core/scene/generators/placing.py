"""Profiles drawn out to solids between two faces that may lean, and solids turned in plan."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from la_core.geometry import Shape, compound, loft, prism

Corner = tuple[float, float]  # x and z, m
QUARTER = {0: (1.0, 0.0), 1: (0.0, 1.0), 2: (-1.0, 0.0), 3: (0.0, -1.0)}  # cosine and sine of quarter turns, without round-off


def leaning(profile: Sequence[Corner], foot: tuple[float, float], head: tuple[float, float], height: tuple[float, float]) -> Shape:
    """Solid of a profile between a front and a back face that are plane and lean; a compound where the profile is not convex.

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
    upright = prism(profile, (0.0, 1.0))  # checks the profile and turns it the right way round
    parts = []
    for part in upright.parts:
        corners = part.vertices[: len(part.vertices) // 2]
        share = ((corners[:, 2] - height[0]) / (height[1] - height[0]))[:, None]
        sides = [np.hstack([corners[:, :1], (1.0 - share) * foot[side] + share * head[side], corners[:, 2:]]) for side in (0, 1)]
        parts.append(loft(sides[0], sides[1]))
    return compound(parts)


def turned(shape: Shape, about: Sequence[float], degrees: float) -> Shape:
    """The shape after a turn about the vertical through a point (m), from x towards y; itself for a turn of 0."""
    if degrees == 0.0:
        return shape
    angle = math.radians(degrees)
    cosine, sine = QUARTER[int(degrees // 90.0) % 4] if degrees % 90.0 == 0.0 else (math.cos(angle), math.sin(angle))
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    return replace(shape, vertices=(shape.vertices - about) @ turn.T + about)
