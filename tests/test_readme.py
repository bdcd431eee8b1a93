"""The README is true: its commands run, its outputs and numbers are those of today."""

import math
import re
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import CrossChecked
from scenes_for_tests import load

from comparison import shipped, tables
from comparison.cli import main
from la_core.case import analyse
from la_core.limit import Drive
from la_core.scene import load_scene

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
RESULT_ROW = re.compile(r"^\| `(\w+)` \|(.*)\|$", re.MULTILINE)
OTHER_MACHINE = 3.0  # stated uncertainties by which YADE's reaction may differ under another compiler or processor


def _blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, re.DOTALL)


def _results() -> dict[str, list[str]]:
    return {name: [cell.strip() for cell in cells.split("|")] for name, cells in RESULT_ROW.findall(README.split("## Results")[1])}


def test_every_command_of_the_line_shows_what_the_readme_shows(capsys: pytest.CaptureFixture[str]) -> None:
    shown = [block for block in _blocks("console") if "crosscheck" in block]
    assert shown
    for block in shown:
        command, *expected = block.splitlines()
        assert main(command.removeprefix("$ .venv/bin/crosscheck ").split()) == 0
        printed = capsys.readouterr().out.splitlines()
        assert _steady(expected) == _steady(printed)


def _steady(lines: list[str]) -> list[str]:
    """The lines that do not hang on the machine's speed or its round-off."""
    noise = ("seconds", "residual", "violation", "gap")
    return [line.rstrip() for line in lines if line.strip() and not any(word in line for word in noise)]


def test_make_targets_of_the_readme_exist() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = re.findall(r"`?make (\w+)`?", README)
    assert {"demo", "test", "lint"} <= set(targets)
    assert all(re.search(rf"^{target}:", makefile, re.MULTILINE) for target in targets)


def test_every_command_of_the_table_exists(capsys: pytest.CaptureFixture[str]) -> None:
    commands = re.findall(r"^\| `crosscheck (\w+)", README, re.MULTILINE)
    assert len(commands) == 6
    for command in commands:
        with pytest.raises(SystemExit) as stop:
            main([command, "--help"])
        assert stop.value.code == 0
        capsys.readouterr()


def test_the_scene_of_the_readme_is_a_scene_with_its_expected_value() -> None:
    (text,) = _blocks("toml")
    assert tomllib.loads(text)
    scene = load(text)
    expected = scene.expected
    assert expected is not None and expected.reaction_over_weight is not None
    sharp = analyse(scene).sharp[Drive.YIELDING].value / scene.weight
    assert sharp == pytest.approx(expected.reaction_over_weight, abs=expected.tolerance)


def test_every_file_and_figure_of_the_readme_exists() -> None:
    linked = re.findall(r"\]\(([^)#:]+)\)", README)
    assert linked
    assert all((ROOT / path).exists() for path in linked)


def test_the_results_table_lists_every_shipped_scene() -> None:
    assert list(_results()) == shipped.names()


@pytest.mark.parametrize("name", shipped.names())
def test_limit_analysis_of_the_results_table(name: str) -> None:
    scene = load_scene(shipped.find(name))
    analysis = analyse(scene)
    values = [analysis.rounded[drive].value for drive in (Drive.YIELDING, Drive.PUSHING)]
    values.append(analysis.sharp[Drive.YIELDING].value)
    shown = [tables.number(value / scene.weight if math.isfinite(value) else None, 5) for value in values]
    assert _results()[name][:3] == shown


@pytest.mark.parametrize("name", shipped.names())
def test_yade_of_the_results_table(name: str, cross_checked: Callable[[str], CrossChecked]) -> None:
    found = cross_checked(name)
    *_, yade, verdict, _, _ = _results()[name]
    assert verdict == found.summary["verdict"]
    if found.run.status != "plateau":
        assert yade == found.run.status
        return
    value, uncertainty = (float(part) for part in yade.split(" ± "))
    reaction, own = (found.run.result[key] / found.scene.weight for key in ("reaction", "uncertainty"))
    last_digit = 10.0 ** -len(yade.split(" ± ")[0].split(".")[1])
    assert abs(value - reaction) <= OTHER_MACHINE * max(uncertainty, own) + last_digit


def test_the_demo_ends_as_the_readme_says(cross_checked: Callable[[str], CrossChecked]) -> None:
    demo = next(block for block in _blocks("text") if "YADE's plateau" in block)
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    (names,) = re.findall(r"crosscheck run (.*?) \|\|", makefile)
    for name in names.split():
        (row,) = [line for line in demo.splitlines() if line.strip().startswith(f"{name} ")]
        assert found_verdict(row) == cross_checked(name).summary["verdict"]
        assert _results()[name][0] in row


def found_verdict(row: str) -> str:
    return next(word for word in ("disagree", "inconclusive", "agree") if word in row)
