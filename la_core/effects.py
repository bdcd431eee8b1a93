"""Which effects a scene calls for, each with its reason."""

from dataclasses import dataclass

import numpy as np

from la_core.errors import SceneError
from la_core.scene import Scene

FLAT = 1e-6  # of the depth, or of a unit vector: deviations below this are in the plane


@dataclass(frozen=True)
class Effects:
    """What is modelled, and why: reasons by effect.

    plane: motion in the xz plane only. friction: "coulomb", "associated" or "none-slides". elasticity: of the joints in limit
    analysis, "none", "plateau" (in steps to the plateau) or "path" (the whole curve). reach: only the blocks that the support's
    motion can touch. displacement: of YADE's contacts, "small" (those listed) or "finite" (new ones are looked for).
    recording: of YADE's states, "plateau" (at rest and on the plateau) or "states" (all along).
    """

    plane: bool
    friction: str
    elasticity: str
    reach: bool
    displacement: str
    recording: str
    reasons: dict[str, str]


def decide(scene: Scene) -> Effects:
    """Settle every "auto" of the scene; raises SceneError where a scene demands a plane model it does not allow."""
    obstacle = _obstacle_to_plane(scene)
    asked = scene.effects.plane
    if asked is True and obstacle:
        raise SceneError("effects.plane", obstacle, value=True, hint='leave it out or say "auto"')
    plane = not obstacle if asked == "auto" else bool(asked)
    if scene.effects.reach is True and scene.live is not None:
        raise SceneError("effects.reach", "a live load acts on every block", value=True, hint='leave it out or say "auto"')
    low, high = scene.blocks.low[:, 1].min(), scene.blocks.high[:, 1].max()
    fits = f"every block is a prism from y = {low:.6g} to {high:.6g} m, and gravity and the motion lie in the xz plane"
    friction = "coulomb" if scene.effects.friction == "auto" else scene.effects.friction
    return Effects(
        plane,
        friction,
        elasticity="plateau" if friction == "coulomb" else "none",
        reach=False,  # until its answer is proven, see `la_core.reach`
        displacement="finite",
        recording="states",
        reasons={
            "plane": obstacle or (fits if plane else f"asked for in the scene, although {fits}"),
            "friction": "the default: joints slide without dilating" if scene.effects.friction == "auto" else "asked for in the scene",
        },
    )


def _obstacle_to_plane(scene: Scene) -> str:
    """Why the scene is not plane, or "" when it is."""
    blocks = scene.blocks
    low, high = blocks.low[:, 1], blocks.high[:, 1]
    depth = high.max() - low.min()
    for outlier in np.flatnonzero((low - low.min() > FLAT * depth) | (high.max() - high > FLAT * depth)):
        return f'block "{blocks.names[outlier]}" does not span the whole depth, y = {low.min():.6g} to {high.max():.6g} m'
    for outlier in np.flatnonzero(np.minimum(np.abs(blocks.face_normal[:, 1]), 1.0 - np.abs(blocks.face_normal[:, 1])) > FLAT):
        return f'block "{blocks.names[blocks.face_block[outlier]]}" is not a prism along y'
    if abs(scene.gravity[1]) > FLAT * np.linalg.norm(scene.gravity):
        return "gravity has a component along y"
    if scene.live is not None and abs(scene.live[1]) > FLAT:
        return "the live load has a component along y"
    if scene.support_twist is not None:
        velocity, spin = scene.support_twist[:3], scene.support_twist[3:]
        out_of_plane = np.hypot(spin[0], spin[2]) if np.any(spin) else abs(velocity[1])
        if out_of_plane > FLAT:
            return "the support does not move in the xz plane"
    return ""
