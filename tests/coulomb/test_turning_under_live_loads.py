"""Blocks that turn under a live load turn as far as in YADE, whose travel limits the fastest block, not the mean of all that is pushed."""

import math

import generated_scenes
import numpy as np
import pytest
import scenes
import unusual_scenes

import comparison
import la_core
from la_core.analysis import analyse
from la_core.coulomb import STIFFER, CoulombSolution, followed_path, prediction
from la_core.limit import Status
from la_core.scene import Scene

WIDTH, HEIGHT = 0.1, 0.4  # of the light block, m
MULTIPLIER = (WIDTH - 0.002) / HEIGHT  # at which it tips about its contact points


def tipping(heavier: float) -> Scene:
    """A slender block that tips on a wide one so many times heavier, which stays."""
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
    """Speed of the slender block, which tips about its lower edge, over the mean speed along the load of both weights."""
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
    """The heavier the block that stays, the less the mean motion when the other one has covered its travel."""
    scene = tipping(heavier)
    coulomb = predicted(scene)
    assert coulomb.value == pytest.approx(MULTIPLIER, rel=5e-3)
    assert travels(scene, coulomb) == pytest.approx(STIFFER / pace(heavier), rel=0.02)


def test_a_light_block_covers_its_travel_before_the_mean_motion_covers_one() -> None:
    """Its path goes on until the curve is flat, at most four times as far."""
    scene = tipping(60.0)
    coulomb = predicted(scene)
    assert coulomb.value == pytest.approx(MULTIPLIER, rel=5e-3)
    assert STIFFER / pace(60.0) < 0.3 and 0.99 <= travels(scene, coulomb) * pace(60.0) / STIFFER <= 1.01 * followed_path.TURNED


def test_smooth_joints_of_large_structures_turn_as_far(monkeypatch: pytest.MonkeyPatch) -> None:
    """Their joints become sharp on another three tenths of the way."""
    monkeypatch.setattr(prediction, "LARGE", 0.0)
    scene = tipping(4.0)
    coulomb = analyse(scene).coulomb
    assert coulomb is not None and coulomb.value == pytest.approx(MULTIPLIER, rel=5e-3)
    assert travels(scene, coulomb) == pytest.approx((1.0 + followed_path.SHARPENED) * STIFFER / pace(4.0), rel=0.02)


def test_yade_pushes_as_far() -> None:
    scene = tipping(4.0)
    run = comparison.run(scene, quiet=True)
    assert run.verdict == "agree"
    on_stiffer_joints = travels(scene, predicted(scene)) * analyse(scene).stiffness.travel / STIFFER
    assert run.summary["yade"]["settlement"] == pytest.approx(on_stiffer_joints, rel=0.02)


@pytest.mark.parametrize(
    ("scene", "yade"),
    [
        pytest.param(generated_scenes.drawn(15, 20261201).scene, 0.4610, id="corner"),
        pytest.param(unusual_scenes.drawn(15).scene, 0.3191, id="corner whose mean motion comes to another plateau"),
    ],
)
def test_finite_rotations_lead_to_the_multiplier_of_yade(scene: Scene, yade: float) -> None:
    """Measured over the travel of the fastest block, with joints 16 times as stiff. Over that of the mean motion: 0.453 and 0.263."""
    coulomb = predicted(la_core.variant(scene, {"effects.rotation": "finite"}))
    assert coulomb.value == pytest.approx(yade, rel=5e-3)
    assert np.isnan(coulomb.released)
