"""Foreign engines in a process of their own: one may stop, abort or never come back without taking the benchmark along."""

import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

LOOK = 0.5  # s between two looks at what a process has used
GRACE = 2.0  # s for a process to end what it has started
START = 60.0  # s of the processor for a process to load what it runs, before its limit counts
PATIENCE = 10.0  # the clock may run so many times faster than the processor where other work shares the machine
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


class PeerEnded(Exception):  # noqa: N818 -- what happened, not whose error
    """The process gave up, died or was ended; the message says which."""


class PeerTooSlow(PeerEnded):
    """The process was ended at its limit of seconds of the processor."""


def alone(function: Callable[..., Iterator[Any]], arguments: tuple, limit: float) -> Iterator[Any]:
    """Yield what a generator function yields in a process of its own, with one thread and its own words silenced.

    Raises PeerEnded when it raises, dies, or yields nothing for `limit` seconds of the processor, or a multiple of them by the clock.
    The limit is watched from outside: the system's own limit makes the seconds that a process sees of itself coarse.
    """
    os.environ.update(ONE_THREAD)  # read by the libraries of the child when they load
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=_run, args=(there, function, arguments))
    process.start()
    there.close()
    try:
        ready = False
        while True:
            _wait(here, process.pid, limit if ready else START)
            try:
                kind, content = here.recv()
            except EOFError:
                process.join()
                raise PeerEnded(_cause(process.exitcode)) from None
            if kind == "end":
                return
            if kind == "ready":
                ready = True
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
    """Wait for the next message; raises PeerTooSlow when the process has used up its limit since the last one."""
    used, clock = _used(pid), time.monotonic()
    while not connection.poll(LOOK):
        if _used(pid) - used > limit or time.monotonic() - clock > PATIENCE * limit:
            raise PeerTooSlow(f"time limit of {limit:g} s")


def _used(pid: int | None) -> float:
    """Seconds of the processor that a process and those it has waited for have used, from Linux' table of processes."""
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")


def _run(connection: Connection, function: Callable[..., Iterator[Any]], arguments: tuple) -> None:
    signal.signal(signal.SIGTERM, lambda *_: sys.exit())  # so that it ends what it has started, such as YADE
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nowhere, stream)
    connection.send(("ready", None))
    try:
        for item in function(*arguments):
            connection.send(("item", item))
        connection.send(("end", None))
    except ImportError as error:
        connection.send(("error", f"not installed: {error.name}"))
    except Exception as error:  # whatever a foreign package raises ends its row, not the run
        connection.send(("error", f"{type(error).__name__}: {error}"))


def _cause(code: int | None) -> str:
    if code is not None and code < 0:
        return f"ended by {signal.Signals(-code).name}"
    return f"ended its process with exit code {code}"
