"""Words of a verdict: one method alone agrees with nobody, what cannot stand says so, and what is open says what to do next."""

import dataclasses
import itertools
import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scenes
from conftest import Silent
from runs import coulomb_run, perfect_run, with_answers, write_run

import la_core
from comparison.cli.exit_codes import CANNOT_STAND, EXIT_OF_VERDICT, GRAVITY, INTERRUPTED, MEANINGS
from comparison.judge.prediction import SLOWER_RUN
from comparison.judge.run_checks import LONGER, check_answer, check_expected, check_run
from comparison.judge.summary import comparison_summary
from comparison.numbers import Units
from comparison.report.scene_view import view_of_scene
from comparison.verdict import VERDICTS, Check, Verdict, conclusion, inside, mark_of, stored_check
from comparison.workflow import harder
from comparison.yade import Results
from comparison.yade.run_record import read_run
from la_core.analysis.accuracy import ATTEMPTS, finer_paths
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.coulomb import PredictionSettings
from la_core.limit.associated import Status
from la_core.limit.problem import Drive

NEWTON = Units(1.0)  # of a report on light structures


@pytest.fixture(scope="module")
def pads() -> LimitAnalysis:
    return analyse(scenes.shipped("two_pads"))


def summary_of(results: Results, yade: dict[str, Any] | None, checks: list[Check]) -> dict[str, Any]:
    return comparison_summary(results, yade, checks, [])


# --- one method alone -------------------------------------------------------------------------------------------------------------


def test_one_method_alone_meets_the_expected_value_and_agrees_with_nobody(pads: LimitAnalysis, tmp_path: Path) -> None:
    summary = summary_of(Results(pads), None, list(check_expected(pads)))
    assert summary["verdict"] == "expected value met" and "YADE was not run" in summary["reason"]
    view = view_of_scene(tmp_path, 1, summary, NEWTON)
    assert (view["symbol"], view["word"]) == ("○", "expected value met (YADE not run)")
    words = [view["word"], view["sentence"], *(check["word"] for check in view["checks"]), *(str(value) for value in summary["checks"])]
    assert not [text for text in words if "agree" in text]
    assert {check["word"] for check in view["checks"]} == {"met"}


def test_without_an_expected_value_nothing_was_compared(pads: LimitAnalysis) -> None:
    found = conclusion([], None)
    assert found.verdict is None and found.next_step == "" and mark_of(None) == "– not compared"
    assert conclusion([Check("accuracy of limit analysis", Verdict.AGREE)], None).verdict is None
    assert pads.scene.expected is not None


def test_with_both_methods_an_expected_value_that_is_met_is_part_of_their_agreement(pads: LimitAnalysis) -> None:
    checks = [*check_expected(pads), *check_run(Results(pads, perfect_run(pads)))]
    assert conclusion(checks, {"status": "plateau"}).verdict is Verdict.AGREE


# --- a structure that cannot stand ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("yade", "words"),
    [(None, "YADE was not run"), ({"status": "collapsed"}, "collapsed in YADE, too"), ({"status": "timeout"}, "ended as timeout")],
)
def test_what_cannot_stand_says_so_with_the_blocks_that_fall(yade: dict[str, Any] | None, words: str) -> None:
    names = [f"block {number}" for number in range(8)]
    unfinished = [Check("YADE's run", Verdict.INCONCLUSIVE, reason="late")] if yade and yade["status"] == "timeout" else []
    found = conclusion(unfinished, yade, names)
    assert found.verdict is Verdict.CANNOT_STAND and found.next_step
    assert '"block 0"' in found.reason and "3 more blocks would fall" in found.reason and words in found.reason
    assert EXIT_OF_VERDICT[found.verdict] == CANNOT_STAND != 0


def test_a_structure_that_stands_in_yade_although_it_cannot_is_a_disagreement() -> None:
    found = conclusion([Check("the structure stands", Verdict.DISAGREE, reason="it stands")], {"status": "plateau"}, ["block"])
    assert found.verdict is Verdict.DISAGREE and found.next_step


# --- what to do next --------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def wall() -> LimitAnalysis:
    return analyse(scenes.shipped("wall_third"))


def open_checks(pads: LimitAnalysis, wall: LimitAnalysis) -> list[list[Check]]:
    """Checks of results that end without agreement, one list each."""
    assert wall.coulomb is not None
    value, moving = wall.coulomb.value, perfect_run(pads)
    moving.poses.forces[:, 0] += pads.assembly.mean_weight
    unsolved = dataclasses.replace(pads.bounds[Drive.YIELDING], status=Status.INACCURATE)
    wrong = [
        Results(pads, perfect_run(pads, status=status, reaction=math.nan)) for status in ("timeout", "failed", "no plateau", "collapsed")
    ]
    wrong += [
        Results(pads, moving),
        Results(pads, perfect_run(pads, reaction=0.5 * pads.bounds[Drive.YIELDING].value)),
        Results(pads, perfect_run(pads, settlement=0.0)),
        Results(pads, perfect_run(pads, uncertainty=math.nan)),
        Results(with_answers(pads, bounds={**pads.bounds, Drive.YIELDING: unsolved}), perfect_run(pads)),
        Results(wall, coulomb_run(wall, reaction=1.1 * value)),
        Results(wall, coulomb_run(wall, reaction=1.02 * value, uncertainty=0.1 * value)),
    ]
    for changes in ({"uncertainty": value}, {"plateaus": np.array([value, 2.0 * value])}, {"status": Status.INACCURATE}):
        other = with_answers(wall, coulomb=dataclasses.replace(wall.coulomb, **changes))  # type: ignore[arg-type]
        wrong.append(Results(other, coulomb_run(wall, reaction=1.2 * value)))
    return [check_run(results) for results in wrong]


def test_everything_that_stays_open_has_a_reason_and_a_next_step(pads: LimitAnalysis, wall: LimitAnalysis) -> None:
    for checks in open_checks(pads, wall):
        found = conclusion(checks, {"status": "plateau"})
        assert found.verdict in (Verdict.INCONCLUSIVE, Verdict.DISAGREE), checks
        assert found.reason and found.next_step and not found.next_step.startswith(found.reason)


def test_the_next_step_reaches_json_and_report(wall: LimitAnalysis, tmp_path: Path) -> None:
    assert wall.coulomb is not None
    run = coulomb_run(wall, reaction=1.02 * wall.coulomb.value, uncertainty=0.1 * wall.coulomb.value)
    summary = summary_of(Results(wall, run), {"status": "plateau"}, check_run(Results(wall, run)))
    assert "--try-harder" in summary["next_step"]
    assert view_of_scene(tmp_path, 1, summary, NEWTON)["next_step"] == summary["next_step"]
    assert summary["curves"] is not None and summary["remarks"] == []


def test_a_remark_of_an_agreement_is_shown(wall: LimitAnalysis, tmp_path: Path) -> None:
    run = coulomb_run(wall, scatter=0.02)
    summary = summary_of(Results(wall, run), {"status": "plateau"}, check_run(Results(wall, run)))
    assert summary["verdict"] == "agree" and summary["reason"] == "" and "Stick-slip" in summary["remarks"][0]
    assert "Stick-slip" in view_of_scene(tmp_path, 1, summary, NEWTON)["sentence"]


# --- ranges, plateaus, words ------------------------------------------------------------------------------------------------------


def test_a_range_check_is_shown_as_a_range_and_its_difference_is_the_distance_beyond(wall: LimitAnalysis, tmp_path: Path) -> None:
    low, high = inside("r", (1.0, 3.0), 2.0, 0.1, "N", "no"), inside("r", (1.0, math.inf), 0.5, 0.1, "N", "no")
    assert (low.verdict, low.difference, low.range) == (Verdict.AGREE, 0.0, (1.0, 3.0))
    assert (high.verdict, high.difference, high.range) == (Verdict.DISAGREE, -0.5, (1.0, None))
    assert all(stored_check(dataclasses.asdict(check)) == check for check in (low, high))
    run = coulomb_run(wall)
    view = view_of_scene(tmp_path, 1, summary_of(Results(wall, run), {"status": "plateau"}, check_run(Results(wall, run))), NEWTON)
    shown = {check["name"]: check for check in view["checks"]}
    ranged = [check for name, check in shown.items() if "range" in name or "interval" in name or "bounds" in name]
    assert len(ranged) >= 3
    for check in ranged:
        assert " to " in check["range"] and check["difference"] == "0"


@pytest.mark.parametrize("status", ["no plateau", "timeout", "collapsed"])
def test_without_a_plateau_no_value_of_one_is_read_from_a_file(pads: LimitAnalysis, status: str, tmp_path: Path) -> None:
    write_run(tmp_path / "run.h5", perfect_run(pads, status=status), "inputs")
    run = read_run(tmp_path / "run.h5", pads.assembly)
    assert np.isnan([run.reaction, run.uncertainty, run.result.slope]).all()
    write_run(tmp_path / "run.h5", perfect_run(pads), "inputs")
    assert math.isfinite(read_run(tmp_path / "run.h5", pads.assembly).reaction)


def test_every_verdict_has_words_an_exit_code_and_every_exit_code_a_meaning() -> None:
    verdicts = [*Verdict, None]
    assert set(VERDICTS) == set(verdicts) == set(EXIT_OF_VERDICT)
    assert len({mark_of(verdict) for verdict in verdicts}) == len({mark_of(verdict)[0] for verdict in verdicts}) == len(verdicts)
    assert set(MEANINGS) == {*GRAVITY, 2, INTERRUPTED}
    page = (Path(__file__).parents[2] / "comparison" / "cli" / "README.md").read_text(encoding="utf-8")
    for code, meaning in MEANINGS.items():
        assert f"| {code} | {meaning} |" in page


# --- varied scenes ----------------------------------------------------------------------------------------------------------------


def test_a_varied_structure_loses_source_and_expected_value_that_spoke_of_another_one() -> None:
    arch = la_core.load("arch_spreading")
    assert arch.source and arch.expected is not None
    other = la_core.variant(arch, {"arch[0].voussoirs": 12})
    assert other.source == "" and other.expected is None
    named = la_core.variant(arch, {"arch[0].voussoirs": 12, "source": "own calculation"})
    assert named.source == "own calculation" and named.expected is None
    for settings in ({"yade.speed": 0.01}, {"accuracy": 0.01}, {"effort": "high"}, {"title": "other words"}):
        same = la_core.variant(arch, settings)
        assert same.source == arch.source and same.expected == arch.expected


# --- try harder -------------------------------------------------------------------------------------------------------------------


def first(verdict: str, seconds: float = 10.0, **yade: Any) -> dict[str, Any]:
    """What is used of a first comparison.json."""
    values = {"reaction": 1.0, "uncertainty": 0.1, "seconds": seconds, "status": "plateau"} | yade
    return {
        "scene": "wall_third", "verdict": verdict, "reason": "why",
        "yade": values, "settings": {"stiffening": 4.0, "normal_stiffness": 2e6},
        "limit_analysis": {"coulomb": {"reaction": 1.2, "uncertainty": 0.2, "seconds": 1.0}},
    }  # fmt: skip


class Told(Silent):
    """A listener that keeps what it was told."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def stage(self, scene: str, stage: str, state: str) -> None:
        self.lines.append(state)


def test_what_a_second_attempt_reads_stands_in_the_file_of_the_first() -> None:
    contract = json.loads((Path(__file__).parents[1] / "helpers" / "contract.json").read_text(encoding="utf-8"))
    known = {*contract["comparison.json"], "limit_analysis.coulomb.uncertainty"}  # which came later
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
    for verdict in (None, "agree", "expected value met", "cannot stand"):
        assert harder.try_harder(first(str(verdict)), scene, tmp_path, Told(), True) is None
    assert not runs
    for verdict in ("inconclusive", "disagree"):
        assert harder.try_harder(first(verdict), scene, tmp_path, Told(), True) == {"verdict": "agree"}
    assert len(runs) == 2
    assert harder.try_harder(first("inconclusive", status="missing"), scene, tmp_path, Told(), True) is None
    assert harder.try_harder(first("inconclusive"), runs[0][0], tmp_path, Told(), True) is None  # a third attempt would be the same


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


def test_it_keeps_the_first_verdict_and_its_time(runs: list[tuple[Any, ...]], tmp_path: Path) -> None:
    scene, told = la_core.load("wall_third"), Told()
    harder.try_harder(first("inconclusive"), scene, tmp_path, told, True, 200.0)
    *_, with_yade, seconds, named = runs[0]
    assert with_yade and 0.0 < seconds <= 200.0
    kept = named["first_verdict"]
    assert (kept["scene"], kept["verdict"], kept["reason"]) == ("wall_third", "inconclusive", "why")
    assert (kept["coulomb"], kept["yade"]) == (1.2, 1.0)
    assert harder.try_harder(first("inconclusive", seconds=1e3), scene, tmp_path, told, True, 200.0) is None
    limit = re.search(r"about (\d+) minutes; --try-harder-limit (\d+) \(s\) allows it", told.lines[-1])
    assert limit is not None and int(limit[2]) == 60 * int(limit[1]) and len(runs) == 1
    assert harder.try_harder(first("inconclusive", seconds=1e3), scene, tmp_path, told, True, float(limit[2])) is not None


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
    other = Check("a check", Verdict.INCONCLUSIVE, reason="Why.", next_step="Look at the scene.")
    assert conclusion([other], None, None, True).next_step == "Look at the scene."


def test_remarks_say_nothing_twice() -> None:
    checks = [Check(name, Verdict.AGREE, reason=f"The {name} differ. It need not be unique.") for name in ("mechanisms", "moving blocks")]
    assert conclusion([*checks, *checks], {"status": "plateau"}).remarks == (
        "The mechanisms differ. It need not be unique.",
        "The moving blocks differ.",
    )


def test_blocks_that_slide_although_a_thrust_could_hold_them_need_a_thrust_or_another_one() -> None:
    for wedged, words in ((True, "Give it another size"), (False, "Give the blocks a thrust")):
        arch = la_core.variant("flat_arch", {"joint.friction": 0.4} | ({} if wedged else {"yade.wedging": None}))
        analysis = analyse(arch)
        if wedged:
            (check,) = check_answer(analysis)
            assert check.verdict is Verdict.INCONCLUSIVE and "slide and fall on the way" in check.reason and words in check.next_step
        run = dataclasses.replace(perfect_run(analysis))
        fallen = dataclasses.replace(run, result=dataclasses.replace(run.result, status="collapsed"))
        assert any(words in check.next_step for check in check_run(Results(analysis, fallen)))
