"""Check of a plane answer in the model in space: small residuals justify the plane model."""

from dataclasses import replace

import numpy as np

from la_core.geometry import contact_points
from la_core.measures import residuals
from la_core.model import Assembly


def in_space(assembly: Assembly, forces: np.ndarray) -> tuple[Assembly, np.ndarray]:
    """The model in space of a plane assembly, and its contact forces (C, 3) in N.

    The points in space that one plane point represents share its force (rows of `forces`, N) equally.
    """
    plane = assembly.points
    points = contact_points(assembly.blocks, assembly.interfaces, 0.0, assembly.inset, plane=False)
    ends = np.stack([2 * points.interface, 2 * points.interface + 1], axis=1)  # plane interface i has the points 2 i and 2 i + 1
    away = np.linalg.norm((plane.position[ends] - points.position[:, None])[..., [0, 2]], axis=2)
    end = ends[np.arange(len(ends)), away.argmin(axis=1)]
    share = np.bincount(end, minlength=len(plane))
    solid = replace(points, friction=plane.friction[end])
    space = replace(assembly, points=solid, effects=replace(assembly.effects, plane=False))
    return space, forces[end] / share[end, None]


def residual_in_space(assembly: Assembly, twists: np.ndarray, forces: np.ndarray) -> float:
    """Largest residual in space of a plane answer; NaN where a residual is undefined.

    twists (B, 6) and contact forces (C, 3), N, are those of the plane answer; a live load has the multiplier that fits them best.
    The residuals of equilibrium and of the cones are over the mean block weight; the penetration is over the speed of the fastest block.
    """
    space, shared = in_space(assembly, forces)
    multiplier = residuals.multiplier(space, shared) if assembly.has_live_load else 0.0
    found = (
        residuals.equilibrium_residual(space, shared, multiplier),
        residuals.cone_violation(space, shared),
        residuals.penetration(space, twists),
    )
    return float(np.max(found))  # NumPy's maximum keeps a NaN
