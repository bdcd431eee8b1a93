"""Coulomb limit analysis: the reaction at collapse, or the collapse multiplier, with friction that does not dilate.

With rigid joints the plateau of such friction is not unique. The elasticity of the joints, however stiff, and the way from
rest select the physical one. The structure is therefore followed from rest along several quasi-static paths, which
differ in the viscosity that they begin with. The travel is doubled until the curve is flat. The answer is the certified
end of the finest path; what the paths and the rest of the curve leave open is its uncertainty.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from la_core.coulomb import plateau
from la_core.coulomb.certificate import Certificate, certify, joint_rates
from la_core.coulomb.elastic_joints import ElasticJoints
from la_core.coulomb.implicit_step import State
from la_core.coulomb.interval import THRESHOLDS, reaction_interval
from la_core.coulomb.path_progress import PathProgress
from la_core.coulomb.plateau import Plateau
from la_core.coulomb.quasi_static_path import QuasiStaticPath, Viscosity, come_to_rest
from la_core.coulomb.solution import CoulombSolution, without_answer
from la_core.coulomb.tangent import Tangent
from la_core.limit import Drive, Solution, Status
from la_core.model import Assembly, JointStiffness, global_forces, support_motion, twists_of

ACCEPTED_RESIDUAL = 1e-5  # every residual of the certified end
SAGS = 300.0  # least travel over the elastic sag: the strain of the joints must not pass for a mechanism
MOST_DOUBLINGS = 4  # of the travel, where the curve is not flat
ANNEALED = 0.5  # of the first travel: from here on the viscosity keeps its last value
LAST_VISCOSITY, END_VISCOSITY = 1e-6, 1e-9  # after annealing; of the last stretch, to the certified end
# Unknowns of a large structure. Instabilities on the way grow with size, and each takes steps in proportion to 1/viscosity; beyond
# this size the first viscosities grow as the square of the size, up to MOST_VISCOUS times, and the last one as the square of that.
LARGE, MOST_VISCOUS = 1000.0, 100.0
# Times its last change: what a curve that is not flat may still change. On a wall of 1,024 blocks every doubling of the travel
# changed it by about three quarters of the change before; such changes add up to three times the last one.
UNFINISHED = 3.0
END_STRETCH, END_ITERATIONS = 0.1, 0.1  # most travel and iterations of the last stretch, over those of the whole path
LEAST_END_ITERATIONS, END_STEPS = 200, 20
# Of the value: what settings that should not matter change. On `wall_third` a falling and a constant viscosity gave 0.070328 and 0.070310.
STEPS_SHARE = 3e-4
SAFETY = 2.0  # times the difference between the two finest paths
BROAD = 0.25  # of the value: an answer with a larger uncertainty is not called solved
Reporter = Callable[[PathProgress], None]


@dataclass(frozen=True)
class PredictionSettings:
    """Accuracy of a prediction.

    Attributes
    ----------
    viscosities : tuple of float
        First viscosity of each path, in multiples of the weight at unit rate, the coarsest path first; more for large
        structures. Where paths disagree, one with a tenth of the least viscosity follows, if the effort allows.
    finer : float
        Factor by which the limits of a step are divided.
    effort : float
        Newton iterations of one path times the square root of the unknowns, after which the path ends, flat or not.
    doublings : int
        How often the travel may be doubled where the curve is not flat.
    """

    viscosities: tuple[float, ...] = (1e-2, 1e-3)
    finer: float = 1.0
    effort: float = 2e5
    doublings: int = MOST_DOUBLINGS


@dataclass(frozen=True)
class _Followed:
    """One path that was followed to its end."""

    plateau: Plateau
    certificate: Certificate
    before: State
    last: State
    progress: np.ndarray
    values: np.ndarray
    iterations: int
    viscosity: float
    exhausted: bool


def predict(
    assembly: Assembly,
    stiffness: JointStiffness,
    associated: Solution,
    wedging: float = 0.0,
    settings: PredictionSettings | None = None,
    report: Reporter | None = None,
) -> CoulombSolution:
    """Follow the structure from rest to its plateau and return the state there.

    Parameters
    ----------
    assembly : Assembly
        Structure with its support motion or live load.
    stiffness : JointStiffness
        Stiffness of the joints, and the travel.
    associated : Solution
        Associated answer of the same assembly; without a value the prediction has none either, and the same status.
    wedging : float
        Motion of the support against its settlement before gravity acts, m or rad.
    settings : PredictionSettings, optional
        Viscosities and steps.
    report : callable, optional
        Receives the progress of the paths.
    """
    if associated.status is not Status.SOLVED:
        return without_answer(assembly, associated.status)
    start, settings = time.perf_counter(), settings or PredictionSettings()
    joints = ElasticJoints(assembly, stiffness)
    tangent = Tangent(joints)
    rest, iterations = come_to_rest(joints, tangent, wedging / stiffness.travel)
    if rest is None:
        return without_answer(assembly, Status.FAILED, time.perf_counter() - start, iterations)
    followed: list[_Followed] = []
    for viscosity in (*settings.viscosities, settings.viscosities[-1] / 10.0):
        if len(followed) >= len(settings.viscosities) and (not _disagree(followed) or followed[-1].exhausted):
            break
        least = max((path.plateau.travel for path in followed), default=0.0)
        place = (len(followed) + 1, len(settings.viscosities))
        one = _follow(joints, tangent, rest, viscosity, settings, least, _reporter(joints, report, viscous(joints) * viscosity, place))
        if one is None:
            return without_answer(assembly, Status.FAILED, time.perf_counter() - start, iterations)
        followed.append(one)
    iterations += sum(path.iterations for path in followed)
    solution = _answer(joints, stiffness, followed)
    return replace(solution, at_rest=_value_at_rest(joints, rest), seconds=time.perf_counter() - start, iterations=iterations)


def reaction_at_rest(assembly: Assembly, stiffness: JointStiffness, wedging: float = 0.0) -> float:
    """Reaction (N or N m) before the support moves, or 0 for a live load; NaN where the blocks do not come to rest.

    wedging: motion of the support against its settlement before gravity acts, m or rad.
    """
    joints = ElasticJoints(assembly, stiffness)
    rest, _ = come_to_rest(joints, Tangent(joints), wedging / stiffness.travel)
    return float("nan") if rest is None else _value_at_rest(joints, rest)


def _value_at_rest(joints: ElasticJoints, rest: State) -> float:
    return 0.0 if joints.live else joints.value_in_units(joints.reaction(rest.joints.force))


def first_travel(joints: ElasticJoints) -> float:
    """Travel that a path is followed for before its curve is judged: the whole travel, and SAGS elastic sags."""
    return max(1.0, SAGS * joints.sag)


def viscous(joints: ElasticJoints) -> float:
    """Factor of the first viscosities: 1, and more for large structures."""
    return float(np.clip((len(joints.weights) / LARGE) ** 2, 1.0, MOST_VISCOUS))


def _reporter(
    joints: ElasticJoints, report: Reporter | None, viscosity: float, place: tuple[int, int]
) -> Callable[[float, float, float], None]:
    """Function that reports progress, end of the travel and scaled value of one path."""
    number, count = place[0], max(place)

    def send(progress: float, end: float, value: float) -> None:
        if report is not None:
            share = (number - 1 + min(progress / end, 1.0)) / count
            report(PathProgress(progress, share, joints.value_in_units(value), viscosity, number, count))

    return send


def _follow(
    joints: ElasticJoints,
    tangent: Tangent,
    rest: State,
    first: float,
    settings: PredictionSettings,
    least_travel: float,
    send: Callable[[float, float, float], None],
) -> _Followed | None:
    """Follow one path until its curve is flat, and to a certified end; None where it cannot go on."""
    end = first_travel(joints)
    least, longest = max(end, least_travel), 2.0**settings.doublings * end
    more = viscous(joints)
    viscosity = Viscosity(more * first, min(more * first, more**2 * LAST_VISCOSITY), ANNEALED * end)
    path = QuasiStaticPath(joints, tangent, rest, viscosity, settings.finer)
    most = settings.effort / float(np.sqrt(len(joints.weights)))
    while True:
        for point in path.advance_to(end, most):
            send(point.progress, end, point.value)
        progress, values = _curve(path)
        reached = path.last.progress
        if reached == 0.0:
            return None
        is_last = reached < end or end >= longest
        if is_last or (end >= least and plateau.plateau_of(progress, values, end, values[-1]).is_flat):
            before, last, certificate = _certified_end(path, END_STRETCH * reached)
            if is_last or certificate.worst <= ACCEPTED_RESIDUAL:
                break
        end *= 2.0
    found = plateau.plateau_of(progress, values, reached, path.value(last))
    return _Followed(found, certificate, before, last, progress, values, path.iterations, more * first, reached < end)


def _curve(path: QuasiStaticPath) -> tuple[np.ndarray, np.ndarray]:
    return np.array([point.progress for point in path.points]), np.array([point.value for point in path.points])


def _certified_end(path: QuasiStaticPath, stretch: float) -> tuple[State, State, Certificate]:
    """Go on with hardly any drag until the state is a limit state; otherwise return the step that comes closest."""
    best = (path.before, path.last, certify(path.joints, path.before, path.last))
    most = path.iterations + max(END_ITERATIONS * path.iterations, LEAST_END_ITERATIONS)
    for _ in path.advance_to(path.last.progress + stretch, most, END_VISCOSITY, stretch / END_STEPS):
        certificate = certify(path.joints, path.before, path.last)
        if certificate.worst < best[2].worst:
            best = (path.before, path.last, certificate)
        if certificate.worst <= ACCEPTED_RESIDUAL / 10.0:
            break
    return best


def _disagree(followed: list[_Followed]) -> bool:
    """Whether the paths end on different plateaus."""
    return len(plateau.groups([path.plateau.value for path in followed])) > 1


def _answer(joints: ElasticJoints, stiffness: JointStiffness, followed: list[_Followed]) -> CoulombSolution:
    """Answer from all paths: the finest path of the plateau that most paths end on."""
    assembly = joints.assembly
    groups = plateau.groups([path.plateau.value for path in followed])
    most = max(groups, key=lambda group: (len(group), max(group)))
    chosen = followed[max(most)]
    value, uncertainty = chosen.plateau.value, _uncertainty(chosen, followed)
    several = [float(np.mean([followed[i].plateau.value for i in group])) for group in groups] if len(groups) > 1 else []
    stride = chosen.last.progress - chosen.before.progress
    speed, motion = support_motion(assembly, (Drive.LIVE if joints.live else Drive.YIELDING).value)
    twists = twists_of(assembly, (chosen.last.blocks - chosen.before.blocks) / stride) + motion
    certified = chosen.certificate.worst <= ACCEPTED_RESIDUAL and chosen.last.progress >= first_travel(joints)
    certain = uncertainty <= BROAD * plateau.reference_size(value)
    unit = joints.value_in_units(1.0)
    return CoulombSolution(
        Status.SOLVED if certified and certain else Status.INACCURATE,
        value * unit,
        _interval(joints, chosen, [followed[i] for i in most], uncertainty),
        twists * (1.0 / (assembly.weight * joints.live_size) if joints.live else speed),
        global_forces(assembly, chosen.last.joints.force),
        at_rest=float("nan"),
        drift=chosen.plateau.change / plateau.reference_size(value),
        dilatancy_residual=chosen.certificate.parting,
        strain_residual=chosen.certificate.power,
        equilibrium_residual=chosen.certificate.equilibrium,
        cone_violation=chosen.certificate.cone,
        seconds=0.0,
        iterations=0,
        steps=sum(len(path.progress) - 1 for path in followed),
        uncertainty=uncertainty * unit,
        plateaus=np.array(several) * unit,
        sliding_residual=chosen.certificate.sliding,
        travel=chosen.last.progress,
        viscosities=np.array([path.viscosity for path in followed]),
        path_settlement=chosen.progress * stiffness.travel,
        path_value=chosen.values * unit,
    )


def _interval(joints: ElasticJoints, chosen: _Followed, alike: list[_Followed], uncertainty: float) -> tuple[float, float]:
    """Interval of the mechanism in units; NaN where it moves with the threshold or the path, or does not contain the value."""
    unit = joints.value_in_units(1.0)

    def ends(path: _Followed, threshold: float) -> np.ndarray:
        return np.array(reaction_interval(joints, joint_rates(joints, path.before, path.last), path.last.joints, threshold)) / unit

    low, high = stated = ends(chosen, THRESHOLDS[0])
    others = [ends(chosen, THRESHOLDS[1]), *(ends(path, THRESHOLDS[0]) for path in alike if path is not chosen)]
    allowed = plateau.ALIKE * plateau.reference_size(chosen.plateau.value)
    near = [np.isclose(other, stated, rtol=0.0, atol=allowed).all() for other in others]  # two infinite ends are the same
    holds = low - uncertainty <= chosen.plateau.value <= high + uncertainty
    return (low * unit, high * unit) if holds and all(near) else (float("nan"), float("nan"))


def _uncertainty(chosen: _Followed, followed: list[_Followed]) -> float:
    """Largest of what the paths differ by, what the curve still changes by, how it scatters and what its steps leave, scaled."""
    end, values = chosen.plateau, [path.plateau.value for path in followed]
    if len(plateau.groups(values)) > 1:
        differ = max(abs(end.value - value) for value in values)
    else:
        near = followed[-2:]
        differ = SAFETY * max(max(abs(end.value - path.plateau.value), abs(end.mean - path.plateau.mean)) for path in near)
    change = end.change if end.is_flat else UNFINISHED * end.change
    return float(np.nanmax([differ, change, end.scatter, STEPS_SHARE * abs(end.value)]))
