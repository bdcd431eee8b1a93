"""The answer of a plane model held against the model in space: what leaving out motion out of the plane rests on."""

from dataclasses import replace

import numpy as np

from la_core.geometry import ContactPoints, contact_points
from la_core.measures import residuals
from la_core.model import Assembly


def in_space(assembly: Assembly, forces: np.ndarray) -> tuple[Assembly, np.ndarray]:
    """The model in space of a plane assembly, and contact forces (C, 3) shared equally by the points that each plane point stands for."""
    plane = assembly.points
    points = contact_points(assembly.blocks, assembly.interfaces, 0.0, assembly.inset, plane=False)
    ends = np.stack([2 * points.interface, 2 * points.interface + 1], axis=1)  # a plane interface has two points, in its own order
    away = np.linalg.norm((plane.position[ends] - points.position[:, None])[..., [0, 2]], axis=2)
    end = ends[np.arange(len(ends)), away.argmin(axis=1)]
    share = np.bincount(end, minlength=len(plane))
    solid = ContactPoints(points.interface, points.position, plane.friction[end])
    space = replace(assembly, points=solid, effects=replace(assembly.effects, plane=False))
    return space, forces[end] / share[end, None]


def residual_in_space(assembly: Assembly, twists: np.ndarray, forces: np.ndarray) -> float:
    """Worst residual in space of a plane answer to a settlement.

    Equilibrium and cones are over the mean block weight, penetration is over the fastest block.
    """
    space, shared = in_space(assembly, forces)
    return max(
        residuals.equilibrium_residual(space, shared),
        residuals.cone_violation(space, shared),
        residuals.penetration(space, twists),
    )
