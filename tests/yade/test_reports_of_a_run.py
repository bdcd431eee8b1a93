"""The reports of a run of YADE while it goes on: the share that is done and the time that is left, at the pace of the attempt."""

import io
import json
import os
from types import SimpleNamespace
from typing import Any

import pytest

from yade_scripts.expected_steps import LATE_MORE, AttemptSteps


class Clocked:
    """A reporter with a clock that the test sets."""

    def __init__(self, run_case: Any, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now, self.stream = 0.0, io.StringIO()
        self.timed, self.between = run_case._SECONDS_TIMED, run_case._SECONDS_BETWEEN_LINES
        monkeypatch.setattr(run_case, "time", SimpleNamespace(monotonic=lambda: self.now))
        self.reporter = run_case.Reporter(self.stream)

    def begin(self, resting: float, settling: float, longest: float, later: float, limit: float = 1e9) -> None:
        self.reporter.attempt(AttemptSteps(resting, settling, longest, later), limit)

    def row(self, now: float, steps: int, stage: str = "settlement") -> dict[str, Any]:
        """Report a row and return the last line."""
        self.now = now
        self.reporter.progress(stage, steps, 0.0, 1.0)
        return dict(json.loads(self.stream.getvalue().splitlines()[-1].removeprefix("progress ")))


@pytest.fixture
def clocked(monkeypatch: pytest.MonkeyPatch) -> Clocked:
    for name in ("OMP_NUM_THREADS", "HOME"):  # the script sets them when it loads
        monkeypatch.setenv(name, os.environ.get(name, "1"))
    from yade_scripts import run_case

    return Clocked(run_case, monkeypatch)


def test_the_time_left_is_that_of_the_expected_steps_at_the_pace_so_far(clocked: Clocked) -> None:
    clocked.begin(resting=20.0, settling=80.0, longest=980.0, later=200.0)
    clocked.row(5.0, 10, "gravity")
    early = clocked.row(5.0 + 0.99 * clocked.timed, 15, "gravity")
    assert early["seconds_left"] is None, "too few steps are timed"
    assert early["fraction"] == pytest.approx(15.0 / 300.0)
    quick = clocked.row(6.0, 20, "gravity")
    assert quick["seconds_left"] == pytest.approx((80.0 + 200.0) / 10.0), "ten steps took a second"
    assert quick["attempt"] == 1 and not quick["is_late"]
    settling = clocked.row(8.0, 50)
    assert settling["seconds_left"] == pytest.approx((50.0 + 200.0) * 3.0 / 40.0) and settling["fraction"] == pytest.approx(50.0 / 300.0)


def test_a_long_rest_makes_no_plateau_late_and_takes_nothing_from_the_settlement(clocked: Clocked) -> None:
    clocked.begin(resting=20.0, settling=80.0, longest=980.0, later=0.0)
    clocked.row(0.0, 0, "gravity")
    resting = clocked.row(10.0, 1000, "gravity")
    assert not resting["is_late"] and resting["seconds_left"] == pytest.approx(0.8)
    assert clocked.row(10.5, 1050)["seconds_left"] == pytest.approx(0.3)


def test_a_late_plateau_is_expected_after_a_share_of_the_steps_so_far_and_within_the_travel(clocked: Clocked) -> None:
    clocked.begin(resting=0.0, settling=100.0, longest=1000.0, later=200.0)
    clocked.row(0.0, 0, "gravity")
    assert not clocked.row(0.99, 99)["is_late"]
    late = clocked.row(2.0, 100)
    assert late["is_late"] and late["seconds_left"] == pytest.approx((LATE_MORE * 100.0 + 200.0) * 2.0 / 100.0)
    assert clocked.row(9.0, 900)["seconds_left"] == pytest.approx((100.0 + 200.0) * 0.01)
    assert clocked.row(12.0, 1200)["seconds_left"] == pytest.approx(200.0 * 0.01), "steps beyond the travel are not owed"


def test_every_attempt_has_its_own_pace_and_adds_to_what_is_done(clocked: Clocked) -> None:
    clocked.begin(resting=0.0, settling=100.0, longest=1000.0, later=200.0, limit=60.0)
    clocked.row(0.0, 0, "gravity")
    assert clocked.row(9.0, 140)["seconds_to_limit"] == pytest.approx(51.0)
    unsaid = clocked.row(9.0 + 0.9 * clocked.between, 150)
    assert unsaid["fraction"] == pytest.approx(140.0 / (140.0 + 0.4 * 140.0 + 200.0)), "the line before: this one came too soon"
    clocked.now = 10.0
    clocked.begin(resting=50.0, settling=250.0, longest=900.0, later=0.0, limit=50.0)
    begun = clocked.row(11.0, 0, "gravity")
    assert begun["attempt"] == 2 and begun["seconds_left"] is None and begun["seconds_to_limit"] == pytest.approx(49.0)
    assert begun["fraction"] == pytest.approx(150.0 / 450.0), "the row without a line counts, too"
    later = clocked.row(12.0, 100, "gravity")
    assert later["seconds_left"] == pytest.approx(2.5) and later["fraction"] == pytest.approx(250.0 / 500.0)
