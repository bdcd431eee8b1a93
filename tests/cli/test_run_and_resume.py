"""`crosscheck run` writes every file, reuses it later, and makes changed, damaged or missing files again."""

import json
import os
from pathlib import Path

import pytest
from faulty_runs import one_message

from comparison.cli.commands import main
from comparison.settings import HARDER_SECONDS
from la_core.scene import shipped


def test_run_without_yade_writes_every_file_and_then_finds_it_cached(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert main(["run", "two_pads", "-o", str(out), "--no-yade"]) == 0
    assert "report.html" in capsys.readouterr().out
    for name in ("two_pads/scene.toml", "two_pads/case.h5", "two_pads/comparison.json", "report.html", "report.md", "report.json"):
        assert (out / name).exists(), name
    summary = json.loads((out / "two_pads" / "comparison.json").read_text())
    assert summary["yade"] is None and summary["verdict"] == "expected"
    before = (out / "two_pads" / "case.h5").stat().st_mtime_ns
    assert main(["run", "two_pads", "-o", str(out), "--no-yade"]) == 0
    assert capsys.readouterr().err.count("cached") == 2
    assert (out / "two_pads" / "case.h5").stat().st_mtime_ns == before
    assert main(["report", str(out)]) == 0


def test_a_changed_scene_is_solved_again(tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]) -> None:
    path, out = tmp_path / "mine.toml", tmp_path / "out"
    text = shipped.find("two_pads").read_text().split("[expected]")[0]
    path.write_text(text)
    assert main(["run", str(path), "-o", str(out), "--no-yade"]) == 0
    path.write_text(text.replace("density = 2200.0", "density = 1100.0"))
    capsys.readouterr()
    assert main(["run", str(path), "-o", str(out), "--no-yade"]) == 0
    assert "cached" not in capsys.readouterr().err
    assert json.loads((out / "mine" / "comparison.json").read_text())["weight"] == pytest.approx(1079.1)


def test_a_half_written_case_is_recognised_and_redone(tmp_path: Path, plain_figures: None) -> None:
    out = tmp_path / "out"
    assert main(["run", "two_pads", "-o", str(out), "--no-yade", "-q"]) == 0
    case = out / "two_pads" / "case.h5"
    case.write_bytes(case.read_bytes()[: case.stat().st_size // 2])
    assert main(["run", "two_pads", "-o", str(out), "--no-yade", "-q"]) == 0
    assert json.loads((out / "two_pads" / "comparison.json").read_text())["verdict"] == "expected"


def test_without_yade_on_the_machine_limit_analysis_is_kept_and_the_exit_code_is_3(
    tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CROSSCHECK_YADE", str(tmp_path / "nowhere"))
    out = tmp_path / "out"
    assert main(["run", "two_pads", "-o", str(out)]) == 3
    captured = capsys.readouterr()
    assert "apt-get install yade python3-h5py" in captured.err
    summary = json.loads((out / "two_pads" / "comparison.json").read_text())
    assert summary["limit_analysis"]["associated"]["status"] == "solved"
    assert summary["yade"]["status"] == "missing" and summary["verdict"] == "inconclusive"
    assert main(["doctor"]) == 3
    assert "apt-get install yade" in capsys.readouterr().out


def test_a_broken_case_does_not_keep_the_others_from_the_report(
    tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main(["run", "two_pads", "trilith", "-o", str(out), "--no-yade", "-q"]) == 0
    (out / "trilith" / "case.h5").write_bytes(b"not HDF5")
    capsys.readouterr()
    assert main(["report", str(out), "--json"]) == 3
    captured = capsys.readouterr()
    assert [c["scene"] for c in json.loads(captured.out)["comparisons"]] == ["two_pads"]
    assert "trilith" in captured.err


@pytest.mark.slow_after_first
@pytest.mark.parametrize("workers", ["1", "2"])
def test_a_folder_that_cannot_be_made_keeps_no_earlier_scene_from_the_report(
    workers: str, tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "slab_four_corners").touch()
    assert main(["run", "two_pads", "slab_four_corners", "-o", str(tmp_path), "--no-yade", "-q", "--workers", workers]) == 3
    captured = capsys.readouterr()
    one_message(captured.err, str(tmp_path / "slab_four_corners"), "a file stands where a folder is needed")
    assert "expected value met" in captured.out
    assert [scene["scene"] for scene in json.loads((tmp_path / "report.json").read_text())["comparisons"]] == ["two_pads"]


def test_a_report_keeps_the_chosen_words_of_its_head_while_its_scenes_are_the_same(
    tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    def head() -> dict[str, str]:
        return dict(json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))["head"])

    assert main(["run", "two_pads", "-o", str(tmp_path), "--no-yade", "-q", "--title", "North pier", "--author", "A. Mason"]) == 0
    assert main(["report", str(tmp_path), "-q"]) == 0
    assert head() == {"title": "North pier", "author": "A. Mason"}
    assert "<title>North pier" in (tmp_path / "report.html").read_text(encoding="utf-8")
    assert main(["report", str(tmp_path), "-q", "--title", "", "--author", "C. Wright"]) == 0
    assert head() == {"title": "", "author": "C. Wright"}
    assert "North pier" not in (tmp_path / "report.html").read_text(encoding="utf-8")
    assert main(["run", "trilith", "-o", str(tmp_path), "--no-yade", "-q", "--title", "Trilith alone"]) == 0
    capsys.readouterr()
    assert main(["report", str(tmp_path), "-q"]) == 0
    assert head() == {}, "the earlier report had one of these two scenes"
    warning = capsys.readouterr().err
    assert 'loses title "Trilith alone": given for a report without two_pads; give it again to keep it' in " ".join(warning.split())
    assert main(["report", str(tmp_path), "-q"]) == 0 and not capsys.readouterr().err, "nothing is left to lose"
    for damaged in ("[]", "[" * 100_000, '{"comparisons": 1, "head": []}'):
        (tmp_path / "report.json").write_text(damaged, encoding="utf-8")
        assert main(["report", str(tmp_path), "-q"]) == 0


@pytest.mark.parametrize(("words", "seconds"), [([], []), (["--try-harder"], [HARDER_SECONDS]), (["--try-harder-limit", "7"], [7.0])])
def test_a_limit_of_a_second_attempt_asks_for_one(
    words: list[str], seconds: list[float], tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[float] = []
    monkeypatch.setattr("comparison.cli.scene_verbs.run.try_harder", lambda *given: asked.append(given[-1]))
    assert main(["run", "two_pads", "-o", str(tmp_path), "--no-yade", "-q", *words]) == 0
    assert asked == seconds


def test_a_report_that_lacks_scenes_of_an_earlier_run_says_how_to_have_them_all(
    tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two runs write the report of one folder, each with its own scenes only."""
    out = tmp_path / "all mine"
    assert main(["run", "two_pads", "-o", str(out), "--no-yade"]) == 0
    assert "other scene" not in capsys.readouterr().err
    assert main(["run", "two_blocks", "-o", str(out), "--no-yade"]) == 0
    assert f"1 other scene in {out} is not in this report: `crosscheck report '{out}'` makes one of all" in capsys.readouterr().err
    assert main(["report", str(out)]) == 0
    assert "other scene" not in capsys.readouterr().err
    assert {one["scene"] for one in json.loads((out / "report.json").read_text())["comparisons"]} == {"two_pads", "two_blocks"}


@pytest.mark.yade
def test_a_changed_scene_leaves_neither_the_run_of_the_earlier_one_nor_its_log(copy: Path, tmp_path: Path, plain_figures: None) -> None:
    path = tmp_path / "two_pads.toml"
    path.write_text(shipped.find("two_pads").read_text().replace("density = 2200.0", "density = 1100.0"))
    assert (copy / "two_pads" / "yade.log").exists()
    assert main(["run", str(path), "-o", str(copy), "--no-yade", "-q"]) == 0
    assert not (copy / "two_pads" / "run.h5").exists() and not (copy / "two_pads" / "yade.log").exists()


def test_a_pdf_of_an_earlier_report_is_named_as_one(
    tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The PDF stays, because somebody may have signed it."""
    monkeypatch.chdir(tmp_path)
    (printed := tmp_path / "mine" / "report.pdf").parent.mkdir()
    told = "mine/report.pdf is of an earlier report; `crosscheck report mine --pdf` prints this one"
    assert main(["run", "two_pads", "-o", "mine", "--no-yade"]) == 0
    assert "report.pdf" not in capsys.readouterr().err
    printed.write_text("signed")
    for made, is_told in ((0, True), (2e10, False)):  # s since 1970: long ago, and after this report
        os.utime(printed, (made, made))
        assert main(["report", "mine"]) == 0
        assert (told in " ".join(capsys.readouterr().err.split())) is is_told
    assert printed.read_text() == "signed"
