"""Shared fixtures."""

import functools
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import scenes_for_tests
from hypothesis import HealthCheck, settings

from comparison import shipped
from comparison.record import Run, read_run
from comparison.workflow import run_scene
from la_core.analysis import LimitAnalysis
from la_core.case_file import read_case
from la_core.scene import Scene, load_scene

every_shipped_scene = pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.long) if name in shipped.LONG else name for name in shipped.names()]
)


# Laws under random structures: few scenes in every run, many with `--hypothesis-profile long`.
for profile, scenes in (("few", 20), ("long", 500)):
    slow = [HealthCheck.too_slow, HealthCheck.filter_too_much]
    settings.register_profile(profile, max_examples=scenes, derandomize=True, deadline=None, suppress_health_check=slow)
settings.load_profile("few")


@dataclass(frozen=True)
class CrossChecked:
    """A shipped scene after `crosscheck run`: both methods' results and what comparison.json holds."""

    scene: Scene
    analysis: LimitAnalysis
    run: Run
    summary: dict[str, Any]
    folder: Path


class Silent:
    """A listener that keeps what it hears to itself."""

    def stage(self, scene: str, stage: str, state: str) -> None:
        pass

    def progress(self, scene: str, report: dict[str, Any]) -> None:
        pass


@pytest.fixture(scope="session")
def cross_checked(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], CrossChecked]:
    """Take a shipped scene through both methods, once a session however many tests ask for it."""
    results = tmp_path_factory.mktemp("cross_checked")

    @functools.cache
    def run(name: str) -> CrossChecked:
        scene = load_scene(shipped.find(name))
        folder = results / name
        summary = run_scene(scene, folder, Silent(), with_yade=True)
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
    return (scenes_for_tests.SHIPPED / "two_pads.toml").read_text(encoding="utf-8")
