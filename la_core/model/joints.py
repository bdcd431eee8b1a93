"""Elastic joints: stiffness of the contact points and travel of the support, for both methods. A run in YADE may stiffen the joints.

Stiffness and travel scale with size, weight and inset, so that structures of any size and weight behave alike.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import cg

from la_core.errors import SceneError
from la_core.exchange import RADIUS_OVER_INSET, STIFFNESS_SETTINGS, TRAVEL_OVER_INSET, broken_rule
from la_core.model.assembly import PLANE_FREEDOMS, Assembly, per_length
from la_core.model.mirrors import mirrored_across

TRAVEL_OVER_SIZE = 1.0 / 400.0  # largest support travel over block size: small displacements
ELASTIC_SHARE = 1.0 / 300.0  # sag over the travel: elastic strain must not be mistaken for a mechanism
PENETRATION_OVER_RADIUS = 0.05  # a contact sphere that penetrates deeper touches away from its contact point
SOLVER_TOLERANCE = 1e-3  # relative error of the solver: its result is only a scale, not an answer
SWAY_TOLERANCE = 0.1  # of the residual, in which quick motions dominate: the slow sway is then right to 1 %, in fewer iterations


@dataclass(frozen=True)
class JointStiffness:
    """Stiffness of every contact point, with the travel and the sag from which it was chosen.

    Attributes
    ----------
    normal : float
        Stiffness along the normal, N/m.
    shear : float
        Stiffness across the normal, N/m.
    travel : float
        Largest motion of the support, m or rad; for a live load the largest displacement of a block, m.
    sag : float
        Largest displacement of a centroid under the weights, m, with glued joints that have the normal stiffness in
        all directions; NaN where nothing holds the structure.
    sway : float
        The same displacement under weights that act sideways, m: the largest of the directions in which the structure may sway. These are
        x in a plane model; in space x and y, or only the direction along the mirror if structure, loads and drive share one vertical
        mirror. NaN where it is unknown.
    """

    normal: float
    shear: float
    travel: float
    sag: float
    sway: float = math.nan


def joint_stiffness(assembly: Assembly, settings: Mapping[str, Any]) -> JointStiffness:
    """Choose the stiffness of the joints and the travel of the support.

    The rules for contact spheres apply where YADE can place them: at an inset above 0.

    Parameters
    ----------
    assembly : Assembly
        Structure with its weights and its driving motion or load.
    settings : mapping
        The scene's [yade] table; its values replace the derived ones.

    Raises
    ------
    SceneError
        A setting has an impossible value.
    """
    inset = assembly.inset
    _refuse_impossible(settings, inset)
    requested = {name: float(settings[name]) for name in STIFFNESS_SETTINGS if name in settings}
    has_spheres = inset > 0.0
    speed = assembly.support_speed
    longest = TRAVEL_OVER_SIZE * _block_size(assembly)
    if has_spheres:
        longest = min(longest, TRAVEL_OVER_INSET * inset)
    travel = requested.get("max_travel", longest / speed)
    sag, force, sway = _glued(assembly)
    least = sag / (ELASTIC_SHARE * travel * speed)
    if has_spheres:
        least = max(least, force / (PENETRATION_OVER_RADIUS * requested.get("sphere_radius", RADIUS_OVER_INSET * inset)))
    normal = requested.get("normal_stiffness", least)
    return JointStiffness(normal, requested.get("shear_stiffness", normal), travel, sag / normal, sway / normal)


def _refuse_impossible(settings: Mapping[str, Any], inset: float) -> None:
    for name in STIFFNESS_SETTINGS:
        rule = _broken_rule(name, settings[name], inset) if name in settings else ""
        if rule:
            raise SceneError(f"yade.{name}", f"must be {rule}", value=settings[name])


def _broken_rule(name: str, value: Any, inset: float) -> str:
    """The rule that the value of a setting breaks, or "" where it breaks none."""
    if rule := broken_rule(name, value):
        return rule
    is_too_large = name == "sphere_radius" and 0.0 < inset <= value  # the sphere would touch across the edge of its face
    return f"less than the inset of the contact points, {inset:g} m" if is_too_large else ""


def _block_size(assembly: Assembly) -> float:
    """Median over the free blocks of their largest extent (in the xz plane for plane scenes), m."""
    extent = (assembly.blocks.high - assembly.blocks.low)[assembly.blocks.free]
    return float(np.median(extent[:, [0, 2] if assembly.effects.plane else [0, 1, 2]].max(axis=1)))


def _glued(assembly: Assembly) -> tuple[float, float, float]:
    """Largest displacement of a centroid (m) and contact force (N) under the weights, joints glued by springs of 1 N/m.

    The last number is the displacement (m) under weights that act sideways. The three numbers are scales and no predictions, because glued
    joints are stiffer than joints that open. NaN where nothing holds the structure.
    """
    plane, standing = assembly.effects.plane, connected_to_held(assembly)
    if not standing.any():
        return math.nan, math.nan, math.nan
    freedoms, width = (len(PLANE_FREEDOMS), 2) if plane else (6, 3)
    gaps = assembly.kinematic_matrix(assembly.length)[:, np.repeat(standing, freedoms)]
    stiffness = gaps.T @ gaps
    inverse = sparse.diags(1.0 / stiffness.diagonal())

    def moved(load: np.ndarray, tolerance: float) -> np.ndarray:
        """Motion under a load (n, 6) of the standing blocks."""
        ruling = per_length(load, assembly.length)[:, PLANE_FREEDOMS if plane else slice(None)]
        return np.asarray(cg(stiffness, ruling.ravel(), rtol=tolerance, M=inverse)[0])

    def largest(motion: np.ndarray) -> float:
        return float(np.linalg.norm(motion.reshape(-1, freedoms)[:, :width], axis=1).max())

    load = assembly.dead_load[standing]
    down = moved(load, SOLVER_TOLERANCE)
    sideways = [np.linalg.norm(load[:, :3], axis=1)[:, None] * np.append(way, np.zeros(3)) for way in _ways_to_sway(assembly)]
    force = float(np.linalg.norm((gaps @ down).reshape(-1, width), axis=1).max())
    return largest(down), force, max(largest(moved(pushed, SWAY_TOLERANCE)) for pushed in sideways)


def _ways_to_sway(assembly: Assembly) -> list[np.ndarray]:
    """Horizontal directions (3,) of sway: x in a plane model; in space x and y, or along the one mirror shared with loads and drive."""
    if assembly.effects.plane:
        return [np.eye(3)[0]]
    across = mirrored_across(assembly)
    return [np.eye(3)[0], np.eye(3)[1]] if across is None else [np.cross(assembly.down, across)]


def connected_to_held(assembly: Assembly) -> np.ndarray:
    """Mask (B,) of the free blocks that joints connect to a held block, also through other blocks; all other free blocks fall."""
    free, size = assembly.blocks.free, len(assembly.blocks)
    a, b = assembly.interfaces.block_a, assembly.interfaces.block_b
    joined = sparse.coo_matrix((np.ones(len(a)), (a, b)), shape=(size, size))
    _, component = connected_components(joined, directed=False)
    return free & np.isin(component, component[~free])
