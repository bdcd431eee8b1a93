"""Which damping, stiffness and speed a run in YADE should have: `.venv/bin/python tests/benchmarks/benchmark_protocol.py`.

Writes comparison/gallery/protocol.md: irregular walls (`protocol_scenes.py`), each run by one attempt with every combination. The
reference of a wall is limit analysis' prediction, which never sees these runs. Seconds are processor time.
"""

import argparse
import itertools
import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import on_path  # noqa: F401  so that the packages are found
from protocol_scenes import Wall, walls

from comparison.yade import find_yade
from comparison.yade.process import yade_environment
from la_core.analysis import LimitAnalysis, analyse, case_file
from la_core.scene import load_scene

PAGE = Path(__file__).parents[2] / "comparison" / "gallery" / "protocol.md"
ATTEMPT = Path(__file__).with_name("protocol_attempt.py")
DAMPING, STIFFENING, PACE = (0.3, 1.0), (1.0, 4.0), (1.0, 0.5)
HEAD = """# How fast, how stiff, how damped: the protocol of a YADE run, measured

Irregular walls of 30 to 35 blocks that are no shipped scenes: unequal courses and blocks, leaning walls, inclined beds, a lintel,
supports that move obliquely or turn; friction 0.25 to 1.2. Each was run by one attempt (no quick one before) with every combination of
contact damping ratio, stiffness over that of limit analysis, and speed over the derived one. The table is written by

```console
$ .venv/bin/python tests/benchmarks/benchmark_protocol.py
```

*plateaus*: walls that came to a plateau. *off by*: median and largest difference from limit analysis' prediction, over the reaction, on
walls with a plateau. *stated*: median and largest stated uncertainty, without the part of the speed. *beyond*: walls whose difference is
larger than both stated uncertainties and 0.5 %. *seconds*: processor time of all walls.
"""


def attempt(case: Path, pace: float, settings: dict[str, float]) -> dict:
    """One attempt in YADE's interpreter."""
    yade = find_yade()
    command = [str(part) for part in (yade.python, "-s", ATTEMPT, case, pace, json.dumps(settings))]
    environment = {**yade_environment(), "YADE_MODULES": str(yade.modules)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def solved(wall: Wall, folder: Path) -> LimitAnalysis:
    """Limit analysis of a wall, stored for YADE."""
    path = folder / f"{wall.name}.toml"
    path.write_text(wall.text, encoding="utf-8")
    analysis = analyse(load_scene(path))
    case_file.write_case(folder / f"{wall.name}.h5", analysis, wall.name)
    return analysis


def row(damping: float, stiffening: float, pace: float, runs: list[tuple[dict, float, float]]) -> str:
    """One line of the table; runs: attempt, prediction and its uncertainty."""
    known = [run for run in runs if run[0]["status"] == "plateau"]
    off = np.array([abs(run["reaction"] / value - 1.0) for run, value, _ in known])
    stated = np.array([run["uncertainty"] / abs(run["reaction"]) for run, _, _ in known])
    beyond = sum(d > s + u / abs(v) + 0.005 for d, s, (_, v, u) in zip(off, stated, known, strict=True))
    spread = [f"{100 * np.median(x):.2f} %, {100 * x.max():.2g} %" if len(x) else "–" for x in (off, stated)]
    seconds = sum(run["seconds"] for run, _, _ in runs)
    return (
        f"| {damping:g} | {stiffening:g} | {pace:g} | {len(known)} of {len(runs)} | {spread[0]} | {spread[1]} | {beyond} | {seconds:.0f} |"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description="Measure combinations of damping, stiffness and speed.")
    parser.add_argument("--seeds", type=int, default=1, help="walls of each kind")
    options = parser.parse_args()
    drawn = walls(range(options.seeds))
    lines = ["| damping | stiffness | speed | plateaus | off by | stated | beyond | seconds |", "|---|---|---|---|---|---|---|---|"]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        predicted = [(wall, solved(wall, folder).coulomb) for wall in drawn]
        for damping, stiffening, pace in itertools.product(DAMPING, STIFFENING, PACE):
            settings = {"damping_ratio": damping, "stiffening": stiffening}
            runs = [
                (attempt(folder / f"{wall.name}.h5", pace, settings), coulomb.value, coulomb.uncertainty) for wall, coulomb in predicted
            ]
            lines.append(row(damping, stiffening, pace, runs))
            print(lines[-1], flush=True)
            for (wall, _), (run, value, _) in zip(predicted, runs, strict=True):
                print(f"    {wall.name} {run['status']} {run['reaction'] / value:.5f} {run['seconds']:.1f}", flush=True)
    names = ", ".join(f"{wall.name} ({wall.friction:g})" for wall in drawn)
    PAGE.write_text(f"{HEAD}\n" + "\n".join(lines) + f"\n\nWalls and their friction: {names}.\n", encoding="utf-8")


if __name__ == "__main__":
    main()
