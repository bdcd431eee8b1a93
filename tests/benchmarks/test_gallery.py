"""The measured pages: every page equals the output of its program from its record, and the record equals that of a fresh run."""

import json
import re
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import benchmark_accuracy
import benchmark_detection
import benchmark_friction
import benchmark_uncertainty
import conclusions
import friction_record
import friction_report
import pytest
import results_page
from conftest import CrossChecked, every_shipped_scene
from marked_text import marked, with_part
from peers_report import conclusions as peers_conclusions
from peers_table import LEAST_REACTION, SOLVED, Row
from results_record import FRICTION_WALLS, classic_reaction, read_record

from comparison.campaign.cases import expand
from comparison.campaign.definition import load_campaign
from comparison.cli.study_verbs.campaign import find_campaign
from comparison.judge.effects_table import effects_summary
from comparison.numbers import percent
from la_core import text_table
from la_core.analysis.decisions import decided_model
from la_core.analysis.stage import analyse
from la_core.limit.associated import Drive, Status
from la_core.scene import full_model, shipped
from la_core.scene.scene import load_scene

GALLERY = conclusions.GALLERY
ROOT = GALLERY.parents[1]
RECORD = read_record()
PAGES = sorted(GALLERY.glob("*.md"))
RECORDS = sorted(GALLERY.rglob("*.json"))
PLACE = re.compile(r"(?<![\w.])/(tmp|home|root|work|var|usr|mnt|Users)/")  # a folder of the machine that measured
FRESH = [name for name in shipped.names() if name not in shipped.LONG]
ROUND_OFF = 1e-2  # relative, of a Coulomb value on another machine: round-off may grow to the range that friction's history leaves open
HISTORY = 1e-2  # relative, of a reaction: friction's history may differ between two models of one structure
OTHER_MACHINE = 3.0  # stated uncertainties by which YADE's reaction may differ under another compiler or processor
CLASSIC = 1e-3  # share of the weight: the classic iteration stops within its own tolerance of its end value


@pytest.mark.parametrize("name", ["results.md", "friction.md", "effects.md"])
def test_a_page_of_results_is_what_the_record_says(name: str) -> None:
    written = {"results.md": results_page.page(RECORD)} | results_page.other_pages(RECORD)
    assert written[name] == (GALLERY / name).read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def concluded() -> dict[str, str]:
    return conclusions.pages()


@pytest.mark.parametrize("name", ["growth.md", "peers.md", "accuracy.md", "startup.md", "cost.md", "friction.md", "seed_paper.md"])
def test_a_page_with_conclusions_is_what_the_records_say(name: str, concluded: dict[str, str]) -> None:
    assert concluded[name] == (GALLERY / name).read_text(encoding="utf-8")


@pytest.mark.parametrize("benchmark", [benchmark_uncertainty, benchmark_detection])
def test_a_page_of_random_scenes_is_what_its_record_says(benchmark: Any) -> None:
    entries = json.loads(benchmark.PAGE.with_suffix(".json").read_text(encoding="utf-8"))
    assert benchmark.page(entries) == benchmark.PAGE.read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_mistake_in_either_method_is_noticed(tmp_path: Path) -> None:
    """On one scene of the page the mistakes change the reaction by 10 % and 24 %. Without them both methods agree."""
    mistakes = ("friction a tenth lower", "support 10 degrees aside, or its axis 0.1 m off")
    none, *wrong = benchmark_detection.measured(7, benchmark_detection.SEED, tmp_path, mistakes)
    assert none["verdict"] == "agree" and len(wrong) == len(benchmark_detection.FACTORS) + 2 * len(mistakes)
    assert {entry["mistake"]: entry["verdict"] for entry in wrong}["prediction 5 % too large"] == "disagree"
    large = [entry for entry in wrong if entry["mistake"] in mistakes]
    assert all((benchmark_detection.change(entry) or 0.0) > 0.05 and entry["verdict"] != "agree" for entry in large)


def test_a_part_is_replaced_between_its_marks_and_nothing_else_is() -> None:
    page = f"before\n{marked('one', 'old')}\nbetween\n{marked('two', 'kept')}\nafter"
    assert with_part(page, "one", "new") == page.replace("old", "new")
    for broken in ("no marks", page + page):
        with pytest.raises(ValueError, match="exactly one"):
            with_part(broken, "one", "new")


def test_the_index_names_every_page_and_figure() -> None:
    index = (GALLERY / "README.md").read_text(encoding="utf-8")
    names = {path.name for path in GALLERY.iterdir()} - {"README.md"}
    assert {name for name in names if f"`{name}`" not in index and f"]({name}" not in index} == set()


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_links_and_programs_of_a_page_exist(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert all((path.parent / link).exists() for link in re.findall(r"\]\(([^)#:]+)\)", text))
    programs = re.findall(r"[\w/.]*tests/[\w/]+\.py", text)
    assert all((ROOT / program).exists() for program in programs)


@pytest.mark.parametrize("script", sorted(Path(__file__).parent.glob("*.py")), ids=lambda script: script.name)
def test_a_script_makes_importable_what_the_tests_share_before_it_imports_it(script: Path) -> None:
    imported = re.findall(r"^(?:import|from) (\w+)", script.read_text(encoding="utf-8"), re.MULTILINE)
    if "on_path" in imported:  # pytest finds these folders by its settings; a script that is run by hand does not
        shared = {path.stem for room in ("helpers", "inputs", "limit") for path in (ROOT / "tests" / room).glob("*.py")}
        assert not shared.intersection(imported[: imported.index("on_path")])


def test_the_record_has_every_shipped_scene() -> None:
    assert list(RECORD) == shipped.names()


@every_shipped_scene
def test_limit_analysis_of_the_record_is_that_of_a_fresh_run(name: str) -> None:
    scene = load_scene(shipped.find(name))
    analysis, recorded = analyse(scene), RECORD[name]["reduced"]
    unit = 1.0 if scene.live is not None else scene.weight
    bounds = {"least": analysis.main, "greatest": Drive.PUSHING}
    for key, drive in bounds.items():
        value = text_table.over_weight(analysis.bounds[drive].value, unit) if drive in analysis.bounds else None
        assert results_page.value_cell(recorded, key) == text_table.number_text(value, 5)
    assert analysis.coulomb is not None
    assert analysis.coulomb.status is Status.SOLVED or name in shipped.LONG
    assert recorded["predicted"] == pytest.approx(analysis.coulomb.value / unit, rel=ROUND_OFF)
    assert (recorded["sharp"] is None) == (analysis.sharp.coulomb is None)
    if analysis.sharp.coulomb is not None:
        assert recorded["sharp"] == pytest.approx(analysis.sharp.coulomb.value / unit, rel=ROUND_OFF)
    assert recorded["interval"] == pytest.approx([end / unit for end in analysis.coulomb.interval], rel=ROUND_OFF)


@every_shipped_scene
def test_yade_of_the_record_is_that_of_a_fresh_run(name: str, cross_checked: Callable[[str], CrossChecked]) -> None:
    recorded = RECORD[name]["reduced"]
    found = cross_checked(name)
    assert recorded["verdict"] == found.summary["verdict"]
    assert recorded["yade_status"] == found.run.status
    if found.run.status != "plateau":
        return
    shown = results_page.yade_cell(recorded).split(" ± ")[0]
    unit = found.scene.weight if found.scene.live is None else 1.0
    reaction, uncertainty = (found.run.result[key] / unit for key in ("reaction", "uncertainty"))
    last_digit = 10.0 ** -len(shown.split(".")[1])
    assert abs(float(shown) - reaction) <= OTHER_MACHINE * max(recorded["uncertainty"], uncertainty) + last_digit


@pytest.mark.parametrize("name", FRESH)
def test_the_full_model_of_the_record_agrees_with_the_reduced_one(name: str) -> None:
    reduced, full = RECORD[name]["reduced"], RECORD[name]["full"]
    assert reduced["verdict"] == full["verdict"] == ("expected" if reduced["yade"] is None else "agree")
    assert full["predicted"] == pytest.approx(reduced["predicted"], rel=HISTORY)
    if reduced["yade"] is not None:
        assert abs(reduced["yade"] - full["yade"]) <= reduced["uncertainty"] + full["uncertainty"] + HISTORY * abs(full["yade"])


@pytest.mark.parametrize("name", FRESH)
def test_what_the_record_leaves_out_is_what_is_left_out(name: str) -> None:
    scene = load_scene(shipped.find(name))
    decided = decided_model(scene)
    off = [row["effect"] for row in effects_summary(scene, decided.whole, decided.assembly)["table"] if not row["on"]]
    assert RECORD[name]["left_out"] == off


@pytest.mark.parametrize("name", ["arch_spreading", "two_pads", "trilith", "slab_four_corners", "stack_bond_wall", "ferris_tin_loi_1"])
def test_limit_analysis_of_the_full_model_of_the_record_is_that_of_a_fresh_run(name: str) -> None:
    scene = full_model(load_scene(shipped.find(name)))
    coulomb = analyse(scene).coulomb
    assert coulomb is not None
    unit = 1.0 if scene.live is not None else scene.weight
    assert RECORD[name]["full"]["predicted"] == pytest.approx(coulomb.value / unit, rel=ROUND_OFF)


@pytest.mark.parametrize("name", FRICTION_WALLS)
def test_the_classic_iteration_of_the_record_is_that_of_a_fresh_run(name: str) -> None:
    assert RECORD[name]["classic"] == pytest.approx(classic_reaction(load_scene(shipped.find(name))), abs=CLASSIC)


def test_an_entry_that_was_not_measured_here_says_where_it_is_from() -> None:
    entries = {name: RECORD[name] for name in ("two_pads", "wall_third", "wall_half")}
    versions = RECORD["wall_half"]["versions"] | {"machine": "another machine"}
    page = results_page.page(entries | {"wall_half": RECORD["wall_half"] | {"versions": versions, "source": "archive"}})
    assert "`wall_half`: another machine; " in page and "(from the archive)" in page


def test_a_verdict_that_is_not_agree_is_named_in_the_conclusions() -> None:
    entry = RECORD["wall_third"]
    entries = {"good": entry, "bad": entry | {"reduced": entry["reduced"] | {"verdict": "disagree"}}}
    assert "1 of 2 scenes agree; `bad` is disagree." in results_page.page(entries)


def test_the_record_on_friction_has_every_wall() -> None:
    results = friction_record.read(GALLERY / friction_record.RECORD)
    assert [result.case for result in results] == list(benchmark_friction.cases(quick=False, large=True))
    assert all(list(result.runs) == [*benchmark_friction.SETTINGS, friction_record.SMOOTH] for result in results)


@pytest.mark.slow_after_first
@pytest.mark.parametrize("number", range(4))
def test_predictions_of_the_record_on_friction_are_those_of_a_fresh_run(number: int) -> None:
    recorded = friction_record.read(GALLERY / friction_record.RECORD)[number]
    fresh = benchmark_friction.run_smooth(benchmark_friction.run(recorded.case))
    for name, one in recorded.runs.items():
        assert fresh.runs[name].status == one.status
        assert fresh.runs[name].value == pytest.approx(one.value, abs=one.uncertainty)


def friction_result(default: float, stated: float) -> friction_record.Result:
    """Return a wall with reaction 1 by the reference and by coarser paths. default, stated: reaction and uncertainty by default."""
    values = {
        friction_record.COARSER: (1.0, 0.1),
        friction_record.DEFAULT: (default, stated),
        friction_record.REFERENCE: (1.0, 0.1),
    }
    runs = {name: friction_record.Run("solved", value, own, (), 1.0, 1e-7, 100, 2.0) for name, (value, own) in values.items()}
    return friction_record.Result(friction_record.Case(4, 3, 0.5, 1), runs)


def test_the_conclusions_on_friction_say_where_a_stated_uncertainty_fails() -> None:
    held, failed = friction_result(1.001, 0.002), friction_result(1.03, 0.01)
    words = friction_report.conclusions([held, failed])
    assert "all 2 within 3 %, for 2 s a wall" in words
    assert (
        "holds on 1 of 2 walls; elsewhere the difference is up to 3 times as large; that of coarser paths holds on 2 of 2 walls." in words
    )


def test_the_figure_on_friction_tells_its_marks_apart_without_colour_and_shows_both_sides_of_the_line() -> None:
    marks, others, line = friction_report.figure([friction_result(1.001, 0.002), friction_result(1.03, 0.01)]).axes[0].lines
    assert marks.get_marker() != others.get_marker()
    assert [own > off for off, own in others.get_xydata()] == [True, False]
    assert (line.get_xdata() == line.get_ydata()).all()


def test_every_requested_accuracy_of_the_page_is_kept_and_a_coarse_wall_costs_less_than_a_third_of_a_fine_one() -> None:
    rows = benchmark_accuracy.stored_rows((GALLERY / "accuracy.md").read_text(encoding="utf-8"))
    assert len(rows) == len({(name, asked) for name, asked, *_ in rows}) >= 30
    assert all(map(benchmark_accuracy.is_kept, rows))
    walls = [row for row in rows if row[0] == f"`{benchmark_accuracy.WALL}`"]
    seconds = {row[1]: benchmark_accuracy.as_number(row[4]) + benchmark_accuracy.as_number(row[7]) for row in walls}
    assert seconds["1 %"] < seconds[percent(benchmark_accuracy.FINE)] / 3.0


def test_an_accuracy_that_is_missed_is_named() -> None:
    row = ["`pads`", "1 %", "0.2 %", "0.3 %", "1", "1.2 %", "0.9 %", "2", "100", "inconclusive"]
    assert not benchmark_accuracy.is_kept(row)
    assert "Missed by `pads` at 1 %." in benchmark_accuracy.conclusions([row])


def test_a_peer_that_is_faster_is_named() -> None:
    rows = [Row("arch", name, "1e-6", LEAST_REACTION, SOLVED, processor=(seconds,), beside=(1.0,)) for name, seconds in
            (("ECOS", 0.5), ("QOCO", 1.0), ("SCS", 3.0))]  # fmt: skip
    words = peers_conclusions(rows, [])
    assert "Faster than we are: ECOS on arch (0.50). About as fast: QOCO on arch (1.0)." in words
    assert "No peer is faster" in peers_conclusions(rows[1:], [])


def test_the_campaign_after_the_seed_paper_has_all_its_cases_and_its_report_does() -> None:
    rows = conclusions.campaign_rows(GALLERY)
    cases = expand(load_campaign(find_campaign(Path("seed_paper"))))
    assert [row["case"] for row in rows] == [case.name for case in cases]
    counts = Counter(row["verdict"] for row in rows)
    assert len(rows) == counts["agree"] + counts["inconclusive"]
    report = (GALLERY / "seed_paper" / "report.md").read_text(encoding="utf-8")
    assert all(row["case"].replace("_", r"\_") in report for row in rows)


@pytest.mark.parametrize("path", [*PAGES, *RECORDS], ids=lambda path: path.name)
def test_no_page_and_no_record_names_a_folder_of_the_machine_that_measured(path: Path) -> None:
    assert PLACE.search(path.read_text(encoding="utf-8")) is None
