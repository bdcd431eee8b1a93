"""The choice of the attempts of a run in YADE, and their outcome: made-up attempts, without YADE."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import scenes
from yade_stand_in import without_yade

from la_core import exchange
from la_core.analysis import analyse, case_file
from yade_scripts import case, settings
from yade_scripts.plateau import Outcome

attempts, faults, protocol, recorder = (without_yade(name) for name in ("attempts", "faults", "protocol", "recorder"))
STATUS = recorder.Status
STEPS, SCATTER = 1000, 0.25
Tried = tuple[float, float, float, float]  # speed over that of the attempt that counts, stiffening, damping ratio, damping of the swing


@pytest.fixture(scope="module")
def wall(tmp_path_factory: pytest.TempPathFactory) -> case.Case:
    path = tmp_path_factory.mktemp("wall") / "case.h5"
    case_file.write_case(path, analyse(scenes.build(*scenes.wall(4, 3, split=0.8), inset=0.001)), "test")
    return case.from_fields(exchange.read(path, (*exchange.CASE_FIELDS, exchange.SWAY)))


def ended(
    reaction: float = 100.0,
    status: Any = STATUS.PLATEAU,
    creeps: bool = False,
    unrest: float = 0.0,
    jump: float = 0.0,
    steps: int = STEPS,
) -> Any:
    """A made-up attempt at its end. unrest: mean unbalanced force over a block's weight; jump: the largest one."""
    record = SimpleNamespace(
        rows=[SimpleNamespace(reaction=0.0)], jumps=lambda allowed: jump > allowed, rattles=lambda _, allowed: unrest > allowed
    )
    outcome = Outcome(reaction, SCATTER, 0.0, 0.0)
    plateau = SimpleNamespace(creeps=creeps)
    return SimpleNamespace(status=status, plateau=plateau, outcome=outcome, record=record, steps=steps, dropped_steps=7, message="m")


RATTLING, CREEPING = {"unrest": 0.1}, {"status": STATUS.NO_PLATEAU, "creeps": True}
JUMPING = {"status": STATUS.NO_PLATEAU, "jump": 0.6}
STICKING, FALLING = {"status": STATUS.NO_PLATEAU}, {"status": STATUS.COLLAPSED}


def scripted(script: Sequence[dict[str, Any]], chosen: list[tuple[float, settings.Settings]]) -> Callable[..., Any]:
    """Return a maker of attempts that end by a script. Its last ending holds for all further ones. chosen: receives pace and settings."""
    endings: Iterator[dict[str, Any]] = iter(script)
    last: dict[str, Any] = {}

    def run(which: case.Case, given: settings.Settings, pace: float) -> Any:
        nonlocal last
        last = next(endings, last)
        chosen.append((pace, given))
        attempt = ended(**last)
        attempt.case, attempt.settings = which, given
        attempt.may_damp = protocol.Protocol.may_damp.fget(attempt)
        return attempt

    return run


def made(one: case.Case, *script: dict[str, Any]) -> tuple[list[Tried], Any]:
    """Make attempts that end by a script; return their settings and their outcome."""
    chosen: list[tuple[float, settings.Settings]] = []
    outcome = attempts.make(one, settings.derive(one), scripted(script, chosen))
    return [(pace, now.stiffening, now.damping_ratio, now.swing_damping) for pace, now in chosen], outcome


def speeds(one: case.Case, *script: dict[str, Any]) -> list[tuple[float, float, float]]:
    """Make attempts that end by a script; return their speeds over the run's, their damping ratios and the dampings of their swing."""
    chosen: list[tuple[float, settings.Settings]] = []
    derived = settings.derive(one)
    attempts.make(one, derived, scripted(script, chosen))
    return [(now.speed / derived.speed, now.damping_ratio, now.swing_damping) for _, now in chosen]


QUICK, OWN, SLOW = (2.0, 4.0, 0.3, 0.0), (1.0, 4.0, 0.3, 0.0), (0.25, 4.0, 0.3, 0.0)
CALM, CRITICAL = (2.0, 4.0, 0.3, 0.5), (2.0, 4.0, 1.0, 0.5)


@pytest.mark.slow_after_first
@pytest.mark.parametrize(
    ("script", "expected"),
    [
        ([{}], [QUICK, OWN]),
        ([{"reaction": 100.4}, {}], [QUICK, OWN]),  # 0.4 / (2^0.5 - 1) and the noise are 1.0 % of the reaction at most
        ([{"reaction": 100.5}, {}], [QUICK, OWN, SLOW]),
        ([{"reaction": -100.5}, {"reaction": -100.0}], [QUICK, OWN, SLOW]),
        ([{"reaction": -100.3}, {"reaction": -100.0}], [QUICK, OWN]),
        ([FALLING], [QUICK]),
        ([CREEPING, {}], [QUICK, (2.0, 16.0, 0.3, 0.0), (1.0, 16.0, 0.3, 0.0)]),
        ([CREEPING], [QUICK, (2.0, 16.0, 0.3, 0.0), (2.0, 64.0, 0.3, 0.0), (1.0, 64.0, 0.3, 0.0)]),
        ([STICKING, {}], [QUICK, CALM, (1.0, 4.0, 0.3, 0.5)]),
        ([STICKING], [QUICK, CALM, (1.0, 4.0, 0.3, 0.5), (0.25, 4.0, 0.3, 0.5)]),
        ([RATTLING, {}], [QUICK, CALM, (1.0, 4.0, 0.3, 0.5)]),
        ([RATTLING, RATTLING, {}], [QUICK, CALM, CRITICAL, (1.0, 4.0, 1.0, 0.5)]),
        ([RATTLING], [QUICK, CALM, CRITICAL, (1.0, 4.0, 1.0, 0.5)]),  # an attempt with all damping goes on
        ([{}, RATTLING, {}], [QUICK, OWN, CALM, (1.0, 4.0, 0.3, 0.5)]),  # a quick attempt follows again
    ],
)
def test_an_attempt_follows_from_how_the_one_before_ended(wall: case.Case, script: list[dict[str, Any]], expected: list[Tried]) -> None:
    tried, outcome = made(wall, *script)
    assert tried == expected
    assert outcome.steps == len(tried) * (STEPS + 7)


@pytest.mark.parametrize(
    ("given", "script", "expected"),
    [
        ({"speed": 1e-5}, [{"reaction": 110.0}, {}], [QUICK, OWN]),  # no attempt is slower than the scene sets
        ({"normal_stiffness": 1e8}, [CREEPING], [2.0, 1.0]),
        ({"wedging": 1e-6}, [CREEPING], [2.0, 1.0]),  # the thrust of a wedged structure is proportional to its stiffness
        ({"damping_ratio": 0.3}, [RATTLING], [2.0, 1.0]),
        ({"swing_damping": 0.0}, [RATTLING, {}], [QUICK, (2.0, 4.0, 1.0, 0.0), (1.0, 4.0, 1.0, 0.0)]),
        ({"swing_damping": 0.0}, [{}, RATTLING, {}], [QUICK, OWN, (2.0, 4.0, 1.0, 0.0), (1.0, 4.0, 1.0, 0.0)]),  # quick again
        ({"swing_damping": 0.5}, [RATTLING, {}], [CALM, CRITICAL, (1.0, 4.0, 1.0, 0.5)]),  # the program still chooses its dashpots
        ({"quick_speed": 0.0}, [{}], [OWN]),
    ],
)
def test_what_the_scene_sets_itself_no_attempt_changes(
    wall: case.Case, given: dict[str, float], script: list[dict[str, Any]], expected: list[Any]
) -> None:
    tried, _ = made(replace(wall, overrides=given), *script)
    assert tried == expected or [pace for pace, *_ in tried] == expected
    assert len({one[1] for one in tried}) == 1


def test_a_slender_structure_gets_time_in_place_of_a_damper(wall: case.Case) -> None:
    """The mean velocity that the damper keeps would follow its slow sway."""
    slender = replace(wall, sway=100.0 * wall.sag)
    assert made(slender, STICKING)[0] == [QUICK, OWN, SLOW]
    assert made(slender, RATTLING, {})[0] == [QUICK, (2.0, 4.0, 1.0, 0.0), (1.0, 4.0, 1.0, 0.0)]


START = [(2.0, 0.3, 0.0), (2.0, 0.3, 0.5), (2.0, 1.0, 0.5)]  # speed over the run's, damping ratio, damping of the swing
SLOW_ONES, LAST = [(0.5, 0.3, 0.5), (0.25, 0.3, 0.5)], (1.0, 1.0, 0.5)
JUMPS = [JUMPING, JUMPING, JUMPING]


@pytest.mark.slow_after_first
@pytest.mark.parametrize(
    ("blocks", "script", "expected"),
    [
        (13, [*JUMPS, {}], [*START, *SLOW_ONES]),
        (13, [*JUMPS, JUMPING, {}], [*START, *SLOW_ONES]),  # at half of that speed no block jumps
        (13, [*JUMPS, {}, JUMPING, {}], [*START, *SLOW_ONES, LAST]),
        (13, [*JUMPS, STICKING, CREEPING, {}], [*START, *SLOW_ONES, LAST]),
        (13, [JUMPING, JUMPING, {}, {"jump": 0.6}], [*START, LAST]),  # the attempt at the run's own speed is the last one
        (13, [JUMPING, JUMPING, RATTLING, {}], [*START, LAST]),  # rattling is no single jump
        (14, [*JUMPS, {}], [*START, LAST]),  # too few blocks
    ],
)
def test_where_one_of_many_blocks_jumps_in_spite_of_all_damping_slow_attempts_follow(
    wall: case.Case, blocks: int, script: list[dict[str, Any]], expected: list[tuple[float, ...]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """blocks: least number of free blocks that counts as many."""
    monkeypatch.setattr(faults, "MANY", blocks)
    assert len(wall.free) == 13
    assert speeds(wall, *script) == [pytest.approx(one) for one in expected]


@pytest.mark.parametrize(
    ("damping", "pace", "jump", "expected"),
    [
        (1.0, 2.0, 0.6, True),
        (1.0, 2.0, 0.4, False),
        (1.0, 1.0, 0.6, False),  # an attempt at the run's own speed goes on to its plateau
        (0.3, 1.0, 0.6, True),  # more damping may follow
    ],
)
def test_an_attempt_ends_at_a_jump_only_where_a_calmer_one_follows(
    wall: case.Case, damping: float, pace: float, jump: float, expected: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(faults, "MANY", 1)
    chosen = replace(settings.derive(wall), damping_ratio=damping, swing_damping=0.5)
    attempt = SimpleNamespace(case=wall, settings=chosen, record=ended(jump=jump).record, pace=pace)
    attempt.may_damp = protocol.Protocol.may_damp.fget(attempt)
    assert protocol.Protocol._is_restless.fget(attempt) is expected


@pytest.mark.parametrize("given", [{"speed": 1e-5}, {"swing_damping": 0.0}, {"damping_ratio": 1.0}, {"quick_speed": 0.0}])
def test_no_attempt_is_slow_without_the_damper_or_where_the_scene_sets_speed_or_damping(
    wall: case.Case, given: dict[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(faults, "MANY", 1)
    assert min(speeds(replace(wall, overrides=given), {"jump": 0.6}))[0] == pytest.approx(1.0)


@pytest.mark.parametrize(("share", "expected"), [(0.14, SLOW_ONES), (0.15, [LAST])])
def test_slow_attempts_are_made_where_four_times_the_steps_of_the_critical_one_are_affordable(
    wall: case.Case, share: float, expected: list[tuple[float, ...]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Together with the three before, they take seven times the steps of one. share: steps of an attempt over the most time steps."""
    monkeypatch.setattr(faults, "MANY", 1)
    steps = {"steps": int(share * settings.most_steps(len(wall.host)))}
    assert speeds(wall, *(JUMPING | steps for _ in range(3)), steps)[3:] == [pytest.approx(one) for one in expected]


def test_a_slow_attempt_that_took_long_is_the_last_one(wall: case.Case, monkeypatch: pytest.MonkeyPatch) -> None:
    """Twice its steps are not affordable."""
    monkeypatch.setattr(faults, "MANY", 1)
    long = {"steps": int(0.4 * settings.most_steps(len(wall.host)))}
    assert speeds(wall, *JUMPS, long) == [pytest.approx(one) for one in [*START, SLOW_ONES[0]]]
    assert speeds(wall, *JUMPS, JUMPING | long, {}) == [pytest.approx(one) for one in [*START, SLOW_ONES[0], LAST]]


def test_a_slow_attempt_without_a_jump_has_the_part_of_the_speed(wall: case.Case, monkeypatch: pytest.MonkeyPatch) -> None:
    """The part is the difference between a half and a quarter of the speed, over the root of 2 less 1, with the noise of the former."""
    monkeypatch.setattr(faults, "MANY", 1)
    _, outcome = made(wall, *JUMPS, {"reaction": 103.0}, {"reaction": 101.0})
    assert outcome.outcome.reaction == 101.0
    assert outcome.outcome.rate == pytest.approx(math.hypot(2.0 / (math.sqrt(2.0) - 1.0), SCATTER))
    _, outcome = made(wall, *JUMPS, JUMPING, {"reaction": 101.0})
    assert math.isnan(outcome.outcome.rate), "no plateau at a higher speed"


def test_the_part_of_the_speed_is_that_of_a_reaction_that_follows_its_root(wall: case.Case) -> None:
    """R(v) = R + c v^0.5: two attempts give c, and c v^0.5 is the error at the lower speed. The noise of the quicker attempt is added."""

    def reaction(pace: float) -> dict[str, float]:
        return {"reaction": 100.0 - 3.0 * math.sqrt(pace)}

    tried, outcome = made(wall, reaction(2.0), reaction(1.0), reaction(0.25))
    assert [pace for pace, *_ in tried] == [2.0, 1.0, 0.25]
    assert outcome.outcome.rate == pytest.approx(math.hypot(1.5, SCATTER))
    assert outcome.outcome.reaction == 98.5 and outcome.outcome.scatter == SCATTER


@pytest.mark.parametrize("script", [[STICKING, {}], [{}, RATTLING, {}], [RATTLING, {}]])
def test_only_two_plateaus_with_the_same_damping_and_stiffness_say_what_the_speed_does(
    wall: case.Case, script: list[dict[str, Any]], monkeypatch: pytest.MonkeyPatch
) -> None:
    rates = []
    found = attempts._with_rate
    monkeypatch.setattr(attempts, "_with_rate", lambda *given: rates.append(found(*given).rate) or found(*given))
    tried, _ = made(wall, *script)
    alike = [False, *(before[1:] == now[1:] for before, now in pairwise(tried))]
    assert [math.isfinite(rate) for rate in rates] == alike and alike[-1]


def test_no_plateau_before_says_nothing_of_the_speed(wall: case.Case) -> None:
    tried, outcome = made(replace(wall, sway=100.0 * wall.sag), STICKING, {})
    assert tried == [QUICK, OWN] and math.isnan(outcome.outcome.rate)


@pytest.mark.parametrize(
    ("ending", "share", "expected"),
    [
        (STICKING, 0.45, [QUICK, CALM]),
        (STICKING, 0.6, [QUICK]),
        (CREEPING, 0.45, [QUICK, (2.0, 16.0, 0.3, 0.0)]),
        (CREEPING, 0.6, [QUICK]),
        (RATTLING, 0.45, [QUICK, CALM]),
        (RATTLING, 0.6, [QUICK]),
    ],
)
def test_all_attempts_together_are_affordable_but_that_at_the_run_s_own_speed_is_made(
    wall: case.Case, ending: dict[str, Any], share: float, expected: list[Tried]
) -> None:
    """share: steps of an attempt over the most time steps."""
    steps = int(share * settings.most_steps(len(wall.host)))
    tried, _ = made(wall, ending | {"steps": steps})
    assert tried == [*expected, (1.0, *expected[-1][1:])]


@pytest.mark.parametrize(("share", "is_made"), [(0.16, True), (0.17, False)])
def test_an_attempt_at_a_quarter_of_the_speed_is_made_where_four_times_the_steps_are_affordable(
    wall: case.Case, share: float, is_made: bool
) -> None:
    """Together with the two before, it takes six times the steps of one. share: steps of an attempt over the most time steps."""
    steps = {"steps": int(share * settings.most_steps(len(wall.host)))}
    tried, _ = made(wall, {"reaction": 101.0} | steps, steps)
    assert tried == [QUICK, OWN, *([SLOW] if is_made else [])]


def test_a_quicker_attempt_takes_less_time_over_its_ramp_and_its_travel(wall: case.Case) -> None:
    usual = settings.derive(wall)
    quick = attempts.settings_of(wall, usual, attempts.Plan(2.0))
    assert (quick.speed, quick.ramp_time, quick.travel_periods) == pytest.approx(
        (2.0 * usual.speed, 0.5 * usual.ramp_time, 0.5 * usual.travel_periods)
    )
    assert quick.time_step == usual.time_step


def test_what_was_tried_before_is_told(wall: case.Case, tmp_path: Path) -> None:
    _, outcome = made(wall, RATTLING, {})
    assert outcome.message.count("before, at 2 times the speed, 4 times the stiffness and a damping ratio of 0.3") == 2
    assert outcome.message.count("the swing damped") == 1
