"""The rungs of `crosscheck cost` in limit analysis: methods and settings that trade time for accuracy."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

from la_core.analysis import drives, smallest_inset, wedging
from la_core.coulomb import PredictionSettings, follow_path, predict
from la_core.limit import ACCEPTED, solve_associated, solve_linearised, solve_sequentially
from la_core.model import Assembly, JointStiffness, assemble, joint_stiffness, with_grid
from la_core.scene import Scene

TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
FACETS = (4, 8, 16, 32, 64)
VISCOSITIES = (1e-1, 1e-2, 1e-3, 1e-4)  # first viscosity of a single path
FINER = (2.0, 10.0)  # times shorter steps
DOUBLINGS = (0, 2, 4)  # of the travel
INCREMENTS = (2, 5, 10, 25, 50)
INSETS = (0.005, 0.002, 0.001, 0.0005, 0.0002, 0.0001)  # m
LARGEST_INSET = 10.0  # times the smallest inset that both methods share: it fits into the narrowest interface
POINTS_PER_SIDE = {True: (2, 3, 5), False: (2, 3)}  # True for a plane scene
ASSOCIATED, PREDICTION = "associated", "prediction"


@dataclass(frozen=True)
class MethodOutcome:
    """Result of one run.

    Attributes
    ----------
    value : float
        Reaction (N; N m for a rotation) or multiplier; NaN where undefined.
    status : str
        How the run ended.
    build, solve : float
        Seconds to build the model and to solve it.
    uncertainty : float
        Uncertainty that the method states itself, in the unit of `value`; NaN where it states none.
    """

    value: float
    status: str
    build: float
    solve: float
    uncertainty: float = float("nan")


@dataclass(frozen=True)
class Method:
    """One rung: a method with one setting.

    Attributes
    ----------
    family : str
        Name of the method.
    setting : str
        Its setting, in words.
    target : str
        ASSOCIATED or PREDICTION: the answer that the method aims at.
    run : callable
        Runs the method once and returns its result.
    beside : bool
        Whether the rung may run beside others, in a process of its own; it then runs after all rungs that may not.
    """

    family: str
    setting: str
    target: str
    run: Callable[[], MethodOutcome]
    beside: bool = False


def limit_analysis_methods(scene: Scene, inset: float) -> Iterator[Method]:
    """Yield all rungs of limit analysis.

    The rungs of the prediction use `inset`, m. Bounds are those of sharp edges, except on the rungs that vary the inset.
    """
    for accuracy in TOLERANCES:
        yield Method("cone programme", f"residual {accuracy:.0e}", ASSOCIATED, partial(_bound, scene, 0.0, accuracy))
    yield from _linearised_methods(scene)
    for bound_inset in _insets(scene):
        yield Method("inset", f"{1e3 * bound_inset:g} mm", ASSOCIATED, partial(_bound, scene, bound_inset))
    plane = assemble(scene).effects.plane
    for per_side in POINTS_PER_SIDE[plane]:
        count = per_side if plane else per_side**2
        yield Method("contact points", f"{count} an interface", ASSOCIATED, partial(_bound, scene, 0.0, ACCEPTED, per_side))
    yield Method("associated", "for a prediction", PREDICTION, partial(_bound, scene, inset))
    yield Method("classic iteration", "its own settings", PREDICTION, partial(_classic, scene, inset))
    default = PredictionSettings()
    for viscosity in VISCOSITIES:
        yield Method(
            "Coulomb",
            f"1 path, viscosity {viscosity:g}",
            PREDICTION,
            partial(coulomb, scene, inset, PredictionSettings((viscosity,))),
        )
    yield Method("Coulomb", f"{len(default.viscosities)} paths (default)", PREDICTION, partial(coulomb, scene, inset, default))
    for finer in FINER:
        yield Method(
            "Coulomb", f"steps {finer:g} times shorter", PREDICTION, partial(coulomb, scene, inset, PredictionSettings(finer=finer))
        )
    for doublings in DOUBLINGS:
        setting = f"at most {2**doublings} travel{'s' if doublings else ''}"
        yield Method("Coulomb", setting, PREDICTION, partial(coulomb, scene, inset, PredictionSettings(doublings=doublings)))
    for increments in INCREMENTS:
        yield Method("path", f"{increments} increments", PREDICTION, partial(_path, scene, inset, increments))


def _linearised_methods(scene: Scene) -> Iterator[Method]:
    """Yield the rungs of HiGHS.

    In space: inscribed and circumscribed polygonal cones. In the plane, where two lines are the exact cone: both algorithms.
    """
    if assemble(scene).effects.plane:
        for method, setting in (("highs-ipm", "HiGHS interior point"), ("highs-ds", "HiGHS simplex")):
            yield Method("linearised", setting, ASSOCIATED, partial(_linearised, scene, FACETS[0], True, method))
        return
    for facets in FACETS:
        for inscribed, side in ((True, "inscribed"), (False, "circumscribed")):
            run = partial(_linearised, scene, facets, inscribed, "highs-ipm")
            yield Method("linearised", f"{facets} facets {side}", ASSOCIATED, run)


def coulomb(scene: Scene, inset: float, settings: PredictionSettings) -> MethodOutcome:
    """Return the Coulomb prediction at an inset, m."""
    assembly, stiffness, built = _elastic(scene, inset)
    bound = solve_associated(assembly, drives(scene)[0])
    answer = predict(assembly, stiffness, bound, wedging(scene), settings)
    return MethodOutcome(answer.value, answer.status.value, built, bound.seconds + answer.seconds, answer.uncertainty)


def shared_inset(scene: Scene) -> float:
    """Return the inset that both methods share, m."""
    return smallest_inset(assemble(scene)) if scene.inset == 0.0 else scene.inset


def _elastic(scene: Scene, inset: float) -> tuple[Assembly, JointStiffness, float]:
    """Return the assembly at an inset, m, the joint stiffness at the shared inset, and the seconds to build both."""
    start = time.perf_counter()
    assembly = assemble(scene)
    shared = assembly.with_inset(scene, shared_inset(scene))
    stiffness = joint_stiffness(shared, scene.yade)
    assembly = shared if inset == shared.inset else assembly.with_inset(scene, inset)
    return assembly, stiffness, time.perf_counter() - start


def _bound(scene: Scene, inset: float, accuracy: float = ACCEPTED, per_side: int = 0) -> MethodOutcome:
    start = time.perf_counter()
    assembly = assemble(scene).with_inset(scene, inset)
    assembly = with_grid(assembly, per_side) if per_side else assembly
    built = time.perf_counter() - start
    answer = solve_associated(assembly, drives(scene)[0], accuracy=accuracy)
    return MethodOutcome(answer.value, answer.status.value, built, answer.seconds)


def _linearised(scene: Scene, facets: int, inscribed: bool, method: str) -> MethodOutcome:
    start = time.perf_counter()
    assembly = assemble(scene).with_inset(scene, 0.0)
    built = time.perf_counter() - start
    answer = solve_linearised(assembly, drives(scene)[0], facets, inscribed, method)
    return MethodOutcome(answer.value, answer.status.value, built, answer.seconds)


def _insets(scene: Scene) -> list[float]:
    """Return the insets that fit into the scene's narrowest interface, m."""
    largest = LARGEST_INSET * smallest_inset(assemble(scene))
    return [inset for inset in INSETS if inset <= largest]


def _classic(scene: Scene, inset: float) -> MethodOutcome:
    start = time.perf_counter()
    assembly = assemble(scene).with_inset(scene, inset)
    built = time.perf_counter() - start
    answer = solve_sequentially(assembly, drives(scene)[0])
    return MethodOutcome(answer.value, answer.status.value, built, answer.seconds)


def _path(scene: Scene, inset: float, increments: int) -> MethodOutcome:
    assembly, stiffness, built = _elastic(scene, inset)
    path = follow_path(assembly, stiffness, stiffness.travel, increments, wedging(scene))
    whole = len(path.value) == increments + 1
    value, status = (float(path.value[-1]), "solved") if whole else (float("nan"), "failed")
    return MethodOutcome(value, status, built, path.seconds)
