"""What a run of YADE says while it goes on: the share that is done and the time that is left, at the pace of the attempt."""

import io
import json
import os
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from yade_scripts.expected_steps import AttemptSteps

Row = Callable[[float, int], dict[str, Any]]


@pytest.fixture
def reporter(monkeypatch: pytest.MonkeyPatch) -> tuple[Any, Row]:
    """Return a reporter on a clock of its own, and a function that reports a row at a time (s) and returns the line."""
    for name in ("OMP_NUM_THREADS", "HOME"):  # the script sets them when it loads
        monkeypatch.setenv(name, os.environ.get(name, "1"))
    from yade_scripts import run_case

    clock, stream = SimpleNamespace(now=0.0), io.StringIO()
    monkeypatch.setattr(run_case, "time", SimpleNamespace(monotonic=lambda: clock.now))
    made = run_case.Reporter(stream)

    def row(now: float, steps: int) -> dict[str, Any]:
        clock.now = now
        made.progress("settlement", steps, 0.0, 1.0)
        return dict(json.loads(stream.getvalue().splitlines()[-1].removeprefix("progress ")))

    return made, row


def test_the_time_left_is_that_of_the_expected_steps_at_the_pace_so_far(reporter: tuple[Any, Row]) -> None:
    made, row = reporter
    made.attempt(AttemptSteps(usual=100.0, most=1000.0, later=200.0))
    first = row(0.0, 0)
    assert first["seconds_left"] is None and first["fraction"] == 0.0, "no step is timed yet"
    quick = row(1.0, 50)
    assert quick["seconds_left"] == pytest.approx((50.0 + 200.0) / 50.0) and quick["fraction"] == pytest.approx(50.0 / 300.0)
    assert quick["attempt"] == 1 and not quick["is_late"]


def test_without_the_expected_plateau_the_time_left_is_that_of_the_whole_travel(reporter: tuple[Any, Row]) -> None:
    made, row = reporter
    made.attempt(AttemptSteps(usual=100.0, most=1000.0, later=200.0))
    row(0.0, 0)
    late = row(3.0, 150)
    assert late["is_late"] and late["seconds_left"] == pytest.approx((850.0 + 200.0) * 3.0 / 150.0)
    assert row(30.0, 1200)["seconds_left"] == pytest.approx(200.0 * 30.0 / 1200.0), "steps beyond the travel are not owed"


def test_every_attempt_has_its_own_pace_and_adds_to_what_is_done(reporter: tuple[Any, Row]) -> None:
    made, row = reporter
    made.attempt(AttemptSteps(usual=100.0, most=1000.0, later=200.0))
    row(0.0, 0)
    row(10.0, 150)
    made.attempt(AttemptSteps(usual=300.0, most=900.0, later=0.0))
    begun = row(11.0, 0)
    assert begun["attempt"] == 2 and begun["seconds_left"] is None and begun["fraction"] == pytest.approx(150.0 / 450.0)
    later = row(12.0, 100)
    assert later["seconds_left"] == pytest.approx(2.0) and later["fraction"] == pytest.approx(250.0 / 450.0)
