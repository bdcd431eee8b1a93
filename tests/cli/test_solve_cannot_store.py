"""`crosscheck solve` answers even if its answer cannot be stored, and harms no file that is there or is being written."""

import os
import shutil
from pathlib import Path

import pytest
from faulty_runs import lasting
from paths import with_reports
from stored_answers import lighter, run, solve, state

from comparison.cli.commands import main
from comparison.cli.exit_codes import AGREE, TOOL
from comparison.run_folder import LOCK, alone_in
from la_core import exchange
from la_core.analysis import analyse, case_file
from la_core.scene import load, shipped

pytestmark = pytest.mark.usefixtures("plain_figures")


# --- obstacles to storing -----------------------------------------------------------------------------------------------------


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


# --- commands at the same time ------------------------------------------------------------------------------------------------


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
    """The second command runs as a whole during the prediction of the first command. `solve` must not have locked the folder."""
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
