"""The limit-analysis stage: from a scene to all its solutions."""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path

import numpy as np

from la_core import reach
from la_core.assembly import Assembly, assemble
from la_core.coulomb import CoulombSolution, predict, reaction_at_rest
from la_core.errors import SceneError
from la_core.limit import Drive, Solution, Status, scaled_problem, solve
from la_core.path import Path as FollowedPath
from la_core.path import follow_path
from la_core.scene import Scene
from la_core.schema import Path as PathAsked
from la_core.stiffness import JointStiffness, joint_stiffness

SMALLEST_INSET = 0.001  # m; and at most SMALLEST_INSET_SHARE of the narrowest interface
SMALLEST_INSET_SHARE = 0.02


@dataclass(frozen=True)
class LimitAnalysis:
    """Solutions of a scene at the inset the methods share and for sharp arrises.

    assembly: contact points at the shared inset: the scene's, or the smallest that YADE can take where the scene has none.
    rounded, sharp: solution by drive at that inset and at inset 0. stiffness: of the joints, at the shared inset.
    coulomb, coulomb_sharp: the same with friction that does not dilate, None where the scene does not call for it.
    path: the curve from rest to the plateau at the shared inset, None where nobody asked for it.
    """

    assembly: Assembly
    rounded: dict[Drive, Solution]
    sharp: dict[Drive, Solution]
    stiffness: JointStiffness
    coulomb: CoulombSolution | None = None
    coulomb_sharp: CoulombSolution | None = None
    path: FollowedPath | None = None

    @property
    def main(self) -> Drive:
        """The drive whose answer the scene asks for."""
        return Drive.LIVE if Drive.LIVE in self.rounded else Drive.YIELDING


def drives(scene: Scene) -> tuple[Drive, ...]:
    """What a scene is solved for: both bounds of the reaction, or the multiplier of its live load."""
    return (Drive.LIVE,) if scene.live is not None else (Drive.YIELDING, Drive.PUSHING)


def smallest_inset(assembly: Assembly) -> float:
    """Inset (m) in the place of sharp arrises: the smallest that YADE's contact spheres can take."""
    interfaces = assembly.interfaces
    owner = np.repeat(np.arange(len(interfaces)), np.diff(interfaces.polygon_start))
    following = np.arange(1, len(owner) + 1)
    following[interfaces.polygon_start[1:] - 1] = interfaces.polygon_start[:-1]
    edges = np.linalg.norm(interfaces.polygon[following] - interfaces.polygon, axis=1)
    width = 2.0 * interfaces.area / np.bincount(owner, weights=edges)
    return float(min(SMALLEST_INSET, SMALLEST_INSET_SHARE * width.min()))


def analyse(scene: Scene, with_path: bool = False) -> LimitAnalysis:
    """Assemble and solve a scene, at the inset that both methods share and for sharp arrises.

    The bounds and the path are those of the whole structure, so is the reaction at rest; the prediction is that of the region within
    `reach` where it is proven to be the whole structure's. The path is followed where the scene asks for it, or with_path does.
    """
    assembly = assemble(scene)
    sharp_assembly = assembly if scene.inset == 0.0 else assembly.with_inset(scene, 0.0)
    if scene.inset == 0.0 and scene.live is None:
        assembly = assembly.with_inset(scene, smallest_inset(assembly))
    stiffness = _stiffness(scene, assembly)
    rounded = dict(_solve_all(scene, assembly))
    sharp = rounded if assembly is sharp_assembly else dict(_solve_all(scene, sharp_assembly))
    whole = LimitAnalysis(assembly, rounded, sharp, stiffness)
    analysis = _within_reach(scene, whole, sharp_assembly)
    path = None
    if assembly.effects.friction == "coulomb" and (scene.path_asked or with_path) and rounded[whole.main].status is Status.SOLVED:
        asked = scene.path_asked or PathAsked()
        path = follow_path(assembly, stiffness, asked.settlement or stiffness.travel, asked.increments, _wedging(scene))
    return replace(analysis, path=path)


def _within_reach(scene: Scene, whole: LimitAnalysis, sharp_assembly: Assembly) -> LimitAnalysis:
    """The analysis with its prediction, by the smallest region whose answer counts for the whole structure."""
    masks, reason = reach.choices(scene, whole.assembly)
    if masks and whole.rounded[whole.main].status is not Status.SOLVED:
        masks, reason = [], f"the whole structure is {whole.rounded[whole.main].status}"
    for aside in masks:
        part, sharp_part = _without(whole, sharp_assembly, aside), reach.set_aside(sharp_assembly, aside)
        part = _with_prediction(scene, part, sharp_part)
        answer, sharp_answer = part.coulomb or part.rounded[part.main], part.coulomb_sharp or part.sharp[part.main]
        obstacle = reach.obstacle(whole.assembly, part.assembly, answer.twists, answer.forces)
        obstacle = obstacle or reach.obstacle(sharp_assembly, sharp_part, sharp_answer.twists, sharp_answer.forces)
        if not obstacle:
            return _at_rest(scene, _because(part, True, reach.reason(part.assembly)), whole.assembly, sharp_assembly)
        reason = f"the whole structure is modelled after all: {obstacle}"
    return _with_prediction(scene, _because(whole, False, reason), sharp_assembly)


def _because(analysis: LimitAnalysis, is_reach: bool, reason: str) -> LimitAnalysis:
    effects = analysis.assembly.effects
    effects = replace(effects, reach=is_reach, reasons=effects.reasons | {"reach": reason})
    return replace(analysis, assembly=replace(analysis.assembly, effects=effects))


def _without(whole: LimitAnalysis, sharp_assembly: Assembly, aside: np.ndarray) -> LimitAnalysis:
    """The whole structure's analysis with `aside` (B,) held: bounds keep their mechanisms, and forces where contacts are left."""

    def left(solutions: dict[Drive, Solution], assembly: Assembly) -> dict[Drive, Solution]:
        kept = reach.kept_points(assembly, aside)
        return {drive: replace(solution, forces=solution.forces[kept]) for drive, solution in solutions.items()}

    rounded, sharp = left(whole.rounded, whole.assembly), left(whole.sharp, sharp_assembly)
    return replace(whole, assembly=reach.set_aside(whole.assembly, aside), rounded=rounded, sharp=sharp)


def _with_prediction(scene: Scene, analysis: LimitAnalysis, sharp_assembly: Assembly) -> LimitAnalysis:
    """With Coulomb's prediction, where the scene calls for it."""
    if analysis.assembly.effects.friction != "coulomb":
        return analysis
    rounded, sharp, main = analysis.rounded, analysis.sharp, analysis.main
    coulomb = predict(analysis.assembly, analysis.stiffness, rounded[main], _wedging(scene))
    alike = sharp is rounded
    coulomb_sharp = coulomb if alike else predict(sharp_assembly, analysis.stiffness, sharp[main], _wedging(scene))
    return replace(analysis, coulomb=coulomb, coulomb_sharp=coulomb_sharp)


def _at_rest(scene: Scene, analysis: LimitAnalysis, assembly: Assembly, sharp_assembly: Assembly) -> LimitAnalysis:
    """With the reactions at rest of the whole assemblies: the region beside unyielding blocks sags in another way."""
    if analysis.coulomb is None or analysis.coulomb_sharp is None:
        return analysis
    at_rest = [reaction_at_rest(one, analysis.stiffness, _wedging(scene)) for one in (assembly, sharp_assembly)]
    coulomb, coulomb_sharp = replace(analysis.coulomb, at_rest=at_rest[0]), replace(analysis.coulomb_sharp, at_rest=at_rest[1])
    return replace(analysis, coulomb=coulomb, coulomb_sharp=coulomb_sharp)


def _wedging(scene: Scene) -> float:
    return float(scene.yade.get("wedging", 0.0))


def _stiffness(scene: Scene, assembly: Assembly) -> JointStiffness:
    try:
        return joint_stiffness(assembly, assembly.inset, scene.yade)
    except SceneError as error:
        raise SceneError(str(scene.path), str(error)) from error


def _solve_all(scene: Scene, assembly: Assembly) -> Iterator[tuple[Drive, Solution]]:
    """Every drive of a scene; a structure that cannot stand cannot in any of them, so the first says it all."""
    problem = scaled_problem(assembly)
    for drive in drives(scene):
        solution = solve(assembly, drive, problem)
        yield drive, solution
        if solution.status is Status.INFEASIBLE:
            for other in drives(scene):
                if other is not drive:
                    yield other, solution
            return


def code_digest(folder: Path) -> str:
    """Digest of the Python code directly in a package's folder."""
    total = hashlib.sha256()
    for source in sorted(folder.glob("*.py")):
        total.update(source.read_bytes())
    return total.hexdigest()


def digest(scene: Scene) -> str:
    """Digest of all that decides the limit analysis: the scene's name, text and meshes, and this package's code."""
    meshes = [f"{mesh.path} {hashlib.sha256(mesh.content).hexdigest()}" for mesh in scene.meshes]
    text = "\n".join([scene.name, code_digest(Path(__file__).parent), version("clarabel"), *meshes, scene.text])
    return hashlib.sha256(text.encode()).hexdigest()
