"""A factorised tangent learns from the moves made with it, and the steps of smooth joints keep it."""

import numpy as np
import pytest
import scenes

from la_core.coulomb.path import implicit_step
from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.quasi_static_path import Falling, QuasiStaticPath
from la_core.coulomb.path.rest import come_to_rest
from la_core.coulomb.path.tangent import MOST_LEARNT, LearningTangent, Tangent
from la_core.model import assemble, joint_stiffness

SIZE = 8


def wrong_tangent(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Matrix of a linear problem (n, n), another one near it, and a right-hand side (n,)."""
    rng = np.random.default_rng(seed)
    matrix = np.eye(SIZE) * 3.0 + 0.5 * rng.normal(size=(SIZE, SIZE))
    return matrix, matrix + 0.4 * rng.normal(size=(SIZE, SIZE)), rng.normal(size=SIZE)


def test_one_move_teaches_the_slope_of_one_unknown() -> None:
    """The tangent is 2.5 times too stiff, and half of its first move is made. The next move leads to the solution."""
    learning = LearningTangent(lambda right: right / 5.0, np.array([1.0]))
    assert learning.move == pytest.approx(0.2)
    assert learning.learn(0.5, np.array([1.0 - 2.0 * 0.1]))
    assert 0.1 + learning.move == pytest.approx(0.5)


@pytest.mark.parametrize("share", [1.0, 0.5])
def test_it_maps_the_change_of_the_forces_to_the_move_that_made_it(share) -> None:
    matrix, near, right = wrong_tangent(1)
    learning = LearningTangent(lambda forces: np.linalg.solve(near, forces), right)
    made = share * learning.move
    after = right - matrix @ made
    learning.learn(share, after)
    inverse = np.linalg.inv(near)
    change = right - after
    updated = inverse + np.outer(made - inverse @ change, made @ inverse) / (made @ inverse @ change)
    assert np.allclose(updated @ change, made)
    assert np.allclose(learning.move, updated @ after)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_it_solves_a_linear_problem_in_twice_as_many_moves_as_unknowns(seed) -> None:
    """Broyden's method does so on every linear problem (D. M. Gay, SIAM J. Numer. Anal. 16, 1979)."""
    matrix, near, right = wrong_tangent(seed)
    learning = LearningTangent(lambda forces: np.linalg.solve(near, forces), right)
    found, alone = np.zeros(SIZE), np.zeros(SIZE)
    for _ in range(2 * SIZE):
        found = found + learning.move
        learning.learn(1.0, right - matrix @ found)
        alone = alone + np.linalg.solve(near, right - matrix @ alone)
    left, left_alone = (np.linalg.norm(right - matrix @ one) / np.linalg.norm(right) for one in (found, alone))
    assert left <= 1e-9 < left_alone


def test_it_says_when_it_has_learnt_enough() -> None:
    learning = LearningTangent(lambda right: 0.5 * right, np.ones(1))
    found, answers = 0.0, []
    while not answers or answers[-1]:
        found += 1e-3 * learning.move
        answers.append(learning.learn(1e-3, 1.0 - found))
    assert len(answers) == MOST_LEARNT + 1


@pytest.mark.parametrize(("plane", "live"), [(True, None), (False, None), (True, (1.0, 0.0, 0.0))], ids=["plane", "3D", "live load"])
def test_smooth_steps_need_fewer_new_tangents(plane, live, monkeypatch) -> None:
    scene = scenes.build(*scenes.wall(6, 4, split=None if live else 1.2), friction=0.6, plane=plane, live=live)
    assembly = assemble(scene)
    joints = ElasticJoints(assembly, joint_stiffness(assembly, scene.yade))
    smoothing = 0.3 / len(joints.friction)
    factorised, values = [], []
    for moves_per_tangent in (implicit_step.MOVES_PER_TANGENT, 1e-9):
        monkeypatch.setattr(implicit_step, "MOVES_PER_TANGENT", moves_per_tangent)
        tangent = Tangent(joints)
        rest, _ = come_to_rest(joints, tangent, 0.0, smoothing)
        assert rest is not None
        path = QuasiStaticPath(joints, tangent, rest, Falling(1e-2, 1e-3, 0.5), smoothing=Falling(smoothing, smoothing, 1.0))
        for _ in path.advance_to(0.5):
            pass
        factorised.append(tangent.factorisations)
        values.append(path.points[-1].value)
    assert factorised[0] < 0.8 * factorised[1]
    assert values[0] == pytest.approx(values[1], rel=1e-2)
