"""Choose YADE's settings for a requested accuracy, estimate the error of a run, and choose a slower run if it is too large."""

import math
from dataclasses import replace

import numpy as np

from comparison.run_folder import is_second_attempt
from comparison.yade.stored import Results
from la_core.analysis import HISTORY, Attempt, LimitAnalysis, has_history, scale, shared_parts
from la_core.exchange import TRAVEL_PERIODS
from la_core.limit import Status
from la_core.scene import Scene

FIT, INERTIA = "fitted plateau", "inertia"
# Share of the reaction: effect of the speed on friction's history if joints slide. It is in proportion to the speed; this is its value at
# the derived speed.
HISTORY_OF_SPEED = 0.0033
HISTORY_SHARE = 0.5  # of the accuracy: largest effect of the speed on friction's history in the first run
# Share of the reaction: effect of stiffness and time step. The effect of friction's history is a separate part here.
SETTINGS_UNCERTAINTY = 2e-4
INERTIA_OF_SPEED = 0.03  # times the root of the kinetic ratio: largest effect of inertia on a reaction beyond its plateau's scatter
# A run without history may move FASTEST times as fast as derived at FAST_ACCURACY or a coarser accuracy. At a finer accuracy the factor is
# in proportion to the accuracy, and at least 1. A run with history may not move faster: the two speeds would differ too much, and a further
# attempt would cost the time that was saved.
FASTEST, FAST_ACCURACY = 8.0, 0.01
STOP_SHARE = 0.25  # of the accuracy: uncertainty of the fitted plateau at which a run stops early
FIT_SHARE = 0.5  # of the accuracy: if the fitted plateau is known to this, a slower run may stop as early, which needs far less travel
LOOSEST_STOP = 0.002  # largest such uncertainty of a run with history: less certain plateaus would seem to differ by their speed
SLOWER, MOST_SLOWER = 2.0, 8.0  # least and largest factor on the duration from one attempt to the next
MOST_ATTEMPTS = 4


def initial_settings(analysis: LimitAnalysis) -> LimitAnalysis:
    """Return the analysis with settings for YADE's first run at the requested accuracy; settings in the scene's [yade] are kept.

    Without a requested accuracy, or without a solution, the analysis is returned unchanged.
    """
    scene = analysis.scene
    record = analysis.accuracy
    if record is None or record.settings or analysis.main_answer.status is not Status.SOLVED:
        return analysis
    accuracy = record.asked
    pace, stop = min(max(1.0, FASTEST * accuracy / FAST_ACCURACY), FASTEST), STOP_SHARE * accuracy
    if may_slide(analysis):
        pace, stop = min(HISTORY_SHARE * accuracy / HISTORY_OF_SPEED, 1.0), min(stop, LOOSEST_STOP)
    periods = float(scene.yade.get("travel_periods", TRAVEL_PERIODS / pace))
    settings = {"travel_periods": periods, "stop_uncertainty": stop, "settings_uncertainty": SETTINGS_UNCERTAINTY}
    return replace(analysis, accuracy=replace(record, settings=_left_open(scene, settings)))


def may_slide(analysis: LimitAnalysis) -> bool:
    """Return whether joints may slide in YADE; they always may, unless limit analysis itself found that no joint slides."""
    scene = analysis.scene
    return has_history(analysis) or (scene.effects.friction != "auto" and bool(analysis.assembly.points.friction.any()))


def _left_open(scene: Scene, settings: dict[str, float]) -> dict[str, float]:
    """Return the settings that the scene leaves open; a speed in the scene also fixes the travel's periods.

    The periods of a second attempt are only initial values, because it may become slower.
    """
    fixed = set(scene.yade) - ({"travel_periods"} if is_second_attempt(scene) else set())
    fixed |= {"travel_periods"} if "speed" in scene.yade else set()
    return {name: value for name, value in settings.items() if name not in fixed}


def attempt_of(results: Results) -> Attempt:
    """Return the attempt of a run: its settings, reaction, seconds and estimated error (NaN without a plateau)."""
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
    """Return the largest kinetic energy on the plateau over the work there: of the weights, or of the reaction or live load if larger.

    The larger work counts, because the weights alone may do almost no work. NaN if nothing moves on the plateau.
    """
    analysis, run = results.analysis, results.recorded
    settlement, energy = run.settling("settlement"), run.settling("kinetic_energy")
    fitted = settlement >= run.result.plateau_start
    moved = float(np.ptp(settlement[fitted])) if fitted.any() else 0.0
    if run.status != "plateau" or moved == 0.0:
        return float(run.result.kinetic_ratio)
    assembly = analysis.assembly
    pushed = np.linalg.norm(assembly.live_load[assembly.blocks.free, :3], axis=1).sum() if assembly.has_live_load else 1.0
    return float(np.fmin(run.result.kinetic_ratio, energy[fitted].max() / (scale(analysis) * pushed * moved)))


def slower_settings(results: Results, limit: float) -> LimitAnalysis | None:
    """Return the analysis with settings for a slower YADE run; None if this run is accurate enough or no slower run can be made.

    No slower run can be made after a timeout, after MOST_ATTEMPTS, if the scene fixes the speed, or if it would exceed the time limit.

    Parameters
    ----------
    results : Results
        Results with the run to be judged.
    limit : float
        Time limit of a run, s of wall time.
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
        slower = min(TRAVEL_PERIODS / periods, MOST_SLOWER)  # the speed may be the reason for the missing plateau
    else:
        return None
    if attempt.seconds * slower > limit:
        return None
    stop = attempt.settings["stop_uncertainty"]
    if not attempt.parts[FIT] <= FIT_SHARE * record.asked:  # NaN without a plateau
        stop /= slower
    settings = {"travel_periods": slower * periods, "stop_uncertainty": stop}
    settings = record.settings | _left_open(scene, settings)
    return replace(analysis, accuracy=replace(record, yade=(*record.yade, attempt), settings=settings))


def carry_attempts_over(rejected: Results, analysis: LimitAnalysis) -> LimitAnalysis:
    """Return the analysis with the attempts of a rejected model in front: they took time, but their errors do not apply here.

    Parameters
    ----------
    rejected : Results
        Results of the rejected model, with its run.
    analysis : LimitAnalysis
        Limit analysis of the model that replaces the rejected one.
    """
    before = rejected.analysis.accuracy
    if before is None or analysis.accuracy is None:
        return analysis
    result = rejected.recorded.result
    last = Attempt(dict(before.settings), result.reaction, {"another model": math.nan}, result.seconds)
    earlier = tuple(replace(attempt, parts={"another model": math.nan}) for attempt in before.yade)
    attempts = (*before.limit_analysis, *analysis.accuracy.limit_analysis)
    return replace(analysis, accuracy=replace(analysis.accuracy, limit_analysis=attempts, yade=(*earlier, last)))
