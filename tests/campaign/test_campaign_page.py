"""The pages of a campaign show every case, every link leads somewhere, and no undefined value is shown as a number."""

import base64
import json
import math
import re
from dataclasses import replace
from pathlib import Path
from urllib.parse import unquote

import pytest
from made_up_campaigns import FRICTIONS, MU, Page, campaign, changed, every_shape

from comparison.campaign.mechanism_changes import letters, mechanism_changes_along
from comparison.campaign.report import rows as report_rows
from comparison.campaign.report.report import write_campaign_report
from comparison.campaign.report.verdict_matrix import FAILURE, matrix_panels
from comparison.campaign.row_groups import sweeps_of
from comparison.campaign.table import CampaignTable, write_campaign
from comparison.cli.commands import main
from comparison.cli.exit_codes import TOOL
from comparison.verdict import VERDICTS

pytestmark = pytest.mark.slow


def page_anchors(text: str) -> set[str]:
    return {"#" + part.split('"')[0] for part in text.split(' id="')[1:]}


@every_shape
def test_the_matrix_has_a_cell_for_every_case(shape: str, tmp_path: Path) -> None:
    table = campaign(tmp_path, shape)
    found = matrix_panels(table)
    cells = [cell for panel in found for _, places in panel.rows for cell_list in places for cell in cell_list]
    assert sorted(cell.case for cell in cells) == sorted(row["case"] for row in table.rows)
    assert all(cell.href and (tmp_path / unquote(cell.href)).is_file() for cell in cells)
    assert all(len(places) == len(panel.columns) for panel in found for _, places in panel.rows)


@pytest.mark.parametrize("lost", [0, 1])
def test_the_signs_of_the_cases_are_explained_and_no_others(lost: int, tmp_path: Path) -> None:
    table = campaign(tmp_path, "two axes")
    table = changed(table, 0, state="failed", verdict=None) if lost else table
    write_campaign_report(table)
    cells = [cell for panel in matrix_panels(table) for _, places in panel.rows for some in places for cell in some]
    shown = {(cell.symbol, cell.word) for cell in cells}
    assert (FAILURE in shown) == bool(lost) and len(shown) < len(VERDICTS)
    for page in ("report.html", "report.md"):
        legend = next(line for line in (tmp_path / page).read_text(encoding="utf-8").splitlines() if "Every cell is a link" in line)
        assert {(sign, word) for sign, word in (*VERDICTS.values(), FAILURE) if f"{sign} {word}" in legend} == shown


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


def test_a_screen_reader_is_told_what_each_heading_heads_and_each_cell_means(tmp_path: Path) -> None:
    text = write_campaign_report(campaign(tmp_path, "two axes")).read_text(encoding="utf-8")
    headings, cells = re.findall(r"<th\b[^>]*>", text), re.findall(r'<(?:a|span) class="cell [^>]*>', text)
    assert all("scope=" in heading for heading in headings) and cells and all("aria-label=" in cell for cell in cells)


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


def test_a_campaign_whose_page_cannot_be_written_or_that_cannot_be_read_keeps_no_other_one_from_its_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folders = [tmp_path / name for name in ("closed", "damaged", "whole")]
    for folder in folders:
        write_campaign(campaign(folder, "one case"))
    (folders[0] / "figures").symlink_to(tmp_path)
    (folders[1] / "campaign.json").write_text("{}")
    assert main(["report", *map(str, folders), "-q"]) == TOOL
    said = capsys.readouterr()
    assert f"{folders[0] / 'figures'}: is a symbolic link" in said.err and f"{folders[1] / 'campaign.json'}: changed or" in said.err
    assert said.err.count("error: ") == 2 and said.out.count("1 case: 1 agree") == 1 and (folders[2] / "report.html").is_file()
    assert main(["report", *map(str, folders), "-q", "--json"]) == TOOL
    assert [report["counts"] for report in json.loads(capsys.readouterr().out)["reports"]] == [{"agree": 1}] * 2


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


def test_every_mechanism_has_a_picture_from_a_case_that_has_it(tmp_path: Path) -> None:
    table = campaign(tmp_path, "two axes")
    lettered = letters(sweeps_of(table))
    assert not list(report_rows.mechanism_pictures(table, lettered))  # no case has a picture yet
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


def test_the_report_shows_the_uncertainty_of_a_prediction_where_it_is_stated(tmp_path: Path) -> None:
    table = changed(campaign(tmp_path), 0, coulomb_uncertainty=3.0, coulomb_plateaus=2)
    write_campaign_report(table)
    for name in ("report.html", "report.md"):
        text = (tmp_path / name).read_text(encoding="utf-8")
        assert text.count(" ± 0.003") == text.count("one of 2 plateaus") == 1


def test_words_for_a_head_that_a_campaign_s_page_does_not_have_are_warned_of(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = campaign(tmp_path / "one", "one case")
    write_campaign(table)
    assert main(["report", str(table.folder), "-q", "--title", "Town hall", "--author", "A. Mason"]) == 0
    assert "warning: --title, --author: without effect" in capsys.readouterr().err
    assert main(["report", str(table.folder), "-q"]) == 0
    assert capsys.readouterr().err == ""


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


def test_a_mechanism_of_the_associated_answer_has_no_picture_where_the_case_draws_the_prediction(tmp_path: Path) -> None:
    table = campaign(tmp_path, "one axis")
    table = changed(table, 0, associated_mechanism="7-other")
    for row in table.rows:
        place = tmp_path / str(row["folder"]) / "scene"
        place.mkdir(parents=True, exist_ok=True)
        (place / "mechanisms.png").write_bytes(b"a picture")
    captions = [str(picture["caption"]) for picture in report_rows.mechanism_pictures(table, letters(sweeps_of(table)))]
    assert captions and not any("associated" in caption for caption in captions)
    alone = changed(table, 0, coulomb_mechanism=None, associated_mechanism="7-other")
    captions = [str(picture["caption"]) for picture in report_rows.mechanism_pictures(alone, letters(sweeps_of(alone)))]
    assert any("associated" in caption for caption in captions)


def test_directions_stand_in_the_order_of_the_file(tmp_path: Path) -> None:
    table = campaign(tmp_path, "directions")
    given = [[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]]  # sorted as texts, the second would come first
    rows = [row | {"settlement.direction": value} for row, value in zip(table.rows, given, strict=True)]
    (panel,) = matrix_panels(replace(table, rows=rows, axes={"settlement.direction": given}))
    assert panel.columns == ["(0, 0, −1)", "(−1, 0, 0)"]


def test_a_campaign_without_yade_tells_of_no_disagreement_and_a_mechanism_has_the_masses_of_all_its_cases(tmp_path: Path) -> None:
    table = campaign(tmp_path, "two axes")
    rows = [row | {"coulomb_mechanism": "1-a", "coulomb_moving_mass": 0.1 + 0.05 * (i % 2)} for i, row in enumerate(table.rows)]
    write_campaign_report(replace(table, rows=[row | {"yade": None, "yade_mechanism": None} for row in rows]))
    for page in ("report.html", "report.md"):
        text = (tmp_path / page).read_text(encoding="utf-8")
        assert "worst disagreement" not in text and "Cases are sorted" not in text and "0.100 to 0.150" in text
    write_campaign_report(replace(table, rows=rows))
    assert "the worst disagreement first" in (tmp_path / "report.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("status", [None, "missing"])
def test_the_captions_of_a_campaign_without_yade_are_of_limit_analysis_alone(status: str | None, tmp_path: Path) -> None:
    table = campaign(tmp_path, "two axes")
    of_yade = {name: None for name in table.rows[0] if name.startswith("yade")} | {"yade_status": status}
    alone = replace(table, rows=[row | of_yade for row in table.rows], costs=[row | {"yade_seconds": None} for row in table.costs])
    told = {True: ("YADE with its uncertainty", "hatched where", "Both methods against"), False: ("Limit analysis against",)}
    for ran_yade, one in ((True, table), (False, alone)):
        text = write_campaign_report(one).read_text(encoding="utf-8")
        assert all(words in text for words in told[ran_yade]) and not any(words in text for words in told[not ran_yade])


def test_a_campaign_of_one_worker_is_not_said_to_have_run_several_cases_at_a_time(tmp_path: Path) -> None:
    text = write_campaign_report(campaign(tmp_path, "one case")).read_text(encoding="utf-8")
    assert "on how many cases it ran at a time" in text and "which ran several cases" not in text
