"""The requested accuracy: the result of each method, its attempts, and the chosen settings, in numbers and words."""

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

from comparison.numbers import percent
from comparison.verdict import Check, Verdict, finite_or_none
from comparison.yade import HISTORY_OF_SPEED, Results, attempt_of
from la_core.analysis import HISTORY, INSET_SHARE, Attempt, LimitAnalysis, lacks_sharp_prediction
from la_core.exchange import TRAVEL_PERIODS
from la_core.limit import Status

METHODS = {"limit_analysis": "limit analysis", "yade": "YADE"}


COARSER = "Request a coarser accuracy, or allow more seconds with --time-limit."
UNKNOWN_ERROR = "Request no accuracy: a part of the error is unknown. The verdict then rests on the uncertainties that both methods state."
SHARP_TOO = (
    "Set inset = 0 in the scene's [joint] table: limit analysis then predicts the value for sharp edges, too, and the part of rounded "
    "edges is known. Otherwise request no accuracy."
)


def attempts_by_method(results: Results) -> dict[str, tuple[Attempt, ...]]:
    """Return all attempts by method, the accepted one last; empty without a requested accuracy, and without YADE's if it has no run."""
    analysis, run = results.analysis, results.run
    record = analysis.accuracy
    if record is None:
        return {}
    yade = (*record.yade, attempt_of(results)) if run is not None else ()
    return {"limit_analysis": record.limit_analysis} | ({"yade": yade} if yade else {})


def accuracy_summary(results: Results) -> dict[str, Any] | None:
    """Return the requested accuracy and, by method, whether it is reached, the estimated error, settings, seconds and every attempt."""
    record = results.analysis.accuracy
    if record is None:
        return None
    summary: dict[str, Any] = {"asked": record.asked}
    for method, attempts in attempts_by_method(results).items():
        last = attempts[-1]
        rows = [dataclasses.asdict(each) | {"error": each.error, "chosen": chosen_settings(each)} for each in attempts]
        summary[method] = {
            "kept": last.is_within(record.asked),
            "error": last.error,
            "chosen": chosen_settings(last),
            "seconds": sum(each.seconds for each in attempts),
            "attempts": rows,
        }
    return summary


def check_accuracy(results: Results) -> Iterator[Check]:
    """Yield the check that each method's estimate of its own error is within the requested accuracy.

    There is no such check without a requested accuracy, or if the structure cannot stand.
    """
    analysis = results.analysis
    if analysis.bounds[analysis.main].status is Status.INFEASIBLE:
        return
    for method, attempts in attempts_by_method(results).items():
        assert analysis.accuracy is not None
        requested, last, name = analysis.accuracy.asked, attempts[-1], METHODS[method]
        kept = last.is_within(requested)
        error = finite_or_none(last.error)
        estimate = "does not know its own error" if error is None else f"estimates its own error as {percent(error)}"
        reason = f"The requested accuracy of {percent(requested)} is not reached: {name} {estimate} ({error_parts(last)})."
        errors: tuple[float | None, float | None] = (error, None) if method == "limit_analysis" else (None, error)
        unknown = SHARP_TOO if lacks_sharp_prediction(analysis) else UNKNOWN_ERROR
        advice = COARSER if error is not None else unknown
        verdict, reason, step = (Verdict.AGREE, "", "") if kept else (Verdict.INCONCLUSIVE, reason, advice)
        yield Check(f"accuracy of {name}", verdict, *errors, None, requested, "of the answer", reason, step)


def error_parts(attempt: Attempt) -> str:
    """Return the parts of an error as text, unknown ones first, then the largest; parts below 1 % of the error are left out."""
    size = sum(value for value in attempt.parts.values() if math.isfinite(value))
    known = sorted(((value, name) for name, value in attempt.parts.items() if 0.01 * size <= value < math.inf), reverse=True)
    unknown = [f"{name} unknown" for name, value in attempt.parts.items() if not math.isfinite(value)]
    return ", ".join([*unknown, *(f"{name} {percent(value)}" for value, name in known)])


def chosen_settings(attempt: Attempt) -> str:
    """Return the settings of an attempt as text, with the reasons for them."""
    settings = attempt.settings
    if "inset" in settings:
        inset = "sharp edges"
        if settings["inset"]:
            inset = f"inset {1e3 * settings['inset']:.3g} mm (rounded edges may take {percent(INSET_SHARE)} of the accuracy)"
        if "viscosity" not in settings:
            return f"{inset}, cone programmes solved to their smallest tolerance, at almost no cost"
        paths = f"paths from viscosities of {10.0 * settings['viscosity']:g} and {settings['viscosity']:g}"
        return f"{paths} (their difference shows the effect of friction's history), {inset}"
    if "damping_ratio" not in settings:
        return "settings of another model"
    speed = TRAVEL_PERIODS / settings["travel_periods"]
    slides = f" (the derived speed changes friction's history by {percent(HISTORY_OF_SPEED)})" if HISTORY in attempt.parts else ""
    return (
        f"{speed:.3g} times the derived speed{slides}, damping ratio {settings['damping_ratio']:g}, "
        f"the run ends once its plateau is known to {percent(settings['stop_uncertainty'])}"
    )


def attempt_words(attempt: Attempt) -> str:
    """Return an attempt in one line: estimated error, seconds and settings."""
    error = f"error estimated as {percent(attempt.error)}" if math.isfinite(attempt.error) else "error unknown"
    return f"{error} ({error_parts(attempt)}) in {attempt.seconds:.2g} s with {chosen_settings(attempt)}"


def why_again(attempt: Attempt, slower: LimitAnalysis) -> str:
    """Return the line that gives the reason and the speed of YADE's next run."""
    assert slower.accuracy is not None  # because it has settings
    speed = TRAVEL_PERIODS / slower.accuracy.settings["travel_periods"]
    return f"{attempt_words(attempt)}; runs again at {speed:.3g} times the derived speed"
