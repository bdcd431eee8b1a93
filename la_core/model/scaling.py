"""Scaling between the model in SI units and programmes with numbers of order one.

Lengths are divided by the mean block size, and forces by the weight of the free blocks.
"""

import numpy as np

from la_core.model.assembly import PLANE_FREEDOMS, Assembly, per_length


def support_motion(assembly: Assembly, sign: float) -> tuple[float, np.ndarray]:
    """Speed of the fastest support point per unit motion (`Assembly.support_speed`; 1 at rest), and support twists (B, 6) over this speed.

    sign: 1 for a support that moves with the settlement, -1 for one that moves against it, 0 for one at rest.
    """
    if sign == 0.0:
        return 1.0, np.zeros((len(assembly.blocks), 6))
    speed = assembly.support_speed
    return speed, sign * assembly.support_twist / speed


def columns(assembly: Assembly, twists: np.ndarray) -> np.ndarray:
    """Twists (B, 6) as the vector that the scaled kinematic matrix acts on.

    Rotations are multiplied by the length; a plane model keeps vx, vz and wy only.
    """
    scaled = twists * np.array([1.0, 1.0, 1.0, *[assembly.length] * 3])
    return scaled[:, PLANE_FREEDOMS].ravel() if assembly.effects.plane else scaled.ravel()


def scaled_load(assembly: Assembly, wrenches: np.ndarray) -> np.ndarray:
    """Wrenches (B, 6) of the free blocks as the vector of powers per scaled unknown.

    Forces are divided by the weight, and moments by the weight and the length.
    """
    scaled = per_length(wrenches[assembly.blocks.free], assembly.length) / assembly.weight
    return scaled[:, PLANE_FREEDOMS].ravel() if assembly.effects.plane else scaled.ravel()


def twists_of(assembly: Assembly, x: np.ndarray) -> np.ndarray:
    """Twists (B, 6) from the scaled unknowns x (n,) of the free blocks; all other blocks are at rest."""
    count = int(assembly.blocks.free.sum())
    free, twists = np.zeros((count, 6)), np.zeros((len(assembly.blocks), 6))
    free[:, PLANE_FREEDOMS if assembly.effects.plane else slice(None)] = x.reshape(count, -1)
    twists[assembly.blocks.free] = per_length(free, assembly.length)
    return twists


def global_forces(assembly: Assembly, local: np.ndarray) -> np.ndarray:
    """Contact forces (C, 3) in N along the global axes, from scaled local components (normal, tangents), flat or (C, 2 or 3)."""
    shaped = local.reshape(len(assembly.points), -1) * assembly.weight
    return np.einsum("ck,ckj->cj", shaped, assembly.axes[:, : shaped.shape[1]])


def local_forces(assembly: Assembly, forces: np.ndarray, components: int) -> np.ndarray:
    """Inverse of `global_forces`, flat: scaled local components of contact forces (C, 3) in N. components: 2 in the plane, or 3."""
    return np.einsum("cj,ckj->ck", forces, assembly.axes[:, :components]).ravel() / assembly.weight
