"""The quasi-static path: the structure followed from rest while its support moves, with a drag that vanishes on the way.

A structure with friction loses stability again and again on its way to the plateau, where a joint slips or parts and some
blocks move on at once. Without a drag such a move has no duration. With a drag of viscosity eta on the rate of every block,

    J' f(q) + w = eta M dq/dp,

it takes a short stretch of the progress p, and steps that are short enough always converge. M contains every block's share of
the mass, so that the drag on all blocks at unit rate is eta times the weight. The viscosity falls from its first value to almost
nothing over the first part of the way. While it is large, the structure passes its first instabilities in few steps. The effect of
this drag fades, as most of the early history does. The power of the remaining drag is known, and so is the reaction without it, by
the balance of power: R = R_with_drag + eta sum(M v^2), v = dq/dp.
"""

import copy
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.implicit_step import State, Target, Trial, advance
from la_core.coulomb.path.tangent import Tangent
from la_core.model import ELASTIC_SHARE, twists_of

FIRST_STEP = 0.05  # of the elastic sag
LONGEST_STEP, LONGEST_SHARE = 0.05, 0.25  # of the travel, or of the progress where that is more
SLIVER = 0.01  # of a step: where less is left to the end, the step goes on to the end
LARGEST_CHANGE, SMOOTH_CHANGE = 0.06, 0.2  # of the contact forces, in one step of sharp and of smooth joints
GROWTH, CUT = 1.6, 4.0  # of the length of the step: after an easy step, and after one that did not converge
CAUTION, REGAINED = 0.7, 1.3  # limit of the length over one that failed, and growth of this limit with every step
EASY, SLIGHT_CHANGE = 8, 0.6  # iterations of a step, and share of its largest change, after which the next one may be longer
AIMED_CHANGE = 0.8  # of its largest change: a step that changed too much is shortened in proportion to reach this
SHORTEST_STEP = 1e-13  # of the travel
AVERAGED = 0.02  # of the progress: the drag's power uses the mean rate over this stretch, because the rate in a jump is untypical
SAGS = 1.0 / ELASTIC_SHARE  # least travel over the elastic sag; more than one travel where the scene's own joints are softer


@dataclass(frozen=True)
class Falling:
    """Quantity that falls along the path: the viscosity (multiples of the weight at unit rate), or the smoothing (force).

    Attributes
    ----------
    first : float
        Value until `start`.
    last : float
        Value from `until` on; in between its logarithm falls evenly.
    until : float
        Progress from which on it keeps its last value, over the travel.
    start : float
        Progress from which on it falls, over the travel.
    """

    first: float
    last: float
    until: float
    start: float = 0.0

    def at(self, progress: float) -> float:
        """Value at a progress over the travel."""
        if self.first == self.last:
            return self.first
        share = min(max((progress - self.start) / (self.until - self.start), 0.0), 1.0)
        return float(self.first * (self.last / self.first) ** share)


SHARP = Falling(0.0, 0.0, 1.0)  # smoothing of sharp joints


@dataclass(frozen=True)
class Point:
    """Point of the curve; all numbers are scaled.

    Attributes
    ----------
    progress : float
        Motion of the support, or displacement along the live load, over the travel.
    value : float
        Reaction over the weight, or multiplier, without the drag.
    drag : float
        Part of the value that replaces the drag.
    iterations : int
        Newton iterations of the path so far.
    """

    progress: float
    value: float
    drag: float
    iterations: int


class QuasiStaticPath:
    """Path of one structure, which can be followed in several stretches.

    Parameters
    ----------
    joints : ElasticJoints
        Structure on its elastic joints.
    tangent : Tangent
        Its tangent matrices.
    rest : State
        State at rest under gravity, from `rest.come_to_rest`.
    viscosity : Falling
        Drag along the path.
    finer : float
        Factor by which the limits of a step are divided: its first and greatest length, and the change of forces.
    smoothing : Falling
        Force over which contact points part and slip gradually, along the path.

    Attributes
    ----------
    before, last : State
        States at the start and at the end of the last step.
    points : list of Point
        Curve so far.
    iterations : int
        Newton iterations so far, also those of steps that did not converge.
    """

    def __init__(
        self,
        joints: ElasticJoints,
        tangent: Tangent,
        rest: State,
        viscosity: Falling,
        finer: float = 1.0,
        smoothing: Falling = SHARP,
    ) -> None:
        self.joints, self.viscosity, self.smoothing, self.iterations = joints, viscosity, smoothing, 0
        self._tangent, self._finer = tangent, finer
        self._offset = rest.progress  # of the support, from wedging
        self._rest_blocks = rest.blocks
        self._live_at = float(joints.live_load @ rest.blocks)
        self.last = self.before = replace(rest, progress=0.0)
        self.points = [Point(0.0, self.value(self.last), 0.0, 0)]
        self._rate = np.zeros_like(rest.blocks)
        self._mark = self._older_mark = self.last
        self._length, self._limit = FIRST_STEP * joints.sag / finer, np.inf

    def copy(self) -> "QuasiStaticPath":
        """Return a copy of the path that goes on from here on its own."""
        other = copy.copy(self)
        other.points = list(self.points)
        return other

    @property
    def curve(self) -> tuple[np.ndarray, np.ndarray]:
        """Progress (P,) and value (P,) of all points."""
        return np.array([point.progress for point in self.points]), np.array([point.value for point in self.points])

    @property
    def joints_as_turned(self) -> ElasticJoints:
        """The joints with the second order of the last state, whose rotations are small from here on."""
        return self.joints.as_turned(self.last.blocks, self._support_at(self.last.progress), for_good=True)

    @property
    def rate(self) -> np.ndarray:
        """Rate (n,) of the free blocks in the last step, over the progress."""
        return self._rate

    @property
    def pace(self) -> float:
        """Displacement of the fastest block, which the travel limits in YADE, over the progress, at least 1; 1 without a live load."""
        if not self.joints.live or self.last.progress == 0.0:
            return 1.0
        moved = twists_of(self.joints.assembly, self.last.blocks - self._rest_blocks)[:, :3]
        return max(float(np.linalg.norm(moved, axis=1).max()) / self.last.progress, 1.0)

    def value(self, state: State) -> float:
        """Scaled reaction, or multiplier, of a state, with the drag."""
        return state.multiplier if self.joints.live else self.joints.reaction(state.joints.force)

    def advance_to(
        self,
        end: float,
        most_iterations: float = np.inf,
        viscosity: float | None = None,
        longest: float = np.inf,
    ) -> Iterator[Point]:
        """Follow the path to a progress and yield every point; stop early after `most_iterations` of the whole path.

        The path also stops where no step is short enough; `last.progress` then lies before the end.

        Parameters
        ----------
        end : float
            Progress to reach exactly, over the travel.
        most_iterations : float
            Newton iterations of the whole path after which it stops.
        viscosity : float, optional
            Viscosity of this stretch; None takes the path's own.
        longest : float
            Longest step, over the travel.
        """
        while self.last.progress < end and self.iterations < most_iterations:
            length = min(self._length, longest, end - self.last.progress)
            if end - self.last.progress - length < SLIVER * length:
                length = end - self.last.progress
            progress = end if length == end - self.last.progress else self.last.progress + length
            eta = self.viscosity.at(progress) if viscosity is None else viscosity
            smoothing = self.smoothing.at(progress)
            most_change = (SMOOTH_CHANGE if smoothing > 0.0 else LARGEST_CHANGE) / self._finer
            trial = self._trial(progress, eta / length, length, smoothing)
            self.iterations += trial.iterations
            change = _change(self.last, trial.state) if trial.state is not None else np.inf
            if trial.state is not None and (change <= most_change or length <= SHORTEST_STEP):
                self._accept(trial.state, length, eta)
                self._lengthen(trial.iterations, change / most_change, length)
                yield self.points[-1]
            elif not self._shorten(trial.state is not None, change / most_change, length):
                return

    def _lengthen(self, iterations: int, change: float, length: float) -> None:
        """Choose the length of the next step after an accepted one of `length`. change: of the forces, as a share of its limit."""
        self._limit *= REGAINED
        if iterations <= EASY and change < SLIGHT_CHANGE:
            longest = max(LONGEST_STEP, LONGEST_SHARE * self.last.progress) / self._finer
            self._length = min(GROWTH * max(length, self._length), longest, max(self._limit, length))

    def _shorten(self, converged: bool, change: float, length: float) -> bool:
        """Choose the length of the next trial after a refused one of `length`. change: of the forces, as a share of its limit.

        Returns False where the length is too short.
        """
        if converged:
            self._length = length * max(1.0 / CUT, AIMED_CHANGE / change)
        else:
            self._limit = CAUTION * length
            self._length = length / CUT
        return self._length >= SHORTEST_STEP

    def _support_at(self, progress: float) -> float:
        """Motion of the support since the blocks were laid, over the travel."""
        return 0.0 if self.joints.live else self._offset + progress

    def _trial(self, progress: float, drag: float, length: float, smoothing: float) -> Trial:
        """Try a step. Turning blocks keep the second order of the first guess, because the tangent is of first order."""
        live_at = self._live_at + progress if self.joints.live else None
        guess = self.last.blocks + length * self._rate
        target = Target(progress, self._support_at(progress), live_at)
        return advance(self.joints.as_turned(guess, target.support), self._tangent, self.last, target, drag, guess, smoothing)

    def _accept(self, state: State, length: float, viscosity: float) -> None:
        self.before, self.last = self.last, state
        self._rate = (state.blocks - self.before.blocks) / length
        if state.progress - self._mark.progress > AVERAGED * state.progress:
            self._older_mark, self._mark = self._mark, self.before
        start = self._mark if state.progress - self._mark.progress >= 0.5 * AVERAGED * state.progress else self._older_mark
        mean = (state.blocks - start.blocks) / (state.progress - start.progress)
        power = viscosity * float(self.joints.mass @ mean**2)
        drag = -power if self.joints.live else power
        self.points.append(Point(state.progress, self.value(state) + drag, drag, self.iterations))


def first_travel(joints: ElasticJoints) -> float:
    """Travel over which the strain of the joints fades: the whole travel, but at least SAGS elastic sags."""
    return max(1.0, SAGS * joints.sag)


def least_travel(joints: ElasticJoints) -> float:
    """Travel of a path before its curve is judged: the first travel; where blocks turn, that of the joints that the path represents."""
    return first_travel(joints) / (1.0 if joints.turning is None else joints.turning.share)


def _change(before: State, after: State) -> float:
    """Change of the contact forces in a step, relative to the forces."""
    old, new = before.joints.force, after.joints.force
    return float(np.abs(new - old).sum() / max(np.abs(old).sum(), np.abs(new).sum(), 1e-12))
