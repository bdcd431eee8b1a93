"""Laws of the report: its numbers, honest about what is missing, harmless to open, the same twice."""

import html
import json
import math
import re
import tomllib
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from comparison.judge.summary import limit_analysis_summary
from comparison.numbers import Units, format_number, plain_number, share_of, small_number, with_uncertainty
from comparison.report import report, structure_facts, values
from comparison.report.plain_words import plain_words
from comparison.verdict.verdict_table import verdict_cells
from comparison.yade import Results
from la_core.analysis.stage import analyse
from la_core.scene.scene import load_scene
from la_core.scene.shipped import find


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (None, "–"), (float("nan"), "–"), (float("inf"), "–"), (True, "–"), (0.0, "0"), (24.0, "24"), (22829, "22829"), (363.2987, "363.3"),
        (99999.6, "100000"), (-0.02981, "−0.02981"), (1.2344e-9, "1.234e-9"), (12345678.9, "1.235e7"),
    ],
)  # fmt: skip
def test_numbers(value: Any, shown: str) -> None:
    assert format_number(value) == shown


@pytest.mark.parametrize(
    ("value", "uncertainty", "shown"),
    [
        (0.0703164, 2.3e-5, "0.07032 ± 0.00002"), (1986.65, 0.65, "1986.7 ± 0.7"), (-0.5, 0.01, "−0.50 ± 0.01"),
        (0.16833, 1e-8, "0.16833"), (0.0, 1e-12, "0"), (0.16833, 0.0, "0.16833"), (0.16833, None, "0.16833"), (float("nan"), 0.1, "–"),
    ],
)  # fmt: skip
def test_a_value_has_the_digits_that_its_uncertainty_leaves(value: float, uncertainty: float | None, shown: str) -> None:
    assert with_uncertainty(value, uncertainty) == shown


HOSTILE = '<script>alert(1)</script> | `a` "b" https://example.org'
NUMBERS = ("limit_analysis", "yade", "difference", "tolerance")


def comparison_of(**changes: Any) -> dict[str, Any]:
    return {
        "scene": "two pads",
        "title": HOSTILE,
        "source": HOSTILE,
        "weight": 2158.2,
        "unit": "N",
        "free_blocks": 1,
        "interfaces": 2,
        "contact_points": 4,
        "effects": {
            "plane": True,
            "friction": "coulomb",
            "reasons": {"plane": HOSTILE},
            "table": [
                {"effect": "plane", "what": HOSTILE, "on": False, "modelled": "plane", "reason": HOSTILE, "saved": {"unknowns": 3}}
                | {"seconds": None},
                {"effect": "friction", "what": "sliding", "on": True, "modelled": "coulomb", "reason": "", "saved": {}, "seconds": 0.25},
            ],
        },
        "expected": {"reaction_over_weight": 0.16667, "reaction_max_over_weight": None, "tolerance": 1e-4, "kind": "exact"},
        "limit_analysis": {
            "associated": {
                "status": "solved", "reaction": 363.3, "reaction_max": 2153.9, "reaction_max_status": "solved", "reaction_sharp": 359.7,
                "reaction_max_sharp": 2158.2, "inset": 0.001, "equilibrium_residual": 1e-12, "cone_violation": 0.0,
                "mechanism_violation": 0.0, "duality_gap": 1e-10, "iterations": 7, "seconds": 0.01,
            },
            "coulomb": None,
        },
        "yade": {"status": "plateau", "reaction": 363.5, "uncertainty": 0.3, "steps": 34233, "seconds": 8.1, "slope": float("nan")},
        "checks": [
            {"name": HOSTILE, "verdict": "agree", "unit": "N", "reason": ""} | dict(zip(NUMBERS, (363.3, 363.5, 0.2, 3.6), strict=True)),
            {"name": "unknown", "verdict": "inconclusive", "unit": "", "reason": HOSTILE} | dict.fromkeys(NUMBERS),
        ],
        "verdict": "inconclusive",
        "reason": HOSTILE,
        "notes": [HOSTILE],
        "settings": {"time_step": 1e-6, "name": HOSTILE},
        "provenance": {"python": "3.11"},
        **changes,
    }  # fmt: skip


class Page(HTMLParser):
    """Tags, every attribute that could load something, and the text of table cells."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.links: list[str] = []
        self.ids: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.links += [value or "" for name, value in attrs if name in ("src", "href", "action", "srcset", "data")]
        self.ids += [value or "" for name, value in attrs if name == "id"]


def values_part(page: str) -> str:
    """The table of both methods' values of the first scene."""
    part = page[page.index('id="scene-1-values"') :]
    return part[: part.index("</table>")]


@pytest.mark.parametrize(
    ("value", "scale", "digits", "shown"),
    [
        (-4.1e-6, 0.3633, 5, "≈ 0"),  # kN: a difference of 0.004 N of two reactions
        (1.59e-4, 2.5524, 5, "0.0002"),
        (-0.0025, 0.366, 5, "−0.00250"),
        (0.0, 0.366, 5, "0"),  # exactly
        (2.44e-11, 1e-6, 3, "≈ 0"),  # far below its tolerance
        (3.5e-6, 1e-5, 3, "3.5e-6"),  # too many places
        (12.0, 250.0, 3, "12"),
        (math.nan, 1.0, 3, "–"),
        (0.5, math.nan, 3, "0.500"),
        (0.5, 0.0, 3, "0.500"),
    ],
)
def test_a_difference_has_the_places_of_what_it_is_compared_with(value: float, scale: float, digits: int, shown: str) -> None:
    assert small_number(value, scale, digits) == shown


def test_small_numbers_of_a_report_have_no_exponent_and_no_idle_zeros() -> None:
    assert [plain_number(value) for value in (1.28e-4, 0.0020, 0.05, 4.0, 20.0, 1e-9, None)] == [
        "0.00013", "0.002", "0.05", "4", "20", "1e-9", "–",
    ]  # fmt: skip
    assert plain_number(1.85, 3) == "1.85" and plain_number(-0.5, 3) == "−0.5"
    assert [share_of(apart, 2.0) for apart in (0.02, -1e-3, 1e-6, 0.0, None)] == ["+1 %", "−0.050 %", "≈ 0 %", "0 %", "–"]
    assert share_of(1.0, 0.0) == "–"


def test_the_page_loads_nothing_and_escapes_everything(tmp_path: Path) -> None:
    (tmp_path / "two pads").mkdir()
    (tmp_path / "two pads" / "assembly.png").write_bytes(b"not looked into")
    page = report.write_report(tmp_path, [comparison_of()], {"python": HOSTILE})
    read = Page(page.read_text(encoding="utf-8"))
    assert not {"script", "link", "iframe", "object"} & set(read.tags)
    assert read.tags.count("img") == 1
    assert all(link.startswith(("data:image/png;base64,", "#")) for link in read.links)
    assert {link[1:] for link in read.links if link.startswith("#")} <= set(read.ids)
    assert "url(" not in page.read_text(encoding="utf-8")


def test_every_markdown_table_keeps_its_columns(tmp_path: Path) -> None:
    report.write_report(tmp_path, [comparison_of(), comparison_of(yade=None, verdict=None)], {"python": HOSTILE})
    text = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert "<script" not in text.replace(r"\<", "")
    columns = 0
    for before, line in zip(["", *text.splitlines()], text.splitlines(), strict=False):
        if line.startswith("|"):
            count = len(re.findall(r"(?<!\\)\|", line))
            columns = columns if before.startswith("|") else count
            assert count == columns, line
    assert not re.search(r"\n\n\n\n", text)


def test_what_is_missing_is_a_dash_and_never_zero(tmp_path: Path) -> None:
    bare = {"scene": "bare", "verdict": None}
    page = report.write_report(tmp_path, [bare], {}).read_text(encoding="utf-8")
    row = values_part(page)
    assert "–" in row
    assert not re.search(r">\s*0", row)
    assert "Nothing was compared" in page


def test_the_verdict_is_a_word_and_the_costs_are_shown(tmp_path: Path) -> None:
    page = report.write_report(tmp_path, [comparison_of(verdict="agree", reason="")], {}).read_text(encoding="utf-8")
    for words in (
        "</span> agree",
        "The two methods agree.",
        "34233 steps",
        "7 iterations",
        "8.1",
        "changes the associated reaction from 0.35970 kN",
        "+1.0 %",
    ):
        assert words in page


def test_the_inset_of_yade_is_what_it_is_judged_by(tmp_path: Path) -> None:
    comparison = comparison_of()
    comparison["limit_analysis"]["associated"] |= {
        "inset": 0.0,
        "shared_inset": {"inset": 0.001, "reaction": 364.0, "reaction_max": 2150.0},
    }
    page = report.write_report(tmp_path, [comparison], {}).read_text(encoding="utf-8")
    assert ">0.36400 kN<" in page and ">2.1500 kN<" in page
    assert "−0.00050 kN (−0.14 %)" in page


def test_json_is_strict_and_all_three_files_are_the_same_twice(tmp_path: Path) -> None:
    names = ("report.html", "report.md", "report.json")
    report.write_report(tmp_path, [comparison_of()], {"b": 1, "a": {"d": float("inf"), "c": 2}})
    first = [(tmp_path / name).read_bytes() for name in names]
    report.write_report(tmp_path, [comparison_of()], {"a": {"c": 2, "d": float("inf")}, "b": 1})
    assert [(tmp_path / name).read_bytes() for name in names] == first
    stored = json.loads(first[2], parse_constant=lambda word: pytest.fail(f"{word} is not JSON"))
    assert stored["comparisons"][0]["yade"]["slope"] is None
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(names)


def frictional_comparison(**changes: Any) -> dict[str, Any]:
    """A comparison with everything that a scene with sliding joints has."""
    comparison = comparison_of(title="A wall", source="", reason="", notes=[], checks=[], **changes)
    comparison["limit_analysis"]["coulomb"] = {
        "status": "solved", "reaction": 366.0, "reaction_interval": [363.3, 371.3], "reaction_sharp": 362.0,
        "reaction_interval_sharp": [360.0, 368.0], "reaction_at_rest": 800.0, "drift": 1.5e-5, "dilatancy_residual": 2.5e-6,
        "strain_residual": 3.5e-5, "equilibrium_residual": 1e-10, "cone_violation": 0.0, "iterations": 19, "seconds": 0.23,
        "uncertainty": 0.75, "plateaus": [], "steps": 1207, "travel": 2.0, "viscosities": [0.01, 0.001], "sliding_residual": 0.0,
    }  # fmt: skip
    comparison["limit_analysis"]["path"] = {
        "settlement": [0.0, 1e-5, 1e-4], "reaction": [800.0, 500.0, 366.1], "strain_residual": [None, 4.5e-4, 2e-4],
        "converged": [True, False, True], "solves": [2, 30, 11], "seconds": 0.57,
    }  # fmt: skip
    counts = {"opening": 2.0, "sliding": 8.0, "sticking": 3.0, "idle": 1.0}
    measures = {"dissipated_power": 51.25, "dissipated_share": 0.1375, "participation_index": 0.0815, "moving_mass_share": 0.25}
    comparison["mechanism_measures"] = {
        "associated": {**measures, **counts, "participation_index": 0.9125},
        "coulomb": {**measures, **counts},
        "yade": dict.fromkeys((*measures, *counts)),
    }
    return comparison


def page_and_markdown(folder: Path, comparison: dict[str, Any]) -> tuple[str, str]:
    page = report.write_report(folder, [comparison], {}).read_text(encoding="utf-8")
    return page, (folder / "report.md").read_text(encoding="utf-8")


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
    assert row.count("±") == 1  # YADE's


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


def test_a_live_load_has_no_share_of_settling_weights(tmp_path: Path) -> None:
    comparison = frictional_comparison(unit="", yade=None)
    answers = comparison["limit_analysis"]
    for answer in (answers["associated"], answers["coulomb"], answers["path"]):
        for name in [name for name in answer if name.startswith("reaction")]:
            answer[name.replace("reaction", "multiplier")] = answer.pop(name)
    answers["coulomb"]["multiplier_interval"] = [363.3, None]
    page, _ = page_and_markdown(tmp_path, comparison)
    assert "0.138" not in page
    assert "363.30 to –" in page
    assert "per unit power of the load" in page


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


def test_the_figure_of_the_dissipation_is_shown_with_a_caption(tmp_path: Path) -> None:
    (tmp_path / "two pads").mkdir()
    (tmp_path / "two pads" / "dissipation.png").write_bytes(b"not looked into")
    page, markdown = page_and_markdown(tmp_path, frictional_comparison())
    assert "<figcaption>Where friction dissipates" in page
    assert "(two%20pads/dissipation.png)" in markdown


def test_an_expected_value_stands_beside_the_answer_with_its_own_friction() -> None:
    scene = load_scene(find("two_blocks"))
    rows = {row["name"]: row for row in values.expected_rows(limit_analysis_summary(analyse(scene)))}
    assert rows["R / W"]["found"] == pytest.approx(0.5, rel=2e-3)
    assert rows["R_min / W, associated"]["found"] == pytest.approx(0.5 / 1.36, rel=1e-6)


def test_the_report_says_what_was_left_out_why_and_what_that_saves(tmp_path: Path) -> None:
    report.write_report(tmp_path, [comparison_of()], {})
    for name in ("report.html", "report.md"):
        page = (tmp_path / name).read_text(encoding="utf-8")
        assert "saves 3 unknowns" in page and "took 0.25 s" in page


def leaves(data: Any) -> Iterator[Any]:
    """Every value in a scene's data that is no table and no array."""
    if isinstance(data, dict):
        for value in data.values():
            yield from leaves(value)
    elif isinstance(data, list):
        for value in data:
            yield from leaves(value)
    else:
        yield data


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


def test_the_head_has_the_words_of_the_command_else_those_of_the_scenes(tmp_path: Path) -> None:
    facts = {"project": "Town hall", "author": "A. Mason", "date": "2026-03-01"}
    scenes = [comparison_of(scene=name, title=name, structure=None) for name in ("one", "two")]
    for scene, own in zip(scenes, (facts, {**facts, "author": "B. Smith"}), strict=True):
        scene["structure"] = own
    assert report.report_head(tmp_path, scenes, {}) == {
        "title": "Town hall", "project": "Town hall", "author": "", "date": "2026-03-01",
    }  # fmt: skip
    head = report.report_head(tmp_path, scenes[:1], {"title": "Crack", "author": "C. Wright"})
    assert head == {"title": "Crack", "project": "Town hall", "author": "C. Wright", "date": "2026-03-01"}


def test_the_conclusion_says_what_moves_what_is_carried_and_what_is_assumed() -> None:
    results = Results(analyse(load_scene(find("two_blocks"))))
    summary = limit_analysis_summary(results.analysis) | {"structure": structure_facts(results), "yade": None}
    told = " ".join(plain_words(summary, Units(summary["weight"])))
    for words in (
        "settles, 1 of the 2 blocks (50 % of the weight) moves.",
        "The support then still carries",
        "50",
        "YADE was not run",
        "friction coefficient",
    ):
        assert words in told, told
    falls = {"limit_analysis": {"associated": {"status": "infeasible", "falling": ["a", "b"]}}}
    told = ["The structure cannot stand under its own weight: 2 blocks fall (a, b).", "No forces between the blocks can hold it"]
    assert [sentence.split(", so")[0] for sentence in plain_words(falls, Units(None))] == told
    assert plain_words(falls | {"verdict": "cannot stand"}, Units(None))[0].startswith(told[1])  # the verdict names the blocks


def test_words_and_numbers_of_a_report_have_one_unit() -> None:
    heavy, light = Units(5e4), Units(50.0)
    assert heavy.text(1986.65, "N") == "1.987 kN" and light.text(12.5, "N") == "12.50 N"
    assert heavy.text(3.4e-4, "m", 3) == "0.340 mm" and heavy.text(2e9, "N/m") == "2000 kN/mm"
    assert heavy.words("Range: 2552.39 to 3340.92 N.") == "Range: 2.55239 to 3.34092 kN."
    assert heavy.words("moved 4e-05 m in 12 s, 5 N/m, 3 mm") == "moved 0.04 mm in 12 s, 5 N/m, 3 mm"
    assert (
        heavy.words("said 363.3 ± 0.1 N; 1300.40 N (plateaus: 363.3, 402 N)")
        == "said 0.3633 ± 0.0001 kN; 1.30040 kN (plateaus: 0.3633, 0.402 kN)"
    )
    assert heavy.words("off by −4e-12 m") == "off by −4e-9 mm" and light.words("363.3 ± 0.1 N") == "363.3 ± 0.1 N"


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
