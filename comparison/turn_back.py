"""Effects that were left out by themselves and that YADE's run shows to be needed: they are turned back on, and say why."""

from collections.abc import Iterable
from dataclasses import replace

from comparison.check import Check, Verdict
from comparison.check_displacement import check_displacement
from comparison.check_effects import check_effects
from comparison.check_prediction import slides_unforeseen
from comparison.check_reach import check_reach
from comparison.record import Run
from la_core import case
from la_core.analysis import LimitAnalysis
from la_core.scene import Scene


def needed(scene: Scene, analysis: LimitAnalysis, run: Run) -> dict[str, tuple[bool | str, str]]:
    """Choice and reason by effect: what the scene leaves to "auto" and a run on its plateau does not allow to be left out."""
    if run.status != "plateau":
        return {}
    found: dict[str, tuple[bool | str, str]] = {}
    if slides_unforeseen(analysis, run) and scene.effects.elasticity != "none":
        found["friction"] = ("coulomb", "joints slide in YADE's mechanism")
    guards: dict[str, tuple[bool | str, Iterable[Check]]] = {
        "plane": (False, check_effects(analysis)),
        "reach": (False, check_reach(scene, analysis, run)),
        "displacement": ("finite", [check_displacement(analysis, run)] if analysis.assembly.effects.displacement == "small" else []),
    }
    for effect, (choice, checks) in guards.items():
        reasons = [check.reason for check in checks if check.verdict is not Verdict.AGREE]
        if reasons:
            found[effect] = (choice, " ".join(reasons))
    return {effect: answer for effect, answer in found.items() if getattr(scene.effects, effect) == "auto"}


def analyse_with(scene: Scene, found: dict[str, tuple[bool | str, str]]) -> LimitAnalysis:
    """Limit analysis again, with those effects modelled for those reasons."""
    choices = {effect: choice for effect, (choice, _) in found.items() if effect != "friction"}
    asked = replace(scene, effects=scene.effects.model_copy(update=choices))
    analysis = case.analyse(asked, slides=found["friction"][1] if "friction" in found else "")
    effects = analysis.assembly.effects
    for effect, (choice, reason) in found.items():
        effects = effects.settled(effect, choice, reason)
    return replace(analysis, assembly=replace(analysis.assembly, effects=effects))
