"""Scenes in worker processes side by side: the same answers, errors in words, and an end at once."""

import json
import os
import signal
from pathlib import Path

import pytest
from faulty_runs import INTERRUPTED, TOOL, crosscheck, dies, endless, one_message, unfinished, wait_for
from processes import is_gone, reached, tree

from comparison.cli.commands import main
from comparison.errors import WorkerLostError
from comparison.workflow import ATTEMPTS, WorkerProcesses

PAIR = ("two_pads", "slab_four_corners")


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


@pytest.mark.yade
def test_a_stop_ends_all_scenes_at_once_and_begins_no_other(tmp_path: Path) -> None:
    out, scenes = tmp_path / "out", [endless(tmp_path, name) for name in ("first", "second", "third")]
    with crosscheck("run", *map(str, scenes), "-o", str(out), "--workers", "2", start_new_session=True) as process:
        runs = [out / name / "yade.log" for name in ("first", "second")]
        wait_for(lambda: all(run.exists() for run in runs) or process.poll() is not None)
        family = tree(process.pid)
        assert reached(process.pid, signal.SIGINT) == {process.pid}  # it ends the others
        os.killpg(process.pid, signal.SIGINT)  # a terminal tells all of them
        _, said = process.communicate()
    assert process.returncode == INTERRUPTED
    one_message(said, "stopped")
    wait_for(lambda: all(is_gone(one) for one in family))
    assert {path.name for path in out.iterdir()} == {"first", "second"} and not unfinished(out)


def test_an_error_of_the_work_is_its_result_and_the_worker_goes_on() -> None:
    with WorkerProcesses(int, 1) as workers:
        for text in ("seven", "7"):
            workers.begin(text)
            assert workers.is_busy
            ((of, made),) = workers.ended()
            assert of == text and not workers.is_busy
            assert made == 7 if text == "7" else isinstance(made, ValueError)


def test_work_whose_workers_all_die_is_lost_in_words() -> None:
    with WorkerProcesses(dies, 1) as workers:
        workers.begin("work")
        ended = [workers.ended() for _ in range(ATTEMPTS)]
    assert ended[:-1] == [[]] * (ATTEMPTS - 1)
    ((of, made),) = ended[-1]
    assert of == "work" and isinstance(made, WorkerLostError) and f"ended with exit code 9, {ATTEMPTS} times" in str(made)


def test_a_scene_whose_workers_all_die_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("comparison.cli.scene_verbs.run._run_quietly", dies)
    assert main(["run", *PAIR, "-o", str(tmp_path / "out"), "--no-yade", "--workers", "2"]) == TOOL
    one_message(capsys.readouterr().err, "two_pads: its worker process ended with exit code 9", "fewer --workers")
