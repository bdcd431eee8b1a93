"""A scene or a command requests an accuracy. The record of the attempts to reach it is printed, stored and found again."""

import json
import math
from pathlib import Path

import pytest
import scenes
from conftest import Silent

import la_core
from comparison.cli.commands import main
from comparison.workflow.one_scene import run_scene
from la_core.analysis.accuracy import with_accuracy
from la_core.analysis.result import AccuracyRecord, Attempt, record_from_text, record_to_text
from la_core.scene.scene import scene_of_text


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
    """A line within a string is not changed, although it looks like the key."""
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
    stored = record_from_text(record_to_text(AccuracyRecord(0.01, (attempt,), (), {"travel_periods": 300.0})))
    assert stored is not None and stored.limit_analysis[0].settings == attempt.settings
    assert math.isnan(stored.limit_analysis[0].error) and stored.settings == {"travel_periods": 300.0}
    assert record_from_text(record_to_text(None)) is None


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


@pytest.mark.parametrize("accuracy", [None, 0.02])
def test_a_note_says_of_sharp_edges_which_inset_both_methods_share(accuracy: float | None, tmp_path: Path) -> None:
    """YADE cannot model a sharp edge at any accuracy."""
    sharp = la_core.variant(scenes.shipped("two_pads"), {"joint.inset": 0.0})
    scene = sharp if accuracy is None else with_accuracy(sharp, accuracy)
    summary = run_scene(scene, tmp_path / "sharp", Silent(), with_yade=False, figures=lambda _: {})
    assert [note[:38] for note in summary["notes"]] == ["The scene has sharp edges (inset 0). Y"]
