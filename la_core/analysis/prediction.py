"""From bounds to the prediction, on the smallest region whose answer provably holds for the whole structure."""

import math
from dataclasses import replace
from functools import partial

import numpy as np

from la_core.analysis import reach
from la_core.analysis.decisions import decide_effects, with_rotation_explained
from la_core.analysis.modelling import StructuralModel, has_given_stiffness, wedging
from la_core.analysis.result import Answers
from la_core.analysis.settings import AnalysisListener, AnalysisSettings
from la_core.coulomb import (
    SAME_VALUE,
    SLIDING_SHARE,
    CoulombSolution,
    PredictionSettings,
    Sliding,
    predict,
    reaction_at_rest,
    slides_in_mechanism,
)
from la_core.limit import Solution, Status
from la_core.measures import mechanism
from la_core.model import Assembly, Effects

Pair = tuple[Answers, Answers]  # at the shared inset, then for sharp edges; one object twice where both are equal


class _DoesNotHoldError(Exception):
    """The coarsest path of a region shows that its answer does not hold for the whole structure; the text says why, as a clause."""


def with_prediction(model: StructuralModel, bounds: Pair, settings: AnalysisSettings, listener: AnalysisListener) -> Pair:
    """Add the prediction to the bounds, where the scene needs one.

    Parameters
    ----------
    model : StructuralModel
        Model of the whole structure at both insets.
    bounds : tuple of Answers
        Bounds of the whole structure at the shared inset and for sharp edges, without prediction.
    settings : AnalysisSettings
        Settings of the analysis, among them the paths of the prediction.
    listener : AnalysisListener
        Receives the progress of the paths of the prediction.

    Returns
    -------
    tuple of Answers
        Bounds and prediction at both insets. Their assemblies are those of the reduced region where its answers
        provably hold for the whole structure, else those of the whole structure; their effects say why.

    Raises
    ------
    SceneError
        The scene forbids an effect that its sliding joints need, see `decide_effects`.
    """
    at_inset, sharp = bounds

    def bound(assembly: Assembly) -> Solution:
        return (at_inset if assembly.inset == model.assembly.inset else sharp).bounds[at_inset.main]

    decision = decide_effects(model, settings, bound)
    reason = decision.reason
    for aside in decision.aside:
        why_enough = reach.reason(reach.set_aside(model.assembly, aside))
        region = _with_effects(_held(bounds, aside), decision.effects.with_effect("reach", True, why_enough))
        try:
            predicted = _predicted(model, region, decision.search, settings.prediction, listener, bounds)
            obstacle = _why_not_valid(bounds, predicted)
        except _DoesNotHoldError as shown:
            obstacle = str(shown)
        if not obstacle:
            return _explained(model, _with_whole_at_rest(model, _with_release_proven(bounds[0], predicted)))
        reason = f"the whole structure is modelled, because {obstacle}"
    whole = _with_effects(bounds, decision.effects.with_effect("reach", False, reason))
    return _explained(model, _predicted(model, whole, decision.search, settings.prediction, listener))


def _explained(model: StructuralModel, answers: Pair) -> Pair:
    """Return the answers; their reason for small rotations also states the effect of turning blocks on the prediction."""
    coulomb = answers[0].coulomb
    return answers if coulomb is None else _with_effects(answers, with_rotation_explained(model.scene, answers[0].assembly, coulomb))


def _with_effects(answers: Pair, effects: Effects) -> Pair:
    """Return the answers with these effects in their assemblies."""
    at_inset, sharp = answers
    changed = replace(at_inset, assembly=replace(at_inset.assembly, effects=effects))
    return changed, changed if sharp is at_inset else replace(sharp, assembly=replace(sharp.assembly, effects=effects))


def _held(answers: Pair, aside: np.ndarray) -> Pair:
    """Return the whole structure's answers on the assembly with `aside` (B,) held.

    Bounds keep their mechanisms, and their forces at the remaining contact points.
    """

    def held(whole: Answers) -> Answers:
        kept = reach.kept_points(whole.assembly, aside)
        bounds = {drive: replace(solution, forces=solution.forces[kept]) for drive, solution in whole.bounds.items()}
        return replace(whole, assembly=reach.set_aside(whole.assembly, aside), bounds=bounds)

    at_inset, sharp = answers
    changed = held(at_inset)
    return changed, changed if sharp is at_inset else held(sharp)


def _why_not_valid(whole: Pair, region: Pair) -> str:
    """Return why the region's answers do not hold for the whole structure at both insets, or ""."""
    for complete, reduced in zip(whole, region, strict=True):
        if reduced.coulomb is None:
            continue
        answer = reduced.coulomb
        if obstacle := reach.why_not_valid(complete.assembly, reduced.assembly, answer.twists, answer.forces):
            return obstacle
    return ""


def _require_valid(complete: Answers, reduced: Answers, twists: np.ndarray, forces: np.ndarray) -> None:
    """Raise _DoesNotHoldError where a mechanism (B, 6) and forces (C, 3) of the region do not hold for the whole structure.

    The finest path decides where there are no forces, which are then NaN.
    """
    if np.isfinite(forces).all() and (obstacle := reach.why_not_valid(complete.assembly, reduced.assembly, twists, forces)):
        raise _DoesNotHoldError(obstacle)


def _with_release_proven(whole: Answers, region: Pair) -> Pair:
    """Return a region's answers; a value after a release is removed if its state does not hold for the whole structure."""
    at_inset, sharp = region
    coulomb = at_inset.coulomb
    if coulomb is None or coulomb.released_state is None:
        return region
    if not reach.why_not_valid(whole.assembly, at_inset.assembly, *coulomb.released_state):
        return region
    changed = replace(at_inset, coulomb=replace(coulomb, released=math.nan, released_uncertainty=math.nan, released_state=None))
    return changed, changed if sharp is at_inset else sharp


def _predicted(
    model: StructuralModel,
    answers: Pair,
    search: Sliding | None,
    settings: PredictionSettings,
    listener: AnalysisListener,
    whole: Pair | None = None,
) -> Pair:
    """Return the answers with their prediction, where the scene needs one.

    Where a search found no sliding joint, the associated answer is the prediction. search: None where there was no search. whole: answers
    of the whole structure, where `answers` are those of a region; finer paths are then not followed where the coarsest one shows that
    they cannot hold for the whole structure, and _DoesNotHoldError is raised.
    """
    at_inset, sharp = answers

    slides = search is None or search.found

    def prediction(bounds: Answers) -> CoulombSolution:
        associated = bounds.bounds[bounds.main]
        if search is not None and not search.found:
            timed = search if bounds is at_inset else replace(search, seconds=0.0)  # the time of the search counts once
            return timed.as_coulomb(bounds.assembly, associated)
        as_given = has_given_stiffness(model.scene)
        goes_on = bounds is at_inset and model.scene.effects.rotation == "auto" and not as_given
        asked = replace(settings, with_release=goes_on)
        check = partial(_require_valid, whole[0 if bounds is at_inset else 1], bounds) if whole else None
        return predict(bounds.assembly, model.stiffness, associated, wedging(model.scene), asked, listener.path, as_given, check)

    if at_inset.assembly.effects.friction != "coulomb" and slides:
        return answers
    changed = replace(at_inset, coulomb=prediction(at_inset))
    if sharp is at_inset:
        return changed, changed
    if slides and model.scene.inset > 0.0:  # see `LimitAnalysis.sharp`
        return changed, replace(sharp, coulomb=_without_history(changed, sharp))
    return changed, replace(sharp, coulomb=prediction(sharp))


def _without_history(at_inset: Answers, sharp: Answers) -> CoulombSolution | None:
    """Return the sharp associated answer as Coulomb's where friction has no history; None elsewhere.

    Friction has none where no loaded joint slides in either mechanism, and both laws give one value at the inset.
    """
    coulomb, associated = at_inset.coulomb, sharp.bounds[sharp.main]
    bounds = at_inset.bounds[at_inset.main], associated
    if coulomb is None or any(answer.status is not Status.SOLVED for answer in (coulomb, *bounds)):
        return None
    if slides_in_mechanism(sharp.assembly, associated):
        return None
    rounded = bounds[0].value
    if abs(coulomb.value - rounded) > SAME_VALUE * abs(rounded) + coulomb.uncertainty:  # slip on the way changed the value
        return None
    if mechanism.sliding_share(at_inset.assembly, coulomb.twists, coulomb.forces) > SLIDING_SHARE:
        return None
    return Sliding(False, "no loaded joint slides in the mechanism").as_coulomb(sharp.assembly, associated)


def _with_whole_at_rest(model: StructuralModel, answers: Pair) -> Pair:
    """Replace the region's reactions at rest by the whole structure's: the region sags differently beside held blocks."""
    at_inset, sharp = answers
    if at_inset.coulomb is None or at_inset.assembly.effects.friction != "coulomb":
        return answers

    def at_rest(assembly: Assembly, coulomb: CoulombSolution) -> CoulombSolution:
        return replace(coulomb, at_rest=reaction_at_rest(assembly, model.stiffness, wedging(model.scene)))

    changed = replace(at_inset, coulomb=at_rest(model.assembly, at_inset.coulomb))
    if sharp is at_inset or sharp.coulomb is None:
        return changed, changed if sharp is at_inset else sharp
    return changed, replace(sharp, coulomb=at_rest(model.sharp, sharp.coulomb))
