"""The limit-analysis stage: from a scene to all its solutions."""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path

import numpy as np

from la_core.assembly import Assembly, assemble
from la_core.coulomb import CoulombSolution, predict
from la_core.errors import SceneError
from la_core.limit import Drive, Solution, Status, scaled_problem, solve
from la_core.path import Path as FollowedPath
from la_core.path import follow_path
from la_core.run_effects import settle_run
from la_core.scene import Scene
from la_core.schema import Path as PathAsked
from la_core.sliding import Sliding, look_for_sliding, may_leave_out_friction, settled_effects
from la_core.stiffness import JointStiffness, joint_stiffness

SMALLEST_INSET = 0.001  # m; and at most SMALLEST_INSET_SHARE of the narrowest interface
SMALLEST_INSET_SHARE = 0.02


@dataclass(frozen=True)
class LimitAnalysis:
    """Solutions of a scene at the inset the methods share and for sharp arrises.

    assembly: contact points at the shared inset: the scene's, or the smallest that YADE can take where the scene has none.
    rounded, sharp: solution by drive at that inset and at inset 0. stiffness: of the joints, at the shared inset.
    coulomb, coulomb_sharp: the same with friction that does not dilate, None where the scene does not call for it.
    least_gap: bound of the gap between blocks without a joint, m, see `settle_run`; NaN where nobody looked.
    path: the curve from rest to the plateau at the shared inset, None where nobody asked for it.
    """

    assembly: Assembly
    rounded: dict[Drive, Solution]
    sharp: dict[Drive, Solution]
    stiffness: JointStiffness
    least_gap: float = float("nan")
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


def analyse(scene: Scene, with_path: bool = False, slides: str = "") -> LimitAnalysis:
    """Assemble and solve a scene, at the inset that both methods share and for sharp arrises.

    The path is followed where the scene asks for it, or with_path does. slides: why joints are known to slide, which keeps friction
    in where "auto" might leave it out.
    """
    assembly, sharp_assembly = _assemblies(scene)
    stiffness = _stiffness(scene, assembly)
    assembly, least_gap = settle_run(scene, assembly, stiffness)
    rounded = dict(_solve_all(scene, assembly))
    sharp = rounded if assembly.inset == sharp_assembly.inset else dict(_solve_all(scene, sharp_assembly))
    analysis = LimitAnalysis(assembly, rounded, sharp, stiffness, least_gap)
    main, wedging = analysis.main, _wedging(scene)
    if assembly.effects.friction != "coulomb":
        return analysis
    if may_leave_out_friction(scene) and not with_path:
        search = Sliding(True, slides) if slides else look_for_sliding(assembly, stiffness, rounded[main], wedging)
        search = search.unless_sliding(sharp_assembly, sharp[main])
        analysis = replace(analysis, assembly=replace(assembly, effects=settled_effects(scene, assembly.effects, search)))
        if not search.found:
            coulomb, coulomb_sharp = (search.as_coulomb(*pair) for pair in ((assembly, rounded[main]), (sharp_assembly, sharp[main])))
            return replace(analysis, coulomb=coulomb, coulomb_sharp=coulomb if sharp is rounded else replace(coulomb_sharp, seconds=0.0))
    coulomb = predict(assembly, stiffness, rounded[main], wedging)
    coulomb_sharp = coulomb if sharp is rounded else predict(sharp_assembly, stiffness, sharp[main], wedging)
    path = None
    if (assembly.effects.elasticity == "path" or with_path) and rounded[main].status is Status.SOLVED:
        asked = scene.path_asked or PathAsked()
        path = follow_path(assembly, stiffness, asked.settlement or stiffness.travel, asked.increments, wedging)
    return replace(analysis, coulomb=coulomb, coulomb_sharp=coulomb_sharp, path=path)


def settled(scene: Scene) -> Assembly:
    """The assembly at the shared inset with its effects settled, at the price of one bound and a few elastic steps."""
    assembly, sharp_assembly = _assemblies(scene)
    stiffness = _stiffness(scene, assembly)
    assembly, _ = settle_run(scene, assembly, stiffness)
    if assembly.effects.friction != "coulomb" or not may_leave_out_friction(scene):
        return assembly
    main = drives(scene)[0]
    search = look_for_sliding(assembly, stiffness, solve(assembly, main), _wedging(scene))
    if not search.found and sharp_assembly.inset != assembly.inset:
        search = search.unless_sliding(sharp_assembly, solve(sharp_assembly, main))
    return replace(assembly, effects=settled_effects(scene, assembly.effects, search))


def _wedging(scene: Scene) -> float:
    return float(scene.yade.get("wedging", 0.0))


def _assemblies(scene: Scene) -> tuple[Assembly, Assembly]:
    """The assembly at the inset that both methods share, and that with sharp arrises."""
    assembly = assemble(scene)
    sharp = assembly if scene.inset == 0.0 else assembly.with_inset(scene, 0.0)
    if scene.inset == 0.0 and scene.live is None:
        assembly = assembly.with_inset(scene, smallest_inset(assembly))
    return assembly, sharp


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
