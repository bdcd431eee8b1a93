"""The path under increments of the support's motion: from rest to the plateau."""

import numpy as np
import pytest
import scenes
from coulomb_problems import PLATEAU, answer, problem, pushed, small_wall

from la_core.coulomb import (
    CoulombSolution,
    EquilibriumPath,
    follow_path,
)
from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.quasi_static_path import Falling, QuasiStaticPath
from la_core.coulomb.path.rest import come_to_rest
from la_core.coulomb.path.tangent import Tangent
from la_core.model.assembly import Assembly
from la_core.scene.scene import Scene

VISCOUS = 1e-2  # viscosity: drag of a structure that moves at unit rate, over its weight
RISE = 1e-3  # of the reaction at rest: what an unconverged step may add to a falling curve


def path_of(scene: Scene, increments: int) -> tuple[Assembly, CoulombSolution, EquilibriumPath]:
    assembly, solution = answer(scene)
    stiffness = problem(scene)[1]
    return assembly, solution, follow_path(assembly, stiffness, stiffness.travel, increments)


@pytest.mark.parametrize("name", ["two_blocks", "arch_settling", "wall_third", "wall_half"])
def test_path_leads_from_rest_to_the_plateau(name) -> None:
    _, solution, path = path_of(scenes.shipped(name), 12)
    assert len(path.value) == 13 and path.settlement[0] == 0.0
    assert path.value[0] == solution.at_rest
    assert path.value[-1] == pytest.approx(solution.value, rel=PLATEAU)


@pytest.mark.parametrize("name", ["arch_settling", "arch_spreading", "trilith"])
def test_reaction_falls_from_rest_to_the_plateau(name) -> None:
    _, _, path = path_of(scenes.shipped(name), 12)
    assert (np.diff(path.value) <= RISE * path.value[0]).all()
    assert path.value[-1] < path.value[0]
    assert (np.diff(path.settlement) > 0.0).all()


def test_block_that_does_not_hang_keeps_its_reaction_all_the_way() -> None:
    _, _, path = path_of(scenes.shipped("two_blocks"), 12)
    assert path.value == pytest.approx(path.value[0], rel=PLATEAU)


@pytest.mark.parametrize("name", ["wall_third", "wall_half"])
def test_more_increments_do_not_change_the_plateau(name) -> None:
    scene = scenes.shipped(name)
    assembly, stiffness = problem(scene)
    few, many = (follow_path(assembly, stiffness, stiffness.travel, increments).value[-1] for increments in (6, 18))
    assert few == pytest.approx(many, rel=PLATEAU)


def test_path_under_a_live_load_starts_without_it_and_rises_to_the_multiplier() -> None:
    _, solution, path = path_of(pushed(), 8)
    assert path.value[0] == 0.0
    assert path.value[-1] == pytest.approx(solution.value, rel=PLATEAU)


def test_path_counts_what_it_solves() -> None:
    assembly, stiffness = problem(small_wall())
    path = follow_path(assembly, stiffness, stiffness.travel, 4)
    assert len(path.solves) == 5 and path.solves[0] == 0 and (path.solves[1:] > 0).all() and path.seconds > 0.0


def test_path_that_breaks_off_is_shorter(monkeypatch) -> None:
    assembly, stiffness = problem(small_wall())
    monkeypatch.setattr("la_core.coulomb.path.implicit_step.MOST_ITERATIONS", 0)
    path = follow_path(assembly, stiffness, stiffness.travel, 4)
    assert len(path.value) == len(path.settlement) == len(path.converged) < 5


def test_the_multiplier_of_a_curve_is_without_the_drag() -> None:
    """A block slides on its bed at unit rate. Its load overcomes friction and drag, and the curve states friction alone."""
    bed, block = scenes.box("bed", (-5.0, 0.0, -1.0), (5.0, 0.2, 0.0), "fixed"), scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.2, 0.2))
    assembly, stiffness = problem(scenes.build(bed, block, friction=0.4, inset=0.001, live=(1.0, 0.0, 0.0)))
    joints = ElasticJoints(assembly, stiffness)
    tangent = Tangent(joints)
    rest, _ = come_to_rest(joints, tangent)
    assert rest is not None
    path = QuasiStaticPath(joints, tangent, rest, Falling(VISCOUS, VISCOUS, 1.0))
    *_, last = path.advance_to(1.0)
    assert joints.value_in_units(path.value(path.last)) == pytest.approx(0.4 + VISCOUS, rel=1e-6)
    assert joints.value_in_units(last.value) == pytest.approx(0.4, rel=1e-6)
