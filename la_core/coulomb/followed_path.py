"""One path of a prediction: its limits and the reports of its progress; the path of a large structure.

A large structure has joints that part and slip gradually at first and become sharp at the end.
"""

import threading
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from la_core.coulomb import plateau
from la_core.coulomb.certificate import End, end_of, limit_state_near
from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.quasi_static_path import Falling, QuasiStaticPath, first_travel, least_travel
from la_core.coulomb.path.rest import come_to_rest
from la_core.coulomb.path.tangent import Tangent
from la_core.coulomb.path.turning import STIFFER
from la_core.coulomb.plateau import Plateau

# Doublings of the travel where the curve is not flat. Far along the path steps are long: on a leaning wall whose curve was flat after 64
# travels, six doublings took 988 iterations and four, which left an uncertainty of 1.6 %, took 981.
MOST_DOUBLINGS = 6
ANNEALED = 0.5  # of the first travel: from here on the viscosity keeps its last value
LAST_VISCOSITY = 1e-6  # after annealing
# Unknowns of a large structure. Its joints are smooth at first, because their instabilities would take most of the time: a wall
# of 1,024 blocks took 250 steps to a twelfth of the travel with sharp joints, and 20 steps to all of it with smooth joints.
LARGE = 2500.0
BIG = 1000.0  # unknowns beyond which the first viscosities grow as the square of the size, and the last one as its fourth power
# Force over which joints part and slip, in mean contact forces: SMOOTH times the first viscosity, and at most SMOOTH_END at the end. They
# become sharp on a stretch of SHARPENED times the travel before. On 48 walls of 60 to 160 blocks a force of 30, 3, 0.3 and 0.03 left an
# error of 5.6, 2.4, 0.8 and 0.3 % in the median. The error falls about as the root of the force, as does that of the law itself.
SMOOTH, SMOOTH_END, SHARPENED = 30.0, 1e-2, 0.3
LAW_ERROR = 3.0  # times the root of that force times the mean contact force: largest error of a smooth joint's force
LESS_VISCOUS, LAST_OF_SMOOTH = 0.1, 1e-3  # first viscosity over that of a small structure; viscosity after annealing
MORE_EFFORT = 6.0  # most iterations of a path with smooth joints over those of one with sharp joints
SHARP_EFFORT = 0.5  # most iterations on the stretch where joints become sharp, over those of a path with smooth joints
AGAIN = 1.0  # most iterations from the first travel to the plateau over those of the first travel, at the usual effort
NEARLY = 0.01  # of a progress: a path that is short of it by less counts as having reached it
TURNED = 4.0  # longest travel of a path with finite rotations, over its least one


@dataclass(frozen=True)
class PredictionSettings:
    """Accuracy of a prediction.

    Attributes
    ----------
    viscosities : tuple of float
        First viscosity of each path, in multiples of the weight at unit rate, the coarsest path first. It is higher for
        large structures with sharp joints, and LESS_VISCOUS times as high with smooth joints. Where paths disagree, a path with a tenth of
        the least viscosity follows, if the effort allows. Where the value after a release is uncertain, such a path follows with finer
        steps.
    finer : float
        Factor by which the limits of a step are divided.
    effort : float
        Limit of the Newton iterations of one path, times the square root of the unknowns; the path ends there, flat or not. Beyond
        LARGE unknowns the limit falls no further: a facade of 9,200 would otherwise end at 98 % of its travel. A path with smooth joints
        may take MORE_EFFORT times as many iterations, and its limit AGAIN is in proportion to the effort.
    doublings : int
        Largest number of doublings of the travel where the curve is not flat.
    with_release : bool
        Whether paths with small rotations go on with finite rotations where their mechanism allows several values, to find the value
        after a release.
    """

    viscosities: tuple[float, ...] = (1e-2, 1e-3)
    finer: float = 1.0
    effort: float = 2e5
    doublings: int = MOST_DOUBLINGS
    with_release: bool = False

    @property
    def viscosities_in_turn(self) -> tuple[float, ...]:
        """First viscosity of each path, then that of the additional path that may follow."""
        return (*self.viscosities, self.viscosities[-1] / 10.0)


@dataclass(frozen=True)
class PathProgress:
    """Progress of the paths of one prediction.

    Attributes
    ----------
    progress : float
        Motion of the support, or displacement along the live load, over the travel.
    share : float
        Estimated share of the paths that is done, 0 to 1.
    value : float
        Reaction (N or N m) or multiplier so far.
    viscosity : float
        First viscosity of the path.
    path, paths : int
        Number of this path, from 1, and of all paths.
    blocks : int
        Number of free blocks that the paths model; 0 where unknown. If it grows, the paths have begun again, because the answer with
        fewer blocks is not proven for the whole structure.
    """

    progress: float
    share: float
    value: float
    viscosity: float
    path: int
    paths: int
    blocks: int = 0


Reporter = Callable[[PathProgress], None]
Sender = Callable[[float, float, float], None]  # progress, end of the travel, scaled value


class SharedProgress:
    """Progress of all paths of a prediction, which may be followed side by side.

    Parameters
    ----------
    joints : ElasticJoints
        Structure on its elastic joints.
    report : callable, optional
        Receives the progress, from one path at a time.
    paths : int
        Number of paths; more may follow.
    goes_on : bool
        Whether as many paths are expected to follow, so that these are the first half of the work.
    """

    def __init__(self, joints: ElasticJoints, report: Reporter | None, paths: int, goes_on: bool = False) -> None:
        self._joints, self._report, self._goes_on = joints, report, goes_on
        self._shares, self._blocks = [0.0] * paths, int(joints.assembly.blocks.free.sum())
        self._lock, self._is_stopped = threading.Lock(), False

    def stop(self) -> None:
        """End the paths that are still followed at their next point."""
        self._is_stopped = True

    def senders_of_more(self, viscosities: list[float]) -> list[Sender]:
        """Return the functions that report the points of paths beyond those so far, one for each first viscosity."""
        so_far, self._goes_on = len(self._shares), False
        self._shares += [0.0] * len(viscosities)
        return [self.sender(viscosity, so_far + number) for number, viscosity in enumerate(viscosities, start=1)]

    def sender(self, viscosity: float, path: int) -> Sender:
        """Return the function that reports the points of one path with this first viscosity; paths are counted from 1."""
        self._shares += [0.0] * (path - len(self._shares))

        def send(progress: float, end: float, value: float) -> None:
            if self._is_stopped:
                raise InterruptedError("another path has ended the prediction")
            self._shares[path - 1] = min(progress / end, 1.0)
            if self._report is not None:
                share = sum(self._shares) / len(self._shares) / (2.0 if self._goes_on else 1.0)
                with self._lock:
                    value = self._joints.value_in_units(value)
                    self._report(PathProgress(progress, share, value, viscosity, path, len(self._shares), self._blocks))

        return send


@dataclass(frozen=True)
class FollowedPath:
    """One path that was followed to its end."""

    plateau: Plateau
    end: End
    progress: np.ndarray
    values: np.ndarray
    iterations: int
    viscosity: float
    exhausted: bool
    is_short: bool = False  # whether it ended before its least travel
    smooth_error: float = 0.0  # largest error of the law of its smooth joints, force at a contact point; 0 for sharp joints
    on_the_way: tuple[float, ...] = ()  # values of plateaus that the curve leaves, and at its end
    first_travel: QuasiStaticPath | None = None  # the path at the end of its first travel; None where joints are smooth or it ends before

    @classmethod
    def on(
        cls,
        path: QuasiStaticPath,
        curve: tuple[np.ndarray, np.ndarray],
        end: End,
        value: float,
        exhausted: bool,
        is_short: bool,
        smooth_error: float = 0.0,
    ) -> "FollowedPath":
        """Path with its curve before the last stretch, and the end of that stretch with its value."""
        progress, values = curve
        found = plateau.plateau_of(progress, values, progress[-1], value)
        first = path.viscosity.first
        return cls(found, end, progress, values, path.iterations, first, exhausted, is_short, smooth_error)


def annealed(joints: ElasticJoints, first: float, last: float = LAST_VISCOSITY) -> Falling:
    """Viscosity that falls to its last value, if this is less, over the first part of the first travel."""
    return Falling(first, min(first, last), ANNEALED * first_travel(joints))


def travels(path: QuasiStaticPath, settings: PredictionSettings) -> tuple[float, float]:
    """Least and longest progress of a path. A structure that turns farther has another geometry.

    Under a live load both follow from the pace so far. The pace may still change a little, so a path that has nearly come to its least
    progress counts as having reached it. The longest progress is at least twice the progress at which the viscosity has fallen, because the
    second half of a curve is judged.
    """
    first, least, reached = first_travel(path.joints), least_travel(path.joints), path.last.progress
    if path.joints.turning is None:
        return least, 2.0**settings.doublings * least
    at_its_pace = least / path.pace
    least = reached if abs(at_its_pace - reached) <= NEARLY * reached else at_its_pace
    return least, max(TURNED * least, 2.0 * ANNEALED * first if path.joints.live else 0.0)


def first_end(path: QuasiStaticPath, usual: float) -> float:
    """Progress at which a path is judged first: earlier than usual where blocks turn under a live load, because their pace may be high."""
    joints = path.joints
    is_early = joints.live and joints.turning is not None
    return max(first_travel(joints) / STIFFER, path.last.progress) if is_early else usual


def next_end(end: float, least: float, longest: float) -> float:
    """Progress at which a path is judged next: twice as far, but at its least progress if that comes first, and at most its longest."""
    return least if end < least < 2.0 * end else min(2.0 * end, longest)


def is_at_end(end: float, longest: float) -> bool:
    """Whether a path has come to its longest progress, or nearly."""
    return end >= (1.0 - NEARLY) * longest


def most_iterations(joints: ElasticJoints, settings: PredictionSettings) -> float:
    """Most Newton iterations of a path."""
    return settings.effort / float(np.sqrt(min(len(joints.weights), LARGE)))


def follow_large(
    joints: ElasticJoints, tangent: Tangent, wedging: float, first: float, settings: PredictionSettings, is_finest: bool, send: Sender
) -> FollowedPath | None:
    """Follow a path with smooth joints to its plateau, then with joints that become sharp.

    The finest path goes on to the limit state near its end; a coarser one only shows the effect of the smoothing. None where the
    path cannot begin.
    """
    travel, most = first_travel(joints), MORE_EFFORT * most_iterations(joints, settings)
    force = 1.0 / len(joints.friction)  # mean contact force
    smooth, sharp = SMOOTH * first * force, min(SMOOTH * first, SMOOTH_END) * force
    viscosity = Falling(LESS_VISCOUS * first, min(LESS_VISCOUS * first, LAST_OF_SMOOTH), travel)
    rest, _ = come_to_rest(joints, tangent, wedging, smooth)
    if rest is None:
        return None
    path = QuasiStaticPath(joints, tangent, rest, viscosity, settings.finer, Falling(smooth, smooth, travel))
    end = _to_plateau(path, settings, most, send)
    if not (is_short := path.last.progress < end):
        path.smoothing = Falling(smooth, sharp, (1.0 + SHARPENED) * end, end)
        end *= 1.0 + SHARPENED
        for point in path.advance_to(end, path.iterations + SHARP_EFFORT * most):
            send(point.progress, end, point.value)
    reached, progress, values = path.last.progress, *path.curve
    if reached == 0.0:
        return None
    error = LAW_ERROR * float(np.sqrt(smooth * force))
    if is_finest:
        ended = limit_state_near(path, lambda: send(reached, end, float(values[-1])))
        return FollowedPath.on(path, (progress, values), ended, path.value(ended.last), reached < end, is_short, error)
    return FollowedPath.on(path, (progress, values), end_of(path), float(values[-1]), reached < end, is_short, error)


def _to_plateau(path: QuasiStaticPath, settings: PredictionSettings, most: float, send: Sender) -> float:
    """Follow a path over its least travel, and on until its plateau is known or blocks cease to turn; return the end.

    most: most Newton iterations of the path. Beyond its least travel it takes at most AGAIN times the iterations of that travel, at the
    usual effort. Where the iterations end the path within its least travel, its progress is below the returned end.
    """
    again, end = AGAIN * settings.effort / PredictionSettings.effort, first_end(path, least_travel(path.joints))
    least, is_cut = travels(path, settings)[0], False
    while True:
        for point in path.advance_to(end, most):
            send(point.progress, (1.0 + SHARPENED) * max(end, least), point.value)
        reached, (least, longest) = path.last.progress, travels(path, settings)
        is_known = reached >= least and plateau.plateau_of(*path.curve, reached, path.points[-1].value).is_known
        if reached < end or is_at_end(end, longest) or is_known:
            path.joints = path.joints_as_turned
            return max(reached, least)
        if reached >= least and not is_cut:
            most, is_cut = min(most, (1.0 + again) * path.iterations), True
        end = next_end(end, least, longest)
