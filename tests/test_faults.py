"""Whatever goes wrong ends in one clear message and the right exit code, leaves nothing half done, and the next call recovers."""

import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure

from comparison import launch, workflow
from comparison.cli import main
from comparison.files import LOCK, alone_in
from comparison.shipped import find
from la_core.sealed_file import VERSION

ROOT = Path(__file__).parent.parent
TOOL, INTERRUPTED = 3, 130
RUN_SECONDS = 2.0  # what YADE takes for two pads, loading included
PATIENCE = 60.0  # s, for what should happen at once

Fake = Callable[[str], None]


# --- what is compared ---------------------------------------------------------------------------------------------------------


def lasting(value: Any) -> Any:
    """What comparison.json says apart from how long it took, and the digests, which know that."""
    if isinstance(value, dict):
        return {name: lasting(item) for name, item in value.items() if name not in ("seconds", "inputs", "sum")}
    return [lasting(item) for item in value] if isinstance(value, list) else value


def answer(out: Path) -> Any:
    return lasting(json.loads((out / "two_pads" / "comparison.json").read_text(encoding="utf-8")))


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of a run that nothing disturbed; tests work on copies."""
    out = tmp_path_factory.mktemp("undisturbed") / "out"
    assert main(["run", "two_pads", "-o", str(out), "-q"]) == 0
    return out


@pytest.fixture(scope="module")
def without_yade(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("without_yade") / "out"
    assert main(["run", "two_pads", "-o", str(out), "-q", "--no-yade"]) == 0
    return out


@pytest.fixture
def copy(undisturbed: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(undisturbed, tmp_path / "out"))


@pytest.fixture
def plain_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """One empty figure in the place of four, for tests that are not about drawing."""
    monkeypatch.setattr(workflow, "_figures", lambda scene, analysis, run: {"assembly": Figure})


def unfinished(out: Path) -> list[Path]:
    return list(out.rglob("*.part"))


def one_message(said: str, *words: str) -> None:
    assert said.count("error: ") == 1 and "Traceback" not in said and "unexpected" not in said, said
    assert all(word in said for word in words), said


@pytest.fixture(autouse=True)
def interruptions_arrive() -> Iterator[None]:
    """A job in the background ignores them, and what it starts does so, too."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def crosscheck(*arguments: str, **options: Any) -> "subprocess.Popen[str]":
    command = [sys.executable, "-m", "comparison", *arguments]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen(command, **{"cwd": ROOT, **pipes, **options})


def wait_for(happens: Callable[[], bool]) -> None:
    deadline = time.monotonic() + PATIENCE
    while not happens():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def processes_about(path: Path) -> list[int]:
    """Processes whose command line names a path."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and str(path).encode() in (entry / "cmdline").read_bytes():
                found.append(int(entry.name))
        except OSError:
            continue  # it ended just now
    return found


# --- YADE ends as it should not -----------------------------------------------------------------------------------------------


@pytest.fixture
def fake_python(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Fake:
    """YADE's interpreter replaced by a shell script that passes the probe."""

    def fake(body: str, probe: str = "echo 0.0; exit 0") -> None:
        path = tmp_path / "python"
        path.write_text(f'#!/bin/sh\nif [ "$2" = -c ]; then {probe}; fi\n{body}\n')
        path.chmod(0o755)
        monkeypatch.setenv("CROSSCHECK_YADE_PYTHON", str(path))

    return fake


DEATHS = {
    "killed": ("kill -KILL $$", "SIGKILL"),
    "segmentation fault": ("kill -SEGV $$", "SIGSEGV"),
    "aborted": ("kill -ABRT $$", "SIGABRT"),
    "nameless signal": ("kill -35 $$", "signal 35"),
    "memory at an end": ("echo error: MemoryError: ; exit 1", "MemoryError"),
    "no result": ("exit 0", "without writing its result"),
    "no reason": ("exit 7", "exit code 7"),
    "broken reports": ("echo progress {; echo progress 3; echo 'progress [1'; exit 7", "exit code 7"),
    "a result that is none": ('echo nothing > "$5"; exit 0', "not a whole file"),
}


@pytest.mark.parametrize(("body", "word"), DEATHS.values(), ids=DEATHS)
def test_a_yade_that_dies_is_a_failed_tool_and_the_next_call_recovers(
    body: str,
    word: str,
    fake_python: Fake,
    plain_figures: None,
    undisturbed: Path,
    copy: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (copy / "two_pads" / "run.h5").unlink()
    fake_python(body)
    assert main(["run", "two_pads", "-o", str(copy)]) == TOOL
    said = capsys.readouterr().err
    assert said.count("YADE: failed") == 1 and word in said and "Traceback" not in said
    assert answer(copy)["yade"]["status"] == "failed" and answer(copy)["verdict"] == "inconclusive"
    shutil.copy(undisturbed / "two_pads" / "run.h5", copy / "two_pads")  # in the place of another run in YADE, which gives the same
    monkeypatch.delenv("CROSSCHECK_YADE_PYTHON")
    assert main(["run", "two_pads", "-o", str(copy), "-q"]) == 0
    assert answer(copy) == answer(undisturbed)


def test_a_yade_that_hangs_is_ended_from_outside(
    fake_python: Fake, tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(launch, "GRACE", 0.2)
    fake_python("exec sleep 600")
    assert main(["run", "two_pads", "-o", str(tmp_path / "out"), "--time-limit", "0.3"]) == TOOL
    assert "SIGKILL, 0.2 s after its limit of 0.3 s" in capsys.readouterr().err


def test_a_yade_without_memory_is_a_failed_tool(
    fake_python: Fake, tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    """The real one, with less address space than its libraries take."""
    fake_python(f'ulimit -v 300000; exec {launch.SYSTEM_PYTHON} "$@"')
    assert main(["run", "two_pads", "-o", str(tmp_path / "out")]) == TOOL
    assert capsys.readouterr().err.count("YADE: failed") == 1


def test_h5py_missing_in_yade_s_python_is_named_with_the_remedy(
    fake_python: Fake, tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "h5py.py").write_text('raise ModuleNotFoundError("no", name="h5py")')
    fake_python("", probe=f'PYTHONPATH={tmp_path} exec {launch.SYSTEM_PYTHON} "$@"')
    assert main(["run", "two_pads", "-o", str(tmp_path / "out")]) == TOOL
    said = capsys.readouterr().err
    assert "lacks h5py" in said and "apt-get install yade python3-h5py" in said and said.count("YADE: missing") == 1


OTHER_YADES = {
    "lacks what is used": ('version = "9999"', "YADE: failed", "cannot import name"),
    "has no version": ("", "YADE: missing", "version"),
    "does not load": ("1 / 0", "YADE: missing", "ZeroDivisionError"),
}


@pytest.mark.parametrize(("config", "state", "word"), OTHER_YADES.values(), ids=OTHER_YADES)
def test_another_yade_is_refused_in_words(
    config: str,
    state: str,
    word: str,
    tmp_path: Path,
    plain_figures: None,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    package = tmp_path / "modules" / "yade"
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "config.py").write_text(config)
    monkeypatch.setenv("CROSSCHECK_YADE", str(package.parent))
    assert main(["run", "two_pads", "-o", str(tmp_path / "out")]) == TOOL
    said = capsys.readouterr().err
    assert said.count(state) == 1 and word in said and "Traceback" not in said


def test_a_python_that_says_nothing_is_no_yade(
    fake_python: Fake, tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    fake_python("", probe="exit 0")
    assert main(["run", "two_pads", "-o", str(tmp_path / "out")]) == TOOL
    assert "does not say which YADE" in capsys.readouterr().err


def test_the_ladder_of_costs_without_yade_says_so(
    fake_python: Fake, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CROSSCHECK_YADE", str(tmp_path / "nowhere"))
    assert main(["cost", "two_pads", "-o", str(tmp_path / "out")]) == TOOL
    one_message(capsys.readouterr().err, "holds no YADE")


def killed_at(moment: float, out: Path, monkeypatch: pytest.MonkeyPatch) -> int:
    """Exit code of a run whose YADE gets SIGKILL so many seconds after its start."""

    class Killed(subprocess.Popen):  # type: ignore[type-arg]
        def __init__(self, arguments: Any, *args: Any, **options: Any) -> None:
            super().__init__(arguments, *args, **options)
            if any("run_case.py" in str(argument) for argument in arguments):
                timer = threading.Timer(moment, self.kill)
                timer.daemon = True
                timer.start()

    with monkeypatch.context() as patch:
        patch.setattr(launch.subprocess, "Popen", Killed)
        return main(["run", "two_pads", "-o", str(out), "-q"])


def kill_and_recover(moments: list[float], undisturbed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    failed = 0
    for k, moment in enumerate(moments):
        out = tmp_path / str(k)
        code = killed_at(moment, out, monkeypatch)
        found = answer(out)
        if code == TOOL:
            failed += 1
            assert found["yade"]["status"] == "failed" and "SIGKILL" in found["yade"]["message"]
            assert not (out / "two_pads" / "run.h5").exists()
            assert main(["run", "two_pads", "-o", str(out), "-q"]) == 0
        assert answer(out) == answer(undisturbed)
        assert not unfinished(out)
    assert failed > len(moments) / 3  # else it tested nothing


def test_a_yade_killed_at_some_moments_is_run_again(
    undisturbed: Path, plain_figures: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kill_and_recover([0.1, 0.35 * RUN_SECONDS, 0.5 * RUN_SECONDS], undisturbed, tmp_path, monkeypatch)


@pytest.mark.long
def test_a_yade_killed_at_any_moment_is_run_again(
    undisturbed: Path, plain_figures: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    chance = random.Random(20)
    kill_and_recover([chance.uniform(0.0, RUN_SECONDS) for _ in range(20)], undisturbed, tmp_path, monkeypatch)


def test_a_timeout_is_tried_again_with_more_time(undisturbed: Path, plain_figures: None, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert main(["run", "two_pads", "-o", str(out), "-q", "--time-limit", "0.01"]) == 4
    assert answer(out)["yade"]["status"] == "timeout"
    assert main(["run", "two_pads", "-o", str(out), "-q"]) == 0
    found, expected = answer(out), answer(undisturbed)
    assert found["yade"] == expected["yade"] and found["checks"] == expected["checks"]


# --- the program itself is interrupted or killed ------------------------------------------------------------------------------


def stopped_by(number: signal.Signals, out: Path, at: Callable[[], bool], delay: float = 0.0) -> tuple[int, str]:
    """Exit code and words of a run that gets a signal when something has happened, and YADE is gone with it."""
    with crosscheck("run", "two_pads", "-o", str(out)) as process:
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


@pytest.mark.parametrize(("stage", "delay"), [(begun, 0.0), (in_yade, 0.3)])
def test_an_interruption_ends_yade_and_the_next_call_goes_on(
    stage: Callable[[Path], Callable[[], bool]], delay: float, undisturbed: Path, plain_figures: None, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    code, said = stopped_by(signal.SIGINT, out, stage(out), delay)
    assert code == INTERRUPTED
    one_message(said, "stopped")
    assert not unfinished(out)
    assert main(["run", "two_pads", "-o", str(out), "-q"]) == 0
    assert answer(out) == answer(undisturbed)


def test_an_interruption_while_the_program_loads_ends_in_one_line(tmp_path: Path) -> None:
    """The moment is when its own entry point has taken over from Python."""
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


@pytest.mark.parametrize("number", [signal.SIGKILL, pytest.param(signal.SIGTERM, marks=pytest.mark.long)])
def test_yade_ends_with_the_program_that_started_it(number: signal.Signals, undisturbed: Path, plain_figures: None, tmp_path: Path) -> None:
    out = tmp_path / "out"
    code, said = stopped_by(number, out, in_yade(out), 0.4)
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


def failing_writes(monkeypatch: pytest.MonkeyPatch, error: BaseException) -> Iterator[int]:
    """Patches so that the first, second, ... file is written half and then fails; ends when a whole run writes fewer files."""
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
    assert files == 7  # scene, case, figure, comparison, three reports


def limited(size: int) -> Callable[[], None]:
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def test_a_disk_that_fills_up_is_named_with_the_file(tmp_path: Path) -> None:
    """No file may be larger than the limit, which is what a full disk does to whoever writes."""
    with crosscheck("run", "two_pads", "-o", str(tmp_path / "out"), preexec_fn=limited(100)) as process:
        _, said = process.communicate()
    assert process.returncode == TOOL
    one_message(said, "scene.toml: File too large")
    assert not unfinished(tmp_path)


def test_a_disk_that_fills_up_under_yade_is_named_with_the_file(undisturbed: Path, plain_figures: None, tmp_path: Path) -> None:
    """YADE's process inherits the limit, below which everything but its result fits."""
    case, run = ((undisturbed / "two_pads" / name).stat().st_size for name in ("case.h5", "run.h5"))
    assert case < run
    out = tmp_path / "out"
    with crosscheck("run", "two_pads", "-o", str(out), preexec_fn=limited(run - 1)) as process:
        _, said = process.communicate()
    assert process.returncode == TOOL and "Traceback" not in said
    assert said.count("YADE: failed") == 1 and "File too large" in said and "run.h5" in said
    assert not unfinished(out) and not (out / "two_pads" / "run.h5").exists()
    assert main(["run", "two_pads", "-o", str(out), "-q"]) == 0
    assert answer(out) == answer(undisturbed)


def test_a_full_disk_behind_standard_output_is_named() -> None:
    with Path("/dev/full").open("w") as full, crosscheck("solve", "two_pads", "--json", "-q", stdout=full) as process:
        _, said = process.communicate()
    assert process.returncode == TOOL
    one_message(said, "standard output: No space left on device")


def test_a_log_that_cannot_be_written_is_named(
    fake_python: Fake, tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fake_python("echo something; sleep 600")
    monkeypatch.setattr(launch, "_report", lambda line: (_ for _ in ()).throw(OSError(28, "No space left on device")))
    assert main(["run", "two_pads", "-o", str(tmp_path / "out"), "-q"]) == TOOL
    one_message(capsys.readouterr().err, "yade.log: No space left on device")
    assert not processes_about(tmp_path / "out")


def test_memory_at_an_end_is_no_fault_of_the_program(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def hungry(scene: Any, with_path: bool) -> None:
        raise MemoryError("Unable to allocate 1 TiB")

    monkeypatch.setattr("comparison.cli.analyse", hungry)
    assert main(["solve", "two_pads"]) == TOOL
    one_message(capsys.readouterr().err, "the memory does not suffice")


# --- folders that cannot be written -------------------------------------------------------------------------------------------


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


@pytest.mark.parametrize("command", [["show", "two_pads"], ["solve", "two_pads"], ["export", "two_pads"]])
def test_an_output_that_cannot_be_written_is_named(command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").touch()
    assert main([*command, "-q", "-o", str(tmp_path / "file" / "figure.png")]) == TOOL
    one_message(capsys.readouterr().err, str(tmp_path / "file"), "Not a directory")


# --- two at once --------------------------------------------------------------------------------------------------------------


def test_a_folder_in_use_is_refused_and_free_again_afterwards(copy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with alone_in(copy / "two_pads"):
        for command in (["run", "two_pads", "-o", str(copy), "-q"], ["report", str(copy), "-q"]):
            assert main(command) == TOOL
            one_message(capsys.readouterr().err, "another crosscheck works in this folder")
    assert main(["run", "two_pads", "-o", str(copy), "-q"]) == 0


def test_of_two_runs_in_one_folder_the_second_leaves_the_first_alone(undisturbed: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    with crosscheck("run", "two_pads", "-o", str(out)) as first:
        wait_for(lambda: (out / "two_pads" / LOCK).exists() and (out / "two_pads" / "case.h5").exists())
        assert main(["run", "two_pads", "-o", str(out), "-q"]) == TOOL
        _, said = first.communicate()
    assert first.returncode == 0, said
    assert answer(out) == answer(undisturbed)


def test_what_a_killed_process_was_writing_is_taken_away(copy: Path) -> None:
    (copy / "two_pads" / "case.h5.123.part").write_bytes(b"half")
    (copy / "two_pads" / "notes.part").write_bytes(b"the user's own")
    assert main(["run", "two_pads", "-o", str(copy), "-q"]) == 0
    assert [path.name for path in unfinished(copy)] == ["notes.part"]


# --- stored results that are broken -------------------------------------------------------------------------------------------

DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "cut short": lambda content: content[: len(content) // 2],
    "empty": lambda content: b"",
    "a flipped bit": lambda content: content[:-1000] + bytes([content[-1000] ^ 1]) + content[-999:],
    "foreign": lambda content: b"\x89HDF\r\n\x1a\n" + content[8:],
    "of the future": lambda content: content.replace(f"crosscheck {VERSION} ".encode(), f"crosscheck {VERSION + 7} ".encode()),
}


@pytest.mark.parametrize("name", ["case.h5", "run.h5"])
@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES)
def test_a_damaged_result_is_never_reported(
    name: str, damage: Callable[[bytes], bytes], copy: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = copy / "two_pads" / name
    path.write_bytes(damage(path.read_bytes()))
    assert main(["report", str(copy), "-q"]) == TOOL
    one_message(capsys.readouterr().err, str(path), "run it again")


@pytest.mark.parametrize("name", ["case.h5", "run.h5"])
def test_a_damaged_result_is_made_again(name: str, copy: Path, undisturbed: Path, plain_figures: None) -> None:
    path = copy / "two_pads" / name
    path.write_bytes(DAMAGES["a flipped bit"](path.read_bytes()))
    assert main(["run", "two_pads", "-o", str(copy), "-q"]) == 0
    assert answer(copy) == answer(undisturbed)


def test_a_run_of_another_scene_is_not_taken_for_this_one_s(copy: Path, undisturbed: Path, plain_figures: None, tmp_path: Path) -> None:
    """Same blocks and points, another density: only the digest of the inputs tells."""
    other = tmp_path / "two_pads.toml"
    other.write_text(find("two_pads").read_text().replace("density = 2200.0", "density = 1100.0"))
    assert main(["run", str(other), "-o", str(tmp_path / "other"), "-q"]) == 0
    shutil.copy(tmp_path / "other" / "two_pads" / "run.h5", copy / "two_pads")
    assert main(["run", "two_pads", "-o", str(copy), "-q"]) == 0
    assert answer(copy) == answer(undisturbed)


def _changed(content: bytes) -> bytes:
    stored = json.loads(content)
    stored["yade"]["reaction"] *= 1.5
    return json.dumps(stored).encode()


GARBAGE: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda content: b"",
    "cut short": lambda content: content[:-100],
    "not UTF-8": lambda content: b"\xff\xfe" + content,
    "not an object": lambda content: b"[]",
    "without end": lambda content: b"[" * 100_000,
    "the digest alone": lambda content: json.dumps({"inputs": json.loads(content)["inputs"]}).encode(),
    "a changed number": _changed,
}


@pytest.mark.parametrize("damage", GARBAGE.values(), ids=GARBAGE)
def test_a_comparison_that_is_garbage_is_made_again(
    damage: Callable[[bytes], bytes], copy: Path, undisturbed: Path, plain_figures: None
) -> None:
    path = copy / "two_pads" / "comparison.json"
    path.write_bytes(damage(path.read_bytes()))
    assert main(["run", "two_pads", "-o", str(copy), "-q"]) == 0
    assert answer(copy) == answer(undisturbed)
    path.write_bytes(damage(path.read_bytes()))
    assert main(["report", str(copy), "-q"]) == 0
    assert answer(copy)["yade"] == answer(undisturbed)["yade"] and answer(copy)["verdict"] == "agree"


def test_a_half_drawn_figure_is_never_left(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It would pass for a whole one, for a comparison that has not changed is not drawn again."""
    figure = copy / "two_pads" / "mechanisms.png"
    figure.unlink()
    original = Path.write_bytes
    monkeypatch.setattr(Path, "write_bytes", lambda path, content: original(path, content[:100]) and os.kill(os.getpid(), signal.SIGINT))
    assert main(["run", "two_pads", "-o", str(copy), "-q"]) == INTERRUPTED
    assert not figure.exists()
