"""Rates at which contact points part and slip between two states of a path, and the powers of their forces."""

from dataclasses import dataclass

import numpy as np

from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.implicit_step import State


@dataclass(frozen=True)
class JointRates:
    """Rates at which the contact points part and slip, over the progress, without the strain of the joints.

    Attributes
    ----------
    gap : (C,) array
        Rate of opening; negative where an open point closes.
    slip : (C, k - 1) array
        Rate of slip.
    """

    gap: np.ndarray
    slip: np.ndarray


def joint_rates(joints: ElasticJoints, before: State, last: State) -> JointRates:
    """Rates of parting and slip between two states."""
    stride = last.progress - before.progress
    displacement = last.joints.displacement - before.joints.displacement
    force = last.joints.force - before.joints.force
    gap = displacement[:, 0] + force[:, 0] / joints.normal
    slip = displacement[:, 1:] + (force[:, 1:] / joints.shear if joints.shear > 0.0 else 0.0)
    return JointRates(gap / stride, slip / stride)


def joint_powers(joints: ElasticJoints, before: State, last: State) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Powers (C,) at the contact points between two states, scaled.

    They are the power of the normal force where a point parts, the dissipation mu n |slip| less the power of the friction force against
    the slip, and this dissipation. The first two vanish in a limit state.
    """
    rates = joint_rates(joints, before, last)
    normal, friction = last.joints.force[:, 0], last.joints.force[:, 1:]
    dissipation = joints.friction * normal * np.linalg.norm(rates.slip, axis=1)
    return normal * np.abs(rates.gap), np.abs(dissipation + np.sum(friction * rates.slip, axis=1)), dissipation
