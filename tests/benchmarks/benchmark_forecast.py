"""Accuracy of YADE's forecast of its run time: the time that a run first states, over the time that it took.

    python tests/benchmarks/benchmark_forecast.py [--seed N] [--size X] [--scenes N ...]

The scenes are the random scenes of verdict_scenes.py. A run that ends before it has timed its steps states no time. Other work on the
machine that begins or ends during a run changes its pace, and therefore the ratio.
"""

import argparse
import tempfile
import time
from pathlib import Path
from typing import Any

import on_path  # noqa: F401
from rich.console import Console
from rich.progress import track
from rich.table import Table
from verdict_scenes import SCENES, SEED, drawn

from comparison.progress import Narration
from comparison.workflow import run_scene


class Watch(Narration):
    """A silent listener that keeps the times of one run of YADE: the first forecast of each attempt, and the last report.

    Attributes
    ----------
    stated : dict of int to (float, float)
        By attempt: the time of its first forecast, and the end that it forecasts; s after YADE has loaded.
    ended : float
        Time of the last report, s after YADE has loaded. A run ends at most about a quarter of a second later.
    attempts : int
        Number of attempts.
    """

    def __init__(self) -> None:
        super().__init__(Console(stderr=True, quiet=True))
        self._start()

    def _start(self) -> None:
        self.stated: dict[int, tuple[float, float]] = {}
        self.ended, self.attempts, self._began = 0.0, 0, time.monotonic()

    def progress(self, scene: str, report: dict[str, Any]) -> None:
        """Keep the times of a report. A scene may be run again with other settings; the last run counts."""
        super().progress(scene, report)
        if report["stage"] == "loaded":
            self._start()
            return
        self.ended, self.attempts = time.monotonic() - self._began, report["attempt"]
        if report["seconds_left"] is not None:
            self.stated.setdefault(self.attempts, (self.ended, self.ended + report["seconds_left"]))

    def of_run(self) -> float | None:
        """Return the time that the first attempt stated for the whole run, over the time it took; None where it stated none."""
        return self.stated[1][1] / self.ended if 1 in self.stated else None

    def of_last(self) -> float | None:
        """Return the ratio for the last attempt from its first forecast to its end; None where it stated none."""
        if self.attempts not in self.stated:
            return None
        told, end = self.stated[self.attempts]
        return (end - told) / (self.ended - told) if self.ended > told else None


def main() -> None:
    """Run the scenes in turn and print a table and the shares of forecasts within a factor of two."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--size", type=float, default=1.0, help="of the structures, over the usual length and number of courses")
    parser.add_argument("--scenes", type=int, nargs="+", default=list(range(0, SCENES, 7)))
    options = parser.parse_args()
    table = Table("scene", "free blocks", "took, s", "attempts", "stated / took: run", "last attempt")
    runs, lasts = [], []
    for number in track(options.scenes, console=Console(stderr=True)):
        scene, watch = drawn(number, options.seed, options.size).scene, Watch()
        with tempfile.TemporaryDirectory() as folder, watch:
            run_scene(scene, Path(folder), watch, with_yade=True, figures=lambda _: {})
        runs.append(watch.of_run())
        lasts.append(watch.of_last())
        shown = ("" if ratio is None else f"{ratio:.2f}" for ratio in (runs[-1], lasts[-1]))
        table.add_row(scene.name, str(int(scene.blocks.free.sum())), f"{watch.ended:.3g}", str(watch.attempts), *shown)
    Console().print(table)
    for name, ratios in (("run", runs), ("last attempt", lasts)):
        stated = [ratio for ratio in ratios if ratio is not None]
        near = sum(0.5 <= ratio <= 2.0 for ratio in stated)
        print(f"{name}: {near} of {len(stated)} forecasts within a factor of two, {len(ratios) - len(stated)} ended before they stated one")


if __name__ == "__main__":
    main()
