"""A run of a campaign keeps finished cases and reports failures. The results of the cases decide its exit code."""

import dataclasses
import json
import os
import signal
from argparse import Namespace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from campaigns import QUICK, Inline, begun, finished, run, sweep, written
from conftest import Silent
from faulty_runs import INTERRUPTED

from comparison.campaign import job, table
from comparison.campaign.cases import expand
from comparison.campaign.definition import load_campaign
from comparison.campaign.job import LOADED, OTHER_CODE, Job, failure, run_job
from comparison.campaign_result import read_campaign
from comparison.cli.commands import main
from comparison.cli.context import Context
from comparison.cli.study_verbs.campaign import MOST_WARNINGS, _warn
from comparison.errors import FolderInUseError
from comparison.run_folder import REPORTS, alone_in
from comparison.workflow.one_scene import read_results
from la_core.scene.scene import load_scene
from la_core.scene.shipped import find


def test_finished_cases_are_not_run_again_and_a_new_value_adds_its_own_alone(tmp_path: Path, plain_figures: None) -> None:
    out, engine = tmp_path / "out", Inline()
    first = run(QUICK, out, engine)
    bytes_before = (out / "results.csv").read_bytes()
    again = Inline()
    assert run(QUICK, out, again).rows == first.rows and again.done == []
    assert (out / "results.csv").read_bytes() == bytes_before
    longer = run(QUICK.replace("[0.4, 0.5]", "[0.4, 0.45, 0.5]"), out, again)
    assert again.done == ["two_pads_friction=0.45"]
    assert [row["case"] for row in longer.rows][2:] == [f"two_pads_friction={mu}" for mu in (0.4, 0.45, 0.5)]
    (out / "cases" / "two_blocks_friction=0.3" / "report.html").unlink()
    (out / "cases" / "two_blocks_friction=0.6" / "outcome.json").write_text("{}")
    repaired = Inline()
    assert run(QUICK, out, repaired).rows == first.rows
    assert repaired.done == ["two_blocks_friction=0.3", "two_blocks_friction=0.6"]


def test_a_case_that_missed_its_accuracy_is_run_again_where_a_larger_time_limit_allows_a_slower_run(
    tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`would_run_slower` decides, by the time limit of this call. The campaign asks it first, and the worker asks it again."""
    asked: list[float | None] = []

    def slower(folder: Path, limit: float | None) -> bool:
        asked.append(limit)
        return limit == 600.0 and folder.parent.name.endswith("0.4")

    text = sweep('vary = { "joint.friction" = [0.4, 0.5] }')
    run(text, tmp_path / "out")
    monkeypatch.setattr(job, "would_run_slower", slower)
    before = finished(tmp_path / "out")
    for limit, again in ((20.0, []), (600.0, ["two_pads_friction=0.4"])):
        engine = Inline()
        run(text, tmp_path / "out", engine, limit)
        after = finished(tmp_path / "out")
        assert engine.done == again == [name for name in after if after[name] != before[name]] and set(asked) == {limit}
        asked.clear()


@pytest.mark.slow_after_first
@pytest.mark.parametrize("damaged", ["report.html", "two_pads/case.h5", "two_pads/comparison.json", "two_pads/scene.toml"])
def test_a_case_whose_stored_files_were_cut_short_is_made_again(damaged: str, tmp_path: Path, plain_figures: None) -> None:
    """`crosscheck report` of such a case says that it has to be run again, so the campaign must not count it as finished."""
    text, out = sweep('vary = { "joint.friction" = [0.4, 0.5] }', "two_pads"), tmp_path / "out"
    first = run(text, out, Inline())
    file = out / "cases" / "two_pads_friction=0.4" / damaged
    whole = file.read_bytes()
    if file.suffix == ".toml":
        file.unlink()
    else:
        file.write_bytes(whole[: len(whole) // 2])
    repaired = Inline()
    assert run(text, out, repaired).rows == first.rows
    assert repaired.done == ["two_pads_friction=0.4"]
    assert file.stat().st_size > len(whole) // 2


def test_a_case_that_fails_is_told_with_its_reason_and_tried_again_by_the_next_call(
    tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    text = sweep('vary = { "effects.elasticity" = ["auto", "none"] }', "wall_low_friction")  # only the answer shows that joints slide
    monkeypatch.setattr("comparison.cli.study_verbs.campaign.Local", lambda workers, yade: Inline())
    assert main(["campaign", str(written(tmp_path, text)), "-o", str(out)]) == 3
    said = capsys.readouterr()
    assert "wall_low_friction_elasticity=none: failed: " in said.err and "effects.elasticity" in said.out
    done, failed = table.read_table(out).rows
    assert (done["state"], failed["state"]) == ("done", "failed")
    assert failed["reason"].startswith("wall_low_friction.toml: effects.elasticity")  # the folder of the program is left out
    assert table.read_table(out).failures == [failed]
    again = Inline()
    run(text, out, again)
    assert again.done == ["wall_low_friction_elasticity=none"]


def test_no_path_of_this_machine_is_in_a_reason(tmp_path: Path) -> None:
    scene = load_scene(find("two_pads"))
    own = Job(scene, tmp_path / "case", False, {}, "", LOADED)
    beside = dataclasses.replace(own, scene=dataclasses.replace(scene, path=Path("mine.toml")))
    reason = f"{own.folder}/two_pads/case.h5: of {scene.path}"
    assert failure(reason, own)["answers"]["reason"] == "two_pads/case.h5: of two_pads.toml"
    assert failure("a. b/c. d", beside)["answers"]["reason"] == "a. b/c. d"


@pytest.mark.slow
def test_what_another_version_would_make_is_not_stored_as_this_one_s(
    tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"

    def install(at: Job) -> None:
        if len(begun(out)) == 2:
            monkeypatch.setattr(job, "code", lambda: "newer")

    found = run(QUICK, out, Inline(install))
    assert [row["state"] for row in found.rows] == ["done", "done", "failed", "failed"]
    assert [row["reason"] for row in found.failures] == [OTHER_CODE] * 2
    assert len(finished(out)) == 2 and not list(out.glob("cases/two_pads*/two_pads"))
    monkeypatch.undo()
    again = Inline()
    assert [row["state"] for row in run(QUICK, out, again).rows] == ["done"] * 4 and len(again.done) == 2


def test_a_worker_that_loaded_another_version_stores_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(job, "LOADED", "older")
    outcome = run_job(Job(load_scene(find("two_pads")), tmp_path / "case", False, {}, "", LOADED), Silent())
    assert (outcome["state"], outcome["answers"]["reason"]) == ("failed", OTHER_CODE)
    assert not (tmp_path / "case").exists()


@pytest.mark.slow
def test_without_yade_a_run_of_an_earlier_call_is_not_told(tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch) -> None:
    def with_a_run(*place: Any) -> SimpleNamespace:
        results = read_results(*place)
        twists = results.analysis.bounds[results.analysis.main].twists
        return SimpleNamespace(scene=results.scene, analysis=results.analysis, run=SimpleNamespace(mechanism=lambda: twists))

    run(QUICK, tmp_path / "fresh" / "out")
    monkeypatch.setattr(job, "read_results", with_a_run)
    found = run(QUICK, tmp_path / "used" / "out")
    assert found.rows[0]["associated_mechanism"] and found.rows[0]["yade_mechanism"] is None
    assert (tmp_path / "used/out/results.csv").read_bytes() == (tmp_path / "fresh/out/results.csv").read_bytes()


@pytest.mark.parametrize(
    ("verdicts", "code"),
    [(["agree"], 0), (["agree", None], 0), (["agree", "inconclusive"], 4), (["inconclusive", "disagree"], 1), (["disagree", "failed"], 3)],
)
def test_the_most_severe_case_decides_the_exit_code(verdicts: list[str | None], code: int, tmp_path: Path) -> None:
    from comparison.cli.study_verbs.campaign import exit_code

    rows = [{"state": "failed", "verdict": None} if verdict == "failed" else {"state": "done", "verdict": verdict} for verdict in verdicts]
    assert exit_code(table.CampaignTable("", {}, rows, [], {}, tmp_path)) == code


def test_the_command_prints_its_table_or_one_json_object_and_nothing_else(
    tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("comparison.cli.study_verbs.campaign.Local", lambda workers, yade: Inline())
    command = ["campaign", str(written(tmp_path, QUICK)), "-o", str(tmp_path / "out")]
    assert main([*command, "--json", "-q"]) == 0
    said = capsys.readouterr()
    found = json.loads(said.out)
    assert said.err == "" and [row["case"] for row in found["rows"]] == sorted(begun(tmp_path / "out"))
    assert main(command) == 0
    said = capsys.readouterr()
    assert "4 of them finished before" in said.err and "4 cases: 3 not compared, 1 expected value met" in said.out and "0.36765" in said.out


def test_a_case_s_folder_is_one_of_crosscheck_run(tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    row = run(QUICK, out).rows[0]
    assert main(["report", str(out / row["folder"]), "-q"]) == 0
    assert "two_blocks" in capsys.readouterr().out


@pytest.mark.slow
def test_what_is_implausible_is_told_once_with_its_first_case(
    tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    text = QUICK.replace('"joint.friction" = [0.3, 0.6]', '"joint.friction" = [0.3, 31.0], "joint.inset" = [0.001, 0.002]')
    main(["campaign", str(written(tmp_path, text)), "-o", str(tmp_path / "out"), "-q"])
    [told] = [line for line in capsys.readouterr().err.splitlines() if line.startswith("warning: ")]
    assert told.startswith("warning: two_blocks_friction=31.0_inset=0.001 and 1 more case: joint.friction = 31 is above 1.2, but")


def test_of_many_warnings_the_first_are_told_and_the_others_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    frictions = [float(angle) for angle in range(30, 43)]
    path = written(tmp_path, QUICK.replace("[0.3, 0.6]", str(frictions)))
    _warn(expand(load_campaign(path)), Context.of(Namespace(quiet=True)))
    told = [line for line in capsys.readouterr().err.splitlines() if line.startswith("warning: ")]
    assert len(told) == MOST_WARNINGS + 1
    assert told[-1].startswith(f"warning: {len(frictions) - MOST_WARNINGS} more warnings: the reports")


def test_two_campaigns_in_one_folder_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    out.mkdir()
    with alone_in(out):
        assert main(["campaign", str(written(tmp_path, QUICK)), "-o", str(out), "-q"]) == 3
    assert "in use by another crosscheck process" in capsys.readouterr().err


def test_a_stop_keeps_the_table_of_what_was_finished(tmp_path: Path, plain_figures: None) -> None:
    out = tmp_path / "out"

    def interrupt(job) -> None:
        if len(begun(out)) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(QUICK, out, Inline(interrupt))
    assert [row["case"] for row in table.read_table(out).rows] == begun(out)
    again = Inline()
    assert len(run(QUICK, out, again).rows) == 4 and len(again.done) == 2


@pytest.mark.slow
def test_no_table_of_an_earlier_run_outlives_the_start_of_cases_that_run_again(tmp_path: Path, plain_figures: None) -> None:
    """A kill or a power cut left the results of the earlier scene, which looked complete."""
    out = tmp_path / "out"
    run(QUICK, out)
    for result in out.glob("cases/*/*/comparison.json"):
        result.unlink()
    left: list[int] = []
    run(QUICK, out, Inline(lambda _: left.append(len(table.read_table(out).rows))))
    assert left[0] == 0 and len(table.read_table(out).rows) == 4


def test_the_report_writes_damaged_and_missing_tables_again(
    tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    run(QUICK, out)
    tables = {name: (out / name).read_bytes() for name in ("results.csv", "costs.csv", "campaign.h5", "campaign.json")}
    (out / "results.csv").write_bytes(b"case,sweep\n")
    (out / "costs.csv").unlink()
    (out / "campaign.h5").write_bytes(tables["campaign.h5"][:1000])
    assert main(["report", str(out), "-q"]) == 0
    assert {name: (out / name).read_bytes() for name in tables} == tables
    capsys.readouterr()


@pytest.mark.slow_after_first
@pytest.mark.parametrize("ended", [0, 1, pytest.param(2, marks=pytest.mark.slow)])
def test_the_report_of_an_interrupted_campaign_tells_of_the_cases_that_ended_and_says_that_others_are_missing(
    ended: int, tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    for name in REPORTS:
        (out / name).write_text("the report of an earlier call")

    def interrupt(at: Job) -> None:
        assert not any((out / name).exists() for name in REPORTS)
        if len(begun(out)) == ended:
            raise KeyboardInterrupt

    monkeypatch.setattr("comparison.cli.study_verbs.campaign.Local", lambda workers, yade: Inline(interrupt))
    assert main(["campaign", str(written(tmp_path, QUICK)), "-o", str(out), "-q"]) == INTERRUPTED
    assert len(table.read_table(out).rows) == ended == len(json.loads((out / "report.json").read_text())["rows"])
    words = f"{ended} of 4 cases {'has' if ended == 1 else 'have'} ended; run the campaign again to go on."
    assert all(words in (out / name).read_text(encoding="utf-8") for name in ("report.html", "report.md"))
    assert "Numbers are ." not in (out / "report.md").read_text(encoding="utf-8")
    assert words.rstrip(".") in str(read_campaign(out))
    capsys.readouterr()
    assert main(["report", str(out)]) == 0
    said = capsys.readouterr().out
    assert words in said and "cases: \n" not in said
    assert main(["compare", str(out), str(out)]) == 0
    assert f"The campaign after was interrupted: {words}" in " ".join(capsys.readouterr().out.split())
    run(QUICK, out)
    assert table.read_table(out).unfinished == read_campaign(out).unfinished == ""


def test_a_campaign_killed_before_its_first_table_is_told_how_to_go_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "campaign.toml").touch()
    assert main(["report", str(tmp_path)]) == 2
    assert "holds a campaign that was ended before its first table" in capsys.readouterr().err
    with alone_in(tmp_path):
        assert main(["report", str(tmp_path)]) == 3
    assert "a campaign is running there and has no table yet; wait" in capsys.readouterr().err


def test_a_request_to_end_is_an_interruption_to_a_campaign_and_to_nothing_else(
    tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"

    def end(at: Job) -> None:
        if len(begun(out)) == 2:
            os.kill(os.getpid(), signal.SIGTERM)

    monkeypatch.setattr("comparison.cli.study_verbs.campaign.Local", lambda workers, yade: Inline(end))
    elsewhere: list[int] = []
    before = signal.signal(signal.SIGTERM, lambda number, frame: elsewhere.append(number))
    try:
        assert main(["campaign", str(written(tmp_path, QUICK)), "-o", str(out), "-q"]) == INTERRUPTED
        assert elsewhere == [] and "error: stopped" in capsys.readouterr().err
        assert [row["case"] for row in table.read_table(out).rows] == begun(out)
        os.kill(os.getpid(), signal.SIGTERM)
        assert elsewhere == [signal.SIGTERM]
    finally:
        signal.signal(signal.SIGTERM, before)


def test_the_report_is_written_while_the_folder_is_held(tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch) -> None:
    def conclude(found: table.CampaignTable) -> None:
        with pytest.raises(FolderInUseError), alone_in(found.folder):
            pass
        concluded.append(len(found.rows))

    concluded: list[int] = []
    monkeypatch.setattr("comparison.cli.study_verbs.campaign.Local", lambda workers, yade: Inline())
    monkeypatch.setattr("comparison.cli.study_verbs.campaign.write_campaign_report", conclude)
    assert main(["campaign", str(written(tmp_path, QUICK)), "-o", str(tmp_path / "out"), "-q"]) == 0
    assert concluded == [4]
