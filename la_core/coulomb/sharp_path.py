"""A path of sharp joints: its travel is doubled until its curve is flat, and it ends in a certified limit state.

Under a live load the greatest multiplier on the way is of interest, too. The usual viscosity lifts it, because blocks gain speed there.
"""

from bisect import bisect_left
from dataclasses import replace

import numpy as np

from la_core.coulomb import plateau
from la_core.coulomb.certificate import ACCEPTED_RESIDUAL, certified_end, limit_state_near
from la_core.coulomb.followed_path import (
    BIG,
    LAST_VISCOSITY,
    NEARLY,
    FollowedPath,
    PredictionSettings,
    Sender,
    SharedProgress,
    annealed,
    first_end,
    is_at_end,
    most_iterations,
    next_end,
    travels,
)
from la_core.coulomb.lasting import Lasting
from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.implicit_step import State
from la_core.coulomb.path.quasi_static_path import QuasiStaticPath, first_travel
from la_core.coulomb.path.tangent import Tangent
from la_core.coulomb.plateau import Plateau
from la_core.coulomb.solution import CoulombSolution

# First viscosity of a path to a peak, and the factor by which the limits of its steps are divided. The usual viscosities lifted
# the peaks of 36 small walls by up to 5 % and that of one of 270 blocks by 29 %. Any lift by these two shows in their difference.
PEAK_PATHS = ((1e-5, 1.0), (1e-6, 3.0))
PEAK_SAFETY = 2.0  # times the difference between the peaks of these paths
# Of a peak: possible rise between the ends of two steps. Of 29 peaks of random walls the finer of the two paths missed 0.15 % at most.
BETWEEN_STEPS = 2e-3
SOUGHT = 5e-3  # of the value: a curve that rises less above it, beyond its uncertainty, has no peak
END_STRETCH = 0.1  # most travel of the last stretch, to the certified end, over that of the path
# A path that goes on with turning blocks ends early where its latest pace would take HOPELESS times the effort that is left. The pace is
# that of its last Newton iterations: PACED plus TIMES_PACED times those before it went on. Two points of `crosscheck new zones` stick and
# slip in turn, in steps of a millionth of the way: 51,500 iterations led nowhere.
PACED, TIMES_PACED, HOPELESS = 1000.0, 10.0, 3.0


def follow(
    joints: ElasticJoints, tangent: Tangent, rest: State, first: float, settings: PredictionSettings, as_far_as: float, send: Sender
) -> FollowedPath | None:
    """Follow one path with a first viscosity until its curve is flat, and to a certified end; None where it cannot go on.

    as_far_as: least travel of the path.
    """
    more = max(len(joints.weights) / BIG, 1.0) ** 2
    viscosity = annealed(joints, more * first, more**2 * LAST_VISCOSITY)
    return _to_its_end(QuasiStaticPath(joints, tangent, rest, viscosity, settings.finer), settings, as_far_as, send)


def with_peak(
    joints: ElasticJoints,
    tangent: Tangent,
    rest: State,
    solution: CoulombSolution,
    travel: float,
    settings: PredictionSettings,
    progress: SharedProgress,
) -> tuple[CoulombSolution, int]:
    """Return a prediction under a live load with its peak, where it has one, and the Newton iterations of the search for it.

    A peak is sought where the curve rises above the value by more than its uncertainty and SOUGHT. travel: unit of the progress, m.
    """
    unit = joints.value_in_units(1.0)
    near = solution.uncertainty + SOUGHT * plateau.reference_size(solution.value / unit) * unit
    if not plateau.peak_before(solution.path_value, solution.value, near) > solution.value + near:
        return solution, 0
    senders = progress.senders_of_more([first for first, _ in PEAK_PATHS])
    end = float(solution.path_settlement[-1]) / travel
    peak, iterations = peak_on_the_way(joints, tangent, rest, solution.value / unit, end, settings, senders)
    is_above = len(peak) > 0 and peak[0] - peak[1] > (solution.value + solution.uncertainty) / unit
    return (replace(solution, peak=peak * unit) if is_above else solution), iterations


def peak_on_the_way(
    joints: ElasticJoints, tangent: Tangent, rest: State, level: float, end: float, settings: PredictionSettings, senders: list[Sender]
) -> tuple[np.ndarray, int]:
    """Follow PEAK_PATHS to a progress; return their peak on the way to a scaled value with its uncertainty, and the Newton iterations.

    The peak is a (2,) array, scaled, and empty where a path does not come to the progress. senders: one for each path.
    """
    peaks, iterations, near = [], 0, plateau.ALIKE * plateau.reference_size(level)
    for (first, finer), send in zip(PEAK_PATHS, senders, strict=True):
        path = QuasiStaticPath(joints, tangent, rest, annealed(joints, first), finer * settings.finer)
        for point in path.advance_to(end, finer * most_iterations(joints, settings)):
            send(point.progress, end, point.value)
        iterations += path.iterations
        if path.last.progress < end:
            return np.zeros(0), iterations
        peaks.append(plateau.peak_before(path.curve[1], level, near))
    coarse, fine = peaks
    return np.array([fine, PEAK_SAFETY * abs(fine - coarse) + BETWEEN_STEPS * abs(fine)]), iterations


def go_on_turning(
    path: QuasiStaticPath, joints: ElasticJoints, settings: PredictionSettings, as_far_as: float, send: Sender
) -> FollowedPath | None:
    """Continue a copy of a path, with joints whose blocks turn by finite angles, as `follow` does; None where it cannot go on.

    as_far_as: least travel of the path.
    """
    path = path.copy()
    path.joints = joints
    paced = (PACED + TIMES_PACED * path.iterations) * settings.effort / PredictionSettings.effort
    return _to_its_end(path, settings, as_far_as, send, paced)


def _is_hopeless(path: QuasiStaticPath, paced: float, goal: float, most: float) -> bool:
    """Whether a path would need more than HOPELESS times the effort that is left to come to its goal, at its latest pace.

    paced: number of last Newton iterations that give the pace. goal: progress. most: Newton iterations of the whole path.
    """
    if path.iterations < paced:
        return False
    since = path.points[bisect_left(path.points, path.iterations - paced, key=lambda point: point.iterations)].progress
    reached = path.last.progress
    return (goal - reached) * paced > HOPELESS * (reached - since) * (most - path.iterations)


def _to_its_end(
    path: QuasiStaticPath, settings: PredictionSettings, as_far_as: float, send: Sender, paced: float = np.inf
) -> FollowedPath | None:
    """Follow a path until its curve is flat, and to a certified end; None where it cannot go on.

    paced: see `_is_hopeless`. Blocks with finite rotations turn until the path has covered the travel of the joints that it represents and
    its curve is flat. Under a live load this travel follows from their pace on the way.
    """
    joints, first, most = path.joints, None, most_iterations(path.joints, settings)
    end = first_end(path, first_travel(joints))
    turned, longest = travels(path, settings)
    passed: list[tuple[Plateau, QuasiStaticPath]] = []
    lasting = Lasting(longest / 2.0)  # a curve is flat over the second half of its way
    while True:
        for point in path.advance_to(end, most):
            send(point.progress, max(end, turned, as_far_as), point.value)
            if _is_hopeless(path, paced, max(end, turned), most):
                break
        if path.joints is joints:
            turned, longest = travels(path, settings)
            lasting.latest = longest / 2.0
        least = max(turned, (1.0 - NEARLY) * as_far_as if joints.live else as_far_as)
        reached, progress, values = path.last.progress, *path.curve
        first = first or (path.copy() if reached == end else None)
        is_last = reached < end or is_at_end(end, longest)
        found = plateau.plateau_of(progress, values, reached, values[-1])
        if reached >= turned and found.is_flat:
            path.joints = path.joints_as_turned
        if reached >= turned and found.is_known:
            passed.append((found, path.copy()))
        if reached > 0.0 and (is_last or (end >= least and found.is_flat)):
            ended = certified_end(path, END_STRETCH * reached)
            if is_last or (ended.certificate.worst <= ACCEPTED_RESIDUAL and lasting.holds(path, ended.before, ended.last)):
                break
        if is_last:
            return None
        end = next_end(end, turned, longest)
    last = FollowedPath.on(path, (progress, values), ended, path.value(ended.last), reached < end, reached < turned)
    chosen = _plateau_left(passed, last.plateau) or last
    on_the_way = tuple(one.value for one, _ in passed if abs(one.value - last.plateau.value) > plateau.LEFT * one.doubt)
    return replace(chosen, on_the_way=(*on_the_way, last.plateau.value), iterations=path.iterations, first_travel=first)


def _plateau_left(passed: list[tuple[Plateau, QuasiStaticPath]], last: Plateau) -> FollowedPath | None:
    """Return the path up to the best plateau that it passed if its curve has left this one for a doubtful value; otherwise None.

    Friction may lock a thrust in, which blocks release by motions many times the settlement at which the curve was flat.
    """
    if not passed:
        return None
    best, path = min(passed, key=lambda one: one[0].doubt)
    if not best.is_left_at(last):
        return None
    curve, ended = path.curve, certified_end(path.copy(), END_STRETCH * path.last.progress)
    if ended.certificate.worst > ACCEPTED_RESIDUAL:
        ended = limit_state_near(path)
    early = FollowedPath.on(path, curve, ended, path.value(ended.last), False, False)
    return early if ended.certificate.worst <= ACCEPTED_RESIDUAL and early.plateau.is_known else None
