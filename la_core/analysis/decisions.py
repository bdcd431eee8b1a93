"""Effects that only an answer can decide: friction where joints slide, and the region that the support's motion can reach."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from la_core.analysis import reach
from la_core.analysis.modelling import StructuralModel, drives, structural_model, wedging
from la_core.analysis.settings import AnalysisSettings
from la_core.coulomb import Sliding, look_for_sliding
from la_core.errors import SceneError
from la_core.limit import Solution, Status, solve_associated
from la_core.model import Assembly, Effects
from la_core.scene import Scene


@dataclass(frozen=True)
class Decision:
    """What is to be modelled.

    effects: of the whole structure. search: the look for sliding joints, None where friction is modelled without one. aside: masks (B,)
    of blocks that may be set aside if the answer proves it, the boldest first. reason: why the whole structure is modelled otherwise.
    """

    effects: Effects
    search: Sliding | None
    aside: list[np.ndarray]
    reason: str


def decide_effects(model: StructuralModel, settings: AnalysisSettings, bound: Callable[[Assembly], Solution]) -> Decision:
    """Decide friction, elasticity and reach. bound: the associated solution, by the main drive, of the model's assembly or its sharp one.

    Raises SceneError where the scene forbids what sliding joints need.
    """
    scene, effects, search = model.scene, model.assembly.effects, None
    if effects.friction == "coulomb" and _may_leave_out_friction(scene) and not settings.follow_path:
        search = _search_sliding(model, settings, bound)
        effects = _with_friction_decided(scene, effects, search)
    aside, reason = reach.candidate_masks(scene, replace(model.assembly, effects=effects))
    if settings.follow_path:
        aside, reason = [], "a path is asked for, and at its start every block sags"
    elif aside and (status := bound(model.assembly).status) is not Status.SOLVED:
        aside, reason = [], f"the whole structure is {status}"
    return Decision(effects, search, aside, reason)


@dataclass(frozen=True)
class DecidedModel:
    """A scene's assembly at the shared inset with its effects decided: the whole one, and the region that is modelled."""

    whole: Assembly
    assembly: Assembly


def decided_model(scene: Scene) -> DecidedModel:
    """Decide the effects of a scene without solving it, at the price of one bound and a few elastic steps.

    The region is the one that the analysis will try first; only its answer can prove it.
    """
    model, solved = structural_model(scene), dict[float, Solution]()

    def bound(assembly: Assembly) -> Solution:
        if assembly.inset not in solved:
            solved[assembly.inset] = solve_associated(assembly, drives(scene)[0])
        return solved[assembly.inset]

    decision = decide_effects(model, AnalysisSettings(), bound)
    part, reason = model.assembly, decision.reason
    if decision.aside:
        part = reach.set_aside(model.assembly, decision.aside[0])
        reason = f"{reach.reason(part)}, if the answer proves it"
    effects = decision.effects.with_effect("reach", bool(decision.aside), reason)
    return DecidedModel(replace(model.assembly, effects=effects), replace(part, effects=effects))


def _may_leave_out_friction(scene: Scene) -> bool:
    """Whether the scene leaves open if joints slide, and asks for nothing that only friction needs."""
    return scene.effects.friction == "auto" and scene.effects.elasticity in ("auto", "none") and scene.path_asked is None


def _search_sliding(model: StructuralModel, settings: AnalysisSettings, bound: Callable[[Assembly], Solution]) -> Sliding:
    """Whether joints slide at either inset: known, or looked for."""
    if settings.sliding_reason:
        return Sliding(True, settings.sliding_reason)
    search = look_for_sliding(model.assembly, model.stiffness, bound(model.assembly), wedging(model.scene))
    if search.found or model.sharp.inset == model.assembly.inset:
        return search
    return search.unless_sliding(model.sharp, bound(model.sharp))


def _with_friction_decided(scene: Scene, effects: Effects, search: Sliding) -> Effects:
    """Friction and elasticity as the search decides them; raises SceneError where the scene forbids what friction needs."""
    if not search.found:
        effects = effects.with_effect("friction", search.law, search.reason)
        return effects.with_effect("elasticity", "none", "nothing dilates, so that the joints' strain decides nothing")
    if scene.effects.elasticity == "none" and search.known:
        reason = f"{search.reason}, and friction without dilatancy follows the joints' strain"
        hint = 'leave it out, or take friction = "associated" for the bounds alone'
        raise SceneError(f"{scene.path}: effects.elasticity", reason, value="none", hint=hint)
    return effects.with_effect("friction", "coulomb", search.reason)
