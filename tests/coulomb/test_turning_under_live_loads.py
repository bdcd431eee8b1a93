"""Under a live load blocks turn as far as in YADE, whose travel limits the fastest block, not the mean of all pushed masses."""

import math
from pathlib import Path

import generated_scenes
import numpy as np
import pytest
import scenes
import unusual_scenes
from coulomb_problems import problem

import comparison
import la_core
from la_core.analysis import analyse
from la_core.coulomb import STIFFER, CoulombSolution, followed_path, prediction
from la_core.limit import Status
from la_core.scene import Scene

WIDTH, HEIGHT = 0.1, 0.4  # of the light block, m
MULTIPLIER = (WIDTH - 0.002) / HEIGHT  # at which it tips about its contact points


def tipping(heavier: float) -> Scene:
    """A slender block tips on a wide block that stays. heavier: weight of the wide block over that of the slender one."""
    return scenes.build(
        scenes.box("ground", (-1.0, 0.0, -0.2), (1.0, 0.2, 0.0), "fixed"),
        scenes.box("wide", (-0.5, 0.0, 0.0), (0.5, 0.2, 0.2), density=2000.0 * heavier * WIDTH * HEIGHT / 0.2),
        scenes.box("slender", (-0.05, 0.0, 0.2), (-0.05 + WIDTH, 0.2, 0.2 + HEIGHT)),
        live=(1.0, 0.0, 0.0),
        inset=0.001,
        model="coulomb",
        effects={"rotation": "finite"},
    )


def pace(heavier: float) -> float:
    """Speed of the slender block's centroid, as it tips about its lower edge, over the mean speed of both weights along the load."""
    return (1.0 + heavier) * math.hypot(HEIGHT, WIDTH) / HEIGHT


def predicted(scene: Scene) -> CoulombSolution:
    coulomb = analyse(scene).coulomb
    assert coulomb is not None and coulomb.status is Status.SOLVED
    return coulomb


def travels(scene: Scene, coulomb: CoulombSolution) -> float:
    """Travels of the path's curve, without the last stretch to its end."""
    return float(coulomb.path_settlement[-1]) / analyse(scene).stiffness.travel


@pytest.mark.parametrize("heavier", [0.5, 4.0])
def test_blocks_turn_until_the_fastest_has_covered_the_travel(heavier: float) -> None:
    """The heavier the block that stays, the smaller the mean motion when the slender block has covered its travel."""
    scene = tipping(heavier)
    coulomb = predicted(scene)
    assert coulomb.value == pytest.approx(MULTIPLIER, rel=5e-3)
    assert travels(scene, coulomb) == pytest.approx(STIFFER / pace(heavier), rel=0.02)


def test_a_light_block_covers_its_travel_before_the_mean_motion_covers_one() -> None:
    """The path goes on until the curve is flat, at most four times as far."""
    scene = tipping(60.0)
    coulomb = predicted(scene)
    assert coulomb.value == pytest.approx(MULTIPLIER, rel=5e-3)
    assert STIFFER / pace(60.0) < 0.3 and 0.99 <= travels(scene, coulomb) * pace(60.0) / STIFFER <= 1.01 * followed_path.TURNED


def test_a_path_is_not_cut_before_its_viscosity_has_fallen() -> None:
    """The fastest block has then gone much farther than in YADE."""
    scene = tipping(400.0)
    coulomb = predicted(scene)
    assert coulomb.value == pytest.approx(MULTIPLIER, rel=1e-4) and coulomb.uncertainty < 1e-3
    assert travels(scene, coulomb) == pytest.approx(1.0)


def test_joints_of_a_given_stiffness_turn_over_one_travel_of_the_fastest_block() -> None:
    own = problem(tipping(4.0))[1].normal
    scene = la_core.variant(tipping(4.0), {"yade.normal_stiffness": own, "yade.shear_stiffness": own})
    assert 0.99 <= travels(scene, predicted(scene)) * pace(4.0) <= 1.01 * followed_path.TURNED


@pytest.mark.slow
def test_no_value_after_a_release_is_told_where_the_fastest_block_has_gone_too_far() -> None:
    """By the end of the first travel of the mean motion, the fastest block has gone 18 travels in one corner and 5 in the other."""
    far, near = (la_core.variant(generated_scenes.drawn(number, 20261201).scene, {"effects.rotation": "auto"}) for number in (65, 95))
    assert np.isnan(predicted(far).released)
    assert predicted(near).released == pytest.approx(0.3828, rel=1e-3)


def test_smooth_joints_of_large_structures_turn_as_far(monkeypatch: pytest.MonkeyPatch) -> None:
    """Smooth joints become sharp over another three tenths of the way."""
    monkeypatch.setattr(prediction, "LARGE", 0.0)
    scene = tipping(4.0)
    coulomb = analyse(scene).coulomb
    assert coulomb is not None and coulomb.value == pytest.approx(MULTIPLIER, rel=5e-3)
    assert travels(scene, coulomb) == pytest.approx((1.0 + followed_path.SHARPENED) * STIFFER / pace(4.0), rel=0.02)


@pytest.mark.slow
@pytest.mark.yade
def test_yade_pushes_as_far(tmp_path: Path) -> None:
    scene = tipping(4.0)
    run = comparison.run(scene, tmp_path, quiet=True)
    assert run.verdict == "agree"
    on_stiffer_joints = travels(scene, predicted(scene)) * analyse(scene).stiffness.travel / STIFFER
    assert run.summary["yade"]["settlement"] == pytest.approx(on_stiffer_joints, rel=0.02)


@pytest.mark.slow_after_first
@pytest.mark.parametrize(
    ("scene", "measured"),
    [
        pytest.param(generated_scenes.drawn(15, 20261201).scene, 0.4610, id="corner"),
        pytest.param(unusual_scenes.drawn(15).scene, 0.3191, id="corner whose mean motion comes to another plateau"),
        pytest.param(generated_scenes.drawn(5, 20261201).scene, 0.4244, id="corner that bears more once its blocks have turned"),
    ],
)
def test_finite_rotations_lead_to_the_multiplier_of_yade(scene: Scene, measured: float) -> None:
    """The multipliers are YADE's over the travel of the fastest block, with joints 16 times as stiff. Over that of the mean motion the
    first two scenes come to 0.453 and 0.263. With small rotations the last scene has 0.4200.
    """
    coulomb = predicted(la_core.variant(scene, {"effects.rotation": "finite"}))
    assert coulomb.value == pytest.approx(measured, rel=5e-3)
    assert np.isnan(coulomb.released)
