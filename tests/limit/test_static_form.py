"""Laws of the static form: it is the dual of the kinematic form, and exact where a strength is given."""

import dataclasses
from typing import Any

import numpy as np
import pytest
import scenes

from la_core.limit import static
from la_core.limit.associated import Status, solve_associated
from la_core.limit.conic import ProgrammeAnswer, maximise
from la_core.limit.problem import ACCEPTED, Drive
from la_core.limit.static import StaticSolution, consistent_reaction, coulomb_limits, solve_static
from la_core.measures import residuals
from la_core.model.assembly import Assembly, assemble
from la_core.scene.scene import Scene

SAME = 1e-6  # relative

in_plane_and_3d = pytest.mark.parametrize("plane", [True, False], ids=["plane", "3D"])
both_drives = pytest.mark.parametrize("drive", [Drive.YIELDING, Drive.PUSHING], ids=["yielding", "pushing"])

TURNING = {"axis": [0.0, 1.0, 0.0], "point": [1.2, 0.0, 0.0]}


def coulomb(assembly: Assembly, drive: Drive = Drive.YIELDING) -> StaticSolution:
    """The static form with Coulomb's cone, which must be solved."""
    solution = solve_static(assembly, drive, *coulomb_limits(assembly))
    assert solution.status is Status.SOLVED
    return solution


def two_blocks(**options) -> Assembly:
    """Equal blocks side by side on a fixed and a settling base, head joint between them."""
    left, right = ((0.0, 0.0, 0.0), (0.5, 0.5, 0.5)), ((0.5, 0.0, 0.0), (1.0, 0.5, 0.5))
    return assemble(scenes.build(*scenes.base(0.5, 1.0, 0.5), scenes.box("left", *left), scenes.box("right", *right), **options))


def head_joint(assembly: Assembly) -> np.ndarray:
    """Mask (C,) of the contact points between the two free blocks."""
    a, b = assembly.contact_blocks
    return assembly.blocks.free[a] & assembly.blocks.free[b]


def assert_dual(assembly: Assembly, drive: Drive) -> None:
    static, kinematic = coulomb(assembly, drive), solve_associated(assembly, drive)
    assert kinematic.status is Status.SOLVED
    assert static.value == pytest.approx(kinematic.value, rel=SAME, abs=1e-9 * assembly.weight)  # zero where joints hold all
    work = float(np.sum(assembly.dead_load * static.twists)) * (1.0 if drive is Drive.YIELDING else -1.0)
    assert work == pytest.approx(static.value, rel=SAME, abs=1e-9 * assembly.weight)
    assert residuals.flow_rule_violation(assembly, static.twists) < ACCEPTED


@in_plane_and_3d
@both_drives
def test_static_and_kinematic_form_agree(plane: bool, drive: Drive) -> None:
    assert_dual(assemble(scenes.build(*scenes.wall(4, 4, split=1.0), plane=plane)), drive)


@in_plane_and_3d
def test_static_and_kinematic_form_agree_on_a_live_load(plane: bool) -> None:
    scene = scenes.build(*scenes.wall(3, 4), live=(1.0, 0.0, 0.0), settlement=None, plane=plane)
    assert_dual(assemble(scene), Drive.LIVE)


@both_drives
@pytest.mark.parametrize(
    "scene",
    [
        scenes.shipped("slab_four_corners"),
        scenes.shipped("arch_diagonal"),
        scenes.shipped("wall_half"),
        scenes.build(*scenes.wall(4, 3, split=1.2), settlement=TURNING),
        scenes.build(*scenes.wall(4, 3, split=1.2), model="none-slides"),
        scenes.build(*scenes.wall(4, 3, split=1.2), friction=0.0),
    ],
    ids=["slab", "arch", "wall", "turning", "none slides", "smooth"],
)
def test_forms_agree_whatever_the_joints_and_the_motion(scene: Scene, drive: Drive) -> None:
    assert_dual(assemble(scene), drive)


def test_equilibrium_is_reached_on_a_wall_of_many_blocks() -> None:
    assembly = assemble(scenes.build(*scenes.wall(12, 16, split=3.2)))
    assert coulomb(assembly).equilibrium_residual < ACCEPTED


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_value_over_weight_knows_no_units(scale: float) -> None:
    scene = scenes.build(*scenes.wall(4, 3, split=1.2))
    original, other = assemble(scene), assemble(scenes.moved(scene, scale=scale, density=3.0))
    assert coulomb(other).value / other.weight == pytest.approx(coulomb(original).value / original.weight, rel=SAME)


@in_plane_and_3d
@pytest.mark.parametrize("slope", [0.0, -0.5])
def test_cohesion_carries_what_it_can(plane: bool, slope: float) -> None:
    """With |t| <= c + slope n, slope <= 0, at each point of the head joint: R = W_b - (number of points) c, at n = 0."""
    assembly = two_blocks(plane=plane)
    joint, strength = head_joint(assembly), 50.0
    limits = np.where(joint, strength, 0.0), np.where(joint, slope, 0.6)
    solution = solve_static(assembly, Drive.YIELDING, *limits)
    assert solution.status is Status.SOLVED
    assert solution.value == pytest.approx(assembly.weight / 2.0 - joint.sum() * strength, rel=SAME)


def test_limits_that_allow_no_equilibrium_are_infeasible() -> None:
    assembly = assemble(scenes.build(scenes.arch(7, 0.3)))
    nothing = np.zeros(len(assembly.points))
    solution = solve_static(assembly, Drive.YIELDING, nothing, nothing)
    assert solution.status is Status.INFEASIBLE
    assert np.isnan(solution.value) and np.isnan(solution.forces).all() and np.isnan(solution.twists).all()


def test_unlimited_reaction_is_unbounded() -> None:
    """A block between two fixed walls that may thrust without limit: friction on them takes any push of the support."""
    parts = (
        scenes.box("left", (-0.5, 0.0, -0.5), (0.0, 1.0, 1.0), "fixed"),
        scenes.box("right", (1.0, 0.0, -0.5), (1.5, 1.0, 1.0), "fixed"),
        scenes.box("pad", (0.2, 0.0, -0.5), (0.8, 1.0, 0.0), "support"),
        scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
    )
    assembly = assemble(scenes.build(*parts))
    assert solve_static(assembly, Drive.PUSHING, *coulomb_limits(assembly)).status is Status.UNBOUNDED


@in_plane_and_3d
def test_given_normal_force_in_the_head_joint_decides_the_reaction(plane: bool) -> None:
    """R = W_b - mu P for a total normal force P in the head joint; the bases keep the friction of half the weights' sum each."""
    assembly = two_blocks(plane=plane)
    joint, pressure, weight = head_joint(assembly), 300.0, assembly.weight / 2.0
    normal = np.where(joint, pressure / joint.sum(), weight / (~joint).sum() * 2.0)
    assert consistent_reaction(assembly, normal).value == pytest.approx(weight - 0.6 * pressure, rel=SAME)


@both_drives
@pytest.mark.parametrize("name", ["wall_third", "wall_half", "trilith"])
def test_no_admissible_state_lies_below_its_consistent_reaction(name: str, drive: Drive) -> None:
    """The state itself meets |t| <= mu N, so the least such reaction is at most its own."""
    assembly = assemble(scenes.shipped(name))
    state = coulomb(assembly, drive)
    loose = assembly.split(state.forces)[0] + 1e-8 * assembly.weight
    assert consistent_reaction(assembly, loose).value <= state.value + 1e-6 * assembly.weight


@pytest.mark.parametrize(
    ("error", "status"), [(0.0, Status.SOLVED), (1e-4, Status.INACCURATE), (1e-2, Status.FAILED), (1e200, Status.FAILED)]
)
def test_an_answer_that_misses_equilibrium_by_far_is_none(error: float, status: Status, monkeypatch: pytest.MonkeyPatch) -> None:
    """A solver may break off and return any numbers as its optimum."""

    def broken_off(*arguments: Any) -> ProgrammeAnswer:
        answer = maximise(*arguments)
        return dataclasses.replace(answer, x=(1.0 + error) * answer.x, multipliers=(1.0 + error) * answer.multipliers)

    monkeypatch.setattr(static, "maximise", broken_off)
    assembly = two_blocks()
    solution = solve_static(assembly, Drive.YIELDING, *coulomb_limits(assembly))
    assert solution.status is status
    assert np.isnan(solution.value) == np.isnan(solution.forces).all() == (status is Status.FAILED)


def test_result_is_frozen() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        coulomb(two_blocks()).value = 0.0  # type: ignore[misc]
