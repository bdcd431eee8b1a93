"""Every page is true: links have targets, commands run, scenes are valid, generated tables and numbers are those of today."""

import argparse
import dataclasses
import doctest
import re
import tomllib
from collections.abc import Callable
from pathlib import Path

import program_keys
import pytest
import scene_keys
from conftest import CrossChecked
from scenes import load

from comparison.campaign import definition
from comparison.campaign.cases import expand
from comparison.cli.arguments import parser
from comparison.cli.commands import COMMANDS, main
from comparison.cli.exit_codes import EXIT_OF_VERDICT, INTERRUPTED, TOOL, USAGE
from comparison.verdict.verdict_table import VERDICTS, verdict_cells
from la_core.analysis.stage import analyse
from la_core.limit.classic_iteration import ClassicParameters
from la_core.limit.problem import Drive

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
FOLDERS = ("la_core", "yade_scripts", "comparison", "tests")
PAGES = [*ROOT.glob("*.md"), *(path for folder in FOLDERS for path in (ROOT / folder).rglob("*.md"))]
PAGES = sorted(path for path in PAGES if path.name != "CHANGELOG.md")  # it describes earlier versions
EXPENSIVE = {"make demo": "test_the_demo_ends_as_the_readme_says checks its table on the suite's own runs"}
CHECKS = ROOT / "comparison" / "README.md"
CAMPAIGNS = ROOT / "comparison" / "campaign" / "README.md"
COMMAND_LINE = ROOT / "comparison" / "cli" / "README.md"
RESULT_ROW = re.compile(r"^\| `(\w+)` \|(.*)\|$", re.MULTILINE)
ROUND_OFF = 1e-2  # of a Coulomb value on another machine: the iteration amplifies round-off up to the effect of friction's history
HISTORY = 1e-2  # of a reaction: effect of friction's history between two models of one structure
OTHER_MACHINE = 3.0  # stated uncertainties by which YADE's reaction may differ under another compiler or processor


def _blocks(language: str, page: str = README) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", page, re.DOTALL)


every_page = pytest.mark.parametrize("path", PAGES, ids=lambda path: path.relative_to(ROOT).as_posix())


def _table(head: str, page: str = README) -> dict[str, list[str]]:
    """Cells of the table with these headings, by the scene that a row names."""
    (table,) = re.findall(rf"^{re.escape(head)}.*?\n\n", page, re.MULTILINE | re.DOTALL)
    return {name: [cell.strip() for cell in cells.split("|")] for name, cells in RESULT_ROW.findall(table)}


def test_the_readme_and_the_page_for_contributors_are_short() -> None:
    assert len(README.splitlines()) <= 200
    assert len((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8").splitlines()) <= 45


@every_page
def test_every_link_and_figure_of_a_page_exists(path: Path) -> None:
    for target, anchor in re.findall(r"\]\(([^)#\s]*)#?([^)\s]*)\)", _without_code(path.read_text(encoding="utf-8"))):
        if "://" in target:
            continue
        linked = path.parent / target if target else path
        assert linked.exists(), target
        if anchor:
            assert linked.suffix == ".md" and anchor in _anchors(linked.read_text(encoding="utf-8")), f"{target}#{anchor}"


def _without_code(page: str) -> str:
    return re.sub(r"```.*?```", "", page, flags=re.DOTALL)


def _anchors(page: str) -> set[str]:
    """Anchors of a page's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.+)$", _without_code(page), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


@every_page
def test_every_file_that_a_page_names_exists(path: Path) -> None:
    """Paths begin with a folder of the repository, seen from its root or from the page. An asterisk matches any name."""
    for name in re.findall(rf"(?<![\w/.-])(?:{'|'.join(FOLDERS)})/[\w./*-]*[\w*]", path.read_text(encoding="utf-8")):
        assert any(ROOT.glob(name)) or any(path.parent.glob(name)), name


@every_page
def test_every_command_of_the_line_shows_what_a_page_shows(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A block without output shows how a page was measured. The next test checks its command, and the generator checks the page."""
    monkeypatch.chdir(tmp_path)
    for block in _blocks("console", path.read_text(encoding="utf-8")):
        line, *expected = block.splitlines()
        command, _, sieve = line.removeprefix("$ ").partition(" | grep ")
        if "crosscheck" not in command or not expected or line.removeprefix("$ ") in EXPENSIVE:
            continue
        assert main(command.removeprefix(".venv/bin/crosscheck ").split()) == 0
        printed = [line for line in capsys.readouterr().out.splitlines() if sieve in line]
        assert _steady(expected) == _steady(printed) != []


def _steady(lines: list[str]) -> list[str]:
    """The lines that do not depend on the machine's speed or its round-off."""
    noise = ("seconds", "residual", "violation", "gap", "drift", "solves")
    return [line.rstrip() for line in lines if line.strip() and not any(word in line for word in noise)]


@every_page
def test_every_command_that_a_page_names_exists(path: Path) -> None:
    """Commands in backticks and in scripts have a verb that exists and options of this verb."""
    page = path.read_text(encoding="utf-8")
    scripts = "\n".join(block for language in ("sh", "bash", "console") for block in _blocks(language, page))
    lines = re.findall(r"`(crosscheck [^`]+)`", _without_code(page)) + re.findall(r"(?:^|/|\s)(crosscheck [^\n|>]+)", scripts)
    (words,) = [action for action in parser()._actions if isinstance(action, argparse._SubParsersAction)]
    for line in lines:
        verb, *rest = line.removeprefix("crosscheck ").split()
        if verb in ("COMMAND", "--version"):
            continue
        assert verb in COMMANDS, line
        options = {word.strip("[]").partition("=")[0] for word in rest if word.strip("[]").startswith("-")}
        assert options <= set(words.choices[verb]._option_string_actions), line


@every_page
def test_make_targets_of_a_page_exist(path: Path) -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = re.findall(r"(?:`|^\$ )make ([\w-]+)", path.read_text(encoding="utf-8"), re.MULTILINE)
    assert all(re.search(rf"^{target}:", makefile, re.MULTILINE) for target in targets), targets
    if path.name == "README.md" and path.parent == ROOT:
        assert {"demo", "test", "lint"} <= set(targets)


@every_page
def test_every_scene_of_a_page_is_a_scene_and_every_campaign_a_campaign(path: Path, tmp_path: Path) -> None:
    for number, text in enumerate(_blocks("toml", path.read_text(encoding="utf-8"))):
        if "sweep" in tomllib.loads(text):
            file = tmp_path / f"campaign{number}.toml"
            file.write_text(text, encoding="utf-8")
            assert expand(definition.load_campaign(file))
            continue
        scene = load(text)
        if scene.expected is not None and scene.expected.reaction_over_weight is not None:
            sharp = analyse(scene).sharp.bounds[Drive.YIELDING].value / scene.weight
            assert sharp == pytest.approx(scene.expected.reaction_over_weight, abs=scene.expected.tolerance)


@every_page
def test_the_python_of_a_page_is_python(path: Path) -> None:
    """Tests of the Python interface run the code of the README and of docstrings. Scripts of other pages run here."""
    for block in _blocks("python", path.read_text(encoding="utf-8")):
        examples = doctest.DocTestParser().get_examples(block)
        code = compile("".join(example.source for example in examples) or block, str(path), "exec")
        if not examples and path.parent != ROOT:
            exec(code, {})


def test_every_command_has_a_row_in_the_readme_and_on_its_own_page() -> None:
    for page in (README, COMMAND_LINE.read_text(encoding="utf-8")):
        rows = "\n".join(re.findall(r"^\| `crosscheck .*?\|", page, re.MULTILINE))
        commands = re.findall(r"`crosscheck (\w+)", rows)
        assert len(commands) == len(set(commands)) and set(commands) == set(COMMANDS)


def test_every_verdict_has_its_words_on_both_pages() -> None:
    glossary = (CHECKS.parent / "glossary.md").read_text(encoding="utf-8")
    (row,) = re.findall(r"^\| verdict \|.*$", glossary, re.MULTILINE)
    for _, words in VERDICTS.values():
        name = words.partition(" (")[0]
        assert name in row.lower() and name in " ".join(CHECKS.read_text(encoding="utf-8").lower().split()), name


def test_effects_have_their_reasons_where_the_glossary_says(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    glossary = (CHECKS.parent / "glossary.md").read_text(encoding="utf-8")
    (command,) = re.findall(r"`crosscheck (show[^`]*)` lists all seven with reasons", glossary)
    assert main([*command.split(), "two_pads", "-q", "-o", str(tmp_path / "pads.png")]) == 0
    assert "reason" in capsys.readouterr().out


def test_every_exit_code_has_a_row() -> None:
    codes = re.findall(r"^\| (\d+) \|", COMMAND_LINE.read_text(encoding="utf-8"), re.MULTILINE)
    assert [int(code) for code in codes] == [*sorted({*EXIT_OF_VERDICT.values(), USAGE, TOOL}), INTERRUPTED]


def test_the_page_of_scenes_has_the_keys_of_the_schema() -> None:
    page = scene_keys.PAGE.read_text(encoding="utf-8")
    assert page == scene_keys.with_part(page, scene_keys.MARK, scene_keys.page_part())


@pytest.mark.parametrize("name", program_keys.PARTS)
def test_the_generated_tables_of_pages_are_those_of_today(name: str) -> None:
    path, text = program_keys.rewritten(name)
    assert path.read_text(encoding="utf-8") == text


def test_the_campaign_of_its_page_has_the_cases_that_the_page_counts() -> None:
    page = CAMPAIGNS.read_text(encoding="utf-8")
    (text,) = _blocks("toml", page)
    (sweep,) = definition.CampaignFile.model_validate(tomllib.loads(text)).sweep
    assert "3 x 2 x 2 cases" in page and sweep.count() == 3 * 2 * 2
    assert f"At most {definition.MOST_CASES:,} cases" in page
    parameters = re.findall(r"`classic\.(\w+)`", page)
    assert set(parameters) == {field.name for field in dataclasses.fields(ClassicParameters)}


@pytest.mark.parametrize("name", ["two_pads", "arch_spreading", "wall_third", "two_blocks", "ferris_tin_loi_1"])
@pytest.mark.slow
def test_every_check_of_a_run_has_a_row(name: str, cross_checked: Callable[[str], CrossChecked]) -> None:
    table = CHECKS.read_text(encoding="utf-8")
    for check in cross_checked(name).summary["checks"]:
        name = re.split(" along [xyz(]", check["name"])[0]  # the direction depends on the scene
        assert re.search(rf"^\| [^|]*{re.escape(name)}", table, re.MULTILINE), name


LEFT_OUT = {"plane": "plane", "friction": "sliding", "reach": "reach", "displacement": "new contacts", "recording": "states"}


def test_the_demo_ends_as_the_readme_says(cross_checked: Callable[[str], CrossChecked]) -> None:
    demo = next(block for block in _blocks("text") if "YADE's plateau" in block)
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    (names,) = re.findall(r"^demo:.*\n.*crosscheck run (.*)", makefile, re.MULTILINE)
    for name in names.split():
        (row,) = [re.split(r"\s{2,}", line.strip()) for line in demo.splitlines() if line.strip().startswith(f"{name} ")]
        summary = cross_checked(name).summary
        assert found_verdict(" ".join(row)) == summary["verdict"]
        _, least, predicted, greatest, *_ = verdict_cells(summary)
        assert (row[1], row[3]) == (least, greatest)
        values = [float(cell.split(" ± ")[0]) for cell in (row[2], predicted)]
        assert values[0] == pytest.approx(values[1], rel=ROUND_OFF) and ("±" in row[2]) == ("±" in predicted)


def test_the_results_of_the_readme_are_those_of_the_record() -> None:
    recorded = _table("| scene | R_min/W | Coulomb R/W |", (ROOT / "comparison" / "gallery" / "results.md").read_text(encoding="utf-8"))
    rows = _table("| scene | Coulomb | its interval |")
    assert 3 <= len(rows) <= 6
    for name, (predicted, interval, yade, verdict) in rows.items():
        _, coulomb, ends, _, _, of_yade, of_both, *_ = recorded[name]
        assert [predicted, yade, verdict] == [coulomb, of_yade, of_both]
        assert interval == ("one point" if ends == f"{coulomb} to {coulomb}" else ends)


@pytest.mark.slow
def test_the_results_of_the_readme_are_those_of_today(cross_checked: Callable[[str], CrossChecked]) -> None:
    rows = _table("| scene | Coulomb | its interval |")
    assert 3 <= len(rows) <= 6
    for name, (predicted, interval, yade, verdict) in rows.items():
        found = cross_checked(name)
        coulomb = found.analysis.coulomb
        assert coulomb is not None and verdict == found.summary["verdict"]
        assert float(predicted) == pytest.approx(coulomb.value / found.scene.weight, rel=ROUND_OFF)
        ends = [float(predicted)] * 2 if interval == "one point" else [float(end) for end in interval.split(" to ")]
        assert ends == pytest.approx([end / found.scene.weight for end in coulomb.interval], rel=ROUND_OFF)
        value, uncertainty = (float(part) for part in yade.split(" ± "))
        reaction, own = (found.run.result[key] / found.scene.weight for key in ("reaction", "uncertainty"))
        last_digit = 10.0 ** -len(yade.split(" ± ")[0].split(".")[1])
        assert abs(value - reaction) <= OTHER_MACHINE * max(uncertainty, own) + last_digit


def found_verdict(row: str) -> str:
    return next(word for word in ("disagree", "inconclusive", "agree") if word in row)
