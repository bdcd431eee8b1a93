"""Shapes gathered into blocks or turned, and the accuracy of their coordinates."""

import numpy as np

from la_core.geometry.blocks import Blocks
from la_core.geometry.shapes import Shape, polyhedron

EXACT = 1e-12  # m, on coordinates of order one: only sums and products of doubles
TURNED = 1e-9  # m, after a rotation and a convex hull


def gathered(*shapes: Shape, held: int = 0) -> Blocks:
    """Return blocks named a, b, c... The first `held` blocks are fixed."""
    roles = ["fixed"] * held + ["free"] * (len(shapes) - held)
    return Blocks.gather([chr(97 + k) for k in range(len(shapes))], roles, [1.0] * len(shapes), shapes)


def turned(shape: Shape, turn: np.ndarray, about: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Shape:
    centre = np.array(about)
    return polyhedron((shape.vertices - centre) @ turn.T + centre)
