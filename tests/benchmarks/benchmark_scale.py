"""Cost of limit analysis of large structures: seconds per stage, iterations, residuals and peak memory, and their growth.

    python tests/benchmarks/benchmark_scale.py [--plane N ...] [--space N ...] [--corner N ...] [--building N ...] [--coulomb N ...]

The structures have about N blocks: running-bond walls in the plane and in 3D and two walls that meet in a corner, of which a third of one
base settles, and a building with windows on all sides, of which one corner settles. Every size runs in its own process. --coulomb follows
walls in the plane and in 3D to their plateau with Coulomb friction.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import multiprocessing
import time
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from functools import wraps
from typing import Any
from unittest.mock import patch

import numpy as np
import scenes
from process_memory import peak_memory
from rich.console import Console
from rich.table import Table

from la_core.coulomb import predict
from la_core.geometry import touching
from la_core.limit import associated, conic
from la_core.limit.problem import Drive
from la_core.limit.associated import Status
from la_core.model import assembly
from la_core.model.joints import joint_stiffness
from la_core.scene.scene import Scene

SIZES = {"plane": [1000, 5000, 20000], "space": [1000, 5000], "corner": [1000, 5000], "building": [1000, 5000], "coulomb": [1000]}
FIXED_SHARE = 0.66  # of the base's length
STOREY, BAY, SOLID_SHARE = 14, 2.4, 0.79  # of a building: courses per storey, m of wall per window, share of the wall without openings
LENGTH, DEPTH, HEIGHT = 0.4, 0.2, 0.2  # of a block, m; a block's depth is half its length, so that a corner keeps the bond
STAGES = {  # timed stages by name: the owner and the name of a function or method
    "scene": (scenes, "build"),
    "contacts": (touching, "_search"),
    "assembly": (assembly, "assemble"),
    "matrix": (associated, "scaled_problem"),
    "conversion": (conic.Programme, "__init__"),
    "solve": (conic.Programme, "solve"),
    "evidence": (associated, "_with_evidence"),
}
SOLVER = ("conversion", "solve")


@dataclass(frozen=True)
class Run:
    """Measurements of one size: seconds by stage and in total, and residuals of the answer. memory: peak of the process, MiB."""

    kind: str
    blocks: int
    rows: int
    stages: dict[str, float]
    total: float
    status: Status
    iterations: int
    residual: float
    reaction: float
    memory: float

    @property
    def solver(self) -> float:
        """Seconds inside the solver."""
        return sum(self.stages[name] for name in SOLVER)


def wall(size: int, plane: bool, **options: Any) -> Scene:
    """Build a wall of about `size` blocks, as many courses as blocks per course. options: further options of `scenes.build`."""
    courses = round(size**0.5)
    per_course = round(size / (courses + 0.5))
    parts = scenes.wall(per_course, courses, FIXED_SHARE * LENGTH * per_course, (LENGTH, DEPTH, HEIGHT))
    return scenes.build(*parts, inset=0.001, plane=plane, **options)


def corner(size: int) -> Scene:
    """Build two walls that meet and interlock, of about `size` blocks together. A third of one wall settles."""
    courses = round((size / 2) ** 0.5)
    end = LENGTH * round(size / (2 * courses))
    return _building("L", (end, end), courses, settling=((FIXED_SHARE * end, -DEPTH), (end + DEPTH, DEPTH)))


def building(size: int) -> Scene:
    """Build storeys of 14 courses on a rectangle, with windows on all sides and a door, of about `size` blocks. One corner settles."""
    storeys = max(1, round((size / 1000) ** (1 / 3)))
    bays = max(5, round(size / (SOLID_SHARE * STOREY * storeys) * LENGTH / (2.0 * BAY)))  # in the south and the east wall together
    along = -(-bays * 4 // 7)
    length, depth = along * BAY, (bays - along) * BAY
    openings = [
        _opening(side, bay, storey, door=(side, bay, storey) == ("south", along // 2, 0))
        for side, count in (("south", along), ("north", along), ("east", bays - along), ("west", bays - along))
        for bay in range(count)
        for storey in range(storeys)
    ]
    settling = ((length - 1.25 * BAY, -DEPTH), (length + DEPTH, BAY))
    return _building("rectangle", (length, depth), STOREY * storeys, settling, openings)


def _opening(side: str, bay: int, storey: int, door: bool) -> dict[str, Any]:
    """Return a window or a door in the middle of a bay. Their lengths are even numbers of half blocks."""
    middle, floor = (bay + 0.5) * BAY, storey * STOREY * HEIGHT
    sill = floor if door else floor + 5 * HEIGHT
    start, stop = (round(middle - 0.6, 6), round(sill, 6)), (round(middle + 0.6, 6), round(floor + 10 * HEIGHT, 6))
    return {"side": side, "from": start, "to": stop, "bearing": 0.3}


def _building(
    plan: str, size: tuple[float, float], courses: int, settling: tuple[tuple[float, float], ...], openings: Sequence[dict[str, Any]] = ()
) -> Scene:
    foundation = {"height": HEIGHT, "settling": {"from": settling[0], "to": settling[1]}}
    block = (LENGTH, DEPTH, HEIGHT)
    parts = [
        scenes.table("[building]", plan=plan, origin=(0.0, 0.0, 0.0), size=size, block=block, courses=courses, foundation=foundation),
        *(scenes.table("[building.opening]", **opening) for opening in openings),
    ]
    return scenes.build("\n".join(parts), inset=0.001)


def patched(stages: dict[str, tuple[Any, str]], spent: Counter) -> ExitStack:
    """Return a context that adds the seconds inside the function of each stage to `spent`, under the stage's name."""
    stack = ExitStack()
    for name, (owner, attribute) in stages.items():
        stack.enter_context(patch.object(owner, attribute, timed(getattr(owner, attribute), name, spent)))
    return stack


def timed(function: Callable, name: str, spent: Counter) -> Callable:
    """Return the function, wrapped so that its seconds are added to `spent` under a name."""

    @wraps(function)
    def wrapper(*args: object, **options: object) -> object:
        start = time.process_time()
        result = function(*args, **options)
        spent[name] += time.process_time() - start
        return result

    return wrapper


def build(kind: str, size: int) -> Scene:
    makers = {"corner": corner, "building": building}
    return makers[kind](size) if kind in makers else wall(size, plane=kind == "plane")


def measure(kind: str, size: int) -> Run:
    """Build and solve one scene for its least reaction."""
    spent: Counter = Counter(dict.fromkeys(STAGES, 0.0))
    start = time.process_time()
    with patched(STAGES, spent):
        model = assembly.assemble(build(kind, size))
        solution = associated.solve_associated(model, Drive.YIELDING)
    total = time.process_time() - start
    spent["scene"] -= spent["contacts"]  # the scene's checks search the contacts first, within the scene's time
    residual = max(solution.equilibrium_residual, solution.cone_violation, solution.mechanism_violation, solution.duality_gap)
    rows = len(model.points) * (4 if model.effects.plane else 3) // (2 if model.effects.plane else 1)
    return Run(
        kind, len(model.blocks), rows, dict(spent), total, solution.status, solution.iterations, residual,
        solution.value / model.weight, peak_memory(),
    )  # fmt: skip


def measure_coulomb(kind: str, size: int) -> tuple[str, ...]:
    """Return one row of the table of Coulomb predictions."""
    scene = build(kind, size)
    model = assembly.assemble(scene)
    bounds = associated.solve_associated(model, Drive.YIELDING)
    solution = predict(model, joint_stiffness(model, scene.yade), bounds)
    return (
        kind, f"{len(model.blocks)}", solution.status, f"{solution.value / model.weight:.6f}", f"{solution.iterations}",
        f"{solution.seconds:.1f}", f"{solution.dilatancy_residual:.1e}", f"{bounds.seconds:.1f}",
    )  # fmt: skip


def alone(function: Callable, *args: object) -> object:
    """Call a function in its own process and return its result."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(function, args)


def exponent(runs: list[Run], seconds: Callable[[Run], float]) -> float:
    """Return the exponent of growth with the number of blocks, fitted to all sizes."""
    return float(np.polyfit(np.log([run.blocks for run in runs]), np.log([seconds(run) for run in runs]), 1)[0])


def listing(runs: list[Run]) -> Table:
    """One row per size. The caption has the exponents of each kind."""
    table = Table(title="Seconds per stage; residual: the largest recomputed one; outside: share of the total outside the solver")
    heads = ("kind", "blocks", "rows", *STAGES, "total", "outside", "iterations", "status", "residual", "R/W", "MiB")
    for head in heads:
        table.add_column(head, justify="right")
    for run in runs:
        stages = (f"{run.stages[name]:.2f}" for name in STAGES)
        share, quality = f"{1.0 - run.solver / run.total:.0%}", (f"{run.iterations}", run.status, f"{run.residual:.0e}")
        table.add_row(
            run.kind, f"{run.blocks}", f"{run.rows}", *stages, f"{run.total:.2f}", share, *quality,
            f"{run.reaction:.7f}", f"{run.memory:.0f}",
        )  # fmt: skip
    for kind in dict.fromkeys(run.kind for run in runs):
        same = [run for run in runs if run.kind == kind]
        if len(same) > 1:
            table.caption = (
                f"{table.caption or 'Growth as blocks to the power of:'} {kind}: solver {exponent(same, lambda r: r.solver):.2f}, "
            )
            table.caption += f"total {exponent(same, lambda r: r.total):.2f}. "
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for kind in SIZES:
        parser.add_argument(f"--{kind}", type=int, nargs="*", metavar="N")
    options = vars(parser.parse_args())
    if all(sizes is None for sizes in options.values()):
        options = {kind: [] for kind in SIZES if kind != "coulomb"}
    asked = {kind: sizes or SIZES[kind] for kind, sizes in options.items() if sizes is not None}
    console = Console(width=200)
    coulomb = asked.pop("coulomb", [])
    runs = []
    for kind, sizes in asked.items():
        for size in sizes:
            runs.append(alone(measure, kind, size))
            console.print(f"{kind} {size}: {runs[-1].total:.1f} s")
    if runs:
        console.print(listing(runs))
    if coulomb:
        table = Table("kind", "blocks", "status", "R/W", "programmes", "seconds", "dilatancy", "associated s", title="Coulomb prediction")
        for kind, size in ((kind, size) for kind in ("plane", "space") for size in coulomb):
            table.add_row(*alone(measure_coulomb, kind, size))
        console.print(table)


if __name__ == "__main__":
    main()
