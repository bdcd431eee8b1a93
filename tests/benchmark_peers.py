"""Peers side by side in one run: our limit analysis against other solvers, and YADE against LMGC90. Needs the extra `peers`.

    python tests/benchmark_peers.py -o comparison/gallery/peers.md [--time-limit S] [--only SCENE ...]

Every solver runs in a process of its own with one thread and a time limit. Beside the Markdown goes a JSON file with all repeats.
"""

import argparse
import json
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import peers_equilibrium
import peers_limit
from peers_process import PeerEnded, alone
from peers_report import page
from peers_scenes import SCENES
from peers_table import FAILED, LEAST_REACTION, Row, as_record

COMMAND = "python tests/benchmark_peers.py -o comparison/gallery/peers.md"
TIME_LIMIT = 300.0  # s of the clock, for one solve


def rows_of(measure: Callable[..., Iterator[Row]], scene: str, solver: str, limit: float) -> list[Row]:
    """All rows of a solver on a scene, one for each setting that it keeps; one that says why where there is none."""
    found: dict[str, Row] = {}
    reason = ""
    try:
        for row in alone(measure, (scene, solver), limit):
            if measure is not peers_limit.measure or solver not in peers_limit.HIGHS:
                found.clear()
            found[row.setting] = row
    except PeerEnded as ended:
        reason = str(ended)
    if not found:
        posed = LEAST_REACTION if measure is peers_limit.measure else "any equilibrium"
        return [Row(scene, solver, "–", posed, FAILED, note=reason)]
    last = list(found)[-1]
    if reason:
        found[last] = replace(found[last], note="; ".join(filter(None, (found[last].note, f"then {reason}"))))
    return list(found.values())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FILE.md")
    parser.add_argument("--time-limit", type=float, default=TIME_LIMIT, metavar="S", help="for one solve, of the clock")
    parser.add_argument("--only", nargs="+", choices=list(SCENES), default=list(SCENES), metavar="SCENE")
    options = parser.parse_args()
    rows: list[Row] = []
    for scene in options.only:
        for measure, solvers in ((peers_limit.measure, peers_limit.SOLVERS), (peers_limit.measure_equilibrium, peers_equilibrium.METHODS)):
            for solver in solvers:
                found = rows_of(measure, scene, solver, options.time_limit)
                for row in found:
                    print(f"{scene}: {solver}, {row.setting}: {row.status}, {row.seconds:.3g} s, ratio {row.ratio:.2g} {row.note}", file=sys.stderr)
                rows += found
    options.output.write_text(page(COMMAND, rows))
    options.output.with_suffix(".json").write_text(json.dumps([as_record(row) for row in rows], indent=1) + "\n")


if __name__ == "__main__":
    main()
