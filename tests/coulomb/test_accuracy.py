"""Buying an accuracy: the promise is kept on scenes with exact values, and a method says so where it cannot keep it."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scenes
from runs import made_up_run

from comparison.cli.commands import main
from comparison.judge import requested_accuracy
from comparison.verdict.check import Verdict
from comparison.workflow import one_scene, stages
from comparison.yade import Results, accuracy_settings
from comparison.yade.run_record import Run
from la_core.analysis.accuracy import ATTEMPTS, LOOSE, with_accuracy
from la_core.analysis.accuracy_record import AccuracyRecord, Attempt, from_text, to_text
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.exchange.dem_settings import TRAVEL_PERIODS
from la_core.scene.scene import Scene, scene_of_text

ACCURACIES = (0.05, 0.01, 0.002)
PUBLISHED = {
    "vault_spreading": 3e-5,
    "arch_settling": 1e-5,
    "arch_diagonal": 1e-5,
    "arch_spreading": 3e-5,
    "ferris_tin_loi_1": 3e-3,
    "ferris_tin_loi_2": 3e-3,
}
LIMIT = 3600.0  # s of wall time for a run
EXACT = ("two_pads", "trilith", "slab_four_corners", "flat_arch", "two_blocks", "stack_bond_wall")


def expected_value(scene: Scene) -> float:
    assert scene.expected is not None
    value = scene.expected.multiplier if scene.live is not None else scene.expected.reaction_over_weight
    assert value is not None
    return value


def divisor(scene: Scene) -> float:
    return 1.0 if scene.live is not None else scene.weight


@pytest.mark.parametrize("accuracy", ACCURACIES)
@pytest.mark.parametrize("name", [*EXACT, *PUBLISHED])
def test_limit_analysis_keeps_its_promise(name: str, accuracy: float) -> None:
    """PUBLISHED: how well the value is known, as a share of it."""
    scene = with_accuracy(scenes.shipped(name), accuracy)
    analysis = analyse(scene)
    assert analysis.accuracy is not None and analysis.accuracy.limit_analysis[-1].is_within(accuracy)
    assert (analysis.printed.coulomb is None) == (analysis.at_inset.coulomb is None)
    exact = expected_value(scene) * divisor(scene)
    sharp = analysis.sharp if analysis.sharp.coulomb is not None else analysis.at_inset  # see `LimitAnalysis.sharp`
    for answer in (analysis.at_inset.sharpest, sharp.sharpest):
        assert answer.value == pytest.approx(exact, rel=accuracy + PUBLISHED.get(name, 0.0))


@pytest.mark.yade
@pytest.mark.slow
@pytest.mark.parametrize("accuracy", ACCURACIES)
def test_yade_keeps_its_promise(accuracy: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(one_scene, "figures_of", lambda *results: {})  # they would take most of the time
    names = [*EXACT[:-1], *(("stack_bond_wall",) if accuracy > min(ACCURACIES) else ("arch_spreading",))]  # 10 s at the finest
    assert main(["run", *names, "--accuracy", str(accuracy), "-o", str(tmp_path), "-q"]) == 0
    for name in names:
        scene, summary = scenes.shipped(name), json.loads((tmp_path / name / "comparison.json").read_text())
        assert summary["accuracy"]["yade"]["kept"]
        slack = PUBLISHED.get(name, 0.0)
        assert summary["yade"]["reaction"] / scene.weight == pytest.approx(expected_value(scene), rel=accuracy + slack), name


@pytest.mark.yade
@pytest.mark.long
def test_a_coarse_wall_costs_less_than_a_third_of_a_fine_one(tmp_path: Path) -> None:
    seconds = {}
    for accuracy in (0.01, 0.002):
        main(["run", "wall_third", "--accuracy", str(accuracy), "-o", str(tmp_path / str(accuracy)), "-q"])
        found = json.loads((tmp_path / str(accuracy) / "wall_third" / "comparison.json").read_text())["accuracy"]
        assert found["limit_analysis"]["kept"] and found["yade"]["kept"]
        seconds[accuracy] = found["limit_analysis"]["seconds"] + found["yade"]["seconds"]
    assert seconds[0.01] < seconds[0.002] / 3.0


def test_rounded_arrises_are_sharpened_until_they_fit_the_accuracy() -> None:
    coarse, fine = (analyse(with_accuracy(scenes.shipped("two_pads"), accuracy)) for accuracy in (0.05, 0.002))
    assert coarse.assembly.inset == scenes.shipped("two_pads").inset
    assert fine.assembly.inset < 0.2 * coarse.assembly.inset  # the error is in proportion to it, 1 % at 1 mm
    assert fine.accuracy is not None and len(fine.accuracy.limit_analysis) == 2


def test_finer_answers_take_less_viscous_paths_and_their_difference_is_the_error() -> None:
    loose, fine = (analyse(with_accuracy(scenes.shipped("wall_third"), accuracy)) for accuracy in (2.0 * LOOSE, 0.5 * LOOSE))
    for analysis, level in ((loose, 0), (fine, 1)):
        assert analysis.accuracy is not None and analysis.coulomb is not None
        attempt = analysis.accuracy.limit_analysis[-1]
        assert attempt.settings["viscosity"] == pytest.approx(1e-3 * ATTEMPTS[level][0])
        assert attempt.parts["friction's history"] == pytest.approx(analysis.coulomb.uncertainty / abs(analysis.coulomb.value))
        assert attempt.is_within(analysis.accuracy.asked)


def test_a_structure_that_cannot_stand_has_no_error_to_judge() -> None:
    scene = with_accuracy(overhang(), 0.01)
    analysis = analyse(scene)
    assert analysis.accuracy is not None and math.isnan(analysis.accuracy.limit_analysis[-1].error)
    assert not list(requested_accuracy.check_accuracy(Results(analysis)))


def overhang() -> Scene:
    text = scenes.shipped("two_pads").text.split("[expected]")[0].replace("to = [1.0, 0.2, 0.0]", "to = [0.45, 0.2, 0.0]")
    return scene_of_text(text.replace("from = [0.5, 0.0, -0.1]", "from = [0.4, 0.0, -0.1]"), Path("overhang.toml"), "overhang")


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
    assert quick is not None and quick.settings["travel_periods"] < periods[1]  # no history without sliding


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
    assert accuracy_settings.slower_settings(Results(slower, run_of(slower, change=0.004)), LIMIT) is None


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
    fast = run_of(analysis, periods=75.0)  # what an eightfold speed comes to, however it was asked for
    assert accuracy_settings.attempt_of(Results(analysis, fast)).parts["friction's history"] > 0.02
    assert accuracy_settings.slower_settings(Results(analysis, fast), LIMIT) is None
    (_, check) = requested_accuracy.check_accuracy(Results(analysis, fast))
    assert check.verdict is Verdict.INCONCLUSIVE


def test_friction_that_the_scene_left_out_still_slides_in_yade() -> None:
    text = scenes.shipped("wall_low_friction").text
    scene = with_accuracy(scenes.load(f'{text}\n[effects]\nfriction = "associated"\n', "bound"), 0.01)
    analysis = accuracy_settings.initial_settings(analyse(scene))
    assert analysis.accuracy is not None and analysis.accuracy.settings["travel_periods"] > 0.5 * TRAVEL_PERIODS
    assert "friction's history" in accuracy_settings.attempt_of(Results(analysis, run_of(analysis))).parts
    (check,) = requested_accuracy.check_accuracy(Results(analysis))
    assert check.verdict is Verdict.INCONCLUSIVE  # a bound of what slides is no prediction


def test_a_run_at_another_inset_is_another_run() -> None:
    coarse, fine = (made_up("two_pads", accuracy) for accuracy in (0.05, 0.002))
    assert coarse.accuracy is not None
    alike = replace(fine, accuracy=coarse.accuracy)
    assert stages.run_inputs("scene", coarse) != stages.run_inputs("scene", alike)


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


def test_an_answer_without_work_of_the_weights_has_inertia_too() -> None:
    analysis = made_up("two_pads")
    run = run_of(analysis)
    record = {
        "stage": np.array([0, 1, 1, 1]), "settlement": np.array([0.0, 0.0, 1e-4, 2e-4]),
        "kinetic_energy": np.array([0.0, 0.0, 1e-6, 1e-6]),
    }  # fmt: skip
    result = replace(run.result, kinetic_ratio=math.nan, plateau_start=1e-4)
    still = replace(run, result=result, record=made_up_run(record=record).record)
    expected = 1e-6 / (analysis.sharp.sharpest.value * 1e-4)
    inertia = accuracy_settings.attempt_of(Results(analysis, still)).parts["inertia"]
    assert inertia == pytest.approx(accuracy_settings.INERTIA_OF_SPEED * math.sqrt(expected))


def test_finer_paths_that_make_it_worse_are_not_the_answer() -> None:
    """Two paths of this corner lie 1 % apart."""
    analysis = analyse(with_accuracy(scenes.shipped("corner_settling_end"), 0.002))
    assert analysis.accuracy is not None
    *others, answer = analysis.accuracy.limit_analysis
    assert all(not other.error < answer.error for other in others)
    assert analysis.at_inset.sharpest.value == answer.value


def test_solve_says_what_it_does_not_reach(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "bound.toml"
    text = scenes.shipped("wall_low_friction").text.split("[expected]")[0]
    path.write_text(f'accuracy = 0.01\n{text}\n[effects]\nfriction = "associated"\n')
    assert main(["solve", str(path)]) == 4
    assert "not reached" in capsys.readouterr().err


@pytest.mark.parametrize(("text", "asked"), [("title = 'x'\n", 0.02), ("accuracy = 0.05\ntitle = 'x'\n", 0.02), ("", 0.01)])
def test_an_accuracy_is_written_into_the_scene(text: str, asked: float) -> None:
    plain = scenes.shipped("two_pads")
    body = "\n".join(line for line in plain.text.splitlines() if not line.startswith(("title", "accuracy")))
    scene = with_accuracy(scene_of_text(f"{text}{body}\n", plain.path, plain.name), asked)
    assert scene.accuracy == asked and scene_of_text(scene.text, scene.path, "again").accuracy == asked
    assert len(scene.blocks) == len(plain.blocks)


def test_an_accuracy_is_replaced_however_it_is_spelled() -> None:
    """A line of a text that looks like the key stays as it is."""
    plain = scenes.shipped("two_pads")
    body = "\n".join(line for line in plain.text.splitlines() if not line.startswith("source"))
    hidden = 'source = """\naccuracy = 0.03\n"""\n"accuracy" = 0.05\n'
    scene = with_accuracy(scene_of_text(f"{hidden}{body}", plain.path, plain.name), 0.02)
    assert scene.accuracy == 0.02 and scene.source == "accuracy = 0.03\n"


@pytest.mark.parametrize("word", ["0", "50%", "-1%", "abc", "nan", "0.05%", "%"])
def test_an_accuracy_that_cannot_be_bought_is_a_usage_error(word: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["run", "two_pads", f"--accuracy={word}"])
    assert stopped.value.code == 2 and "such as 1%" in capsys.readouterr().err


def test_a_scene_with_an_impossible_accuracy_names_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "eager.toml"
    path.write_text(f"accuracy = 1e-6\n{scenes.shipped('two_pads').text}")
    assert main(["solve", str(path)]) == 2
    assert "accuracy" in capsys.readouterr().err


def test_a_purchase_survives_its_text() -> None:
    attempt = Attempt({"viscosity": 1e-3}, 1.5, {"friction's history": math.nan}, 0.1)
    stored = from_text(to_text(AccuracyRecord(0.01, (attempt,), (), {"travel_periods": 300.0})))
    assert stored is not None and stored.limit_analysis[0].settings == attempt.settings
    assert math.isnan(stored.limit_analysis[0].error) and stored.settings == {"travel_periods": 300.0}
    assert from_text(to_text(None)) is None


def test_what_was_bought_is_printed_reported_and_found_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "asking.toml"
    path.write_text(f"accuracy = 0.01\n{scenes.shipped('two_blocks').text}")
    out = str(tmp_path / "out")
    assert main(["run", str(path), "--no-yade", "-o", out]) == 0
    printed = capsys.readouterr().out
    assert "requested accuracy" in printed and "viscosities of 0.01 and 0.001" in printed
    first = json.loads((tmp_path / "out" / "asking" / "comparison.json").read_text())["accuracy"]
    assert first["limit_analysis"]["kept"] and len(first["limit_analysis"]["attempts"]) == 1
    assert main(["run", str(path), "--no-yade", "-o", out]) == 0
    assert "cached" in capsys.readouterr().err
    assert json.loads((tmp_path / "out" / "asking" / "comparison.json").read_text())["accuracy"] == first
    for page in ("report.md", "report.html"):
        assert "viscosities of 0.01 and 0.001" in (tmp_path / "out" / page).read_text()
