"""A report states the inputs of the structure, the changes on reading, and the moving blocks."""

import html
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from made_up_comparisons import comparison_of, page_and_markdown

import la_core
from comparison.judge.checks.energy import LEAST_TURNOVER
from comparison.judge.summary import limit_analysis_summary
from comparison.numbers import Units, percent
from comparison.report import predicted_value, report, scene_view, structure_facts
from comparison.report.inputs import input_rows, key_rows, setting_rows
from comparison.report.plain_words import plain_words
from comparison.yade import Results
from la_core.analysis.stage import analyse
from la_core.scene.scene import load_scene
from la_core.scene.shipped import find


def leaves(data: Any) -> Iterator[Any]:
    """Yield every value in a scene's data that is neither a table nor an array."""
    if isinstance(data, dict):
        for value in data.values():
            yield from leaves(value)
    elif isinstance(data, list):
        for value in data:
            yield from leaves(value)
    else:
        yield data


@pytest.mark.slow
def test_every_input_of_the_facade_is_in_its_report_with_units_and_the_scene_file(tmp_path: Path) -> None:
    results = Results(analyse(load_scene(find("facade"))))
    summary = limit_analysis_summary(results.analysis) | {"structure": structure_facts(results), "verdict": None}
    (tmp_path / "facade").mkdir()
    text = find("facade").read_text(encoding="utf-8")
    (tmp_path / "facade" / "scene.toml").write_text(text, encoding="utf-8")
    page = report.write_report(tmp_path, [summary], {}).read_text(encoding="utf-8")
    (enclosed,) = re.findall(r"<pre>(.*?)</pre>", page, re.DOTALL)
    assert html.unescape(enclosed).strip() == text.strip()
    shown = html.unescape(re.sub(r"<[^>]*>", " ", page.replace(enclosed, "")))
    given = list(leaves(tomllib.loads(text)))
    assert len(given) > 60
    assert [value for value in given if str(value) not in shown] == []
    inputs = html.unescape(re.sub(r"<[^>]*>", " ", page[page.index('id="scene-1-inputs"') :]))
    for words in (
        "170 free, 1 fixed (ground), 1 on the moving support", "7200 × 400 × 5400 mm", "300 to 1800 × 400 × 300 mm", "1400 kg/m3",
        "9.81 m/s2 downwards", "0.6 (31.0°)", "1 mm", "settling foundation: x 5.4 to 7.2 m", "(0, 0, −1)", "kN/mm", "154.26 kN",
    ):  # fmt: skip
        assert words in inputs, words


def test_scenes_of_one_title_are_told_apart_by_their_names(tmp_path: Path) -> None:
    alike = {"title": "A wall", "verdict": None}
    scenes = [alike | {"scene": "wall"}, alike | {"scene": "wall_harder"}, {"scene": "arch", "title": "An arch", "verdict": None}]
    page = report.write_report(tmp_path, scenes, {}).read_text(encoding="utf-8")
    assert re.findall(r"<h2 id=.scene-.*?>(.*?)</h2>", page) == ["A wall (wall)", "A wall (wall_harder)", "An arch"]


def test_the_conclusion_says_what_moves_what_is_carried_and_what_is_assumed() -> None:
    results = Results(analyse(load_scene(find("two_blocks"))))
    summary = limit_analysis_summary(results.analysis) | {"structure": structure_facts(results), "yade": None}
    told = " ".join(plain_words(summary, Units(summary["weight"])))
    for words in (
        "settles, 1 of the 2 blocks (50 % of their mass) moves.",
        "The support then still carries",
        "50",
        "YADE was not run",
        "friction coefficient",
    ):
        assert words in told, told
    falls = {"limit_analysis": {"associated": {"status": "infeasible", "falling": ["a", "b"]}}}
    told = ["The structure cannot stand: 2 blocks fall (a, b).", "No forces between the blocks can hold the structure"]
    assert [sentence.split(", so")[0] for sentence in plain_words(falls, Units(None))] == told
    assert plain_words(falls | {"verdict": "cannot stand"}, Units(None))[0].startswith(told[1])  # the verdict already names the blocks


CHANGED = {
    "drawings": [
        {"file": "wall.dxf", "blocks": 40, "doubles": 6, "specks": 0, "loose_lines": 2, "in_openings": 0, "straightened": 0, "compounds": 3}
        | {"ignored": {"TEXT": 4}}
    ],
    "repairs": {"tolerance": 0.003, "joint_width": 0.016, "largest_move": 0.0071, "moved_block": "block 7", "gaps_closed": 81}
    | {"overlaps_closed": 9, "overlaps_cut": 1, "shortest_joint": 0.006}
    | {"unclosed": [{"blocks": ["block 3", "block <4>"], "vertex": [1.25, 0.0, 2.5], "gap": -0.004}]},
    "joints_dropped": 5,
    "short_joints": 0,
}
CHANGES = (
    "blocks from wall.dxf 40", "outlines drawn twice, dropped 6", "lines that enclose nothing, dropped 2", "several parts 3", "4 TEXT",
    "wrong by 3 mm", "open joints closed, up to 16 mm wide 81", "overlapping faces parted 9", 'of "block 7" 7.1 mm', "too short to count 5",
    "places that are not closed 1", '"block 3" and "block <4>", at (1.25, 0, 2.5) m overlap of 4 mm',
)  # fmt: skip


def test_the_report_lists_what_reading_changed_in_the_geometry(tmp_path: Path) -> None:
    page, markdown = page_and_markdown(tmp_path, comparison_of(geometry=CHANGED))
    part = page[page.index('id="scene-1-geometry"') :]
    shown = " ".join(html.unescape(re.sub(r"<[^>]*>", " ", part)).split())
    for words in CHANGES:
        assert words in shown, words
    assert "changed in the geometry on reading" in markdown and "| 7.1 mm |" in markdown
    assert "block <4>" not in page
    unchanged, _ = page_and_markdown(tmp_path, comparison_of(geometry=None))
    assert "scene-1-geometry" not in unchanged


def test_a_turning_support_is_said_to_turn_about_its_axis() -> None:
    facts = {
        "gravity": [0.0, 0.0, -9.81],
        "friction": [0.6],
        "inset": 0.001,
        "densities": [],
        "size": [1.0] * 3,
        "block_size": [[1.0] * 3] * 2,
    }
    spin, point = np.array([0.0, -1.0, 0.0]), np.array([1.2, 0.0, -0.3])
    turning = {"structure": facts | {"motion": [*np.cross(point, spin), *spin]}, "unit": "N m"}
    rows = dict(input_rows(turning, Units(1000.0)))
    assert rows["rotation of the support, right-handed"] == "about the axis (0, −1, 0) through the point (1.2, 0, −0.3) m"
    assert not any("unit vector" in name for name in rows)


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ({}, {"limit analysis": "2000 kN/mm"}),
        ({"normal_stiffness": 2e9 * (1.0 + 1e-12), "shear_stiffness": 2e9}, {"both methods": "2000 kN/mm"}),
        (
            {"normal_stiffness": 6.4e10, "shear_stiffness": 6.4e10},
            {"limit analysis": "2000 kN/mm", "YADE": "64000 kN/mm, 32 times that of limit analysis"},
        ),
    ],
)
def test_each_method_s_joints_have_their_own_stiffness(settings: dict[str, float], expected: dict[str, str]) -> None:
    comparison = {"joints": {"normal": 2e9, "shear": 2e9, "travel": 8e-4}, "settings": settings}
    rows = {name: text for name, text in input_rows(comparison, Units(1000.0)) if "stiffness" in name}
    assert rows == {f"{way} stiffness of a contact point, {who}": text for way in ("normal", "shear") for who, text in expected.items()}


FACTS = {"friction": [0.6], "motion": [0.0, 0.0, -1.0, 0.0, 0.0, 0.0], "gravity": [0.0, 0.0, -9.81], "live": [1.0, 0.0, 0.0]}
ASSUMED = "Assumed: friction coefficient 0.6, dry joints without mortar, cohesion or tension, rigid blocks that do not crush."


@pytest.mark.parametrize("known", [False, True])
@pytest.mark.parametrize(
    ("quantity", "tilts", "bound", "value"),
    [
        ("reaction", False, "still carries at least 500 N, 50 % of the weight W = 1000 N: this is the lower bound", "carries 500 N"),
        (
            "multiplier",
            False,
            "fails at no more than 0.5000 times its weight, W = 1000 N: this is the upper bound",
            "fails at 0.5000 times",
        ),
        ("multiplier", True, "about y of at most 26.565 degrees by limit analysis (this is the upper bound", "of 26.565 degrees"),
    ],
)
def test_a_bound_is_not_given_as_the_answer(quantity: str, tilts: bool, bound: str, value: str, known: bool) -> None:
    """Without a Coulomb prediction the conclusion gives the associated answer and calls it a bound."""
    answer = {"status": "solved", quantity: 500.0 if quantity == "reaction" else 0.5, "angle": 26.565 if tilts else None}
    answers = {"associated": answer, "coulomb": answer if known else {"status": "failed", quantity: None, "angle": None}}
    structure = FACTS | ({"tilt": [0.0, 1.0, 0.0]} if tilts else {})
    comparison = {"limit_analysis": answers, "structure": structure, "weight": 1000.0, "unit": "N" if quantity == "reaction" else ""}
    told = " ".join(plain_words(comparison, Units(50.0)))
    assert (bound in told) != known and (value in told) == known, told
    assert predicted_value(comparison) == answer[quantity]


@pytest.mark.parametrize(
    ("motion", "unit", "reaction", "words"),
    [
        ([0.0, 0.0, -1.0, 0.0, 0.0, 0.0], "N", 500.0, ""),
        ([0.0, 0.0, -1.0, 0.0, 0.0, 0.0], "N", -1e-9, ""),  # nothing but rounding errors
        ([0.0, 0.0, -1.0, 0.0, 0.0, 0.0], "N", -500.0, "holds the support back: a force of this size must move it."),
        ([1.0, 0.0, 0.0, 0.0, 0.0, 0.0], "N", -500.0, "holds the support back: a force of this size must move it."),
        ([0.0, 0.0, 0.0, 0.0, 1.0, 0.0], "N m", -500.0, "holds the support back: a moment of this size must turn it."),
    ],
)
def test_the_conclusion_says_what_a_negative_reaction_means(motion: list[float], unit: str, reaction: float, words: str) -> None:
    """A sinking wedge that drives two blocks apart carries nothing, but the conclusion once said that it carries -500 N."""
    answer = {"status": "solved", "reaction": reaction}
    comparison = {"limit_analysis": {"associated": answer, "coulomb": answer}, "structure": FACTS | {"motion": motion}}
    told = " ".join(plain_words(comparison | {"weight": 1000.0, "unit": unit}, Units(50.0)))
    assert told.endswith(f"The minus says that the structure {words} {ASSUMED}") if words else "holds the support back" not in told
    assert ("still carries" in told) == (not words)


BOUNDS = {"status": "solved", "reaction": 400.0, "reaction_max": 900.0}
COULOMB = {"status": "solved", "reaction": 500.0, "uncertainty": 2.0, "reaction_interval": [450.0, 600.0], "interval_status": "limited"}
PLATEAU = {"status": "plateau", "reaction": 501.0, "uncertainty": 4.0}


def known(coulomb: dict[str, Any], associated: dict[str, Any] = BOUNDS, yade: dict[str, Any] = PLATEAU, **changes: Any) -> str:
    comparison = {"limit_analysis": {"associated": associated, "coulomb": coulomb}, "structure": FACTS, "weight": 1000.0, "unit": "N"}
    return " ".join(plain_words(comparison | {"yade": yade} | changes, Units(1000.0)))


def test_the_conclusion_says_how_well_the_values_are_known() -> None:
    """A reader who copies one number finds beside it its uncertainty and the interval that friction's history leaves open."""
    told = known(COULOMB)
    stated = "the reaction is 0.500 ± 0.002 kN by limit analysis and 0.501 ± 0.004 kN in YADE."
    assert f"With the uncertainty that each method states, {stated}" in told
    assert "With another history of friction the same mechanism allows a reaction of 0.45000 to 0.60000 kN." in told
    assert "No state in balance on these contact points has a reaction outside 0.40000 to 0.90000 kN." in told
    point = known(COULOMB | {"reaction_interval": [500.0, 500.0], "uncertainty": 0.0}, yade=PLATEAU | {"uncertainty": None})
    assert not {"uncertainty", "history", "outside"} & set(point.split())


@pytest.mark.parametrize(
    ("interval", "status", "words"),
    [
        ([450.0, None], "limited", "the same mechanism allows a reaction of at least 0.45000 kN."),
        ([None, None], "unlimited", "the same mechanism allows every reaction."),
        ([None, None], "not stated", "How far another history of friction changes the reaction is unknown."),
    ],
)
def test_an_interval_without_two_ends_is_told_too(interval: list[float | None], status: str, words: str) -> None:
    told = known(COULOMB | {"reaction_interval": interval, "interval_status": status}, BOUNDS | {"reaction_max": None})
    assert words in told and "has a reaction below 0.40000 kN." in told and "–" not in told


def test_a_multiplier_is_called_one_and_an_angle_has_its_uncertainty_once() -> None:
    pushed = {"status": "solved", "multiplier": 0.64}
    coulomb = {"status": "solved", "multiplier": 0.5, "uncertainty": 0.002, "multiplier_interval": [0.45, 0.6]}
    plateau = {"status": "plateau", "reaction": 0.501, "uncertainty": 0.004}
    told = known(coulomb, pushed, plateau, unit="")
    assert "states, the multiplier is 0.500 ± 0.002 by limit analysis and 0.501 ± 0.004 in YADE." in told
    assert "allows a multiplier of 0.45000 to 0.60000." in told and "in balance" not in told
    angles = ({"angle": 26.57, "angle_uncertainty": 0.1} | one for one in (coulomb, pushed, plateau))
    tilted = known(*angles, unit="", structure=FACTS | {"tilt": [0.0, 1.0, 0.0]})
    assert tilted.count("±") == 2 and "allows a multiplier of" in tilted


def test_a_push_is_given_as_a_force_too() -> None:
    """Without the force, a reader takes the weight beside the multiplier for the push at failure."""
    answer = {"status": "solved", "multiplier": 0.5}
    comparison = {"limit_analysis": {"associated": answer, "coulomb": answer}, "structure": FACTS, "weight": 1000.0, "unit": ""}
    told = " ".join(plain_words(comparison, Units(1000.0)))
    assert "fails at 0.5000 times its weight, W = 1 kN. The push is then 0.5000 kN." in told


def test_a_name_that_ends_in_a_unit_keeps_its_number() -> None:
    alone = {"limit_analysis": {"count": 1, "names": ["pier 3 N and lintel 2 m"]}}
    first = {"scene": "span 3 m", "verdict": "inconclusive", "reason": "apart by 3 N."}
    comparison = {"first_verdict": first, "structure": {"joints_of_one_method": alone}}
    shown = " ".join(Units(1000.0).words(note) for note in scene_view._notes(comparison))
    assert '"pier 3 N and lintel 2 m"' in shown and '"span 3 m", was' in shown and "apart by 0.003 kN" in shown


@pytest.mark.parametrize(("per", "unit"), [("", "kg"), ("per = 'm'", "kg/m"), ("per = 'm2'", "kg/m2")])
def test_the_unit_of_a_load_is_that_of_its_own_kind(per: str, unit: str) -> None:
    (mass,) = [row for row in key_rows(f"[[load]]\nname = 'floor'\nmass = 900.0\n{per}\n") if row[0] == "load[0].mass"]
    assert mass[1] == f"900.0 {unit}"


def test_the_share_of_a_reaction_of_round_off_is_0_percent() -> None:
    """For a block on a support that slides horizontally, the sentence once said "0 kN, -1e-7 % of the weight"."""
    answer = {"status": "solved", "reaction": -1e-6}
    comparison = {"limit_analysis": {"associated": answer, "coulomb": answer}, "structure": FACTS, "weight": 1000.0, "unit": "N"}
    assert "0 kN, 0 % of the weight W" in " ".join(plain_words(comparison, Units(1000.0)))


def test_the_conclusion_names_the_weight_that_is_pushed() -> None:
    """A block of 1000 N and a mass on it are pushed. A dead load by force counts in W, but is not pushed."""
    loads = [{"name": "mass", "force": [0.0, 0.0, -100.0], "mass": 100.0 / 9.81, "blocks": 1}]
    answer = {"associated": {"status": "solved", "multiplier": 0.5}, "coulomb": {"status": "solved", "multiplier": 0.5}}
    yade = {"reaction": 0.5, "status": "plateau"}

    def told(more: list[dict[str, Any]], weight: float) -> str:
        structure = FACTS | {"loads": loads + more}
        comparison = {"limit_analysis": answer, "structure": structure, "weight": weight, "unit": "", "yade": yade}
        return " ".join(plain_words(comparison, Units(50.0)))

    assert "fails at 0.5000 times its weight, W = 1100 N." in (alone := told([], 1100.0))
    assert "YADE gives 0.5000 times its weight." in alone
    pressed = told([{"name": "cable", "force": [30.0, 0.0, -400.0], "mass": None, "blocks": 1}], 1500.0)
    assert "fails at 0.5000 times the pushed weight, 1100 N." in pressed
    assert "YADE gives 0.5000 times the pushed weight." in pressed
    lifted = told([{"name": "balloon", "force": [0.0, 0.0, 400.0], "mass": None, "blocks": 1}], 1100.0)
    assert "times its weight, W = 1100 N." in lifted  # a lifting force is no part of W


def test_the_place_of_a_support_has_no_round_off() -> None:
    support = {"names": ["pad"], "low": [-4.04e-27, -2.6e-18, -0.3], "high": [0.55, 0.4, -1.0473639561444162e-06]}
    comparison = {"structure": FACTS | {"support": support}, "weight": 1000.0, "unit": "N"}
    facts = comparison["structure"] | {"densities": [], "inset": 0.0, "size": [1.0] * 3, "block_size": [[1.0] * 3] * 2}
    rows = dict(input_rows(comparison | {"structure": facts}, Units(1000.0)))
    assert rows["support"] == "pad: x 0 to 0.55 m, y 0 to 0.4 m, z −0.3 to 0 m"
    assert 'the support ("pad", x = 0 to 0.55 m)' in " ".join(plain_words(comparison, Units(1000.0)))
    long = {"names": ["pad"], "low": [-0.0004, 0.0, -0.3], "high": [2.0, 0.4, 0.0]}
    assert "x = 0 to 2 m" in " ".join(plain_words(comparison | {"structure": FACTS | {"support": long}}, Units(1000.0)))


def test_a_place_far_from_the_origin_is_given_as_exactly_as_one_near_it() -> None:
    """Coordinates of a survey have six digits before the point. The lever arm of a turning support needs the digits after the point."""
    support = {"names": ["pad"], "low": [432100.804, 0.0, -0.3], "high": [432101.906, 0.4, 0.0]}
    axis, point = np.array([0.0, 1.0, 0.0]), np.array([432100.125, 0.0, -0.5])
    motion = [*np.cross(point, axis).tolist(), *axis.tolist()]
    comparison = {"structure": FACTS | {"support": support, "motion": motion}, "weight": 1000.0, "unit": "N m"}
    facts = comparison["structure"] | {"densities": [], "inset": 0.0, "size": [1.0] * 3, "block_size": [[1.0] * 3] * 2}
    rows = dict(input_rows(comparison | {"structure": facts}, Units(1000.0)))
    assert rows["support"].startswith("pad: x 432100.804 to 432101.906 m")
    assert rows["rotation of the support, right-handed"].endswith("through the point (432100.125, 0, −0.5) m")
    assert "x = 432100.804 to 432101.906 m" in " ".join(plain_words(comparison, Units(1000.0)))


@pytest.mark.parametrize(("unit", "travel", "speed"), [("N", "0.002 m", "0.1 m/s"), ("N m", "0.002 rad", "0.1 rad/s")])
def test_every_setting_of_yade_has_its_unit(unit: str, travel: str, speed: str) -> None:
    settings = {"max_travel": 0.002, "speed": 0.1, "poses": 40, "rest_energy": 1e-6, "unknown": 1.5}
    rows = dict(setting_rows({"unit": unit, "settings": settings}))
    assert rows == {"max_travel": travel, "speed": speed, "poses": "40", "rest_energy": "1e-06 J", "unknown": "1.5"}
    assert setting_rows({"unit": unit}) == []


def test_a_setting_that_the_scene_gives_has_its_unit() -> None:
    text = find("two_pads").read_text(encoding="utf-8") + "\n[yade]\nspeed = 0.01\nthreads = 1\n"
    given = {row[0]: row[1] for row in key_rows(text)}
    assert given["yade.speed"] == "0.01 m/s" and given["yade.threads"] == "1"


@pytest.mark.parametrize(
    ("recording", "span"),
    [("states", "from rest under gravity to its end"), ("plateau", "from its first to its last stored state on the plateau")],
)
def test_the_energies_say_what_they_cover_and_what_the_turnover_is(recording: str, span: str, tmp_path: Path) -> None:
    energy = {"weights": -1.4, "support": 0.0, "load": 1.6, "kinetic": 0.0, "elastic": 0.1, "friction": 0.1, "viscous": -0.01}
    comparison = comparison_of(energy=energy | {"turnover": 0.7, "drift": 0.01})
    comparison["effects"]["recording"] = recording
    page, markdown = page_and_markdown(tmp_path, comparison)
    assert f"Energy of YADE's run, {span}<" in page and f"| energy of YADE's run, {span} |" in markdown
    for text in (page, markdown):
        assert "−200.00 %" in text and "The turnover is the sum of the work on each block" in text
        assert f"the work of {percent(LEAST_TURNOVER)} of the weight over the settlement, the check takes its shares of this work" in text


def test_a_block_alone_is_no_share_of_all_blocks() -> None:
    results = Results(analyse(load_scene(find("two_pads"))))
    summary = limit_analysis_summary(results.analysis) | {"structure": structure_facts(results), "yade": None}
    assert "settles, the only block moves." in plain_words(summary, Units(summary["weight"]))[0]


PADS = {"fixed": ("fixed", 0.0, 0.3), "moves": ("support", 1.7, 2.0)}  # role, and the ends of a pad under a block of 2 m


def on_pads(settlement: dict[str, Any]) -> dict[str, Any]:
    """A summary of limit analysis for a block on two pads, of which one moves."""
    pads = [{"name": name, "role": role, "box": {"from": [a, 0.0, -0.2], "to": [b, 1.0, 0.0]}} for name, (role, a, b) in PADS.items()]
    block = {"name": "block", "box": {"from": [0.0, 0.0, 0.0], "to": [2.0, 1.0, 0.3]}}
    scene = {"stone": {"density": 2000.0}, "joint": {"friction": 0.6}, "block": [*pads, block], "settlement": settlement}
    results = Results(analyse(la_core.build(scene)))
    return limit_analysis_summary(results.analysis) | {"structure": structure_facts(results), "yade": None}


@pytest.mark.parametrize(
    ("settlement", "moves", "carries"),
    [
        ({"direction": [0.0, 0.0, -1.0]}, "settles, the only", "The support then still carries"),
        ({"direction": [0.3, 0.0, -1.0]}, "moves along (0.287, 0, −0.958), the only", "The force on the support along its motion is then"),
        (
            {"axis": [0.0, 1.0, 0.0], "point": [0.0, 0.0, 0.0], "zone": [{"blocks": ["moves"], "ratio": 0.5}]},
            "turns by a share of the rotation, the only",
            "The moment on the support, times its share of the rotation, is then",
        ),
    ],
)
def test_the_support_carries_what_acts_along_a_vertical_motion_alone(settlement: dict[str, Any], moves: str, carries: str) -> None:
    """Along an oblique motion the force was called a share of the weight; a moment was told without the share that multiplies it."""
    summary = on_pads(settlement)
    first, second, *_ = plain_words(summary, Units(summary["weight"]))
    assert moves in first and second.startswith(carries)
    turns = [text for name, text in input_rows(summary, Units(summary["weight"])) if name.startswith("of it")]
    assert len(turns) == ("zone" in settlement) and all("angular (0, 0.5, 0) rad/rad" in text for text in turns)


def test_a_structure_that_falls_has_no_answer_for_small_displacements(tmp_path: Path) -> None:
    comparison = comparison_of()
    comparison["effects"] |= {"rotation": "small", "reasons": {"rotation": "the answer is for small displacements"}}
    assert "Rotations of the blocks are small" in page_and_markdown(tmp_path, comparison)[0]
    comparison["limit_analysis"]["associated"] = {"status": "infeasible", "reaction": None, "falling": ["b"]}
    assert "Rotations of the blocks are small" not in page_and_markdown(tmp_path, comparison)[0]
