"""A report shows the value of each method, its uncertainty, and its difference from the other method."""

import re
from pathlib import Path
from typing import Any

import pytest
import scenes
from conftest import Silent
from made_up_comparisons import comparison_of, frictional_comparison, page_and_markdown, values_part

import la_core
from comparison.figures.reaction_levels import levels
from comparison.judge.checks.answer import check_expected
from comparison.judge.summary import limit_analysis_summary
from comparison.numbers import Units, format_number
from comparison.report import notes_of, report, values
from comparison.report.plain_words import plain_words
from comparison.report.scene_view import view_of_scene
from comparison.report.values import rounding_words
from comparison.verdict.verdict_table import verdict_cells, verdict_title
from comparison.workflow import run_scene
from la_core.analysis.stage import analyse
from la_core.scene.scene import load_scene
from la_core.scene.shipped import find


def test_the_inset_of_yade_is_what_it_is_judged_by(tmp_path: Path) -> None:
    comparison = comparison_of()
    comparison["limit_analysis"]["associated"] |= {
        "inset": 0.0,
        "shared_inset": {"inset": 0.001, "reaction": 364.0, "reaction_max": 2150.0},
    }
    page = report.write_report(tmp_path, [comparison], {}).read_text(encoding="utf-8")
    assert ">0.36400 kN<" in page and ">2.1500 kN<" in page
    assert "−0.00050 kN (−0.14 %)" in page


def test_the_coulomb_prediction_stands_with_its_interval_and_what_yade_is_above_it(tmp_path: Path) -> None:
    page, markdown = page_and_markdown(tmp_path, frictional_comparison())
    row = values_part(page)
    for words in ("0.3660 ± 0.0008 kN", "0.36330 to 0.37130 kN", "−0.00250 kN (−0.68 %)"):
        assert words in row
    assert "several plateaus:" not in row
    assert "less R_min" not in row
    (top,) = (line for line in markdown.splitlines() if line.startswith("| two pads | ? inconclusive"))
    assert "| 0.3660 ± 0.0008 kN | 0.36330 to 0.37130 kN |" in top
    assert top.endswith("| −0.00250 kN (−0.68 %) |")


def test_the_value_after_a_release_stands_below_the_prediction_where_it_is_known(tmp_path: Path) -> None:
    comparison = frictional_comparison()
    name = "limit analysis: prediction after turning blocks release thrusts"
    assert name not in page_and_markdown(tmp_path, comparison)[0]
    comparison["limit_analysis"]["coulomb"] |= {"released": 331.0, "released_uncertainty": 1.2}
    rows = list(values.value_rows(values.values_of(comparison, Units(comparison["weight"]))))
    (place,) = (k for k, row in enumerate(rows) if row[0] == name)
    assert rows[place - 1][0] == "limit analysis: Coulomb prediction"
    assert rows[place][1:] == ("0.331 ± 0.001 kN", f"{format_number(331.0 / comparison['weight'])} of W")
    assert name in page_and_markdown(tmp_path, comparison)[0]


def test_the_verdict_table_shows_the_uncertainty_of_both_methods_and_several_plateaus() -> None:
    comparison = frictional_comparison()
    _, _, predicted, _, yade, *_ = verdict_cells(comparison)
    assert (predicted, yade) == ("0.1696 ± 0.0003", "0.1684 ± 0.0001")
    comparison["limit_analysis"]["coulomb"] |= {"plateaus": [366.0, 402.5], "status": "inaccurate"}
    assert verdict_cells(comparison)[2] == "0.1696 ± 0.0003 inaccurate; several plateaus: 0.1696, 0.1865"


def test_without_a_coulomb_answer_yade_is_held_against_the_bound(tmp_path: Path) -> None:
    page, markdown = page_and_markdown(tmp_path, comparison_of())
    row = values_part(page)
    assert "0.00020 kN (+0.055 %)" in row
    assert "YADE less R_min" in row
    assert "| 0.00020 kN (+0.055 %) (less R\\_min) |" in markdown


def test_every_method_says_what_it_is_worth_and_what_it_took(tmp_path: Path) -> None:
    page, markdown = page_and_markdown(tmp_path, frictional_comparison())
    for text in (page, markdown):
        for words in (
            "7 iterations", "largest residual 1e-10", "2 paths, 1207 steps, 19 Newton iterations", "± 0.00075 kN", "half-width 0.004 kN",
            "2 increments, 43 Newton iterations", "largest share of drag 4.5e-4", "1 increment not reached", "34233 steps",
        ):  # fmt: skip
            assert words in text
    for seconds in ("0.010", "0.23", "0.57", "8.1"):
        assert f'data-label="time, s">{seconds}</td>' in page
    assert "Coulomb: power of the normal forces at parting joints, over the power put in" in page


def test_each_scene_of_a_report_has_the_units_of_its_own_figures(tmp_path: Path) -> None:
    """In kN, the unit of a wall, the forces of a model of 5 cm would have powers of ten."""
    small, large = (comparison_of(scene=name, weight=weight) for name, weight in (("model", 50.0), ("wall", 5e5)))
    page = report.write_report(tmp_path, [small, large], {}).read_text(encoding="utf-8")
    assert "W = 50 N" in page and "W = 500 kN" in page and "Forces in this report are in N or kN" in page


def test_an_uncertain_prediction_shows_all_its_plateaus_and_an_older_one_no_uncertainty(tmp_path: Path) -> None:
    comparison = frictional_comparison()
    coulomb = comparison["limit_analysis"]["coulomb"]
    coulomb["plateaus"] = [366.0, 402.5]
    for text in page_and_markdown(tmp_path, comparison):
        assert "several plateaus: 0.3660, 0.4025 kN" in text
    for name in ("uncertainty", "plateaus", "viscosities", "steps", "travel"):
        del coulomb[name]
    page, markdown = page_and_markdown(tmp_path, comparison)
    assert "| 0.36600 kN | 0.36330 to 0.37130 kN |" in markdown
    assert "several plateaus:" not in page
    row = values_part(page)
    assert row.count("±") == 1  # YADE's uncertainty


def test_the_work_of_a_prediction_of_version_0_2_0_is_counted_in_what_it_solved(tmp_path: Path) -> None:
    comparison = frictional_comparison()
    comparison["limit_analysis"]["coulomb"] |= {"viscosities": [], "steps": 8}
    for text in page_and_markdown(tmp_path, comparison):
        assert "8 steps, 19 associated programmes" in text and "2 increments, 43 associated programmes" in text
        assert "Newton iterations" not in text


def test_mechanisms_are_measured_by_method_and_unknown_ones_left_out(tmp_path: Path) -> None:
    page, markdown = page_and_markdown(tmp_path, frictional_comparison())
    table = page[page.index("Measures of the mechanisms") :]
    table = table[: table.index("</table>")]
    assert [name for name in ("associated", "Coulomb", "YADE") if f">limit analysis, {name}<" in table or f">{name}<" in table] == [
        "associated",
        "Coulomb",
    ]
    for words in ("0.05125 kN", "0.138", "0.912", "0.0815", "0.250"):
        assert words in table
        assert words.removesuffix(" kN") in markdown
    assert "(Σp)²/(J Σp²)" in page


def test_the_inset_of_yade_is_what_the_prediction_is_shown_at(tmp_path: Path) -> None:
    comparison = frictional_comparison()
    comparison["limit_analysis"]["coulomb"]["shared_inset"] = {"inset": 0.001, "reaction": 364.5, "reaction_interval": [363.5, 363.51]}
    page, _ = page_and_markdown(tmp_path, comparison)
    row = values_part(page)
    assert ">0.36450 kN<" in row
    assert "a point" in row
    assert "−0.00100 kN" in row


@pytest.mark.parametrize(("status", "words"), [("not stated", "not stated: thresholds of slip"), ("unlimited", "unlimited"), (None, "–")])
def test_an_interval_without_ends_says_why(status: str | None, words: str) -> None:
    comparison = frictional_comparison()
    comparison["limit_analysis"]["coulomb"] |= {"reaction_interval": [None, None], "interval_status": status}
    assert values.values_of(comparison, Units(comparison["weight"]))["interval"].startswith(words)


def test_without_a_prediction_no_interval_is_withheld() -> None:
    comparison = frictional_comparison()
    missing = {"status": "infeasible", "reaction": None, "reaction_interval": [None, None], "interval_status": "not stated"}
    comparison["limit_analysis"]["coulomb"] |= missing
    assert values.values_of(comparison, Units(comparison["weight"]))["interval"] == "–"


def test_a_reaction_that_is_only_round_off_is_zero() -> None:
    comparison = frictional_comparison()
    comparison["limit_analysis"]["associated"]["reaction"] = 1e-10 * comparison["weight"]
    assert values.values_of(comparison, Units(comparison["weight"]))["least"] == 0.0


@pytest.mark.parametrize(("share", "words"), [(0.9e-4, "–"), (1.1e-4, "+100 %")])
def test_a_difference_is_no_share_of_a_reaction_that_counts_as_zero(share: float, words: str) -> None:
    comparison = frictional_comparison()
    weight = comparison["weight"]
    comparison["limit_analysis"]["coulomb"]["reaction"], comparison["yade"]["reaction"] = share * weight, 2.0 * share * weight
    results = values.values_of(comparison | {"least_tolerance": 1e-4 * weight}, Units(weight))
    assert results["difference_words"] == words
    assert ("%" in dict(row[:2] for row in values.value_rows(results))["YADE less Coulomb"]) is (words != "–")


def test_powers_under_a_live_load_are_per_unit_power_of_the_load(tmp_path: Path) -> None:
    comparison = frictional_comparison(unit="", yade=None)
    answers = comparison["limit_analysis"]
    for answer in (answers["associated"], answers["coulomb"], answers["path"]):
        for name in [name for name in answer if name.startswith("reaction")]:
            answer[name.replace("reaction", "multiplier")] = answer.pop(name)
    answers["coulomb"]["multiplier_interval"] = [363.3, None]
    page, markdown = page_and_markdown(tmp_path, comparison)
    assert "at least 363.30" in page
    assert "per unit power of the load" in page
    assert "The multiplier is the factor of the live load" in markdown and "R is the reaction" not in markdown


@pytest.mark.parametrize("empty", [None, {}])
def test_older_files_and_empty_answers_are_shown(empty: Any, tmp_path: Path) -> None:
    comparison = frictional_comparison()
    comparison["limit_analysis"] |= {"coulomb": empty, "path": empty}
    comparison["mechanism_measures"] = {"coulomb": empty, "yade": {"moving_mass_share": 0.5}}
    page, _ = page_and_markdown(tmp_path, comparison)
    assert "less R_min" in page
    del comparison["mechanism_measures"], comparison["limit_analysis"]["coulomb"], comparison["limit_analysis"]["path"]
    page, _ = page_and_markdown(tmp_path, comparison)
    assert "Measures of the mechanisms" not in page
    comparison["limit_analysis"]["path"] = {"settlement": [], "reaction": [], "strain_residual": [], "converged": [], "solves": []}
    comparison["limit_analysis"]["coulomb"] = {"status": "failed", "reaction": None, "reaction_interval": [None, None]}
    page, _ = page_and_markdown(tmp_path, comparison)
    assert ">failed<" in page
    assert "0 increments" in page


def test_an_expected_value_stands_beside_the_answer_with_its_own_friction() -> None:
    scene = load_scene(find("two_blocks"))
    rows = {row["name"]: row for row in values.expected_rows(limit_analysis_summary(analyse(scene)))}
    assert rows["R / W"]["found"] == pytest.approx(0.5, rel=2e-3)
    assert rows["R_min / W, associated"]["found"] == pytest.approx(0.5 / 1.36, rel=1e-6)


def test_an_expected_moment_over_the_weight_is_a_length() -> None:
    turn = {"settlement.direction": None, "settlement.axis": [0.0, 1.0, 0.0], "settlement.point": [0.4, 0.0, 0.0]}
    expected = {"expected": {"reaction_over_weight": 0.1, "kind": "exact", "tolerance": 1e-6}}
    analysis = analyse(la_core.variant("two_pads", turn | expected))
    (row,) = values.expected_rows(limit_analysis_summary(analysis))
    assert row["name"] == "R / W, m"
    assert row["found"] == pytest.approx(0.1, abs=1e-6)  # W / 6 acts 0.6 m from the axis
    (check,) = check_expected(analysis)
    assert check.unit == "m (R/W)"


def test_a_row_writes_all_numbers_alike() -> None:
    comparison = comparison_of()
    comparison["limit_analysis"]["associated"] |= {"reaction": -0.1 * 2158.2, "reaction_max": 0.998 * 2158.2}
    comparison["yade"] |= {"reaction": -0.1 * 2158.2, "uncertainty": 1e-12}
    assert verdict_cells(comparison)[1:5] == ["−0.10000", "–", "0.99800", "−0.10000"]


def test_a_multiplier_without_a_limit_is_called_so_where_its_bound_would_stand() -> None:
    comparison = comparison_of(unit="", yade=None)
    comparison["limit_analysis"]["associated"] = {"status": "unbounded", "multiplier": None, "seconds": 0.01}
    assert verdict_cells(comparison)[1:5] == ["–", "–", "unbounded", "–"]


def test_the_title_says_what_the_numbers_are() -> None:
    for units, words in (
        ({"N"}, ("reaction over the weight",)),
        ({"N m"}, ("moment on the turning support", "in m")),
        ({""}, ("multiplier of the live load",)),
        ({"N", "N m", ""}, ("reaction over the weight", "of a turning support its moment over W, in m", "of a live load its multiplier")),
    ):
        title = verdict_title(units)
        assert all(word in title for word in words) and title.startswith(words[0])


def test_a_page_says_of_a_moment_that_it_is_one(tmp_path: Path) -> None:
    turning = comparison_of(unit="N m")
    turning["yade"] |= {"settlement": 1e-4}
    (tmp_path / "two pads").mkdir()
    (tmp_path / "two pads" / "reaction.png").write_bytes(b"a picture")
    page = report.write_report(tmp_path, [turning], {}).read_text(encoding="utf-8")
    for words in (
        "R is the moment of the support against its rotation",
        "Moment of the support against its rotation, from rest.",  # the moment of the structure on the support acts along the rotation
        "rotation imposed in YADE",
    ):
        assert words in page
    assert "orce on the support" not in page and "force of the support" not in page


@pytest.mark.parametrize(
    ("changes", "shown", "hidden"),
    [
        ({"yade": None}, (), ("YADE",)),
        ({"yade": {"status": "collapsed", "settlement": 0.0}}, ("YADE has no record of a settlement (collapsed).",), ("plateau",)),
        ({"yade": {"status": "timeout", "settlement": 1e-4}}, ("YADE: the record, which has no plateau (timeout).",), ("extrapolated",)),
        ({"limit_analysis": {"coulomb": {"status": "failed", "reaction": None}}}, ("Limit analysis: the bounds.",), ("prediction",)),
        ({"limit_analysis": {"associated": {"status": "infeasible", "reaction": None}, "coulomb": None}}, (), ("Limit analysis",)),
        (
            {"joints": {"normal": 2e9}, "settings": {"normal_stiffness": 8e9}},
            ("plateau extrapolated", "its curve from rest, and the interval of values", "4 times as stiff as those of limit analysis"),
            ("released",),
        ),
        (
            {"joints": {"normal": 2e9}, "settings": {"normal_stiffness": 128e9}, "effects": {"rotation": "finite"}},
            ("at which YADE's joints, 64 times as stiff as those of limit analysis, have released as much.",),
            ("divided",),  # the divisor would be the root of 16 times 64
        ),
        ({"effects": {"rotation": "finite"}}, ("at which the joints have released as much.",), ("divided",)),
    ],
)
def test_the_caption_says_what_the_figure_shows(
    changes: dict[str, Any], shown: tuple[str, ...], hidden: tuple[str, ...], tmp_path: Path
) -> None:
    comparison = frictional_comparison()
    comparison["limit_analysis"]["coulomb"] |= {"curve": {"settlement": [0.0, 1e-4], "reaction": [800.0, 366.0]}}
    comparison |= changes | {"limit_analysis": comparison["limit_analysis"] | changes.get("limit_analysis", {})}
    (tmp_path / "two pads").mkdir()
    (tmp_path / "two pads" / "reaction.png").write_bytes(b"a picture")
    (figure,) = view_of_scene(tmp_path, 1, comparison, Units(1000.0))["figures"]
    assert all(words in figure["caption"] for words in shown), figure["caption"]
    assert not any(words in figure["caption"] for words in hidden), figure["caption"]


def test_w_is_said_to_hold_the_loads_wherever_reactions_are_given_over_it(tmp_path: Path) -> None:
    page, markdown = page_and_markdown(tmp_path, comparison_of())
    for text in (page, markdown.replace("\n", " "), verdict_title({"N"}), verdict_title({"N m"}), values.MEANINGS["N m"]):
        assert "weight" in text and ("of the free blocks and the loads on them" in text or "of the free blocks and their loads" in text)


def test_several_plateaus_are_told_beside_the_conclusion_unless_its_reason_tells_them() -> None:
    """A reader of the conclusion alone would take its value, which may be the unsafe one."""
    comparison = frictional_comparison()
    comparison["limit_analysis"]["coulomb"]["plateaus"] = [366.0, 402.5]
    told = "several plateaus: 366, 402.5 N. A small disturbance decides between them: work with the least favourable one."
    assert any(note.endswith(told) for note in notes_of(comparison))
    assert not any("plateaus" in note for note in notes_of(comparison | {"reason": "The structure has several plateaus (366 N, 402.5 N)."}))
    assert not any("plateaus" in note for note in notes_of(frictional_comparison()))


@pytest.mark.parametrize(("sharp", "is_told"), [(359.7, False), (340.0, True), (0.0, True), (None, False)])
def test_an_inset_that_changes_the_answer_much_is_told_beside_the_conclusion(sharp: float | None, is_told: bool) -> None:
    """An inset of 1 mm is a larger share of a small joint: a wall of stones of 100 x 30 mm bore 18 % more than with sharp edges."""
    comparison = comparison_of()
    comparison["limit_analysis"]["associated"] |= {"reaction": 363.3, "reaction_sharp": sharp, "inset": 0.001}
    notes = [note for note in notes_of(comparison) if note.startswith("The inset of 1 mm changes the associated reaction from ")]
    assert bool(notes) == is_told
    assert all(note.endswith("If the edges are less worn, set a smaller [joint] inset.") for note in notes)


def test_a_force_of_round_off_is_shown_as_zero() -> None:
    """By round-off, a block that stays on the fixed part of its ground pressed the settling part with 7.5e-10 kN."""
    assert Units(1500.0).text(7.5e-7, "N") == "0 kN" == Units(1500.0).text(-7.5e-7, "N")
    assert Units(1500.0).text(1e-3, "N") != "0 kN" and Units(None).text(7.5e-7, "N") != "0 kN"
    assert Units(1500.0).text(1e-9, "m") != "0 mm"


@pytest.mark.parametrize("tilts", [False, True])
def test_a_multiplier_of_round_off_is_shown_as_zero(tilts: bool, tmp_path: Path) -> None:
    """A block without friction failed "at 1.505e-11 times its weight", and "at a tilt of 8.624e-10 degrees"."""
    ground, block = scenes.box("ground", (-1.0, 0.0, -0.3), (2.0, 0.4, 0.0), "fixed"), scenes.box("block", (0.0, 0.0, 0.0), (0.6, 0.4, 0.4))
    drive: dict[str, Any] = {"tilt": (0.0, 1.0, 0.0)} if tilts else {"live": (1.0, 0.0, 0.0)}
    scene = scenes.build(ground, block, friction=0.0, inset=0.001, settlement=None, model="auto", **drive)
    summary = run_scene(scene, tmp_path, Silent(), with_yade=False)
    units = Units(scene.weight)
    words = " ".join(plain_words(summary, units))
    assert re.search(r"about y of 0(\.0+ ± 0\.0+[1-9])? degrees by limit" if tilts else "fails at 0 times its weight", words)
    assert rounding_words(summary, units) == "The inset of 1 mm does not change the associated multiplier, 0."
    assert values.values_of(summary, units)["coulomb"] == 0.0
    assert set(levels(analyse(scene)).values()) == {0.0}
    effects = summary["effects"]["reasons"]
    assert effects["rotation"] == "no joint has friction, so the mechanism allows one value"
