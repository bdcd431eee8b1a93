"""What accuracy costs in time: error against seconds over a ladder of methods and settings, on one scene."""

import dataclasses
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

from rich import box
from rich.table import Table

from comparison.judge import without_undefined
from comparison.studies.cost_limit_analysis import ASSOCIATED, PREDICTION, Method, MethodOutcome, coulomb, shared_inset
from la_core.scene import Scene
from la_core.text_table import ROUND_OFF, number_text

REPEATS, ENOUGH = 3, 10.0  # times a rung is run; seconds after which it is not run again
FINEST_STEPS = 32  # of the prediction that all are held against where no value is known
LEAST_ERROR = 1e-10  # smaller errors are what two solves of one programme differ by: they count as this
USABLE = ("solved", "plateau", "inaccurate")


@dataclass(frozen=True)
class CostPoint:
    """One rung, measured. value and error: over the weight or as a multiplier, and relative to the reference; NaN where undefined,
    as is an error relative to nothing but round-off.

    Seconds: median over the repeats, to build the model, to solve, for all the rest; scatter: range of the total, NaN for one run.
    pareto: no other rung of the same target is both faster and closer.
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
        """Seconds of one run."""
        return self.build + self.solve + self.post


@dataclass(frozen=True)
class CostStudy:
    """All rungs of a scene; reference: by target, what errors are relative to, and in words where it comes from."""

    scene: str
    title: str
    quantity: str
    references: dict[str, tuple[float, str]]
    rungs: tuple[CostPoint, ...]


def measure_study(scene: Scene, methods: Sequence[Method], progress: Callable[[int, str], None]) -> CostStudy:
    """Run every rung in turn, as often as it is quick; progress is told the number of the rung and its name."""
    measured = []
    for k, method in enumerate(methods):
        progress(k, f"{method.family}, {method.setting}")
        measured.append((method, *_measure(method)))
    references = _references(scene, [(method, outcome) for method, outcome, *_ in measured])
    rungs = [_rung(scene, *one, references[one[0].target][0]) for one in measured]
    best = [rung for target in references for rung in front([one for one in rungs if one.target == target])]
    rungs = [dataclasses.replace(rung, pareto=rung in best) for rung in rungs]
    return CostStudy(scene.name, scene.title, scene.quantity, references, tuple(rungs))


def prediction_inset(scene: Scene) -> float:
    """Inset of limit analysis' predictions, m: sharp where the exact value is known, for that holds for sharp arrises."""
    return 0.0 if _known(scene)[PREDICTION] is not None else shared_inset(scene)


def _measure(method: Method) -> tuple[MethodOutcome, list[float], list[tuple[float, float]]]:
    """Outcome, seconds of every run, and its seconds to build and to solve."""
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
    """Exact values by target, over the weight or as multipliers; for sharp arrises."""
    expected = scene.expected
    if expected is None or expected.kind != "exact":
        return {ASSOCIATED: None, PREDICTION: None}
    live = scene.live is not None
    own = expected.multiplier if live else expected.reaction_over_weight
    associated = expected.associated_multiplier if live else expected.associated_reaction_over_weight
    return {ASSOCIATED: associated, PREDICTION: own}


def _references(scene: Scene, measured: list[tuple[Method, MethodOutcome]]) -> dict[str, tuple[float, str]]:
    """What errors are relative to: the scene's exact value, else the finest rung."""
    divisor = 1.0 if scene.live is not None else scene.weight
    known = _known(scene)
    finest = [(m, o) for m, o in measured if m.target == ASSOCIATED and m.family == "cone programme" and o.status == "solved"][-1]
    found = {ASSOCIATED: (finest[1].value / divisor, f"the cone programme with {finest[0].setting}")}
    inset = prediction_inset(scene)
    if known[PREDICTION] is None:
        words = f"the Coulomb prediction in {FINEST_STEPS} steps, at the inset that both methods share, {1e3 * inset:g} mm"
        found[PREDICTION] = (coulomb(scene, inset, FINEST_STEPS).value / divisor, words)
    for target, value in known.items():
        if value is not None:
            found[target] = (value, "the exact value, for sharp arrises")
    return found


def front(rungs: Sequence[CostPoint]) -> list[CostPoint]:
    """The Pareto front, by time: rungs than which none is as close in less time, or closer in as much."""
    found: list[CostPoint] = []
    for rung in sorted((one for one in rungs if math.isfinite(one.error)), key=lambda one: (one.total, one.error)):
        if not found or max(rung.error, LEAST_ERROR) < found[-1].error:
            found.append(rung)
    return found


def cost_table(ladder: CostStudy, target: str) -> Table:
    """One row a rung of a target; the Pareto front is marked."""
    reference, words = ladder.references[target]
    over = "" if ladder.quantity == "multiplier" else " over W"
    title = f"{ladder.title}: {target}; errors are relative to {number_text(reference, 7)}{over}, {words}"
    table = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left")
    for head in (
        "method",
        "setting",
        "status",
        f"{ladder.quantity}{over}",
        "error",
        "build s",
        "solve s",
        "post s",
        "total s",
        "range s",
        "front",
    ):
        table.add_column(head, justify="left" if head in ("method", "setting", "status", "front") else "right")
    for rung in (one for one in ladder.rungs if one.target == target):
        seconds = [
            number_text(value if math.isfinite(value) else None, 2)
            for value in (rung.build, rung.solve, rung.post, rung.total, rung.scatter)
        ]
        found = [number_text(value if math.isfinite(value) else None, digits) for value, digits in ((rung.value, 6), (rung.error, 2))]
        table.add_row(rung.family, rung.setting, rung.status, *found, *seconds, "●" if rung.pareto else "")
    return table


def cost_dict(ladder: CostStudy) -> dict[str, Any]:
    """The ladder as a JSON object; undefined numbers are null."""
    references = {target: {"value": value, "source": words} for target, (value, words) in ladder.references.items()}
    rungs = [dataclasses.asdict(rung) | {"total": rung.total} for rung in ladder.rungs]
    found: dict[str, Any] = without_undefined(
        {"scene": ladder.scene, "quantity": ladder.quantity, "references": references, "rungs": rungs}
    )
    return found
