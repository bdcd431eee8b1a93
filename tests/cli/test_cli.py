"""The command line's promises: exit codes, JSON alone on stdout, one helpful message, resume."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import every_shipped_scene

from comparison.cli.commands import main
from comparison.studies import TimeEstimate, estimated_times
from la_core.analysis import structural_model
from la_core.scene import load_scene, shipped

GALLERY = Path(__file__).parents[2] / "comparison" / "gallery"
SOLVED_KEYS = {
    "status", "reaction", "reaction_max", "reaction_sharp", "equilibrium_residual", "cone_violation", "duality_gap", "seconds"
}  # fmt: skip


def test_scenes_lists_every_shipped_scene_with_its_source(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenes", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)["scenes"]
    assert [scene["name"] for scene in listed] == shipped.names()
    assert all(scene["title"] and scene["source"] for scene in listed)
    assert main(["scenes"]) == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in ("two_pads", "facade", "wall_third"))


def test_solve_prints_one_json_object_and_nothing_else(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "two_pads", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["weight"] == pytest.approx(2158.2)
    assert (answer["free_blocks"], answer["interfaces"], answer["contact_points"]) == (1, 2, 4)
    assert answer["effects"]["plane"] is True
    associated = answer["limit_analysis"]["associated"]
    assert associated.keys() >= SOLVED_KEYS
    assert associated["status"] == "solved"
    assert associated["reaction"] == pytest.approx(363.297, abs=1e-3)  # the inset moves every lever arm: 0.101 / 0.6 of W
    assert associated["reaction_sharp"] == pytest.approx(359.7, abs=1e-3)
    coulomb = answer["limit_analysis"]["coulomb"]
    assert coulomb["status"] == "solved"
    assert coulomb["reaction"] == pytest.approx(associated["reaction"], rel=1e-6)  # no joint slides
    assert coulomb["reaction_interval"] == pytest.approx([associated["reaction"]] * 2, rel=1e-6)
    assert coulomb["dilatancy_residual"] <= 1e-3 and coulomb["iterations"] > 0 and coulomb["seconds"] > 0.0
    assert not {"yade", "checks", "verdict"} & answer.keys()


def _overhanging(folder: Path) -> Path:
    """Two pads that both lie left of the block's centroid."""
    text = shipped.find("two_pads").read_text().split("[expected]")[0].replace("to = [1.0, 0.2, 0.0]", "to = [0.45, 0.2, 0.0]")
    path = folder / "overhang.toml"
    path.write_text(text.replace("from = [0.5, 0.0, -0.1]", "from = [0.4, 0.0, -0.1]"))
    return path


def test_solve_of_a_structure_that_cannot_stand_names_what_falls(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", str(_overhanging(tmp_path)), "--json"]) == 5
    associated = json.loads(capsys.readouterr().out)["limit_analysis"]["associated"]
    assert associated["status"] == "infeasible"
    assert associated["reaction"] is None and associated["duality_gap"] is None
    assert associated["falling"] == ["block"]


def test_a_scene_that_misses_its_expected_value_disagrees(tmp_path: Path) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text(shipped.find("two_pads").read_text().replace("0.1666666667", "0.1766666667"))
    assert main(["solve", str(path), "-q"]) == 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("friction = 0.6", "fricton = 0.6"), ("fricton", "friction")),
        (("friction = 0.6", "friction = -0.6"), ("joint.friction", "-0.6")),
        (("friction = 0.6", "friction = nan"), ("joint.friction", "nan")),
        (("[settlement]", "[settlement"), ("TOML",)),
    ],
)
def test_a_bad_scene_ends_with_code_2_and_one_message(
    change: tuple[str, str], words: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(shipped.find("two_pads").read_text().replace(*change))
    for command in (["solve", str(path)], ["run", str(path), "-o", str(tmp_path / "out")], ["show", str(path)]):
        assert main(command) == 2
        captured = capsys.readouterr()
        assert captured.out == ""
        assert captured.err.startswith("error: ") and captured.err.count("\n") == 1
        assert "bad.toml" in captured.err and all(word in captured.err for word in words)
    assert not (tmp_path / "out").exists()


def test_unknown_scenes_and_commands_end_with_code_2(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "two_pds"]) == 2
    assert "two_pads" in capsys.readouterr().err
    with pytest.raises(SystemExit) as stop:
        main(["frobnicate"])
    assert stop.value.code == 2


def test_two_scenes_of_one_name_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    copy = tmp_path / "two_pads.toml"
    shutil.copy(shipped.find("two_pads"), copy)
    assert main(["run", "two_pads", str(copy), "-o", str(tmp_path / "out"), "--no-yade"]) == 2
    assert "same name" in capsys.readouterr().err


def test_show_states_dimensions_density_and_times(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "two_pads", "-o", str(tmp_path / "a.png"), "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["dimensions"] == pytest.approx([1.0, 0.2, 0.5]) and facts["densities"] == [2200.0]
    assert set(facts["estimated_seconds"]) == {"limit_analysis", "yade"}
    assert main(["show", "ferris_tin_loi_1", "-q", "-o", str(tmp_path / "a.png")]) == 0
    printed = capsys.readouterr().out
    assert "limit analysis takes" in printed and "YADE takes" in printed


@pytest.mark.parametrize("name", ["two_pads", "arch_spreading", "rubble_wall", "wall_third", "wall_tall", "facade"])
def test_the_estimated_times_hold_the_measured_ones(name: str) -> None:
    recorded = json.loads((GALLERY / "results.json").read_text(encoding="utf-8"))[name]["reduced"]
    points = len(structural_model(load_scene(shipped.find(name))).assembly.points)
    times = estimated_times(points)
    assert times["yade"].least <= recorded["yade_seconds"] <= times["yade"].greatest
    assert recorded["limit_analysis_seconds"] <= max(times["limit_analysis"].greatest, 1.0)
    assert times["yade"].greatest == pytest.approx(9.0 * times["yade"].least)
    assert str(TimeEstimate(0.1, 0.9)) == "less than 1 s" and str(TimeEstimate(400.0, 3700.0)) == "7 min to 1 h"


def test_show_draws_and_counts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    figure = tmp_path / "figure.png"
    assert main(["show", "slab_four_corners", "-o", str(figure), "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert (facts["free_blocks"], facts["contact_points"]) == (1, 16)
    assert figure.read_bytes().startswith(b"\x89PNG")


def test_a_figure_takes_the_format_of_its_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, beginning in (("f.png", b"\x89PNG"), ("f.svg", b"<?xml"), ("f.pdf", b"%PDF")):
        assert main(["show", "two_pads", "-q", "-o", str(tmp_path / name)]) == 0
        assert (tmp_path / name).read_bytes().startswith(beginning)
    with pytest.raises(SystemExit) as stop:
        main(["show", "two_pads", "-o", str(tmp_path / "figure.jpeg")])
    assert stop.value.code == 2 and ".svg" in capsys.readouterr().err


def test_run_without_yade_writes_every_file_and_then_finds_it_cached(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert main(["run", "two_pads", "-o", str(out), "--no-yade"]) == 0
    assert "report.html" in capsys.readouterr().out
    for name in ("two_pads/scene.toml", "two_pads/case.h5", "two_pads/comparison.json", "report.html", "report.md", "report.json"):
        assert (out / name).exists(), name
    summary = json.loads((out / "two_pads" / "comparison.json").read_text())
    assert summary["yade"] is None and summary["verdict"] == "expected value met"
    before = (out / "two_pads" / "case.h5").stat().st_mtime_ns
    assert main(["run", "two_pads", "-o", str(out), "--no-yade"]) == 0
    assert capsys.readouterr().err.count("cached") == 2
    assert (out / "two_pads" / "case.h5").stat().st_mtime_ns == before
    assert main(["report", str(out)]) == 0


def test_a_changed_scene_is_solved_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, out = tmp_path / "mine.toml", tmp_path / "out"
    text = shipped.find("two_pads").read_text().split("[expected]")[0]
    path.write_text(text)
    assert main(["run", str(path), "-o", str(out), "--no-yade"]) == 0
    path.write_text(text.replace("density = 2200.0", "density = 1100.0"))
    capsys.readouterr()
    assert main(["run", str(path), "-o", str(out), "--no-yade"]) == 0
    assert "cached" not in capsys.readouterr().err
    assert json.loads((out / "mine" / "comparison.json").read_text())["weight"] == pytest.approx(1079.1)


def test_a_half_written_case_is_recognised_and_redone(tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert main(["run", "two_pads", "-o", str(out), "--no-yade", "-q"]) == 0
    case = out / "two_pads" / "case.h5"
    case.write_bytes(case.read_bytes()[: case.stat().st_size // 2])
    assert main(["run", "two_pads", "-o", str(out), "--no-yade", "-q"]) == 0
    assert json.loads((out / "two_pads" / "comparison.json").read_text())["verdict"] == "expected value met"


def test_without_yade_on_the_machine_limit_analysis_is_kept_and_the_exit_code_is_3(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CROSSCHECK_YADE", str(tmp_path / "nowhere"))
    out = tmp_path / "out"
    assert main(["run", "two_pads", "-o", str(out)]) == 3
    captured = capsys.readouterr()
    assert "apt-get install yade python3-h5py" in captured.err
    summary = json.loads((out / "two_pads" / "comparison.json").read_text())
    assert summary["limit_analysis"]["associated"]["status"] == "solved"
    assert summary["yade"]["status"] == "missing" and summary["verdict"] == "inconclusive"
    assert main(["doctor"]) == 3
    assert "apt-get install yade" in capsys.readouterr().out


def test_a_live_load_gives_a_multiplier_and_no_yade_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "pushed.toml"
    path.write_text("""
title = "Block pushed sideways"
[stone]
density = 2000.0
[joint]
friction = 0.4
[[block]]
name = "ground"
role = "fixed"
box = { from = [-1.0, 0.0, -0.1], to = [2.0, 1.0, 0.0] }
[[block]]
name = "block"
box = { from = [0.0, 0.0, 0.0], to = [1.0, 1.0, 0.5] }
[live]
direction = [1.0, 0.0, 0.0]
""")
    assert main(["solve", str(path), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)["limit_analysis"]
    assert answer["associated"]["multiplier"] == pytest.approx(0.4, abs=1e-8)
    assert answer["coulomb"]["multiplier"] == pytest.approx(0.4, abs=1e-6)
    assert "reaction" not in answer["associated"] and "reaction" not in answer["coulomb"]
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 0


def test_colours_and_narration_obey_the_environment(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "comparison", "solve", "two_pads", "-q"]
    environment = {**os.environ, "NO_COLOR": "1", "FORCE_COLOR": ""}
    answer = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    assert "\x1b[3" not in answer.stdout
    assert answer.stderr == ""


@every_shipped_scene
def test_every_shipped_scene_reproduces_what_is_expected_of_it(name: str) -> None:
    assert main(["solve", name, "-q"]) == 0


def test_an_expected_value_of_the_wrong_kind_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "wrong.toml"
    for line in ("multiplier = 3.0", ""):
        path.write_text(shipped.find("two_pads").read_text().split("[expected]")[0] + f'[expected]\nkind = "exact"\n{line}\n')
        assert main(["solve", str(path)]) == 2
        assert "reaction_over_weight" in capsys.readouterr().err


def test_a_bad_scene_is_refused_before_the_first_one_runs(tmp_path: Path) -> None:
    path = tmp_path / "floating.toml"
    lifted = ("from = [0.0, 0.0, 0.0], to = [1.0, 0.2, 0.5]", "from = [0.0, 0.0, 3.0], to = [1.0, 0.2, 3.5]")
    path.write_text(shipped.find("two_pads").read_text().replace(*lifted))
    assert main(["run", "two_pads", str(path), "-o", str(tmp_path / "out"), "--no-yade"]) == 2
    assert not (tmp_path / "out").exists()


def test_a_broken_case_does_not_keep_the_others_from_the_report(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert main(["run", "two_pads", "trilith", "-o", str(out), "--no-yade", "-q"]) == 0
    (out / "trilith" / "case.h5").write_bytes(b"not HDF5")
    capsys.readouterr()
    assert main(["report", str(out), "--json"]) == 3
    captured = capsys.readouterr()
    assert [c["scene"] for c in json.loads(captured.out)["comparisons"]] == ["two_pads"]
    assert "trilith" in captured.err


def test_a_fault_of_the_program_is_never_taken_for_a_disagreement(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("comparison.cli.scene_verbs.solve.limit_analysis_alone", lambda *arguments: 1 / 0)
    assert main(["solve", "two_pads"]) == 3
    assert "ZeroDivisionError" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "word"),
    [
        ('title   = "', 'title   = "\\u0000', "title"),
        ("friction = 0.6", "friction = 1e300", "friction"),
        ("density = 2000.0", "density = 1e-300", "density"),
        ("gravity = [0.0, 0.0, -9.81]", "gravity = [0.0, 0.0, -1e-200]", "gravity"),
        ("[settlement]", "deep = " + "[" * 20_000 + "\n[settlement]", "TOML"),
    ],
)
def test_absurd_values_are_refused_with_a_sentence(
    old: str, new: str, word: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "absurd.toml"
    text = shipped.find("two_pads").read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    assert main(["run", str(path), "-o", str(tmp_path / "out"), "--no-yade"]) == 2
    assert word in capsys.readouterr().err


def test_a_path_is_followed_where_it_is_asked_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "two_pads", "--path", "--json", "-o", str(tmp_path / "path.svg")]) == 0
    path = json.loads(capsys.readouterr().out)["limit_analysis"]["path"]
    assert len(path["settlement"]) == len(path["reaction"]) == 26 and path["settlement"][0] == 0.0
    assert path["reaction"][-1] == pytest.approx(363.297, rel=1e-3)
    assert (tmp_path / "path.svg").is_file()
    assert main(["solve", "two_pads", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["limit_analysis"]["path"] is None


def test_a_path_needs_friction_that_does_not_dilate(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "scene.toml"
    text = shipped.find("two_pads").read_text() + '\n[effects]\nfriction = "associated"\n'
    scene.write_text(text)
    assert main(["solve", str(scene), "--path"]) == 2
    scene.write_text(text + "[path]\nincrements = 5\n")
    assert main(["solve", str(scene)]) == 2
    assert "[path]" in capsys.readouterr().err


def test_the_classic_iteration_s_sensitivity_is_tabled_and_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    figure = tmp_path / "sensitivity.png"
    assert main(["sensitivity", "two_blocks", "-o", str(figure), "--json"]) == 0
    study = json.loads(capsys.readouterr().out)
    assert len(study["trials"]) == 25 and figure.stat().st_size > 10_000
