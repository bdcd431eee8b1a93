"""Dead loads at points, on lines and on areas match closed forms. Equal loads have equal effects in whatever form they are stated."""

from typing import Any

import numpy as np
import pytest
import scenes
from loaded_scenes import BEAM, EXACT, PREDICTED, STACK, load, solved, tie

import la_core
from la_core.errors import SceneError
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble

OWN = 2000.0 * 9.81 * 0.3  # N, weight of the beam
SPIRE = scenes.block("beam", prism=(((0.0, 0.0), (1.0, 0.0), (0.5, 1000.0)), (0.0, 1.0)))  # so steep that no face faces up


@pytest.mark.parametrize(("place", "size"), [(0.7, 1000.0), (0.35, 2.5e4), (1.0, 4000.0)])
def test_a_point_load_on_two_pads_is_shared_by_the_lever_arms(place: float, size: float) -> None:
    scene = scenes.build(*BEAM, load(force=(0.0, 0.0, -size), at=(place, 0.5, 0.3)))
    assert scene.weight == assemble(scene).weight == pytest.approx(OWN + size)  # the unit of tables, and of all tolerances
    assert solved(scene).value == pytest.approx((0.3 * OWN + (place - 0.2) * size) / 0.8, abs=EXACT * scene.weight)
    assert solved(scene, Drive.PUSHING).value == pytest.approx((0.5 * OWN + place * size) / 0.8, abs=EXACT * scene.weight)


def test_the_prediction_carries_loads_too() -> None:
    scene = scenes.build(*BEAM, load(force=(0.0, 0.0, -3000.0), at=(0.7, 0.5, 0.3)), model="coulomb", effects={"elasticity": "plateau"})
    assert la_core.solve(scene).coulomb == pytest.approx((0.3 * OWN + 0.5 * 3000.0) / 0.8, abs=PREDICTED * scene.weight)


SAME_LOADS = {  # 600 kg on the whole beam, stated in different ways
    "density": (),
    "mass of the block": (load(mass=600.0),),
    "force": (load(force=(0.0, 0.0, -600.0 * 9.81)),),
    "area": (load(mass=600.0, per="m2"),),
    "two lines": tuple(load(mass=300.0, per="m", start=(x, 0.0), to=(x, 1.0)) for x in (0.25, 0.75)),
    "longer line": (load(mass=600.0, per="m", start=(-3.0, 0.5), to=(4.0, 0.5)),),
    "two points": tuple(load(force=(0.0, 0.0, -300.0 * 9.81), at=(x, 0.5, 0.1)) for x in (0.1, 0.9)),
    "region": (load(mass=600.0, blocks=[], region={"from": (0.0, 0.0, 0.1), "to": (1.0, 1.0, 0.2)}),),
    "pattern": (load(mass=600.0, blocks=["b?a*"]),),
}


@pytest.mark.parametrize("way", SAME_LOADS)
@pytest.mark.parametrize("drive", [Drive.YIELDING, Drive.PUSHING])
def test_equal_loads_given_in_another_way_are_equal(way: str, drive: Drive) -> None:
    scene = scenes.build(*BEAM, *SAME_LOADS[way], density=4000.0 if way == "density" else 2000.0)
    assert scene.weight == pytest.approx(2.0 * OWN)
    assert assemble(scene).effects.plane or way in ("two lines", "area")
    twice = scenes.build(*BEAM)
    assert solved(scene, drive).value == pytest.approx(2.0 * solved(twice, drive).value, abs=EXACT * scene.weight)


def test_a_live_load_pushes_masses_and_no_forces() -> None:
    """Both loads press the block down, but the live load pushes the mass alone."""
    push = {"live": (1.0, 0.0, 0.0), "settlement": None, "friction": 0.3}
    block = (*STACK[:2],)
    weight = 2000.0 * 9.81 * 0.2
    carried = {"blocks": ["lower"], "at": (0.5, 0.5, 0.1)}
    of_mass = scenes.build(*block, load(mass=weight / 9.81, **carried), **push)
    of_force = scenes.build(*block, load(force=(0.0, 0.0, -weight), **carried), **push)
    assert of_mass.weight == pytest.approx(of_force.weight) == pytest.approx(2.0 * weight)
    assert solved(of_mass, Drive.LIVE).value == pytest.approx(0.3, abs=EXACT)
    assert solved(of_force, Drive.LIVE).value == pytest.approx(0.6, abs=EXACT)


def test_a_mass_high_above_tips_under_a_live_load_with_its_own_lever_arm() -> None:
    weight, height = 2000.0 * 9.81 * 0.2, 2.0
    above = load(blocks=["lower"], mass=weight / 9.81, at=(0.5, 0.5, height))
    scene = scenes.build(*STACK[:2], above, live=(1.0, 0.0, 0.0), settlement=None, friction=5.0, plane=True)
    assert solved(scene, Drive.LIVE).value == pytest.approx(2.0 * 0.5 / (0.1 + height), rel=1e-5)


def test_a_load_on_a_slope_acts_on_its_plan() -> None:
    """One slope of a gable: the mass is per square metre of plan and acts in the middle of the face."""
    gable = scenes.block("beam", prism=(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)), (0.0, 2.0)))
    scene = scenes.build(*BEAM[:2], gable, load(mass=100.0, per="m2"))
    assert scene.loads.mass == pytest.approx([200.0])
    assert scene.loads.point == pytest.approx(np.array([[0.5, 1.0, 0.5]]))


def test_a_load_above_a_notch_acts_on_the_upper_faces_alone() -> None:
    """In a block of several convex parts, a face below another part of the same block carries no load."""
    notched = ((0.0, 0.0), (1.0, 0.0), (1.0, 0.2), (0.4, 0.2), (0.4, 0.4), (1.0, 0.4), (1.0, 0.6), (0.0, 0.6))
    scene = scenes.build(*BEAM[:2], scenes.block("beam", prism=(notched, (0.0, 1.0))), load(mass=100.0, per="m2"))
    assert scene.loads.mass.sum() == pytest.approx(100.0)
    assert scene.loads.point[:, 2] == pytest.approx(0.6)


@pytest.mark.parametrize("blocks", [["arch *"], ["arch 2"]])
def test_a_fill_over_an_arch_acts_on_its_outer_face_alone(blocks: list[str]) -> None:
    """The joints between voussoirs face up, too, but other blocks cover them."""
    scene = scenes.build(scenes.arch(8, 0.2, depth=3.0), load(blocks=blocks, mass=100.0, per="m2"))
    span = np.diff(-1.1 * np.cos(np.pi * np.arange(9) / 8))[slice(None) if blocks == ["arch *"] else slice(1, 2)]
    assert scene.loads.mass == pytest.approx(100.0 * 3.0 * span)


@pytest.mark.parametrize("voussoirs", [15, 16, 40, 200])
def test_a_fill_over_an_arch_acts_on_its_steepest_flanks_too(voussoirs: int) -> None:
    """The normal of the lowest voussoir's outer face rises by only sin(90° / voussoirs). Its upper joint faces almost straight up."""
    scene = scenes.build(scenes.arch(voussoirs, 0.2, depth=3.0), load(blocks=["arch *"], mass=100.0, per="m2"))
    span = np.diff(-1.1 * np.cos(np.pi * np.arange(voussoirs + 1) / voussoirs))
    assert scene.loads.mass == pytest.approx(100.0 * 3.0 * span)
    assert np.hypot(scene.loads.point[:, 0], scene.loads.point[:, 2]) == pytest.approx(1.1 * np.cos(0.5 * np.pi / voussoirs))


def test_a_fill_over_two_rings_lies_on_the_outer_one() -> None:
    """A load on both rings is refused, and the message names the ring to choose."""

    def loaded(pattern: str) -> la_core.Scene:
        arch = scenes.arch(16, 0.2, depth=3.0).replace("thickness", "rings = 2\nthickness")
        return scenes.build(arch, load(blocks=[pattern], mass=100.0, per="m2"))

    with pytest.raises(SceneError, match="choose the blocks of one level, or of the outermost ring"):
        loaded("arch *")
    assert loaded("arch 2.*").loads.mass.sum() == pytest.approx(100.0 * 3.0 * 2.2)


def test_a_mass_on_each_block_lies_on_both_rings() -> None:
    """Only loads per metre or per square metre need a top face. A mass on each block does not."""
    arch = scenes.arch(16, 0.2, depth=3.0).replace("thickness", "rings = 2\nthickness")
    assert scenes.build(arch, load(blocks=["arch *"], mass=100.0)).loads.mass.tolist() == [100.0] * 32


@pytest.mark.parametrize(
    ("blocks", "given", "told"),
    [
        (BEAM, {"per": "m", "start": (0.0, 1.5), "to": (1.0, 1.5)}, "from: no top face of the chosen blocks lies under the line"),
        ((*BEAM[:2], SPIRE), {"per": "m2"}, "blocks: no top face of the chosen blocks faces up"),
        ((*BEAM[:2], SPIRE), {"per": "m2", "blocks": [], "region": {"from": (0.0, 0.0, 0.0), "to": (1.0, 1.0, 900.0)}},
         "region: no top face of the chosen blocks faces up"),
    ],
    ids=["a line beside the blocks", "a spire", "a spire in a region"],
)  # fmt: skip
def test_a_load_that_no_face_carries_is_refused(blocks: tuple[str, ...], given: dict[str, Any], told: str) -> None:
    """Otherwise the load would vanish without a message."""
    with pytest.raises(SceneError, match=told):
        scenes.build(*blocks, load(mass=100.0, **given))


def test_a_floor_on_a_course_with_a_leaning_face_acts_on_its_bed_joint() -> None:
    """The next course is not loaded, so the floor lies on the bed joint, as in an upright wall, and not on the leaning face."""
    courses = [((0.0, 0.0), (1.0, 0.0), (0.98, 0.4), (0.0, 0.4)), ((0.0, 0.4), (0.98, 0.4), (0.96, 0.8), (0.0, 0.8))]
    stones = [scenes.block(f"course {k}", prism=(profile, (0.0, 1.0))) for k, profile in enumerate(courses)]
    ground = scenes.box("ground", (0.0, 0.0, -0.2), (1.0, 1.0, 0.0), "fixed")
    given = {"live": (1.0, 0.0, 0.0), "settlement": None}
    floor = scenes.build(ground, *stones, load(blocks=["course 0"], mass=10.0, per="m2"), **given)
    assert floor.loads.mass == pytest.approx([9.8])
    assert floor.loads.point[:, 2] == pytest.approx(0.4)


@pytest.mark.parametrize("east", [0.0, 1000.0])
def test_a_joint_carries_nothing_however_far_the_structure_is_from_the_origin(east: float) -> None:
    """The two faces of the joint differ by a tenth of a millimetre, as typed coordinates do."""
    ground = scenes.box("ground", (east, 0.0, -0.2), (east + 2.5, 1.0, 0.0), "fixed")
    profiles = {"left": (0.0, 1.0, 1.5, 0.0), "right": (1.0001, 2.5, 2.5, 1.5)}
    stones = [
        scenes.block(name, prism=(tuple((east + x, z) for x, z in zip(across, (0.0, 0.0, 1.0, 1.0), strict=True)), (0.0, 1.0)))
        for name, across in profiles.items()
    ]
    scene = scenes.build(ground, *stones, load(blocks=["right"], mass=10.0, per="m2"), live=(1.0, 0.0, 0.0), settlement=None)
    assert scene.loads.mass == pytest.approx([10.0])


def test_a_line_across_an_arch_counts_once() -> None:
    scene = scenes.build(scenes.arch(8, 0.2, depth=3.0), load(blocks=["arch *"], mass=10.0, per="m", start=(-1.0, 1.5), to=(1.0, 1.5)))
    assert scene.loads.mass.sum() == pytest.approx(20.0)
    assert not [words for words in scene.warnings if "top faces" in words]


def test_a_floor_under_the_next_course_still_acts_on_the_course_that_carries_it() -> None:
    scene = scenes.build(*STACK, load(blocks=["lower"], mass=10.0, per="m2"), live=(1.0, 0.0, 0.0), settlement=None)
    assert scene.loads.mass == pytest.approx([10.0])


def test_a_load_beside_the_middle_makes_the_model_one_in_space() -> None:
    centred, beside = (scenes.build(*BEAM, load(mass=50.0, at=(0.4, y, 0.3))) for y in (0.5, 0.6))
    assert assemble(centred).effects.plane and not assemble(beside).effects.plane
    assert 'load or tie on block "beam" acts out of the xz plane' in assemble(beside).effects.reasons["plane"]


@pytest.mark.parametrize(
    ("force", "y", "plane"),
    [
        ((0.0, 0.0, -900.0), 0.5, True),
        ((0.0, 5.0, -900.0), 0.5, False),  # across, through the centroid
        ((0.0, -5.0, -900.0), 0.5, False),
        ((0.0, 0.0, -900.0), 0.45, False),  # a moment about x
        ((500.0, 0.0, 0.0), 0.5, True),
        ((500.0, 0.0, 0.0), 0.55, False),  # a moment about z
    ],
)
def test_a_force_across_or_beside_the_middle_makes_the_model_one_in_space(force: tuple[float, ...], y: float, plane: bool) -> None:
    effects = assemble(scenes.build(*BEAM, load(force=force, at=(0.5, y, 0.15)))).effects
    assert effects.plane is plane and plane != ('load or tie on block "beam" acts out of' in effects.reasons["plane"])


@pytest.mark.parametrize("size", [900.0, -900.0])
def test_a_tie_beside_the_middle_makes_the_model_one_in_space(size: float) -> None:
    """A force against the pull of the tie, at the end of the tie, cancels it."""
    rod = tie(["beam"], (0.5, 0.6, 0.3), (0.5, 0.6, 5.0), 900.0)
    effects = assemble(scenes.build(*BEAM, rod, load(force=(0.0, 0.0, size), at=(0.5, 0.6, 0.3)))).effects
    assert effects.plane is (size < 0.0)


@pytest.mark.parametrize("push", [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)])
@pytest.mark.parametrize("y", [0.5, 0.6])
def test_a_mass_beside_the_middle_is_pushed_there_although_a_force_bears_its_weight(y: float, push: tuple[float, ...]) -> None:
    """The dead loads are then in the plane. Where the mass lies beside the middle, the push turns the block about z or about x."""
    carried = {"blocks": ["lower"], "at": (0.5, y, 0.1)}
    loads = load(**carried, mass=100.0), load(**carried, force=(0.0, 0.0, 100.0 * 9.81))
    assert assemble(scenes.build(*STACK[:2], *loads, live=push, settlement=None)).effects.plane is (y == 0.5)
