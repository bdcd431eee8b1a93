"""Coulomb limit analysis: the reaction at collapse, or the collapse multiplier, with friction that does not dilate.

With rigid joints the plateau of such friction is not unique. The elasticity of the joints, however stiff, and the way from
rest select the physical one. The structure is therefore followed from rest along several quasi-static paths, which
differ in the viscosity that they begin with. The travel is doubled until the curve is flat. The answer is the certified
end of the finest path; what the paths and the rest of the curve leave open is its uncertainty.
"""

import time
from dataclasses import dataclass, replace

import numpy as np

from la_core.coulomb import plateau
from la_core.coulomb.certificate import ACCEPTED_RESIDUAL, Certificate, certified_end, certify, limit_state_near
from la_core.coulomb.elastic_joints import ElasticJoints
from la_core.coulomb.implicit_step import State
from la_core.coulomb.interval import stated_interval
from la_core.coulomb.path_progress import Reporter, Sender, sender
from la_core.coulomb.plateau import Plateau
from la_core.coulomb.quasi_static_path import Falling, QuasiStaticPath, come_to_rest, first_travel
from la_core.coulomb.solution import CoulombSolution, without_answer
from la_core.coulomb.tangent import Tangent
from la_core.limit import Drive, Solution, Status
from la_core.model import Assembly, JointStiffness, global_forces, support_motion, twists_of

# Of the travel, where the curve is not flat. Far along the path steps are long: on a leaning wall whose curve was flat after 64 travels,
# six doublings took 988 iterations and four, which left an uncertainty of 1.6 %, took 981.
MOST_DOUBLINGS = 6
ANNEALED = 0.5  # of the first travel: from here on the viscosity keeps its last value
LAST_VISCOSITY = 1e-6  # after annealing
# Unknowns of a large structure. Its joints are smooth at first, because their instabilities would take most of the time: a wall
# of 1,024 blocks took 250 steps of sharp joints to a twelfth of the travel, and 20 of smooth ones to all of it.
LARGE = 2500.0
BIG = 1000.0  # unknowns beyond which the first viscosities grow as the square of the size, and the last as the square of that
# Over the first viscosity: force over which joints part and slip at first, in mean contact forces; the force at the end; the
# stretch on which they become sharp, over the travel before.
SMOOTH, SMOOTH_END, SHARPENED = 3000.0, 1e-2, 0.3
MORE_VISCOUS, LAST_OF_SMOOTH = 10.0, 1e-3  # first viscosity over that of a small structure; viscosity after annealing
MORE_EFFORT = 2.0  # iterations of a path over those of a small structure of this size
# Times its last change: what a curve that is not flat may still change. On a wall of 1,024 blocks every doubling of the travel
# changed it by about three quarters of the change before; such changes add up to three times the last one.
UNFINISHED = 3.0
# Times the difference between paths of large structures, whose smoothing differs tenfold: on a wall of 60 blocks, mu 0.3, a smoothing
# of 30, 10, 3, 1 and 0.3 mean contact forces gave 0.463, 0.461, 0.457, 0.449 and 0.446 W, and sharp joints 0.442 W.
SMOOTHED = 5.0
END_STRETCH = 0.1  # most travel of the last stretch, to the certified end, over that of the path
# Of the value: what settings that should not matter change. On `wall_third` two ways of the viscosity gave 0.070328 and 0.070310.
STEPS_SHARE = 3e-4
SAFETY = 2.0  # times the difference between the two finest paths
BROAD = 0.25  # of the value: an answer with a larger uncertainty is not called solved


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
    rounded: float = float("nan")  # value where the smoothing was ten times that of the end, of smooth joints

    @classmethod
    def on(
        cls,
        path: QuasiStaticPath,
        curve: tuple[np.ndarray, np.ndarray],
        ended: tuple[State, State, Certificate],
        value: float,
        exhausted: bool,
        rounded: float = float("nan"),
    ) -> "_Followed":
        """Path with its curve before the last stretch, and the end of that stretch with its value."""
        (progress, values), (before, last, certificate) = curve, ended
        found = plateau.plateau_of(progress, values, progress[-1], value)
        first = path.viscosity.first
        return cls(found, certificate, before, last, progress, values, path.iterations, first, exhausted, rounded)


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
    for number, viscosity in enumerate((*settings.viscosities, settings.viscosities[-1] / 10.0), start=1):
        if number > len(settings.viscosities) and ((len(joints.weights) > LARGE) or not _disagree(followed) or followed[-1].exhausted):
            break
        send = sender(joints, report, viscosity, number, max(number, len(settings.viscosities)))
        if len(joints.weights) > LARGE:
            is_finest = number == len(settings.viscosities)
            one = _follow_large(joints, tangent, -rest.progress, viscosity, settings, is_finest, send)
        else:
            least = max((path.plateau.travel for path in followed), default=0.0)
            one = _follow(joints, tangent, rest, viscosity, settings, least, send)
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


def _follow(
    joints: ElasticJoints, tangent: Tangent, rest: State, first: float, settings: PredictionSettings, least_travel: float, send: Sender
) -> _Followed | None:
    """Follow one path with a first viscosity until its curve is flat, and to a certified end; None where it cannot go on."""
    end = first_travel(joints)
    least, longest = max(end, least_travel), 2.0**settings.doublings * end
    more = max(len(joints.weights) / BIG, 1.0) ** 2
    viscosity = Falling(more * first, min(more * first, more**2 * LAST_VISCOSITY), ANNEALED * end)
    path = QuasiStaticPath(joints, tangent, rest, viscosity, settings.finer)
    while True:
        for point in path.advance_to(end, _effort(joints, settings)):
            send(point.progress, end, point.value)
        reached, progress, values = path.last.progress, *path.curve
        is_last = reached < end or end >= longest
        if reached > 0.0 and (is_last or (end >= least and plateau.plateau_of(progress, values, end, values[-1]).is_flat)):
            ended = certified_end(path, END_STRETCH * reached)
            if is_last or ended[2].worst <= ACCEPTED_RESIDUAL:
                break
        if is_last:
            return None
        end *= 2.0
    return _Followed.on(path, (progress, values), ended, path.value(ended[1]), reached < end)


def _follow_large(
    joints: ElasticJoints, tangent: Tangent, wedging: float, first: float, settings: PredictionSettings, is_finest: bool, send: Sender
) -> _Followed | None:
    """Follow a path with smooth joints over the first travel, then with joints that become sharp.

    The finest path goes on to the limit state near its end; a coarser one only shows what the viscosity changes. None where the
    path cannot begin.
    """
    middle = first_travel(joints)
    end = (1.0 + SHARPENED) * middle
    force = 1.0 / len(joints.friction)  # mean contact force
    smoothing = Falling(SMOOTH * first * force, SMOOTH_END * force, end, middle)
    viscosity = Falling(MORE_VISCOUS * first, min(MORE_VISCOUS * first, LAST_OF_SMOOTH), middle)
    rest, _ = come_to_rest(joints, tangent, wedging, smoothing.first)
    if rest is None:
        return None
    path = QuasiStaticPath(joints, tangent, rest, viscosity, settings.finer, smoothing)
    for point in path.advance_to(end, MORE_EFFORT * _effort(joints, settings)):
        send(point.progress, end, point.value)
    reached, progress, values = path.last.progress, *path.curve
    if reached == 0.0:
        return None
    smooth = values[np.array([smoothing.at(point) > 10.0 * smoothing.last for point in progress])]
    rounded = float(smooth[-1]) if len(smooth) else float("nan")
    if is_finest:
        ended = limit_state_near(path)
        return _Followed.on(path, (progress, values), ended, path.value(ended[1]), reached < end, rounded)
    ended = path.before, path.last, certify(joints, path.before, path.last)
    return _Followed.on(path, (progress, values), ended, float(values[-1]), reached < end, rounded)


def _effort(joints: ElasticJoints, settings: PredictionSettings) -> float:
    """Most Newton iterations of a path."""
    return settings.effort / float(np.sqrt(len(joints.weights)))


def _disagree(followed: list[_Followed]) -> bool:
    """Whether the paths end on different plateaus."""
    return len(plateau.groups([path.plateau.value for path in followed])) > 1


def _answer(joints: ElasticJoints, stiffness: JointStiffness, followed: list[_Followed]) -> CoulombSolution:
    """Answer from all paths: the finest path of the plateau that most paths end on."""
    assembly = joints.assembly
    groups = [list(range(len(followed)))] if (len(joints.weights) > LARGE) else plateau.groups([path.plateau.value for path in followed])
    most = max(groups, key=lambda group: (len(group), max(group)))
    chosen = followed[max(most)]
    value, uncertainty = chosen.plateau.value, _uncertainty(chosen, followed)
    several = [float(np.mean([followed[i].plateau.value for i in group])) for group in groups] if len(groups) > 1 else []
    stride = chosen.last.progress - chosen.before.progress
    speed, motion = support_motion(assembly, (Drive.LIVE if joints.live else Drive.YIELDING).value)
    twists = twists_of(assembly, (chosen.last.blocks - chosen.before.blocks) / stride) + motion
    still_smooth = chosen.exhausted and np.isfinite(chosen.rounded)  # a path that was cut short before its joints became sharp
    reached = chosen.last.progress >= first_travel(joints) and not still_smooth
    certified = chosen.certificate.worst <= ACCEPTED_RESIDUAL and reached
    certain = uncertainty <= BROAD * plateau.reference_size(value)
    unit = joints.value_in_units(1.0)
    mechanisms = [(path.before, path.last) for path in (chosen, *(followed[i] for i in most if followed[i] is not chosen))]
    low, high = stated_interval(joints, mechanisms, value, uncertainty)
    return CoulombSolution(
        Status.SOLVED if certified and certain else Status.INACCURATE,
        value * unit,
        (low * unit, high * unit),
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


def _uncertainty(chosen: _Followed, followed: list[_Followed]) -> float:
    """Largest of what the paths differ by, what the curve still changes by, how it scatters and what its steps leave, scaled."""
    end, values = chosen.plateau, [path.plateau.value for path in followed]
    if np.isfinite(chosen.rounded):  # of smooth joints: what the smoothing and the last move to the limit state change
        return SMOOTHED * max(abs(end.value - other) for other in (chosen.rounded, chosen.values[-1], *values))
    if len(plateau.groups(values)) > 1:
        differ = max(abs(end.value - value) for value in values)
    else:
        near = followed[-2:]
        differ = SAFETY * max(max(abs(end.value - path.plateau.value), abs(end.mean - path.plateau.mean)) for path in near)
    change = end.change if end.is_flat else UNFINISHED * end.change
    return float(np.nanmax([differ, change, end.scatter, STEPS_SHARE * abs(end.value)]))
