"""YADE's plateau against what limit analysis predicts: reaction, interval of the mechanism, friction state, mechanism.

The prediction is Coulomb's where the scene calls for it, else the associated answer; where joints slide, the latter is a bound.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from comparison.judge.check import Check, Verdict, inside, within
from comparison.judge.tolerances import HISTORY, REACH, REACTION, accuracy_share, is_broad, least_reaction, reaction_tolerance
from comparison.yade import Results, Run
from la_core.analysis import LimitAnalysis
from la_core.coulomb import SLIDING_SHARE, CoulombSolution
from la_core.limit import Drive, Status, consistent_reaction
from la_core.measures import mechanism, residuals

REACTION_CHECK, INTERVAL_CHECK = "reaction against prediction", "reaction within the mechanism's interval"
SIMILAR = 0.95  # mass-weighted assurance of two mechanisms that are the same to the eye
ADMISSIBLE = 0.02  # of the fastest block: joints' elastic strain while YADE's mechanism moves, which the flow rule does not know
SAME_MASS = 0.05  # share of the mass that may move in one method and not in the other
DOUBTFUL = 1e-2  # dilatancy residual: an iteration that leaves more of it predicts nothing, one that leaves less may confirm
STEADY = 5e-3  # of the reaction: scatter about the plateau's line above this is stick-slip
CONSISTENT = 1e-2  # of the reaction: slow steady runs are within 1e-4, runs that stick and slip miss by per cents

BOUND_ONLY = ", so the associated answer is only a lower bound: YADE may lie above it, and nothing sharper is known here."


@dataclass(frozen=True)
class Prediction:
    """What YADE's plateau is held against, in N or N m. obstacle: why it is no sharp prediction, "" where it is one.

    interval: what the mechanism alone allows. slides: whether loaded joints slide. share: tolerance of the reaction.
    doubt: why it may confirm YADE but not contradict it, "" where it may do both.
    """

    value: float
    interval: tuple[float, float]
    twists: np.ndarray
    slides: bool
    share: float
    obstacle: str
    doubt: str = ""


def predicted(results: Results) -> Prediction:
    """The sharpest prediction that limit analysis has for this scene."""
    analysis = results.analysis
    least, coulomb, assembly = analysis.bounds[Drive.YIELDING], analysis.coulomb, analysis.assembly
    if slides_unforeseen(results):
        obstacle = 'Joints slide in YADE and in no mechanism of limit analysis; ask for effects.friction = "coulomb".'
        return Prediction(least.value, (math.nan, math.nan), least.twists, True, REACTION, obstacle)
    if coulomb is not None and coulomb.status in (Status.SOLVED, Status.INACCURATE):
        slides = mechanism.sliding_share(assembly, coulomb.twists, coulomb.forces) > SLIDING_SHARE or _slides_in_yade(results)
        share = HISTORY + abs(coulomb.drift) if slides else REACTION
        share += REACH if assembly.effects.reach else 0.0
        left = f"dilatancy residual {coulomb.dilatancy_residual:.1e}, strain residual {coulomb.strain_residual:.1e}"
        doubt = "" if coulomb.status is Status.SOLVED else f"The Coulomb iteration has not converged ({left})."
        if doubt and not (coulomb.dilatancy_residual <= DOUBTFUL and abs(coulomb.drift) <= DOUBTFUL):
            return Prediction(coulomb.value, coulomb.interval, coulomb.twists, slides, share, obstacle=doubt)
        share += _spurious_share(analysis, coulomb) if doubt else 0.0
        return Prediction(coulomb.value, coulomb.interval, coulomb.twists, slides, share, "", doubt)
    slides = mechanism.sliding_share(assembly, least.twists, least.forces) > SLIDING_SHARE or _slides_in_yade(results)
    what = {"none-slides": "Joints slide in YADE, which the scene excludes in limit analysis"}
    obstacle = what.get(assembly.effects.friction, "Joints slide in the mechanism and real friction does not dilate") + BOUND_ONLY
    return Prediction(least.value, (math.nan, math.nan), least.twists, slides, REACTION, obstacle if slides else "")


def _spurious_share(analysis: LimitAnalysis, coulomb: CoulombSolution) -> float:
    """By how much of the reaction the dilation that is left may shift it: its work, by the balance of power of one mechanism."""
    settling = float(np.maximum(np.sum(analysis.assembly.dead_load * coulomb.twists, axis=1), 0.0).sum())
    return coulomb.dilatancy_residual * settling / abs(coulomb.value) if coulomb.value else math.inf


def slides_unforeseen(results: Results) -> bool:
    """Whether joints slide in YADE though limit analysis found none that does, so that friction was left out."""
    analysis = results.analysis
    effects = analysis.assembly.effects
    return effects.friction == "none-slides" and not effects.sliding_excluded and _slides_in_yade(results)


def _slides_in_yade(results: Results) -> bool:
    """Whether joints slide in YADE's mechanism as limit analysis does not allow: faster than they part, without penetrating."""
    analysis, run = results.analysis, results.recorded
    twists = run.mechanism()
    if np.isnan(twists).any():
        return False
    penetrates = residuals.penetration(analysis.assembly, twists) > ADMISSIBLE
    return not penetrates and residuals.flow_rule_violation(analysis.assembly, twists) > ADMISSIBLE


def check_prediction(results: Results) -> Iterator[Check]:
    """Reaction against prediction and interval, YADE's friction state, and the mechanisms."""
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
    by = f"YADE differs from the Coulomb prediction by {f'{apart / abs(value):.1%}' if abs(value) > least else f'{apart:.4g} {scene.unit}'}"
    if prediction.obstacle:
        return Check(name, Verdict.INCONCLUSIVE, value, reaction, reaction - value, None, scene.unit, prediction.obstacle)
    if is_broad(results):
        reason = "YADE's own uncertainty is too large to judge the prediction."
    elif not prediction.slides:
        reason = "No joint slides, so limit analysis predicts the reaction, but YADE's differs by more than both uncertainties."
        return within(name, value, reaction, tolerance, scene.unit, reason)
    elif misses and prediction.doubt:
        reason = f"{by}. {prediction.doubt}"
    elif misses and low - tolerance <= reaction <= high + tolerance:
        ends = f"{low:.6g} to {high:.6g} {scene.unit}"
        reason = f"{by}, but both lie in the interval {ends} within which friction's history decides{_stick_slip(run)}."
    elif misses and not alike >= SIMILAR:
        reason = f"{by} and moves by another mechanism (assurance {alike:.3f}): the history of friction decides between them."
    else:
        reason = f"{by}, more than friction's history and both uncertainties explain."
        return within(name, value, reaction, tolerance, scene.unit, reason)
    return Check(name, Verdict.INCONCLUSIVE, value, reaction, reaction - value, tolerance, scene.unit, reason)


def _check_interval(results: Results, prediction: Prediction, alike: float) -> Iterator[Check]:
    """The interval binds every method that moves by the same mechanism."""
    scene, analysis, run = results.scene, results.analysis, results.recorded
    if any(math.isnan(end) for end in prediction.interval):
        return
    reason = "YADE's reaction lies outside what the Coulomb mechanism allows, whatever the history of friction."
    tolerance = reaction_tolerance(results, max(REACTION, accuracy_share(analysis)))
    check = inside(INTERVAL_CHECK, prediction.interval, run.result.reaction, tolerance, scene.unit, reason)
    if check.verdict is Verdict.DISAGREE and (prediction.doubt or not alike >= SIMILAR):
        other = f"YADE moves by another mechanism (assurance {alike:.3f}), which the interval of this one does not bind."
        reason = f"{prediction.doubt or other} {check.reason}"
        check = Check(check.name, Verdict.INCONCLUSIVE, *_numbers(check), check.unit, reason)
    yield check


def _numbers(check: Check) -> tuple[float | None, float | None, float | None, float | None]:
    return check.limit_analysis, check.yade, check.difference, check.tolerance


def _check_consistency(results: Results) -> Check:
    """The least reaction with friction limited by YADE's own normal forces is YADE's where every joint that should slide does."""
    scene, analysis, run = results.scene, results.analysis, results.recorded
    forces = run.plateau_forces()
    normal = np.maximum(analysis.assembly.split(forces)[0], 0.0)
    found, sharp = residuals.reaction(analysis.assembly, forces), consistent_reaction(analysis.assembly, normal)
    name = "YADE's friction state"
    if sharp.status is not Status.SOLVED:
        reason = "YADE's mean normal forces on the plateau are not those of one quasi-static state."
        return Check(name, Verdict.INCONCLUSIVE, None, found, None, None, scene.unit, reason)
    tolerance = max(CONSISTENT * abs(found), reaction_tolerance(results, 0.0))
    reason = "With friction limited by YADE's own normal forces a lower reaction is possible: not every joint slides that should."
    check = within(name, sharp.value, found, tolerance, scene.unit, reason + _stick_slip(run))
    return check if check.verdict is Verdict.AGREE else Check(name, Verdict.INCONCLUSIVE, *_numbers(check), check.unit, check.reason)


def _check_steadiness(run: Run) -> Check:
    """Names stick-slip; it is no fault, the plateau's uncertainty counts it."""
    scatter = run.scatter()
    named = (
        f"Stick-slip: the reaction scatters by {scatter:.1%} about its plateau, which its uncertainty counts." if scatter > STEADY else ""
    )
    verdict = Verdict.AGREE if math.isfinite(scatter) else Verdict.INCONCLUSIVE
    reason = named or ("" if math.isfinite(scatter) else "YADE recorded too little of the plateau to tell its scatter.")
    return Check("steadiness of the plateau", verdict, None, scatter if math.isfinite(scatter) else None, None, STEADY, "of R", reason)


def _stick_slip(run: Run) -> str:
    scatter = run.scatter()
    return f" (stick-slip: scatter {scatter:.1%})" if scatter > STEADY else ""


def _check_mechanism(results: Results, prediction: Prediction, alike: float) -> Iterator[Check]:
    analysis, run = results.analysis, results.recorded
    found, blocks = run.mechanism(), analysis.assembly.blocks
    if np.isnan(found).any():
        reason = "YADE stored fewer than two states on the plateau, so its mechanism is not known."
        yield Check("mechanism similarity", Verdict.INCONCLUSIVE, reason=reason)
        return
    differ = mechanism.moving(blocks, prediction.twists) != mechanism.moving(blocks, found)
    mass = float(blocks.mass[differ].sum() / analysis.assembly.movable_mass)
    if prediction.slides and analysis.coulomb is None:
        other, why = Verdict.INCONCLUSIVE, " The associated mechanism dilates where joints slide; real friction does not."
    elif prediction.slides:
        other, why = Verdict.INCONCLUSIVE, " With friction that does not dilate, the mechanism need not be unique."
    elif _is_collapse_mechanism(results, found):
        other, why = Verdict.AGREE, " YADE's is admissible and does the same work, so the collapse mechanism is not unique."
    else:
        other, why = Verdict.DISAGREE, ""
    same = alike >= SIMILAR
    reason = "" if same else f"The mechanisms differ (assurance {alike:.3f}).{why}"
    yield Check("mechanism similarity", Verdict.AGREE if same else other, 1.0, alike, alike - 1.0, 1.0 - SIMILAR, "", reason)
    same = mass <= SAME_MASS
    reason = "" if same else f"Blocks with {mass:.0%} of the mass move in one method only.{why}"
    shares = [mechanism.moving_mass_share(analysis.assembly, twists) for twists in (prediction.twists, found)]
    yield Check("moving blocks", Verdict.AGREE if same else other, shares[0], shares[1], mass, SAME_MASS, "of the mass", reason)


def _is_collapse_mechanism(results: Results, twists: np.ndarray) -> bool:
    """Whether twists (B, 6) for the support's unit motion solve limit analysis, too: they obey the flow rule and do its work."""
    analysis = results.analysis
    work = float(np.sum(analysis.assembly.dead_load * twists))
    misses = abs(work - analysis.bounds[Drive.YIELDING].value)
    obeys = residuals.flow_rule_violation(analysis.assembly, twists) <= ADMISSIBLE
    return obeys and misses <= reaction_tolerance(results)
