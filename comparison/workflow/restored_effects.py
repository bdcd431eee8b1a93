"""Effects that were left out by themselves and that YADE's run shows to be needed: they are turned back on, and say why."""

from collections.abc import Iterable
from dataclasses import replace

from comparison.judge import Check, Verdict, check_displacement, check_plane, check_reach, slides_unforeseen
from comparison.yade import Run
from la_core.analysis import LimitAnalysis, accuracy
from la_core.coulomb import FIRST_SAGS, STEPS
from la_core.limit import Status
from la_core.scene import Scene


def needed(scene: Scene, analysis: LimitAnalysis, run: Run) -> dict[str, tuple[bool | str, str]]:
    """Choice and reason by effect: what the scene leaves to "auto" and the run does not allow to be left out.

    Only a plateau can be judged by more than how far blocks moved. Nothing is turned back where the scene forbids joints to strain, or
    where the structure is proven to fall.
    """
    if scene.effects.elasticity == "none" or analysis.rounded[analysis.main].status is Status.INFEASIBLE:
        return {}
    guards: dict[str, tuple[bool | str, Iterable[Check]]] = {"displacement": ("finite", check_displacement(analysis, run))}
    found: dict[str, tuple[bool | str, str]] = {}
    if run.status == "plateau":
        guards |= {"plane": (False, check_plane(analysis)), "reach": (False, check_reach(scene, analysis, run))}
        if slides_unforeseen(analysis, run):
            found["friction"] = ("coulomb", "joints slide in YADE's mechanism")
    for effect, (choice, checks) in guards.items():
        reasons = [check.reason for check in checks if check.verdict is not Verdict.AGREE]
        if reasons:
            found[effect] = (choice, " ".join(reasons))
    return {effect: answer for effect, answer in found.items() if getattr(scene.effects, effect) == "auto"}


def analyse_with(
    scene: Scene, found: dict[str, tuple[bool | str, str]], steps: int = STEPS, first_sags: float = FIRST_SAGS
) -> LimitAnalysis:
    """Limit analysis again, with those effects modelled for those reasons. steps, first_sags: of the prediction."""
    choices = {effect: choice for effect, (choice, _) in found.items() if effect != "friction"}
    asked = replace(scene, effects=scene.effects.model_copy(update=choices))
    analysis = accuracy.analyse(asked, slides=found["friction"][1] if "friction" in found else "", steps=steps, first_sags=first_sags)
    effects = analysis.assembly.effects
    for effect, (choice, reason) in found.items():
        effects = effects.settled(effect, choice, reason)
    effects = replace(effects, called_back=tuple(found))
    return replace(analysis, assembly=replace(analysis.assembly, effects=effects))


def called_back(analysis: LimitAnalysis) -> dict[str, tuple[bool | str, str]]:
    """Choice and reason by effect of what an analysis has had turned back on before."""
    effects = analysis.assembly.effects
    return {effect: (getattr(effects, effect), effects.reasons[effect]) for effect in effects.called_back}
