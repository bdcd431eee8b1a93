"""From bounds to the prediction: with friction where joints slide, of the region within reach where that is proven to be enough."""

from dataclasses import replace

import numpy as np

from la_core.analysis import reach
from la_core.analysis.result import LimitAnalysis
from la_core.coulomb import FIRST_SAGS, STEPS, Sliding, look_for_sliding, may_leave_out_friction, predict, reaction_at_rest, settled_effects
from la_core.limit import Drive, Solution, Status
from la_core.model import Assembly
from la_core.scene import Scene


def with_prediction(
    scene: Scene,
    whole: LimitAnalysis,
    sharp_assembly: Assembly,
    slides: str = "",
    with_path: bool = False,
    steps: int = STEPS,
    first_sags: float = FIRST_SAGS,
) -> LimitAnalysis:
    """The analysis with its prediction, by the smallest region whose answer counts for the whole structure.

    slides: why joints are known to slide. with_path: a path is followed besides, so that friction and all blocks are called for.
    steps, first_sags: of the prediction, as in `la_core.coulomb.predict`.
    """
    search = None
    if whole.assembly.effects.friction == "coulomb" and may_leave_out_friction(scene) and not with_path:
        search = search_sliding(scene, whole, slides).unless_sliding(sharp_assembly, whole.sharp[whole.main])
        whole = replace(whole, assembly=replace(whole.assembly, effects=settled_effects(scene, whole.assembly.effects, search)))
    masks, reason = reach.choices(scene, whole.assembly)
    if masks and whole.rounded[whole.main].status is not Status.SOLVED:
        masks, reason = [], f"the whole structure is {whole.rounded[whole.main].status}"
    if with_path:
        masks, reason = [], "a path is asked for, and at its start every block sags"
    for aside in masks:
        sharp_part = reach.set_aside(sharp_assembly, aside)
        part = _predicted(scene, _without(whole, sharp_assembly, aside), sharp_part, search, steps, first_sags)
        answer, sharp_answer = part.coulomb or part.rounded[part.main], part.coulomb_sharp or part.sharp[part.main]
        obstacle = reach.obstacle(whole.assembly, part.assembly, answer.twists, answer.forces)
        obstacle = obstacle or reach.obstacle(sharp_assembly, sharp_part, sharp_answer.twists, sharp_answer.forces)
        if not obstacle:
            return _at_rest(scene, _because(part, True, reach.reason(part.assembly)), whole.assembly, sharp_assembly)
        reason = f"the whole structure is modelled after all: {obstacle}"
    return _predicted(scene, _because(whole, False, reason), sharp_assembly, search, steps, first_sags)


def search_sliding(scene: Scene, bounds: LimitAnalysis, slides: str = "") -> Sliding:
    """Whether joints slide: known, or looked for."""
    if slides:
        return Sliding(True, slides)
    return look_for_sliding(bounds.assembly, bounds.stiffness, bounds.rounded[bounds.main], wedging(scene))


def _because(analysis: LimitAnalysis, is_reach: bool, reason: str) -> LimitAnalysis:
    effects = analysis.assembly.effects.settled("reach", is_reach, reason)
    return replace(analysis, assembly=replace(analysis.assembly, effects=effects))


def _without(whole: LimitAnalysis, sharp_assembly: Assembly, aside: np.ndarray) -> LimitAnalysis:
    """The whole structure's analysis with `aside` (B,) held: bounds keep their mechanisms, and forces where contacts are left."""

    def left(solutions: dict[Drive, Solution], assembly: Assembly) -> dict[Drive, Solution]:
        kept = reach.kept_points(assembly, aside)
        return {drive: replace(solution, forces=solution.forces[kept]) for drive, solution in solutions.items()}

    rounded, sharp = left(whole.rounded, whole.assembly), left(whole.sharp, sharp_assembly)
    return replace(whole, assembly=reach.set_aside(whole.assembly, aside), rounded=rounded, sharp=sharp)


def _predicted(
    scene: Scene, analysis: LimitAnalysis, sharp_assembly: Assembly, search: Sliding | None, steps: int, first_sags: float
) -> LimitAnalysis:
    """With Coulomb's prediction, where the scene calls for it; the associated answer is it where no joint was found to slide."""
    assembly, rounded, sharp = analysis.assembly, analysis.rounded[analysis.main], analysis.sharp[analysis.main]
    alike = assembly.inset == sharp_assembly.inset
    if search is not None and not search.found:
        coulomb, coulomb_sharp = search.as_coulomb(assembly, rounded), replace(search, seconds=0.0).as_coulomb(sharp_assembly, sharp)
    elif assembly.effects.friction == "coulomb":
        coulomb = predict(assembly, analysis.stiffness, rounded, wedging(scene), steps, first_sags)
        coulomb_sharp = coulomb if alike else predict(sharp_assembly, analysis.stiffness, sharp, wedging(scene), steps, first_sags)
    else:
        return analysis
    return replace(analysis, coulomb=coulomb, coulomb_sharp=coulomb if alike else coulomb_sharp)


def _at_rest(scene: Scene, analysis: LimitAnalysis, assembly: Assembly, sharp_assembly: Assembly) -> LimitAnalysis:
    """With the reactions at rest of the whole assemblies: the region beside unyielding blocks sags in another way."""
    if analysis.coulomb is None or analysis.coulomb_sharp is None or assembly.effects.friction != "coulomb":
        return analysis
    at_rest = [reaction_at_rest(one, analysis.stiffness, wedging(scene)) for one in (assembly, sharp_assembly)]
    coulomb, coulomb_sharp = replace(analysis.coulomb, at_rest=at_rest[0]), replace(analysis.coulomb_sharp, at_rest=at_rest[1])
    return replace(analysis, coulomb=coulomb, coulomb_sharp=coulomb_sharp)


def wedging(scene: Scene) -> float:
    """Motion of the support against its settlement before gravity acts, m or rad."""
    return float(scene.yade.get("wedging", 0.0))
