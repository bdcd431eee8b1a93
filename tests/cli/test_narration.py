"""While limit analysis works, a command shows its bounds, its path and the time left, on a terminal and without one."""

import dataclasses
import io
import itertools
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
from paths import REPORTS, with_reports
from rich.console import Console

from comparison import progress
from comparison.cli.commands import main
from comparison.cli.exit_codes import AGREE
from comparison.progress import LINE_EVERY, Narration
from la_core.analysis import AnalysisSettings, analyse
from la_core.coulomb import PathProgress
from la_core.limit import Drive, Status
from la_core.scene import load, variant

WEIGHT = 2158.2  # N, of two pads


@pytest.fixture
def ticks(monkeypatch: pytest.MonkeyPatch) -> Callable[[float], None]:
    """Return a function that lets Narration's clock advance by so many seconds at each reading."""

    def by(seconds: float) -> None:
        clock = itertools.count(step=seconds)
        monkeypatch.setattr(progress, "time", SimpleNamespace(monotonic=lambda: next(clock)))

    return by


def test_lines_tell_share_value_and_time_left_where_there_is_no_terminal(
    ticks: Callable[[float], None], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    ticks(LINE_EVERY)
    with_reports(monkeypatch)
    assert main(["solve", "two_pads"]) == AGREE
    lines = [line for line in capsys.readouterr().err.splitlines() if ": path " in line]
    assert len(lines) == len(REPORTS)
    for line, report in zip(lines, REPORTS, strict=True):
        assert f"two_pads: path {report.path} of 2: {100 * report.share:.0f} %, R {report.value:g} N" in line
        assert f"R/W {report.value / WEIGHT:.4g}" in line
        assert ("min left" in line) == (report.share > 0.0)


def test_lines_are_few_where_there_is_no_terminal(
    ticks: Callable[[float], None], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    ticks(LINE_EVERY / 100.0)
    with_reports(monkeypatch)
    assert main(["solve", "two_pads"]) == AGREE
    assert ": path " not in capsys.readouterr().err


def test_paths_that_begin_again_with_more_blocks_say_so_at_once(
    ticks: Callable[[float], None], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    ticks(LINE_EVERY / 100.0)
    with_reports(monkeypatch, reports=tuple(PathProgress(0.1, 0.1, 100.0, 0.01, 1, 2, blocks) for blocks in (0, 300, 300, 400, 400)))
    assert main(["solve", "two_pads"]) == AGREE
    said = [line for line in capsys.readouterr().err.splitlines() if "again" in line]
    again = "the paths begin again with 400 free blocks, because the answer with 300 is not proven for the whole structure"
    assert said == [f"two_pads: limit analysis: {again}"]


def test_a_multiplier_has_no_weight(
    ticks: Callable[[float], None], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    ticks(LINE_EVERY)
    with_reports(monkeypatch, reports=(PathProgress(0.5, 0.5, 0.25, 0.01, 1, 1),))
    assert main(["solve", "ferris_tin_loi_1", "--json"]) == AGREE
    said = capsys.readouterr().err
    assert "bound: multiplier 0.6429" in said and "ferris_tin_loi_1: path: 50 %, multiplier 0.2500\n" in said


def test_a_run_narrates_bounds_and_path(
    ticks: Callable[[float], None],
    plain_figures: None,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    ticks(LINE_EVERY)
    with_reports(monkeypatch)
    assert main(["run", "two_pads", "ferris_tin_loi_1", "--no-yade", "-o", str(tmp_path)]) == AGREE
    said = capsys.readouterr().err.splitlines()
    for name in ("two_pads", "ferris_tin_loi_1"):
        told = [line.removeprefix(f"{name}: ").split(":")[0] for line in said if line.startswith(f"{name}: ")]
        assert told == ["limit analysis", "limit analysis", *["path 1 of 2"] * 2, *["path 2 of 2"] * 2, "comparison"]


def shown(monkeypatch: pytest.MonkeyPatch, terminal: str) -> str:
    """Return the output of two reports on a terminal of this kind."""
    monkeypatch.setenv("TERM", terminal)
    screen = io.StringIO()
    with Narration(Console(file=screen, force_terminal=True, width=120)) as narration:
        narration.bounds(analyse(load("two_pads")))
        for report in REPORTS:
            narration.path(report)
            narration._bars.refresh()
    return screen.getvalue()


def test_a_terminal_shows_a_bar_and_a_dumb_one_does_not(monkeypatch: pytest.MonkeyPatch) -> None:
    screen = shown(monkeypatch, "xterm")
    assert "━" in screen and "path 2 of 2: 75 %, R 103 N, R/W 0.04772" in screen
    dumb = shown(monkeypatch, "dumb")
    assert "━" not in dumb and "path" not in dumb and "bounds: R 363.3 to 2154 N" in dumb


def test_the_time_left_follows_the_pace_and_starts_anew_where_the_share_falls(monkeypatch: pytest.MonkeyPatch) -> None:
    times = iter([0.0, 30.0, 100.0, 160.0, 170.0])
    monkeypatch.setattr(progress, "time", SimpleNamespace(monotonic=lambda: next(times)))
    pace = progress._Pace()
    assert pace.time_left(0.2) == ""
    assert pace.time_left(0.5) == ", about 0:50 min left"  # 0.3 in 30 s
    assert pace.time_left(0.1) == ""  # the travel turned out to be longer
    assert pace.time_left(0.4) == ", about 2:00 min left"  # 0.3 in 60 s
    assert pace.time_left(1.0) == ""


@pytest.mark.parametrize(
    ("status", "words"),
    [
        (Status.INFEASIBLE, "bounds: infeasible"),
        (Status.SOLVED, "bounds: R 363.3 to 2154 N, R/W 0.1683 to 0.9980"),
    ],
)
def test_bounds_in_words(status: Status, words: str) -> None:
    analysis = analyse(load("two_pads"))
    bounds = {drive: dataclasses.replace(bound, status=status) for drive, bound in analysis.bounds.items()}
    changed = dataclasses.replace(analysis, at_inset=dataclasses.replace(analysis.at_inset, bounds=bounds))
    assert progress.bounds_words(changed) == words


def test_bounds_without_an_upper_one_in_words() -> None:
    analysis = analyse(load("two_pads"))
    bounds = dict(analysis.bounds)
    bounds[Drive.PUSHING] = dataclasses.replace(bounds[Drive.PUSHING], status=Status.UNBOUNDED, value=float("inf"))
    changed = dataclasses.replace(analysis, at_inset=dataclasses.replace(analysis.at_inset, bounds=bounds))
    assert progress.bounds_words(changed) == "bounds: R at least 363.3 N, R/W at least 0.1683"


def test_a_bound_of_round_off_is_zero() -> None:
    analysis = analyse(load("two_pads"))
    bounds = dict(analysis.bounds)
    bounds[Drive.YIELDING] = dataclasses.replace(bounds[Drive.YIELDING], value=6.4e-7)  # of a slab that tips off its support
    changed = dataclasses.replace(analysis, at_inset=dataclasses.replace(analysis.at_inset, bounds=bounds))
    assert progress.bounds_words(changed) == "bounds: R 0 to 2154 N, R/W 0 to 0.9980"


def test_a_bound_of_round_off_on_a_multiplier_is_zero() -> None:
    analysis = analyse(variant(load("ferris_tin_loi_1"), {"joint.inset": 0.001}), AnalysisSettings(bounds_only=True))
    bounds = {drive: dataclasses.replace(bound, value=1.5e-11) for drive, bound in analysis.bounds.items()}  # of a block without friction
    changed = dataclasses.replace(analysis, at_inset=dataclasses.replace(analysis.at_inset, bounds=bounds))
    assert progress.bounds_words(changed) == "bound: multiplier 0"


def test_bounds_of_sharp_edges_are_called_so() -> None:
    sharp = analyse(variant(load("two_pads"), {"joint.inset": 0.0}))
    assert progress.bounds_words(sharp) == "bounds: R 359.7 to 2158 N, R/W 0.1667 to 1.000, for sharp edges"
