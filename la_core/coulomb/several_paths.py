"""Result of several paths of one structure: the paths on the plateau of the answer, and the uncertainty from all paths."""

import numpy as np

from la_core.coulomb import plateau
from la_core.coulomb.certificate import ACCEPTED_RESIDUAL
from la_core.coulomb.followed_path import FollowedPath, PredictionSettings
from la_core.coulomb.path.elastic_joints import ElasticJoints

# Times the move from the end of a path with smooth joints to the limit state near it.
MOVED = 5.0
# Of the value: effect of settings that should not matter. On `wall_third` two courses of the viscosity gave 0.070328 and 0.070310.
STEPS_SHARE = 3e-4
BROAD = 0.25  # of the value: an answer with a larger uncertainty is not called solved
SAFETY = 2.0  # times the difference between the two finest paths


def joints_of_path(joints: ElasticJoints, number: int, settings: PredictionSettings) -> ElasticJoints:
    """Joints of path `number`, from 1. Where blocks turn, the axes of a coarse path turn with block a of each joint, not with b.

    The paths then show the effect of this choice.
    """
    return joints if number >= len(settings.viscosities) else joints.with_axes_of_first()


def disagree(followed: list[FollowedPath]) -> bool:
    """Whether the paths end on different plateaus."""
    return len(plateau.groups([path.plateau.value for path in followed])) > 1


def on_one_plateau(followed: list[FollowedPath]) -> list[FollowedPath]:
    """Return the paths of the plateau that most paths end on. The first is the answer: the finest that ends in a limit state, if any.

    Among plateaus with equally many paths, those with a limit state come first, then the one with the finest path. Paths with smooth joints
    count as one plateau, because their ends differ by the smoothing and not by the structure.
    """
    is_smooth = followed[-1].smooth_error > 0.0
    certified = [path.end.certificate.worst <= ACCEPTED_RESIDUAL for path in followed]  # NaN is no limit state
    groups = [list(range(len(followed)))] if is_smooth else plateau.groups([path.plateau.value for path in followed])
    most = max(groups, key=lambda group: (len(group), any(certified[i] for i in group), max(group)))
    return [followed[i] for i in sorted(most, key=lambda i: (not certified[i], -i))]


def stated_uncertainty(chosen: FollowedPath, followed: list[FollowedPath]) -> float:
    """Largest of: difference between the paths, remaining change of the curve, its scatter, and effect of the steps; scaled."""
    end, values = chosen.plateau, [path.plateau.value for path in followed]
    if chosen.smooth_error > 0.0:
        left = left_by_smoothing(chosen, followed)
    elif len(plateau.groups(values)) > 1:
        left = max(abs(end.value - value) for value in values)
    else:
        near = followed[-2:]
        left = SAFETY * max(max(abs(end.value - path.plateau.value), abs(end.mean - path.plateau.mean)) for path in near)
    return float(np.nanmax([left, end.doubt, STEPS_SHARE * abs(end.value)]))


def left_by_smoothing(finest: FollowedPath, followed: list[FollowedPath]) -> float:
    """Uncertainty that a sharper path would lessen: by the paths' difference, the move to the limit state or the law's error, scaled.

    The means of these paths are not compared, because they depend on the smoothing on the way.
    """
    end = finest.plateau.value
    differ = SAFETY * max(abs(end - path.plateau.value) for path in followed[-2:])
    return float(np.nanmax([differ, MOVED * abs(end - finest.values[-1]), SAFETY * finest.smooth_error]))
