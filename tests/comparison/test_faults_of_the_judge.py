"""Faults that the judge once had: tolerances that grew with doubt, noise against noise, excuses, curves that nobody compared."""

import dataclasses
import math
import warnings

import numpy as np
import pytest
import scenes
from runs import coulomb_run, made_up_run, perfect_run, with_answers

from comparison.figures.reaction_levels import curve_of
from comparison.judge import energy
from comparison.judge.curves import compare_curves
from comparison.judge.run_checks import check_run
from comparison.judge.tolerances import FLOOR, UNCERTAIN
from comparison.verdict.check import Check, Verdict, overall
from comparison.yade import Results
from comparison.yade.run_record import Run
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.coulomb import CoulombSolution
from la_core.limit.problem import Drive
from la_core.measures import mechanism
from la_core.model.joints import TRAVEL_OVER_SIZE

REACTION, SIMILARITY, MOVING = "reaction against prediction", "mechanism similarity", "moving blocks"


@pytest.fixture(scope="module")
def wall() -> LimitAnalysis:
    """A wall whose joints slide."""
    return analyse(scenes.shipped("wall_third"))


def coulomb_of(analysis: LimitAnalysis, **changes: object) -> CoulombSolution:
    assert analysis.coulomb is not None
    return dataclasses.replace(analysis.coulomb, **changes)  # type: ignore[arg-type]


def named(name: str, found: list[Check]) -> Check:
    return next(check for check in found if check.name.startswith(name))


def judged(analysis: LimitAnalysis, run: Run) -> list[Check]:
    return check_run(Results(analysis, run))


def stating(analysis: LimitAnalysis, share: float) -> LimitAnalysis:
    """The analysis with a prediction that states this uncertainty, as a share of its value."""
    value = coulomb_of(analysis).value
    return with_answers(analysis, coulomb=coulomb_of(analysis, uncertainty=share * value))


# --- a tolerance never grows into agreement ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("share", [0.02, 0.05, 0.1])
def test_doubt_of_limit_analysis_is_no_agreement_and_names_limit_analysis_and_what_is_cheaper(wall: LimitAnalysis, share: float) -> None:
    analysis = stating(wall, share)
    check = named(REACTION, judged(analysis, coulomb_run(wall, reaction=(1.0 + 0.8 * share) * coulomb_of(wall).value)))
    assert check.verdict is Verdict.INCONCLUSIVE
    assert check.reason.startswith("Limit analysis states an uncertainty") and "YADE states" not in check.reason
    assert "limit analysis" in check.next_step and "--try-harder" in check.next_step


@pytest.mark.parametrize("share", [0.012, 0.045])
def test_doubt_of_yade_is_no_agreement_and_names_yade(wall: LimitAnalysis, share: float) -> None:
    value = coulomb_of(wall).value
    check = named(REACTION, judged(wall, coulomb_run(wall, reaction=(1.0 + 0.8 * share) * value, uncertainty=share * value)))
    assert check.verdict is Verdict.INCONCLUSIVE
    assert check.reason.startswith("YADE states an uncertainty") and "YADE slower" in check.next_step


@pytest.mark.parametrize(("off", "verdict"), [(0.9 * FLOOR, Verdict.AGREE), (1.1 * FLOOR, Verdict.INCONCLUSIVE)])
def test_in_doubt_only_the_floor_makes_an_agreement(wall: LimitAnalysis, off: float, verdict: Verdict) -> None:
    reaction = coulomb_of(wall).value / (1.0 - off)  # the floor is a share of YADE's reaction
    check = named(REACTION, judged(stating(wall, 0.05), coulomb_run(wall, reaction=reaction)))
    assert check.verdict is verdict and check.reason.startswith("Limit analysis states an uncertainty")


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


# --- a reaction of zero -----------------------------------------------------------------------------------------------------------


def leaving(blocks: int) -> LimitAnalysis:
    """A stack of blocks that stands on the ground without the pad that settles: the pad leaves, and nothing moves."""
    stack = [scenes.box(f"block {i}", (0.0, 0.0, 0.4 * i), (1.2, 0.2, 0.4 * (i + 1))) for i in range(blocks)]
    ground = scenes.box("ground", (0.0, 0.0, -0.1), (1.0, 0.2, 0.0), "fixed")
    pad = scenes.box("pad", (1.0, 0.0, -0.1), (1.2, 0.2, 0.0), "support")
    return analyse(scenes.build(ground, pad, *stack, inset=1e-3))


def with_noise(analysis: LimitAnalysis, run: Run, size: float) -> Run:
    """The run with blocks that tremble by this share of the settlement."""
    trembling = np.random.default_rng(17).standard_normal(run.poses.displacement.shape[1:]) * analysis.assembly.blocks.free[:, None]
    displacement = run.poses.displacement + size * run.poses.settlement[:, None, None] * trembling
    return dataclasses.replace(run, poses=dataclasses.replace(run.poses, displacement=displacement))


@pytest.mark.parametrize("blocks", [1, 2, 4])
@pytest.mark.parametrize("noise", [0.0, 1e-9, 1e-4, 5e-3])
def test_two_reactions_of_zero_agree_whatever_trembles(blocks: int, noise: float) -> None:
    analysis = leaving(blocks)
    assert analysis.bounds[Drive.YIELDING].value == pytest.approx(0.0, abs=1e-6 * analysis.scene.weight)
    run = perfect_run(analysis, reaction=2e-6 * analysis.scene.weight, uncertainty=3e-6 * analysis.scene.weight)
    found = judged(analysis, with_noise(analysis, run, noise))
    assert overall(found)[0] is Verdict.AGREE, [check for check in found if check.verdict is not Verdict.AGREE]


def test_noise_is_no_motion_where_the_support_leaves_alone() -> None:
    analysis = leaving(2)
    run = with_noise(analysis, perfect_run(analysis), 5e-3)
    assert not mechanism.moving(analysis.assembly.blocks, run.mechanism()).any()
    assert named(SIMILARITY, judged(analysis, run)).reason.startswith("No block moves in either method")


@pytest.mark.parametrize(("least", "verdict"), [(energy.LEAST_TURNOVER, Verdict.AGREE), (0.0, Verdict.INCONCLUSIVE)])
def test_energy_that_hardly_anything_turned_over_is_noise(least: float, verdict: Verdict, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(energy, "LEAST_TURNOVER", least)
    analysis = leaving(2)
    run = with_noise(analysis, perfect_run(analysis), 1e-3)
    record = {name: np.zeros(5) for name in ("kinetic_energy", "reaction")} | {"settlement": run.poses.settlement}
    stiffness = {"normal_stiffness": analysis.stiffness.normal, "shear_stiffness": analysis.stiffness.shear}
    recorded = made_up_run(record=record | {"stage": np.array([0, 1, 1, 1, 1])}).record
    run = dataclasses.replace(run, record=recorded, settings=stiffness)
    run.poses.forces[1:] *= 1.5  # forces that do not balance the weights: the work does not add up
    (check,) = energy.check_energy(analysis.assembly, run)
    assert check.verdict is verdict


def test_a_block_that_moves_in_yade_alone_is_no_noise() -> None:
    analysis = leaving(2)
    run = with_noise(analysis, perfect_run(analysis), 0.5)
    assert overall(judged(analysis, run))[0] is Verdict.DISAGREE


def test_a_reaction_of_zero_that_is_not_zero_in_yade_disagrees() -> None:
    analysis = leaving(2)
    run = perfect_run(analysis, reaction=1e-3 * analysis.scene.weight)
    assert named(REACTION, judged(analysis, run)).verdict is Verdict.DISAGREE


# --- intervals protect nobody -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("factor", [0.93, 0.985, 1.015, 1.08])
def test_the_interval_of_a_mechanism_excuses_no_difference(wall: LimitAnalysis, factor: float) -> None:
    coulomb, low, high = coulomb_of(wall), *coulomb_of(wall).interval
    assert low < factor * coulomb.value < high  # both lie in it
    found = judged(wall, coulomb_run(wall, reaction=factor * coulomb.value))
    assert named(REACTION, found).verdict is Verdict.DISAGREE
    assert named("reaction within the mechanism's interval", found).verdict is Verdict.AGREE
    assert overall(found)[0] is Verdict.DISAGREE


def test_another_mechanism_excuses_no_difference_either(wall: LimitAnalysis) -> None:
    run = moved_otherwise(coulomb_run(wall, reaction=1.05 * coulomb_of(wall).value), np.arange(3, 9))
    assert named(REACTION, judged(wall, run)).verdict is Verdict.DISAGREE


def test_a_state_of_yade_that_is_in_doubt_may_not_contradict_limit_analysis(wall: LimitAnalysis) -> None:
    """Where its own forces show that not every joint slides that should, YADE is not at the end of its way."""
    run = coulomb_run(wall, reaction=1.05 * coulomb_of(wall).value)
    run.poses.forces[:] = wall.bounds[Drive.PUSHING].forces
    check = named(REACTION, judged(wall, run))
    assert check.verdict is Verdict.INCONCLUSIVE and "YADE slower" in check.next_step


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
    """The run in which these blocks go down with the support, too."""
    displacement = run.poses.displacement.copy()
    displacement[:, blocks, 2] -= run.poses.settlement[:, None]
    return dataclasses.replace(run, poses=dataclasses.replace(run.poses, displacement=displacement))


def others(analysis: LimitAnalysis) -> np.ndarray:
    """Blocks at rest in the prediction, with about a third of the mass."""
    blocks = analysis.assembly.blocks
    still = np.flatnonzero(blocks.free & ~mechanism.moving(blocks, coulomb_of(analysis).twists))
    return still[np.cumsum(blocks.mass[still]) <= 0.31 * analysis.assembly.movable_mass]


def test_a_mechanism_that_is_not_determined_decides_nothing_where_the_reactions_agree(wall: LimitAnalysis) -> None:
    run = moved_otherwise(coulomb_run(wall, reaction=1.004 * coulomb_of(wall).value), others(wall))
    found = judged(wall, run)
    check = named(MOVING, found)
    assert check.difference is not None and check.difference > 0.25 and "need not be unique" in check.reason  # it is said ...
    assert overall(found)[0] is Verdict.AGREE  # ... and does not decide


def test_where_no_joint_slides_another_mechanism_still_disagrees() -> None:
    arch = analyse(scenes.shipped("arch_spreading"))
    assert overall(judged(arch, moved_otherwise(perfect_run(arch), np.array([3]))))[0] is Verdict.DISAGREE


def test_a_block_at_the_threshold_of_motion_is_the_same_in_both_methods(wall: LimitAnalysis) -> None:
    """Blocks that creep by 4 % in one method and by 6 % in the other do not move in one only."""
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


# --- sharp values without a witness -------------------------------------------------------------------------------------------------


def test_no_sharp_value_is_stated_where_the_history_of_friction_decides(wall: LimitAnalysis) -> None:
    assert coulomb_of(wall).value > 1.05 * wall.bounds[Drive.YIELDING].value  # joints slide: the history decides
    assert wall.sharp.coulomb is None
    arch = analyse(scenes.shipped("arch_spreading"))
    assert arch.sharp.coulomb is not None  # nothing slides: the value is that of the bound, with other lever arms
    assert arch.sharp.coulomb.value == pytest.approx(arch.sharp.bounds[Drive.YIELDING].value)


# --- whole curves -----------------------------------------------------------------------------------------------------------------


def test_whole_curves_are_compared_where_both_exist(wall: LimitAnalysis) -> None:
    coulomb = coulomb_of(wall)
    settlement = np.linspace(0.0, coulomb.path_settlement[-1] * 0.8, 300)
    reaction = np.interp(settlement, coulomb.path_settlement, coulomb.path_value)
    bump = np.exp(-(((settlement - settlement[100]) / settlement[5]) ** 2))
    record = {"stage": np.ones(300, dtype=int), "settlement": settlement, "reaction": reaction + 50.0 * bump}
    run = dataclasses.replace(coulomb_run(wall), record=made_up_run(record=record).record)
    found = compare_curves(Results(wall, run))
    assert found is not None
    assert found.largest == pytest.approx(50.0) and found.settlement == pytest.approx(settlement[100])
    assert found.until == pytest.approx(settlement[-1])
    assert found.mean == pytest.approx(float(50.0 * np.mean(bump)), rel=0.01)
    assert overall(judged(wall, run))[0] is Verdict.AGREE  # the verdict rests on the plateaus


def test_a_path_is_put_to_the_stiffness_of_yades_joints(wall: LimitAnalysis) -> None:
    coulomb, stiffer = coulomb_of(wall), 4.0
    settlement = np.linspace(0.0, coulomb.path_settlement[-1] / stiffer, 200)
    reaction = np.interp(stiffer * settlement, coulomb.path_settlement, coulomb.path_value)
    record = {"stage": np.ones(200, dtype=int), "settlement": settlement, "reaction": reaction}
    settings = {"normal_stiffness": stiffer * wall.stiffness.normal}
    run = dataclasses.replace(coulomb_run(wall), record=made_up_run(record=record).record, settings=settings)
    found = compare_curves(Results(wall, run))
    assert found is not None
    assert found.largest <= 1e-9 * coulomb.value and found.until == pytest.approx(settlement[-1])


def test_curves_are_compared_as_far_as_both_go_and_not_at_all_without_one(wall: LimitAnalysis) -> None:
    coulomb = coulomb_of(wall)
    beyond = np.linspace(0.0, 2.0 * coulomb.path_settlement[-1], 50)
    record = {"stage": np.ones(50, dtype=int), "settlement": beyond, "reaction": np.full(50, coulomb.value)}
    run = dataclasses.replace(coulomb_run(wall), record=made_up_run(record=record).record)
    found = compare_curves(Results(wall, run))
    assert found is not None and found.until <= coulomb.path_settlement[-1]
    assert compare_curves(Results(wall, made_up_run())) is None and compare_curves(Results(wall)) is None
    arch = analyse(scenes.shipped("arch_spreading"))
    assert compare_curves(Results(arch, coulomb_run(arch))) is None  # no joint slides: no path was followed
    assert math.isfinite(found.largest)


@pytest.mark.parametrize("stiffness", [0.0, math.nan])
def test_curves_are_not_compared_where_yades_stiffness_is_undefined(wall: LimitAnalysis, stiffness: float) -> None:
    """A damaged record; the path cannot be put to the run's settlements, and no warning of a division reaches the user."""
    run = dataclasses.replace(coulomb_run(wall), settings={"normal_stiffness": stiffness})
    results = Results(wall, run)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert math.isnan(results.stiffening) and compare_curves(results) is None
        assert [len(part) for part in curve_of(results, 1e-3)] == [0, 0]
