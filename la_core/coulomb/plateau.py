"""Coulomb limit analysis: the reaction at collapse, or the collapse multiplier, with friction that does not dilate.

The rigid plateau of such friction is not unique; the elasticity of the joints, however stiff, selects the physical one
(mechanics behind it: `la_core.coulomb.elastic_joints`). From rest under gravity the support moves, or the live load grows, in a few
steps of geometric progression, from the first strain of the joints to a travel of many times that, where the mechanism carries on with no
further change in force.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from la_core.coulomb.elastic_joints import ElasticJoints
from la_core.coulomb.fixed_point import DILATANCY, Step, advance
from la_core.coulomb.interval import reaction_interval
from la_core.limit import Drive, Solution, Status
from la_core.measures import mechanism, residuals
from la_core.model import Assembly, JointStiffness, global_forces, support_motion, twists_of

STEPS = 8  # to the plateau; tests/benchmarks/benchmark_friction.py shows what fewer and more cost and bring
FIRST_SAGS = 6.0  # travel of the first step over the elastic sag: joints are strained, few have slid
SOFTEST = 0.05  # sag over the travel: the strain of softer joints passes for a mechanism
DRIFT = 0.1  # largest change of the value over the last step: what changes more has no plateau within the travel
ACCEPTED_RESIDUAL = 1e-5  # equilibrium and cone residuals, of the mean block weight: far below what friction's history leaves open


@dataclass(frozen=True)
class PredictionSettings:
    """Steps of a prediction.

    steps: from rest to the whole travel. first_sags: travel of the first step over the elastic sag.
    """

    steps: int = STEPS
    first_sags: float = FIRST_SAGS


@dataclass(frozen=True)
class CoulombSolution:
    """Answer of Coulomb limit analysis with its evidence. Undefined numbers are NaN.

    value: reaction in N (N m for a rotation) or multiplier. interval: least and greatest value that the mechanism allows.
    twists (B, 6): mechanism for the support's unit motion, or for unit power of the unit live load. forces (C, 3): on b, N, global.
    at_rest: reaction before the support moves, 0 for a live load. drift: relative change of the value over the last step.
    dilatancy_residual: work of the dilation that is left, sum of n |mu |slip| - s|, over the work put in by the weights that settle
    and by a support that has to be pulled, or the live load, in the last step. strain_residual: the same work over the elastic
    energy of the joints.
    equilibrium_residual, cone_violation: over the mean free-block weight. iterations: associated programmes solved. steps: from rest
    to the plateau as asked for, twice as many where the iteration did not converge in these; 0 without a value.
    """

    status: Status
    value: float
    interval: tuple[float, float]
    twists: np.ndarray
    forces: np.ndarray
    at_rest: float
    drift: float
    dilatancy_residual: float
    strain_residual: float
    equilibrium_residual: float
    cone_violation: float
    seconds: float
    iterations: int
    steps: int = 0


def predict(
    assembly: Assembly,
    stiffness: JointStiffness,
    associated: Solution,
    wedging: float = 0.0,
    settings: PredictionSettings | None = None,
) -> CoulombSolution:
    """Follow the structure from rest to its plateau; where the associated answer has no value, neither has this.

    wedging: m or rad, a motion of the support against its settlement before gravity acts.
    """
    settings = settings or PredictionSettings()
    if associated.status is not Status.SOLVED:
        return _without_value(assembly, associated.status)
    joints = ElasticJoints(assembly, stiffness)
    first = min(0.5, settings.first_sags * stiffness.sag / joints.unit)
    best: CoulombSolution | None = None
    for count in (settings.steps, 2 * settings.steps):  # shorter steps where the iteration does not converge
        stations = np.geomspace(1.0, first, count)[::-1]  # a single step goes the whole way
        followed = list(follow(joints, stations, stiffness, wedging))
        if followed[-1].trial.solved and len(followed) > count:
            solution = _with_evidence(joints, followed)
            if best is None or solution.status is Status.SOLVED or solution.strain_residual < best.strain_residual:
                best = solution
        if best is not None and best.status is Status.SOLVED:
            break
    if best is None:
        return _without_value(assembly, Status.FAILED, joints)
    soft = stiffness.sag > SOFTEST * joints.unit and best.status is Status.SOLVED
    status = Status.INACCURATE if soft else best.status
    return replace(best, status=status, seconds=joints.seconds, iterations=joints.solves, steps=settings.steps)


def reaction_at_rest(assembly: Assembly, stiffness: JointStiffness, wedging: float = 0.0) -> float:
    """Reaction (N or N m) before the support moves, or 0 for a live load; NaN where the blocks do not come to rest."""
    joints = ElasticJoints(assembly, stiffness)
    step = next(follow(joints, np.zeros(0), stiffness, wedging))
    return value_of(joints, step) if step.trial.solved else float("nan")


def follow(
    joints: ElasticJoints, stations: np.ndarray, stiffness: JointStiffness, wedging: float = 0.0, most_solves: int | None = None
) -> Iterator[Step]:
    """Rest under gravity, then one step to each of the `stations` (rising, over the travel); ends early where a step fails.

    The shift of a step is foretold by that of the one before, as if the mechanism went on.
    """
    wedged = -wedging / stiffness.travel
    nothing = np.zeros(len(joints.assembly.points))
    step = advance(joints, joints.laid, wedged * joints.motion, None, 0.0, nothing, most_solves=most_solves)
    yield step
    start = joints.live_displacement(step.trial.blocks)
    rate = np.zeros_like(step.shift)
    for station in stations:
        if not step.trial.solved:
            return
        stride = station - step.progress
        motion, live = (wedged + station) * joints.motion, start + station if joints.live else None
        last_from = step if station == stations[-1] else None
        step = advance(joints, step.joints, motion, live, station, rate * stride, last_from, most_solves)
        rate = step.shift / stride
        yield step


def value_of(joints: ElasticJoints, step: Step) -> float:
    """Reaction (N or N m) or multiplier at the end of a step."""
    if joints.live:
        return joints.value(step.trial)
    return joints.value(step.trial) * joints.assembly.weight * joints.assembly.support_speed


def _with_evidence(joints: ElasticJoints, steps: list[Step]) -> CoulombSolution:
    assembly, (before, last) = joints.assembly, steps[-2:]
    drive = Drive.LIVE if joints.live else Drive.YIELDING
    stride = last.progress - before.progress
    speed, motion = support_motion(assembly, drive.value)
    twists = twists_of(assembly, (last.trial.blocks - before.trial.blocks) / stride) + motion
    value = value_of(joints, last)
    forces = global_forces(assembly, last.joints.force)
    twists = twists * (1.0 / assembly.weight if joints.live else speed)
    dilatancy = last.dilation / joints.work(last.trial, before.trial, stride)
    worst = (
        residuals.equilibrium_residual(assembly, forces, value if joints.live else 0.0),
        residuals.cone_violation(assembly, forces),
    )
    unit = max(abs(value), 1e-6 if joints.live else 1e-6 * assembly.weight * speed)
    drift = (value - value_of(joints, before)) / unit
    converged = last.converged and dilatancy <= DILATANCY and max(worst) <= ACCEPTED_RESIDUAL and abs(drift) <= DRIFT
    interval = reaction_interval(joints, before, last)
    return CoulombSolution(
        Status.SOLVED if converged else Status.INACCURATE,
        value,
        interval,
        twists,
        forces,
        at_rest=value_of(joints, steps[0]),
        drift=drift,
        dilatancy_residual=dilatancy,
        strain_residual=last.strain_residual,
        equilibrium_residual=worst[0],
        cone_violation=worst[1],
        seconds=joints.seconds,
        iterations=joints.solves,
    )


def without_sliding(assembly: Assembly, associated: Solution, seconds: float, solves: int) -> CoulombSolution:
    """The associated answer as Coulomb's, where no joint slides: nothing dilates, and its mechanism leaves the value no interval.

    seconds, solves: of the look for sliding. The value at rest is not known: nobody needs it.
    """
    if associated.status is not Status.SOLVED:
        return _without_value(assembly, associated.status)
    nan = float("nan")
    return CoulombSolution(
        Status.SOLVED,
        associated.value,
        (associated.value, associated.value),
        associated.twists,
        associated.forces,
        at_rest=nan,
        drift=nan,
        dilatancy_residual=mechanism.sliding_share(assembly, associated.twists, associated.forces),
        strain_residual=nan,
        equilibrium_residual=associated.equilibrium_residual,
        cone_violation=associated.cone_violation,
        seconds=seconds,
        iterations=solves,
    )


def _without_value(assembly: Assembly, status: Status, joints: ElasticJoints | None = None) -> CoulombSolution:
    nan = float("nan")
    twists, forces = np.full((len(assembly.blocks), 6), nan), np.full((len(assembly.points), 3), nan)
    seconds, solves = (joints.seconds, joints.solves) if joints else (0.0, 0)
    return CoulombSolution(status, nan, (nan, nan), twists, forces, nan, nan, nan, nan, nan, nan, seconds, solves)
