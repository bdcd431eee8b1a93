"""Comparison of damping, stiffness and speed of a run in YADE: `.venv/bin/python tests/benchmarks/benchmark_protocol.py`.

Runs irregular walls (`protocol_scenes.py`), each in one attempt with every combination, and writes comparison/gallery/protocol.md. The
reference of a wall is limit analysis' prediction, which never sees these runs. Seconds are processor time.
"""

import argparse
import itertools
import json
import subprocess
import tempfile
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import on_path  # noqa: F401  so that the packages are found
from protocol_scenes import Wall, walls

from comparison.yade import find_yade
from comparison.yade.installation import yade_environment
from la_core.analysis import LimitAnalysis, analyse, case_file
from la_core.scene import load_scene

PAGE = Path(__file__).parents[2] / "comparison" / "gallery" / "protocol.md"
ATTEMPT = Path(__file__).with_name("protocol_attempt.py")
# Damping ratios of the contacts and of the blocks' swing; stiffness and speed over the derived values.
DAMPING, STIFFNESS, SPEED = ((0.3, 0.0), (1.0, 0.0), (0.3, 0.5)), (0.25, 1.0, 4.0), (1.0, 0.5)
ALLOWED = 0.005  # share of the reaction that the judge allows besides both stated uncertainties
HEAD = """# How fast, how stiff, how damped: the protocol of a YADE run, measured

Irregular walls of 30 to 35 blocks that are no shipped scenes: unequal courses and blocks, leaning walls, inclined beds, a lintel,
supports that move obliquely or turn; friction 0.25 to 1.2. Each wall ran in one attempt (no quick one before) with every combination of
damping, stiffness and speed. [How YADE runs](../../yade_scripts/README.md#the-protocol) says which combination a run takes, and why. The
table is written by

```console
$ .venv/bin/python tests/benchmarks/benchmark_protocol.py --seeds 2 --workers 2
```

*damping*: damping ratio of the contacts. *swing*: damping ratio of the blocks' swing. *stiffness*, *speed*: over the derived ones; the
derived stiffness follows from the travel that limit analysis' path took to become flat. *plateaus*: walls that came to a plateau. *off by*:
median and largest difference from limit analysis' prediction, over the reaction, on walls with a plateau. *stated*: median and largest
stated uncertainty, without the part of the speed. *beyond*: walls whose difference is larger than both stated uncertainties and 0.5 %.
*seconds*: processor time of all walls.
"""
COLUMNS = ("damping", "swing", "stiffness", "speed", "plateaus", "off by", "stated", "beyond", "seconds")


@dataclass(frozen=True)
class Combination:
    """Settings that vary between attempts. The page explains the columns of the same names."""

    damping: float
    swing: float
    stiffness: float
    speed: float


def attempt(case: Path, tried: Combination) -> dict[str, Any]:
    """Run one attempt in YADE's interpreter."""
    yade = find_yade()
    settings = json.dumps({"damping_ratio": tried.damping, "swing_damping": tried.swing})
    command = [str(part) for part in (yade.python, "-s", ATTEMPT, case, tried.speed, tried.stiffness, settings)]
    environment = {**yade_environment(), "YADE_MODULES": str(yade.modules)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return dict(json.loads(done.stdout.splitlines()[-1]))


def solved(wall: Wall, folder: Path) -> LimitAnalysis:
    """Solve a wall by limit analysis, and store its case for YADE."""
    path = folder / f"{wall.name}.toml"
    path.write_text(wall.text, encoding="utf-8")
    analysis = analyse(load_scene(path))
    case_file.write_case(folder / f"{wall.name}.h5", analysis, wall.name)
    return analysis


def row(tried: Combination, runs: Sequence[tuple[dict[str, Any], float, float]]) -> str:
    """Return one line of the table. runs: attempt, prediction and its uncertainty."""
    known = [run for run in runs if run[0]["status"] == "plateau"]
    off = np.array([abs(run["reaction"] / value - 1.0) for run, value, _ in known])
    stated = np.array([run["uncertainty"] / abs(run["reaction"]) for run, _, _ in known])
    beyond = sum(d > s + u / abs(v) + ALLOWED for d, s, (_, v, u) in zip(off, stated, known, strict=True))
    spread = [f"{100 * np.median(x):.2f} %, {100 * x.max():.2g} %" if len(x) else "–" for x in (off, stated)]
    seconds = sum(run["seconds"] for run, _, _ in runs)
    made = [f"{value:g}" for value in (tried.damping, tried.swing, tried.stiffness, tried.speed)]
    return "| " + " | ".join([*made, f"{len(known)} of {len(runs)}", *spread, f"{beyond}", f"{seconds:.0f}"]) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(description="Measure combinations of damping, stiffness and speed.")
    parser.add_argument("--seeds", type=int, default=1, help="walls of each kind")
    parser.add_argument("--workers", type=int, default=1, help="attempts side by side")
    options = parser.parse_args()
    drawn = walls(range(options.seeds))
    lines = [f"| {' | '.join(COLUMNS)} |", "|---" * len(COLUMNS) + "|"]
    with tempfile.TemporaryDirectory() as place, ThreadPoolExecutor(options.workers) as pool:
        folder = Path(place)
        predicted = [(wall, solved(wall, folder).coulomb) for wall in drawn]
        predicted = [(wall, coulomb) for wall, coulomb in predicted if coulomb.value > 0.0]  # differences are divided by the prediction
        for (damping, swing), stiffness, speed in itertools.product(DAMPING, STIFFNESS, SPEED):
            tried = Combination(damping, swing, stiffness, speed)
            cases = [folder / f"{wall.name}.h5" for wall, _ in predicted]
            made = pool.map(attempt, cases, itertools.repeat(tried))
            runs = [(run, coulomb.value, coulomb.uncertainty) for run, (_, coulomb) in zip(made, predicted, strict=True)]
            lines.append(row(tried, runs))
            print(lines[-1], flush=True)
            for (wall, _), (run, value, _) in zip(predicted, runs, strict=True):
                print(f"    {wall.name} {run['status']} {run['reaction'] / value:.5f} {run['seconds']:.1f}", flush=True)
    names = ", ".join(f"{wall.name} ({wall.friction:g})" for wall, _ in predicted)
    PAGE.write_text(f"{HEAD}\n" + "\n".join(lines) + f"\n\nWalls and their friction: {names}.\n", encoding="utf-8")


if __name__ == "__main__":
    main()
