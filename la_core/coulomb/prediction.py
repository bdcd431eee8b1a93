"""Coulomb limit analysis: the reaction at collapse, or the collapse multiplier, with friction that does not dilate.

With rigid joints the plateau of such friction is not unique. The elasticity of the joints, however stiff, and the way from
rest select the physical one. The structure is therefore followed from rest along several quasi-static paths, which
differ in the viscosity that they begin with. The travel is doubled until the curve is flat. The answer is the certified
end of the finest path. Its uncertainty comes from the differences between the paths and from the rest of the curve.
"""

import math
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from la_core.coulomb import plateau
from la_core.coulomb.certificate import ACCEPTED_RESIDUAL, error_of_forces, mechanism_and_forces, without_closing
from la_core.coulomb.followed_path import LARGE, FollowedPath, PredictionSettings, Reporter, SharedProgress, follow_large
from la_core.coulomb.interval import ONE_VALUE, relative_width, stated_interval
from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.implicit_step import State
from la_core.coulomb.path.rest import come_to_rest, value_at_rest
from la_core.coulomb.path.tangent import Tangent
from la_core.coulomb.path.turning import STIFFER
from la_core.coulomb.release import released
from la_core.coulomb.several_paths import BROAD, disagree, joints_of_path, left_by_smoothing, on_one_plateau, stated_uncertainty
from la_core.coulomb.sharp_path import follow, with_peak
from la_core.coulomb.solution import CoulombSolution, reaching_to, without_answer
from la_core.limit import Solution, Status
from la_core.model import Assembly, JointStiffness
from la_core.side_by_side import side_by_side

# Largest distance of a value from the nearest end of its mechanism's interval, over the value, where blocks lock as they dilate. Of 66
# values that YADE confirmed none was farther than 0.10; a block against a step, whose value YADE did not confirm, was 0.45 away.
LOCKED_IN = 0.25
# Largest uncertainty of an answer, over the weight, or over the value where this is larger. Blocks that fall on one path leave an
# uncertainty of a million weights (`flat_arch` with a friction of 0.4); a row of blocks that jams between held ones, 1.2 times its value.
UNKNOWN = 100.0
# Factor by which the limits of a step are divided on one more path, where the value after a release is uncertain. Such a structure passes
# many states on its way, and all paths with the usual steps may end in one wrong state. On the wall that led to this rule a factor of
# 1.3 already showed that this state was wrong, and 3 led to the value of YADE.
FINER_STEPS = 3.0

Check = Callable[[np.ndarray, np.ndarray], None]


def predict(
    assembly: Assembly,
    stiffness: JointStiffness,
    associated: Solution,
    wedging: float = 0.0,
    settings: PredictionSettings | None = None,
    report: Reporter | None = None,
    as_given: bool = False,
    check: Check | None = None,
) -> CoulombSolution:
    """Follow the structure from rest to its plateau and return the state there.

    Parameters
    ----------
    assembly : Assembly
        Structure with its support motion or live load.
    stiffness : JointStiffness
        Stiffness of the joints, and the travel.
    associated : Solution
        Associated answer of the same assembly. The path is followed where it is SOLVED, and also where it is UNBOUNDED and the
        joints are elastic: blocks that lock as they dilate may move without dilatancy. Only a certain plateau is then an answer.
        Without an answer the prediction has no value, and the status of the associated answer.
    wedging : float
        Motion of the support against its settlement before gravity acts, m or rad.
    settings : PredictionSettings, optional
        Viscosities and steps.
    report : callable, optional
        Receives the progress of the paths.
    as_given : bool
        Whether finite rotations are those of joints with this stiffness, over the travel; if not, the path represents stiffer joints.
    check : callable, optional
        Receives the mechanism, shape (B, 6), and the contact forces (N), shape (C, 3), at the end of the coarsest path, before finer ones
        have ended. An exception that it raises ends the prediction.
    """
    has_bound = associated.status is Status.SOLVED
    may_move = associated.status is Status.UNBOUNDED and assembly.effects.elasticity != "none"
    if not (has_bound or may_move):
        return without_answer(assembly, associated.status)
    turning = 0.0 if assembly.effects.rotation == "small" else 1.0 if as_given else 1.0 / STIFFER
    solution = _followed_from_rest(assembly, stiffness, turning, wedging, settings or PredictionSettings(), report, check)
    if has_bound:
        return reaching_to(solution, associated.value, assembly.has_live_load)
    if solution.status is Status.SOLVED and not _is_locked_in(solution):
        return solution
    return without_answer(assembly, Status.UNBOUNDED, solution.seconds, solution.iterations)


def _is_held_back(solution: CoulombSolution, unit: float) -> bool:
    """Whether the multiplier of a plateau, or of one on the way, is negative: such a load holds back blocks that fall without it.

    The structure rests without the load. A load that grows from nothing never becomes negative, so the blocks fall before this plateau.
    unit: value whose scaled value is 1.
    """
    return solution.value < -solution.uncertainty or solution.plateaus.min(initial=0.0) < -plateau.LEAST * unit


def _is_locked_in(solution: CoulombSolution) -> bool:
    """Whether the value comes from stresses that the blocks locked in on their way: it is far from all known ends of its interval.

    False without a known end, because nothing then shows such stresses.
    """
    ends = [end for end in solution.interval if math.isfinite(end)]
    return bool(ends) and min(abs(end - solution.value) for end in ends) > LOCKED_IN * abs(solution.value)


def _followed_from_rest(
    assembly: Assembly,
    stiffness: JointStiffness,
    turning: float,
    wedging: float,
    settings: PredictionSettings,
    report: Reporter | None,
    check: Check | None,
) -> CoulombSolution:
    """Return the prediction of a structure that can stand. turning: see `ElasticJoints`; other parameters: see `predict`."""
    start = time.perf_counter()
    joints = ElasticJoints(assembly, stiffness, turning)
    tangent = Tangent(joints)
    rest, iterations = come_to_rest(joints, tangent, wedging / stiffness.travel)
    if rest is None:
        return _of_falling_blocks(assembly, start, iterations)
    progress = SharedProgress(joints, report, len(settings.viscosities), settings.with_release)
    followed = _paths(joints, tangent, rest, settings, progress, check) if len(joints.weights) <= LARGE else []
    iterations += sum(path.iterations for path in followed)
    if not followed or followed[-1].is_short:
        smooth = _smooth_paths(joints, -rest.progress, settings, report, check)
        iterations += sum(path.iterations for path in smooth)
        followed = smooth or followed
    if not followed:
        return without_answer(assembly, Status.FAILED, time.perf_counter() - start, iterations)
    solution = _answer(joints, stiffness, followed)
    if settings.with_release and not _falls(joints, solution) and not _has_one_value(joints, solution):
        solution, more = _with_release(joints, stiffness, tangent, rest, followed, solution, settings, progress)
        iterations += more
    if _falls(joints, solution):
        return _of_falling_blocks(assembly, start, iterations)
    if joints.live and not followed[-1].smooth_error:
        solution, more = with_peak(joints, tangent, rest, solution, stiffness.travel, settings, progress)
        iterations += more
    return replace(solution, at_rest=value_at_rest(joints, rest), seconds=time.perf_counter() - start, iterations=iterations)


def _has_one_value(joints: ElasticJoints, solution: CoulombSolution) -> bool:
    """Whether the mechanism of a solution allows its value alone; False where its interval is not stated."""
    return relative_width(solution.interval, solution.value, joints.value_in_units(1.0)) <= ONE_VALUE


def _with_release(
    joints: ElasticJoints,
    stiffness: JointStiffness,
    tangent: Tangent,
    rest: State,
    followed: list[FollowedPath],
    solution: CoulombSolution,
    settings: PredictionSettings,
    progress: SharedProgress,
) -> tuple[CoulombSolution, int]:
    """Return the answer of the paths with its value after a release, and the Newton iterations that this took.

    Where that value is doubtful although the paths end on one plateau, a finer path is added to those of the answer.
    """
    after = released(joints, stiffness, followed, settings, progress)
    iterations = after.iterations
    if after.is_doubtful and not disagree(followed) and not followed[-1].exhausted:
        finer = _finer_path(joints, tangent, rest, followed, settings, progress)
        iterations += 0 if finer is None else finer.iterations
        if finer is not None and not finer.exhausted:
            solution = _answer(joints, stiffness, [*followed, finer])
    return replace(solution, released=after.value, released_uncertainty=after.uncertainty, released_state=after.state), iterations


def _falls(joints: ElasticJoints, solution: CoulombSolution) -> bool:
    """Whether blocks fall on one path of a solution, or are held up only by a negative live load."""
    size = max(abs(joints.value_in_units(1.0)), abs(solution.value))
    return solution.uncertainty > UNKNOWN * size or (joints.live and _is_held_back(solution, joints.value_in_units(1.0)))


def _of_falling_blocks(assembly: Assembly, start: float, iterations: int) -> CoulombSolution:
    """Return a prediction without a value, and with an infinite uncertainty. start: reading of the clock at its start, s."""
    return replace(without_answer(assembly, Status.FAILED, time.perf_counter() - start, iterations), uncertainty=math.inf)


def _paths(
    joints: ElasticJoints, tangent: Tangent, rest: State, settings: PredictionSettings, progress: SharedProgress, check: Check | None
) -> list[FollowedPath]:
    """Follow paths with sharp joints, each at least as far as those before; return none where one of them cannot go on.

    After a path whose effort ends before its least travel no other path follows. See `joints_of_path`. check: see `predict`.
    """
    followed: list[FollowedPath] = []
    for number, viscosity in enumerate(settings.viscosities_in_turn, start=1):
        if number > len(settings.viscosities) and (not disagree(followed) or followed[-1].exhausted):
            break
        least = max((path.plateau.travel for path in followed), default=0.0)
        own = joints_of_path(joints, number, settings)
        one = follow(own, tangent, rest, viscosity, settings, least, progress.sender(viscosity, number))
        if one is None:
            return []
        followed.append(one)
        if one.is_short:
            break
        if check is not None and number == 1:
            check(*mechanism_and_forces(own, one.end))
    return followed


def _finer_path(
    joints: ElasticJoints,
    tangent: Tangent,
    rest: State,
    followed: list[FollowedPath],
    settings: PredictionSettings,
    progress: SharedProgress,
) -> FollowedPath | None:
    """Return one more path, in finer steps and with less viscosity; None where it cannot go on."""
    finer = replace(settings, finer=FINER_STEPS * settings.finer)
    viscosity, least = settings.viscosities_in_turn[-1], max(path.plateau.travel for path in followed)
    return follow(joints, tangent, rest, viscosity, finer, least, *progress.senders_of_more([viscosity]))


def _smooth_paths(
    joints: ElasticJoints, wedging: float, settings: PredictionSettings, report: Reporter | None, check: Check | None
) -> list[FollowedPath]:
    """Follow paths with smooth joints side by side, because they are independent; return none where one of them cannot begin.

    Where the smoothing leaves the value too uncertain for the judge of the comparison, a finer path follows. It counts if it comes
    to its end. check: see `predict`.
    """
    number = len(settings.viscosities)
    progress = SharedProgress(joints, report, number)

    def followed(path: int) -> FollowedPath | None:
        viscosity = settings.viscosities_in_turn[path - 1]
        own, send = joints_of_path(joints, path, settings), progress.sender(viscosity, path)
        one = follow_large(own, Tangent(joints), wedging, viscosity, settings, path >= number, send)
        if check is not None and path == 1 and one is not None:
            check(*mechanism_and_forces(own, one.end))
        return one

    made = side_by_side(followed, range(1, number + 1), progress.stop)
    paths = [path for path in made if path is not None]
    if len(paths) < number:
        return []
    last = paths[-1]
    if not last.exhausted and left_by_smoothing(last, paths) > plateau.EARLY * plateau.reference_size(last.plateau.value):
        finer = followed(number + 1)
        paths += [finer] if finer is not None and not finer.exhausted else []
    return paths


def _answer(joints: ElasticJoints, stiffness: JointStiffness, followed: list[FollowedPath]) -> CoulombSolution:
    """Answer from all paths: the finest path of the plateau that most paths end on."""
    alike = on_one_plateau(followed)
    own = next(k for k, path in enumerate(followed) if path is alike[0])
    alike = [replace(path, end=without_closing(joints, path.end)) for path in alike]
    chosen, is_smooth = alike[0], followed[-1].smooth_error > 0.0
    last, certificate = chosen.end.last, chosen.end.certificate
    value, unit = chosen.plateau.value, joints.value_in_units(1.0)
    met = np.array([*(path.plateau.value for path in followed), *chosen.on_the_way])
    others = [] if is_smooth else [float(met[group].mean()) for group in plateau.groups(met.tolist()) if own not in group]
    twists, forces = mechanism_and_forces(joints, chosen.end)
    uncertainty = stated_uncertainty(chosen, followed) + error_of_forces(joints, chosen.end) / unit
    still_smooth = chosen.exhausted and is_smooth  # a path that was cut short before its joints became sharp
    certified = certificate.worst <= ACCEPTED_RESIDUAL and not (chosen.is_short or still_smooth)
    certain = uncertainty <= BROAD * plateau.reference_size(value)
    mechanisms = [(path.end.before, path.end.last) for path in alike]
    low, high = stated_interval(joints, mechanisms, value, uncertainty)
    return CoulombSolution(
        Status.SOLVED if certified and certain else Status.INACCURATE,
        value * unit,
        (low * unit, high * unit),
        twists,
        forces,
        at_rest=float("nan"),
        drift=chosen.plateau.change / plateau.reference_size(value),
        dilatancy_residual=certificate.parting,
        strain_residual=certificate.power,
        equilibrium_residual=certificate.equilibrium,
        cone_violation=certificate.cone,
        seconds=0.0,
        iterations=0,
        steps=sum(len(path.progress) - 1 for path in followed),
        uncertainty=uncertainty * unit,
        plateaus=np.array([value, *others] if others else []) * unit,
        sliding_residual=certificate.sliding,
        travel=last.progress,
        viscosities=np.array([path.viscosity for path in followed]),
        path_settlement=chosen.progress * stiffness.travel,
        path_value=chosen.values * unit,
    )
