"""Accuracy and cost of the Coulomb prediction: its stated uncertainty against viscosities and steps ten times finer.

    python tests/benchmarks/benchmark_friction.py [--quick] [--large] [--verbose] [-o RECORD.json]
    python tests/benchmarks/benchmark_friction.py --write

Running-bond walls, sharp arrises, a third or half of the base settles. Every wall is predicted with the default viscosities,
with coarser ones, and with the reference: viscosities and steps ten times finer. The record holds every value. --write runs nothing:
it writes the table and the figure of the page friction.md from the record in the gallery.
"""

import on_path  # noqa: F401, I001  before what it makes importable
import argparse
import itertools
import json
import os
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scenes
from marked_text import sentences, with_part
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from comparison.figures import FAINT, INK, method_colour
from comparison.judge.requested_accuracy import percent
from la_core.coulomb import PredictionSettings, predict
from la_core.limit import Drive, solve_associated
from la_core.model import assemble, joint_stiffness
from la_core.text_table import number_text

GALLERY = Path(__file__).parents[2] / "comparison" / "gallery"
RECORD, PART = "friction.json", "predictions"  # record in the gallery; part of friction.md that is written from it
WALLS = ((4, 3), (6, 5), (7, 6), (6, 10), (10, 6), (12, 8))  # blocks per course, courses
LARGE_WALLS = ((16, 10), (20, 12))  # half a minute each, two by the reference
FRICTION = (0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
PARTS = (3, 2)  # a third, half of the base settles
COARSER, DEFAULT, REFERENCE = "coarser", "default", "reference"
SETTINGS = {
    COARSER: PredictionSettings((1e-1, 1e-2)),
    DEFAULT: PredictionSettings(),
    REFERENCE: PredictionSettings(
        tuple(viscosity / 10.0 for viscosity in PredictionSettings().viscosities), finer=10.0, effort=3.0 * PredictionSettings().effort
    ),
}
LEAST = 1e-3  # of the weight: a reaction below it is judged by this
ALIKE = 1e-6  # relative: a smaller difference is none
FAR = 0.01  # relative: a difference that would decide a verdict


@dataclass(frozen=True)
class Case:
    """One wall with its friction and the number of blocks of the base that settle."""

    per_course: int
    courses: int
    friction: float
    settling: int

    def __str__(self) -> str:
        return f"{self.per_course} x {self.courses}, {self.settling} settle, mu {self.friction}"


@dataclass(frozen=True)
class Run:
    """One prediction; value, uncertainty and plateaus over the weight."""

    status: str
    value: float
    uncertainty: float
    plateaus: tuple[float, ...]
    travel: float
    certificate: float
    iterations: int
    seconds: float


@dataclass(frozen=True)
class Result:
    """Runs of one wall by the name of their settings."""

    case: Case
    runs: dict[str, Run]

    @property
    def scale(self) -> float:
        """Size that differences are relative to."""
        return max(abs(self.runs[REFERENCE].value), LEAST)

    def deviation(self, name: str) -> float:
        """Difference from the reference, relative; infinite without a value."""
        off = abs(self.runs[name].value - self.runs[REFERENCE].value)
        return off / self.scale if np.isfinite(off) else np.inf

    def excess(self, name: str) -> float:
        """Difference from the reference over the stated uncertainty; a difference of a millionth always holds."""
        return self.deviation(name) / max(self.runs[name].uncertainty / self.scale, ALIKE)


def run(case: Case) -> Result:
    """Predict one wall with all settings."""
    parts = scenes.wall(case.per_course, case.courses, split=0.4 * (case.per_course - case.settling))
    assembly = assemble(scenes.build(*parts, friction=case.friction))
    stiffness, associated = joint_stiffness(assembly, 0.0, {}), solve_associated(assembly, Drive.YIELDING)
    runs = {}
    for name, settings in SETTINGS.items():
        answer = predict(assembly, stiffness, associated, settings=settings)
        runs[name] = Run(
            answer.status.value,
            answer.value / assembly.weight,
            answer.uncertainty / assembly.weight,
            tuple((answer.plateaus / assembly.weight).tolist()),
            answer.travel,
            answer.certificate,
            answer.iterations,
            answer.seconds,
        )
    return Result(case, runs)


def cases(quick: bool, large: bool = False) -> Iterator[Case]:
    """All walls but the large ones; a handful of small ones if quick, and the large ones, too, if large."""
    walls = WALLS[:4] if quick else WALLS + (LARGE_WALLS if large else ())
    for (per_course, courses), friction, part in itertools.product(walls, (0.3, 0.6) if quick else FRICTION, PARTS):
        yield Case(per_course, courses, friction, per_course // part)


def run_all(todo: list[Case], workers: int, console: Console, record: Path | None) -> list[Result]:
    """Run the cases in their own processes and write the record after each; results in the cases' order."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    found: dict[Case, Result] = {}
    with ProcessPoolExecutor(workers) as pool, Progress(*columns, console=console) as progress:
        task = progress.add_task("walls", total=len(todo))
        for future in as_completed([pool.submit(run, case) for case in todo]):
            found[future.result().case] = future.result()
            progress.advance(task)
            if record is not None:
                write(record, [found[case] for case in todo if case in found])
    return [found[case] for case in todo]


def write(record: Path, results: list[Result]) -> None:
    """Write the record, one wall a line."""
    lines = [json.dumps({"case": asdict(r.case), "runs": {name: asdict(one) for name, one in r.runs.items()}}) for r in results]
    record.write_text("[\n" + ",\n".join(lines) + "\n]\n", encoding="utf-8")


def read(record: Path) -> list[Result]:
    """Results of a record."""
    stored = json.loads(record.read_text(encoding="utf-8"))
    return [Result(Case(**row["case"]), {name: Run(**one) for name, one in row["runs"].items()}) for row in stored]


NAMES = (
    "settings",
    "median error",
    "90 %",
    "worst",
    "median uncertainty",
    "uncertainty holds",
    "worst excess",
    "several",
    "not solved",
    "s",
)


def rows(results: list[Result]) -> Iterator[tuple[str, ...]]:
    """One row for each setting: errors against the reference, stated uncertainties, and cost."""
    for name in SETTINGS:
        runs = [result.runs[name] for result in results]
        off = np.array([result.deviation(name) for result in results])
        stated = np.array([result.runs[name].uncertainty / result.scale for result in results])
        excess = np.array([result.excess(name) for result in results])
        errors = [percent(float(error)) for error in (np.median(off), np.quantile(off, 0.9), off.max())]
        holds = [f"{np.sum(excess <= 1.0)} of {len(results)}", f"{excess.max():.1f}"]
        yield (
            name,
            *(errors if name != REFERENCE else ["", "", ""]),
            percent(float(np.median(stated))),
            *(holds if name != REFERENCE else ["", ""]),
            f"{sum(len(one.plateaus) > 1 for one in runs)}",
            f"{sum(one.status != 'solved' for one in runs)}",
            f"{sum(one.seconds for one in runs):.0f}",
        )


def summary(results: list[Result]) -> Table:
    """One row for each setting."""
    table = Table(title=f"{len(results)} walls. Errors and uncertainties are relative to the reaction of the reference.")
    for name in NAMES:
        table.add_column(name, justify="right")
    for row in rows(results):
        table.add_row(*row)
    return table


def listing(results: list[Result]) -> Table:
    """One row for each wall."""
    table = Table("wall", "reference", "its uncertainty", "default", "off", "stated", "excess", "travel", "certificate", "plateaus")
    for result in results:
        fine, one = result.runs[REFERENCE], result.runs[DEFAULT]
        table.add_row(
            str(result.case),
            f"{fine.value:.6f}",
            f"{fine.uncertainty / result.scale:.3%}",
            f"{one.value:.6f}",
            f"{result.deviation(DEFAULT):.3%}",
            f"{one.uncertainty / result.scale:.3%}",
            f"{result.excess(DEFAULT):.1f}",
            f"{one.travel:.1f}",
            f"{one.certificate:.0e}",
            " ".join(f"{value:.4f}" for value in one.plateaus),
        )
    return table


def page_part(folder: Path = GALLERY) -> str:
    """Table and conclusions of the page friction.md, as the record in the folder has them."""
    results = read(folder / RECORD)
    table = [NAMES, ("---",) * len(NAMES), *rows(results)]
    return "\n".join(f"| {' | '.join(row)} |" for row in table) + "\n\n" + conclusions(results)


def conclusions(results: list[Result]) -> str:
    """What the table says, in a few sentences."""
    off = [result.deviation(DEFAULT) for result in results]
    each = sum(result.runs[DEFAULT].seconds for result in results) / len(results)
    return sentences(
        [
            f"By default nine predictions in ten are within {percent(float(np.quantile(off, 0.9)))} of the reference and all "
            f"{len(results)} within {percent(max(off))}, for {number_text(each, 2)} s a wall on average.",
            *_far(results),
            f"The stated uncertainty {_held(results, DEFAULT)}; that of coarser paths {_held(results, COARSER)}.",
        ]
    )


def _far(results: list[Result]) -> Iterator[str]:
    """What the walls state that are far from the reference, if there are any."""
    far = [result for result in results if result.deviation(DEFAULT) > FAR]
    if far:
        stated = min(result.runs[DEFAULT].uncertainty / result.scale for result in far)
        least = min(result.case.per_course * result.case.courses for result in far)
        yield (
            f"{len(far)} walls are off by more than {percent(FAR)}: they have {least} blocks and more, and each states at least "
            f"{percent(stated)}."
        )


def _held(results: list[Result], name: str) -> str:
    """On how many walls the stated uncertainty holds, and by how much it fails on the others."""
    excess = [result.excess(name) for result in results]
    held = sum(one <= 1.0 for one in excess)
    fails = f"; elsewhere the difference is up to {number_text(max(excess), 2)} times as large" if held < len(results) else ""
    return f"holds on {held} of {len(results)} walls{fails}"


def figure(results: list[Result]) -> Figure:
    """Draw the stated uncertainty of every wall over its difference from the reference, for coarser paths and for the default."""
    drawn = Figure(figsize=(5.6, 5.0), layout="constrained")
    FigureCanvasAgg(drawn)
    axes = drawn.subplots()
    looks: dict[str, dict[str, Any]] = {
        COARSER: {"marker": "^", "color": INK, "markerfacecolor": "none"},
        DEFAULT: {"marker": "o", "color": method_colour(DEFAULT)},
    }
    for name, look in looks.items():
        places = [(max(result.deviation(name), ALIKE), result.runs[name].uncertainty / result.scale) for result in results]
        axes.plot(*zip(*places, strict=True), linestyle="none", markersize=4.5, markeredgewidth=0.8, alpha=0.8, label=name, **look)
    axes.set(xscale="log", yscale="log", xlabel="difference from the reference (-)", ylabel="stated uncertainty (-)")
    ends = [ALIKE / 2.0, 2.0 * axes.get_ylim()[1]]
    axes.plot(ends, ends, color=INK, linewidth=0.8, linestyle="--", label="equal: above it the uncertainty holds")
    axes.set(xlim=(ALIKE / 2.0, None), ylim=(1e-4, None))
    axes.grid(True, which="major", color=FAINT, linewidth=0.4, alpha=0.6)
    axes.set_title(f"{len(results)} walls, relative to the reaction; differences below {ALIKE:g} are drawn there", fontsize=8)
    axes.legend(fontsize=8, loc="upper left")
    return drawn


def write_page(folder: Path = GALLERY) -> None:
    """Write the part of friction.md and the figure from the record in the folder."""
    page = folder / "friction.md"
    page.write_text(with_part(page.read_text(encoding="utf-8"), PART, page_part(folder)), encoding="utf-8")
    figure(read(folder / RECORD)).savefig(folder / "friction.png", dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="a handful of small walls")
    parser.add_argument("--large", action="store_true", help="walls of 160 and 240 blocks, too")
    parser.add_argument("--verbose", action="store_true", help="list every wall")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("-o", "--output", type=Path, metavar="RECORD", help="file for all values, JSON")
    parser.add_argument("--write", action="store_true", help="write the page friction.md and its figure from the record, and run nothing")
    options = parser.parse_args()
    if options.write:
        write_page()
        return
    console = Console()
    results = run_all(list(cases(options.quick, options.large)), options.workers, console, options.output)
    if options.verbose:
        console.print(listing(results))
    console.print(summary(results))


if __name__ == "__main__":
    main()
