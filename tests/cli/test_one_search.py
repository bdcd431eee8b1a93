"""The search for interfaces is the slow part of assembling a scene: a run makes it once."""

from collections.abc import Callable
from pathlib import Path

import pytest

import comparison
from comparison.cli.commands import main
from la_core.geometry import touching
from la_core.model import assembly

SCENES = ("two_pads", "wall_third")  # the prediction of the first is the bound; joints of the second slide


@pytest.fixture
def searches(monkeypatch: pytest.MonkeyPatch, plain_figures: None) -> list[int]:
    """Return a list that receives the number of blocks of each search."""
    found: list[int] = []
    search = assembly.find_interfaces

    def counted(blocks, *arguments, **options):
        found.append(len(blocks))
        return search(blocks, *arguments, **options)

    monkeypatch.setattr(assembly, "find_interfaces", counted)
    return found


def by_command(name: str, folder: Path) -> None:
    assert main(["run", name, "--no-yade", "-q", "-o", str(folder)]) == 0


def by_command_to_an_accuracy(name: str, folder: Path) -> None:
    assert main(["run", name, "--no-yade", "-q", "--accuracy", "1%", "-o", str(folder)]) == 0


def from_python(name: str, folder: Path) -> None:
    comparison.run(name, folder, yade=False, quiet=True)


@pytest.mark.slow_after_first
@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("run", [by_command, by_command_to_an_accuracy, from_python])
def test_a_run_searches_interfaces_once_whether_fresh_or_cached(
    run: Callable[[str, Path], None], name: str, tmp_path: Path, searches: list[int]
) -> None:
    for _ in ("fresh", "cached"):
        searches.clear()
        run(name, tmp_path)
        assert len(searches) == 1


def test_a_run_of_several_scenes_searches_each_once(tmp_path: Path, searches: list[int]) -> None:
    assert main(["run", *SCENES, "--no-yade", "-q", "-o", str(tmp_path)]) == 0
    assert len(searches) == len(SCENES)


def test_the_checks_of_a_scene_and_its_model_share_the_search_for_touching_faces(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, plain_figures: None
) -> None:
    searched: list[int] = []
    search = touching._search
    monkeypatch.setattr(touching, "_search", lambda blocks: searched.append(len(blocks)) or search(blocks))
    by_command("wall_third", tmp_path)
    assert len(searched) == 1
