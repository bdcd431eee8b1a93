"""YADE to an accuracy asked for: settings by a model that the ladder of `crosscheck cost` calibrated, the error that a run itself tells,
and a slower run where that misses."""

import math
from dataclasses import replace

from comparison.record import Run
from la_core.accuracy import HISTORY, has_history, scale, shared_parts
from la_core.analysis import LimitAnalysis
from la_core.exchange import TRAVEL_PERIODS
from la_core.purchase import Attempt
from la_core.scene import Scene

FIT, INERTIA = "fitted plateau", "inertia"
# Of the reaction, at the derived speed, and in proportion to it: what friction's history owes to speed where joints slide.
HISTORY_OF_SPEED = 0.0033
HISTORY_SHARE = 0.5  # of the accuracy, for that
INERTIA_OF_SPEED = 0.03  # of the root of the kinetic ratio, a speed: the most that it adds to a reaction beyond its plateau's scatter
FASTEST, FAST_ACCURACY = 8.0, 0.01  # times the derived speed, and the accuracy for which runs without history may be as fast
STOP_SHARE = 0.25  # of the accuracy, for the fitted plateau of a run that stops early
LIGHT_DAMPING, LIGHT_FROM = 0.1, 5e-3  # damping ratio that allows longer time steps, and the accuracy from which on it serves
SLOWER, MOST_SLOWER = 2.0, 8.0  # times, from one attempt to the next
MOST_ATTEMPTS = 4


def first_settings(analysis: LimitAnalysis) -> LimitAnalysis:
    """The analysis with settings for YADE's first run, where an accuracy is asked for."""
    purchase = analysis.purchase
    if purchase is None or purchase.settings or not math.isfinite(purchase.limit_analysis[-1].error):
        return analysis
    asked = purchase.asked
    faster = HISTORY_SHARE * asked / HISTORY_OF_SPEED if has_history(analysis) else max(1.0, FASTEST * asked / FAST_ACCURACY)
    settings = {"travel_periods": TRAVEL_PERIODS / min(faster, FASTEST), "stop_uncertainty": STOP_SHARE * asked}
    if asked >= LIGHT_FROM:
        settings["damping_ratio"] = LIGHT_DAMPING
    return replace(analysis, purchase=replace(purchase, settings=settings))


def attempt_of(analysis: LimitAnalysis, run: Run) -> Attempt:
    """What a run tells of its own error; undefined without a plateau."""
    assert analysis.purchase is not None
    earlier, reaction = analysis.purchase.yade, run.result["reaction"]
    parts = {FIT: run.result["uncertainty"] / scale(analysis), INERTIA: INERTIA_OF_SPEED * math.sqrt(run.result["kinetic_ratio"])}
    parts |= shared_parts(analysis)
    if has_history(analysis):
        parts[HISTORY] = HISTORY_OF_SPEED * TRAVEL_PERIODS / run.settings["travel_periods"]
        if earlier and math.isfinite(earlier[-1].error):
            parts[HISTORY] = abs(reaction - earlier[-1].value) / scale(analysis)
    if run.status != "plateau":
        parts = dict.fromkeys(parts, math.nan)
    settings = {name: run.settings[name] for name in ("travel_periods", "damping_ratio", "stop_uncertainty")}
    return Attempt(settings, reaction, parts, run.result["seconds"])


def again(scene: Scene, analysis: LimitAnalysis, run: Run) -> LimitAnalysis | None:
    """The analysis with settings for a slower run; None where this one is good enough, or a slower one would not help."""
    purchase = analysis.purchase
    if purchase is None or not purchase.settings or "speed" in scene.yade or run.status == "timeout":
        return None
    attempt = attempt_of(analysis, run)
    periods = attempt.settings["travel_periods"]
    if attempt.keeps(purchase.asked) or len(purchase.yade) + 1 == MOST_ATTEMPTS:
        return None
    if math.isfinite(attempt.error):
        slower = min(max(SLOWER, attempt.error / purchase.asked), MOST_SLOWER)
    elif periods < TRAVEL_PERIODS:
        slower = min(TRAVEL_PERIODS / periods, MOST_SLOWER)  # no plateau: it may be the speed's doing
    else:
        return None
    settings = purchase.settings | {"travel_periods": slower * periods, "stop_uncertainty": purchase.settings["stop_uncertainty"] / slower}
    return replace(analysis, purchase=replace(purchase, yade=(*purchase.yade, attempt), settings=settings))
