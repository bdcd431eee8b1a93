"""Permitted imports: the rooms (packages within a package) in order, and rules about imports, read from the sources."""

import argparse
import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGES = ("la_core", "yade_scripts", "comparison")
FILES = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py")) if path.parent.name != "tutorials"]
STANDARD = sys.stdlib_module_names
MOST_LINES, MOST_MODULES = 300, 12  # lines of a module; modules of a room, without its `__init__.py`

# Every room may import the rooms before it, and its own modules. A module directly in a package counts as a room.
ROOMS = (
    "la_core.errors", "la_core.digests", "la_core.side_by_side", "la_core.text_table", "la_core.pictures",
    "la_core.exchange", "la_core.geometry", "la_core.drawing", "la_core.repair", "la_core.scene", "la_core.model", "la_core.measures",
    "la_core.limit", "la_core.coulomb", "la_core.analysis",
    "comparison.provenance", "comparison.numbers", "comparison.settings", "comparison.errors", "comparison.run_folder",
    "comparison.progress", "comparison.verdict", "comparison.yade", "comparison.judge", "comparison.limit_analysis", "comparison.figures",
    "comparison.report", "comparison.workflow", "comparison.studies", "comparison.campaign", "comparison.picture", "comparison.result",
    "comparison.study_result", "comparison.campaign_result", "comparison.cli", "comparison.__main__",
)  # fmt: skip
INNER = {  # the same order within a room that has rooms of its own; "" are the modules directly in the room
    "la_core.scene": ("schema", "generators", "loads", ""),
    "la_core.coulomb": ("path", ""),
    "comparison.judge": ("checks", ""),
    "comparison.campaign": ("", "workers", "figures", "report"),
    "comparison.cli": ("", "help_verbs", "study_verbs", "scene_verbs", "commands"),
}
DRAW = ("comparison/figures/", "comparison/studies/figure_of_", "comparison/campaign/figures/")  # files that may import matplotlib
PRINT = ("comparison/cli/", "yade_scripts/run_case.py")

every_file = pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))


def name_of(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def is_module(name: str) -> bool:
    place = ROOT.joinpath(*name.split("."))
    return place.with_suffix(".py").exists() or (place / "__init__.py").exists()


def imported(path: Path) -> Iterator[str]:
    """Dotted name of every module that a file imports, anywhere in the file. A name from a face (`__init__.py`) counts as the face."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            assert node.module is not None
            for alias in node.names:  # `from la_core.limit import conic` names a module, `from la_core.limit import solve` a name
                yield f"{node.module}.{alias.name}" if is_module(f"{node.module}.{alias.name}") else node.module


def package(module: str) -> str:
    return module.split(".", maxsplit=1)[0]


def room(module: str) -> str | None:
    """The room of a module of this project; None for a module outside all rooms."""
    parts = module.split(".")
    return next((name for name in (".".join(parts[:2]), module) if name in ROOMS), None)


def own(path: Path) -> list[str]:
    """The modules of this project that a file imports."""
    return [module for module in imported(path) if package(module) in PACKAGES]


def inner_room(module: str, outer: str) -> str:
    inside = module.removeprefix(outer).strip(".").split(".")[0]
    return inside if inside in INNER[outer] else ""


def is_called(name: str, path: Path) -> bool:
    calls = (node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, ast.Call))
    return any(isinstance(call.func, ast.Name) and call.func.id == name for call in calls)


def test_there_is_something_to_hold_the_rules_against() -> None:
    assert {package(name_of(path)) for path in FILES} == set(PACKAGES)
    assert {"numpy", "la_core.measures.residuals", "la_core.limit.conic"} <= set(imported(ROOT / "la_core" / "limit" / "associated.py"))
    assert room("la_core.limit.conic") == "la_core.limit" and room("comparison.errors") == "comparison.errors"
    assert room("la_core.attic.trunk") is None


def test_every_module_is_in_a_room_and_every_room_has_one() -> None:
    names = [name_of(path) for path in FILES if package(name_of(path)) != "yade_scripts"]
    rooms = {name: room(name) for name in names if name not in PACKAGES}
    assert not [name for name, place in rooms.items() if place is None]
    assert set(rooms.values()) == set(ROOMS)


@every_file
def test_every_import_points_to_an_earlier_room(path: Path) -> None:
    here = room(name_of(path))
    if here is None:
        return
    for module in own(path):
        there = room(module)
        assert there is not None, f"{module} is no room's"
        assert ROOMS.index(there) <= ROOMS.index(here), f"{here} may not know {there}"
        if there == here and here in INNER and name_of(path) != here:  # a face imports from all of its room
            order = INNER[here]
            assert order.index(inner_room(module, here)) <= order.index(inner_room(name_of(path), here))


def test_no_module_comes_back_to_itself_through_its_imports() -> None:
    """Imports for type hints count. Two modules that import each other are one module, or one of them needs too much."""
    known = {name_of(path): {module for module in own(path) if module != name_of(path)} for path in FILES}
    while bare := [name for name, modules in known.items() if not modules & known.keys()]:
        for name in bare:
            del known[name]
    in_circles = {name: sorted(modules & known.keys()) for name, modules in known.items()}
    assert not in_circles


@every_file
def test_rooms_are_entered_by_their_faces(path: Path) -> None:
    """Other rooms import only the names in a room's `__all__`. Its further names and modules are internal."""
    here = room(name_of(path))
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module is not None and (there := room(node.module)) not in (None, here):
            assert node.module == there, f"{node.module}: take it from {there}"
            face = ROOT.joinpath(*node.module.split(".")) / "__init__.py"
            if face.exists():
                assert {alias.name for alias in node.names} <= face_of(face), there


def face_of(path: Path) -> set[str]:
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and node.targets[0].id == "__all__":
            return set(ast.literal_eval(node.value))
    return set()


@pytest.mark.parametrize("place", sorted({path.parent for path in FILES}), ids=lambda place: str(place.relative_to(ROOT)))
def test_every_room_has_a_sentence_and_few_modules(place: Path) -> None:
    sentence = ast.get_docstring(ast.parse((place / "__init__.py").read_text(encoding="utf-8")))
    assert sentence and sentence[0].isupper() and sentence.endswith(".")
    assert len([path for path in place.glob("*.py") if path.name != "__init__.py"]) <= MOST_MODULES


@every_file
def test_no_module_is_long(path: Path) -> None:
    assert len(path.read_text(encoding="utf-8").splitlines()) <= MOST_LINES


@every_file
def test_packages_know_only_whom_they_may(path: Path) -> None:
    modules = set(imported(path))
    packages = {package(module) for module in modules}
    here = package(name_of(path))
    if here == "la_core":
        assert not packages & {"comparison", "yade_scripts", "yade", "minieigen"}
    elif here == "yade_scripts":
        foreign = packages - STANDARD - {"numpy", "h5py", "yade", "minieigen", "la_core", "yade_scripts"}
        assert not foreign
        assert {module for module in modules if package(module) == "la_core"} <= {"la_core.exchange"}
    else:
        assert not packages & {"yade_scripts", "yade", "minieigen"}


def test_limit_analysis_asks_for_pictures_in_one_place() -> None:
    """The package `comparison` draws for `scene.draw()` and `answer.plot()`, and is loaded only for them."""
    asks = [path for path in FILES if package(name_of(path)) == "la_core" and 'import_module("comparison")' in path.read_text("utf-8")]
    assert asks == [ROOT / "la_core" / "pictures.py"]
    assert not loaded_by("import la_core; la_core.load('two_pads')") & {"comparison", "matplotlib"}


@every_file
def test_one_module_talks_to_the_solver(path: Path) -> None:
    assert ("clarabel" in set(map(package, imported(path)))) == (path == ROOT / "la_core" / "limit" / "conic.py")


@every_file
def test_only_figures_draw(path: Path) -> None:
    if "matplotlib" in set(map(package, imported(path))):
        assert path.relative_to(ROOT).as_posix().startswith(DRAW)


@every_file
def test_one_module_makes_the_tables_of_the_terminal(path: Path) -> None:
    """A second module copies tables to fit a width. Elsewhere, markup in a user's text would take effect."""
    if is_called("Table", path):
        assert path.relative_to(ROOT).as_posix() in ("comparison/verdict/terminal_table.py", "comparison/cli/layout.py")


@every_file
def test_only_entry_points_print(path: Path) -> None:
    if is_called("print", path):
        assert path.relative_to(ROOT).as_posix().startswith(PRINT)


@pytest.mark.parametrize("name", ["la_core", "comparison"])
def test_a_package_loads_nothing_before_it_is_asked_for(name: str) -> None:
    """YADE's interpreter loads la_core.exchange and must not need the rest; the command line must not wait for modules that draw."""
    assert list(imported(ROOT / name / "__init__.py")) == ["importlib"]


def loaded_by(statement: str) -> set[str]:
    """Packages that a process has loaded after a statement."""
    program = f"import sys; {statement}; print(*{{name.split('.')[0] for name in sys.modules}})"
    return set(subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split())


def test_exchange_runs_in_both_interpreters() -> None:
    modules = {module for path in (ROOT / "la_core" / "exchange").glob("*.py") for module in imported(path)}
    assert {package(module) for module in modules} <= STANDARD | {"numpy", "h5py", "la_core"}
    assert {module for module in modules if package(module) == "la_core"} <= {name for name in modules if room(name) == "la_core.exchange"}


def test_loading_exchange_loads_nothing_it_need_not() -> None:
    loaded = loaded_by("import la_core.exchange")
    assert "h5py" in loaded
    assert not loaded & {"clarabel", "scipy", "shapely", "pydantic", "matplotlib", "rich", "jinja2"}


def test_the_command_line_does_not_wait_for_what_draws() -> None:
    assert not loaded_by("from comparison.cli import main") & {"matplotlib", "jinja2", "distributed", "vtk"}


def test_solve_does_not_wait_for_what_draws() -> None:
    assert not loaded_by("import comparison.cli.scene_verbs.solve") & {"matplotlib", "jinja2"}


def test_every_verb_has_a_module_of_its_own() -> None:
    """The command line loads the module by its name, which no checker of types or imports follows."""
    from comparison.cli.arguments import parser
    from comparison.cli.commands import COMMANDS

    (words,) = [action for action in parser()._actions if isinstance(action, argparse._SubParsersAction)]
    assert set(words.choices) == set(COMMANDS)
    for verb, module in COMMANDS.items():
        assert module.split(".")[-1] == verb and module.split(".")[-2] in INNER["comparison.cli"]
        tree = ast.parse(ROOT.joinpath(*module.split(".")).with_suffix(".py").read_text(encoding="utf-8"))
        assert [ast.unparse(node.args) for node in tree.body if isinstance(node, ast.FunctionDef) and node.name == "execute"] == [
            "context: Context"
        ]


@pytest.mark.parametrize("place", PACKAGES)
def test_the_readme_lists_the_rooms_in_their_order(place: str) -> None:
    (line,) = [line for line in (ROOT / "README.md").read_text(encoding="utf-8").splitlines() if line.startswith(f"| `{place}` |")]
    listed = line.split("|")[-2].strip(" `").split()
    assert set(listed) == {path.parent.name for path in (ROOT / place).glob("*/__init__.py")}
    if place != "yade_scripts":  # its rooms share the modules directly in the package
        assert listed == [name.removeprefix(f"{place}.") for name in ROOMS if name.removeprefix(f"{place}.") in listed]


def test_top_level_is_as_the_owner_fixed_it() -> None:
    shown = {path.name for path in ROOT.iterdir() if path.is_dir() and not path.name.startswith(".") and any(path.glob("*.py"))}
    assert shown == {*PACKAGES, "tests"}


def public_names(path: Path) -> Iterator[str]:
    """Functions and classes that a module defines for others."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
            yield node.name


@pytest.mark.parametrize("name", PACKAGES)
def test_no_public_name_is_defined_twice_within_a_package(name: str) -> None:
    """Exceptions are `execute`, which every verb of the command line has, and the entry `main`."""
    homes: dict[str, list[str]] = {}
    for path in FILES:
        if package(name_of(path)) == name:
            for defined in public_names(path):
                homes.setdefault(defined, []).append(name_of(path))
    assert not {defined: places for defined, places in homes.items() if len(places) > 1 and defined not in ("execute", "main")}


@pytest.mark.parametrize("name", ["la_core", "comparison"])
def test_no_two_faces_show_one_name(name: str) -> None:
    shown: dict[str, list[str]] = {}
    for place in ROOMS:
        face = ROOT.joinpath(*place.split(".")) / "__init__.py"
        if package(place) == name and face.exists():
            for entry in face_of(face):
                if not is_module(f"{place}.{entry}"):
                    shown.setdefault(entry, []).append(place)
    assert not {entry: places for entry, places in shown.items() if len(places) > 1}
