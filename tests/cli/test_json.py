"""With `--json` every command prints one JSON object and nothing else on standard output, or nothing at all after an error."""

import argparse
import json
from pathlib import Path
from typing import Any, NoReturn

import pytest
from campaigns import run as run_campaign

from comparison.cli.arguments import parser
from comparison.cli.commands import main
from comparison.cli.exit_codes import AGREE, USAGE

VALUES = {"SCENE": "two_pads", "DIR|SCENE": "two_pads", "SHELL": "bash"}  # values of required arguments, by their names in the help
OUTPUTS = {"SCENE": "scene.toml", "FIG": "figure.png", "PAGE": "page.html", "MOVIE": "movie.gif"}
CAMPAIGN = "campaign.toml"
PREFERRED = ("no_yade",)  # switches that save time


def _commands() -> dict[str, argparse.ArgumentParser]:
    (words,) = [action for action in parser()._actions if isinstance(action, argparse._SubParsersAction)]
    return dict(words.choices)


COMMAND_LINE = _commands()


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("results")
    assert main(["run", "two_pads", "--no-yade", "-q", "-o", str(folder)]) == AGREE
    (folder / CAMPAIGN).write_text('[[sweep]]\nscene = "two_pads"\n')
    run_campaign('yade = false\n[[sweep]]\nscene = "two_pads"\n', folder / "campaign")  # which writes the campaign's file, too
    assert (folder / CAMPAIGN).is_file()
    return folder


def example(sub: argparse.ArgumentParser, results: Path, folder: Path) -> list[str]:
    """Return arguments with which a command does its work: the required ones, and the place of its files."""
    given = []
    for action in sub._actions:
        if action.dest == "output":
            given += ["-o", str(folder / OUTPUTS.get(str(action.metavar), "files"))]
        elif action.dest in PREFERRED:
            given.append(action.option_strings[0])
        elif action.required:
            stored = {"DIR": str(results), "FILE": str(results / CAMPAIGN), **dict.fromkeys(("DIR1", "DIR2"), str(results / "campaign"))}
            value = (stored | VALUES).get(str(action.metavar))
            assert value is not None, f"say in VALUES what this test is to give for {action.metavar} of {sub.prog}"
            given += [*action.option_strings[:1], value]
    return given


def one_object(text: str) -> dict[str, Any]:
    """Return the JSON object of a text. Any text before or after the object, or a number that JSON does not know, is an error."""

    def refuse(name: str) -> NoReturn:
        raise AssertionError(f"{name} is no JSON")

    found = json.loads(text, parse_constant=refuse)
    assert isinstance(found, dict) and found
    return found


@pytest.mark.yade
@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.slow) if name == "animate" else name for name in COMMAND_LINE])
def test_every_command_prints_one_object_and_nothing_else(
    name: str, results: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("CROSSCHECK_OUTPUT")
    monkeypatch.setattr("comparison.studies.cost.REPEATS", 1)
    assert main([name, *example(COMMAND_LINE[name], results, tmp_path), "--json"]) == AGREE
    one_object(capfd.readouterr().out)


@pytest.mark.parametrize("name", COMMAND_LINE)
def test_an_error_is_one_line_on_standard_error_and_an_exit_code(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Every command reports an invalid configuration. Commands on a scene or folder report a missing one."""
    monkeypatch.chdir(tmp_path)
    absent = [*example(COMMAND_LINE[name], tmp_path / "nowhere", tmp_path), "--json"]
    if "two_pads" in absent or any(word.startswith(str(tmp_path / "nowhere")) for word in absent):
        assert main([name, *("two_pds" if word == "two_pads" else word for word in absent)]) == USAGE
        _one_error(capfd)
    Path("crosscheck.toml").write_text("friction = 0.6")
    assert main([name, *absent]) == USAGE
    _one_error(capfd)


def _one_error(capfd: pytest.CaptureFixture[str]) -> None:
    captured = capfd.readouterr()
    assert captured.out == "" and captured.err.startswith("error: ") and captured.err.count("\n") == 1


def test_several_folders_are_still_one_object(results: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["report", str(results), str(results), "--json"]) == AGREE
    assert len(one_object(capfd.readouterr().out)["reports"]) == 2
