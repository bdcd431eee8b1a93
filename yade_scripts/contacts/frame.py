"""The frame of a run: its origin lies near the blocks, even if the blocks lie far from the origin of the scene.

A survey has coordinates of a national grid, 1e5 to 1e7 m from its origin. YADE computes the inertia of a block about the origin first. The
inertia is lost in round-off if the origin is some 1e5 block sizes away.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

_PLACES = ("blocks/vertices", "blocks/centroid", "contacts/position")
_TWISTS = ("scene/support_twist", "blocks/support_twist")
_WIDTHS = 2.0  # unit of the shift over the structure's width, rounded up to a power of two; a structure near the origin stays in place


def origin_near(vertices: np.ndarray) -> np.ndarray:
    """Return the origin (3,), m, of a frame near all vertices (V, 3), m; 0 if they lie near the scene's origin or are not finite."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    width = float((high - low).max())
    if not (np.isfinite(width) and width > 0.0):
        return np.zeros(3)
    unit = _WIDTHS * 2.0 ** np.ceil(np.log2(width))
    return np.asarray(unit * np.round((low + high) / 2.0 / unit) + 0.0)  # without negative zeros


def near_blocks(data: Mapping[str, Any]) -> tuple[Mapping[str, Any], np.ndarray]:
    """Return the fields of a case in a frame near its blocks, and the origin (3,) of this frame in the frame of the file, m."""
    origin = origin_near(data["blocks/vertices"])
    if not origin.any():
        return data, origin
    moved = {name: data[name] - origin for name in _PLACES}
    for name in (name for name in _TWISTS if name in data):
        velocity, spin = data[name][..., :3], data[name][..., 3:]
        moved[name] = np.concatenate([velocity + np.cross(spin, origin), spin], axis=-1)
    return {**data, **moved}, origin


def about_old_origin(wrenches: np.ndarray, origin: np.ndarray) -> np.ndarray:
    """Return wrenches (N, 6) about the origin of a run as wrenches about the origin of the file, N and N m; origin: (3,), m."""
    return np.concatenate([wrenches[:, :3], wrenches[:, 3:] + np.cross(origin, wrenches[:, :3])], axis=1)
