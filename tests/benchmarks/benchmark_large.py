"""Verdicts on large structures: the answers of both methods, and the time that a user waits.

    python tests/benchmarks/benchmark_large.py [--scenes NAME ...] [--threads N] [--folder DIR] [--record FILE]

A scene that the record holds is not run again. `--page` writes the page from the record and runs nothing.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import json
import time
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from growth_report import table
from rich.console import Console
from verdict_scenes import drawn

import la_core
from comparison.numbers import percent
from comparison.numbers import format_number, with_uncertainty
from la_core.text_table import exists
from comparison.progress import Narration
from comparison.provenance import describe
from comparison.run_folder import write_text
from comparison.verdict import mark_of
from comparison.workflow import run_scene
from la_core.scene import Scene, same_structure

GALLERY = Path(__file__).parents[2] / "comparison" / "gallery"
FRICTION, DENSITY = 0.4, 1800.0  # -, kg/m3
BLOCK, BRICK = (0.4, 0.2, 0.2), (0.25, 0.12, 0.08)  # length, depth, height, m
Opening = tuple[tuple[float, float], tuple[float, float]]  # lower left and upper right corner, m
OPENINGS: list[Opening] = [((left, low), (left + 1.0, high)) for left in (1.0, 4.0, 7.0) for low, high in ((0.72, 1.84), (2.48, 3.44))]
OPENINGS[2] = (4.0, 0.0), OPENINGS[2][1]  # the door
LARGE_OPENINGS: list[Opening] = [
    ((left, low), (left + 1.25, high)) for left in (1.5, 5.75, 10.0) for low, high in ((1.04, 2.64), (3.52, 4.88))
]
LARGE_OPENINGS[2] = (5.75, 0.0), LARGE_OPENINGS[2][1]
HEADINGS = (
    "scene",
    "blocks",
    "mu",
    "Coulomb R/W",
    "YADE R/W",
    "apart",
    "verdict",
    "limit analysis, s",
    "YADE, s",
    "steps of YADE",
    "whole run, min",
)
INTRODUCTION = """\
# Large structures by both methods

Both methods run structures of 60 to 3,066 blocks, whose right third settles, to a verdict. The first four are walls in running bond. All
are plane except *250 blocks in space*, whose blocks may move in all directions. *brick facade* has five windows and a door under lintels.
*large facade* is 1.4 times as long and high. The machine did nothing else, except for other calculations on one core during limit analysis
of *large facade*. Seconds are wall time: those of limit analysis are for the paths of the answer, those of YADE for all its attempts.
*whole run* also includes reading, paths of models that were given up, checks and the writing of numbers. *apart* is the difference of the
two reactions, over YADE's reaction. Written by `python tests/benchmarks/benchmark_large.py --threads 2`.

Blocks beyond the [reach](../glossary.md) of the support are left out where they are at least 100 and at least a quarter of the free
blocks: 272 of the 1,008 blocks of the wall, 432 of the 1,496 bricks of the facade and 825 of the 3,066 bricks of the large facade.

YADE's settings for large structures were found on the plane structures of this table, whose agreement therefore proves little about other
structures. Where a method states an uncertainty of more than 1 %, agreement means that the reactions differ by at most 0.5 %, the floor of
the tolerance.

The run of the large facade takes an hour and a half, half of it in limit analysis; no larger structure was tried. Limit analysis first
left out 957 bricks. After 13 minutes its paths showed that some of these would not stand; now the coarser path alone, half of that time,
shows it. The answer needs a third path, because the smoothing of the first two leaves an uncertainty of more than 1 %. An earlier version
modelled all bricks and followed two paths: its prediction was 0.1536 ± 0.0026 W, and YADE's reaction 0.1531 ± 0.0016 W."""
RANDOM = """\
Random irregular structures of 60 to 200 blocks are in the second table. They are of the kinds of the [random verdicts](verdicts.md), with
two to three times their length and number of courses. Program and seed were fixed before the first run. The structures ran with one thread,
beside another run of YADE on the same two cores. YADE treats random 2 and 10 as large structures. Both ran again, alone and with later
settings; random 10 was among the walls on which these settings were tried. Random 4 and 12 ran again, beside each other and a test run,
after slow attempts had been added to the protocol. Random 12 is one of the walls that led to slow attempts."""


def wall_tables(size: tuple[float, float, float], per_course: int, courses: int, **more: Any) -> dict[str, Any]:
    """Scene file of a plane running-bond wall whose right third settles. size: a block's length, depth, height, m; more: further keys."""
    length = per_course * size[0]
    footing = {"height": 0.3, "settling": [round(2.0 * length / 3.0, 3), length]}
    bond = {"bond": "running", "origin": [0.0, 0.0, 0.0], "block": list(size), "per_course": per_course, "courses": courses}
    return {
        "title": "Right third of a foundation settles",
        "stone": {"density": DENSITY},
        "joint": {"friction": FRICTION},
        "wall": [bond | {"footing": footing} | more],
        "settlement": {"direction": [0.0, 0.0, -1.0]},
    }


def wall(size: tuple[float, float, float], per_course: int, courses: int, **more: Any) -> Scene:
    """Build the scene of `wall_tables`."""
    return la_core.build(wall_tables(size, per_course, courses, **more), "large")


def facade(per_course: int, courses: int, openings: list[Opening]) -> Scene:
    """Build a brick facade with five windows and a door."""
    tables = [{"from": list(low), "to": list(high), "bearing": BRICK[0]} for low, high in openings]
    return wall(BRICK, per_course, courses, opening=tables)


SCENES: dict[str, Callable[[], Scene]] = {
    "10 x 6 wall": lambda: wall(BLOCK, 10, 6),
    "250 blocks": lambda: wall(BLOCK, 15, 16),
    "250 blocks in space": lambda: la_core.build(wall_tables(BLOCK, 15, 16) | {"effects": {"plane": False}}, "large"),
    "1,000 blocks": lambda: wall(BLOCK, 31, 32),
    "brick facade": lambda: facade(36, 50, OPENINGS),
    "large facade": lambda: facade(51, 71, LARGE_OPENINGS),
}
RANDOM_SEED, RANDOM_SCENES, RANDOM_SIZE = 20261127, 15, 2.2


def random_structure(number: int) -> Scene:
    """The random structure of a number from 0 to RANDOM_SCENES - 1."""
    return drawn(number, RANDOM_SEED, RANDOM_SIZE).scene


SCENES |= {f"random {number}": partial(random_structure, number) for number in range(RANDOM_SCENES)}


def measured(name: str, threads: int, folder: Path) -> dict[str, Any]:
    """Run a scene and return its entry. Reactions are over the weight."""
    scene = same_structure(SCENES[name](), {"yade.threads": threads} if threads > 1 else {}, name.replace(" ", "_").replace(",", ""))
    start = time.perf_counter()
    with Narration(Console(stderr=True)) as narration:
        summary = run_scene(scene, folder / scene.name, narration, with_yade=True, figures=lambda _: {})
    minutes = (time.perf_counter() - start) / 60.0
    coulomb, yade, weight = summary["limit_analysis"]["coulomb"], summary["yade"], summary["weight"]
    shared = coulomb.get("shared_inset") or coulomb
    values = {
        "coulomb": shared["reaction"], "coulomb_uncertainty": shared["uncertainty"],
        "yade": yade["reaction"], "yade_uncertainty": yade["uncertainty"],
    }  # fmt: skip
    return {name: value / weight if exists(value) else None for name, value in values.items()} | {
        "name": name, "blocks": summary["free_blocks"], "friction": scene.friction, "weight": weight, "threads": threads,
        "verdict": summary["verdict"], "reason": summary["reason"], "coulomb_status": shared["status"], "yade_status": yade["status"],
        "coulomb_seconds": coulomb["seconds"], "yade_seconds": yade["seconds"], "steps": yade["steps"], "minutes": minutes,
    }  # fmt: skip


def page(record: dict[str, Any]) -> str:
    """Return the page of a record."""
    entries = [record["scenes"][name] for name in SCENES if name in record["scenes"]]
    reasons = [f"- **{entry['name']}** is {entry['verdict']}: {entry['reason']}" for entry in entries if entry["reason"]]
    regular, irregular = ([entry for entry in entries if entry["name"].startswith("random") == of] for of in (False, True))
    threads = ", ".join(f"{entry['name']} {entry['threads']}" for entry in regular)
    counted = Counter(entry["verdict"] for entry in irregular)
    open_ones = f"{counted['inconclusive']} are inconclusive, {counted['disagree']} disagree"
    tally = f"Of {len(irregular)} structures {counted['agree']} agree, {open_ones}."
    parts = [
        INTRODUCTION,
        table(HEADINGS, [_row(entry) for entry in regular]),
        *([f"{RANDOM} {tally}", table(HEADINGS, [_row(entry) for entry in irregular])] if irregular else []),
        "\n".join(reasons) or "Every structure agrees.",
        f"Threads of YADE: {threads}. Versions: {', '.join(f'{name} {value}' for name, value in record['versions'].items())}.",
    ]
    return "\n\n".join(parts) + "\n"


def _row(entry: dict[str, Any]) -> list[str]:
    known = exists(entry["coulomb"]) and exists(entry["yade"])
    return [
        entry["name"],
        f"{entry['blocks']:,}",
        format_number(entry["friction"], 3),
        with_uncertainty(entry["coulomb"], entry["coulomb_uncertainty"]) if exists(entry["coulomb"]) else entry["coulomb_status"],
        with_uncertainty(entry["yade"], entry["yade_uncertainty"]) if exists(entry["yade"]) else entry["yade_status"],
        percent(abs(entry["yade"] - entry["coulomb"]) / abs(entry["yade"])) if known and entry["yade"] else "–",
        mark_of(entry["verdict"]),
        format_number(entry["coulomb_seconds"], 2),
        format_number(entry["yade_seconds"], 2),
        f"{entry['steps']:,}",
        format_number(entry["minutes"], 2),
    ]


def main() -> None:
    """Run the scenes that the record lacks. Write the record after every scene, and the page at the end."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", nargs="*", choices=list(SCENES), default=list(SCENES), help="names of scenes (default: all)")
    parser.add_argument("--threads", type=int, default=1, help="threads of YADE (default: 1)")
    parser.add_argument("--folder", type=Path, default=Path("crosscheck-large"), help="folder of all runs")
    parser.add_argument("--record", type=Path, default=GALLERY / "large.json", help="the record; the page lies beside it")
    parser.add_argument("--page", action="store_true", help="write the page alone")
    options = parser.parse_args()
    record = json.loads(options.record.read_text(encoding="utf-8")) if options.record.exists() else {"versions": {}, "scenes": {}}
    versions = describe()
    for name in () if options.page else (name for name in options.scenes if name not in record["scenes"]):
        record["scenes"][name] = measured(name, options.threads, options.folder)
        record["versions"] = {key: versions[key] for key in ("crosscheck", "python", "numpy", "machine")}
        write_text(options.record, json.dumps(record, indent=1, sort_keys=True, ensure_ascii=False) + "\n")
        print(" | ".join(_row(record["scenes"][name])), flush=True)
    write_text(options.record.with_suffix(".md"), page(record))


if __name__ == "__main__":
    main()
