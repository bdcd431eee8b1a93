"""Find YADE on this machine and run one case in its interpreter, with a clean environment, a time limit and a log."""

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

from comparison.errors import YadeFailedError, YadeMissingError
from comparison.settings import load_settings

TESTED = ("2023.02a", "2025.2.0")  # versions of YADE whose runs were compared with known values: those of Debian 12 and 13
HOW_TO_GET_YADE = "sudo apt-get install yade python3-h5py"
HOW_TO_TRY_YADE = "`crosscheck run two_pads arch_spreading wall_third` compares it with known values"
LOG_TAIL = 8  # lines of the log that an error quotes
GRACE = 60.0  # seconds beyond YADE's own time limit before the process is ended from outside
PROBE_SECONDS = 60.0
ROOT = Path(__file__).parents[2]
SCRIPTS = ROOT / "yade_scripts"


_PROBE = """
import ast, importlib, pathlib, sys
sys.path.insert(0, sys.argv[1])
try:
    import h5py, numpy
except ImportError as error:
    sys.exit(f"lacks {error.name}")
try:
    import yade.config
except ImportError as error:
    sys.exit(f"cannot load YADE ({error})")
version = yade.config.version
try:
    pathlib.Path(yade.Omega().tmpFilename()).parent.rmdir()  # the scratch folder that YADE makes when it loads, and leaves behind
except (AttributeError, OSError):
    pass
needed, wanted = {}, {}
for source in sorted(pathlib.Path(sys.argv[2]).rglob("*.py")):
    nodes = list(ast.walk(ast.parse(source.read_text(encoding="utf-8"))))
    tried = [part for node in nodes if isinstance(node, ast.Try) for part in node.body]
    for node in nodes:
        if isinstance(node, ast.ImportFrom) and node.module in ("yade", "yade.utils"):
            try:
                module = importlib.import_module(node.module)
            except ImportError:
                module = None
            lacking = wanted if node in tried else needed
            lacking.update({name.name: None for name in node.names if not hasattr(module, name.name)})
if needed:
    sys.exit(f"loads YADE {version}, which lacks names that crosscheck uses: {', '.join(needed)}")
print("lacks", *wanted)
print(version)
"""  # the probe reads the names that our scripts import of YADE, because a separate list would grow old


@dataclass(frozen=True)
class Installation:
    """Where YADE is on this machine, whether it loads or not.

    Attributes
    ----------
    python : Path
        Interpreter that loads it.
    modules : Path
        Folder that holds its Python package.
    """

    python: Path
    modules: Path


@dataclass(frozen=True)
class Yade(Installation):
    """A YADE that loads on this machine.

    Attributes
    ----------
    version : str
        Its version.
    lacks : tuple of str
        Optional names that this build lacks, such as Polyhedra.
    """

    version: str
    lacks: tuple[str, ...] = ()

    @property
    def caution(self) -> str:
        """Warning about a build that lacks something or an untested version, else ""; a version is never refused for its number."""
        warnings = []
        if "Polyhedra" in self.lacks:
            limit = 'with "finite" displacements a block that is no box along the axes must not come near a block that it did not touch'
            warnings.append(f"{self.version} was built without polyhedra (CGAL): {limit}")
        if self.version not in TESTED:
            warnings.append(f"{self.version} is not among the tested versions ({', '.join(TESTED)}); {HOW_TO_TRY_YADE}")
        return "; ".join(warnings)


def locate_yade() -> Installation:
    """Return where YADE is, without a check that it loads; raises YadeMissingError with the command that installs it.

    YADE is loaded as a module of the system's Python: its own launcher would open a TCP prompt and an XMLRPC server.
    The settings `yade` and `yade_python` name another module folder and another interpreter.
    """
    configuration = load_settings()
    interpreter, named = configuration.settings.yade_python, configuration.settings.yade
    found = shutil.which(interpreter)
    if found is None:
        raise YadeMissingError(f"{configuration.place('yade_python')} = {interpreter} is no program; unset it, or {HOW_TO_GET_YADE}")
    python = Path(found).absolute()  # it will run in a folder of results
    modules = _module_folder(named)
    if modules is None and named is not None:
        raise YadeMissingError(f"{configuration.place('yade')} = {named} holds no YADE; unset it, or {HOW_TO_GET_YADE}")
    if modules is None:
        raise YadeMissingError(f"YADE is not installed; get it with: {HOW_TO_GET_YADE}")
    return Installation(python, modules)


def find_yade() -> Yade:
    """Return the YADE of this machine, after a check that it loads; raises YadeMissingError with the command that installs it.

    The check takes as long as a start of YADE. A run does without it, because it finds out by itself.
    """
    return _checked(locate_yade())


def _checked(installation: Installation) -> Yade:
    """Return an installation with what it says of itself when it loads; raises YadeMissingError where it does not."""
    python, modules = installation.python, installation.modules
    try:
        answer = subprocess.run(
            [python, "-s", "-c", _PROBE, modules, SCRIPTS],
            env=yade_environment(), capture_output=True, text=True, timeout=PROBE_SECONDS, check=False,
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired) as error:
        raise YadeMissingError(f"{python} does not run ({error}); get YADE with: {HOW_TO_GET_YADE}") from error
    complaint = answer.stderr.strip().splitlines() or ["fails without a message"]
    if answer.returncode != 0:
        raise YadeMissingError(f"{python} {complaint[-1]}; install what is missing with: {HOW_TO_GET_YADE}")
    version = answer.stdout.strip().splitlines()
    if not version:
        raise YadeMissingError(f"{python} does not say which YADE it loads; install another one with: {HOW_TO_GET_YADE}")
    lacks = next((line.split()[1:] for line in version if line.startswith("lacks ")), [])
    return Yade(python, modules, version[-1], tuple(lacks))


def _module_folder(named: Path | None) -> Path | None:
    """Return the folder that holds the `yade` package: the one of the setting `named`, else the one in YADE's launcher, or None."""
    if named is not None:
        return named.absolute() if (named / "yade").is_dir() else None
    launcher = shutil.which("yade")
    if launcher is None:
        return None
    text = Path(launcher).read_text(errors="replace")
    names = dict(re.findall(r"^\s*(prefix|libPATH|suffix)\s*=\s*['\"]([^'\"]*)['\"]", text, re.MULTILINE))
    root = Path(names.get("prefix", "/usr"))
    candidates = [root / names.get("libPATH", "lib") / f"yade{names.get('suffix', '')}" / "py"]
    candidates += sorted(root.glob("lib/*/yade*/py"))
    return next((folder for folder in candidates if (folder / "yade").is_dir()), None)


def yade_environment() -> dict[str, str]:
    """Return YADE's environment: one thread, large pages, a home (YADE needs one), and no variable of Python or of this program.

    On large memory pages, where the system has them to give, a step of 1,000 blocks takes 6 % less time.
    """
    kept = {name: value for name, value in os.environ.items() if name in ("HOME", "LANG", "LC_ALL", "TMPDIR")}
    one_thread = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
    large_pages = {"GLIBC_TUNABLES": "glibc.malloc.hugetlb=1"}
    return {"HOME": tempfile.gettempdir(), **kept, "PATH": "/usr/local/bin:/usr/bin:/bin", **one_thread, **large_pages}


def run_yade(
    yade: Installation,
    folder: Path,
    inputs: str,
    time_limit: float,
    progress: Callable[[dict[str, Any]], None],
    started: Callable[[], None] = lambda: None,
) -> None:
    """Run `case.h5` of a folder in YADE to its end, and write `run.h5` and `yade.log` there.

    Raises YadeFailedError when no result was written, and YadeMissingError where this is because YADE does not load. An interruption of
    this call ends YADE, too.

    Parameters
    ----------
    yade : Installation
        The YADE to run.
    folder : Path
        Folder of the scene's results, which holds `case.h5`.
    inputs : str
        Digest of the run's inputs, to be stored in `run.h5`.
    time_limit : float
        Time limit, s of wall time; YADE keeps it and is killed GRACE seconds after it.
    progress : callable
        Receives each progress report by name: first, as stage "loaded", YADE's version and what its build lacks; then stage, attempt,
        fraction of the run's expected work, seconds_left (None while unknown), seconds_to_limit, is_late (a plateau was expected
        before), settlement and reaction.
    started : callable
        Called once YADE's process has started; a thread that it starts runs while YADE loads.
    """
    case, run, log = folder / "case.h5", folder / "run.h5", folder / "yade.log"
    options = ["--inputs", inputs, "--time-limit", time_limit]
    command = [str(part) for part in (yade.python, "-s", "-u", SCRIPTS / "run_case.py", case.resolve(), run.resolve(), *options)]
    variables = {**yade_environment(), "YADE_MODULES": str(yade.modules)}
    began = time.monotonic()
    try:
        log.unlink(missing_ok=True)  # a link in its place would lead elsewhere
        with log.open("x") as record:
            code = _followed(command, variables, folder, time_limit + GRACE, record, progress, started)
    except OSError as error:  # an error of the log itself does not name its file
        raise OSError(error.errno, error.strerror, error.filename or str(log)) from error
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
) -> int:
    """Run a process and return its exit code; it is killed after `seconds`, or when this call ends. `record` receives its output."""
    process = subprocess.Popen(
        command, env=variables, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        text=True, errors="replace", start_new_session=True,
    )  # fmt: skip
    overtime = threading.Timer(seconds, _end, [process])
    overtime.daemon = True
    try:
        overtime.start()
        started()
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
    """Return the progress report in a line of YADE's output, None for any other line."""
    try:
        report = json.loads(line.removeprefix("progress ")) if line.startswith("progress ") else None
    except ValueError:
        return None  # a line that only begins like a report
    return report if isinstance(report, dict) else None


def _end(process: "subprocess.Popen[str]") -> None:
    """Kill a process and every process that it started."""
    if process.poll() is None:
        with contextlib.suppress(ProcessLookupError):  # it may have ended in this moment
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def _caution(installation: Installation, is_killed: bool) -> str:
    """Return what a reader of a failure should know about this YADE; raises YadeMissingError where it does not load.

    is_killed: whether the failed process had been killed, so that it may have loaded.
    """
    try:
        caution = _checked(installation).caution
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
