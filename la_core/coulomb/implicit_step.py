"""One implicit step of a structure on elastic joints: equilibrium at its end, with a drag on the rate of every block.

For displacements q of the free blocks, f(q) the contact forces and w the weights, a step from q_before solves
    J' f(q) + w - drag M (q - q_before) = 0
by a semi-smooth Newton iteration with the consistent tangent. A live load adds its multiplier as an unknown and its mean
displacement as an equation. `drag` is the viscosity over the length of the step. It makes a step solvable where the structure
is unstable without it: a shorter step always converges.
"""

from dataclasses import dataclass

import numpy as np

from la_core.coulomb.elastic_joints import ElasticJoints, JointState
from la_core.coulomb.tangent import Solve, Tangent

# Of the mean block weight: norm of the unbalanced forces of a converged step. A last iteration mostly leaves round-off; looser
# steps would press unloaded joints enough for a large friction coefficient to make them jam.
TOLERANCE = 1e-9
LEAST_TOLERANCE = 1e-12  # of the weight: round-off of large structures
# Times the tolerance: up to here the best iterate is accepted where the next STALLED ones are no better, for points then chatter.
# Where the best residual is larger, the iteration mostly runs in a circle, and ends after LOST worse ones.
LOOSE, STALLED, LOST = 1e3, 2, 4
MOST_ITERATIONS, MOST_MOVES = 20, 40  # new tangents of a step, and moves with them
# Of the residual before: after a move that left less than this, smooth joints keep the factorised tangent for the next one. On a wall of
# 1,008 blocks a factorisation takes fifteen times as long as a move with an old one, and 4 in 10 moves reuse it.
REUSED = 0.2
SHORTEST = 1.0 / 16.0  # of the Newton step in the line search; the last trial is taken even if it is worse
DIVERGED = 100.0  # times the first residual: the iteration has left the solution


@dataclass(frozen=True)
class State:
    """State of the structure at the end of a step; all numbers are scaled as in `la_core.coulomb.elastic_joints`.

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
    """

    progress: float
    blocks: np.ndarray
    joints: JointState
    multiplier: float = 0.0


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
        Newton iterations, each with one factorisation; moves that reuse a tangent do not count.
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
    progress, live_at = target.progress, target.live_at
    blocks, multiplier = guess, before.multiplier
    tolerance = max(TOLERANCE * joints.freedoms / len(joints.weights), LEAST_TOLERANCE)

    def evaluate(blocks: np.ndarray, multiplier: float) -> tuple[np.ndarray, float, float, JointState, np.ndarray]:
        displacement = joints.displacement(blocks, target.support)
        state, stiffness = joints.state(displacement, before.joints, smoothing)
        rest = joints.unbalanced(state.force) - drag * joints.mass * (blocks - before.blocks)
        lag = 0.0
        if live_at is not None:
            rest += multiplier * joints.live_load
            lag = live_at - float(joints.live_load @ blocks)
        return rest, lag, float(np.hypot(np.linalg.norm(rest), lag)), state, stiffness

    rest, lag, size, state, stiffness = evaluate(blocks, multiplier)
    first, best, best_at = size, (np.inf, State(progress, blocks, state, multiplier)), 0
    solve: Solve | None = None
    iterations = 0
    for moves in range(MOST_MOVES):
        if size <= tolerance:
            return Trial(State(progress, blocks, state, multiplier), iterations)
        if not size <= DIVERGED * max(first, tolerance) and iterations > 2:
            return Trial(None, iterations)
        if solve is None:
            if iterations == MOST_ITERATIONS:
                break
            iterations += 1
            try:
                solve = tangent.factorised(stiffness, drag)
            except RuntimeError:  # a singular matrix
                return Trial(None, iterations)
        move, rise = _direction(joints, solve, rest, lag, live_at is not None)
        share, size_before = 1.0, size
        while True:
            trial = evaluate(blocks + share * move, multiplier + share * rise)
            if trial[2] < size or share <= SHORTEST:
                break
            share /= 2.0
        blocks, multiplier = blocks + share * move, multiplier + share * rise
        rest, lag, size, state, stiffness = trial
        if smoothing == 0.0 or size > REUSED * size_before:
            solve = None
        if size < best[0]:
            best, best_at = (size, State(progress, blocks, state, multiplier)), moves
        elif moves - best_at >= (STALLED if best[0] <= LOOSE * tolerance else LOST):
            break
    return Trial(best[1] if best[0] <= LOOSE * tolerance else None, iterations)


def _direction(joints: ElasticJoints, solve: Solve, rest: np.ndarray, lag: float, live: bool) -> tuple[np.ndarray, float]:
    """Newton step of the displacements (n,) and of the multiplier, with a factorised tangent."""
    if not live:
        return solve(rest), 0.0
    both = solve(np.stack([rest, joints.live_load], axis=1))
    rise = (lag - float(joints.live_load @ both[:, 0])) / float(joints.live_load @ both[:, 1])
    return both[:, 0] + rise * both[:, 1], rise
