"""Each check of a run computes its number as by hand, and contradicts limit analysis only where it may."""

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scenes
from judged_runs import REACTION, SIMILARITY, judged, named
from runs import TRAVEL, made_up_run, perfect_run, with_answers

from comparison.judge.checks.run_checks import BELOW, _check_balance, _check_bounds, _check_contacts, _check_settlement, _check_speed
from comparison.judge.checks.tolerances import unbalanced
from comparison.verdict.check import Verdict
from comparison.yade import Results, Run
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.limit import Status
from la_core.limit.problem import Drive

GROUND = scenes.box("ground", (-2.0, 0.0, -0.2), (5.0, 0.15, 0.0), "fixed")
LEAVES = "steady; the reaction leaves it before 1 m"


@pytest.fixture(scope="module")
def pads() -> LimitAnalysis:
    """A block on two pads; no joint slides."""
    return analyse(scenes.shipped("two_pads"))


@pytest.fixture(scope="module")
def arch() -> LimitAnalysis:
    return analyse(scenes.shipped("arch_spreading"))


@pytest.fixture(scope="module")
def pushed() -> LimitAnalysis:
    """Two blocks beside each other, one with three times the mass of the other."""
    blocks = [scenes.box(f"block {k}", (2.0 * k, 0.0, 0.0), (2.0 * k + 0.5, 0.15, 0.7), density=1000.0 * (1 + 2 * k)) for k in range(2)]
    return analyse(scenes.build(GROUND, *blocks, inset=1e-3, live=(1.0, 0.0, 0.0), friction=0.9))


def along(analysis: LimitAnalysis, **result: object) -> Run:
    """Return a run of both pushed blocks at a recorded speed of 1 mm/s. The heavy block moves half as fast as the light one."""
    bound = analysis.bounds[Drive.LIVE]
    twists = np.zeros_like(bound.twists)
    twists[analysis.assembly.blocks.free, 0] = [1.0, 0.5]
    stand_in = dataclasses.replace(bound, twists=twists)
    run = perfect_run(with_answers(analysis, bounds={Drive.YIELDING: stand_in}), **result)
    moved = np.linspace(0.0, TRAVEL, 101)
    record = {"stage": np.ones(101, dtype=int), "time": 1e3 * moved, "settlement": moved, "reaction": np.full(101, run.result.reaction)}
    return dataclasses.replace(run, record=made_up_run(record=record).record, settings={"speed": 7e-4})


def test_the_speed_along_a_load_is_the_mean_by_mass_times_speed(pushed: LimitAnalysis) -> None:
    """Masses m and 3 m at the speeds 1 and 1/2 give (1 + 3/4) / (1 + 3/2)."""
    check = _check_speed(Results(pushed, along(pushed)))
    assert check.verdict is Verdict.AGREE and check.yade == pytest.approx(1e-3 * 0.7)


@pytest.mark.parametrize(("rows", "is_known"), [([0, 20, 90, 100], True), ([0, 20, 90], False)])
def test_a_speed_takes_two_rows(pushed: LimitAnalysis, rows: list[int], is_known: bool) -> None:
    run = along(pushed)
    few = {name: values[rows] for name, values in vars(run.record).items() if len(values)}
    check = _check_speed(Results(pushed, dataclasses.replace(run, record=made_up_run(record=few).record)))
    assert (check.verdict is Verdict.AGREE) is is_known and ("never moved steadily" in check.reason) is not is_known


def test_a_multiplier_has_an_upper_bound_alone_and_none_where_there_is_none(pushed: LimitAnalysis) -> None:
    run = along(pushed, reaction=-0.1)
    (check,) = _check_bounds(Results(pushed, run))
    assert check.name == BELOW and check.verdict is Verdict.AGREE and check.range == (None, pytest.approx(0.498 / 0.7, rel=1e-6))
    free: Any = SimpleNamespace(scene=pushed.scene, analysis=SimpleNamespace(is_without_bound=True), recorded=run)
    assert list(_check_bounds(free)) == []


def test_the_state_at_the_very_start_of_a_plateau_counts(pushed: LimitAnalysis) -> None:
    """The multiplier rises. The forces belong to its mean over the plateau, its first state included."""
    bound = pushed.bounds[Drive.LIVE]
    run = along(pushed, plateau_start=0.5 * TRAVEL, reaction=bound.value)
    assert run.poses.settlement[2] == run.result.plateau_start
    run.record.reaction[:] = bound.value * (1.0 + 0.1 * (run.record.settlement / TRAVEL - 0.75))
    run.poses.displacement[:] = 0.0  # the forces act where the blocks were built
    assert _check_balance(Results(pushed, run)).yade == pytest.approx(0.0, abs=1e-5)


def test_a_state_is_judged_where_its_blocks_have_gone(pads: LimitAnalysis) -> None:
    """A block slides by 0.1 m over pads at rest: its weight moves by 0.1 m, and its contact points by half as much."""
    assembly, run, gone = pads.assembly, perfect_run(pads), 0.1
    (block,) = np.flatnonzero(assembly.blocks.free)
    place = assembly.points.position[:, 0]
    ends = [np.isclose(place, x) for x in (0.4 - assembly.inset, 0.5 + assembly.inset)]
    left, right = (place[end][0] for end in ends)
    share = (0.5 + gone - (left + gone / 2.0)) / (right - left)  # share of the weight at the right end
    run.poses.displacement[:], run.poses.rotation[:] = 0.0, 0.0
    run.poses.displacement[2:, block, 0] = gone
    upward = np.where(assembly.contact_blocks[1] == block, 1.0, -1.0) * assembly.weight
    run.poses.forces[:] = 0.0
    run.poses.forces[:, :, 2] = upward * sum(one * end / end.sum() for one, end in zip((1.0 - share, share), ends, strict=True))
    assert named("balance along the mechanism", judged(pads, run)).yade == pytest.approx(0.0, abs=1e-6 * assembly.weight)


def test_a_state_is_out_of_equilibrium_by_the_larger_of_its_two_faults(pads: LimitAnalysis) -> None:
    """A horizontal force of half a weight acts at a point without normal force: it is unbalanced, and exceeds friction by as much."""
    run, half = perfect_run(pads), 0.5 * pads.assembly.mean_weight
    pressed = pads.assembly.split(run.plateau_forces())[0]
    run.poses.forces[:, pressed.argmin(), 0] += half
    assert named("equilibrium of the YADE state", judged(pads, run)).yade == pytest.approx(0.5, rel=1e-3)


@pytest.mark.parametrize(("times", "verdict"), [(0.9, Verdict.DISAGREE), (1.3, Verdict.INCONCLUSIVE)])
def test_a_state_contradicts_a_prediction_up_to_the_unbalanced_force_that_is_accepted(
    pads: LimitAnalysis, times: float, verdict: Verdict
) -> None:
    """The force is horizontal and acts on a base without horizontal motion, so its power is zero."""
    run = perfect_run(pads, reaction=1.1 * pads.bounds[Drive.YIELDING].value)
    run.poses.forces[:, 0, 0] += times * unbalanced(Results(pads, run)) * pads.assembly.mean_weight
    assert named(REACTION, judged(pads, run)).verdict is verdict


@pytest.mark.parametrize(("message", "verdict"), [("steady", Verdict.DISAGREE), (LEAVES, Verdict.INCONCLUSIVE)])
def test_another_mechanism_on_a_plateau_that_yade_leaves_is_no_contradiction(arch: LimitAnalysis, message: str, verdict: Verdict) -> None:
    run = perfect_run(arch, message=message)
    run.poses.displacement[:] = 0.0
    run.poses.displacement[:, 3, 0] = run.poses.settlement
    assert named(SIMILARITY, judged(arch, run)).verdict is verdict


def test_a_support_that_did_not_move_as_far_as_it_was_driven_is_wrong_without_a_plateau_too(arch: LimitAnalysis) -> None:
    found = judged(arch, perfect_run(arch, status="no plateau", reaction=math.nan, settlement=0.9 * TRAVEL))
    assert named("settlement achieved", found).verdict is Verdict.DISAGREE


@pytest.mark.parametrize(("turns", "unit"), [(True, "rad"), (False, "m")])
def test_a_turn_is_told_in_radians(turns: bool, unit: str) -> None:
    scene: Any = SimpleNamespace(is_rotation=turns)
    check = _check_settlement(scene, made_up_run({"asked_settlement": 0.1, "settlement": 0.0998}))
    assert check.verdict is Verdict.DISAGREE and (check.unit, check.tolerance) == (unit, pytest.approx(1e-4))
    assert f"moved by 0.0998 {unit}, but a settlement of 0.1 {unit}" in check.reason


def test_contacts_that_are_not_listed_are_counted_and_three_of_them_named(arch: LimitAnalysis) -> None:
    pairs, names = np.array([[0, 2], [1, 3], [2, 4], [3, 5]]), arch.assembly.blocks.names
    check = _check_contacts(Results(arch, dataclasses.replace(perfect_run(arch), extra_contacts=pairs)))
    listed = len(arch.assembly.points)
    assert (check.limit_analysis, check.yade, check.difference) == (listed, listed + 4, 4)
    assert (
        f"4 contacts formed where limit analysis lists no contact point ({', '.join(f'{names[a]} and {names[b]}' for a, b in pairs[:3])})"
        in (check.reason)
    )


def test_an_unlimited_greatest_reaction_has_no_value_and_is_no_end_of_the_range(arch: LimitAnalysis) -> None:
    greatest = dataclasses.replace(arch.bounds[Drive.PUSHING], status=Status.UNBOUNDED, value=math.nan)
    unlimited = with_answers(arch, bounds={**arch.bounds, Drive.PUSHING: greatest})
    check = named("reaction within bounds", judged(unlimited, perfect_run(arch)))
    assert check.verdict is Verdict.AGREE and check.range == (pytest.approx(arch.bounds[Drive.YIELDING].value), None)


# --- falling structures -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("status", "verdict"), [(Status.SOLVED, Verdict.DISAGREE), (Status.INACCURATE, Verdict.INCONCLUSIVE)])
def test_only_an_equilibrium_that_was_found_must_hold_without_friction(status: Status, verdict: Verdict) -> None:
    pad = [scenes.box(f"pad {k}", (0.6 * k, 0.0, -0.1), (0.6 * k + 0.4, 0.2, 0.0), role) for k, role in enumerate(("fixed", "support"))]
    analysis = analyse(scenes.build(*pad, scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.2, 0.4)), inset=1e-3, friction=0.0))
    bound = dataclasses.replace(analysis.bounds[Drive.YIELDING], status=status)
    doubtful = with_answers(analysis, bounds={**analysis.bounds, Drive.YIELDING: bound})
    fallen = perfect_run(analysis, status="collapsed", reaction=math.nan)
    assert named("the structure stands", judged(doubtful, fallen)).verdict is verdict


def test_a_prediction_that_is_in_doubt_is_no_fall() -> None:
    analysis = analyse(scenes.shipped("wall_third"))
    assert analysis.coulomb is not None
    fallen = perfect_run(analysis, status="collapsed", reaction=math.nan)
    for status, falls in ((Status.FAILED, True), (Status.INACCURATE, False)):
        doubtful = with_answers(analysis, coulomb=dataclasses.replace(analysis.coulomb, status=status))
        check = named("the structure stands", judged(doubtful, fallen))
        assert check.reason.startswith("In both methods") is falls and "Blocks laid without thrust may slide" in check.reason


def test_blocks_that_were_given_a_thrust_are_not_said_to_lack_it() -> None:
    analysis = analyse(scenes.shipped("flat_arch"))
    check = named("the structure stands", judged(analysis, perfect_run(analysis, status="collapsed", reaction=math.nan, settlement=0.0)))
    assert check.reason.endswith("(steady).") and "laid without thrust" not in check.reason
