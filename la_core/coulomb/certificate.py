"""Certificate of the end of a path: the state recomputed as a limit state with friction that does not dilate.

A limit state is a set of contact forces with a mechanism. The forces balance the weights and lie in the friction cones.
Loaded joints do not part, and friction mu n acts against the slip. The power of the weights equals the dissipation plus
the power of the support or of the live load. The drag and the changing strain of the joints keep a path slightly away
from such a state; the residuals measure the distance.

A small structure comes close enough on its path. A large one creeps for too long, so the limit state next to the end of its path is
computed instead. Forces and a mechanism differ from a limit state by a power that should vanish, sum(n |u_n| + mu n |u_t| + t . u_t),
with the rates u of parting and slip. This power is linear in the forces for a given mechanism, and convex in the mechanism for given
forces. Two conic programmes in turn lower it: one finds forces in balance for the mechanism, the other the mechanism for these
forces. A slight quadratic term keeps the forces near those of the path, and the mechanism near that of the round before.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.implicit_step import State
from la_core.coulomb.path.joint_rates import joint_powers, joint_rates
from la_core.coulomb.path.quasi_static_path import QuasiStaticPath
from la_core.limit import Cones, Drive, Programme, ProgrammeOutcome
from la_core.measures import residuals
from la_core.model import global_forces, support_motion, twists_of

ACCEPTED_RESIDUAL = 1e-5  # every residual of a certified end
LEAST_CLOSING = 1e-3  # over the support's rate: an open point that closes more slowly may only follow the strain of the joints
END_VISCOSITY = 1e-9  # of the last stretch, to the certified end
END_ITERATIONS, LEAST_END_ITERATIONS = 0.2, 200  # most iterations of the last stretch: share of those of the path, and least number
END_STEPS = 20  # least number of steps of the last stretch
LEAST_WORK = 1e-3  # of the weight's power at the support's rate: least power that residuals are relative to
MOST_ROUNDS = 12  # of two programmes each, to a limit state near the end of a path
# Weights of half the squared distances, over the power in mean block weights. Forces, from those at the end of the path: first weight, its
# factor from round to round, least weight. Rates, from those of the round before: one weight. A light weight from the start would move the
# value needlessly.
NEAR, NEARER, LEAST_NEAR, NEAR_RATE = 1e-2, 0.1, 1e-8, 1e-6
# Of the largest residual of the round before. Where a round with the least weight leaves more, further rounds bring nothing. While the
# weight still falls they may: on a wall of 1,008 blocks the second round left 0.97 of it, and the fifth, which was certified, 0.77.
MOST_LEFT = 0.97


@dataclass(frozen=True)
class Certificate:
    """Residuals of a limit state.

    Attributes
    ----------
    equilibrium : float
        Largest unbalanced force on a free block over the mean free-block weight.
    cone : float
        Largest tension or excess of |t| over mu n, over the mean free-block weight.
    parting : float
        Power of the normal forces at parting joints over the power put in by sinking weights and by the support or live load.
    sliding : float
        Dissipation mu n |slip| less the power of the friction forces against the slip, over the power put in.
    power : float
        Power of the weights less dissipation less the power of the reaction, over the power put in.
    """

    equilibrium: float
    cone: float
    parting: float
    sliding: float
    power: float

    @property
    def worst(self) -> float:
        """Largest residual; NaN where one is undefined."""
        return float(np.max([self.equilibrium, self.cone, self.parting, self.sliding, self.power]))


@dataclass(frozen=True)
class End:
    """End of a path: the states between which its mechanism moves, and the certificate of the last one."""

    before: State
    last: State
    certificate: Certificate

    def or_nearer(self, other: "End") -> "End":
        """Return this end or the other, whichever is nearer to a limit state; an end with an undefined residual is the farther one."""
        worst, of_other = self.certificate.worst, other.certificate.worst
        return other if of_other < worst or (np.isnan(worst) and not np.isnan(of_other)) else self


def certify(joints: ElasticJoints, before: State, last: State) -> Certificate:
    """Recompute the end of a path as a limit state, with the mechanism of its last step from `before` to `last`."""
    assembly = joints.assembly
    forces = global_forces(assembly, last.joints.force)
    value = last.multiplier if joints.live else joints.reaction(last.joints.force)
    parting, lacking, dissipation = joint_powers(joints, before, last)
    twists = (last.blocks - before.blocks) / (last.progress - before.progress)
    block_power = (joints.weights * twists).reshape(-1, joints.freedoms).sum(axis=1)
    driving = value if joints.live else -value  # power of the live load, or of the support, on the structure
    put_in = max(float(np.maximum(block_power, 0.0).sum()) + max(driving, 0.0), LEAST_WORK)
    return Certificate(
        residuals.equilibrium_residual(assembly, forces, joints.value_in_units(value) if joints.live else 0.0),
        residuals.cone_violation(assembly, forces),
        float(parting.sum()) / put_in,
        float(lacking.sum()) / put_in,
        abs(float(block_power.sum()) + driving - float(dissipation.sum())) / put_in,
    )


def mechanism_and_forces(joints: ElasticJoints, end: End) -> tuple[np.ndarray, np.ndarray]:
    """Twists (B, 6) and contact forces (C, 3), N, at the end of a path, as those of a `CoulombSolution`."""
    assembly, last = joints.assembly, end.last
    speed, motion = support_motion(assembly, (Drive.LIVE if joints.live else Drive.YIELDING).value)
    twists = twists_of(assembly, (last.blocks - end.before.blocks) / (last.progress - end.before.progress)) + motion
    size = 1.0 / (assembly.weight * joints.live_size) if joints.live else speed
    return twists * size, global_forces(assembly, last.joints.force)


def error_of_forces(joints: ElasticJoints, end: End) -> float:
    """Return a cautious estimate of the error of the value (N, N m or multiplier) from errors of the forces at the end of a path.

    The forces are slightly out of balance. Where joints part or slide, the work of the forces differs from that in a limit state. A path
    leaves out friction that is round-off beside heavy blocks, and this friction may matter to light ones.
    """
    multiplier = joints.value_in_units(end.last.multiplier) if joints.live else 0.0
    unbalanced = residuals.most_power_of_unbalanced(joints.assembly, *mechanism_and_forces(joints, end), multiplier)
    parting, lacking, _ = joint_powers(joints, end.before, end.last)
    at_joints = float((1.0 + joints.friction) @ (parting + lacking))  # missing friction may also press on another sliding joint
    return unbalanced + abs(joints.value_in_units(at_joints))


def end_of(path: QuasiStaticPath) -> End:
    """Return the end of a path as it is, with the mechanism of its last step."""
    return End(path.before, path.last, certify(path.joints, path.before, path.last))


def certified_end(path: QuasiStaticPath, stretch: float) -> End:
    """Go on with hardly any drag until the state is a limit state; otherwise return the step that comes closest.

    Rotations are small on this stretch, because a mechanism is one of first order.
    """
    turning, path.joints = path.joints, path.joints_as_turned
    best = end_of(path)
    most = path.iterations + max(END_ITERATIONS * path.iterations, LEAST_END_ITERATIONS)
    for _ in path.advance_to(path.last.progress + stretch, most, END_VISCOSITY, stretch / END_STEPS):
        now = end_of(path)
        best = best.or_nearer(now)
        if now.certificate.worst <= ACCEPTED_RESIDUAL / 10.0:
            break
    path.joints = turning
    return best


class _Pressed:
    """Contact points near the end of a path, and programmes for their forces and mechanism. may_close: whether it may close points."""

    def __init__(self, joints: ElasticJoints, points: np.ndarray, may_close: bool = True) -> None:
        self.joints, self.points, self._may_close = joints, points, may_close
        self.count, self.width = len(self.points), joints.width
        rows = (self.points[:, None] * self.width + np.arange(self.width)).ravel()
        self.kinematics = joints.kinematics[rows].tocsr()
        self.motion, self.friction = joints.motion[self.points], joints.friction[self.points]
        self.blocks = len(joints.weights) / joints.freedoms
        self.live = sparse.csr_matrix(joints.live_load[None, :] if joints.live else np.zeros((0, len(joints.weights))))
        self._frames: dict[bool, tuple[sparse.csr_matrix, Cones]] = {}
        self._mechanism = self._mechanism_programme()

    def _cones(self, equalities: int, others: int) -> Cones:
        """Cones of `equalities`, `others` inequalities, then one friction cone a point."""
        plane = self.width == 2
        return Cones(equalities, others + (2 * self.count if plane else 0), 0 if plane else self.count)

    def _in_cones(self, size: sparse.spmatrix, parts: list[sparse.spmatrix]) -> sparse.csr_matrix:
        """Rows that limit the size of the tangential vectors `parts` to `size`, in the order of `_cones`."""
        if self.width == 2:
            return sparse.vstack([size - parts[0], size + parts[0]]).tocsr()
        order = (np.arange(3)[None, :] * self.count + np.arange(self.count)[:, None]).ravel()
        return sparse.vstack([size, *parts]).tocsr()[order]

    def _axis(self, number: int) -> sparse.csr_matrix:
        """Matrix (P, P k) that picks the component along one axis at every point."""
        row = np.arange(self.count)
        return sparse.csr_matrix((np.ones(self.count), (row, row * self.width + number)), shape=(self.count, self.count * self.width))

    def _force_frame(self, held: bool) -> tuple[sparse.csr_matrix, Cones]:
        """Rows and cones of the programme for the forces and for the value, its last unknown; one more row fixes a held value."""
        normal, *tangents = (self._axis(i) for i in range(self.width))
        cone = self._in_cones(sparse.diags(self.friction) @ normal, tangents)
        reaction = None if self.joints.live else sparse.csr_matrix(self.motion.reshape(1, -1))
        columns = [[self.kinematics.T, self.live.T if self.joints.live else None]]
        columns += [] if self.joints.live else [[reaction, -sparse.identity(1)]]
        columns += [[None, sparse.identity(1)]] if held else []
        frame = sparse.bmat([*columns, [normal, None], [cone, None]]).tocsr()
        return frame, self._cones(len(self.joints.weights) + len(columns) - 1, self.count)

    def _mechanism_programme(self) -> Programme:
        """Programme whose unknowns are the rates of the free blocks, then the sizes of parting at all points, then those of slip.

        Under a live load the mean rate along the load is one.
        """
        normal, *tangents = (self._axis(i) @ self.kinematics for i in range(self.width))
        freedoms, one = len(self.joints.weights), sparse.identity(self.count)
        none = sparse.csr_matrix((self.count, self.count))
        cone = self._in_cones(
            sparse.hstack([sparse.csr_matrix((self.count, freedoms)), none, one]).tocsr(),
            [sparse.hstack([axis, none, none]).tocsr() for axis in tangents],
        )
        live = sparse.hstack([self.live, sparse.csr_matrix((self.live.shape[0], 2 * self.count))])
        closing = sparse.hstack([normal, one if self._may_close else none, none])
        parting = sparse.vstack([closing, sparse.hstack([-normal, one, none])])
        quadratic = np.concatenate([np.full(freedoms, NEAR_RATE), np.zeros(2 * self.count)])
        return Programme(sparse.vstack([live, parting, cone]).tocsr(), self._cones(self.live.shape[0], 2 * self.count), quadratic)

    def forces(self, rate: np.ndarray, end: tuple[np.ndarray, float], near: float, held: bool) -> tuple[np.ndarray, float] | None:
        """Forces (P, k) in balance with the least wrong power in a mechanism, near those at the end of the path, and their value.

        The wrong power is the power that vanishes in a limit state. A `held` value is that of the path's end. None without an answer.
        """
        at_end, value = end
        u = (self.kinematics @ rate).reshape(self.count, self.width) + self.motion
        cost = np.column_stack([np.abs(u[:, 0]) + self.friction * np.linalg.norm(u[:, 1:], axis=1), u[:, 1:]])
        reaction, holding = np.zeros(0 if self.joints.live else 1), np.full(int(held), -self.blocks * value)
        others = np.zeros(self.count * (1 + (2 if self.width == 2 else 3)))
        offset = np.concatenate([self.blocks * self.joints.weights, reaction, holding, others])
        frame = self._frames.get(held) or self._frames.setdefault(held, self._force_frame(held))
        programme = Programme(*frame, np.append(np.full(cost.size, near), 0.0))
        answer = programme.solve(np.append(near * self.blocks * at_end.ravel() - cost.ravel(), 0.0), offset)
        if answer.outcome is not ProgrammeOutcome.OPTIMUM:
            return None
        return answer.x[:-1].reshape(self.count, self.width) / self.blocks, float(answer.x[-1]) / self.blocks

    def mechanism(self, forces: np.ndarray, before: np.ndarray) -> np.ndarray | None:
        """Rates (n,) of the free blocks, near `before`, in which the forces have the least wrong power; None without an answer."""
        normal = np.maximum(forces[:, 0], 0.0) * self.blocks
        friction = np.concatenate([np.zeros((self.count, 1)), forces[:, 1:] * self.blocks], axis=1)
        power = np.concatenate([NEAR_RATE * before - self.kinematics.T @ friction.ravel(), -normal, -self.friction * normal])
        across = self.motion[:, 1:]
        if self.width == 2:
            in_cones = np.concatenate([-across[:, 0], across[:, 0]])
        else:
            in_cones = np.column_stack([np.zeros(self.count), across]).ravel()
        offset = np.concatenate([-np.ones(self.live.shape[0]), self.motion[:, 0], -self.motion[:, 0], in_cones])
        answer = self._mechanism.solve(power, offset)
        return answer.x[: len(self.joints.weights)] if answer.outcome is ProgrammeOutcome.OPTIMUM else None

    def states(self, last: State, forces: np.ndarray, value: float, rate: np.ndarray) -> tuple[State, State]:
        """State from which the mechanism leads to the end of a path in one travel, without strain, and that end with these forces."""
        force = np.zeros_like(last.joints.force)
        force[self.points] = forces
        joints = replace(last.joints, force=force, memory=force[:, 1:])
        moved = self.joints.local(self.joints.kinematics @ rate) + self.joints.motion
        earlier = replace(joints, displacement=joints.displacement - moved)
        multiplier = value if self.joints.live else 0.0
        return State(last.progress - 1.0, last.blocks - rate, earlier, multiplier), replace(last, joints=joints, multiplier=multiplier)


def without_closing(joints: ElasticJoints, end: End) -> End:
    """Return an end whose mechanism closes no gap, with the same forces; the same end where it closes none, or none is found.

    Blocks as laid have no gaps. Elastic joints have some, which a path may leave open: of two blocks that slide apart under a live load the
    one behind then moves alone, into the one ahead. The mechanism nearest to that of the path is found, as in `limit_state_near`.
    """
    last = end.last
    if joints.turning is not None or joint_rates(joints, end.before, last).gap.min(initial=0.0) >= -LEAST_CLOSING:
        return end
    laid = _Pressed(joints, np.arange(len(joints.friction)), may_close=False)
    rate = laid.mechanism(last.joints.force, (last.blocks - end.before.blocks) / (last.progress - end.before.progress))
    if rate is None:
        return end
    before, last = laid.states(last, last.joints.force, last.multiplier, rate)
    certificate = certify(joints, before, last)
    return End(before, last, certificate) if certificate.worst <= ACCEPTED_RESIDUAL else end


def limit_state_near(path: QuasiStaticPath, tell: Callable[[], None] = lambda: None) -> End:
    """Limit state near the end of a path, or the closest state that is found.

    It has the value of the path, unless no limit state with that value is found. tell: called before every round.
    """
    best = end_of(path)
    pressed = _Pressed(path.joints, np.flatnonzero(path.last.joints.displacement[:, 0] <= path.joints.sag))  # wider gaps carry nothing
    end = path.last.joints.force[pressed.points], path.points[-1].value
    for held in (True, False):
        rate, worst = path.rate, np.inf
        for number in range(MOST_ROUNDS):
            tell()
            near = max(NEAR * NEARER**number, LEAST_NEAR)
            balanced = pressed.forces(rate, end, near, held)
            mechanism = None if balanced is None else pressed.mechanism(balanced[0], rate)
            if balanced is None or mechanism is None:
                break
            rate = mechanism
            before, last = pressed.states(path.last, *balanced, rate)
            certificate = certify(path.joints, before, last)
            best = best.or_nearer(End(before, last, certificate))
            if certificate.worst <= ACCEPTED_RESIDUAL:
                return best
            if near == LEAST_NEAR and certificate.worst > MOST_LEFT * worst:
                break
            worst = certificate.worst
    return best
