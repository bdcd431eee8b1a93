"""The walls of Ferris and Tin-Loi with windows, by both methods."""

from pathlib import Path

import published_walls
import pytest
from conftest import Silent
from published_walls_page import row_of

import la_core
from comparison.workflow import run_scene

pytestmark = [pytest.mark.yade, pytest.mark.slow]


@pytest.mark.parametrize("number", [3, 4])
def test_walls_with_windows_go_through_both_methods(number: int, tmp_path: Path) -> None:
    """These are the smaller two. The page on the published walls has all six."""
    scene = la_core.build(published_walls.tables(number), f"wall_{number}")
    summary = run_scene(scene, tmp_path / "results", Silent(), with_yade=True, figures=lambda _: {})
    coulomb, yade = summary["limit_analysis"]["coulomb"]["shared_inset"], summary["yade"]
    assert summary["verdict"] == "agree", summary["reason"]
    assert abs(yade["multiplier"] - coulomb["multiplier"]) <= yade["uncertainty"] + coulomb["uncertainty"]
    assert yade["multiplier"] == pytest.approx(coulomb["multiplier"], rel=2e-3)
    assert yade["multiplier"] <= summary["limit_analysis"]["associated"]["shared_inset"]["multiplier"]
    assert row_of(number, summary)[-1] == "agree"
