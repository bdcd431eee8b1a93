"""Limit analysis to a requested accuracy.

A calibrated model chooses the cheapest settings, the answer itself yields an estimate of its error, and finer settings
follow where the error is too large. Errors are relative to the reaction, or to the multiplier, for sharp edges.
Settings that cost almost nothing stay at their best: looser residuals of the cone programmes save less than a tenth of
their time (`crosscheck cost`).
"""

import math
import time
from dataclasses import replace

import numpy as np

from la_core.analysis.modelling import StructuralModel, smallest_inset
from la_core.analysis.one_pass import analyse_once
from la_core.analysis.result import AccuracyRecord, Attempt, LimitAnalysis
from la_core.analysis.settings import AnalysisListener, AnalysisSettings, Silent
from la_core.coulomb import CoulombSolution, PredictionSettings, slides_in_mechanism
from la_core.limit import Solution, Status
from la_core.scene import Scene, same_structure

ROUNDED, HISTORY, ELASTIC, BOUND = "rounded edges", "friction's history", "elastic settlement", "error of the bound"
ROUNDED_HISTORY = "friction's history in the part of rounded edges"

INSET_SHARE = 0.25  # of the accuracy, for rounded edges: a smaller inset costs nothing
TIED_TO_INSET = frozenset({"sphere_radius", "max_travel"})  # settings of YADE that a scene chooses for its inset
LEAST_INSET = 0.02  # of the scene's
# Paths of the attempts: viscosities and effort relative to the default, division of the steps. Coarser paths than the default take as
# long, and may both miss a plateau that the default paths show.
ATTEMPTS = ((1.0, 1.0, 1.0), (0.1, 4.0, 3.0), (0.01, 16.0, 10.0))
# Largest change of an answer without history by joints four times softer or stiffer, over the ratio of sag to travel.
ELASTIC_SHARE = 0.03
HIGH = 1  # attempt of a scene that asks for a high effort
LEAST_SCALE = 0.01  # of the weight, or a multiplier: errors of smaller answers are relative to this


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
        Settings of every attempt, apart from the paths of the prediction, which each attempt chooses.
    listener : AnalysisListener
        Receives bounds and progress of every attempt.

    Returns
    -------
    LimitAnalysis
        The attempt with the smallest estimated error; its `accuracy` records all attempts.
    """
    accuracy = model.scene.accuracy
    assert accuracy is not None
    tried, level = model, HIGH if model.scene.effort == "high" else 0
    attempts: list[tuple[Attempt, LimitAnalysis]] = []
    while True:
        start = time.perf_counter()
        chosen = replace(settings, prediction=_paths(level))
        analysis = analyse_once(tried, chosen, listener)
        attempt = _attempt(analysis, level, start, _change_by_inset(tried, analysis, chosen))
        attempts.append((attempt, analysis))
        finer = _finer(model.scene, analysis, attempt, accuracy, level)
        is_worse = len(attempts) > 1 and attempt.error > attempts[-2][0].error
        if attempt.is_within(accuracy) or finer is None or is_worse:
            break
        inset, level = finer
        tried = model.with_inset(inset)
    attempts.sort(key=lambda pair: -pair[0].error if math.isfinite(pair[0].error) else -math.inf)  # the best one is the answer
    record = AccuracyRecord(accuracy, tuple(attempt for attempt, _ in attempts))
    return replace(attempts[-1][1], accuracy=record)


def finer_paths() -> PredictionSettings:
    """Return the path settings of a scene that requests a high effort: one attempt finer than the default."""
    return _paths(HIGH)


def _paths(level: int) -> PredictionSettings:
    """Return the path settings of an attempt."""
    default, (viscosity, effort, finer) = PredictionSettings(), ATTEMPTS[level]
    return PredictionSettings(tuple(viscosity * first for first in default.viscosities), finer, effort * default.effort)


def stated(analysis: LimitAnalysis) -> Solution | CoulombSolution:
    """Return the answer that errors are relative to: for sharp edges, or the prediction at the inset where joints slide."""
    return analysis.at_inset.sharpest if has_history(analysis) else analysis.sharp.sharpest


def scale(analysis: LimitAnalysis) -> float:
    """Return the scale of relative errors (N, N m, multiplier): the answer's size, at least LEAST_SCALE of the weight."""
    return max(abs(stated(analysis).value), LEAST_SCALE * analysis.assembly.in_value_unit(analysis.assembly.weight))


def has_history(analysis: LimitAnalysis) -> bool:
    """Whether joints slide, so that the answer depends on the history of friction."""
    return analysis.assembly.effects.friction == "coulomb"


def shared_parts(analysis: LimitAnalysis) -> dict[str, float]:
    """Return the relative errors that both methods share, by source: rounded edges and elastic joints.

    Where joints slide, the effect of rounded edges is measured on the bounds, because bounds have no history. An attempt also knows the
    effect of half the inset on the prediction, and the larger effect counts. Where blocks lock as they dilate, no bound exists. The effect
    is then measured on the predictions at both insets, each to within its uncertainty.
    """
    rounded, sharp, stiffness = analysis.at_inset, analysis.sharp, analysis.stiffness
    by_bounds = has_history(analysis) and not _has_two_predictions(analysis)
    pair = (rounded.bounds[analysis.main], sharp.bounds[analysis.main]) if by_bounds else (rounded.sharpest, sharp.sharpest)
    attempts = analysis.accuracy.limit_analysis if analysis.accuracy else ()
    of_attempt = attempts[-1].parts.get(ROUNDED, 0.0) if attempts else 0.0
    parts = {
        ROUNDED: float(np.max([abs(pair[0].value - pair[1].value) / scale(analysis), of_attempt])),
        ELASTIC: ELASTIC_SHARE * stiffness.sag / (stiffness.travel * analysis.assembly.support_speed),
    }
    if _has_two_predictions(analysis):
        stated_by_both = (answer.uncertainty for answer in pair if isinstance(answer, CoulombSolution))
        parts[ROUNDED_HISTORY] = sum(stated_by_both) / scale(analysis)
    return parts


def _has_two_predictions(analysis: LimitAnalysis) -> bool:
    """Whether no bound exists, and a prediction both at the shared inset and for sharp edges."""
    return analysis.is_without_bound and analysis.sharp.is_without_bound


def lacks_sharp_prediction(analysis: LimitAnalysis) -> bool:
    """Whether the part of rounded edges is unknown because there is neither a bound nor a prediction for sharp edges.

    Inset 0 in the scene adds this prediction, see `LimitAnalysis.sharp`.
    """
    return analysis.is_without_bound and analysis.scene.inset > 0.0 and analysis.sharp.coulomb is None


def _change_by_inset(model: StructuralModel, analysis: LimitAnalysis, settings: AnalysisSettings) -> float:
    """Return the relative change of a prediction by rounded edges, estimated from a second prediction at half the inset.

    The lever arms of sliding joints may change the prediction by several times as much as the bound. The second half of the inset is
    assumed to change it as much as the first half. 0 where no such prediction is needed; NaN where the second one is not solved.
    """
    answer = analysis.coulomb
    if not has_history(analysis) or _has_two_predictions(analysis) or answer is None:
        return 0.0
    yade = {name: value for name, value in model.scene.yade.items() if name not in TIED_TO_INSET}
    free = replace(model, scene=replace(model.scene, yade=yade))
    second = analyse_once(free.with_inset(0.5 * analysis.assembly.inset), settings, Silent()).coulomb
    return math.nan if second is None or second.status is not Status.SOLVED else 2.0 * abs(answer.value - second.value) / scale(analysis)


def _is_tied_to_inset(scene: Scene) -> bool:
    """Whether the scene gives a setting of YADE that is valid for its own inset alone."""
    return bool(TIED_TO_INSET & set(scene.yade))


def _attempt(analysis: LimitAnalysis, level: int, start: float, change_by_inset: float) -> Attempt:
    """Estimate the relative error of an analysis; NaN without a solution.

    level: index into ATTEMPTS. start: time at which the attempt began, s, by `time.perf_counter`. change_by_inset: result
    of `_change_by_inset`.
    """
    settings: dict[str, float] = {"inset": analysis.assembly.inset}
    answer, parts = stated(analysis), shared_parts(analysis)
    parts[ROUNDED] = float(np.max([parts[ROUNDED], change_by_inset]))
    if has_history(analysis) and isinstance(answer, CoulombSolution):
        paths = _paths(level)
        settings |= {"viscosity": paths.viscosities[-1], "finer": paths.finer}
        parts[HISTORY] = answer.uncertainty / scale(analysis)
    else:
        del parts[ELASTIC]  # the answer does not depend on the stiffness
        parts[BOUND] = analysis.sharp.bounds[analysis.main].error / scale(analysis)
        if slides_in_mechanism(analysis.assembly, analysis.bounds[analysis.main]):
            parts[HISTORY] = math.nan  # real friction does not dilate: the answer is a bound
    rounded = analysis.at_inset.sharpest
    solved = rounded.status is Status.SOLVED and answer.status is Status.SOLVED
    return Attempt(settings, rounded.value, parts if solved else dict.fromkeys(parts, math.nan), time.perf_counter() - start)


def _finer(scene: Scene, analysis: LimitAnalysis, attempt: Attempt, accuracy: float, level: int) -> tuple[float, int] | None:
    """Return inset (m) and level of the next attempt; None where finer settings do not help or there is no answer."""
    if analysis.bounds[analysis.main].status is not Status.SOLVED and not _has_two_predictions(analysis):
        return None
    inset = attempt.settings["inset"]
    least, goal = LEAST_INSET * (scene.inset or smallest_inset(analysis.assembly)), INSET_SHARE * accuracy
    rounded = attempt.parts[ROUNDED]
    finer_inset = max(least, _one_digit(inset * goal / rounded)) if rounded > goal and not _is_tied_to_inset(scene) else inset
    history = sum(value for part, value in attempt.parts.items() if part in (HISTORY, ROUNDED_HISTORY))
    is_finer = level + 1 < len(ATTEMPTS) and "viscosity" in attempt.settings and not history <= accuracy / 2.0
    return (finer_inset, level + is_finer) if is_finer or finer_inset != inset else None


def _one_digit(value: float) -> float:
    """Round a positive number down to its first digit."""
    unit = 10.0 ** math.floor(math.log10(value))
    return math.floor(value / unit * (1.0 + 1e-12)) * unit
