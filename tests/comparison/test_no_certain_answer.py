"""Where limit analysis has an uncertain answer or no value, a check gives the reason. For a certain value there is no such check."""

import dataclasses
import math

import pytest
import scenes
from judged_runs import coulomb_of
from runs import with_answers

from comparison.judge.checks.answer import check_answer, check_expected
from comparison.judge.checks.prediction import FELL
from comparison.verdict import Verdict
from la_core.analysis import LimitAnalysis, analyse
from la_core.limit import Status
from la_core.limit.problem import Drive


@pytest.fixture(scope="module")
def wall() -> LimitAnalysis:
    """A wall whose joints slide."""
    return analyse(scenes.shipped("wall_third"))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"status": Status.SOLVED}, None),
        (
            {"status": Status.INACCURATE, "value": 2000.0, "uncertainty": 30.0},
            "Coulomb limit analysis ended as inaccurate: its value is 2000 ± 30 N, and the largest residual of its limit state 3.0e-03.",
        ),
        ({"status": Status.FAILED, "value": math.nan}, "Coulomb limit analysis ended as failed, so it has no value."),
        ({"status": Status.FAILED, "uncertainty": math.inf}, f"Coulomb limit analysis ended as failed: {FELL}."),
    ],
)
def test_a_prediction_that_is_not_solved_decides_nothing_and_says_why(
    wall: LimitAnalysis, changes: dict[str, object], words: str | None
) -> None:
    doubtful = with_answers(wall, coulomb=coulomb_of(wall, sliding_residual=3e-3, **changes))
    found = [(check.verdict, check.reason) for check in check_answer(doubtful)]
    assert found == ([] if words is None else [(Verdict.INCONCLUSIVE, words)])


@pytest.mark.parametrize(("predicted", "count"), [(Status.SOLVED, 0), (Status.FAILED, 1)])
def test_a_bound_without_limit_is_no_lack_of_an_answer_where_the_prediction_has_a_value(
    wall: LimitAnalysis, predicted: Status, count: int
) -> None:
    locked = dataclasses.replace(wall.bounds[Drive.YIELDING], status=Status.UNBOUNDED, value=math.nan)
    answers = with_answers(wall, bounds={**wall.bounds, Drive.YIELDING: locked}, coulomb=coulomb_of(wall, status=predicted))
    assert len(list(check_answer(answers))) == count


@pytest.mark.parametrize("is_shared", [True, False])
def test_a_fall_at_the_shared_inset_is_told_once(wall: LimitAnalysis, is_shared: bool) -> None:
    """One check reports a fall at the shared inset. Only the check of the expected value reports a fall for sharp edges."""
    assert wall.scene.expected is not None
    fell = coulomb_of(wall, status=Status.FAILED, value=math.nan, uncertainty=math.inf)
    sharp = dataclasses.replace(wall.sharp, coulomb=None if is_shared else dataclasses.replace(fell))
    fallen = dataclasses.replace(with_answers(wall, coulomb=fell), sharp=sharp)
    check = next(check for check in check_expected(fallen) if check.name == "expected reaction")
    assert check.verdict is Verdict.INCONCLUSIVE and "ended as failed, but the scene expects" in check.reason
    assert (FELL[1:] in check.reason) is not is_shared
    assert ("an inset of" in check.reason) is is_shared
