"""What a prediction states where there is no answer, or an uncertain one."""

from dataclasses import replace

import numpy as np
import pytest
import scenes
from coulomb_problems import FOUND, PLATEAU, UNSLIDING, answer, great_wall, problem, small_wall

from la_core.analysis.modelling import wedging
from la_core.coulomb import (
    PredictionSettings,
    predict,
)
from la_core.coulomb.followed_path import SHARPENED
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.scene import variant


@pytest.mark.parametrize(
    ("scene", "status"),
    [
        (lambda: scenes.build(scenes.arch(15, 0.05)), Status.INFEASIBLE),
        (lambda: scenes.build(*scenes.wall(4, 3), live=(0.0, 0.0, -1.0)), Status.UNBOUNDED),
    ],
    ids=["cannot stand", "nothing limits the load"],
)
def test_where_the_associated_answer_has_no_value_neither_has_this(scene, status) -> None:
    assembly, stiffness = problem(scene())
    solution = predict(assembly, stiffness, solve_associated(assembly, Drive.LIVE if assembly.has_live_load else Drive.YIELDING))
    assert (solution.status, solution.iterations) == (status, 0)
    assert np.isnan([solution.value, *solution.interval, solution.at_rest, solution.drift, solution.dilatancy_residual]).all()
    assert np.isnan(solution.forces).all() and np.isnan(solution.twists).all()


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
    monkeypatch.setattr("la_core.coulomb.implicit_step.MOST_ITERATIONS", 0)
    solution = predict(assembly, stiffness, associated)
    assert solution.status is Status.FAILED and np.isnan(solution.value) and np.isnan(solution.forces).all()


def test_slip_that_may_choose_between_bed_joints_does_not_touch_the_value() -> None:
    """Every bed joint of this wall slides at lambda = mu: slip wanders between them, so the answer may be called inaccurate."""
    assembly, stiffness = problem(scenes.build(*scenes.wall(4, 3), live=(1.0, 0.0, 0.0)))
    solution = predict(assembly, stiffness, solve_associated(assembly, Drive.LIVE))
    assert solution.status in (Status.SOLVED, Status.INACCURATE)
    assert [solution.value, *solution.interval] == pytest.approx([0.6, 0.6, 0.6], rel=UNSLIDING)


@pytest.mark.parametrize("mu", [0.05, 1.0, 3.0, 30.0])
def test_any_friction_is_answered_or_called_inaccurate(mu) -> None:
    assembly, stiffness = problem(small_wall(friction=mu))
    associated = solve_associated(assembly, Drive.YIELDING)
    solution = predict(assembly, stiffness, associated)
    assert solution.status in (Status.SOLVED, Status.INACCURATE)
    assert solution.value >= associated.value - FOUND * assembly.weight


def test_blocks_that_fall_on_the_way_leave_no_value() -> None:
    """A flat arch that slides out of its abutments: the drag of the path would hold it at any load, which is no answer."""
    arch = variant("flat_arch", {"joint.friction": 0.4})
    assembly, stiffness = problem(arch)
    associated = solve_associated(assembly, Drive.YIELDING)
    solution = predict(assembly, stiffness, associated, wedging(arch))
    assert associated.status is Status.SOLVED
    assert solution.status is Status.FAILED and np.isnan(solution.value) and np.isinf(solution.uncertainty) and not len(solution.plateaus)
