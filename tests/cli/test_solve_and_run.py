"""`crosscheck run` and `crosscheck solve` reuse each other's answers, but never the answer to another question."""

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path

import pytest
import scenes
from faulty_runs import lasting
from stored_answers import lighter, run, solve, state

from comparison.cli.commands import main
from comparison.cli.exit_codes import AGREE
from la_core.analysis import analyse, case_file
from la_core.scene import load, shipped

pytestmark = pytest.mark.usefixtures("plain_figures")


# --- reuse of answers ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["two_pads", "two_blocks", "ferris_tin_loi_1"])
def test_a_run_finds_what_solve_found(name: str, out: Path, analysed: list[object], capsys: pytest.CaptureFixture[str]) -> None:
    answer = solve(out, capsys, name)
    before = state(out)
    assert set(before) == {f"{name}/case.h5", f"{name}/scene.toml"}
    run(out, name)
    assert f"{name}: limit analysis: cached" in capsys.readouterr().err
    assert len(analysed) == 1
    after = state(out)
    assert after[f"{name}/case.h5"] == before[f"{name}/case.h5"]
    assert after[f"{name}/scene.toml"][1] == before[f"{name}/scene.toml"][1]
    compared = json.loads((out / name / "comparison.json").read_text(encoding="utf-8"))
    assert compared["limit_analysis"] == answer["limit_analysis"]


@pytest.mark.slow_after_first
@pytest.mark.parametrize("first", [solve, lambda out, capsys, name: run(out, name)])
@pytest.mark.parametrize("name", ["two_pads", "ferris_tin_loi_1"])
def test_solve_finds_what_was_found_before_and_prints_the_same(
    name: str, first: Callable[..., object], out: Path, analysed: list[object], capsys: pytest.CaptureFixture[str]
) -> None:
    fresh = solve(out.parent / "another", capsys, name)
    first(out, capsys, name)
    before = state(out)
    capsys.readouterr()
    assert main(["solve", name, "--results", str(out)]) == AGREE
    captured = capsys.readouterr()
    assert f"{name}: limit analysis: cached" in captured.err
    assert captured.out.count("over W" if name == "two_pads" else "value") == 2 and "Coulomb: status" in captured.out
    assert lasting(solve(out, capsys, name)) == lasting(fresh)
    assert len(analysed) == 2 and state(out) == before


def test_a_scene_with_a_mesh_is_stored_with_its_mesh(out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    solve(out, capsys, "rubble_wall")
    assert set(state(out)) == {f"rubble_wall/{name}" for name in ("case.h5", "rubble_wall.obj", "scene.toml")}
    run(out, "rubble_wall")
    assert "rubble_wall: limit analysis: cached" in capsys.readouterr().err


def test_the_default_folder_is_that_of_a_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("CROSSCHECK_OUTPUT")
    assert main(["solve", "two_pads", "-q"]) == AGREE
    assert (tmp_path / "crosscheck-results" / "two_pads" / "case.h5").is_file()
    assert main(["run", "two_pads", "--no-yade"]) == AGREE
    assert "limit analysis: cached" in capsys.readouterr().err
    Path("crosscheck.toml").write_text('output = "configured"')
    assert main(["solve", "two_pads", "-q"]) == AGREE
    assert (tmp_path / "configured" / "two_pads" / "case.h5").is_file()


def test_what_solve_found_can_be_reported_without_a_run(out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    solve(out, capsys)
    assert main(["report", str(out), "-q"]) == AGREE
    assert "two_pads" in capsys.readouterr().out


# --- answers to other questions -----------------------------------------------------------------------------------------------


def test_an_answer_with_a_path_is_not_taken_for_one_without_nor_the_other_way_round(
    out: Path, analysed: list[object], capsys: pytest.CaptureFixture[str]
) -> None:
    assert solve(out, capsys, "two_pads", "--path")["limit_analysis"]["path"] is not None
    assert not out.exists()
    assert solve(out, capsys)["limit_analysis"]["path"] is None
    before = state(out)
    assert solve(out, capsys, "two_pads", "--path")["limit_analysis"]["path"] is not None
    assert solve(out, capsys)["limit_analysis"]["path"] is None
    assert len(analysed) == 3 and state(out) == before


def test_a_path_of_the_scene_itself_is_stored_with_it(
    tmp_path: Path, out: Path, analysed: list[object], capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "two_pads.toml"
    path.write_text(shipped.find("two_pads").read_text() + "\n[path]\nincrements = 3\n")
    first, second = (solve(out, capsys, str(path))["limit_analysis"]["path"] for _ in range(2))
    assert len(analysed) == 1 and len(first["settlement"]) == 4 and first == second
    assert solve(out, capsys)["limit_analysis"]["path"] is None  # the shipped scene of the same name has no path


def test_bounds_alone_are_neither_stored_nor_taken_from_what_is_stored(
    out: Path, analysed: list[object], capsys: pytest.CaptureFixture[str]
) -> None:
    assert solve(out, capsys, "two_pads", "--bounds")["limit_analysis"]["coulomb"] is None
    assert not out.exists()
    assert solve(out, capsys)["limit_analysis"]["coulomb"] is not None
    before = state(out)
    assert solve(out, capsys, "two_pads", "--bounds")["limit_analysis"]["coulomb"] is None
    assert state(out) == before and len(analysed) == 1


@pytest.mark.parametrize("first", [solve, lambda out, capsys: run(out)])
def test_results_of_another_state_of_a_scene_stay_as_they_are(
    first: Callable[..., object], out: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """This also holds for another scene of the same name. No message mentions the stored results."""
    first(out, capsys)
    (out / "two_pads" / "run.h5").write_bytes(b"of YADE")
    before, other = state(out), lighter(tmp_path)
    capsys.readouterr()
    assert main(["solve", str(other), "--json", "--results", str(out)]) == AGREE
    captured = capsys.readouterr()
    assert json.loads(captured.out)["weight"] == pytest.approx(2158.2 / 2)
    assert state(out) == before
    assert [line.split(": ")[1].split(",")[0] for line in captured.err.splitlines()] == ["limit analysis"] * 2  # beginning, and bounds


def test_what_a_run_of_yade_changed_is_not_taken_for_an_answer_of_limit_analysis_alone(
    out: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fresh = solve(out, capsys, "two_blocks")
    scene = load("two_blocks")
    analysis = analyse(scene)
    changed = analysis.with_effects(dataclasses.replace(analysis.assembly.effects, called_back=("friction",)))
    case_file.write_case(out / "two_blocks" / "case.h5", changed, case_file.scene_digest(scene))
    before = state(out)
    assert lasting(solve(out, capsys, "two_blocks")) == lasting(fresh)
    assert state(out) == before


def test_what_cannot_stand_is_told_from_what_is_stored_too_and_loads_are_named(
    out: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A tie at its top overturns a block that stands without the tie: 500 N at 0.9 m exceed 397 N m of the weight."""
    block, ground = (
        scenes.box("block", (0.0, 0.0, 0.0), (0.3, 0.5, 0.9)),
        scenes.box("ground", (-3.0, -1.0, -0.1), (1.0, 1.0, 0.0), "fixed"),
    )
    tie = 'name = "rod"\nblocks = ["block"]\nfrom = [0.0, 0.25, 0.9]\nto = [-2.0, 0.25, 0.9]\nforce = 500.0'
    path = tmp_path / "pulled.toml"
    path.write_text(scenes.text(block, ground, f"[[tie]]\n{tie}", live=(1.0, 0.0, 0.0)))
    told = []
    for _ in range(2):
        assert main(["solve", str(path), "--results", str(out)]) == 5
        captured = capsys.readouterr()
        told.append(" ".join(captured.out.split()))
        assert "Look at the loads and ties on these blocks" in " ".join(captured.err.split())
    assert told[0] == told[1]
    assert 'no equilibrium exists under the structure\'s weight, loads and ties: "block" would fall' in told[0]
