"""A run of YADE is as slow as the accuracy needs. A run that misses it is repeated more slowly; one that cannot reach it says so."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scenes
from runs import made_up_run

from comparison.judge import requested_accuracy
from comparison.run_folder import SECOND_ATTEMPT
from comparison.verdict.check import Verdict
from comparison.workflow import one_scene, stages
from comparison.yade import Results, accuracy_settings
from comparison.yade.run_record import Run
from la_core import exchange
from la_core.analysis import shared_parts
from la_core.analysis.accuracy import scale, with_accuracy
from la_core.analysis.case_file import write_case
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.exchange.dem_settings import TRAVEL_PERIODS

ACCURACIES = (0.05, 0.01, 0.002)
LIMIT = 3600.0  # s of wall time for a run


def made_up(name: str = "wall_third", accuracy: float = 0.01) -> LimitAnalysis:
    return accuracy_settings.initial_settings(analyse(with_accuracy(scenes.shipped(name), accuracy)))


def run_of(analysis: LimitAnalysis, status: str = "plateau", uncertainty: float = 1e-4, periods: float = 0.0, change: float = 0.0) -> Run:
    assert analysis.accuracy is not None
    reaction = (1.0 + change) * analysis.at_inset.sharpest.value if status == "plateau" else math.nan
    settings = {"travel_periods": TRAVEL_PERIODS, "damping_ratio": 0.3, "stop_uncertainty": 1e-3} | analysis.accuracy.settings
    settings |= {"travel_periods": periods} if periods else {}
    result = {"status": status, "reaction": reaction, "uncertainty": uncertainty * reaction, "kinetic_ratio": 1e-5, "seconds": 1.0}
    return made_up_run(result, settings=settings)


def test_friction_that_slides_is_moved_slower_for_a_finer_accuracy() -> None:
    chosen = [made_up("two_blocks", one).accuracy.settings for one in ACCURACIES]  # type: ignore[union-attr]
    periods = [settings["travel_periods"] for settings in chosen]
    assert periods == sorted(periods) and periods[-1] > TRAVEL_PERIODS
    quick = made_up("two_pads").accuracy
    assert quick is not None and quick.settings["travel_periods"] < periods[1]  # without sliding there is no history of friction


def test_friction_that_slides_is_not_moved_faster_than_derived_for_a_coarse_accuracy() -> None:
    loosest = made_up("two_blocks", max(ACCURACIES)).accuracy
    assert loosest is not None and loosest.settings["travel_periods"] == TRAVEL_PERIODS
    assert loosest.settings["stop_uncertainty"] == accuracy_settings.LOOSEST_STOP


def test_a_run_that_misses_is_repeated_slower_and_then_tells_the_change() -> None:
    analysis = made_up()
    assert accuracy_settings.slower_settings(Results(analysis, run_of(analysis)), LIMIT) is None
    slower = accuracy_settings.slower_settings(Results(analysis, run_of(analysis, uncertainty=0.02)), LIMIT)
    assert slower is not None and slower.accuracy is not None and analysis.accuracy is not None
    assert slower.accuracy.settings["travel_periods"] >= 2.0 * analysis.accuracy.settings["travel_periods"]
    second = accuracy_settings.attempt_of(Results(slower, run_of(slower, change=0.004)))
    assert second.parts["friction's history"] == pytest.approx(0.004, rel=0.05)
    less = accuracy_settings.attempt_of(Results(slower, run_of(slower, change=-0.004)))
    assert less.parts["friction's history"] == pytest.approx(0.004, rel=0.05)
    assert accuracy_settings.slower_settings(Results(slower, run_of(slower, change=0.004)), LIMIT) is None


@pytest.mark.slow_after_first
@pytest.mark.parametrize(("uncertainty", "factor"), [(0.011, 2.0), (0.045, 0.0), (0.5, 8.0)])
def test_a_run_that_misses_is_slower_by_as_much_as_it_misses_and_knows_its_plateau_better_by_as_much(
    uncertainty: float, factor: float
) -> None:
    analysis = made_up()
    results = Results(analysis, run_of(analysis, uncertainty=uncertainty))
    slower = accuracy_settings.slower_settings(results, LIMIT)
    assert slower is not None and slower.accuracy is not None and analysis.accuracy is not None
    before, after = analysis.accuracy.settings, slower.accuracy.settings
    expected = factor or accuracy_settings.attempt_of(results).error / 0.01
    assert 2.0 <= expected <= 8.0 and after["travel_periods"] == pytest.approx(expected * before["travel_periods"])
    assert after["stop_uncertainty"] == pytest.approx(before["stop_uncertainty"] / expected)


@pytest.mark.parametrize(("uncertainty", "tighter"), [(0.0009, 1.0), (0.0011, 2.0)])
def test_a_slower_run_stops_as_early_where_its_fit_takes_at_most_half_of_the_accuracy(uncertainty: float, tighter: float) -> None:
    """Otherwise the wall at 0.1 % went on over its whole travel although its fit had been good enough."""
    analysis = made_up("two_blocks", 0.002)
    results = Results(analysis, run_of(analysis, uncertainty=uncertainty, periods=0.5 * TRAVEL_PERIODS))  # too fast for friction's history
    slower = accuracy_settings.slower_settings(results, LIMIT)
    assert slower is not None and slower.accuracy is not None and analysis.accuracy is not None
    before, after = analysis.accuracy.settings, slower.accuracy.settings
    factor = after["travel_periods"] / (0.5 * TRAVEL_PERIODS)
    assert factor >= 2.0
    assert after["stop_uncertainty"] == pytest.approx(before["stop_uncertainty"] / (factor if tighter > 1.0 else 1.0))


def test_a_run_that_ran_out_of_time_is_not_repeated_slower() -> None:
    analysis = made_up("two_pads")
    assert accuracy_settings.slower_settings(Results(analysis, run_of(analysis, status="no plateau")), LIMIT) is not None
    assert accuracy_settings.slower_settings(Results(analysis, run_of(analysis, status="timeout")), LIMIT) is None


@pytest.mark.slow_after_first
@pytest.mark.parametrize(("kept", "limit", "again"), [(False, 1.9, False), (False, 2.1, True), (True, 2.1, False)])
def test_a_larger_time_limit_allows_the_slower_run_that_a_stored_one_needs(
    kept: bool, limit: float, again: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The stored run took a second, and one at half the speed would take two."""
    analysis = made_up()
    stored = Results(analysis, run_of(analysis, uncertainty=0.011))
    monkeypatch.setattr(one_scene, "_stored_summary", lambda folder: {"accuracy": {"yade": {"kept": kept}}})
    monkeypatch.setattr(one_scene, "read_results", lambda folder: stored)
    assert one_scene.would_run_slower(tmp_path, limit) is again


@pytest.mark.parametrize("accuracy", [None, {"asked": 0.01}])
def test_a_stored_scene_without_an_accuracy_of_yade_is_not_run_again(
    accuracy: dict[str, float] | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(one_scene, "_stored_summary", lambda folder: {"accuracy": accuracy})
    assert not one_scene.would_run_slower(tmp_path, 1e9)


def test_without_sliding_a_run_is_as_fast_as_the_accuracy_bears() -> None:
    """A run is eight times as fast as derived at 1 % and coarser, less fast in proportion at finer accuracies, and never slower."""
    for accuracy, pace in ((0.05, 8.0), (0.01, 8.0), (0.0025, 2.0), (0.001, 1.0)):
        chosen = made_up("two_pads", accuracy).accuracy
        assert chosen is not None and chosen.settings["travel_periods"] == pytest.approx(TRAVEL_PERIODS / pace)


def test_the_estimated_error_is_a_share_of_the_prediction_and_has_the_parts_that_both_methods_share() -> None:
    analysis = made_up()
    fitted = accuracy_settings.attempt_of(Results(analysis, run_of(analysis, uncertainty=0.004, change=-0.5))).parts
    assert fitted["fitted plateau"] == pytest.approx(0.002, rel=1e-6)
    shared = shared_parts(analysis)
    assert shared and shared.items() <= fitted.items()


def test_a_run_without_a_plateau_is_repeated_only_where_it_was_fast() -> None:
    analysis = made_up("two_pads")
    slower = accuracy_settings.slower_settings(Results(analysis, run_of(analysis, status="no plateau")), LIMIT)
    assert slower is not None and slower.accuracy is not None
    assert slower.accuracy.settings["travel_periods"] == pytest.approx(TRAVEL_PERIODS)
    assert accuracy_settings.slower_settings(Results(slower, run_of(slower, status="no plateau")), LIMIT) is None
    undefined = accuracy_settings.attempt_of(Results(slower, run_of(slower, status="no plateau")))
    assert math.isnan(undefined.error) and not undefined.is_within(1.0)


def test_attempts_come_to_an_end_and_what_is_not_reached_is_said() -> None:
    analysis = made_up()
    tried = 0
    while analysis is not None:
        last, analysis = analysis, accuracy_settings.slower_settings(Results(analysis, run_of(analysis, uncertainty=0.5)), LIMIT)  # type: ignore[assignment]
        tried += 1
    assert tried == accuracy_settings.MOST_ATTEMPTS
    checks = {check.name: check for check in requested_accuracy.check_accuracy(Results(last, run_of(last, uncertainty=0.5)))}
    check = checks["accuracy of YADE"]
    assert check.verdict is Verdict.INCONCLUSIVE and "fitted plateau 50 %" in check.reason
    assert checks["accuracy of limit analysis"].verdict is Verdict.AGREE


@pytest.mark.parametrize("own", [{"speed": 1e-3}, {"travel_periods": 75.0}])
def test_a_speed_of_the_scene_is_not_touched_and_its_error_is_told(own: dict[str, float]) -> None:
    scene = replace(with_accuracy(scenes.shipped("wall_third"), 0.01), yade=own)
    analysis = accuracy_settings.initial_settings(analyse(scene))
    assert analysis.accuracy is not None and "travel_periods" not in analysis.accuracy.settings
    fast = run_of(analysis, periods=75.0)  # the periods at an eightfold speed, whichever setting requests it
    assert accuracy_settings.attempt_of(Results(analysis, fast)).parts["friction's history"] > 0.02
    assert accuracy_settings.slower_settings(Results(analysis, fast), LIMIT) is None
    (_, check) = requested_accuracy.check_accuracy(Results(analysis, fast))
    assert check.verdict is Verdict.INCONCLUSIVE


@pytest.mark.slow_after_first
@pytest.mark.parametrize(("own", "begins_with"), [({"travel_periods": 2400.0}, 2400.0), ({"speed": 1e-3}, None)])
def test_a_second_attempt_becomes_slower_where_it_misses_the_accuracy(
    own: dict[str, float], begins_with: float | None, tmp_path: Path
) -> None:
    """The scene of the second attempt sets the periods that it begins with. A speed set by the user is not changed."""
    scene = with_accuracy(scenes.shipped("wall_third"), 0.001)
    scene = replace(scene, name=scene.name + SECOND_ATTEMPT, effort="high", yade=own)
    analysis = accuracy_settings.initial_settings(analyse(scene))
    assert analysis.accuracy is not None and analysis.accuracy.settings.get("travel_periods") == begins_with
    run = run_of(analysis, periods=2400.0, uncertainty=0.01)
    slower = accuracy_settings.slower_settings(Results(analysis, run), LIMIT)
    assert (slower is None) is (begins_with is None)
    if slower is not None and slower.accuracy is not None:
        periods = slower.accuracy.settings["travel_periods"]
        assert periods >= 2.0 * 2400.0
        write_case(tmp_path / "case.h5", slower, "inputs")
        stored = exchange.read(tmp_path / "case.h5", exchange.CASE_FIELDS)
        assert json.loads(stored["scene/settings"])["travel_periods"] == periods, "what YADE runs with"


def test_friction_that_the_scene_left_out_still_slides_in_yade() -> None:
    text = scenes.shipped("wall_low_friction").text
    scene = with_accuracy(scenes.load(f'{text}\n[effects]\nfriction = "associated"\n', "bound"), 0.01)
    analysis = accuracy_settings.initial_settings(analyse(scene))
    assert analysis.accuracy is not None and analysis.accuracy.settings["travel_periods"] > 0.5 * TRAVEL_PERIODS
    assert "friction's history" in accuracy_settings.attempt_of(Results(analysis, run_of(analysis))).parts
    (check,) = requested_accuracy.check_accuracy(Results(analysis))
    assert check.verdict is Verdict.INCONCLUSIVE  # a bound is no prediction where joints slide
    assert check.next_step.startswith("Request no accuracy: a part of the error is unknown.")


def test_a_run_at_another_inset_is_another_run() -> None:
    coarse, fine = (made_up("two_pads", accuracy) for accuracy in (0.05, 0.002))
    assert coarse.accuracy is not None
    alike = replace(fine, accuracy=coarse.accuracy)
    assert stages.run_inputs("scene", coarse) != stages.run_inputs("scene", alike)


@pytest.mark.slow
def test_a_run_of_another_model_takes_time_and_tells_no_error() -> None:
    analysis = made_up()
    run = run_of(analysis)
    again = accuracy_settings.initial_settings(accuracy_settings.carry_attempts_over(Results(analysis, run), analyse(analysis.scene)))
    assert again.accuracy is not None and analysis.accuracy is not None
    assert len(again.accuracy.limit_analysis) == 2 * len(analysis.accuracy.limit_analysis)
    assert [one.seconds for one in again.accuracy.yade] == [1.0] and again.accuracy.settings == analysis.accuracy.settings
    fresh = accuracy_settings.attempt_of(Results(again, run_of(again, change=0.1)))
    assert fresh.parts["friction's history"] == pytest.approx(
        accuracy_settings.attempt_of(Results(analysis, run)).parts["friction's history"]
    )


def test_a_run_that_would_outlast_its_limit_is_not_begun() -> None:
    analysis = made_up()
    assert accuracy_settings.slower_settings(Results(analysis, run_of(analysis, uncertainty=0.02)), limit=1.5) is None


@pytest.mark.slow_after_first
@pytest.mark.parametrize("name", ["two_pads", "ferris_tin_loi_1"])
@pytest.mark.parametrize("of_weights", [math.nan, 1e3])
def test_an_answer_without_work_of_the_weights_has_inertia_too(name: str, of_weights: float) -> None:
    """A multiplier does work on the pushed weights. Without it the inertia of a sliding block was stated as 12 % for 0.05 %."""
    analysis = made_up(name)
    run = run_of(analysis)
    record = {
        "stage": np.array([0, 1, 1, 1]), "settlement": np.array([0.0, 0.0, 1e-4, 2e-4]),
        "kinetic_energy": np.array([0.0, 0.0, 1e-6, 1e-6]),
    }  # fmt: skip
    result = replace(run.result, kinetic_ratio=of_weights, plateau_start=1e-4)
    still = replace(run, result=result, record=made_up_run(record=record).record)
    force = scale(analysis) * (1.0 if analysis.scene.live is None else analysis.scene.weight)
    expected = 1e-6 / (force * 1e-4)
    inertia = accuracy_settings.attempt_of(Results(analysis, still)).parts["inertia"]
    assert inertia == pytest.approx(accuracy_settings.INERTIA_OF_SPEED * math.sqrt(expected))
