"""However YADE ends, the command prints one clear message, has the right exit code and leaves nothing half done; the next call recovers."""

import random
import re
import shutil
import sys
import threading
import time
from collections.abc import Iterable
from pathlib import Path

import dying_yade
import pytest
from faulty_runs import TOOL, USAGE, Fake, answer, one_message, unfinished

from comparison.cli.commands import main
from comparison.settings import SYSTEM_PYTHON
from comparison.yade import installation, process
from la_core.scene import shipped

DEATHS = {
    "killed": ("kill -KILL $$", "SIGKILL"),
    "segmentation fault": ("kill -SEGV $$", "SIGSEGV"),
    "aborted": ("kill -ABRT $$", "SIGABRT"),
    "nameless signal": ("kill -35 $$", "signal 35"),
    "memory at an end": ("echo error: MemoryError: ; exit 1", "MemoryError"),
    "no result": ("exit 0", "without writing its result"),
    "no reason": ("exit 7", "exit code 7"),
    "broken reports": ("echo progress {; echo progress 3; echo 'progress [1'; exit 7", "exit code 7"),
    "reports of wrong values": (
        """echo 'progress {"fraction": "x"}'; echo 'progress {"seconds_left": 1e999}'; echo 'progress {"lacks": 5}'; exit 7""",
        "exit code 7",
    ),
    "a result that is none": ('echo nothing > "$5"; exit 0', "not a whole file"),
}


@pytest.mark.slow_after_first
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
    shutil.copy(undisturbed / "two_pads" / "run.h5", copy / "two_pads")  # replaces another run in YADE, which would give the same
    monkeypatch.delenv("CROSSCHECK_YADE_PYTHON")
    assert main(["run", "two_pads", "-o", str(copy), "-q"]) == 0
    assert answer(copy) == answer(undisturbed)


@pytest.mark.slow_after_first
@pytest.mark.yade
@pytest.mark.parametrize("command", ["run", "animate"])
def test_a_setting_that_this_structure_refuses_is_a_matter_of_the_scene(
    command: str, tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The advice is not `crosscheck doctor`, which would find no fault of YADE."""
    monkeypatch.setenv("CROSSCHECK_OUTPUT", str(tmp_path / "out"))
    scene = tmp_path / "two_pads.toml"
    scene.write_text(shipped.find("two_pads").read_text(encoding="utf-8") + "\n[yade]\ntime_step = 1e-3\n", encoding="utf-8")
    assert main([command, str(scene), "-q"]) == USAGE
    said = answer(tmp_path / "out")
    assert "time_step is 0.001 s; it must be at most" in said["reason"]
    assert "[yade]" in said["next_step"] and "doctor" not in said["next_step"]


def test_an_interpreter_that_is_not_there_is_named_with_its_setting_and_every_scene_is_told(
    tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CROSSCHECK_YADE_PYTHON", "/nowhere/python3")
    out = tmp_path / "out"
    assert main(["run", "two_pads", "two_blocks", "-o", str(out), "-q"]) == TOOL
    assert answer(out)["yade"]["status"] == "missing"
    assert "CROSSCHECK_YADE_PYTHON = /nowhere/python3 is no program; unset it" in answer(out)["reason"]
    assert "crosscheck doctor" in answer(out)["next_step"]
    assert "yade.log" not in answer(out)["next_step"] and not (out / "two_pads" / "yade.log").exists()
    assert "two_blocks" in (out / "report.md").read_text(encoding="utf-8")


@pytest.mark.yade
def test_a_yade_that_hangs_is_ended_from_outside(
    fake_python: Fake, tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(process, "GRACE", 0.2)
    fake_python("exec sleep 600")
    assert main(["run", "two_pads", "-o", str(tmp_path / "out"), "--time-limit", "0.3"]) == TOOL
    assert "SIGKILL, 0.2 s after its limit of 0.3 s" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.yade
def test_a_yade_that_hangs_while_it_loads_is_started_once_more(fake_python: Fake, copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, go = copy / "two_pads", copy / "go"
    (folder / "run.h5").unlink()
    fake_python(f'while [ ! -e "{go}" ]; do sleep 0.05; done; exec {SYSTEM_PYTHON} "$@"')
    limits = [process.LOADING]
    monkeypatch.setattr(process, "LOADING", 0.1)

    def started() -> None:
        if limits:
            process.LOADING = limits.pop()  # limit of the second start
        else:
            go.touch()

    process.run_yade(installation.locate_yade(), folder, "", 600.0, lambda report: None, started)
    assert (folder / "run.h5").exists()
    assert "YADE did not load within" in (folder / "yade.log").read_text(encoding="utf-8")


@pytest.mark.yade
def test_a_yade_whose_report_waits_to_be_read_does_not_hang(fake_python: Fake, copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Once Ctrl-Z stopped this program while YADE loaded. After `fg` it discarded the finished run and started another."""
    folder, starts = copy / "two_pads", []
    (folder / "run.h5").unlink()
    fake_python(f"echo 'progress {{}}'; exec {SYSTEM_PYTHON} \"$@\"")
    monkeypatch.setattr(process, "LOADING", 0.3)

    def started() -> None:
        starts.append("")
        time.sleep(0.8)  # no report is read

    process.run_yade(installation.locate_yade(), folder, "", 600.0, lambda report: None, started)
    assert len(starts) == 1 and (folder / "run.h5").exists()


def test_a_yade_that_hangs_at_every_start_is_a_failed_tool(
    fake_python: Fake, tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(process, "LOADING", 0.2)
    monkeypatch.setattr(process, "UNREAD", 0.1)
    fake_python("exec sleep 600")
    assert main(["run", "two_pads", "-o", str(tmp_path / "out")]) == TOOL
    one = capsys.readouterr().err
    assert "YADE: failed: YADE did not load within 0.2 s, 2 times; run the same command again" in one and "Traceback" not in one


@pytest.mark.yade
def test_a_yade_without_memory_is_a_failed_tool(
    fake_python: Fake, tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    """The real YADE has less address space than its libraries take."""
    fake_python(f'ulimit -v 300000; exec {SYSTEM_PYTHON} "$@"')
    assert main(["run", "two_pads", "-o", str(tmp_path / "out")]) == TOOL
    assert capsys.readouterr().err.count("YADE: failed") == 1


@pytest.mark.yade
def test_h5py_missing_in_yade_s_python_is_named_with_the_remedy(
    fake_python: Fake, tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "h5py.py").write_text('raise ModuleNotFoundError("no", name="h5py")')
    fake_python("", probe=f'PYTHONPATH={tmp_path} exec {SYSTEM_PYTHON} "$@"')
    assert main(["run", "two_pads", "-o", str(tmp_path / "out")]) == TOOL
    said = capsys.readouterr().err
    assert "lacks h5py" in said and "apt-get install yade python3-h5py" in said and said.count("YADE: missing") == 1


OTHER_YADES = {
    "lacks what is used": ('version = "9999"', "YADE: missing", "YADE 9999, which lacks names that crosscheck uses: Bo1_Box_Aabb"),
    "has no version": ("", "YADE: missing", "version"),
    "does not load": ("1 / 0", "YADE: missing", "ZeroDivisionError"),
}


@pytest.mark.slow_after_first
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


@pytest.mark.yade
def test_a_python_that_says_nothing_is_no_yade(
    fake_python: Fake, tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    fake_python("", probe="exit 0")
    assert main(["run", "two_pads", "-o", str(tmp_path / "out")]) == TOOL
    assert "does not say which YADE" in capsys.readouterr().err


@pytest.mark.yade
def test_a_python_that_says_rubbish_is_a_failed_tool(
    fake_python: Fake, tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    fake_python("exit 7", probe=r"printf '\377\376'; exit 0")
    assert main(["run", "two_pads", "-o", str(tmp_path / "out")]) == TOOL
    said = capsys.readouterr().err
    assert said.count("YADE: failed") == 1 and "exit code 7" in said


def test_a_program_that_the_system_cannot_start_is_no_yade(
    tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    program = tmp_path / "python"
    program.write_bytes(b"no program")
    program.chmod(0o755)
    monkeypatch.setenv("CROSSCHECK_YADE_PYTHON", str(program))
    assert main(["run", "two_pads", "two_blocks", "-o", str(tmp_path / "out")]) == TOOL
    said = capsys.readouterr().err
    assert said.count("YADE: missing") == 2 and "does not run" in said and "apt-get install" in said


def test_the_ladder_of_costs_without_yade_says_so(
    fake_python: Fake, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CROSSCHECK_YADE", str(tmp_path / "nowhere"))
    assert main(["cost", "two_pads", "-o", str(tmp_path / "out")]) == TOOL
    one_message(capsys.readouterr().err, "holds no YADE")


@pytest.fixture
def dying(fake_python: Fake) -> Fake:
    """YADE's interpreter replaced by one that dies at a given moment."""
    return lambda moment: fake_python(f'shift 2; exec {SYSTEM_PYTHON} -s -u {dying_yade.__file__} {moment} "$@"')


@pytest.fixture
def rows(dying: Fake, plain_figures: None, tmp_path: Path) -> int:
    """Number of rows of all attempts of a run together."""
    dying(dying_yade.NEVER)
    assert main(["run", "two_pads", "-o", str(tmp_path / "whole"), "-q"]) == 0
    return int((tmp_path / "whole" / "two_pads" / "rows").read_text())


def kill_and_recover(moments: Iterable[str], dying: Fake, undisturbed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for moment in moments:
        out = tmp_path / moment
        dying(moment)
        assert main(["run", "two_pads", "-o", str(out), "-q"]) == TOOL, moment
        found = answer(out)
        assert found["yade"]["status"] == "failed" and "SIGKILL" in found["yade"]["message"]
        assert not (out / "two_pads" / "run.h5").exists()
        assert (moment == dying_yade.WRITTEN) == bool(unfinished(out))  # only then was anything half written
        monkeypatch.delenv("CROSSCHECK_YADE_PYTHON")
        assert main(["run", "two_pads", "-o", str(out), "-q"]) == 0
        assert answer(out) == answer(undisturbed)
        assert not unfinished(out)


@pytest.mark.slow
def test_a_yade_killed_at_some_moments_is_run_again(
    rows: int, dying: Fake, undisturbed: Path, plain_figures: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    moments = [dying_yade.LOADED, "1", str(rows // 2), str(rows), dying_yade.WRITTEN]
    kill_and_recover(moments, dying, undisturbed, tmp_path, monkeypatch)


@pytest.mark.long
def test_a_yade_killed_at_any_moment_is_run_again(
    rows: int, dying: Fake, undisturbed: Path, plain_figures: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    moments = random.Random(20).sample(range(1, rows), 20)
    kill_and_recover(map(str, moments), dying, undisturbed, tmp_path, monkeypatch)


@pytest.mark.slow
def test_a_timeout_is_tried_again_with_more_time(undisturbed: Path, plain_figures: None, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert main(["run", "two_pads", "-o", str(out), "-q", "--time-limit", "0.01"]) == 4
    assert answer(out)["yade"]["status"] == "timeout"
    assert re.search(r"the time limit was reached at a settlement of [\d.e-]+ m\b", answer(out)["reason"])
    assert main(["run", "two_pads", "-o", str(out), "-q"]) == 0
    found, expected = answer(out), answer(undisturbed)
    assert found["yade"] == expected["yade"] and found["checks"] == expected["checks"]


def test_a_time_limit_beyond_what_a_timer_takes_is_no_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`--time-limit 1e10` once left the traceback of a thread on standard error, and nothing ended a YADE that hung."""
    scripts, waits = tmp_path / "scripts", []
    scripts.mkdir()
    (scripts / "run_case.py").write_text("import pathlib, sys\npathlib.Path(sys.argv[2]).touch()\n", encoding="utf-8")
    monkeypatch.setattr(process, "SCRIPTS", scripts)
    timer = threading.Timer
    monkeypatch.setattr(threading, "Timer", lambda seconds, *rest: waits.append(seconds) or timer(seconds, *rest))
    process.run_yade(installation.Installation(Path(sys.executable), tmp_path), tmp_path, "", 1e308, lambda report: None)
    assert (tmp_path / "run.h5").exists() and max(waits) == threading.TIMEOUT_MAX
