"""Errors and cost at three requested accuracies: the shipped scenes of known value, and the wall.

    python tests/benchmarks/benchmark_accuracy.py [-o comparison/gallery/accuracy.md] [SCENE ...]

Each row is a run of `crosscheck run SCENE --accuracy SHARE`. It shows two errors of each method: the difference from the scene's exact or
published value, and the method's own estimate.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import re
import tempfile
from pathlib import Path
from typing import Any

from marked_text import listed, marked, sentences
from rich.console import Console
from scenes import shipped

from comparison import figures
from comparison.numbers import percent
from comparison.numbers import DASH
from comparison.progress import Narration
from comparison.provenance import describe
from comparison.workflow import one_scene
from la_core.analysis.accuracy import with_accuracy
from la_core.text_table import number_text

ACCURACIES = (0.05, 0.01, 0.002)
FINE = 0.001  # the finest accuracy that may be requested; for the wall alone, to show the cost of accuracy
SCENES = (
    "two_pads", "trilith", "slab_four_corners", "flat_arch", "two_blocks", "stack_bond_wall", "arch_spreading", "arch_settling",
    "arch_diagonal", "vault_spreading", "ferris_tin_loi_1", "ferris_tin_loi_2", "wall_third",
)  # fmt: skip
COARSE = ("computed",)  # values known to one per cent only: no error is stated, except for arches, whose values have five digits
FIVE_DIGITS = 1e-4
WALL = "wall_third"  # the scene whose cost is compared between accuracies
INTRODUCTION = (
    "# What a requested accuracy costs, and whether it is kept",
    "",
    "Every row is one run of `crosscheck run SCENE --accuracy SHARE`. Its answer is the reaction where a support settles, and the",
    "multiplier under a live load. *asked* is the requested accuracy. *error* is the difference from the scene's exact or published value,",
    "where one exists. *estimated* is each method's own estimate of its error, which must not exceed *asked*. *s* is each method's time in",
    "seconds.",
    "",
    "`python tests/benchmarks/benchmark_accuracy.py -o comparison/gallery/accuracy.md`",
    "",
)
HEAD = ("scene", "asked", "limit analysis: error", "estimated", "s", "YADE: error", "estimated", "s", "steps", "verdict")


def accuracies(name: str) -> tuple[float, ...]:
    """Return the accuracies requested of a scene."""
    return (*ACCURACIES, FINE) if name == WALL else ACCURACIES


def measured(name: str, accuracy: float, folder: Path, narration: Narration) -> list[str]:
    """Run a scene at one accuracy and return the cells of its row."""
    scene = with_accuracy(shipped(name), accuracy)
    summary = one_scene.run_scene(scene, folder / f"{name}-{accuracy}", narration, with_yade=True)
    expected, bought, yade = scene.expected, summary["accuracy"], summary["yade"] or {}
    exact = None
    if expected is not None and (expected.kind not in COARSE or expected.tolerance <= FIVE_DIGITS):
        exact = expected.multiplier if scene.live is not None else (expected.reaction_over_weight or 0.0) * scene.weight
    answer = summary["limit_analysis"]["coulomb"] or summary["limit_analysis"]["associated"]
    found = {"limit_analysis": answer.get("shared_inset", answer)[scene.quantity], "yade": yade.get("reaction")}
    cells = [f"`{name}`", percent(accuracy)]
    for method, value in found.items():
        own: dict[str, Any] = bought.get(method) or {}
        error = percent(abs(value / exact - 1.0)) if exact and value is not None else DASH
        cells += [error, percent(own.get("error")), number_text(own.get("seconds"), 2)]
    return [*cells, number_text(yade.get("steps")) if yade.get("steps") else DASH, summary["verdict"]]


def page(rows: list[list[str]], facts: str) -> str:
    """Return the page as Markdown. rows: cells from `measured`; facts: machine and versions in a line."""
    lines = [*INTRODUCTION, facts, "", marked("conclusions", conclusions(rows)), "", f"| {' | '.join(HEAD)} |", "|" + "---|" * len(HEAD)]
    return "\n".join([*lines, *(f"| {' | '.join(row)} |" for row in rows)]) + "\n"


def stored_page(path: Path) -> str:
    """Return the page, written again from its own table. Nothing is run."""
    text = path.read_text(encoding="utf-8")
    (facts,) = re.findall(r"^python \d.*$", text, re.MULTILINE)
    return page(stored_rows(text), facts)


def stored_rows(text: str) -> list[list[str]]:
    """Return the cells of every row of the page's table."""
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("| `")]


def conclusions(rows: list[list[str]]) -> str:
    """Return the conclusions from the rows, as a list."""
    missed = [f"{row[0]} at {row[1]}" for row in rows if not is_kept(row)]
    kept = f"Missed by {listed(missed)}." if missed else "No error and no estimate is larger than the accuracy requested."
    lines = [f"{len(rows)} runs of {len({row[0] for row in rows})} scenes. {kept}"]
    times = {row[1]: as_number(row[4]) + as_number(row[7]) for row in rows if row[0] == f"`{WALL}`"}
    fine_name = percent(FINE)
    if {"1 %", fine_name} <= set(times):
        coarse, fine = times["1 %"], times[fine_name]
        lines.append(
            f"On `{WALL}` an accuracy of 1 % takes {number_text(coarse, 2)} s, which is {number_text(coarse / fine, 2)} "
            f"of the {number_text(fine, 2)} s for {fine_name}."
        )
    return sentences(lines)


def is_kept(row: list[str]) -> bool:
    """Return True if the errors and estimates of both methods are within the requested accuracy."""
    return all(as_number(row[k]) <= as_number(row[1]) for k in (2, 3, 5, 6) if row[k] != DASH)


def as_number(cell: str) -> float:
    """Return a cell's number, in per cent or seconds."""
    return float(cell.removesuffix(" %"))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("-o", "--output", type=Path)
    options = parser.parse_args()
    figures.report_figures = lambda *results: {}  # type: ignore[assignment]  # the measured times leave out figures
    with tempfile.TemporaryDirectory() as folder, Narration(Console(stderr=True)) as narration:
        rows = [measured(name, accuracy, Path(folder), narration) for name in options.scenes for accuracy in accuracies(name)]
    text = page(rows, ", ".join(f"{key} {value}" for key, value in describe().items() if key != "crosscheck"))
    print(text)
    if options.output:
        options.output.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
