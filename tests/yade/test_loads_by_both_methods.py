"""Dead loads, ties and classes of joints by both methods, against statics by hand."""

from pathlib import Path
from typing import Any

import pytest
import scenes
from conftest import Silent

from comparison.workflow.one_scene import run_scene
from la_core.scene.scene import load_scene

INSET = 1e-3  # m
SAME = 1e-3  # of the weight: agreement of both methods with statics
WEDGED = 5e-3  # relative: the wedging leaves a little of its thrust in the arch
BEAM = (
    scenes.box("left", (0.0, 0.0, -0.2), (0.2, 1.0, 0.0), "fixed"),
    scenes.box("right", (0.8, 0.0, -0.2), (1.0, 1.0, 0.0), "support"),
)
OWN = 2000.0 * 9.81 * 0.3  # N
LEANING_WEIGHT = 2000.0 * 9.81  # N
PRESSED_WEIGHT = 2000.0 * 9.81 * 0.1  # N


def statics(weight_arm: float, moment: float) -> float:
    """Force on the right pad, N, as the block turns about the inner edge of the left one; both methods have the inset.

    weight_arm: moment of the weights about x = 0, N m. moment: sum of the vertical forces, N.
    """
    edge = 0.2 - INSET
    return (weight_arm - edge * moment) / (1.0 - INSET - edge)


def both(tmp_path: Path, *parts: str, **options: Any) -> tuple[dict[str, Any], float, float]:
    """The comparison, YADE's reaction (N) or multiplier and the predicted one, of a run that agrees."""
    path = tmp_path / "scene.toml"
    path.write_text(scenes.text(*parts, inset=INSET, model="auto", **options), encoding="utf-8")
    summary = run_scene(load_scene(path), tmp_path / "result", Silent(), with_yade=True)
    assert summary["verdict"] == "agree", summary["reason"]
    predicted = summary["limit_analysis"]["coulomb"]["multiplier" if "live" in options else "reaction"]
    return summary, summary["yade"]["reaction"], predicted


@pytest.mark.yade
@pytest.mark.parametrize("y", [0.5, pytest.param(0.7, marks=pytest.mark.slow)])
def test_an_eccentric_load_is_shared_by_the_lever_arms(y: float, tmp_path: Path) -> None:
    """A load beside the middle of the depth needs a model in space. The pads bear along the whole depth, so the arms are the same."""
    size = 8000.0
    load = scenes.table("[load]", blocks=["beam"], force=(0.0, 0.0, -size), at=(0.7, y, 0.3))
    summary, run, predicted = both(tmp_path, *BEAM, scenes.box("beam", (0.0, 0.0, 0.0), (1.0, 1.0, 0.3)), load)
    assert summary["effects"]["plane"] is (y == 0.5)
    expected = statics(0.5 * OWN + 0.7 * size, OWN + size)
    assert (run, predicted) == (pytest.approx(expected, abs=SAME * (OWN + size)), pytest.approx(expected, abs=SAME * (OWN + size)))


@pytest.mark.yade
def test_a_tie_holds_a_block_that_leans_beyond_its_base(tmp_path: Path) -> None:
    tension = 0.3 * LEANING_WEIGHT
    leaning = scenes.block("leaning", prism=(((0.0, 0.0), (1.0, 0.0), (2.2, 1.0), (1.2, 1.0)), (0.0, 1.0)))
    rod = scenes.table("[tie]", blocks=["leaning"], **{"from": (1.2, 0.5, 1.0)}, to=(-2.0, 0.5, 1.0), force=tension)
    _, run, predicted = both(tmp_path, *BEAM, leaning, rod, friction=0.9)
    expected = statics(1.1 * LEANING_WEIGHT - 1.0 * tension, LEANING_WEIGHT)
    assert (run, predicted) == (pytest.approx(expected, abs=SAME * LEANING_WEIGHT), pytest.approx(expected, abs=SAME * LEANING_WEIGHT))


@pytest.mark.slow_after_first
@pytest.mark.yade
@pytest.mark.parametrize("mu", [0.2, 0.5])
def test_a_stone_pressed_against_a_wall_slides_by_the_friction_of_that_joint(mu: float, tmp_path: Path) -> None:
    force = 0.6 * PRESSED_WEIGHT
    parts = (
        scenes.box("wall", (-0.5, 0.0, -0.2), (0.0, 0.4, 0.5), "fixed"),
        scenes.box("pad", (0.0, 0.0, -0.2), (0.5, 0.4, 0.0), "support"),
        scenes.box("stone", (0.0, 0.0, 0.0), (0.5, 0.4, 0.5)),
        scenes.table("[load]", blocks=["stone"], force=(-force, 0.0, 0.0), at=(0.5, 0.2, 0.2)),
        scenes.table("[friction]", between=["stone", "pad"], friction=0.0),
    )
    _, run, predicted = both(tmp_path, *parts, friction=mu)
    expected = PRESSED_WEIGHT - mu * force
    assert (run, predicted) == (pytest.approx(expected, abs=SAME * PRESSED_WEIGHT), pytest.approx(expected, abs=SAME * PRESSED_WEIGHT))


@pytest.mark.yade
def test_a_flat_arch_is_wedged_in_before_its_load_acts(tmp_path: Path) -> None:
    """Hinges form at the lower edges of the abutments and the upper edges of the middle block. Half of the load goes to either side."""
    own, load = 2000.0 * 9.81 * 2.0 * 0.3 * 0.4, 2000.0
    text = (scenes.SHIPPED / "flat_arch.toml").read_text(encoding="utf-8")
    text = text[: text.index("[expected]")] + scenes.table("[load]", blocks=["arch 1.2"], force=(0.0, 0.0, -load)) + "\n"
    path = tmp_path / "loaded_arch.toml"
    path.write_text(text, encoding="utf-8")
    summary = run_scene(load_scene(path), tmp_path / "result", Silent(), with_yade=True)
    assert summary["yade"]["status"] == "plateau", summary["yade"]["message"]
    expected = (own * 2.0 / 9.0 + load * 2.0 / 6.0) / (0.4 - 2.0 * INSET)
    for reaction in (summary["yade"]["reaction"], summary["limit_analysis"]["coulomb"]["reaction"]):
        assert reaction == pytest.approx(expected, rel=WEDGED)


@pytest.mark.slow_after_first
@pytest.mark.yade
@pytest.mark.parametrize("rod", [0.0, 0.4], ids=["free", "held by a rod"])
def test_a_floor_is_pushed_with_the_block_that_carries_it(rod: float, tmp_path: Path) -> None:
    """The block tips about its outer edge. Its weight, the floor and the rod resist the push on the masses of block and floor."""
    breadth, height, size = 0.5, 0.7, 3000.0
    weight = 2000.0 * 9.81 * breadth * height
    floor = scenes.table("[load]", blocks=["block"], mass=size / 9.81, at=(0.25, 0.5, height))
    held = scenes.table("[tie]", blocks=["block"], **{"from": (0.0, 0.5, height)}, to=(-1.0, 0.5, height), force=rod * weight)
    plane = scenes.box("plane", (-0.5, 0.0, -0.2), (1.0, 1.0, 0.0), "fixed")
    block = scenes.box("block", (0.0, 0.0, 0.0), (breadth, 1.0, height))
    ties = (held,) if rod else ()
    summary, run, predicted = both(tmp_path, plane, block, floor, *ties, friction=0.9, live=(1.0, 0.0, 0.0))
    standing = (weight + size) * (0.5 * breadth - INSET) + rod * weight * height
    expected = standing / (0.5 * weight * height + size * height)
    assert summary["weight"] == pytest.approx(weight + size)
    assert (run, predicted) == (pytest.approx(expected, rel=SAME), pytest.approx(expected, rel=SAME))
