"""For results that were moved, copied or made by another version, the report still states their time, program and input files."""

import hashlib
import json
import os
import shutil
from pathlib import Path

import pytest

from comparison import provenance
from comparison.cli.arguments import parser
from comparison.cli.commands import main
from comparison.cli.conclude import conclude
from comparison.cli.context import Context
from la_core import exchange
from la_core.exchange import hdf5

BEFORE = Path(__file__).parents[1] / "helpers" / "stored_0_2_0"  # results of `crosscheck run two_pads`, without figures


def stored(folder: Path, scene: str = "two_pads") -> dict[str, object]:
    return dict(json.loads((folder / scene / "comparison.json").read_text(encoding="utf-8")))


@pytest.fixture
def results(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Results of version 1.2.3, with figures."""
    monkeypatch.setattr(provenance, "version", lambda: "1.2.3")
    assert main(["run", "two_pads", "-o", str(tmp_path / "out"), "--no-yade", "-q", "--project", "Bridge 7"]) == 0
    monkeypatch.undo()
    return tmp_path / "out"


def test_a_renamed_folder_of_a_scene_keeps_its_figures_and_has_its_own_name(results: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (results / "two_pads").rename(results / "pads of May")
    capsys.readouterr()
    assert main(["report", str(results)]) == 0
    said, page = capsys.readouterr(), (results / "report.html").read_text(encoding="utf-8")
    assert "pads of May" in said.out and not {"other", "loses"} & set(said.err.split())
    assert page.count("<img") >= 3 and "viewer-data" in page
    (told,) = json.loads((results / "report.json").read_text(encoding="utf-8"))["comparisons"]
    assert (told["folder"], told["scene"]) == ("pads of May", "two_pads") and "folder" not in stored(results, "pads of May")
    assert "- project: Bridge 7\n" in (results / "report.md").read_text(encoding="utf-8")


def test_the_date_of_a_report_is_that_of_its_results_and_not_of_their_copy(results: Path) -> None:
    made = exchange.made_by(results / "two_pads" / "case.h5")[exchange.MADE_AT]
    copy = shutil.copytree(results, results.with_name("copy"))
    os.utime(copy / "two_pads" / "case.h5", (2e9, 2e9))
    assert main(["report", str(copy), "-q"]) == 0
    assert f"- date: {made[:10]}\n" in (copy / "report.md").read_text(encoding="utf-8") and "2033" not in made


def test_results_keep_the_versions_that_made_them(results: Path) -> None:
    (results / "two_pads" / "comparison.json").unlink()
    assert main(["report", str(results), "-q"]) == 0
    made = stored(results)["provenance"]
    assert isinstance(made, dict) and made["crosscheck"] == "1.2.3" and exchange.MADE_AT not in made
    page = (results / "report.html").read_text(encoding="utf-8")
    assert "Crosscheck 1.2.3, solver Clarabel" in page and "Provenance of this scene" in page


@pytest.mark.slow
def test_versions_and_dates_that_are_unknown_are_not_those_of_today(tmp_path: Path) -> None:
    """HDF5 files of version 0.2.0 state neither version nor date. The comparison beside them states the versions."""
    out = shutil.copytree(BEFORE, tmp_path / "out")
    versions = stored(out)["provenance"]
    assert main(["report", str(out), "-q"]) == 0
    assert stored(out)["provenance"] == versions and "- date" not in (out / "report.md").read_text(encoding="utf-8")
    (out / "two_pads" / "comparison.json").unlink()
    assert main(["report", str(out), "-q"]) == 0
    assert stored(out)["provenance"] == {} and "Crosscheck" not in (out / "report.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("time", ["yesterday", "2026-11-30T08:00:00", None])
def test_a_time_that_is_none_is_no_date(time: str | None, results: Path) -> None:
    """A time must have a zone, so that the times of two files can be compared."""
    case = results / "two_pads" / "case.h5"
    exchange.write(case, (), {}, "", {})
    made = json.dumps({"crosscheck": "1", exchange.MADE_AT: time})
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(hdf5.json, "dumps", lambda values: made)
        exchange.write(case, (), {}, "")
    assert exchange.made_by(case) == {}


def test_a_second_attempt_decides_whatever_the_folders_are_called(results: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The scene's name identifies the first attempt; a renamed folder does not change it."""
    first = stored(results) | {"verdict": "inconclusive", "next_step": "do this", "reason": "in doubt", "folder": "first try"}
    second = stored(results) | {"scene": "two_pads_harder", "folder": "second try"}
    second["first_verdict"] = {"scene": "two_pads", "verdict": "inconclusive", "reason": "in doubt"}
    context = Context.of(parser().parse_args(["report", str(results)]))
    assert conclude([(results, [first, second])], context) == 0
    said = capsys.readouterr().out
    assert "first try: in doubt" in said and "do this" not in said and "second try" in said


def test_another_verdict_on_the_same_results_is_told(
    results: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("comparison.workflow.one_scene.check_expected", lambda analysis: [])
    monkeypatch.setattr("comparison.workflow.one_scene.COMPARISON_CODE", ())  # as if the code were different
    capsys.readouterr()
    assert main(["report", str(results)]) == 0
    said = " ".join(capsys.readouterr().err.split())
    assert "two_pads: comparison: not compared; the same results were judged before: expected value met" in said


def test_the_report_names_every_file_of_the_calculation_with_its_digest(tmp_path: Path) -> None:
    drawing = b'<svg xmlns="http://www.w3.org/2000/svg" width="2000" height="1000"><g id="blocks">%s</g></svg>' % b"".join(
        b'<rect x="%d" y="%d" width="%d" height="400"/>' % place for place in ((0, 500, 1000), (1000, 500, 1000), (500, 100, 1000))
    )
    (tmp_path / "wall.svg").write_bytes(drawing)
    assert main(["new", "--from", str(tmp_path / "wall.svg"), "-o", str(tmp_path / "wall.toml"), "-q"]) == 0
    assert main(["run", str(tmp_path / "wall.toml"), "-o", str(tmp_path / "out"), "--no-yade", "-q"]) in (0, 4, 5)
    files = {name: hashlib.sha256((tmp_path / "out" / "wall" / name).read_bytes()).hexdigest() for name in ("scene.toml", "wall.svg")}
    page, markdown = ((tmp_path / "out" / name).read_text(encoding="utf-8") for name in ("report.html", "report.md"))
    for name, digest in files.items():
        assert digest in page and f"| SHA-256 of the copy of {name} | {digest} |" in markdown
    assert "and the files that it reads the calculation can be repeated" in page


def test_a_file_says_by_what_it_was_made_and_when(tmp_path: Path) -> None:
    path = tmp_path / "case.h5"
    exchange.write(path, (), {}, "inputs", {"crosscheck": "1"})
    assert exchange.made_by(path)["crosscheck"] == "1" and exchange.made_by(tmp_path / "none.h5") == {}
