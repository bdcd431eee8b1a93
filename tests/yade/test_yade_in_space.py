"""Real YADE runs in three dimensions: contact spheres at every corner of every overlap, supports that tilt, structures at any angle."""

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import scenes
from conftest import Silent

from comparison.workflow.one_scene import run_scene
from la_core.limit.associated import solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble
from la_core.scene.scene import Scene, load_scene

HALF_PER_CENT = 5e-3  # of the reaction: promised accuracy of both methods where friction's history does not decide
HISTORY = 1e-2  # of the reaction: uncertainty from friction's history where joints slide
SAME = 1e-5  # relative: Coulomb limit analysis of the same structure in another frame; its iteration amplifies round-off
CrossCheck = Callable[[Scene], dict]


@pytest.fixture
def cross_check(tmp_path: Path) -> CrossCheck:
    """Return a function that runs a scene by both methods and returns the content of comparison.json."""

    def run(scene: Scene) -> dict:
        path = tmp_path / "scene.toml"
        path.write_text(scene.text, encoding="utf-8")
        return run_scene(load_scene(path), tmp_path / "result", Silent(), with_yade=True)

    return run


def reactions(summary: dict) -> tuple[float, float]:
    """YADE's and the predicted reaction over the weight, of a run that agreed."""
    assert summary["yade"]["status"] == "plateau", summary["yade"]["message"]
    assert summary["verdict"] == "agree", summary["reason"]
    weight = summary["weight"]
    return summary["yade"]["reaction"] / weight, summary["limit_analysis"]["coulomb"]["reaction"] / weight


def piers(roles: tuple[str, ...]) -> list[str]:
    """Three piers of 0.2 x 0.2 m under the corners (0, 0), (1, 0) and (0, 1) of a slab."""
    places = [(0.0, 0.0), (0.8, 0.0), (0.0, 0.8)]
    return [
        scenes.box(f"pier {k}", (x, y, -0.2), (x + 0.2, y + 0.2, 0.0), role)
        for k, ((x, y), role) in enumerate(zip(places, roles, strict=True))
    ]


@pytest.mark.yade
@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_a_slab_at_any_angle_in_space_carries_what_it_carries_upright(seed: int, cross_check: CrossCheck) -> None:
    """No face lies along the axes: all blocks are YADE's polyhedra."""
    upright = scenes.shipped("slab_four_corners")
    chance = np.random.default_rng(seed)
    turn = scenes.rotation(chance.normal(size=3), chance.uniform(0.5, 2.5))
    yade, predicted = reactions(cross_check(scenes.moved(upright, turn, shift=(3.0, -1.0, 2.0), plane=False)))
    level = reactions(cross_check(upright))[1]
    assert predicted == pytest.approx(level, rel=SAME)
    assert yade == pytest.approx(level, rel=HALF_PER_CENT)


@pytest.mark.yade
@pytest.mark.parametrize("angle", [0.35, pytest.param(0.9, marks=pytest.mark.slow)])
def test_beams_crossed_askew_rest_on_the_corners_where_their_edges_cross(angle: float, cross_check: CrossCheck) -> None:
    """A beam lies askew over two rails. All contact points are crossings of edges, and none is a corner of a block."""
    across = scenes.rotation((0.0, 0.0, 1.0), angle)
    beam = np.array([(x, y, z) for x in (-0.2, 1.3) for y in (-0.1, 0.1) for z in (0.0, 0.2)]) @ across.T
    scene = scenes.build(
        scenes.box("fixed rail", (-0.1, -2.0, -0.2), (0.1, 2.0, 0.0), "fixed"),
        scenes.box("settling rail", (0.7, -2.0, -0.2), (0.8, 2.0, 0.0), "support"),
        scenes.block("beam", polyhedron=beam),
        inset=0.001,
        model="coulomb",
    )
    yade, predicted = reactions(cross_check(scene))
    assert yade == pytest.approx(predicted, rel=HALF_PER_CENT)


@pytest.mark.yade
@pytest.mark.slow
@pytest.mark.parametrize("axis", [(0.0, 1.0, 0.0), (1.0, 1.0, 0.0)])
def test_a_pier_that_tilts_under_a_slab_feels_the_moment_of_its_load(axis: tuple[float, float, float], cross_check: CrossCheck) -> None:
    """The head of the pier moves sideways, too, and slides under the slab."""
    slab = scenes.box("slab", (0.0, 0.0, 0.0), (1.0, 1.0, 0.15))
    settlement = {"axis": axis, "point": (0.0, 0.0, -0.2)}
    scene = scenes.build(slab, *piers(("fixed", "support", "fixed")), settlement=settlement, inset=0.001, model="coulomb", plane=False)
    yade, predicted = reactions(cross_check(scene))
    assert yade == pytest.approx(predicted, rel=HALF_PER_CENT)


@pytest.mark.yade
@pytest.mark.slow
@pytest.mark.parametrize("region", [((1.0, 0.0), (1.6, 0.6)), ((0.6, 0.0), (1.2, 0.2))], ids=["corner", "strip"])
def test_a_small_building_settles_at_its_corner_or_along_a_strip(region: tuple, cross_check: CrossCheck) -> None:
    walls = scenes.table("[building]", plan="rectangle", origin=(0.0, 0.0, 0.0), size=(1.6, 1.2), block=(0.4, 0.2, 0.2), courses=3)
    foundation = scenes.table("building.foundation", height=0.2, settling={"from": region[0], "to": region[1]})
    yade, predicted = reactions(cross_check(scenes.build(walls, foundation, inset=0.001, model="coulomb")))
    assert yade == pytest.approx(predicted, rel=HISTORY)


@pytest.mark.yade
@pytest.mark.long
def test_irregular_stones_of_a_mesh_at_any_angle_in_space_go_through_both_methods(tmp_path: Path) -> None:
    """The mesh of the shipped wall is turned and shifted, and gravity and settlement turn with it. The 3D model has the same reaction."""
    axis, degrees = (1.0, 2.0, -0.5), 40.0
    down = scenes.rotation(axis, np.radians(degrees)) @ scenes.DOWN
    text = (scenes.SHIPPED / "rubble_wall.toml").read_text(encoding="utf-8")
    motion = f"turn = {{ axis = {list(axis)}, degrees = {degrees} }}\nshift = [3.0, -2.0, 1.0]\n"
    text = text.replace("[[mesh]]\n", f"[[mesh]]\n{motion}").replace("direction = [0.0, 0.0, -1.0]", f"direction = {down.tolist()}")
    path = tmp_path / "turned.toml"
    path.write_text(f"gravity = {(9.81 * down).tolist()}\n{text}", encoding="utf-8")
    shutil.copy(scenes.SHIPPED / "rubble_wall.obj", tmp_path)
    turned, upright = run_scene(load_scene(path), tmp_path / "result", Silent(), with_yade=True), scenes.shipped("rubble_wall")
    least = solve_associated(assemble(upright), Drive.YIELDING).value
    assert turned["limit_analysis"]["associated"]["reaction"] == pytest.approx(least, abs=1e-6 * upright.weight)
    yade, predicted = reactions(turned)
    assert yade == pytest.approx(predicted, rel=HISTORY)
