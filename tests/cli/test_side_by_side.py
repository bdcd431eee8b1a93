"""Scenes in parallel worker processes have the same answers, report errors in words, and end at once."""

import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from faulty_runs import (
    INTERRUPTED,
    PATIENCE,
    ROOT,
    TOOL,
    crosscheck,
    dies,
    endless,
    fails_unreadably,
    one_message,
    refuses,
    stops_while_an_object_ends,
    unfinished,
    wait_for,
)
from processes import is_gone, reached, tree

from comparison.cli.commands import main
from comparison.errors import WorkerLostError
from comparison.workflow import ATTEMPTS, WorkerProcesses, worker_processes
from la_core.errors import SceneError
from la_core.scene.shipped import find

USAGE = 2
PAIR = ("two_pads", "slab_four_corners")


@pytest.mark.slow
def test_scenes_side_by_side_give_what_they_give_in_turn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    results = []
    for workers, name in (("2", "beside"), ("1", "in_turn")):
        words = ["run", *PAIR, "-o", str(tmp_path / name), "--no-yade", "--json", "--workers", workers]
        assert main(words) == 0
        results.append(json.loads(capsys.readouterr().out)["comparisons"])
    beside, in_turn = results
    assert [scene["scene"] for scene in beside] == [scene["scene"] for scene in in_turn] == list(PAIR)
    for one, other in zip(beside, in_turn, strict=True):
        assert one["limit_analysis"]["associated"]["reaction"] == other["limit_analysis"]["associated"]["reaction"]


@pytest.mark.slow
@pytest.mark.yade
def test_a_stop_ends_all_scenes_at_once_and_begins_no_other(tmp_path: Path) -> None:
    out, scenes = tmp_path / "out", [endless(tmp_path, name) for name in ("first", "second", "third")]
    with crosscheck("run", *map(str, scenes), "-o", str(out), "--workers", "2", start_new_session=True) as process:
        runs = [out / name / "yade.log" for name in ("first", "second")]
        wait_for(lambda: all(run.exists() for run in runs) or process.poll() is not None)
        family = tree(process.pid)
        assert reached(process.pid, signal.SIGINT) == {process.pid}  # the program itself ends the others
        os.killpg(process.pid, signal.SIGINT)  # a terminal sends it to all of them
        _, said = process.communicate()
    assert process.returncode == INTERRUPTED
    one_message(said, "stopped")
    wait_for(lambda: all(is_gone(one) for one in family))
    assert {path.name for path in out.iterdir()} == {"first", "second"} and not unfinished(out)


def made_by(function: Callable[[Any], Any], *pieces: Any) -> list[Any]:
    """Return the results of a worker for pieces of work, one after another."""
    made = []
    with WorkerProcesses(function, 1) as workers:
        for work in pieces:
            workers.begin(work)
            assert workers.is_busy
            ((of, result),) = workers.ended(PATIENCE)
            assert of == work and not workers.is_busy
            made.append(result)
        assert workers.ended() == []  # nothing is under way
    return made


def test_an_error_of_the_work_is_its_result_and_the_worker_goes_on() -> None:
    wrong, right = made_by(int, "seven", "7")
    assert isinstance(wrong, ValueError) and "seven" in str(wrong)
    assert right == 7


def test_an_error_in_a_scene_comes_out_of_its_worker_whole() -> None:
    (error,) = made_by(refuses, "this")
    assert isinstance(error, SceneError) and str(error) == "here = 'this': must be otherwise; change it"
    assert (error.where, error.blocks, error.spots) == ("here", ("stone",), ((0.0, 1.0, 2.0),))


def test_an_error_that_cannot_come_out_of_its_worker_is_told() -> None:
    (error,) = made_by(fails_unreadably, "one")
    assert isinstance(error, RuntimeError) and str(error) == "UnreadableError: one and another"


@pytest.mark.slow_after_first
@pytest.mark.parametrize("workers", ["1", "2"])
def test_an_error_found_during_a_run_is_said_alike_and_earlier_scenes_keep_their_report(
    workers: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shipped, out, own = find("rubble_wall"), tmp_path / "out", tmp_path / "own"
    (own / "sub").mkdir(parents=True)
    shutil.copy(shipped.with_suffix(".obj"), own / "sub")
    (own / "rubble.toml").write_text(shipped.read_text(encoding="utf-8").replace('"rubble_wall.obj"', '"sub/rubble_wall.obj"'))
    (tmp_path / "elsewhere").mkdir()
    (out / "rubble").mkdir(parents=True)
    (out / "rubble" / "sub").symlink_to(tmp_path / "elsewhere")
    assert main(["run", "two_pads", str(own / "rubble.toml"), "-o", str(out), "--no-yade", "--workers", workers, "-q"]) == USAGE
    one_message(capsys.readouterr().err, "through a link; remove the link")
    assert "two_pads" in (out / "report.md").read_text(encoding="utf-8")


def test_a_stop_that_comes_while_an_object_ends_is_no_traceback_and_stops_the_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(worker_processes, "GRACE", PATIENCE)
    with WorkerProcesses(stops_while_an_object_ends, 1) as workers:
        workers.begin(tmp_path)
        wait_for((tmp_path / "begun").exists)
    assert (tmp_path / "finished").exists()
    assert capfd.readouterr().err == ""


@pytest.mark.slow
def test_work_whose_workers_all_die_is_lost_in_words() -> None:
    with WorkerProcesses(dies, 1) as workers:
        workers.begin("work")
        ended = [workers.ended(PATIENCE) for _ in range(ATTEMPTS)]
    assert ended[:-1] == [[]] * (ATTEMPTS - 1)
    ((of, made),) = ended[-1]
    assert of == "work" and isinstance(made, WorkerLostError) and f"ended with exit code 9, {ATTEMPTS} times; its own message" in str(made)


def test_a_worker_that_dies_while_it_waits_is_replaced_although_a_broken_pipe_ends_the_program() -> None:
    before = signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # as the command line sets it
    try:
        with WorkerProcesses(int, 1) as workers:
            workers.begin("7")
            assert workers.ended(PATIENCE) == [("7", 7)]
            (idle,) = workers._idle
            idle.process.kill()
            idle.process.join()
            workers.begin("8")
            assert workers.ended(PATIENCE) == []
            assert workers.ended(PATIENCE) == [("8", 8)]
        assert signal.getsignal(signal.SIGPIPE) is signal.SIG_DFL
        assert signal.SIGPIPE not in signal.pthread_sigmask(signal.SIG_BLOCK, ())
    finally:
        signal.signal(signal.SIGPIPE, before)


@pytest.mark.slow
def test_a_scene_whose_workers_all_die_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("comparison.cli.scene_verbs.run._run_quietly", dies)
    assert main(["run", *PAIR, "-o", str(tmp_path / "out"), "--no-yade", "--workers", "2"]) == TOOL
    one_message(capsys.readouterr().err, "two_pads: its worker process ended with exit code 9", "fewer --workers")


STOPPED_AT_A_START = """
import os, signal, sys
from multiprocessing import util
from comparison.workflow import WorkerProcesses
starts = util.spawnv_passfds
def told(*arguments):
    number = starts(*arguments)
    os.kill(os.getpid(), signal.SIGTERM)  # before the worker has what it needs to start
    return number
signal.signal(signal.SIGTERM, signal.default_int_handler)
try:
    with WorkerProcesses(abs, 1) as workers:
        from multiprocessing import resource_tracker
        resource_tracker.ensure_running()
        util.spawnv_passfds = told
        workers.begin(1)
except KeyboardInterrupt:
    sys.exit(130)
"""


def test_a_sigterm_while_a_worker_starts_waits_until_it_has_started() -> None:
    """A campaign that a batch scheduler ended at that moment once left the traceback of a worker: EOFError: Ran out of input."""
    ended = subprocess.run([sys.executable, "-c", STOPPED_AT_A_START], cwd=ROOT, capture_output=True, text=True, check=False)
    assert ended.returncode == INTERRUPTED and ended.stderr == ""
