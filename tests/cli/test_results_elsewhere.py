"""Results that were moved, copied or made by another version: the report still says when, by what and from which files they were made."""

import hashlib
import json
import os
import shutil
from pathlib import Path

import pytest

from comparison import provenance
from comparison.cli.commands import main
from la_core import exchange


def stored(folder: Path, scene: str = "two_pads") -> dict[str, object]:
    return dict(json.loads((folder / scene / "comparison.json").read_text(encoding="utf-8")))


@pytest.fixture
def results(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Results of version 1.2.3, with figures."""
    monkeypatch.setattr(provenance, "version", lambda: "1.2.3")
    assert main(["run", "two_pads", "-o", str(tmp_path / "out"), "--no-yade", "-q"]) == 0
    monkeypatch.undo()
    return tmp_path / "out"


def test_a_renamed_folder_of_a_scene_keeps_its_figures_and_has_its_own_name(results: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (results / "two_pads").rename(results / "pads of May")
    capsys.readouterr()
    assert main(["report", str(results)]) == 0
    said, page = capsys.readouterr(), (results / "report.html").read_text(encoding="utf-8")
    assert "pads of May" in said.out and "other scene" not in said.err
    assert page.count("<img") >= 3 and "viewer-data" in page
    (told,) = json.loads((results / "report.json").read_text(encoding="utf-8"))["comparisons"]
    assert told["scene"] == "pads of May" and stored(results, "pads of May")["scene"] == "two_pads"


def test_the_date_of_a_report_is_that_of_its_results_and_not_of_their_copy(results: Path) -> None:
    made = exchange.made_by(results / "two_pads" / "case.h5")[exchange.TIME]
    copy = shutil.copytree(results, results.with_name("copy"))
    os.utime(copy / "two_pads" / "case.h5", (2e9, 2e9))
    assert main(["report", str(copy), "-q"]) == 0
    assert f"- date: {made[:10]}\n" in (copy / "report.md").read_text(encoding="utf-8") and "2033" not in made


def test_results_keep_the_versions_that_made_them(results: Path) -> None:
    (results / "two_pads" / "comparison.json").unlink()
    assert main(["report", str(results), "-q"]) == 0
    made = stored(results)["provenance"]
    assert isinstance(made, dict) and made["crosscheck"] == "1.2.3" and exchange.TIME not in made
    page = (results / "report.html").read_text(encoding="utf-8")
    assert "Crosscheck 1.2.3, solver Clarabel" in page and "Provenance of this scene" in page


def test_versions_that_are_unknown_are_not_those_of_today(results: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As with a file of version 0.2.0 whose comparison is lost."""
    monkeypatch.setattr(exchange, "made_by", lambda path: {})
    (results / "two_pads" / "comparison.json").unlink()
    assert main(["report", str(results), "-q"]) == 0
    assert stored(results)["provenance"] == {} and "Crosscheck" not in (results / "report.md").read_text(encoding="utf-8")


def test_another_verdict_on_the_same_results_is_told(
    results: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("comparison.workflow.one_scene.check_expected", lambda analysis: [])
    monkeypatch.setattr("comparison.workflow.one_scene.COMPARISON_CODE", ())  # as with other code
    capsys.readouterr()
    assert main(["report", str(results)]) == 0
    assert "two_pads: comparison: not compared; the same results were judged before: expected value met" in " ".join(
        capsys.readouterr().err.split()
    )


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
        assert digest in page and f"| SHA-256 of {name} | {digest} |" in markdown
    assert "and the files that it reads the calculation can be repeated" in page


def test_a_file_says_by_what_it_was_made_and_when(tmp_path: Path) -> None:
    path = tmp_path / "case.h5"
    exchange.write(path, (), {}, "inputs", {"crosscheck": "1"})
    assert exchange.made_by(path)["crosscheck"] == "1" and exchange.made_by(tmp_path / "none.h5") == {}
