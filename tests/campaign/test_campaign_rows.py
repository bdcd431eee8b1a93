"""A campaign's report derives order, counts, lines and changes of mechanism from its rows."""

import math
import random
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scenes
from made_up_campaigns import INSET, MU, campaign, changed
from made_up_comparisons import frictional_comparison

from comparison.campaign import mechanism_labels
from comparison.campaign.columns import METHODS, answers_of
from comparison.campaign.mechanism_changes import letters, mechanism_changes_along
from comparison.campaign.report import rows as report_rows
from comparison.campaign.report.compare import compare_tables
from comparison.campaign.report.report import stored_campaign_report
from comparison.campaign.row_groups import lines, sweeps_of
from comparison.campaign.row_values import (
    bounds,
    compared_with,
    deviation,
    interval,
    over_weight,
    title_of_values,
    value_cells,
    worst_first,
)
from comparison.judge.checks.tolerances import least_reaction
from comparison.judge.summary import comparison_summary
from comparison.verdict import verdict_title
from comparison.yade import Results
from la_core.analysis.stage import analyse

pytestmark = pytest.mark.slow

ROUND_OFF = 1e-9  # of a slope: difference quotients of numbers of order one


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


def test_cases_that_nothing_tells_apart_keep_the_order_of_the_campaign() -> None:
    rows: list[dict[str, Any]] = [{"case": f"density={density}", "verdict": None} for density in (900.0, 1000.0, 1e-5)]
    assert worst_first(rows) == rows


def test_where_both_methods_agree_after_a_release_yade_is_compared_with_this_value(tmp_path: Path) -> None:
    row = campaign(tmp_path).rows[0] | {"yade": 400.0, "yade_uncertainty": 2.0, "coulomb": 440.0, "verdict": "agree"}
    released = {"coulomb_released": 399.0, "coulomb_released_uncertainty": 2.0}
    assert compared_with(row | released) == "coulomb_released" and deviation(row | released) == pytest.approx(1.0 / 6.0)
    assert compared_with(row | released | {"verdict": "inconclusive"}) == compared_with(row | released | {"yade": 439.0}) == "coulomb"
    assert compared_with(row | released | {"coulomb_released": 380.0}) == compared_with(row) == "coulomb"


def test_a_deviation_of_one_is_what_sliding_joints_and_the_uncertainty_allow(tmp_path: Path) -> None:
    row = campaign(tmp_path).rows[0] | {"yade": 400.0, "yade_uncertainty": 2.0, "coulomb": 396.0}  # 4 apart; tolerance: 0.5 % of 400, and 2
    assert deviation(row) == pytest.approx(1.0)
    assert deviation(row | {"coulomb_uncertainty": 4.0}) == pytest.approx(0.5)
    assert deviation(row | {"coulomb": None, "least": 396.0, "coulomb_uncertainty": 4.0}) == pytest.approx(1.0)  # not that of `least`


def test_a_small_reaction_deviates_by_a_share_of_the_weight_and_a_multiplier_by_itself(tmp_path: Path) -> None:
    """The floor of a reaction is 1e-4 of the weight of 1,000 N: 0.1 N. A multiplier is over the weight already, and so is its floor."""
    row = campaign(tmp_path).rows[0] | {"yade_uncertainty": 0.0}
    for sign in (1.0, -1.0):
        assert deviation(row | {"yade": sign * 1.0, "coulomb": sign * 0.9}) == pytest.approx(1.0)
        assert deviation(row | {"yade": sign * 400.0, "coulomb": sign * 396.0}) == pytest.approx(2.0)
        multiplier = row | {"unit": "", "yade": sign * 0.4, "coulomb": sign * 0.396}
        assert deviation(multiplier) == pytest.approx(2.0)
        assert deviation(multiplier | {"yade": sign * 1e-3, "coulomb": sign * 0.9e-3}) == pytest.approx(1.0)


def test_a_small_moment_deviates_as_the_judge_measures_it(tmp_path: Path) -> None:
    """For a block on a turning pad, the floor is 1e-4 of the weight times the size of the block."""
    pads = (
        scenes.box("fixed pad", (0.0, 0.0, -0.1), (0.4, 0.2, 0.0), "fixed"),
        scenes.box("pad", (0.5, 0.0, -0.1), (1.0, 0.2, 0.0), "support"),
    )
    block = scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.2, 0.5))
    analysis = analyse(scenes.build(*pads, block, inset=1e-3, settlement={"axis": (0.0, 1.0, 0.0), "point": (0.5, 0.0, 0.0)}))
    floor = least_reaction(analysis)
    assert analysis.scene.unit == "N m" and floor == pytest.approx(1e-4 * analysis.scene.weight * analysis.assembly.length)
    summary = comparison_summary(Results(analysis), None, [], [])
    row = campaign(tmp_path).rows[0] | answers_of(summary, {}) | {"yade_uncertainty": 0.0, "coulomb_uncertainty": 0.0}
    assert deviation(row | {"yade": floor, "coulomb": 0.0}) == pytest.approx(1.0)


def test_a_row_has_the_value_after_a_release_at_the_inset_of_both_methods() -> None:
    comparison = frictional_comparison()
    assert answers_of(comparison, {})["coulomb_released"] is None
    comparison["limit_analysis"]["coulomb"] |= {"released": None, "shared_inset": {"released": 331.0, "released_uncertainty": 1.2}}
    row = answers_of(comparison, {})
    assert (row["coulomb_released"], row["coulomb_released_uncertainty"]) == (331.0, 1.2)


@pytest.mark.parametrize("weight", [None, 0.0])
def test_a_reaction_over_no_weight_is_undefined_and_a_multiplier_needs_none(weight: float | None, tmp_path: Path) -> None:
    row = campaign(tmp_path).rows[0] | {"weight": weight, "coulomb": 0.4}
    assert over_weight(row, "coulomb") is None and over_weight(row | {"unit": ""}, "coulomb") == 0.4


def test_cases_are_counted_by_how_they_ended(tmp_path: Path) -> None:
    table = changed(changed(campaign(tmp_path), 0, verdict="disagree"), 1, state="failed", verdict=None)
    found = {item["word"]: item["count"] for item in report_rows.counts(table)}
    assert found == {"agree": len(table.rows) - 2, "disagree": 1, "failed": 1} and sum(found.values()) == len(table.rows)


def test_mechanisms_are_told_by_equality_alone(tmp_path: Path) -> None:
    """Other labels that are equal in the same rows give the same letters and changes of mechanism."""
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


def test_between_two_mechanisms_there_is_no_slope(tmp_path: Path) -> None:
    table = campaign(tmp_path)
    rows = [row | {"yade_mechanism": name} for row, name in zip(table.rows, "ABBAACCC", strict=True)]
    found = [change for change in mechanism_changes_along(sweeps_of(replace(table, rows=rows))) if change.method == "yade"]
    assert [(change.before, change.after) for change in found] == [("A", "B"), ("B", "A")]
    assert [(change.slope_before is None, change.slope_after is None) for change in found] == [(True, False), (False, False)]
    alone = [row | {"yade_mechanism": name} for row, name in zip(table.rows, "ABABACCC", strict=True)]
    found = [change for change in mechanism_changes_along(sweeps_of(replace(table, rows=alone))) if change.method == "yade"]
    assert [(change.slope_before, change.slope_after) for change in found] == [(None, None)] * 4


@pytest.mark.parametrize(
    ("speeds", "moving"), [([1.0, 0.05, 0.0], 1), ([1.0, 0.07, 0.0], 2), ([1.0, 0.1, 0.03], 2), ([1.0, 0.055, 0.045], 1)]
)
def test_the_widest_gap_between_speeds_parts_what_moves_from_what_only_strains(
    speeds: list[float], moving: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mechanism_labels, "block_speeds", lambda *_: np.array(speeds))
    monkeypatch.setattr(mechanism_labels, "fastest_speed", lambda *_: max(speeds))
    assembly: Any = SimpleNamespace(blocks=SimpleNamespace(free=np.ones(3, dtype=bool), names=["a", "b", "c"]))
    label = mechanism_labels.mechanism_label(assembly, np.zeros((3, 6)))
    assert label is not None and label.startswith(f"{moving}-")


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


def test_the_bounds_of_a_multiplier_end_at_the_associated_one_and_those_of_a_reaction_begin_there(tmp_path: Path) -> None:
    row = campaign(tmp_path).rows[0]
    assert bounds(row) == (row["least"] / 1000.0, row["greatest"] / 1000.0)
    assert bounds(row | {"greatest": None}) == (row["least"] / 1000.0, math.inf)
    assert bounds(row | {"unit": "", "least": 0.7, "greatest": None}) == (-math.inf, 0.7)


def test_where_blocks_lock_as_they_dilate_the_other_bound_stays(tmp_path: Path) -> None:
    """The table once had a dash for a known greatest reaction, because no least reaction exists."""
    row = campaign(tmp_path).rows[0] | {"associated_status": "unbounded", "least": None, "greatest": 250.0}
    assert bounds(row) == (-math.inf, 0.25)
    assert value_cells(row)[0] == "–" and value_cells(row)[2] == "0.25000"
    assert bounds(row | {"unit": "", "greatest": None}) == (-math.inf, math.inf)
    assert np.isnan(bounds(row | {"associated_status": "failed"})).all()


def test_an_interval_without_a_limit_at_one_end_goes_on_for_ever(tmp_path: Path) -> None:
    row = campaign(tmp_path).rows[0] | {"coulomb_low": 100.0, "coulomb_high": 300.0}
    assert interval(row) == (0.1, 0.3)
    assert interval(row | {"coulomb_high": None}) == (0.1, math.inf)
    assert interval(row | {"coulomb_low": None}) == (-math.inf, 0.3)
    assert np.isnan(interval(row | {"coulomb_low": None, "coulomb_high": None})).all()


def test_a_row_is_printed_over_the_weight_and_a_multiplier_is_bounded_from_above(tmp_path: Path) -> None:
    row = campaign(tmp_path).rows[0] | {"least": 360.0, "coulomb": -400.0, "greatest": 998.0, "yade": None}
    assert value_cells(row) == ["0.36000", "−0.40000", "0.99800", "–"]
    assert value_cells(row | {"unit": "", "least": 0.5, "coulomb": 0.25, "greatest": None}) == ["–", "0.25000", "0.50000", "–"]
    assert title_of_values([row, row | {"unit": "", "state": "failed"}]) == verdict_title({"N"})
    assert title_of_values([row | {"unit": "N m"}, row | {"unit": ""}]) == verdict_title({"N m", ""})
