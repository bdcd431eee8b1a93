"""Joints that cannot slide (Heyman 1966): the independent equations that exclude sliding, and the friction that they do not determine.

All points of an interface lie in one plane. In a plane model the interface does not slide if one point does not. In
3D one point must not slide and a second one must not turn about it.
"""

import numpy as np
from scipy import sparse

from la_core.model import Assembly


def no_sliding_rows(assembly: Assembly) -> sparse.csr_matrix:
    """Rows (E, C k) that pick the sliding velocities which must vanish: one per interface in the plane, three in 3D.

    They act on the local relative velocities, k = 2 or 3 per contact point.
    """
    width, count = (2, len(assembly.points)) if assembly.effects.plane else (3, len(assembly.points))
    interfaces, first = np.unique(assembly.points.interface, return_index=True)
    pick = sparse.identity(count * width, format="csr")
    tangents = sparse.vstack([pick[first * width + k] for k in range(1, width)])
    if assembly.effects.plane:
        return tangents.tocsr()
    place = np.searchsorted(interfaces, assembly.points.interface)
    arm = assembly.points.position - assembly.points.position[first][place]
    length = np.linalg.norm(arm, axis=1)
    order = np.lexsort((length, place))
    far = order[np.append(np.flatnonzero(np.diff(place[order])), count - 1)]  # the point farthest from the first one
    across = np.cross(assembly.normal[far], arm[far])
    local = np.einsum("ik,ijk->ij", across, assembly.axes[far][:, 1:])
    turning = length[far] > 0.0  # an interface with one point turns freely
    local, far = local[turning] / length[far][turning, None], far[turning]
    rows = sparse.diags(local[:, 0]) @ pick[far * width + 1] + sparse.diags(local[:, 1]) @ pick[far * width + 2]
    return sparse.vstack([tangents, rows]).tocsr()


def shared_friction(assembly: Assembly, forces: np.ndarray) -> np.ndarray:
    """Contact forces (C, 3), N, with the friction of each interface shared by all its points.

    The wrench on each block stays the same; among all such friction forces these have the least sum of squares.
    """
    interface, count = assembly.points.interface, len(assembly.interfaces)
    points = np.bincount(interface, minlength=count)[interface, None]

    def total(values: np.ndarray) -> np.ndarray:
        return np.stack([np.bincount(interface, column, minlength=count) for column in values.T], axis=1)[interface]

    arm = assembly.points.position - total(assembly.points.position) / points
    compression, friction = assembly.split(forces)
    torsion = total(np.sum(np.cross(arm, friction) * assembly.normal, axis=1, keepdims=True))
    spread = total(np.sum(arm**2, axis=1, keepdims=True))
    turning = np.divide(torsion, spread, out=np.zeros_like(torsion), where=spread > 0.0)
    return compression[:, None] * assembly.normal + total(friction) / points + turning * np.cross(assembly.normal, arm)
