"""Laws of a campaign's report and of the comparison of two campaigns: every case is shown, nothing undefined is a number, nothing hides."""

import base64
import json
import math
import random
import re
from dataclasses import replace
from html.parser import HTMLParser
from itertools import product
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest

from comparison.campaign.columns import COSTS, METHODS, result_columns
from comparison.campaign.figures import lines as plot_lines
from comparison.campaign.figures import maps
from comparison.campaign.mechanism_changes import letters, mechanism_changes_along
from comparison.campaign.parameter_labels import label, quantity
from comparison.campaign.report import rows as report_rows
from comparison.campaign.report.compare import Change, Comparison, compare_tables
from comparison.campaign.report.compare_report import sentence, stored_comparison, terminal_tables
from comparison.campaign.report.report import stored_campaign_report, write_campaign_report
from comparison.campaign.report.verdict_matrix import matrix_panels
from comparison.campaign.row_groups import lines, sweeps_of
from comparison.campaign.row_values import bounds, deviation, worst_first
from comparison.campaign.table import CampaignTable, write_campaign
from comparison.cli.commands import main
from comparison.cli.exit_codes import TOOL
from comparison.figures.canvas import LIMIT_ANALYSIS, YADE
from la_core.exchange.dem_settings import SETTINGS

pytestmark = pytest.mark.slow

ROUND_OFF = 1e-9  # of a slope: difference quotients of numbers of order one
MU, INSET, LAW = "joint.friction", "joint.inset", "effects.friction"
FRICTIONS = [0.2, 0.3, 0.4, 0.5, 0.6]
SHAPES: dict[str, list[dict[str, list[Any]]]] = {
    "one case": [{}],
    "scenes": [{}, {}, {}],
    "one axis": [{MU: FRICTIONS}, {MU: FRICTIONS[:3]}],
    "choices": [{LAW: ["coulomb", "associated"]}],
    "two axes": [{MU: FRICTIONS, INSET: [0.001, 0.002]}],
    "three axes": [{MU: FRICTIONS, INSET: [0.001, 0.002], "wall[0].courses": [4, 6, 8]}],
    "different sweeps": [{MU: FRICTIONS}, {INSET: [0.001, 0.002]}, {MU: FRICTIONS, LAW: ["coulomb", "associated"]}, {}],
    "classic": [{"classic.relaxation": [0.2, 0.6, 1.0], "classic.slope": [0.001, 0.01]}],
    "directions": [{"settlement.direction": [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]}],
}
every_shape = pytest.mark.parametrize("shape", SHAPES)


def row_of(name: str, scene: str, place: dict[str, Any], axes: list[str]) -> dict[str, Any]:
    """A case whose reaction falls with friction along one slope below mu = 0.45, along another above, where the mechanism differs."""
    friction = place.get(MU, 0.6)
    low = friction < 0.45
    reaction = 1000.0 * (0.5 - (0.3 if low else 0.1) * friction)
    row = dict.fromkeys(result_columns(axes)) | {"case": name, "scene": scene} | place
    row |= {"state": "done", "verdict": "agree", "reason": "", "unit": "N", "weight": 1000.0, "free_blocks": 40}
    row |= {"associated_status": "solved", "least": 0.9 * reaction, "greatest": 3.0 * reaction, "coulomb_status": "solved"}
    row |= {"coulomb": reaction, "coulomb_low": 0.95 * reaction, "coulomb_high": 1.1 * reaction, "coulomb_sharp": reaction}
    row |= {"yade_status": "plateau", "yade": 1.002 * reaction, "yade_uncertainty": 0.001 * reaction}
    if any(key.startswith("classic.") for key in place):
        converges = place["classic.relaxation"] < 1.0
        row |= {"classic": reaction if converges else None, "classic_status": "solved" if converges else "inaccurate"}
        row |= {"classic_iterations": 12 if converges else 100}
    for method in METHODS:
        row |= {f"{method}_mechanism": "30-low" if low else "12-high", f"{method}_participation": 0.3, f"{method}_moving_mass": 0.4}
    return row | {"folder": f"cases/{name}"}


def campaign(folder: Path, shape: str = "one axis", title: str = "A campaign", scene: str = "scene") -> CampaignTable:
    """A table of synthetic cases whose folders hold a page each."""
    ranges = SHAPES[shape]
    axes: dict[str, list[Any]] = {}
    for sweep in ranges:
        for key, values in sweep.items():
            axes[key] = [*axes.get(key, []), *(value for value in values if value not in axes.get(key, []))]
    rows = []
    for number, sweep in enumerate(ranges):
        for values in product(*sweep.values()):
            place = dict(zip(sweep, values, strict=True))
            name = "_".join([f"{scene}{number}", *(f"{key}={value}" for key, value in place.items())])
            rows.append(row_of(name, f"{scene}{number}", place, list(axes)))
            (folder / "cases" / name).mkdir(parents=True, exist_ok=True)
            (folder / "cases" / name / "report.html").write_text("a case's page")
    costs = [
        dict.fromkeys(COSTS) | {"case": row["case"], "seconds": 9.0, "limit_analysis_seconds": 0.25, "yade_seconds": 4.0} for row in rows
    ]
    return CampaignTable(title, axes, rows, costs, {"program": {"crosscheck": "0.1.0"}}, folder)


def changed(table: CampaignTable, place: int, /, **values: Any) -> CampaignTable:
    """The table with other values in one row."""
    rows = [row | values if k == place else row for k, row in enumerate(table.rows)]
    return replace(table, rows=rows)


class Page(HTMLParser):
    """Tags, addresses and text of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.addresses: list[str] = []
        self.text = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.addresses += [value or "" for name, value in attrs if name in ("href", "src")]

    def handle_data(self, data: str) -> None:
        if self.tags[-1:] != ["style"]:
            self.text += data


def left_out(table: CampaignTable, *places: int, **values: Any) -> CampaignTable:
    """The table in which some cases, or all, came to nothing but the given values."""
    empty = dict.fromkeys(set(result_columns([])) - {"case", "sweep", "scene"}) | {"state": "failed", "reason": "it broke"} | values
    return replace(table, rows=[row | empty if not places or k in places else row for k, row in enumerate(table.rows)])


@every_shape
def test_the_matrix_has_a_cell_for_every_case(shape: str, tmp_path: Path) -> None:
    table = campaign(tmp_path, shape)
    found = matrix_panels(table)
    cells = [cell for panel in found for _, places in panel.rows for cell_list in places for cell in cell_list]
    assert sorted(cell.case for cell in cells) == sorted(row["case"] for row in table.rows)
    assert all(cell.href and (tmp_path / unquote(cell.href)).is_file() for cell in cells)
    assert all(len(places) == len(panel.columns) for panel in found for _, places in panel.rows)


@pytest.mark.parametrize("shape", ["one case", "two axes", "different sweeps", "classic", "directions"])
def test_every_address_of_the_page_leads_somewhere_and_nothing_is_fetched(shape: str, tmp_path: Path) -> None:
    table = campaign(tmp_path, shape)
    text = write_campaign_report(table).read_text(encoding="utf-8")
    page = Page(text)
    for address in page.addresses:
        assert address.startswith("data:image/png;base64,") or address in page_anchors(text) or (tmp_path / unquote(address)).is_file()
    assert "default-src 'none'" in text and "script" not in page.tags
    own = {f"cases/{row['case']}/report.html" for row in table.rows}
    for row in table.rows:
        assert row["case"] in page.text
    costs = text[text.index('id="costs"') :]
    assert own == {unquote(address) for address in Page(costs).addresses if address.startswith("cases/")}
    markdown = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert all((tmp_path / part.split(")")[0]).is_file() for part in markdown.split("](figures/")[1:] for part in [f"figures/{part}"])


def page_anchors(text: str) -> set[str]:
    return {"#" + part.split('"')[0] for part in text.split(' id="')[1:]}


def test_a_folder_outside_the_campaign_is_not_linked(tmp_path: Path) -> None:
    (tmp_path / "report.html").write_text("elsewhere")
    for folder in ("../", "..", "/", str(tmp_path), "javascript:alert(1)", "no/such"):
        table = changed(campaign(tmp_path / "inside", "one case"), 0, folder=folder)
        assert matrix_panels(table)[0].rows[0][1][0][0].href == ""


def test_no_text_of_a_campaign_is_read_as_markup(tmp_path: Path) -> None:
    hostile = '<script>alert("x")</script> [x](y) | $\\frac$ `*'
    table = campaign(tmp_path, "two axes", title=hostile)
    table = changed(table, 0, verdict="disagree", reason=hostile, scene=hostile, yade_mechanism=hostile, case=hostile)
    table = changed(table, 1, state="failed", reason=hostile, associated_status=hostile)
    text = write_campaign_report(replace(table, provenance={hostile: hostile})).read_text(encoding="utf-8")
    assert "script" not in Page(text).tags and hostile in Page(text).text
    markdown = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert "<script" not in markdown.replace("\\<", "") and "[x](y)" not in markdown
    assert json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))["title"] == hostile


def test_what_is_undefined_is_a_dash_and_never_a_number(tmp_path: Path) -> None:
    table = campaign(tmp_path)
    kept = ("case", "scene", "state", "folder", *table.axes)
    numbers = {name for name, value in table.rows[0].items() if isinstance(value, float)}
    empty = {name: math.nan if name in numbers else None for name in table.rows[0] if name not in kept}
    table = changed(changed(table, 1, **empty), 4, **(empty | {"state": "failed", "reason": "it broke"}))
    text = Page(write_campaign_report(table).read_text(encoding="utf-8")).text
    markdown = (tmp_path / "report.md").read_text(encoding="utf-8")
    for page in (text, markdown):
        assert not re.search(r"\b(nan|none|null|inf)\b", page, re.IGNORECASE)
    stored = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    assert all(stored["rows"][1][name] is None for name in empty)
    (line,) = [line for line in markdown.splitlines() if line.startswith("| [scene0\\_joint.friction=0.3]") and "not run" in line]
    assert line.count("–") >= 5


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["two axes", "classic"])
def test_the_same_campaign_gives_the_same_files(shape: str, tmp_path: Path) -> None:
    table = campaign(tmp_path, shape)
    first = {path.name: path.read_bytes() for path in sorted(write_campaign_report(table).parent.rglob("*.*")) if path.is_file()}
    (tmp_path / "figures" / "reaction-99.png").write_bytes(b"of an earlier campaign")
    again = {path.name: path.read_bytes() for path in sorted(write_campaign_report(table).parent.rglob("*.*")) if path.is_file()}
    assert first == again


def test_a_change_of_mechanism_leads_to_the_reports_of_both_its_cases(tmp_path: Path) -> None:
    table = campaign(tmp_path, "two axes")
    found = list(mechanism_changes_along(sweeps_of(table)))
    for row, change in zip(report_rows.changed(table, found, letters(sweeps_of(table))), found, strict=True):
        assert [unquote(side["href"]) for side in row["between"]] == [f"cases/{case}/report.html" for case in change.cases]
        cases = {own["case"]: own for own in table.rows}
        assert [cases[case][change.parameter] for case in change.cases] == [change.low, change.high]
    assert found
    text = write_campaign_report(table).read_text(encoding="utf-8")
    place = text.index('id="mechanisms"')
    addresses = {unquote(address) for address in Page(text[place : text.index("<h2", place)]).addresses}
    assert {f"cases/{case}/report.html" for change in found for case in change.cases} <= addresses


def test_a_folder_of_figures_that_is_a_link_is_refused_and_what_lies_there_stays(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = campaign(tmp_path / "campaign", "one case")
    write_campaign(table)
    elsewhere = tmp_path / "photographs"
    elsewhere.mkdir()
    (elsewhere / "reaction-1.png").write_bytes(b"the user's own")
    (table.folder / "figures").symlink_to(elsewhere)
    assert main(["report", str(table.folder), "-q"]) == TOOL
    said = capsys.readouterr().err
    assert f"{table.folder / 'figures'}: is a symbolic link" in said and "unexpected" not in said
    assert {path.name: path.read_bytes() for path in elsewhere.iterdir()} == {"reaction-1.png": b"the user's own"}


def test_only_figures_of_this_program_s_own_naming_are_taken_away(tmp_path: Path) -> None:
    table = campaign(tmp_path)
    theirs = ("site.png", "reaction-old.png", "map-1.jpeg", "reaction-1-annotated.png", "notes.part")
    ours = ("reaction-99.png", "costs-7.png", "map-1.png.123.part")
    (tmp_path / "figures").mkdir()
    for name in (*theirs, *ours):
        (tmp_path / "figures" / name).write_bytes(b"earlier")
    write_campaign_report(table)
    left = {path.name for path in (tmp_path / "figures").iterdir()}
    assert set(theirs) <= left and left.isdisjoint(ours)


def test_the_axis_of_a_reaction_says_its_unit_though_the_first_case_failed(tmp_path: Path) -> None:
    (drawn,) = plot_lines.reaction_figures(sweeps_of(left_out(campaign(tmp_path), 0)))
    assert drawn.figure.axes[0].get_ylabel() == quantity("N") != quantity("")


def test_a_panel_in_which_no_case_stands_is_left_out(tmp_path: Path) -> None:
    table = campaign(tmp_path)
    lost = [k for k, row in enumerate(table.rows) if row["scene"] == "scene1"]
    for draw in (plot_lines.reaction_figures, plot_lines.participation_figures):
        (whole,) = draw(sweeps_of(table))
        (partly,) = draw(sweeps_of(left_out(table, *lost)))
        assert len(whole.figure.axes) == 2 and len(partly.figure.axes) == 1
        assert not list(draw(sweeps_of(left_out(table))))
    fallen = left_out(table, state="done", unit="N", weight=1000.0, free_blocks=40, associated_status="infeasible", yade_status="collapsed")
    assert "reaction-1.png" not in write_campaign_report(fallen).read_text(encoding="utf-8")
    assert not list((tmp_path / "figures").glob("reaction-*"))


@pytest.mark.parametrize("shape", ["one axis", "two axes"])
def test_maps_of_cases_without_yade_have_no_place_for_it(shape: str, tmp_path: Path) -> None:
    table = campaign(tmp_path, shape)
    none = {name: None for name in result_columns([]) if name.startswith("yade")}
    without = replace(table, rows=[row | none for row in table.rows])
    ((with_yade, _),), ((alone, _),) = (maps.map_figures(sweeps_of(one)) for one in (table, without))

    def shown(figure: Any) -> str:
        return " ".join(text.get_text() for axes in figure.axes for text in (axes.title, *axes.get_yticklabels()))

    assert "YADE" in shown(with_yade) and "YADE" not in shown(alone)
    cells = [sum(len(axes.texts) for axes in figure.axes) for figure in (with_yade, alone)]
    assert cells[0] == 2 * cells[1] > 0


def test_one_of_a_thing_is_not_told_as_many(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = campaign(tmp_path, "one case")
    write_campaign(table)
    folder = str(tmp_path)
    assert main(["report", folder]) == main(["compare", folder, folder]) == 0
    said = capsys.readouterr()
    assert "1 case: 1 agree" in said.out and "1 case is in both" in said.out and "1 cases" not in said.out + said.err


def test_a_campaign_in_which_nothing_ended_has_a_report(tmp_path: Path) -> None:
    text = write_campaign_report(CampaignTable("Nothing yet", {MU: FRICTIONS}, [], [], {}, tmp_path)).read_text(encoding="utf-8")
    assert "nothing ran" in text


def test_the_worst_come_first_whatever_their_order_and_their_unit(tmp_path: Path) -> None:
    table, draw = campaign(tmp_path, "three axes"), random.Random(3)
    rows = [row | {"yade": row["coulomb"] * draw.uniform(0.9, 1.1)} for row in table.rows]
    rows[4] |= {"yade": None, "verdict": "inconclusive"}
    rows[5] |= {"yade": None, "verdict": "disagree"}
    found = worst_first(rows)
    apart = [deviation(row) for row in found[:-2]]
    assert apart == sorted((value for value in apart if value is not None), reverse=True) and len(apart) == len(rows) - 2
    assert [row["verdict"] for row in found[-2:]] == ["disagree", "inconclusive"]
    assert worst_first(draw.sample(rows, len(rows))) == found
    reactions = ("least", "coulomb", "yade", "yade_uncertainty", "weight")
    heavier = [row | {name: 8.0 * row[name] for name in reactions if row[name] is not None} for row in rows]
    assert [row["case"] for row in worst_first(heavier)] == [row["case"] for row in found]


def test_a_deviation_of_one_is_what_sliding_joints_and_the_uncertainty_allow(tmp_path: Path) -> None:
    row = campaign(tmp_path).rows[0] | {"yade": 400.0, "yade_uncertainty": 2.0, "coulomb": 396.0}  # 4 apart; 0.5 % of 400, and 2
    assert deviation(row) == pytest.approx(1.0)
    assert deviation(row | {"coulomb_uncertainty": 4.0}) == pytest.approx(0.5)
    assert deviation(row | {"coulomb": None, "least": 396.0, "coulomb_uncertainty": 4.0}) == pytest.approx(1.0)  # that of another value


def test_cases_are_counted_by_how_they_ended(tmp_path: Path) -> None:
    table = changed(changed(campaign(tmp_path), 0, verdict="disagree"), 1, state="failed", verdict=None)
    found = {item["word"]: item["count"] for item in report_rows.counts(table)}
    assert found == {"agree": len(table.rows) - 2, "disagree": 1, "failed": 1} and sum(found.values()) == len(table.rows)


def test_mechanisms_are_told_by_equality_alone(tmp_path: Path) -> None:
    """Other labels, equal where the first were, give the same letters, changes and maps."""
    table = campaign(tmp_path, "two axes")
    new = {"30-low": "x", "12-high": "y"}
    renamed = replace(
        table, rows=[row | {f"{method}_mechanism": new[row[f"{method}_mechanism"]] for method in METHODS} for row in table.rows]
    )
    first, second = (stored_campaign_report(one) for one in (table, renamed))
    assert first["mechanism_changes"] == second["mechanism_changes"]
    assert {new[name]: letter for name, letter in letters(sweeps_of(table))["scene0"].items()} == letters(sweeps_of(renamed))["scene0"]


def test_a_change_of_mechanism_lies_between_its_neighbours_with_the_slopes_of_both_sides(tmp_path: Path) -> None:
    table = campaign(tmp_path, "two axes")
    found = list(mechanism_changes_along(sweeps_of(table)))
    assert {(change.parameter, change.method, change.low, change.high) for change in found} == {
        (MU, "limit", 0.4, 0.5), (MU, "yade", 0.4, 0.5)
    }  # fmt: skip
    assert len(found) == 2 * len(table.axes[INSET])
    for change in found:
        share = 1.002 if change.method == "yade" else 1.0
        assert change.slope_before == pytest.approx(-0.3 * share, rel=ROUND_OFF)
        assert change.slope_after == pytest.approx(-0.1 * share, rel=ROUND_OFF)


def test_a_parameter_that_does_not_vary_or_goes_with_another_is_no_axis(tmp_path: Path) -> None:
    table = campaign(tmp_path)
    rows = [row | {INSET: 0.001, "stone.density": 2000.0 + 1000.0 * row[MU]} for row in table.rows]
    found = sweeps_of(replace(table, axes=table.axes | {INSET: [0.001], "stone.density": []}, rows=rows))
    assert [sweep.parameters for sweep in found] == [[MU], [MU]]


def test_lines_hold_every_row_of_a_sweep_once_and_rise(tmp_path: Path) -> None:
    (sweep,) = sweeps_of(campaign(tmp_path, "three axes"))
    for parameter in sweep.parameters:
        found = lines(sweep, parameter)
        assert sorted(row["case"] for line in found for row in line.rows) == sorted(row["case"] for row in sweep.rows)
        for line in found:
            assert [row[parameter] for row in line.rows] == sorted(row[parameter] for row in line.rows)


def test_cases_that_share_a_run_are_one_case_to_both_methods_and_their_run_is_paid_once(tmp_path: Path) -> None:
    table = campaign(tmp_path, "classic")
    table = replace(table, rows=[row | {"folder": table.rows[0]["folder"]} for row in table.rows])
    assert [len(sweep.rows) for sweep in sweeps_of(table)] == [1]
    (total,) = report_rows.totals(table)
    assert (total["cases"], total["yade_seconds"]) == (len(table.rows), "4")
    apart = campaign(tmp_path, "classic")
    for before, after in ((table, table), (table, apart), (apart, table)):
        assert {cost.method: (cost.cases, cost.before, cost.after) for cost in compare_tables(before, after).costs}["YADE"] == (1, 4.0, 4.0)


def test_the_methods_have_their_colours_in_the_figures_of_a_campaign(tmp_path: Path) -> None:
    (drawn,) = plot_lines.reaction_figures(sweeps_of(campaign(tmp_path, "one axis")))
    colours = {line.get_color(): line.get_ydata() for line in drawn.figure.axes[0].get_lines() if len(line.get_xdata()) == len(FRICTIONS)}
    reaction = [0.5 - (0.3 if mu < 0.45 else 0.1) * mu for mu in FRICTIONS]
    assert list(colours[LIMIT_ANALYSIS]) == pytest.approx(reaction)
    assert list(colours[YADE]) == pytest.approx([1.002 * value for value in reaction])


def test_the_bounds_of_a_multiplier_end_at_the_associated_one_and_those_of_a_reaction_begin_there(tmp_path: Path) -> None:
    row = campaign(tmp_path).rows[0]
    assert bounds(row) == (row["least"] / 1000.0, row["greatest"] / 1000.0)
    assert bounds(row | {"greatest": None}) == (row["least"] / 1000.0, math.inf)
    assert bounds(row | {"unit": "", "least": 0.7, "greatest": None}) == (-math.inf, 0.7)


def test_where_the_law_of_friction_is_associated_its_mechanism_is_the_one_compared(tmp_path: Path) -> None:
    table = campaign(tmp_path, "choices")
    table = changed(table, 1, coulomb=None, coulomb_status=None, coulomb_mechanism=None, associated_mechanism="own", yade_mechanism="own")
    ((figure, _),) = maps.map_figures(sweeps_of(table))
    assert [text.get_text() for text in figure.axes[0].texts] == ["A", "B", "A", "B"]


def test_cells_where_the_methods_differ_are_marked_and_no_others(tmp_path: Path) -> None:
    table = changed(campaign(tmp_path, "two axes"), 3, yade_mechanism="12-high")
    ((figure, _),) = maps.map_figures(sweeps_of(table))
    marked = [[text for text in axes.texts if maps.APART in text.get_text()] for axes in figure.axes]
    assert [len(texts) for texts in marked] == [1, 1]
    assert marked[0][0].get_position() == marked[1][0].get_position()
    assert [texts[0].get_text()[0] for texts in marked] == ["A", "B"]


def test_a_structure_that_cannot_stand_has_no_mechanism_and_its_cell_says_so(tmp_path: Path) -> None:
    none = dict.fromkeys(f"{method}_mechanism" for method in METHODS)
    table = changed(campaign(tmp_path, "two axes"), 0, **none, associated_status="infeasible", yade_status="collapsed")
    ((figure, _),) = maps.map_figures(sweeps_of(table))
    for axes in figure.axes:
        assert [text.get_text() for text in axes.texts].count(maps.FALLS) == 1


def test_labels_of_axes_say_what_it_is_and_in_what_unit() -> None:
    assert label(MU) == "friction mu (-)" and label(INSET) == "inset (m)"
    assert label("wall[0].courses") == "wall[0]: courses" and label("wall[0].block[2]") == "wall[0]: block size (m), z"
    assert label("yade.damping") == "yade: damping"
    assert label("wall[0].opening[1].from[1]") == "wall[0] opening[1]: from (m), z"
    assert label("block[0].box.to[0]") == "block[0] box: to (m), x" and label("block[0].density") == "block[0]: density (kg/m³)"
    assert label("block[2].prism.profile[3][1]") == "block[2] prism: profile (m), point [3], z"
    assert label("building[0].foundation.settling.to[1]") == "building[0] foundation settling: to (m), y"
    assert label("arch[0].thickness") == "arch[0]: thickness (m)" and label("dome[0].radius") == "dome[0]: radius (m)"
    assert label("yade.normal_stiffness") == "yade: normal stiffness (N/m)" and label("yade.time_limit") == "yade: time limit (s)"
    assert (
        label("yade.speed", {"yade.speed": "v"}) == "v (m/s or rad/s)"
        and label("block[0].box.to[0]", {"block[0].box.to[0]": "end"}) == "end (m)"
    )
    assert label(INSET, {INSET: "e (mm)"}) == "e (mm)"
    assert label("tie[0].force") == "tie[0]: force (N)" and label("load[1].mass") == "load[1]: mass (kg, kg/m or kg/m2)"
    counted = {"record_rows", "poses"}
    assert {name for name in SETTINGS if not label(f"yade.{name}").endswith(")")} == counted
    assert label(MU, {MU: "tan phi"}) == "tan phi (-)" and label("wall[0].block[2]", {"wall[0].block[2]": "height"}) == "height (m)"


# Two campaigns


def words(found: Comparison) -> list[tuple[str, str, str]]:
    return [(change.case, change.kind, change.what) for change in found.changes]


@every_shape
def test_a_campaign_compared_with_itself_has_not_changed(shape: str, tmp_path: Path) -> None:
    table = campaign(tmp_path, shape)
    found = compare_tables(table, table)
    assert not found.changed and not found.within and not found.provenance and found.matched == len(table.rows)
    assert all(cost.ratio == cost.typical == 1.0 for cost in found.costs)


def test_yade_in_one_campaign_only_is_said_once(tmp_path: Path) -> None:
    before = replace(campaign(tmp_path), provenance={"yade": True})
    after = replace(before, provenance={"yade": False})
    for place in range(len(before.rows)):
        after = changed(after, place, yade=None, yade_status=None, yade_uncertainty=None, verdict="")
    found = compare_tables(before, after)
    assert found.changed and len(found.changes) >= 2 * len(before.rows)  # JSON and the exit code still tell them
    assert sentence(found).startswith("YADE ran in one campaign only")
    assert "changes" not in [str(table.title) for table in terminal_tables(found)]
    other = compare_tables(before, changed(after, 0, coulomb=1.2 * before.rows[0]["coulomb"]))
    assert sentence(other).startswith(f"1 of {len(before.rows)} cases changed")
    assert "changes" in [str(table.title) for table in terminal_tables(other)]


def test_every_mechanism_has_a_picture_from_a_case_that_has_it(tmp_path: Path) -> None:
    table = campaign(tmp_path, "two axes")
    lettered = letters(sweeps_of(table))
    assert not list(report_rows.mechanism_pictures(table, lettered))  # no case has drawn any
    for row in table.rows:
        place = tmp_path / str(row["folder"]) / "scene"
        place.mkdir(parents=True, exist_ok=True)
        (place / "mechanisms.png").write_bytes(str(row["case"]).encode())
    shown = list(report_rows.mechanism_pictures(table, lettered))
    assert len(shown) == sum(map(len, lettered.values()))
    for picture in shown:
        row = next(row for row in table.rows if row["case"] == picture["case"])
        assert base64.b64decode(picture["data"].split(",")[1]).decode() == row["case"]
        letter = lettered[str(picture["scene"])][str(row["coulomb_mechanism"])]
        assert f"mechanism {letter} by" in picture["caption"]


def moved(folder: Path) -> tuple[CampaignTable, CampaignTable]:
    """Two campaigns that differ in every kind of thing."""
    before = campaign(folder, "two axes")
    after = changed(before, 0, verdict="disagree", yade=600.0)
    after = changed(after, 1, coulomb_mechanism="other", coulomb=before.rows[1]["coulomb"] * 1.1)
    after = changed(after, 2, yade=None, yade_status="timeout", yade_uncertainty=None)
    after = changed(after, 3, yade=before.rows[3]["yade"] * 1.0005)
    after = changed(after, 4, case="new")
    costs = [cost | {"yade_seconds": 2.0 * cost["yade_seconds"]} for cost in after.costs]
    return before, replace(after, costs=costs, provenance={"program": {"crosscheck": "0.2.0", "numpy": "2.0"}})


def test_the_comparison_is_antisymmetric(tmp_path: Path) -> None:
    before, after = moved(tmp_path)
    there, back = compare_tables(before, after), compare_tables(after, before)
    assert there.changed and back.changed

    def turned(change: Change) -> Change:
        return replace(change, before=change.after, after=change.before, allowed=change.allowed and pytest.approx(change.allowed))

    assert [turned(change) for change in there.changes] == back.changes
    assert [turned(change) for change in there.within] == back.within and len(there.within) == 1
    for change, opposite in zip(there.changes, back.changes, strict=True):
        assert change.difference is None or opposite.difference is None or change.difference == -opposite.difference
    assert (there.only_before, there.only_after) == (back.only_after, back.only_before)
    assert [(name, second, first) for name, first, second in there.provenance] == back.provenance
    for cost, opposite in zip(there.costs, back.costs, strict=True):
        assert cost.ratio * opposite.ratio == pytest.approx(1.0) and cost.typical * opposite.typical == pytest.approx(1.0)


def test_only_what_exceeds_the_stated_uncertainty_is_a_change(tmp_path: Path) -> None:
    before = campaign(tmp_path)
    both = 2.0 * before.rows[2]["yade_uncertainty"]
    inside = compare_tables(before, changed(before, 2, yade=before.rows[2]["yade"] + 0.9 * both))
    outside = compare_tables(before, changed(before, 2, yade=before.rows[2]["yade"] + 1.1 * both))
    case = before.rows[2]["case"]
    assert not inside.changed and [change.case for change in inside.within] == [case]
    assert words(outside) == [(case, "reaction", "yade")] and not outside.within


def test_a_prediction_may_move_by_the_uncertainty_that_both_campaigns_state(tmp_path: Path) -> None:
    before = campaign(tmp_path)
    before = changed(before, 0, coulomb_uncertainty=0.001 * before.rows[0]["coulomb"])
    for factor, substantial in ((1.0019, []), (1.0022, [(before.rows[0]["case"], "reaction", "coulomb")])):
        assert words(compare_tables(before, changed(before, 0, coulomb=factor * before.rows[0]["coulomb"]))) == substantial


def test_the_report_shows_the_uncertainty_of_a_prediction_where_it_is_stated(tmp_path: Path) -> None:
    table = changed(campaign(tmp_path), 0, coulomb_uncertainty=3.0, coulomb_plateaus=2)
    write_campaign_report(table)
    for name in ("report.html", "report.md"):
        text = (tmp_path / name).read_text(encoding="utf-8")
        assert text.count(" ± 0.003") == text.count("one of 2 plateaus") == 1


def test_a_prediction_may_move_where_its_mechanism_leaves_it_open_and_not_elsewhere(tmp_path: Path) -> None:
    before = campaign(tmp_path)
    after = changed(before, 0, coulomb=1.005 * before.rows[0]["coulomb"])
    assert not compare_tables(before, after).changed
    point = {"coulomb_low": before.rows[0]["coulomb"], "coulomb_high": before.rows[0]["coulomb"]}
    assert words(compare_tables(changed(before, 0, **point), changed(after, 0, **point))) == [
        (before.rows[0]["case"], "reaction", "coulomb")
    ]


def test_a_value_that_comes_into_being_is_a_change(tmp_path: Path) -> None:
    before = campaign(tmp_path)
    found = compare_tables(changed(before, 0, greatest=None), before)
    assert words(found) == [(before.rows[0]["case"], "reaction", "greatest")] and found.changes[0].difference is None


def test_costs_and_versions_are_told_and_are_no_change(tmp_path: Path) -> None:
    before = campaign(tmp_path)
    costs = [cost | {"limit_analysis_seconds": 3.0 * cost["limit_analysis_seconds"]} for cost in before.costs]
    found = compare_tables(before, replace(before, costs=costs, provenance={"program": {"crosscheck": "0.2.0"}}))
    assert not found.changed and found.provenance == [("program.crosscheck", "0.1.0", "0.2.0")]
    assert {cost.method: cost.ratio for cost in found.costs} == {"limit analysis": pytest.approx(3.0), "YADE": 1.0}


def test_a_campaign_run_by_another_yade_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, version in (("before", "2023.02a"), ("after", "2024.04")):
        table = campaign(tmp_path / name)
        own = table.folder / table.rows[0]["folder"] / "scene"
        own.mkdir()
        (own / "comparison.json").write_text(json.dumps({"yade": {"version": version}}))
        (table.folder / table.rows[1]["folder"] / "scene").mkdir()
        (table.folder / table.rows[1]["folder"] / "scene" / "comparison.json").write_text("{damaged")
        (table.folder / table.rows[2]["folder"] / "scene").mkdir()
        (table.folder / table.rows[2]["folder"] / "scene" / "comparison.json").write_bytes(b"\xff")
        (table.folder / table.rows[3]["folder"] / "scene" / "comparison.json").mkdir(parents=True)
        write_campaign(table)
    assert main(["compare", str(tmp_path / "before"), str(tmp_path / "after"), "--json", "-q"]) == 0
    assert json.loads(capsys.readouterr().out)["provenance"] == [{"name": "yade_version", "before": "2023.02a", "after": "2024.04"}]


def test_the_command_ends_with_what_it_found(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before, after = moved(tmp_path / "before")
    after = replace(after, folder=tmp_path / "after", title="<b>after</b> | x")
    after.folder.mkdir()
    write_campaign(before)
    write_campaign(after)
    first, second = str(before.folder), str(after.folder)
    assert main(["compare", first, first]) == 0
    assert "Nothing of substance changed" in capsys.readouterr().out
    assert main(["compare", first, second, "-q"]) == 1
    told = capsys.readouterr()
    assert "only before" in told.out and not told.err
    assert main(["compare", first, second, "--json", "-q"]) == 1
    assert json.loads(capsys.readouterr().out) == json.loads(json.dumps(stored_comparison(compare_tables(before, after))))
    assert main(["compare", first, str(tmp_path)]) == 2
    for ending in ("html", "md", "json"):
        assert main(["compare", first, second, "-q", "-o", str(tmp_path / f"changes.{ending}")]) == 1
    page = Page((tmp_path / "changes.html").read_text(encoding="utf-8"))
    assert "b" not in page.tags and "<b>after</b> | x" in page.text
    markdown = (tmp_path / "changes.md").read_text(encoding="utf-8")
    assert all(str(change.case).replace("_", "\\_") in markdown for change in compare_tables(before, after).changes)
    assert json.loads((tmp_path / "changes.json").read_text(encoding="utf-8"))["changed"] is True
    with pytest.raises(SystemExit):
        main(["compare", first, second, "-o", "changes.txt"])


def test_report_on_a_campaign_s_folder_writes_its_report_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = campaign(tmp_path / "one", "one case")
    write_campaign(table)
    assert main(["report", str(table.folder), "--json", "-q"]) == 0
    assert json.loads(capsys.readouterr().out)["counts"] == {"agree": 1}
    assert (table.folder / "report.html").is_file()
    write_campaign(changed(table, 0, verdict="disagree", reason="it does not"))
    assert main(["report", str(table.folder), "-q"]) == 1
    assert "it does not" in capsys.readouterr().out
    assert main(["report", str(table.folder), str(tmp_path)]) == 2
