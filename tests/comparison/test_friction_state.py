"""The friction state of a plateau, by hand: a block on level ground bears a push of at most mu times its normal force."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scenes
from runs import perfect_run, with_answers

from comparison.judge.checks.friction_state import check_friction_state, check_steadiness
from comparison.verdict.check import Check, Verdict
from comparison.yade import Results
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.limit.problem import Drive

FRICTION = 0.35


@pytest.fixture(scope="module")
def pushed() -> LimitAnalysis:
    """A block on two contact points, which slides under a far smaller push than it tips."""
    ground = scenes.box("ground", (-2.0, 0.0, -0.2), (3.0, 0.15, 0.0), "fixed")
    block = scenes.box("block", (0.0, 0.0, 0.0), (0.6, 0.15, 0.4))
    return analyse(scenes.build(ground, block, inset=1e-3, live=(1.0, 0.0, 0.0), friction=FRICTION))


def state(analysis: LimitAnalysis, pressed: tuple[float, float], held: float, uncertainty: float = 0.0) -> Check:
    """Return the check for the normal forces of both points and the friction force on the block, as shares of the weight."""
    weight, upward = analysis.assembly.weight, np.sign(analysis.assembly.contact_blocks[1] - analysis.assembly.contact_blocks[0])
    forces = weight * np.array([[-held / 2.0, 0.0, share] for share in pressed]) * upward[:, None]
    bound = {Drive.YIELDING: analysis.bounds[Drive.LIVE]}
    run = perfect_run(with_answers(analysis, bounds=bound), reaction=held, uncertainty=uncertainty)
    run.poses.forces[:] = forces
    return check_friction_state(Results(analysis, run))


@pytest.mark.parametrize(
    ("pressed", "held", "most", "tolerance", "verdict"),
    [
        ((0.5, 0.5), 0.35, 0.35, 0.0035, Verdict.AGREE),
        ((0.9, 0.1), 0.35, 0.35, 0.0035, Verdict.AGREE),
        ((0.5, 0.5), 0.347, 0.35, 0.00347, Verdict.AGREE),
        ((0.5, 0.5), 0.345, 0.35, 0.00345, Verdict.INCONCLUSIVE),
        ((0.6, 0.6), 0.35, 0.42, 0.0035, Verdict.INCONCLUSIVE),
        ((1.2, -0.2), 0.42, 0.42, 0.0042, Verdict.AGREE),  # a point in tension has no friction
        ((0.5, 0.5), -0.35, 0.35, 0.0035, Verdict.INCONCLUSIVE),  # friction pushes the block
        ((0.0, 0.0), 0.5e-4, 0.0, 1e-4, Verdict.AGREE),  # within the least tolerance
    ],
)
def test_a_push_is_compared_with_the_one_that_the_normal_forces_allow(
    pushed: LimitAnalysis, pressed: tuple[float, float], held: float, most: float, tolerance: float, verdict: Verdict
) -> None:
    check = state(pushed, pressed, held)
    assert check.verdict is verdict
    assert (check.limit_analysis, check.yade, check.tolerance) == pytest.approx((most, held, tolerance), rel=1e-5, abs=1e-9)
    assert (f"could be as high as {most:.3g}" in check.reason) is (verdict is not Verdict.AGREE)
    assert state(pushed, pressed, held, uncertainty=0.01).tolerance == pytest.approx(tolerance + 0.01)


def test_normal_forces_under_which_nothing_is_in_balance_decide_nothing() -> None:
    """Friction alone can balance the horizontal part of gravity. A block without normal forces has no friction."""
    ground = scenes.box("ground", (-2.0, 0.0, -0.2), (3.0, 0.15, 0.0), "fixed")
    block = scenes.box("block", (0.0, 0.0, 0.0), (0.6, 0.15, 0.4))
    leaning = analyse(scenes.build(ground, block, inset=1e-3, gravity=(1.0, 0.0, -9.81), live=(0.0, 0.0, 1.0), friction=FRICTION))
    check = state(leaning, (0.0, 0.0), 0.2)
    assert check.verdict is Verdict.INCONCLUSIVE and check.limit_analysis is None
    assert "ended as infeasible, so these forces are not those of one quasi-static state" in check.reason


# --- scatter ----------------------------------------------------------------------------------------------------------------------

WEIGHT = 2000.0  # N


def steadiness(reaction: float, amplitude: float, slope: float = 0.0) -> Check:
    """Return the check of a plateau over the second half of the settlement.

    Its rows lie alternately above and below its line. The rows before it lie far from the line.
    """
    settlement = np.linspace(0.0, 1.0, 41)
    rows = reaction + slope * settlement + amplitude * np.where(np.arange(41) % 2, 1.0, -1.0)
    series = {"settlement": settlement, "reaction": np.where(settlement < 0.5, 5.0 * WEIGHT, rows)}
    ended = SimpleNamespace(reaction=reaction, slope=slope, plateau_start=0.5)
    scene: Any = SimpleNamespace(live=None, weight=WEIGHT, is_rotation=False, quantity="reaction")
    results: Any = SimpleNamespace(
        scene=scene,
        analysis=SimpleNamespace(scene=scene, assembly=SimpleNamespace(length=0.4)),
        recorded=SimpleNamespace(result=ended, settling=series.__getitem__),
    )
    return check_steadiness(results)


@pytest.mark.parametrize(
    ("reaction", "amplitude", "share"),
    [(600.0, 6.0, 0.01), (-600.0, 6.0, 0.01), (600.0, 2.4, 0.004), (0.0, 0.2, 0.01), (10.0, 0.2, 0.01), (0.0, 0.08, 0.004)],
)
@pytest.mark.parametrize("slope", [0.0, 300.0])
def test_scatter_is_a_share_of_the_reaction_but_at_least_of_a_hundredth_of_the_weight(
    reaction: float, amplitude: float, share: float, slope: float
) -> None:
    check = steadiness(reaction, amplitude, slope)
    assert check.verdict is Verdict.AGREE and check.yade == pytest.approx(share, rel=2e-3)  # the mean of 21 rows is not on the line
    assert ("Stick-slip" in check.reason) is (share > 0.005)


def test_the_scatter_of_no_row_is_unknown() -> None:
    settlement = np.linspace(0.0, 0.4, 5)
    ended = SimpleNamespace(reaction=600.0, slope=0.0, plateau_start=0.5)
    scene: Any = SimpleNamespace(live=None, weight=WEIGHT, is_rotation=False, quantity="reaction")
    series = {"settlement": settlement, "reaction": np.full(5, 600.0)}
    results: Any = SimpleNamespace(
        scene=scene, analysis=SimpleNamespace(scene=scene), recorded=SimpleNamespace(result=ended, settling=series.__getitem__)
    )
    check = check_steadiness(results)
    assert check.yade is None and "too few rows" in check.reason
