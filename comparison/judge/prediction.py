"""Compare YADE's plateau with the prediction of limit analysis: reaction, interval and friction state.

The prediction is the Coulomb prediction where there is one, and the associated answer elsewhere. Where joints slide, the associated
answer is only a lower bound. A method in doubt, by evidence of its own, may confirm the other one but not contradict it.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from comparison.judge.curves import earlier_agreement
from comparison.judge.mechanisms import ADMISSIBLE, BOUNDS_LEFT, SIMILAR, check_mechanism
from comparison.judge.tolerances import (
    UNCERTAIN,
    Unsure,
    floor,
    least_reaction,
    reaction_tolerance,
    stated_uncertainty,
    unbalanced,
    unsure_methods,
)
from comparison.numbers import format_number, settlement_text
from comparison.verdict import HARDER, Check, Verdict, inside, within
from comparison.yade import Results
from la_core import exchange
from la_core.analysis import wedging
from la_core.coulomb import SLIDING_SHARE, CoulombSolution
from la_core.limit import Drive, Status, consistent_reaction
from la_core.measures import mechanism, residuals

STEADY = 5e-3  # of the reaction: scatter about the plateau's line above this is stick-slip
CONSISTENT = 1e-2  # of the reaction: slow steady runs are within 1e-4, runs that stick and slip miss by per cents

BOUND_ONLY = {
    Drive.YIELDING: "The associated answer is then only a lower bound of the reaction, and YADE may lie above it.",
    Drive.LIVE: "The associated answer is then only an upper bound of the multiplier, and YADE may lie below it.",
}
MODEL_SLIDING = 'Set friction = "coulomb" in the scene\'s [effects] table for a prediction.'
FINER_PATHS = f"Let limit analysis follow finer paths: this is cheaper than a finer run of YADE. {HARDER}"
FELL = "the blocks slide and fall, under gravity or on the way to a plateau, although an equilibrium exists"  # of a prediction
SLOWER_RUN = f"Run YADE more slowly (set [yade] speed to half of the speed in the report) and on stiffer joints. {HARDER}"
BOTH_FINER = f"Repeat both methods with finer settings. {HARDER}"
TWO_LEVELS = f'If the curve rests there, turning blocks may have released a thrust: set [effects] rotation = "finite". If not: {BOTH_FINER}'
BOUNDS = "Work with the bounds: they hold for every history of friction, the interval only for those that end in its mechanism."
LEAST_FAVOURABLE = "Work with the least favourable plateau, or with the bounds: a small disturbance decides between them."


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
    stated : float
        Uncertainty that limit analysis states, N or N m.
    obstacle : str
        Why the value is no sharp prediction; "" where it is one.
    doubt : str
        Why the value may confirm YADE but not contradict it; "" where it may do both.
    next_step : str
        What a user can do about the obstacle or the doubt.
    """

    value: float
    interval: tuple[float, float]
    twists: np.ndarray
    slides: bool
    stated: float = 0.0
    obstacle: str = ""
    doubt: str = ""
    next_step: str = ""


def predicted(results: Results) -> Prediction:
    """Return the sharpest prediction that limit analysis has for this scene."""
    analysis = results.analysis
    bound, coulomb, assembly = analysis.bounds[analysis.main], analysis.coulomb, analysis.assembly
    unknown = (math.nan, math.nan)
    if slides_unforeseen(results):
        obstacle = "Joints slide in YADE, but in no mechanism of limit analysis."
        return Prediction(bound.value, unknown, results.per_motion(bound.twists), True, obstacle=obstacle, next_step=MODEL_SLIDING)
    if coulomb is not None and coulomb.status in (Status.SOLVED, Status.INACCURATE):
        slides = mechanism.sliding_share(assembly, coulomb.twists, coulomb.forces) > SLIDING_SHARE or _slides_in_yade(results)
        doubt, step = _doubt(coulomb, results.scene.unit)
        stated = stated_uncertainty(analysis)
        return Prediction(coulomb.value, coulomb.interval, results.per_motion(coulomb.twists), slides, stated, doubt=doubt, next_step=step)
    slides = mechanism.sliding_share(assembly, bound.twists, bound.forces) > SLIDING_SHARE or _slides_in_yade(results)
    obstacle, step = _associated_obstacle(assembly.effects.friction, analysis.main, coulomb) if slides else ("", "")
    return Prediction(bound.value, unknown, results.per_motion(bound.twists), slides, obstacle=obstacle, next_step=step)


def _associated_obstacle(friction: str, drive: Drive, coulomb: CoulombSolution | None) -> tuple[str, str]:
    """Why the associated answer is no prediction where joints slide, for the modelled effect `friction`, and what to do."""
    if friction == "none-slides":
        return f"Joints slide in YADE, but the scene excludes sliding in limit analysis. {BOUND_ONLY[drive]}", MODEL_SLIDING
    dilates = f"Sliding joints dilate in the associated mechanism and not in YADE. {BOUND_ONLY[drive]}"
    if coulomb is not None and math.isinf(coulomb.uncertainty):
        return f"The prediction has no value: {FELL}. {dilates}", BOUNDS_LEFT
    return dilates, FINER_PATHS if friction == "coulomb" else MODEL_SLIDING


def _doubt(coulomb: CoulombSolution, unit: str) -> tuple[str, str]:
    """Why a prediction may confirm YADE but not contradict it, and what to do; two times "" where it may do both."""
    if len(coulomb.plateaus):
        several = ", ".join(f"{format_number(value, 4)} {unit}".rstrip() for value in coulomb.plateaus.tolist())
        return f"The structure has several plateaus ({several}), so a single plateau cannot contradict YADE.", LEAST_FAVOURABLE
    if coulomb.status is not Status.SOLVED:
        residual = f"largest residual {coulomb.certificate:.1e}"
        return f"The end of the path is no limit state ({residual}), so its value cannot contradict YADE.", FINER_PATHS
    return "", ""


def slides_unforeseen(results: Results) -> bool:
    """Return whether joints slide in YADE although limit analysis found no sliding joint and therefore left sliding out."""
    effects = results.analysis.assembly.effects
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
    """Yield the checks of the reaction, its interval, YADE's friction state and the mechanism.

    The reaction decides. Where it agrees, what the other checks find is a remark, unless it contradicts limit analysis outright.
    """
    analysis, run = results.analysis, results.recorded
    prediction = predicted(results)
    state = _check_consistency(results) if prediction.slides and analysis.coulomb is not None else None
    yield (reaction := _check_reaction(results, prediction, state))
    agrees = reaction.verdict is Verdict.AGREE
    if state is not None:
        yield from _check_interval(results, prediction)
        yield _remark(state) if agrees else state
        yield _check_steadiness(results)
    determined = not (prediction.slides or analysis.is_without_bound)
    for check in check_mechanism(results, prediction.twists, determined, is_alone=prediction.slides and analysis.coulomb is None):
        yield _remark(check) if agrees and not determined and np.isfinite(run.mechanism()).all() else check


def _remark(check: Check) -> Check:
    """Return an inconclusive check as one that agrees, its reason as a remark."""
    return replace(check, verdict=Verdict.AGREE, next_step="") if check.verdict is Verdict.INCONCLUSIVE else check


def _check_reaction(results: Results, prediction: Prediction, state: Check | None) -> Check:
    """Compare the reactions. state: the check of YADE's friction state, where there is one."""
    scene, run = results.scene, results.recorded
    name, value, reaction = f"{scene.quantity} against prediction", prediction.value, run.result.reaction
    if prediction.obstacle:
        numbers = value, reaction, reaction - value, None
        return Check(name, Verdict.INCONCLUSIVE, *numbers, scene.unit, prediction.obstacle, prediction.next_step)
    tolerance = reaction_tolerance(results, prediction.stated)
    check = within(name, value, reaction, tolerance, scene.unit, _difference_words(results, prediction), BOTH_FINER)
    if unsure := unsure_methods(results, prediction.stated):
        return _unsure_check(results, check, unsure)
    if check.verdict is Verdict.DISAGREE:
        doubts = [(prediction.doubt, prediction.next_step), _other_history(results), _jump(results)]
        doubts += [("YADE's own state is in doubt.", SLOWER_RUN)] if state is not None and state.verdict is not Verdict.AGREE else []
        if known := [(doubt, step) for doubt, step in doubts if doubt]:
            return replace(check, verdict=Verdict.INCONCLUSIVE, reason=f"{check.reason} {known[0][0]}", next_step=known[0][1])
        if prediction.slides and (before := earlier_agreement(results, value, tolerance)):
            is_small = results.analysis.assembly.effects.rotation == "small"
            return replace(check, reason=f"{check.reason} {before}", next_step=TWO_LEVELS if is_small else BOTH_FINER)
    return check


def _unsure_check(results: Results, check: Check, unsure: list[Unsure]) -> Check:
    """Return the check of the reaction where a method is too uncertain: the floor alone, which no doubt widens, may still make it agree."""
    reason = " ".join(_unsure_words(one, results.scene.unit) for one in unsure)
    if check.difference is not None and abs(check.difference) <= floor(results):
        alike = f"The {results.scene.quantity}s agree within the floor of the tolerance alone."
        return replace(check, verdict=Verdict.AGREE, reason=f"{reason} {alike}")
    step = FINER_PATHS if unsure[0].method == "limit analysis" else SLOWER_RUN
    return replace(check, verdict=Verdict.INCONCLUSIVE, reason=reason, next_step=step)


def _other_history(results: Results) -> tuple[str, str]:
    """Why both methods follow different histories of friction, and what to do; two times "" where nothing says so.

    Only a lifted support is excused: its lift is a history before the settlement, and the methods need not come to rest alike.
    """
    scene, analysis, run = results.scene, results.analysis, results.recorded
    if not wedging(scene) or analysis.coulomb is None or not len(recorded := run.settling("reaction")):
        return "", ""
    rest, other = analysis.coulomb.at_rest, float(recorded[0])
    if not abs(other - rest) > UNCERTAIN * max(abs(rest), least_reaction(analysis) / UNCERTAIN):
        return "", ""
    states = f"{rest:.6g} {scene.unit} in limit analysis, {other:.6g} {scene.unit} in YADE"
    return f"After the lift ([yade] wedging) the methods are at rest in different states ({states}): two histories of friction.", BOUNDS


def _jump(results: Results) -> tuple[str, str]:
    """Why a jump on YADE's way may have led to another plateau, and what to do; two times "" where no block jumped.

    Without a jump a wall of 250 blocks came to the plateau of limit analysis, and after jumps to others, 8 to 12 % higher.
    """
    settlement, sizes = (results.recorded.settling(name) for name in ("settlement", "unbalanced"))
    if not len(sizes) or not sizes.max() > exchange.JUMP * unbalanced(results):
        return "", ""
    place = settlement_text(settlement[sizes.argmax()], results.scene.settlement_unit)
    jump = f"of {sizes.max():.2g} mean block weights at a settlement of {place}"
    return f"On YADE's way a block jumped (unbalanced force {jump}), and a jump by inertia may lead to another plateau.", SLOWER_RUN


def _difference_words(results: Results, prediction: Prediction) -> str:
    scene, apart = results.scene, abs(results.recorded.result.reaction - prediction.value)
    is_small = not abs(prediction.value) > least_reaction(results.analysis)
    distance = f"{format_number(apart, 4)} {scene.unit}".rstrip() + ("" if is_small else f" ({apart / abs(prediction.value):.1%})")
    allowed = f"{format_number(reaction_tolerance(results, prediction.stated), 4)} {scene.unit}".rstrip()
    note = "" if prediction.slides else ", although no joint slides"
    return f"YADE differs from the prediction of limit analysis by {distance}{note}; both stated uncertainties and the floor are {allowed}."


def _unsure_words(unsure: Unsure, unit: str) -> str:
    size, allowed = (f"{format_number(value, 3)} {unit}".rstrip() for value in (unsure.uncertainty, unsure.allowed))
    named = "YADE" if unsure.method == "YADE" else "Limit analysis"
    return f"{named} states an uncertainty of {size} ({unsure.share:.1%}), too large to decide by ({allowed} allowed)."


def _check_interval(results: Results, prediction: Prediction) -> Iterator[Check]:
    """Yield the check that YADE's reaction lies in the interval, which binds every method with the same mechanism."""
    scene, analysis, run = results.scene, results.analysis, results.recorded
    if any(math.isnan(end) for end in prediction.interval):
        return
    reason = f"YADE's {scene.quantity} lies outside the interval that the Coulomb mechanism allows for any history of friction."
    tolerance = reaction_tolerance(results, prediction.stated)
    name = f"{scene.quantity} within the mechanism's interval"
    check = inside(name, prediction.interval, run.result.reaction, tolerance, scene.unit, reason, BOTH_FINER)
    alike = mechanism.similarity(analysis.assembly.blocks, prediction.twists, run.mechanism())
    if check.verdict is Verdict.DISAGREE and (prediction.doubt or not alike >= SIMILAR):
        other = f"YADE moves by another mechanism (modal assurance {alike:.3f}), to which the Coulomb interval does not apply."
        other = "YADE's mechanism is unknown, so that the Coulomb interval may not apply." if math.isnan(alike) else other
        check = replace(check, verdict=Verdict.INCONCLUSIVE, reason=f"{prediction.doubt or other} {check.reason}")
    yield check


def _check_consistency(results: Results) -> Check:
    """Compare YADE's reaction with the least one that its own normal forces allow; they agree where every joint slides that should.

    A multiplier is compared with the greatest one.
    """
    scene, analysis, run = results.scene, results.analysis, results.recorded
    forces = run.plateau_forces()
    normal = np.maximum(analysis.assembly.split(forces)[0], 0.0)
    is_live = scene.live is not None
    reaction = (residuals.multiplier if is_live else residuals.reaction)(analysis.assembly, forces)
    consistent = consistent_reaction(analysis.assembly, normal)
    name = "YADE's friction state"
    if consistent.status is not Status.SOLVED:
        ended = f"Limit analysis with YADE's mean normal forces on the plateau ended as {consistent.status}"
        reason = f"{ended}, so these forces are not those of one quasi-static state."
        return Check(name, Verdict.INCONCLUSIVE, None, reaction, None, None, scene.unit, reason, SLOWER_RUN)
    tolerance = max(CONSISTENT * abs(reaction), least_reaction(analysis)) + float(run.result.uncertainty)
    end = f"{'high' if is_live else 'low'} as {consistent.value:.6g} {scene.unit}".rstrip()
    possible = f"With friction limited by YADE's own normal forces, the {scene.quantity} could be as {end}"
    scatter = _scatter(results)
    slips = f" (stick-slip: scatter {scatter:.1%})" if scatter > STEADY else ""
    reason = f"{possible}: not every joint slides that should{slips}."
    check = within(name, consistent.value, reaction, tolerance, scene.unit, reason, SLOWER_RUN)
    return check if check.verdict is Verdict.AGREE else replace(check, verdict=Verdict.INCONCLUSIVE)


def _check_steadiness(results: Results) -> Check:
    """Report stick-slip, which is no fault: the plateau's uncertainty includes it."""
    scatter = _scatter(results)
    name, unit = "steadiness of the plateau", "of R"
    if not math.isfinite(scatter):
        reason = "YADE recorded too few rows on the plateau to measure its scatter."
        return Check(name, Verdict.AGREE, None, None, None, STEADY, unit, reason)
    what = results.scene.quantity
    slips = f"Stick-slip: the {what} scatters by {scatter:.1%} about its plateau; the uncertainty of the {what} includes this."
    return Check(name, Verdict.AGREE, None, scatter, None, STEADY, unit, slips if scatter > STEADY else "")


def _scatter(results: Results) -> float:
    """Return the scatter about the plateau's line over the reaction, a small one taken as 1 % of the weight: noise is no stick-slip."""
    analysis, run = results.analysis, results.recorded
    settlement, reaction = run.settling("settlement"), run.settling("reaction")
    kept = settlement >= run.result.plateau_start
    size = max(abs(run.result.reaction), least_reaction(analysis) / UNCERTAIN)
    return float(np.std((reaction - run.result.reaction - run.result.slope * settlement)[kept]) / size) if kept.any() else math.nan
