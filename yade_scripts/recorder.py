"""The record of a run: rows of reaction and energy, poses with contact forces, and contacts that the case does not list."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import Enum
from itertools import chain

import numpy as np
from yade import Omega

from la_core.exchange import GRAVITY, SETTLEMENT
from yade_scripts.bodies import Model, Vector3
from yade_scripts.case import Case
from yade_scripts.driving import pushed_of
from yade_scripts.plateau import Pose

# Mean block weight over that of a block, above which rest is judged by the block's own weight. A lighter block with the unbalanced force
# of a mean block at rest, a thousandth of the mean weight, may fall at over 2 % of free fall. The judge expects a run to show such a fall.
LIGHT = 20.0


class Status(Enum):
    """Status at the end of a run, as stored in `run.h5`."""

    PLATEAU = "plateau"
    NO_PLATEAU = "no plateau"
    COLLAPSED = "collapsed"
    TIMEOUT = "timeout"
    FAILED = "failed"


@dataclass(frozen=True)
class Row:
    """One recorded instant.

    Attributes
    ----------
    stage : int
        GRAVITY or SETTLEMENT of `la_core.exchange`.
    time : float
        Simulated time, s.
    settlement : float
        Settlement of the supports, m or rad; under a live load the mean displacement of the loaded weights along it since rest, m.
    reaction : float
        Reaction, N or N m; the multiplier of a live load.
    support_wrench : np.ndarray
        Force and moment about the origin (6,) of the supports on the structure, N and N m.
    kinetic_energy : float
        Kinetic energy of the free blocks with the inertia of this run, J.
    damped_energy : float
        Energy that the damping of the blocks' swing has taken so far, J.
    unbalanced : float
        Largest unbalanced force over the mean block weight. Before the settlement the divisor of a light block is LIGHT times its own
        weight and loads, if this is less.
    speed : float
        Speed of the fastest free block, m/s.
    weight_work : float
        Work of the weights, dead loads and ties since the start, J.
    displacement : float
        Displacement of the free block that moved most, m.
    """

    stage: int
    time: float
    settlement: float
    reaction: float
    support_wrench: np.ndarray
    kinetic_energy: float
    damped_energy: float
    unbalanced: float
    speed: float
    weight_work: float
    displacement: float


def _array(vectors: Iterable[Vector3]) -> np.ndarray:
    """Return YADE's vectors as an array (N, 3); reading them by index is ten times as fast as numpy's own conversion."""
    return np.array([(vector[0], vector[1], vector[2]) for vector in vectors]).reshape(-1, 3)


@dataclass
class Record:
    """Rows and poses of one run, read from YADE's scene.

    Attributes
    ----------
    case : Case
        The case that runs.
    model : Model
        Bodies of the case in YADE.
    rows : list of Row
        Recorded instants.
    poses : list of Pose
        Stored states.
    extra : dict
        First contact position (3,), m, by pair of blocks that the case does not list.
    """

    case: Case
    model: Model
    rows: list[Row] = field(default_factory=list)
    poses: list[Pose] = field(default_factory=list)
    extra: dict[tuple[int, int], np.ndarray] = field(default_factory=dict)

    _rest_along: float | None = None
    _cut: float | None = None

    def __post_init__(self) -> None:
        """Look up the data of every row: clumps of free blocks and supports, their states (YADE updates them in place), constants."""
        case, bodies = self.case, Omega().bodies
        self._clumps, self._supports = ([self.model.clump[block] for block in blocks] for blocks in (case.free, case.supports))
        self.states, self._support_states = ([bodies[clump].state for clump in clumps] for clumps in (self._clumps, self._supports))
        self._all_states = [bodies[clump].state for clump in self.model.clump]
        self._built = np.array([(turn[0], turn[1], turn[2], turn[3]) for turn in self.model.rotation])
        self._rest, self._mass, inertia = self.model.position[case.free], case.mass[case.free], self.model.inertia
        self._inert_mass, self._inertia = inertia.mass[case.free], inertia.tensor[case.free]
        own = self._mass * float(np.linalg.norm(case.gravity)) + np.linalg.norm(case.applied_load[case.free, :3], axis=1)
        self._weight_at_rest = np.minimum(case.block_weight, LIGHT * own)
        self._loads, self._turned = case.applied_load[case.free, :3], np.flatnonzero(case.applied_load[:, 3:].any(axis=1)).tolist()
        self._pushed_aside = np.flatnonzero(case.live_load[:, 3:].any(axis=1)).tolist()  # blocks with loaded masses off their centroid
        if case.live is None:
            twist = case.support_twists[case.leader]
            self._leads = bodies[self.model.clump[case.leader]].state
            self._direction = twist[3:] if case.is_rotation else twist[:3] + np.cross(twist[3:], case.centroid[case.leader])

    def read_row(self, stage: int, damped_energy: float = 0.0) -> Row:
        """Read the present instant from YADE, add it to the rows and return it.

        stage: GRAVITY or SETTLEMENT; damped_energy: energy that the damping of the swing has taken so far, J.
        """
        case, omega, states = self.case, Omega(), self.states
        read = [(s.vel for s in states), (s.angVel for s in states), (s.pos for s in states), map(omega.forces.f, self._clumps)]
        vectors = _array(chain(*read)).reshape(len(read), -1, 3)
        vectors[2] -= self._rest
        vectors[3] += self._inert_mass[:, None] * _array([self.model.integrator.gravity])
        _, spin, moved, _ = vectors
        squares = (vectors**2).sum(axis=2)
        squares[3] /= (self._weight_at_rest if stage == GRAVITY else case.block_weight) ** 2
        speed, _, displacement, unbalanced = np.sqrt(squares.max(axis=1)).tolist()
        rotational = np.einsum("bi,bij,bj->", spin, self._inertia, spin)
        wrenches = self.support_wrenches()
        row = Row(
            stage=stage,
            time=omega.time + omega.dt,  # YADE's clock advances after the last engine, but the bodies have already moved
            settlement=self.settlement(),
            reaction=-float(np.sum(case.support_twists[case.supports] * wrenches)) if case.live is None else self.multiplier(),
            support_wrench=wrenches.sum(axis=0),
            kinetic_energy=0.5 * float(self._inert_mass @ squares[0] + rotational),
            damped_energy=damped_energy,
            unbalanced=unbalanced,
            speed=speed,
            weight_work=float(self._mass @ (moved @ case.gravity)) + self._work_of_loads(moved),
            displacement=displacement,
        )
        self.rows.append(row)
        return row

    def settling(self) -> list[Row]:
        """Return the rows of the settlement, or of the live load."""
        return [row for row in self.rows if row.stage == SETTLEMENT]

    def rattles(self, share: float, allowed: float) -> bool:
        """Whether blocks rattle: their mean unbalanced force is larger than in a quasi-static motion.

        share: first part of the settlement, which the mean leaves out; allowed: largest mean force over the mean block weight.
        """
        start = share * self.settlement()
        later = [row.unbalanced for row in self.settling() if row.settlement >= start]
        return bool(later) and float(np.mean(later)) > allowed

    def jumps(self, allowed: float) -> bool:
        """Whether a block has jumped: a single unbalanced force over the mean block weight was larger than allowed.

        One jump may carry the structure past an equilibrium to another state that then looks steady.
        """
        return max((row.unbalanced for row in self.settling()), default=0.0) > allowed

    def _work_of_loads(self, moved: np.ndarray) -> float:
        """Return the work of dead loads and ties for displacements of the free blocks (F, 3), J."""
        turning = sum(float(self.case.applied_load[block, 3:] @ self.rotation(block)) for block in self._turned)
        return float(np.sum(self._loads * moved)) + turning

    def support_wrenches(self) -> np.ndarray:
        """Return force and moment about the global origin (S, 6), N and N m, of each support on the structure."""
        if not self._supports:
            return np.zeros((0, 6))
        forces, supports = Omega().forces, self._supports
        read = [map(forces.f, supports), map(forces.t, supports), (state.pos for state in self._support_states)]
        force, torque, place = _array(chain(*read)).reshape(len(read), -1, 3)
        moment = torque + (place[:, [1, 2, 0]] * force[:, [2, 0, 1]] - place[:, [2, 0, 1]] * force[:, [1, 2, 0]])
        return -np.concatenate([force, moment], axis=1)

    def settlement(self) -> float:
        """Return the motion of the supports (m, or rad) along their unit twist, from the pose of the leading support.

        Under a live load: the mean displacement of the loaded weights along it since `start_load`, m: the work of the load over their sum.
        """
        if self._cut is not None:
            return self._cut
        if self.case.live is not None:
            return 0.0 if self._rest_along is None else self._mean_place() - self._rest_along
        block, direction = self.case.leader, self._direction
        if self.case.is_rotation:
            moved = self.rotation(block)
        else:
            place = self._leads.pos
            moved = np.array([place[0], place[1], place[2]]) - self.model.position[block]
        return float(moved @ direction) / float(direction @ direction)

    def start_load(self) -> None:
        """Measure the displacement along the live load from the present state on."""
        self._rest_along = self._mean_place()

    def multiplier(self) -> float:
        """Return the present multiplier of the live load."""
        gravity = self.case.gravity
        extra = _array([self.model.integrator.gravity])[0] - gravity
        return float(extra @ self.case.live / np.linalg.norm(gravity))

    @property
    def masses(self) -> np.ndarray:
        """Masses of the free blocks, kg."""
        return self._mass

    def along(self, name: str) -> np.ndarray:
        """Return positions ("pos", m) or velocities ("vel", m/s) of the free blocks along the live load."""
        along: np.ndarray = _array(getattr(state, name) for state in self.states) @ self.case.live
        return along

    def _mean_place(self) -> float:
        case, pushed = self.case, pushed_of(self.case)
        turning = sum(float(case.live_load[block, 3:] @ self.rotation(block)) for block in self._pushed_aside)
        return (float(pushed @ self.along("pos")) + turning) / float(pushed.sum())

    def rotation(self, block: int) -> np.ndarray:
        """Return the rotation vector (3,), rad, of a block relative to the case's geometry."""
        turn = Omega().bodies[self.model.clump[block]].state.ori * self.model.rotation[block].conjugate()
        vector = np.array([turn[0], turn[1], turn[2]]) * (1.0 if turn[3] >= 0.0 else -1.0)
        sine = float(np.linalg.norm(vector))
        return vector * (2.0 * np.arctan2(sine, abs(turn[3])) / sine if sine > 0.0 else 2.0)

    def contact_forces(self) -> np.ndarray:
        """Return the force (C, 3), N, on block b at every contact point, from the force on the contact's sphere."""
        forces = Omega().forces
        on_host = _array(forces.f(sphere) for sphere in self.model.sphere)
        return np.where(self.case.host == self.case.block_b, 1.0, -1.0)[:, None] * on_host

    def pose(self) -> Pose:
        """Return the present state."""
        return Pose(self.settlement(), *self.motion(), self.contact_forces())

    def motion(self) -> tuple[np.ndarray, np.ndarray]:
        """Return displacements (B, 3), m, and rotation vectors (B, 3), rad, of all blocks relative to the case's geometry."""
        states = self._all_states
        moved = _array(state.pos for state in states) - self.model.position
        now = np.array([(turn[0], turn[1], turn[2], turn[3]) for turn in (state.ori for state in states)])
        (axis, real), (axis_built, real_built) = ((turns[:, :3], turns[:, 3:]) for turns in (now, self._built))
        vector = real_built * axis - real * axis_built - np.cross(axis, axis_built)
        cosine = (axis * axis_built).sum(axis=1, keepdims=True) + real * real_built
        sine = np.linalg.norm(vector, axis=1, keepdims=True)
        angle = 2.0 * np.arctan2(sine, np.abs(cosine))
        return moved, vector * np.where(cosine >= 0.0, 1.0, -1.0) * np.divide(angle, sine, out=np.full_like(sine, 2.0), where=sine > 0.0)

    def store_pose(self) -> None:
        """Store the present state, and note contacts that the case does not list."""
        self.poses.append(self.pose())
        self._note_extra_contacts()

    def mark(self) -> tuple[int, int]:
        """Store the present state, and return the numbers of rows and of states so far."""
        if self.poses[-1].settlement < self.settlement():
            self.store_pose()
        return len(self.rows), len(self.poses)

    def cut(self, mark: tuple[int, int]) -> None:
        """Drop all rows and states after a mark: the run ends there."""
        del self.rows[mark[0] :], self.poses[mark[1] :]
        self._cut = self.rows[-1].settlement

    @property
    def is_cut(self) -> bool:
        """Whether the run ends at a mark."""
        return self._cut is not None

    def keep_plateau(self, start: float) -> None:
        """Drop the states between rest and the settlement `start`, where the plateau begins; the last state stays."""
        first, last = 0, len(self.poses) - 1
        self.poses = [pose for number, pose in enumerate(self.poses) if number in (first, last) or pose.settlement >= start]

    def _note_extra_contacts(self) -> None:
        target = dict(zip(self.model.sphere, self.case.target, strict=True))  # a sphere may touch two parts of its target
        block_of = {clump: block for block, clump in enumerate(self.model.clump)}
        bodies = Omega().bodies
        for contact in Omega().interactions:
            if not contact.isReal:
                continue
            blocks = [block_of[bodies[body].clumpId] for body in (contact.id1, contact.id2)]
            if target.get(contact.id1) != blocks[1] and target.get(contact.id2) != blocks[0]:
                pair = sorted(blocks)
                self.extra.setdefault((pair[0], pair[1]), np.array(contact.geom.contactPoint))
