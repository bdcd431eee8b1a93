"""Who may know whom: rules about imports, read from the sources."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
ROOMS = ("la_core", "yade_scripts", "comparison")
FILES = [path for room in ROOMS for path in sorted((ROOT / room).rglob("*.py"))]
STANDARD = sys.stdlib_module_names

every_file = pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))


def room(path: Path) -> str:
    return path.relative_to(ROOT).parts[0]


def imported(path: Path) -> Iterator[str]:
    """Every module a file imports, wherever in it the import stands, as a dotted name."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            assert node.module is not None
            # `from la_core import exchange` names a module, `from la_core.exchange import read` a name in one.
            is_package = (ROOT / node.module.replace(".", "/") / "__init__.py").exists()
            yield from (f"{node.module}.{alias.name}" if is_package else node.module for alias in node.names)


def package(module: str) -> str:
    return module.split(".", maxsplit=1)[0]


def is_called(name: str, path: Path) -> bool:
    calls = (node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, ast.Call))
    return any(isinstance(call.func, ast.Name) and call.func.id == name for call in calls)


def test_there_is_something_to_hold_the_rules_against() -> None:
    assert {room(path) for path in FILES} == set(ROOMS)
    limit = set(imported(ROOT / "la_core" / "limit.py"))
    assert {"numpy", "la_core.measures.residuals", "la_core.limit.conic"} <= limit


@every_file
def test_rooms_know_only_whom_they_may(path) -> None:
    modules = set(imported(path))
    packages = {package(module) for module in modules}
    if room(path) == "la_core":
        assert not packages & {"comparison", "yade_scripts", "yade", "minieigen"}
    elif room(path) == "yade_scripts":
        foreign = packages - STANDARD - {"numpy", "h5py", "yade", "minieigen", "la_core", "yade_scripts"}
        assert not foreign
        assert {module for module in modules if package(module) == "la_core"} <= {"la_core.exchange"}
    else:
        assert not packages & {"yade_scripts", "yade", "minieigen"}


@every_file
def test_one_module_talks_to_the_solver(path) -> None:
    assert ("clarabel" in set(map(package, imported(path)))) == (path == ROOT / "la_core" / "limit" / "conic.py")


@every_file
def test_only_plots_draw(path) -> None:
    if "matplotlib" in set(map(package, imported(path))):
        assert room(path) == "comparison" and (path.stem.startswith("plot") or path.stem == "drawing")


@every_file
def test_only_entry_points_print(path) -> None:
    if is_called("print", path) and path.parent.name != "tutorials":  # those are scripts
        assert path.relative_to(ROOT).as_posix() in ("comparison/cli.py", "yade_scripts/run_case.py")


@pytest.mark.parametrize("name", ["la_core", "comparison"])
def test_a_package_loads_nothing_before_it_is_asked_for(name: str) -> None:
    """YADE's interpreter loads la_core.exchange and must not need the rest; the command line must not wait for what draws."""
    assert list(imported(ROOT / name / "__init__.py")) == ["importlib"]


def test_exchange_runs_in_both_interpreters() -> None:
    modules = set(imported(ROOT / "la_core" / "exchange.py"))
    assert {package(module) for module in modules - {"la_core.exchange.checksummed_file"}} <= STANDARD | {"numpy", "h5py"}
    assert set(imported(ROOT / "la_core" / "sealed_file.py")) <= STANDARD


def test_loading_exchange_loads_nothing_it_need_not() -> None:
    program = "import sys, la_core.exchange; print(*{name.split('.')[0] for name in sys.modules})"
    loaded = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    assert "h5py" in loaded
    assert not set(loaded) & {"clarabel", "scipy", "shapely", "pydantic", "matplotlib", "rich", "jinja2"}


def test_top_level_is_as_the_owner_fixed_it() -> None:
    shown = {path.name for path in ROOT.iterdir() if path.is_dir() and not path.name.startswith(".") and any(path.glob("*.py"))}
    assert shown == {*ROOMS, "tests"}
