"""The table of a campaign is the same, to the byte, whichever workers run its cases and whichever process ends in the middle."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from campaigns import QUICK, Inline, begun, campaign, finished, run
from faulty_runs import INTERRUPTED, PATIENCE, ROOT, TOOL, crosscheck, held_yade, one_message, processes_about, unfinished, wait_for
from processes import is_gone, listening, reached, tree

from comparison.campaign.job import LOADED, Job
from comparison.campaign.workers.dask import Dask
from comparison.campaign.workers.local import Local
from comparison.cli.commands import main
from comparison.workflow import ATTEMPTS

WORKERS = 4
FEW = """
yade = false
[[sweep]]
scene = "two_blocks"
vary = { "joint.friction" = [0.3, 0.6] }
"""
WITH_YADE = """
[[sweep]]
scene = "two_pads"
vary = { "joint.friction" = [0.3, 0.4, 0.5] }
"""
LARGE = """
title = "More than sixty cases with YADE"

[[sweep]]
scene = "two_pads"
[sweep.vary]
"joint.friction" = [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8]
[[sweep.together]]
"block[0].box.to[0]" = [0.3, 0.35, 0.4, 0.45]
"block[1].box.from[0]" = [0.4, 0.45, 0.5, 0.55]

[[sweep]]
scene = "arch_spreading"
[sweep.vary]
"arch[0].thickness" = [0.26, 0.28, 0.3, 0.32, 0.34]
"arch[0].voussoirs" = [9, 11, 13]
"joint.friction" = [0.6, 0.7]

[[sweep]]
scene = "two_blocks"
[sweep.vary]
"joint.friction" = [0.3, 0.45, 0.6]
"""


@contextlib.contextmanager
def cluster(workers: int) -> Iterator[str]:
    """Yield the address of a Dask scheduler with this number of worker processes."""
    command = [sys.executable, str(ROOT / "tests" / "helpers" / "dask_cluster.py"), str(workers)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
    with subprocess.Popen(command, env=environment, cwd=ROOT, text=True, **pipes) as process:  # type: ignore[call-overload]
        try:
            yield process.stdout.readline().strip()
            process.stdin.close()
            process.wait(PATIENCE)
        finally:
            process.kill()


class LosesLocal(Local):
    """Workers on this machine, one of which is killed in the middle of the first case."""

    def begin(self, job: Job) -> None:
        super().begin(job)
        if not hasattr(self, "lost"):
            self.lost = self._processes._busy[0].process.pid
            threading.Thread(target=kill_when_begun, args=(self.lost, job), daemon=True).start()


class LosesDask(Dask):
    """Workers of a scheduler, one of which is killed in the middle of the first case."""

    def begin(self, job: Job) -> None:
        super().begin(job)
        if not hasattr(self, "lost"):
            wait_for(lambda: any(self._client.processing().values()))
            (worker,) = [worker for worker, keys in self._client.processing().items() if keys]
            self.lost = self._client.run(os.getpid, workers=[worker])[worker]
            threading.Thread(target=kill_when_begun, args=(self.lost, job), daemon=True).start()


def kill_when_begun(process: int, job: Job) -> None:
    wait_for((job.folder / ".lock").exists)
    os.kill(process, signal.SIGKILL)


@pytest.mark.slow
@pytest.mark.parametrize("workers", [pytest.param(1, marks=pytest.mark.long), 2])
def test_workers_of_this_machine_one_of_them_lost_give_the_table_of_this_process(workers: int, tmp_path: Path, plain_figures: None) -> None:
    run(FEW, tmp_path / "inline" / "out")
    engine = LosesLocal(workers, yade=False)
    run(FEW, tmp_path / "local" / "out", engine)
    assert is_gone(engine.lost) and not unfinished(tmp_path)
    assert (tmp_path / "local" / "out" / "results.csv").read_bytes() == (tmp_path / "inline" / "out" / "results.csv").read_bytes()


@pytest.mark.slow
def test_workers_of_a_scheduler_one_of_them_lost_give_the_table_of_this_process(tmp_path: Path, plain_figures: None) -> None:
    run(QUICK, tmp_path / "inline" / "out")
    with cluster(WORKERS) as address:
        engine = LosesDask(address, tmp_path / "dask" / "out")
        run(QUICK, tmp_path / "dask" / "out", engine)
    assert is_gone(engine.lost) and not unfinished(tmp_path)
    assert (tmp_path / "dask" / "out" / "results.csv").read_bytes() == (tmp_path / "inline" / "out" / "results.csv").read_bytes()


def test_a_case_whose_workers_all_die_is_a_failure_and_the_others_go_on(tmp_path: Path) -> None:
    (job, *_) = [Job(case.run.scene(), tmp_path / case.run.name, False, {}, "", LOADED) for case in campaign(QUICK, tmp_path / "out").cases]
    with Local(1, yade=False) as engine:
        engine.begin(job)
        ended: list[Any] = []
        for _ in range(ATTEMPTS):
            assert not ended
            engine._processes._busy[0].process.kill()
            ended = engine.ended(PATIENCE)
    ((of, outcome),) = ended
    assert of is job and outcome["state"] == "failed" and "was ended by SIGKILL" in outcome["answers"]["reason"]


@pytest.mark.yade
@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGINT, INTERRUPTED), pytest.param(signal.SIGKILL, -signal.SIGKILL, marks=pytest.mark.long)]
)
def test_a_stop_ends_workers_and_yade_at_once_and_the_next_call_goes_on(
    number: signal.Signals, code: int, tmp_path: Path, plain_figures: None
) -> None:
    out, path = tmp_path / "out", tmp_path / "campaign.toml"
    path.write_text(WITH_YADE, encoding="utf-8")
    environment, _ = held_yade(tmp_path, after=1)  # the second case waits for the stop, however long that takes
    with crosscheck("campaign", str(path), "-o", str(out), "--workers", "1", start_new_session=True, env=environment) as process:
        wait_for(lambda: (len(finished(out)) >= 1 and bool(processes_about(out / "cases"))) or process.poll() is not None)
        family = tree(process.pid)
        assert len(family) >= 3  # the campaign, a worker, YADE
        assert not listening(family)
        assert reached(process.pid, signal.SIGINT) == {process.pid}  # the campaign itself ends the others
        os.killpg(process.pid, number) if number is signal.SIGINT else process.kill()  # a terminal sends it to all of them
        _, said = process.communicate()
    assert process.returncode == code
    wait_for(lambda: all(is_gone(one) for one in family))
    before = finished(out)
    assert 1 <= len(before) < len(campaign(WITH_YADE, out).cases)
    if number is signal.SIGINT:
        one_message(said, "stopped")
        assert not unfinished(out)
        assert len((out / "results.csv").read_text(encoding="utf-8").splitlines()) == 1 + len(before)
    engine = Inline()
    found = run(WITH_YADE, out, engine)
    assert [row["state"] for row in found.rows] == ["done"] * 3
    assert not set(engine.done) & set(before) and {name: finished(out)[name] for name in before} == before


@pytest.mark.slow
def test_a_scheduler_that_is_not_there_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("comparison.campaign.workers.dask.PATIENCE", 0.5)
    path = tmp_path / "campaign.toml"
    path.write_text(QUICK, encoding="utf-8")
    for address, code in (("tcp://127.0.0.1:9", 3), ("nonsense://x:1", 3), ("foo", 2), ("tcp://host", 2)):
        assert main(["campaign", str(path), "-o", str(tmp_path / "out"), "--scheduler", address, "-q"]) == code
        one_message(capsys.readouterr().err, address, *(["must be an address with a port"] if code == 2 else []))
    assert begun(tmp_path / "out") == []


@pytest.mark.slow
def test_a_scheduler_that_goes_away_does_not_end_the_program_by_a_broken_pipe(tmp_path: Path) -> None:
    before = signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # as the command line sets it
    try:
        with cluster(1) as address, Dask(address, tmp_path):
            assert signal.getsignal(signal.SIGPIPE) is signal.SIG_IGN
        assert signal.getsignal(signal.SIGPIPE) is signal.SIG_DFL
    finally:
        signal.signal(signal.SIGPIPE, before)


@pytest.mark.yade
@pytest.mark.long
def test_a_scheduler_that_goes_away_in_in_the_middle_is_told_and_the_next_call_goes_on(tmp_path: Path, plain_figures: None) -> None:
    out, path = tmp_path / "out", tmp_path / "campaign.toml"
    path.write_text(WITH_YADE, encoding="utf-8")
    with cluster(1) as address:
        process = crosscheck("campaign", str(path), "-o", str(out), "--scheduler", address)
        wait_for(lambda: len(finished(out)) >= 1 or process.poll() is not None, 600.0)
    with process:
        _, said = process.communicate()
    assert process.returncode == TOOL
    one_message(said, "the Dask scheduler is gone")
    assert [row["state"] for row in run(WITH_YADE, out).rows] == ["done"] * 3


def test_a_finished_campaign_keeps_the_name_of_the_workers_that_ran_it(tmp_path: Path, plain_figures: None) -> None:
    out = tmp_path / "out"
    first = run(QUICK, out, Inline()).provenance["engine"]
    assert run(QUICK, out, Dask("tcp://nobody:1", out)).provenance["engine"] == first != "Dask"


def test_a_missing_extra_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "campaign.toml"
    path.write_text(QUICK, encoding="utf-8")
    command = ["campaign", str(path), "-o", str(tmp_path / "out"), "-q"]
    for extra, module, option in (("dask", "distributed", ["--scheduler", "x"]), ("parquet", "pyarrow", ["--parquet"])):
        monkeypatch.setitem(sys.modules, module, None)
        assert main([*command, *option]) == 2
        one_message(capsys.readouterr().err, f'extra "{extra}"')


def test_a_missing_yade_is_told_once_and_before_anything_runs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CROSSCHECK_YADE", str(tmp_path / "nowhere"))
    path = tmp_path / "campaign.toml"
    path.write_text(WITH_YADE, encoding="utf-8")
    assert main(["campaign", str(path), "-o", str(tmp_path / "out"), "-q"]) == 3
    one_message(capsys.readouterr().err, "holds no YADE")
    assert begun(tmp_path / "out") == []


# --- sixty cases and more, with YADE ------------------------------------------------------------------------------------------


@pytest.mark.yade
@pytest.mark.long
def test_a_large_campaign_stopped_and_robbed_of_workers_is_the_same_on_this_machine_and_on_a_cluster(tmp_path: Path) -> None:
    whole = tmp_path / "local" / "out"
    run(LARGE, whole, LosesLocal(2, yade=True))
    expected = (whole / "results.csv").read_bytes()
    assert expected.count(b"\n") > 60 and expected.count(b",done,agree,") > 60
    out, path = tmp_path / "dask" / "out", tmp_path / "dask" / "campaign.toml"
    path.parent.mkdir()
    path.write_text(LARGE, encoding="utf-8")
    with cluster(WORKERS) as address:
        with crosscheck("campaign", str(path), "-o", str(out), "--scheduler", address) as process:
            wait_for(lambda: len(finished(out)) >= 10, 600.0)
            process.send_signal(signal.SIGINT)
            _, said = process.communicate()
        one_message(said, "stopped")
        before = finished(out)
        run(LARGE, out, LosesDask(address, out))
    assert (out / "results.csv").read_bytes() == expected
    assert {name: finished(out)[name] for name in before} == before
