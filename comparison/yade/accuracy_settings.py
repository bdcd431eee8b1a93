"""Choose YADE settings for a requested accuracy, estimate the run's error, and rerun more slowly if it is too large."""

import math
from dataclasses import replace

import numpy as np

from comparison.yade.stored import Results
from la_core.analysis import HISTORY, Attempt, LimitAnalysis, has_history, scale, shared_parts
from la_core.exchange import TRAVEL_PERIODS
from la_core.limit import Status
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


def initial_settings(analysis: LimitAnalysis) -> LimitAnalysis:
    """The analysis with settings for YADE's first run, where an accuracy is requested; what the scene's [yade] sets stays its own."""
    scene = analysis.scene
    record = analysis.accuracy
    if record is None or record.settings or analysis.bounds[analysis.main].status is not Status.SOLVED:
        return analysis
    accuracy = record.asked
    faster = HISTORY_SHARE * accuracy / HISTORY_OF_SPEED if may_slide(analysis) else max(1.0, FASTEST * accuracy / FAST_ACCURACY)
    settings = {"travel_periods": TRAVEL_PERIODS / min(faster, FASTEST), "stop_uncertainty": STOP_SHARE * accuracy}
    if accuracy >= LIGHT_FROM:
        settings["damping_ratio"] = LIGHT_DAMPING
    return replace(analysis, accuracy=replace(record, settings=_left_open(scene, settings)))


def may_slide(analysis: LimitAnalysis) -> bool:
    """Whether joints may slide in YADE: unless limit analysis found by itself that none does."""
    scene = analysis.scene
    return has_history(analysis) or (scene.effects.friction != "auto" and bool(analysis.assembly.points.friction.any()))


def _left_open(scene: Scene, settings: dict[str, float]) -> dict[str, float]:
    """Settings that the scene leaves to the program; its own speed stands for the travel's periods, too."""
    own = set(scene.yade) | ({"travel_periods"} if "speed" in scene.yade else set())
    return {name: value for name, value in settings.items() if name not in own}


def attempt_of(results: Results) -> Attempt:
    """What a run tells of its own error; undefined without a plateau."""
    analysis, run = results.analysis, results.recorded
    assert analysis.accuracy is not None
    earlier, reaction = analysis.accuracy.yade, run.result.reaction
    parts = {FIT: run.result.uncertainty / scale(analysis), INERTIA: INERTIA_OF_SPEED * math.sqrt(_kinetic_ratio(results))}
    parts |= shared_parts(analysis)
    if may_slide(analysis):
        parts[HISTORY] = HISTORY_OF_SPEED * TRAVEL_PERIODS / run.settings["travel_periods"]
        if earlier and math.isfinite(earlier[-1].error):
            parts[HISTORY] = abs(reaction - earlier[-1].value) / scale(analysis)
    if run.status != "plateau":
        parts = dict.fromkeys(parts, math.nan)
    settings = {name: run.settings[name] for name in ("travel_periods", "damping_ratio", "stop_uncertainty")}
    return Attempt(settings, reaction, parts, run.result.seconds)


def _kinetic_ratio(results: Results) -> float:
    """Largest kinetic energy on the plateau over the work of the weights there, or of the reaction where the weights do none."""
    analysis, run = results.analysis, results.recorded
    if math.isfinite(run.result.kinetic_ratio) or run.status != "plateau":
        return float(run.result.kinetic_ratio)
    settlement, energy = run.settling("settlement"), run.settling("kinetic_energy")
    fitted = settlement >= run.result.plateau_start
    return float(energy[fitted].max() / (scale(analysis) * np.ptp(settlement[fitted])))


def slower_settings(results: Results, limit: float) -> LimitAnalysis | None:
    """The analysis with settings for a slower run; None where this one is good enough, or a slower one would not help.

    limit: wall seconds that a run may take; one that would take longer is not begun, for its answer would be none.
    """
    scene, analysis, run = results.scene, results.analysis, results.recorded
    record = analysis.accuracy
    if record is None or "travel_periods" not in record.settings or run.status == "timeout":
        return None
    attempt = attempt_of(results)
    periods = attempt.settings["travel_periods"]
    if attempt.is_within(record.asked) or len(record.yade) + 1 >= MOST_ATTEMPTS:
        return None
    if math.isfinite(attempt.error):
        slower = min(max(SLOWER, attempt.error / record.asked), MOST_SLOWER)
    elif periods < TRAVEL_PERIODS:
        slower = min(TRAVEL_PERIODS / periods, MOST_SLOWER)  # no plateau: it may be the speed's doing
    else:
        return None
    if attempt.seconds * slower > limit:
        return None
    settings = {"travel_periods": slower * periods, "stop_uncertainty": attempt.settings["stop_uncertainty"] / slower}
    settings = record.settings | _left_open(scene, settings)
    return replace(analysis, accuracy=replace(record, yade=(*record.yade, attempt), settings=settings))


def carry_attempts_over(rejected: Results, analysis: LimitAnalysis) -> LimitAnalysis:
    """The analysis of another model, with the attempts on the rejected one: they took time, and estimate no error here."""
    before = rejected.analysis.accuracy
    if before is None or analysis.accuracy is None:
        return analysis
    result = rejected.recorded.result
    last = Attempt(dict(before.settings), result.reaction, {"another model": math.nan}, result.seconds)
    earlier = tuple(replace(attempt, parts={"another model": math.nan}) for attempt in before.yade)
    attempts = (*before.limit_analysis, *analysis.accuracy.limit_analysis)
    return replace(analysis, accuracy=replace(analysis.accuracy, limit_analysis=attempts, yade=(*earlier, last)))
