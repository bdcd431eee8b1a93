"""A report lists the forces of the ground. For joints that open or slide it lists forces, friction used, eccentricity and motion."""

import html
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scenes
from made_up_comparisons import page_and_markdown
from runs import perfect_run

from comparison.judge.summary import limit_analysis_summary
from comparison.report import structure_facts
from comparison.report.facts import MOST_ROWS
from comparison.yade import Results
from la_core.analysis import solve
from la_core.analysis.stage import analyse
from la_core.geometry import Interfaces
from la_core.measures import eccentricity
from la_core.scene import Scene, variant
from la_core.scene.scene import load_scene
from la_core.scene.shipped import find

THICKNESS, INSET = 0.3, 0.001  # m, of `arch_spreading`


def facts_of(scene: Scene) -> dict[str, Any]:
    analysis = analyse(scene)
    results = Results(analysis)
    return limit_analysis_summary(analysis) | {"structure": structure_facts(results), "verdict": None}


def joints_of(scene: Scene) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = facts_of(scene)["structure"]["moving_joints"]["rows"]
    return rows


@pytest.mark.parametrize("turn", [1, -1])
def test_eccentricity_is_the_share_of_the_way_to_the_edge(turn: int) -> None:
    """The corners of a triangle and of a rectangle of 2 x 4 m run in either sense about the normal. One interface has no force."""
    triangle, rectangle = [(0, 0, 0), (3, 0, 0), (0, 3, 0)][::turn], [(0, 0, 5), (0, 4, 5), (0, 4, 7), (0, 0, 7)][::turn]
    away = np.array([7.0, -3.0, 2.0])  # the distance from the origin has no influence
    corners = away + np.array([*triangle, *rectangle, *rectangle, *rectangle], dtype=float)
    normal, start = np.array([[0, 0, 1], [1, 0, 0], [1, 0, 0], [1, 0, 0]], dtype=float), np.array([0, 3, 7, 11, 15])
    one = np.ones(4, dtype=int)
    assembly: Any = SimpleNamespace(interfaces=Interfaces(0 * one, one, normal, one.astype(float), corners, start))
    # The force acts half way from the centroid (1, 1) to the hypotenuse, a quarter of 2 m beside the middle, and on an edge.
    centre = np.array([[1.25, 1.25, 0], [0, 2.5, 6], [0, 2.5, 5], [np.nan] * 3])
    assert eccentricity(assembly, away + centre) == pytest.approx([0.5, 0.25, 1.0, np.nan], abs=1e-12, nan_ok=True)


def test_an_arch_turns_in_four_hinges_at_its_edges() -> None:
    """A hinge opens by its rotation times the distance of its two contact points, and its force acts at one of them."""
    rows = joints_of(load_scene(find("arch_spreading")))
    assert [row["state"] for row in rows] == ["opening"] * 4
    for row in rows:
        assert row["opening"] == pytest.approx(row["rotation"] * (THICKNESS - 2.0 * INSET), rel=1e-6)
        assert row["eccentricity"] == pytest.approx(1.0 - 2.0 * INSET / THICKNESS, rel=1e-6)
        assert row["slip"] == pytest.approx(0.0, abs=1e-6)
        assert row["friction_used"] == pytest.approx(row["shear"] / (0.7 * row["normal"]), rel=1e-9)


def test_a_joint_that_slides_uses_all_its_friction_and_slips_as_far_as_its_blocks() -> None:
    """Half blocks of a wall sink with the support beside blocks at rest: by 1 m per m their head joints slide and their bed joints open."""
    rows = joints_of(load_scene(find("wall_third")))
    sliding, opening = ([row for row in rows if row["state"] == state] for state in ("sliding", "opening"))
    assert len(sliding) == len(opening) == 4
    for row in sliding:
        assert (row["friction_used"], row["slip"]) == pytest.approx((1.0, 1.0), rel=1e-3)
    for row in opening:
        assert (row["opening"], row["normal"]) == pytest.approx((1.0, 0.0), abs=1e-3)
        assert np.isnan([row["friction_used"], row["eccentricity"], row["x"]]).all()


def test_a_pushed_block_turns_by_one_over_the_height_of_its_load() -> None:
    """Per metre of the mean displacement along the load, a block that tips about its toe turns by one over the height of its centroid."""
    pad, block = scenes.box("pad", (-1.0, 0.0, -0.5), (2.0, 1.0, 0.0), "fixed"), scenes.box("block", (0.0, 0.0, 0.0), (0.5, 1.0, 2.0))
    (row,) = joints_of(scenes.build(pad, block, live=[1.0, 0.0, 0.0]))
    assert row["rotation"] == pytest.approx(1.0, rel=1e-3) and row["eccentricity"] == pytest.approx(1.0, abs=0.01)


def test_report_and_markdown_have_the_table_with_what_is_left_out(tmp_path: Path) -> None:
    summary = facts_of(load_scene(find("arch_spreading")))
    page, markdown = page_and_markdown(tmp_path, summary)
    shown = html.unescape(re.sub(r"<[^>]*>", " ", page))
    assert "Joints that open or slide" in shown
    for words in (
        "arch 5 and arch 6", "opens", "0.132", "0.444", "2.621", "0.293", "0.16", "(−0.3058, 2.127) m", "centre of pressure", "(x, z)",
    ):  # fmt: skip
        assert words in shown and words in markdown, words
    assert "more joint" not in shown and "A joint that turns in its own plane slides although it uses less than 1" in shown
    summary["structure"]["moving_joints"]["count"] = 5
    assert "1 more joint moves no farther" in page_and_markdown(tmp_path, summary)[0]
    summary["structure"]["moving_joints"] = {"count": 0, "rows": []}
    assert "Joints that open or slide" not in page_and_markdown(tmp_path, summary)[0]


def test_many_joints_are_cut_to_those_that_move_most() -> None:
    found = facts_of(load_scene(find("wall_tall")))["structure"]["moving_joints"]
    assert len(found["rows"]) == min(found["count"], MOST_ROWS)
    moves = [max(row["opening"], row["slip"]) for row in found["rows"]]
    assert moves == pytest.approx(sorted(moves, reverse=True), rel=1e-5, abs=1e-9)


def test_the_ground_and_the_support_carry_the_weight_and_their_thrusts_balance(tmp_path: Path) -> None:
    """Each springing of an arch carries half the weight and the inward thrust, which is the reaction of the spreading support."""
    scene = load_scene(find("arch_spreading"))
    analysis = analyse(scene)
    run = perfect_run(analysis)
    facts = structure_facts(Results(analysis, run))
    left, right = facts["ground_reactions"]["rows"]
    assert (left["block"], right["block"]) == ("arch springer left", "arch springer right")
    thrust = analysis.bounds[analysis.main].value
    assert left["limit_analysis"] == pytest.approx([thrust, 0.0, scene.weight / 2.0], rel=1e-6, abs=1e-6 * scene.weight)
    assert right["limit_analysis"] == pytest.approx([-thrust, 0.0, scene.weight / 2.0], rel=1e-6, abs=1e-6 * scene.weight)
    assert right["yade"] == pytest.approx(right["limit_analysis"], rel=1e-3, abs=1e-3 * scene.weight)
    summary = limit_analysis_summary(analysis) | {"structure": facts, "verdict": None}
    page, markdown = page_and_markdown(tmp_path, summary)
    for words in ("Forces of the ground and the support", "YADE, z, kN", "−2.552", "7.296"):
        assert words in page and (words in markdown or words.startswith("Forces")), words
    assert "more block" not in markdown and "blocks set aside" not in markdown and "cosine" not in markdown
    facts["ground_reactions"] |= {"count": 3, "aside": 2}
    facts["tilt"] = [0.0, 1.0, 0.0]
    _, markdown = page_and_markdown(tmp_path, summary)
    for words in ("1 more block carries no more.", "what the ground bears under the 2 blocks set aside", "smaller, by its cosine"):
        assert words in markdown, words


def test_blocks_that_are_set_aside_are_no_ground() -> None:
    """Blocks that are set aside are fixed like the ground and carry the region, but their forces are no forces of the ground."""
    scene = variant(load_scene(find("wall_long")), {"effects.reach": True})
    analysis = analyse(scene)
    assert analysis.assembly.aside.sum() > 10
    found = structure_facts(Results(analysis))["ground_reactions"]
    assert [row["block"] for row in found["rows"]] == ["fixed base", "settling base"]
    assert (found["count"], found["aside"]) == (2, analysis.assembly.aside.sum())


def test_of_many_blocks_of_ground_those_are_listed_that_carry_most() -> None:
    pads = [scenes.box(f"pad {k}", (0.1 * k, 0.0, -0.5), (0.1 * k + 0.1, 1.0, 0.0), "fixed") for k in range(MOST_ROWS + 2)]
    support = scenes.box("support", (3.0, 0.0, -0.5), (4.0, 1.0, 0.0), "support")
    blocks = [scenes.box(f"block {k}", (0.1 * k, 0.0, 0.0), (0.1 * k + 0.1, 1.0, 0.5 if k else 0.1)) for k in range(MOST_ROWS + 2)]
    beside = scenes.box("beside", (3.0, 0.0, 0.0), (4.0, 1.0, 0.5))
    scene = scenes.build(*pads, support, *blocks, beside, settlement=scenes.DOWN, reach=False)
    found = structure_facts(Results(analyse(scene)))["ground_reactions"]
    names = [row["block"] for row in found["rows"]]
    assert found["count"] == MOST_ROWS + 3 and len(names) == MOST_ROWS
    assert "pad 0" not in names and "support" in names


def test_a_joint_that_turns_in_its_own_plane_slides_with_less_than_all_its_friction() -> None:
    """A block that is pushed along one rough and one frictionless pad turns on the rough pad."""
    scene = scenes.build(
        scenes.box("rough", (0.0, 0.0, -0.5), (0.5, 1.0, 0.0), "fixed"),
        scenes.box("slick", (1.0, -2.0, -0.5), (2.0, 3.0, 0.0), "fixed"),
        scenes.box("block", (0.0, 0.0, 0.0), (2.0, 1.0, 0.5)),
        scenes.table("[friction]", between=["slick", "block"], friction=0.0),
        friction=0.5,
        live=[0.0, 1.0, 0.0],
        plane=False,
    )
    used = {row["block_a"]: (row["state"], row["friction_used"]) for row in joints_of(scene)}
    assert used["slick"] == ("sliding", pytest.approx(np.nan, nan_ok=True))
    assert used["rough"][0] == "sliding" and 0.1 < used["rough"][1] < 0.9


@pytest.mark.filterwarnings("error")
def test_joints_of_a_structure_that_cannot_stand_are_unknown_without_a_python_warning() -> None:
    pad, support = (
        scenes.box("pad", (0.0, 0.0, -0.5), (0.4, 1.0, 0.0), "fixed"),
        scenes.box("support", (0.4, 0.0, -0.5), (0.6, 1.0, 0.0), "support"),
    )
    answer = solve(scenes.build(pad, support, scenes.box("beam", (0.0, 0.0, 0.0), (2.0, 1.0, 0.4)), settlement=(0.0, 0.0, -1.0)))
    assert {row["state"] for row in answer.joints} == {"unknown"}
    assert all(np.isnan([row["opening"], row["slip"], row["rotation"], row["eccentricity"]]).all() for row in answer.joints)
