"""The comparison of two campaigns: only a difference above the stated uncertainties is a change."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from made_up_campaigns import MU, Page, campaign, changed, every_shape

from comparison.campaign.report.compare import Change, Comparison, compare_tables
from comparison.campaign.report.compare_report import change_words, sentence, stored_comparison, terminal_tables
from comparison.campaign.table import CampaignTable, write_campaign
from comparison.cli.commands import main

pytestmark = pytest.mark.slow


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
    assert found.changed and len(found.changes) >= 2 * len(before.rows)  # JSON and the exit code still report the changes
    assert sentence(found).startswith("YADE ran in one campaign only")
    assert "changes" not in [str(table.title) for table in terminal_tables(found)]
    other = compare_tables(before, changed(after, 0, coulomb=1.2 * before.rows[0]["coulomb"]))
    assert sentence(other).startswith(f"1 of {len(before.rows)} cases changed")
    assert "changes" in [str(table.title) for table in terminal_tables(other)]


def moved(folder: Path) -> tuple[CampaignTable, CampaignTable]:
    """Return two campaigns with every kind of difference."""
    before = campaign(folder, "two axes")
    after = changed(before, 0, verdict="disagree", yade=600.0)
    after = changed(after, 1, coulomb_mechanism="other", coulomb=before.rows[1]["coulomb"] * 1.1)
    after = changed(after, 2, yade=None, yade_status="timeout", yade_uncertainty=None)
    after = changed(after, 3, yade=before.rows[3]["yade"] * 1.0005)
    after = changed(after, 4, case="new", **{MU: 0.9})
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
        assert opposite.difference == (None if change.difference is None else -change.difference)
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
    assert "1 reaction differs within the stated uncertainties" in sentence(inside)
    assert "1 other reaction differs within" in sentence(compare_tables(*moved(tmp_path)))  # in addition to the changed reactions
    assert words(outside) == [(case, "reaction", "yade")] and not outside.within


def test_a_prediction_may_move_by_the_uncertainty_that_both_campaigns_state(tmp_path: Path) -> None:
    before = campaign(tmp_path)
    before = changed(before, 0, coulomb_uncertainty=0.001 * before.rows[0]["coulomb"])
    for factor, substantial in ((1.0019, []), (1.0022, [(before.rows[0]["case"], "reaction", "coulomb")])):
        assert words(compare_tables(before, changed(before, 0, coulomb=factor * before.rows[0]["coulomb"]))) == substantial


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


RELEASED = {"coulomb_released": 300.0, "coulomb_released_uncertainty": 2.0, "coulomb_uncertainty": 0.1}
PEAK = {"unit": "", "coulomb_peak": 0.4, "coulomb_peak_uncertainty": 0.01, "coulomb_uncertainty": 0.1}


@pytest.mark.parametrize(
    ("own", "name", "inside", "outside"),
    [
        (RELEASED, "coulomb_released", 303.9, 304.1),
        (PEAK, "coulomb_peak", 0.419, 0.421),
        ({"coulomb_low": 420.0, "coulomb_uncertainty": 1.0}, "coulomb_low", 421.9, 422.1),
        ({"coulomb_high": 480.0, "coulomb_uncertainty": 1.0}, "coulomb_high", 478.1, 477.9),
        ({"coulomb_high": 480.0}, "coulomb_high", 480.4, 481.0),  # no stated uncertainty: 0.1 %
    ],
)
def test_every_answer_is_held_against_its_own_uncertainty(
    own: dict[str, float], name: str, inside: float, outside: float, tmp_path: Path
) -> None:
    before = changed(campaign(tmp_path), 0, **own)
    assert not compare_tables(before, changed(before, 0, **{name: inside})).changed
    (change,) = compare_tables(before, changed(before, 0, **{name: outside})).changes
    assert (change.case, change.kind, change.what) == (before.rows[0]["case"], "reaction", name)
    (lost,) = compare_tables(before, changed(before, 0, **{name: None})).changes
    assert lost.what == name and lost.difference is None


@pytest.mark.parametrize(
    ("name", "value", "kind", "printed"),
    [
        ("weight", 1100.0, "weight", "1100 N"),
        ("unit", "N m", "unit", "N m"),
        ("free_blocks", 41, "count", "41"),
        ("coulomb_plateaus", 2, "count", "2"),
    ],
)
def test_another_structure_or_number_of_plateaus_is_a_change(name: str, value: object, kind: str, printed: str, tmp_path: Path) -> None:
    before = campaign(tmp_path)
    after = changed(before, 0, **{name: value})
    found = compare_tables(before, after)
    assert words(found) == [(before.rows[0]["case"], kind, name)]
    assert change_words(found.changes[0])["after"] == printed


def test_round_off_of_a_weight_is_none(tmp_path: Path) -> None:
    before = campaign(tmp_path)
    found = compare_tables(before, changed(before, 0, weight=before.rows[0]["weight"] * (1.0 + 1e-12)))
    assert not found.changed and not found.within


def test_a_column_that_an_earlier_version_did_not_have_is_no_change(tmp_path: Path) -> None:
    later = ("coulomb_released", "coulomb_peak", "coulomb_plateaus")
    after = campaign(tmp_path)
    for place in range(len(after.rows)):
        after = changed(after, place, coulomb_released=300.0, coulomb_peak=None, coulomb_plateaus=1)
    before = replace(after, rows=[{name: value for name, value in row.items() if name not in later} for row in after.rows])
    assert not compare_tables(before, after).changed and not compare_tables(after, before).changed


@pytest.mark.parametrize(
    ("row", "before", "after", "is_change"),
    [
        ({"unit": ""}, -6.1e-12, -1.7e-11, False),  # a multiplier of a structure without friction
        ({"unit": ""}, 0.0, 1e-5, True),
        ({"unit": "N m", "least_tolerance": 1.0}, 0.0, 5e-3, False),  # 1e-4 of W = 1 kN with a lever arm of 10 m
        ({"unit": "N m", "least_tolerance": 1.0}, 0.0, 5e-2, True),
    ],
)
def test_round_off_of_a_value_near_0_is_no_change(
    row: dict[str, object], before: float, after: float, is_change: bool, tmp_path: Path
) -> None:
    alike = changed(campaign(tmp_path), 0, weight=1000.0, **row)
    first, second = (changed(alike, 0, least=value) for value in (before, after))
    assert compare_tables(first, second).changed is is_change
    heavier = changed(alike, 0, weight=1000.005)  # N, also where the reaction is a moment
    assert compare_tables(alike, heavier).changed


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


def test_cases_are_matched_by_their_values_in_whatever_order_they_stand(tmp_path: Path) -> None:
    """A case with an array as parameter is named by the array's place in the range, so one name may belong to different cases."""
    before = campaign(tmp_path, "directions")
    rows = [dict(row) for row in before.rows]
    names = [row["case"] for row in rows]
    assert len(names) == 2
    swapped = [row | {"case": name} for row, name in zip(reversed(rows), names, strict=True)]
    costs = [dict(cost) | {"case": name} for cost, name in zip(reversed(before.costs), names, strict=True)]
    found = compare_tables(before, replace(before, rows=swapped, costs=costs))
    assert not found.changed and found.matched == 2
    first = swapped[1] | {"case": names[0]}  # the second case alone, under the name of the first
    other = first | {"settlement.direction": [0.0, 1.0, 0.0], "case": names[1]}
    found = compare_tables(before, replace(before, rows=[rows[1] | {"case": names[0]}, other]))
    assert found.matched == 1 and found.only_before == [names[0]] and found.only_after == [f"{names[1]} (after)"]


def test_a_case_of_other_values_is_no_case_of_the_same_name(tmp_path: Path) -> None:
    before = campaign(tmp_path, "directions")
    after = changed(before, 1, **{"settlement.direction": [0.0, 1.0, 0.0]})
    found, name = compare_tables(before, after), str(before.rows[1]["case"])
    assert (found.matched, found.only_before, found.only_after) == (1, [name], [f"{name} (after)"])
    assert not found.changes


def test_a_table_that_has_more_keys_in_another_version_is_told_by_its_name(tmp_path: Path) -> None:
    before = campaign(tmp_path, "directions")
    tables = [{"direction": [0.0, 0.0, -1.0]}, {"direction": [1.0, 0.0, 0.0]}]

    def with_tables(more: dict[str, float]) -> CampaignTable:
        rows = [row | {"settlement": one | more} for row, one in zip(before.rows, tables, strict=True)]
        return replace(before, rows=rows, axes={"settlement": [row["settlement"] for row in rows]})

    found = compare_tables(with_tables({}), with_tables({"ratio": 1.0}))
    assert found.matched == 2 and not found.changed
