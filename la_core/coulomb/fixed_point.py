"""Coulomb friction without dilatancy as the fixed point s = mu |slip(s)| of De Saxce's shift, one step of motion at a time.

Each contact point is relaxed by its own factor: it grows while the point's residual keeps its sign and is cut when the sign turns
(the delta-bar-delta rule, Jacobs 1988); its ceiling sinks with every turn, so that a point that chatters comes to rest. One factor
for all, under-, over- or Anderson-relaxed, converges on fewer walls, because confined joints answer a shift with less slip and
free ones do not answer at all.
"""

from dataclasses import dataclass, replace

import numpy as np

from la_core.coulomb.elastic_joints import ElasticJoints, JointState, Trial

FIRST, LEAST, MOST = 1.0, 0.02, 2.0  # relaxation factor of a contact point
GROW, CUT, CEILING_CUT = 1.2, 0.6, 0.9
CONVERGED = 1e-3  # strain residual: the forces of such a state are history for the next step, so it has to be small
STEADY, STEADY_RESIDUAL, STEADY_SOLVES = 2e-3, 2e-2, 4  # range of the value over so many solves, while a few joints still chatter
LAST_RESIDUAL = 6e-3  # the same of the last step, whose state is the answer: its dilatancy residual is a seventh of this
PATIENCE = 20  # solves of a step, which few small walls take: from then on a settled value makes do with the next two
PATIENT_RESIDUAL = 5e-2  # strain residual on the way
DILATANCY = 1e-3  # dilatancy residual at the end: what an answer is judged by
LEAST_ENERGY = 1e-12  # of the weight's work over the travel: joints that carry nothing have no energy to compare with
STALLED_SOLVES, MOST_SOLVES = 50, 150  # solves without a tenth less residual; of one step


@dataclass(frozen=True)
class Step:
    """State at the end of one step of motion, and how well its shift and its slip agree. All scaled as in `la_core.coulomb.elastic_joints`.

    strain_residual: work of the spurious dilation, sum of n |mu |slip| - s|, over the joints' elastic energy: it tells by how much
    the dilation that is left can still change the forces. dilation: that work. solves: associated programmes of this step.
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
    """Take one step to the supports' relative displacement `motion` (C, k), starting the iteration from `shift` (C,).

    last_from: the step before the last one, which is held to more; None on the way.
    The best state found counts: where joints chatter, the residual may rise again. A step that did not converge says so.
    """
    friction = joints.assembly.points.friction
    enough = STEADY_RESIDUAL if last_from is None else LAST_RESIDUAL
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
        else:  # what the answer is judged by counts before all else
            accepted = suffices = dilation <= DILATANCY * joints.work(trial, last_from.trial, progress - last_from.progress)
        settled = _is_steady(values) and (residual <= enough or (count > PATIENCE and suffices))
        converged = accepted and (residual <= CONVERGED or settled)
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
