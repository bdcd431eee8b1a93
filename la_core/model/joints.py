"""Elastic joints: how stiff a contact point is and how far the support travels, for limit analysis and YADE alike.

Both follow from size, weight and inset, so that blocks of any size and weight behave alike.
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
from la_core.exchange import RADIUS_OVER_INSET
from la_core.model.assembly import PLANE_FREEDOMS, Assembly, per_length

TRAVEL_OVER_SIZE = 1.0 / 400.0  # largest support travel over block size: small displacements
TRAVEL_OVER_INSET = 0.8  # a contact sphere that slips by its inset leaves the face
ELASTIC_SHARE = 1.0 / 300.0  # sag over the travel: elastic strain must not pass for a mechanism
PENETRATION_OVER_RADIUS = 0.05  # a contact sphere that sinks in deeper touches at another place than its contact point
SOLVER_TOLERANCE = 1e-3  # only a scale is wanted

_ASKED = ("normal_stiffness", "shear_stiffness", "max_travel", "sphere_radius")


@dataclass(frozen=True)
class JointStiffness:
    """Stiffness of one contact point along its normal and across it (N/m), and what it was chosen by.

    travel: largest motion of the support, m or rad (no support: largest displacement of a block). sag: largest displacement of a
    centroid (m) under the weights with joints glued, as stiff across as along the normal; NaN where nothing holds the structure.
    """

    normal: float
    shear: float
    travel: float
    sag: float


def joint_stiffness(assembly: Assembly, inset: float, settings: Mapping[str, Any]) -> JointStiffness:
    """Stiffness for an assembly with contact points at `inset` (m), what `settings` (a scene's [yade]) asks for put first.

    The rules about contact spheres hold where YADE can lay them: at an inset above 0, under a support that moves.
    Raises SceneError for an impossible value.
    """
    _refuse_impossible(settings, inset)
    asked = {name: float(settings[name]) for name in _ASKED if name in settings}
    has_spheres = inset > 0.0 and not assembly.has_live_load
    speed = assembly.support_speed
    longest = TRAVEL_OVER_SIZE * _block_size(assembly)
    if has_spheres:
        longest = min(longest, TRAVEL_OVER_INSET * inset)
    travel = asked.get("max_travel", longest / speed)
    sag, force = _glued(assembly)
    least = sag / (ELASTIC_SHARE * travel * speed)
    if has_spheres:
        least = max(least, force / (PENETRATION_OVER_RADIUS * asked.get("sphere_radius", RADIUS_OVER_INSET * inset)))
    normal = asked.get("normal_stiffness", least)
    return JointStiffness(normal, asked.get("shear_stiffness", normal), travel, sag / normal)


def _refuse_impossible(settings: Mapping[str, Any], inset: float) -> None:
    for name in _ASKED:
        rule = _broken_rule(name, settings[name], inset) if name in settings else ""
        if rule:
            raise SceneError(f"yade.{name}", f"must be {rule}", value=settings[name])


def _broken_rule(name: str, value: Any, inset: float) -> str:
    """What the value of a setting must be and is not; "" when all is well."""
    if not isinstance(value, int | float) or isinstance(value, bool) or not math.isfinite(value):
        return "a finite number"
    if value < 0.0 or (value == 0.0 and name != "shear_stiffness"):  # without shear stiffness joints are smooth, not gone
        return "at least 0" if name == "shear_stiffness" else "greater than 0"
    is_too_large = name == "sphere_radius" and 0.0 < inset <= value  # the sphere would touch across the edge of its face
    return f"less than the inset of the contact points, {inset:g} m" if is_too_large else ""


def _block_size(assembly: Assembly) -> float:
    """Median over the free blocks of their largest extent (in the xz plane for plane scenes), m."""
    extent = (assembly.blocks.high - assembly.blocks.low)[assembly.blocks.free]
    return float(np.median(extent[:, [0, 2] if assembly.effects.plane else [0, 1, 2]].max(axis=1)))


def _glued(assembly: Assembly) -> tuple[float, float]:
    """Largest displacement of a centroid (m) and contact force (N) under the weights, joints glued by springs of 1 N/m.

    Glued joints are stiffer than open ones: a scale, not a prediction. NaN where nothing holds the structure.
    """
    plane, standing = assembly.effects.plane, _standing(assembly)
    if not standing.any():
        return math.nan, math.nan
    freedoms, width = (len(PLANE_FREEDOMS), 2) if plane else (6, 3)
    gaps = assembly.kinematic_matrix(assembly.length)[:, np.repeat(standing, freedoms)]
    stiffness = gaps.T @ gaps
    load = per_length(assembly.dead_load[standing], assembly.length)[:, PLANE_FREEDOMS if plane else slice(None)]
    motion, _ = cg(stiffness, load.ravel(), rtol=SOLVER_TOLERANCE, M=sparse.diags(1.0 / stiffness.diagonal()))
    displacement, force = motion.reshape(-1, freedoms)[:, :width], (gaps @ motion).reshape(-1, width)
    return float(np.linalg.norm(displacement, axis=1).max()), float(np.linalg.norm(force, axis=1).max())


def _standing(assembly: Assembly) -> np.ndarray:
    """Mask (B,) of the free blocks that joints connect to a held one: the others would fall for ever, however stiff the glue."""
    free, size = assembly.blocks.free, len(assembly.blocks)
    a, b = assembly.interfaces.block_a, assembly.interfaces.block_b
    _, part = connected_components(sparse.coo_matrix((np.ones(len(a)), (a, b)), shape=(size, size)), directed=False)
    return free & np.isin(part, part[~free])
