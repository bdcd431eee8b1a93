"""Laws of the figures and the report: drawn for every kind of scene, the same twice, honest about what is missing, harmless to open."""

import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from runs import made_up_run

from comparison.figures import canvas as drawing
from comparison.figures import reaction as plot_reaction
from comparison.figures import reaction_figure, save, structure
from comparison.figures.line_labels import ROW, Word, write_words
from comparison.judge.summary import limit_analysis_summary
from comparison.numbers import format_number
from comparison.report import report, scene_view
from comparison.yade import Results
from comparison.yade.run_record import Run
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.coulomb.equilibrium_path import EquilibriumPath
from la_core.limit.problem import Drive
from la_core.scene.scene import Scene, load_scene
from la_core.scene.shipped import find

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
    least = analysis.bounds[Drive.YIELDING]
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
    return made_up_run({**known, **result}, record, poses)


@pytest.mark.parametrize("kind", SCENES)
def test_every_kind_of_scene_is_drawn(kind: str, tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES[kind], title="Costs $5 and $\\\\badmacro")
    analysis = analyse(scene)
    solution = analysis.bounds[analysis.main]
    run = synthetic_run(analysis) if np.isfinite(solution.value) and scene.live is None else None
    mechanisms = {"limit analysis (associated)": solution.twists, "YADE": run.mechanism() if run else np.full_like(solution.twists, np.nan)}
    figures = {
        "assembly": structure.assembly_figure(scene, analysis.assembly),
        "mechanisms": structure.mechanism_figure(analysis.assembly, mechanisms, scene.title, solution.falling),
        "reaction": reaction_figure(Results(analysis, run)),
    }
    for name, figure in figures.items():
        save(figure, tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").stat().st_size > 5000


def test_the_same_figure_has_the_same_bytes(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["solid"])
    analysis = analyse(scene)
    for path in (tmp_path / "first.png", tmp_path / "second.png"):
        save(reaction_figure(Results(analysis, synthetic_run(analysis))), path)
    assert (tmp_path / "first.png").read_bytes() == (tmp_path / "second.png").read_bytes()


def test_largest_drawn_displacement_is_a_fixed_share_of_the_structure(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = analyse(scene)
    twists = analysis.bounds[Drive.YIELDING].twists
    figure = structure.mechanism_figure(analysis.assembly, {"one": twists, "YADE": 0.5 * twists})
    drawn = [float(word) for word in re.findall(r"([0-9.]+) mm", figure.get_suptitle())]
    # The block turns about (0.4, 0) by 1/0.6 of the settlement at x = 1; its upper right corner is the fastest, by hypot(0.6, 0.5)/0.6.
    assert drawn == [pytest.approx(1e3 * structure.DRAWN * drawing.structure_size(scene.blocks) * 0.6 / np.hypot(0.6, 0.5), rel=0.01)]


def test_contacts_open_slide_or_rest(tmp_path: Path) -> None:
    analysis = analyse(scene_of(tmp_path, SCENES["plane"]))
    assembly = analysis.assembly
    opens, slides = structure.contact_motion(assembly, analysis.bounds[Drive.YIELDING].twists)
    # The block turns about the fixed pad's right end and stays on the settling pad at its right end: the other two points open.
    where = assembly.points.position[:, 0]
    assert [round(float(x), 1) for x in np.sort(where[opens])] == [0.0, 0.5]
    assert not slides[opens].any()
    shear = np.zeros((len(assembly.blocks), 6))
    shear[assembly.blocks.free, 0] = 1.0
    opens, slides = structure.contact_motion(assembly, shear)
    assert slides.all()
    assert not opens.any()


def test_nearer_blocks_are_drawn_over_those_they_rest_on(tmp_path: Path) -> None:
    analysis = analyse(scene_of(tmp_path, SCENES["solid"]))
    canvas = drawing.canvases(structure.Figure(), analysis.assembly, 1)[0]
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
    canvas = drawing.canvases(structure.Figure(), analysis.assembly, 1)[0]
    assert list(canvas.seen(np.array([[1.0, 0.001, 1.0], [1.0, 0.5, 1.0], [2.499, 0.5, 1.0], [1.0, 0.999, 1.0]]))) == [
        True,
        False,
        True,
        False,
    ]


def test_a_greatest_reaction_far_above_is_named_and_not_drawn(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = analyse(scene)
    whole, close = reaction_figure(Results(analysis, synthetic_run(analysis))).axes
    greatest, least = (analysis.bounds[drive].value for drive in (Drive.PUSHING, Drive.YIELDING))
    assert close.get_ylim()[1] < greatest
    assert "lies above" in close.get_title(loc="right")
    assert close.get_ylim()[0] < least < close.get_ylim()[1]
    assert whole.get_ylim()[1] > least + 0.4 * scene.weight


def test_a_run_without_plateau_has_no_line(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = analyse(scene)
    run = synthetic_run(analysis, status="no plateau", reaction=np.nan, uncertainty=np.nan, slope=np.nan, plateau_start=np.nan)
    (axes,) = reaction_figure(Results(analysis, run)).axes
    assert "no plateau" in axes.get_title(loc="left")
    assert not any("fitted" in str(line.get_label()) for line in axes.get_lines())


def frictional(analysis: LimitAnalysis, share: tuple[float, float], value: float = 1.1) -> LimitAnalysis:
    """The analysis with a Coulomb value of so many times the least reaction, and its interval likewise; and a short path."""
    assert analysis.coulomb is not None
    least = analysis.bounds[analysis.main].value
    coulomb = replace(analysis.coulomb, value=value * least, interval=(share[0] * least, share[1] * least))
    settlement = np.linspace(0.0, 8e-4, 9)
    path = EquilibriumPath(
        settlement, least * (value + 2.0 * np.exp(-settlement / 3e-5)), np.zeros(9), np.ones(9, bool), np.ones(9, int), 0.1
    )
    return replace(analysis, at_inset=replace(analysis.at_inset, coulomb=coulomb), path=path)


def labels_of(axes: Any) -> dict[str, Any]:
    return {label: handle for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)}


@pytest.mark.parametrize(
    ("share", "drawn"),
    [
        ((1.0, 1.3), True), ((1.0, np.inf), True), ((-np.inf, 1.3), True), ((1.1, 1.1 + 1e-6), False), ((np.nan, 1.3), False),
        ((1.0, np.nan), False),
    ],
)  # fmt: skip
def test_an_interval_is_a_band_unless_it_is_a_point_or_unknown(share: tuple[float, float], drawn: bool, tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = frictional(analyse(scene), share)
    figure = reaction_figure(Results(analysis, synthetic_run(analysis)))
    save(figure, tmp_path / "reaction.png")
    least = analysis.bounds[Drive.YIELDING].value
    for axes in figure.axes:
        band = labels_of(axes).get(plot_reaction.HISTORY)
        assert (band is not None) == drawn
        assert plot_reaction.COULOMB in labels_of(axes)
        if band is not None:
            seen = np.clip([band.get_y(), band.get_y() + band.get_height()], *axes.get_ylim())
            assert seen == pytest.approx(np.clip(np.array(share) * least, *axes.get_ylim()))


def test_everything_drawn_is_named_once_beside_its_line_or_in_the_legend(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = frictional(analyse(scene), (1.0, 1.3))
    figure = reaction_figure(Results(analysis, synthetic_run(analysis)))
    keys = [text.get_text() for text in figure.legends[0].get_texts()]
    words = [text.get_text() for axes in figure.axes for text in axes.texts]
    beside = {
        plot_reaction.LEAST: "$R_{\\min}$, associated: 330.27 N",
        plot_reaction.COULOMB: "Coulomb prediction: 363.30 N",
        plot_reaction.HISTORY: "value depends on friction's history",
        plot_reaction.FITTED: "YADE's plateau: 350 ± 2 N",
        plot_reaction.GREATEST: "$R_{\\max}$, associated: 1958.1 N",
        r"$R_{\min}$ of sharp arrises": "sharp arrises: 327.00 N",  # W / 6
        plot_reaction.ADMISSIBLE: "admissible",
    }
    for label in {label for axes in figure.axes for label in labels_of(axes)}:
        shown = any(beside[label] in word for word in words) if label in beside else False
        assert shown != (label in keys), label
    assert {plot_reaction.LEAST, plot_reaction.COULOMB, plot_reaction.HISTORY, plot_reaction.FITTED}.isdisjoint(keys)


def test_a_prediction_that_is_the_bound_shares_its_words(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = frictional(analyse(scene), (1.0, 1.0), value=1.0)
    figure = reaction_figure(Results(analysis))
    words = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert any("associated, and Coulomb prediction" in word for word in words)
    assert not any(word.startswith("Coulomb prediction") for word in words)


@pytest.mark.parametrize("kind", ["plane", "live"])
@pytest.mark.parametrize("known", [(), ("coulomb",), ("path",), ("coulomb", "path")])
def test_what_limit_analysis_has_is_drawn_without_a_run(kind: str, known: tuple[str, ...], tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES[kind])
    analysis = frictional(analyse(scene), (1.0, 1.3))
    if "coulomb" not in known:
        analysis = replace(analysis, at_inset=replace(analysis.at_inset, coulomb=None))
    if "path" not in known:
        analysis = replace(analysis, path=None)
    figure = reaction_figure(Results(analysis))
    save(figure, tmp_path / "reaction.png")
    assert len(figure.axes) == (2 if "path" in known else 1)
    for axes in figure.axes:
        assert (plot_reaction.COULOMB in labels_of(axes)) == ("coulomb" in known)
        assert any("path" in label for label in labels_of(axes)) == ("path" in known)
    assert figure.axes[0].get_xlabel().startswith("mean displacement" if kind == "live" else "settlement")
    if "path" in known:
        assert figure.axes[0].get_xlabel().endswith("(mm)")
        assert figure.axes[0].get_ylim()[0] < 0.0 < analysis.path.value.max() < 1e3 * figure.axes[0].get_ylim()[1]  # type: ignore[union-attr]


def test_an_interval_that_dwarfs_the_plateau_does_not_set_its_scale(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = frictional(analyse(scene), (1.0, 5.0))
    close = reaction_figure(Results(analysis, synthetic_run(analysis))).axes[1]
    assert close.get_ylim()[1] < 1.5 * analysis.bounds[Drive.YIELDING].value


def test_words_keep_off_lines_and_each_other() -> None:
    axes = structure.Figure().subplots()
    axes.set_ylim(0.0, 1.0)

    def word(low: float, high: float, name: str) -> Word:
        return Word(low, high, name, "black", (name,))

    # Words for "two" fit below it only, for "one" nowhere; the band's stand in its widest gap.
    lines = [word(0.5, 0.5, "three"), word(0.5 - 0.2 * ROW, 0.5 - 0.2 * ROW, "one"), word(0.5 - 0.4 * ROW, 0.5 - 0.4 * ROW, "two")]
    narrow = word(0.9, 0.9 + 0.9 * ROW, "narrow")
    assert write_words(axes, [*lines, word(0.0, 0.5, "band"), narrow], (0.0, 1.0)) == {"three", "two", "band"}
    at = {text.get_text(): text.xy[1] for text in axes.texts}
    assert at["three"] == 0.5
    assert at["band"] == pytest.approx((0.5 - 1.4 * ROW) / 2.0)
    # The words of the upper line stand below it, for above is no room, and there those of the lower line may not be.
    axes = structure.Figure().subplots()
    upper, lower = 1.0 - 0.5 * ROW, 1.0 - 2.0 * ROW
    assert write_words(axes, [word(upper, upper, "upper"), word(lower, lower, "lower")], (0.0, 1.0)) == {"upper", "lower"}
    assert [text.get_va() for text in axes.texts] == ["top", "top"]


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (None, "–"), (float("nan"), "–"), (float("inf"), "–"), (True, "–"), (0.0, "0"), (24.0, "24"), (22829, "22829"), (363.2987, "363.3"),
        (99999.6, "100000"), (-0.02981, "−0.02981"), (1.2344e-9, "1.234e-9"), (12345678.9, "1.235e7"),
    ],
)  # fmt: skip
def test_numbers(value: Any, shown: str) -> None:
    assert format_number(value) == shown


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
        "changes the associated reaction from 359.70 N",
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


def frictional_comparison(**changes: Any) -> dict[str, Any]:
    """A comparison with everything that a scene with sliding joints has."""
    comparison = comparison_of(title="A wall", source="", reason="", notes=[], checks=[], **changes)
    comparison["limit_analysis"]["coulomb"] = {
        "status": "solved", "reaction": 366.0, "reaction_interval": [363.3, 371.3], "reaction_sharp": 362.0,
        "reaction_interval_sharp": [360.0, 368.0], "reaction_at_rest": 800.0, "drift": 1.5e-5, "dilatancy_residual": 2.5e-6,
        "strain_residual": 3.5e-5, "equilibrium_residual": 1e-10, "cone_violation": 0.0, "iterations": 19, "seconds": 0.23,
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
    row = page[page.index('href="#scene-1"') : page.index("</tbody>")]
    for words in ("366 N", "363.30 to 371.30 N", "−2.50 N"):
        assert words in row
    assert "less R_min" not in row
    (top,) = (line for line in markdown.splitlines() if line.startswith("| two pads | ? inconclusive"))
    assert "| 366 | 363.30 to 371.30 N |" in top
    assert top.endswith("| −2.50 |")


def test_without_a_coulomb_answer_yade_is_held_against_the_bound(tmp_path: Path) -> None:
    page, markdown = page_and_markdown(tmp_path, comparison_of())
    row = page[page.index('href="#scene-1"') : page.index("</tbody>")]
    assert "0.200 N" in row
    assert "less R_min" in row
    assert "| 0.200 (less R\\_min) |" in markdown


def test_every_method_says_what_it_is_worth_and_what_it_took(tmp_path: Path) -> None:
    page, markdown = page_and_markdown(tmp_path, frictional_comparison())
    for text in (page, markdown):
        for words in (
            "7 iterations", "largest residual 1e-10", "19 associated programmes", "dilatancy residual 2.5e-6", "half-width 4 N",
            "2 increments, 43 associated programmes", "largest strain residual 4.5e-4", "1 increments not converged", "34233 steps",
        ):  # fmt: skip
            assert words in text
    for seconds in ("0.010", "0.23", "0.57", "8.1"):
        assert f'<td class="number">{seconds}</td>' in page
    assert "Coulomb: work of the remaining dilation, over the elastic energy of the joints" in page


def test_mechanisms_are_measured_by_method_and_unknown_ones_left_out(tmp_path: Path) -> None:
    page, markdown = page_and_markdown(tmp_path, frictional_comparison())
    table = page[page.index("Measures of the mechanisms") :]
    table = table[: table.index("</table>")]
    assert [name for name in ("associated", "Coulomb", "YADE") if f">limit analysis, {name}<" in table or f">{name}<" in table] == [
        "associated",
        "Coulomb",
    ]
    for words in ("51.25 N", "0.138", "0.912", "0.0815", "0.250"):
        assert words in table
        assert words.removesuffix(" N") in markdown
    assert "(Σp)²/(J Σp²)" in page


def test_the_inset_of_yade_is_what_the_prediction_is_shown_at(tmp_path: Path) -> None:
    comparison = frictional_comparison()
    comparison["limit_analysis"]["coulomb"]["shared_inset"] = {"inset": 0.001, "reaction": 364.5, "reaction_interval": [363.5, 363.51]}
    page, _ = page_and_markdown(tmp_path, comparison)
    row = page[page.index('href="#scene-1"') : page.index("</tbody>")]
    assert "364.50 N" in row
    assert "a point" in row
    assert "−1 N" in row


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
    rows = {row["name"]: row for row in scene_view._expected(limit_analysis_summary(analyse(scene)))}
    assert rows["R / W"]["found"] == pytest.approx(0.5, rel=2e-3)
    assert rows["R_min / W, associated"]["found"] == pytest.approx(0.5 / 1.36, rel=1e-6)


def test_the_report_says_what_was_left_out_why_and_what_that_saves(tmp_path: Path) -> None:
    report.write_report(tmp_path, [comparison_of()], {})
    for name in ("report.html", "report.md"):
        page = (tmp_path / name).read_text(encoding="utf-8")
        assert "saves 3 unknowns" in page and "took 0.25 s" in page
