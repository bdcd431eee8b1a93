"""The static form is the dual of the kinematic form, and exact where a strength is given."""

import dataclasses
from types import SimpleNamespace
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
    assert static.value == pytest.approx(kinematic.value, rel=SAME, abs=1e-9 * assembly.weight)  # zero where the joints carry all weight
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
    """A block stands between two fixed walls with unlimited thrust, so their friction resists any push of the support."""
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
    """R = W_b - mu P for a total normal force P in the head joint. The normal force of each base is half of the total weight."""
    assembly = two_blocks(plane=plane)
    joint, pressure, weight = head_joint(assembly), 300.0, assembly.weight / 2.0
    normal = np.where(joint, pressure / joint.sum(), weight / (~joint).sum() * 2.0)
    assert consistent_reaction(assembly, normal).value == pytest.approx(weight - 0.6 * pressure, rel=SAME)


@both_drives
@pytest.mark.parametrize("name", ["wall_third", "wall_half", "trilith"])
def test_no_admissible_state_lies_below_its_consistent_reaction(name: str, drive: Drive) -> None:
    """The state itself satisfies |t| <= mu N, so the least consistent reaction is at most the state's own."""
    assembly = assemble(scenes.shipped(name))
    state = coulomb(assembly, drive)
    loose = assembly.split(state.forces)[0] + 1e-8 * assembly.weight
    assert consistent_reaction(assembly, loose).value <= state.value + 1e-6 * assembly.weight


@pytest.mark.parametrize(
    ("error", "status"), [(0.0, Status.SOLVED), (1e-4, Status.INACCURATE), (1e-2, Status.FAILED), (1e200, Status.FAILED)]
)
def test_an_answer_that_misses_equilibrium_by_far_is_none(error: float, status: Status, monkeypatch: pytest.MonkeyPatch) -> None:
    """A solver may break off and return arbitrary numbers as its optimum."""

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


# --- by hand ----------------------------------------------------------------------------------------------------------------------


def one_point(monkeypatch: pytest.MonkeyPatch, parting: float = 0.0, sliding: float = 0.0) -> Any:
    """One contact point with a mechanism of these speeds; the fastest block has unit speed, and the weight gives 100 W."""
    monkeypatch.setattr(static, "contact_speeds", lambda *_: (np.array([parting]), np.array([sliding])))
    monkeypatch.setattr(static.residuals, "over_fastest", lambda assembly, twists, violation: float(violation.max()))
    return SimpleNamespace(split=lambda forces: (forces[:, 0], forces[:, 1:]), dead_load=np.array([[100.0]]))


@pytest.mark.parametrize(
    ("force", "limit", "violation"),
    [
        ((4.0, 3.0, 4.0), (1.0, 0.5), 2.0),  # |t| = 5 over 1 + 2
        ((4.0, 3.0, -4.0), (6.0, -0.5), 1.0),  # over 6 - 2
        ((4.0, 3.0, 4.0), (3.0, 0.5), 0.0),
        ((-2.0, 0.0, 0.0), (9.0, 0.5), 2.0),  # tension
        ((-2.0, 3.0, 4.0), (1.0, 0.5), 5.0),
        ((4.0, 3.0, 4.0), (np.inf, 0.0), 0.0),
    ],
)
def test_a_limit_is_violated_by_tension_or_by_friction_beyond_it(
    force: tuple[float, ...], limit: tuple[float, float], violation: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    limits = np.array([limit[0]]), np.array([limit[1]])
    assert static._limit_violation(one_point(monkeypatch), np.array([force]), limits) == violation


@pytest.mark.parametrize(
    ("parting", "sliding", "limit", "violation"),
    [
        (0.5, 2.0, (0.0, 0.75), 0.8),  # required parting 0.75 * 2 = 1.5; the missing 1.0 over sqrt(1 + 0.75^2)
        (1.5, 2.0, (0.0, 0.75), 0.0),
        (-1.0, 0.0, (0.0, 0.75), 1.0),  # penetration
        (0.0, 3.0, (7.0, 0.0), 0.0),  # a limit that does not depend on n requires no dilation
        (5.0, 2.0, (np.inf, 0.0), 2.0),  # a point that cannot slide
        (5.0, 2.0, (np.inf, -0.5), 2.0),
        (-1.0, 2.0, (7.0, -0.5), 0.0),  # a limit that falls admits every motion
    ],
)
def test_the_flow_rule_is_violated_by_what_its_limit_does_not_admit(
    parting: float, sliding: float, limit: tuple[float, float], violation: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    limits = np.array([limit[0]]), np.array([limit[1]])
    assert static._flow_violation(one_point(monkeypatch, parting, sliding), np.zeros((1, 6)), limits) == pytest.approx(violation)


@pytest.mark.parametrize(
    ("parting", "sliding", "limit", "resisted"),
    [
        (0.0, 2.0, (10.0, 0.0), 20.0),
        (1.5, 2.0, (10.0, 0.75), 20.0),  # at n = 0
        (1.0, 3.0, (10.0, -0.5), 30.0),  # at n = 0; at n = 20 the friction is zero and the parting gives 20 W
        (-4.0, 3.0, (10.0, -0.5), 80.0),  # at n = 20, where the penetration takes 80 W
        (-4.0, 3.0, (20.0, -0.5), 135.0),  # at n = 40 it would take 160 W, but no force of the state exceeds 30 N: 30 * 4 + 5 * 3
        (0.0, 0.0, (np.inf, 0.0), 0.0),
    ],
)
def test_the_forces_within_the_limits_resist_a_mechanism_least(
    parting: float, sliding: float, limit: tuple[float, float], resisted: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    assembly, limits = one_point(monkeypatch, parting, sliding), (np.array([limit[0]]), np.array([limit[1]]))
    found = [static._value_of_mechanism(assembly, drive, np.array([[30.0, 0.0, 0.0]]), np.ones((1, 1)), limits) for drive in Drive]
    signs = {Drive.YIELDING: 1.0, Drive.PUSHING: -1.0, Drive.LIVE: -1.0}
    assert found == pytest.approx([signs[drive] * (100.0 - resisted) for drive in Drive])


@pytest.mark.parametrize("bound", [7.0 - 3e-6, 7.0 + 3e-6])
@pytest.mark.parametrize(("drive", "multiplier"), [(Drive.YIELDING, 0.0), (Drive.PUSHING, 0.0), (Drive.LIVE, 5.0)])
def test_residuals_are_shares_of_a_mean_block_and_undefined_ones_prove_nothing(
    drive: Drive, multiplier: float, bound: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Four blocks of 10 N stand on a support that turns about an axis 3 m away. A multiplier has no unit and scales the live load."""
    found: dict[str, Any] = {"flow": 2e-7}
    value = 5.0 if drive is Drive.LIVE else 7.0
    assembly: Any = SimpleNamespace(mean_weight=10.0, weight=40.0, in_value_unit=lambda force: 1.0 if drive is Drive.LIVE else 3.0 * force)
    assembly.points, assembly.blocks = [None], [None]
    monkeypatch.setattr(static.residuals, "multiplier", lambda *_: 5.0)
    monkeypatch.setattr(static.residuals, "reaction", lambda *_: 7.0)
    monkeypatch.setattr(static.residuals, "equilibrium_residual", lambda assembly, forces, size: found.update(size=size) or 1e-7)
    monkeypatch.setattr(static, "_limit_violation", lambda *_: 4e-6)
    monkeypatch.setattr(static, "_flow_violation", lambda *_: found["flow"])
    monkeypatch.setattr(static, "_value_of_mechanism", lambda *_: bound + value - 7.0)
    answer: Any = SimpleNamespace(seconds=1.0, iterations=8)
    nothing: Any = None
    solution = static._with_evidence(assembly, drive, nothing, nothing, nothing, answer)
    assert found["size"] == multiplier and solution.value == value
    assert (solution.limit_violation, solution.equilibrium_residual) == (pytest.approx(4e-7), 1e-7)
    assert solution.duality_gap == pytest.approx(3e-6 if drive is Drive.LIVE else 1e-7)
    for flow, status in ((ACCEPTED, Status.SOLVED), (1e-3, Status.INACCURATE), (1.1e-3, Status.FAILED), (np.nan, Status.FAILED)):
        found["flow"] = flow
        if drive is not Drive.LIVE:
            assert static._with_evidence(assembly, drive, nothing, nothing, nothing, answer).status is status


def on_fixed_base(assembly: Assembly) -> np.ndarray:
    """Mask (C,) of the contact points on the fixed base."""
    return np.isin(assembly.contact_blocks, assembly.blocks.names.index("fixed base")).any(axis=0)


@in_plane_and_3d
def test_cohesion_holds_no_tension(plane: bool) -> None:
    """A support that pushes up lifts the block off the fixed base and carries its whole weight."""
    block = scenes.box("block", (0.4, 0.0, 0.0), (1.0, 0.5, 0.5))
    assembly = assemble(scenes.build(*scenes.base(0.5, 1.0, 0.5), block, plane=plane))
    limits = np.where(on_fixed_base(assembly), 100.0, 0.0), np.full(len(assembly.points), 0.6)
    assert solve_static(assembly, Drive.PUSHING, *limits).value == pytest.approx(assembly.weight, rel=SAME)


@in_plane_and_3d
def test_a_point_whose_limit_falls_from_nothing_carries_nothing(plane: bool) -> None:
    """The settling base, below the centroid, carries the block alone. Beside a smooth fixed base, it would carry 0.15/0.5."""
    block = scenes.box("block", (0.3, 0.0, 0.0), (1.0, 0.5, 0.5))
    assembly = assemble(scenes.build(*scenes.base(0.5, 1.0, 0.5), block, plane=plane))
    for slope, share in ((-0.5, 1.0), (0.0, 0.3)):
        limits = np.zeros(len(assembly.points)), np.where(on_fixed_base(assembly), slope, 0.6)
        assert solve_static(assembly, Drive.YIELDING, *limits).value == pytest.approx(share * assembly.weight, rel=SAME)


@in_plane_and_3d
def test_tension_in_a_given_state_gives_no_friction(plane: bool) -> None:
    """YADE's forces in an open joint may be slightly off zero. The friction of such a head joint is zero."""
    assembly = two_blocks(plane=plane)
    normal = np.where(head_joint(assembly), -300.0, assembly.weight)
    assert consistent_reaction(assembly, normal).value == pytest.approx(assembly.weight / 2.0, rel=SAME)


@in_plane_and_3d
def test_given_normal_forces_decide_the_multiplier_of_a_push(plane: bool) -> None:
    """A wide block slides at mu times the given normal force: here half of its weight."""
    ground = scenes.box("ground", (-1.0, 0.0, -0.2), (2.0, 0.5, 0.0), "fixed")
    block = scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.5, 0.2))
    assembly = assemble(scenes.build(ground, block, live=(1.0, 0.0, 0.0), plane=plane))
    normal = np.full(len(assembly.points), 0.5 * assembly.weight / len(assembly.points))
    assert consistent_reaction(assembly, normal).value == pytest.approx(0.6 * 0.5, rel=SAME)


def test_joints_that_cannot_slide_hold_whatever_the_given_normal_forces() -> None:
    assembly = two_blocks(model="none-slides")
    held = solve_associated(assembly, Drive.YIELDING).value
    assert held < 0.4 * assembly.weight
    assert consistent_reaction(assembly, np.zeros(len(assembly.points))).value == pytest.approx(held, rel=SAME, abs=SAME * assembly.weight)
