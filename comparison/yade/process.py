"""Run one case in YADE's interpreter, with a clean environment, a time limit and a log."""

import contextlib
import json
import math
import os
import signal
import subprocess
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TextIO

from comparison.errors import YadeFailedError, YadeMissingError
from comparison.yade.installation import HOW_TO_GET_YADE, SCRIPTS, Installation, checked, yade_environment

LOG_TAIL = 8  # lines of the log that an error quotes
NUMBERS = ("attempt", "fraction", "seconds_left", "seconds_to_limit", "settlement", "reaction")  # numbers in a progress report, if known
GRACE = 60.0  # seconds beyond YADE's own time limit until this program kills the process
LOADING = 300.0  # longest time to load, s; YADE needs two seconds, with 10,000 blocks twenty, but one of some ten thousand starts hung
UNREAD = 2.0  # seconds after LOADING in which a report is still read: it may wait unread if this process was stopped, as by Ctrl-Z
STARTS = 2  # largest number of starts of a YADE that hangs while it loads


def run_yade(
    yade: Installation,
    folder: Path,
    inputs: str,
    time_limit: float,
    progress: Callable[[dict[str, Any]], None],
    started: Callable[[], None] = lambda: None,
) -> None:
    """Run `case.h5` of a folder in YADE to its end, and write `run.h5` and `yade.log` there.

    A YADE that hangs while it loads is started once more.

    Raises YadeFailedError if no result was written, but YadeMissingError if the reason is that YADE does not load. An interruption of this
    call also ends YADE.

    Parameters
    ----------
    yade : Installation
        YADE installation.
    folder : Path
        Folder of the scene's results with `case.h5`.
    inputs : str
        Digest of the run's inputs, to be stored in `run.h5`.
    time_limit : float
        Time limit, s of wall time; YADE ends by then, and is otherwise killed GRACE seconds later.
    progress : callable
        Receives each progress report by name. The first one, with the stage "loaded", has YADE's version and the names missing in its
        build. The others have stage, attempt, fraction of the run's expected work, seconds_left (None while unknown), seconds_to_limit,
        is_late (a plateau was expected before), settlement and reaction.
    started : callable
        Called after each start of YADE's process, so that a thread started there runs while YADE loads.
    """
    case, run, log = folder / "case.h5", folder / "run.h5", folder / "yade.log"
    options = ["--inputs", inputs, "--time-limit", time_limit]
    command = [str(part) for part in (yade.python, "-s", "-u", SCRIPTS / "run_case.py", case.resolve(), run.resolve(), *options)]
    variables = {**yade_environment(), "YADE_MODULES": str(yade.modules)}
    code: int | None = None
    try:
        log.unlink(missing_ok=True)  # otherwise a link in place of the log would be followed
        with log.open("x") as record:
            for _ in range(STARTS):
                began = time.monotonic()
                code = _followed(command, variables, folder, time_limit + GRACE, record, progress, started)
                if code is not None:
                    break
                record.write(f"YADE did not load within {LOADING:g} s\n")
    except OSError as error:  # an error in writing the log does not name its file
        raise OSError(error.errno, error.strerror, error.filename or str(log)) from error
    if code is None:
        raise YadeFailedError(
            f"YADE did not load within {LOADING:g} s, {STARTS} times; run the same command again while fewer other programs run"
        )
    if code != 0 or not run.exists():
        overran = time.monotonic() - began >= time_limit + GRACE
        reason = _failure(code, log, f", {GRACE:g} s after its limit of {time_limit:g} s" if overran else "")
        raise YadeFailedError(reason + _caution(yade, is_killed=code < 0))


def _followed(
    command: list[str],
    variables: dict[str, str],
    folder: Path,
    seconds: float,
    record: TextIO,
    progress: Callable[[dict[str, Any]], None],
    started: Callable[[], None],
) -> int | None:
    """Run a process and return its exit code; None if it was killed because it reported nothing within LOADING seconds.

    The process is also killed after `seconds`, and when this call ends. `record` receives its output.
    """
    try:
        process = subprocess.Popen(
            command, env=variables, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            text=True, errors="replace", start_new_session=True,
        )  # fmt: skip
    except OSError as error:
        raise YadeMissingError(f"{command[0]} does not run ({error}); get YADE with: {HOW_TO_GET_YADE}") from error
    loaded, hangs = threading.Event(), threading.Event()

    def give_up() -> None:
        if not loaded.wait(UNREAD):
            hangs.set()
            _end(process)

    overtime, loading = threading.Timer(min(seconds, threading.TIMEOUT_MAX), _end, [process]), threading.Timer(LOADING, give_up)
    overtime.daemon = loading.daemon = True
    try:
        overtime.start()
        loading.start()
        started()
        assert process.stdout is not None  # because it is a pipe
        with process.stdout:
            for line in process.stdout:
                record.write(line)
                if (report := _report(line)) is not None:
                    loaded.set()
                    loading.cancel()
                    progress(report)
        code = process.wait()
        return None if hangs.is_set() else code
    finally:
        loading.cancel()
        overtime.cancel()
        _end(process)


def _report(line: str) -> dict[str, Any] | None:
    """Return the progress report in a line of YADE's output, None for any other line."""
    try:
        report = json.loads(line.removeprefix("progress ")) if line.startswith("progress ") else None
    except ValueError:
        return None  # the line only begins like a report
    if not isinstance(report, dict) or not isinstance(report.get("lacks", []), list):
        return None
    return report if all(_is_number(report.get(name)) for name in NUMBERS) else None


def _is_number(value: Any) -> bool:
    """Whether a value of a report is a finite number or unknown."""
    return value is None or (isinstance(value, int | float) and math.isfinite(value))


def _end(process: "subprocess.Popen[str]") -> None:
    """Kill a process and every process that it started."""
    if process.poll() is None:
        with contextlib.suppress(ProcessLookupError):  # the process may have ended just now
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def _caution(installation: Installation, is_killed: bool) -> str:
    """Return the caution about this YADE for the message of a failure; raises YadeMissingError if it does not load.

    is_killed: whether the failed process was killed; it may then have loaded, so no error is raised.
    """
    try:
        caution = checked(installation).caution
    except YadeMissingError:
        if is_killed:
            return ""
        raise
    return f"\nYADE {caution}" if caution else ""


def _failure(code: int, log: Path, when: str) -> str:
    if code < 0:
        how = f"was ended by {signal.Signals(-code).name if -code in set(signal.Signals) else f'signal {-code}'}{when}"
    else:
        how = f"ended with exit code {code}" if code else "ended without writing its result"
    lines = [line for line in log.read_text(errors="replace").splitlines() if not line.startswith("progress ")]
    how += "".join(f" ({line})" for line in lines if line.startswith("error: "))
    return f"YADE {how}.\nThe last lines of {log}:\n" + "\n".join(f"  {line}" for line in lines[-LOG_TAIL:])
