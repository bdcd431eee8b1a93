"""Restore effects that the program left out although YADE's run shows that they are needed."""

from collections.abc import Iterable
from dataclasses import replace

from comparison.judge import check_displacement, check_plane, check_reach, slides_unforeseen
from comparison.verdict import Check, Verdict
from comparison.yade import Results
from la_core.analysis import AnalysisSettings, LimitAnalysis, analyse, structural_model
from la_core.limit import Status


def needed(results: Results) -> dict[str, tuple[bool | str, str]]:
    """Return choice and reason by effect, for each needed effect that the scene leaves at "auto".

    The run shows which effects are needed. Without a plateau, only its displacements are checked. Nothing is restored if the scene sets
    rigid joints, or if the structure is proven to fall.
    """
    scene, analysis, run = results.scene, results.analysis, results.recorded
    if scene.effects.elasticity == "none" or analysis.bounds[analysis.main].status is Status.INFEASIBLE:
        return {}
    guards: dict[str, tuple[bool | str, Iterable[Check]]] = {"displacement": ("finite", check_displacement(results))}
    needs: dict[str, tuple[bool | str, str]] = {}
    if run.status == "plateau":
        guards |= {"plane": (False, check_plane(analysis)), "reach": (False, check_reach(results))}
        if slides_unforeseen(results):
            needs["friction"] = ("coulomb", "joints slide in YADE's mechanism")
    for effect, (choice, checks) in guards.items():
        reasons = [check.reason for check in checks if check.verdict is not Verdict.AGREE]
        if reasons:
            needs[effect] = (choice, " ".join(reasons))
    return {effect: need for effect, need in needs.items() if getattr(scene.effects, effect) == "auto"}


def restore(results: Results) -> LimitAnalysis | None:
    """Return limit analysis with the effects that were left out although YADE's run shows that they are needed; None without any.

    This is the only function that repeats limit analysis after a run. It adds the missing effects to the model and changes nothing else:
    neither the method of the prediction, nor an effect that was modelled or that the scene chose. The interfaces are used again.
    """
    missing = needed(results)
    return _analyse_with(results.analysis, _restored(results.analysis) | missing) if missing else None


def _restored(analysis: LimitAnalysis) -> dict[str, tuple[bool | str, str]]:
    """Return choice and reason by effect, for the restored effects of an analysis."""
    effects = analysis.assembly.effects
    return {effect: (getattr(effects, effect), effects.reasons[effect]) for effect in effects.called_back}


def _analyse_with(before: LimitAnalysis, restored: dict[str, tuple[bool | str, str]]) -> LimitAnalysis:
    """Repeat limit analysis of the same scene. restored: choice and reason by effect, for all effects to be restored."""
    choices = {effect: choice for effect, (choice, _) in restored.items() if effect != "friction"}
    scene = replace(before.scene, effects=before.scene.effects.model_copy(update=choices))
    sliding_reason = restored["friction"][1] if "friction" in restored else ""
    analysis = analyse(structural_model(scene, before.whole.interfaces), AnalysisSettings(sliding_reason=sliding_reason))
    effects = analysis.assembly.effects
    for effect, (choice, reason) in restored.items():
        effects = effects.with_effect(effect, choice, reason)
    return replace(analysis.with_effects(replace(effects, called_back=tuple(restored))), scene=before.scene)
