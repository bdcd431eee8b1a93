"""What a run remembers: rows of reaction and energy, poses with contact forces, and contacts the case does not list."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from yade import Omega

from yade_scripts.bodies import Model, Vector3
from yade_scripts.case import Case

GRAVITY, SETTLEMENT = 0, 1


@dataclass(frozen=True)
class Row:
    """One recorded instant; units as in `run.h5`. `speed`: of the fastest free block, m/s; `weight_work`:
    work of the weights since the start, J; `displacement`: of the free block that moved most, m."""

    stage: int
    time: float
    settlement: float
    reaction: float
    support_wrench: np.ndarray
    kinetic_energy: float
    unbalanced: float
    speed: float
    weight_work: float
    displacement: float


def _array(vectors: Iterable[Vector3]) -> np.ndarray:
    """YADE's vectors as (N, 3); taken apart by index, because numpy asks each one ten times as long for its entries."""
    return np.array([(vector[0], vector[1], vector[2]) for vector in vectors]).reshape(-1, 3)


@dataclass
class Record:
    """Rows and poses of one run, read from YADE's scene of `model`."""

    case: Case
    model: Model
    rows: list[Row] = field(default_factory=list)
    poses: list[tuple[float, np.ndarray, np.ndarray, np.ndarray]] = field(default_factory=list)
    extra: dict[tuple[int, int], np.ndarray] = field(default_factory=dict)

    def read_row(self, stage: int) -> Row:
        """Read the present instant from YADE and keep it."""
        case, omega = self.case, Omega()
        free = case.free
        states = [omega.bodies[self.model.clump[block]].state for block in free]
        velocity, spin = _array(s.vel for s in states), _array(s.angVel for s in states)
        moved = _array(s.pos for s in states) - self.model.position[free]
        mass = case.mass[free]
        rotational = np.einsum("bi,bij,bj->", spin, case.inertia[free], spin)
        force = _array(omega.forces.f(self.model.clump[block]) for block in free) + mass[:, None] * case.gravity
        wrench = self.support_wrench()
        row = Row(
            stage=stage,
            time=omega.time + omega.dt,  # YADE's clock advances after the last engine, the bodies have moved already
            settlement=self.settlement(),
            reaction=-float(case.support_twist @ wrench),
            support_wrench=wrench,
            kinetic_energy=0.5 * float(mass @ np.sum(velocity**2, axis=1) + rotational),
            unbalanced=float(np.linalg.norm(force, axis=1).max()) / case.block_weight,
            speed=float(np.linalg.norm(velocity, axis=1).max()),
            weight_work=float(mass @ (moved @ case.gravity)),
            displacement=float(np.linalg.norm(moved, axis=1).max()),
        )
        self.rows.append(row)
        return row

    def support_wrench(self) -> np.ndarray:
        """Force and moment about the global origin (6,), N and N m, of the supports on the structure."""
        forces, omega = Omega().forces, Omega()
        total = np.zeros(6)
        for block in self.case.supports:
            clump = self.model.clump[block]
            force = np.array(forces.f(clump))
            total[:3] -= force
            total[3:] -= np.array(forces.t(clump)) + np.cross(np.array(omega.bodies[clump].state.pos), force)
        return total

    def settlement(self) -> float:
        """Motion of the supports (m, or rad) along their unit twist, read from the first support's pose."""
        block = int(self.case.supports[0])
        twist = self.case.support_twist
        part = twist[3:] if self.case.is_rotation else twist[:3]
        moved = self.rotation(block) if self.case.is_rotation else self.displacement(block)
        return float(moved @ part) / float(part @ part)

    def displacement(self, block: int) -> np.ndarray:
        """Displacement (3,), m, of the block's centroid from the case's geometry."""
        return np.array(Omega().bodies[self.model.clump[block]].state.pos) - self.model.position[block]

    def rotation(self, block: int) -> np.ndarray:
        """Rotation vector (3,), rad, of the block from the case's geometry."""
        turn = Omega().bodies[self.model.clump[block]].state.ori * self.model.rotation[block].conjugate()
        vector = np.array([turn[0], turn[1], turn[2]]) * (1.0 if turn[3] >= 0.0 else -1.0)
        sine = float(np.linalg.norm(vector))
        return vector * (2.0 * np.arctan2(sine, abs(turn[3])) / sine if sine > 0.0 else 2.0)

    def contact_forces(self) -> np.ndarray:
        """Force (C, 3), N, on block b at every contact point: what the contact's sphere feels, or its opposite."""
        forces = Omega().forces
        on_host = _array(forces.f(sphere) for sphere in self.model.sphere)
        return np.where(self.case.host == self.case.block_b, 1.0, -1.0)[:, None] * on_host

    def store_pose(self) -> None:
        """Keep displacements, rotations and contact forces of the present state, and look for contacts nobody listed."""
        bodies = Omega().bodies
        moved = _array(bodies[clump].state.pos for clump in self.model.clump) - self.model.position
        turned = np.array([self.rotation(block) for block in range(len(self.case.role))])
        self.poses.append((self.settlement(), moved, turned, self.contact_forces()))
        self._note_extra_contacts()

    def keep_plateau(self, start: float) -> None:
        """Forget the states between rest and the settlement `start` where the plateau begins; the last one stays."""
        first, last = 0, len(self.poses) - 1
        self.poses = [pose for number, pose in enumerate(self.poses) if number in (first, last) or pose[0] >= start]

    def _note_extra_contacts(self) -> None:
        expected = {frozenset(pair) for pair in zip(self.model.sphere, self.model.face, strict=True)}
        block_of = {clump: block for block, clump in enumerate(self.model.clump)}
        bodies = Omega().bodies
        for contact in Omega().interactions:
            if contact.isReal and frozenset((contact.id1, contact.id2)) not in expected:
                pair = sorted(block_of[bodies[body].clumpId] for body in (contact.id1, contact.id2))
                self.extra.setdefault((pair[0], pair[1]), np.array(contact.geom.contactPoint))
