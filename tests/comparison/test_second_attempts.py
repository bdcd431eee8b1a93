"""A second attempt with finer settings: its conditions, its settings, and the next step after it."""

import itertools
import json
import re
from pathlib import Path
from typing import Any

import pytest
from conftest import Silent

import la_core
from comparison.cli.conclude import lines_below
from comparison.judge.checks.next_steps import FINER_PATHS, FINEST_PATHS, LONGER, MORE_TIME, SLOWER_RUN
from comparison.judge.summary import conclusion_of
from comparison.run_folder import is_second_attempt
from comparison.verdict import Check, Verdict, conclusion
from comparison.workflow import harder
from la_core.analysis.accuracy import ATTEMPTS, finer_paths
from la_core.analysis.stage import analyse
from la_core.coulomb import PredictionSettings
from la_core.exchange import EARLIER_ATTEMPT


def first(verdict: str, seconds: float = 10.0, **yade: Any) -> dict[str, Any]:
    """Return the entries of a first comparison.json that a second attempt reads."""
    values = {"reaction": 1.0, "uncertainty": 0.1, "seconds": seconds, "status": "plateau"} | yade
    return {
        "scene": "wall_third", "verdict": verdict, "reason": "why",
        "yade": values, "settings": {"stiffening": 4.0, "normal_stiffness": 2e6},
        "limit_analysis": {"coulomb": {"reaction": 1.2, "uncertainty": 0.2, "seconds": 1.0}},
    }  # fmt: skip


class Told(Silent):
    """A listener that keeps the states of all stages."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def stage(self, scene: str, stage: str, state: str) -> None:
        self.lines.append(state)


def test_what_a_second_attempt_reads_stands_in_the_file_of_the_first() -> None:
    contract = json.loads((Path(__file__).parents[1] / "helpers" / "contract.json").read_text(encoding="utf-8"))
    known = {*contract["comparison.json"], "limit_analysis.coulomb.uncertainty"}  # which a later version added
    content = first("inconclusive")
    assert set(content) <= known
    assert {f"yade.{name}" for name in content["yade"]} <= known
    assert {f"limit_analysis.coulomb.{name}" for name in content["limit_analysis"]["coulomb"]} <= known


@pytest.fixture
def runs(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Any, ...]]:
    """Calls of `run_scene` by a second attempt."""
    calls: list[tuple[Any, ...]] = []
    monkeypatch.setattr(harder, "run_scene", lambda *given, **named: calls.append((*given, named)) or {"verdict": "agree"})
    return calls


def test_a_second_attempt_is_made_only_where_something_is_open(runs: list[tuple[Any, ...]], tmp_path: Path) -> None:
    scene = la_core.load("wall_third")
    for verdict in (None, "agree", "expected", "cannot stand"):
        assert harder.try_harder(first(str(verdict)), scene, tmp_path, Told(), True) is None
    assert not runs
    for verdict in ("inconclusive", "disagree"):
        assert harder.try_harder(first(verdict), scene, tmp_path, Told(), True) == {"verdict": "agree"}
    assert len(runs) == 2
    assert harder.try_harder(first("inconclusive", status="missing"), scene, tmp_path, Told(), True) is None
    assert harder.try_harder(first("inconclusive"), runs[0][0], tmp_path, Told(), True) is None  # a third attempt would be the same


def test_a_scene_that_sets_a_high_effort_itself_has_a_second_attempt(runs: list[tuple[Any, ...]], tmp_path: Path) -> None:
    """Such a scene once had no second attempt, and no message said why."""
    scene, told = la_core.variant("wall_third", {"effort": "high"}, "wall"), Told()
    assert harder.try_harder(first("inconclusive"), scene, tmp_path, told, True, 101.5) is not None  # its paths are as fine as before
    assert runs[0][0].name == "wall_harder" and runs[0][4] == 100.5
    assert is_second_attempt(runs[0][0]) and not is_second_attempt(scene)
    assert not is_second_attempt(la_core.variant(scene, {"effort": "normal"}, "wall_harder"))


@pytest.mark.parametrize(
    ("name", "status", "with_yade", "words"),
    [
        ("wall_harder", "plateau", True, "this is a second attempt already, because its name ends in _harder"),
        ("wall", "plateau", False, 'the scene sets effort = "high", so limit analysis has followed finer paths already'),
        ("wall", "missing", True, "YADE is missing"),
    ],
)
def test_why_no_second_attempt_is_made_is_told(
    name: str, status: str, with_yade: bool, words: str, runs: list[tuple[Any, ...]], tmp_path: Path
) -> None:
    told, scene = Told(), la_core.variant("wall_third", {"effort": "high"}, name)
    assert harder.try_harder(first("inconclusive", status=status), scene, tmp_path, told, with_yade) is None and not runs
    assert len(told.lines) == 1 and told.lines[0].startswith(f"not tried harder: {words}")
    assert harder.try_harder(first("agree", status=status), scene, tmp_path, told, with_yade) is None
    assert len(told.lines) == 1, "nothing is open"


@pytest.mark.parametrize(("name", "is_tried"), [("pads", False), ("pads_harder", True)])
def test_a_high_effort_of_the_scene_is_not_told_as_a_second_attempt(name: str, is_tried: bool) -> None:
    analysis = analyse(la_core.variant("two_pads", {"effort": "high"}, name))
    check, paths = (Check("a check", Verdict.INCONCLUSIVE, reason="Why.", next_step=step) for step in (LONGER, FINER_PATHS))
    found = conclusion_of(analysis, [check], {"status": "no plateau"}).next_step
    assert ("second attempt already" in found) is is_tried and ("--try-harder" in found) is not is_tried
    found = conclusion_of(analysis, [paths], {"status": "plateau"}).next_step
    assert found != FINER_PATHS and (found == FINEST_PATHS) is not is_tried


def test_its_settings_are_finer_for_both_methods_and_depend_on_no_value(runs: list[tuple[Any, ...]], tmp_path: Path) -> None:
    scene = la_core.load("wall_third")
    for verdict, reaction in itertools.product(("inconclusive", "disagree"), (1.0, 7.0)):
        harder.try_harder(first(verdict, reaction=reaction), scene, tmp_path, Told(), True)
    texts = {run[0].text for run in runs}
    assert len(texts) == 1
    other = runs[0][0]
    assert other.name == "wall_third_harder" and runs[0][1] == tmp_path / other.name
    assert other.effort == "high" and other.expected == scene.expected and other.source == scene.source
    assert other.yade["stiffening"] == 16.0 and "normal_stiffness" not in other.yade
    assert other.yade["damping_ratio"] == 1.0 and other.yade["travel_periods"] == 2400.0
    hurried = la_core.variant(scene, {"yade.speed": 0.02, "yade.damping_ratio": 1.5})
    assert harder.finer_settings(hurried, {})["yade.speed"] == 0.01
    assert harder.finer_settings(hurried, {})["yade.damping_ratio"] == 1.5
    given = la_core.variant(scene, {"yade.normal_stiffness": 2e6})
    finer = harder.finer_settings(given, {"stiffening": 1.0, "normal_stiffness": 2e6})
    assert finer["yade.normal_stiffness"] == 8e6 and "yade.stiffening" not in finer


@pytest.mark.parametrize(
    ("changes", "came_to", "periods"),
    [
        ({}, 7920.0, 2400.0),  # without a requested accuracy each run finds its speed in its own attempts
        ({"accuracy": 0.001}, 7920.0, 15840.0),
        ({"accuracy": 0.01}, 150.0, 2400.0),
        ({"accuracy": 0.001, "yade.travel_periods": 75.0}, 75.0, 150.0),
        ({"accuracy": 0.001}, None, 2400.0),
    ],
)
def test_it_is_slower_than_what_an_accuracy_has_made_of_the_first_run(
    changes: dict[str, Any], came_to: float | None, periods: float
) -> None:
    """The second attempt was once faster than the first run, with a larger error of its own."""
    scene = la_core.variant("wall_third", changes)
    run = {"stiffening": 4.0} | ({} if came_to is None else {"travel_periods": came_to})
    assert harder.finer_settings(scene, run)["yade.travel_periods"] == periods


def test_it_keeps_the_first_verdict_and_its_time(runs: list[tuple[Any, ...]], tmp_path: Path) -> None:
    scene, told = la_core.load("wall_third"), Told()
    harder.try_harder(first("inconclusive"), scene, tmp_path, told, True, 200.0)
    *_, with_yade, seconds, named = runs[0]
    assert with_yade and seconds == 200.0 - harder.DEARER_PATHS * 1.0  # the time that the prediction leaves
    kept = named["first_verdict"]
    assert (kept["scene"], kept["verdict"], kept["reason"]) == ("wall_third", "inconclusive", "why")
    assert (kept["coulomb"], kept["yade"]) == (1.2, 1.0)
    assert harder.try_harder(first("inconclusive", seconds=1e3), scene, tmp_path, told, True, 200.0) is None
    limit = re.search(r"about (\d+) minutes; --try-harder-limit (\d+) \(s\) allows it", told.lines[-1])
    assert limit is not None and int(limit[2]) == 60 * int(limit[1]) and len(runs) == 1
    assert harder.try_harder(first("inconclusive", seconds=1e3), scene, tmp_path, told, True, float(limit[2])) is not None


@pytest.mark.parametrize(
    ("of_yade", "of_prediction", "with_yade", "is_made"),
    [(19.0, 0.9, True, True), (21.0, 0.9, True, False), (19.0, 1.6, True, False), (1e3, 24.0, False, True), (0.0, 26.0, False, False)],
)
def test_its_time_is_that_of_both_methods_and_of_yade_only_where_it_runs(
    of_yade: float, of_prediction: float, with_yade: bool, is_made: bool, runs: list[tuple[Any, ...]], tmp_path: Path
) -> None:
    """The estimate, ten times the seconds of YADE's first attempt plus eight times those of the prediction, is held against 200 s."""
    content = first("inconclusive", seconds=of_yade)
    content["limit_analysis"]["coulomb"]["seconds"] = of_prediction
    harder.try_harder(content, la_core.load("wall_third"), tmp_path, Told(), with_yade, 200.0)
    assert bool(runs) is is_made


def test_what_yade_tried_in_vain_does_not_count_for_its_time(runs: list[tuple[Any, ...]], tmp_path: Path) -> None:
    content, scene = first("inconclusive", seconds=80.0), la_core.load("wall_third")
    assert harder.try_harder(content, scene, tmp_path, Told(), True, 300.0) is None
    content["yade"]["message"] = f"steady{EARLIER_ATTEMPT}faster: blocks rattle{EARLIER_ATTEMPT}damped: blocks rattle"
    assert harder.try_harder(content, scene, tmp_path, Told(), True, 300.0) is not None


def test_a_time_limit_of_the_first_run_is_not_that_of_the_second_one(runs: list[tuple[Any, ...]], tmp_path: Path) -> None:
    """With the same limit a run would be cut off again. The time of a cut-off run says too little about the time of the next run."""
    scene, told = la_core.variant("wall_third", {"yade.time_limit": 20.0}), Told()
    harder.try_harder(first("inconclusive", seconds=20.0, status="timeout"), scene, tmp_path, told, True, 300.0)
    assert runs[0][4] == 292.0 and "YADE for at most 292 s (--try-harder-limit); its time limit cut the first run off" in told.lines[-1]
    assert harder.try_harder(first("inconclusive", seconds=30.0, status="timeout"), scene, tmp_path, told, True, 300.0) is None
    assert "about 6 minutes or more, because its time limit cut YADE's first run off; --try-harder-limit 360" in told.lines[-1]
    harder.try_harder(first("inconclusive", seconds=20.0), scene, tmp_path, told, True, 300.0)
    assert told.lines[-1].endswith("YADE for at most 292 s (--try-harder-limit)")
    harder.try_harder(first("unexpected"), scene, tmp_path, told, False, 300.0)
    assert told.lines[-1] == "unexpected; both methods run again with finer settings"


def test_stiffnesses_of_the_scene_become_stiffer_each() -> None:
    given = la_core.variant(la_core.load("wall_third"), {"yade.normal_stiffness": 2e6, "yade.shear_stiffness": 1e6})
    finer = harder.finer_settings(given, {"stiffening": 1.0, "normal_stiffness": 2e6, "shear_stiffness": 1e6})
    assert (finer["yade.normal_stiffness"], finer["yade.shear_stiffness"]) == (8e6, 4e6) and "yade.stiffening" not in finer


def test_it_keeps_the_multiplier_of_a_live_load_too(runs: list[tuple[Any, ...]], tmp_path: Path) -> None:
    content = first("inconclusive")
    content["limit_analysis"]["coulomb"] = {"multiplier": 0.4, "shared_inset": {"multiplier": 0.3, "uncertainty": 0.01}, "seconds": 1.0}
    harder.try_harder(content, la_core.load("ferris_tin_loi_1"), tmp_path, Told(), True)
    kept = runs[0][-1]["first_verdict"]
    assert (kept["coulomb"], kept["coulomb_uncertainty"]) == (0.3, 0.01)


def test_a_high_effort_is_finer_paths() -> None:
    default, high = PredictionSettings(), finer_paths()
    assert high.viscosities[-1] < default.viscosities[-1] and high.finer > default.finer and high.effort > default.effort
    assert len(ATTEMPTS) > 2
    scene = la_core.load("two_blocks")
    ordinary, fine = analyse(scene).coulomb, analyse(la_core.variant(scene, {"effort": "high"})).coulomb
    assert ordinary is not None and fine is not None
    assert fine.viscosities[-1] < ordinary.viscosities[-1] and fine.steps > ordinary.steps
    assert abs(fine.value - ordinary.value) <= ordinary.uncertainty + fine.uncertainty


def test_after_a_second_attempt_no_other_one_of_the_same_settings_is_advised() -> None:
    open_checks = [Check("a check", verdict, reason="Why.") for verdict in (Verdict.DISAGREE, Verdict.INCONCLUSIVE)]
    open_checks += [Check("a check", Verdict.INCONCLUSIVE, reason="Why.", next_step=step) for step in (LONGER, SLOWER_RUN)]
    for check in open_checks:
        first, second = (conclusion([check], {"status": "plateau"}, None, is_finest).next_step for is_finest in (False, True))
        assert "--try-harder" in first and "--try-harder" not in second
        assert second.endswith("model a smaller part.")
    late = Check("YADE's run", Verdict.INCONCLUSIVE, reason="Why.", next_step=MORE_TIME)
    assert conclusion([late], None).next_step == MORE_TIME
    assert conclusion([late], None, None, True).next_step == "Allow more seconds with --try-harder-limit, or model larger blocks."
    other = Check("a check", Verdict.INCONCLUSIVE, reason="Why.", next_step="Look at the scene.")
    assert conclusion([other], None, None, True).next_step == "Look at the scene."


def test_what_comes_next_is_not_told_again_where_the_second_attempt_has_done_it() -> None:
    comparison = {"verdict": "inconclusive", "reason": "The plateau is uncertain.", "next_step": "`crosscheck run --try-harder` does this."}
    assert list(lines_below(comparison))[-1] == "next: `crosscheck run --try-harder` does this."
    assert list(lines_below(comparison, is_tried_again=True)) == ["The plateau is uncertain."]
