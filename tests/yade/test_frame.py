"""A structure in a national grid, far from the origin: YADE runs it in a frame near its blocks and reports in the scene's frame."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scenes
from conftest import Silent
from numpy.testing import assert_allclose

from comparison.workflow.one_scene import run_scene
from la_core import exchange
from la_core.analysis.case_file import write_case
from la_core.analysis.stage import analyse
from la_core.scene.scene import Scene, load_scene
from yade_scripts import case
from yade_scripts.contacts.frame import about_old_origin, origin_near

SURVEY = np.array([4.5e5, 5.4e6, 300.0])  # m: east, north and height in a national grid
ROUND_OFF = 1e-8  # m: of coordinates as large as these
HALF_PER_CENT = 5e-3  # of the reaction: promised accuracy of both methods
PARTS = (
    scenes.box("pad", (0.0, 0.0, -0.1), (0.4, 0.2, 0.0), "fixed"),
    scenes.box("settling pad", (0.5, 0.0, -0.1), (1.0, 0.2, 0.0), "support"),
    scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.2, 0.5)),
)
TURNING = {"axis": (0.0, 1.0, 0.0), "point": (0.1, 0.0, 0.0)}


def pads(settlement: Any) -> Scene:
    return scenes.build(*PARTS, settlement=settlement, inset=0.001, model="coulomb")


def case_of(scene: Scene, folder: Path) -> case.Case:
    write_case(folder / "case.h5", analyse(scene), "")
    return case.from_fields(exchange.read(folder / "case.h5", exchange.CASE_FIELDS))


def test_a_structure_near_the_origin_stays_where_it_is() -> None:
    for name in ("two_pads", "arch_spreading", "wall_third", "building_corner"):
        assert not origin_near(scenes.shipped(name).blocks.vertices).any()


@pytest.mark.parametrize("settlement", [scenes.DOWN, TURNING], ids=["drop", "turn"])
def test_a_case_far_from_the_origin_is_that_near_it(settlement: Any, tmp_path: Path) -> None:
    """Places differ by one shift, and every point of a support has the same motion."""
    near = case_of(pads(settlement), tmp_path)
    far = case_of(scenes.moved(pads(settlement), shift=SURVEY), tmp_path)
    shift = SURVEY - far.origin
    assert not near.origin.any() and np.abs(shift).max() < 10.0
    assert_allclose(far.centroid - shift, near.centroid, atol=ROUND_OFF)
    assert_allclose(np.concatenate(far.vertices).mean(axis=0) - shift, np.concatenate(near.vertices).mean(axis=0), atol=ROUND_OFF)
    assert far.support_speed == pytest.approx(near.support_speed, rel=1e-6)
    moved = [
        twists[:, :3] + np.cross(twists[:, 3:], one.centroid) for one, twists in ((near, near.support_twists), (far, far.support_twists))
    ]
    assert_allclose(moved[1], moved[0], atol=ROUND_OFF)


def test_a_moment_is_told_about_the_origin_of_the_scene() -> None:
    point, force = np.array([1.0, 2.0, 3.0]), np.array([4.0, -5.0, 6.0])
    about_new = np.concatenate([force, np.cross(point, force)])[None]
    assert_allclose(about_old_origin(about_new, SURVEY)[0], np.concatenate([force, np.cross(point + SURVEY, force)]))


@pytest.mark.slow_after_first
@pytest.mark.yade
@pytest.mark.parametrize("settlement", [scenes.DOWN, TURNING], ids=["drop", "turn"])
def test_both_methods_agree_far_from_the_origin(settlement: Any, tmp_path: Path) -> None:
    """At these coordinates YADE itself lost the inertia of its blocks in round-off and refused them."""
    path = tmp_path / "scene.toml"
    path.write_text(scenes.moved(pads(settlement), shift=SURVEY).text, encoding="utf-8")
    summary = run_scene(load_scene(path), tmp_path / "result", Silent(), with_yade=True)
    assert summary["verdict"] == "agree", summary["reason"]
    assert summary["yade"]["reaction"] == pytest.approx(summary["limit_analysis"]["coulomb"]["reaction"], rel=HALF_PER_CENT)
