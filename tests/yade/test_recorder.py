"""The record of YADE's bodies: motions, work, energies and forces of made-up states, without YADE."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation
from yade_stand_in import without_yade

from la_core import exchange

recorder = without_yade("recorder")
FREE, SUPPORT = [0, 1], [2, 3]
GRAVITY = np.array([0.0, 0.0, -9.81])
CENTROID = np.array([[0.0, 0.0, 1.0], [2.0, 1.0, 3.0], [0.0, 0.0, -1.0], [2.0, 0.5, -1.0]])  # m
MASS, INERT = np.array([5.0, 7.0, 1.0, 1.0]), np.array([6.0, 9.0, 1.0, 1.0])  # kg
TENSOR = np.array([np.diag([2.0, 3.0, 4.0]), [[5.0, 1.0, 0.0], [1.0, 6.0, 0.5], [0.0, 0.5, 7.0]], np.eye(3), np.eye(3)])  # kg m2
BUILT = Rotation.from_rotvec([[0.0, 0.0, 0.0], [0.3, -0.2, 0.9], [0.0, 0.0, 0.0], [0.0, 3.0, 0.0]])
DOWN = np.array([0.0, 0.0, -1.0, 0.0, 0.0, 0.0])


class Turn:
    """A quaternion as YADE's: x, y, z, w."""

    def __init__(self, rotation: Rotation, sign: float = 1.0) -> None:
        self.rotation, self.sign = rotation, sign

    def __getitem__(self, place: int) -> float:
        return float(self.sign * self.rotation.as_quat()[place])

    def __mul__(self, other: "Turn") -> "Turn":
        return Turn(self.rotation * other.rotation, self.sign)

    def conjugate(self) -> "Turn":
        return Turn(self.rotation.inv(), self.sign)


class Scene:
    """YADE's scene with one clump per block, numbered from 10 on in the order of the blocks, and contact spheres 0 to 3."""

    def __init__(self) -> None:
        self.time, self.dt = 4.0, 0.25
        self.force = {number: np.zeros(3) for number in range(20)}
        self.torque = {number: np.zeros(3) for number in range(20)}
        self.forces = SimpleNamespace(f=self.force.__getitem__, t=self.torque.__getitem__)
        self.interactions: list[Any] = []
        states = [
            SimpleNamespace(pos=CENTROID[k].copy(), ori=Turn(BUILT[k]), vel=np.zeros(3), angVel=np.zeros(3)) for k in range(len(MASS))
        ]
        self.bodies = {10 + k: SimpleNamespace(state=state, clumpId=10 + k) for k, state in enumerate(states)}
        self.bodies |= {sphere: SimpleNamespace(clumpId=10 + block) for sphere, block in enumerate([0, 1, 0, 2])}

    def state(self, block: int) -> Any:
        return self.bodies[10 + block].state


@pytest.fixture
def scene(monkeypatch: pytest.MonkeyPatch) -> Scene:
    found = Scene()
    monkeypatch.setattr(recorder, "Omega", lambda: found)
    return found


def record_of(twists: Any = (DOWN, DOWN), leader: int = 2, **changes: Any) -> Any:
    support_twists = np.zeros((4, 6))
    support_twists[SUPPORT] = twists
    usual = {
        "free": np.array(FREE), "supports": np.array(SUPPORT), "mass": MASS, "centroid": CENTROID, "gravity": GRAVITY, "live": None,
        "applied_load": np.zeros((4, 6)), "live_load": np.zeros((4, 6)), "support_twists": support_twists, "leader": leader,
        "is_rotation": bool(support_twists[:, 3:].any()), "block_weight": 60.0,
        "host": np.array([0, 1, 0, 2]), "target": np.array([2, 3, 1, 0]), "block_b": np.array([2, 3, 1, 2]),
    }  # fmt: skip
    model = SimpleNamespace(
        clump=(10, 11, 12, 13), sphere=(0, 1, 2, 3), position=CENTROID, rotation=[Turn(one) for one in BUILT],
        inertia=SimpleNamespace(mass=INERT, tensor=TENSOR), integrator=SimpleNamespace(gravity=GRAVITY),
    )  # fmt: skip
    return recorder.Record(SimpleNamespace(**(usual | changes)), model)


def test_a_row_tells_energy_work_and_what_is_unbalanced(scene: Scene) -> None:
    """A dead load pushes block 0 along x and has a couple about its y axis."""
    load = np.zeros((4, 6))
    load[0] = [8.0, 0.0, 0.0, 0.0, 5.0, 0.0]
    record = record_of(applied_load=load)
    scene.state(0).vel, scene.state(1).angVel = np.array([3.0, 0.0, 4.0]), np.array([1.0, 2.0, 0.0])
    scene.state(0).pos = CENTROID[0] + [0.1, 0.0, -0.2]
    scene.state(0).ori = Turn(Rotation.from_rotvec([0.0, 0.01, 0.0]) * BUILT[0])
    scene.force[10], scene.force[11] = -INERT[0] * GRAVITY + [0.0, 12.0, 0.0], -INERT[1] * GRAVITY
    row = record.read_row(exchange.SETTLEMENT, 0.7)
    assert record.rows == [row] and row.damped_energy == 0.7
    assert row.time == 4.25  # the bodies have moved by the end of the step
    assert row.kinetic_energy == pytest.approx(0.5 * 6.0 * 25.0 + 0.5 * (5.0 * 1.0 + 6.0 * 4.0 + 2.0 * 1.0 * 2.0))
    assert row.weight_work == pytest.approx(5.0 * 9.81 * 0.2 + 8.0 * 0.1 + 5.0 * 0.01)
    assert row.unbalanced == pytest.approx(12.0 / 60.0)
    assert row.speed == 5.0 and row.displacement == pytest.approx(np.hypot(0.1, 0.2))


def test_the_reaction_is_what_all_supports_resist_by_their_shares_and_moments_are_about_the_origin(scene: Scene) -> None:
    record = record_of((DOWN, 0.5 * DOWN))
    scene.force[12], scene.force[13] = np.array([1.0, 2.0, -30.0]), np.array([0.0, 0.0, -10.0])
    scene.torque[13] = np.array([0.0, 4.0, 0.0])
    scene.state(2).pos = np.array([0.5, 0.0, -1.0])
    row = record.read_row(exchange.GRAVITY)
    assert row.reaction == pytest.approx(30.0 + 0.5 * 10.0)
    moments = np.cross([0.5, 0.0, -1.0], [1.0, 2.0, -30.0]) + np.cross(CENTROID[3], [0.0, 0.0, -10.0]) + [0.0, 4.0, 0.0]
    assert_allclose(row.support_wrench, [-1.0, -2.0, 40.0, *-moments])


def test_supports_that_turn_resist_by_moments_about_their_axis(scene: Scene) -> None:
    """The axis runs along y through x = -1, so that block 2 resists its force at an arm of 1 m."""
    axis = np.array([0.0, 1.0, 0.0])
    record = record_of([[*np.cross([-1.0, 0.0, 0.0], axis), *axis]] * 2)
    scene.force[12] = np.array([0.0, 0.0, -30.0])
    assert record.read_row(exchange.SETTLEMENT).reaction == pytest.approx(30.0 * 1.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_settlement_is_the_way_of_the_support_that_leads_in_units_of_its_share(scene: Scene, sign: float) -> None:
    record = record_of((DOWN, 0.5 * DOWN), leader=3)
    scene.state(3).pos = CENTROID[3] - [0.0, 0.0, 1e-3]
    assert record.settlement() == pytest.approx(2e-3)
    turned = np.array([0.0, 0.1, 0.0])  # a share of a straight settlement, as of supports along a profile
    profile = record_of([[*np.cross([-1.0, 0.0, 0.0], turned), *turned]] * 2, leader=3, is_rotation=False)
    scene.state(3).pos = CENTROID[3] + 3e-3 * np.cross(turned, CENTROID[3] - [-1.0, 0.0, 0.0])
    assert profile.settlement() == pytest.approx(3e-3)
    axis = np.array([0.0, 2.0, 0.0])
    turning = record_of([[0.0, 0.0, 0.0, *axis]] * 2, leader=3)
    scene.state(3).ori = Turn(Rotation.from_rotvec([0.0, 4e-3, 0.0]) * BUILT[3], sign)
    assert turning.settlement() == pytest.approx(2e-3)


def test_motions_are_those_relative_to_the_blocks_as_built(scene: Scene) -> None:
    """One block turns by more than half a turn, one not at all; a quaternion and its opposite are the same turn."""
    record, turns = record_of(), np.array([[0.4, -1.0, 0.2], [0.0, 3.5, 0.0], [0.0, 0.0, 0.0], [1e-9, 0.0, -2e-9]])
    for block, (turn, sign) in enumerate(zip(turns, (1.0, 1.0, -1.0, -1.0), strict=True)):
        scene.state(block).ori = Turn(Rotation.from_rotvec(turn) * BUILT[block], sign)
        scene.state(block).pos = CENTROID[block] + block * np.array([1.0, -2.0, 3.0])
    moved, rotations = record.motion()
    expected = Rotation.from_rotvec(turns).as_rotvec()
    assert_allclose(moved, np.arange(4)[:, None] * [1.0, -2.0, 3.0], atol=1e-12)
    assert_allclose(rotations, expected, rtol=1e-6, atol=1e-15)
    assert_allclose([record.rotation(block) for block in range(3)], expected[:3], rtol=1e-9, atol=1e-12)


def test_a_live_load_moves_the_blocks_by_the_mean_that_its_shares_weigh(scene: Scene) -> None:
    """A dead load of 9.81 N per unit multiplier makes block 0 count as 1 kg more, which lies 0.5 m above its centroid."""
    live, extra = np.array([1.0, 0.0, 0.0]), np.zeros((4, 6))
    extra[0, :3], extra[0, 4] = 9.81 * live, 9.81 * 0.5
    record = record_of(live=live, live_load=extra)
    scene.state(0).pos = CENTROID[0] + [0.5, 0.0, 0.0]
    assert record.settlement() == 0.0  # the settlement counts from rest
    record.start_load()
    for block, way in enumerate((0.1, 0.3)):
        scene.state(block).pos = np.add(scene.state(block).pos, [way, 0.0, 7.0])
    assert record.settlement() == pytest.approx((6.0 * 0.1 + 7.0 * 0.3) / 13.0)
    scene.state(0).ori = Turn(Rotation.from_rotvec([0.0, 0.02, 0.0]) * BUILT[0])
    assert record.settlement() == pytest.approx((6.0 * 0.1 + 7.0 * 0.3 + 1.0 * 0.5 * 0.02) / 13.0)
    record.model.integrator.gravity = GRAVITY + 0.25 * 9.81 * live
    assert record.read_row(exchange.SETTLEMENT).reaction == pytest.approx(0.25)
    assert_allclose(record.along("pos"), [0.6, 2.3])


def test_contact_forces_are_those_on_the_block_of_the_higher_number(scene: Scene) -> None:
    record = record_of()
    for sphere in range(4):
        scene.force[sphere] = np.array([0.0, 0.0, 1.0 + sphere])
    assert_allclose(record.contact_forces()[:, 2], [-1.0, -2.0, -3.0, 4.0])


def test_contacts_that_the_case_does_not_list_are_noted_once(scene: Scene) -> None:
    """Spheres 0 to 3 sit in blocks 0, 1, 0, 2; their faces are bodies 16 to 19, in blocks 2, 3, 1, 0."""
    record = record_of()
    scene.bodies |= {16 + k: SimpleNamespace(clumpId=10 + block) for k, block in enumerate([2, 3, 1, 0])}

    def contact(one: int, other: int, place: float, real: bool = True) -> Any:
        return SimpleNamespace(isReal=real, id1=one, id2=other, geom=SimpleNamespace(contactPoint=[place, 0.0, 0.0]))

    scene.interactions = [contact(0, 16, 1.0), contact(17, 1, 2.0), contact(18, 3, 3.0), contact(1, 16, 4.0, real=False)]
    record.store_pose()
    assert {pair: place[0] for pair, place in record.extra.items()} == {(1, 2): 3.0}
    scene.interactions = [contact(3, 18, 5.0), contact(0, 17, 6.0)]
    record.store_pose()
    assert {pair: place[0] for pair, place in record.extra.items()} == {(1, 2): 3.0, (0, 3): 6.0}


def test_a_run_that_is_cut_ends_with_its_plateau_and_keeps_the_states_from_its_beginning(scene: Scene) -> None:
    record = record_of()
    record.store_pose()
    for way in (1e-3, 2e-3, 3e-3, 4e-3):
        scene.state(2).pos = CENTROID[2] - [0.0, 0.0, way]
        record.read_row(exchange.SETTLEMENT)
        record.store_pose()
        if way == 3e-3:
            mark = record.mark()
            assert mark == (3, 4) and len(record.poses) == 4  # this state is stored already
    assert not record.is_cut
    record.cut(mark)
    assert record.is_cut and record.settlement() == pytest.approx(3e-3) and len(record.rows) == 3
    record.keep_plateau(2e-3 - 1e-9)
    assert [pose.settlement for pose in record.poses] == pytest.approx([0.0, 2e-3, 3e-3])
    record.keep_plateau(np.nan)  # no plateau is known
    assert [pose.settlement for pose in record.poses] == pytest.approx([0.0, 3e-3])


def test_blocks_rattle_where_forces_are_unbalanced_on_the_mean_of_the_later_travel() -> None:
    """Forces on the way to the plateau do not count, nor does a single force: the mean of 1 and 3 is 2."""
    rows = [SimpleNamespace(settlement=place, unbalanced=force) for place, force in ((0.1, 10.0), (0.6, 1.0), (0.9, 3.0))]
    record: Any = SimpleNamespace(settlement=lambda: 1.0, settling=lambda: rows)
    assert recorder.Record.rattles(record, 0.5, 1.9) and not recorder.Record.rattles(record, 0.5, 2.1)
    assert recorder.Record.rattles(record, 0.05, 4.5) and not recorder.Record.rattles(record, 0.95, 0.0)  # no row, no rattling


def test_one_large_force_that_is_unbalanced_while_the_supports_move_is_a_jump(scene: Scene) -> None:
    record = record_of()
    scene.force[10] = -INERT[0] * GRAVITY + [0.0, 60.0, 0.0]
    scene.force[11] = -INERT[1] * GRAVITY
    record.read_row(exchange.GRAVITY)
    assert not record.jumps(0.5)
    record.read_row(exchange.SETTLEMENT)
    assert record.jumps(0.99) and not record.jumps(1.01)
