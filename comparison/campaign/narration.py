"""A campaign as it happens, on stderr: a bar on a terminal, a line now and then elsewhere; failures at once."""

import time
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from comparison.numbers import plural
from comparison.progress import LINE_EVERY
from la_core.errors import visible


class CampaignNarration:
    """Counts a campaign's runs; silent on a quiet console."""

    def __init__(self, console: Console, title: str) -> None:
        self._console, self._title = console, title
        columns = (TextColumn("{task.description}", markup=False), BarColumn(), TextColumn("{task.fields[state]}", markup=False))
        self._bar = Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
        self._task = self._bar.add_task(visible(title), total=None, state="")
        self._total = self._running = self._done = self._failed = self._before = 0
        self._began = self._spoke = time.monotonic()

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._bar.stop()

    def opens(self, cases: int, runs: int, cached: int) -> None:
        """Tell how much there is to do."""
        self._total, self._done, self._before = runs, cached, cached
        self._began = time.monotonic()
        known = f", {cached} of them finished before" if cached else ""
        self._console.print(visible(f"{self._title}: {plural(cases, 'case')}, {plural(runs, 'run')}{known}"), markup=False)

    def begins(self) -> None:
        """A run was handed to a worker."""
        self._running += 1
        self.shows()

    def ends(self, name: str, state: str, reason: str) -> None:
        """A run ended; a failed one is told with its reason."""
        self._running -= 1
        self._done += state == "done"
        self._failed += state == "failed"
        if state == "failed":
            self._console.print(visible(f"{name}: failed: {reason}"), markup=False)
        self.shows()

    def shows(self) -> None:
        """Show the counts."""
        words = f"{self._done} of {self._total} done, {self._running} running, {self._failed} failed{self._left()}"
        if self._console.is_terminal:
            self._bar.update(self._task, total=self._total, completed=self._done + self._failed, state=words)
        elif time.monotonic() - self._spoke >= LINE_EVERY:
            self._spoke = time.monotonic()
            self._console.print(visible(f"{self._title}: {words}"), markup=False)

    def _left(self) -> str:
        """Time left, if what is to come takes as long as what was done in this call."""
        ended = self._done + self._failed
        if ended in (self._before, self._total):
            return ""
        seconds = (time.monotonic() - self._began) / (ended - self._before) * (self._total - ended)
        minutes, rest = divmod(round(seconds), 60)
        hours, minutes = divmod(minutes, 60)
        return f", about {hours} h {minutes:02} min left" if hours else f", about {minutes}:{rest:02} min left"
