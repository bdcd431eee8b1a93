"""Sliding bodies have the forces of statics: only one force polygon exists, because every sliding joint has its friction angle.

Where blocks only translate and every joint that moves slides, each force leans by the angle of friction phi against the slip. Two such
forces and the weight balance each other in one way, so strain of the joints and friction's history cannot change the value. Dilatancy
changes the value only where it forbids the motion. The associated bound then differs and is derived here, too.
"""

import math

import pytest
import scenes
from coulomb_problems import answer

from la_core.limit.associated import solve_associated
from la_core.limit.problem import Drive
from la_core.scene.scene import Scene

STRAIN = 1e-4  # relative: strain of the joints before all of them slide


def prism(name: str, profile: list[tuple[float, float]], role: str = "free") -> str:
    return scenes.block(name, role, prism=(profile, (0.0, 1.0)))


def holds(scene: Scene, value: float, bound: float, drive: Drive = Drive.YIELDING) -> None:
    """Check the prediction and the associated bound; reactions are over W."""
    assembly, solution = answer(scene)
    unit = 1.0 if drive is Drive.LIVE else assembly.weight
    assert solution.value / unit == pytest.approx(value, rel=STRAIN)
    assert solve_associated(assembly, drive).value / unit == pytest.approx(bound, rel=1e-6)


@pytest.mark.parametrize(("degrees", "friction"), [(45.0, 0.3), (60.0, 0.5)])
def test_a_wedge_that_is_drawn_out_from_under_a_block_at_a_wall(degrees: float, friction: float) -> None:
    """The block sinks along the wall and slips down the wedge, whose face rises by a away from the wall.

    The wedge's force leans by phi toward the slope's upper side: it is at a - phi to the vertical, and its part against the wall is
    N = V tan(a - phi) with V its vertical part. The wall bears mu N, so V = W - mu N, and R = N = W / (mu + 1 / tan(a - phi)).
    """
    slope, phi = math.radians(degrees), math.atan(friction)
    top = math.tan(slope)
    scene = scenes.build(
        scenes.box("wall", (-1.0, 0.0, -0.5), (0.0, 1.0, top + 1.0), "fixed"),
        prism("wedge", [(0.0, -0.5), (1.0, -0.5), (1.0, top), (0.0, 0.0)], "support"),
        prism("block", [(0.0, 0.0), (1.0, top), (1.0, top + 0.6), (0.0, top + 0.6)]),
        friction=friction,
        settlement=(1.0, 0.0, 0.0),
    )
    value = 1.0 / (friction + 1.0 / math.tan(slope - phi))
    holds(scene, value, value)  # these forces are also the least of all that balance the weight


def test_a_wedge_that_holds_itself_must_be_pulled_out() -> None:
    """A face flatter than phi carries the block along until a wall stops it, on the side where the wedge is high.

    Now the wedge's force drags the block against the wall, which bears mu N of the weight as the block sinks:
    N = (W - mu N) tan(phi - a), and R = -N. Associated joints may not slide so: their block would have to part from the wall. With
    the block at rest the wall's friction may press it down instead: N = (W + mu N) tan(phi - a).
    """
    slope, friction = math.radians(15.0), 0.5
    drag, top = math.tan(math.atan(friction) - slope), math.tan(slope)
    scene = scenes.build(
        scenes.box("wall", (1.0, 0.0, -0.5), (2.0, 1.0, 2.0), "fixed"),
        prism("wedge", [(0.0, -0.5), (1.0, -0.5), (1.0, top), (0.0, 0.0)], "support"),
        prism("block", [(0.0, 0.0), (1.0, top), (1.0, 1.0), (0.0, 1.0)]),
        friction=friction,
        settlement=(1.0, 0.0, 0.0),
    )
    holds(scene, -drag / (1.0 + friction * drag), -drag / (1.0 - friction * drag))


def test_a_keystone_between_skewbacks_of_two_slopes() -> None:
    """The right skewback leaves and the keystone slides down both faces, which lean by a and b from the vertical.

    Each force is a + phi, or b + phi, above the level; both have the same thrust H, and H tan(a + phi) + H tan(b + phi) = W.
    """
    left, right, friction = math.radians(20.0), math.radians(30.0), 0.3
    phi, high, wide = math.atan(friction), 0.5, 0.6
    low, end = high * math.tan(left), wide - high * math.tan(right)
    scene = scenes.build(
        prism("left", [(-0.5, 0.0), (low, 0.0), (0.0, high), (-0.5, high)], "fixed"),
        prism("right", [(end, 0.0), (wide + 0.5, 0.0), (wide + 0.5, high), (wide, high)], "support"),
        prism("keystone", [(0.0, high), (wide, high), (end, 0.0), (low, 0.0)]),
        friction=friction,
        settlement=(1.0, 0.0, 0.0),
    )
    value = 1.0 / (math.tan(left + phi) + math.tan(right + phi))
    holds(scene, value, value)


@pytest.mark.parametrize(("lifts", "sign"), [(-1.0, -1.0), (1.0, 1.0)])
def test_a_panel_clamped_by_a_rod_between_panels_that_slide_freely(lifts: float, sign: float) -> None:
    """A rod of tension P presses three panels together; their footings have no friction, so both head joints carry all of P.

    The middle one sinks with its pad: R = W - 2 mu P. When lifted, it loads the pad by W + 2 mu P; R is minus that, as the pad rises.
    """
    friction, tension, weight = 0.6, 4000.0, 0.3 * 2000.0 * 9.81
    scene = scenes.build(
        scenes.box("ground left", (0.0, 0.0, -0.2), (0.6, 1.0, 0.0), "fixed"),
        scenes.box("pad", (0.6, 0.0, -0.2), (1.2, 1.0, 0.0), "support"),
        scenes.box("ground right", (1.2, 0.0, -0.2), (1.8, 1.0, 0.0), "fixed"),
        *(scenes.box(f"panel {k}", (0.6 * k, 0.0, 0.0), (0.6 * k + 0.6, 1.0, 0.5)) for k in range(3)),
        scenes.table("[friction]", joints="footing", friction=0.0),
        scenes.table("[tie]", blocks=["panel 0", "panel 2"], **{"from": (0.0, 0.5, 0.25)}, to=(1.8, 0.5, 0.25), force=tension),
        friction=friction,
        settlement=(0.0, 0.0, lifts),
    )
    value = -sign * (weight + sign * 2.0 * friction * tension) / (3.0 * weight)
    holds(scene, value, value)


@pytest.mark.parametrize("friction", [0.3, 0.6])
def test_a_prism_pushed_along_a_groove(friction: float) -> None:
    """Both faces lean by 45 degrees: 2 N cos t = W, and friction against the slip along the groove is 2 mu N = mu W / cos t.

    Dilating joints lift the prism by w as it moves by v: each parts by w cos t = mu sqrt(v^2 + (w sin t)^2), because it also slides up the
    face. So the bound is w / v = mu / sqrt(cos^2 t - mu^2 sin^2 t).
    """

    def body(name: str, profile: list[tuple[float, float]], ends: tuple[float, float], role: str = "free") -> str:
        return scenes.block(name, role, polyhedron=[(x, y, z) for x, z in profile for y in ends])

    scene = scenes.build(
        body("left", [(0.0, 0.0), (-2.0, 2.0), (-2.0, 0.0)], (-2.0, 4.0), "fixed"),
        body("right", [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0)], (-2.0, 4.0), "fixed"),
        body("prism", [(0.0, 0.0), (0.5, 0.5), (-0.5, 0.5)], (0.0, 2.0)),
        friction=friction,
        live=(0.0, 1.0, 0.0),
    )
    half = math.sqrt(0.5)  # sine and cosine of 45 degrees
    holds(scene, friction / half, friction / math.sqrt(0.5 - 0.5 * friction**2), Drive.LIVE)
