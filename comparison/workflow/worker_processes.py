"""Worker processes on this machine, with one thread each. Each has its own pipe to this process; no network port is open.

Processes are spawned, not forked: a fork would copy locks that the threads of numerical libraries hold. Workers load only this program, not
the script that calls it. When a worker dies, its pipe ends, and a new worker repeats its work.
"""

import contextlib
import multiprocessing
import os
import pickle
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from types import FrameType
from typing import Any, Generic, Self, TypeVar

from comparison.errors import WorkerLostError

ATTEMPTS = 3  # largest number of workers for one piece of work: the system may kill a worker if other processes use up the memory
GRACE = 3.0  # s for a worker to end YADE and finish its files
AGAIN = 0.01  # s until a worker is stopped again after Python has dropped the first stop
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
NOT_FROM_HERE = {"PYTHONSAFEPATH": "1"}  # otherwise a new worker would load an unknown signal.py from the current folder
_CONTEXT = multiprocessing.get_context("spawn")

Work = TypeVar("Work")
Made = TypeVar("Made")


class StoppedError(BaseException):
    """The parent process has ended. This is no failure, so the class is no Exception, and handlers of failures do not catch it."""


class WorkerProcesses(Generic[Work, Made]):
    """Processes that call a function, each for one piece of work at a time; all of them end when the context is left.

    Parameters
    ----------
    function : callable
        Returns the result of a piece of work. It is called in a worker, so function, work and result are pickled.
    capacity : int
        Largest number of pieces of work at a time.
    """

    def __init__(self, function: Callable[[Work], Made], capacity: int) -> None:
        self._function, self.capacity = function, capacity
        self._idle: list[_Worker] = []
        self._busy: list[_Worker] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        workers = [*self._idle, *self._busy]
        for worker in workers:
            worker.process.terminate()
        deadline = time.monotonic() + GRACE
        try:
            for worker in workers:
                worker.process.join(max(0.0, deadline - time.monotonic()))
        finally:  # a second Ctrl-C ends the wait
            for worker in workers:
                worker.process.kill()  # YADE ends with it
                worker.process.join()

    @property
    def is_busy(self) -> bool:
        """Whether the number of pieces of work under way has reached the capacity."""
        return len(self._busy) >= self.capacity

    def begin(self, work: Work) -> None:
        """Hand a piece of work to a worker; at most `capacity` pieces are under way at a time."""
        worker = self._idle.pop() if self._idle else _Worker(self._function)
        self._busy.append(worker)
        worker.begin(work, 1)

    def ended(self, seconds: float | None = None) -> list[tuple[Work, Made | Exception]]:
        """Return pieces of work that ended, with their results; waits for the first of them, at most `seconds` if these are given.

        An error that the function raised is its result. WorkerLostError is the result if ATTEMPTS workers died with the same work. Without
        work under way the method returns at once.
        """
        results: list[tuple[Work, Made | Exception]] = []
        ready = wait([worker.pipe for worker in self._busy], seconds) if self._busy else []
        for worker in [worker for worker in self._busy if worker.pipe in ready]:
            self._busy.remove(worker)
            try:
                packed = worker.pipe.recv_bytes()
                self._idle.append(worker)
                results.append((worker.work, pickle.loads(packed)))
            except (EOFError, OSError):
                worker.process.join()
                if worker.attempt < ATTEMPTS:
                    other = _Worker(self._function)
                    self._busy.append(other)
                    other.begin(worker.work, worker.attempt + 1)
                else:
                    how = f"its worker process {_how_ended(worker.process.exitcode)}, {ATTEMPTS} times"
                    results.append((worker.work, WorkerLostError(f"{how}; {_next_step(worker.process.exitcode)}")))
        return results


class _Worker:
    """A worker process, its pipe, and its present work."""

    def __init__(self, function: Callable[[Any], Any]) -> None:
        self.pipe, theirs = _CONTEXT.Pipe()
        self.process = _CONTEXT.Process(target=_serve, args=(function, theirs), daemon=True)
        self.work: Any = None
        self.attempt = 0
        with _environment(ONE_THREAD | NOT_FROM_HERE), _interruptions_held(), _stop_held(), _script_hidden():
            self.process.start()
        theirs.close()

    def begin(self, work: Any, attempt: int) -> None:
        self.work, self.attempt = work, attempt
        with _broken_pipe_held(), contextlib.suppress(OSError):  # `ended` notices a dead worker by the end of its pipe
            self.pipe.send(work)


@contextlib.contextmanager
def _environment(variables: dict[str, str]) -> Iterator[None]:
    """Add variables to the environment of processes started here; libraries read them while they load."""
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
    """Block Ctrl-C in processes started here: only this process handles it and ends its workers."""
    resource_tracker.ensure_running()  # otherwise Python starts it with the first worker and then unblocks Ctrl-C
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def _stop_held() -> Iterator[None]:
    """Hold SIGTERM back until a worker has started: a worker with incomplete start data would end with a traceback."""
    if threading.current_thread() is not threading.main_thread():  # handlers neither interrupt another thread nor can be set there
        yield
        return
    came: list[int] = []
    before = signal.signal(signal.SIGTERM, lambda number, frame: came.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL if before is None else before)
        for number in came[:1]:
            signal.raise_signal(number)


@contextlib.contextmanager
def _broken_pipe_held() -> Iterator[None]:
    """Ignore SIGPIPE from the pipe of a dead worker; SIGPIPE from a closed pipe of the shell must still end this process."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGPIPE})
    try:
        yield
    finally:
        if signal.SIGPIPE in signal.sigpending():
            signal.sigwait({signal.SIGPIPE})
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def _script_hidden() -> Iterator[None]:
    """Hide the user's script from processes started here, because they would run it again, or look for a file named <stdin>."""
    main = vars(sys.modules["__main__"])
    before: dict[str, Any] = {name: main[name] for name in ("__file__", "__spec__") if name in main}
    main.pop("__file__", None)
    main["__spec__"] = None
    try:
        yield
    finally:
        main.pop("__spec__")
        main.update(before)


def _next_step(code: int | None) -> str:
    """Return the next step after the exit code of a worker; a negative code is a signal, and with 1 Python has printed an error."""
    message, again = "its own message on standard error says why", "run the same command again, with fewer --workers where memory ran out"
    return message if code == 1 else again if code is not None and code < 0 else f"{message}; {again}"


def _how_ended(code: int | None) -> str:
    if code is not None and code < 0:
        return f"was ended by {signal.Signals(-code).name if -code in set(signal.Signals) else f'signal {-code}'}"
    return f"ended with exit code {code}"


def _serve(function: Callable[[Any], Any], pipe: Connection) -> None:
    """Work in a worker process until the process that started it ends."""
    is_working = False

    def stop(number: int, frame: FrameType | None) -> None:
        if not is_working:
            os._exit(0)
        signal.signal(signal.SIGTERM, signal.SIG_IGN)  # a second stop must not interrupt the clean-up
        raise StoppedError

    def dropped(error: "sys.UnraisableHookArgs") -> None:
        if error.exc_type is StoppedError:  # Python drops an exception raised while it destroys an object, so the stop is repeated
            signal.signal(signal.SIGTERM, stop)
            threading.Timer(AGAIN, os.kill, (os.getpid(), signal.SIGTERM)).start()
        else:
            sys.__unraisablehook__(error)

    sys.unraisablehook = dropped
    signal.signal(signal.SIGTERM, stop)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    with contextlib.suppress(EOFError, OSError, StoppedError):
        while True:
            work = pipe.recv()
            is_working = True
            try:
                made = function(work)
            except Exception as error:  # the caller decides what the error means
                made = error
            packed = _packed(made)
            is_working = False
            pipe.send_bytes(packed)


def _packed(made: Any) -> bytes:
    """Pickle a result; a result that cannot be pickled, or an error that cannot be unpickled, becomes a RuntimeError with its message."""
    try:
        packed = pickle.dumps(made)
        if isinstance(made, Exception):
            pickle.loads(packed)
        return packed
    except Exception as error:  # pickle runs the code of every type in the result
        reason = made if isinstance(made, Exception) else error
        return pickle.dumps(RuntimeError(f"{type(reason).__name__}: {reason}"))


def _end_with_parent() -> None:
    """End this process when the process that started it ends, for any reason."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(GRACE)
    os._exit(1)  # a library did not react to the signal
