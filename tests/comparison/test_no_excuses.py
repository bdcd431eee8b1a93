"""Neither an interval nor another mechanism excuses a difference. A mechanism decides only where it is determined."""

import dataclasses
import math

import numpy as np
import pytest
import scenes
from judged_runs import MOVING, REACTION, coulomb_of, judged, named
from runs import coulomb_run, perfect_run, with_answers

from comparison.verdict.check import Verdict, overall
from comparison.yade.run_record import Run
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.limit.problem import Drive
from la_core.measures import mechanism


@pytest.fixture(scope="module")
def wall() -> LimitAnalysis:
    """A wall whose joints slide."""
    return analyse(scenes.shipped("wall_third"))


# --- intervals excuse no difference -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("factor", [0.93, 0.985, 1.015, 1.08])
def test_the_interval_of_a_mechanism_excuses_no_difference(wall: LimitAnalysis, factor: float) -> None:
    coulomb, low, high = coulomb_of(wall), *coulomb_of(wall).interval
    assert low < factor * coulomb.value < high  # both values lie in the interval
    found = judged(wall, coulomb_run(wall, reaction=factor * coulomb.value))
    assert named(REACTION, found).verdict is Verdict.DISAGREE
    assert named("reaction within the mechanism's interval", found).verdict is Verdict.AGREE
    assert overall(found)[0] is Verdict.DISAGREE


def test_another_mechanism_excuses_no_difference_either(wall: LimitAnalysis) -> None:
    run = moved_otherwise(coulomb_run(wall, reaction=1.05 * coulomb_of(wall).value), np.arange(3, 9))
    assert named(REACTION, judged(wall, run)).verdict is Verdict.DISAGREE


def test_a_state_of_yade_that_is_in_doubt_may_not_contradict_limit_analysis(wall: LimitAnalysis) -> None:
    """Where YADE's own forces show that some joints do not slide as they should, YADE has not reached its final state."""
    run = coulomb_run(wall, reaction=1.05 * coulomb_of(wall).value)
    run.poses.forces[:] = wall.bounds[Drive.PUSHING].forces
    check = named(REACTION, judged(wall, run))
    assert check.verdict is Verdict.INCONCLUSIVE and "YADE more slowly" in check.next_step


@pytest.mark.parametrize(("factor", "jump", "verdict"), [(1.05, 0.6, "inconclusive"), (1.05, 0.4, "disagree"), (1.0, 0.6, "agree")])
def test_a_run_whose_block_jumped_may_confirm_limit_analysis_but_not_contradict_it(
    wall: LimitAnalysis, factor: float, jump: float, verdict: str
) -> None:
    """An unbalanced force above half a block's weight shows a jump, which may lead to another plateau."""
    run = coulomb_run(wall, reaction=factor * coulomb_of(wall).value)
    run.record.unbalanced[len(run.record) // 2] = jump
    place = f"{1e3 * run.record.settlement[len(run.record) // 2]:.3g} mm"
    check = named(REACTION, judged(wall, run))
    words = ("a block jumped", f"at a settlement of {place}")
    assert check.verdict == verdict and [word in check.reason for word in words] == [verdict == "inconclusive"] * 2


@pytest.mark.parametrize(
    ("stretches", "level", "named_stretch"),
    [
        ([(0.05, 0.2)], 1.0, 0),
        ([(0.05, 0.2)], 1.004, 0),  # the tolerance is 0.0056
        ([(0.05, 0.2)], 1.008, None),
        ([(0.05, 0.2)], 0.98, None),
        ([(0.11, 0.2)], 1.0, 0),
        ([(0.13, 0.2)], 1.0, None),  # begins after 0.6 of the settlement at its end
        ([(0.0, 0.004)], 1.0, None),  # too short
        ([(0.4, 0.9)], 1.0, None),  # on the later plateau
        ([(0.02, 0.04), (0.08, 0.25)], 1.0, 1),
        ([(0.02, 0.1), (0.2, 0.29)], 1.0, 0),  # the second stretch is longer, but begins too late for its length
    ],
)
def test_a_disagreement_names_an_earlier_stretch_at_the_prediction(
    wall: LimitAnalysis, stretches: list[tuple[float, float]], level: float, named_stretch: int | None
) -> None:
    """A named stretch is long enough for a plateau, ends before the later plateau at 0.3 of the travel, and is within the tolerance.

    stretches: begin and end over the travel; level: reaction on the stretches over the prediction.
    """
    value = coulomb_of(wall).value
    run = coulomb_run(wall, reaction=1.05 * value)
    settlement = run.record.settlement / run.record.settlement[-1]
    held = [(settlement >= begin) & (settlement <= end) for begin, end in stretches]
    run.record.reaction[np.any(held, axis=0)] = level * value
    unknown = with_answers(wall, coulomb=coulomb_of(wall, released=math.nan, released_uncertainty=math.nan))
    check = named(REACTION, judged(unknown, run))
    assert check.verdict is Verdict.DISAGREE
    assert ("within the tolerance of the prediction" in check.reason) == ("rests there" in check.next_step) == (named_stretch is not None)
    finite = unknown.with_effects(wall.assembly.effects.with_effect("rotation", "finite", ""))
    assert "rotation" not in named(REACTION, judged(finite, run)).next_step  # the prediction includes the release by turning blocks
    if named_stretch is not None:
        first, *_, last = 1e3 * run.record.settlement[held[named_stretch]]
        assert f"Before its plateau, from {first:.3g} mm to {last:.3g} mm, YADE's reaction" in check.reason


@pytest.mark.parametrize(
    ("released", "stated", "was_there", "verdict", "words", "step"),
    [
        (1.05, 1e-4, True, "agree", "The plateau agrees with the value that limit analysis predicts after turning blocks", ""),
        (1.05, 1e-4, False, "inconclusive", "but its curve was not at the prediction before", 'rotation = "finite"'),
        (1.05, 0.02, True, "inconclusive", "but this is too uncertain to decide by", "finer settings"),
        (1.07, 1e-4, True, "disagree", "It also differs from the value", "finer settings"),
        (0.95, 1e-4, True, "disagree", "It also differs from the value", "finer settings"),
        (1.0001, 1e-4, True, "disagree", "Before its plateau", "finer settings"),  # turning blocks change nothing
        (1.02, 0.04, True, "inconclusive", "but this is too uncertain to decide by", "finer settings"),
        (1.05, 0.06, True, "inconclusive", "but this is too uncertain to decide by", "finer settings"),  # nor whether the value changes
        (0.9, 0.02, True, "disagree", "It also differs from the value", "finer settings"),
    ],
)
def test_a_plateau_after_a_release_agrees_where_both_levels_are_those_of_limit_analysis(
    wall: LimitAnalysis, released: float, stated: float, was_there: bool, verdict: str, words: str, step: str
) -> None:
    """YADE's plateau is 5 % above the prediction. released, stated: the released value and its uncertainty, over the prediction."""
    value = coulomb_of(wall).value
    run = coulomb_run(wall, reaction=1.05 * value)
    if was_there:
        run.record.reaction[run.record.settlement <= 0.2 * run.record.settlement[-1]] = value
    analysis = with_answers(wall, coulomb=coulomb_of(wall, released=released * value, released_uncertainty=stated * value))
    found = judged(analysis, run)
    check = named(REACTION, found)
    assert check.verdict == verdict and words in check.reason and step in check.next_step
    compared = released if verdict == "agree" else 1.0
    assert check.limit_analysis == pytest.approx(compared * value) and check.difference == pytest.approx((1.05 - compared) * value)
    assert overall(found)[0] == verdict


def test_the_interval_before_a_release_does_not_bind_the_value_after_it(wall: LimitAnalysis) -> None:
    """YADE's plateau is the released value, 5 % above the prediction and above its interval."""
    value = coulomb_of(wall).value
    run = coulomb_run(wall, reaction=1.05 * value)
    run.record.reaction[run.record.settlement <= 0.2 * run.record.settlement[-1]] = value
    known = {"interval": (0.95 * value, 1.02 * value), "released_uncertainty": 1e-4 * value}
    agreeing, other = (with_answers(wall, coulomb=coulomb_of(wall, released=to * value, **known)) for to in (1.05, 1.08))
    assert overall(judged(agreeing, run))[0] is Verdict.AGREE
    assert named("reaction within the mechanism's interval", judged(other, run)).verdict is Verdict.DISAGREE


def test_a_run_in_doubt_may_not_agree_with_the_value_after_a_release(wall: LimitAnalysis) -> None:
    value = coulomb_of(wall).value
    run = coulomb_run(wall, reaction=1.05 * value)
    run.record.reaction[run.record.settlement <= 0.2 * run.record.settlement[-1]] = value
    run.record.unbalanced[len(run.record) // 2] = 0.6  # a block jumped
    analysis = with_answers(wall, coulomb=coulomb_of(wall, released=1.05 * value, released_uncertainty=1e-4 * value))
    assert named(REACTION, judged(analysis, run)).verdict is Verdict.INCONCLUSIVE


@pytest.mark.parametrize(("wedging", "rest", "verdict"), [(5e-5, 0.96, "inconclusive"), (5e-5, 1.0, "disagree"), (0.0, 0.96, "disagree")])
def test_only_a_lift_that_leaves_the_methods_at_rest_in_different_states_is_another_history(
    wall: LimitAnalysis, wedging: float, rest: float, verdict: str
) -> None:
    analysis = dataclasses.replace(wall, scene=dataclasses.replace(wall.scene, yade={"wedging": wedging}))
    run = coulomb_run(wall, reaction=1.1 * coulomb_of(wall).value)
    run.record.reaction[0] = rest * coulomb_of(wall).at_rest
    assert named(REACTION, judged(analysis, run)).verdict == verdict


# --- mechanisms where they are determined ----------------------------------------------------------------------------------------


def moved_otherwise(run: Run, blocks: np.ndarray) -> Run:
    """Return the run with these blocks also moving down with the support."""
    displacement = run.poses.displacement.copy()
    displacement[:, blocks, 2] -= run.poses.settlement[:, None]
    return dataclasses.replace(run, poses=dataclasses.replace(run.poses, displacement=displacement))


def others(analysis: LimitAnalysis) -> np.ndarray:
    """Return blocks at rest in the prediction that have about a third of the movable mass."""
    blocks = analysis.assembly.blocks
    still = np.flatnonzero(blocks.free & ~mechanism.moving(analysis.assembly, coulomb_of(analysis).twists))
    return still[np.cumsum(blocks.mass[still]) <= 0.31 * analysis.assembly.movable_mass]


def test_a_mechanism_that_is_not_determined_decides_nothing_where_the_reactions_agree(wall: LimitAnalysis) -> None:
    run = moved_otherwise(coulomb_run(wall, reaction=1.004 * coulomb_of(wall).value), others(wall))
    found = judged(wall, run)
    check = named(MOVING, found)
    assert check.difference is not None and check.difference > 0.25 and "need not be unique" in check.reason  # the difference is stated ...
    assert overall(found)[0] is Verdict.AGREE  # ... but does not decide


def test_where_no_joint_slides_another_mechanism_still_disagrees() -> None:
    arch = analyse(scenes.shipped("arch_spreading"))
    assert overall(judged(arch, moved_otherwise(perfect_run(arch), np.array([3]))))[0] is Verdict.DISAGREE
    passing = perfect_run(arch, message="steady; the reaction leaves it before 1 m")
    assert overall(judged(arch, moved_otherwise(passing, np.array([3]))))[0] is Verdict.INCONCLUSIVE


def test_a_block_at_the_threshold_of_motion_is_the_same_in_both_methods(wall: LimitAnalysis) -> None:
    """Blocks at 4.8 % of the fastest speed in one method and 5.3 % in the other, about the threshold of 5 %, count as alike."""
    blocks = wall.assembly.blocks
    slow = others(wall)
    twists = coulomb_of(wall).twists.copy()
    twists[slow] = 0.0
    fastest = mechanism.block_speeds(blocks, twists).max()
    twists[slow, 2] = -0.96 * mechanism.MOVING_SHARE * fastest
    run = coulomb_run(with_answers(wall, coulomb=coulomb_of(wall, twists=twists)))
    run.poses.displacement[:, slow, 2] *= 1.06 / 0.96
    check = named(MOVING, judged(with_answers(wall, coulomb=coulomb_of(wall, twists=twists)), run))
    assert check.difference == 0.0 and check.limit_analysis != check.yade


# --- no value for sharp edges -------------------------------------------------------------------------------------------------------


def test_no_sharp_value_is_stated_where_the_history_of_friction_decides(wall: LimitAnalysis) -> None:
    assert coulomb_of(wall).value > 1.05 * wall.bounds[Drive.YIELDING].value  # joints slide: the history decides
    assert wall.sharp.coulomb is None
    arch = analyse(scenes.shipped("arch_spreading"))
    assert arch.sharp.coulomb is not None  # nothing slides: the value is that of the bound, with other lever arms
    assert arch.sharp.coulomb.value == pytest.approx(arch.sharp.bounds[Drive.YIELDING].value)


def test_no_sharp_value_is_stated_where_slip_on_the_way_decides_although_the_mechanism_is_without() -> None:
    """Of three columns under two beams, an outer one settles and the other rises. No joint slides in the mechanism, yet the laws differ."""
    columns = [(name, x, role) for name, x, role in (("A", 0.0, "support"), ("B", 2.5, "support"), ("C", 1.25, "fixed"))]
    pads = [scenes.box(f"pad {name}", (x, 0.0, -0.2), (x + 0.5, 0.4, 0.0), role) for name, x, role in columns]
    shafts = [scenes.box(f"column {name}", (x, 0.0, 0.0), (x + 0.5, 0.4, 1.5)) for name, x, _ in columns]
    beams = [scenes.box(f"beam {x}", (x, 0.0, 1.5), (x + 1.5, 0.4, 1.8)) for x in (0.0, 1.5)]
    settlement = {"direction": [0.0, 0.0, -1.0], "zone": [{"blocks": ["pad B"], "ratio": -0.5}]}
    analysis = analyse(scenes.build(*pads, *shafts, *beams, inset=1e-3, model="coulomb", settlement=settlement))
    associated, coulomb = analysis.bounds[Drive.YIELDING], coulomb_of(analysis)
    assert mechanism.sliding_share(analysis.assembly, coulomb.twists, coulomb.forces) < 1e-3
    assert coulomb.value > 1.05 * associated.value
    assert analysis.sharp.coulomb is None
