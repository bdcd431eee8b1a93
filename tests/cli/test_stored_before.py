"""Results that version 0.2.0 stored are read as they are, or made again with a message. They are never misread."""

import json
import shutil
from pathlib import Path

import pytest

from comparison.cli.commands import main
from comparison.cli.exit_codes import AGREE
from comparison.numbers import Units
from comparison.report.scene_view import view_of_scene
from comparison.workflow.one_scene import LIVE_WITHOUT_YADE, _sum_of
from comparison.yade import read_results

BEFORE = Path(__file__).parents[1] / "helpers" / "stored_0_2_0"  # results of `crosscheck run two_pads`, without figures


@pytest.fixture
def stored(tmp_path: Path) -> Path:
    return Path(shutil.copytree(BEFORE, tmp_path / "results"))


def test_both_methods_results_are_read_value_by_value(stored: Path) -> None:
    before = json.loads((BEFORE / "two_pads" / "comparison.json").read_text(encoding="utf-8"))
    results = read_results(stored / "two_pads")
    associated, coulomb = before["limit_analysis"]["associated"], before["limit_analysis"]["coulomb"]
    assert results.analysis.bounds[results.analysis.main].value == associated["reaction"]
    assert results.analysis.sharp.bounds[results.analysis.main].value == associated["reaction_sharp"]
    assert results.analysis.coulomb is not None and results.analysis.coulomb.value == coulomb["reaction"]
    assert list(results.analysis.coulomb.interval) == coulomb["reaction_interval"]
    for name, value in before["yade"].items():
        assert getattr(results.recorded.result, name) == value


def test_what_was_a_dictionary_is_read_as_one(stored: Path) -> None:
    """The three parts of YADE's record have attributes today. Scripts for version 0.2.0 read them by name and iterate over names."""
    run = read_results(stored / "two_pads").recorded
    assert run is not None
    for part in (run.result, run.record, run.poses):
        assert list(part) == list(part.keys()) == list(dict(part)) and "settlement" in part and "sediment" not in part
        for (name, value), same in zip(part.items(), part.values(), strict=True):
            assert value is same is part[name] is getattr(part, name)
        with pytest.raises(KeyError, match="sediment"):
            part["sediment"]


def test_the_report_says_of_them_what_it_said(stored: Path, plain_figures: None) -> None:
    assert main(["report", str(stored), "-q"]) == AGREE
    before, now = (json.loads((folder / "two_pads" / "comparison.json").read_text(encoding="utf-8")) for folder in (BEFORE, stored))
    for part in ("verdict", "weight", "mechanism_measures"):
        assert now[part] == before[part]
    assert {key: now["yade"][key] for key in before["yade"]} == before["yade"]  # newer versions add keys
    for law in ("associated", "coulomb"):  # newer versions add keys
        then, today = (summary["limit_analysis"][law] for summary in (before, now))
        assert {key: today[key] for key in then} == then
    assert now["limit_analysis"]["coulomb"]["uncertainty"] is None
    for then, today in zip(before["checks"], now["checks"], strict=True):  # one method meets an expected value: no agreement
        said = "expected" if then["name"].startswith("expected") else then["verdict"]
        assert (today["name"], today["verdict"]) == (then["name"], said)


def test_a_report_takes_results_that_do_not_say_why_rotations_are_small(stored: Path) -> None:
    """Where joints slide, the report gives the reason for small rotations. Version 0.2.0 had no other rotations and stored no reason."""
    before = json.loads((BEFORE / "two_pads" / "comparison.json").read_text(encoding="utf-8"))
    effects = before["effects"] | {"friction": "coulomb", "rotation": "small"}
    assert "rotation" not in effects["reasons"]
    assert view_of_scene(stored, 1, before | {"effects": effects}, Units(before["weight"]))["notes"] == []
    effects["reasons"]["rotation"] = "nothing turns"
    assert view_of_scene(stored, 1, before | {"effects": effects}, Units(before["weight"]))["notes"] == [
        "Rotations of the blocks are small: nothing turns."
    ]


def test_a_stored_note_that_yade_cannot_run_live_loads_is_left_out(stored: Path, plain_figures: None) -> None:
    """The note stood beside every live load. A note that is still true is kept."""
    path = stored / "two_pads" / "comparison.json"
    for notes, kept in (([LIVE_WITHOUT_YADE], []), ([LIVE_WITHOUT_YADE, "kept"], ["kept"])):
        summary = json.loads(path.read_text(encoding="utf-8")) | {"notes": notes, "inputs": "older"}
        path.write_text(json.dumps(summary | {"sum": _sum_of(summary)}), encoding="utf-8")
        assert main(["report", str(stored), "-q"]) == AGREE
        assert json.loads(path.read_text(encoding="utf-8"))["notes"] == kept


def test_a_new_run_makes_them_again_and_says_so(stored: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]) -> None:
    """The code has changed since, so the results of version 0.2.0 do not count as cached."""
    assert main(["run", "two_pads", "--no-yade", "-o", str(stored)]) == AGREE
    narrated = capsys.readouterr().err
    assert "limit analysis: running" in narrated and "cached" not in narrated
    assert not (stored / "two_pads" / "run.h5").exists()
