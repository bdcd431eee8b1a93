"""Drive a structure by its live load: a multiplier that keeps the blocks moving along the load at constant speed.

A load in proportion to weight is an acceleration, so only the vector of gravity changes. Let a mechanism have the velocities v along the
load, let alpha be the multiplier, and let q' be the mean of v, weighted by m v. Then q'' = g (alpha - resistance) for every set of moving
blocks, because the power of the load and the kinetic energy have the same factor. So the servo keeps this mean constant. The weights follow
the motion of the last windows of time. There the motion of blocks that swing about their places cancels; if it counted, the other blocks
would move faster than set. Blocks that stand still strain their joints while the multiplier grows. A heavy wall would then outweigh a light
pinnacle that slides on it. So the motion by which the structure sways under the change of the multiplier does not count, either. The servo
acts like a spring and a dashpot, derived from a frequency and a damping ratio of q. While the blocks stand still, the spring stretches.
"""

import math
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from yade_scripts.case import Case
from yade_scripts.settings import Settings, sag_of, sway_over_sag

LARGEST_MULTIPLIER = 5.0  # of a live load; a structure that bears more is wedged in
LAG = 0.2  # largest decay of a block's motion, by the servo's dashpot, between two changes of the multiplier; above 2 it is unstable
LONG_SWAY = 4.0  # period of the sway over that of the sag: beyond this the servo is slower, so that it does not swing with standing blocks
SLOWEST = 5.0  # largest factor by which the servo is slower: the spring of a slower one would stretch over the whole travel
OPENED = 2.0  # sway of a structure whose joints open as the multiplier grows, over its sway with glued joints
RENEWED = 0.5  # share of the remembered motion that the motion of the last window replaces


class LoadedBlocks(Protocol):
    """The blocks that a live load pulls."""

    @property
    def masses(self) -> np.ndarray:
        """Masses of the blocks (n,), kg."""

    def along(self, name: str) -> np.ndarray:
        """Return the blocks' positions along the load (n,), m, for "pos", or their speeds (n,), m/s, for "vel"."""


@dataclass
class Servo:
    """The servo of a live load: a point that moves away and pulls the blocks by a spring and a dashpot.

    Attributes
    ----------
    spring : float
        Multiplier over the distance by which the blocks lag behind the point, 1/m.
    dashpot : float
        Multiplier over the speed by which the blocks are slower than the point, s/m.
    speed : float
        Speed of the point at the end of its ramp, m/s.
    ramp_time : float
        Duration of the cosine ramp, s.
    every : int
        Time steps from one change of the multiplier to the next.
    window : float
        Duration of a window of motion from which the weights are renewed, s.
    sway : float
        Largest motion of standing blocks along the load, over the change of the multiplier, m.
    moved : float
        Motion of the blocks so far: integral of their weighted mean speed, m.
    acting : float
        The last multiplier.
    """

    spring: float
    dashpot: float
    speed: float
    ramp_time: float
    every: int
    window: float
    sway: float = 0.0
    moved: float = 0.0
    acting: float = 0.0
    _last: float = 0.0
    _window_began: float = 0.0
    _acted: float = 0.0  # the multiplier when the window began
    _places: np.ndarray = field(default_factory=lambda: np.zeros(0))
    _weights: np.ndarray = field(default_factory=lambda: np.zeros(0))
    _motion: np.ndarray = field(default_factory=lambda: np.zeros(0))  # mass times motion in a window, mean over the last windows, kg m

    def pulled(self, elapsed: float) -> tuple[float, float]:
        """Return motion (m) and speed (m/s) of the pulling point, `elapsed` seconds after its start from rest."""
        ramp = self.ramp_time
        if elapsed >= ramp:
            return self.speed * (elapsed - 0.5 * ramp), self.speed
        phase = math.pi * elapsed / ramp
        return 0.5 * self.speed * (elapsed - ramp / math.pi * math.sin(phase)), 0.5 * self.speed * (1.0 - math.cos(phase))

    def multiplier(self, elapsed: float, speed: float) -> float:
        """Return the multiplier for blocks with this weighted mean speed along the load, m/s."""
        self.moved += speed * (elapsed - self._last)
        self._last = elapsed
        place, rate = self.pulled(elapsed)
        self.acting = self.spring * (place - self.moved) + self.dashpot * (rate - speed)
        return self.acting

    def weighted(self, speeds: np.ndarray) -> float:
        """Return the weighted mean of the blocks' speeds (n,), m/s."""
        return float(self._weights @ speeds)

    def renew(self, elapsed: float, masses: np.ndarray, places: np.ndarray) -> None:
        """Renew the weights by the motion of the blocks since the last window began; masses (n,), kg; places along the load (n,), m."""
        if len(self._weights):
            motion, strain = places - self._places, self.sway * abs(self.acting - self._acted)
            self._motion += RENEWED * (masses * (motion - np.clip(motion, -strain, strain)) - self._motion)
            along = np.maximum(self._motion, 0.0)
            if along.sum() > 0.0:
                self._weights = along / along.sum()
        else:
            self._weights, self._motion = masses / masses.sum(), np.zeros(len(masses))
        self._places, self._window_began, self._acted = places, elapsed, self.acting

    def loading_time(self, multiplier: float = LARGEST_MULTIPLIER) -> float:
        """Return the time in which the multiplier grows to this value while the blocks stand still, s."""
        return multiplier / (self.spring * self.speed)

    def start(self, blocks: LoadedBlocks) -> None:
        """Begin the first window: motions are measured from the present positions."""
        self.renew(0.0, blocks.masses, blocks.along("pos"))

    def measured(self, elapsed: float, blocks: LoadedBlocks) -> float:
        """Return the multiplier for the present speeds of the blocks, `elapsed` seconds after the start."""
        if elapsed - self._window_began >= self.window:
            self.renew(elapsed, blocks.masses, blocks.along("pos"))
        return self.multiplier(elapsed, self.weighted(blocks.along("vel")))


def pushed_of(case: Case) -> np.ndarray:
    """Return the live load (F,) of multiplier 1 on each free block, N; it does not act on dead loads that are given as forces."""
    assert case.live is not None
    return np.asarray(case.mass[case.free] * np.linalg.norm(case.gravity) + case.live_load[case.free, :3] @ case.live)


def servo_of(case: Case, settings: Settings) -> Servo:
    """Return the servo of a case with a live load."""
    gravity = float(np.linalg.norm(case.gravity))
    sag, slender = sag_of(case, settings.normal_stiffness), sway_over_sag(case)
    slower = min(max(1.0, slender / LONG_SWAY), SLOWEST)
    frequency = settings.servo_frequency / slower * math.sqrt(gravity / sag)
    decay = 2.0 * settings.servo_damping * frequency
    # The live load acts on a dead load that is given as a mass, but this mass has no inertia. So its block accelerates faster by the ratio
    # of the loaded weight to the block's own weight.
    quickest = float((pushed_of(case) / (case.mass[case.free] * gravity)).max())
    every = max(1, int(LAG / (quickest * decay * settings.settling_step)))
    window, sway = 1.0 / frequency, OPENED * sag * slender**2
    return Servo(frequency**2 / gravity, decay / gravity, settings.speed, settings.ramp_time, every, window, sway)
