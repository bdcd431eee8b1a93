"""Curve of the reaction over the settlement, or of the multiplier over the displacement, from rest to a requested end."""

import time
from dataclasses import dataclass

import numpy as np

from la_core.coulomb.followed_path import annealed
from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.quasi_static_path import Point, QuasiStaticPath
from la_core.coulomb.path.rest import come_to_rest
from la_core.coulomb.path.tangent import Tangent
from la_core.geometry import Held
from la_core.model import Assembly, JointStiffness

FIRST_VISCOSITY = 1e-3
LEAST_SHARE = 1e-6  # of the weight, or a multiplier: at smaller values the drag is relative to this


@dataclass(frozen=True, eq=False, repr=False)
class EquilibriumPath(Held):
    """Curve of the reaction over the settlement: rest under gravity, then one point per increment.

    It ends early, with fewer points P, where the path cannot go on; it has none where the blocks do not come to rest.

    Attributes
    ----------
    settlement : (P,) array
        Motion of the support, m or rad; for a live load the mean displacement along it, m.
    value : (P,) array
        Reaction (N; N m for a rotation) or multiplier.
    strain_residual : (P,) array
        Part of the value that replaces the drag of the path, over the value.
    converged : (P,) array of bool
        Always True, because increments that the path does not reach have no point. Files of earlier versions may contain False.
    solves : (P,) array of int
        Newton iterations of each increment.
    seconds : float
        Time of the path.
    """

    settlement: np.ndarray
    value: np.ndarray
    strain_residual: np.ndarray
    converged: np.ndarray
    solves: np.ndarray
    seconds: float


def follow_path(assembly: Assembly, stiffness: JointStiffness, settlement: float, increments: int, wedging: float = 0.0) -> EquilibriumPath:
    """Follow the reaction from rest to a settlement. The first increments are short, because the reaction falls fast there.

    Parameters
    ----------
    assembly : Assembly
        Structure that can stand.
    stiffness : JointStiffness
        Stiffness of the joints.
    settlement : float
        Final motion of the support, m or rad; for a live load the mean displacement along it, m.
    increments : int
        Number of increments after rest; their ends grow as the square of their number. The path takes as many steps
        within an increment as it needs.
    wedging : float
        Motion of the support against its settlement before gravity acts, m or rad.
    """
    start = time.perf_counter()
    joints = ElasticJoints(assembly, stiffness, 0.0 if assembly.effects.rotation == "small" else 1.0)
    tangent = Tangent(joints)
    rest, _ = come_to_rest(joints, tangent, wedging / stiffness.travel)
    points: list[Point] = []
    if rest is not None:
        path = QuasiStaticPath(joints, tangent, rest, annealed(joints, FIRST_VISCOSITY))
        points.append(path.points[0])
        for station in settlement / stiffness.travel * (np.arange(1, increments + 1) / increments) ** 2:
            *_, reached = [points[-1], *path.advance_to(station)]
            if path.last.progress < station:
                break
            points.append(reached)
    values = np.array([point.value for point in points])
    drags = np.array([point.drag for point in points])
    return EquilibriumPath(
        np.array([point.progress for point in points]) * stiffness.travel,
        values * joints.value_in_units(1.0),
        np.abs(drags) / np.maximum(np.abs(values), LEAST_SHARE),
        np.ones(len(points), dtype=bool),
        np.diff([point.iterations for point in points], prepend=0).astype(int),
        time.perf_counter() - start,
    )
