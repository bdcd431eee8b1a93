"""Model of a scene: its assemblies at the shared inset and for sharp edges, and the stiffness of its joints."""

from dataclasses import dataclass

import numpy as np

from la_core.errors import SceneError
from la_core.geometry import Interfaces, next_corners, owners
from la_core.limit import Drive
from la_core.model import Assembly, JointStiffness, assemble, decide_dem_effects, joint_stiffness
from la_core.scene import Scene

SMALLEST_INSET = 0.001  # m; and at most SMALLEST_INSET_SHARE of the median width of interfaces; narrower ones have their own inset
SMALLEST_INSET_SHARE = 0.02


@dataclass(frozen=True)
class StructuralModel:
    """Scene that is ready for the solvers.

    Attributes
    ----------
    scene : Scene
        Scene of the model.
    assembly : Assembly
        Contact points at the shared inset: the scene's, or that of YADE where the scene has inset 0.
    sharp : Assembly
        Contact points at inset 0.
    stiffness : JointStiffness
        Stiffness of the joints at the shared inset.
    least_gap : float
        Lower bound of the gap between blocks without a joint, m, see `LimitAnalysis`.
    """

    scene: Scene
    assembly: Assembly
    sharp: Assembly
    stiffness: JointStiffness
    least_gap: float

    def with_inset(self, inset: float) -> "StructuralModel":
        """Model the same scene with another shared inset, m, greater than 0."""
        return _at_inset(self.scene, self.assembly.with_inset(self.scene, inset), self.sharp)


def structural_model(scene: Scene, interfaces: Interfaces | None = None) -> StructuralModel:
    """Assemble a scene at both insets and decide the effects that need no solution.

    interfaces: interfaces of its blocks, if they are known; None searches them. Raises SceneError where the scene
    requests an effect that it does not allow; `decide_effects` checks the effects that need a solution.
    """
    assembly = assemble(scene, interfaces)
    sharp = assembly if scene.inset == 0.0 else assembly.with_inset(scene, 0.0)
    if scene.inset == 0.0:
        assembly = assembly.with_inset(scene, smallest_inset(assembly))
    return _at_inset(scene, assembly, sharp)


def _at_inset(scene: Scene, assembly: Assembly, sharp: Assembly) -> StructuralModel:
    """Model a scene with its assemblies at the shared inset and for sharp edges."""
    try:
        stiffness = joint_stiffness(assembly, scene.yade)
    except SceneError as error:
        raise scene.located(error) from error
    assembly, least_gap = decide_dem_effects(scene, assembly, stiffness)
    return StructuralModel(scene, assembly, sharp, stiffness, least_gap)


def drives(scene: Scene) -> tuple[Drive, ...]:
    """Drives of a scene: both directions of the support, or its live load."""
    return (Drive.LIVE,) if scene.live is not None else (Drive.YIELDING, Drive.PUSHING)


def smallest_inset(assembly: Assembly) -> float:
    """Smallest inset for YADE's contact spheres, m; it replaces the inset 0 of sharp edges."""
    interfaces = assembly.interfaces
    owner = owners(interfaces.polygon_start)
    edges = np.linalg.norm(interfaces.polygon[next_corners(interfaces.polygon_start)] - interfaces.polygon, axis=1)
    width = 2.0 * interfaces.area / np.bincount(owner, weights=edges)
    middle = np.sort(width)[(len(width) - 1) // 2]
    return float(min(SMALLEST_INSET, SMALLEST_INSET_SHARE * middle))


def has_given_stiffness(scene: Scene) -> bool:
    """Whether the scene sets the stiffness of YADE's joints, or wedging, whose thrust is in proportion to it."""
    return "normal_stiffness" in scene.yade or wedging(scene) != 0.0


def wedging(scene: Scene) -> float:
    """Motion of the support against its settlement before gravity acts, m (rad for a rotation)."""
    return float(scene.yade.get("wedging", 0.0))
