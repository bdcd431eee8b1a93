"""The interval of values that a non-dilatant mechanism allows: which joints part, slide and stick decides it, friction's history not.

A joint that parts carries no force; one that slides carries friction mu n against its slip; one that sticks carries any force in
its cone. Forces of this kind in equilibrium are a convex set, so the least and the greatest reaction are two cone programmes:
as in `la_core.limit`, with a sliding joint's velocity limited by (n - mu tau) . u >= 0 in the place of the flow rule's cone.
"""

from dataclasses import replace

import numpy as np
from scipy import sparse

from la_core.coulomb.elastic_joints import ElasticJoints
from la_core.coulomb.fixed_point import Step
from la_core.limit import ProgrammeAnswer, ProgrammeOutcome, optimum, scaled_problem
from la_core.model import Assembly, columns, scaled_load, support_motion

THRESHOLD = 0.03  # of the support's motion: slower slip and parting are elastic strain that the last step still carries
LOADED = 1e-5  # of the weight: more normal force than the residuals of a joint that carries none
SLIGHT = 1e-5  # friction up to here may point anywhere: it moves an end by no more, and exact directions contradict equilibrium
FAN = 0.01  # rad: slip's direction is known no better, and exact ones, far more than equilibrium needs in 3D, would contradict it


def reaction_interval(joints: ElasticJoints, before: Step, last: Step, threshold: float = THRESHOLD) -> tuple[float, float]:
    """Least and greatest reaction (N, N m) or multiplier that the mechanism of the last step allows.

    An end is infinite where nothing limits it, NaN where no state of force fits the mechanism.
    """
    stride = last.progress - before.progress
    slip = last.trial.slip / stride
    speed = np.linalg.norm(slip, axis=1)
    unloaded = last.joints.force[:, 0] <= LOADED  # a joint that slides may part by the dilation that is left, and still carries force
    parting = unloaded & ((last.trial.gap - before.trial.gap) / stride > threshold)
    sliding = ~parting & (speed > threshold) & (joints.assembly.points.friction > SLIGHT)
    direction = slip / np.where(speed > 0.0, speed, 1.0)[:, None]
    ends, seconds = _ends(joints.assembly, parting, sliding, direction)
    joints.seconds += seconds
    return ends


def _ends(assembly: Assembly, parting: np.ndarray, sliding: np.ndarray, direction: np.ndarray) -> tuple[tuple[float, float], float]:
    sticking = replace(assembly, points=assembly.points.subset(~parting & ~sliding))
    problem = scaled_problem(sticking)
    guided = sparse.vstack([_guide(assembly, edge)[sliding] for edge in _fan(direction)]).tocsr()
    split = problem.cones.equalities
    imposed = sparse.vstack([problem.imposed_rows[:split], guided, problem.imposed_rows[split:]]).tocsr()
    cones = replace(problem.cones, inequalities=problem.cones.inequalities + guided.shape[0])
    free = np.repeat(assembly.blocks.free, imposed.shape[1] // len(assembly.blocks))
    speed, ends, seconds = 1.0, [], 0.0
    for sign in (1.0, -1.0):
        if assembly.has_live_load:
            live = sparse.csr_matrix(scaled_load(assembly, assembly.live_load))
            matrix = sparse.vstack([live, imposed[:, free]]).tocsr()
            offset = np.concatenate([[sign], np.zeros(imposed.shape[0])])
            answer = optimum(problem.power, matrix, offset, replace(cones, equalities=split + 1))
        else:
            speed, motion = support_motion(assembly, sign)
            answer = optimum(problem.power, imposed[:, free], imposed @ columns(assembly, motion), cones)
        ends.append(sign * _value(answer, problem.power) * (1.0 if assembly.has_live_load else assembly.weight * speed))
        seconds += answer.seconds
    return (ends[0], ends[1]), seconds


def _fan(direction: np.ndarray) -> list[np.ndarray]:
    """Directions (C, 1 or 2) that friction at a sliding point may oppose; in 3D a fan, for no more is known of it."""
    if direction.shape[1] == 1:
        return [direction]
    across = direction[:, ::-1] * [-1.0, 1.0]
    return [np.cos(turn) * direction + np.sin(turn) * across for turn in (-FAN, 0.0, FAN)]


def _guide(assembly: Assembly, direction: np.ndarray) -> sparse.csr_matrix:
    """Rows (C,) from all blocks' columns to (n - mu tau) . u at every contact point."""
    count, width = len(direction), direction.shape[1] + 1
    local = np.concatenate([np.ones((count, 1)), -assembly.points.friction[:, None] * direction], axis=1)
    rows = np.repeat(np.arange(count), width)
    pick = sparse.csr_matrix((local.ravel(), (rows, np.arange(count * width))), shape=(count, count * width))
    return (pick @ assembly.kinematic_matrix(assembly.length)).tocsr()


def _value(answer: ProgrammeAnswer, power: np.ndarray) -> float:
    """The optimum; minus infinity where no velocity fits, so that no force is limited; NaN where no state of force exists."""
    if answer.outcome is ProgrammeOutcome.OPTIMUM:
        return float(power @ answer.x)
    return -np.inf if answer.outcome is ProgrammeOutcome.EMPTY else float("nan")
