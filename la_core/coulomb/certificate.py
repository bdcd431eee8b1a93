"""Certificate of the end of a path: the state recomputed as a limit state with friction that does not dilate.

A limit state is a set of contact forces with a mechanism: the forces balance the weights and lie in the friction cones,
loaded joints do not part, friction mu n acts against the slip, and the power of the weights equals the dissipation plus
the power of the support or of the live load. The drag and the changing strain of the joints keep a path from this
exactly; every residual measures what they leave.
"""

from dataclasses import dataclass

import numpy as np

from la_core.coulomb.elastic_joints import ElasticJoints
from la_core.coulomb.implicit_step import State
from la_core.coulomb.quasi_static_path import QuasiStaticPath
from la_core.measures import residuals
from la_core.model import global_forces

ACCEPTED_RESIDUAL = 1e-5  # every residual of a certified end
END_VISCOSITY = 1e-9  # of the last stretch, to the certified end
END_ITERATIONS, LEAST_END_ITERATIONS, END_STEPS = 0.2, 200, 20  # most iterations of the last stretch over those of the path
LEAST_WORK = 1e-3  # of the weight's work over the support's motion


@dataclass(frozen=True)
class Certificate:
    """Residuals of a limit state.

    Attributes
    ----------
    equilibrium : float
        Largest unbalanced force on a free block over the mean free-block weight.
    cone : float
        Largest tension or excess of |t| over mu n, over the mean free-block weight.
    parting : float
        Power of the normal forces at parting joints over the power put in by sinking weights and by the support or live load.
    sliding : float
        Dissipation mu n |slip| less the power of the friction forces against the slip, over the power put in.
    power : float
        Power of the weights less dissipation less the power of the reaction, over the power put in.
    """

    equilibrium: float
    cone: float
    parting: float
    sliding: float
    power: float

    @property
    def worst(self) -> float:
        """Largest residual."""
        return max(self.equilibrium, self.cone, self.parting, self.sliding, self.power)


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


def certify(joints: ElasticJoints, before: State, last: State) -> Certificate:
    """Recompute the end of a path as a limit state, with the mechanism of its last step from `before` to `last`."""
    assembly = joints.assembly
    forces = global_forces(assembly, last.joints.force)
    value = last.multiplier if joints.live else joints.reaction(last.joints.force)
    rates = joint_rates(joints, before, last)
    normal, friction = last.joints.force[:, 0], last.joints.force[:, 1:]
    dissipation = joints.friction * normal * np.linalg.norm(rates.slip, axis=1)
    twists = (last.blocks - before.blocks) / (last.progress - before.progress)
    block_power = (joints.weights * twists).reshape(-1, joints.freedoms).sum(axis=1)
    driving = value if joints.live else -value  # power of the live load, or of the support, on the structure
    put_in = max(float(np.maximum(block_power, 0.0).sum()) + max(driving, 0.0), LEAST_WORK)
    return Certificate(
        residuals.equilibrium_residual(assembly, forces, joints.value_in_units(value) if joints.live else 0.0),
        residuals.cone_violation(assembly, forces),
        float(np.sum(normal * np.abs(rates.gap))) / put_in,
        float(np.sum(np.abs(dissipation + np.sum(friction * rates.slip, axis=1)))) / put_in,
        abs(float(block_power.sum()) + driving - float(dissipation.sum())) / put_in,
    )


def certified_end(path: QuasiStaticPath, stretch: float) -> tuple[State, State, Certificate]:
    """Go on with hardly any drag until the state is a limit state; otherwise return the step that comes closest."""
    best = (path.before, path.last, certify(path.joints, path.before, path.last))
    most = path.iterations + max(END_ITERATIONS * path.iterations, LEAST_END_ITERATIONS)
    for _ in path.advance_to(path.last.progress + stretch, most, END_VISCOSITY, stretch / END_STEPS):
        certificate = certify(path.joints, path.before, path.last)
        if certificate.worst < best[2].worst:
            best = (path.before, path.last, certificate)
        if certificate.worst <= ACCEPTED_RESIDUAL / 10.0:
            break
    return best
