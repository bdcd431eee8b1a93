"""Tests every law of `test_random_laws.py` and `test_random_loads.py` on many scenes, and writes the counts into random_laws.md.

    python tests/benchmarks/random_laws_report.py -o comparison/gallery [--scenes 500] [--laws WORD ...]

Failing scenes are not shrunk here, so that every scene counts once; `pytest --hypothesis-profile long` shrinks them.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import pickle
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import test_random_laws
import test_random_loads
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis.errors import UnsatisfiedAssumption
from independent_mechanics import drives
from random_scenes import random_scenes
from rich.console import Console

from la_core.coulomb import predict
from la_core.limit.problem import Drive
from la_core.limit.associated import Status, solve_associated
from la_core.limit.static import coulomb_limits, solve_static
from la_core.model.assembly import assemble
from la_core.model.joints import joint_stiffness
from la_core.scene.scene import Scene

INTRODUCTION = """\
# Laws under random structures

The structures have 2 to 15 free blocks: walls with openings, piles, posts and lintels, arches, rubble and crossed beams, in the plane and
in space. Friction is 0 to 1.5, sometimes 1e-6 or 5; densities are equal or differ by up to 1 : 1000; gravity is sometimes tilted. Any part
of the base settles in any direction or turns, or there is a live load. Many structures cannot stand. *scenes* counts those to which the law
applies. Written by `python tests/benchmarks/random_laws_report.py -o comparison/gallery`.
"""
LOADS = """
The same structures with up to three forces, three masses and two ties of up to 1.5 times the weight of the mean block, and with friction of
their own in some classes of joints:
"""

MODULES = (test_random_laws, test_random_loads)
METHODS = ("kinematic form", "static form", "Coulomb prediction")


@dataclass
class Count:
    """Outcome of one law. `failures` holds the arguments for which the law failed."""

    law: str
    scenes: int = 0
    failures: list[dict[str, Any]] = field(default_factory=list)
    seconds: float = 0.0


def laws(module: ModuleType, words: list[str]) -> Iterator[Callable]:
    """Yield the hypothesis tests of a module. words: if any, only tests whose name has one of them."""
    for name, test in vars(module).items():
        if name.startswith("test_") and hasattr(test, "hypothesis") and (not words or any(word in name for word in words)):
            yield test


def many(scenes: int) -> settings:
    """Return settings for this number of scenes, the same in every run, without shrinking."""
    quiet = settings(max_examples=scenes, derandomize=True, deadline=None, database=None, phases=[Phase.generate])
    return settings(quiet, suppress_health_check=list(HealthCheck))


def words_of(test: Callable) -> str:
    """Return the law in words."""
    return (test.__doc__ or test.__name__).strip()


def counted(test: Callable, scenes: int) -> Count:
    """Test one law on this number of scenes, and go on after failures."""
    law = test.hypothesis.inner_test  # type: ignore[attr-defined]
    count = Count(words_of(test))

    def try_one(**given: Any) -> None:
        try:
            law(**given)
        except UnsatisfiedAssumption:
            raise
        except Exception:  # every error counts as a failure
            count.failures.append(given)
        count.scenes += 1

    start = time.perf_counter()
    test.hypothesis.inner_test = try_one  # type: ignore[attr-defined]
    many(scenes)(test)()
    count.seconds = time.perf_counter() - start
    return count


def census(scenes: int) -> dict[str, Counter[str]]:
    """Count the statuses of each method over this number of scenes. Only structures that stand have a Coulomb prediction."""
    statuses = {method: Counter() for method in METHODS}

    @many(scenes)
    @given(scene=random_scenes())
    def look(scene: Scene) -> None:
        assembly = assemble(scene)
        for drive in drives(assembly):
            solution = solve_associated(assembly, drive)
            static = solve_static(assembly, drive, *coulomb_limits(assembly))
            for method, one in zip(METHODS, (solution, static), strict=False):
                statuses[method][one.status.value] += 1
            if solution.status is Status.SOLVED and drive is not Drive.PUSHING:
                prediction = predict(assembly, joint_stiffness(assembly, {}), solution)
                statuses[METHODS[2]][prediction.status.value] += 1

    look()
    return statuses


def write_page(path: Path, counts: list[Count], scenes: int) -> None:
    """Write the page; laws that were not counted this time keep their rows."""
    rows = {count.law: f"| {count.law} | {count.scenes} | {len(count.failures)} |" for count in counts}
    before = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    lines = []
    for module, words in zip(MODULES, ("", LOADS), strict=True):
        lines += [*words.splitlines(), "", "| law | scenes | failures |", "|---|---|---|"]
        for law in (words_of(test) for test in laws(module, [])):
            lines += [rows[law]] if law in rows else [line for line in before if line.startswith(f"| {law} |")]
    lines += [
        "",
        f"Answers by status, of {scenes} further scenes:",
        "",
        f"| method | {' | '.join(Status)} |",
        "|---" * (len(Status) + 1) + "|",
    ]
    for method, found in census(scenes).items():
        lines.append(f"| {method} | {' | '.join(str(found[status.value]) for status in Status)} |")
    path.write_text(INTRODUCTION + "\n".join(lines) + "\n", encoding="utf-8")


def main() -> int:
    """Count, write the table, and on request write the failed scenes to a file. Return 1 if any scene failed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, help="folder for random_laws.md")
    parser.add_argument("--scenes", type=int, default=500, help="for each law")
    parser.add_argument("--laws", nargs="*", default=[], help="only those whose name has one of these words; others keep their rows")
    parser.add_argument("--failures", type=Path, help="file to pickle the scenes that failed into")
    options = parser.parse_args()
    console, counts = Console(stderr=True, soft_wrap=True), []
    for test in (test for module in MODULES for test in laws(module, options.laws)):
        counts.append(counted(test, options.scenes))
        console.print(f"{counts[-1].seconds:6.1f} s  {counts[-1].scenes:4d} scenes, {len(counts[-1].failures)} failures: {counts[-1].law}")
    if options.failures:
        options.failures.write_bytes(pickle.dumps({count.law: count.failures for count in counts}))
    if options.output:
        write_page(options.output / "random_laws.md", counts, options.scenes)
    return 1 if any(count.failures for count in counts) else 0


if __name__ == "__main__":
    sys.exit(main())
