"""The location of YADE on this machine, its version and build, and the environment of its process."""

import os
import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from comparison.errors import YadeMissingError
from comparison.settings import load_settings
from la_core.errors import visible

TESTED = ("2023.02a", "2025.2.0")  # versions of YADE whose runs were compared with known values; Debian 12 and 13 have them
HOW_TO_GET_YADE = "sudo apt-get install yade python3-h5py"
HOW_TO_TRY_YADE = "`crosscheck run two_pads arch_spreading wall_third` compares it with known values"
PROBE_SECONDS = 60.0
ROOT = Path(__file__).parents[2]
SCRIPTS = ROOT / "yade_scripts"


_PROBE = """
import sys
sys.path = [sys.argv[1], *filter(None, sys.path)]  # without the current folder: its files may come from anybody
import ast, importlib, pathlib
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
"""  # the probe reads from our scripts the names that they import from YADE, because a separate list would become outdated


@dataclass(frozen=True)
class Installation:
    """The location of a YADE on this machine, which may or may not load.

    Attributes
    ----------
    python : Path
        Interpreter that loads YADE.
    modules : Path
        Folder with YADE's Python package.
    """

    python: Path
    modules: Path


@dataclass(frozen=True)
class Yade(Installation):
    """A YADE that loads on this machine.

    Attributes
    ----------
    version : str
        Version of YADE.
    lacks : tuple of str
        Optional names that are missing in this build, such as Polyhedra.
    """

    version: str
    lacks: tuple[str, ...] = ()

    @property
    def is_tested(self) -> bool:
        """Whether runs of its version were compared with known values."""
        return self.version in TESTED

    @property
    def short_caution(self) -> str:
        """The warning of `caution` in a few words; "" without a warning."""
        words = ["built without polyhedra"] if "Polyhedra" in self.lacks else []
        words += [] if self.is_tested else ["untested version"]
        return f"{', '.join(words)}, see `crosscheck doctor`" if words else ""

    @property
    def caution(self) -> str:
        """Warning about an incomplete build or an untested version, otherwise ""; no version is refused because of its number."""
        warnings = []
        if "Polyhedra" in self.lacks:
            limit = 'with "finite" displacements a block that is no box along the axes must not come near a block that it did not touch'
            warnings.append(f"{self.version} was built without polyhedra (CGAL): {limit}")
        if not self.is_tested:
            warnings.append(f"{self.version} is not among the tested versions ({', '.join(TESTED)}); {HOW_TO_TRY_YADE}")
        return "; ".join(warnings)


def locate_yade() -> Installation:
    """Return the location of YADE without a check that it loads; raises YadeMissingError with the command that installs YADE.

    YADE is loaded as a module of the system's Python, because its own launcher would open a TCP prompt and an XMLRPC server.
    The settings `yade` and `yade_python` name another module folder and another interpreter.
    """
    configuration = load_settings()
    interpreter, named = configuration.settings.yade_python, configuration.settings.yade
    found = shutil.which(interpreter)
    if found is None:
        raise YadeMissingError(f"{configuration.place('yade_python')} = {interpreter} is no program; unset it, or {HOW_TO_GET_YADE}")
    python = Path(found).absolute()  # because the process runs in a folder of results
    modules = _module_folder(named)
    if modules is None and named is not None:
        raise YadeMissingError(f"{configuration.place('yade')} = {named} holds no YADE; unset it, or {HOW_TO_GET_YADE}")
    if modules is None:
        raise YadeMissingError(f"YADE is not installed; get it with: {HOW_TO_GET_YADE}")
    return Installation(python, modules)


def find_yade() -> Yade:
    """Return the YADE of this machine after a check that it loads; raises YadeMissingError with the command that installs YADE.

    The check takes as long as a start of YADE. A run needs no check, because its start shows whether YADE loads.
    """
    return checked(locate_yade())


def checked(installation: Installation) -> Yade:
    """Return an installation with its version and missing names, read when it loads; raises YadeMissingError if it does not load."""
    python, modules = installation.python, installation.modules
    try:
        answer = subprocess.run(
            [python, "-s", "-c", _PROBE, modules, SCRIPTS],
            env=yade_environment(), capture_output=True, text=True, errors="replace", timeout=PROBE_SECONDS, check=False,
        )  # fmt: skip
    except (OSError, subprocess.TimeoutExpired) as error:
        raise YadeMissingError(f"{python} does not run ({error}); get YADE with: {HOW_TO_GET_YADE}") from error
    complaint = visible(answer.stderr).strip().splitlines() or ["fails without a message"]
    if answer.returncode != 0:
        raise YadeMissingError(f"{python} {complaint[-1]}; install what is missing with: {HOW_TO_GET_YADE}")
    version = visible(answer.stdout).strip().splitlines()
    if not version:
        raise YadeMissingError(f"{python} does not say which YADE it loads; install another one with: {HOW_TO_GET_YADE}")
    lacks = next((line.split()[1:] for line in version if line.startswith("lacks ")), [])
    return Yade(python, modules, version[-1], tuple(lacks))


def _module_folder(named: Path | None) -> Path | None:
    """Return the folder with the `yade` package: the folder `named` by the setting, or else that of YADE's launcher; None without one."""
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

    With large memory pages, if the system provides them, a step of 1,000 blocks takes 6 % less time.
    """
    kept = {name: value for name, value in os.environ.items() if name in ("HOME", "LANG", "LC_ALL", "TMPDIR")}
    one_thread = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
    large_pages = {"GLIBC_TUNABLES": "glibc.malloc.hugetlb=1"}
    return {"HOME": tempfile.gettempdir(), **kept, "PATH": "/usr/local/bin:/usr/bin:/bin", **one_thread, **large_pages}
