"""Our limit analysis compared with other solvers, and YADE with LMGC90, in one run.

    python tests/benchmarks/benchmark_peers.py -o comparison/gallery/peers.md [--time-limit S] [--only SCENE ...] [--commands]

Needs `pip install -e '.[peers]'` and `pip install --no-deps compas_lmgc90`; a missing solver has a row that says so. Every solver runs in
its own process with one thread and a time limit. A JSON file beside the Markdown has all repeats. `--commands` measures whole commands
alone, and keeps the rest of the record.
"""

import argparse
import json
import math
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import peers_command
import peers_dynamics
import peers_equilibrium
import peers_limit
from peers_command import Command
from peers_dynamics import Run
from peers_process import PeerEnded, PeerTooSlow, alone
from peers_report import page, versions
from peers_scenes import SCENES
from peers_table import EQUILIBRIUM, FAILED, LEAST_REACTION, Row, as_record, restored

PARTS: dict[str, type] = {"limit analysis": Row, "in time": Run, "whole commands": Command}  # parts of the record
COMMAND = "python tests/benchmarks/benchmark_peers.py -o comparison/gallery/peers.md"
TIME_LIMIT = 20.0  # processor seconds of one solution
COMMAND_LIMIT = 200  # processor seconds of one command


def limit_rows(scene: str, limit: float) -> Iterator[Row]:
    """Run all solvers on one scene."""
    for solver in peers_limit.SOLVERS:
        yield from rows_of(peers_limit.measure, Row(scene, solver, "–", LEAST_REACTION, FAILED), limit)
    for solver in peers_equilibrium.METHODS:
        yield from rows_of(peers_limit.measure_equilibrium, Row(scene, solver, "–", EQUILIBRIUM, FAILED), limit)


def rows_of(measure: Callable[..., Iterator[Row]], blank: Row, limit: float) -> list[Row]:
    """Return the last state of each row of a solver on a scene, or the blank row with the reason where the solver gave none."""
    found: dict[str, Row] = {}
    try:
        for row in alone(measure, (blank.scene, blank.solver), limit):
            found[row.key] = row
    except PeerEnded as ended:
        key = next(reversed(found), "")
        last = found.get(key, blank)
        bound = limit if isinstance(ended, PeerTooSlow) and not last.processor else math.nan
        found[key] = replace(last, limit=bound, note="; then ".join(filter(None, (last.note, str(ended)))))
    return list(found.values())


def dynamic_runs(scene: str, limit: float) -> Iterator[Run]:
    """Run our prediction, YADE and LMGC90 on one scene."""
    asked: list[tuple[Callable[..., Iterator[Run]], tuple, str, str]] = [
        (peers_dynamics.predict, (), "limit analysis", "inset"),
        (peers_dynamics.yade, (), "YADE", "derived settings"),
        *((peers_dynamics.lmgc90, (step,), "LMGC90", peers_dynamics.words(step)) for step in peers_dynamics.STEPS),
    ]
    for run, arguments, method, setting in asked:
        try:
            yield from alone(run, (scene, *arguments), limit)
        except PeerEnded as ended:
            yield Run(scene, method, setting, FAILED, note=str(ended))


def commands(blocks: int) -> list[Command]:
    """Run all methods as whole commands on one wall, repeated in turn."""
    found = {method: Command(blocks, method) for method in peers_command.METHODS}
    for _ in range(peers_command.REPEATS):
        for method, one in found.items():
            if one.note:
                continue
            try:
                value, seconds = peers_command.measure(blocks, method, COMMAND_LIMIT)
                found[method] = replace(one, value=value, processor=(*one.processor, seconds))
            except PeerEnded as ended:
                found[method] = replace(one, limit=COMMAND_LIMIT if isinstance(ended, PeerTooSlow) else math.nan, note=str(ended))
    return list(found.values())


def stored_page(output: Path) -> str:
    """Return the page of the stored record. Nothing is run."""
    return page_of(json.loads(output.with_suffix(".json").read_text(encoding="utf-8")))


def page_of(record: dict[str, Any]) -> str:
    """Return the page of a record."""
    rows, runs, whole = ([restored(kind, row) for row in record.get(name, ())] for name, kind in PARTS.items())
    return page(COMMAND, record["limit"], rows, runs, record["versions"], whole, record.get("versions of commands", ""))


def write(output: Path, record: dict[str, Any], name: str, found: list[Any]) -> None:
    """Write the record with the rows of one part, and its page; print the last row."""
    record[name] = [as_record(one) for one in found]
    print(" | ".join(f"{value}" for key, value in record[name][-1].items() if key not in ("beside", "clock")), file=sys.stderr)
    output.with_suffix(".json").write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    output.write_text(page_of(record), encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FILE.md")
    parser.add_argument("--time-limit", type=float, default=TIME_LIMIT, metavar="S", help="for one solve, of the processor")
    parser.add_argument("--only", nargs="+", choices=list(SCENES), default=list(SCENES), metavar="SCENE", help="without whole commands")
    parser.add_argument("--commands", action="store_true", help="measure whole commands alone, and keep the rest of the record")
    options = parser.parse_args()
    limits, in_time, whole = PARTS
    if options.commands:
        record = json.loads(options.output.with_suffix(".json").read_text(encoding="utf-8"))
    else:
        record = {"versions": versions(), "limit": options.time_limit, **{name: [] for name in PARTS}}
        rows: list[Row] = []
        for scene in options.only:
            for row in limit_rows(scene, options.time_limit):
                rows.append(row)
                write(options.output, record, limits, rows)
        runs: list[Run] = []
        for scene in (scene for scene in options.only if scene in peers_dynamics.DYNAMIC):
            for run in dynamic_runs(scene, options.time_limit):
                runs.append(run)
                write(options.output, record, in_time, runs)
    if options.commands or options.only == list(SCENES):
        record["versions of commands"] = versions(())
        found: list[Command] = []
        for blocks in peers_command.WALLS:
            for command in commands(blocks):
                found.append(command)
                write(options.output, record, whole, found)


if __name__ == "__main__":
    main()
