"""Test of the certified end of a path: it does not last if a contact point is about to close, to open or to slide.

Blocks as laid have no gaps. A gap of elastic joints, which formed on the way to a plateau, may close long after the curve is flat, and
another mechanism follows: a rubble wall of 12 stones loses 1.2 % when a gap of one sag has closed, after 1.7 travels. A point
that sticks while its force still changes may open or slide as late: a pointed vault changes by 0.14 % when a point opens, 11 travels after
its curve was flat.
"""

from dataclasses import dataclass

import numpy as np

from la_core.coulomb.certificate import ACCEPTED_RESIDUAL, LEAST_CLOSING
from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.implicit_step import State
from la_core.coulomb.path.joint_rates import joint_rates
from la_core.coulomb.path.quasi_static_path import QuasiStaticPath
from la_core.coulomb.plateau import FLAT, reference_size


def next_change(joints: ElasticJoints, before: State, last: State) -> float:
    """Progress at which the next contact point changes its state if the rates from `before` to `last` stay; infinite where none does."""
    return last.progress + min(_until_one_closes(joints, before, last), _until_one_gives_way(joints, before, last))


def _until_one_closes(joints: ElasticJoints, before: State, last: State) -> float:
    gap, rate = last.joints.displacement[:, 0], joint_rates(joints, before, last).gap
    closes = (last.joints.force[:, 0] == 0.0) & (gap > 0.0) & (rate < -LEAST_CLOSING)
    return float(np.min(gap[closes] / -rate[closes], initial=np.inf))


def _until_one_gives_way(joints: ElasticJoints, before: State, last: State) -> float:
    """Progress until a loaded point opens, or a sticking point reaches mu n; forces below an accepted residual count as zero."""
    force, stride = last.joints.force, last.progress - before.progress
    rate = (force - before.joints.force) / stride
    normal, friction, normal_rate, friction_rate = force[:, 0], force[:, 1:], rate[:, 0], rate[:, 1:]
    least = ACCEPTED_RESIDUAL * joints.freedoms / len(joints.weights)
    opens = (normal > least) & (normal_rate < 0.0)
    sticks = joints.friction * normal - np.linalg.norm(friction, axis=1) > least
    # The least positive root s of (mu n)^2 = |t|^2, with n and t linear in s; this form also holds where a coefficient vanishes.
    square = (joints.friction * normal_rate) ** 2 - np.sum(friction_rate**2, axis=1)
    linear = 2.0 * (joints.friction**2 * normal * normal_rate - np.sum(friction * friction_rate, axis=1))
    constant = (joints.friction * normal) ** 2 - np.sum(friction**2, axis=1)
    inner = linear**2 - 4.0 * square * constant
    below = np.sqrt(np.maximum(inner, 0.0)) - linear
    slides = sticks & (inner >= 0.0) & (below > 0.0)
    until = np.concatenate([normal[opens] / -normal_rate[opens], 2.0 * constant[slides] / below[slides]])
    return float(np.min(until, initial=np.inf))


@dataclass
class Lasting:
    """Test whether a certified end lasts: no contact point changes its state before `latest`, or the last change did not move the value.

    Attributes
    ----------
    latest : float
        Progress beyond which no change counts.
    awaited : float
        Progress at which the next contact point changes its state.
    value : float
        Value of the path at the certified end tested last; NaN before the first test.
    """

    latest: float
    awaited: float = 0.0
    value: float = np.nan

    def holds(self, path: QuasiStaticPath, before: State, last: State) -> bool:
        """Test a certified end, with its mechanism from `before` to `last`; True where it lasts."""
        if last.progress < self.awaited:
            return False
        earlier, self.value = self.value, path.value(last)
        self.awaited = next_change(path.joints, before, last)
        return self.awaited > self.latest or abs(self.value - earlier) <= FLAT * reference_size(self.value)
