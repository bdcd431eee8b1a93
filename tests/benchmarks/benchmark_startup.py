"""Cost of a command beside its solver: loading the packages, the smallest commands, and the stages of `crosscheck solve` by size.

    python tests/benchmarks/benchmark_startup.py -o comparison/gallery [--beside DIR] [--repeats N] [--sizes N ...]

Times are processor seconds (user and system) and wall seconds of separate processes, the least of several. --beside times the sources of
another version in DIR in turn with these. Writes startup.md and startup.json.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from growth_report import table
from marked_text import listed, marked, sentences
from solve_stages import SOLVER

from comparison import provenance
from comparison.yade import installation

ROOT = Path(__file__).parents[2]
SIZES = {65: (10, 6), 250: (20, 12), 1000: (40, 25)}  # blocks of the wall, with its footing: blocks per course, and courses
LENGTH = 0.6  # of a block, m
REPEATS, ENOUGH = 9, 60.0  # times a process is started; seconds after which it is not started again
LARGE_SHARE, FROM_BLOCKS = 0.1, 250  # largest share for a stage beside the solver, and the least size to which this aim applies
NOTHING = 0.01  # s, resolution of the processor clock
SOLVE, RUN = 0.5, 1.2  # s that `solve two_pads` and `run two_pads` should take at most
LIBRARIES = "scipy.sparse.linalg, h5py, shapely, clarabel, pydantic.main, rich.console, rich.table, rich.progress"
COMMAND = "from comparison.__main__ import main; main()"
IMPORTS = {  # by name: the statement of a process
    "Python alone": "pass",
    "import numpy": "import numpy",
    "the libraries that `solve` needs": f"import {LIBRARIES}",
    "import la_core": "import la_core",
    "import comparison": "import comparison",
    "la_core.load and la_core.solve": "import la_core; la_core.load, la_core.solve",
    "comparison.run": "import comparison; comparison.run",
}
COMMANDS = {  # by name: arguments
    "crosscheck --help": ["--help"],
    "crosscheck solve two_pads --bounds": ["solve", "two_pads", "--bounds"],
    "crosscheck solve two_pads": ["solve", "two_pads"],
    "crosscheck run two_pads --no-yade": ["run", "two_pads", "--no-yade"],
    "crosscheck run two_pads": ["run", "two_pads"],
}
SOLVES, RUNS, NEEDED = "crosscheck solve two_pads", "crosscheck run two_pads", "the libraries that `solve` needs"
YADE_STARTS = "start of YADE alone"
CALL = f"""
import resource, sys
try:
    {COMMAND}
finally:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(used.ru_utime + used.ru_stime, file=sys.stderr)
"""  # a process prints the processor time of its child processes, which are YADE's
SCENE = """
title = "Wall on a footing whose right third settles"
stone.density = 2000.0
joint.friction = 0.6
settlement.direction = [0.0, 0.0, -1.0]
[[wall]]
bond = "running"
origin = [0.0, 0.0, 0.0]
block = [{length}, 0.4, 0.3]
per_course = {per_course}
courses = {courses}
footing = {{ height = 0.3, settling = [{split}, {end}] }}
"""
INTRODUCTION = """\
A small scene is solved in milliseconds, so its command takes little longer than the start of the program. The first table has the processor
seconds (user and system) of whole processes, each the least of several runs. The sources are compiled, as in an installed program. *of it
YADE* is the part of YADE's own process. *by the clock* is the time that a user waits.

The second table has the stages of `crosscheck solve` on walls in running bond whose right third settles: *loading* is the start of Python
and of the program, *solver* is set-up and solution of cone programmes and the steps of the paths, *evidence* is the certificate of an
answer, *reports* are the reports of a path on its progress, *rest* is everything else.

A busy machine takes more seconds than a quiet one. Two versions are therefore timed in turn, and only their ratio counts."""
STAGES = ("loading", "reading", "contacts", "model", SOLVER, "evidence", "reports", "writing", "tables", "rest")


def environment(sources: Path, caches: Path) -> dict[str, str]:
    """Return the variables of a process that loads these sources, compiled into their own folder. Only the first process compiles them."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    one_thread = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    return kept | one_thread | {"PYTHONPATH": str(sources), "PYTHONPYCACHEPREFIX": str(caches)}


def used(command: Sequence[str | Path], variables: dict[str, str], folder: Path) -> tuple[float, float, str]:
    """Run a process. Return its processor seconds with those of its children, its wall seconds, and the last line of its standard error.

    Raises RuntimeError where the process fails.
    """
    before, start = os.times(), time.perf_counter()
    ended = subprocess.run(command, env=variables, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    after, clock = os.times(), time.perf_counter() - start
    if ended.returncode not in (0, 4):  # 4: a prediction is inaccurate; its seconds count all the same
        raise RuntimeError(f"{command} ended with {ended.returncode}: {ended.stderr}")
    seconds = after.children_user - before.children_user + after.children_system - before.children_system
    return seconds, clock, (ended.stderr.splitlines() or [""])[-1]


def yade_start() -> list[str | Path]:
    """Return the command that loads YADE and does nothing else."""
    yade = installation.find_yade()
    return [yade.python, "-s", "-c", f"import sys; sys.path.insert(0, {str(yade.modules)!r}); import yade.utils"]


def starts(trees: dict[str, Path], repeats: int) -> list[dict[str, Any]]:
    """Return the least seconds of every statement and command with each tree of sources, in turn, and YADE's part of processor seconds."""
    rows = []
    with tempfile.TemporaryDirectory() as work:
        calls: dict[str, list[str | Path]] = {name: [sys.executable, "-c", statement] for name, statement in IMPORTS.items()}
        calls |= {name: [sys.executable, "-c", CALL, *arguments] for name, arguments in COMMANDS.items()}
        for name, call in calls.items():
            tried: dict[str, list[tuple[float, float, float]]] = {tree: [] for tree in trees}
            for attempt in range(repeats + 1):
                for tree, sources in trees.items():
                    with tempfile.TemporaryDirectory() as folder:  # an empty folder, so that no stored result is used
                        seconds, clock, told = used(call, environment(sources, Path(work) / tree), Path(folder))
                    if attempt:  # the first attempt compiles
                        tried[tree].append((seconds, float(told) if name in COMMANDS else 0.0, clock))
            best = {tree: (*min(many)[:2], min(one[2] for one in many)) for tree, many in tried.items()}
            rows.append({"name": name} | {tree: dict(zip(("seconds", "yade", "clock"), one, strict=True)) for tree, one in best.items()})
            print(f"{name}: {best}", flush=True)
        alone = [used(yade_start(), installation.yade_environment(), Path(work)) for _ in range(repeats)]
        seconds, clock = (min(one[number] for one in alone) for number in (0, 1))
        rows.append({"name": YADE_STARTS, "now": {"seconds": seconds, "yade": seconds, "clock": clock}})
    return rows


def wall(size: int) -> str:
    """Return the scene file of the wall of about `size` blocks."""
    per_course, courses = SIZES[size]
    split, end = (round(LENGTH * count, 1) for count in (per_course - per_course // 3, per_course))
    return SCENE.format(length=LENGTH, per_course=per_course, courses=courses, split=split, end=end)


def stages(size: int, options: Sequence[str], trees: dict[str, Path], repeats: int) -> dict[str, Any]:
    """Return the seconds by stage of the solution of a wall with each tree of sources, in turn. The quickest process counts."""
    found: dict[str, Any] = {"blocks": size, "options": list(options)}
    with tempfile.TemporaryDirectory() as work:
        scene = Path(work) / "wall.toml"
        scene.write_text(wall(size), encoding="utf-8")
        spent = 0.0
        for attempt in range(repeats + 1):
            for tree, sources in trees.items():
                variables = environment(sources, Path(work) / tree)
                if not attempt:
                    used([sys.executable, "-c", COMMAND, "solve", "two_pads"], variables, Path(work))  # compiles
                    continue
                with tempfile.TemporaryDirectory() as folder:
                    call = [sys.executable, Path(__file__).with_name("solve_stages.py"), "solve", scene, *options]
                    one = json.loads(used(call, variables, Path(folder))[-1])
                spent += one["total"]
                if tree not in found or one["total"] < found[tree]["total"]:
                    found[tree] = one
            if spent > ENOUGH:
                break
    print(f"{size} {options}: {found}", flush=True)
    return found


def conclusions(record: dict[str, Any]) -> str:
    """Return the conclusions of the record about the aims."""
    rows = {row["name"]: row for row in record["starts"]}
    solve, run, alone = (rows[name]["now"]["seconds"] for name in (SOLVES, RUNS, YADE_STARTS))
    clock = rows[RUNS]["now"]["clock"]
    libraries, yade = rows[NEEDED]["now"]["seconds"], rows[RUNS]["now"]["yade"]
    lines = [
        f"`{SOLVES}` takes {solve:.2f} s, {'within' if solve <= SOLVE else 'above'} the aim of {SOLVE:g} s; "
        f"{libraries:.2f} s of them, {libraries / solve:.0%}, pass while Python and libraries load, before a line of this program runs.",
        f"`{RUNS}` takes {run:.2f} s, {'within' if run <= RUN else 'above'} the aim of {RUN:g} s; {yade:.2f} s of them are in YADE, "
        f"which takes {alone:.2f} s to start. The rest, {run - yade:.2f} s, is this program and the libraries that draw its figures. "
        + (f"By the clock it takes {clock:.2f} s: these libraries are loaded while YADE starts." if clock < run else ""),
    ]
    if "before" in rows[SOLVES]:
        names = (SOLVES, "crosscheck solve two_pads --bounds", "crosscheck run two_pads --no-yade")
        ratios = ", ".join(f"{rows[name]['now']['seconds'] / rows[name]['before']['seconds']:.2f} for `{name}`" for name in names)
        by_clock = rows[RUNS]["now"]["clock"] / rows[RUNS]["before"]["clock"]
        lines.append(
            f"In the same run, the ratio to the time of the version before is {ratios}, and by the clock {by_clock:.2f} for `{RUNS}`."
        )
    for row in record["stages"]:
        if row["blocks"] >= FROM_BLOCKS:
            total = row["now"]["total"]
            large = [name for name in STAGES if name != SOLVER and row["now"].get(name, 0.0) > LARGE_SHARE * total]
            words = listed([f"{name} ({row['now'][name] / total:.0%})" for name in large]) if large else "nothing"
            lines.append(f"`{command_of(row)}`, {row['blocks']:,} blocks: beside the solver, {words} takes more than {LARGE_SHARE:.0%}.")
    return sentences(lines)


def command_of(row: dict[str, Any]) -> str:
    """Return the command whose stages a row has."""
    return " ".join(("crosscheck solve", *row["options"]))


def page(record: dict[str, Any]) -> str:
    """Return the page of a record."""
    command = __doc__.split("\n\n")[1].strip()
    has_before = any("before" in row for row in record["starts"])
    rows: list[list[object]] = []
    for row in record["starts"]:
        now, before = row["now"], row.get("before")
        cells: list[object] = [row["name"], now["seconds"], now["yade"] if now["yade"] > NOTHING else None, now["clock"]]
        if has_before:
            cells += [before and before["seconds"], before and f"{now['seconds'] / before['seconds']:.2f}", before and before["clock"]]
        rows.append(cells)
    heads = ["process", "s", "of it YADE, s", "by the clock, s", *(["s before", "ratio", "by the clock before, s"] if has_before else [])]
    shares: list[list[object]] = []
    for row in record["stages"]:
        for tree in (name for name in ("before", "now") if name in row):
            spent = row[tree]
            parts = [f"{spent.get(name, 0.0) / spent['total']:.1%}" for name in STAGES]
            shares.append([command_of(row), row["blocks"], tree, spent["total"], *parts])
    sections = ["# What a command takes beside its solver", INTRODUCTION, f"`{command}`", record["machine"]]
    sections += [marked("conclusions", conclusions(record)), "## Loading and small commands", table(heads, rows)]
    sections += ["## Shares of the stages", table(("command", "blocks", "version", "s", *STAGES), shares)]
    return "\n\n".join(sections) + "\n"


def stored_page(folder: Path) -> str:
    """Return the page of the stored record. Nothing is measured."""
    return page(json.loads((folder / "startup.json").read_text(encoding="utf-8")))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR")
    parser.add_argument("--beside", type=Path, metavar="DIR", help="sources of another version")
    parser.add_argument("--repeats", type=int, default=REPEATS, metavar="N", help=f"starts of each process (default: {REPEATS})")
    parser.add_argument("--sizes", type=int, nargs="*", choices=list(SIZES), default=list(SIZES), metavar="N", help="blocks")
    options = parser.parse_args()
    trees = ({"before": options.beside.resolve()} if options.beside else {}) | {"now": ROOT}
    made = provenance.describe() | {"YADE": installation.find_yade().version}
    machine = f"{made.pop('machine')}; " + ", ".join(f"{name} {version}" for name, version in made.items() if name != "crosscheck")
    record: dict[str, Any] = {"machine": machine, "starts": starts(trees, options.repeats)}
    record["stages"] = [
        stages(size, extent, trees if size < max(SIZES) or extent else {"now": ROOT}, options.repeats)
        for size in options.sizes
        for extent in (["--bounds"], [])
    ]
    (options.output / "startup.json").write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    (options.output / "startup.md").write_text(page(record), encoding="utf-8")


if __name__ == "__main__":
    main()
