"""The attempts of a run: quick ones that find damping and stiffness, then slower ones until the speed hardly matters.

The first attempt moves `quick_speed` times as fast as the run. How it ends decides what follows:

- Its blocks rattle: the next attempt damps the swing of the blocks, which leaves the time step as it is. Where blocks rattle even then, the
  contacts get critical damping, too, and steps are a third as long. Where one of a hundred blocks or more jumps even so, two attempts with
  the light dashpots follow, at a half and a quarter of the run's speed; where these fail, that at the run's speed with critical damping.
  (A large plane structure, whose swing is damped at once, keeps its dashpots: on a wall of 1,008 blocks both gave the same reaction.)
- Its curve still creeps at the end of the travel: the next attempt has stiffer joints, because only travel over the elastic sag counts.
- It sticks and slips: the next attempt damps the swing.
- Otherwise the attempt at the run's own speed follows, and a slower one where this one still sticks and slips, or its speed matters much.

The difference between two speeds gives the part of the speed in the uncertainty. The effect is taken to grow with the root of the speed, as
that of friction's history nearly does; an effect that grows with the speed itself, such as drag, is then overestimated. The noise of the
quicker attempt is added, because it may hide a small difference.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from la_core.exchange import EARLIER_ATTEMPT, UNCERTAIN
from yade_scripts.case import Case
from yade_scripts.contacts.near_faces import NearFaces
from yade_scripts.faults import is_restless
from yade_scripts.plateau import Outcome
from yade_scripts.protocol import Protocol
from yade_scripts.recorder import Status
from yade_scripts.settings import CRITICAL, SWING_DAMPING, Settings, derive, is_large, is_long, most_steps, slowness

STIFFER, MOST_STIFFENING = 4.0, 64.0  # from one attempt to the next; at most
SLOWER, SLOWEST = 0.25, 0.25  # from one attempt to the next; at least, of the speed of the run
SLOW_PAIR = 4.0  # time steps of both slow attempts over those of a quick critical one: 12 times its duration, in steps 3 times as long


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


@dataclass(frozen=True)
class Plan:
    """An attempt to be made.

    Attributes
    ----------
    pace : float
        Its speed over that of the run.
    stiffening, damping, swing : float or None
        Stiffening and both dampings; None for the derived ones.
    own : float
        Speed of the attempt that counts, over that of the run; a quicker one comes before it.
    """

    pace: float
    stiffening: float | None = None
    damping: float | None = None
    swing: float | None = None
    own: float = 1.0


class WithoutSearch:
    """Makes attempts without the search for new contacts, until one of them shows that it is needed.

    Parameters
    ----------
    run : callable
        Makes one attempt with given settings and pace; with faces near the spheres it ends where one of them may be met.
    """

    def __init__(self, run: Callable[[Case, Settings, float, NearFaces | None], Protocol]) -> None:
        self._run, self._searches = run, False

    def __call__(self, case: Case, settings: Settings, pace: float) -> Protocol:
        """Make one attempt, a second time where it needs the search. pace: its speed over that of the attempt that counts."""
        if case.displacement == "small":
            return self._run(case, settings, pace, None)
        dropped = 0
        if all(box is not None for box in case.boxes) and is_long(case):
            self._searches = True  # among boxes the search costs a fifth of a step, and an attempt in vain would take minutes
        if not self._searches:
            made = self._run(replace(case, displacement="small"), settings, pace, NearFaces(case, settings))
            if not made.met_face:
                return made
            self._searches, dropped = True, made.steps
        # The stable step is that of the listed contacts. A block that meets another one swings faster.
        made = self._run(case, replace(settings, settling_step=min(settings.settling_step, settings.time_step)), pace, None)
        made.dropped_steps = dropped
        made.message += "; YADE looked for new contacts"
        return made


def make(case: Case, derived: Settings, run: Callable[[Case, Settings, float], Protocol]) -> Attempts:
    """Make the attempts of a case. derived: its settings; run: makes one attempt with given settings and pace, its speed over that of
    the attempt that counts.
    """
    large = is_large(case)  # once for all attempts: more damping makes more steps
    if large and derived.swing_damping > 0.0:  # it keeps its dashpots
        case = replace(case, overrides=case.overrides | {"damping_ratio": derived.damping_ratio})
    plan, before, steps, history = Plan(derived.quick_speed or 1.0), None, 0, ""
    while True:
        attempt = run(case, settings_of(case, derived, plan, large), plan.pace / plan.own)
        steps += attempt.steps + attempt.dropped_steps
        outcome = _with_rate(attempt, before)
        again = _next(attempt, outcome, plan, steps)
        if again is None:
            return Attempts(attempt, outcome, steps, attempt.message + history)
        made = attempt.settings
        how = f"at {plan.pace:g} times the speed, {made.stiffening:g} times the stiffness and a damping ratio of {made.damping_ratio:g}"
        how += ", the swing damped" if made.swing_damping > 0.0 else ""
        history += f"{EARLIER_ATTEMPT}{how}: {attempt.message}"
        before = attempt if attempt.status is Status.PLATEAU else None
        plan = again


def settings_of(case: Case, derived: Settings, plan: Plan, large: bool | None = None) -> Settings:
    """Return the settings of an attempt. derived: those of the case, which a plan with its own speed alone keeps."""
    given = {"stiffening": plan.stiffening, "damping_ratio": plan.damping, "swing_damping": plan.swing}
    changed = {name: value for name, value in given.items() if value is not None}
    settings = derive(replace(case, overrides=case.overrides | changed), large) if changed else derived
    pace = plan.pace
    ramp, periods = settings.ramp_time / pace, settings.travel_periods / pace
    return replace(settings, speed=pace * settings.speed, ramp_time=ramp, travel_periods=periods)


def _with_rate(attempt: Protocol, before: Protocol | None) -> Outcome:
    """Return the outcome of an attempt, with the part of the speed from the quicker one before."""
    now = attempt.settings
    alike = ("stiffening", "damping_ratio", "swing_damping")
    if before is None or any(getattr(before.settings, name) != getattr(now, name) for name in alike):
        return attempt.outcome
    pace = before.settings.speed / attempt.settings.speed
    left = abs(before.outcome.reaction - attempt.outcome.reaction) / (math.sqrt(pace) - 1.0)
    return replace(attempt.outcome, rate=math.hypot(left, before.outcome.scatter))


def _next(attempt: Protocol, outcome: Outcome, plan: Plan, steps: int) -> Plan | None:
    """Return the next attempt; None where the last one counts."""
    settings, given, pace = attempt.settings, attempt.case.overrides, plan.pace
    if attempt.status not in (Status.PLATEAU, Status.NO_PLATEAU):
        return None  # a quick attempt that falls would fall at any speed
    is_calm = plan.own == 1.0 and not is_restless(attempt.case, settings, attempt.record, attempt.may_damp, pace)
    if not is_calm and (calmer := _calmer(attempt, plan, steps)):
        return calmer
    creeps = attempt.status is Status.NO_PLATEAU and attempt.plateau.creeps
    stiffer = STIFFER * settings.stiffening
    may_stiffen = stiffer <= MOST_STIFFENING and "normal_stiffness" not in given and settings.wedging == 0.0
    if creeps and may_stiffen and _affordable(attempt, steps, 1.0):
        return replace(plan, stiffening=stiffer)
    sticks = attempt.status is Status.NO_PLATEAU and not creeps
    if sticks and _may_calm(attempt) and _affordable(attempt, steps, 1.0):
        return replace(plan, pace=settings.quick_speed or 1.0, swing=SWING_DAMPING)
    if pace > 1.0:
        return replace(plan, pace=1.0)
    hurried = not math.isnan(outcome.rate) and outcome.rate > UNCERTAIN * abs(outcome.reaction)
    may_slow = pace > SLOWEST and "speed" not in given and _affordable(attempt, steps, 1.0 / SLOWER)
    return replace(plan, pace=SLOWER * pace) if may_slow and not creeps and (sticks or hurried) else None


def _after_slow(attempt: Protocol, plan: Plan, steps: int) -> Plan | None:
    """Return the attempt after a slow one: a slower one, or with critical dashpots at the run's own speed; None where it has a plateau."""
    slower = plan.pace / plan.own
    if slower > 1.0 and _affordable(attempt, steps, slower):
        return replace(plan, pace=plan.own)
    return None if attempt.status is Status.PLATEAU else replace(plan, pace=1.0, own=1.0, damping=CRITICAL)


def _calmer(attempt: Protocol, plan: Plan, steps: int) -> Plan | None:
    """Return the attempt after one that rattles: with its swing damped, with critical dashpots, or slow; None where none may be made.

    It is a quick one again, of two slow ones the quicker: what speed does is known only from two attempts with the same damping.
    """
    if plan.own < 1.0:
        return _after_slow(attempt, plan, steps)
    if plan.damping == CRITICAL:
        slow = replace(plan, pace=SLOWEST * plan.pace, own=SLOWEST, damping=None)
        return slow if _affordable(attempt, steps, SLOW_PAIR) else replace(plan, pace=1.0)
    quick = attempt.settings.quick_speed or 1.0
    if _may_calm(attempt) and _affordable(attempt, steps, 1.0):
        return replace(plan, pace=quick, swing=SWING_DAMPING)
    longer = CRITICAL / attempt.settings.damping_ratio
    return replace(plan, pace=quick, damping=CRITICAL) if _affordable(attempt, steps, longer) else None


def _may_calm(attempt: Protocol) -> bool:
    """Whether an attempt with its swing damped may follow.

    A slender structure sways more slowly than the damper's mean is taken. Its sway is no flutter, and only a longer run helps.
    """
    undamped = attempt.settings.swing_damping == 0.0 and "swing_damping" not in attempt.case.overrides
    return undamped and slowness(attempt.case) == 1.0


def _affordable(attempt: Protocol, steps: int, longer: float) -> bool:
    return steps + longer * attempt.steps <= most_steps(len(attempt.case.host))
