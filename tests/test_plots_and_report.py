"""Laws of the figures and the report: drawn for every kind of scene, the same twice, honest about what is missing, harmless to open."""

import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from comparison import drawing, plots, report
from comparison.record import Run
from la_core.case import LimitAnalysis, analyse
from la_core.limit import Drive
from la_core.scene import Scene, load_scene

HEAD = """
title = "{title}"
[stone]
density = 2000.0
[joint]
friction = 0.6
"""
PADS = """
[[block]]
name = "fixed $\\\\frac$ <pad>"
role = "fixed"
box = { from = [0.0, 0.0, -0.1], to = [0.4, 0.2, 0.0] }
[[block]]
name = "settling"
role = "support"
box = { from = [0.5, 0.0, -0.1], to = [1.0, 0.2, 0.0] }
"""
BLOCK = """
[[block]]
name = "block"
box = { from = [0.0, 0.0, 0.0], to = [1.0, 0.2, 0.5] }
"""
NARROW = BLOCK.replace("0.2, 0.5]", "0.15, 0.5]")
OVERHANG = """
[[block]]
name = "overhang"
box = { from = [0.9, 0.0, 0.0], to = [1.9, 0.2, 0.5] }
[[block]]
name = "stands"
box = { from = [0.0, 0.0, 0.0], to = [0.4, 0.2, 0.5] }
"""
DOWN = "[settlement]\ndirection = [0.0, 0.0, -1.0]\n"
TURN = "[settlement]\naxis = [0.0, 1.0, 0.0]\npoint = [0.5, 0.0, 0.0]\n"
LIVE = "[live]\ndirection = [1.0, 0.0, 0.0]\n"
SCENES = {
    "plane": PADS + BLOCK + DOWN,
    "solid": PADS + NARROW + DOWN,
    "turning": PADS + BLOCK + TURN,
    "falling": PADS + OVERHANG + DOWN,
    "live": PADS.replace('"support"', '"fixed"') + BLOCK + LIVE,
}


def scene_of(folder: Path, body: str, title: str = "A scene") -> Scene:
    path = folder / "scene.toml"
    path.write_text(HEAD.format(title=title) + body, encoding="utf-8")
    return load_scene(path)


def synthetic_run(analysis: LimitAnalysis, **result: Any) -> Run:
    """A record that falls from rest to a plateau 1 % of the weight above the least reaction, with the associated mechanism."""
    least = analysis.rounded[Drive.YIELDING]
    weight = analysis.assembly.weight
    settlement = np.linspace(0.0, 4e-4, 200)
    plateau = least.value + 0.01 * weight
    reaction = plateau + 0.4 * weight * np.exp(-settlement / 3e-5)
    record = {"stage": np.ones(200, dtype=int), "settlement": settlement, "reaction": reaction}
    poses = {
        "settlement": settlement[::20],
        "displacement": settlement[::20, None, None] * least.twists[None, :, :3],
        "rotation": settlement[::20, None, None] * least.twists[None, :, 3:],
    }
    known = {"status": "plateau", "reaction": plateau, "uncertainty": 2.0, "plateau_start": 2e-4, "slope": 0.0, "message": "settled"}
    return Run({**known, **result}, record, poses, np.zeros((0, 2), dtype=int), {})


@pytest.mark.parametrize("kind", SCENES)
def test_every_kind_of_scene_is_drawn(kind: str, tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES[kind], title="Costs $5 and $\\\\badmacro")
    analysis = analyse(scene)
    solution = analysis.rounded[analysis.main]
    run = synthetic_run(analysis) if np.isfinite(solution.value) and scene.live is None else None
    mechanisms = {"limit analysis (associated)": solution.twists, "YADE": run.mechanism() if run else np.full_like(solution.twists, np.nan)}
    figures = {
        "assembly": plots.assembly_figure(scene, analysis.assembly),
        "mechanisms": plots.mechanism_figure(analysis.assembly, mechanisms, scene.title, solution.falling),
        "reaction": plots.reaction_figure(scene, analysis, run),
    }
    for name, figure in figures.items():
        plots.save(figure, tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").stat().st_size > 5000


def test_the_same_figure_has_the_same_bytes(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["solid"])
    analysis = analyse(scene)
    for path in (tmp_path / "first.png", tmp_path / "second.png"):
        plots.save(plots.reaction_figure(scene, analysis, synthetic_run(analysis)), path)
    assert (tmp_path / "first.png").read_bytes() == (tmp_path / "second.png").read_bytes()


def test_largest_drawn_displacement_is_a_fixed_share_of_the_structure(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = analyse(scene)
    twists = analysis.rounded[Drive.YIELDING].twists
    figure = plots.mechanism_figure(analysis.assembly, {"one": twists, "YADE": 0.5 * twists})
    drawn = [float(word) for word in re.findall(r"([0-9.]+) mm", figure.get_suptitle())]
    # The block turns about (0.4, 0) by 1/0.6 of the settlement at x = 1; its upper right corner is the fastest, by hypot(0.6, 0.5)/0.6.
    assert drawn == [pytest.approx(1e3 * plots.DRAWN * drawing.size(scene.blocks) * 0.6 / np.hypot(0.6, 0.5), rel=0.01)]


def test_contacts_open_slide_or_rest(tmp_path: Path) -> None:
    analysis = analyse(scene_of(tmp_path, SCENES["plane"]))
    assembly = analysis.assembly
    opens, slides = plots.contact_motion(assembly, analysis.rounded[Drive.YIELDING].twists)
    # The block turns about the fixed pad's right end and stays on the settling pad at its right end: the other two points open.
    where = assembly.points.position[:, 0]
    assert [round(float(x), 1) for x in np.sort(where[opens])] == [0.0, 0.5]
    assert not slides[opens].any()
    shear = np.zeros((len(assembly.blocks), 6))
    shear[assembly.blocks.free, 0] = 1.0
    opens, slides = plots.contact_motion(assembly, shear)
    assert slides.all()
    assert not opens.any()


def test_nearer_blocks_are_drawn_over_those_they_rest_on(tmp_path: Path) -> None:
    analysis = analyse(scene_of(tmp_path, SCENES["solid"]))
    canvas = drawing.canvases(plots.Figure(), analysis.assembly, 1)[0]
    # Seen from above, the block hides its pads, although its centroid is not nearer than the right pad's.
    assert list(canvas.order).index(2) == 2


def test_points_inside_a_thick_wall_are_hidden(tmp_path: Path) -> None:
    wall = """
[[wall]]
bond = "stack"
origin = [0.0, 0.0, 0.0]
block = [0.5, 0.5, 0.5]
per_course = 5
courses = 5
[[wall]]
name = "behind"
bond = "stack"
origin = [0.0, 0.5, 0.0]
block = [0.5, 0.5, 0.5]
per_course = 5
courses = 5
[[block]]
name = "ground"
role = "fixed"
box = { from = [0.0, 0.0, -0.5], to = [1.5, 1.0, 0.0] }
[[block]]
name = "yields"
role = "support"
box = { from = [1.5, 0.0, -0.5], to = [2.5, 1.0, 0.0] }
"""
    analysis = analyse(scene_of(tmp_path, wall + DOWN + "[effects]\nplane = false\n"))
    canvas = drawing.canvases(plots.Figure(), analysis.assembly, 1)[0]
    assert list(canvas.seen(np.array([[1.0, 0.001, 1.0], [1.0, 0.5, 1.0], [2.499, 0.5, 1.0], [1.0, 0.999, 1.0]]))) == [
        True,
        False,
        True,
        False,
    ]


def test_a_greatest_reaction_far_above_is_named_and_not_drawn(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = analyse(scene)
    whole, close = plots.reaction_figure(scene, analysis, synthetic_run(analysis)).axes
    greatest, least = (analysis.rounded[drive].value for drive in (Drive.PUSHING, Drive.YIELDING))
    assert close.get_ylim()[1] < greatest
    assert "lies above" in close.get_title(loc="right")
    assert close.get_ylim()[0] < least < close.get_ylim()[1]
    assert whole.get_ylim()[1] > least + 0.4 * scene.weight


def test_a_run_without_plateau_has_no_line(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = analyse(scene)
    run = synthetic_run(analysis, status="no plateau", reaction=np.nan, uncertainty=np.nan, slope=np.nan, plateau_start=np.nan)
    (axes,) = plots.reaction_figure(scene, analysis, run).axes
    assert "no plateau" in axes.get_title(loc="left")
    assert not any("fitted" in str(line.get_label()) for line in axes.get_lines())


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (None, "–"), (float("nan"), "–"), (float("inf"), "–"), (True, "–"), (0.0, "0"), (24.0, "24"), (22829, "22829"), (363.2987, "363.3"),
        (99999.6, "100000"), (-0.02981, "−0.02981"), (1.2344e-9, "1.234e-9"), (12345678.9, "1.235e7"),
    ],
)  # fmt: skip
def test_numbers(value: Any, shown: str) -> None:
    assert report.number(value) == shown


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
        "effects": {"plane": True, "friction": "coulomb", "reasons": {"plane": HOSTILE}},
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
    row = page[page.index('href="#scene-1"') : page.index("</tbody>")]
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
        "takes the reaction from 359.70 N",
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
    assert "364 to 2150 N" in page
    assert "−0.500 N" in page


def test_json_is_strict_and_all_three_files_are_the_same_twice(tmp_path: Path) -> None:
    names = ("report.html", "report.md", "report.json")
    report.write_report(tmp_path, [comparison_of()], {"b": 1, "a": {"d": float("inf"), "c": 2}})
    first = [(tmp_path / name).read_bytes() for name in names]
    report.write_report(tmp_path, [comparison_of()], {"a": {"c": 2, "d": float("inf")}, "b": 1})
    assert [(tmp_path / name).read_bytes() for name in names] == first
    stored = json.loads(first[2], parse_constant=lambda word: pytest.fail(f"{word} is not JSON"))
    assert stored["comparisons"][0]["yade"]["slope"] is None
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(names)
