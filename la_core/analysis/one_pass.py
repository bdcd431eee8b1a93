"""One pass of limit analysis at given settings: bounds, prediction, and the path on request."""

from collections.abc import Sequence
from dataclasses import replace

from la_core.analysis.modelling import StructuralModel, drives, wedging
from la_core.analysis.prediction import with_prediction
from la_core.analysis.result import Answers, LimitAnalysis, with_one_fall
from la_core.analysis.settings import AnalysisListener, AnalysisSettings
from la_core.coulomb import EquilibriumPath, follow_path
from la_core.limit import Drive, ScaledProblem, Solution, Status, scaled_problem, solve_associated
from la_core.model import BOUNDS_HOLD, BOUNDS_WITHOUT_STRAIN, Assembly
from la_core.scene import RequestedPath, Scene
from la_core.side_by_side import side_by_side


def analyse_once(model: StructuralModel, settings: AnalysisSettings, listener: AnalysisListener) -> LimitAnalysis:
    """Solve a model at the shared inset and for sharp edges.

    The bounds, the path and the reaction at rest belong to the whole structure. The prediction comes from a reduced
    region where a proof shows that it holds for the whole structure, see `la_core.analysis.reach`.
    """
    assemblies = [model.assembly, model.sharp] if model.sharp.inset != model.assembly.inset else [model.assembly]
    bounds, *others = _bounds(model.scene, assemblies)
    sharp = others[0] if others else bounds
    known = LimitAnalysis(model.scene, model.assembly, bounds, sharp, model.stiffness, model.least_gap)
    if settings.bounds_only:
        known = _of_bounds_only(known)
    listener.bounds(known)
    if settings.bounds_only:
        return known
    at_inset, sharp = with_prediction(model, (bounds, sharp), settings, listener)
    whole = replace(model.assembly, effects=at_inset.assembly.effects)
    path = _followed(model, at_inset, settings)
    return LimitAnalysis(model.scene, whole, at_inset, sharp, model.stiffness, model.least_gap, path)


def _of_bounds_only(analysis: LimitAnalysis) -> LimitAnalysis:
    """Return an analysis without prediction whose effects say that only the bounds were requested."""
    effects = analysis.assembly.effects
    if effects.friction == "coulomb":
        effects = effects.with_effect("friction", "associated", "only the bounds were requested")
    effects = effects.with_effect("elasticity", "none", BOUNDS_WITHOUT_STRAIN)
    effects = effects.with_effect("rotation", "small", BOUNDS_HOLD)
    return analysis.with_effects(effects.with_effect("reach", False, "the bounds are those of the whole structure"))


def _followed(model: StructuralModel, answers: Answers, settings: AnalysisSettings) -> EquilibriumPath | None:
    """Follow the path of the whole structure if the scene or the caller requests it and the structure has an answer."""
    is_requested = settings.follow_path or answers.assembly.effects.elasticity == "path"
    has_answer = answers.bounds[answers.main].status is Status.SOLVED or answers.is_without_bound
    if not (is_requested and has_answer and model.assembly.effects.friction == "coulomb"):
        return None
    request = model.scene.path_asked or RequestedPath()
    settlement = request.settlement or model.stiffness.travel
    return follow_path(model.assembly, model.stiffness, settlement, request.increments, wedging(model.scene))


def _bounds(scene: Scene, assemblies: Sequence[Assembly]) -> list[Answers]:
    """Solve every drive of every assembly.

    Two drives are solved side by side. Each is solved for one assembly after the other, and the second solve starts near the answer of
    the first. A single drive is solved for all assemblies side by side.
    """
    asked, problems = drives(scene), [(assembly, scaled_problem(assembly)) for assembly in assemblies]
    chains = [problems] if len(asked) > 1 else [[problem] for problem in problems]

    def solved(work: tuple[Drive, list[tuple[Assembly, ScaledProblem]]]) -> list[Solution]:
        drive, chain = work
        solutions: list[Solution] = []
        for assembly, problem in chain:
            solutions.append(solve_associated(assembly, drive, problem, near=solutions[-1] if solutions else None))
        return solutions

    found = side_by_side(solved, [(drive, chain) for drive in asked for chain in chains])
    in_turn = [solution for solutions in found for solution in solutions]  # drive by drive, each with all assemblies
    every = len(assemblies)
    return [
        Answers(assembly, with_one_fall(dict(zip(asked, in_turn[number::every], strict=True))))
        for number, assembly in enumerate(assemblies)
    ]
