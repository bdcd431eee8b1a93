"""Cost of each effect in limit analysis, where it is on and where it is off, measured in turn in one run.

    python tests/benchmarks/benchmark_effects_limit.py [--blocks N] [--voussoirs N]

plane: both bounds of a running-bond wall of about N blocks. friction: the whole limit analysis of an arch whose joints do not slide.
elasticity: a small wall's plateau alone, and the path to it. reach: a long facade with one settling end. Times are CPU seconds, the best of
several rounds over all variants in turn; *solver* counts the cone programmes alone.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import scenes
from rich.console import Console
from rich.table import Table

from la_core.analysis.stage import analyse
from la_core.limit.problem import Drive
from la_core.limit.associated import solve_associated
from la_core.model.assembly import Assembly, assemble
from la_core.scene.scene import Scene

ROUNDS = 3
LONG = 20.0  # s; a longer solution is measured once
BLOCK = (0.4, 0.2, 0.2)  # m
FACADE = (60, 8)  # blocks per course, courses
END = 2.4  # m, length of the facade's settling end


@dataclass(frozen=True)
class Variant:
    """One choice of one effect, and the function that solves a scene with it."""

    effect: str
    choice: str
    solve: Callable[[], "Answer"]


@dataclass(frozen=True)
class Answer:
    """The model, its answer over the weight, and the solver's seconds."""

    assembly: Assembly
    value: float
    solver: float


def bounds(scene: Scene) -> Answer:
    """Solve for the least and greatest reaction alone."""
    assembly = assemble(scene)
    least, greatest = (solve_associated(assembly, drive) for drive in (Drive.YIELDING, Drive.PUSHING))
    return Answer(assembly, least.value / scene.weight, least.seconds + greatest.seconds)


def everything(scene: Scene) -> Answer:
    """Solve for bounds and prediction, with inset and sharp."""
    analysis = analyse(scene)
    solutions = [*analysis.bounds.values(), *analysis.sharp.bounds.values(), analysis.coulomb, analysis.sharp.coulomb, analysis.path]
    solver = sum(one.seconds for one in {id(one): one for one in solutions if one is not None}.values())
    answer = analysis.coulomb or analysis.bounds[Drive.YIELDING]
    return Answer(analysis.assembly, answer.value / scene.weight, solver)


def variants(blocks: int, voussoirs: int) -> list[Variant]:
    """Return all choices of every effect."""
    courses = round(blocks**0.5)
    per_course = round(blocks / courses)
    parts = scenes.wall(per_course, courses, 0.66 * BLOCK[0] * per_course, BLOCK)
    walls = {name: scenes.build(*parts, inset=0.001, plane=plane) for name, plane in (("plane", True), ("in space", False))}
    arch = {"friction": 0.7, "inset": 0.001, "settlement": (1.0, 0.0, 0.0)}
    arches = {model: scenes.build(scenes.arch(voussoirs, 0.15), model=model, **arch) for model in ("none-slides", "auto", "coulomb")}
    small = scenes.wall(10, 6, 2.0, BLOCK)
    strains = {name: scenes.build(*small, inset=0.001, model="auto", effects={"elasticity": name}) for name in ("plateau", "path")}
    long = scenes.wall(*FACADE, FACADE[0] * BLOCK[0] - END, BLOCK)
    facades = {
        name: scenes.build(*long, inset=0.001, model="coulomb", effects={"reach": reach})
        for name, reach in (("within reach", True), ("all blocks", False))
    }
    asked = (
        ("plane", walls, bounds),
        ("friction", arches, everything),
        ("elasticity", strains, everything),
        ("reach", facades, everything),
    )
    return [
        Variant(effect, choice, lambda scene=scene, work=work: work(scene))  # type: ignore[misc]
        for effect, choices, work in asked
        for choice, scene in choices.items()
    ]


def measure(found: list[Variant]) -> list[tuple[Variant, Answer, float]]:
    """Return each variant, its answer with the least solver seconds, and the least CPU seconds. Long solutions are measured once."""
    best, solver = [float("inf")] * len(found), [float("inf")] * len(found)
    answers: list[Answer] = []
    for turn in range(ROUNDS):
        for k, one in enumerate(found):
            if turn > 0 and best[k] > LONG:
                continue
            start = time.process_time()
            answer = one.solve()
            best[k], solver[k] = min(best[k], time.process_time() - start), min(solver[k], answer.solver)
            answers += [answer] if turn == 0 else []
    return [(one, replace(answer, solver=solver[k]), best[k]) for k, (one, answer) in enumerate(zip(found, answers, strict=True))]


def listing(rows: list[tuple[Variant, Answer, float]]) -> Table:
    """One row per variant; ratios are to the cheapest choice of the same effect."""
    table = Table(title="Limit analysis: what an effect costs, in seconds and over the cheapest choice")
    for head in ("effect", "modelled", "free blocks", "unknowns", "contact points", "R/W", "solver", "ratio", "total", "ratio"):
        table.add_column(head, justify="right")
    for one, answer, seconds in rows:
        solver, total = (min(of) for of in zip(*((a.solver, t) for v, a, t in rows if v.effect == one.effect), strict=True))
        free, points = int(answer.assembly.blocks.free.sum()), len(answer.assembly.points)
        unknowns = free * (3 if answer.assembly.effects.plane else 6)
        table.add_row(
            one.effect, one.choice, f"{free}", f"{unknowns}", f"{points}", f"{answer.value:.6f}", f"{answer.solver:.3g}",
            f"{answer.solver / solver:.1f}", f"{seconds:.3g}", f"{seconds / total:.1f}",
        )  # fmt: skip
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--blocks", type=int, default=1000)
    parser.add_argument("--voussoirs", type=int, default=301)
    options = parser.parse_args()
    Console(width=140).print(listing(measure(variants(options.blocks, options.voussoirs))))


if __name__ == "__main__":
    main()
