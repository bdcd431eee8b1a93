"""One implicit step of a structure on elastic joints: equilibrium at its end, with a drag on the rate of every block.

For displacements q of the free blocks, f(q) the contact forces and w the weights, a step from q_before solves
    J' f(q) + w - drag M (q - q_before) = 0
by a semi-smooth Newton iteration with the consistent tangent. A live load adds its multiplier as an unknown and its mean
displacement as an equation. `drag` is the viscosity over the length of the step. It makes a step solvable where the structure
is unstable without it: a shorter step always converges.
"""

from dataclasses import dataclass

import numpy as np

from la_core.coulomb.path.elastic_joints import ElasticJoints, JointState
from la_core.coulomb.path.tangent import LearningTangent, Solve, Tangent

# Of the mean block weight: norm of the unbalanced forces of a converged step. A last iteration mostly leaves round-off. A looser
# tolerance would press unloaded joints so much that they jam under a large friction coefficient.
TOLERANCE = 1e-9
LEAST_TOLERANCE = 1e-12  # of the weight: round-off of large structures
# Times the tolerance: a best residual up to LOOSE is accepted after STALLED iterates that are no better, because contact points then
# chatter. Where the best residual is larger, the iteration mostly runs in a circle, and ends after LOST worse iterates.
LOOSE, STALLED, LOST = 1e3, 2, 4
MOST_ITERATIONS = 20  # new tangents of a step
# Moves with an old tangent in the time of a new tangent: on a wall of 1,008 blocks 0.9 ms and 6.6 ms. Smooth joints keep a tangent while
# its moves lower the logarithm of the residual faster, by time, than the first move did, and at least by LEAST_GAIN.
MOVES_PER_TANGENT, LEAST_GAIN = 7.0, 0.1
SHORTEST = 1.0 / 16.0  # of the Newton step in the line search; the last trial is taken even if it is worse
DIVERGED = 100.0  # times the first residual: the iteration has left the solution


@dataclass(frozen=True)
class State:
    """State of the structure at the end of a step; all numbers are scaled as in `la_core.coulomb.path.elastic_joints`.

    Attributes
    ----------
    progress : float
        Motion of the support, or displacement along the live load, over the travel.
    blocks : (n,) array
        Displacements of the free blocks.
    joints : JointState
        Displacements and forces of the joints.
    multiplier : float
        Multiplier of the live load times its size; 0 for a settlement.
    stiffness : (C, k, k) array or None
        Stiffness of the contact points; None before the first step.
    """

    progress: float
    blocks: np.ndarray
    joints: JointState
    multiplier: float = 0.0
    stiffness: np.ndarray | None = None


@dataclass(frozen=True)
class Target:
    """Imposed motion at the end of a step, over the travel.

    Attributes
    ----------
    progress : float
        Motion of the support from rest, or displacement along the live load from rest.
    support : float
        Motion of the support since the blocks were laid; it differs from `progress` by the wedging.
    live_at : float or None
        Displacement along the live load since the blocks were laid; None where no live load drives the structure.
    """

    progress: float
    support: float
    live_at: float | None = None


@dataclass(frozen=True)
class Trial:
    """Outcome of one step.

    Attributes
    ----------
    state : State or None
        State at the end of the step; None where the iteration did not converge.
    iterations : int
        Newton iterations, each with one factorisation; moves with an old tangent do not count.
    """

    state: State | None
    iterations: int


def advance(
    joints: ElasticJoints,
    tangent: Tangent,
    before: State,
    target: Target,
    drag: float,
    guess: np.ndarray,
    smoothing: float = 0.0,
) -> Trial:
    """Take one step.

    Parameters
    ----------
    joints : ElasticJoints
        Structure on its elastic joints.
    tangent : Tangent
        Its tangent matrices.
    before : State
        State at the start of the step.
    target : Target
        Imposed motion at the end of the step.
    drag : float
        Viscosity over the length of the step.
    guess : (n,) array
        First displacements of the iteration.
    smoothing : float
        Force over which contact points part and slip gradually.
    """
    balance = _Balance(joints, before, target, drag, smoothing)
    now, iterations = _begun(balance, tangent, guess)
    tolerance = max(TOLERANCE * joints.freedoms / len(joints.weights), LEAST_TOLERANCE)
    first, best, best_at, least = now.size, now, 0, np.inf
    current: LearningTangent | None = None
    gain = 0.0
    while True:
        if now.size <= tolerance:
            return Trial(balance.state(now), iterations)
        if not now.size <= DIVERGED * max(first, tolerance) and iterations > 2:
            return Trial(None, iterations)
        if is_new := current is None:
            if iterations == MOST_ITERATIONS:
                break
            iterations += 1
            try:
                current = LearningTangent(balance.solver(tangent, now.stiffness), now.unbalanced)
            except RuntimeError:  # a singular matrix
                return Trial(None, iterations)
        share, trial = _searched(balance, now, current.move)
        gained = float(np.log(now.size / max(trial.size, 1e-300)))
        if not (is_new or gained > 0.0):
            current = None
            continue
        gain, now = gained if is_new else gain, trial
        if smoothing == 0.0 or not gained >= max(gain / MOVES_PER_TANGENT, LEAST_GAIN) or not current.learn(share, now.unbalanced):
            current = None
        if now.size < least:
            best, best_at, least = now, iterations, now.size
        elif is_new and iterations - best_at >= (STALLED if least <= LOOSE * tolerance else LOST):
            break
    return Trial(balance.state(best) if least <= LOOSE * tolerance else None, iterations)


@dataclass(frozen=True)
class _Iterate:
    """Unknowns (displacements of the free blocks; then the multiplier of a live load), the forces left unbalanced, and their size."""

    unknowns: np.ndarray
    unbalanced: np.ndarray
    size: float
    joints: JointState
    stiffness: np.ndarray


@dataclass(frozen=True)
class _Balance:
    """The equations of one step: balance of the free blocks at its end; then, under a live load, the displacement along the load."""

    joints: ElasticJoints
    before: State
    target: Target
    drag: float
    smoothing: float

    def unknowns(self, blocks: np.ndarray, multiplier: float) -> np.ndarray:
        return blocks if self.target.live_at is None else np.append(blocks, multiplier)

    def at(self, unknowns: np.ndarray) -> _Iterate:
        state, stiffness = self.joints.state(self._displacement(unknowns), self.before.joints, self.smoothing)
        rest = self._unbalanced(unknowns, state.force)
        live = self.target.live_at is not None
        size = float(np.hypot(np.linalg.norm(rest[:-1]), rest[-1]) if live else np.linalg.norm(rest))
        return _Iterate(unknowns, rest, size, state, stiffness)

    def in_same_state(self, tangent: Tangent, unknowns: np.ndarray) -> np.ndarray:
        """Unknowns in balance if all points close, stick and slide as before the step; raises RuntimeError if the tangent is singular."""
        before, stiffness = self.before.joints, self.before.stiffness
        assert stiffness is not None
        moved = self._displacement(unknowns) - before.displacement
        force = before.force - np.einsum("cij,cj->ci", stiffness, moved)
        return unknowns + self.solver(tangent, stiffness)(self._unbalanced(unknowns, force))

    def _displacement(self, unknowns: np.ndarray) -> np.ndarray:
        return self.joints.displacement(unknowns[: len(self.joints.weights)], self.target.support)

    def _unbalanced(self, unknowns: np.ndarray, force: np.ndarray) -> np.ndarray:
        """Forces on the free blocks left unbalanced at `unknowns`; then, under a live load, the displacement still missing along it.

        force: contact forces (C, k).
        """
        joints, live_at = self.joints, self.target.live_at
        blocks = unknowns[: len(joints.weights)]
        rest = joints.unbalanced(force) - self.drag * joints.mass * (blocks - self.before.blocks)
        if live_at is None:
            return rest
        rest += unknowns[-1] * joints.live_load
        return np.append(rest, live_at - float(joints.live_load @ blocks))

    def state(self, iterate: _Iterate) -> State:
        blocks = iterate.unknowns[: len(self.joints.weights)]
        multiplier = self.before.multiplier if self.target.live_at is None else float(iterate.unknowns[-1])
        return State(self.target.progress, blocks, iterate.joints, multiplier, iterate.stiffness)

    def solver(self, tangent: Tangent, stiffness: np.ndarray) -> Solve:
        """Factorise the tangent of a stiffness and return the function that solves with it; raises RuntimeError where it is singular."""
        solve, load = tangent.factorised(stiffness, self.drag), self.joints.live_load
        if self.target.live_at is None:
            return solve

        def with_multiplier(unbalanced: np.ndarray) -> np.ndarray:
            both = solve(np.stack([unbalanced[:-1], load], axis=1))
            rise = (unbalanced[-1] - float(load @ both[:, 0])) / float(load @ both[:, 1])
            return np.append(both[:, 0] + rise * both[:, 1], rise)

        return with_multiplier


def _begun(balance: _Balance, tangent: Tangent, guess: np.ndarray) -> tuple[_Iterate, int]:
    """Return the first iterate, and the iterations that it took.

    Where blocks turn, the second order of a guess opens points that hardly press. A block on such a point would then move far. So the step
    begins where all points keep their state, if this leaves less unbalanced: `facade` took 18,000 iterations without this, and takes 2,500.
    """
    now = balance.at(balance.unknowns(guess, balance.before.multiplier))
    if not balance.joints.has_turned or balance.smoothing > 0.0 or balance.before.stiffness is None:
        return now, 0
    try:
        other = balance.at(balance.in_same_state(tangent, now.unknowns))
    except RuntimeError:  # a singular matrix
        return now, 1
    return (other if other.size < now.size else now), 1


def _searched(balance: _Balance, now: _Iterate, move: np.ndarray) -> tuple[float, _Iterate]:
    """Return the largest share 1, 1/2, ... of a move that leaves less unbalanced, or else the shortest, and the iterate after it."""
    share = 1.0
    while True:
        trial = balance.at(now.unknowns + share * move)
        if trial.size < now.size or share <= SHORTEST:
            return share, trial
        share /= 2.0
