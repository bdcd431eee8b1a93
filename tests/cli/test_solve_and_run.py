"""`crosscheck run` uses what `crosscheck solve` found, and the other way round; `solve` changes nothing that was stored before."""

import dataclasses
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from faulty_runs import lasting
from paths import with_reports

from comparison.cli.commands import main
from comparison.cli.exit_codes import AGREE, TOOL
from comparison.run_folder import LOCK, alone_in
from la_core import exchange
from la_core.analysis import analyse, case_file
from la_core.scene import load, shipped

pytestmark = pytest.mark.usefixtures("plain_figures")


@pytest.fixture
def out(tmp_path: Path) -> Path:
    """Folder of results that does not exist yet."""
    return tmp_path / "out"


@pytest.fixture
def analysed(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """Scenes that were predicted so far."""
    return with_reports(monkeypatch)


def solve(out: Path, capsys: pytest.CaptureFixture[str], scene: str = "two_pads", *options: str) -> dict[str, Any]:
    """What `crosscheck solve --json` prints of a scene."""
    capsys.readouterr()
    assert main(["solve", scene, "--json", "--results", str(out), *options]) == AGREE
    return dict(json.loads(capsys.readouterr().out))


def run(out: Path, scene: str = "two_pads") -> None:
    assert main(["run", scene, "--no-yade", "-o", str(out)]) == AGREE


def state(folder: Path) -> dict[str, tuple[int, bytes]]:
    """When every file below a folder was changed, and what it holds; the lock aside, which holds nothing."""
    files = [path for path in folder.rglob("*") if path.is_file() and path.name != LOCK]
    return {str(path.relative_to(folder)): (path.stat().st_mtime_ns, path.read_bytes()) for path in files}


def lighter(folder: Path) -> Path:
    """A file of another scene that is named "two_pads", too."""
    path = folder / "elsewhere" / "two_pads.toml"
    path.parent.mkdir(exist_ok=True)
    path.write_text(shipped.find("two_pads").read_text().replace("density = 2200.0", "density = 1100.0"))
    return path


# --- one finds what the other found -------------------------------------------------------------------------------------------


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


# --- what is another answer ---------------------------------------------------------------------------------------------------


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
    assert solve(out, capsys)["limit_analysis"]["path"] is None  # of the shipped scene of the same name


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
    """Or of another scene of the same name; nothing is said about them."""
    first(out, capsys)
    (out / "two_pads" / "run.h5").write_bytes(b"of YADE")
    before, other = state(out), lighter(tmp_path)
    capsys.readouterr()
    assert main(["solve", str(other), "--json", "--results", str(out)]) == AGREE
    captured = capsys.readouterr()
    assert json.loads(captured.out)["weight"] == pytest.approx(2158.2 / 2)
    assert state(out) == before
    assert [line.split(": ")[1].split(",")[0] for line in captured.err.splitlines()] == ["limit analysis"] * 2  # it begins, and its bounds


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


# --- what stands in the way ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["notes.txt", "scene.toml", "comparison.json", "run.h5", "case.h5"])
def test_a_folder_that_holds_anything_else_is_left_alone(name: str, out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (out / "two_pads").mkdir(parents=True)
    (out / "two_pads" / name).write_text("the user's own")
    solve(out, capsys)
    assert [path.name for path in (out / "two_pads").iterdir()] == [name]
    assert (out / "two_pads" / name).read_text() == "the user's own"


def test_what_an_interrupted_call_left_of_the_same_scene_is_completed(out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (out / "two_pads").mkdir(parents=True)
    (out / "two_pads" / LOCK).touch()
    shutil.copy(shipped.find("two_pads"), out / "two_pads" / "scene.toml")
    solve(out, capsys)
    assert (out / "two_pads" / "case.h5").is_file()


def test_a_pipe_in_the_place_of_the_scene_is_not_waited_for(out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (out / "two_pads").mkdir(parents=True)
    os.mkfifo(out / "two_pads" / "scene.toml")
    solve(out, capsys)
    assert not (out / "two_pads" / "case.h5").exists()


@pytest.mark.parametrize("where", ["below a file", "below /proc", "a file for the scene's folder"])
def test_a_folder_that_cannot_be_written_is_no_error(where: str, out: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").touch()
    place = {"below a file": tmp_path / "file" / "out", "below /proc": Path("/proc/nowhere")}.get(where, out)
    if where == "a file for the scene's folder":
        out.mkdir()
        (out / "two_pads").touch()
    assert main(["solve", "two_pads", "--results", str(place)]) == AGREE
    captured = capsys.readouterr()
    assert "Coulomb: reaction" in captured.out and "error" not in captured.err


@pytest.mark.parametrize("number", [1, 2])
def test_a_disk_that_is_full_is_no_error_and_the_next_call_stores(
    number: int, out: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The copy of the scene is written first, then the case."""
    original, written = Path.write_bytes, [0]

    def fail(path: Path, content: bytes) -> int:
        written[0] += 1
        if written[0] == number:
            original(path, content[: len(content) // 2])
            raise OSError(28, "No space left on device")
        return original(path, content)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "write_bytes", fail)
        solve(out, capsys)
    assert written == [number] and not list(out.rglob("*.part")) and not (out / "two_pads" / "case.h5").exists()
    solve(out, capsys)
    run(out)
    assert "limit analysis: cached" in capsys.readouterr().err


def test_a_scene_that_a_run_refuses_is_solved_and_not_stored(tmp_path: Path, out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "report.html.toml"
    shutil.copy(shipped.find("two_pads"), path)
    solve(out, capsys, str(path))
    assert not out.exists()


def test_a_damaged_result_is_not_used_and_left_for_a_run_to_mend(
    out: Path, analysed: list[object], capsys: pytest.CaptureFixture[str]
) -> None:
    fresh = solve(out, capsys)
    case = out / "two_pads" / "case.h5"
    content = case.read_bytes()
    case.write_bytes(content[:-1000] + bytes([content[-1000] ^ 1]) + content[-999:])
    before = state(out)
    assert lasting(solve(out, capsys)) == lasting(fresh)
    assert len(analysed) == 2 and state(out) == before
    run(out)
    assert len(analysed) == 3
    assert lasting(solve(out, capsys)) == lasting(fresh) and len(analysed) == 3


def test_a_stored_result_with_the_right_digest_and_wrong_values_is_not_used(
    out: Path, analysed: list[object], capsys: pytest.CaptureFixture[str]
) -> None:
    fresh = solve(out, capsys)
    other = load(lighter(out.parent))
    case_file.write_case(out / "two_pads" / "case.h5", analyse(other), case_file.scene_digest(load("two_pads")))
    assert lasting(solve(out, capsys)) == lasting(fresh)


# --- at the same time ---------------------------------------------------------------------------------------------------------


def test_a_folder_in_use_is_read_but_not_written_and_nobody_waits(
    out: Path, analysed: list[object], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (out / "two_pads").mkdir(parents=True)
    with alone_in(out / "two_pads"):
        solve(out, capsys)
        assert [path.name for path in (out / "two_pads").iterdir()] == [LOCK]
    solve(out, capsys)
    with alone_in(out / "two_pads"):
        solve(out, capsys)
    assert len(analysed) == 2


@pytest.mark.parametrize("other", ["solve", "run"])
def test_of_two_at_once_the_first_to_end_stores(
    other: str, out: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The second one runs as a whole while the first one is predicting; `solve` must not have locked the folder."""
    seen: list[dict[str, tuple[int, bytes]]] = []
    begun: list[str] = []

    def meanwhile(report: object) -> None:
        if not begun:
            begun.append(other)
            folder = {"solve": "--results", "run": "-o"}[other]
            assert main([other, "two_pads", "-q", "--json", folder, str(out), *(["--no-yade"] if other == "run" else [])]) == AGREE
            seen.append(state(out))

    with_reports(monkeypatch, meanwhile)
    assert main(["solve", "two_pads", "-q", "--results", str(out)]) == AGREE
    assert begun == [other] and state(out) == seen[0] and "two_pads/case.h5" in seen[0]
    assert exchange.inputs_digest(out / "two_pads" / "case.h5") == case_file.scene_digest(load("two_pads"))


def test_nothing_is_stored_where_nothing_was_found(out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(report: object) -> None:
        raise RuntimeError("of the path")

    with_reports(monkeypatch, fails)
    assert main(["solve", "two_pads", "-q", "--results", str(out)]) == TOOL
    assert not out.exists()
