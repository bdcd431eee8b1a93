"""The pages of a report load no file, escape all text, mark missing values, and are the same each time."""

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from made_up_comparisons import HOSTILE, comparison_of, frictional_comparison, page_and_markdown, values_part

from comparison.report import report
from comparison.report.templating import paper_width

PUSHED = {"associated": {"status": "solved", "multiplier": 0.5}, "coulomb": None}
FALLS = {"associated": {"status": "infeasible", "reaction": None, "falling": ["block"]}, "coulomb": None}


class Page(HTMLParser):
    """Tags of a page, every attribute that could load something, and ids."""

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


@pytest.mark.parametrize(("unit", "arm"), [("N", ""), ("N m", " m")])
def test_a_moment_over_the_weight_is_a_length_in_every_table(tmp_path: Path, unit: str, arm: str) -> None:
    report.write_report(tmp_path, [comparison_of(unit=unit)], {})
    (row,) = [line for line in (tmp_path / "report.md").read_text(encoding="utf-8").splitlines() if line.startswith("| two pads | ?")]
    cells = [cell.strip() for cell in row.split("|")]
    shares = [cells[place] for place in (4, 9)]
    assert all(re.fullmatch(r"[\d.]+( to [\d.]+)?" + arm, share) for share in shares), shares


def test_a_command_in_a_sentence_is_code(tmp_path: Path) -> None:
    page = report.write_report(tmp_path, [comparison_of(next_step="See `crosscheck show <b>` & look.")], {}).read_text(encoding="utf-8")
    assert "See <code>crosscheck show &lt;b&gt;</code> &amp; look." in page


@pytest.mark.parametrize(("yade", "headings"), [(None, ["Mechanism", "Structure"]), ({}, ["Mechanism", "Reaction", "Forces", "Structure"])])
def test_no_figure_is_empty_where_blocks_fall(yade: Any, headings: list[str], tmp_path: Path) -> None:
    falling = comparison_of(yade={"status": "collapsed"} if yade is not None else None, limit_analysis=FALLS)
    (tmp_path / falling["scene"]).mkdir()
    for name in ("mechanisms", "reaction", "forces", "assembly"):
        (tmp_path / falling["scene"] / f"{name}.png").write_bytes(b"not looked into")
    page = report.write_report(tmp_path, [falling], {}).read_text(encoding="utf-8")
    assert [
        heading for heading in re.findall(r"<h3[^>]*>([^<]*)</h3>", page) if heading in headings or heading in ("Reaction", "Forces")
    ] == headings


def test_what_is_missing_is_a_dash_and_never_zero(tmp_path: Path) -> None:
    bare = {"scene": "bare", "verdict": None}
    page = report.write_report(tmp_path, [bare], {}).read_text(encoding="utf-8")
    row = values_part(page)
    assert "–" in row
    assert not re.search(r">\s*0", row)
    assert "Nothing was compared" in page


def test_two_figures_of_the_usual_height_share_a_sheet_of_paper_and_a_tall_one_is_larger() -> None:
    usual, tall, animated = (picture(1105, 866), picture(1105, 1115), b"GIF89a")
    assert [round(paper_width(image)) for image in (usual, tall, animated)] == [151, 173, 0]  # mm; the figures are drawn 216 mm wide


def picture(width: int, height: int) -> bytes:
    """Return the beginning of a PNG file, up to its width and height, pixels."""
    return b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR" + width.to_bytes(4, "big") + height.to_bytes(4, "big")


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


def test_json_is_strict_and_all_three_files_are_the_same_twice(tmp_path: Path) -> None:
    names = ("report.html", "report.md", "report.json")
    report.write_report(tmp_path, [comparison_of()], {"b": 1, "a": {"d": float("inf"), "c": 2}})
    first = [(tmp_path / name).read_bytes() for name in names]
    report.write_report(tmp_path, [comparison_of()], {"a": {"c": 2, "d": float("inf")}, "b": 1})
    assert [(tmp_path / name).read_bytes() for name in names] == first
    stored = json.loads(first[2], parse_constant=lambda word: pytest.fail(f"{word} is not JSON"))
    assert stored["comparisons"][0]["yade"]["slope"] is None
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(names)


def test_the_figure_of_the_dissipation_is_shown_with_a_caption(tmp_path: Path) -> None:
    (tmp_path / "two pads").mkdir()
    (tmp_path / "two pads" / "dissipation.png").write_bytes(b"not looked into")
    page, markdown = page_and_markdown(tmp_path, frictional_comparison())
    assert "<figcaption>Where friction dissipates" in page
    assert "(two%20pads/dissipation.png)" in markdown


@pytest.mark.parametrize(
    ("changes", "caption"),
    [
        ({}, "Blocks that move when the support moves, by both methods"),
        ({"yade": None}, "Blocks that move when the support moves, by limit analysis"),
        ({"yade": None, "limit_analysis": FALLS}, "Blocks that fall, by limit analysis"),
        (
            {"yade": None, "unit": "", "limit_analysis": PUSHED},
            "Blocks that move when the structure fails under the load, by limit analysis",
        ),
    ],
)
def test_the_mechanisms_are_those_of_the_methods_that_ran(changes: dict[str, Any], caption: str, tmp_path: Path) -> None:
    (tmp_path / "two pads").mkdir()
    (tmp_path / "two pads" / "mechanisms.png").write_bytes(b"not looked into")
    page, _ = page_and_markdown(tmp_path, comparison_of(**changes))
    assert f"<figcaption>{caption}" in page


def test_the_report_says_what_was_left_out_why_and_what_that_saves(tmp_path: Path) -> None:
    report.write_report(tmp_path, [comparison_of()], {})
    for name in ("report.html", "report.md"):
        page = (tmp_path / name).read_text(encoding="utf-8")
        assert "saves 3 unknowns" in page and "took 0.25 s" in page


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
