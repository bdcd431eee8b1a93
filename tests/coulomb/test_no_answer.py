"""A prediction states no value where there is no answer, and says so where its answer is uncertain."""

import math
from dataclasses import replace

import numpy as np
import pytest
import scenes
from coulomb_problems import FOUND, PLATEAU, UNSLIDING, answer, great_wall, problem, small_wall
from locking_scenes import lifted_pad, slot

from la_core.analysis.modelling import wedging
from la_core.coulomb import CoulombSolution, PredictionSettings, predict, prediction
from la_core.coulomb.followed_path import SHARPENED
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.scene import Scene, variant


def has_no_numbers(solution: CoulombSolution) -> bool:
    """Whether every number of a prediction is undefined."""
    scalars = [solution.value, *solution.interval, solution.at_rest, solution.drift, solution.dilatancy_residual, solution.uncertainty]
    return bool(np.isnan(scalars).all() and np.isnan(solution.forces).all() and np.isnan(solution.twists).all())


def test_what_cannot_stand_is_not_followed() -> None:
    assembly, stiffness = problem(scenes.build(scenes.arch(15, 0.05)))
    solution = predict(assembly, stiffness, solve_associated(assembly, Drive.YIELDING))
    assert (solution.status, solution.iterations) == (Status.INFEASIBLE, 0) and has_no_numbers(solution)


# --- blocks that lock where they dilate -----------------------------------------------------------------------------------------


def in_a_slot(direction: tuple[float, ...], height: float = 0.5, friction: float = 0.4) -> Scene:
    return scenes.build(*slot(height), friction=friction, inset=0.001, live=direction, model="coulomb")


def locked(scene: Scene) -> CoulombSolution:
    """Prediction for a structure without a bound, because its blocks lock as they dilate."""
    assembly, stiffness = problem(scene)
    bound = solve_associated(assembly, Drive.LIVE if assembly.has_live_load else Drive.YIELDING)
    assert bound.status is Status.UNBOUNDED
    return predict(assembly, stiffness, bound)


@pytest.mark.parametrize("friction", [0.3, 0.45])
def test_a_block_that_is_pulled_aslant_out_of_a_slot_slides_up_one_wall(friction: float) -> None:
    """The block presses the wall with N = lambda W / sqrt 2 and slides up: lambda W / sqrt 2 = W + mu N. A dilating block would lock."""
    solution = locked(in_a_slot((1.0, 0.0, 1.0), friction=friction))
    assert solution.status is Status.SOLVED
    assert solution.value == pytest.approx(2.0**0.5 / (1.0 - friction), rel=PLATEAU)
    assert abs(solution.value - 2.0**0.5 / (1.0 - friction)) <= solution.uncertainty
    assert solution.interval[0] == pytest.approx(solution.value, rel=PLATEAU) and solution.interval[1] == math.inf


def test_a_block_that_is_pushed_along_a_channel_slides_on_its_bed_and_one_wall() -> None:
    """In space: mu (W + lambda sin a W) = lambda cos a W for a push at the angle a to the channel. A dilating block would lock."""
    scene = scenes.build(*slot(depth=1.0), friction=0.5, inset=0.001, live=(0.5, 1.0, 0.0), plane=False, model="coulomb")
    solution = locked(scene)
    assert solution.value == pytest.approx(0.5 / (1.0 - 0.25) * 1.25**0.5, rel=PLATEAU)
    assert abs(solution.value - 0.5 / (1.0 - 0.25) * 1.25**0.5) <= solution.uncertainty


def test_a_block_that_is_lifted_out_of_a_slot_by_its_pad_weighs_on_it() -> None:
    scene = scenes.build(*lifted_pad(), friction=0.5, inset=0.001, settlement=(0.0, 0.0, 1.0), model="coulomb")
    solution = locked(scene)
    assert solution.status is Status.SOLVED and solution.value == pytest.approx(-scene.weight, rel=PLATEAU)  # opposes the motion


@pytest.mark.parametrize(
    "scene",
    [
        lambda: in_a_slot((1.0, 0.0, 1.0), height=0.2),
        lambda: scenes.build(*scenes.wall(4, 3), live=(0.0, 0.0, -1.0), model="coulomb"),
    ],
    ids=["jammed", "pressed into the ground"],
)
def test_blocks_that_jam_without_dilatancy_too_have_no_value(scene) -> None:
    """A low slot jams: the couple of both walls presses the block harder than the load lifts it."""
    solution = locked(scene())
    assert solution.status is Status.UNBOUNDED and solution.iterations > 0 and has_no_numbers(solution)


def test_a_value_far_from_every_limit_of_its_mechanism_is_one_of_locked_in_stresses() -> None:
    known = locked(in_a_slot((1.0, 0.0, 1.0)))
    assert not prediction._is_locked_in(known)
    for interval, is_locked_in in (
        ((0.5 * known.value, math.inf), True),
        ((0.9 * known.value, math.inf), False),
        ((0.9 * known.value, 9.0 * known.value), False),
        ((0.5 * known.value, 9.0 * known.value), True),
        ((-math.inf, math.inf), False),
        ((math.nan, math.nan), False),
    ):
        assert prediction._is_locked_in(replace(known, interval=interval)) is is_locked_in


def test_a_value_of_locked_in_stresses_is_not_stated(monkeypatch) -> None:
    monkeypatch.setattr(prediction, "_is_locked_in", lambda _solution: True)
    solution = locked(in_a_slot((1.0, 0.0, 1.0)))
    assert solution.status is Status.UNBOUNDED and solution.iterations > 0 and has_no_numbers(solution)


def test_rigid_joints_have_no_prediction_where_the_bound_locks() -> None:
    assembly, stiffness = problem(in_a_slot((1.0, 0.0, 1.0)))
    rigid = replace(assembly, effects=replace(assembly.effects, elasticity="none"))
    assert predict(rigid, stiffness, solve_associated(rigid, Drive.LIVE)).iterations == 0


# --- uncertain answers ----------------------------------------------------------------------------------------------------------


@pytest.mark.slow_after_first
@pytest.mark.parametrize("effort", [1e3, 3e3])
def test_path_that_is_cut_short_states_a_larger_uncertainty_or_no_answer(effort) -> None:
    assembly, whole = answer(great_wall(0.6, 1.2))
    stiffness, associated = problem(great_wall(0.6, 1.2))[1], solve_associated(assembly, Drive.YIELDING)
    short = predict(assembly, stiffness, associated, settings=PredictionSettings(effort=effort))
    is_smooth = short.travel == pytest.approx(1.0 + SHARPENED)  # the sharp path was cut short before its travel
    assert short.travel < whole.travel or is_smooth
    assert short.status is Status.INACCURATE or abs(short.value - whole.value) <= short.uncertainty > 5.0 * whole.uncertainty


def test_soft_joints_are_followed_until_their_strain_is_small() -> None:
    assembly, stiffness = problem(small_wall())
    factor = 20.0
    soft = replace(stiffness, normal=stiffness.normal / factor, shear=stiffness.shear / factor, sag=factor * stiffness.sag)
    associated = solve_associated(assembly, Drive.YIELDING)
    solution, usual = (predict(assembly, joints, associated) for joints in (soft, stiffness))
    assert solution.status is Status.SOLVED and solution.travel > 0.9 * factor
    assert solution.value == pytest.approx(usual.value, rel=PLATEAU)


def test_iteration_that_fails_leaves_no_value(monkeypatch) -> None:
    assembly, stiffness = problem(small_wall())
    associated = solve_associated(assembly, Drive.YIELDING)
    monkeypatch.setattr("la_core.coulomb.path.implicit_step.MOST_ITERATIONS", 0)
    solution = predict(assembly, stiffness, associated)
    assert solution.status is Status.FAILED and np.isnan(solution.value) and np.isnan(solution.forces).all()


def test_slip_that_may_choose_between_bed_joints_does_not_touch_the_value() -> None:
    """Every bed joint of this wall slides at lambda = mu. The slip wanders from joint to joint, so the answer may be called inaccurate."""
    assembly, stiffness = problem(scenes.build(*scenes.wall(4, 3), live=(1.0, 0.0, 0.0)))
    solution = predict(assembly, stiffness, solve_associated(assembly, Drive.LIVE))
    assert solution.status in (Status.SOLVED, Status.INACCURATE)
    assert [solution.value, *solution.interval] == pytest.approx([0.6, 0.6, 0.6], rel=UNSLIDING)


@pytest.mark.slow_after_first
@pytest.mark.parametrize("mu", [0.05, 1.0, 3.0, 30.0])
def test_any_friction_is_answered_or_called_inaccurate(mu) -> None:
    assembly, stiffness = problem(small_wall(friction=mu))
    associated = solve_associated(assembly, Drive.YIELDING)
    solution = predict(assembly, stiffness, associated)
    assert solution.status in (Status.SOLVED, Status.INACCURATE)
    assert solution.value >= associated.value - FOUND * assembly.weight


def test_blocks_that_fall_on_the_way_leave_no_value() -> None:
    """A flat arch slides out of its abutments. The drag of the path would hold it at any load, so no load is an answer."""
    arch = variant("flat_arch", {"joint.friction": 0.4})
    assembly, stiffness = problem(arch)
    associated = solve_associated(assembly, Drive.YIELDING)
    solution = predict(assembly, stiffness, associated, wedging(arch))
    assert associated.status is Status.SOLVED
    assert solution.status is Status.FAILED and np.isnan(solution.value) and np.isinf(solution.uncertainty) and not len(solution.plateaus)
