"""The six walls of Ferris and Tin-Loi: the published bounds, and both methods on those with windows."""

from pathlib import Path

import published_walls
import pytest
from conftest import Silent
from published_walls_page import PUBLISHED, row_of

import la_core
from comparison.workflow import run_scene

FREE_BLOCKS = {1: 33, 2: 55, 3: 46, 4: 55, 5: 61, 6: 146}


@pytest.mark.parametrize("number", FREE_BLOCKS)
def test_the_walls_stand_and_have_the_published_bounds(number: int) -> None:
    wall = la_core.build(published_walls.tables(number), f"wall_{number}")
    answer = la_core.solve(wall, bounds_only=True)
    assert answer.status == la_core.Status.SOLVED
    assert int(wall.blocks.free.sum()) == FREE_BLOCKS[number]
    if number in PUBLISHED:
        assert answer.multiplier == pytest.approx(PUBLISHED[number][0], abs=1e-5)


@pytest.mark.slow
@pytest.mark.yade
@pytest.mark.parametrize("number", [3, 4])
def test_walls_with_windows_go_through_both_methods(number: int, tmp_path: Path) -> None:
    """The smaller two; the page on the published walls holds all six."""
    scene = la_core.build(published_walls.tables(number), f"wall_{number}")
    summary = run_scene(scene, tmp_path / "results", Silent(), with_yade=True, figures=lambda _: {})
    coulomb, yade = summary["limit_analysis"]["coulomb"]["shared_inset"], summary["yade"]
    assert summary["verdict"] == "agree", summary["reason"]
    assert abs(yade["multiplier"] - coulomb["multiplier"]) <= yade["uncertainty"] + coulomb["uncertainty"]
    assert yade["multiplier"] == pytest.approx(coulomb["multiplier"], rel=2e-3)
    assert yade["multiplier"] <= summary["limit_analysis"]["associated"]["shared_inset"]["multiplier"]
    assert row_of(number, summary)[-1] == "agree"
