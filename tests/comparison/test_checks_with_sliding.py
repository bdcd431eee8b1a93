"""Where joints slide, a run is compared with the prediction. Neither its interval nor a large uncertainty excuses a difference."""

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scenes
from judged_runs import case_of, verdict_of
from locking_scenes import lifted_pad
from runs import coulomb_run, perfect_run, with_answers

from comparison.judge.checks.answer import check_answer
from comparison.judge.checks.mechanisms import SIMILAR
from comparison.judge.checks.prediction import predicted
from comparison.judge.checks.run_checks import check_run
from comparison.judge.checks.sections import check_sections
from comparison.verdict.check import Verdict
from comparison.verdict.conclusion import conclusion
from comparison.yade import Results, accuracy_settings
from comparison.yade.run_parts import Poses
from la_core.analysis.result import AccuracyRecord, LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.coulomb.solution import without_answer
from la_core.limit.associated import Status
from la_core.limit.problem import Drive
from la_core.scene.scene import Scene


def test_where_joints_slide_the_associated_answer_is_called_a_bound_and_not_an_error() -> None:
    scene, analysis = case_of("two_blocks")
    analysis = dataclasses.replace(with_answers(analysis, coulomb=None), sharp=dataclasses.replace(analysis.sharp, coulomb=None))
    run = perfect_run(analysis, reaction=0.5 * scene.weight)  # the reaction for friction without dilatancy
    check = next(c for c in check_run(Results(analysis, run)) if c.name == "reaction against prediction")
    assert check.verdict is Verdict.INCONCLUSIVE and "bound" in check.reason
    assert check.difference == pytest.approx(0.5 * scene.weight - analysis.bounds[Drive.YIELDING].value)
    assert verdict_of("reaction within bounds", check_run(Results(analysis, run))) is Verdict.AGREE


@pytest.mark.parametrize(("friction", "step"), [("coulomb", "finer paths"), ("associated", 'friction = "coulomb"')])
def test_what_to_do_about_a_missing_prediction_depends_on_whether_one_was_requested(friction: str, step: str) -> None:
    scene, analysis = case_of("two_blocks")
    effects = analysis.assembly.effects.with_effect("friction", friction, "made up")
    without = with_answers(analysis.with_effects(effects), coulomb=None)
    assert step in predicted(Results(without, perfect_run(analysis, reaction=0.5 * scene.weight))).next_step


@pytest.fixture(scope="module")
def wall() -> tuple[Scene, LimitAnalysis]:
    """A wall whose joints slide: the history of friction decides its reaction within an interval."""
    return case_of("wall_third")


def test_a_run_that_follows_the_coulomb_prediction_agrees_in_everything(wall: tuple[Scene, LimitAnalysis]) -> None:
    found = check_run(Results(wall[1], coulomb_run(wall[1])))
    assert {check.verdict for check in found} == {Verdict.AGREE}, [check for check in found if check.reason]
    assert {"reaction within the mechanism's interval", "YADE's friction state", "steadiness of the plateau"} <= {c.name for c in found}


@pytest.mark.parametrize(("excluded", "words"), [(False, "in no mechanism of limit analysis"), (True, "the scene excludes sliding")])
def test_where_joints_slide_in_yade_alone_the_reason_says_who_left_sliding_out(
    wall: tuple[Scene, LimitAnalysis], excluded: bool, words: str
) -> None:
    _scene, analysis = wall
    effects = analysis.assembly.effects.with_effect("friction", "none-slides", "made up")
    without = with_answers(analysis.with_effects(dataclasses.replace(effects, sliding_excluded=excluded)), coulomb=None)
    assert words in predicted(Results(without, coulomb_run(analysis))).obstacle


@pytest.mark.parametrize("asked", ["none-slides", "associated"])
def test_where_the_scene_excludes_sliding_and_yades_mechanism_is_unknown_there_is_no_sharp_prediction(asked: str) -> None:
    """Blocks on beds without friction slide back under a tilt in YADE: the multiplier is zero, and no plateau has two states."""
    scene, analysis = case_of("arch_spreading")
    run = perfect_run(analysis, reaction=0.5 * analysis.bounds[Drive.YIELDING].value)
    run = dataclasses.replace(run, poses=Poses(*(part[:1] for part in vars(run.poses).values())))
    assert "Joints may slide in YADE" not in predicted(Results(analysis, run)).obstacle
    effects = scene.effects.model_copy(update={"friction": asked})
    excluded = dataclasses.replace(analysis, scene=dataclasses.replace(scene, effects=effects))
    found = predicted(Results(with_answers(excluded, coulomb=None), run))
    assert found.slides and "Joints may slide in YADE" in found.obstacle and "coulomb" in found.next_step


def test_a_plateau_that_yade_leaves_does_not_contradict_the_prediction(wall: tuple[Scene, LimitAnalysis]) -> None:
    left = "steady from a settlement of 1e-05 to 2e-05 m; the reaction leaves it before a settlement of 3e-05 m"
    names = ("reaction against prediction", "reaction within the mechanism's interval")
    for message, verdict in ((left, Verdict.INCONCLUSIVE), (f"steady; before, at 2 times the speed: {left}", Verdict.DISAGREE)):
        found = check_run(Results(wall[1], coulomb_run(wall[1], reaction=1.3 * wall[1].coulomb.value, message=message)))
        checks = [check for check in found if check.name in names]
        assert [check.verdict for check in checks] == [verdict, verdict]
        assert all(("leaves this plateau" in check.reason) is (message == left) for check in checks)


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
    assert verdict_of("reaction against prediction", found) is prediction
    assert verdict_of("reaction within the mechanism's interval", found) is interval
    assert not any("almost no work" in check.reason for check in found), "friction does work here"


def test_the_interval_of_one_mechanism_does_not_bind_another(wall: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = wall
    assert analysis.coulomb is not None
    run = coulomb_run(analysis, reaction=1.3 * analysis.coulomb.value)
    run.poses.displacement[:] = 0.0
    run.poses.displacement[:, 3, 0] = run.poses.settlement
    found = check_run(Results(analysis, run))
    check = next(check for check in found if check.name == "reaction within the mechanism's interval")
    assert check.verdict is Verdict.INCONCLUSIVE and check.reason.startswith("YADE moves by another mechanism (modal assurance 0.")
    assert verdict_of("mechanism similarity", found) is Verdict.INCONCLUSIVE


def test_a_mechanism_that_yade_does_not_show_is_not_called_another_one(wall: tuple[Scene, LimitAnalysis]) -> None:
    """One stored state on the plateau shows no motion, so there is no similarity to compare."""
    _scene, analysis = wall
    assert analysis.coulomb is not None
    run = coulomb_run(analysis, reaction=1.3 * analysis.coulomb.value)
    few = dataclasses.replace(run, poses=Poses(**{name: values[[0, -1]] for name, values in vars(run.poses).items()}))
    check = next(c for c in check_run(Results(analysis, few)) if c.name == "reaction within the mechanism's interval")
    assert check.verdict is Verdict.INCONCLUSIVE
    assert check.reason.startswith("YADE's mechanism is unknown") and "nan" not in check.reason


def test_stick_slip_is_named_where_the_reaction_scatters(wall: tuple[Scene, LimitAnalysis]) -> None:
    for scatter, named in ((0.001, False), (0.02, True)):
        found = check_run(Results(wall[1], coulomb_run(wall[1], scatter=scatter)))
        check = next(c for c in found if c.name == "steadiness of the plateau")
        assert check.yade == pytest.approx(scatter, rel=0.05)
        assert ("Stick-slip" in check.reason) is named
        assert check.verdict is Verdict.AGREE


def test_a_friction_state_below_its_limit_is_not_the_one_that_slides(wall: tuple[Scene, LimitAnalysis]) -> None:
    """The state of the greatest reaction is in equilibrium and within the friction cones, but its joints do not slide down."""
    _scene, analysis = wall
    assert analysis.coulomb is not None
    for factor, verdict in ((1.05, Verdict.INCONCLUSIVE), (1.0, Verdict.AGREE)):  # only a remark where the reactions agree
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
        ({"plateaus": np.array([1900.0, 2400.0])}, 1.30, "several plateaus (1900 N, 2400 N)"),
        ({"plateaus": np.array([11900.0, 12400.0])}, 1.30, "several plateaus (11900 N, 12400 N)"),
        ({"uncertainty": 200.0}, 1.02, "Limit analysis states an uncertainty of 200 N (9.87 %), too large"),
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


@pytest.mark.parametrize(("interval", "words"), [((math.nan, math.nan), " The mechanism's interval is unknown"), (None, "")])
def test_an_agreement_with_an_inaccurate_prediction_says_so(
    wall: tuple[Scene, LimitAnalysis], interval: tuple[float, float] | None, words: str
) -> None:
    _scene, analysis = wall
    assert analysis.coulomb is not None
    changes = {"status": Status.INACCURATE, "sliding_residual": 2e-3} | ({"interval": interval} if interval else {})
    coulomb = dataclasses.replace(analysis.coulomb, **changes)
    found = check_run(Results(with_answers(analysis, coulomb=coulomb), coulomb_run(analysis)))
    told = conclusion(found, {"status": "plateau"})
    assert told.verdict is Verdict.AGREE
    said = ("ended as inaccurate: its value is ", "the largest residual of its limit state 2.0e-03. YADE confirms this value", words)
    assert any(all(part in remark for part in said) for remark in told.remarks)
    assert any("interval" in check.name for check in found) is not bool(words)
    assert not any("inaccurate" in remark for remark in conclusion(check_run(Results(analysis, coulomb_run(analysis))), {}).remarks)


def test_several_plateaus_that_make_a_prediction_uncertain_are_named(wall: tuple[Scene, LimitAnalysis]) -> None:
    """The distance of the plateaus is the uncertainty. Where finer paths find them again, the user takes the least favourable one."""
    _scene, analysis = wall
    assert analysis.coulomb is not None
    least = 0.9 * analysis.coulomb.value
    several = {"plateaus": np.array([analysis.coulomb.value, least]), "uncertainty": analysis.coulomb.value - least}
    coulomb = dataclasses.replace(analysis.coulomb, **several)
    found = check_run(Results(with_answers(analysis, coulomb=coulomb), coulomb_run(analysis, reaction=least)))
    check = next(c for c in found if c.name == "reaction against prediction")
    assert check.verdict is Verdict.INCONCLUSIVE
    assert check.reason.startswith("Limit analysis states an uncertainty") and "The structure has several plateaus" in check.reason
    first, second = (conclusion([check], {"status": "plateau"}, None, is_finest).next_step for is_finest in (False, True))
    assert "--try-harder" in first and "--try-harder" not in second
    assert "least favourable plateau" in first and "least favourable plateau" in second


def test_a_stated_uncertainty_widens_the_tolerance_by_as_much(wall: tuple[Scene, LimitAnalysis]) -> None:
    _scene, analysis = wall
    assert analysis.coulomb is not None
    tolerances_of = []
    for share in (0.0, 0.02):
        coulomb = dataclasses.replace(analysis.coulomb, uncertainty=share * analysis.coulomb.value)
        found = check_run(Results(with_answers(analysis, coulomb=coulomb), coulomb_run(analysis)))
        tolerances_of.append(next(c.tolerance for c in found if c.name == "reaction against prediction"))
    assert tolerances_of[1] - tolerances_of[0] == pytest.approx(0.02 * analysis.coulomb.value, rel=1e-6)


def test_a_prediction_without_a_bound_is_compared_like_any_other() -> None:
    """A pad lifts a block out of a slot, in which dilatant joints lock. YADE's reaction has only an upper bound, the greatest reaction."""
    lift = (0.3, 0.0, 1.0)  # also presses the block against a side of the slot
    analysis = analyse(scenes.build(*lifted_pad(), friction=0.4, inset=0.001, settlement=lift, model="auto"))
    assert analysis.is_without_bound and analysis.coulomb is not None
    found = check_run(Results(analysis, coulomb_run(analysis)))
    assert {check.verdict for check in found} == {Verdict.AGREE}
    assert {"reaction within bounds", "reaction against prediction", "balance along the mechanism", "plane answer in space"} <= {
        check.name for check in found
    }
    other = coulomb_run(analysis, reaction=1.02 * analysis.coulomb.value)
    assert verdict_of("reaction against prediction", check_run(Results(analysis, other))) is Verdict.DISAGREE
    pulled = coulomb_run(analysis, reaction=-analysis.coulomb.value)
    assert verdict_of("reaction within bounds", check_run(Results(analysis, pulled))) is Verdict.DISAGREE
    (fallen,) = (one for one in check_run(Results(analysis, coulomb_run(analysis, status="collapsed"))) if one.reason)
    assert "finds an equilibrium, but it collapsed in YADE" in fallen.reason and "unbounded" not in fallen.reason


def test_a_block_lifted_straight_out_of_a_slot_has_no_sharp_prediction_for_want_of_a_bound() -> None:
    """No joint dissipates energy, so only the missing bound shows that the value for sharp edges is not the associated one."""
    analysis = analyse(scenes.build(*lifted_pad(), friction=0.4, inset=0.001, settlement=(0.0, 0.0, 1.0), model="auto"))
    assert analysis.is_without_bound and analysis.sharp.coulomb is None
    started = accuracy_settings.initial_settings(dataclasses.replace(analysis, accuracy=AccuracyRecord(0.01)))
    assert started.accuracy is not None and started.accuracy.settings  # YADE still runs at the requested accuracy


def test_without_a_bound_the_mechanism_is_not_determined_although_nothing_slides() -> None:
    """In YADE the block also drifts into a wall of the slot. Without a bound, the work of this mechanism cannot be compared."""
    analysis = analyse(scenes.build(*lifted_pad(), friction=0.4, inset=0.001, settlement=(0.0, 0.0, 1.0), model="auto"))
    run = coulomb_run(analysis)
    run.poses.displacement[:, analysis.assembly.blocks.free, 0] += run.poses.settlement[:, None]
    check = next(check for check in check_run(Results(analysis, run)) if check.name == "mechanism similarity")
    assert check.yade is not None and check.yade < SIMILAR
    assert check.verdict is Verdict.AGREE and "need not be unique" in check.reason  # a remark, because the reactions agree


def test_cuts_of_a_pushed_structure_are_compared_at_one_multiplier() -> None:
    """Two columns are pushed and lifted. The associated multiplier is 0.56; without dilatancy it is 0.35, as in YADE."""
    columns = scenes.box("left", (0.0, 0.0, 0.0), (1.0, 1.0, 3.0)), scenes.box("right", (1.0, 0.0, 0.0), (2.0, 1.0, 2.5))
    ground, load = scenes.box("ground", (-1.0, 0.0, -0.2), (4.0, 1.0, 0.0), "fixed"), (1.0, 0.0, 0.5)
    scene = scenes.build(ground, *columns, friction=0.9, inset=0.001, settlement=None, live=load, model="coulomb")
    analysis = analyse(scene)
    assert analysis.coulomb is not None
    assert analysis.coulomb.value < 0.8 * analysis.bounds[analysis.main].value
    for forces, verdict in ((analysis.coulomb.forces, Verdict.AGREE), (1.1 * analysis.coulomb.forces, Verdict.DISAGREE)):
        found = check_sections(SimpleNamespace(scene=scene, analysis=analysis, recorded=SimpleNamespace(plateau_forces=lambda f=forces: f)))
        assert [check.verdict for check in found] == [verdict]


@pytest.mark.parametrize(("live", "advice"), [(None, "[yade] wedging"), ((1.0, 0.0, 0.0), "slides out and falls")])
def test_a_thrust_is_advised_only_where_a_support_can_give_it(live: tuple[float, float, float] | None, advice: str) -> None:
    base = scenes.box("base", (0.0, 0.0, -0.1), (1.0, 1.0, 0.0), "support" if live is None else "fixed")
    scene = scenes.build(base, scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), settlement=None if live else scenes.DOWN, live=live)
    analysis = analyse(scene)
    fallen = without_answer(analysis.assembly, Status.FAILED)
    (check,) = check_answer(with_answers(analysis, coulomb=dataclasses.replace(fallen, uncertainty=np.inf)))
    assert "slide and fall" in check.reason and advice in check.next_step
    assert live is None or "work with the bound, if there is one" in check.next_step  # blocks that lock by dilation have no bound
