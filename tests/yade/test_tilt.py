"""Tilting ground: closed forms by both methods, the equivalent push, the stated angle, and refused scenes."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scenes
from conftest import Silent
from numpy.testing import assert_allclose

from comparison.cli.conclude import lines_below
from comparison.judge import comparison_summary
from comparison.numbers import Units
from comparison.report.plain_words import plain_words
from comparison.workflow import run_scene
from comparison.yade import Results
from la_core.analysis import analyse
from la_core.errors import SceneError
from la_core.scene import Scene, tilt_angles

INSET, PER_MILLE = 1e-3, 1e-3
PLANE = scenes.box("plane", (-1.0, 0.0, -0.2), (2.0, 0.3, 0.0), "fixed")
ABOUT_Y = (0.0, 1.0, 0.0)


def stack(breadth: float, height: float, courses: int = 1, *parts: str, **options: Any) -> Scene:
    """Equal blocks on a plane that is tilted about y."""
    step = height / courses
    blocks = [scenes.box(f"block {k}", (0.0, 0.0, k * step), (breadth, 0.3, (k + 1) * step)) for k in range(courses)]
    return scenes.build(PLANE, *blocks, *parts, **({"inset": INSET, "model": "coulomb", "tilt": ABOUT_Y} | options))


FLOOR = 100.0  # kg
FLOOR_PARTS = (scenes.table("[load]", name="floor", blocks=("block 0",), mass=FLOOR, at=(0.25, 0.15, 0.7)),)
OWN = 2000.0 * 0.5 * 0.7 * 0.3  # kg
CLOSED_FORMS = {  # tangent of the angle
    "slides": (lambda: stack(0.6, 0.4, friction=0.35), 0.35),
    "tips": (lambda: stack(0.5, 0.7, friction=0.9), (0.5 - 2.0 * INSET) / 0.7),
    "stack tips": (lambda: stack(0.5, 1.0, 10, friction=0.7), (0.5 - 2.0 * INSET) / 1.0),
    "tips under a floor": (
        lambda: stack(0.5, 0.7, 1, *FLOOR_PARTS, friction=0.9),
        (OWN + FLOOR) * (0.25 - INSET) / (0.35 * OWN + 0.7 * FLOOR),
    ),
}


@pytest.mark.slow_after_first
@pytest.mark.yade
@pytest.mark.parametrize("name", [n if n in ("slides", "tips") else pytest.param(n, marks=pytest.mark.slow) for n in CLOSED_FORMS])
def test_both_methods_find_the_angle_of_the_closed_form(name: str, tmp_path: Path) -> None:
    build, tangent = CLOSED_FORMS[name]
    summary = run_scene(build(), tmp_path / "results", Silent(), with_yade=True, figures=lambda _: {})
    angle = math.degrees(math.atan(tangent))
    coulomb, yade = summary["limit_analysis"]["coulomb"], summary["yade"]
    assert summary["verdict"] == "agree", summary["reason"]
    assert coulomb["angle"] == pytest.approx(angle, rel=PER_MILLE) and yade["angle"] == pytest.approx(angle, rel=PER_MILLE)
    assert yade["multiplier"] == yade["reaction"] == pytest.approx(tangent, rel=PER_MILLE)
    assert abs(yade["angle"] - angle) <= yade["angle_uncertainty"] <= 5.0 * PER_MILLE * angle
    assert summary["structure"]["tilt"] == list(ABOUT_Y)
    (sentence, *_) = lines_below(summary)
    assert f"{math.floor(10.0 * yade['angle']) / 10.0:.1f}" in sentence and sentence.endswith(
        "the multiplier is the tangent of this angle."
    )
    assert any("a tilt of the ground" in words for words in plain_words(summary, Units(None)))


@pytest.mark.parametrize(
    ("axis", "gravity", "push"),
    [
        ((0.0, 2.0, 0.0), (0.0, 0.0, -9.81), (1.0, 0.0, 0.0)),  # the side at greater x goes down, as the right hand turns
        ((0.0, -1.0, 0.0), (0.0, 0.0, -9.81), (-1.0, 0.0, 0.0)),
        ((1.0, 0.0, 0.0), (0.0, 0.0, -9.81), (0.0, -1.0, 0.0)),
        ((0.0, 0.0, 1.0), (-9.81, 0.0, 0.0), (0.0, 1.0, 0.0)),
    ],
)
def test_a_tilt_pushes_where_the_ground_goes_down(axis: Any, gravity: Any, push: Any) -> None:
    scene = stack(0.5, 0.7, tilt=axis, gravity=gravity)
    assert scene.live is not None and scene.tilt is not None
    assert_allclose(scene.live, push, atol=1e-15)
    turn = scenes.rotation(axis, 0.3)  # of the ground, so that gravity turns back in its axes
    down = np.array(gravity) / 9.81
    assert_allclose(turn.T @ down, math.cos(0.3) * (down + math.tan(0.3) * scene.live), atol=1e-12)


def test_a_tilt_is_the_push_and_the_same_structure_on_ground_tilted_by_the_angle_fails_without_one() -> None:
    parts = scenes.wall(3, 4)
    tilted = analyse(scenes.build(*parts, tilt=ABOUT_Y))
    pushed = analyse(scenes.build(*parts, live=(1.0, 0.0, 0.0)))
    multiplier = tilted.bounds[tilted.main].value
    assert multiplier == pytest.approx(pushed.bounds[pushed.main].value, abs=1e-9)
    angle = math.radians(tilt_angles(tilted.scene.tilt, multiplier)["angle"])
    gravity = 9.81 * np.array([math.sin(angle), 0.0, -math.cos(angle)])
    critical = analyse(scenes.build(*parts, live=(1.0, 0.0, 0.0), gravity=gravity))
    assert critical.bounds[critical.main].value == pytest.approx(0.0, abs=1e-6)


def test_a_summary_has_the_angle_of_yades_multiplier_and_its_uncertainty() -> None:
    """The uncertainty is half of the change of the angle between both ends of the multiplier."""
    run = {"status": "plateau", "message": "", "reaction": 0.35, "uncertainty": 2e-3}
    yade = comparison_summary(Results(analyse(stack(0.6, 0.4, friction=0.35))), run, [], [])["yade"]
    low, angle, high = (math.degrees(math.atan(tangent)) for tangent in (0.348, 0.35, 0.352))
    assert yade["multiplier"] == 0.35 and yade["angle"] == pytest.approx(angle)
    assert yade["angle_uncertainty"] == pytest.approx(0.5 * (high - low), rel=1e-4)


def test_an_angle_has_the_uncertainty_of_its_tangent() -> None:
    low, high = (tilt_angles(np.array(ABOUT_Y), 0.7 + change)["angle"] for change in (-1e-4, 1e-4))
    found = tilt_angles(np.array(ABOUT_Y), 0.7, 1e-4)
    assert found["angle_uncertainty"] == pytest.approx(0.5 * (high - low), rel=1e-6)
    assert math.isnan(tilt_angles(np.array(ABOUT_Y), None)["angle"]) and tilt_angles(None, 0.7) == {}


MOVES = scenes.table("live", direction=(1.0, 0.0, 0.0))
FORCE = scenes.table("[load]", name="cable", blocks=("block 0",), force=(0.0, 0.0, -1000.0))
TIE = scenes.table("[tie]", name="rod", blocks=("block 0",), **{"from": (0.0, 0.1, 0.3), "to": (-0.5, 0.1, 0.3), "force": 100.0})


@pytest.mark.parametrize(
    ("parts", "options", "message"),
    [
        ((), {"tilt": (0.0, 0.0, 1.0)}, "tilt.axis"),
        ((), {"tilt": (0.0, 1.0, 0.2)}, "must be level, at right angles to gravity"),
        ((MOVES,), {}, r"needs one table out of \[settlement\], \[live\] and \[tilt\]; it has \[live\] and \[tilt\]"),
        ((FORCE,), {}, 'load "cable".force: a force does not turn with gravity'),
        ((TIE,), {}, 'tie "rod": the tension of a tie does not turn with gravity'),
        ((scenes.box("moving", (3.0, 0.0, 0.0), (3.1, 0.3, 0.1), "support"),), {}, r"tilt: a \[tilt\] scene has no support"),
    ],
)
def test_what_does_not_go_with_a_tilt_is_refused(parts: tuple[str, ...], options: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        stack(0.5, 0.7, 1, *parts, **options)
