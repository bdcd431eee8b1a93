"""Compare YADE's plateau with the prediction: first the reaction, then its interval, the friction state and the mechanism."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from comparison.judge.checks import next_steps
from comparison.judge.checks.answer import ended_words
from comparison.judge.checks.curves import earlier_agreement
from comparison.judge.checks.friction_state import check_friction_state, check_steadiness
from comparison.judge.checks.mechanisms import SIMILAR, check_mechanism
from comparison.judge.checks.prediction import Prediction, predicted
from comparison.judge.checks.tolerances import (
    LEAST_REACTION,
    MOST_UNCERTAIN,
    UNCERTAIN,
    Unsure,
    accuracy_share,
    floor,
    least_reaction,
    reaction_tolerance,
    unbalanced,
    unsure_methods,
)
from comparison.numbers import format_number, percent, settlement_text, with_uncertainty
from comparison.verdict import Check, Verdict, inside, within
from comparison.yade import Results
from la_core import exchange
from la_core.analysis import wedging
from la_core.limit import Status
from la_core.measures import mechanism
from la_core.text_table import ROUND_OFF

NO_DIFFERENCE = ROUND_OFF / LEAST_REACTION  # of the least tolerance: smaller differences count as 0


def check_prediction(results: Results) -> Iterator[Check]:
    """Yield the checks of the reaction, its interval, YADE's friction state and the mechanism.

    The reaction decides. If it agrees, an inconclusive check of the friction state or of a known mechanism becomes a remark. A
    contradiction stays.
    """
    analysis, run = results.analysis, results.recorded
    prediction = predicted(results)
    state = check_friction_state(results) if prediction.slides and analysis.coulomb is not None else None
    reaction = _check_reaction(results, prediction, state)
    yield _with_inaccuracy(results, prediction, reaction)
    agrees = reaction.verdict is Verdict.AGREE
    if state is not None:
        if not agrees or reaction.limit_analysis == prediction.value:  # the interval is that of the mechanism before a release
            yield from _check_interval(results, prediction)
        yield _remark(state) if agrees else state
        yield check_steadiness(results)
    determined = not (prediction.slides or analysis.is_without_bound)
    for check in check_mechanism(results, prediction.twists, determined, is_alone=prediction.slides and analysis.coulomb is None):
        yield _remark(check) if agrees and np.isfinite(run.mechanism()).all() else check


def _remark(check: Check) -> Check:
    """Return an inconclusive check as an agreeing one, with its reason as a remark."""
    return replace(check, verdict=Verdict.AGREE, next_step="") if check.verdict is Verdict.INCONCLUSIVE else check


def _with_inaccuracy(results: Results, prediction: Prediction, check: Check) -> Check:
    """Return the check; where it agrees with a prediction that ended as inaccurate, it says so as a remark."""
    coulomb = results.analysis.coulomb
    is_confirmed = check.verdict is Verdict.AGREE and check.limit_analysis == prediction.value
    if coulomb is None or coulomb.status is not Status.INACCURATE or not is_confirmed:
        return check
    words = f"{ended_words(coulomb, results.scene.unit)} YADE confirms this value all the same."
    unknown = any(math.isnan(end) for end in prediction.interval)
    words += f" The mechanism's interval is unknown, so YADE's {results.scene.quantity} is not compared with it." if unknown else ""
    return replace(check, reason=f"{check.reason} {words}".lstrip())


def _check_reaction(results: Results, prediction: Prediction, state: Check | None) -> Check:
    """Compare the reactions. state: the check of YADE's friction state, if there is one."""
    scene, run = results.scene, results.recorded
    name, value, reaction = f"{scene.quantity} against prediction", prediction.value, run.result.reaction
    if prediction.obstacle:
        numbers = value, reaction, reaction - value, None
        return Check(name, Verdict.INCONCLUSIVE, *numbers, scene.unit, prediction.obstacle, prediction.next_step)
    tolerance = reaction_tolerance(results, prediction.stated)
    check = within(name, value, reaction, tolerance, scene.unit, _difference_words(results, prediction), next_steps.BOTH_FINER)
    if unsure := unsure_methods(results, prediction.stated):
        return _unsure_check(results, check, unsure, prediction)
    if check.verdict is Verdict.DISAGREE:
        is_odd = state is not None and state.verdict is not Verdict.AGREE
        of_state = ("YADE's own state is in doubt.", next_steps.SLOWER_RUN) if is_odd else ("", "")
        doubts = ((prediction.doubt, prediction.next_step), _other_history(results), _jump(results), _left(results), of_state)
        doubt, step = next((one for one in doubts if one[0]), ("", ""))
        if doubt:
            return replace(check, verdict=Verdict.INCONCLUSIVE, reason=f"{check.reason} {doubt}", next_step=step)
        if prediction.slides:
            return _check_release(results, prediction, check, earlier_agreement(results, value, tolerance))
    return _if_not_for_the_weight(results, check, prediction.stated)


def _if_not_for_the_weight(results: Results, check: Check, stated: float) -> Check:
    """Return the check; it becomes inconclusive if the reactions agree only because both are small compared with the weight.

    The reactions then differ by more than both stated uncertainties and by more than MOST_UNCERTAIN. stated: uncertainty of the
    prediction, N or N m.
    """
    analysis, run = results.analysis, results.recorded
    least, difference = least_reaction(analysis), abs(check.difference or 0.0)
    size = max(abs(run.result.reaction), abs(check.limit_analysis or 0.0))
    share = max(MOST_UNCERTAIN, 2.0 * accuracy_share(analysis))
    is_told = difference > max(stated + float(run.result.uncertainty), share * size, NO_DIFFERENCE * least)
    if check.verdict is not Verdict.AGREE or results.scene.live is not None or not is_told:
        return check
    words = f"The {results.scene.quantity}s differ by {percent(difference / size)} and agree only because both are small"
    reason = f"{words}: a difference of up to {format_number(least, 3)} {results.scene.unit}".rstrip() + " is within the tolerance."
    return replace(check, verdict=Verdict.INCONCLUSIVE, reason=reason, next_step=next_steps.SMALLER_PART)


def _check_release(results: Results, prediction: Prediction, check: Check, before: str) -> Check:
    """Return the check if YADE's plateau may be the plateau after turning blocks have released a thrust.

    Limit analysis predicts this plateau before YADE runs. The check agrees only if YADE's curve was at the prediction first and its plateau
    is at the value after the release.

    check: check of a plateau that differs from the prediction. before: sentence on the part of the curve at the prediction, "" if none.
    """
    scene, reaction, release = results.scene, results.recorded.result.reaction, prediction.release
    check = replace(check, reason=f"{check.reason} {before}".rstrip())
    if release is None:
        is_small = results.analysis.assembly.effects.rotation == "small"
        return replace(check, next_step=next_steps.TWO_LEVELS) if before and is_small else check
    is_unsure = bool(unsure_methods(results, release.stated))
    if not (release.is_other or is_unsure):
        return check
    value = f"{with_uncertainty(release.value, release.stated)} {scene.unit}".rstrip()
    after = f"the value that limit analysis predicts after turning blocks have released a thrust, {value}"
    tolerance = reaction_tolerance(results, release.stated)
    if abs(reaction - release.value) > tolerance:
        return replace(check, reason=f"{check.reason} It also differs from {after}.")
    if before and not is_unsure:
        reason = f"{before} The plateau agrees with {after}."
        return Check(check.name, Verdict.AGREE, release.value, reaction, reaction - release.value, tolerance, scene.unit, reason)
    but = "but this is too uncertain to decide by" if is_unsure else "but its curve was not at the prediction before"
    reason = f"{check.reason} The plateau is within the tolerance of {after}, {but}."
    step = next_steps.BOTH_FINER if is_unsure else next_steps.AFTER_RELEASE
    return replace(check, verdict=Verdict.INCONCLUSIVE, reason=reason, next_step=step)


def _unsure_check(results: Results, check: Check, unsure: list[Unsure], prediction: Prediction) -> Check:
    """Return the check of the reaction if a method is too uncertain. Reactions that differ by less than the floor alone still agree.

    Even these do not agree if an uncertainty exceeds MOST_UNCERTAIN. The uncertainty of limit analysis may come from several plateaus:
    finer paths may give a single plateau; otherwise the several plateaus are the answer.
    """
    reason = " ".join(_unsure_words(one, results.scene.unit) for one in unsure)
    if check.difference is not None and abs(check.difference) <= floor(results):
        alike = f"The {results.scene.quantity}s agree within the floor of the tolerance alone"
        if all(one.share <= MOST_UNCERTAIN for one in unsure):
            return replace(check, verdict=Verdict.AGREE, reason=f"{reason} {alike}.")
        reason = f"{reason} {alike}, which decides up to an uncertainty of {percent(MOST_UNCERTAIN)}."
    if unsure[0].method != "limit analysis":
        return replace(check, verdict=Verdict.INCONCLUSIVE, reason=reason, next_step=next_steps.SLOWER_RUN)
    other = "" if prediction.next_step == next_steps.FINER_PATHS else prediction.next_step
    reason, step = f"{reason} {prediction.doubt}".rstrip(), f"{next_steps.FINER_PATHS} {other}".rstrip()
    return replace(check, verdict=Verdict.INCONCLUSIVE, reason=reason, next_step=step)


def _other_history(results: Results) -> tuple[str, str]:
    """Return the reason why the methods follow different histories of friction, and the next step; two times "" without a reason.

    The only accepted reason is a lifted support: the lift is a history before the settlement, and the states at rest may differ.
    """
    scene, analysis, run = results.scene, results.analysis, results.recorded
    if not wedging(scene) or analysis.coulomb is None or not len(recorded := run.settling("reaction")):
        return "", ""
    rest, other = analysis.coulomb.at_rest, float(recorded[0])
    if not abs(other - rest) > UNCERTAIN * max(abs(rest), least_reaction(analysis) / UNCERTAIN):
        return "", ""
    states = f"{rest:.6g} {scene.unit} in limit analysis, {other:.6g} {scene.unit} in YADE"
    return (
        f"After the lift ([yade] wedging) the methods are at rest in different states ({states}): two histories of friction.",
        next_steps.BOUNDS,
    )


def _jump(results: Results) -> tuple[str, str]:
    """Return a sentence on a jump that may have led YADE to another plateau, and the next step; two times "" if no block jumped.

    Without a jump a wall of 250 blocks came to the plateau of limit analysis. After jumps it came to others, 8 to 12 % higher.
    """
    settlement, sizes = (results.recorded.settling(name) for name in ("settlement", "unbalanced"))
    if not len(sizes) or not sizes.max() > exchange.JUMP * unbalanced(results):
        return "", ""
    place = settlement_text(settlement[sizes.argmax()], results.scene.settlement_unit)
    jump = f"of {sizes.max():.2g} mean block weights at a settlement of {place}"
    return (
        f"On YADE's way a block jumped (unbalanced force {jump}), and a jump by inertia may lead to another plateau.",
        next_steps.SLOWER_RUN,
    )


def leaves_plateau(results: Results) -> bool:
    """Return whether YADE's reaction leaves the stated plateau before the run ends."""
    last, *_ = str(results.recorded.result.message).split(exchange.EARLIER_ATTEMPT)
    return exchange.LEFT_PLATEAU in last


def _left(results: Results) -> tuple[str, str]:
    """Return a sentence on a plateau of YADE that the reaction leaves later, and the next step; two times "" if the run ends on it.

    A pushed wall of rubble stayed at 1.057 for a while, as on the path of limit analysis. With stiffer joints it reached the prediction,
    1.143.
    """
    if not leaves_plateau(results):
        return "", ""
    return f"YADE's {results.scene.quantity} leaves this plateau as the motion goes on, so it may be one on the way.", next_steps.BOTH_FINER


def _difference_words(results: Results, prediction: Prediction) -> str:
    scene, apart = results.scene, abs(results.recorded.result.reaction - prediction.value)
    is_small = not abs(prediction.value) > least_reaction(results.analysis)
    distance = f"{format_number(apart, 4)} {scene.unit}".rstrip() + ("" if is_small else f" ({percent(apart / abs(prediction.value))})")
    allowed = f"{format_number(reaction_tolerance(results, prediction.stated), 4)} {scene.unit}".rstrip()
    note = "" if prediction.slides else ", although friction does almost no work"
    return f"YADE differs from the prediction of limit analysis by {distance}{note}; both stated uncertainties and the floor are {allowed}."


def _unsure_words(unsure: Unsure, unit: str) -> str:
    size, allowed = (f"{format_number(value, 3)} {unit}".rstrip() for value in (unsure.uncertainty, unsure.allowed))
    named = "YADE" if unsure.method == "YADE" else "Limit analysis"
    return f"{named} states an uncertainty of {size} ({percent(unsure.share, 3)}), too large to decide by ({allowed} allowed)."


def _check_interval(results: Results, prediction: Prediction) -> Iterator[Check]:
    """Yield the check that YADE's reaction lies in the interval, which holds for every method with the same mechanism."""
    scene, analysis, run = results.scene, results.analysis, results.recorded
    if any(math.isnan(end) for end in prediction.interval):
        return
    reason = f"YADE's {scene.quantity} lies outside the interval that the Coulomb mechanism allows for any history of friction."
    tolerance = reaction_tolerance(results, prediction.stated)
    name = f"{scene.quantity} within the mechanism's interval"
    check = inside(name, prediction.interval, run.result.reaction, tolerance, scene.unit, reason, next_steps.BOTH_FINER)
    alike = mechanism.similarity(analysis.assembly.blocks, prediction.twists, run.mechanism())
    doubt = prediction.doubt or _left(results)[0]
    if check.verdict is Verdict.DISAGREE and (doubt or not alike >= SIMILAR):
        other = f"YADE moves by another mechanism (modal assurance {alike:.3f}), to which the Coulomb interval does not apply."
        other = "YADE's mechanism is unknown, so that the Coulomb interval may not apply." if math.isnan(alike) else other
        check = replace(check, verdict=Verdict.INCONCLUSIVE, reason=f"{doubt or other} {check.reason}")
    yield check
