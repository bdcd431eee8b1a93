"""Reaction against settlement, or live load against displacement, from rest to the plateau, with the history of slip."""

from dataclasses import dataclass

import numpy as np

from la_core.coulomb.elastic_joints import ElasticJoints
from la_core.coulomb.plateau import follow, value_of
from la_core.model import Assembly, JointStiffness


@dataclass(frozen=True)
class EquilibriumPath:
    """The followed curve, N + 1 points of which the first is rest under gravity; it ends early where a step has no answer.

    settlement (N + 1,): motion of the support, m or rad; under a live load the mean displacement along it, m.
    value (N + 1,): reaction in N (N m for a rotation) or multiplier. strain_residual (N + 1,): see `la_core.coulomb.fixed_point.Step`.
    converged (N + 1,): whether each step did. solves (N + 1,): associated programmes of each step. seconds: of all.
    """

    settlement: np.ndarray
    value: np.ndarray
    strain_residual: np.ndarray
    converged: np.ndarray
    solves: np.ndarray
    seconds: float


def follow_path(assembly: Assembly, stiffness: JointStiffness, settlement: float, increments: int, wedging: float = 0.0) -> EquilibriumPath:
    """Follow a structure that stands to `settlement` (m or rad) in `increments` steps, short at first, where the reaction falls fast."""
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
