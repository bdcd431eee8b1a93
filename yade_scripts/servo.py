"""Drive a structure by its live load: a multiplier that keeps the mean displacement along the load growing at constant speed.

A load in proportion to weight is an acceleration, so only the vector of gravity changes. The servo acts on the free blocks like a spring
and a dashpot between their mean displacement u along the load and a point that moves away at constant speed. It adds no energy, whatever
the mechanism is, because the mean displacement is what the load does work on: force and speed are measured at the same place. With
alpha the multiplier and g gravity, a structure that moves freely along the load obeys u'' = g alpha; spring and dashpot over the weight
are therefore chosen by the frequency and the damping ratio of u.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from yade_scripts.case import Case
from yade_scripts.settings import Settings

if TYPE_CHECKING:  # these load YADE
    from yade_scripts.bodies import Model
    from yade_scripts.recorder import Record

LARGEST_MULTIPLIER = 5.0  # of a live load; a structure that bears more is wedged in
LAG = 0.2  # decay of the servo's own motion, by its dashpot, between two of its steps


@dataclass
class Servo:
    """The point that pulls, and how hard.

    Attributes
    ----------
    spring : float
        Multiplier over the distance by which the blocks lag behind the point, 1/m.
    dashpot : float
        Multiplier over the speed by which they lag, s/m.
    speed : float
        Speed of the point at the end of its ramp, m/s.
    ramp_time : float
        Duration of the cosine ramp, s.
    every : int
        Time steps from one multiplier to the next.
    """

    spring: float
    dashpot: float
    speed: float
    ramp_time: float
    every: int

    def pulled(self, elapsed: float) -> tuple[float, float]:
        """Return motion (m) and speed (m/s) of the point, `elapsed` seconds after its start from rest."""
        ramp = self.ramp_time
        if elapsed >= ramp:
            return self.speed * (elapsed - 0.5 * ramp), self.speed
        phase = math.pi * elapsed / ramp
        return 0.5 * self.speed * (elapsed - ramp / math.pi * math.sin(phase)), 0.5 * self.speed * (1.0 - math.cos(phase))

    def multiplier(self, elapsed: float, displacement: float, speed: float) -> float:
        """Return the multiplier for blocks with this mean displacement (m) and speed (m/s) along the load."""
        place, rate = self.pulled(elapsed)
        return self.spring * (place - displacement) + self.dashpot * (rate - speed)

    @property
    def loading_time(self) -> float:
        """Time to the largest multiplier while the blocks stand, s."""
        return LARGEST_MULTIPLIER / (self.spring * self.speed)

    def start(self, record: Record, model: Model) -> None:
        """Measure displacements from here, and pull from the next step on."""
        record.start_load()
        model.drive.iterPeriod, model.drive.dead = self.every, False

    def pull(self, elapsed: float, record: Record, model: Model) -> None:
        """Set the multiplier, `elapsed` seconds after the start."""
        case, multiplier = record.case, self.multiplier(elapsed, record.settlement(), record.speed_along())
        if case.live is not None:
            model.integrator.gravity = case.gravity + multiplier * np.linalg.norm(case.gravity) * case.live


def servo_of(case: Case, settings: Settings) -> Servo:
    """Return the servo of a case with a live load."""
    gravity = case.weight / float(case.mass[case.free].sum())
    sag = case.sag * case.normal_stiffness / settings.normal_stiffness
    frequency = settings.servo_frequency * math.sqrt(gravity / sag)
    decay = 2.0 * settings.servo_damping * frequency
    every = max(1, int(LAG / (decay * settings.time_step)))
    return Servo(frequency**2 / gravity, decay / gravity, settings.speed, settings.ramp_time, every)
