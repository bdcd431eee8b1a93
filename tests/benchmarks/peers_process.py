"""Other solvers in their own processes: one may stop, abort or never end without ending the benchmark."""

import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

LOADING = 600.0  # processor seconds to load Python, its packages and the arguments, a last resort
LOOK = 0.5  # s between two readings of a process's time
GRACE = 2.0  # s for a process to end its own child processes
PATIENCE = 10.0  # most wall time over processor time, where other work shares the machine
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


class PeerEnded(Exception):  # noqa: N818 -- the name of an event
    """The process gave up, died or was ended; the message says which."""


class PeerTooSlow(PeerEnded):
    """The process was ended at its limit of processor seconds."""


def alone(function: Callable[..., Iterator[Any]], arguments: tuple, limit: float) -> Iterator[Any]:
    """Run a generator function in its own process, with one thread and its output silenced, and yield its items.

    Raises PeerEnded when the function raises, the process dies, or nothing is yielded for `limit` processor seconds or PATIENCE times as
    many wall seconds. Time counts once the process has loaded its packages: loading takes seconds on a busy machine and is not the solver's
    work. This process watches the limit, because the system's own limit makes the time that a process reads of itself coarse.
    """
    os.environ.update(ONE_THREAD)  # read by the libraries of the child when they load
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=_run, args=(there, function, arguments))
    process.start()
    there.close()
    try:
        allowed = LOADING
        while True:
            _wait(here, process.pid, allowed)
            try:
                kind, content = here.recv()
            except EOFError:
                process.join()
                raise PeerEnded(_cause(process.exitcode)) from None
            allowed = limit
            if kind == "end":
                return
            if kind == "begin":
                continue
            if kind == "error":
                raise PeerEnded(content)
            yield content
    finally:
        process.terminate()
        process.join(GRACE)
        process.kill()
        process.join()


def _wait(connection: Connection, pid: int | None, limit: float) -> None:
    """Wait for the next message. Raises PeerTooSlow when the process has used up its limit since the last message."""
    used, clock = _used(pid), time.monotonic()
    while not connection.poll(LOOK):
        if _used(pid) - used > limit or time.monotonic() - clock > PATIENCE * limit:
            raise PeerTooSlow(f"time limit of {limit:g} s")


def _used(pid: int | None) -> float:
    """Return the processor seconds of a process and its ended children, from Linux' table of processes."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")


def _run(connection: Connection, function: Callable[..., Iterator[Any]], arguments: tuple) -> None:
    signal.signal(signal.SIGTERM, lambda *_: sys.exit())  # so that it ends its child processes, such as YADE
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nowhere, stream)
    connection.send(("begin", None))
    try:
        for item in function(*arguments):
            connection.send(("item", item))
        connection.send(("end", None))
    except ImportError as error:
        connection.send(("error", f"not installed: {error.name}"))
    except Exception as error:  # an error of another package ends its row, not the run
        connection.send(("error", f"{type(error).__name__}: {error}"))


def _cause(code: int | None) -> str:
    if code is not None and code < 0:
        return f"ended by {signal.Signals(-code).name}"
    return f"ended its process with exit code {code}"
