"""Time steps that an attempt is expected to take, so that a run can tell how long it still goes on."""

from dataclasses import dataclass

from yade_scripts.case import Case
from yade_scripts.driving import servo_of
from yade_scripts.settings import Settings

RESTING = 1.1  # time steps of the rest under gravity over those in which the weights grow: blocks rest soon after
SETTLING = 1.25  # time steps to a plateau over those to the least travel: of 139 attempts at 59 random walls 108 took less
LATE_MORE = 0.4  # steps that a late plateau still takes, over those so far: half of the 31 late attempts took less
USUAL_MULTIPLIER = 1.0  # of a live load: YADE is not told what limit analysis predicts


@dataclass(frozen=True)
class AttemptSteps:
    """Time steps that are expected of an attempt.

    Attributes
    ----------
    resting : float
        Until the blocks rest under gravity.
    settling : float
        From there to the plateau; a later plateau is late.
    longest : float
        From there to the end of the travel.
    later : float
        Of the slower attempt that follows a quick one; 0 where none is expected.
    """

    resting: float
    settling: float
    longest: float
    later: float

    def left(self, rested: int, settled: int) -> float:
        """Return the steps that are left, with those of the later attempt.

        rested: steps under gravity so far; settled: steps since then, 0 before.
        """
        if settled == 0:
            return max(self.resting - rested, 0.0) + self.settling + self.later
        more = LATE_MORE * settled if self.is_late(settled) else self.settling - settled
        return max(min(more, self.longest - settled), 0.0) + self.later

    def is_late(self, settled: int) -> bool:
        """Return whether the plateau was expected before so many steps of the settlement."""
        return settled >= self.settling


def expected_steps(case: Case, settings: Settings, pace: float) -> AttemptSteps:
    """Return the time steps that are expected of an attempt; pace: its speed over that of the attempt that counts."""
    growing, wedging = RESTING * settings.gravity_ramp, settings.wedging / settings.speed
    starting, loading, longest_loading = 0.5 * settings.ramp_time + wedging, 0.0, 0.0
    if case.live is not None:
        servo = servo_of(case, settings)
        loading, longest_loading = servo.loading_time(USUAL_MULTIPLIER), servo.loading_time()
    longest = (starting + longest_loading + settings.max_travel / settings.speed) / settings.settling_step
    settling = min(SETTLING * (starting + loading + settings.plateau_travel / settings.speed) / settings.settling_step, longest)
    later = (growing + pace * wedging) / settings.time_step + pace * settling
    return AttemptSteps((growing + wedging) / settings.time_step, settling, longest, later if pace > 1.0 else 0.0)
