"""Light stones under heavy blocks that are pushed: the prediction compared with YADE on random scenes.

    python tests/benchmarks/benchmark_loose.py [--seed N] [--scenes N]

Runs only scenes with such stones that do not come to rest under their full weight at once: they rest while the weights grow, or not at
all. Prints one line for each scene, and a summary.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np
from loose_scenes import drawn
from rich.console import Console

from comparison.progress import Narration
from comparison.workflow import run_scene
from la_core.analysis import LimitAnalysis, analyse
from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.implicit_step import State
from la_core.coulomb.path.rest import rest_from
from la_core.coulomb.path.tangent import Tangent
from la_core.limit import Status

SEED, COUNT = 102, 292
KINDS = ("pinched", "corner")


def main() -> None:
    """Draw the scenes, run the scenes whose stones slip at once, and print the answers of both methods."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--scenes", type=int, default=COUNT)
    options = parser.parse_args()
    random, counts = np.random.default_rng(options.seed), Counter[str]()
    for number in range(options.scenes):
        kind, scene = drawn(random)
        if kind not in KINDS:
            continue
        analysis = analyse(scene)
        if analysis.bounds[analysis.main].status is not Status.SOLVED or analysis.coulomb is None or _rests_at_once(analysis):
            continue
        with tempfile.TemporaryDirectory() as folder, Narration(Console(stderr=True, quiet=True)) as narration:
            summary = run_scene(scene, Path(folder), narration, with_yade=True, figures=lambda results: {})
        yade, coulomb = summary["yade"], analysis.coulomb
        counts[f"prediction {coulomb.status}, YADE {yade['status']}, {summary['verdict']}"] += 1
        print(
            f"{number:3} {kind:8} {coulomb.status} {coulomb.value:.6g}, YADE {yade['status']} {yade['multiplier']}: {summary['verdict']}",
            flush=True,
        )
    for outcome, count in sorted(counts.items()):
        print(f"{count:3} {outcome}")


def _rests_at_once(analysis: LimitAnalysis) -> bool:
    """Return True if the blocks come to rest where all the weight acts at once."""
    joints = ElasticJoints(analysis.assembly, analysis.stiffness)
    return rest_from(joints, Tangent(joints), State(0.0, np.zeros_like(joints.weights), joints.laid), 0.0)[0] is not None


if __name__ == "__main__":
    main()
