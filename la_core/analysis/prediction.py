"""From bounds to the prediction: of the smallest region whose answer is proven to be that of the whole structure."""

from dataclasses import replace

import numpy as np

from la_core.analysis import reach
from la_core.analysis.decisions import decide_effects
from la_core.analysis.modelling import StructuralModel, wedging
from la_core.analysis.result import Answers
from la_core.analysis.settings import AnalysisSettings
from la_core.coulomb import CoulombSolution, PredictionSettings, Sliding, predict, reaction_at_rest
from la_core.limit import Solution
from la_core.model import Assembly, Effects

Pair = tuple[Answers, Answers]  # at the shared inset, and for sharp arrises


def with_prediction(model: StructuralModel, bounds: Pair, settings: AnalysisSettings) -> Pair:
    """The answers with their prediction, where the scene calls for one. bounds: answers of the whole structure without it."""
    at_inset, sharp = bounds

    def bound(assembly: Assembly) -> Solution:
        return (at_inset if assembly.inset == model.assembly.inset else sharp).bounds[at_inset.main]

    decision = decide_effects(model, settings, bound)
    reason = decision.reason
    for aside in decision.aside:
        part = reach.set_aside(model.assembly, aside)
        region = _with_effects(_held(bounds, aside), decision.effects.with_effect("reach", True, reach.reason(part)))
        predicted = _predicted(model, region, decision.search, settings.prediction)
        obstacle = _why_not_valid(bounds, predicted)
        if not obstacle:
            return _with_whole_at_rest(model, predicted)
        reason = f"the whole structure is modelled after all: {obstacle}"
    whole = _with_effects(bounds, decision.effects.with_effect("reach", False, reason))
    return _predicted(model, whole, decision.search, settings.prediction)


def _with_effects(answers: Pair, effects: Effects) -> Pair:
    """Answers whose assemblies have these effects; one object stays one."""
    at_inset, sharp = answers
    changed = replace(at_inset, assembly=replace(at_inset.assembly, effects=effects))
    return changed, changed if sharp is at_inset else replace(sharp, assembly=replace(sharp.assembly, effects=effects))


def _held(answers: Pair, aside: np.ndarray) -> Pair:
    """The whole structure's answers with `aside` (B,) held: bounds keep their mechanisms, and forces where contacts are left."""

    def held(one: Answers) -> Answers:
        kept = reach.kept_points(one.assembly, aside)
        bounds = {drive: replace(solution, forces=solution.forces[kept]) for drive, solution in one.bounds.items()}
        return replace(one, assembly=reach.set_aside(one.assembly, aside), bounds=bounds)

    at_inset, sharp = answers
    changed = held(at_inset)
    return changed, changed if sharp is at_inset else held(sharp)


def _why_not_valid(whole: Pair, region: Pair) -> str:
    """Why the region's answers do not hold for the whole structure at both insets, or ""."""
    for structure, part in zip(whole, region, strict=True):
        answer = part.sharpest
        if obstacle := reach.why_not_valid(structure.assembly, part.assembly, answer.twists, answer.forces):
            return obstacle
    return ""


def _predicted(model: StructuralModel, answers: Pair, search: Sliding | None, settings: PredictionSettings) -> Pair:
    """With Coulomb's prediction, where the scene calls for it; the associated answer is it where no joint was found to slide."""
    at_inset, sharp = answers

    def prediction(one: Answers) -> CoulombSolution:
        if search is not None and not search.found:
            took = search if one is at_inset else replace(search, seconds=0.0)
            return took.as_coulomb(one.assembly, one.bounds[one.main])
        return predict(one.assembly, model.stiffness, one.bounds[one.main], wedging(model.scene), settings)

    if at_inset.assembly.effects.friction != "coulomb" and (search is None or search.found):
        return answers
    changed = replace(at_inset, coulomb=prediction(at_inset))
    return changed, changed if sharp is at_inset else replace(sharp, coulomb=prediction(sharp))


def _with_whole_at_rest(model: StructuralModel, answers: Pair) -> Pair:
    """With the reactions at rest of the whole assemblies: the region beside unyielding blocks sags in another way."""
    at_inset, sharp = answers
    if at_inset.coulomb is None or sharp.coulomb is None or at_inset.assembly.effects.friction != "coulomb":
        return answers

    def at_rest(assembly: Assembly, coulomb: CoulombSolution) -> CoulombSolution:
        return replace(coulomb, at_rest=reaction_at_rest(assembly, model.stiffness, wedging(model.scene)))

    changed = replace(at_inset, coulomb=at_rest(model.assembly, at_inset.coulomb))
    return changed, changed if sharp is at_inset else replace(sharp, coulomb=at_rest(model.sharp, sharp.coulomb))
