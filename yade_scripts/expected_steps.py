"""Time steps that an attempt is expected to take, so that a run can tell how long it still goes on."""

from dataclasses import dataclass

from yade_scripts.case import Case
from yade_scripts.driving import servo_of
from yade_scripts.settings import Settings

RESTING = 1.1  # time steps of the rest under gravity over those in which the weights grow: blocks rest soon after
SETTLING = 1.25  # time steps to a plateau over those to the least travel: of 67 attempts at 35 random walls three quarters took less
USUAL_MULTIPLIER = 1.0  # of a live load, while no method has said what the structure bears


@dataclass(frozen=True)
class AttemptSteps:
    """Time steps that are expected of an attempt.

    Attributes
    ----------
    usual : float
        To the first plateau that it may show.
    most : float
        To the end of its travel.
    later : float
        Of the attempt at the run's own speed that follows a quick one.
    """

    usual: float
    most: float
    later: float

    def left(self, done: int) -> float:
        """Return the steps that are left: to the plateau, or to the end of the travel where it is late, and of the later attempt."""
        return max((self.usual if done < self.usual else self.most) - done, 0.0) + self.later


def expected_steps(case: Case, settings: Settings, pace: float) -> AttemptSteps:
    """Return the time steps that are expected of an attempt; pace: its speed over that of the run."""
    wedging = settings.wedging / settings.speed
    resting = (RESTING * settings.gravity_ramp + wedging) / settings.time_step
    starting, loading, longest_loading = 0.5 * settings.ramp_time + wedging, 0.0, 0.0
    if case.live is not None:
        servo = servo_of(case, settings)
        loading, longest_loading = servo.loading_time(USUAL_MULTIPLIER), servo.loading_time()
    longest = (starting + longest_loading + settings.max_travel / settings.speed) / settings.settling_step
    usual = min(SETTLING * (starting + loading + settings.plateau_travel / settings.speed) / settings.settling_step, longest)
    return AttemptSteps(resting + usual, resting + longest, resting + pace * usual if pace > 1.0 else 0.0)
