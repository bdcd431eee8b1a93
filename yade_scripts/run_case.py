"""Run one case in YADE: `/usr/bin/python3 run_case.py case.h5 run.h5 [--inputs DIGEST] [--time-limit SECONDS]`.

Standard output carries protocol lines only: `progress {JSON}` during the run, `done <status>` at the end. The exit code is 0 if
run.h5 was written, for every status. YADE's Python modules are loaded from $YADE_MODULES, or else from the folders of Debian and
Ubuntu. In a plain Python interpreter YADE opens no network socket; its own launcher always opens two.
"""

import argparse
import contextlib
import ctypes
import dataclasses
import importlib.metadata
import importlib.util
import json
import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, TextIO

if TYPE_CHECKING:
    from yade_scripts.expected_steps import AttemptSteps

os.environ["OMP_NUM_THREADS"] = "1"  # for libraries that load before YADE
os.environ.setdefault("HOME", str(Path.home()))  # YADE needs it when it loads

_ROOT = Path(__file__).resolve().parent.parent
_SECONDS_BETWEEN_LINES = 0.25
_SECONDS_TIMED = 0.5  # wall time, s, over which time steps are timed before the remaining time is estimated
_PR_SET_PDEATHSIG = 1  # prctl(2)


def load_package(name: str) -> ModuleType:
    """Load package `name` from the parent of this file's folder. sys.path is not changed, because other packages there must stay hidden."""
    folder = _ROOT / name
    spec = importlib.util.spec_from_file_location(name, folder / "__init__.py", submodule_search_locations=[str(folder)])
    if spec is None or spec.loader is None:
        raise ImportError(f"{folder} is not a package")
    package = importlib.util.module_from_spec(spec)
    sys.modules[name] = package
    spec.loader.exec_module(package)
    return package


class DeferredModule(ModuleType):
    """A module that has its version at once, and is loaded only when another attribute is read."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.__version__ = importlib.metadata.version(name)

    def __getattr__(self, name: str) -> Any:
        """Load the module in place of this one."""
        if sys.modules.get(self.__name__) is self:
            del sys.modules[self.__name__]
        return getattr(importlib.import_module(self.__name__), name)


def defer_console() -> None:
    """Defer the load of IPython, which takes a quarter of YADE's loading time; YADE needs only IPython's version."""
    with contextlib.suppress(importlib.metadata.PackageNotFoundError):
        sys.modules.setdefault("IPython", DeferredModule("IPython"))


def find_yade() -> str:
    """Return the folder of YADE's Python modules; raises ImportError with the command that installs YADE if YADE is not installed."""
    named = os.environ.get("YADE_MODULES")
    # Debian ships builds of several precisions side by side: double precision is preferred.
    installed = sorted(Path("/usr/lib").glob("*/yade*/py"), key=lambda path: ("double" not in str(path), str(path)))
    for folder in [Path(named)] if named else installed:
        if (folder / "yade" / "__init__.py").is_file():
            return str(folder)
    where = f"in $YADE_MODULES = {named}" if named else "below /usr/lib"
    raise ImportError(f"no YADE {where}; install it (apt-get install yade python3-h5py) or set YADE_MODULES to its module folder")


class Reporter:
    """Protocol lines on the process's standard output, at most a few per second, with the remaining time at the pace so far."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._last = -_SECONDS_BETWEEN_LINES
        self._attempt, self._before, self._steps = 0, 0, 0  # number; time steps of the earlier attempts, and of this one
        self._rested = 0  # time steps of this attempt under gravity
        self._first: tuple[float, int] | None = None  # time of this attempt's first row, s, and time steps up to it

    def loaded(self, version: str, lacks: list[str]) -> None:
        """Write YADE's version, and the optional names that are missing in its build."""
        self._write_progress(stage="loaded", version=version, lacks=lacks)

    def attempt(self, steps: "AttemptSteps", seconds: float) -> None:
        """Begin an attempt. steps: its expected time steps; seconds: wall time until its time limit."""
        self._attempt, self._before, self._steps, self._rested = self._attempt + 1, self._before + self._steps, 0, 0
        self._expected, self._first, self._limit = steps, None, time.monotonic() + seconds

    def progress(self, stage: str, steps: int, settlement: float, reaction: float) -> None:
        """Write one progress line unless the last one is too recent.

        steps: time steps of this attempt so far. settlement: m or rad. reaction: N or N m, or the multiplier of a live load.
        """
        now = time.monotonic()
        self._steps, self._first = steps, self._first or (now, steps)
        if stage == "gravity":
            self._rested = steps
        if now - self._last < _SECONDS_BETWEEN_LINES:
            return
        self._last = now
        left, timed, done = self._expected.left(self._rested, steps - self._rested), now - self._first[0], self._before + steps
        self._write_progress(
            stage=stage,
            attempt=self._attempt,
            fraction=done / (done + left),
            seconds_left=left * timed / (steps - self._first[1]) if timed >= _SECONDS_TIMED else None,
            seconds_to_limit=self._limit - now,
            is_late=self._expected.is_late(steps - self._rested),
            settlement=settlement,
            reaction=reaction,
        )

    def done(self, status: str) -> None:
        """Write the last line."""
        self._write(f"done {status}")

    def _write_progress(self, **report: Any) -> None:
        self._write(f"progress {json.dumps(report)}")

    def _write(self, line: str) -> None:
        self._stream.write(line + "\n")
        self._stream.flush()


def run(options: argparse.Namespace, reporter: Reporter) -> None:
    """Read the case, run it, write the record."""
    sys.path[:] = [entry for entry in sys.path if Path(entry or ".").resolve() != _ROOT / "yade_scripts"]
    for package in ("la_core", "yade_scripts"):
        load_package(package)
    from la_core import exchange  # noqa: PLC0415  loadable only from here on
    from yade_scripts import case, settings  # noqa: PLC0415

    if not options.run.parent.is_dir():  # known before the run, which may take hours
        raise exchange.ExchangeError(f"{options.run}: its folder does not exist; make the folder, then run the case again")
    began = time.monotonic()
    problem = settings.affordable(case.from_fields(exchange.read(options.case, case_fields(options.case))))
    derived = settings.derive(problem)
    limit = derived.time_limit if options.time_limit is None else options.time_limit
    os.environ["OMP_NUM_THREADS"] = str(derived.threads)  # with several threads the order in which forces are added differs between runs
    sys.path.append(find_yade())
    defer_console()
    from yade import config  # noqa: PLC0415

    from yade_scripts import attempts, bodies, protocol, recorder, run_fields  # noqa: PLC0415
    from yade_scripts.contacts import faces, near_faces  # noqa: PLC0415
    from yade_scripts.expected_steps import expected_steps  # noqa: PLC0415

    _remove_scratch_folder()
    reporter.loaded(config.version, ["Polyhedra"] if faces.Polyhedra is None else [])

    def attempt(one: case.Case, chosen: settings.Settings, pace: float, near: near_faces.NearFaces | None) -> protocol.Protocol:
        left = dataclasses.replace(chosen, time_limit=max(limit - (time.monotonic() - began), 1e-3))
        model = bodies.build(one, left, "watch()", "pull()", "calm()")
        reporter.attempt(expected_steps(one, chosen, pace), left.time_limit)
        made = protocol.Protocol(one, left, model, recorder.Record(one, model), reporter.progress, near, pace)
        _expose(watch=made.watch, pull=made.pull, calm=made.calm)
        made.run()
        made.settings = dataclasses.replace(chosen, time_limit=limit)
        return made

    values = run_fields.fields(attempts.make(problem, derived, attempts.WithoutSearch(attempt)), time.monotonic() - began)
    exchange.write(options.run, exchange.RUN_FIELDS, values, options.inputs)
    reporter.done(values["result/status"])


def case_fields(path: Path) -> tuple[Any, ...]:
    """Return the fields of a case file: the required ones, and the optional ones in this file. The packages must be loaded."""
    from la_core import exchange  # noqa: PLC0415

    optional = (*exchange.OWN_FIELDS, exchange.SWAY, exchange.LONG_RUN_SETTINGS)
    return (*exchange.CASE_FIELDS, *exchange.present(path, optional))


def _expose(**called: Callable[[], Any]) -> None:
    """Add functions to the main module, where YADE's PyRunners evaluate their commands."""
    sys.modules["__main__"].__dict__.update(called)


def _remove_scratch_folder() -> None:
    """Remove the empty folder that YADE makes when it loads: it is not used here, and a killed process would leave it behind."""
    from yade import Omega  # noqa: PLC0415  loadable only from here on

    with contextlib.suppress(OSError):
        Path(Omega().tmpFilename()).parent.rmdir()


def _end_with_parent() -> None:
    """Let the system kill this process when its parent ends, because no process would then read its result."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def _reason(error: Exception) -> str:
    """Return the error as one line; an unexpected error has its type in front."""
    text = " ".join(str(error).split())
    foreseen = isinstance(error, ImportError) or type(error).__module__.split(".")[0] in ("la_core", "yade_scripts")
    return text if foreseen and text else f"{type(error).__name__}: {text}"


def main() -> int:
    """Entry point: exit code 0 when run.h5 was written, 1 when not, 2 for wrong arguments."""
    parser = argparse.ArgumentParser(description="Run one case in YADE.")
    parser.add_argument("case", type=Path, help="case.h5, from limit analysis")
    parser.add_argument("run", type=Path, help="run.h5, to be written")
    parser.add_argument("--inputs", default="", help="digest of what makes the run, stored in run.h5")
    parser.add_argument("--time-limit", type=float, help="seconds of wall time, in place of the case's setting")
    options = parser.parse_args()
    _end_with_parent()
    # YADE prints to standard output from C++ and Python. Send this to standard error, and keep the original stream for the protocol.
    protocol_stream = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    try:
        run(options, Reporter(protocol_stream))
    except Exception as error:
        sys.stderr.write(f"error: {_reason(error)}\n")
        return 1
    return 0


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)  # YADE's own clean-up at interpreter exit may crash after all results are written
