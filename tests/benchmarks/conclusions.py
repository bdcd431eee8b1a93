"""Writes the conclusions from stored measurements into the gallery's pages. All numbers come from the records; nothing is run.

    .venv/bin/python tests/benchmarks/conclusions.py

The pages growth.md, peers.md, accuracy.md and startup.md are written whole. Of cost.md, friction.md and seed_paper.md only the marked parts
are written.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import csv
import json
from collections import Counter, defaultdict
from pathlib import Path
from statistics import median
from typing import Any

import benchmark_accuracy
import benchmark_growth
import benchmark_peers
import benchmark_startup
import friction_report
from marked_text import listed, sentences, span, with_part

from comparison.campaign.cases import expand
from comparison.campaign.definition import load_campaign
from comparison.cli.study_verbs.campaign import find_campaign
from comparison.numbers import percent
from la_core.text_table import number_text

GALLERY = Path(__file__).parents[2] / "comparison" / "gallery"
LADDERS = ("two_pads", "arch_spreading", "wall_third", "corner_settling_end")
CLASSIC = ("classic iteration", "its own settings")
DEFAULT, ROUGH, FINE = (("Coulomb", setting) for setting in ("2 paths (default)", "1 path, viscosity 0.1", "steps 10 times shorter"))
DERIVED, FASTER, SLOWER = (("YADE", setting) for setting in ("derived settings", "settlement speed x 4", "settlement speed x 0.5"))


def pages(folder: Path = GALLERY) -> dict[str, str]:
    """Return the text of every page that quotes a record, by file name, from the records in the folder."""
    written = {
        "growth.md": benchmark_growth.stored_page(folder),
        "peers.md": benchmark_peers.stored_page(folder / "peers.md"),
        "accuracy.md": benchmark_accuracy.stored_page(folder / "accuracy.md"),
        "startup.md": benchmark_startup.stored_page(folder),
    }
    accuracy = benchmark_accuracy.stored_rows(written["accuracy.md"])
    parts = {
        "cost.md": {"ladders": ladders(folder), "requested accuracy": benchmark_accuracy.conclusions(accuracy)},
        "friction.md": {
            "classic iteration": classic_iteration(campaign_rows(folder)),
            friction_report.PART: friction_report.page_part(folder),
            friction_report.SMOOTH_PART: friction_report.smooth_part(folder),
        },
        "seed_paper.md": {"counts": counts(folder), "reactions": reactions(campaign_rows(folder))},
    }
    for name, texts in parts.items():
        page = (folder / name).read_text(encoding="utf-8")
        for part, text in texts.items():
            page = with_part(page, part, text)
        written[name] = page
    return written


def ladders(folder: Path) -> str:
    """Return the conclusions from the four ladders of `crosscheck cost`."""
    errors: dict[str, dict[tuple[str, str], dict[str, Any]]] = {}
    for name in LADDERS:
        rungs = json.loads((folder / f"{name}-cost.json").read_text(encoding="utf-8"))["rungs"]
        errors[name] = {(rung["family"], rung["setting"]): rung for rung in rungs}
    pads, arch, wall, corner = (errors[name] for name in LADDERS)
    fine, coarse = ("inset", "0.2 mm"), ("inset", "1 mm")
    one_path = [_error(corner, key) for key in corner if key[1].startswith("1 path")]
    alone = max(corner[key]["uncertainty"] / abs(corner[key]["value"]) for key in corner if key[1].startswith("1 path"))
    of_two = corner[DEFAULT]["uncertainty"] / abs(corner[DEFAULT]["value"])
    return sentences(
        [
            "Where no joint slides, the bound is the prediction, and it takes milliseconds "
            f"({number_text(1e3 * arch['associated', 'for a prediction']['total'], 2)} ms on the arch with 11 voussoirs). "
            f"The remaining error comes from the inset: on two pads {_percent(pads, coarse)} at 1 mm and {_percent(pads, fine)} at 0.2 mm, "
            f"in YADE {_percent(pads, DERIVED)} and {_percent(pads, ('YADE', 'inset x 0.2'))}.",
            f"Where joints slide, the bound is {_percent(wall, ('associated', 'for a prediction'))} off on the wall and the classic "
            f"iteration {_percent(wall, CLASSIC)}.",
            f"On the wall the default prediction is {_priced(wall, DEFAULT)}. One path with a viscosity of 0.1 W is "
            f"{_priced(wall, ROUGH)}; two paths with steps ten times shorter are {_priced(wall, FINE)}. Allowing more travel changes "
            "nothing where one travel is enough.",
            f"With its derived settings YADE is {_priced(wall, DERIVED)} on the wall; four times as fast it is {_priced(wall, FASTER)}, at "
            f"half the speed {_priced(wall, SLOWER)}.",
            f"On the corner friction's history decides. A single path is {percent(min(one_path))} to {percent(max(one_path))} off, "
            f"depending on its viscosity, but states an uncertainty of at most {percent(alone)}. Only a second path shows the error: the "
            f"default prediction with two paths is {_priced(corner, DEFAULT)} and states an uncertainty of {percent(of_two)}.",
            f"With its derived settings YADE is {_priced(corner, DERIVED)} on the corner; four times as fast it is "
            f"{_priced(corner, FASTER)}, at half the speed {_priced(corner, SLOWER)}. The classic iteration ends as "
            f"`{corner[CLASSIC]['status']}` there.",
        ]
    )


def _priced(rungs: dict[tuple[str, str], dict[str, Any]], key: tuple[str, str]) -> str:
    return f"{_percent(rungs, key)} off in {number_text(rungs[key]['total'], 2)} s"


def _error(rungs: dict[tuple[str, str], dict[str, Any]], key: tuple[str, str]) -> float:
    return float(rungs[key]["error"])


def _percent(rungs: dict[tuple[str, str], dict[str, Any]], key: tuple[str, str]) -> str:
    return percent(_error(rungs, key))


def campaign_rows(folder: Path) -> list[dict[str, str]]:
    """Return the rows of the campaign after the seed paper."""
    with (folder / "seed_paper" / "results.csv").open(encoding="utf-8", newline="") as table:
        return list(csv.DictReader(table))


def counts(folder: Path) -> str:
    """State the number of cases that agree, and the names of the others."""
    rows = campaign_rows(folder)
    verdicts = Counter(row["verdict"] for row in rows)
    with (folder / "seed_paper" / "costs.csv").open(encoding="utf-8", newline="") as table:
        spent = {row["case"]: float(row["seconds"]) for row in csv.DictReader(table)}
    runs = {case.run.name: spent[case.name] for case in expand(load_campaign(find_campaign(Path("seed_paper"))))}
    others = [f"{count} {verdict}" for verdict, count in sorted(verdicts.items()) if verdict != "agree"]
    lines = [f"{len(rows)} cases: {verdicts['agree']} agree, {listed(others or ['no case is inconclusive, none disagrees'])}."]
    minutes = number_text(sum(runs.values()) / 60.0, 2)
    lines.append(f"They need {len(runs)} runs of both methods, which take {minutes} minutes one after another.")
    apart = [abs(float(row["yade"]) / float(row["coulomb"]) - 1.0) for row in rows if row["yade"] and row["coulomb"]]
    lines.append(f"YADE differs from the prediction by {percent(median(apart))} in the median and {percent(max(apart))} at most.")
    for verdict in sorted(set(verdicts) - {"agree"}):
        names = [f"`{row['case']}`" for row in rows if row["verdict"] == verdict]
        lines.append(f"{verdict.capitalize()}: {listed(names)}.")
    return sentences(lines)


def reactions(rows: list[dict[str, str]]) -> str:
    """State the change of the reaction of a wall's settling end with friction, and the mechanism of walls of different height."""
    zones: dict[str, list[dict[str, str]]] = defaultdict(list)
    for row in rows:
        if row["sweep"] == "wall":
            zones[row["block[0].box.to[0]"]].append(row)
    kept, switched = [], []
    for many in zones.values():
        first, last = many[0], many[-1]
        same = first["coulomb_mechanism"] == last["coulomb_mechanism"]
        (kept if same else switched).append(1.0 - float(last["coulomb"]) / float(first["coulomb"]))
    alike = sum(row["coulomb_mechanism"] == row["yade_mechanism"] for row in rows if row["sweep"] == "wall")
    many = [row for row in rows if row["sweep"] == "wall_height"]
    (wedge, wedges), *_ = Counter(row["yade_mechanism"] for row in many).most_common(1)
    friction = [row["joint.friction"] for row in rows if row["sweep"] == "wall"]
    return sentences(
        [
            f"From a friction of {friction[0]} to {friction[-1]} the reaction of a wall's settling end falls by "
            f"{span([100.0 * fall for fall in kept])} % where the mechanism stays"
            + (f", and by {span([100.0 * fall for fall in switched])} % where it changes." if switched else "."),
            f"In {alike} of these {sum(map(len, zones.values()))} cases the same blocks move in both methods.",
            f"In {wedges} of {len(many)} walls of different height YADE finds the same {wedge.split('-')[0]} moving blocks; taller "
            "walls are heavier, so these blocks are a smaller share of the weight.",
        ]
    )


def classic_iteration(rows: list[dict[str, str]]) -> str:
    """State the parameters with which the classic iteration converges, on a wall whose right third or right half settles."""
    lines = []
    for sweep, words in (("iteration", "right third"), ("iteration_half", "right half")):
        many = [row for row in rows if row["sweep"] == sweep]
        solved = [row for row in many if row["classic_status"] == "solved"]
        ends = [float(row["classic"]) / float(row["coulomb_high"]) for row in solved]
        relaxations, slopes = ([float(row[f"classic.{name}"]) for row in solved] for name in ("relaxation", "slope"))
        lines.append(
            f"{words.capitalize()}: the iteration converges for {len(solved)} of {len(many)} settings, all with relaxations of "
            f"{span(relaxations)} and slopes of {span(slopes)}. It takes {span([float(row['classic_iterations']) for row in solved])} "
            f"programmes and ends at {span([100.0 * end for end in ends], 4)} % of the upper end of the interval. Other settings end as "
            f"{listed(sorted({row['classic_status'] for row in many} - {'solved'}))}."
        )
    return sentences(lines)


def main() -> None:
    for name, page in pages().items():
        (GALLERY / name).write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
