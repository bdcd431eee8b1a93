"""What is solved: the assembly at the inset that both methods share and for sharp arrises, with its elastic joints."""

from dataclasses import dataclass

import numpy as np

from la_core.errors import SceneError
from la_core.geometry import Interfaces
from la_core.limit import Drive
from la_core.model import Assembly, JointStiffness, assemble, decide_dem_effects, joint_stiffness
from la_core.scene import Scene

SMALLEST_INSET = 0.001  # m; and at most SMALLEST_INSET_SHARE of the narrowest interface
SMALLEST_INSET_SHARE = 0.02


@dataclass(frozen=True)
class StructuralModel:
    """A scene ready to be solved.

    assembly: contact points at the inset that both methods share: the scene's, or the smallest that YADE can take where the scene has
    none. sharp: contact points at inset 0. stiffness: of the joints at the shared inset. least_gap: see `LimitAnalysis`, m.
    """

    scene: Scene
    assembly: Assembly
    sharp: Assembly
    stiffness: JointStiffness
    least_gap: float

    def with_scene(self, scene: Scene) -> "StructuralModel":
        """The model of a scene with the same blocks, and another inset or other effects; interfaces are not searched again."""
        return structural_model(scene, self.assembly.interfaces)


def structural_model(scene: Scene, interfaces: Interfaces | None = None) -> StructuralModel:
    """Model a scene. interfaces: of its blocks, where they are known.

    Raises SceneError for everything that the scene requests and does not allow, except for what only an answer can tell.
    """
    assembly = assemble(scene, interfaces)
    sharp = assembly if scene.inset == 0.0 else assembly.with_inset(scene, 0.0)
    if scene.inset == 0.0 and scene.live is None:
        assembly = assembly.with_inset(scene, smallest_inset(assembly))
    try:
        stiffness = joint_stiffness(assembly, assembly.inset, scene.yade)
    except SceneError as error:
        raise SceneError(str(scene.path), str(error)) from error
    assembly, least_gap = decide_dem_effects(scene, assembly, stiffness)
    return StructuralModel(scene, assembly, sharp, stiffness, least_gap)


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


def wedging(scene: Scene) -> float:
    """Motion of the support against its settlement before gravity acts, m or rad."""
    return float(scene.yade.get("wedging", 0.0))
