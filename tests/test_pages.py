"""Every page is true: links lead somewhere, commands run, scenes are scenes, generated tables and numbers are those of today."""

import argparse
import csv
import dataclasses
import doctest
import json
import math
import re
import tomllib
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from statistics import median

import program_keys
import pytest
import scene_keys
from conftest import CrossChecked, every_shipped_scene
from growth_report import fit
from scenes import load

from comparison.campaign import definition
from comparison.campaign.cases import expand
from comparison.campaign.definition import load_campaign
from comparison.cli.arguments import parser
from comparison.cli.commands import COMMANDS, main
from comparison.cli.exit_codes import EXIT_OF_VERDICT, INTERRUPTED, TOOL, USAGE
from comparison.cli.study_verbs.campaign import find_campaign
from comparison.judge.effects_table import effects_summary
from comparison.judge.verdict_table import verdict_cells
from la_core import text_table
from la_core.analysis.decisions import decided_model
from la_core.analysis.stage import analyse
from la_core.limit.associated import Status
from la_core.limit.classic_iteration import ClassicParameters, solve_sequentially
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble
from la_core.scene import shipped
from la_core.scene.scene import load_scene
from la_core.scene.variants import full_model

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
FOLDERS = ("la_core", "yade_scripts", "comparison", "tests")
PAGES = [*ROOT.glob("*.md"), *(path for folder in FOLDERS for path in (ROOT / folder).rglob("*.md"))]
PAGES = sorted(path for path in PAGES if path.name != "CHANGELOG.md")  # which tells of what was
EXPENSIVE = {"make demo": "test_the_demo_ends_as_the_readme_says checks its table on the suite's own runs"}
CHECKS = ROOT / "comparison" / "README.md"
CAMPAIGNS = ROOT / "comparison" / "campaign" / "README.md"
COMMAND_LINE = ROOT / "comparison" / "cli" / "README.md"
RESULT_ROW = re.compile(r"^\| `(\w+)` \|(.*)\|$", re.MULTILINE)
ROUND_OFF = 1e-2  # of a Coulomb value on another machine: the iteration amplifies round-off up to what friction's history leaves open
HISTORY = 1e-2  # of a reaction: what friction's history leaves open between two models of one structure
OTHER_MACHINE = 3.0  # stated uncertainties by which YADE's reaction may differ under another compiler or processor


def _blocks(language: str, page: str = README) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", page, re.DOTALL)


every_page = pytest.mark.parametrize("path", PAGES, ids=lambda path: path.relative_to(ROOT).as_posix())


def _table(head: str) -> dict[str, list[str]]:
    """Cells of the table that begins with these headings, by the scene that a row names."""
    (table,) = re.findall(rf"^{re.escape(head)}.*?\n\n", README, re.MULTILINE | re.DOTALL)
    return {name: [cell.strip() for cell in cells.split("|")] for name, cells in RESULT_ROW.findall(table)}


def _results() -> dict[str, list[str]]:
    return _table("| scene | R_min/W |")


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
    """Paths that begin with a folder of the repository; an asterisk stands for any name."""
    for name in re.findall(rf"(?<![\w/.-])(?:{'|'.join(FOLDERS)})/[\w./*-]*[\w*]", path.read_text(encoding="utf-8")):
        assert any(ROOT.glob(name)), name


@every_page
def test_every_command_of_the_line_shows_what_a_page_shows(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for block in _blocks("console", path.read_text(encoding="utf-8")):
        line, *expected = block.splitlines()
        command, _, sieve = line.removeprefix("$ ").partition(" | grep ")
        if "crosscheck" not in command or line.removeprefix("$ ") in EXPENSIVE:
            continue
        assert main(command.removeprefix(".venv/bin/crosscheck ").split()) == 0
        printed = [line for line in capsys.readouterr().out.splitlines() if sieve in line]
        assert _steady(expected) == _steady(printed) != []


def _steady(lines: list[str]) -> list[str]:
    """The lines that do not hang on the machine's speed or its round-off."""
    noise = ("seconds", "residual", "violation", "gap", "drift", "solves")
    return [line.rstrip() for line in lines if line.strip() and not any(word in line for word in noise)]


@every_page
def test_every_command_that_a_page_names_exists(path: Path) -> None:
    """Commands in backticks and in scripts: a verb that exists, with options that it has."""
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
    """What the README and the docstrings show is run by the tests of the Python interface; scripts of other pages run here."""
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


@pytest.mark.parametrize("name", ["two_pads", "arch_spreading", "wall_third", "two_blocks"])
def test_every_check_of_a_run_has_a_row(name: str, cross_checked: Callable[[str], CrossChecked]) -> None:
    table = CHECKS.read_text(encoding="utf-8")
    for check in cross_checked(name).summary["checks"]:
        name = re.split(" along [xyz(]", check["name"])[0]  # the direction depends on the scene
        assert re.search(rf"^\| [^|]*{re.escape(name)}", table, re.MULTILINE), name


def test_the_results_table_lists_every_shipped_scene() -> None:
    assert list(_results()) == shipped.names()


@every_shipped_scene
def test_limit_analysis_of_the_results_table(name: str) -> None:
    scene = load_scene(shipped.find(name))
    analysis = analyse(scene)
    least, predicted, interval, greatest, sharp, *_ = _results()[name]
    unit = 1.0 if scene.live is not None else scene.weight
    assert least == _shown(text_table.over_weight(analysis.bounds[analysis.main].value, unit))
    if Drive.PUSHING in analysis.bounds:
        assert greatest == _shown(text_table.over_weight(analysis.bounds[Drive.PUSHING].value, unit))
    assert analysis.coulomb is not None and analysis.sharp.coulomb is not None
    assert analysis.coulomb.status is Status.SOLVED or name in shipped.LONG
    assert float(predicted) == pytest.approx(analysis.coulomb.value / unit, rel=ROUND_OFF)
    assert float(sharp) == pytest.approx(analysis.sharp.coulomb.value / unit, rel=ROUND_OFF)
    ends = [float(end) for end in interval.split(" to ")]
    assert ends == pytest.approx([end / unit for end in analysis.coulomb.interval], rel=ROUND_OFF)


def _shown(value: float | None) -> str:
    return text_table.number_text(value if value is not None and math.isfinite(value) else None, 5)


@every_shipped_scene
def test_yade_of_the_results_table(name: str, cross_checked: Callable[[str], CrossChecked]) -> None:
    *_, yade, verdict, _, _, _ = _results()[name]
    if load_scene(shipped.find(name)).live is not None:
        assert (yade, verdict) == ("–", "agree")
        return
    found = cross_checked(name)
    assert verdict == found.summary["verdict"]
    if found.run.status != "plateau":
        assert yade == found.run.status
        return
    value, uncertainty = (float(part) for part in yade.split(" ± "))
    reaction, own = (found.run.result[key] / found.scene.weight for key in ("reaction", "uncertainty"))
    last_digit = 10.0 ** -len(yade.split(" ± ")[0].split(".")[1])
    assert abs(value - reaction) <= OTHER_MACHINE * max(uncertainty, own) + last_digit


def test_the_full_model_stands_beside_the_reduced_one_and_agrees() -> None:
    rows = _table("| scene | left out |")
    assert list(rows) == [name for name in shipped.names() if name not in shipped.LONG]
    for name, (_, predicted, with_everything, yade, yade_with_everything, verdict, *_) in rows.items():
        results = _results()[name]
        assert (predicted, yade, verdict) == (results[1], results[5], results[6])
        assert float(with_everything) == pytest.approx(float(predicted), rel=HISTORY)
        if yade != "–":
            (value, own), (full, other) = ((float(part) for part in cell.split(" ± ")) for cell in (yade, yade_with_everything))
            assert abs(value - full) <= own + other + HISTORY * abs(full)


LEFT_OUT = {"plane": "plane", "friction": "sliding", "reach": "reach", "displacement": "new contacts", "recording": "states"}


@pytest.mark.parametrize("name", [name for name in shipped.names() if name not in shipped.LONG])
def test_what_the_readme_says_is_left_out(name: str) -> None:
    scene = load_scene(shipped.find(name))
    decided = decided_model(scene)
    off = [row["effect"] for row in effects_summary(scene, decided.whole, decided.assembly)["table"] if not row["on"]]
    words = ", ".join(LEFT_OUT[effect] for effect in off if effect in LEFT_OUT) or "nothing"
    assert _table("| scene | left out |")[name][0] == words


@pytest.mark.parametrize("name", ["arch_spreading", "two_pads", "trilith", "slab_four_corners", "stack_bond_wall", "ferris_tin_loi_1"])
def test_limit_analysis_of_the_full_model(name: str) -> None:
    scene = full_model(load_scene(shipped.find(name)))
    coulomb = analyse(scene).coulomb
    assert coulomb is not None
    shown = float(_table("| scene | left out |")[name][2])
    assert shown == pytest.approx(coulomb.value / (1.0 if scene.live is not None else scene.weight), rel=ROUND_OFF)


def test_the_table_of_friction_is_that_of_the_results() -> None:
    """Walls under Coulomb friction: bound, prediction, interval, classic iteration and YADE as the programs find them."""
    rows = re.findall(r"^\| (0\.\d) \| right (\w+) \|(.*)\|$", README, re.MULTILINE)
    scenes = {("0.6", "third"): "wall_third", ("0.6", "half"): "wall_half", ("0.3", "third"): "wall_low_friction"}
    assert len(rows) == len(scenes)
    for friction, settling, cells in rows:
        name = scenes[friction, settling]
        scene = load_scene(shipped.find(name))
        least, predicted, interval, classic, yade = (cell.strip() for cell in cells.split("|"))
        assert float(least) == pytest.approx(float(_results()[name][0]), abs=1e-4)
        assert float(predicted) == pytest.approx(float(_results()[name][1]), abs=1e-4)
        assert [float(end) for end in interval.split(" to ")] == pytest.approx(
            [float(end) for end in _results()[name][2].split(" to ")], abs=1e-4
        )
        found = solve_sequentially(assemble(scene), Drive.YIELDING)
        assert float(classic) == pytest.approx(found.value / scene.weight, abs=1e-3)
        assert yade == _results()[name][5]


def test_what_the_readme_concludes_from_the_ladders() -> None:
    """The gallery's numbers are those of the figures: bound and classic iteration on the wall, the rest within a quarter of a per cent."""
    gallery = ROOT / "comparison" / "gallery"
    wall, pads = (json.loads((gallery / f"{name}-cost.json").read_text())["rungs"] for name in ("wall_third", "two_pads"))
    errors = {(rung["family"], rung["setting"]): rung["error"] for rung in wall if rung["target"] == "prediction"}
    assert errors.pop(("associated", "for a prediction")) == pytest.approx(0.13, abs=0.005)
    assert errors.pop(("classic iteration", "its own settings")) == pytest.approx(0.18, abs=0.005)
    assert {family for family, _ in errors} == {"Coulomb", "path", "YADE"} and max(errors.values()) <= 0.0025
    insets = {rung["setting"]: rung["error"] for rung in pads if rung["family"] in ("YADE", "inset")}
    assert (insets["derived settings"], insets["inset x 0.2"]) == (pytest.approx(0.01, rel=0.02), pytest.approx(0.002, rel=0.02))
    assert (insets["1 mm"], insets["0.2 mm"]) == (pytest.approx(0.01, rel=0.02), pytest.approx(0.002, rel=0.02))


def test_the_demo_ends_as_the_readme_says(cross_checked: Callable[[str], CrossChecked]) -> None:
    demo = next(block for block in _blocks("text") if "YADE's plateau" in block)
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    (names,) = re.findall(r"^demo:.*\n.*crosscheck run (.*)", makefile, re.MULTILINE)
    for name in names.split():
        (row,) = [line.split() for line in demo.splitlines() if line.strip().startswith(f"{name} ")]
        summary = cross_checked(name).summary
        assert found_verdict(" ".join(row)) == summary["verdict"]
        _, least, predicted, greatest, *_ = verdict_cells(summary)
        assert (row[1], row[3]) == (least, greatest)
        assert float(row[2]) == pytest.approx(float(predicted), rel=ROUND_OFF)


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


def test_what_the_readme_concludes_from_the_peers() -> None:
    """Ratios of the processor's seconds over our own, from the record beside the page."""
    record = json.loads((ROOT / "comparison" / "gallery" / "peers.json").read_text())
    ratios: dict[str, dict[str, float]] = {}
    for row in record["limit analysis"]:
        if row["status"] == "solved" and row["solver"] != "clarabel, ours":
            best = ratios.setdefault(row["scene"], {})
            best[row["solver"]] = min(best.get(row["solver"], math.inf), median(row["processor"]) / median(row["beside"]))
    assert min(ratio for name, ratio in ratios["plane wall 1000"].items() if "HiGHS" in name) > 5.0
    for found in ratios.values():
        assert all(ratio > 1.5 for name, ratio in found.items() if name == "SCS" or "compas_cra" in name)
        assert all(ratio > 0.55 for ratio in found.values())
    assert {name for name in ratios["wall 1000 in space"] if "compas_cra" not in name} == {"ECOS"}
    assert ratios["wall 1000 in space"]["ECOS"] > 3.0
    dynamics = {(row["scene"], row["setting"]): row for row in record["in time"] if row["method"] == "LMGC90"}
    off = {key: abs(row["reaction"] / row["predicted"] - 1.0) for key, row in dynamics.items()}
    assert all(error < 1e-3 for (scene, _), error in off.items() if scene == "arch_spreading")
    assert all(error < 2e-2 for error in off.values())


def test_what_the_readme_concludes_from_growth() -> None:
    record = json.loads((ROOT / "comparison" / "gallery" / "growth.json").read_text())["measured"]

    def exponents(method: str, quantity: str) -> list[float]:
        series = [[row for row in record if row["method"] == method and row["dimension"] == dimension] for dimension in ("plane", "3D")]
        fits = [fit([row["blocks"] for row in rows], [row[quantity] for row in rows]) for rows in series]
        return [found.exponent for found in fits if found is not None]

    assert exponents("associated", "seconds") == pytest.approx([2.0, 2.0], abs=0.25)
    assert exponents("associated", "memory") == pytest.approx([1.0, 1.0], abs=0.1)
    assert all(2.35 <= one < 2.75 for one in exponents("Coulomb", "seconds"))
    assert all(1.0 < one < 1.25 for one in exponents("step", "step"))
    assert all(1.35 <= one < 1.75 for one in exponents("YADE", "seconds"))
    outside = {(row["method"], row["dimension"], row["blocks"]): row["outside"] for row in record if "outside" in row}
    coulomb, bounds = "all of Coulomb", "all of associated"
    for method, dimension, least in ((coulomb, "plane", 117), (coulomb, "3D", 62), (bounds, "plane", 1010), (bounds, "3D", 497)):
        large = [share for (m, d, blocks), share in outside.items() if (m, d) == (method, dimension) and blocks >= least]
        assert large and max(large) < 0.1
    overhead = {row["dimension"]: row["overhead"] for row in record if row["method"] == "driver"}
    assert overhead["wall_third"] < 0.05 and overhead["corner_settling_end"] < 0.05
    assert 0.15 < overhead["arch_spreading"] < 0.25


def test_every_bought_accuracy_of_the_page_is_kept_and_a_coarse_wall_costs_less_than_a_third_of_a_fine_one() -> None:
    page = (ROOT / "comparison" / "gallery" / "accuracy.md").read_text(encoding="utf-8")
    rows = [[cell.strip() for cell in cells.split("|")] for _, cells in RESULT_ROW.findall(page)]
    names = [name for name, _ in RESULT_ROW.findall(page)]
    assert len(rows) == len(set(zip(names, [row[0] for row in rows], strict=True))) >= 30

    def number(cell: str) -> float:
        return float(cell.removesuffix(" %"))

    for asked, *cells in rows:
        shares = [number(cell) for k, cell in enumerate(cells) if k in (0, 1, 3, 4) and cell != "–"]
        assert shares and max(shares) <= number(asked)
    seconds = {row[0]: number(row[3]) + number(row[6]) for name, row in zip(names, rows, strict=True) if name == "wall_third"}
    assert seconds["1 %"] < seconds["0.2 %"] / 3.0


def test_the_campaign_after_the_seed_paper_came_to_what_the_readme_says() -> None:
    folder = ROOT / "comparison" / "gallery" / "seed_paper"
    with (folder / "results.csv").open(encoding="utf-8", newline="") as table:
        rows = list(csv.DictReader(table))
    cases = expand(load_campaign(find_campaign(Path("seed_paper"))))
    assert [row["case"] for row in rows] == [case.name for case in cases]
    counts = Counter(row["verdict"] for row in rows)
    assert f"{len(rows)} cases, {counts['agree']} agree and {counts['inconclusive']} are" in README
    assert len(rows) == counts["agree"] + counts["inconclusive"]
    assert f"{len({case.run.name for case in cases})} runs" in README
    report = (folder / "report.md").read_text(encoding="utf-8")
    assert all(row["case"].replace("_", r"\_") in report for row in rows)
