"""The attempts of a run: quick ones that find damping and stiffness, then slower ones until the speed hardly matters.

The first attempt moves `quick_speed` times as fast as the run. Its end decides on the next attempt:

- The blocks rattle: the next attempt damps the swing of the blocks, which does not change the time step. If blocks still rattle, the
  contacts get critical damping, too, and the time step is a third as long. If a block still jumps in a structure of at least a hundred
  blocks, two attempts with the light dashpots follow, at a half and a quarter of the run's speed. If these fail, the next attempt has the
  run's speed and critical damping. (A large plane structure has a damped swing from the start and keeps its dashpots. On a wall of
  1,008 blocks both dampings gave the same reaction.)
- The curve still creeps at the end of the travel: the next attempt has stiffer joints, because only the travel over the elastic sag counts.
- The blocks stick and slip: the next attempt damps the swing.
- Otherwise the attempt at the run's own speed follows. A slower one follows if this attempt still sticks and slips, or if its speed
  changes the reaction much.

The difference between two speeds gives the part of the uncertainty that is due to the speed. The effect of the speed is assumed to grow
with the root of the speed, as the effect of friction's history nearly does. An effect in proportion to the speed, such as drag, is then
overestimated. The noise of the quicker attempt is added, because it may hide a small difference.
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

STIFFER, MOST_STIFFENING = 4.0, 64.0  # factor on the stiffness from one attempt to the next; largest stiffening
SLOWER, SLOWEST = 0.25, 0.25  # factor on the speed from one attempt to the next; least speed over that of the run
# Number of time steps of both slow attempts over that of a quick attempt with critical dashpots: the slow ones last 12 times as long, and
# their time steps are 3 times as long.
SLOW_PAIR = 4.0


@dataclass(frozen=True)
class Attempts:
    """The result of all attempts of a run.

    Attributes
    ----------
    last : Protocol
        The attempt that counts.
    outcome : Outcome
        Reaction of this attempt, with the part of its uncertainty that is due to the speed.
    steps : int
        Time steps of all attempts.
    message : str
        Why the last attempt ended, and the settings and ends of the others.
    """

    last: Protocol
    outcome: Outcome
    steps: int
    message: str


@dataclass(frozen=True)
class Plan:
    """The plan of the next attempt.

    Attributes
    ----------
    pace : float
        Speed of the attempt over that of the run.
    stiffening, damping, swing : float or None
        Stiffening of the joints, damping ratio of the contacts, and damping ratio of the swing; None for the derived value.
    own : float
        Speed of the attempt that counts, over that of the run; a quicker attempt comes before it.
    """

    pace: float
    stiffening: float | None = None
    damping: float | None = None
    swing: float | None = None
    own: float = 1.0


class WithoutSearch:
    """Makes attempts without YADE's search for new contacts, until an attempt shows that the search is needed.

    Parameters
    ----------
    run : callable
        Makes one attempt with given settings and pace. If it also gets the faces near the spheres, the attempt ends where a sphere may
        touch one of them.
    """

    def __init__(self, run: Callable[[Case, Settings, float, NearFaces | None], Protocol]) -> None:
        self._run, self._searches = run, False

    def __call__(self, case: Case, settings: Settings, pace: float) -> Protocol:
        """Make one attempt, and repeat it if it needs the search. pace: its speed over that of the attempt that counts."""
        if case.displacement == "small":
            return self._run(case, settings, pace, None)
        dropped = 0
        if all(box is not None for box in case.boxes) and is_long(case):
            self._searches = True  # between boxes the search costs a fifth of a step; an attempt that must be repeated would cost minutes
        if not self._searches:
            made = self._run(replace(case, displacement="small"), settings, pace, NearFaces(case, settings))
            if not made.met_face:
                return made
            self._searches, dropped = True, made.steps
        # The stable time step is derived from the listed contacts alone. A block that touches another one swings faster.
        made = self._run(case, replace(settings, settling_step=min(settings.settling_step, settings.time_step)), pace, None)
        made.dropped_steps = dropped
        made.message += "; YADE looked for new contacts"
        return made


def make(case: Case, derived: Settings, run: Callable[[Case, Settings, float], Protocol]) -> Attempts:
    """Make the attempts of a case.

    derived: settings of the case. run: makes one attempt with given settings and pace, which is its speed over that of the attempt that
    counts.
    """
    large = is_large(case)  # decided once for all attempts, because more damping needs more time steps
    if large and derived.swing_damping > 0.0:  # a large structure with a damped swing keeps its dashpots
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
    """Return the settings of an attempt. derived: settings of the case; a plan that changes only the speed keeps all others."""
    given = {"stiffening": plan.stiffening, "damping_ratio": plan.damping, "swing_damping": plan.swing}
    changed = {name: value for name, value in given.items() if value is not None}
    settings = derive(replace(case, overrides=case.overrides | changed), large) if changed else derived
    pace = plan.pace
    ramp, periods = settings.ramp_time / pace, settings.travel_periods / pace
    return replace(settings, speed=pace * settings.speed, ramp_time=ramp, travel_periods=periods)


def _with_rate(attempt: Protocol, before: Protocol | None) -> Outcome:
    """Return the outcome of an attempt, with the uncertainty due to the speed from a quicker attempt before it."""
    now = attempt.settings
    alike = ("stiffening", "damping_ratio", "swing_damping")
    if before is None or any(getattr(before.settings, name) != getattr(now, name) for name in alike):
        return attempt.outcome
    pace = before.settings.speed / attempt.settings.speed
    left = abs(before.outcome.reaction - attempt.outcome.reaction) / (math.sqrt(pace) - 1.0)
    return replace(attempt.outcome, rate=math.hypot(left, before.outcome.scatter))


def _next(attempt: Protocol, outcome: Outcome, plan: Plan, steps: int) -> Plan | None:
    """Return the plan of the next attempt; None where the last attempt counts."""
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
    """Return the plan after a slow attempt: the slower attempt of the pair, or critical dashpots at the run's own speed.

    None where the slow attempt counts because it has a plateau.
    """
    slower = plan.pace / plan.own
    if slower > 1.0 and _affordable(attempt, steps, slower):
        return replace(plan, pace=plan.own)
    return None if attempt.status is Status.PLATEAU else replace(plan, pace=1.0, own=1.0, damping=CRITICAL)


def _calmer(attempt: Protocol, plan: Plan, steps: int) -> Plan | None:
    """Return the plan after an attempt that rattles: a damped swing, critical dashpots, or slow attempts; None where none may be made.

    An attempt with another damping is quick again, and of two slow attempts the quicker one comes first: only two attempts with the same
    damping show the effect of the speed.
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
    """Whether an attempt with a damped swing may follow.

    The sway of a slender structure has a longer period than the damper's mean velocity. It is no flutter, and only a longer run helps.
    """
    undamped = attempt.settings.swing_damping == 0.0 and "swing_damping" not in attempt.case.overrides
    return undamped and slowness(attempt.case) == 1.0


def _affordable(attempt: Protocol, steps: int, longer: float) -> bool:
    return steps + longer * attempt.steps <= most_steps(len(attempt.case.host))
