"""The limit-analysis stage: from a scene to all its solutions."""

import hashlib
from collections.abc import Iterator
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

import numpy as np

from la_core.analysis import reach
from la_core.analysis.prediction import search_sliding, wedging, with_prediction
from la_core.analysis.result import LimitAnalysis
from la_core.coulomb import FIRST_SAGS, STEPS, follow_path, may_leave_out_friction, settled_effects
from la_core.errors import SceneError
from la_core.limit import Drive, Solution, Status, scaled_problem, solve
from la_core.model import Assembly, JointStiffness, assemble, joint_stiffness, settle_run
from la_core.scene import Path as PathAsked
from la_core.scene import Scene

SMALLEST_INSET = 0.001  # m; and at most SMALLEST_INSET_SHARE of the narrowest interface
SMALLEST_INSET_SHARE = 0.02


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


def analyse(scene: Scene, with_path: bool = False, slides: str = "", steps: int = STEPS, first_sags: float = FIRST_SAGS) -> LimitAnalysis:
    """Assemble and solve a scene, at the inset that both methods share and for sharp arrises.

    The bounds, the path and the reaction at rest are those of the whole structure; the prediction is that of the region within reach
    where it is proven to be the whole structure's. The path is followed where the scene asks for it, or with_path does. slides: why
    joints are known to slide, which keeps friction in where "auto" might leave it out. steps: of the prediction, from rest to the plateau.
    first_sags: travel of the first of them over the elastic sag.
    """
    assembly, sharp_assembly, stiffness, least_gap = model(scene)
    rounded = dict(_solve_all(scene, assembly))
    sharp = rounded if assembly.inset == sharp_assembly.inset else dict(_solve_all(scene, sharp_assembly))
    bounds = LimitAnalysis(assembly, rounded, sharp, stiffness, least_gap)
    analysis, path = with_prediction(scene, bounds, sharp_assembly, slides, with_path, steps, first_sags), None
    is_followed = with_path or analysis.assembly.effects.elasticity == "path"
    if is_followed and assembly.effects.friction == "coulomb" and rounded[bounds.main].status is Status.SOLVED:
        asked = scene.path_asked or PathAsked()
        path = follow_path(assembly, stiffness, asked.settlement or stiffness.travel, asked.increments, wedging(scene))
    return replace(analysis, path=path)


def settled(scene: Scene) -> Assembly:
    """The assembly at the shared inset with its effects settled, at the price of one bound and a few elastic steps.

    Reach is what `analyse` will try first; only its answer can prove it.
    """
    assembly, sharp_assembly, stiffness, least_gap = model(scene)
    main, effects = drives(scene)[0], assembly.effects
    if effects.friction == "coulomb" and may_leave_out_friction(scene):
        bounds = LimitAnalysis(assembly, {main: solve(assembly, main)}, {}, stiffness, least_gap)
        search = search_sliding(scene, bounds)
        if not search.found and sharp_assembly.inset != assembly.inset:
            search = search.unless_sliding(sharp_assembly, solve(sharp_assembly, main))
        effects = settled_effects(scene, effects, search)
    masks, reason = reach.choices(scene, assembly)
    part = reach.set_aside(assembly, masks[0]) if masks else assembly
    effects = effects.settled("reach", bool(masks), f"{reach.reason(part)}, if the answer proves it" if masks else reason)
    return replace(part, effects=effects)


def model(scene: Scene) -> tuple[Assembly, Assembly, JointStiffness, float]:
    """What is solved: the assembly at the inset that both methods share and that with sharp arrises, their joints, the least gap (m).

    Raises SceneError for all that a scene asks for and does not allow, but for what only an answer can tell.
    """
    assembly = assemble(scene)
    sharp = assembly if scene.inset == 0.0 else assembly.with_inset(scene, 0.0)
    if scene.inset == 0.0 and scene.live is None:
        assembly = assembly.with_inset(scene, smallest_inset(assembly))
    try:
        stiffness = joint_stiffness(assembly, assembly.inset, scene.yade)
    except SceneError as error:
        raise SceneError(str(scene.path), str(error)) from error
    assembly, least_gap = settle_run(scene, assembly, stiffness)
    return assembly, sharp, stiffness, least_gap


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


def code_digest(*folders: Path) -> str:
    """Digest of all Python code below the folders: where each file lies, and every byte of it."""
    total = hashlib.sha256()
    for folder in folders:
        for source in sorted(folder.rglob("*.py")):
            name, content = source.relative_to(folder).as_posix().encode(), source.read_bytes()
            total.update(b"%d %b %d %b" % (len(name), name, len(content), content))
    return total.hexdigest()


def digest(scene: Scene) -> str:
    """Digest of all that decides the limit analysis: the scene's name, text and meshes, and this package's code."""
    meshes = [f"{mesh.path} {hashlib.sha256(mesh.content).hexdigest()}" for mesh in scene.meshes]
    text = "\n".join([scene.name, code_digest(Path(__file__).parents[1]), version("clarabel"), *meshes, scene.text])
    return hashlib.sha256(text.encode()).hexdigest()
