"""The attempts of a run: quick ones that find the stiffness, then slower ones until speed hardly matters.

The first attempt moves `quick_speed` times as fast as the run. Where its curve still creeps at the end of the travel, the
joints are made stiffer: only travel over the elastic sag counts. Then comes the run at its own speed. The difference
between the two says what the speed may still do: at most as much as if the reaction followed its root. (What follows the
speed itself, as drag does, is overestimated; the history of friction has come close to the root.) The noise of the quicker
attempt, which hides a smaller difference, is added. Where a run sticks and slips, or the part of the speed is large, a slower
attempt follows.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from yade_scripts.case import Case
from yade_scripts.plateau import Outcome
from yade_scripts.protocol import Protocol, Status
from yade_scripts.settings import Settings, derive

STIFFER, MOST_STIFFENING = 4.0, 64.0  # from one attempt to the next; at most
SLOWER, SLOWEST = 0.25, 0.25  # from one attempt to the next; at least, of the speed of the run
QUICK_STOP = 0.005  # uncertainty, as a share of the reaction, below which a quick attempt stops
ENOUGH = 0.02  # of the reaction: part of the speed above which a slower attempt follows
MOST_WORK = 3e8  # time steps times contact points of all attempts: one that would take more is not made


@dataclass(frozen=True)
class Attempts:
    """What the attempts came to.

    Attributes
    ----------
    last : Protocol
        The attempt that counts.
    outcome : Outcome
        Its reaction, with the part of the speed.
    steps : int
        Time steps of all attempts.
    message : str
        How the last one ended, and what the others were.
    """

    last: Protocol
    outcome: Outcome
    steps: int
    message: str


def make(case: Case, run: Callable[[Case, Settings], Protocol]) -> Attempts:
    """Make the attempts of a case. run: makes one attempt with given settings."""
    pace, stiffening, before, steps, history = derive(case).quick_speed or 1.0, None, None, 0, ""
    while True:
        attempt = run(case, settings_of(case, pace, stiffening))
        steps += attempt.steps
        outcome = _with_rate(attempt, before)
        again = _next(attempt, outcome, pace, steps)
        if again is None:
            return Attempts(attempt, outcome, steps, attempt.message + history)
        history += f"; before, at {pace:g} times the speed and {attempt.settings.stiffening:g} times the stiffness: {attempt.message}"
        before = attempt if attempt.status is Status.PLATEAU else None
        pace, stiffening = again


def settings_of(case: Case, pace: float, stiffening: float | None) -> Settings:
    """Return the settings of an attempt at `pace` times the speed of the run. stiffening: in place of the derived one, or None."""
    changed = case if stiffening is None else replace(case, overrides=case.overrides | {"stiffening": stiffening})
    settings = derive(changed)
    stop = max(settings.stop_uncertainty, QUICK_STOP) if pace > 1.0 else settings.stop_uncertainty
    ramp, periods = settings.ramp_time / pace, settings.travel_periods / pace
    return replace(settings, speed=pace * settings.speed, ramp_time=ramp, travel_periods=periods, stop_uncertainty=stop)


def _with_rate(attempt: Protocol, before: Protocol | None) -> Outcome:
    """Return the outcome of an attempt, with the part of the speed from the quicker one before."""
    if before is None or before.settings.stiffening != attempt.settings.stiffening:
        return attempt.outcome
    pace = before.settings.speed / attempt.settings.speed
    left = abs(before.outcome.reaction - attempt.outcome.reaction) / (math.sqrt(pace) - 1.0)
    return replace(attempt.outcome, rate=math.hypot(left, before.outcome.scatter))


def _next(attempt: Protocol, outcome: Outcome, pace: float, steps: int) -> tuple[float, float] | None:
    """Return pace and stiffening of the next attempt; None where the last one counts."""
    settings, given = attempt.settings, attempt.case.overrides
    if attempt.status not in (Status.PLATEAU, Status.NO_PLATEAU):
        return None  # a quick attempt that falls would fall at any speed
    creeps = attempt.status is Status.NO_PLATEAU and attempt.plateau.creeps
    stiffer = STIFFER * settings.stiffening
    may_stiffen = stiffer <= MOST_STIFFENING and "normal_stiffness" not in given and settings.wedging == 0.0
    if creeps and may_stiffen and _affordable(attempt, steps, 1.0):
        return pace, stiffer
    if pace > 1.0:
        return 1.0, settings.stiffening
    unsure = attempt.status is Status.NO_PLATEAU or (not math.isnan(outcome.rate) and outcome.rate > ENOUGH * abs(outcome.reaction))
    if unsure and not creeps and pace > SLOWEST and "speed" not in given and _affordable(attempt, steps, 1.0 / SLOWER):
        return SLOWER * pace, settings.stiffening
    return None


def _affordable(attempt: Protocol, steps: int, longer: float) -> bool:
    return (steps + longer * attempt.steps) * len(attempt.case.host) <= MOST_WORK
