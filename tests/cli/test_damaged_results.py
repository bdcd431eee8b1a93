"""Damaged stored results are never reported. The next call makes them again."""

import json
import os
import random
import shutil
import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from faulty_runs import INTERRUPTED, TOOL, answer, one_message

from comparison.cli.commands import main
from comparison.cli.exit_codes import AGREE
from comparison.judge import without_run
from comparison.workflow.one_scene import _without_run, read_results
from la_core.exchange.checksummed_file import VERSION, ExchangeError
from la_core.scene.shipped import find

DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "cut short": lambda content: content[: len(content) // 2],
    "empty": lambda content: b"",
    "a flipped bit": lambda content: content[:-1000] + bytes([content[-1000] ^ 1]) + content[-999:],
    "foreign": lambda content: b"\x89HDF\r\n\x1a\n" + content[8:],
    "of the future": lambda content: content.replace(f"crosscheck {VERSION} ".encode(), f"crosscheck {VERSION + 7} ".encode()),
}


@pytest.mark.parametrize("name", ["case.h5", "run.h5"])
@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES)
def test_a_damaged_result_is_never_reported(
    name: str, damage: Callable[[bytes], bytes], copy: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = copy / "two_pads" / name
    path.write_bytes(damage(path.read_bytes()))
    assert main(["report", str(copy), "-q"]) == TOOL
    one_message(capsys.readouterr().err, str(path), "run the scene again")


def test_a_scene_whose_case_is_missing_is_told_as_one_whose_case_is_damaged(copy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shutil.copytree(copy / "two_pads", copy / "other")
    (copy / "other" / "case.h5").unlink()
    for folder in (copy, copy / "other"):
        assert main(["report", str(folder), "--json", "-q"]) == TOOL
        said = capsys.readouterr()
        one_message(said.err, str(copy / "other" / "case.h5"), "missing", "run the scene again")
        assert json.loads(said.out)["left_out"] == ["other"]
        assert "other" in (copy / "report.md").read_text(encoding="utf-8")


LENGTHS = 50


@pytest.mark.slow_after_first
@pytest.mark.parametrize("name", ["case.h5", "run.h5"])
def test_a_result_cut_at_any_length_is_never_read(name: str, copy: Path) -> None:
    path = copy / "two_pads" / name
    content, chance = path.read_bytes(), random.Random(50)
    for length in [*(chance.randrange(len(content)) for _ in range(LENGTHS)), len(content) - 1]:
        path.write_bytes(content[:length])
        with pytest.raises(ExchangeError, match="run the scene again"):
            read_results(copy / "two_pads")


@pytest.mark.long
@pytest.mark.parametrize("name", ["case.h5", "run.h5"])
def test_a_result_cut_at_any_length_is_never_reported_and_is_made_again(
    name: str, copy: Path, undisturbed: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    path = copy / "two_pads" / name
    content, chance = path.read_bytes(), random.Random(51)
    for length in (chance.randrange(len(content)) for _ in range(LENGTHS)):
        path.write_bytes(content[:length])
        assert main(["report", str(copy), "-q"]) == TOOL
        one_message(capsys.readouterr().err, str(path), "run the scene again")
        assert main(["run", "two_pads", "-o", str(copy), "-q"]) == 0
        assert answer(copy) == answer(undisturbed)


@pytest.mark.slow_after_first
@pytest.mark.parametrize("name", ["case.h5", "run.h5"])
def test_a_damaged_result_is_made_again(name: str, copy: Path, undisturbed: Path, plain_figures: None) -> None:
    path = copy / "two_pads" / name
    path.write_bytes(DAMAGES["a flipped bit"](path.read_bytes()))
    assert main(["run", "two_pads", "-o", str(copy), "-q"]) == 0
    assert answer(copy) == answer(undisturbed)


@pytest.mark.slow
def test_a_run_of_another_scene_is_not_taken_for_this_one_s(copy: Path, undisturbed: Path, plain_figures: None, tmp_path: Path) -> None:
    """Blocks and contact points are the same, but the density is different: only the digest of the inputs shows this."""
    other = tmp_path / "two_pads.toml"
    other.write_text(find("two_pads").read_text().replace("density = 2200.0", "density = 1100.0"))
    assert main(["run", str(other), "-o", str(tmp_path / "other"), "-q"]) == 0
    shutil.copy(tmp_path / "other" / "two_pads" / "run.h5", copy / "two_pads")
    assert main(["run", "two_pads", "-o", str(copy), "-q"]) == 0
    assert answer(copy) == answer(undisturbed)


def _changed(content: bytes) -> bytes:
    stored = json.loads(content)
    stored["yade"]["reaction"] *= 1.5
    return json.dumps(stored).encode()


GARBAGE: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda content: b"",
    "cut short": lambda content: content[:-100],
    "not UTF-8": lambda content: b"\xff\xfe" + content,
    "not an object": lambda content: b"[]",
    "without end": lambda content: b"[" * 100_000,
    "the digest alone": lambda content: json.dumps({"inputs": json.loads(content)["inputs"]}).encode(),
    "a changed number": _changed,
}


@pytest.mark.slow_after_first
@pytest.mark.parametrize("damage", GARBAGE.values(), ids=GARBAGE)
def test_a_comparison_that_is_garbage_is_made_again(
    damage: Callable[[bytes], bytes], copy: Path, undisturbed: Path, plain_figures: None
) -> None:
    path = copy / "two_pads" / "comparison.json"
    path.write_bytes(damage(path.read_bytes()))
    assert main(["run", "two_pads", "-o", str(copy), "-q"]) == 0
    assert answer(copy) == answer(undisturbed)
    path.write_bytes(damage(path.read_bytes()))
    assert main(["report", str(copy), "-q"]) == 0
    assert answer(copy)["yade"] == answer(undisturbed)["yade"] and answer(copy)["verdict"] == "agree"


@pytest.mark.parametrize("name", ["comparison.json", ".lock", "report.json"])
@pytest.mark.parametrize("verb", ["run", "report"])
def test_a_pipe_in_the_place_of_a_result_is_not_waited_for(verb: str, name: str, copy: Path, plain_figures: None) -> None:
    place = copy / name if name == "report.json" else copy / "two_pads" / name
    place.unlink(missing_ok=True)
    os.mkfifo(place)
    signal.alarm(60)  # reading the pipe would never end
    try:
        assert main([verb, *(["two_pads", "-o"] if verb == "run" else []), str(copy), "-q"]) == 0
    finally:
        signal.alarm(0)
    assert answer(copy)["verdict"] == "agree"


def test_a_half_drawn_figure_is_never_left(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A half-drawn figure would pass for a whole one, because an unchanged comparison is not drawn again."""
    figure = copy / "two_pads" / "mechanisms.png"
    figure.unlink()
    original = Path.write_bytes
    monkeypatch.setattr(Path, "write_bytes", lambda path, content: original(path, content[:100]) and os.kill(os.getpid(), signal.SIGINT))
    assert main(["run", "two_pads", "-o", str(copy), "-q"]) == INTERRUPTED
    assert not figure.exists()


@pytest.mark.slow_after_first
@pytest.mark.parametrize("name", ["mechanisms.png", "viewer.json"])
def test_a_damaged_drawing_is_made_again(name: str, copy: Path, undisturbed: Path) -> None:
    path = copy / "two_pads" / name
    path.write_bytes(path.read_bytes()[:300])
    assert main(["report", str(copy), "-q"]) == 0
    assert path.read_bytes() == (undisturbed / "two_pads" / name).read_bytes()


def test_a_run_that_was_deleted_is_called_missing(copy: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]) -> None:
    (copy / "two_pads" / "run.h5").unlink()
    assert main(["report", str(copy), "-q"]) == TOOL
    told = " ".join(capsys.readouterr().out.split())
    assert "the record of YADE's run is missing" in told and "run the scene again" in told and "inconclusive" in told
    assert answer(copy)["yade"]["reaction"] is None


@pytest.mark.parametrize("name", ["case.h5", "scene.toml"])
def test_a_scene_that_cannot_be_read_is_named_in_the_report_of_the_others(
    name: str, copy: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(copy / "two_pads", copy / "broken")
    damaged = copy / "broken" / name
    if name == "scene.toml":
        damaged.unlink()
    else:
        damaged.write_bytes(b"")
    assert main(["report", str(copy), "-q"]) == TOOL
    one_message(capsys.readouterr().err, str(damaged), "again")
    for page in ("report.html", "report.md"):
        text = (copy / page).read_text(encoding="utf-8")
        assert "because the results cannot be read" in text and "broken" in text
    assert [scene["scene"] for scene in json.loads((copy / "report.json").read_text())["comparisons"]] == ["two_pads"]


def test_results_that_another_user_closed_are_named_as_left_out(
    copy: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The tests may run as root, who may read everything, so the answer of the system is imitated."""
    closed = copy / "closed"
    closed.mkdir()
    may = os.access
    monkeypatch.setattr(os, "access", lambda path, mode: path != closed and may(path, mode))
    assert main(["report", str(copy), "--json", "-q"]) == TOOL
    said = capsys.readouterr()
    one_message(said.err, f"{closed}: it may not be read by you: ask its owner")
    assert json.loads(said.out)["left_out"] == ["closed"]
    with monkeypatch.context() as full:
        full.setattr("comparison.cli.scene_verbs.report.report_again", lambda *_: (_ for _ in ()).throw(OSError(28, "No space left", "x")))
        assert main(["report", str(copy), "--json", "-q"]) == TOOL
    assert json.loads(capsys.readouterr().out)["left_out"] == ["closed", "two_pads"]
    shutil.rmtree(copy / "two_pads")
    assert main(["report", str(copy), "-q"]) == TOOL
    one_message(capsys.readouterr().err, "ask its owner")


def test_a_folder_that_cannot_be_listed_is_not_said_to_hold_no_results(
    copy: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """With the mode 711, files in the folder may be read by name, but their names cannot be listed."""
    may = os.access
    monkeypatch.setattr(os, "access", lambda path, mode: path != copy and may(path, mode))
    monkeypatch.setattr(Path, "glob", lambda *_: iter(()))
    assert main(["report", str(copy), "-q"]) == TOOL
    one_message(capsys.readouterr().err, f"{copy}: it may not be read by you: ask its owner")


@pytest.mark.parametrize("name", ["lost+found", ".Trash-0"])
def test_a_closed_folder_of_the_disk_beside_results_is_no_result(
    name: str, copy: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (copy / name).mkdir()
    may = os.access
    monkeypatch.setattr(os, "access", lambda path, mode: path != copy / name and may(path, mode))
    assert main(["report", str(copy), "--json", "-q"]) == AGREE
    said = capsys.readouterr()
    assert not said.err and name not in said.out


def test_a_report_stays_where_no_scene_can_be_read(copy: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = (copy / "report.html").read_bytes()
    (copy / "two_pads" / "scene.toml").unlink()
    assert main(["report", str(copy), "-q"]) == TOOL
    one_message(capsys.readouterr().err, str(copy / "two_pads" / "scene.toml"), "missing; run the scene again")
    assert (copy / "report.html").read_bytes() == before


def test_json_names_what_was_left_out_and_keeps_its_shape(copy: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]) -> None:
    shutil.copytree(copy, copy.parent / "other")
    (copy / "two_pads" / "scene.toml").unlink()
    assert main(["report", str(copy), "--json", "-q"]) == TOOL
    told = json.loads(capsys.readouterr().out)
    assert (told["comparisons"], told["left_out"]) == ([], ["two_pads"])
    assert main(["report", str(copy), str(copy.parent / "other"), "--json", "-q"]) == TOOL
    first, second = json.loads(capsys.readouterr().out)["reports"]
    assert first["left_out"] == ["two_pads"] and second["left_out"] == [] and len(second["comparisons"]) == 1


def test_a_stored_scene_that_breaks_a_rule_is_an_error_of_the_scene(
    copy: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(copy / "two_pads", copy / "broken")
    scene = copy / "broken" / "scene.toml"
    scene.write_text(scene.read_text().replace("friction =", "fricton =", 1))
    assert main(["report", str(copy), "-q"]) == 2
    one_message(capsys.readouterr().err, str(scene), "fricton")
    assert "broken" in (copy / "report.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("status", ["missing", "failed"])
def test_a_yade_that_made_no_record_keeps_its_own_reason(status: str, tmp_path: Path) -> None:
    """Only a run that made a record can have lost it."""
    own = without_run(status, "why")
    assert _without_run(own, tmp_path) == own and _without_run(None, tmp_path) is None
    lost = _without_run(without_run("plateau", ""), tmp_path)
    assert lost is not None and lost["status"] == "failed" and "run.h5" in lost["message"]
