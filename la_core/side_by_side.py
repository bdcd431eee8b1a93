"""Parallel threads for calls of libraries that release Python's global lock."""

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor, wait
from typing import TypeVar

Item = TypeVar("Item")
Made = TypeVar("Made")


def cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def threads() -> int:
    """Return the number of threads: OMP_NUM_THREADS, or else one for each core that this process may use."""
    given = os.environ.get("OMP_NUM_THREADS", "")
    return max(1, int(given)) if given.isdecimal() else cores()


def side_by_side(
    function: Callable[[Item], Made], items: Iterable[Item], stop: Callable[[], None] = lambda: None, at_once: int | None = None
) -> list[Made]:
    """Return the results of a function for all items, in the order of the items; with one thread the calls run in turn.

    Parameters
    ----------
    function : callable
        Called once for each item.
    items : iterable
        Items.
    stop : callable
        Called where one call fails or the user interrupts the program; the other calls then have to end soon.
    at_once : int, optional
        Number of calls at once; None takes the number of threads.
    """
    at_once = at_once or threads()
    if at_once == 1:
        return [function(item) for item in items]
    errors: list[BaseException] = []

    def call(item: Item) -> Made:
        try:
            return function(item)
        except BaseException as error:
            errors.append(error)  # before the others stop: their errors only follow from this one
            stop()
            raise

    with ThreadPoolExecutor(at_once) as pool:
        futures = [pool.submit(call, item) for item in items]
        try:
            wait(futures)
        except BaseException:
            stop()
            raise
    if errors:
        raise errors[0]
    return [future.result() for future in futures]
