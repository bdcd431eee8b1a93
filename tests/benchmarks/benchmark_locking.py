"""Blocks that lock by the dilatancy of their joints: the prediction compared with YADE on random scenes without a bound.

    python tests/benchmarks/benchmark_locking.py [--seed N] [--scenes N]

Scenes with a bound are left out. Prints one line for each scene that has a prediction and no bound, and a summary.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import tempfile
from pathlib import Path

import numpy as np
from locking_scenes import drawn
from rich.console import Console

from comparison.progress import Narration
from comparison.workflow import run_scene
from la_core.analysis import analyse
from la_core.limit import Status

SEED, COUNT = 26, 150


def main() -> None:
    """Draw the scenes, run the scenes that lock, and print the answers of both methods."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--scenes", type=int, default=COUNT)
    options = parser.parse_args()
    random = np.random.default_rng(options.seed)
    jammed, apart, verdicts = 0, [], []
    for number in range(options.scenes):
        kind, scene = drawn(random)
        analysis = analyse(scene)
        if analysis.bounds[analysis.main].status is not Status.UNBOUNDED:
            continue
        if analysis.coulomb is None or analysis.coulomb.status is not Status.SOLVED:
            jammed += 1
            continue
        with tempfile.TemporaryDirectory() as folder, Narration(Console(stderr=True, quiet=True)) as narration:
            summary = run_scene(scene, Path(folder), narration, with_yade=True, figures=lambda results: {})
        reaction, value = summary["yade"]["reaction"], analysis.coulomb.value
        difference = None if reaction is None else abs(reaction - value) / abs(value)
        verdicts.append(summary["verdict"])
        apart += [] if difference is None else [difference]
        told = "no plateau" if difference is None else f"{reaction:.6g}, {difference:.2%} apart"
        print(f"{number:3} {kind:10} friction {scene.friction:.3f}: prediction {value:.6g}, YADE {told}: {summary['verdict']}", flush=True)
    print(f"{len(verdicts)} predictions without a bound, {jammed} without a plateau; {verdicts.count('agree')} agree, ", end="")
    print(f"{verdicts.count('disagree')} disagree; YADE has {len(apart)} plateaus, at most {max(apart, default=0.0):.2%} away")


if __name__ == "__main__":
    main()
