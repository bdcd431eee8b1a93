"""Directions and motions of a scene file as arrays."""

import numpy as np

from la_core.scene.schema.scene_file import Settlement
from la_core.scene.schema.types import Vector


def unit_vector(vector: Vector) -> np.ndarray:
    """Unit vector. The vector is first scaled by its largest entry, so that tiny and huge entries neither underflow nor overflow."""
    scaled = np.array(vector) / np.abs(vector).max()
    return scaled / np.linalg.norm(scaled)


def support_twist(settlement: Settlement | None) -> np.ndarray | None:
    """Twist (6,) of the support's unit motion: velocity of the origin, then angular velocity. None without a settlement."""
    if settlement is None:
        return None
    if settlement.direction is not None:
        return np.concatenate([unit_vector(settlement.direction), np.zeros(3)])
    assert settlement.axis is not None and settlement.point is not None  # the schema demands both
    axis = unit_vector(settlement.axis)
    return np.concatenate([np.cross(np.array(settlement.point), axis), axis])
