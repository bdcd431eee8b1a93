"""Decide the effects that need a solution: friction where joints slide, and the region that the motion affects."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from la_core.analysis import reach
from la_core.analysis.modelling import StructuralModel, drives, structural_model, wedging
from la_core.analysis.settings import AnalysisSettings
from la_core.coulomb import (
    ONE_VALUE,
    CoulombSolution,
    Sliding,
    change_by_release,
    interval_status,
    is_changed_by_release,
    look_for_sliding,
    reference_size,
    relative_width,
)
from la_core.errors import SceneError
from la_core.limit import Solution, Status, solve_associated
from la_core.model import Assembly, Effects, distance_to_meet
from la_core.scene import Scene
from la_core.text_table import number_text

# Of the value: a smaller change is stated as this much, because no prediction is certain to less. A narrower interval is a point.
LEAST_CHANGE = 1e-4


@dataclass(frozen=True)
class Decision:
    """Decided effects of a scene, and the regions to try.

    Attributes
    ----------
    effects : Effects
        Effects of the whole structure.
    search : Sliding or None
        Search for sliding joints. None where friction is modelled without a search.
    aside : list of ndarray, shape (B,)
        Masks of free blocks to set aside, the largest first; only the answer of the remaining region can prove a mask.
    reason : str
        Reason for modelling the whole structure where no mask is proven.
    """

    effects: Effects
    search: Sliding | None
    aside: list[np.ndarray]
    reason: str


def decide_effects(model: StructuralModel, settings: AnalysisSettings, bound: Callable[[Assembly], Solution]) -> Decision:
    """Decide friction, elasticity and reach of a model.

    Parameters
    ----------
    model : StructuralModel
        Model of the whole structure.
    settings : AnalysisSettings
        Settings of the analysis; a known reason for sliding replaces the search.
    bound : callable
        Returns the associated solution, for the main drive, of the model's assembly or of its sharp one.

    Returns
    -------
    Decision
        Effects with their reasons, and the regions to try.

    Raises
    ------
    SceneError
        Joints slide, but the scene forbids the elastic joints that friction without dilatancy needs.
    """
    scene, effects, search = model.scene, model.assembly.effects, None
    if effects.friction == "coulomb" and _may_leave_out_friction(scene) and not settings.follow_path:
        search = _search_sliding(model, settings, bound)
        effects = _with_friction_decided(scene, effects, search)
    aside, reason = reach.candidate_masks(
        scene, replace(model.assembly, effects=effects), distance_to_meet(model.assembly, model.stiffness)
    )
    if settings.follow_path:
        aside, reason = [], reach.PATH_IS_REQUESTED
    elif aside and (status := bound(model.assembly).status) is not Status.SOLVED:
        aside, reason = [], f"the whole structure is {status}"
    return Decision(effects, search, aside, reason)


@dataclass(frozen=True)
class DecidedModel:
    """Assemblies of a scene at the shared inset with decided effects.

    Attributes
    ----------
    whole : Assembly
        Assembly with every free block.
    assembly : Assembly
        Assembly to solve: the whole one, or the region without the blocks that are set aside.
    """

    whole: Assembly
    assembly: Assembly


def decided_model(scene: Scene) -> DecidedModel:
    """Decide the effects of a scene without a complete analysis, from bounds and a search for joints that slide.

    The region is the first one that the analysis will try; its answer is not computed, so it is not proven yet.
    """
    model, solved = structural_model(scene), dict[float, Solution]()

    def bound(assembly: Assembly) -> Solution:
        if assembly.inset not in solved:
            solved[assembly.inset] = solve_associated(assembly, drives(scene)[0])
        return solved[assembly.inset]

    decision = decide_effects(model, AnalysisSettings(), bound)
    region, reason = model.assembly, decision.reason
    if decision.aside:
        region = reach.set_aside(model.assembly, decision.aside[0])
        reason = f"{reach.reason(region)}; the answer must prove this"
    effects = decision.effects.with_effect("reach", bool(decision.aside), reason)
    return DecidedModel(replace(model.assembly, effects=effects), replace(region, effects=effects))


def _may_leave_out_friction(scene: Scene) -> bool:
    """Whether the scene leaves friction to the program and requests no effect that needs it."""
    return scene.effects.friction == "auto" and scene.effects.elasticity in ("auto", "none") and scene.path_asked is None


def _search_sliding(model: StructuralModel, settings: AnalysisSettings, bound: Callable[[Assembly], Solution]) -> Sliding:
    """Return whether joints slide at one of the two insets, known from the settings or found by a search."""
    if settings.sliding_reason:
        return Sliding(True, settings.sliding_reason)
    search = look_for_sliding(model.assembly, model.stiffness, bound(model.assembly), wedging(model.scene))
    if search.found or model.sharp.inset == model.assembly.inset:
        return search
    return search.unless_sliding(model.sharp, bound(model.sharp))


def with_rotation_explained(scene: Scene, assembly: Assembly, coulomb: CoulombSolution) -> Effects:
    """Return the effects of an assembly; its prediction adds to the reason for small rotations if the scene leaves these to the program.

    Turning blocks may release a thrust that friction locked in. A mechanism with such a thrust allows several values.
    """
    effects = assembly.effects
    if scene.effects.rotation != "auto" or effects.friction != "coulomb" or math.isnan(coulomb.value):
        return effects
    return effects.with_effect("rotation", "small", f"{effects.reasons['rotation']}; {_effect_of_turning(scene, assembly, coulomb)}")


def _effect_of_turning(scene: Scene, assembly: Assembly, coulomb: CoulombSolution) -> str:
    """Effect of turning blocks, in words, as far as a prediction with small rotations shows it.

    Changes are in per cent of the value. If the value is too small to be the scale of its changes, they are in its own unit.
    """
    unit = assembly.in_value_unit(assembly.weight)
    width = relative_width(coulomb.interval, coulomb.value, unit)
    size, is_small = reference_size(coulomb.value / unit) * unit, abs(coulomb.value) < reference_size(0.0) * unit
    wide = f"{number_text(width * size, 2)} {scene.unit}".rstrip() if is_small else f"{width:.2g} of the value"
    wide = "a point" if width <= LEAST_CHANGE else wide
    if width <= ONE_VALUE:
        return f"turning blocks may change it by another mechanism alone, because the interval of this one is {wide}"
    if math.isnan(coulomb.released):
        interval = {"not stated": "unknown", "unlimited": "unlimited"}.get(interval_status(coulomb.interval), wide)
        return f"turning blocks may release a thrust, because the mechanism's interval is {interval}"
    change, doubt = change_by_release(coulomb, unit)
    times, of = (size, f" {scene.unit}".rstrip()) if is_small else (100.0, " %")
    if abs(change) + doubt <= ONE_VALUE:
        return f"turning blocks change it by at most {number_text(times * max(abs(change) + doubt, LEAST_CHANGE), 2)}{of}"
    if not is_changed_by_release(coulomb, unit):
        return f"it is uncertain whether turning blocks change it ({_with_doubt(times * change, times * doubt)}{of})"
    value = f"{number_text(coulomb.released, 4)} {scene.unit}".rstrip()
    by = f"{_with_doubt(times * abs(change), times * doubt)}{of} {'more' if change > 0.0 else 'less'}"
    becomes = f"the {scene.quantity} becomes {value}, {by}"
    return f'turning blocks later release a thrust, and {becomes} (rotation = "finite" has YADE check this)'


def _with_doubt(change: float, doubt: float) -> str:
    """A change and its doubt, above 0, as text: both to the place of the doubt's first digit, or to the whole number."""
    places = max(-math.floor(math.log10(doubt)), 0)
    return f"{round(change, places) + 0.0:.{places}f} ± {doubt:.{places}f}".replace("-", "−")  # + 0.0: no negative zero


def _with_friction_decided(scene: Scene, effects: Effects, search: Sliding) -> Effects:
    """Return the effects with friction and elasticity decided by a search; raises SceneError as `decide_effects` does."""
    if not search.found:
        effects = effects.with_effect("friction", search.law, search.reason)
        why = "no joint has friction" if search.law == "associated" else "no joint slides"
        effects = effects.with_effect("rotation", "small", f"{why}, so the mechanism allows one value")
        return effects.with_effect("elasticity", "none", "no joint dilates, so the strain of joints has no effect")
    if scene.effects.elasticity == "none" and search.known:
        reason = f"{search.reason}, and friction without dilatancy depends on the strain of the joints"
        hint = 'leave it out, or use friction = "associated" for the bounds alone'
        raise scene.located(SceneError("effects.elasticity", reason, value="none", hint=hint))
    return effects.with_effect("friction", "coulomb", search.reason)
