"""What an accuracy asked for came to, in numbers and in words: attempts of both methods, what each chose and why, whether it is kept."""

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

from comparison.judge.check import Check, Verdict, finite_or_none
from comparison.yade import HISTORY_OF_SPEED, Results, attempt_of
from la_core.analysis import HISTORY, INSET_SHARE, Attempt, LimitAnalysis
from la_core.exchange import TRAVEL_PERIODS
from la_core.limit import Status

METHODS = {"limit_analysis": "limit analysis", "yade": "YADE"}


def percent(share: float | None) -> str:
    """A share in per cent, in two significant digits; a dash for none."""
    return "–" if share is None or not math.isfinite(share) else f"{100.0 * share:.2g} %"


def attempts_by_method(results: Results) -> dict[str, tuple[Attempt, ...]]:
    """All attempts by method, the last of which is its answer; none where no accuracy is asked for, or YADE gave no run."""
    analysis, run = results.analysis, results.run
    purchase = analysis.accuracy
    if purchase is None:
        return {}
    yade = (*purchase.yade, attempt_of(results)) if run is not None else ()
    return {"limit_analysis": purchase.limit_analysis} | ({"yade": yade} if yade else {})


def accuracy_summary(results: Results) -> dict[str, Any] | None:
    """Accuracy asked for and, by method, whether it is kept, the estimate, what was chosen and why, seconds, and every attempt."""
    analysis = results.analysis
    purchase = analysis.accuracy
    if purchase is None:
        return None
    found: dict[str, Any] = {"asked": purchase.asked}
    for method, tried in attempts_by_method(results).items():
        found[method] = {
            "kept": tried[-1].is_within(purchase.asked),
            "error": tried[-1].error,
            "chosen": chosen_settings(tried[-1]),
            "seconds": sum(one.seconds for one in tried),
            "attempts": [dataclasses.asdict(one) | {"error": one.error, "chosen": chosen_settings(one)} for one in tried],
        }
    return found


def check_accuracy(results: Results) -> Iterator[Check]:
    """Whether each method's own estimate of its error is within the accuracy asked for; nothing where the structure cannot stand."""
    analysis = results.analysis
    if analysis.bounds[analysis.main].status is Status.INFEASIBLE:
        return
    for method, tried in attempts_by_method(results).items():
        assert analysis.accuracy is not None
        asked, last, words = analysis.accuracy.asked, tried[-1], METHODS[method]
        kept = last.is_within(asked)
        shown = f"{percent(last.error)} ({error_parts(last)})"
        reason = f"The accuracy of {percent(asked)} that was asked for is not reached: {words} estimates its error as {shown}."
        error = {method: finite_or_none(last.error)}
        verdict = Verdict.AGREE if kept else Verdict.INCONCLUSIVE
        yield Check(f"accuracy of {words}", verdict, **error, tolerance=asked, unit="of the answer", reason="" if kept else reason)


def error_parts(attempt: Attempt) -> str:
    """The parts of an error in words, the largest first; those that are nothing beside it left out."""
    size = sum(value for value in attempt.parts.values() if math.isfinite(value))
    told = sorted(((value, name) for name, value in attempt.parts.items() if value >= 0.01 * size), reverse=True)
    unknown = [f"{name} unknown" for name, value in attempt.parts.items() if not math.isfinite(value)]
    return ", ".join([*unknown, *(f"{name} {percent(value)}" for value, name in told)])


def chosen_settings(attempt: Attempt) -> str:
    """Settings of an attempt and why they are the cheapest that serve, in words."""
    settings = attempt.settings
    if "inset" in settings:
        inset = "sharp arrises"
        if settings["inset"]:
            inset = f"inset {1e3 * settings['inset']:.3g} mm (rounded arrises may take {percent(INSET_SHARE)} of the accuracy)"
        if "steps" not in settings:
            return f"{inset}, cone programmes at their tightest, which costs next to nothing"
        return f"{settings['steps']:.0f} steps (against half as many, which tells what friction's history owes to them), {inset}"
    if "damping_ratio" not in settings:
        return "settings of another model"
    speed = TRAVEL_PERIODS / settings["travel_periods"]
    slides = f" (each time changes friction's history by {percent(HISTORY_OF_SPEED)})" if HISTORY in attempt.parts else ""
    return (
        f"{speed:.3g} times the derived speed{slides}, damping ratio {settings['damping_ratio']:g}, "
        f"a plateau known to {percent(settings['stop_uncertainty'])} ends the run"
    )


def attempt_words(attempt: Attempt) -> str:
    """An attempt in one line."""
    return (
        f"error estimated as {percent(attempt.error)} ({error_parts(attempt)}) in {attempt.seconds:.2g} s with {chosen_settings(attempt)}"
    )


def why_again(attempt: Attempt, slower: LimitAnalysis) -> str:
    """Why YADE runs again, and how."""
    assert slower.accuracy is not None  # for it has settings
    speed = TRAVEL_PERIODS / slower.accuracy.settings["travel_periods"]
    return f"{attempt_words(attempt)}; runs again at {speed:.3g} times the derived speed"
