"""The cost of accuracy: error against seconds for a ladder of methods and settings, on one scene.

A rung of the ladder is one method with one setting.
"""

import dataclasses
import itertools
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

from rich.table import Table

from comparison.judge import without_undefined
from comparison.numbers import with_uncertainty
from comparison.studies.cost_limit_analysis import ASSOCIATED, PREDICTION, Method, MethodOutcome, coulomb, shared_inset
from comparison.verdict import new_table, plain
from la_core.coulomb import PredictionSettings
from la_core.scene import Scene
from la_core.side_by_side import side_by_side
from la_core.text_table import OVER_WEIGHT, ROUND_OFF, number_text

REPEATS, ENOUGH = 3, 10.0  # runs of a rung; seconds after which it does not run again
FINEST = PredictionSettings((1e-3, 1e-4), finer=10.0)  # reference where no exact value is known
LEAST_ERROR = 1e-10  # two solutions of one programme differ by as much: smaller errors count as this error
USABLE = ("solved", "plateau", "inaccurate")
Measured = tuple[Method, MethodOutcome, list[float], list[tuple[float, float]]]  # a rung, its outcome, seconds of every run


@dataclass(frozen=True)
class CostPoint:
    """Measured value, error and seconds of one rung.

    Attributes
    ----------
    family : str
        Name of the method.
    setting : str
        Its setting, in words.
    target : str
        ASSOCIATED or PREDICTION: the answer that the method aims at.
    status : str
        How the run ended.
    value : float
        Reaction over the weight (m for a rotation), or multiplier; NaN where undefined.
    error : float
        Relative error of the value; NaN where the value is undefined or the reference is zero.
    uncertainty : float
        Uncertainty that the method states itself, in the unit of `value`; NaN where it states none.
    build, solve, post : float
        Seconds to build the model, to solve it, and for the rest; medians over the repeats.
    scatter : float
        Range of the total seconds over the repeats; NaN for one run.
    repeats : int
        Number of runs.
    pareto : bool
        Whether no other rung of the same target is both faster and closer.
    """

    family: str
    setting: str
    target: str
    status: str
    value: float
    error: float
    uncertainty: float
    build: float
    solve: float
    post: float
    scatter: float
    repeats: int
    pareto: bool = False

    @property
    def total(self) -> float:
        """Return the seconds of one run."""
        return self.build + self.solve + self.post


@dataclass(frozen=True)
class CostStudy:
    """All measured rungs of a scene.

    Attributes
    ----------
    scene, title : str
        Name and title of the scene.
    quantity : str
        "reaction" or "multiplier".
    unit : str
        Unit of the quantity, "" for a multiplier; the values of the study are over the weight.
    references : dict of str to (float, str)
        Reference of the errors, in the unit of `CostPoint.value`, and its source in words; by target.
    rungs : tuple of CostPoint
        In the order of the runs.
    """

    scene: str
    title: str
    quantity: str
    unit: str
    references: dict[str, tuple[float, str]]
    rungs: tuple[CostPoint, ...]


def measure_study(
    scene: Scene,
    methods: Sequence[Method],
    progress: Callable[[int, str], None],
    workers: int = 1,
    stop: Callable[[], None] = lambda: None,
) -> CostStudy:
    """Run every rung, REPEATS times where it is quick, and return the study.

    Rungs that may run beside others run after all other rungs.

    Parameters
    ----------
    scene : Scene
        The scene to solve.
    methods : sequence of Method
        The rungs, in the order in which they run.
    progress : callable
        Called before each rung with the number of rungs begun before it, and its name.
    workers : int
        Number of rungs that run side by side, where they may.
    stop : callable
        Called where one of these rungs fails or the user interrupts the program; `progress` or the running rungs must then raise an error.
    """
    begun = itertools.count()

    def measured_by(method: Method) -> Measured:
        progress(next(begun), f"{method.family}, {method.setting}")
        return method, *_measure(method)

    measured = [measured_by(method) for method in methods if not method.beside]
    measured += side_by_side(measured_by, [method for method in methods if method.beside], stop, workers)
    references = _references(scene, [(method, outcome) for method, outcome, *_ in measured])
    rungs = [_rung(scene, *record, references[record[0].target][0]) for record in measured]
    best = [rung for target in references for rung in front([other for other in rungs if other.target == target])]
    rungs = [dataclasses.replace(rung, pareto=rung in best) for rung in rungs]
    return CostStudy(scene.name, scene.title, scene.quantity, scene.unit, references, tuple(rungs))


def prediction_inset(scene: Scene) -> float:
    """Return the predictions' inset, m: 0 where the scene has an exact value, which holds for sharp edges."""
    return 0.0 if _known(scene)[PREDICTION] is not None else shared_inset(scene)


def _measure(method: Method) -> tuple[MethodOutcome, list[float], list[tuple[float, float]]]:
    """Run a rung; return its outcome, and for every run the total seconds and those to build and to solve."""
    totals: list[float] = []
    parts: list[tuple[float, float]] = []
    while len(totals) < REPEATS and sum(totals) <= ENOUGH:
        start = time.perf_counter()
        outcome = method.run()
        totals.append(max(time.perf_counter() - start, outcome.build + outcome.solve))
        parts.append((outcome.build, outcome.solve))
    return outcome, totals, parts


def _rung(
    scene: Scene, method: Method, outcome: MethodOutcome, totals: list[float], parts: list[tuple[float, float]], reference: float
) -> CostPoint:
    divisor = 1.0 if scene.live is not None else scene.weight
    value = outcome.value / divisor if outcome.status in USABLE else math.nan
    build, solve = (median(column) for column in zip(*parts, strict=True))
    return CostPoint(
        method.family,
        method.setting,
        method.target,
        outcome.status,
        value,
        abs(value - reference) / abs(reference) if abs(reference) > ROUND_OFF else math.nan,
        outcome.uncertainty / divisor,
        build,
        solve,
        post=max(median(totals) - build - solve, 0.0),
        scatter=max(totals) - min(totals) if len(totals) > 1 else math.nan,
        repeats=len(totals),
    )


def _known(scene: Scene) -> dict[str, float | None]:
    """Return the exact values by target, over the weight or as multipliers, for sharp edges; None where unknown."""
    expected = scene.expected
    if expected is None or expected.kind != "exact":
        return {ASSOCIATED: None, PREDICTION: None}
    live = scene.live is not None
    prediction = expected.multiplier if live else expected.reaction_over_weight
    associated = expected.associated_multiplier if live else expected.associated_reaction_over_weight
    return {ASSOCIATED: associated, PREDICTION: prediction}


def _references(scene: Scene, measured: list[tuple[Method, MethodOutcome]]) -> dict[str, tuple[float, str]]:
    """Return the references of the errors and their sources: the scene's exact value, else the finest rung."""
    divisor = 1.0 if scene.live is not None else scene.weight
    known = _known(scene)
    finest = [(m, o) for m, o in measured if m.family == "cone programme" and o.status == "solved"][-1]
    references = {ASSOCIATED: (finest[1].value / divisor, f"the cone programme with {finest[0].setting}")}
    inset = prediction_inset(scene)
    if known[PREDICTION] is None:
        source = f"the Coulomb prediction on paths and steps ten times finer, at the inset that both methods share, {1e3 * inset:g} mm"
        references[PREDICTION] = (coulomb(scene, inset, FINEST).value / divisor, source)
    for target, value in known.items():
        if value is not None:
            references[target] = (value, "the exact value, for sharp edges")
    return references


def front(rungs: Sequence[CostPoint]) -> list[CostPoint]:
    """Return the Pareto front in the order of time: each rung is closer than all faster rungs."""
    best: list[CostPoint] = []
    for rung in sorted((rung for rung in rungs if math.isfinite(rung.error)), key=lambda rung: (rung.total, rung.error)):
        if not best or max(rung.error, LEAST_ERROR) < best[-1].error:
            best.append(rung)
    return best


def cost_table(ladder: CostStudy, target: str) -> Table:
    """Return a table with one row for each rung of a target; values have the uncertainty that they state, and a dot marks the front."""
    reference, source = ladder.references[target]
    title = f"{ladder.title}: {target}; errors are relative to {number_text(reference, 7)}, {source}"
    table = new_table(
        "method",
        "setting",
        "status",
        f"{ladder.quantity} {OVER_WEIGHT[ladder.unit]}".rstrip(),
        "error",
        "build s",
        "solve s",
        "post s",
        "total s",
        "range s",
        "front",
        title=title,
    )
    for column in table.columns:
        column.justify = "left" if column.header in ("method", "setting", "status", "front") else "right"
    for rung in (rung for rung in ladder.rungs if rung.target == target):
        seconds = [
            number_text(value if math.isfinite(value) else None, 2)
            for value in (rung.build, rung.solve, rung.post, rung.total, rung.scatter)
        ]
        value = with_uncertainty(rung.value, rung.uncertainty) if math.isfinite(rung.uncertainty) else number_text(rung.value, 6)
        error = number_text(rung.error, 2)
        table.add_row(*map(plain, (rung.family, rung.setting, rung.status)), value, error, *seconds, "●" if rung.pareto else "")
    return table


def cost_dict(ladder: CostStudy) -> dict[str, Any]:
    """Return the study as a JSON object; undefined numbers are null."""
    references = {target: {"value": value, "source": source} for target, (value, source) in ladder.references.items()}
    rungs = [dataclasses.asdict(rung) | {"total": rung.total} for rung in ladder.rungs]
    study: dict[str, Any] = without_undefined(
        {"scene": ladder.scene, "quantity": ladder.quantity, "unit": ladder.unit, "references": references, "rungs": rungs}
    )
    return study
