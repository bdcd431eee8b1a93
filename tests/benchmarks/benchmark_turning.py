"""What blocks that turn by a finite angle change: `.venv/bin/python tests/benchmarks/benchmark_turning.py`.

Writes comparison/gallery/turning.md: the random scenes of the verdicts, whose path is followed with displacements of first and of second
order in the rotations. Where both differ, YADE is sent over the whole travel.
"""

import argparse
import tempfile
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import on_path  # noqa: F401  so that the packages are found
from turning_joints import TurningJoints
from verdict_scenes import FRESH_SEED, SCENES, SEED, drawn

import comparison
import la_core
from la_core.analysis import analyse
from la_core.coulomb.followed_path import annealed
from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.quasi_static_path import QuasiStaticPath
from la_core.coulomb.path.rest import come_to_rest
from la_core.coulomb.path.tangent import Tangent
from la_core.coulomb.plateau import plateau_of, reference_size
from la_core.model import joint_stiffness

PAGE = Path(__file__).parents[2] / "comparison" / "gallery" / "turning.md"
SEEDS = (SEED, FRESH_SEED)
STIFFER = 16.0  # joints over those of limit analysis, so that a release begins early in the travel; YADE takes 4 to 32
VISCOSITY = 1e-3  # first one of the finer path of a prediction, in multiples of the weight at unit rate
MOST_ITERATIONS = 20_000
CHANGED, LEFT = 5e-3, 1e-2  # of the reaction: a change that the page lists; the distance at which the curve has left the first order's
TOGETHER = 5e-3  # of the reaction: YADE confirms a value within this and its stated uncertainty
HEAD = """# What turning blocks release

Limit analysis keeps the geometry as laid: where a block turns, its contact points move at right angles to their arms. In truth they move on
circles. The difference, of second order in the rotation, is tiny beside a block, but not beside the strain of stiff joints. Friction may
lock a thrust in, which holds only by this strain. Turning blocks release it after a settlement of about the root of strain times block
size, some tenths of a millimetre, and the reaction comes to another plateau. The prediction is for settlements before this release. The
bounds hold before and after it.

Here the random scenes of [both](verdicts.md) [pages](fresh_verdicts.md) of verdicts are followed from rest over one travel, 0.8 mm, with
joints 16 times as stiff as those of the prediction: once with displacements of first order in the rotations, once of second order. In both
the forces balance on the geometry as laid. Where the ends differ by more than 0.5 %, YADE is sent over the whole travel, by the setting
`[yade] plateau_share = 1.0`. Written by `python tests/benchmarks/benchmark_turning.py --workers 2`.

*leaves at*: settlement at which the path of second order has left the end of the other one by 1 %; with softer joints it leaves later.
*YADE is at*: the order whose end is within 0.5 % and the uncertainty of YADE.
"""
COLUMNS = ("scene", "Coulomb R/W", "first order", "second order", "change %", "leaves at, mm", "YADE, whole travel", "YADE is at")


@dataclass(frozen=True)
class Ends:
    """Ends of the two paths of a scene over the weight, whether both are flat, and the settlement, m, at which the second one leaves."""

    coulomb: float
    first: float
    second: float
    are_flat: bool
    left_at: float
    iterations: tuple[int, int]

    @property
    def change(self) -> float:
        """Change by the second order, over the reaction."""
        return (self.second - self.first) / reference_size(self.first)


@dataclass(frozen=True)
class Row:
    """Scene with its ends, and YADE's reaction and uncertainty over the weight: NaN without a plateau, None where YADE did not run."""

    name: str
    ends: Ends
    yade: tuple[float, float] | None

    @property
    def at(self) -> str:
        """Order of the displacements that YADE confirms."""
        value, uncertainty = self.yade or (np.nan, np.nan)
        if not np.isfinite(value):
            return "no plateau"
        near = [abs(value - end) <= TOGETHER * reference_size(end) + uncertainty for end in (self.ends.first, self.ends.second)]
        return {(True, False): "the first order", (False, True): "the second order", (True, True): "both"}.get(
            (near[0], near[1]), "neither"
        )

    @property
    def line(self) -> str:
        """Line of the table."""
        ends, (value, uncertainty) = self.ends, self.yade or (np.nan, np.nan)
        shown = f"{value:.4g} ± {uncertainty:.1g}" if np.isfinite(value) else "–"
        numbers = [f"{number:.4g}" for number in (ends.coulomb, ends.first, ends.second)]
        numbers += [f"{100.0 * ends.change:+.2g}", f"{1e3 * ends.left_at:.2g}"]
        return f"| {' | '.join([self.name, *numbers, shown, self.at])} |"


def ends_of(scene: la_core.Scene) -> Ends | None:
    """Follow both paths of a scene; None where it has no prediction, or where a path does not reach its end."""
    analysis = analyse(scene)
    if analysis.coulomb is None or not np.isfinite(analysis.coulomb.value):
        return None
    assembly, stiff = analysis.assembly, STIFFER * analysis.stiffness.normal
    stiffness = joint_stiffness(assembly, scene.inset, {**scene.yade, "normal_stiffness": stiff, "shear_stiffness": stiff})
    paths = [path for kind in (ElasticJoints, TurningJoints) if (path := followed(kind(assembly, stiffness))) is not None]
    if len(paths) < 2:
        return None
    first, second = (path.points[-1].value for path in paths)
    are_flat = all(plateau_of(*path.curve, 1.0, path.points[-1].value).is_known for path in paths)
    progress, values = paths[1].curve
    left_at = float(np.max(progress[np.abs(values - first) <= LEFT * reference_size(first)], initial=0.0)) * paths[1].joints.unit
    iterations = (paths[0].iterations, paths[1].iterations)
    return Ends(analysis.coulomb.value / scene.weight, first, second, are_flat, left_at, iterations)


def followed(joints: ElasticJoints) -> QuasiStaticPath | None:
    """Path from rest over one travel; None where it does not begin or does not reach its end."""
    tangent = Tangent(joints)
    rest, _ = come_to_rest(joints, tangent)
    if rest is None:
        return None
    path = QuasiStaticPath(joints, tangent, rest, annealed(joints, VISCOSITY))
    for _ in path.advance_to(1.0, MOST_ITERATIONS):
        pass
    return path if path.last.progress == 1.0 else None


def yade_over_the_travel(scene: la_core.Scene) -> tuple[float, float]:
    """Reaction of YADE and its uncertainty over the weight, after the whole travel; NaN without a plateau."""
    with tempfile.TemporaryDirectory() as folder:
        run = comparison.run(la_core.variant(scene, {"yade.plateau_share": 1.0}), folder, quiet=True).yade
    return (np.nan, np.nan) if run is None else (run.reaction / scene.weight, run.uncertainty / scene.weight)


def measured(scene: tuple[int, int]) -> Row | None:
    """Follow the paths of a scene, its seed and number, and run YADE where their ends differ; None where a path does not reach its end."""
    seed, number = scene
    one = drawn(number, seed)
    ends = ends_of(one.scene)
    if ends is None:
        return None
    differ = ends.are_flat and abs(ends.change) > CHANGED
    return Row(f"{number} of {seed}, {one.kind}, {one.motion}", ends, yade_over_the_travel(one.scene) if differ else None)


def page(rows: list[Row], scenes: int) -> str:
    """The page: its head, what was found, and a line for each scene whose ends differ."""
    known = [row for row in rows if row.ends.are_flat]
    listed = [row for row in known if row.yade is not None]
    changes = [abs(row.ends.change) for row in known]
    first, second = np.sum([row.ends.iterations for row in rows], axis=0)
    confirmed = Counter(row.at for row in listed).most_common()
    found = [
        f"- Of {scenes} scenes {len(rows)} have a prediction and reach the end of both paths. Of {len(known)} both ends are known to 1 %.",
        f"- {len(listed)} of these change by more than {100 * CHANGED:g} %, {sum(change > LEFT for change in changes)} by more than 1 %, "
        f"the most by {100 * max(changes):.2g} %.",
        f"- Where they change, YADE is at {', at '.join(f'{at} in {count}' for at, count in confirmed)}.",
        f"- The second order takes {second / first:.2g} times as many iterations.",
    ]
    table = [f"| {' | '.join(COLUMNS)} |", "|" + " --- |" * len(COLUMNS), *(row.line for row in listed)]
    return "\n".join([HEAD, *found, "", *table]) + "\n"


def main() -> None:
    """Measure all scenes and write the page."""
    parser = argparse.ArgumentParser(description="Measure what blocks that turn by a finite angle change.")
    parser.add_argument("--scenes", type=int, default=SCENES, help="scenes of each seed")
    parser.add_argument("--workers", type=int, default=1, help="scenes side by side")
    options = parser.parse_args()
    chosen = [(seed, number) for seed in SEEDS for number in range(options.scenes)]
    rows = []
    with ProcessPoolExecutor(options.workers) as pool:
        for row in pool.map(measured, chosen):
            rows += [row] if row is not None else []
            if row is not None and row.yade is not None:
                print(row.line, flush=True)
    PAGE.write_text(page(rows, len(chosen)), encoding="utf-8")


if __name__ == "__main__":
    main()
