"""Worker processes on this machine. Each talks to the campaign over its own pipe; no network port is open.

Processes are spawned, not forked: a fork would copy locks that the threads of numerical libraries hold. When a worker dies, its pipe
ends; a new worker then repeats its job.
"""

import contextlib
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Iterator
from multiprocessing.connection import Connection, wait
from types import FrameType
from typing import Any

from comparison.campaign.job import Job, JobOutcome, StoppedError, failure, run_job
from comparison.numbers import plural
from comparison.yade import find_yade
from la_core.analysis import Silent

ATTEMPTS = 3  # at a job whose worker dies: the system may have killed it because other processes used up the memory
GRACE = 3.0  # s for a worker to end YADE and finish its files
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
_CONTEXT = multiprocessing.get_context("spawn")


class Local:
    """Jobs on worker processes of this machine, at most `capacity` at a time; leaving the context ends all processes."""

    def __init__(self, workers: int, yade: bool) -> None:
        self.capacity, self._yade = workers, yade
        self.name = f"this machine, {plural(workers, 'worker')}"
        self._idle: list[_Worker] = []
        self._busy: list[_Worker] = []

    def __enter__(self) -> "Local":
        if self._yade:
            find_yade()  # without YADE every case would fail
        return self

    def __exit__(self, *error: object) -> None:
        workers = [*self._idle, *self._busy]
        for worker in workers:
            worker.process.terminate()
        deadline = time.monotonic() + GRACE
        for worker in workers:
            worker.process.join(max(0.0, deadline - time.monotonic()))
            worker.process.kill()  # YADE ends with it
            worker.process.join()

    def begin(self, job: Job) -> None:
        """Hand a job to a worker."""
        worker = self._idle.pop() if self._idle else _Worker()
        self._busy.append(worker)
        worker.begin(job, 1)

    def ended(self, seconds: float) -> list[tuple[Job, JobOutcome]]:
        """Return jobs that ended, with their outcomes; waits at most `seconds` for the first one."""
        outcomes: list[tuple[Job, JobOutcome]] = []
        ready = wait([worker.pipe for worker in self._busy], seconds)
        for worker in [worker for worker in self._busy if worker.pipe in ready]:
            self._busy.remove(worker)
            job = worker.job
            assert job is not None  # it is busy
            try:
                outcomes.append((job, worker.pipe.recv()))
                self._idle.append(worker)
            except (EOFError, OSError):
                worker.process.join()
                if worker.attempt < ATTEMPTS:
                    other = _Worker()
                    self._busy.append(other)
                    other.begin(job, worker.attempt + 1)
                else:
                    how = _how_ended(worker.process.exitcode)
                    outcomes.append((job, failure(f"its worker {how}, {ATTEMPTS} times; run the campaign again", job)))
        return outcomes


class _Worker:
    """A worker process, its pipe, and the job it has."""

    def __init__(self) -> None:
        self.pipe, theirs = _CONTEXT.Pipe()
        self.process = _CONTEXT.Process(target=_serve, args=(theirs,), daemon=True)
        self.job: Job | None = None
        self.attempt = 0
        with _environment(ONE_THREAD), _interruptions_held():
            self.process.start()
        theirs.close()

    def begin(self, job: Job, attempt: int) -> None:
        self.job, self.attempt = job, attempt
        with contextlib.suppress(OSError):  # `ended` notices a dead worker by the end of its pipe
            self.pipe.send(job)


@contextlib.contextmanager
def _environment(variables: dict[str, str]) -> Iterator[None]:
    """Add variables to the environment of processes started here; libraries read them when they are loaded."""
    before = {name: os.environ.get(name) for name in variables}
    os.environ.update(variables)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextlib.contextmanager
def _interruptions_held() -> Iterator[None]:
    """Block Ctrl-C in processes started here: only the campaign's process handles it, and ends its workers."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _how_ended(code: int | None) -> str:
    if code is not None and code < 0:
        return f"was ended by {signal.Signals(-code).name if -code in set(signal.Signals) else f'signal {-code}'}"
    return f"ended with exit code {code}"


class _Quiet(Silent):
    """A listener of all stages that reports nothing."""

    def stage(self, scene: str, stage: str, state: str) -> None:
        pass

    def progress(self, scene: str, report: dict[str, Any]) -> None:
        pass


def _serve(pipe: Connection) -> None:
    """Run jobs in a worker process until the campaign ends."""
    is_working = False

    def stop(number: int, frame: FrameType | None) -> None:
        if not is_working:
            os._exit(0)
        signal.signal(signal.SIGTERM, signal.SIG_IGN)  # one stop is enough: a second one must not interrupt the cleaning up
        raise StoppedError

    signal.signal(signal.SIGTERM, stop)
    threading.Thread(target=_end_with_campaign, daemon=True).start()
    with contextlib.suppress(EOFError, OSError, StoppedError):
        while True:
            job = pipe.recv()
            is_working = True
            outcome = run_job(job, _Quiet())
            is_working = False
            pipe.send(outcome)


def _end_with_campaign() -> None:
    """End this process when the campaign's process ends, for whatever reason."""
    campaign = multiprocessing.parent_process()
    if campaign is not None:
        campaign.join()
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(GRACE)
    os._exit(1)  # a library did not react to the signal
