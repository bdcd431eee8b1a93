"""Each class of joints has its own friction coefficient, and a structure slides in its weakest joint."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
import scenes
from loaded_scenes import EXACT, PREDICTED, STACK, friction, solved

import la_core
from comparison.cli.scene_verbs.show import facts_table, scene_facts
from la_core.analysis import decided_model
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble

PRESSED = (
    scenes.box("wall", (-0.5, 0.0, -0.2), (0.0, 0.4, 0.5), "fixed"),
    scenes.box("pad", (0.0, 0.0, -0.2), (0.5, 0.4, 0.0), "support"),
    scenes.box("stone", (0.0, 0.0, 0.0), (0.5, 0.4, 0.5)),
)
PRESSED_WEIGHT = 2000.0 * 9.81 * 0.1  # N


@pytest.mark.parametrize(
    ("classes", "expected"),
    [
        ((friction(joints="footing", friction=0.2),), 0.2),
        ((friction(joints="bed", friction=0.15),), 0.15),
        ((friction(joints="bed", friction=0.15), friction(joints="bed", friction=0.25)), 0.25),
        ((friction(between=["upper", "lower"], friction=0.1), friction(joints="footing", friction=0.2)), 0.1),
        ((friction(between=["lower", "gr*"], friction=0.1),), 0.1),
        ((friction(joints="head", friction=0.0),), 0.3),
    ],
)
def test_a_stack_slides_in_its_weaker_joint(classes: Sequence[str], expected: float) -> None:
    scene = scenes.build(*STACK, *classes, live=(1.0, 0.0, 0.0), settlement=None, friction=0.3)
    assert solved(scene, Drive.LIVE).value == pytest.approx(expected, abs=EXACT)


@pytest.mark.parametrize("mu", [0.2, 0.5])
def test_a_stone_pressed_against_a_wall_hangs_on_the_friction_of_that_joint_alone(mu: float) -> None:
    """The joint with the pad is smooth, so that all of the force presses on the wall."""
    force = 0.6 * PRESSED_WEIGHT
    press = scenes.table("[load]", blocks=["stone"], force=(-force, 0.0, 0.0), at=(0.5, 0.2, 0.2))
    smooth = friction(between=["stone", "pad"], friction=0.0)
    scene = scenes.build(*PRESSED, press, smooth, friction=mu, model="coulomb", effects={"elasticity": "plateau"}, inset=1e-3)
    answer, expected = la_core.solve(scene), PRESSED_WEIGHT - mu * force
    assert answer.least == pytest.approx(expected, abs=EXACT * PRESSED_WEIGHT)
    assert answer.coulomb == pytest.approx(expected, abs=PREDICTED * PRESSED_WEIGHT)


def test_the_inset_does_not_change_classes_of_joints() -> None:
    scene = scenes.build(*STACK, friction(joints="bed", friction=0.1), live=(1.0, 0.0, 0.0), settlement=None, inset=1e-3)
    model = assemble(scene)
    assert np.array_equal(model.points.friction, model.with_inset(scene, 0.0).points.friction)
    assert sorted(set(model.points.friction.tolist())) == [0.1, 0.6]


@pytest.mark.parametrize(
    ("classes", "counts"),
    [
        ((friction(joints="bed", friction=0.2), friction(joints="footing", friction=0.1)), [1, 1]),
        ((friction(joints="head", friction=0.2),), [0]),
        ((friction(joints="bed", friction=0.2), friction(between=["upper", "lower"], friction=0.1)), [0, 1]),  # the last one counts
    ],
)
def test_show_counts_the_joints_of_every_class(classes: Sequence[str], counts: list[int]) -> None:
    scene = scenes.build(*STACK, *classes, live=(1.0, 0.0, 0.0), settlement=None, friction=0.3)
    facts = scene_facts(scene, decided_model(scene))
    assert [joints["interfaces"] for joints in facts["joint_classes"]] == counts
    assert all(
        row.endswith(f", {count} interface{'' if count == 1 else 's'}") for count, row in zip(counts, _friction_rows(facts), strict=True)
    )


def _friction_rows(facts: dict[str, Any]) -> list[str]:
    table = facts_table("stack", facts)
    return [str(cell) for cell in table.columns[0].cells if str(cell).startswith("friction of")]
