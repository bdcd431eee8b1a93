"""Reaction against settlement, or live load against displacement, from rest to the plateau, with the history of slip."""

from dataclasses import dataclass

import numpy as np

from la_core.coulomb.elastic_joints import ElasticJoints
from la_core.coulomb.plateau import follow, value_of
from la_core.model import Assembly, JointStiffness


@dataclass(frozen=True)
class EquilibriumPath:
    """Curve of the reaction over the settlement: rest under gravity, then one point per increment.

    It ends early, with fewer points P, where a step has no answer.

    Attributes
    ----------
    settlement : (P,) array
        Motion of the support, m or rad; for a live load the mean displacement along it, m.
    value : (P,) array
        Reaction (N; N m for a rotation) or multiplier.
    strain_residual : (P,) array
        Work of the spurious dilation over the elastic energy of the joints.
    converged : (P,) array of bool
        Whether the iteration of each step converged.
    solves : (P,) array of int
        Associated programmes solved in each step.
    seconds : float
        Time in the solver, all steps.
    """

    settlement: np.ndarray
    value: np.ndarray
    strain_residual: np.ndarray
    converged: np.ndarray
    solves: np.ndarray
    seconds: float


def follow_path(assembly: Assembly, stiffness: JointStiffness, settlement: float, increments: int, wedging: float = 0.0) -> EquilibriumPath:
    """Follow the reaction from rest to a settlement. The first steps are short, because the reaction falls fast there.

    Parameters
    ----------
    assembly : Assembly
        Structure that can stand.
    stiffness : JointStiffness
        Stiffness of the joints.
    settlement : float
        Final motion of the support, m or rad; for a live load the mean displacement along it, m.
    increments : int
        Number of steps after rest; their ends grow as the square of their number.
    wedging : float
        Motion of the support against its settlement before gravity acts, m or rad.
    """
    joints = ElasticJoints(assembly, stiffness)
    stations = settlement / stiffness.travel * (np.arange(1, increments + 1) / increments) ** 2
    steps = [step for step in follow(joints, stations, stiffness, wedging) if step.trial.solved]
    return EquilibriumPath(
        np.array([step.progress for step in steps]) * stiffness.travel,
        np.array([value_of(joints, step) for step in steps]),
        np.array([step.strain_residual for step in steps]),
        np.array([step.converged for step in steps]),
        np.array([step.solves for step in steps]),
        joints.seconds,
    )
