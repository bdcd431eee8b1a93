"""Entry point of `crosscheck`: an interruption or a missing package ends with one line, even while the program is still loading."""

import gc
import os
import signal
import sys
from types import FrameType

CANNOT_LOAD = 3  # TOOL of comparison.cli.exit_codes; that module itself may fail to load


def main() -> int:
    """Run the command line; returns its exit code."""
    if sys.platform == "win32":
        from la_core.errors import ON_WINDOWS

        sys.stderr.write(f"error: {ON_WINDOWS}\n")
        return CANNOT_LOAD
    _open_closed_streams()
    os.environ["MPLBACKEND"] = "Agg"  # all figures are files; a backend that matplotlib no longer knows would end the command
    patient = signal.getsignal(signal.SIGINT)
    if patient is signal.default_int_handler:  # else the caller has chosen to ignore or handle interruptions
        signal.signal(signal.SIGINT, _stop_at_once)
    gc.disable()  # objects made while loading are not freed; searching them for garbage takes a tenth of the time
    try:
        from comparison.cli import main as run
    except ImportError as error:
        from la_core.errors import missing_part

        sys.stderr.write(f"error: {missing_part(error)}\n")
        return CANNOT_LOAD
    gc.freeze()
    gc.enable()
    signal.signal(signal.SIGINT, patient)
    return run()


def _open_closed_streams() -> None:
    """Open the null device for each closed standard stream, or a file of results would get its number and the output of libraries."""
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is None:
            stream = os.fdopen(os.open(os.devnull, os.O_RDWR), "w" if number else "r", encoding="utf-8")  # it takes the lowest free number
            os.set_inheritable(stream.fileno(), True)
            setattr(sys, name, stream)


def _stop_at_once(number: int, frame: FrameType | None) -> None:
    """End the process without an exception, which a loading module might swallow; no work has begun that needs an end."""
    os.write(2, b"error: stopped before anything began\n")
    os._exit(130)


if __name__ == "__main__":
    sys.exit(main())
