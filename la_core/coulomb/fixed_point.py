"""Coulomb friction without dilatancy as the fixed point s = mu |slip(s)| of De Saxce's shift, one step of motion at a time.

Each contact point has its own relaxation factor. The factor grows while the point's residual keeps its sign and is
cut when the sign changes (the delta-bar-delta rule, Jacobs 1988). Its upper limit decreases with every change of
sign, so that a chattering point comes to rest. A common factor (under-, over- or Anderson relaxation) converges on
fewer walls, because the slip of a confined joint decreases with the shift and the slip of a free joint does not
respond to it.
"""

from dataclasses import dataclass, replace

import numpy as np

from la_core.coulomb.elastic_joints import ElasticJoints, JointState, Trial

FIRST, LEAST, MOST = 1.0, 0.02, 2.0  # relaxation factor of a contact point
GROW, CUT, CEILING_CUT = 1.2, 0.6, 0.9
CONVERGED = 1e-3  # strain residual of a converged step: small, for its forces are history for the next step
# A value is steady if its relative range over the last STEADY_SOLVES solves is at most STEADY. The step then converges with
# STEADY_RESIDUAL as its largest strain residual; a few joints may still chatter.
STEADY, STEADY_RESIDUAL, STEADY_SOLVES = 2e-3, 2e-2, 4
LAST_RESIDUAL = 6e-3  # the same for the last step, which is the answer: its dilatancy residual is a seventh of this
PATIENCE = 20  # solves of a step, more than most small walls take; then a steady value only has to meet the next two
PATIENT_RESIDUAL = 5e-2  # strain residual of every step but the last
DILATANCY = 1e-3  # dilatancy residual of the last step, and so of an accepted answer
LEAST_ENERGY = 1e-12  # of the weight's work over the travel: unloaded joints have no energy to compare with
STALLED_SOLVES, MOST_SOLVES = 50, 150  # solves without a tenth less residual; solves of one step


@dataclass(frozen=True)
class Step:
    """State at the end of one step, and the difference between its shift and its slip.

    All numbers are scaled as in `la_core.coulomb.elastic_joints`.

    Attributes
    ----------
    progress : float
        Motion of the support, or displacement along the live load, over the travel.
    trial : Trial
        Displacements and forces.
    shift : (C,) array
        Shift of the normal displacement; equal to mu |slip| in an exact answer.
    strain_residual : float
        `dilation` over the elastic energy of the joints; it measures how much the spurious dilation can still change
        the forces.
    dilation : float
        Work of the spurious dilation, sum of n |mu |slip| - s|.
    solves : int
        Associated programmes solved in this step.
    converged : bool
        Whether the iteration converged.
    """

    progress: float
    trial: Trial
    shift: np.ndarray
    strain_residual: float
    dilation: float
    solves: int
    converged: bool

    @property
    def joints(self) -> JointState:
        """Joints at the end of the step."""
        return self.trial.joints


def advance(
    joints: ElasticJoints,
    before: JointState,
    motion: np.ndarray,
    live: float | None,
    progress: float,
    shift: np.ndarray,
    last_from: Step | None = None,
    most_solves: int | None = None,
) -> Step:
    """Take one step of motion: iterate the shift s until it agrees with mu |slip|.

    Parameters
    ----------
    joints : ElasticJoints
        Structure on its elastic joints.
    before : JointState
        Joints at the start of the step.
    motion : (C, k) array
        Relative displacement of the joints that the supports impose at the end of the step, scaled.
    live : float or None
        Displacement to impose along the live load, scaled; None where the load does not act.
    progress : float
        Motion of the support, or displacement along the live load, at the end of the step, over the travel.
    shift : (C,) array
        First shift of the iteration, scaled.
    last_from : Step, optional
        Previous step, given with the last step alone: the answer then has to meet DILATANCY and LAST_RESIDUAL as well.
    most_solves : int, optional
        Largest number of associated programmes; MOST_SOLVES if not given.

    Returns
    -------
    Step
        State with the smallest strain residual, for the residual may rise again where joints chatter; or the first
        converged state. `converged` is False where the iteration did not converge, and `trial.solved` where the
        solver has no answer.
    """
    friction = joints.assembly.points.friction
    steady_limit = STEADY_RESIDUAL if last_from is None else LAST_RESIDUAL
    relaxation, ceiling, last = np.full(len(shift), FIRST), np.full(len(shift), MOST), np.zeros(len(shift))
    values: list[float] = []
    best: Step | None = None
    progressed = 0
    for count in range(1, (most_solves or MOST_SOLVES) + 1):
        trial = joints.solve(before, motion, shift, live)
        if not trial.solved:
            break
        change = friction * np.linalg.norm(trial.slip, axis=1) - shift
        dilation = float(np.sum(np.maximum(trial.joints.force[:, 0], 0.0) * np.abs(change)))
        residual = dilation / max(trial.energy, LEAST_ENERGY)
        values.append(joints.value(trial))
        if last_from is None:
            accepted, suffices = True, residual <= PATIENT_RESIDUAL
        else:  # an accepted answer needs this first
            accepted = suffices = dilation <= DILATANCY * joints.work(trial, last_from.trial, progress - last_from.progress)
        is_steady = _is_steady(values) and (residual <= steady_limit or (count > PATIENCE and suffices))
        converged = accepted and (residual <= CONVERGED or is_steady)
        if best is None or residual < 0.9 * best.strain_residual:
            progressed = count
        if best is None or residual < best.strain_residual or converged:
            best = Step(progress, trial, shift, residual, dilation, count, converged)
        if converged or count - progressed >= STALLED_SOLVES:
            break
        turned = change * last
        ceiling = np.where(turned < 0.0, np.maximum(CEILING_CUT * ceiling, LEAST), ceiling)
        relaxation = np.where(turned < 0.0, np.maximum(CUT * relaxation, LEAST), relaxation)
        relaxation = np.minimum(np.where(turned > 0.0, GROW * relaxation, relaxation), ceiling)
        last, shift = change, np.maximum(shift + relaxation * change, 0.0)
    if best is None:
        return Step(progress, trial, shift, float("nan"), float("nan"), count, False)
    return replace(best, solves=count)


def _is_steady(values: list[float]) -> bool:
    recent = values[-STEADY_SOLVES:]
    return len(recent) == STEADY_SOLVES and max(recent) - min(recent) <= STEADY * abs(recent[-1])
