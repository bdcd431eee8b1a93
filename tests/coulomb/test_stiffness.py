"""Stiffness of the joints: its laws, the values that a scene may set in its place, and its transfer to YADE."""

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scenes

from la_core import exchange
from la_core.analysis.case_file import read_case, write_case
from la_core.analysis.stage import analyse
from la_core.errors import SceneError
from la_core.limit.associated import Status
from la_core.model.assembly import assemble
from la_core.model.joints import ELASTIC_SHARE, TRAVEL_OVER_INSET, TRAVEL_OVER_SIZE, JointStiffness, joint_stiffness
from la_core.scene.scene import Scene

HELD = scenes.box("held", (0.0, 0.0, -0.1), (0.4, 0.2, 0.0), "fixed"), scenes.box("pad", (0.6, 0.0, -0.1), (1.0, 0.2, 0.0), "support")
MASS = 1000.0  # kg of the block of 1.0 x 0.2 x 0.5 m at 10,000 kg/m3
Point = tuple[float, float, float]
SHIPPED = ("two_pads", "trilith", "arch_spreading", "flat_arch", "slab_four_corners", "wall_third")


def slab(**options: object) -> Scene:
    """A block on two pads, symmetric about its centroid. Under a live load no pad settles."""
    pads = (held.replace("support", "fixed") for held in HELD) if "live" in options else HELD
    return scenes.build(*pads, scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.2, 0.5)), density=1e4, **options)


def wall(**options: object) -> Scene:
    return scenes.build(*scenes.wall(3, 4, split=0.8), **{"inset": 0.001, **options})


def stiffness(scene: Scene, **settings: object) -> JointStiffness:
    assembly = assemble(scene)
    return joint_stiffness(assembly, settings)


def ratios(one: JointStiffness, other: JointStiffness) -> tuple[float, ...]:
    return tuple(b / a for a, b in zip(dataclasses.astuple(one), dataclasses.astuple(other), strict=True))


@pytest.mark.parametrize(("plane", "points"), [(True, 4), (False, 8)])
def test_a_block_on_two_pads_sags_by_its_weight_over_its_springs(plane, points) -> None:
    found = stiffness(slab(inset=0.01, plane=plane))
    assert found.travel == pytest.approx(1.0 / 400.0)
    assert found.sag == pytest.approx(MASS * 9.81 / (points * found.normal), rel=1e-3)
    assert found.sag == pytest.approx(found.travel / 300.0, rel=1e-9) and found.shear == found.normal


ALONG, ACROSS = (0.49, 0.11), (0.09,)  # m: distances of the points from the middle of the block, along x and along y


def sway_about(arms: tuple[float, ...], points: int, normal: float) -> float:
    """Sway of the slab, m: its shift, weight over all springs, plus its turn, moment over springs times arms^2."""
    height, turning = 0.25, points * np.mean(np.square(arms))  # its weight acts sideways at half its height
    return float(MASS * 9.81 / normal * (1.0 / points + height**2 / turning))


@pytest.mark.parametrize(
    ("options", "arms"),
    [
        ({"plane": True}, ALONG),
        ({"plane": False}, ALONG),
        ({"plane": False, "settlement": (0.6, 0.0, -0.8)}, ALONG),
        ({"plane": False, "settlement": (0.0, 0.6, -0.8)}, ACROSS),
        ({"plane": False, "live": (1.0, 0.0, 0.0)}, ALONG),
        ({"plane": False, "live": (0.6, 0.8, 0.0)}, ACROSS),
        ({"plane": False, "live": (0.0, 1.0, 0.0)}, ACROSS),
    ],
)
def test_a_block_on_two_pads_sways_about_the_shorter_axis_of_its_base(options: dict[str, Any], arms: tuple[float, ...]) -> None:
    """The block is symmetric about the plane of x and z. It sways along this plane, and across it only if the drive has a part along y."""
    found, points = stiffness(slab(inset=0.01, **options)), 4 if options["plane"] else 8
    assert found.sway == pytest.approx(sway_about(arms, points, found.normal), rel=2e-3)


@pytest.mark.parametrize(
    ("force", "at", "arms"),
    [
        ((0.0, 0.0, -10.0), (0.3, 0.1, 0.5), ALONG),
        ((0.0, 0.0, -10.0), (0.3, 0.11, 0.5), ACROSS),
        ((0.0, 0.1, 0.0), (0.3, 0.1, 0.5), ACROSS),
    ],
)
def test_a_load_beside_the_mirror_of_a_block_makes_it_sway_across(force: Point, at: Point, arms: tuple[float, ...]) -> None:
    load = scenes.table("[load]", blocks=("block",), at=at, force=force)
    found = stiffness(
        scenes.build(*HELD, scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.2, 0.5)), load, density=1e4, inset=0.01, plane=False)
    )
    assert found.sway == pytest.approx(sway_about(arms, 8, found.normal), rel=2e-3)


def test_a_block_that_settles_as_a_whole_may_sway_both_ways() -> None:
    """The structure has two planes of symmetry. If both counted, no direction would be left, so neither counts."""
    pad = scenes.box("pad", (-0.1, 0.0, -0.2), (0.3, 1.0, 0.0), "support")
    parts = (pad, scenes.box("tower", (0.0, 0.0, 0.0), (0.2, 1.0, 2.0)))
    one, other = (stiffness(scenes.build(*parts, inset=0.01, plane=plane)) for plane in (True, False))
    assert other.sway / other.sag == pytest.approx(one.sway / one.sag, rel=0.01)


@pytest.mark.parametrize("angle", [10.0, 45.0, 77.0, 123.0])
def test_a_wall_in_any_direction_sways_along_itself(angle: float) -> None:
    """The wall's plane of symmetry runs along the wall, for any axes."""
    one = wall(plane=False)
    turned = scenes.moved(one, scenes.rotation((0.0, 0.0, 1.0), np.radians(angle)), (30.0, -70.0, 2.0), plane=False)
    assert ratios(stiffness(one), stiffness(turned))[-1] == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("plane", [True, False])
@pytest.mark.parametrize("build", [slab, wall])
def test_twice_the_density_is_twice_the_stiffness(build, plane) -> None:
    one = build(inset=0.001, plane=plane)
    found = ratios(stiffness(one), stiffness(scenes.moved(one, density=2.0, plane=plane)))
    assert found == pytest.approx((2.0, 2.0, 1.0, 1.0, 1.0), rel=1e-6)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_lengths_scale_travel_and_sag_and_weights_over_lengths_the_stiffness(scale) -> None:
    one = wall()
    expected = (scale**2, scale**2, scale, scale, scale)
    assert ratios(stiffness(one), stiffness(scenes.moved(one, scale=scale))) == pytest.approx(expected, rel=1e-6)


def test_the_plane_is_as_stiff_as_the_space_on_half_the_points() -> None:
    plane, space = stiffness(wall(plane=True)), stiffness(wall(plane=False))
    assert plane.normal == pytest.approx(2.0 * space.normal, rel=0.01)
    assert plane.travel == space.travel


@pytest.mark.parametrize("name", SHIPPED)
def test_the_sag_is_at_most_its_share_of_the_travel(name) -> None:
    scene = scenes.shipped(name)
    assembly = assemble(scene)
    for inset in (scene.inset, 0.0):
        found = joint_stiffness(assembly.with_inset(scene, inset), scene.yade)
        assert 0.0 < found.sag <= ELASTIC_SHARE * found.travel * (1.0 + 1e-9)
        assert found.normal > 0.0 and np.isfinite(found.normal)


def test_a_small_inset_limits_the_travel_and_sharp_edges_do_not() -> None:
    assert stiffness(slab(inset=0.001)).travel == pytest.approx(TRAVEL_OVER_INSET * 0.001)
    assert stiffness(slab(inset=0.0)).travel == pytest.approx(TRAVEL_OVER_SIZE * 1.0)


def test_spheres_limit_a_live_load_as_they_limit_a_settlement() -> None:
    rounded, sharp = (stiffness(scenes.build(*scenes.wall(3, 3), live=(1.0, 0.0, 0.0), inset=inset)) for inset in (0.001, 0.0))
    assert rounded.travel == pytest.approx(TRAVEL_OVER_INSET * 0.001) and sharp.travel == pytest.approx(TRAVEL_OVER_SIZE * 0.4)
    assert rounded.sag <= ELASTIC_SHARE * rounded.travel * (1.0 + 1e-9) and sharp.sag == pytest.approx(ELASTIC_SHARE * sharp.travel)


def test_a_turning_support_travels_by_an_angle() -> None:
    hinge = {"axis": (0.0, 1.0, 0.0), "point": (-1.0, 0.0, 0.0)}
    turning = stiffness(slab(inset=0.001, settlement=hinge))
    sinking = stiffness(slab(inset=0.001))
    assert turning.travel == pytest.approx(sinking.travel / 1.999)  # its outermost contact point lies 1.999 m from the axis
    assert (turning.normal, turning.sag) == pytest.approx((sinking.normal, sinking.sag))


def test_a_small_sphere_must_not_sink_in() -> None:
    usual, small = stiffness(wall()), stiffness(wall(), sphere_radius=1e-6)
    assert small.normal > usual.normal and small.travel == usual.travel
    assert small.normal == pytest.approx(10.0 * stiffness(wall(), sphere_radius=1e-5).normal)


def test_blocks_that_nothing_holds_do_not_count() -> None:
    afloat = scenes.box("a", (5.0, 0.0, 0.0), (6.0, 0.2, 0.5)), scenes.box("b", (5.0, 0.0, 0.5), (6.0, 0.2, 1.0))
    block = scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.2, 0.5))
    both, alone = (stiffness(scenes.build(*HELD, block, *more, inset=0.01)) for more in (afloat, ()))
    assert both == alone


def test_where_nothing_is_held_there_is_no_stiffness_but_an_answer(tmp_path: Path) -> None:
    scene = scenes.build(
        scenes.box("a", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), scenes.box("b", (0.0, 0.0, 1.0), (1.0, 1.0, 2.0)), live=(1, 0, 0)
    )
    analysis = analyse(scene)
    write_case(tmp_path / "case.h5", analysis, "")
    found = read_case(tmp_path / "case.h5", scene).stiffness
    assert np.isnan([found.normal, found.shear, found.sag]).all() and found.travel == pytest.approx(TRAVEL_OVER_INSET * 0.001)
    assert analysis.bounds[analysis.main].status is Status.INFEASIBLE


# --- values set by a scene ---------------------------------------------------------------------------------------------------


def test_what_a_scene_asks_for_is_what_it_gets() -> None:
    derived = stiffness(wall())
    found = stiffness(wall(), normal_stiffness=2.0 * derived.normal)
    assert ratios(derived, found) == pytest.approx((2.0, 2.0, 1.0, 0.5, 0.5))
    found = stiffness(wall(), shear_stiffness=0, normal_stiffness=1e6)
    assert (found.normal, found.shear) == (1e6, 0.0)
    found = stiffness(wall(), max_travel=0.5 * derived.travel)
    assert ratios(derived, found) == pytest.approx((2.0, 2.0, 0.5, 0.5, 0.5))
    assert stiffness(wall(), speed=1.0, time_limit=5.0) == derived


@pytest.mark.parametrize(
    ("name", "value", "rule"),
    [
        ("normal_stiffness", 0.0, "must be greater than 0"),
        ("normal_stiffness", -1.0, "must be greater than 0"),
        ("normal_stiffness", float("nan"), "must be a finite number"),
        ("normal_stiffness", "hard", "must be a finite number"),
        ("shear_stiffness", -1.0, "must be at least 0"),
        ("shear_stiffness", True, "must be a finite number"),
        ("max_travel", 0.0, "must be greater than 0"),
        ("sphere_radius", 0.0, "must be greater than 0"),
        ("sphere_radius", 0.001, "must be less than the inset of the contact points, 0.001 m"),
    ],
)
def test_an_impossible_value_is_refused_by_name_value_and_rule(name, value, rule) -> None:
    with pytest.raises(SceneError) as error:
        stiffness(wall(), **{name: value})
    shown = str(value).lower() if isinstance(value, bool) else repr(value)
    assert str(error.value) == f"yade.{name} = {shown}: {rule}"


def test_a_scene_with_an_impossible_value_is_refused_by_its_file() -> None:
    with pytest.raises(SceneError, match=r"line \d+: yade\.normal_stiffness = 0\.0: must be greater than 0$"):
        scenes.load(scenes.text(*scenes.wall(3, 4, split=0.8), inset=0.001) + "[yade]\nnormal_stiffness = 0.0\n")


# --- from limit analysis to YADE ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("asked", ["", "[yade]\nnormal_stiffness = 3e7\nshear_stiffness = 1e7\nmax_travel = 1e-4\n"])
def test_yade_runs_with_the_case_s_numbers(asked: str, tmp_path: Path) -> None:
    from yade_scripts import case, settings

    scene = scenes.load(scenes.text(*scenes.wall(3, 4, split=0.8), inset=0.001) + asked)
    analysis = analyse(scene)
    write_case(tmp_path / "case.h5", analysis, "")
    assert read_case(tmp_path / "case.h5", scene).stiffness == analysis.stiffness
    one = case.from_fields(exchange.read(tmp_path / "case.h5", (*exchange.CASE_FIELDS, exchange.SWAY)))
    chosen = settings.derive(one)
    normal, shear = (stiffness / chosen.stiffening for stiffness in (chosen.normal_stiffness, chosen.shear_stiffness))
    found = JointStiffness(normal, shear, chosen.max_travel, one.sag, one.sway)
    assert chosen.stiffening == (1.0 if asked else 4.0)  # a run must come to its plateau in one travel, a path may go on
    assert found == analysis.stiffness


def test_yade_refuses_a_case_without_stiffness(tmp_path: Path) -> None:
    from yade_scripts import case

    scene = wall()
    analysis = analyse(scene)
    broken = dataclasses.replace(analysis, stiffness=dataclasses.replace(analysis.stiffness, normal=float("nan")))
    write_case(tmp_path / "case.h5", broken, "")
    with pytest.raises(case.CaseError, match="joints/normal_stiffness is nan; it must be a finite number greater than 0"):
        case.from_fields(exchange.read(tmp_path / "case.h5", exchange.CASE_FIELDS))
