"""A nearby answer changes the start of the conic solver and its number of iterations, but not the bound."""

from dataclasses import replace

import numpy as np
import pytest
import scenes

from la_core.analysis.modelling import structural_model
from la_core.analysis.result import with_one_fall
from la_core.limit.associated import Solution, Status, solve_associated
from la_core.limit.conic import Programme
from la_core.limit.problem import Drive, points_of_rows, scaled_problem
from la_core.limit.starting_scale import NEAR_SCALE, starting_scale
from la_core.model import global_forces
from la_core.model.assembly import Assembly
from la_core.scene import Scene

SAME_REACTION = 1e-6  # each answer is solved to residuals below this
LEAST_SAVING = 0.1  # of the iterations, on walls of 256 blocks


def wall(plane: bool, size: int = 16) -> Scene:
    return scenes.build(*scenes.wall(size, size, split=0.25 * size + 0.4), inset=0.001, plane=plane)


def pair(scene: Scene) -> tuple[Assembly, Assembly]:
    model = structural_model(scene)
    return model.assembly, model.sharp


@pytest.mark.parametrize("plane", [True, False], ids=["plane", "3D"])
@pytest.mark.parametrize("drive", [Drive.YIELDING, Drive.PUSHING])
def test_the_answer_at_the_inset_saves_iterations_of_the_sharp_one(plane: bool, drive: Drive) -> None:
    rounded, sharp = pair(wall(plane))
    near = solve_associated(rounded, drive)
    cold, warm = solve_associated(sharp, drive), solve_associated(sharp, drive, near=near)
    assert cold.status is warm.status is Status.SOLVED
    assert warm.value == pytest.approx(cold.value, rel=SAME_REACTION)
    assert warm.iterations <= (1.0 - LEAST_SAVING) * cold.iterations


@pytest.mark.parametrize("plane", [True, False], ids=["plane", "3D"])
def test_a_misleading_answer_does_not_change_the_bound(plane: bool) -> None:
    """The misleading forces are those of the opposite drive, those of one point alone, or zero."""
    _, sharp = pair(wall(plane, 8))
    cold, opposite = (solve_associated(sharp, drive) for drive in (Drive.YIELDING, Drive.PUSHING))
    nothing = np.zeros_like(opposite.forces)
    alone = nothing.copy()
    alone[0] = sharp.normal[0]
    for misleading in (opposite, replace(opposite, forces=alone), replace(opposite, forces=nothing)):
        found = solve_associated(sharp, Drive.YIELDING, near=misleading)
        assert found.status is Status.SOLVED
        assert found.value == pytest.approx(cold.value, rel=SAME_REACTION)


@pytest.mark.parametrize("plane", [True, False], ids=["plane", "3D"])
def test_scales_are_the_sizes_of_the_multipliers_within_their_limits(plane: bool) -> None:
    """Multipliers are drawn at random, and the scales come from the contact forces that they add up to."""
    assembly = pair(wall(plane, 4))[0]
    problem = scaled_problem(assembly)
    multipliers = 10.0 ** np.random.default_rng(20261124).uniform(-6.0, 0.0, problem.rows.shape[0])
    scale = starting_scale(assembly, problem, len(multipliers) + 1, global_forces(assembly, problem.flow_rule.T @ multipliers))
    sizes = multipliers if plane else np.repeat(multipliers[::3], 3)
    assert scale[0] == 1.0
    assert scale[1:] == pytest.approx(np.maximum(NEAR_SCALE * sizes / sizes.max(), 1.0 / NEAR_SCALE), rel=1e-9)
    assert (scale[1:].min(), scale[1:].max()) == (pytest.approx(1.0 / NEAR_SCALE), pytest.approx(NEAR_SCALE))


def test_an_answer_that_is_not_solved_or_has_other_points_is_no_start(monkeypatch: pytest.MonkeyPatch) -> None:
    rounded, sharp = pair(wall(True, 4))
    near = solve_associated(rounded, Drive.YIELDING)
    scales: list[float] = []
    solve = Programme.solve

    def noted(programme: Programme, power: np.ndarray, offset: np.ndarray):
        scales.append(float(np.abs(offset).sum()))
        return solve(programme, power, offset)

    monkeypatch.setattr(Programme, "solve", noted)

    def first_offset(start: Solution | None) -> float:
        scales.clear()
        solve_associated(sharp, Drive.YIELDING, near=start)
        return scales[0]

    cold = first_offset(None)
    assert first_offset(replace(near, status=Status.INACCURATE)) == cold
    assert first_offset(replace(near, forces=near.forces[1:])) == cold
    assert first_offset(near) != cold


def test_a_structure_that_falls_under_one_drive_keeps_the_confirmed_bound_of_the_other() -> None:
    assembly, _ = pair(wall(True, 4))
    solved = solve_associated(assembly, Drive.YIELDING)
    fallen, unbounded = (replace(solved, status=status) for status in (Status.INFEASIBLE, Status.UNBOUNDED))
    assert with_one_fall({Drive.YIELDING: solved, Drive.PUSHING: fallen}) == {Drive.YIELDING: solved, Drive.PUSHING: fallen}
    assert with_one_fall({Drive.YIELDING: unbounded, Drive.PUSHING: fallen}) == {Drive.YIELDING: fallen, Drive.PUSHING: fallen}
    assert with_one_fall({Drive.YIELDING: unbounded, Drive.PUSHING: solved}) == {Drive.YIELDING: unbounded, Drive.PUSHING: solved}


@pytest.mark.parametrize("plane", [True, False], ids=["plane", "3D"])
def test_rows_of_head_joints_start_at_ten_times_those_of_bed_joints(plane: bool) -> None:
    """The rows before those of the joints start at one."""
    stones = [
        scenes.box("left", (0.0, 0.0, 0.0), (0.4, 0.2, 0.2)),
        scenes.box("right", (0.4, 0.0, 0.0), (0.8, 0.2, 0.2)),
        scenes.box("base", (0.0, 0.0, -0.2), (0.8, 0.2, 0.0), "support"),
    ]
    model = structural_model(scenes.build(*stones, inset=0.001, plane=plane)).assembly
    problem = scaled_problem(model)
    scale = starting_scale(model, problem, problem.rows.shape[0] + 3, None)
    is_head = np.abs(model.normal @ model.down) < 0.5
    assert is_head.any() and not is_head.all()
    expected = np.where(is_head, 10.0, 1.0)[points_of_rows(model, problem)]
    np.testing.assert_allclose(scale, [1.0, 1.0, 1.0, *expected])
