"""Blocks that turn by a finite angle release a thrust that friction locked in; small rotations keep it."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scenes
from coulomb_problems import problem
from scipy.spatial.transform import Rotation
from turning_scenes import FINITE, OF_YADE, RELEASES
from verdict_scenes import FRESH_SEED, SEED, drawn

import comparison
import la_core
from la_core.analysis import analyse
from la_core.analysis.path_settings import settings_after_path, settings_of_long_run
from la_core.coulomb import ACCEPTED_RESIDUAL, STIFFER, follow_path, followed_path, prediction, sharp_path
from la_core.coulomb.certificate import certified_end, certify
from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.quasi_static_path import QuasiStaticPath, first_travel, least_travel
from la_core.coulomb.path.rest import come_to_rest
from la_core.coulomb.path.tangent import Tangent
from la_core.limit import Status
from la_core.model import twists_of
from la_core.scene import Scene

# --- displacements ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("side", [0, 1], ids=["axes of a", "axes of b"])
@pytest.mark.parametrize("plane", [True, False], ids=["plane", "space"])
def test_displacements_are_those_of_finite_rotations_to_the_third_order(plane: bool, side: int) -> None:
    """Ten times smaller rotations leave a thousandth of the error; the joints' axes turn with block a or b."""
    joints = ElasticJoints(*problem(scenes.build(*scenes.wall(3, 3, split=0.8), plane=plane)), turning=1.0)
    joints = joints if side else joints.with_axes_of_first()
    some = np.random.default_rng(5).normal(size=len(joints.weights))
    errors = [_error(joints, size * some, _turned(joints, size * some, 0.0), side) for size in (1.0, 0.1)]
    of_first_order = _error(joints, 0.1 * some, joints.local(joints.kinematics @ (0.1 * some)), side)
    assert errors[1] < 2e-3 * errors[0] and errors[1] < 0.02 * of_first_order


def _turned(joints: ElasticJoints, blocks: np.ndarray, progress: float) -> np.ndarray:
    """Relative displacements (C, k) of first and second order, over the travel."""
    return joints.as_turned(blocks, progress).displacement(blocks, progress)


def _error(joints: ElasticJoints, blocks: np.ndarray, displacement: np.ndarray, side: int) -> float:
    return float(np.abs(displacement - _finite(joints, blocks, side)).max())


def _finite(joints: ElasticJoints, blocks: np.ndarray, side: int) -> np.ndarray:
    """Relative displacements (C, k) over the travel, from rotation matrices, along axes that turn with block a (side 0) or b (side 1)."""
    assembly = joints.assembly
    twists = joints.unit * twists_of(assembly, blocks)
    turn = Rotation.from_rotvec(twists[:, 3:]).as_matrix()
    a, b = assembly.contact_blocks
    moved = []
    for block in (a, b):
        arm = assembly.points.position - assembly.blocks.centroid[block]
        moved.append(twists[block, :3] + np.einsum("cij,cj->ci", turn[block], arm) - arm)
    axes = np.einsum("cij,ckj->cki", turn[(a, b)[side]], assembly.axes[:, : joints.width])
    return np.einsum("ckj,cj->ck", axes, moved[1] - moved[0]) / joints.unit


def test_a_support_that_turns_about_an_axis_moves_its_contact_points_on_circles_about_it() -> None:
    """Half the motion leaves an eighth of the error against a rotation matrix about the axis."""
    scene = drawn(10, SEED).scene
    assembly, stiffness = problem(scene)
    assert scene.support_twist is not None and scene.support_twist[4] != 0.0
    joints = ElasticJoints(assembly, stiffness, turning=1.0)
    a, b = assembly.contact_blocks
    of_support = np.flatnonzero(assembly.support_twist[a].any(axis=1) & assembly.blocks.free[b])
    assert len(of_support) > 0

    def error(progress: float) -> float:
        still = np.zeros_like(joints.weights)
        displacement = _turned(joints, still, progress)[of_support] * joints.unit
        twist = assembly.support_twist[a[of_support[0]]]
        spin = twist[3:]
        velocity = twist[:3] - np.cross(spin, assembly.blocks.centroid[a[of_support[0]]])  # of the point at the origin
        axis = np.cross(spin, velocity) / float(spin @ spin)
        turn = Rotation.from_rotvec(progress * stiffness.travel * spin).as_matrix()
        points = assembly.points.position[of_support]
        moved = (points - axis) @ turn.T + axis - points
        exact = -np.einsum("cj,ckj->ck", moved, assembly.axes[of_support][:, : joints.width])
        return float(np.abs(displacement - exact).max())

    first_order = np.abs(joints.unit * 200.0 * joints.motion[of_support]).max()
    assert error(200.0) < 0.05 * first_order
    assert error(100.0) < 0.15 * error(200.0)


def test_the_second_order_counts_by_its_share() -> None:
    assembly, stiffness = problem(RELEASES)
    some = np.random.default_rng(3).normal(size=len(ElasticJoints(assembly, stiffness).weights))
    none, whole, part = (_turned(ElasticJoints(assembly, stiffness, share), some, 0.3) for share in (0.0, 1.0, 1.0 / STIFFER))
    np.testing.assert_allclose(STIFFER * (part - none), whole - none, atol=1e-9 * np.abs(whole - none).max())


def test_joints_as_turned_have_displacements_of_first_order_beside_those_of_their_turn() -> None:
    joints = ElasticJoints(*problem(RELEASES), turning=1.0)
    here, on = np.random.default_rng(4).normal(size=(2, len(joints.weights)))
    turned = joints.as_turned(here, 0.5)
    change = turned.displacement(here + on, 0.7) - turned.displacement(here, 0.5)
    np.testing.assert_allclose(change, joints.local(joints.kinematics @ on) + 0.2 * joints.motion, atol=1e-12)
    np.testing.assert_allclose(_turned(turned, on, 0.9), _turned(joints, on, 0.9), atol=1e-12)
    kept = joints.as_turned(here, 0.5, for_good=True)
    assert kept.as_turned(on, 0.9) is kept
    small = ElasticJoints(*problem(RELEASES))
    assert small.as_turned(here, 0.5) is small


# --- predictions ------------------------------------------------------------------------------------------------------------------


def test_finite_rotations_release_a_thrust_that_small_ones_keep() -> None:
    small, finite = analyse(RELEASES), analyse(la_core.variant(RELEASES, FINITE))
    values = [analysis.coulomb.value / RELEASES.weight for analysis in (small, finite)]
    assert values[0] == pytest.approx(0.0807, abs=1e-3)
    assert values[1] == pytest.approx(0.0660, rel=5e-3)
    bound = small.bounds[small.main].value / RELEASES.weight
    assert values[1] >= bound


@pytest.mark.slow_after_first
@pytest.mark.parametrize(
    ("number", "seed", "yade"), [*OF_YADE, pytest.param(164, FRESH_SEED, 0.01535, id="support that turns and releases nothing")]
)
def test_finite_rotations_lead_to_the_value_of_yade_over_its_whole_travel(number: int, seed: int, yade: float) -> None:
    scene = drawn(number, seed).scene
    coulomb = analyse(la_core.variant(scene, FINITE)).coulomb
    assert coulomb is not None and coulomb.status is Status.SOLVED
    assert coulomb.value / scene.weight == pytest.approx(yade, rel=5e-3)


def test_the_end_after_a_release_is_a_certified_limit_state_of_the_geometry_as_laid() -> None:
    """The certificate is recomputed from the state's forces and rates on joints of first order alone."""
    assembly, stiffness = problem(la_core.variant(RELEASES, FINITE))
    joints = ElasticJoints(assembly, stiffness, turning=1.0 / STIFFER)
    tangent = Tangent(joints)
    rest, _ = come_to_rest(joints, tangent)
    assert rest is not None
    path = QuasiStaticPath(joints, tangent, rest, followed_path.annealed(joints, 1e-3))
    for _ in path.advance_to(least_travel(joints)):
        pass
    end = certified_end(path, sharp_path.END_STRETCH * path.last.progress)
    assert path.joints is joints  # the path is ready to turn on
    worst = certify(ElasticJoints(assembly, stiffness), end.before, end.last).worst
    assert worst == pytest.approx(end.certificate.worst) and worst <= ACCEPTED_RESIDUAL


def test_a_path_of_finite_rotations_goes_as_far_as_the_joints_it_stands_for() -> None:
    assembly, stiffness = problem(RELEASES)
    small, stiffer, itself = (ElasticJoints(assembly, stiffness, share) for share in (0.0, 1.0 / STIFFER, 1.0))
    assert least_travel(small) == least_travel(itself) == first_travel(small)
    assert least_travel(stiffer) == STIFFER * first_travel(small)
    coulomb = analyse(la_core.variant(RELEASES, FINITE)).coulomb
    assert coulomb is not None and coulomb.status is Status.SOLVED and coulomb.travel >= STIFFER


def test_the_requested_curve_is_that_of_the_joints_as_they_are() -> None:
    """The rotation at a release grows as the root of the strain. On softer joints it comes later by the root of the stiffness."""
    scene = la_core.variant(RELEASES, FINITE)
    assembly, stiffness = problem(scene)
    soft, stiff = follow_path(assembly, stiffness, 2.0 * stiffness.travel, 40), analyse(scene).coulomb
    assert stiff is not None
    settlement = stiffness.travel * np.array([0.5, 1.0, 1.5, 2.0])
    on_stiff = np.interp(settlement / math.sqrt(STIFFER), stiff.path_settlement / STIFFER, stiff.path_value)
    np.testing.assert_allclose(np.interp(settlement, soft.settlement, soft.value), on_stiff, rtol=0.01)
    assert soft.value[-1] < 0.85 * analyse(RELEASES).coulomb.value  # type: ignore[union-attr]


@pytest.mark.slow_after_first
@pytest.mark.parametrize(("number", "seed", "yade"), [(0, FRESH_SEED, 0.0660), (69, FRESH_SEED, 0.0348), (10, SEED, 0.2209)])
def test_smooth_joints_of_large_structures_release_the_same_thrust(
    number: int, seed: int, yade: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The uncertainty of smooth joints comes from their law: some per cent of the value for a small structure."""
    monkeypatch.setattr(prediction, "LARGE", 0.0)
    scene = drawn(number, seed).scene
    coulomb = analyse(la_core.variant(scene, FINITE)).coulomb
    assert coulomb is not None and coulomb.status is Status.SOLVED and coulomb.travel >= STIFFER
    assert coulomb.value / scene.weight == pytest.approx(yade, rel=0.01)


@pytest.mark.parametrize("stiffer", [1.0, 16.0, 64.0])
def test_joints_of_a_given_stiffness_release_the_same_thrust(stiffer: float) -> None:
    """The path is then that of these joints, with the whole second order; the level after a release does not depend on the stiffness."""
    own = stiffer * problem(RELEASES)[1].normal
    coulomb = analyse(la_core.variant(RELEASES, FINITE | {"yade.normal_stiffness": own, "yade.shear_stiffness": own})).coulomb
    assert coulomb is not None and coulomb.status is Status.SOLVED
    assert coulomb.value / RELEASES.weight == pytest.approx(0.0660, rel=2e-3)
    assert coulomb.travel < 5.0


def test_a_lifted_support_presses_by_the_stiffness_that_is_given() -> None:
    """Joints 16 times as stiff would be wedged by 16 times the thrust, which ends on another plateau, of 0.091 W."""
    coulomb = analyse(la_core.variant(RELEASES, FINITE | {"yade.wedging": 2e-6})).coulomb
    assert coulomb is not None and coulomb.status is Status.SOLVED
    assert coulomb.value / RELEASES.weight == pytest.approx(0.0660, rel=2e-3) and coulomb.travel < 5.0


@pytest.mark.parametrize("space", [False, True], ids=["plane", "space"])
def test_units_mirrors_turns_and_the_order_of_blocks_do_not_matter(space: bool) -> None:
    def value(**changes: Any) -> float:
        scene = scenes.moved(RELEASES, **changes)
        coulomb = analyse(la_core.variant(scene, FINITE)).coulomb
        assert coulomb is not None and coulomb.status is Status.SOLVED
        return coulomb.value / scene.weight

    mirror, turn = np.diag([-1.0, 1.0, 1.0]), scenes.rotation((0.3, -0.5, 0.8), 1.1)
    order = np.random.default_rng(3).permutation(len(RELEASES.blocks))
    change: dict[str, Any] = {"turn": turn, "shift": (3.0, -2.0, 5.0), "plane": False} if space else {"turn": mirror, "scale": 1e3}
    assert value(order=order, density=7.0, **change) == pytest.approx(value(), rel=1e-3)


@pytest.mark.slow
def test_what_the_order_of_blocks_decides_is_in_the_uncertainty() -> None:
    """Corners that meet lie on neither block's face. Axes that turn with one block or the other lead to levels 9 % apart, in YADE, too."""
    scene = drawn(94, SEED).scene
    backwards = scenes.moved(scene, order=range(len(scene.blocks))[::-1])
    one, other = (analyse(la_core.variant(each, FINITE)).coulomb for each in (scene, backwards))
    assert one is not None and other is not None and one.status is other.status is Status.SOLVED
    apart = abs(one.value - other.value)
    assert apart > 0.05 * one.value
    assert apart <= 1.01 * min(one.uncertainty, other.uncertainty)
    for own, beside in ((one, other), (other, one)):
        assert own.plateaus == pytest.approx([own.value, beside.value], rel=1e-3)


@pytest.mark.slow_after_first
@pytest.mark.parametrize("name", ["wall_third", "stack_bond_wall", "ferris_tin_loi_1"])
def test_scenes_without_a_locked_thrust_keep_their_answer(name: str) -> None:
    scene = scenes.shipped(name)
    small, finite = analyse(scene).coulomb, analyse(la_core.variant(scene, FINITE)).coulomb
    assert small is not None and finite is not None and finite.status is Status.SOLVED
    assert finite.value == pytest.approx(small.value, rel=3e-3, abs=2.0 * (small.uncertainty + finite.uncertainty))


# --- beside YADE ------------------------------------------------------------------------------------------------------------------


def test_yade_covers_its_whole_travel_with_joints_as_stiff() -> None:
    def settings(scene: Scene) -> dict[str, float]:
        analysis = analyse(scene)
        assert settings_of_long_run(analysis) == {}
        return settings_after_path(analysis)

    finite = la_core.variant(RELEASES, FINITE)
    assert settings(finite) == {"plateau_share": 1.0, "least_stiffening": STIFFER}
    own = problem(finite)[1].normal
    assert settings(la_core.variant(finite, {"yade.normal_stiffness": own})) == {"plateau_share": 1.0}


@pytest.mark.slow
@pytest.mark.yade
def test_both_methods_release_the_thrust_over_the_same_settlements(tmp_path: Path) -> None:
    """The whole curves agree: the reaction falls by 18 % from 0 to 0.25 mm, on joints 16 times as stiff."""
    run = comparison.run(la_core.variant(RELEASES, FINITE), tmp_path, quiet=True)
    assert run.verdict == "agree" and run.summary["settings"]["stiffening"] == STIFFER
    assert run.summary["curves"]["until"] == pytest.approx(run.summary["settings"]["max_travel"], rel=1e-3)
    assert run.summary["curves"]["mean"] < 5e-3 * run.yade.reaction
    assert any("Rotations are finite" in note for note in run.summary["notes"])
    [row] = [row for row in run.summary["effects"]["table"] if row["effect"] == "rotation"]
    assert row["on"] and row["modelled"] == "finite"
