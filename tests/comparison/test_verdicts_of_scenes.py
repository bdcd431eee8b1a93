"""The verdict of a scene: the most severe check decides, a fall needs a proof, and an expected value needs a solved answer."""

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import pytest
import scenes
from judged_runs import case_of
from runs import perfect_run, with_answers

import la_core
from comparison.judge.checks import next_steps, tolerances
from comparison.judge.checks.answer import check_answer, check_expected
from comparison.judge.checks.run_checks import check_run
from comparison.verdict.check import Check, Verdict, overall
from comparison.workflow import one_scene
from comparison.workflow.harder import finer_settings
from comparison.yade import Results
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.limit.associated import Status
from la_core.scene.scene import Scene, load_scene
from la_core.scene.shipped import find


def test_alone_a_prediction_that_is_none_leaves_no_verdict_and_says_why() -> None:
    _scene, analysis = case_of("two_pads")
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
    return case_of("arch_spreading")


def test_a_run_without_a_plateau_is_inconclusive(arch: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = arch
    assert overall(check_run(Results(analysis, perfect_run(analysis, status="no plateau"))))[0] is Verdict.INCONCLUSIVE
    for status in ("timeout", "failed"):
        assert overall(check_run(Results(analysis, perfect_run(analysis, status=status))))[0] is Verdict.INCONCLUSIVE


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "Let YADE go"),
        ({"yade.speed": 1.0}, "The scene's [yade] table sets speed: leave it out first"),
        ({"yade.speed": 1.0, "yade.fall_speed": 1.0}, "sets speed, fall_speed: leave them out first"),
        ({"yade.threads": 2, "yade.wedging": 1e-6}, "Let YADE go"),
        ({"yade.speed": 1.0, "yade.stiffening": 16.0, "effort": "high"}, "sets speed: leave it out first"),
        ({"yade.travel_periods": 10.0, "effort": "high"}, "sets travel_periods: leave it out first"),
    ],
)
def test_settings_of_the_scene_are_left_out_first_where_yade_did_not_settle(changes: dict[str, Any], words: str) -> None:
    analysis = analyse(la_core.variant("two_pads", changes))
    (check,) = (one for one in check_run(Results(analysis, perfect_run(analysis, status="no plateau"))) if one.name == "plateau")
    assert words in check.next_step and next_steps.LONGER in check.next_step


def test_settings_of_a_second_attempt_are_not_for_the_user_to_leave_out() -> None:
    scene = la_core.load("two_pads")
    analysis = analyse(la_core.variant(scene, finer_settings(scene, {"stiffening": 4.0})))
    (check,) = (one for one in check_run(Results(analysis, perfect_run(analysis, status="no plateau"))) if one.name == "plateau")
    assert check.next_step == next_steps.LONGER


def test_a_fall_that_limit_analysis_does_not_prove_is_inconclusive_with_friction(arch: tuple[Scene, LimitAnalysis]) -> None:
    verdict, reason = overall(check_run(Results(arch[1], perfect_run(arch[1], status="collapsed", settlement=0.0))))
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


def test_the_scene_s_own_expectation_is_checked_for_sharp_edges() -> None:
    scene, analysis = case_of("two_pads")
    assert {check.verdict for check in check_expected(analysis)} == {Verdict.EXPECTED_MET}
    assert scene.expected is not None
    wrong = dataclasses.replace(scene, expected=scene.expected.model_copy(update={"reaction_over_weight": 0.17}))
    assert Verdict.UNEXPECTED in {check.verdict for check in check_expected(dataclasses.replace(analysis, scene=wrong))}


def test_the_most_severe_check_decides_and_gives_the_reason() -> None:
    good, open_, bad = (Check("c", verdict, reason=verdict.value) for verdict in (Verdict.AGREE, Verdict.INCONCLUSIVE, Verdict.DISAGREE))
    assert overall([good, open_, bad]) == (Verdict.DISAGREE, "disagree")
    assert overall([good, open_]) == (Verdict.INCONCLUSIVE, "inconclusive")
    assert overall([]) == (None, "")


def test_what_several_checks_say_is_said_once() -> None:
    reasons = ("They differ by 5.5%. It has two plateaus.", "It has two plateaus. YADE lies outside.", "They differ by 5.5%.")
    checks = [Check("c", Verdict.INCONCLUSIVE, reason=reason) for reason in reasons]
    assert overall(checks) == (Verdict.INCONCLUSIVE, "They differ by 5.5%. It has two plateaus. YADE lies outside.")


@pytest.mark.parametrize(("reaction", "accepted"), [(math.nan, 0.02), (-249.0, 0.02), (1000.0, 0.08)])
def test_what_is_quasi_static_is_small_beside_a_block_or_beside_the_reaction(reaction: float, accepted: float) -> None:
    """For blocks of 10 N, a reaction of 1 kN allows a larger unbalanced force."""
    assembly = SimpleNamespace(has_live_load=False, support_speed=1.0, mean_weight=10.0)
    recorded = SimpleNamespace(result=SimpleNamespace(reaction=reaction))
    results: Any = SimpleNamespace(analysis=SimpleNamespace(assembly=assembly), recorded=recorded)
    assert tolerances.unbalanced(results) == pytest.approx(accepted)
    assembly.has_live_load = True  # the reaction is then a multiplier
    assert tolerances.unbalanced(results) == tolerances.UNBALANCED


def test_a_machine_that_was_too_slow_contradicts_no_proof(tmp_path) -> None:
    """Limit analysis proves the fall, and YADE ran out of time or failed: this is no disagreement."""
    text = find("two_pads").read_text().split("[expected]")[0].replace("to = [1.0, 0.2, 0.0]", "to = [0.45, 0.2, 0.0]")
    path = tmp_path / "overhang.toml"
    path.write_text(text.replace("from = [0.5, 0.0, -0.1]", "from = [0.4, 0.0, -0.1]"))
    scene = load_scene(path)
    analysis = analyse(scene)
    for status in ("timeout", "failed"):
        assert overall(check_run(Results(analysis, perfect_run(analysis, status=status))))[0] is Verdict.INCONCLUSIVE


def test_an_expected_value_is_never_met_by_an_answer_that_is_not_solved() -> None:
    _scene, analysis = case_of("two_pads")
    doubtful = {drive: dataclasses.replace(s, status=Status.INACCURATE) for drive, s in analysis.sharp.bounds.items()}
    assert analysis.sharp.coulomb is not None
    coulomb = dataclasses.replace(analysis.sharp.coulomb, status=Status.INACCURATE)
    sharp = dataclasses.replace(analysis.sharp, bounds=doubtful, coulomb=coulomb)
    verdicts = {check.verdict for check in check_expected(dataclasses.replace(analysis, sharp=sharp))}
    assert verdicts == {Verdict.INCONCLUSIVE}


def test_an_expected_value_without_an_answer_asks_for_what_the_answer_lacks() -> None:
    """A flat arch without a thrust slides down on elastic joints. Its friction law is right, so the next step asks for a thrust."""
    scene = scenes.load(find("flat_arch").read_text().replace("wedging = 2e-5", ""))
    analysis = analyse(scene)
    (check,) = check_expected(analysis)
    assert check.verdict is Verdict.INCONCLUSIVE and check.next_step == next_steps.GIVE_THRUST
    reasons = " ".join(one.reason for one in (check, *check_answer(analysis)))
    assert reasons.count("the blocks slide and fall") == 1
    fell = dataclasses.replace(analysis, sharp=dataclasses.replace(analysis.sharp, coulomb=dataclasses.replace(analysis.coulomb)))
    assert " 0.555556. The blocks slide and fall" in next(check_expected(fell)).reason
