"""Worker processes on this machine. Each talks to the campaign over a pipe of its own: nothing listens.

Processes are spawned, not forked: a fork would copy locks that the threads of numerical libraries hold. A worker that dies is known by
the end of its pipe, and so is the job it had; the job is begun again by a new worker.
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
from comparison.yade import find_yade

ATTEMPTS = 3  # at a job whose worker dies: the system may have ended it for want of memory, which others held
GRACE = 3.0  # s that a worker gets to end YADE and leave nothing half written
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
_CONTEXT = multiprocessing.get_context("spawn")


class Local:
    """Jobs on worker processes of this machine, at most `capacity` at a time; ends them all on leaving."""

    def __init__(self, workers: int, yade: bool) -> None:
        self.capacity, self._yade = workers, yade
        self.name = f"this machine, {workers} workers"
        self._idle: list[_Worker] = []
        self._busy: list[_Worker] = []

    def __enter__(self) -> "Local":
        if self._yade:
            find_yade()  # else every case would fail for the want of it
        return self

    def __exit__(self, *error: object) -> None:
        every = [*self._idle, *self._busy]
        for worker in every:
            worker.process.terminate()
        deadline = time.monotonic() + GRACE
        for worker in every:
            worker.process.join(max(0.0, deadline - time.monotonic()))
            worker.process.kill()  # YADE ends with it
            worker.process.join()

    def begin(self, job: Job) -> None:
        """Hand a job to a worker."""
        worker = self._idle.pop() if self._idle else _Worker()
        self._busy.append(worker)
        worker.begin(job, 1)

    def ended(self, seconds: float) -> list[tuple[Job, JobOutcome]]:
        """Jobs that ended, with what they came to, once there is one or after so many seconds."""
        found: list[tuple[Job, JobOutcome]] = []
        ready = wait([worker.pipe for worker in self._busy], seconds)
        for worker in [worker for worker in self._busy if worker.pipe in ready]:
            self._busy.remove(worker)
            job = worker.job
            assert job is not None  # it is busy
            try:
                found.append((job, worker.pipe.recv()))
                self._idle.append(worker)
            except (EOFError, OSError):
                worker.process.join()
                if worker.attempt < ATTEMPTS:
                    other = _Worker()
                    self._busy.append(other)
                    other.begin(job, worker.attempt + 1)
                else:
                    how = _how_ended(worker.process.exitcode)
                    found.append((job, failure(f"its worker {how}, {ATTEMPTS} times; run the campaign again", job)))
        return found


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
        with contextlib.suppress(OSError):  # a worker that is gone is found by the end of its pipe
            self.pipe.send(job)


@contextlib.contextmanager
def _environment(variables: dict[str, str]) -> Iterator[None]:
    """What a process started here finds in its environment besides: libraries read it when they are loaded."""
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
    """A process started here never sees Ctrl-C, which a terminal sends to all: the campaign hears it, and ends its workers."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _how_ended(code: int | None) -> str:
    if code is not None and code < 0:
        return f"was ended by {signal.Signals(-code).name if -code in set(signal.Signals) else f'signal {-code}'}"
    return f"ended with exit code {code}"


class _Quiet:
    """A listener that keeps what it hears to itself."""

    def stage(self, scene: str, stage: str, state: str) -> None:
        pass

    def progress(self, scene: str, report: dict[str, Any]) -> None:
        pass


def _serve(pipe: Connection) -> None:
    """A worker's life: job after job, until the campaign ends it, or is gone."""
    is_working = False

    def stop(number: int, frame: FrameType | None) -> None:
        if not is_working:
            os._exit(0)
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
    """End this process with the one that started it, however that ends: nobody is left to hear of its work."""
    campaign = multiprocessing.parent_process()
    if campaign is not None:
        campaign.join()
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(GRACE)
    os._exit(1)  # it is in a library that does not look
