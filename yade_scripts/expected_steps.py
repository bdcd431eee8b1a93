"""Expected number of time steps of an attempt, from which a run estimates its remaining time."""

from dataclasses import dataclass

from yade_scripts.case import Case
from yade_scripts.driving import servo_of
from yade_scripts.settings import Settings

RESTING = 1.1  # time steps until the blocks rest, over those in which the weights grow: blocks rest soon after the ramp
SETTLING = 1.25  # time steps to a plateau over those to the least travel: of 139 attempts at 59 random walls 108 took less
LATE_MORE = 0.4  # further steps to a late plateau over the steps so far: half of the 31 late attempts took less
USUAL_MULTIPLIER = 1.0  # assumed multiplier of a live load, because YADE does not know the prediction of limit analysis


@dataclass(frozen=True)
class AttemptSteps:
    """Expected numbers of time steps of an attempt.

    Attributes
    ----------
    resting : float
        Steps until the blocks rest under gravity.
    settling : float
        Steps from rest to the plateau; a plateau after more steps is late.
    longest : float
        Steps from rest to the end of the travel.
    later : float
        Steps of the slower attempt that follows a quick one; 0 if none is expected.
    """

    resting: float
    settling: float
    longest: float
    later: float

    def left(self, rested: int, settled: int) -> float:
        """Return the remaining steps, including those of the later attempt.

        rested: steps under gravity so far; settled: steps since rest, 0 before rest.
        """
        if settled == 0:
            return max(self.resting - rested, 0.0) + self.settling + self.later
        more = LATE_MORE * settled if self.is_late(settled) else self.settling - settled
        return max(min(more, self.longest - settled), 0.0) + self.later

    def is_late(self, settled: int) -> bool:
        """Return whether the plateau is late after this number of steps since rest."""
        return settled >= self.settling


def expected_steps(case: Case, settings: Settings, pace: float) -> AttemptSteps:
    """Return the expected time steps of an attempt; pace: its speed over that of the attempt that counts."""
    growing, wedging = RESTING * settings.gravity_ramp, settings.wedging / settings.speed
    starting, loading, longest_loading = 0.5 * settings.ramp_time + wedging, 0.0, 0.0
    if case.live is not None:
        servo = servo_of(case, settings)
        loading, longest_loading = servo.loading_time(USUAL_MULTIPLIER), servo.loading_time()
    longest = (starting + longest_loading + settings.max_travel / settings.speed) / settings.settling_step
    settling = min(SETTLING * (starting + loading + settings.plateau_travel / settings.speed) / settings.settling_step, longest)
    later = (growing + pace * wedging) / settings.time_step + pace * settling
    return AttemptSteps((growing + wedging) / settings.time_step, settling, longest, later if pace > 1.0 else 0.0)
