"""Entry point of `crosscheck`: an interruption ends in one line, even while the program is still loading."""

import gc
import os
import signal
import sys
from types import FrameType


def main() -> int:
    """Run the command line; returns its exit code."""
    patient = signal.getsignal(signal.SIGINT)
    if patient is signal.default_int_handler:  # else somebody asked not to be interrupted
        signal.signal(signal.SIGINT, _stop_at_once)
    gc.disable()  # what loading makes is there to stay: to search it for what could be freed takes a tenth of the time
    from comparison.cli import main as run

    gc.freeze()
    gc.enable()
    signal.signal(signal.SIGINT, patient)
    return run()


def _stop_at_once(number: int, frame: FrameType | None) -> None:
    """An exception might be swallowed by what is being imported; nothing has begun that would need an end."""
    os.write(2, b"error: stopped before anything began\n")
    os._exit(130)


if __name__ == "__main__":
    sys.exit(main())
