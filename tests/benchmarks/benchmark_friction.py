"""Accuracy and cost of the Coulomb prediction: its stated uncertainty, compared with a reference of ten times finer viscosities and steps.

    python tests/benchmarks/benchmark_friction.py [--quick] [--large] [--verbose] [-o RECORD.json]
    python tests/benchmarks/benchmark_friction.py --smooth
    python tests/benchmarks/benchmark_friction.py --write

The structures are running-bond walls with sharp edges. A third or half of the base settles. Every wall is predicted with the default
viscosities, with coarser viscosities, and with those of the reference. The record holds every value. --smooth adds the predictions with
the smooth joints of large structures to the record in the gallery. --write runs nothing: it writes the tables and the figure of the page
friction.md from the record in the gallery.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import itertools
import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest import mock

import scenes
from friction_record import COARSER, DEFAULT, GALLERY, RECORD, REFERENCE, SMOOTH, Case, Result, Run, read, write
from friction_report import listing, summary, write_page
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from la_core.coulomb import PredictionSettings, predict, prediction
from la_core.limit import Drive, solve_associated
from la_core.model import assemble, joint_stiffness

WALLS = ((4, 3), (6, 5), (7, 6), (6, 10), (10, 6), (12, 8))  # blocks per course, courses
LARGE_WALLS = ((16, 10), (20, 12))  # half a minute each, two minutes with the reference's settings
FRICTION = (0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
PARTS = (3, 2)  # a third, half of the base settles
SETTINGS = {
    COARSER: PredictionSettings((1e-1, 1e-2)),
    DEFAULT: PredictionSettings(),
    REFERENCE: PredictionSettings(
        tuple(viscosity / 10.0 for viscosity in PredictionSettings().viscosities), finer=10.0, effort=3.0 * PredictionSettings().effort
    ),
}


def run(case: Case) -> Result:
    """Predict one wall with all settings."""
    return Result(case, predictions(case, SETTINGS))


def run_smooth(recorded: Result) -> Result:
    """Add to a wall's record its prediction with smooth joints. No wall here is large enough to get them by default."""
    with mock.patch.object(prediction, "LARGE", 0.0):
        return replace(recorded, runs=recorded.runs | predictions(recorded.case, {SMOOTH: SETTINGS[DEFAULT]}))


def predictions(case: Case, settings: dict[str, PredictionSettings]) -> dict[str, Run]:
    """Predict one wall with each of some settings."""
    parts = scenes.wall(case.per_course, case.courses, split=0.4 * (case.per_course - case.settling))
    assembly = assemble(scenes.build(*parts, friction=case.friction))
    stiffness, associated = joint_stiffness(assembly, {}), solve_associated(assembly, Drive.YIELDING)
    runs = {}
    for name, one in settings.items():
        answer = predict(assembly, stiffness, associated, settings=one)
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
    return runs


def cases(quick: bool, large: bool = False) -> Iterator[Case]:
    """Yield all walls except the large ones. quick: a few small walls instead; large: the large walls, too."""
    walls = WALLS[:4] if quick else WALLS + (LARGE_WALLS if large else ())
    for (per_course, courses), friction, part in itertools.product(walls, (0.3, 0.6) if quick else FRICTION, PARTS):
        yield Case(per_course, courses, friction, per_course // part)


def run_all(calls: Iterable[tuple[Callable[[Any], Result], Any]], workers: int, console: Console, record: Path | None) -> list[Result]:
    """Make calls, each a function and its argument, in several processes. Write the record after each. Results have the calls' order."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with ProcessPoolExecutor(workers) as pool, Progress(*columns, console=console) as progress:
        futures = [pool.submit(*call) for call in calls]
        task = progress.add_task("walls", total=len(futures))
        for _ in as_completed(futures):
            progress.advance(task)
            if record is not None:
                write(record, [future.result() for future in futures if future.done()])
    return [future.result() for future in futures]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="a handful of small walls")
    parser.add_argument("--large", action="store_true", help="walls of 160 and 240 blocks, too")
    parser.add_argument("--smooth", action="store_true", help="add predictions with smooth joints to the record in the gallery")
    parser.add_argument("--verbose", action="store_true", help="list every wall")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("-o", "--output", type=Path, metavar="RECORD", help="file for all values, JSON")
    parser.add_argument("--write", action="store_true", help="write the page friction.md and its figure from the record, and run nothing")
    options = parser.parse_args()
    if options.write:
        write_page()
        return
    console = Console()
    if options.smooth:
        write(GALLERY / RECORD, run_all([(run_smooth, one) for one in read(GALLERY / RECORD)], options.workers, console, None))
        write_page()
        return
    todo = [(run, case) for case in cases(options.quick, options.large)]
    results = run_all(todo, options.workers, console, options.output)
    if options.verbose:
        console.print(listing(results))
    console.print(summary(results))


if __name__ == "__main__":
    main()
