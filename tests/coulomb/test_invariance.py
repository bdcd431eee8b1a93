"""A prediction depends neither on stiffness and units nor on order, mirror and frame. It does depend on the history of friction."""

from functools import cache

import numpy as np
import pytest
import scenes
from coulomb_problems import DIGIT, PLATEAU, SCENES, STRAIN, UNSLIDING, answer, bounds, great_wall, problem, small_wall, value

HALF = 3e-2  # relative: more joints slide where the right half settles, and soft joints slide later
SAME = 1e-3  # relative: the same problem in another order of blocks or another frame; the iteration amplifies round-off


@cache
def unmoved(name: str, plane: bool | str = "auto") -> float:
    """Value of a structure in its own units, order and frame."""
    return value(SCENES[name](plane=plane))


@pytest.mark.slow
@pytest.mark.parametrize("factor", [1.0 / 3.0, 3.0])
@pytest.mark.parametrize("split", [1.6, 1.2])
def test_plateau_does_not_depend_on_the_stiffness(split, factor) -> None:
    scene = great_wall(0.6, split)
    stiffness = problem(scene)[1]
    changed = {"normal_stiffness": factor * stiffness.normal, "max_travel": stiffness.travel}
    assert value(scene, **changed) == pytest.approx(value(scene), rel=PLATEAU if split == 1.6 else HALF)
    assert bounds(scene, **changed) == pytest.approx(bounds(scene), abs=DIGIT)


@pytest.mark.parametrize("travel", [1e-5, 0.05])
def test_travel_comes_with_the_stiffness_it_needs(travel) -> None:
    assert value(small_wall(), max_travel=travel) == pytest.approx(value(small_wall()), rel=SAME)


@pytest.mark.slow_after_first
@pytest.mark.parametrize(("scale", "density"), [(1e-3, 1e-3), (1e3, 1e3), (1e3, 1e-3)])
@pytest.mark.parametrize("name", ["wall", "turning base", "live load"])
def test_units_do_not_matter(name, scale, density) -> None:
    scene = SCENES[name]()
    factor = scale if scene.is_rotation else 1.0
    assert value(scenes.moved(scene, scale=scale, density=density)) == pytest.approx(factor * unmoved(name), rel=SAME)


@pytest.mark.parametrize("name", ["wall", "crossing beams", "turning base", "live load"])
def test_mirrored_structure_carries_the_same(name) -> None:
    scene = SCENES[name]()
    mirror = np.diag([-1.0, 1.0, 1.0])
    assert value(scenes.moved(scene, mirror)) == pytest.approx(unmoved(name), rel=SAME)


@pytest.mark.parametrize("name", ["wall", "crossing beams", "turning base", "live load"])
def test_order_of_blocks_does_not_matter(name) -> None:
    scene = SCENES[name]()
    order = np.random.default_rng(3).permutation(len(scene.blocks))
    assert value(scenes.moved(scene, order=order)) == pytest.approx(unmoved(name), rel=SAME)


@pytest.mark.slow_after_first
@pytest.mark.parametrize("name", ["wall", "crossing beams", "turning base", "live load"])
def test_turned_structure_carries_the_same(name) -> None:
    scene = SCENES[name](plane=False)
    about_z = scenes.rotation((0.0, 0.0, 1.0), 0.7)
    assert value(scenes.moved(scene, about_z, shift=(3.0, -2.0, 5.0), plane=False)) == pytest.approx(unmoved(name, plane=False), rel=SAME)


@pytest.mark.parametrize("name", ["wall", "crossing beams"])
def test_same_question_same_answer(name) -> None:
    first, second = (answer(SCENES[name]())[1] for _ in range(2))
    assert np.array_equal(first.forces, second.forces) and np.array_equal(first.twists, second.twists)
    assert (first.value, first.interval, first.iterations) == (second.value, second.interval, second.iterations)


def test_joints_without_shear_stiffness_carry_the_frictionless_reaction() -> None:
    assert value(small_wall(), shear_stiffness=0.0) == pytest.approx(value(small_wall(friction=0.0)), rel=UNSLIDING)


def test_wedging_is_remembered_and_stays_within_the_interval() -> None:
    """A wall that was first pushed against its settlement has a greater reaction at rest, and its joints keep friction of that history."""
    scene = small_wall()
    stiffness = problem(scene)[1]
    _, plain = answer(scene)
    assembly, wedged = answer(scene, wedging=0.1 * stiffness.travel)
    assert wedged.at_rest > plain.at_rest
    low, high = wedged.interval
    assert low - STRAIN * assembly.weight <= wedged.value <= high + STRAIN * assembly.weight
