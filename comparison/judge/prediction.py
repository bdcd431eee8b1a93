"""Compare YADE's plateau with the prediction of limit analysis: reaction, interval, friction state and mechanism.

The prediction is the Coulomb prediction where there is one, and the associated answer elsewhere. Where joints slide, the associated
answer is only a lower bound.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from comparison.judge.check import Check, Verdict, inside, within
from comparison.judge.tolerances import BROAD, HISTORY, REACH, REACTION, accuracy_share, is_broad, least_reaction, reaction_tolerance
from comparison.yade import Results, Run
from la_core.coulomb import SLIDING_SHARE, CoulombSolution
from la_core.limit import Drive, Status, consistent_reaction
from la_core.measures import mechanism, residuals

REACTION_CHECK, INTERVAL_CHECK = "reaction against prediction", "reaction within the mechanism's interval"
SIMILAR = 0.95  # modal assurance of two mechanisms that are the same to the eye
ADMISSIBLE = 0.02  # of the fastest block: joints' elastic strain while YADE's mechanism moves, which the flow rule does not know
SAME_MASS = 0.05  # share of the mass that may move in one method and not in the other
STEADY = 5e-3  # of the reaction: scatter about the plateau's line above this is stick-slip
CONSISTENT = 1e-2  # of the reaction: slow steady runs are within 1e-4, runs that stick and slip miss by per cents

BOUND_ONLY = "The associated answer is then only a lower bound of the reaction, and YADE may lie above it."
MODEL_SLIDING = 'Set friction = "coulomb" in the scene\'s [effects] table for a prediction.'


@dataclass(frozen=True)
class Prediction:
    """The prediction that YADE's plateau is compared with.

    Attributes
    ----------
    value : float
        Predicted reaction, N or N m.
    interval : tuple of float
        Least and greatest reaction that the predicted mechanism allows, N or N m; NaN where unknown.
    twists : np.ndarray
        Predicted mechanism (B, 6): twist of each block for a unit motion of the support.
    slides : bool
        Whether loaded joints slide.
    share : float
        Tolerance of the reaction, as a share of it.
    obstacle : str
        Why the value is no sharp prediction; "" where it is one.
    doubt : str
        Why the value may confirm YADE but not contradict it; "" where it may do both.
    """

    value: float
    interval: tuple[float, float]
    twists: np.ndarray
    slides: bool
    share: float
    obstacle: str
    doubt: str = ""


def predicted(results: Results) -> Prediction:
    """Return the sharpest prediction that limit analysis has for this scene."""
    analysis = results.analysis
    least, coulomb, assembly = analysis.bounds[Drive.YIELDING], analysis.coulomb, analysis.assembly
    if slides_unforeseen(results):
        obstacle = f"Joints slide in YADE, but in no mechanism of limit analysis. {MODEL_SLIDING}"
        return Prediction(least.value, (math.nan, math.nan), least.twists, True, REACTION, obstacle)
    if coulomb is not None and coulomb.status in (Status.SOLVED, Status.INACCURATE):
        slides = mechanism.sliding_share(assembly, coulomb.twists, coulomb.forces) > SLIDING_SHARE or _slides_in_yade(results)
        stated = coulomb.uncertainty if math.isfinite(coulomb.uncertainty) else 0.0  # files of version 0.2.0 state none
        unsure = stated / max(abs(coulomb.value), least_reaction(analysis))
        share = (HISTORY if slides else REACTION) + unsure + (REACH if assembly.effects.reach else 0.0)
        obstacle = (
            f"Limit analysis states an uncertainty of {unsure:.1%}, too large to judge YADE. Refine it with --accuracy."
            if unsure > BROAD
            else ""
        )
        return Prediction(coulomb.value, coulomb.interval, coulomb.twists, slides, share, obstacle, "" if obstacle else _doubt(coulomb))
    slides = mechanism.sliding_share(assembly, least.twists, least.forces) > SLIDING_SHARE or _slides_in_yade(results)
    obstacle = _associated_obstacle(assembly.effects.friction) if slides else ""
    return Prediction(least.value, (math.nan, math.nan), least.twists, slides, REACTION, obstacle)


def _associated_obstacle(friction: str) -> str:
    """Why the associated answer is no prediction where joints slide, for the modelled effect `friction`."""
    if friction == "none-slides":
        return f"Joints slide in YADE, but the scene excludes sliding in limit analysis. {BOUND_ONLY} {MODEL_SLIDING}"
    dilates = f"Sliding joints dilate in the associated mechanism and not in YADE. {BOUND_ONLY}"
    return dilates if friction == "coulomb" else f"{dilates} {MODEL_SLIDING}"


def _doubt(coulomb: CoulombSolution) -> str:
    """Why a prediction may confirm YADE but not contradict it, or ""."""
    if len(coulomb.plateaus):
        several = ", ".join(f"{value:.4g}" for value in coulomb.plateaus)
        return f"The structure has several plateaus ({several}), so a single one cannot contradict YADE."
    if coulomb.status is not Status.SOLVED:
        return f"The end of the path is no limit state (largest residual {coulomb.certificate:.1e}), so its value cannot contradict YADE."
    return ""


def slides_unforeseen(results: Results) -> bool:
    """Return whether joints slide in YADE although limit analysis found no sliding joint and therefore left sliding out."""
    analysis = results.analysis
    effects = analysis.assembly.effects
    return effects.friction == "none-slides" and not effects.sliding_excluded and _slides_in_yade(results)


def _slides_in_yade(results: Results) -> bool:
    """Return whether joints of YADE's mechanism slide faster than they open, without penetrating: limit analysis excludes that."""
    analysis, run = results.analysis, results.recorded
    twists = run.mechanism()
    if np.isnan(twists).any():
        return False
    penetrates = residuals.penetration(analysis.assembly, twists) > ADMISSIBLE
    return not penetrates and residuals.flow_rule_violation(analysis.assembly, twists) > ADMISSIBLE


def check_prediction(results: Results) -> Iterator[Check]:
    """Yield the checks of the reaction, its interval, YADE's friction state and the mechanism."""
    analysis, run = results.analysis, results.recorded
    prediction = predicted(results)
    alike = mechanism.similarity(analysis.assembly.blocks, prediction.twists, run.mechanism())
    yield _check_reaction(results, prediction, alike)
    if prediction.slides and analysis.coulomb is not None:
        yield from _check_interval(results, prediction, alike)
        yield _check_consistency(results)
        yield _check_steadiness(run)
    yield from _check_mechanism(results, prediction, alike)


def _check_reaction(results: Results, prediction: Prediction, alike: float) -> Check:
    scene, analysis, run = results.scene, results.analysis, results.recorded
    name, value, reaction = REACTION_CHECK, prediction.value, run.result.reaction
    tolerance = reaction_tolerance(results, max(prediction.share, 2.0 * accuracy_share(analysis)))  # either method may be off
    misses = abs(reaction - value) > tolerance
    low, high = prediction.interval
    apart, least = abs(reaction - value), least_reaction(analysis)
    distance = f"{apart / abs(value):.1%}" if abs(value) > least else f"{apart:.4g} {scene.unit}"
    by = f"YADE differs from the Coulomb prediction by {distance}"
    if prediction.obstacle:
        return Check(name, Verdict.INCONCLUSIVE, value, reaction, reaction - value, None, scene.unit, prediction.obstacle)
    if is_broad(results):
        size = f"{run.result.uncertainty:.3g} {scene.unit}"
        reason = f"YADE's uncertainty of {size} is too large to judge the prediction. Run it slower ([yade] speed)."
    elif not prediction.slides:
        reason = f"YADE differs from limit analysis by {distance}, more than both uncertainties, although no joint slides."
        return within(name, value, reaction, tolerance, scene.unit, reason)
    elif misses and prediction.doubt:
        reason = f"{by}. {prediction.doubt}"
    elif misses and low - tolerance <= reaction <= high + tolerance:
        ends = f"{low:.6g} to {high:.6g} {scene.unit}"
        reason = f"{by}, but both lie in the interval {ends} within which friction's history decides{_stick_slip(run)}."
    elif misses and not alike >= SIMILAR:
        reason = f"{by} and moves by another mechanism (modal assurance {alike:.3f}). Friction's history decides which one forms."
    else:
        reason = f"{by}. Friction's history and both uncertainties explain at most {tolerance:.4g} {scene.unit}."
        return within(name, value, reaction, tolerance, scene.unit, reason)
    return Check(name, Verdict.INCONCLUSIVE, value, reaction, reaction - value, tolerance, scene.unit, reason)


def _check_interval(results: Results, prediction: Prediction, alike: float) -> Iterator[Check]:
    """Yield the check that YADE's reaction lies in the interval, which binds every method with the same mechanism."""
    scene, analysis, run = results.scene, results.analysis, results.recorded
    if any(math.isnan(end) for end in prediction.interval):
        return
    reason = "YADE's reaction lies outside the interval that the Coulomb mechanism allows for any history of friction."
    tolerance = reaction_tolerance(results, max(REACTION, accuracy_share(analysis)))
    check = inside(INTERVAL_CHECK, prediction.interval, run.result.reaction, tolerance, scene.unit, reason)
    if check.verdict is Verdict.DISAGREE and (prediction.doubt or not alike >= SIMILAR):
        other = f"YADE moves by another mechanism (modal assurance {alike:.3f}), to which the Coulomb interval does not apply."
        reason = f"{prediction.doubt or other} {check.reason}"
        check = Check(check.name, Verdict.INCONCLUSIVE, *_numbers(check), check.unit, reason)
    yield check


def _numbers(check: Check) -> tuple[float | None, float | None, float | None, float | None]:
    return check.limit_analysis, check.yade, check.difference, check.tolerance


def _check_consistency(results: Results) -> Check:
    """Compare YADE's reaction with the least one that its own normal forces allow; they agree where every joint slides that should."""
    scene, analysis, run = results.scene, results.analysis, results.recorded
    forces = run.plateau_forces()
    normal = np.maximum(analysis.assembly.split(forces)[0], 0.0)
    reaction, least = residuals.reaction(analysis.assembly, forces), consistent_reaction(analysis.assembly, normal)
    name = "YADE's friction state"
    if least.status is not Status.SOLVED:
        ended = f"Limit analysis with YADE's mean normal forces on the plateau ended as {least.status}"
        reason = f"{ended}, so these forces are not those of one quasi-static state."
        return Check(name, Verdict.INCONCLUSIVE, None, reaction, None, None, scene.unit, reason)
    tolerance = max(CONSISTENT * abs(reaction), reaction_tolerance(results, 0.0))
    possible = f"With friction limited by YADE's own normal forces, the reaction could be as low as {least.value:.6g} {scene.unit}"
    reason = f"{possible}: not every joint slides that should{_stick_slip(run)}."
    check = within(name, least.value, reaction, tolerance, scene.unit, reason)
    return check if check.verdict is Verdict.AGREE else Check(name, Verdict.INCONCLUSIVE, *_numbers(check), check.unit, check.reason)


def _check_steadiness(run: Run) -> Check:
    """Report stick-slip, which is no fault: the plateau's uncertainty includes it."""
    scatter = run.scatter()
    name, unit = "steadiness of the plateau", "of R"
    if not math.isfinite(scatter):
        reason = "YADE recorded too few rows on the plateau to measure its scatter."
        return Check(name, Verdict.INCONCLUSIVE, None, None, None, STEADY, unit, reason)
    slips = f"Stick-slip: the reaction scatters by {scatter:.1%} about its plateau; the uncertainty of the reaction includes this."
    return Check(name, Verdict.AGREE, None, scatter, None, STEADY, unit, slips if scatter > STEADY else "")


def _stick_slip(run: Run) -> str:
    scatter = run.scatter()
    return f" (stick-slip: scatter {scatter:.1%})" if scatter > STEADY else ""


def _check_mechanism(results: Results, prediction: Prediction, alike: float) -> Iterator[Check]:
    analysis, run = results.analysis, results.recorded
    twists, blocks = run.mechanism(), analysis.assembly.blocks
    if np.isnan(twists).any():
        reason = "YADE stored fewer than two states on the plateau, so its mechanism is unknown. Store more states ([yade] poses)."
        yield Check("mechanism similarity", Verdict.INCONCLUSIVE, reason=reason)
        return
    differ = mechanism.moving(blocks, prediction.twists) != mechanism.moving(blocks, twists)
    mass = float(blocks.mass[differ].sum() / analysis.assembly.movable_mass)
    if prediction.slides and analysis.coulomb is None:
        other, why = Verdict.INCONCLUSIVE, " Sliding joints dilate in the associated mechanism and not in YADE."
    elif prediction.slides:
        other, why = Verdict.INCONCLUSIVE, " Where joints slide without dilatancy, the mechanism need not be unique."
    elif _is_collapse_mechanism(results, twists):
        other, why = Verdict.AGREE, " YADE's mechanism is admissible and does the same work, so the collapse mechanism is not unique."
    else:
        other, why = Verdict.DISAGREE, ""
    same = alike >= SIMILAR
    reason = "" if same else f"The mechanisms differ (modal assurance {alike:.3f}, at least {SIMILAR} for agreement).{why}"
    yield Check("mechanism similarity", Verdict.AGREE if same else other, 1.0, alike, alike - 1.0, 1.0 - SIMILAR, "", reason)
    same = mass <= SAME_MASS
    reason = "" if same else f"Blocks with {mass:.0%} of the mass move in one method only ({SAME_MASS:.0%} accepted).{why}"
    shares = [mechanism.moving_mass_share(analysis.assembly, motion) for motion in (prediction.twists, twists)]
    yield Check("moving blocks", Verdict.AGREE if same else other, shares[0], shares[1], mass, SAME_MASS, "of the mass", reason)


def _is_collapse_mechanism(results: Results, twists: np.ndarray) -> bool:
    """Return whether twists (B, 6) for a unit motion of the support solve limit analysis, too: they obey the flow rule and do its work."""
    analysis = results.analysis
    work = float(np.sum(analysis.assembly.dead_load * twists))
    misses = abs(work - analysis.bounds[Drive.YIELDING].value)
    obeys = residuals.flow_rule_violation(analysis.assembly, twists) <= ADMISSIBLE
    return obeys and misses <= reaction_tolerance(results)
