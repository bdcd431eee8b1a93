"""Where no joint slides, a correct run agrees in every check. A run with one fault fails the check of this fault."""

import dataclasses
import math

import numpy as np
import pytest
import scenes
from judged_runs import case_of, verdict_of
from runs import TRAVEL, made_up_run, perfect_run, with_answers

from comparison.judge.checks import mechanisms
from comparison.judge.checks.run_checks import check_run
from comparison.verdict.check import Verdict
from comparison.yade import Results
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.coulomb.solution import without_answer
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.measures import mechanism, residuals
from la_core.model.assembly import Assembly
from la_core.scene.scene import Scene


@pytest.fixture(scope="module")
def arch() -> tuple[Scene, LimitAnalysis]:
    return case_of("arch_spreading")


def test_a_run_that_follows_limit_analysis_agrees_in_everything(arch: tuple[Scene, LimitAnalysis]) -> None:
    found = check_run(Results(arch[1], perfect_run(arch[1])))
    assert {(check.verdict, check.reason, check.next_step) for check in found} == {(Verdict.AGREE, "", "")}
    assert {check.name.split(" along")[0] for check in found} == {
        "settlement achieved", "displacements within the least gap", "equilibrium of the YADE state", "plane answer in space",
        "balance", "reaction within bounds", "reaction against prediction", "mechanism similarity", "moving blocks",
        "force sums over sections", "support's force",
    }  # fmt: skip


@pytest.mark.parametrize(("factor", "verdict"), [(1.004, Verdict.AGREE), (0.996, Verdict.AGREE), (1.006, Verdict.DISAGREE)])
def test_the_reaction_is_judged_to_half_a_per_cent(arch: tuple[Scene, LimitAnalysis], factor: float, verdict: Verdict) -> None:
    _scene, analysis = arch
    run = perfect_run(analysis, reaction=factor * analysis.bounds[Drive.YIELDING].value)
    check = next(check for check in check_run(Results(analysis, run)) if check.name == "reaction against prediction")
    assert check.verdict is verdict
    assert ("N (0.6" in check.reason) is (verdict is Verdict.DISAGREE)


def test_an_earlier_level_at_the_prediction_is_not_put_down_to_friction(arch: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = arch
    value = analysis.bounds[Drive.YIELDING].value
    settlement = np.linspace(0.0, TRAVEL, 400)
    record = {
        "stage": np.ones(400, dtype=int),
        "settlement": settlement,
        "reaction": np.where(settlement < 0.2 * TRAVEL, value, 1.05 * value),
    }
    run = dataclasses.replace(perfect_run(analysis, reaction=1.05 * value), record=made_up_run(record=record).record)
    check = next(check for check in check_run(Results(analysis, run)) if check.name == "reaction against prediction")
    assert (
        check.verdict is Verdict.DISAGREE
        and "although friction does almost no work" in check.reason
        and "Before its plateau" not in check.reason
    )


@pytest.mark.parametrize("message", ["steady", "steady; the reaction leaves it before 1 m"])
def test_a_reaction_below_the_lower_bound_disagrees(arch: tuple[Scene, LimitAnalysis], message: str) -> None:
    """A bound holds for every state of equilibrium, also for a plateau that YADE leaves."""
    _scene, analysis = arch
    run = perfect_run(analysis, reaction=0.9 * analysis.bounds[Drive.YIELDING].value, message=message)
    assert verdict_of("reaction within bounds", check_run(Results(analysis, run))) is Verdict.DISAGREE


def test_a_run_that_does_not_know_its_reaction_decides_nothing(arch: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = arch
    value = analysis.bounds[Drive.YIELDING].value
    run = perfect_run(analysis, reaction=1.02 * value, uncertainty=0.2 * value)
    assert verdict_of("reaction against prediction", check_run(Results(analysis, run))) is Verdict.INCONCLUSIVE


def test_an_undefined_reaction_never_agrees(arch: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = arch
    found = check_run(Results(analysis, perfect_run(analysis, reaction=math.nan)))
    assert verdict_of("reaction within bounds", found) is Verdict.INCONCLUSIVE
    assert verdict_of("reaction against prediction", found) is Verdict.INCONCLUSIVE


def test_a_settlement_that_was_not_delivered_disagrees(arch: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = arch
    run = perfect_run(analysis, settlement=0.5 * TRAVEL)
    assert verdict_of("settlement achieved", check_run(Results(analysis, run))) is Verdict.DISAGREE


def test_a_contact_that_limit_analysis_does_not_know_disagrees_by_name(arch: tuple[Scene, LimitAnalysis]) -> None:
    """Only a model with finite displacements has this check: small displacements keep the given list of contacts."""
    scene, small = arch
    effects = dataclasses.replace(small.assembly.effects, displacement="finite")
    analysis = small.with_effects(effects)
    run = dataclasses.replace(perfect_run(analysis), extra_contacts=np.array([[0, 2]]))
    check = next(c for c in check_run(Results(analysis, run)) if c.name == "contact lists")
    assert check.verdict is Verdict.DISAGREE
    assert scene.blocks.names[0] in check.reason and scene.blocks.names[2] in check.reason
    rattling = dataclasses.replace(perfect_run(analysis, status="no plateau", reaction=np.nan), extra_contacts=np.array([[0, 2]]))
    assert verdict_of("contact lists", check_run(Results(analysis, rattling))) is Verdict.INCONCLUSIVE


def test_a_tall_block_that_is_still_swaying_decides_nothing() -> None:
    """The fixed pad carries the whole weight 0.1 m beside the centroid. This lever arm is small beside the block's height of 100 m."""
    scene = scenes.build(
        scenes.box("fixed pad", (0.0, 0.0, -0.1), (0.4, 0.2, 0.0), "fixed"),
        scenes.box("settling pad", (0.5, 0.0, -0.1), (1.0, 0.2, 0.0), "support"),
        scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.2, 100.0)),
        inset=1e-3,
    )
    analysis = analyse(scene)
    run = perfect_run(analysis, reaction=0.0)
    at_edge = np.isclose(analysis.assembly.points.position[:, 0], 0.4 - scene.inset)
    run.poses.forces[:] = np.where(at_edge[:, None], [0.0, 0.0, scene.weight / at_edge.sum()], 0.0)
    found = check_run(Results(analysis, run))
    assert verdict_of("equilibrium of the YADE state", found) is Verdict.AGREE
    assert verdict_of("balance along the mechanism", found) is Verdict.INCONCLUSIVE
    assert not any(check.name.startswith("reaction") for check in found) and Verdict.DISAGREE not in {check.verdict for check in found}


def test_a_state_out_of_equilibrium_decides_nothing(arch: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = arch
    run = perfect_run(analysis)
    run.poses.forces[:, 0] += 0.5 * analysis.assembly.mean_weight
    assert verdict_of("equilibrium", check_run(Results(analysis, run))) is Verdict.INCONCLUSIVE


def test_another_mechanism_disagrees_where_no_joint_slides(arch: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = arch
    run = perfect_run(analysis)
    run.poses.displacement[:] = 0.0
    run.poses.displacement[:, 3, 0] = np.linspace(0.0, TRAVEL, 5)
    found = check_run(Results(analysis, run))
    assert verdict_of("mechanism similarity", found) is Verdict.DISAGREE
    assert verdict_of("moving blocks", found) is Verdict.DISAGREE


def test_another_mechanism_that_does_the_same_work_agrees_and_is_named() -> None:
    """Three equal voussoirs of a flat arch may hinge at either inner joint; the solver mixes both mechanisms."""
    scene, analysis = case_of("flat_arch")
    least = analysis.bounds[Drive.YIELDING]
    one_hinge = solve_associated(_with_heavier_left(analysis), Drive.YIELDING).twists
    assert mechanism.similarity(scene.blocks, one_hinge, least.twists) < mechanisms.SIMILAR
    run = perfect_run(analysis)
    run.poses.displacement[:] = run.poses.settlement[:, None, None] * one_hinge[None, :, :3]
    run.poses.rotation[:] = run.poses.settlement[:, None, None] * one_hinge[None, :, 3:]
    check = next(c for c in check_run(Results(analysis, run)) if c.name == "mechanism similarity")
    assert check.verdict is Verdict.AGREE and "not unique" in check.reason and not check.next_step


@pytest.mark.parametrize(("share", "verdict"), [(0.04, Verdict.AGREE), (0.06, Verdict.DISAGREE)])
def test_a_twentieth_of_the_mass_may_move_in_one_method_only(share: float, verdict: Verdict) -> None:
    """A light block on fixed ground rises in YADE as fast as a heavy block beside it sinks with its support.

    The similarity of both mechanisms is M^2 / (M (M + m)), the share of the heavy block in the mass.
    """
    light, gap = share / (1.0 - share), 0.5
    boxes = [
        scenes.box("light", (0.0, 0.0, 0.0), (light, 0.5, 0.5)),
        scenes.box("heavy", (gap, 0.0, 0.0), (gap + 1.0, 0.5, 0.5)),
        scenes.box("ground", (0.0, 0.0, -0.2), (light, 0.5, 0.0), "fixed"),
        scenes.box("support", (gap, 0.0, -0.2), (gap + 1.0, 0.5, 0.0), "support"),
    ]
    analysis = analyse(scenes.build(*boxes, inset=0.001, reach=False))
    run = perfect_run(analysis)
    run.poses.displacement[:, 0, 2] = run.poses.settlement
    found = check_run(Results(analysis, run))
    moving = next(check for check in found if check.name == "moving blocks")
    assert moving.verdict is verdict and (moving.difference, moving.tolerance) == pytest.approx((share, 0.05))
    alike = next(check for check in found if check.name == "mechanism similarity")
    assert alike.verdict is verdict
    assert (alike.limit_analysis, alike.yade, alike.difference, alike.tolerance) == pytest.approx((1.0, 1.0 - share, -share, 0.05))
    for check in (moving, alike):  # only a failed check has a reason and a next step
        assert bool(check.reason) is bool(check.next_step) is (verdict is Verdict.DISAGREE)


def test_an_admissible_mechanism_that_does_other_work_disagrees() -> None:
    """The block stands still while the pad settles below it: every joint obeys the flow rule, but the weight does no work."""
    scene, analysis = case_of("two_pads")
    run = perfect_run(analysis)
    run.poses.displacement[:, scene.blocks.free] = run.poses.rotation[:, scene.blocks.free] = 0.0
    assert residuals.flow_rule_violation(analysis.assembly, run.mechanism()) <= mechanisms.ADMISSIBLE
    assert verdict_of("mechanism similarity", check_run(Results(analysis, run))) is Verdict.DISAGREE


def _with_heavier_left(analysis: LimitAnalysis) -> Assembly:
    """Return the assembly with a slightly heavier first free block: this makes one of several mechanisms the only one."""
    load = analysis.assembly.dead_load.copy()
    load[np.flatnonzero(analysis.assembly.blocks.free)[0]] *= 1.001
    return dataclasses.replace(analysis.assembly, dead_load=load)


@pytest.mark.parametrize(
    ("message", "verdict"), [("steady", Verdict.DISAGREE), ("steady; the reaction leaves it before 1 m", Verdict.INCONCLUSIVE)]
)
def test_a_transverse_force_outside_its_range_disagrees_except_where_yade_passes_by(
    arch: tuple[Scene, LimitAnalysis], message: str, verdict: Verdict
) -> None:
    """Frictionless blocks that leave a plateau are in motion on it and push the support aside."""
    scene, analysis = arch
    run = perfect_run(analysis, message=message)
    support = int(np.flatnonzero(scene.blocks.role == 2)[0])
    a, b = analysis.assembly.contact_blocks
    at_support = (a == support) | (b == support)
    run.poses.forces[:, at_support, 2] += 0.1 * scene.weight
    found = check_run(Results(analysis, run))
    assert verdict_of("equilibrium of the YADE state", found) is Verdict.INCONCLUSIVE
    assert verdict_of("support's force along z", found) is verdict


def test_a_bound_that_is_not_solved_leaves_the_range_undecided(arch: tuple[Scene, LimitAnalysis]) -> None:
    """If an inaccurate upper bound counted as no bound, the check would accept every great reaction."""
    _scene, analysis = arch
    for status, verdict in ((Status.INACCURATE, Verdict.INCONCLUSIVE), (Status.UNBOUNDED, Verdict.AGREE)):
        greatest = dataclasses.replace(analysis.bounds[Drive.PUSHING], status=status)
        doubtful = with_answers(analysis, bounds={**analysis.bounds, Drive.PUSHING: greatest})
        assert verdict_of("reaction within bounds", check_run(Results(doubtful, perfect_run(analysis)))) is verdict


def test_an_answer_without_a_limit_asks_for_another_direction(arch: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = arch
    steps = {}
    for status in (Status.UNBOUNDED, Status.INACCURATE):
        least = dataclasses.replace(analysis.bounds[analysis.main], status=status)
        answers = with_answers(
            analysis, bounds={**analysis.bounds, analysis.main: least}, coulomb=without_answer(analysis.assembly, status)
        )
        (check,) = check_run(Results(answers, perfect_run(analysis)))
        assert check.verdict is Verdict.INCONCLUSIVE
        steps[status] = check.next_step
    assert "direction" in steps[Status.UNBOUNDED] and "direction" not in steps[Status.INACCURATE]


def test_an_undefined_uncertainty_decides_nothing(arch: tuple[Scene, LimitAnalysis]) -> None:
    found = check_run(Results(arch[1], perfect_run(arch[1], uncertainty=math.nan)))
    assert verdict_of("reaction within bounds", found) is Verdict.INCONCLUSIVE
    assert verdict_of("reaction against prediction", found) is Verdict.INCONCLUSIVE


def test_shares_of_moving_mass_that_differ_although_the_check_passes_say_why(
    arch: tuple[Scene, LimitAnalysis], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without this reason a reader saw the shares 0.591 and 0.525 with a difference of 0."""
    run = perfect_run(arch[1])
    run.poses.displacement[:] = 0.0
    run.poses.displacement[:, 3, 0] = np.linspace(0.0, TRAVEL, 5)
    monkeypatch.setattr(mechanisms, "_mass_in_one_only", lambda *_: 0.0)  # as if all speeds were close to the threshold of motion
    check = next(check for check in check_run(Results(arch[1], run)) if check.name == "moving blocks")
    assert check.verdict is Verdict.AGREE and check.difference == 0.0
    assert check.reason == mechanisms.NEARLY_AT_REST and "from 5 % of the fastest speed on" in check.reason
    same = next(check for check in check_run(Results(arch[1], perfect_run(arch[1]))) if check.name == "moving blocks")
    assert not same.reason
