"""The prediction of limit analysis for YADE's plateau, and the reasons why it may not be sharp.

It is the Coulomb prediction if there is one, otherwise the associated answer. If joints slide, the associated answer is only a bound: a
lower one of a reaction, an upper one of a multiplier. A method whose own results raise a doubt may confirm the other method but not
contradict it.
"""

import math
from dataclasses import dataclass

import numpy as np

from comparison.judge.checks import next_steps
from comparison.judge.checks.mechanisms import ADMISSIBLE, BOUNDS_LEFT, DILATES, EXCLUDED
from comparison.judge.checks.tolerances import stated_uncertainty
from comparison.numbers import format_number
from comparison.yade import Results
from la_core.coulomb import SLIDING_SHARE, CoulombSolution, is_changed_by_release
from la_core.limit import Drive, Status
from la_core.measures import mechanism, residuals
from la_core.model import Assembly

BOUND_ONLY = {
    Drive.YIELDING: "The associated answer is then only a lower bound of the reaction, and YADE may lie above it.",
    Drive.LIVE: "The associated answer is then only an upper bound of the multiplier, and YADE may lie below it.",
}
MAY_SLIDE = "The scene leaves friction without dilatancy out of limit analysis. Joints may slide in YADE, whose mechanism is unknown."
FELL = "the blocks slide and fall, under gravity or on the way to a plateau, although an equilibrium exists"  # of a prediction


@dataclass(frozen=True)
class Release:
    """The prediction of limit analysis after turning blocks have released a thrust.

    Attributes
    ----------
    value : float
        Predicted reaction, N or N m, or multiplier.
    stated : float
        Uncertainty that limit analysis states, in the unit of the value.
    is_other : bool
        Whether the value certainly differs from the value before the release.
    """

    value: float
    stated: float
    is_other: bool


@dataclass(frozen=True)
class Prediction:
    """The prediction for YADE's plateau.

    Attributes
    ----------
    value : float
        Predicted reaction, N or N m, or multiplier.
    interval : tuple of float
        Least and greatest value that the predicted mechanism allows; NaN where unknown.
    twists : np.ndarray
        Predicted mechanism (B, 6): twist of each block for a unit motion of the support, or displacement along the live load.
    slides : bool
        Whether loaded joints slide, or may slide.
    stated : float
        Uncertainty that limit analysis states, in the unit of the value.
    release : Release or None
        The value after turning blocks have released a thrust; None if limit analysis has not computed the release.
    obstacle : str
        Reason why the value is no sharp prediction; "" for a sharp one.
    doubt : str
        Reason why the value may confirm YADE but not contradict it; "" if it may do both.
    next_step : str
        Next step of a user with this obstacle or doubt.
    """

    value: float
    interval: tuple[float, float]
    twists: np.ndarray
    slides: bool
    stated: float = 0.0
    release: Release | None = None
    obstacle: str = ""
    doubt: str = ""
    next_step: str = ""


def predicted(results: Results) -> Prediction:
    """Return the sharpest prediction that limit analysis has for this scene."""
    analysis = results.analysis
    bound, coulomb, assembly = analysis.bounds[analysis.main], analysis.coulomb, analysis.assembly
    unknown, motion = (math.nan, math.nan), results.per_motion(bound.twists)
    of_bound = float(np.nan_to_num(bound.error))  # a file of an earlier version has no error
    if slides_unforeseen(results):
        obstacle = "Joints slide in YADE, but in no mechanism of limit analysis."
        return Prediction(bound.value, unknown, motion, True, of_bound, obstacle=obstacle, next_step=next_steps.MODEL_SLIDING)
    if coulomb is not None and coulomb.status in (Status.SOLVED, Status.INACCURATE):
        slides = mechanism.sliding_share(assembly, coulomb.twists, coulomb.forces) > SLIDING_SHARE or _slides_in_yade(results)
        doubt, step = _doubt(coulomb, results.scene.unit)
        stated, release = stated_uncertainty(analysis), _release(coulomb, assembly)
        path_motion = results.per_motion(coulomb.twists)
        return Prediction(coulomb.value, coulomb.interval, path_motion, slides, stated, release, doubt=doubt, next_step=step)
    slides = mechanism.sliding_share(assembly, bound.twists, bound.forces) > SLIDING_SHARE or _slides_in_yade(results)
    if not slides and _may_slide_in_yade(results):
        return Prediction(bound.value, unknown, motion, True, of_bound, obstacle=MAY_SLIDE, next_step=next_steps.MODEL_SLIDING)
    obstacle, step = _associated_obstacle(assembly.effects.friction, analysis.main, coulomb) if slides else ("", "")
    return Prediction(bound.value, unknown, motion, slides, of_bound, obstacle=obstacle, next_step=step)


def _release(coulomb: CoulombSolution, assembly: Assembly) -> Release | None:
    if math.isnan(coulomb.released):
        return None
    is_other = is_changed_by_release(coulomb, assembly.in_value_unit(assembly.weight))
    return Release(coulomb.released, coulomb.released_uncertainty, is_other)


def _associated_obstacle(friction: str, drive: Drive, coulomb: CoulombSolution | None) -> tuple[str, str]:
    """Return the reason why the associated answer is no prediction for sliding joints, and the next step. friction: modelled effect."""
    if friction == "none-slides":
        return f"{EXCLUDED} {BOUND_ONLY[drive]}", next_steps.MODEL_SLIDING
    dilates = f"{DILATES} {BOUND_ONLY[drive]}"
    if coulomb is not None and math.isinf(coulomb.uncertainty):
        return f"The prediction has no value: {FELL}. {dilates}", BOUNDS_LEFT
    return dilates, next_steps.FINER_PATHS if friction == "coulomb" else next_steps.MODEL_SLIDING


def _doubt(coulomb: CoulombSolution, unit: str) -> tuple[str, str]:
    """Return the reason why a prediction may confirm but not contradict YADE, and the next step; two times "" if it may do both."""
    if len(coulomb.plateaus):
        several = ", ".join(f"{format_number(value, 4)} {unit}".rstrip() for value in coulomb.plateaus.tolist())
        return f"The structure has several plateaus ({several}), so a single plateau cannot contradict YADE.", next_steps.LEAST_FAVOURABLE
    if coulomb.status is not Status.SOLVED:
        residual = f"largest residual {coulomb.certificate:.1e}"
        return f"The end of the path is no limit state ({residual}), so its value cannot contradict YADE.", next_steps.FINER_PATHS
    return "", ""


def slides_unforeseen(results: Results) -> bool:
    """Return whether joints slide in YADE although limit analysis found no sliding joint and therefore excluded sliding."""
    effects = results.analysis.assembly.effects
    return effects.friction == "none-slides" and not effects.sliding_excluded and _slides_in_yade(results)


def _may_slide_in_yade(results: Results) -> bool:
    """Return whether the scene excludes Coulomb friction in limit analysis, and YADE's mechanism is unknown."""
    excludes = results.scene.effects.friction in ("associated", "none-slides")
    return excludes and bool(np.isnan(results.recorded.mechanism()).any())


def _slides_in_yade(results: Results) -> bool:
    """Return whether joints of YADE's mechanism slide with less opening than the associated flow rule requires, without penetration."""
    analysis, run = results.analysis, results.recorded
    twists = run.mechanism()
    if np.isnan(twists).any():
        return False
    penetrates = residuals.penetration(analysis.assembly, twists) > ADMISSIBLE
    return not penetrates and residuals.flow_rule_violation(analysis.assembly, twists) > ADMISSIBLE
