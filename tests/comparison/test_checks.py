"""The judge, judged: made-up YADE runs that are right, wrong in one respect, or undecided."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
import scenes
from runs import TRAVEL, coulomb_run, perfect_run, with_answers

from comparison.judge import mechanisms, run_checks, sections, tolerances
from comparison.judge import prediction as check_prediction
from comparison.judge.run_checks import check_expected, check_run
from comparison.verdict.check import Check, Verdict, overall
from comparison.workflow import one_scene
from comparison.yade import Results
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.measures import mechanism
from la_core.model.assembly import Assembly
from la_core.scene.scene import Scene, load_scene
from la_core.scene.shipped import find


def _case(name: str) -> tuple[Scene, LimitAnalysis]:
    scene = load_scene(find(name))
    return scene, analyse(scene)


def _verdict(name: str, found: list[Check]) -> Verdict:
    return next(check.verdict for check in found if check.name.startswith(name))


def test_alone_a_prediction_that_is_none_leaves_no_verdict_and_says_why() -> None:
    _scene, analysis = _case("two_pads")
    assert analysis.coulomb is not None and not one_scene._judge(one_scene.SceneOutcome(Results(analysis), None, [], ""))
    unsure = dataclasses.replace(analysis.coulomb, status=Status.INACCURATE, uncertainty=120.0, strain_residual=0.0, sliding_residual=2e-4)
    failed = dataclasses.replace(analysis.coulomb, status=Status.FAILED, value=math.nan)
    for coulomb, reason in (
        (unsure, "ended as inaccurate: its value is 363.30 ± 120 N, and the largest residual of its limit state 2.0e-04."),
        (failed, "ended as failed, so it has no value."),
    ):
        (check,) = one_scene._judge(one_scene.SceneOutcome(Results(with_answers(analysis, coulomb=coulomb)), None, [], ""))
        assert check.verdict is Verdict.INCONCLUSIVE and check.reason == f"Coulomb limit analysis {reason}"


@pytest.fixture(scope="module")
def arch() -> tuple[Scene, LimitAnalysis]:
    return _case("arch_spreading")


def test_a_run_that_follows_limit_analysis_agrees_in_everything(arch: tuple[Scene, LimitAnalysis]) -> None:
    found = check_run(Results(arch[1], perfect_run(arch[1])))
    assert {check.verdict for check in found} == {Verdict.AGREE}
    assert {check.name.split(" along")[0] for check in found} == {
        "settlement achieved", "displacements within the least gap", "equilibrium of the YADE state", "plane answer in space",
        "balance", "reaction within bounds", "reaction against prediction", "mechanism similarity", "moving blocks",
        "force sums over sections", "support's force",
    }  # fmt: skip


@pytest.mark.parametrize(("factor", "verdict"), [(1.004, Verdict.AGREE), (0.996, Verdict.AGREE), (1.006, Verdict.DISAGREE)])
def test_the_reaction_is_judged_to_half_a_per_cent(arch: tuple[Scene, LimitAnalysis], factor: float, verdict: Verdict) -> None:
    _scene, analysis = arch
    run = perfect_run(analysis, reaction=factor * analysis.bounds[Drive.YIELDING].value)
    assert _verdict("reaction against prediction", check_run(Results(analysis, run))) is verdict


def test_a_reaction_below_the_lower_bound_disagrees(arch: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = arch
    run = perfect_run(analysis, reaction=0.9 * analysis.bounds[Drive.YIELDING].value)
    assert _verdict("reaction within bounds", check_run(Results(analysis, run))) is Verdict.DISAGREE


def test_a_run_that_does_not_know_its_reaction_decides_nothing(arch: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = arch
    value = analysis.bounds[Drive.YIELDING].value
    run = perfect_run(analysis, reaction=1.02 * value, uncertainty=0.2 * value)
    assert _verdict("reaction against prediction", check_run(Results(analysis, run))) is Verdict.INCONCLUSIVE


def test_an_undefined_reaction_never_agrees(arch: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = arch
    found = check_run(Results(analysis, perfect_run(analysis, reaction=math.nan)))
    assert _verdict("reaction within bounds", found) is Verdict.INCONCLUSIVE
    assert _verdict("reaction against prediction", found) is Verdict.INCONCLUSIVE


def test_a_settlement_that_was_not_delivered_disagrees(arch: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = arch
    run = perfect_run(analysis, settlement=0.5 * TRAVEL)
    assert _verdict("settlement achieved", check_run(Results(analysis, run))) is Verdict.DISAGREE


def test_a_contact_that_limit_analysis_does_not_know_disagrees_by_name(arch: tuple[Scene, LimitAnalysis]) -> None:
    """A matter of finite displacements: small ones keep to the list."""
    scene, small = arch
    effects = dataclasses.replace(small.assembly.effects, displacement="finite")
    analysis = small.with_effects(effects)
    run = dataclasses.replace(perfect_run(analysis), extra_contacts=np.array([[0, 2]]))
    check = next(c for c in check_run(Results(analysis, run)) if c.name == "contact lists")
    assert check.verdict is Verdict.DISAGREE
    assert scene.blocks.names[0] in check.reason and scene.blocks.names[2] in check.reason


def test_a_tall_block_that_is_still_swaying_decides_nothing() -> None:
    """Its whole weight on the fixed pad is out of balance by a tenth of a metre, which is little against its own 100 m."""
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
    assert _verdict("equilibrium of the YADE state", found) is Verdict.AGREE
    assert _verdict("balance along the mechanism", found) is Verdict.INCONCLUSIVE
    assert not any(check.name.startswith("reaction") for check in found) and Verdict.DISAGREE not in {check.verdict for check in found}


def test_a_state_out_of_equilibrium_decides_nothing(arch: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = arch
    run = perfect_run(analysis)
    run.poses.forces[:, 0] += 0.5 * analysis.assembly.mean_weight
    assert _verdict("equilibrium", check_run(Results(analysis, run))) is Verdict.INCONCLUSIVE


def test_another_mechanism_disagrees_where_no_joint_slides(arch: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = arch
    run = perfect_run(analysis)
    run.poses.displacement[:] = 0.0
    run.poses.displacement[:, 3, 0] = np.linspace(0.0, TRAVEL, 5)
    found = check_run(Results(analysis, run))
    assert _verdict("mechanism similarity", found) is Verdict.DISAGREE
    assert _verdict("moving blocks", found) is Verdict.DISAGREE


def test_another_mechanism_that_does_the_same_work_agrees_and_is_named() -> None:
    """Three equal voussoirs of a flat arch may hinge at either inner joint; the solver mixes both mechanisms."""
    scene, analysis = _case("flat_arch")
    least = analysis.bounds[Drive.YIELDING]
    one_hinge = solve_associated(_with_heavier_left(analysis), Drive.YIELDING).twists
    assert mechanism.similarity(scene.blocks, one_hinge, least.twists) < mechanisms.SIMILAR
    run = perfect_run(analysis)
    run.poses.displacement[:] = run.poses.settlement[:, None, None] * one_hinge[None, :, :3]
    run.poses.rotation[:] = run.poses.settlement[:, None, None] * one_hinge[None, :, 3:]
    check = next(c for c in check_run(Results(analysis, run)) if c.name == "mechanism similarity")
    assert check.verdict is Verdict.AGREE and "not unique" in check.reason


def _with_heavier_left(analysis: LimitAnalysis) -> Assembly:
    """The assembly with its first free block a little heavier, which singles out one of several mechanisms."""
    load = analysis.assembly.dead_load.copy()
    load[np.flatnonzero(analysis.assembly.blocks.free)[0]] *= 1.001
    return dataclasses.replace(analysis.assembly, dead_load=load)


def test_a_transverse_force_outside_its_range_disagrees(arch: tuple[Scene, LimitAnalysis]) -> None:
    scene, analysis = arch
    run = perfect_run(analysis)
    support = int(np.flatnonzero(scene.blocks.role == 2)[0])
    a, b = analysis.assembly.contact_blocks
    at_support = (a == support) | (b == support)
    run.poses.forces[:, at_support, 2] += 0.1 * scene.weight
    assert _verdict("support's force along z", check_run(Results(analysis, run))) is Verdict.DISAGREE


def test_where_joints_slide_the_associated_answer_is_called_a_bound_and_not_an_error() -> None:
    scene, analysis = _case("two_blocks")
    analysis = dataclasses.replace(with_answers(analysis, coulomb=None), sharp=dataclasses.replace(analysis.sharp, coulomb=None))
    run = perfect_run(analysis, reaction=0.5 * scene.weight)  # what friction without dilatancy gives
    check = next(c for c in check_run(Results(analysis, run)) if c.name == "reaction against prediction")
    assert check.verdict is Verdict.INCONCLUSIVE and "bound" in check.reason
    assert _verdict("reaction within bounds", check_run(Results(analysis, run))) is Verdict.AGREE


def test_a_run_without_a_plateau_is_inconclusive(arch: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = arch
    assert overall(check_run(Results(analysis, perfect_run(analysis, status="no plateau"))))[0] is Verdict.INCONCLUSIVE
    for status in ("timeout", "failed"):
        assert overall(check_run(Results(analysis, perfect_run(analysis, status=status))))[0] is Verdict.INCONCLUSIVE


def test_a_fall_that_limit_analysis_does_not_prove_is_inconclusive_with_friction(arch: tuple[Scene, LimitAnalysis]) -> None:
    verdict, reason = overall(check_run(Results(arch[1], perfect_run(arch[1], status="collapsed"))))
    assert verdict is Verdict.INCONCLUSIVE and "thrust" in reason


@pytest.mark.parametrize(("status", "verdict"), [("collapsed", Verdict.AGREE), ("plateau", Verdict.DISAGREE)])
def test_a_proof_that_the_structure_falls_binds_yade(status: str, verdict: Verdict, tmp_path) -> None:
    text = find("two_pads").read_text().replace('role = "fixed"', 'role = "support"').replace("source", "# source", 1)
    text = text.replace("from = [0.5, 0.0, -0.1]", "from = [0.3, 0.0, -0.1]").replace("to = [1.0, 0.2, 0.0]", "to = [0.4, 0.2, 0.0]")
    path = tmp_path / "overhang.toml"
    path.write_text(text.replace("to = [0.4, 0.2, 0.0] }", "to = [0.3, 0.2, 0.0] }", 1).split("[expected]")[0])
    scene = load_scene(path)
    analysis = analyse(scene)
    run = perfect_run(analysis, status=status)
    found, reason = overall(check_run(Results(analysis, run)))
    assert found is verdict
    assert verdict is Verdict.AGREE or '"block"' in reason or "block would fall" in reason


def test_the_scene_s_own_expectation_is_checked_for_sharp_arrises() -> None:
    scene, analysis = _case("two_pads")
    assert {check.verdict for check in check_expected(analysis)} == {Verdict.EXPECTED_MET}
    assert scene.expected is not None
    wrong = dataclasses.replace(scene, expected=scene.expected.model_copy(update={"reaction_over_weight": 0.17}))
    assert Verdict.DISAGREE in {check.verdict for check in check_expected(dataclasses.replace(analysis, scene=wrong))}


def test_the_gravest_check_decides_and_gives_the_reason() -> None:
    good, open_, bad = (Check("c", verdict, reason=verdict.value) for verdict in (Verdict.AGREE, Verdict.INCONCLUSIVE, Verdict.DISAGREE))
    assert overall([good, open_, bad]) == (Verdict.DISAGREE, "disagree")
    assert overall([good, open_]) == (Verdict.INCONCLUSIVE, "inconclusive")
    assert overall([]) == (None, "")


def test_every_tolerance_of_the_judge_is_positive_and_small() -> None:
    rooms = {
        tolerances: ("FLOOR", "UNCERTAIN", "LEAST_REACTION", "UNBALANCED"),
        run_checks: ("SETTLEMENT",),
        check_prediction: ("STEADY", "CONSISTENT"),
        mechanisms: ("SAME_MASS", "ADMISSIBLE"),
        sections: ("SECTION", "ALONG"),
    }
    for module, names in rooms.items():
        assert all(0.0 < getattr(module, name) <= 0.05 for name in names)


@pytest.fixture(scope="module")
def wall() -> tuple[Scene, LimitAnalysis]:
    """A wall whose joints slide, in which friction's history decides within an interval."""
    return _case("wall_third")


def test_a_run_that_follows_the_coulomb_prediction_agrees_in_everything(wall: tuple[Scene, LimitAnalysis]) -> None:
    found = check_run(Results(wall[1], coulomb_run(wall[1])))
    assert {check.verdict for check in found} == {Verdict.AGREE}, [check for check in found if check.reason]
    assert {"reaction within the mechanism's interval", "YADE's friction state", "steadiness of the plateau"} <= {c.name for c in found}


@pytest.mark.parametrize(
    ("factor", "prediction", "interval"),
    [
        (1.004, Verdict.AGREE, Verdict.AGREE),
        (0.996, Verdict.AGREE, Verdict.AGREE),
        (1.10, Verdict.DISAGREE, Verdict.AGREE),
        (0.93, Verdict.DISAGREE, Verdict.AGREE),
        (1.30, Verdict.DISAGREE, Verdict.DISAGREE),
    ],
)
def test_within_its_interval_and_outside_nothing_excuses_a_difference(
    wall: tuple[Scene, LimitAnalysis], factor: float, prediction: Verdict, interval: Verdict
) -> None:
    _scene, analysis = wall
    assert analysis.coulomb is not None
    found = check_run(Results(analysis, coulomb_run(analysis, reaction=factor * analysis.coulomb.value)))
    assert _verdict("reaction against prediction", found) is prediction
    assert _verdict("reaction within the mechanism's interval", found) is interval


def test_the_interval_of_one_mechanism_does_not_bind_another(wall: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = wall
    assert analysis.coulomb is not None
    run = coulomb_run(analysis, reaction=1.3 * analysis.coulomb.value)
    run.poses.displacement[:] = 0.0
    run.poses.displacement[:, 3, 0] = run.poses.settlement
    found = check_run(Results(analysis, run))
    assert _verdict("reaction within the mechanism's interval", found) is Verdict.INCONCLUSIVE
    assert _verdict("mechanism similarity", found) is Verdict.INCONCLUSIVE


def test_stick_slip_is_named_where_the_reaction_scatters(wall: tuple[Scene, LimitAnalysis]) -> None:
    for scatter, named in ((0.001, False), (0.02, True)):
        found = check_run(Results(wall[1], coulomb_run(wall[1], scatter=scatter)))
        check = next(c for c in found if c.name == "steadiness of the plateau")
        assert check.yade == pytest.approx(scatter, rel=0.05)
        assert ("Stick-slip" in check.reason) is named
        assert check.verdict is Verdict.AGREE


def test_a_friction_state_below_its_limit_is_not_the_one_that_slides(wall: tuple[Scene, LimitAnalysis]) -> None:
    """The state that carries the most by friction is in equilibrium and within its cones, but its joints do not slide down."""
    _scene, analysis = wall
    assert analysis.coulomb is not None
    for factor, verdict in ((1.05, Verdict.INCONCLUSIVE), (1.0, Verdict.AGREE)):  # a remark where the reactions agree
        run = coulomb_run(analysis, reaction=factor * analysis.coulomb.value)
        run.poses.forces[:] = analysis.bounds[Drive.PUSHING].forces
        check = next(c for c in check_run(Results(analysis, run)) if c.name == "YADE's friction state")
        assert check.verdict is verdict and "not every joint slides that should" in check.reason


@pytest.mark.parametrize(
    ("changes", "factor", "reason"),
    [
        ({"status": Status.INACCURATE, "sliding_residual": 2e-3}, 1.005, ""),
        ({"status": Status.INACCURATE, "sliding_residual": 2e-3}, 1.05, "no limit state (largest residual 2.0e-03)"),
        ({"status": Status.INACCURATE, "sliding_residual": 2e-3}, 1.30, "no limit state (largest residual 2.0e-03)"),
        ({"plateaus": np.array([1900.0, 2400.0])}, 1.005, ""),
        ({"plateaus": np.array([1900.0, 2400.0])}, 1.30, "several plateaus (1900, 2400)"),
        ({"uncertainty": 200.0}, 1.02, "Limit analysis states an uncertainty of 200 N (9.9%), too large"),
    ],
)
def test_a_prediction_in_doubt_may_confirm_but_not_contradict_and_a_broad_one_does_neither(
    wall: tuple[Scene, LimitAnalysis], changes: dict[str, Any], factor: float, reason: str
) -> None:
    _scene, analysis = wall
    assert analysis.coulomb is not None
    coulomb = dataclasses.replace(analysis.coulomb, **changes)
    found = check_run(Results(with_answers(analysis, coulomb=coulomb), coulomb_run(analysis, reaction=factor * coulomb.value)))
    check = next(c for c in found if c.name == "reaction against prediction")
    assert check.verdict is (Verdict.INCONCLUSIVE if reason else Verdict.AGREE) and reason in check.reason
    assert Verdict.DISAGREE not in {c.verdict for c in found}


def test_a_stated_uncertainty_widens_the_tolerance_by_as_much(wall: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = wall
    assert analysis.coulomb is not None
    tolerances_of = []
    for share in (0.0, 0.02):
        coulomb = dataclasses.replace(analysis.coulomb, uncertainty=share * analysis.coulomb.value)
        found = check_run(Results(with_answers(analysis, coulomb=coulomb), coulomb_run(analysis)))
        tolerances_of.append(next(c.tolerance for c in found if c.name == "reaction against prediction"))
    assert tolerances_of[1] - tolerances_of[0] == pytest.approx(0.02 * analysis.coulomb.value, rel=1e-6)


def test_a_machine_that_was_too_slow_contradicts_no_proof(tmp_path) -> None:
    """Limit analysis proves the fall, YADE ran out of time: nobody disagrees."""
    text = find("two_pads").read_text().split("[expected]")[0].replace("to = [1.0, 0.2, 0.0]", "to = [0.45, 0.2, 0.0]")
    path = tmp_path / "overhang.toml"
    path.write_text(text.replace("from = [0.5, 0.0, -0.1]", "from = [0.4, 0.0, -0.1]"))
    scene = load_scene(path)
    analysis = analyse(scene)
    for status in ("timeout", "failed"):
        assert overall(check_run(Results(analysis, perfect_run(analysis, status=status))))[0] is Verdict.INCONCLUSIVE


def test_an_expected_value_is_never_met_by_an_answer_that_is_not_solved() -> None:
    _scene, analysis = _case("two_pads")
    doubtful = {drive: dataclasses.replace(s, status=Status.INACCURATE) for drive, s in analysis.sharp.bounds.items()}
    assert analysis.sharp.coulomb is not None
    coulomb = dataclasses.replace(analysis.sharp.coulomb, status=Status.INACCURATE)
    sharp = dataclasses.replace(analysis.sharp, bounds=doubtful, coulomb=coulomb)
    verdicts = {check.verdict for check in check_expected(dataclasses.replace(analysis, sharp=sharp))}
    assert verdicts == {Verdict.INCONCLUSIVE}


def test_a_bound_that_is_not_solved_leaves_the_range_undecided(arch: tuple[Scene, LimitAnalysis]) -> None:
    """Taking an inaccurate upper bound for none would let any great reaction pass."""
    _scene, analysis = arch
    for status, verdict in ((Status.INACCURATE, Verdict.INCONCLUSIVE), (Status.UNBOUNDED, Verdict.AGREE)):
        greatest = dataclasses.replace(analysis.bounds[Drive.PUSHING], status=status)
        doubtful = with_answers(analysis, bounds={**analysis.bounds, Drive.PUSHING: greatest})
        assert _verdict("reaction within bounds", check_run(Results(doubtful, perfect_run(analysis)))) is verdict


def test_an_undefined_uncertainty_decides_nothing(arch: tuple[Scene, LimitAnalysis]) -> None:
    found = check_run(Results(arch[1], perfect_run(arch[1], uncertainty=math.nan)))
    assert _verdict("reaction within bounds", found) is Verdict.INCONCLUSIVE
    assert _verdict("reaction against prediction", found) is Verdict.INCONCLUSIVE
