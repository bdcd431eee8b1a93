"""Narration on stderr: stages as they happen, and YADE's progress as a bar on a terminal or a line now and then elsewhere."""

import time
from types import TracebackType
from typing import Any, Self

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

from la_core.errors import visible

LINE_EVERY = 10.0  # s between progress lines where there is no terminal


class Narration:
    """A listener of `comparison.workflow` that tells a person; silent on a quiet console."""

    def __init__(self, console: Console) -> None:
        columns = (TextColumn("{task.description}", markup=False), BarColumn(), TextColumn("{task.fields[state]}", markup=False))
        self._console = console
        self._bars = Progress(*columns, TimeElapsedColumn(), console=console, transient=True, disable=not console.is_terminal)
        self._tasks: dict[str, TaskID] = {}
        self._spoke = time.monotonic()

    def __enter__(self) -> Self:
        self._bars.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._bars.stop()

    def stage(self, scene: str, stage: str, state: str) -> None:
        """Tell that a stage began, was found cached or ended badly."""
        self._console.print(visible(f"{scene}: {stage}: {state}"), markup=False)
        if scene in self._tasks:
            self._bars.remove_task(self._tasks.pop(scene))

    def progress(self, scene: str, report: dict[str, Any]) -> None:
        """Move the bar of a running YADE case, or say a line where bars do not show."""
        self.fraction(scene, float(report.get("fraction") or 0.0), f"YADE: {_state(report)}")

    def fraction(self, scene: str, fraction: float, state: str) -> None:
        """Move the bar of a scene's long work, or say a line now and then where bars do not show."""
        if self._console.is_terminal:
            if scene not in self._tasks:
                self._tasks[scene] = self._bars.add_task(scene, total=1.0, state="")
            self._bars.update(self._tasks[scene], completed=fraction, state=state)
        elif time.monotonic() - self._spoke >= LINE_EVERY:
            self._spoke = time.monotonic()
            self._console.print(f"{scene}: {state}", markup=False)


def _state(report: dict[str, Any]) -> str:
    """One phrase of a progress report."""
    if report.get("stage") == "gravity":
        return "coming to rest under gravity"
    settlement, reaction = report.get("settlement"), report.get("reaction")
    moved = "" if settlement is None else f"moved {settlement * 1e3:.3f} {report.get('unit', '')}"
    return moved if reaction is None else f"{moved}, reaction {reaction:.5g}"
