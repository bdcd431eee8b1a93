"""Full disks, unwritable folders and exhausted memory are named and leave no file half written. The next call recovers."""

import json
import os
import resource
import shutil
from collections.abc import Iterator
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import pytest
import scenes
from faulty_runs import INTERRUPTED, TOOL, Fake, answer, crosscheck, one_message, processes_about, unfinished, wait_for

from comparison.cli.commands import main
from comparison.cli.exit_codes import USAGE


def failing_writes(monkeypatch: pytest.MonkeyPatch, error: BaseException) -> Iterator[int]:
    """Let the write of the first, second, ... file fail half way. Yield the file's number; end when a whole run writes fewer files."""
    written = 0
    original = Path.write_bytes

    def fail(path: Path, content: bytes) -> int:
        nonlocal written
        written += 1
        if written != number:
            return original(path, content)
        original(path, content[: len(content) // 2])
        raise error

    for number in range(1, 100):
        written = 0
        with monkeypatch.context() as patch:
            patch.setattr(Path, "write_bytes", fail)
            yield number
        if written < number:
            return


STOPS = {
    "disk full": (OSError(28, "No space left on device"), TOOL, "No space"),
    "interrupted": (KeyboardInterrupt(), INTERRUPTED, "stopped"),
}


@pytest.mark.slow_after_first
@pytest.mark.parametrize(("error", "code", "word"), STOPS.values(), ids=STOPS)
def test_a_stop_in_any_file_leaves_none_half_written_and_the_next_call_recovers(
    error: BaseException,
    code: int,
    word: str,
    plain_figures: None,
    without_yade: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    files = 0
    for number in failing_writes(monkeypatch, error):
        out = tmp_path / str(number)
        command = ["run", "two_pads", "-o", str(out), "--no-yade", "-q"]
        found = main(command)
        said = capsys.readouterr().err
        if found == 0:
            break
        files += 1
        assert found == code
        one_message(said, word)
        assert not unfinished(out)
        with monkeypatch.context() as patch:
            patch.undo()
            assert main(command) == 0
        assert answer(out) == answer(without_yade)
    assert files == 8  # scene, case, figure, view, comparison, three reports


def test_a_disk_that_fills_up_at_the_report_takes_no_verdict_away(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """All results are stored by then, so the user still gets the verdict."""

    def fill(folder: Path, *_: object) -> Path:
        raise OSError(28, os.strerror(28), str(folder / "report.html"))

    monkeypatch.setattr("comparison.cli.conclude.write_report", fill)
    assert main(["run", "two_pads", "-o", str(tmp_path), "--no-yade", "-q"]) == TOOL
    told = capsys.readouterr()
    assert "expected value met" in told.out and "report:" not in told.out
    one_message(told.err, "report.html: No space left on device")


@pytest.mark.parametrize(("module", "write"), [("conclude", "write_report"), ("scene_verbs.report", "report_again")])
def test_a_report_that_cannot_be_written_keeps_no_other_folder_from_its_own(
    module: str,
    write: str,
    without_yade: Path,
    tmp_path: Path,
    plain_figures: None,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    filled, other = (shutil.copytree(without_yade, tmp_path / name) for name in ("filled", "other"))
    (other / "report.html").unlink()
    whole = f"comparison.cli.{module}.{write}"
    original = resolve_name(whole)

    def fill(folder: Path, *rest: Any, **named: Any) -> Any:
        if folder.is_relative_to(filled):
            raise OSError(28, os.strerror(28), str(folder))
        return original(folder, *rest, **named)

    monkeypatch.setattr(whole, fill)
    assert main(["report", str(filled), str(other), "-q"]) == TOOL
    told = capsys.readouterr()
    one_message(told.err, f"{filled}", "No space left on device")
    assert told.out.count("report:") == 1 and (other / "report.html").is_file()
    assert main(["report", str(filled), str(other), "-q", "--json"]) == TOOL
    first, second = json.loads(capsys.readouterr().out)["reports"]
    has_verdict = write == "write_report"  # the report is written after all comparisons
    assert (len(first["comparisons"]), first["left_out"]) == ((1, []) if has_verdict else (0, ["two_pads"]))
    assert len(second["comparisons"]) == 1 and second["left_out"] == []
    assert main(["report", str(filled), "-q", "--json"]) == TOOL
    assert len(json.loads(capsys.readouterr().out)["comparisons"]) == int(has_verdict)


def full(_: object, path: Path) -> None:
    raise OSError(28, os.strerror(28), str(path))


@pytest.mark.parametrize(("option", "word"), [("-q", "Coulomb, elastic joints"), ("--json", '"trials"')])
def test_a_disk_that_fills_up_at_the_figure_of_a_study_takes_no_number_away(
    option: str, word: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("comparison.cli.study_verbs.sensitivity.save", full)
    assert main(["sensitivity", "two_pads", "-o", str(tmp_path / "figure.png"), "-q", option]) == TOOL
    told = capsys.readouterr()
    assert word in told.out
    one_message(told.err, "figure.png: No space left on device")


@pytest.mark.slow_after_first
@pytest.mark.parametrize(("option", "word"), [("-q", "errors are relative to"), ("--json", '"ladders"')])
def test_a_disk_that_fills_up_at_the_figure_of_the_costs_takes_no_number_away(
    option: str, word: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("comparison.cli.study_verbs.cost.save", full)
    monkeypatch.setattr("comparison.studies.cost.REPEATS", 1)
    assert main(["cost", "two_pads", "--no-yade", "-o", str(tmp_path), "-q", option]) == TOOL
    told = capsys.readouterr()
    assert word in told.out and (tmp_path / "two_pads-cost.json").is_file()
    one_message(told.err, "two_pads-cost.png: No space left on device")


def limited(size: int) -> dict[str, Any]:
    """Return options of a process whose files cannot exceed `size`, bytes. Python writes no compiled modules: they would be cut off."""
    return {
        "preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)),
        "env": {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
    }


def test_a_disk_that_fills_up_is_named_with_the_file(tmp_path: Path) -> None:
    """A limit on the size of files has the same effect as a full disk."""
    with crosscheck("run", "two_pads", "-o", str(tmp_path / "out"), **limited(100)) as process:
        _, said = process.communicate()
    assert process.returncode == TOOL
    one_message(said, "scene.toml: File too large")
    assert not unfinished(tmp_path)


def test_a_disk_that_fills_up_leaves_no_empty_scene_that_a_new_one_would_spare(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    with crosscheck("new", "arch", "-o", str(path), **limited(100)) as process:
        _, said = process.communicate()
    assert process.returncode == TOOL
    one_message(said, "mine.toml: File too large")
    assert not list(tmp_path.iterdir())
    assert main(["new", "arch", "-o", str(path), "-q"]) == 0


@pytest.mark.slow
def test_a_disk_that_fills_up_under_yade_is_named_with_the_file(plain_figures: None, tmp_path: Path) -> None:
    """YADE's process inherits the limit. Only its result, with many stored states, is larger."""
    scene, undisturbed, out = tmp_path / "two_pads.toml", tmp_path / "undisturbed", tmp_path / "out"
    scene.write_text(scenes.shipped("two_pads").text + "\n[yade]\nposes = 200\nstop_uncertainty = 1e-9\n")
    assert main(["run", str(scene), "-o", str(undisturbed), "-q"]) == 0
    case, run = ((undisturbed / "two_pads" / name).stat().st_size for name in ("case.h5", "run.h5"))
    assert case < run
    with crosscheck("run", str(scene), "-o", str(out), **limited(run - 1)) as process:
        _, said = process.communicate()
    assert process.returncode == TOOL and "Traceback" not in said
    assert said.count("YADE: failed") == 1 and "File too large" in said and "run.h5" in said
    assert not unfinished(out) and not (out / "two_pads" / "run.h5").exists()
    assert main(["run", str(scene), "-o", str(out), "-q"]) == 0
    assert answer(out) == answer(undisturbed)


def test_a_full_disk_behind_standard_output_is_named() -> None:
    with Path("/dev/full").open("w") as full, crosscheck("solve", "two_pads", "--json", "-q", stdout=full) as process:
        _, said = process.communicate()
    assert process.returncode == TOOL
    one_message(said, "standard output: No space left on device")


@pytest.mark.yade
def test_a_log_that_cannot_be_written_is_named(
    fake_python: Fake, tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fake_python("echo something; sleep 600")
    monkeypatch.setattr("comparison.yade.process._report", lambda line: (_ for _ in ()).throw(OSError(28, "No space left on device")))
    assert main(["run", "two_pads", "-o", str(tmp_path / "out"), "-q"]) == TOOL
    one_message(capsys.readouterr().err, "yade.log: No space left on device")
    wait_for(lambda: not processes_about(tmp_path / "out"))


@pytest.mark.yade
def test_memory_at_an_end_is_no_fault_of_the_program(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def hungry(*arguments: Any, **options: Any) -> None:
        raise MemoryError("Unable to allocate 1 TiB")

    monkeypatch.setattr("comparison.cli.scene_verbs.solve.limit_analysis_alone", hungry)
    assert main(["solve", "two_pads"]) == TOOL
    one_message(capsys.readouterr().err, "out of memory")


@pytest.mark.parametrize("where", ["below a file", "below /proc", "a file for a scene's folder", "a folder for a result"])
def test_a_folder_that_cannot_be_written_is_named(where: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = {"below a file": tmp_path / "file" / "out", "below /proc": Path("/proc/nowhere")}.get(where, tmp_path / "out")
    (tmp_path / "file").touch()
    if where == "a file for a scene's folder":
        out.mkdir()
        (out / "two_pads").touch()
    if where == "a folder for a result":
        (out / "two_pads" / "case.h5" / "x").mkdir(parents=True)
    assert main(["run", "two_pads", "-o", str(out), "--no-yade", "-q"]) == TOOL
    one_message(capsys.readouterr().err, str(out))


@pytest.mark.parametrize(
    ("command", "code", "words"),
    [("show", USAGE, "is a file, and not a folder"), ("solve", USAGE, "is a file, and not a folder"), ("export", TOOL, "Not a directory")],
)
def test_an_output_that_cannot_be_written_is_named(
    command: str, code: int, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """An output path cannot lie inside a file. `show` and `solve` refuse it before the work."""
    (tmp_path / "file").touch()
    assert main([command, "two_pads", "-q", "-o", str(tmp_path / "file" / "figure.png")]) == code
    one_message(capsys.readouterr().err, str(tmp_path / "file"), words)
