"""Ties hold blocks and press joints together, in agreement with statics."""

import numpy as np
import pytest
import scenes
from loaded_scenes import BEAM, EXACT, STACK, friction, solved, tie

from comparison.figures.structure import assembly_figure
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble

LEANING = (*BEAM[:2], scenes.block("leaning", prism=(((0.0, 0.0), (1.0, 0.0), (2.2, 1.0), (1.2, 1.0)), (0.0, 1.0))))
LEANING_WEIGHT = 2000.0 * 9.81  # N


@pytest.mark.parametrize("tension", [0.2, 0.4])
def test_a_tie_to_the_ground_holds_a_leaning_block(tension: float) -> None:
    """The block turns about the inner edge of the fixed pad, and no joint slides. Moments about this edge give the reaction."""
    rod = tie(["leaning"], (1.2, 0.5, 1.0), (-2.0, 0.5, 1.0), tension * LEANING_WEIGHT)
    scene = scenes.build(*LEANING, rod, friction=0.9)
    assert scene.weight == pytest.approx(LEANING_WEIGHT)
    assert solved(scene).value == pytest.approx((0.9 - tension) / 0.8 * LEANING_WEIGHT, abs=EXACT * LEANING_WEIGHT)


@pytest.mark.parametrize(("tension", "stands"), [(0.0, False), (0.099, False), (0.101, True)])
def test_a_leaning_block_falls_where_its_tie_is_too_slack(tension: float, stands: bool) -> None:
    rods = (tie(["leaning"], (1.2, 0.5, 1.0), (-2.0, 0.5, 1.0), tension * LEANING_WEIGHT),) if tension else ()
    solution = solve_associated(assemble(scenes.build(*LEANING, *rods, friction=0.9)), Drive.YIELDING)
    assert solution.status is (Status.SOLVED if stands else Status.INFEASIBLE)
    assert solution.falling == (() if stands else ("leaning",))


def test_a_tie_between_blocks_pulls_both_with_equal_and_opposite_forces() -> None:
    rod = tie(["upper", "lower"], (0.5, 0.5, 0.3), (0.5, 0.5, 0.1), 750.0)
    scene = scenes.build(*STACK, rod, live=(1.0, 0.0, 0.0), settlement=None)
    assert scene.ties is not None
    assert scene.ties.forces.force == pytest.approx(np.array([[0.0, 0.0, -750.0], [0.0, 0.0, 750.0]]))
    assert assemble(scene).applied_load.sum() == pytest.approx(0.0, abs=1e-9)


def test_a_tie_through_a_joint_adds_to_its_friction() -> None:
    """The upper block slides at mu (W + T) over its own weight W."""
    rod = tie(["upper", "lower"], (0.5, 0.5, 0.4), (0.5, 0.5, 0.0), 500.0)
    scene = scenes.build(*STACK, rod, live=(1.0, 0.0, 0.0), settlement=None, friction=0.9)
    weak = scenes.build(*STACK, rod, friction(joints="bed", friction=0.2), live=(1.0, 0.0, 0.0), settlement=None, friction=0.9)
    weight = 2000.0 * 9.81 * 0.2
    assert solved(weak, Drive.LIVE).value == pytest.approx(0.2 * (weight + 500.0) / weight, abs=EXACT)
    assert solved(scene, Drive.LIVE).value > 0.3


@pytest.mark.parametrize(("anchor", "is_shown"), [(-2.0, True), (-50.0, False)])
def test_the_anchor_of_a_tie_is_drawn_unless_it_is_far_away(anchor: float, is_shown: bool) -> None:
    """An anchor at many times the size of the structure would reduce the structure to a dot, so its rod leaves the figure."""
    scene = scenes.build(*LEANING, tie(["leaning"], (1.2, 0.5, 1.0), (anchor, 0.5, 1.0), 1000.0), friction=0.9)
    low, high = assembly_figure(scene, assemble(scene)).axes[0].get_xlim()
    assert (low < anchor) == is_shown
    assert high - low < 12.0
