"""The classic iteration for non-associative friction, and the influence of its parameters."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scenes

from comparison.figures import save
from comparison.studies.figure_of_sensitivity import sensitivity_figure
from comparison.studies.sensitivity import Trial, sensitivity_dict, sensitivity_table, study
from la_core.limit import classic_iteration
from la_core.limit.associated import Status, solve_associated
from la_core.limit.classic_iteration import ClassicParameters, ClassicSolution, dilation, solve_sequentially
from la_core.limit.problem import Drive
from la_core.limit.static import StaticSolution
from la_core.model.assembly import Assembly, assemble

MU = 0.6
NEAR = 1e-3  # of the weight: the iteration stops at 1e-4 of a block's weight, some steps before its limit
DEFAULT = ClassicParameters()

in_plane_and_3d = pytest.mark.parametrize("plane", [True, False], ids=["plane", "3D"])


def converged(assembly: Assembly, drive: Drive = Drive.YIELDING, parameters: ClassicParameters = DEFAULT) -> ClassicSolution:
    solution = solve_sequentially(assembly, drive, parameters)
    assert solution.status is Status.SOLVED
    assert solution.violations[-1] <= parameters.tolerance
    assert solution.value == solution.values[-1]
    assert len(solution.values) == len(solution.violations) == solution.iterations
    return solution


def two_blocks(plane: bool = True) -> Assembly:
    """Equal blocks side by side, the right one on the settling base."""
    left, right = ((0.0, 0.0, 0.0), (0.5, 0.5, 0.5)), ((0.5, 0.0, 0.0), (1.0, 0.5, 0.5))
    parts = (*scenes.base(0.5, 1.0, 0.5), scenes.box("left", *left), scenes.box("right", *right))
    return assemble(scenes.build(*parts, friction=MU, plane=plane))


def ferris_tin_loi(rows: int) -> Assembly:
    """Walls 1 and 2 of Ferris & Tin-Loi (2001): blocks 0.4 x 0.175 m, mu 0.65, live load along the wall; half blocks first."""
    parts = scenes.wall(5, rows, block_size=(0.4, 0.175, 0.175), first="half")
    return assemble(scenes.build(*parts, friction=0.65, live=(1.0, 0.0, 0.0), settlement=None))


@in_plane_and_3d
def test_block_beside_another_carries_itself(plane: bool) -> None:
    """Without a thrust in the head joint, real friction carries no weight: R = W_b. With associated friction, R = W_b / (1 + mu^2)."""
    assembly = two_blocks(plane)
    solution = converged(assembly)
    assert solution.values[0] == pytest.approx(assembly.weight / 2.0 / (1.0 + MU**2), rel=1e-6)
    assert solution.value == pytest.approx(assembly.weight / 2.0, rel=NEAR)


def test_part_of_a_stack_bonded_wall_carries_itself() -> None:
    assembly = assemble(scenes.build(*scenes.wall(4, 5, split=0.8, bond="stack"), friction=MU))
    assert converged(assembly).value == pytest.approx(assembly.weight / 2.0, rel=NEAR)


@pytest.mark.parametrize("name", ["trilith", "arch_settling", "arch_spreading", "two_pads", "slab_four_corners"])
def test_without_sliding_it_stays_at_the_associated_answer(name: str) -> None:
    assembly = assemble(scenes.shipped(name))
    assert converged(assembly).value == pytest.approx(solve_associated(assembly, Drive.YIELDING).value, abs=1e-4 * assembly.mean_weight)


def test_where_sliding_is_excluded_nothing_is_iterated() -> None:
    assembly = assemble(scenes.build(*scenes.wall(4, 3, split=1.2), model="none-slides"))
    solution = converged(assembly)
    assert solution.iterations == 2
    assert solution.value == pytest.approx(solve_associated(assembly, Drive.YIELDING).value, abs=1e-6 * assembly.weight)


@pytest.mark.parametrize(("rows", "associated", "coulomb"), [(6, 0.64286, 0.63982), (10, 0.58000, 0.56260)])
def test_walls_of_ferris_and_tin_loi(rows: int, associated: float, coulomb: float) -> None:
    solution = converged(ferris_tin_loi(rows), Drive.LIVE)
    assert solution.values[0] == pytest.approx(associated, abs=0.5e-5)
    assert solution.value == pytest.approx(coulomb, abs=5e-5)


@pytest.mark.parametrize("name", ["wall_third", "wall_half"])
def test_converged_state_is_admissible_and_does_not_dilate(name: str) -> None:
    assembly = assemble(scenes.shipped(name))
    solution, associated = converged(assembly), solve_associated(assembly, Drive.YIELDING)
    assert solution.value >= associated.value
    assert solution.equilibrium_residual <= 1e-6
    assert solution.dilation <= 1e-6
    assert dilation(assembly, associated.twists, associated.forces) > 0.05


@pytest.mark.parametrize(("name", "upper_end"), [("wall_third", 1.0 / 12.0), ("wall_half", 0.175)])
def test_any_small_slope_leads_to_one_end_of_what_friction_allows(name: str, upper_end: float) -> None:
    """Where the friction limit falls with the normal force, the iteration unloads every sliding joint. The reaction is then the
    greatest that the mechanism allows, not that of a settlement from rest."""
    assembly = assemble(scenes.shipped(name))
    for slope in (1e-4, 1e-2):
        value = converged(assembly, parameters=ClassicParameters(slope=slope)).value
        assert value / assembly.weight == pytest.approx(upper_end, rel=NEAR)


def test_slope_makes_sliding_joints_close() -> None:
    """u_n = -a mu |u_t|: the penetration of the mechanism is proportional to the slope a."""
    assembly = ferris_tin_loi(6)
    small, large = (converged(assembly, Drive.LIVE, ClassicParameters(slope=slope)).penetration for slope in (0.01, 0.1))
    assert large == pytest.approx(10.0 * small, rel=0.1)


def test_programme_without_equilibrium_is_reported() -> None:
    assembly = assemble(scenes.shipped("wall_third"))
    solution = solve_sequentially(assembly, Drive.YIELDING, ClassicParameters(relaxation=1.0))
    assert solution.status is Status.INFEASIBLE
    assert len(solution.values) == solution.iterations - 1 >= 1
    assert np.isnan([solution.value, solution.dilation, solution.penetration]).all() and np.isnan(solution.forces).all()


def test_structure_that_cannot_stand_is_infeasible_at_once() -> None:
    assembly = assemble(scenes.build(scenes.arch(15, 0.05)))
    solution = solve_sequentially(assembly, Drive.YIELDING)
    assert (solution.status, solution.iterations, len(solution.values)) == (Status.INFEASIBLE, 1, 0)


def test_too_few_iterations_are_called_inaccurate() -> None:
    solution = solve_sequentially(two_blocks(), Drive.YIELDING, ClassicParameters(iterations=3))
    assert (solution.status, solution.iterations) == (Status.INACCURATE, 3)
    assert np.isfinite(solution.value)


def test_a_steady_value_with_large_residuals_is_called_inaccurate(monkeypatch: pytest.MonkeyPatch) -> None:
    assembly = two_blocks()
    solved = classic_iteration.solve_static

    def inaccurate(*arguments: Any) -> StaticSolution:
        return replace(solved(*arguments), status=Status.INACCURATE)

    monkeypatch.setattr(classic_iteration, "solve_static", inaccurate)
    solution = solve_sequentially(assembly, Drive.YIELDING)
    assert solution.status is Status.INACCURATE and solution.iterations < DEFAULT.iterations


def test_same_question_same_answer() -> None:
    assembly = assemble(scenes.shipped("wall_half"))
    first, second = (solve_sequentially(assembly, Drive.YIELDING) for _ in range(2))
    assert np.array_equal(first.values, second.values) and np.array_equal(first.forces, second.forces)


@pytest.mark.parametrize(
    "wrong",
    [
        {"relaxation": 0.0},
        {"relaxation": 1.1},
        {"slope": -0.1},
        {"slope": np.inf},
        {"iterations": 0},
        {"iterations": 1.5},
        {"cohesion": 1e-3},
        {"tolerance": np.inf},
    ],
)
def test_parameters_without_meaning_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=r"tolerance|needed"):
        replace(DEFAULT, **wrong)


def test_study_of_the_parameters_tells_how_every_run_ended(tmp_path: Path) -> None:
    scene = scenes.shipped("wall_third")
    assembly = assemble(scene)
    heard: list[tuple[int, int, Trial]] = []
    parameters = ClassicParameters(iterations=15)
    grid = {"relaxations": (0.2, 0.6, 1.0), "slopes": (0.01, 0.1)}
    result = study(scene, assembly, **grid, parameters=parameters, progress=lambda *report: heard.append(report))
    assert [(done, total) for done, total, _ in heard] == [(k, 6) for k in range(1, 7)]
    assert tuple(trial for *_, trial in heard) == result.trials
    assert [trial.status for trial in result.trials] == 2 * [Status.INACCURATE, Status.SOLVED, Status.INFEASIBLE]
    found = json.loads(json.dumps(sensitivity_dict(result), allow_nan=False))
    assert [trial["value"] is None for trial in found["trials"]] == 2 * [True, False, True]
    least = solve_associated(assembly, Drive.YIELDING).value
    references: dict[str, tuple[float, int | None]] = {"associated": (least, 1), "Coulomb, elastic joints": (least, None)}
    assert sensitivity_table(result, references).row_count == 8
    figure = sensitivity_figure(result, references)
    save(figure, tmp_path / "sensitivity.png")
    assert [text.get_text() for text in figure.legends[0].get_texts()][-4:] == [
        "associated", "Coulomb, elastic joints", "not converged, range of the last ten", "no equilibrium found: last value",
    ]  # fmt: skip


def test_study_of_a_live_load_is_in_multipliers() -> None:
    scene = scenes.build(*scenes.wall(3, 3), friction=0.65, live=(1.0, 0.0, 0.0), settlement=None)
    result = study(scene, assemble(scene), relaxations=(0.6,), slopes=(0.01,))
    assert (result.quantity, result.unit, result.divisor) == ("multiplier", "", 1.0)
