"""Progress on stderr, of a scene or a campaign: bars on a terminal, a line every few seconds elsewhere; failures at once."""

import time
from types import TracebackType
from typing import Any, Self

from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, TaskID, TextColumn, TimeElapsedColumn

from comparison.errors import StderrConsole
from comparison.numbers import format_number, plural, value_range
from la_core.analysis import LimitAnalysis
from la_core.coulomb import PathProgress
from la_core.errors import true_or_false, visible
from la_core.limit import Drive, Status
from la_core.scene import Scene, tilt_angles
from la_core.text_table import without_round_off

LINE_EVERY = 10.0  # s between progress lines where there is no terminal that can show a bar
LONG = 60.0  # s: an attempt of YADE is announced where at least this time is left
LEAST_GAIN = 0.01  # share of the work: before this gain, the pace says little about the time left
BAR_WIDTH = 16  # characters: the words beside it need the rest of 80


class _Bars:
    """Progress bars of one console, shown from entering to leaving the context; silent on a quiet console."""

    def __init__(self, console: Console, *more_columns: ProgressColumn) -> None:
        columns = (TextColumn("{task.description}", markup=False), BarColumn(BAR_WIDTH), TextColumn("{task.fields[state]}", markup=False))
        self._console = console
        self._has_bars = console.is_terminal and not console.is_dumb_terminal
        self._bars = Progress(*columns, *more_columns, console=console, transient=True, disable=not self._has_bars)
        self._spoke = time.monotonic()

    def __enter__(self) -> Self:
        self._bars.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._bars.stop()

    def _say(self, line: str) -> None:
        self._console.print(visible(line), markup=False)

    def _say_now_and_then(self, line: str) -> None:
        """Print a line unless the last one was printed less than LINE_EVERY seconds ago."""
        if self._is_heard:
            self._spoke = time.monotonic()
            self._say(line)

    @property
    def _is_heard(self) -> bool:
        """Whether a line printed now would be shown: always with bars, otherwise LINE_EVERY seconds after the last line."""
        return self._has_bars or time.monotonic() - self._spoke >= LINE_EVERY


class Narration(_Bars):
    """A listener of `comparison.workflow` that prints progress for a person."""

    def __init__(self, console: Console) -> None:
        super().__init__(console, TimeElapsedColumn())
        self._tasks: dict[str, TaskID] = {}
        self._analysed: Scene | None = None
        self._modelled = 0  # free blocks in its paths; 0 before the first report
        self._pace = _Pace()
        self._announced: dict[str, int] = {}  # last attempt of YADE that was announced, by scene

    def stage(self, scene: str, stage: str, state: str) -> None:
        """Print that a stage began, was found cached or ended badly."""
        self._say(f"{scene}: {stage}: {state}")
        self._end_bar(scene)

    def bounds(self, analysis: LimitAnalysis) -> None:
        """Print the bounds; the paths that follow belong to the same analysis."""
        self._end_bar(analysis.scene.name)
        self._analysed, self._modelled, self._pace = analysis.scene, 0, _Pace()
        self.tell_bounds(analysis)

    def tell_bounds(self, analysis: LimitAnalysis) -> None:
        """Print the bounds as one line."""
        self._say(f"{analysis.scene.name}: limit analysis: {bounds_words(analysis)}")

    def path(self, report: PathProgress) -> None:
        """Show the progress of the prediction's paths, and print where they begin again with more blocks."""
        scene, share = self._analysed, report.share
        assert scene is not None  # bounds come first
        if report.blocks > self._modelled > 0:
            why = f"the answer with {self._modelled} is not proven for the whole structure"
            self._say(f"{scene.name}: limit analysis: the paths begin again with {report.blocks} free blocks, because {why}")
        self._modelled = report.blocks
        which = f"path {report.path} of {report.paths}" if report.paths > 1 else "path"
        left = self._pace.time_left(share)
        if self._is_heard:  # a path has thousands of points
            self.fraction(scene.name, share, f"{which}: {100.0 * share:.0f} %, {value_words(scene, report.value)}{left}")

    def progress(self, scene: str, report: dict[str, Any]) -> None:
        """Show the progress of a running YADE case; an attempt that is expected to take long is announced.

        report: progress report of YADE's process.
        """
        if report.get("stage") == "loaded":
            self._announced.pop(scene, None)
            return
        attempt, seconds, share = int(report.get("attempt") or 1), report.get("seconds_left"), float(report.get("fraction") or 0.0)
        which = f"attempt {attempt}, " if attempt > 1 else ""
        late = "no plateau yet, " if report.get("is_late") else ""
        if seconds is not None and seconds >= LONG and attempt > self._announced.get(scene, 0):
            self._announced[scene] = attempt
            self._say(f"{scene}: YADE: {which}{late}{_announcement(seconds, report)}")
        done = f"{100.0 * share:.0f} %, " if share > 0.0 else ""
        left = "" if seconds is None else _time_left(seconds)
        self.fraction(scene, share, f"YADE: {done}{which}{late}{_state(report)}{left}")

    def fraction(self, scene: str, fraction: float, state: str) -> None:
        """Move the bar of a scene's long work; without a terminal, print a line every few seconds.

        fraction: share of the work that is done, 0 to 1. state: the present state of the work as one phrase.
        """
        if not self._has_bars:
            self._say_now_and_then(f"{scene}: {state}")
            return
        if scene not in self._tasks:
            self._tasks[scene] = self._bars.add_task(scene, total=1.0, state="")
        self._bars.update(self._tasks[scene], completed=fraction, state=state)

    def _end_bar(self, scene: str) -> None:
        if scene in self._tasks:
            self._bars.remove_task(self._tasks.pop(scene))


class _Pace:
    """Remaining time of some work, from its pace since the first report, or since its estimated share last fell."""

    def __init__(self) -> None:
        self._began, self._first, self._last = 0.0, 0.0, float("inf")

    def time_left(self, done: float) -> str:
        """Return the remaining time as text, "" where it is unknown. done: share of the work, 0 to 1."""
        now = time.monotonic()
        if done < self._last:
            self._began, self._first = now, done
        self._last, gained = done, done - self._first
        return _time_left((now - self._began) / gained * (1.0 - done)) if gained >= LEAST_GAIN and done < 1.0 else ""


class CampaignNarration(_Bars):
    """Progress of a campaign: counts its runs in one bar."""

    def __init__(self, console: Console, title: str) -> None:
        super().__init__(console)
        self._title = title
        self._task = self._bars.add_task(visible(title), total=None, state="")
        self._total = self._running = self._done = self._failed = self._before = 0
        self._began = time.monotonic()
        self._is_told = False  # whether the end of all runs was printed

    def opens(self, cases: int, runs: int, cached: int) -> None:
        """Print the number of cases and runs; cached: runs that were finished before."""
        self._total, self._done, self._before = runs, cached, cached
        self._began = time.monotonic()
        known = f", {cached} of them finished before" if cached else ""
        self._say(f"{self._title}: {plural(cases, 'case')}, {plural(runs, 'run')}{known}")

    def begins(self) -> None:
        """Count a run that was handed to a worker."""
        self._running += 1
        self.shows()

    def ends(self, name: str, state: str, reason: str) -> None:
        """Count a run that ended in `state`; print a failed one with its reason."""
        self._running -= 1
        self._done += state == "done"
        self._failed += state == "failed"
        if state == "failed":
            self._say(f"{name}: failed: {reason}")
        self.shows()

    def shows(self) -> None:
        """Show the counts."""
        counts = f"{self._done} of {self._total} done, {self._running} running, {self._failed} failed{self._left()}"
        if self._has_bars:
            self._bars.update(self._task, total=self._total, completed=self._done + self._failed, state=counts)
        elif self._total and self._done + self._failed == self._total:
            if not self._is_told:
                self._is_told = True
                self._say(f"{self._title}: {counts}")
        else:
            self._say_now_and_then(f"{self._title}: {counts}")

    def _left(self) -> str:
        """Return the remaining time as text, from the mean time of the runs that ended in this call; "" where none or all ended."""
        ended = self._done + self._failed
        if ended in (self._before, self._total):
            return ""
        return _time_left((time.monotonic() - self._began) / (ended - self._before) * (self._total - ended))


def time_words(seconds: float) -> str:
    """Return a time in words: about 4:05 min, or about 1 h 05 min."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"about {hours} h {minutes:02} min" if hours else f"about {minutes}:{rest:02} min"


def _time_left(seconds: float) -> str:
    return f", {time_words(seconds)} left"


def bounds_words(analysis: LimitAnalysis) -> str:
    """Return the bounds at the scene's own inset in one phrase, or the status of a structure without them."""
    scene, bounds = analysis.scene, analysis.printed.bounds
    main, edges = bounds[analysis.main], "" if scene.inset else ", for sharp edges"
    if main.status is not Status.SOLVED:
        return f"bounds: {main.status}"
    if scene.live is not None:
        return f"bound: {value_words(scene, without_round_off(main.value, 1.0))}{edges}"
    greatest = bounds[Drive.PUSHING]
    lowest, highest = (without_round_off(value, scene.weight) for value in (main.value, greatest.value))
    values, shares = (value_range(lowest / unit, highest / unit, greatest.status is Status.UNBOUNDED, 4) for unit in (1.0, scene.weight))
    return f"bounds: R {values} {scene.unit}, R/W {shares}{_unit_of_share(scene)}{edges}"


def value_words(scene: Scene, value: float) -> str:
    """Return a reaction in its unit and over the weight, or a multiplier, in one phrase."""
    if scene.live is not None:
        angles = tilt_angles(scene.tilt, value)
        return f"multiplier {format_number(value)}" + (f", {format_number(angles['angle'])} degrees" if angles else "")
    return f"R {format_number(value)} {scene.unit}, R/W {format_number(value / scene.weight)}{_unit_of_share(scene)}"


def _unit_of_share(scene: Scene) -> str:
    """Return the unit of a reaction over the weight with a space before it: the moment of a turning support gives a length."""
    return " m" if scene.is_rotation else ""


def _announcement(seconds: float, report: dict[str, Any]) -> str:
    """Return as text the time that a run still takes, `seconds`, and the report's time limit where this ends the run first."""
    limit: float | None = report.get("seconds_to_limit")
    words = f"{time_words(seconds)} to a plateau, longer if the blocks stick and slip"
    if limit is None or seconds < limit:
        return words
    larger = "--try-harder-limit" if report.get("is_second_attempt") else "--time-limit, or time_limit in [yade],"
    return f"{words}; its time limit ends the run in {time_words(limit)} (a larger {larger} allows more)"


def _state(report: dict[str, Any]) -> str:
    """Return a progress report of YADE as one phrase."""
    if report.get("stage") == "gravity":
        return "coming to rest under gravity"
    settlement, reaction = report.get("settlement"), report.get("reaction")
    moved = "" if settlement is None else f"moved {settlement * 1e3:.3f} {report.get('unit', '')}"
    if reaction is None:
        return moved
    if report.get("quantity") == "multiplier":
        return f"{moved}, multiplier {reaction:.5g}"
    return f"{moved}, reaction {reaction + 0.0:.5g} {'N m' if report.get('unit') == 'mrad' else 'N'}"


def narration(quiet: bool) -> Narration:
    """Return a narration on standard error for a caller from Python; a quiet one prints nothing."""
    return Narration(StderrConsole(true_or_false("quiet", quiet)))
