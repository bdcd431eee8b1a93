"""Dead loads, ties and classes of joints by limit analysis: closed forms, equal loads given in several ways, mistakes in their tables."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scenes

import la_core
from comparison.cli.commands import main
from comparison.figures.canvas import LOAD_COLOUR
from comparison.figures.structure import assembly_figure
from comparison.numbers import Units
from comparison.report.inputs import input_rows
from la_core.errors import SceneError
from la_core.limit.associated import Solution, Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble
from la_core.scene.loads.summary import classes_as_dicts, loads_as_dicts, ties_as_dicts
from la_core.scene.scene import Scene, load_scene
from la_core.scene.shipped import starter_text

EXACT = 1e-6  # of the weight: what the solver promises
PREDICTED = 1e-3  # of the weight: joints are a little elastic in the prediction
BEAM = (
    scenes.box("left", (0.0, 0.0, -0.2), (0.2, 1.0, 0.0), "fixed"),
    scenes.box("right", (0.8, 0.0, -0.2), (1.0, 1.0, 0.0), "support"),
    scenes.box("beam", (0.0, 0.0, 0.0), (1.0, 1.0, 0.3)),
)
OWN = 2000.0 * 9.81 * 0.3  # N, weight of the beam
LEANING = (*BEAM[:2], scenes.block("leaning", prism=(((0.0, 0.0), (1.0, 0.0), (2.2, 1.0), (1.2, 1.0)), (0.0, 1.0))))
LEANING_WEIGHT = 2000.0 * 9.81  # N
PRESSED = (
    scenes.box("wall", (-0.5, 0.0, -0.2), (0.0, 0.4, 0.5), "fixed"),
    scenes.box("pad", (0.0, 0.0, -0.2), (0.5, 0.4, 0.0), "support"),
    scenes.box("stone", (0.0, 0.0, 0.0), (0.5, 0.4, 0.5)),
)
PRESSED_WEIGHT = 2000.0 * 9.81 * 0.1  # N
STACK = (
    scenes.box("ground", (0.0, 0.0, -0.2), (1.0, 1.0, 0.0), "fixed"),
    scenes.box("lower", (0.0, 0.0, 0.0), (1.0, 1.0, 0.2)),
    scenes.box("upper", (0.0, 0.0, 0.2), (1.0, 1.0, 0.4)),
)


def load(**entries: Any) -> str:
    """A [[load]] on the beam where no other blocks are given; `start` is its key `from`."""
    if "start" in entries:
        entries["from"] = entries.pop("start")
    return scenes.table("[load]", **({"blocks": ["beam"]} | entries))


def tie(blocks: Sequence[str], start: Sequence[float], to: Sequence[float], force: float) -> str:
    return scenes.table("[tie]", blocks=blocks, **{"from": start}, to=to, force=force)


def friction(**entries: Any) -> str:
    return scenes.table("[friction]", **entries)


def solved(scene: Scene, drive: Drive = Drive.YIELDING) -> Solution:
    solution = solve_associated(assemble(scene), drive)
    assert solution.status is Status.SOLVED
    return solution


# --- point, line and area loads ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("place", "size"), [(0.7, 1000.0), (0.35, 2.5e4), (1.0, 4000.0)])
def test_a_point_load_on_two_pads_is_shared_by_the_lever_arms(place: float, size: float) -> None:
    scene = scenes.build(*BEAM, load(force=(0.0, 0.0, -size), at=(place, 0.5, 0.3)))
    assert scene.weight == pytest.approx(OWN + size)
    assert solved(scene).value == pytest.approx((0.3 * OWN + (place - 0.2) * size) / 0.8, abs=EXACT * scene.weight)
    assert solved(scene, Drive.PUSHING).value == pytest.approx((0.5 * OWN + place * size) / 0.8, abs=EXACT * scene.weight)


def test_the_prediction_carries_loads_too() -> None:
    scene = scenes.build(*BEAM, load(force=(0.0, 0.0, -3000.0), at=(0.7, 0.5, 0.3)), model="coulomb", effects={"elasticity": "plateau"})
    assert la_core.solve(scene).coulomb == pytest.approx((0.3 * OWN + 0.5 * 3000.0) / 0.8, abs=PREDICTED * scene.weight)


SAME_LOADS = {  # 600 kg on the whole beam, each in another way
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
    """Both loads press the block down; the mass is pushed, too."""
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
    """Half of a gable's top: the mass is for each square metre of plan, and acts in the middle of the face."""
    gable = scenes.block("beam", prism=(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)), (0.0, 2.0)))
    scene = scenes.build(*BEAM[:2], gable, load(mass=100.0, per="m2"))
    assert scene.loads.mass == pytest.approx([200.0])
    assert scene.loads.point == pytest.approx(np.array([[0.5, 1.0, 0.5]]))


def test_a_load_above_a_notch_acts_on_the_upper_faces_alone() -> None:
    """A block of several convex parts: what lies under a part of the same block carries nothing."""
    notched = ((0.0, 0.0), (1.0, 0.0), (1.0, 0.2), (0.4, 0.2), (0.4, 0.4), (1.0, 0.4), (1.0, 0.6), (0.0, 0.6))
    scene = scenes.build(*BEAM[:2], scenes.block("beam", prism=(notched, (0.0, 1.0))), load(mass=100.0, per="m2"))
    assert scene.loads.mass.sum() == pytest.approx(100.0)
    assert scene.loads.point[:, 2] == pytest.approx(0.6)


def test_a_load_beside_the_middle_makes_the_model_one_in_space() -> None:
    centred, beside = (scenes.build(*BEAM, load(mass=50.0, at=(0.4, y, 0.3))) for y in (0.5, 0.6))
    assert assemble(centred).effects.plane and not assemble(beside).effects.plane
    assert 'load or tie on block "beam" acts out of the xz plane' in assemble(beside).effects.reasons["plane"]


# --- ties --------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("tension", [0.2, 0.4])
def test_a_tie_to_the_ground_holds_a_leaning_block(tension: float) -> None:
    """By moments about the inner edge of the fixed pad: the block turns about it, and no joint slides."""
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


# --- classes of joints -------------------------------------------------------------------------------------------------------


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


# --- mistakes ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (load(), "needs either a `force` or a `mass`"),
        (load(mass=1.0, force=(0.0, 0.0, -1.0)), "needs either a `force` or a `mass`"),
        (load(mass=1.0, blocks=[]), "needs `blocks` or a `region`"),
        (load(mass=1.0, blocks=["beem"]), 'no block has the name "beem"; did you mean "beam"?'),
        (load(mass=1.0, blocks=["left"]), "chooses no free block; a load on a held block changes nothing"),
        (load(mass=1.0, per="m"), '`per = "m"` needs `from` and `to`'),
        (load(mass=1.0, start=(0.0, 0.0), to=(1.0, 0.0)), '`per = "m"` needs `from` and `to`, and they belong to it alone'),
        (load(mass=1.0, per="m", start=(0.0, 0.0), to=(0.0, 0.0)), "`from` and `to` must differ"),
        (load(mass=1.0, per="m", start=(0.0, 7.0), to=(1.0, 7.0)), "no top face of the chosen blocks lies under the line"),
        (load(mass=1.0, per="m2", at=(0.0, 0.0, 0.0)), "`at` belongs to a load"),
        (load(force=(0.0, 0.0, 0.0)), "must not be the zero vector"),
        (tie(["beam", "beem"], (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 1.0), 'no block has the name "beem"; did you mean "beam"?'),
        (tie(["left", "right"], (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 1.0), "no end is at a free block"),
        (tie(["beam", "beam"], (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 1.0), "the two `blocks` must differ"),
        (tie(["beam"], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0), "`from` and `to` must differ"),
        (friction(friction=0.1), "needs `joints` or `between`"),
        (friction(between=["beam", "lift"], friction=0.1), 'no block has the name "lift"; did you mean "left"?'),
    ],
)
def test_a_mistake_in_a_table_is_named_with_its_line(table: str, message: str) -> None:
    with pytest.raises(SceneError) as refused:
        scenes.build(*BEAM, table)
    assert message in str(refused.value)
    assert "line " in str(refused.value)


def test_a_load_that_would_count_twice_is_refused() -> None:
    with pytest.raises(SceneError, match="lie above each other"):
        scenes.build(*STACK, load(blocks=["lower", "upper"], mass=100.0, per="m2"), live=(1.0, 0.0, 0.0), settlement=None)


def test_a_point_on_several_blocks_is_refused() -> None:
    with pytest.raises(SceneError, match="is a point on one block, but 2 blocks are chosen"):
        scenes.build(*STACK, load(blocks=["*er"], mass=100.0, at=(0.5, 0.5, 0.4)), live=(1.0, 0.0, 0.0), settlement=None)


def test_a_class_of_joints_that_no_joint_belongs_to_is_refused() -> None:
    scene = scenes.build(*BEAM, friction(between=["left", "right"], friction=0.1))
    with pytest.raises(SceneError, match=r"no joint lies between these blocks"):
        assemble(scene)


# --- what a user sees --------------------------------------------------------------------------------------------------------


def test_show_lists_and_draws_loads_ties_and_classes_of_joints(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "floors.toml"
    path.write_text(starter_text("floors"), encoding="utf-8")
    assert main(["show", str(path), "-q", "--json", "-o", str(tmp_path / "floors.png")]) == 0
    facts = json.loads(capsys.readouterr().out)
    floor, beam = facts["loads"]
    assert (floor["name"], floor["mass"], floor["blocks"]) == ("floor", pytest.approx(250.0 * 3.6), 7)
    assert (beam["force"], beam["mass"], beam["blocks"]) == ([0.0, 0.0, -1500.0], None, 1)
    assert facts["ties"] == [{"name": "rod", "tension": 2000.0, "length": pytest.approx(3.6), "between": ["wall 5.1", "wall 5.6"]}]
    assert facts["joint_classes"] == [{"joints": "footing", "between": None, "friction": 0.5}]
    scene = load_scene(path)
    figure = assembly_figure(scene, assemble(scene))
    labels = {text.get_text() for legend in figure.legends for text in legend.get_texts()}
    assert {"dead load", "tie"} <= labels
    arrows = [text for text in figure.axes[0].texts if text.arrowprops and text.arrowprops.get("color") == LOAD_COLOUR]
    assert len(arrows) == len(scene.loads) == 8


def test_the_inputs_of_a_report_list_loads_ties_and_classes_of_joints() -> None:
    scene = scenes.load(starter_text("floors"))
    facts = {
        "loads": loads_as_dicts(scene.loads, scene.load_names),
        "ties": ties_as_dicts(scene.ties, scene.blocks.names),
        "joint_classes": classes_as_dicts(scene.joint_classes),
        "densities": [], "gravity": [0.0, 0.0, -9.81], "friction": [0.5, 0.6], "inset": 1e-3,
    }  # fmt: skip
    rows = dict(input_rows({"structure": facts, "weight": scene.weight}, Units(scene.weight)))
    assert rows["dead load floor (x, y, z)"].endswith("on 7 blocks, 900 kg")
    assert rows["tie rod, tension"].endswith("between wall 5.1 and wall 5.6")
    assert rows["friction coefficient of footing joints"] == "0.5"
    assert "weight of the free blocks and the loads on them, W" in rows
