"""Jobs on an existing Dask scheduler, whose workers share the campaign's folder with this process.

Workers write results directly, so the folder must be on a file system that all workers see under the same path. This is checked before
the first job, and again by each job. The campaign's process holds the lock of the folder and keeps a token in it; a job stops when
either is gone.
"""

import contextlib
import errno
import fcntl
import logging
import os
import queue
import re
import signal
import threading
import uuid
from pathlib import Path
from typing import Any

from comparison.campaign.job import LOADED, Job, JobOutcome, failure, run_job
from comparison.errors import message_of
from comparison.numbers import plural
from comparison.run_folder import LOCK, write_text
from comparison.workflow import StoppedError
from la_core.analysis import LimitAnalysis
from la_core.coulomb import PathProgress
from la_core.errors import SceneError, extra_hint

CALL = ".call"  # token of the process that runs the campaign
PATIENCE = 10.0  # s to wait for the scheduler, and for a first worker


class Dask:
    """Jobs on the workers of a Dask scheduler, one per worker at a time; the scheduler repeats a lost worker's job on another one."""

    def __init__(self, address: str, folder: Path) -> None:
        self._address, self._folder, self._token = address, folder, uuid.uuid4().hex
        self._jobs: dict[Any, Job] = {}
        self._done: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._client: Any = None
        self._on_broken_pipe: Any = None
        self.name, self.capacity = "Dask", 1

    def __enter__(self) -> "Dask":
        try:
            import distributed  # noqa: PLC0415 - an extra
        except ImportError as error:
            raise SceneError(
                "--scheduler", "needs the package distributed, which is not installed", hint=extra_hint("dask", "distributed")
            ) from error
        if not re.search(r":\d+/?$", self._address):  # the client would fail, and try to close itself for 20 s
            raise SceneError("--scheduler", "must be an address with a port, such as tcp://host:8786", value=self._address)
        for name in [name for name in logging.root.manager.loggerDict if name.startswith("distributed")]:
            logging.getLogger(name).setLevel(logging.CRITICAL)  # this class reports the errors itself
        if threading.current_thread() is threading.main_thread():  # Python sets handlers of signals in no other thread
            self._on_broken_pipe = signal.signal(signal.SIGPIPE, signal.SIG_IGN)  # it would end this process when the scheduler goes away
        try:
            try:
                self._client = distributed.Client(self._address, timeout=PATIENCE, set_as_default=False)
            except (OSError, ValueError) as error:
                raise OSError(errno.EHOSTUNREACH, f"no Dask scheduler answers there ({error})", self._address) from error
            write_text(self._folder / CALL, self._token)
            self._look_at_workers()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *error: object) -> None:
        (self._folder / CALL).unlink(missing_ok=True)
        try:
            if self._client is not None:
                self._client.cancel(list(self._jobs))
                self._client.close(timeout=PATIENCE)
        finally:
            if self._on_broken_pipe is not None:
                signal.signal(signal.SIGPIPE, self._on_broken_pipe)

    def _look_at_workers(self) -> None:
        """Check that there are workers and that each sees the folder, has this code, and has one thread."""
        try:
            self._client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError as error:
            hint = f"start some: dask worker {self._address} --nthreads 1"
            raise OSError(errno.EHOSTUNREACH, f"the scheduler has no workers; {hint}", self._address) from error
        threads = self._client.nthreads()
        for worker, seen in self._client.run(_look, self._folder).items():
            if seen["token"] != self._token:
                rule = f"does not see the campaign's folder {self._folder}; choose one with -o that all workers share under one path"
            elif seen["code"] != LOADED:
                rule = "has another version of this program or of its packages; install the same there"
            elif threads.get(worker, 1) != 1 or seen["threads"] != "1":
                rule = "has several threads; start workers with `dask worker ADDRESS --nthreads 1 --nworkers N`, with OMP_NUM_THREADS=1"
            else:
                continue
            raise SceneError("--scheduler", f"the worker {worker} {rule}")
        self.capacity = sum(threads.values())
        self.name = f"Dask, {plural(self.capacity, 'worker')}"

    def begin(self, job: Job) -> None:
        """Hand a job to the scheduler."""
        key = f"crosscheck-{self._token}-{job.folder.name}"
        future = self._client.submit(_work, job, self._folder, self._token, key=key, pure=False)
        self._jobs[future] = job
        future.add_done_callback(self._done.put)

    def ended(self, seconds: float) -> list[tuple[Job, JobOutcome]]:
        """Return jobs that ended, with their outcomes; waits at most `seconds`. Raises OSError without a scheduler."""
        outcomes = []
        with contextlib.suppress(queue.Empty):
            future = self._done.get(timeout=seconds)
            job = self._jobs[future]
            try:
                outcomes.append((job, future.result()))
            except Exception as error:  # an error in the worker, or the loss of the worker
                self._require_scheduler()
                outcomes.append((job, failure(_reason(error), job)))
            del self._jobs[future]
        self._require_scheduler()
        return outcomes

    def _require_scheduler(self) -> None:
        """Check that the scheduler answers and knows the jobs, and update the capacity; raises OSError."""
        try:
            is_there = self._client.status == "running" and not any(future.status in ("cancelled", "lost") for future in self._jobs)
            threads = self._client.nthreads() if is_there else {}
        except OSError:
            is_there = False
        if not is_there:
            hint = "finished cases are kept; run the same command again to continue"
            raise OSError(errno.ECONNRESET, f"the Dask scheduler is gone; {hint}", self._address)
        self.capacity = max(1, sum(threads.values()))


def _reason(error: BaseException) -> str:
    """Return the reason why a job has no outcome."""
    return f"its workers were lost repeatedly ({error})" if type(error).__name__ == "KilledWorker" else message_of(error)


def _look(folder: Path) -> dict[str, Any]:
    """Return the token that a worker sees in the folder, the digest of its code, and its setting of threads."""
    return {"token": _token_in(folder), "code": LOADED, "threads": os.environ.get("OMP_NUM_THREADS")}


def _work(job: Job, folder: Path, token: str) -> JobOutcome:
    """Run a job in a worker."""
    if _token_in(folder) != token:
        return failure("its worker does not see the campaign's folder", job)
    try:
        return run_job(job, _Watch(folder, token))
    except StoppedError:
        return failure("the campaign's process has ended", job)


class _Watch:
    """A listener that stops a job whose campaign has ended."""

    def __init__(self, folder: Path, token: str) -> None:
        self._folder, self._token = folder, token

    def stage(self, scene: str, stage: str, state: str) -> None:
        self._look()

    def bounds(self, analysis: LimitAnalysis) -> None:
        self._look()

    def path(self, report: PathProgress) -> None:
        self._look()

    def progress(self, scene: str, report: dict[str, Any]) -> None:
        self._look()

    def _look(self) -> None:
        if _token_in(self._folder) != self._token or not _is_held(self._folder):
            raise StoppedError


def _token_in(folder: Path) -> str:
    try:
        return (folder / CALL).read_text(encoding="utf-8")
    except OSError:
        return ""


def _is_held(folder: Path) -> bool:
    """Return whether the campaign's process still holds the lock of its folder; the lock ends with the process."""
    with (folder / LOCK).open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except BlockingIOError:
            return True
    return False
