"""Find YADE on this machine and run one case in its own interpreter: clean environment, time limit, log, typed failures."""

import contextlib
import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

HOW_TO_GET_YADE = "sudo apt-get install yade python3-h5py"
LOG_TAIL = 8  # lines of the log that an error quotes
GRACE = 60.0  # seconds beyond YADE's own time limit before the process is ended from outside
PROBE_SECONDS = 60.0
SYSTEM_PYTHON = "/usr/bin/python3"


_PROBE = """
import sys
sys.path.insert(0, sys.argv[1])
try:
    import h5py, numpy
except ImportError as error:
    sys.exit(f"lacks {error.name}")
try:
    import yade.config
except ImportError as error:
    sys.exit(f"cannot load YADE ({error})")
print(yade.config.version)
"""


class YadeMissingError(Exception):
    """No usable YADE on this machine; the message says what is missing and how to get it."""


class YadeFailedError(Exception):
    """YADE ended without a result; the message carries the exit code's meaning and the log's last lines."""


@dataclass(frozen=True)
class Yade:
    """A YADE that loads: its interpreter, its module folder, its version."""

    python: Path
    modules: Path
    version: str


def find_yade() -> Yade:
    """Locate YADE's interpreter and modules and check that they load; raises YadeMissingError with the remedy.

    YADE is loaded as a module of the system's Python: its own launcher would open a TCP prompt and an XMLRPC server.
    The environment variable CROSSCHECK_YADE names another module folder.
    """
    modules = _module_folder()
    if modules is None and "CROSSCHECK_YADE" in os.environ:
        raise YadeMissingError(f"CROSSCHECK_YADE = {os.environ['CROSSCHECK_YADE']} holds no YADE; unset it, or {HOW_TO_GET_YADE}")
    if modules is None:
        raise YadeMissingError(f"YADE is not installed; get it with: {HOW_TO_GET_YADE}")
    python = Path(os.environ.get("CROSSCHECK_YADE_PYTHON", SYSTEM_PYTHON))
    try:
        answer = subprocess.run(
            [python, "-s", "-c", _PROBE, modules], env=environment(), capture_output=True, text=True, timeout=PROBE_SECONDS, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise YadeMissingError(f"{python} does not run ({error}); get YADE with: {HOW_TO_GET_YADE}") from error
    said = answer.stderr.strip().splitlines() or ["gives no reason"]
    if answer.returncode != 0:
        raise YadeMissingError(f"{python} {said[-1]}; get what is missing with: {HOW_TO_GET_YADE}")
    version = answer.stdout.strip().splitlines()
    if not version:
        raise YadeMissingError(f"{python} does not say which YADE it loads; get one that does with: {HOW_TO_GET_YADE}")
    return Yade(python, modules, version[-1])


def _module_folder() -> Path | None:
    """Folder that holds the `yade` package: named by the environment, else as YADE's launcher names it."""
    named = os.environ.get("CROSSCHECK_YADE")
    if named is not None:
        return Path(named) if (Path(named) / "yade").is_dir() else None
    launcher = shutil.which("yade")
    if launcher is None:
        return None
    text = Path(launcher).read_text(errors="replace")
    words = dict(re.findall(r"^\s*(prefix|libPATH|suffix)\s*=\s*['\"]([^'\"]*)['\"]", text, re.MULTILINE))
    root = Path(words.get("prefix", "/usr"))
    candidates = [root / words.get("libPATH", "lib") / f"yade{words.get('suffix', '')}" / "py"]
    candidates += sorted(root.glob("lib/*/yade*/py"))
    return next((folder for folder in candidates if (folder / "yade").is_dir()), None)


def environment() -> dict[str, str]:
    """What YADE gets of the environment: one thread, a home (it asks for one), nothing of Python's or this program's own."""
    kept = {name: value for name, value in os.environ.items() if name in ("HOME", "LANG", "LC_ALL", "TMPDIR")}
    one_thread = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
    return {"HOME": tempfile.gettempdir(), **kept, "PATH": "/usr/local/bin:/usr/bin:/bin", **one_thread}


def run_yade(yade: Yade, folder: Path, inputs: str, time_limit: float, progress: Callable[[dict[str, Any]], None]) -> None:
    """Run `case.h5` of a folder to its end; writes `run.h5` and `yade.log` there. `progress` gets each report on the way.

    Raises YadeFailedError when no result was written. An interruption ends YADE, too.
    """
    case, run, log = folder / "case.h5", folder / "run.h5", folder / "yade.log"
    script = Path(__file__).parent.parent / "yade_scripts" / "run_case.py"
    command = [
        str(part)
        for part in (yade.python, "-s", "-u", script, case.resolve(), run.resolve(), "--inputs", inputs, "--time-limit", time_limit)
    ]
    variables = {**environment(), "YADE_MODULES": str(yade.modules)}
    began = time.monotonic()
    try:
        log.unlink(missing_ok=True)  # a link in its place would lead elsewhere
        with log.open("x") as record:
            code = _followed(command, variables, folder, time_limit + GRACE, record, progress)
    except OSError as error:  # the log's own does not say so
        raise OSError(error.errno, error.strerror, error.filename or str(log)) from error
    if code != 0 or not run.exists():
        overran = time.monotonic() - began >= time_limit + GRACE
        raise YadeFailedError(_failure(code, log, f", {GRACE:g} s after its limit of {time_limit:g} s" if overran else ""))


def _followed(
    command: list[str],
    variables: dict[str, str],
    folder: Path,
    seconds: float,
    record: TextIO,
    progress: Callable[[dict[str, Any]], None],
) -> int:
    """Exit code of a process that is ended after so many seconds, and with this call however that ends; `record` keeps what it says."""
    process = subprocess.Popen(
        command, env=variables, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        text=True, errors="replace", start_new_session=True,
    )  # fmt: skip
    overtime = threading.Timer(seconds, _end, [process])
    overtime.daemon = True
    try:
        overtime.start()
        assert process.stdout is not None  # it is a pipe
        for line in process.stdout:
            record.write(line)
            if (report := _report(line)) is not None:
                progress(report)
        return process.wait()
    finally:
        overtime.cancel()
        _end(process)


def _report(line: str) -> dict[str, Any] | None:
    """The report in a line of YADE's, None for any other line."""
    try:
        report = json.loads(line.removeprefix("progress ")) if line.startswith("progress ") else None
    except ValueError:
        return None  # it only begins like one
    return report if isinstance(report, dict) else None


def _end(process: "subprocess.Popen[str]") -> None:
    """End a process and whatever it started."""
    if process.poll() is None:
        with contextlib.suppress(ProcessLookupError):  # it may end by itself just now
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def _failure(code: int, log: Path, when: str) -> str:
    if code < 0:
        how = f"was ended by {signal.Signals(-code).name if -code in set(signal.Signals) else f'signal {-code}'}{when}"
    else:
        how = f"ended with exit code {code}" if code else "ended without writing its result"
    lines = [line for line in log.read_text(errors="replace").splitlines() if not line.startswith("progress ")]
    how += "".join(f" ({line})" for line in lines if line.startswith("error: "))
    return f"YADE {how}; the last lines of {log}:\n" + "\n".join(f"  {line}" for line in lines[-LOG_TAIL:])
