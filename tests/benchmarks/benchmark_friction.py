"""What the accuracy of Coulomb limit analysis costs: steps to the plateau against the reaction of a finely followed path.

    python tests/benchmarks/benchmark_friction.py [--quick] [--verbose]

Running-bond walls, sharp arrises, a third or half of the base settles. All cases run in parallel; times are the solver's own.
"""

import on_path  # noqa: F401, I001  before what it makes importable
import argparse
import itertools
import os
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass

import numpy as np
import scenes
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from la_core.coulomb.elastic_joints import ElasticJoints, JointState, Trial
from la_core.coulomb.plateau import STEPS, PredictionSettings, follow, predict
from la_core.limit.problem import Drive
from la_core.limit.associated import Status, solve_associated
from la_core.model.assembly import Assembly, assemble
from la_core.model.joints import JointStiffness, joint_stiffness

WALLS = ((4, 3), (6, 5), (7, 6), (6, 10), (10, 6), (12, 8), (16, 10), (20, 12))  # blocks per course, courses
FRICTION = (0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
PARTS = (3, 2)  # a third, half of the base settles
COUNTS = (1, 2, 4, 8)  # steps to the plateau
REFERENCE = 16
NEAR, FAR = 0.01, 0.05  # of the reference reaction
LEAST = 1e-3  # of the weight: a reaction below it is judged by this


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
    """Outcome of one prediction, value over the weight."""

    status: Status
    value: float
    solves: int
    dilatancy: float
    seconds: float


@dataclass(frozen=True)
class Result:
    """Runs of one case by their number of steps, and the solves after which one step's value stays NEAR its end value."""

    case: Case
    runs: dict[int, Run]
    settled_after: int

    def deviation(self, steps: int) -> float:
        """Of a run from the reference, relative; infinite without a value."""
        reference, value = self.runs[REFERENCE].value, self.runs[steps].value
        return abs(value - reference) / max(abs(reference), LEAST) if np.isfinite(value - reference) else np.inf


class Listening(ElasticJoints):
    """Joints that remember the value of every solve."""

    def __init__(self, assembly: Assembly, stiffness: JointStiffness) -> None:
        super().__init__(assembly, stiffness)
        self.values: list[float] = []

    def solve(self, before: JointState, motion: np.ndarray, shift: np.ndarray, live: float | None = None) -> Trial:
        trial = super().solve(before, motion, shift, live)
        self.values.append(self.value(trial))
        return trial


def settled_after(assembly: Assembly, stiffness: JointStiffness) -> int:
    """Solves of a single step to the whole travel after which the value stays within NEAR of the step's result."""
    joints = Listening(assembly, stiffness)
    rest, last = follow(joints, np.array([1.0]), stiffness)
    end = joints.value(last.trial)
    off = np.flatnonzero(np.abs(np.array(joints.values[rest.solves :]) - end) > NEAR * max(abs(end), LEAST))
    return int(off[-1]) + 2 if len(off) else 1


def run(case: Case) -> Result:
    """Predict one case with every number of steps."""
    parts = scenes.wall(case.per_course, case.courses, split=0.4 * (case.per_course - case.settling))
    scene = scenes.build(*parts, friction=case.friction)
    assembly = assemble(scene)
    stiffness, associated = joint_stiffness(assembly, 0.0, {}), solve_associated(assembly, Drive.YIELDING)
    runs = {}
    for steps in (*COUNTS, REFERENCE):
        answer = predict(assembly, stiffness, associated, settings=PredictionSettings(steps))
        runs[steps] = Run(answer.status, answer.value / assembly.weight, answer.iterations, answer.dilatancy_residual, answer.seconds)
    return Result(case, runs, settled_after(assembly, stiffness))


def cases(quick: bool) -> Iterator[Case]:
    """All walls; a handful of small ones if quick."""
    for (per_course, courses), friction, part in itertools.product(WALLS[:4] if quick else WALLS, (0.3, 0.6) if quick else FRICTION, PARTS):
        yield Case(per_course, courses, friction, per_course // part)


def run_all(todo: list[Case], workers: int, console: Console) -> list[Result]:
    """Run the cases, the largest first, in their own processes; results in the cases' order."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    found: dict[Case, Result] = {}
    with ProcessPoolExecutor(workers) as pool, Progress(*columns, console=console) as progress:
        task = progress.add_task("walls", total=len(todo))
        for future in as_completed([pool.submit(run, case) for case in reversed(todo)]):
            found[future.result().case] = future.result()
            progress.advance(task)
    return [found[case] for case in todo]


def summary(results: list[Result]) -> Table:
    """One row per number of steps."""
    title = (
        f"{len(results)} walls. Solves: median, 90 %, max. Cases within {NEAR:.0%} and {FAR:.0%} of the reaction of {REFERENCE} steps, "
        "the worst, the largest dilatancy residual, cases not solved, seconds of all."
    )
    table = Table(title=title, caption=settling_caption(results))
    names = ("steps", "solves", f"in {NEAR:.0%}", f"in {FAR:.0%}", "worst", "dilatancy", "not solved", "s")
    for name in names:
        table.add_column(name, justify="right")
    for steps in (*COUNTS, REFERENCE):
        runs = [result.runs[steps] for result in results]
        solves, off = np.array([r.solves for r in runs]), np.array([result.deviation(steps) for result in results])
        row = [
            f"{np.median(solves):.0f}, {np.quantile(solves, 0.9):.0f}, {solves.max()}",
            *(f"{np.sum(off <= limit)}" for limit in (NEAR, FAR)),
            f"{off.max():.1%}",
            f"{np.nanmax([r.dilatancy for r in runs]):.1e}",
            f"{sum(r.status is not Status.SOLVED for r in runs)}",
            f"{sum(r.seconds for r in runs):.1f}",
        ]
        table.add_row(f"{steps}{' *' if steps == STEPS else ''}", *row)
    return table


def settling_caption(results: list[Result]) -> str:
    after = np.array([result.settled_after for result in results])
    numbers = f"median {np.median(after):.0f}, 90 % {np.quantile(after, 0.9):.0f}, max {after.max()}"
    return f"* default. Solves of a single step after which its value stays within {NEAR:.0%} of its end value: {numbers}"


def listing(results: list[Result]) -> Table:
    """One row per wall: the reference and, for every number of steps, deviation and solves."""
    table = Table("wall", title="R/W of the reference; deviation and solves of fewer steps; solves after which a single step has settled")
    for name in ("reference", *(f"{steps}" for steps in COUNTS), "settled"):
        table.add_column(name, justify="right")

    def cell(result: Result, steps: int) -> str:
        entry = result.runs[steps]
        return f"{result.deviation(steps):.1%}  {entry.solves}" + ("" if entry.status is Status.SOLVED else f" {entry.status}")

    def reference(result: Result) -> str:
        entry = result.runs[REFERENCE]
        return f"{entry.value:.4f}  {entry.solves}" + ("" if entry.status is Status.SOLVED else f" {entry.status}")

    for result in results:
        table.add_row(str(result.case), reference(result), *(cell(result, steps) for steps in COUNTS), str(result.settled_after))
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="a handful of small walls")
    parser.add_argument("--verbose", action="store_true", help="list every wall")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes")
    options = parser.parse_args()
    console = Console()
    results = run_all(list(cases(options.quick)), options.workers, console)
    if options.verbose:
        console.print(listing(results))
    console.print(summary(results))


if __name__ == "__main__":
    main()
