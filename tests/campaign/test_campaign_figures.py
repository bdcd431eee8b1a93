"""The colours, units, panels and marks of a campaign's figures show the results of its cases, and leave out undefined values."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from made_up_campaigns import FRICTIONS, INSET, MU, campaign, changed, left_out

from comparison.campaign.columns import METHODS, result_columns
from comparison.campaign.figures import classic, maps
from comparison.campaign.figures import lines as plot_lines
from comparison.campaign.figures.case_costs import case_cost_figure
from comparison.campaign.parameter_labels import label, quantity, shown
from comparison.campaign.report.report import write_campaign_report
from comparison.campaign.row_groups import sweeps_of
from comparison.figures.canvas import LIMIT_ANALYSIS, YADE
from la_core.exchange.dem_settings import SETTINGS

pytestmark = pytest.mark.slow


def test_the_axis_of_a_reaction_says_its_unit_though_the_first_case_failed(tmp_path: Path) -> None:
    (drawn,) = plot_lines.reaction_figures(sweeps_of(left_out(campaign(tmp_path), 0)))
    assert drawn.figure.axes[0].get_ylabel() == quantity("N") != quantity("")


def test_forces_and_moments_of_one_sweep_have_panels_of_their_own(tmp_path: Path) -> None:
    """The moments of the last two cases stood on the axis of the forces."""
    table = campaign(tmp_path, "one axis")
    rows = [row | {"unit": "N m" if row[MU] > 0.45 else "N"} for row in table.rows if row["scene"] == "scene0"]
    (drawn,) = plot_lines.reaction_figures(sweeps_of(replace(table, rows=rows)))
    assert [axes.get_ylabel() for axes in drawn.figure.axes] == [quantity("N"), quantity("N m")]
    points = [{len(line.get_xdata()) for line in axes.get_lines() if line.get_color() == LIMIT_ANALYSIS} for axes in drawn.figure.axes]
    assert points == [{3}, {2}]


def test_a_table_is_shown_by_its_keys_with_values() -> None:
    """Labels held the text of a Python table with all its keys, and took the place of the whole figure."""
    assert shown({"axis": [0.0, 1.0, 0.0], "point": [0.5, 0.0, 0.0], "direction": None, "zone": []}) == "axis (0, 1, 0), point (0.5, 0, 0)"
    assert shown({"load_factor": 2.0}) == "load factor 2"


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


def test_the_methods_have_their_colours_in_the_figures_of_a_campaign(tmp_path: Path) -> None:
    (drawn,) = plot_lines.reaction_figures(sweeps_of(campaign(tmp_path, "one axis")))
    colours = {line.get_color(): line.get_ydata() for line in drawn.figure.axes[0].get_lines() if len(line.get_xdata()) == len(FRICTIONS)}
    reaction = [0.5 - (0.3 if mu < 0.45 else 0.1) * mu for mu in FRICTIONS]
    assert list(colours[LIMIT_ANALYSIS]) == pytest.approx(reaction)
    assert list(colours[YADE]) == pytest.approx([1.002 * value for value in reaction])


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


def keys_of(figure: Any) -> str:
    return ", ".join(text.get_text() for text in figure.legends[0].get_texts())


def test_the_legend_of_a_map_lists_the_signs_that_are_drawn_and_no_others(tmp_path: Path) -> None:
    whole = campaign(tmp_path, "two axes")
    signs = ("! failed", "↓ cannot stand", "– no mechanism known", "methods' mechanisms differ", "mechanism changes")
    none = dict.fromkeys(f"{method}_mechanism" for method in METHODS)
    drawn = {
        (): whole,
        (signs[0],): changed(whole, 0, **none, state="failed"),
        (signs[1],): changed(whole, 0, **none, associated_status="infeasible", yade_status="collapsed"),
        (signs[2],): changed(whole, 0, **none),
        (signs[3],): changed(whole, 3, yade_mechanism="12-high"),
    }
    for present, table in drawn.items():
        ((figure, _),) = maps.map_figures(sweeps_of(table))
        assert {sign for sign in signs if sign in keys_of(figure)} == {*present, signs[4]}
    same = replace(whole, rows=[row | dict.fromkeys(none, "12-one") for row in whole.rows])
    ((figure, _),) = maps.map_figures(sweeps_of(same))
    assert keys_of(figure) == "A, B, ...: mechanisms of a scene, equal letters for equal ones"


def test_the_legend_of_a_curve_names_changes_of_the_mechanism_where_one_is_drawn(tmp_path: Path) -> None:
    table = campaign(tmp_path, "one axis")
    same = replace(table, rows=[row | {"coulomb_mechanism": "12-one"} for row in table.rows])
    for one, is_told in ((table, True), (same, False)):
        (drawn,) = plot_lines.reaction_figures(sweeps_of(one))
        assert ("mechanism changes" in keys_of(drawn.figure)) == is_told


def test_the_legend_of_the_classic_iteration_names_a_lost_run_where_one_is_drawn(tmp_path: Path) -> None:
    table = campaign(tmp_path, "classic")
    answered = [row | {"classic": 0.4, "classic_status": "solved"} for row in table.rows]
    opened = [row | {"classic": 0.4, "classic_status": "inaccurate"} for row in table.rows]
    shown = [
        [keys_of(figure) for figure, _ in classic.classic_figures(sweeps_of(replace(table, rows=rows), classic=True))]
        for rows in (table.rows, answered, opened)
    ]
    assert [all("no value" in words for words in one) for one in shown] == [True, False, False]
    assert [any("no value" in words for words in one) for one in shown] == [True, False, False]
    assert [all(", not converged" in words for words in one) for one in shown] == [False, False, True]


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


def test_all_numbers_of_an_axis_have_one_size(tmp_path: Path) -> None:
    table = campaign(tmp_path)
    costs = [
        {"case": row["case"], "limit_analysis_seconds": seconds}
        for row, seconds in zip(table.rows, (0.02, 0.03, 0.05, 0.06, 0.07), strict=False)
    ]
    figure = case_cost_figure(replace(table, costs=costs))
    assert figure is not None
    figure.draw_without_rendering()
    written = [text for axes in figure.axes for text in axes.yaxis.get_ticklabels(which="both") if text.get_text()]
    assert len(written) > 4 and len({text.get_fontsize() for text in written}) == 1


@pytest.mark.parametrize("greatest", [0.005, 0.06, 0.9, 40.0])
def test_an_axis_of_seconds_has_at_least_two_numbers(greatest: float, tmp_path: Path) -> None:
    """The times, from 0.0025 s on, include several powers of ten, one or none."""
    table = campaign(tmp_path)
    seconds = np.geomspace(0.0025, greatest, len(table.rows))
    costs = [{"case": row["case"], "limit_analysis_seconds": float(one)} for row, one in zip(table.rows, seconds, strict=True)]
    figure = case_cost_figure(replace(table, costs=costs))
    assert figure is not None
    figure.draw_without_rendering()
    for axes in figure.axes:
        low, high = axes.get_ylim()
        texts = axes.yaxis.get_ticklabels(which="both")
        assert len([text for text in texts if text.get_text() and low <= text.get_position()[1] <= high]) >= 2


@pytest.mark.parametrize("numbers", [(31, 38), (65, 75), (101, 104), (11, 19), (31, 31)])
def test_cases_of_nearly_the_same_size_have_their_figure_of_costs(numbers: tuple[int, int], tmp_path: Path) -> None:
    """Where no round number of blocks lies between the cases, the axis has their own numbers."""
    table = campaign(tmp_path)
    rows = [row | {"free_blocks": number} for row, number in zip(table.rows, numbers, strict=False)]
    costs = [{"case": row["case"], "limit_analysis_seconds": 0.1 * (k + 1)} for k, row in enumerate(rows)]
    figure = case_cost_figure(replace(table, rows=rows, costs=costs))
    assert figure is not None
    figure.draw_without_rendering()
    left = figure.axes[0]
    low, high = left.get_xlim()
    shown = [float(text.get_text()) for text in left.get_xticklabels() if text.get_text()]
    assert shown and all(low <= number <= high for number in shown)
