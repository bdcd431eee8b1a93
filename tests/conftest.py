"""Shared fixtures."""

import functools
import os
import shutil
import signal
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from faulty_runs import Fake
from hypothesis import HealthCheck, settings
from matplotlib.figure import Figure
from paths import with_reports

from comparison.cli.commands import main
from comparison.figures import report_figures
from comparison.workflow.one_scene import run_scene
from comparison.yade.run_record import Run, read_run
from la_core.analysis import settings as settings_of_analysis
from la_core.analysis.case_file import read_case
from la_core.analysis.result import LimitAnalysis
from la_core.scene import shipped
from la_core.scene.scene import Scene, load_scene

os.environ.pop("COLUMNS", None)  # parallel runs set it to the terminal's width; tables are tested at the width of a pipe
STARTS_YADE = {"cross_checked", "undisturbed", "copy", "yade", "ran", "altered_yade"}
# Scenes whose runs `make test` judges. Each takes seconds; together they have sliding joints in the plane, an arch, blocks in space.
QUICK = {"two_pads", "two_blocks", "arch_spreading", "slab_four_corners", "wall_third"}
SHARED = {"two_pads", "arch_spreading", "wall_third"}  # scenes of tests in many modules; some of these tests take several
NOT_ABOUT_DRAWING = {"coulomb", "inputs", "limit", "yade"}  # rooms whose tests run scenes and look at no figure of the run
LONGEST = ("dome_sector", "facade", "wall_long", "corner_settling_end", "wall_half", "vault_spreading", "wall_tall", "wall_low_friction")


every_shipped_scene = pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.long if name in shipped.LONG else pytest.mark.slow if name in LONGEST else ())
        for name in shipped.names()
    ],
)


class NoParameters:
    """Stand-in for the parameters of a test without parameters."""

    params: dict[str, Any] = {}  # noqa: RUF012


# Laws under random structures: few scenes in every run, many with `--hypothesis-profile long`.
for profile, examples in (("few", 20), ("long", 500)):
    slow = [HealthCheck.too_slow, HealthCheck.filter_too_much]
    settings.register_profile(profile, max_examples=examples, derandomize=True, deadline=None, suppress_health_check=slow)
settings.load_profile("few")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark tests that start YADE, leave out tests that take hours, and share the work among processes. README.md explains it."""
    begun: set[Any] = set()  # functions of which `make test` has a case
    for item in items:
        fixtures = set(getattr(item, "fixturenames", ()))
        if fixtures & STARTS_YADE:
            item.add_marker("yade")
        scenes = scenes_of(item) if "cross_checked" in fixtures else set()
        if scenes - QUICK or item.get_closest_marker("browser"):
            item.add_marker("slow")
        if {mark.name for mark in item.iter_markers()} & {"slow_after_first", "slow", "long"} == {"slow_after_first"}:
            if item.function in begun:  # type: ignore[attr-defined]
                item.add_marker("slow")
            begun.add(item.function)  # type: ignore[attr-defined]
        item.add_marker(pytest.mark.xdist_group(group_of(item, scenes) if "cross_checked" in fixtures else item.path.name))
    if "long" not in config.option.markexpr:  # `-m "not yade"` does not request the tests that take hours
        config.hook.pytest_deselected(items=[item for item in items if item.get_closest_marker("long")])
        items[:] = [item for item in items if not item.get_closest_marker("long")]
    # Processes take groups in this order: the longest group comes first, so that no process ends long after the others.
    items.sort(key=lambda item: next((k for k, name in enumerate(LONGEST) if is_about(item, name)), len(LONGEST)))


def scenes_of(item: pytest.Item) -> set[str]:
    """Shipped scenes that a test names, as a parameter or in its own lines."""
    words = (*getattr(item, "callspec", NoParameters).params.values(), *item.function.__code__.co_consts)  # type: ignore[attr-defined]
    return {word for word in words if isinstance(word, str)} & set(shipped.names())


def group_of(item: pytest.Item, scenes: set[str]) -> str:
    """Tests of one scene share a process and its run. Tests of SHARED scenes, and tests of several scenes, are one group."""
    return f"run of {next(iter(scenes))}" if len(scenes) == 1 and not scenes <= SHARED else "runs of shared scenes"


def is_about(item: pytest.Item, scene: str) -> bool:
    marker = item.get_closest_marker("xdist_group")
    return marker is not None and marker.args == (f"run of {scene}",)


@pytest.fixture(autouse=True, scope="session")
def no_settings_of_the_user(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Tests run with the default settings on every machine. Only the place of YADE may come from the environment.

    The default folder of results cannot be made, so that no test leaves results in the current folder or finds results of another test.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CONFIG_HOME", str(tmp_path_factory.mktemp("configuration")))
        for name in ("OUTPUT", "TIME_LIMIT", "WORKERS"):
            patch.delenv(f"CROSSCHECK_{name}", raising=False)
        patch.setenv("CROSSCHECK_OUTPUT", "/dev/null/crosscheck-results")
        yield


@dataclass(frozen=True)
class CrossChecked:
    """A shipped scene after `crosscheck run`: both methods' results and the content of comparison.json."""

    scene: Scene
    analysis: LimitAnalysis
    run: Run
    summary: dict[str, Any]
    folder: Path


class Silent(settings_of_analysis.Silent):
    """A listener of all stages that prints nothing."""

    def stage(self, scene: str, stage: str, state: str) -> None:
        pass

    def progress(self, scene: str, report: dict[str, Any]) -> None:
        pass


@pytest.fixture(scope="session")
def cross_checked(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], CrossChecked]:
    """Return a function that runs a shipped scene by both methods, once a session for all tests."""
    results = tmp_path_factory.mktemp("cross_checked")

    @functools.cache
    def run(name: str) -> CrossChecked:
        scene = load_scene(shipped.find(name))
        folder = results / name
        summary = run_scene(scene, folder, Silent(), with_yade=True, figures=report_figures)  # whatever figures the first test has
        analysis = read_case(folder / "case.h5", scene)
        return CrossChecked(scene, analysis, read_run(folder / "run.h5", analysis.assembly), summary, folder)

    return run


@pytest.fixture
def write_scene(tmp_path: Path) -> Callable[[str], Path]:
    """Write a scene's text to a file and return its path."""

    def write(toml: str, name: str = "scene") -> Path:
        path = tmp_path / f"{name}.toml"
        path.write_text(toml, encoding="utf-8")
        tomllib.loads(toml)  # a slip in a test's own text must not pass for a scene's fault
        return path

    return write


@pytest.fixture(scope="session")
def two_pads() -> str:
    """Text of the contract's example."""
    return shipped.find("two_pads").read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of an undisturbed run; tests work on copies."""
    out = tmp_path_factory.mktemp("undisturbed") / "out"
    assert main(["run", "two_pads", "-o", str(out), "-q"]) == 0
    return out


@pytest.fixture(scope="session")
def without_yade(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("without_yade") / "out"
    assert main(["run", "two_pads", "-o", str(out), "-q", "--no-yade"]) == 0
    return out


@pytest.fixture
def out(tmp_path: Path) -> Path:
    """Folder of results that does not exist yet."""
    return tmp_path / "out"


@pytest.fixture
def analysed(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """Scenes that were predicted so far."""
    return with_reports(monkeypatch)


@pytest.fixture
def copy(undisturbed: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(undisturbed, tmp_path / "out"))


@pytest.fixture
def plain_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """One empty figure in place of four, for tests that are not about drawing."""
    monkeypatch.setattr("comparison.figures.report_figures", lambda results: {"assembly": Figure})


@pytest.fixture(autouse=True)
def figures_where_they_are_looked_at(request: pytest.FixtureRequest) -> None:
    """Leave figures out in the other rooms: drawing takes longer than solving a small scene."""
    if request.path.parent.name in NOT_ABOUT_DRAWING:
        request.getfixturevalue("plain_figures")


@pytest.fixture(autouse=True)
def interruptions_arrive() -> Iterator[None]:
    """A job in the background ignores interruptions, and so do its children, unless the handler is set again."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def fake_python(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Fake:
    """YADE's interpreter replaced by a shell script that passes the probe."""

    def fake(body: str, probe: str = "echo 0.0; exit 0") -> None:
        path = tmp_path / "python"
        path.write_text(f'#!/bin/sh\nif [ "$2" = -c ]; then {probe}; fi\n{body}\n')
        path.chmod(0o755)
        monkeypatch.setenv("CROSSCHECK_YADE_PYTHON", str(path))

    return fake
