"""Limit analysis to a requested accuracy.

A calibrated model chooses the cheapest settings, the answer itself yields an estimate of its error, and finer settings
follow where the error is too large. Errors are relative to the reaction, or to the multiplier, for sharp arrises.
Settings that cost almost nothing stay at their best: looser residuals of the cone programmes save less than a tenth of
their time (`crosscheck cost`).
"""

import math
import time
from dataclasses import replace

from la_core.analysis.accuracy_record import AccuracyRecord, Attempt
from la_core.analysis.modelling import StructuralModel, smallest_inset
from la_core.analysis.one_pass import analyse_once
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.settings import AnalysisListener, AnalysisSettings
from la_core.coulomb import CoulombSolution, PredictionSettings, slides_in_mechanism
from la_core.limit import Status
from la_core.model import Assembly
from la_core.scene import Scene, same_structure

ROUNDED, HISTORY, DILATANCY, ELASTIC, GAP = "rounded arrises", "friction's history", "dilatancy", "elastic settlement", "duality gap"

INSET_SHARE = 0.25  # of the accuracy, for rounded arrises: a smaller inset costs nothing
LEAST_INSET = 0.02  # of the scene's
# Error of friction's history, of the answer, times the number of steps. Of 128 walls (tests/benchmarks/benchmark_friction.py)
# 127 are within 5 % in 2 steps, and 123 within 1 % in 8. Only the change by twice as many steps counts as an estimate.
HISTORY_OF_STEPS = 0.08
FEWEST_STEPS, MOST_STEPS = 2, 64
# Of the sag over the travel: the most by which joints four times softer or stiffer change an answer that has no history.
ELASTIC_SHARE = 0.03
LEAST_SCALE = 0.01  # of the weight, or a multiplier: errors of smaller answers are relative to this
MOST_ATTEMPTS = 6


def with_accuracy(scene: Scene, accuracy: float) -> Scene:
    """Copy a scene with a requested relative accuracy, in its text, too; its name stays."""
    return same_structure(scene, {"accuracy": accuracy}, scene.name)


def analyse_to_accuracy(model: StructuralModel, settings: AnalysisSettings, listener: AnalysisListener) -> LimitAnalysis:
    """Analyse a scene with finer and finer settings until the estimated error is within the accuracy that it requests.

    Parameters
    ----------
    model : StructuralModel
        Model of a scene with an accuracy.
    settings : AnalysisSettings
        Settings of every attempt, apart from the steps of the prediction, which each attempt chooses.
    listener : AnalysisListener
        Receives bounds and progress of every attempt.

    Returns
    -------
    LimitAnalysis
        The attempt with the smallest estimated error; its `accuracy` records all attempts.
    """
    accuracy = model.scene.accuracy
    assert accuracy is not None
    tried, steps, before = model, _first_steps(accuracy), math.nan
    attempts: list[tuple[Attempt, LimitAnalysis]] = []
    while True:
        start = time.perf_counter()
        analysis = analyse_once(tried, replace(settings, prediction=PredictionSettings(steps)), listener)
        attempts.append((_attempt(analysis, steps, before, start), analysis))
        attempt = attempts[-1][0]
        finer = _finer(model.scene, analysis, attempt, accuracy)
        is_worse = len(attempts) > 1 and attempt.error > attempts[-2][0].error
        if attempt.is_within(accuracy) or finer is None or is_worse or len(attempts) == MOST_ATTEMPTS:
            break
        before = analysis.sharp.sharpest.value
        tried, steps = model.with_scene(replace(model.scene, inset=finer[0])), finer[1]
    attempts.sort(key=lambda pair: -pair[0].error if math.isfinite(pair[0].error) else -math.inf)  # the best one is the answer
    record = AccuracyRecord(accuracy, tuple(attempt for attempt, _ in attempts))
    return replace(attempts[-1][1], scene=model.scene, accuracy=record)


def scale(analysis: LimitAnalysis) -> float:
    """Return the scale of relative errors (N, N m, multiplier): the answer's size, at least LEAST_SCALE of the weight."""
    return max(abs(analysis.sharp.sharpest.value), LEAST_SCALE * _unit(analysis.assembly, analysis.assembly.weight))


def _unit(assembly: Assembly, weight: float) -> float:
    """Return a weight (N) in the unit of the answer: N, N m by the support's arm, or 1 for a multiplier."""
    return 1.0 if assembly.has_live_load else weight * assembly.support_speed


def has_history(analysis: LimitAnalysis) -> bool:
    """Whether joints slide, so that the answer depends on the history of friction."""
    return analysis.assembly.effects.friction == "coulomb"


def shared_parts(analysis: LimitAnalysis) -> dict[str, float]:
    """Return the relative errors that both methods share, by source: rounded arrises and elastic joints."""
    rounded, sharp, stiffness = analysis.at_inset.sharpest, analysis.sharp.sharpest, analysis.stiffness
    return {
        ROUNDED: abs(rounded.value - sharp.value) / scale(analysis),
        ELASTIC: ELASTIC_SHARE * stiffness.sag / (stiffness.travel * analysis.assembly.support_speed),
    }


def _attempt(analysis: LimitAnalysis, steps: int, before: float, start: float) -> Attempt:
    """Estimate the relative error of an analysis; NaN without a solution.

    steps: steps of the prediction. before: sharp answer of the attempt with half the steps (N, N m or multiplier), NaN
    for the first attempt. start: time at which the attempt began, s, by `time.perf_counter`.
    """
    settings: dict[str, float] = {"inset": analysis.assembly.inset}
    rounded, sharp = analysis.at_inset.sharpest, analysis.sharp.sharpest
    parts = shared_parts(analysis)
    if has_history(analysis) and isinstance(sharp, CoulombSolution) and isinstance(rounded, CoulombSolution):
        settings["steps"] = steps
        parts[HISTORY] = abs(sharp.value - before) / scale(analysis)
        parts[DILATANCY] = max(rounded.dilatancy_residual, sharp.dilatancy_residual)
    else:
        del parts[ELASTIC]  # the answer knows no stiffness
        gap = analysis.sharp.bounds[analysis.main].duality_gap
        parts[GAP] = gap * _unit(analysis.assembly, analysis.assembly.mean_weight) / scale(analysis)
        if slides_in_mechanism(analysis.assembly, analysis.bounds[analysis.main]):
            parts[HISTORY] = math.nan  # real friction does not dilate: the answer is a bound
    solved = rounded.status is Status.SOLVED and sharp.status is Status.SOLVED
    return Attempt(settings, rounded.value, parts if solved else dict.fromkeys(parts, math.nan), time.perf_counter() - start)


def _first_steps(accuracy: float) -> int:
    """Return half the number of steps (a power of two) that the calibrated model needs for a relative accuracy."""
    needed = 2 ** math.ceil(math.log2(HISTORY_OF_STEPS / accuracy))
    return max(FEWEST_STEPS, min(needed, MOST_STEPS) // 2)  # its doubling measures what fewer steps change


def _finer(scene: Scene, analysis: LimitAnalysis, attempt: Attempt, accuracy: float) -> tuple[float, int] | None:
    """Return inset (m) and steps of the next attempt; None where finer ones do not help or there is no answer."""
    if analysis.bounds[analysis.main].status is not Status.SOLVED:
        return None
    inset, steps = attempt.settings["inset"], int(attempt.settings.get("steps", 0))
    if steps == MOST_STEPS:
        return None
    least, goal = LEAST_INSET * (scene.inset or smallest_inset(analysis.assembly)), INSET_SHARE * accuracy
    rounded = attempt.parts[ROUNDED]
    is_tied_to_inset = {"sphere_radius", "max_travel"} & set(scene.yade)  # the scene chose them for its inset
    finer_inset = max(least, _one_digit(inset * goal / rounded)) if rounded > goal and not is_tied_to_inset else inset
    return None if steps == 0 and finer_inset == inset else (finer_inset, 2 * steps)


def _one_digit(value: float) -> float:
    """Round a positive number down to its first digit."""
    unit = 10.0 ** math.floor(math.log10(value))
    return math.floor(value / unit * (1.0 + 1e-12)) * unit
