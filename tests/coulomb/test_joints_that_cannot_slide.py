"""Few independent equations keep a joint from sliding as well as the equations of all its points."""

import numpy as np
import pytest
import scenes
from reduced_models import SOLVER
from scipy import sparse

from la_core.limit import problem
from la_core.limit.associated import Status, solve_associated
from la_core.limit.no_sliding import no_sliding_rows, shared_friction
from la_core.limit.problem import Drive, ScaledProblem, scaled_problem
from la_core.model.assembly import Assembly, assemble


def with_every_point(assembly: Assembly, monkeypatch: pytest.MonkeyPatch) -> ScaledProblem:
    """The problem with the equations of no sliding of all contact points, in place of the independent ones."""
    width = 2 if assembly.effects.plane else 3
    tangents = np.arange(len(assembly.points) * width) % width > 0
    with monkeypatch.context() as patch:
        patch.setattr(problem, "no_sliding_rows", lambda _: sparse.identity(len(tangents), format="csr")[tangents])
        return scaled_problem(assembly)


@pytest.mark.parametrize("plane", [True, False])
def test_few_equations_stop_all_points_of_a_joint(plane: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both sets of equations have the same null space."""
    scene = scenes.build(*scenes.wall(3, 2, 0.6), plane=plane, model="none-slides", inset=0.01)
    assembly = assemble(scene)
    kinematics = assembly.kinematic_matrix(assembly.length)
    every, few = with_every_point(assembly, monkeypatch), scaled_problem(assembly)
    matrices = [(one.flow_rule[: one.cones.equalities] @ kinematics).toarray() for one in (every, few)]
    ranks = [np.linalg.matrix_rank(matrix) for matrix in (*matrices, np.vstack(matrices))]
    assert len(set(ranks)) == 1
    assert no_sliding_rows(assembly).shape[0] == len(assembly.interfaces) * (1 if plane else 3) < matrices[0].shape[0]


def test_few_equations_give_the_answer_of_all(monkeypatch: pytest.MonkeyPatch) -> None:
    assembly = assemble(scenes.build(*scenes.crossing_beams(), model="none-slides", inset=0.01))
    few = solve_associated(assembly, Drive.YIELDING)
    every = solve_associated(assembly, Drive.YIELDING, with_every_point(assembly, monkeypatch))
    assert few.status is Status.SOLVED
    assert few.value == pytest.approx(every.value, rel=SOLVER)


def test_shared_friction_has_the_same_wrench_and_is_the_least() -> None:
    assembly = assemble(scenes.build(*scenes.crossing_beams(), inset=0.01))
    forces = np.random.default_rng(7).normal(size=(len(assembly.points), 3))
    shared = shared_friction(assembly, forces)
    assert assembly.contact_wrenches(shared) == pytest.approx(assembly.contact_wrenches(forces), abs=1e-12)
    normal = [np.sum(one * assembly.normal, axis=1) for one in (forces, shared)]
    assert normal[0] == pytest.approx(normal[1])
    assert np.linalg.norm(shared) < np.linalg.norm(forces)
    assert shared_friction(assembly, shared) == pytest.approx(shared, abs=1e-12)
