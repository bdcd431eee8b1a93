"""Effects that were left out by themselves and that YADE's run shows to be needed: they are turned back on, and say why."""

from collections.abc import Iterable
from dataclasses import replace

from comparison.judge import Check, Verdict, check_displacement, check_plane, check_reach, slides_unforeseen
from comparison.yade import Results
from la_core.analysis import AnalysisSettings, LimitAnalysis, analyse, structural_model
from la_core.coulomb import PredictionSettings
from la_core.limit import Status


def needed(results: Results) -> dict[str, tuple[bool | str, str]]:
    """Choice and reason by effect: what the scene leaves to "auto" and the run does not allow to be left out.

    Only a plateau can be judged by more than how far blocks moved. Nothing is turned back where the scene forbids joints to strain, or
    where the structure is proven to fall.
    """
    scene, analysis, run = results.scene, results.analysis, results.recorded
    if scene.effects.elasticity == "none" or analysis.bounds[analysis.main].status is Status.INFEASIBLE:
        return {}
    guards: dict[str, tuple[bool | str, Iterable[Check]]] = {"displacement": ("finite", check_displacement(results))}
    found: dict[str, tuple[bool | str, str]] = {}
    if run.status == "plateau":
        guards |= {"plane": (False, check_plane(analysis)), "reach": (False, check_reach(results))}
        if slides_unforeseen(results):
            found["friction"] = ("coulomb", "joints slide in YADE's mechanism")
    for effect, (choice, checks) in guards.items():
        reasons = [check.reason for check in checks if check.verdict is not Verdict.AGREE]
        if reasons:
            found[effect] = (choice, " ".join(reasons))
    return {effect: answer for effect, answer in found.items() if getattr(scene.effects, effect) == "auto"}


def analyse_with(
    before: LimitAnalysis, restored: dict[str, tuple[bool | str, str]], prediction: PredictionSettings | None = None
) -> LimitAnalysis:
    """Limit analysis of the same scene again, with these effects modelled for these reasons; interfaces are not searched again."""
    choices = {effect: choice for effect, (choice, _) in restored.items() if effect != "friction"}
    scene = replace(before.scene, effects=before.scene.effects.model_copy(update=choices))
    sliding_reason = restored["friction"][1] if "friction" in restored else ""
    settings = AnalysisSettings(sliding_reason=sliding_reason, prediction=prediction or PredictionSettings())
    analysis = analyse(structural_model(scene, before.whole.interfaces), settings)
    effects = analysis.assembly.effects
    for effect, (choice, reason) in restored.items():
        effects = effects.with_effect(effect, choice, reason)
    return replace(analysis.with_effects(replace(effects, called_back=tuple(restored))), scene=before.scene)


def restored(analysis: LimitAnalysis) -> dict[str, tuple[bool | str, str]]:
    """Choice and reason by effect of what was restored in an analysis before."""
    effects = analysis.assembly.effects
    return {effect: (getattr(effects, effect), effects.reasons[effect]) for effect in effects.called_back}
