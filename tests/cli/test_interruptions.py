"""An interrupted program leaves no file half written and no process of YADE behind. The next call continues."""

import random
import shutil
import signal
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from faulty_runs import (
    INTERRUPTED,
    ROOT,
    RUN_SECONDS,
    TOOL,
    answer,
    crosscheck,
    endless,
    held_yade,
    one_message,
    processes_about,
    unfinished,
    wait_for,
)

from comparison.cli.commands import main
from comparison.run_folder import LOCK, WRITTEN, alone_in


def stopped_by(number: signal.Signals, out: Path, at: Callable[[], bool], delay: float = 0.0, scene: str = "two_pads") -> tuple[int, str]:
    """Return exit code and messages of a run that gets a signal `delay` seconds after `at()` is true. YADE must have ended, too."""
    with crosscheck("run", scene, "-o", str(out)) as process:
        wait_for(lambda: at() or process.poll() is not None)
        time.sleep(delay)
        process.send_signal(number)
        _, said = process.communicate()
    wait_for(lambda: not processes_about(out))
    return process.returncode, said


def begun(out: Path) -> Callable[[], bool]:
    return lambda: bool(processes_about(out)) and out.exists()


def in_yade(out: Path) -> Callable[[], bool]:
    return (out / "two_pads" / "yade.log").exists


@pytest.mark.slow_after_first
@pytest.mark.parametrize(("stage", "delay"), [(begun, 0.0), (in_yade, 0.3)])
def test_an_interruption_ends_yade_and_the_next_call_goes_on(
    stage: Callable[[Path], Callable[[], bool]], delay: float, undisturbed: Path, plain_figures: None, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    code, said = stopped_by(signal.SIGINT, out, stage(out), delay, str(endless(tmp_path)))
    assert code == INTERRUPTED
    one_message(said, "stopped")
    assert not unfinished(out)
    assert main(["run", "two_pads", "-o", str(out), "-q"]) == 0
    assert answer(out) == answer(undisturbed)


@pytest.mark.slow
def test_a_report_tells_an_interrupted_run_of_yade_from_one_that_nobody_asked_for(
    plain_figures: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Earlier results of limit analysis alone do not hide the interruption. Later ones are reported without it."""
    out, scene = tmp_path / "out", str(endless(tmp_path))
    assert main(["run", scene, "-o", str(out), "-q", "--no-yade"]) == 0
    assert stopped_by(signal.SIGINT, out, in_yade(out), 0.3, scene)[0] == INTERRUPTED
    capsys.readouterr()
    for _ in range(2):
        assert main(["report", str(out), "-q"]) == TOOL
        told = " ".join(capsys.readouterr().out.split())
        assert "YADE's run was interrupted" in told and "next: Run the scene again" in told and "doctor" not in told
    assert main(["run", scene, "-o", str(out), "-q", "--no-yade"]) == 0
    assert main(["report", str(out), "-q"]) == 0
    assert "interrupted" not in capsys.readouterr().out


def test_an_interruption_while_the_program_loads_ends_in_one_line(tmp_path: Path) -> None:
    """The signal comes after the program's own entry point has taken over from Python."""
    (tmp_path / "comparison").mkdir()
    (tmp_path / "comparison" / "__init__.py").touch()
    shutil.copy(ROOT / "comparison" / "__main__.py", tmp_path / "comparison")
    (tmp_path / "comparison" / "cli.py").write_text('import time\nprint("loading", flush=True)\ntime.sleep(60.0)\n')
    with crosscheck("scenes", cwd=tmp_path) as process:
        assert process.stdout is not None and process.stdout.readline() == "loading\n"
        process.send_signal(signal.SIGINT)
        _, said = process.communicate()
    assert process.returncode == INTERRUPTED
    one_message(said, "stopped before anything began")


@pytest.mark.parametrize(("verb", "continues"), [("run", True), ("solve", False)])
def test_only_a_command_that_keeps_something_promises_to_continue(
    verb: str, continues: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def stopped(context: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr(f"comparison.cli.scene_verbs.{verb}.execute", stopped)
    assert main([verb, "two_pads"]) == INTERRUPTED
    said = capsys.readouterr().err
    one_message(said, "stopped")
    assert ("the same command continues" in said) is continues


def test_an_interruption_while_the_command_line_is_read_ends_in_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def stopped() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("comparison.cli.commands.parser", stopped)
    assert main(["scenes"]) == INTERRUPTED
    one_message(capsys.readouterr().err, "stopped")


@pytest.mark.parametrize("number", [signal.SIGKILL, pytest.param(signal.SIGTERM, marks=pytest.mark.long)])
def test_yade_ends_with_the_program_that_started_it(number: signal.Signals, undisturbed: Path, plain_figures: None, tmp_path: Path) -> None:
    out = tmp_path / "out"
    code, said = stopped_by(number, out, in_yade(out), 0.4, str(endless(tmp_path)))
    assert code == -number and "Traceback" not in said
    assert main(["run", "two_pads", "-o", str(out), "-q"]) == 0
    assert answer(out) == answer(undisturbed)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(20))
def test_an_interruption_at_any_moment_leaves_nothing_half_done(seed: int, undisturbed: Path, tmp_path: Path) -> None:
    out, delay = tmp_path / "out", random.Random(seed).uniform(0.0, 2.0 * RUN_SECONDS)
    code, said = stopped_by(signal.SIGINT, out, begun(out), delay)
    assert code in (0, INTERRUPTED) and "Traceback" not in said
    assert not unfinished(out)
    assert main(["run", "two_pads", "-o", str(out), "-q"]) == 0
    assert answer(out) == answer(undisturbed)


def test_a_folder_in_use_is_refused_and_free_again_afterwards(copy: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]) -> None:
    with alone_in(copy / "two_pads"):
        for command in (["run", "two_pads", "-o", str(copy), "-q"], ["report", str(copy), "-q"]):
            assert main(command) == TOOL
            one_message(capsys.readouterr().err, "in use by another crosscheck process")
    assert main(["run", "two_pads", "-o", str(copy), "-q"]) == 0


@pytest.mark.slow
def test_of_two_runs_in_one_folder_the_second_leaves_the_first_alone(undisturbed: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    environment, go = held_yade(tmp_path)
    with crosscheck("run", "two_pads", "-o", str(out), env=environment) as first:
        wait_for(lambda: ((out / "two_pads" / LOCK).exists() and (out / "two_pads" / "case.h5").exists()) or first.poll() is not None)
        code = main(["run", "two_pads", "-o", str(out), "-q"])
        go.touch()
        assert code == TOOL
        _, said = first.communicate()
    assert first.returncode == 0, said
    assert answer(out) == answer(undisturbed)


def test_what_a_killed_process_was_writing_is_taken_away(copy: Path) -> None:
    (copy / "two_pads" / "case.h5.123.part").write_bytes(b"half")
    (copy / "two_pads" / "notes.part").write_bytes(b"the user's own")
    assert main(["run", "two_pads", "-o", str(copy), "-q"]) == 0
    assert [path.name for path in unfinished(copy)] == ["notes.part"]


def test_what_lies_below_a_folder_or_has_another_s_name_is_not_taken_away(tmp_path: Path) -> None:
    """A folder below has its own lock, and an archive in parts belongs to the user."""
    (tmp_path / "cases" / "one").mkdir(parents=True)
    kept = ["survey.zip.2.part", "case.h5.part", "case.h5.x.part", "cases/one/case.h5.77.part"]
    for name in (*kept, "case.h5.77.part", "results.csv.8.part"):
        (tmp_path / name).write_bytes(b"half")
    with alone_in(tmp_path):
        assert sorted(str(path.relative_to(tmp_path)) for path in unfinished(tmp_path)) == sorted(kept)


def test_every_file_of_a_run_is_known_to_be_the_program_s_own(undisturbed: Path) -> None:
    written = {path.name for path in (undisturbed / "two_pads").iterdir()}
    assert written - {LOCK} <= WRITTEN and "case.h5" in written
