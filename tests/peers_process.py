"""Foreign engines in a process of their own: one may stop, abort or never come back without taking the benchmark along."""

import math
import multiprocessing
import os
import resource
import signal
import time
from collections.abc import Callable, Iterator
from multiprocessing.connection import Connection
from typing import Any

PATIENCE = 5.0  # the clock may run so many times faster than the processor where other work shares the machine
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


class PeerEnded(Exception):  # noqa: N818 -- what happened, not whose error
    """The process gave up, died or was ended; the message says which."""


def alone(function: Callable[..., Iterator[Any]], arguments: tuple, limit: float) -> Iterator[Any]:
    """Yield what a generator function yields in a process of its own, with one thread and its own words silenced.

    Raises PeerEnded when it raises, dies, or yields nothing for `limit` seconds of the processor, or a multiple of them by the clock.
    """
    os.environ.update(ONE_THREAD)  # read by the libraries of the child when they load
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe(duplex=False)
    process = context.Process(target=_run, args=(there, function, arguments, limit))
    process.start()
    there.close()
    try:
        while True:
            if not here.poll(PATIENCE * limit):
                raise PeerEnded(f"time limit of {PATIENCE * limit:g} s by the clock")
            try:
                kind, content = here.recv()
            except EOFError:
                process.join()
                raise PeerEnded(_cause(process.exitcode, limit)) from None
            if kind == "end":
                return
            if kind == "error":
                raise PeerEnded(content)
            yield content
    finally:
        process.kill()
        process.join()


def _run(connection: Connection, function: Callable[..., Iterator[Any]], arguments: tuple, limit: float) -> None:
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nowhere, stream)
    try:
        items = function(*arguments)
        while True:
            _allow(limit)
            try:
                item = next(items)
            except StopIteration:
                break
            connection.send(("item", item))
        connection.send(("end", None))
    except ImportError as error:
        connection.send(("error", f"not installed: {error.name}"))
    except Exception as error:  # whatever a foreign package raises ends its row, not the run
        connection.send(("error", f"{type(error).__name__}: {error}"))


def _allow(seconds: float) -> None:
    """Let this process run for so many more seconds of the processor; then the system ends it by SIGXCPU."""
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(time.process_time() + seconds), resource.RLIM_INFINITY))


def _cause(code: int | None, limit: float) -> str:
    if code == -signal.SIGXCPU:
        return f"time limit of {limit:g} s"
    if code is not None and code < 0:
        return f"ended by {signal.Signals(-code).name}"
    return f"ended its process with exit code {code}"
