"""Cost of each effect in YADE, where it is on and where it is off, measured in turn.

    python tests/benchmarks/benchmark_effects.py [--blocks N] [--steps N]

Times the steps of a running-bond wall of about N blocks over a settling base, in the plane and in 3D, with small and finite displacements.
The variants take turns, and the best of several rounds counts. A small wall is run to its end for the cost of recording.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import itertools
import json
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import scenes
from rich.console import Console
from rich.table import Table

from comparison.yade import installation, process
from comparison.yade.run_record import Run, read_run
from la_core.analysis.case_file import write_case
from la_core.analysis.stage import analyse
from la_core.scene.scene import Scene

SPLIT = 0.66  # share of the base's length that stays; no upright joint lies above its end, so that displacements may be small
BLOCK = (0.4, 0.2, 0.2)  # m
ROUNDS = 3  # over all variants in turn, so that a passing load on the machine slows all variants alike
SMALL_WALL = (4, 6)  # blocks per course, courses; run to its end
TIME_LIMIT = 600.0  # s
COST = Path(__file__).parent / "yade_cost.py"


@dataclass(frozen=True)
class Variant:
    """One combination of effects of a run in YADE."""

    plane: bool
    displacement: str
    recording: str = "states"

    def scene(self, per_course: int, courses: int) -> Scene:
        parts = scenes.wall(per_course, courses, SPLIT * BLOCK[0] * per_course, BLOCK)
        effects = {"displacement": self.displacement, "recording": self.recording}
        return scenes.build(*parts, inset=0.001, plane=self.plane, effects=effects)

    def __str__(self) -> str:
        return f"{'plane' if self.plane else '3D'}, {self.displacement}"


def write(scene: Scene, folder: Path) -> Path:
    """Write case.h5 of a scene into a new folder and return its path."""
    folder.mkdir()
    write_case(folder / "case.h5", analyse(scene), "benchmark")
    return folder / "case.h5"


def in_yade(script: Path, *arguments: object) -> dict[str, Any]:
    """Run a script in YADE's interpreter, in its own process, and return the JSON of its last line."""
    yade = installation.find_yade()
    environment = {**installation.yade_environment(), "YADE_MODULES": str(yade.modules)}
    command = [str(part) for part in (yade.python, "-s", script, *arguments)]
    answer = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=TIME_LIMIT)
    found: dict[str, Any] = json.loads(answer.stdout.splitlines()[-1])
    return found


def yade_rows(blocks: int, steps: int, folder: Path) -> dict[Variant, dict[str, Any]]:
    """Return the cost of every variant of a wall of about `blocks` blocks."""
    courses = round(blocks**0.5)
    per_course = round(blocks / courses)
    variants = [Variant(plane, displacement) for plane, displacement in itertools.product((True, False), ("small", "finite"))]
    cases = {one: write(one.scene(per_course, courses), folder / str(one)) for one in variants}
    rounds = [{one: in_yade(COST, path, steps) for one, path in cases.items()} for _ in range(ROUNDS)]
    return {one: {**rounds[0][one], **{key: min(turn[one][key] for turn in rounds) for key in ("step", "row", "pose")}} for one in variants}


def recording_rows(folder: Path) -> dict[str, tuple[Run, int]]:
    """Run a small wall to its end, with states recorded throughout or on the plateau alone. Return each run and the bytes of its run.h5."""
    found = {}
    for recording in ("states", "plateau"):
        scene = Variant(True, "small", recording).scene(*SMALL_WALL)
        case = write(scene, folder / recording)
        process.run_yade(installation.find_yade(), case.parent, "benchmark", TIME_LIMIT, lambda report: None)
        record = case.parent / "run.h5"
        found[recording] = (read_run(record, analyse(scene).assembly), record.stat().st_size)
    return found


def yade_table(rows: dict[Variant, dict[str, Any]]) -> Table:
    """One row per variant; the last columns state the cost of recording and its share of the time of a run over its full travel."""
    table = Table(title="YADE: cost of a step and of what is recorded; recording: of the time of a run over its full travel")
    heads = (
        "effects",
        "blocks",
        "spheres",
        "pairs",
        "engines",
        "us/step",
        "steps",
        "travel s",
        "ms/row",
        "ms/state",
        "kB/state",
        "recording",
    )
    for head in heads:
        table.add_column(head, justify="right")
    for one, row in rows.items():
        travel = row["step"] * row["steps_of_travel"]
        recorded = row["rows"] * row["row"] + row["poses"] * row["pose"]
        table.add_row(
            str(one), f"{row['blocks']}", f"{row['spheres']}", f"{row['interactions']}", f"{len(row['engines'])}",
            f"{1e6 * row['step']:.0f}", f"{row['steps_of_travel']}", f"{travel:.0f}", f"{1e3 * row['row']:.2f}", f"{1e3 * row['pose']:.2f}",
            f"{1e-3 * row['pose_bytes']:.0f}", f"{recorded / (travel + recorded):.2%}",
        )  # fmt: skip
    ratios = {name: rows[Variant(False, name)]["step"] / rows[Variant(True, name)]["step"] for name in ("small", "finite")}
    table.caption = ", ".join(f"{name}: a step in 3D costs {ratio:.2f} times that in the plane" for name, ratio in ratios.items())
    return table


def recording_table(rows: dict[str, tuple[Run, int]]) -> Table:
    """One row per kind of recording."""
    table = Table("recording", "status", "R, N", "seconds", "states", "bytes of run.h5", title="YADE: a small plane wall run to its end")
    for name, (run, size) in rows.items():
        states = len(run.poses.settlement)
        table.add_row(name, run.status, f"{run.result['reaction']:.9g}", f"{run.result['seconds']:.2f}", f"{states}", f"{size}")
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--blocks", type=int, default=1000)
    parser.add_argument("--steps", type=int, default=200)
    options = parser.parse_args()
    console = Console(width=160)
    with tempfile.TemporaryDirectory() as folder:
        console.print(yade_table(yade_rows(options.blocks, options.steps, Path(folder))))
        console.print(recording_table(recording_rows(Path(folder))))


if __name__ == "__main__":
    main()
