"""Rest under gravity: the blocks are laid without force, their weights grow, and they sag on elastic joints until nothing moves.

The weights grow as in YADE, because joints that slide on the way to rest keep friction from this way. If all the weight acted at once, a
light block might slip away before the block on it presses it. In parts of domes the joints would keep other thrusts: one part came to a
plateau 0.8 % higher than YADE's.
"""

from dataclasses import replace

import numpy as np

from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.implicit_step import State, Target, advance
from la_core.coulomb.path.tangent import Tangent
from la_core.model import Assembly, JointStiffness

REST_DRAG, LAST_REST_DRAG = 1e-5, 1e-7  # of the stiffness of a contact point
AT_REST = 1e-6  # of the travel: displacement in the last step to rest
MOST_REST_STEPS = 300
# For growing weights. Of 16 structures the same 13 came to rest with drags from 0.1 to 0.0001, and with ten times the first share.
GROWING_DRAG = 3e-3  # of the weight: drag on all blocks if they move by the sag while the weights grow
FIRST_SHARE = 1e-2  # of the share at which contact points press the lightest block harder than the drag
GROWING = 1.6  # length of a step over that of the step before
LONGEST_SHARE, SHORTEST_SHARE = 0.05, 1e-14  # of the weights, in one step
MOST_GROWING_STEPS = 300  # also those that do not converge; random structures took 51 at most
FALLEN = 1.0  # of the travel: a block that moves farther under gravity falls. YADE ends there, too.


def come_to_rest(joints: ElasticJoints, tangent: Tangent, wedging: float = 0.0, smoothing: float = 0.0) -> tuple[State | None, int]:
    """State at rest under gravity, and the Newton iterations that it took; None where the blocks do not come to rest.

    The blocks are laid without force, and their weights grow. Then a drag that falls with every step lets them sag until nothing moves.

    Parameters
    ----------
    joints : ElasticJoints
        Structure on its elastic joints.
    tangent : Tangent
        Its tangent matrices.
    wedging : float
        Motion of the support against its settlement before gravity acts, over the travel.
    smoothing : float
        Force over which contact points part and slip gradually.

    Returns
    -------
    state : State or None
        State at rest; its progress is that of the wedged support, -wedging.
    iterations : int
        Newton iterations.
    """
    laid = State(-wedging, np.zeros_like(joints.weights), joints.laid)
    laid = replace(laid, joints=replace(joints.laid, displacement=joints.displacement(laid.blocks, -wedging)))
    grown, iterations = _under_growing_weights(joints, tangent, laid, smoothing)
    if grown is None:
        return None, iterations
    state, more = rest_from(joints, tangent, grown, smoothing)
    return state, iterations + more


def reaction_at_rest(assembly: Assembly, stiffness: JointStiffness, wedging: float) -> float:
    """Reaction (N or N m) before the support moves, or 0 for a live load; NaN where the blocks do not come to rest.

    wedging: motion of the support against its settlement before gravity acts, m or rad.
    """
    joints = ElasticJoints(assembly, stiffness)
    rest, _ = come_to_rest(joints, Tangent(joints), wedging / stiffness.travel)
    return float("nan") if rest is None else value_at_rest(joints, rest)


def value_at_rest(joints: ElasticJoints, rest: State) -> float:
    """Reaction (N or N m) of a state at rest, or 0 for a live load."""
    return 0.0 if joints.live else joints.value_in_units(joints.reaction(rest.joints.force))


def rest_from(joints: ElasticJoints, tangent: Tangent, state: State, smoothing: float) -> tuple[State | None, int]:
    """State at rest under the whole weight, reached from an earlier state, and the Newton iterations.

    None where a block moves by more than FALLEN, or where the blocks never come to rest.
    """
    drag, last = REST_DRAG * joints.normal, LAST_REST_DRAG * joints.normal
    start, iterations = state.blocks, 0
    for _ in range(MOST_REST_STEPS):
        trial = advance(joints, tangent, state, Target(state.progress, state.progress), drag, state.blocks, smoothing)
        iterations += trial.iterations
        if trial.state is None:
            drag *= 10.0
            continue
        moved = float(np.abs(trial.state.blocks - state.blocks).max())
        state = trial.state
        if float(np.abs(state.blocks - start).max()) > FALLEN:
            break
        if drag <= last * 1.001 and (moved <= AT_REST or smoothing > 0.0):  # smooth joints creep for ever
            return state, iterations
        drag = max(drag / 10.0, last)
    return None, iterations


def _under_growing_weights(joints: ElasticJoints, tangent: Tangent, state: State, smoothing: float) -> tuple[State | None, int]:
    """State after the weights have grown from nothing, and Newton iterations; None where no step is short enough, or too many are needed.

    At first the drag bears the weights, and all blocks sink alike. So no block slips away before its neighbours press it.
    """
    viscosity = GROWING_DRAG / joints.sag
    length = FIRST_SHARE * min(viscosity * float(joints.mass.min()) / joints.normal, 1.0)
    share, iterations, rate = 0.0, 0, np.zeros_like(state.blocks)
    for _ in range(MOST_GROWING_STEPS):
        step = min(length, 1.0 - share)
        grown, target = joints.under(share + step), Target(state.progress, state.progress)
        trial = advance(grown, tangent, state, target, viscosity / step, state.blocks + step * rate, smoothing)
        iterations += trial.iterations
        if trial.state is None:
            length = step / 4.0
            if length < SHORTEST_SHARE:
                break
            continue
        if step == 1.0 - share:
            return trial.state, iterations
        rate = (trial.state.blocks - state.blocks) / step
        share, state = share + step, trial.state
        length = min(GROWING * step, LONGEST_SHARE)
    return None, iterations
