"""A run that contradicts the first answer of limit analysis changes no byte of it. A restored effect keeps the first answer, too.

The runs of YADE are made up: they contradict limit analysis wildly, slide where it excludes sliding, or move blocks too far.
"""

import dataclasses
import io
import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import h5py
import numpy as np
import pytest
import scenes
from conftest import Silent
from faulty_runs import lasting
from runs import coulomb_run, perfect_run, with_answers, write_run

import la_core
from comparison.cli.commands import main
from comparison.judge.effects_table import EFFECTS
from comparison.judge.first_prediction import WHY, WITHOUT, answer_of, first_prediction_summary
from comparison.numbers import Units
from comparison.workflow import restored_effects, stages
from comparison.workflow.one_scene import report_again, run_scene
from comparison.yade import Results, accuracy_settings
from comparison.yade.run_record import Run
from la_core import exchange
from la_core.analysis.accuracy import with_accuracy
from la_core.analysis.case_file import read_case, read_first_prediction, write_case
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.scene.scene import Scene, load_scene

pytestmark = pytest.mark.usefixtures("plain_figures")
WILD = 3.0  # times the prediction, still between the bounds
FAR = 0.1  # m: farther than any gap of these scenes
Make = Callable[[LimitAnalysis], Run]


@pytest.fixture
def made_up_yade(monkeypatch: pytest.MonkeyPatch) -> Callable[[Make], list[bytes]]:
    """Replace YADE by a function that makes up runs. The list receives the content of case.h5 at the start of each run."""

    def replace_yade(make: Make) -> list[bytes]:
        found_at_start: list[bytes] = []

        def run_yade(yade: Any, folder: Path, inputs: str, time_limit: float, progress: Any, started: Any) -> None:
            assert started is stages._load_drawing
            found_at_start.append((folder / "case.h5").read_bytes())
            scene = load_scene(folder / "scene.toml", name=folder.name)
            write_run(folder / "run.h5", make(read_case(folder / "case.h5", scene)), inputs)

        monkeypatch.setattr(stages, "locate_yade", lambda: SimpleNamespace(python="made up", modules="made up"))
        monkeypatch.setattr(stages, "run_yade", run_yade)
        return found_at_start

    return replace_yade


class Listening(Silent):
    """A listener that remembers the stages."""

    def __init__(self) -> None:
        self.heard: list[str] = []

    def stage(self, scene: str, stage: str, state: str) -> None:
        self.heard.append(f"{stage}: {state}")


def answers_in(content: bytes) -> dict[str, bytes]:
    """Return all bytes of limit analysis' answers in a case.h5, by path."""
    found: dict[str, bytes] = {}
    with h5py.File(io.BytesIO(content)) as file:
        file["limit_analysis"].visititems(
            lambda name, node: found.update({name: node[()].tobytes()} if isinstance(node, h5py.Dataset) else {})
        )
    return found


def wild(analysis: LimitAnalysis) -> Run:
    assert analysis.coulomb is not None
    return coulomb_run(analysis, reaction=WILD * analysis.coulomb.value)


# --- a contradiction changes nothing ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["wall_third", "two_blocks", "arch_spreading"])
def test_a_run_that_contradicts_the_prediction_changes_no_byte_of_it(
    name: str, tmp_path: Path, made_up_yade: Callable[[Make], list[bytes]]
) -> None:
    """This holds for structures with and without sliding joints."""
    at_start = made_up_yade(wild)
    summary = run_scene(scenes.shipped(name), tmp_path / name, Silent(), with_yade=True)
    assert summary["verdict"] == "disagree"
    assert at_start == [(tmp_path / name / "case.h5").read_bytes()]
    assert summary["first_prediction"] is None
    assert summary["yade"]["reaction"] == pytest.approx(WILD * summary["limit_analysis"]["coulomb"]["reaction"], rel=1e-9)


def test_with_and_without_yade_limit_analysis_says_the_same(tmp_path: Path, made_up_yade: Callable[[Make], list[bytes]]) -> None:
    made_up_yade(wild)
    scene = scenes.shipped("two_blocks")
    alone = run_scene(scene, tmp_path / "alone", Silent(), with_yade=False)
    both = run_scene(scene, tmp_path / "both", Silent(), with_yade=True)
    assert lasting(both["limit_analysis"]) == lasting(alone["limit_analysis"])


# --- settings of YADE for a requested accuracy ---------------------------------------------------------------------------------------


def test_slower_runs_for_an_accuracy_change_no_byte_of_the_prediction(tmp_path: Path, made_up_yade: Callable[[Make], list[bytes]]) -> None:
    """Settings of YADE are chosen and stored before each of its runs. The answers in the same file do not change."""

    def uncertain(analysis: LimitAnalysis) -> Run:
        assert analysis.coulomb is not None and analysis.accuracy is not None
        run = coulomb_run(analysis, reaction=WILD * analysis.coulomb.value, uncertainty=0.5 * analysis.coulomb.value)
        settings = {"travel_periods": 1.0, "damping_ratio": 0.3, "stop_uncertainty": 1e-3} | analysis.accuracy.settings
        return dataclasses.replace(run, settings=settings)

    at_start = made_up_yade(uncertain)
    scene = with_accuracy(scenes.shipped("two_blocks"), 0.01)
    run_scene(scene, tmp_path / scene.name, Silent(), with_yade=True)
    assert len(at_start) == accuracy_settings.MOST_ATTEMPTS and len(set(at_start)) == len(at_start)  # the settings differ
    answers = [answers_in(content) for content in (*at_start, (tmp_path / scene.name / "case.h5").read_bytes())]
    assert answers[0] and all(one == answers[0] for one in answers)
    fresh = analyse(scene)
    assert fresh.coulomb is not None and answers[0]["coulomb/value"] == np.float64(fresh.coulomb.value).tobytes()


def test_the_choice_of_settings_hands_the_answers_on_as_they_are() -> None:
    analysis = accuracy_settings.initial_settings(analyse(with_accuracy(scenes.shipped("two_blocks"), 0.01)))
    assert analysis.accuracy is not None and analysis.coulomb is not None
    run = coulomb_run(analysis, reaction=WILD * analysis.coulomb.value, uncertainty=0.5 * analysis.coulomb.value)
    settings = {"damping_ratio": 0.3, "stop_uncertainty": 1e-3} | analysis.accuracy.settings
    slower = accuracy_settings.slower_settings(Results(analysis, dataclasses.replace(run, settings=settings)), 3600.0)
    assert slower is not None and slower.accuracy != analysis.accuracy
    for part in ("scene", "whole", "at_inset", "sharp", "stiffness", "path"):
        assert getattr(slower, part) is getattr(analysis, part)


# --- an effect that was left out is restored ------------------------------------------------------------------------------------------


def sliding(analysis: LimitAnalysis, far: float = 0.0) -> Run:
    """Return a run of "two_pads": the block slides along the fixed pad if the model excludes sliding, and moves by a further `far`, m."""
    run = perfect_run(analysis) if analysis.assembly.effects.friction == "none-slides" else coulomb_run(analysis)
    block = analysis.assembly.blocks.names.index("block")
    if analysis.assembly.effects.friction == "none-slides":
        run.poses.displacement[:, block] = run.poses.settlement[:, None] * [1.0, 0.0, 0.0]
        run.poses.rotation[:, block] = 0.0
    run.poses.displacement[:, block, 0] += far
    return run


def two_pads() -> Scene:
    return scenes.shipped("two_pads")


def test_the_first_answer_is_kept_where_friction_was_left_out(tmp_path: Path, made_up_yade: Callable[[Make], list[bytes]]) -> None:
    at_start = made_up_yade(sliding)
    listener = Listening()
    summary = run_scene(two_pads(), tmp_path / "two_pads", listener, with_yade=True)
    assert any("repeated with effects that were left out (friction: joints slide" in one for one in listener.heard)
    assert len(at_start) == 2 and summary["effects"]["friction"] == "coulomb"
    first, before = summary["first_prediction"], analyse(two_pads())
    assert first["restored"] == ["friction"] and {"friction", "elasticity"} <= set(first["left_out"])
    assert "friction" not in {row["effect"] for row in summary["effects"]["table"] if not row["on"]}
    coulomb, associated = before.coulomb, first["associated"]
    assert coulomb is not None and first["coulomb"]["status"] == coulomb.status.value == "solved"
    assert first["coulomb"]["reaction"] == coulomb.value and first["coulomb"]["reaction_interval"] == list(coulomb.interval)
    assert associated["reaction"] == before.bounds[before.main].value
    stored = np.frombuffer(answers_in(at_start[0])["coulomb/value"])
    assert first["coulomb"]["reaction"] == stored.item()  # the value in the file at the start of YADE
    start = "Before YADE ran, limit analysis without sliding said 363.30 N; joints slide in YADE, so friction was modelled: "
    assert first["sentence"].startswith(start) and first["sentence"].endswith(" N.")


def test_a_note_says_of_restored_friction_that_rotations_are_finite(tmp_path: Path, made_up_yade: Callable[[Make], list[bytes]]) -> None:
    """Without sliding, rotations release no forces, so the rotations of the first answer are small."""
    runs = made_up_yade(sliding)
    summary = run_scene(la_core.variant(two_pads(), {"effects.rotation": "finite"}), tmp_path / "pads", Silent(), with_yade=True)
    assert len(runs) == 2 and summary["first_prediction"]["restored"] == ["friction"]
    assert summary["effects"]["rotation"] == "finite"
    assert any("Rotations are finite" in note for note in summary["notes"])


def test_the_first_answer_survives_a_second_call_a_report_and_lost_files(
    tmp_path: Path, made_up_yade: Callable[[Make], list[bytes]]
) -> None:
    at_start = made_up_yade(sliding)
    folder = tmp_path / "two_pads"
    summary = run_scene(two_pads(), folder, Silent(), with_yade=True)
    listener = Listening()
    assert run_scene(two_pads(), folder, listener, with_yade=True) == summary
    assert listener.heard == ["limit analysis: cached", "YADE: cached", "comparison: cached"] and len(at_start) == 2
    (folder / "comparison.json").unlink()
    assert report_again(folder, Silent())["first_prediction"] == summary["first_prediction"]
    (folder / "comparison.json").write_text("damaged", encoding="utf-8")
    (folder / "run.h5").unlink()
    again = run_scene(two_pads(), folder, Silent(), with_yade=True)
    assert again["first_prediction"] == summary["first_prediction"] and len(at_start) == 3


@pytest.mark.slow_after_first
@pytest.mark.parametrize("text", ["{}", "no JSON", '{"left_out": 1, "associated": {}, "coulomb": null}', "[]"])
def test_a_first_answer_that_cannot_be_read_is_made_again(
    text: str, tmp_path: Path, made_up_yade: Callable[[Make], list[bytes]], capsys: pytest.CaptureFixture[str]
) -> None:
    made_up_yade(sliding)
    summary = run_scene(two_pads(), tmp_path / "two_pads", Silent(), with_yade=True)
    path = tmp_path / "two_pads" / "case.h5"
    write_case(path, read_case(path, two_pads()), exchange.inputs_digest(path), text)
    assert main(["report", str(tmp_path), "-q"]) == 3
    assert "run the scene again" in capsys.readouterr().err
    listener = Listening()
    again = run_scene(two_pads(), tmp_path / "two_pads", listener, with_yade=True)
    assert any("limit analysis: repeated, because the stored result cannot be read" in one for one in listener.heard)
    assert lasting(again["first_prediction"]) == lasting(summary["first_prediction"])


def test_another_scene_in_the_folder_has_no_first_answer(tmp_path: Path, made_up_yade: Callable[[Make], list[bytes]]) -> None:
    made_up_yade(sliding)
    folder = tmp_path / "two_pads"
    assert run_scene(two_pads(), folder, Silent(), with_yade=True)["first_prediction"] is not None
    other = scenes.load(two_pads().text.replace("0.5]", "0.4]"), "two_pads")
    made_up_yade(perfect_run)
    assert run_scene(other, folder, Silent(), with_yade=True)["first_prediction"] is None
    assert read_first_prediction(folder / "case.h5") == ""


def test_of_two_restorations_the_very_first_answer_is_kept(tmp_path: Path, made_up_yade: Callable[[Make], list[bytes]]) -> None:
    """The first run slides. The second run, with friction, moves the block too far for its list of contacts."""
    made_up_yade(lambda analysis: sliding(analysis, 0.0 if analysis.assembly.effects.friction == "none-slides" else FAR))
    listener = Listening()
    summary = run_scene(two_pads(), tmp_path / "two_pads", listener, with_yade=True)
    told = [one.partition("left out ")[2].split(":")[0] for one in listener.heard if "repeated with effects" in one]
    assert told == ["(friction", "(displacement"]  # each time only the new effect
    first = summary["first_prediction"]
    assert first["restored"] == ["friction", "displacement"] and "friction" in first["left_out"]
    assert first["coulomb"]["iterations"] == analyse(two_pads()).coulomb.iterations  # type: ignore[union-attr]
    assert "without sliding and new contacts said" in first["sentence"]


def test_only_effects_that_were_left_out_are_restored() -> None:
    before = analyse(two_pads())
    needed = restored_effects.needed(Results(before, sliding(before, FAR)))
    assert set(needed) == {"friction", "displacement"}
    for effect, (choice, reason) in needed.items():
        assert getattr(before.assembly.effects, effect) in EFFECTS[effect] and choice not in EFFECTS[effect] and reason
    full = analyse(scenes.load(two_pads().text + '\n[effects]\nfriction = "coulomb"\ndisplacement = "finite"\n', "two_pads"))
    assert restored_effects.restore(Results(full, sliding(full, FAR))) is None


def test_every_effect_that_may_be_restored_has_its_words() -> None:
    assert set(WITHOUT) == set(WHY) == {"plane", "friction", "reach", "displacement"} <= set(EFFECTS)


def test_the_sentence_shows_both_answers_and_an_answer_that_is_not_solved() -> None:
    before = analyse(two_pads())
    assert before.coulomb is not None
    other = with_answers(before, coulomb=dataclasses.replace(before.coulomb, value=1300.4))
    after = other.with_effects(dataclasses.replace(other.assembly.effects, called_back=("friction",)))
    summary = first_prediction_summary(answer_of(before), after)
    assert summary is not None and summary["sentence"].endswith("said 363.30 N; joints slide in YADE, so friction was modelled: 1300.4 N.")
    unsure = answer_of(before)
    unsure["coulomb"] |= {"uncertainty": 20.0, "plateaus": [363.298, 402.0], "status": "inaccurate"}
    summary = first_prediction_summary(unsure, after)
    assert summary is not None and "said 363 ± 20 N (several plateaus: 363.3, 402 N; inaccurate); joints" in summary["sentence"]
    failed = answer_of(before) | {"coulomb": {"status": "failed", "reaction": None}}
    summary = first_prediction_summary(failed, after)
    assert summary is not None and "without sliding said failed;" in summary["sentence"]


def test_the_report_and_the_command_line_show_both_answers(
    tmp_path: Path, made_up_yade: Callable[[Make], list[bytes]], capsys: pytest.CaptureFixture[str]
) -> None:
    made_up_yade(sliding)
    main(["run", "two_pads", "-o", str(tmp_path)])
    summary = json.loads((tmp_path / "two_pads" / "comparison.json").read_text(encoding="utf-8"))
    sentence = summary["first_prediction"]["sentence"]
    shown = Units(summary["weight"]).words(sentence)  # a page has one unit of force
    assert f"two_pads: {sentence}" in capsys.readouterr().out.replace("\n", " ")
    for page in ("report.html", "report.md"):
        assert shown in (tmp_path / page).read_text(encoding="utf-8").replace("\\", "")
    (tmp_path / "two_pads" / "comparison.json").unlink()
    main(["report", str(tmp_path)])
    assert sentence in capsys.readouterr().out.replace("\n", " ") and shown in (tmp_path / "report.html").read_text(encoding="utf-8")
