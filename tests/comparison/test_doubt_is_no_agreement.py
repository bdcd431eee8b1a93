"""The uncertainty that a method states never turns a difference into an agreement."""

import math
from dataclasses import replace

import pytest
import scenes
from judged_runs import REACTION, coulomb_of, judged, named
from runs import coulomb_run, perfect_run, with_answers

from comparison.judge.checks.reduced_model import check_displacement, largest_displacements
from comparison.judge.checks.tolerances import FLOOR, UNCERTAIN
from comparison.verdict.check import Verdict
from comparison.yade import Results
from la_core.analysis.result import AccuracyRecord, LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.limit.associated import Status
from la_core.limit.problem import Drive
from la_core.model.joints import TRAVEL_OVER_SIZE


@pytest.fixture(scope="module")
def wall() -> LimitAnalysis:
    """A wall whose joints slide."""
    return analyse(scenes.shipped("wall_third"))


def stating(analysis: LimitAnalysis, share: float) -> LimitAnalysis:
    """Return the analysis with this uncertainty of the prediction, as a share of its value."""
    value = coulomb_of(analysis).value
    return with_answers(analysis, coulomb=coulomb_of(analysis, uncertainty=share * value))


@pytest.mark.parametrize("share", [0.02, 0.05, 0.1])
def test_doubt_of_limit_analysis_is_no_agreement_and_names_limit_analysis_and_what_is_cheaper(wall: LimitAnalysis, share: float) -> None:
    analysis = stating(wall, share)
    check = named(REACTION, judged(analysis, coulomb_run(wall, reaction=(1.0 + 0.8 * share) * coulomb_of(wall).value)))
    assert check.verdict is Verdict.INCONCLUSIVE
    assert check.reason.startswith("Limit analysis states an uncertainty") and "YADE states" not in check.reason
    assert "limit analysis" in check.next_step and "--try-harder" in check.next_step


@pytest.mark.parametrize(
    ("uncertainty", "reason", "step"), [(math.inf, "the blocks slide and fall", "bounds"), (math.nan, "", "finer paths")]
)
def test_a_prediction_without_a_value_says_why(wall: LimitAnalysis, uncertainty: float, reason: str, step: str) -> None:
    """An infinite uncertainty means that blocks fell on the path of limit analysis."""
    failed = with_answers(wall, coulomb=coulomb_of(wall, status=Status.FAILED, uncertainty=uncertainty))
    check = named(REACTION, judged(failed, perfect_run(wall)))
    assert check.verdict is Verdict.INCONCLUSIVE and "dilate" in check.reason
    assert reason in check.reason and step in check.next_step


@pytest.mark.parametrize("share", [0.012, 0.045])
def test_doubt_of_yade_is_no_agreement_and_names_yade(wall: LimitAnalysis, share: float) -> None:
    value = coulomb_of(wall).value
    check = named(REACTION, judged(wall, coulomb_run(wall, reaction=(1.0 + 0.8 * share) * value, uncertainty=share * value)))
    assert check.verdict is Verdict.INCONCLUSIVE
    assert check.reason.startswith("YADE states an uncertainty") and "YADE more slowly" in check.next_step


@pytest.mark.parametrize(("off", "verdict"), [(0.9 * FLOOR, Verdict.AGREE), (1.1 * FLOOR, Verdict.INCONCLUSIVE)])
def test_in_doubt_only_the_floor_makes_an_agreement(wall: LimitAnalysis, off: float, verdict: Verdict) -> None:
    reaction = coulomb_of(wall).value / (1.0 - off)  # the floor is a share of YADE's reaction
    check = named(REACTION, judged(stating(wall, 0.05), coulomb_run(wall, reaction=reaction)))
    assert check.verdict is verdict and check.reason.startswith("Limit analysis states an uncertainty")


@pytest.mark.parametrize(("share", "verdict"), [(0.049, Verdict.AGREE), (0.051, Verdict.INCONCLUSIVE), (0.22, Verdict.INCONCLUSIVE)])
@pytest.mark.parametrize("method", ["limit analysis", "YADE"])
def test_a_value_that_is_hardly_known_agrees_with_nothing(wall: LimitAnalysis, method: str, share: float, verdict: Verdict) -> None:
    """A value with more than 5 % uncertainty agrees with nothing.

    A facade had "YADE 0.15 ± 0.03" and "agree": YADE's two attempts were 9 % apart, and the second met the prediction.
    """
    value = coulomb_of(wall).value
    is_yade = method == "YADE"
    analysis, run = (wall, share * value) if is_yade else (stating(wall, share), 0.0)
    check = named(REACTION, judged(analysis, coulomb_run(wall, uncertainty=run)))
    assert check.verdict is verdict and "agree within the floor of the tolerance alone" in check.reason
    assert (method in check.next_step or "YADE more slowly" in check.next_step) == (verdict is Verdict.INCONCLUSIVE)


@pytest.mark.parametrize(
    ("asked", "off", "verdict"),
    [
        (0.001, 0.9 * FLOOR, Verdict.AGREE),  # the floor does not shrink with the requested accuracy
        (0.001, 1.1 * FLOOR, Verdict.DISAGREE),
        (0.01, 0.019, Verdict.AGREE),
        (0.01, 0.021, Verdict.DISAGREE),
    ],
)
def test_the_floor_is_at_least_twice_a_requested_accuracy(wall: LimitAnalysis, asked: float, off: float, verdict: Verdict) -> None:
    analysis = replace(stating(wall, 0.0), accuracy=AccuracyRecord(asked))
    run = coulomb_run(analysis, reaction=coulomb_of(wall).value / (1.0 - off), uncertainty=0.0)
    assert named(REACTION, judged(analysis, run)).verdict is verdict


def test_where_both_are_in_doubt_the_cheaper_one_comes_first(wall: LimitAnalysis) -> None:
    value = coulomb_of(wall).value
    check = named(REACTION, judged(stating(wall, 0.05), coulomb_run(wall, reaction=1.02 * value, uncertainty=0.05 * value)))
    assert check.reason.index("Limit analysis states") < check.reason.index("YADE states")
    assert "finer paths" in check.next_step


def test_the_tolerance_is_both_uncertainties_and_a_floor_alike_where_joints_slide_and_where_not(wall: LimitAnalysis) -> None:
    value = coulomb_of(wall).value
    check = named(REACTION, judged(stating(wall, 0.004), coulomb_run(wall, uncertainty=0.003 * value)))
    assert check.tolerance == pytest.approx((FLOOR + 0.004 + 0.003) * value)
    arch = analyse(scenes.shipped("arch_spreading"))
    least = arch.bounds[Drive.YIELDING].value
    stated = coulomb_of(arch).uncertainty
    check = named(REACTION, judged(arch, perfect_run(arch, uncertainty=0.003 * least)))
    assert check.tolerance == pytest.approx((FLOOR + 0.003) * least + stated)


def test_the_floor_is_what_the_travel_changes_in_a_lever_arm_of_half_a_block() -> None:
    assert pytest.approx(TRAVEL_OVER_SIZE / 0.5) == FLOOR
    assert UNCERTAIN >= FLOOR


@pytest.mark.parametrize(("gaps", "verdict"), [(2.1, Verdict.AGREE), (1.9, Verdict.INCONCLUSIVE)])
def test_contacts_may_be_missed_where_a_block_moves_by_more_than_half_the_least_gap(
    wall: LimitAnalysis, gaps: float, verdict: Verdict
) -> None:
    """Two blocks may approach each other, each by the largest displacement. gaps: the least gap over the largest displacement."""
    run = coulomb_run(wall)
    small = wall.with_effects(wall.assembly.effects.with_effect("displacement", "small", "nothing is near"))
    largest = float(largest_displacements(wall.assembly.blocks, run).max())
    (check,) = check_displacement(Results(replace(small, least_gap=gaps * largest), run))
    assert largest > 0.0 and check.verdict is verdict
