"""The effects that a scene needs, each with its reason."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from la_core.errors import SceneError
from la_core.geometry import Held
from la_core.scene import Scene
from la_core.text_table import coordinate_text

FLAT = 1e-6  # of the depth, or of a unit vector: deviations below this are in the plane


@dataclass(frozen=True)
class Effects(Held):
    """Modelled effects with their reasons.

    Attributes
    ----------
    plane : bool
        Whether blocks move in the xz plane only.
    friction : str
        "coulomb", "associated" or "none-slides".
    elasticity : str
        Strain of the joints in limit analysis: "none", "plateau" (on the way to the plateau) or "path" (along the
        requested curve, too).
    reach : bool
        Whether only the blocks that the support's motion can affect are modelled.
    displacement : str
        Contacts in YADE: "small" (those of the case) or "finite" (YADE searches for new ones).
    recording : str
        States that YADE stores: "plateau" (at rest and on the plateau) or "states" (all the way).
    reasons : mapping of str
        Reason for each effect, by its name.
    rotation : str
        Rotations of the blocks in limit analysis: "small", or "finite" (turning blocks may release thrusts).
    sliding_excluded : bool
        Whether sliding is excluded by Heyman's law at the scene's request, and not only absent from the answer.
    called_back : tuple of str
        Effects that were first left out and turned on again after a run in YADE.
    """

    plane: bool
    friction: str
    elasticity: str
    reach: bool
    displacement: str
    recording: str
    reasons: Mapping[str, str]
    rotation: str = "small"
    sliding_excluded: bool = False
    called_back: tuple[str, ...] = ()

    @property
    def as_dict(self) -> dict[str, Any]:
        """All effects by name, as values for JSON."""
        return vars(self) | {"reasons": dict(self.reasons)}

    def with_effect(self, effect: str, choice: bool | str, reason: str) -> "Effects":
        """The same effects with another choice for one effect, and the reason for it."""
        return replace(self, **{effect: choice, "reasons": dict(self.reasons) | {effect: reason}})  # type: ignore[arg-type]


def decide(scene: Scene) -> Effects:
    """Decide the effects that depend on the scene alone.

    Friction "auto" is Coulomb's until `la_core.coulomb` has searched for sliding joints. Raises SceneError for a
    requested effect that the scene does not allow.
    """
    plane, why_plane = _decide_plane(scene)
    if scene.effects.reach is True and scene.live is not None:
        raise SceneError("effects.reach", "a live load acts on every block", value=True, hint='leave it out or say "auto"')
    friction, elasticity = scene.effects.friction, scene.effects.elasticity
    if elasticity == "auto":
        elasticity = "none" if friction in ("associated", "none-slides") else "path" if scene.path_asked else "plateau"
    elif (obstacle := _obstacle_to_elasticity(scene)) is not None:
        raise SceneError("effects.elasticity", obstacle, value=elasticity, hint='leave it out or say "auto"')
    rotation, why_rotation = _decide_rotation(scene)
    by_request = "requested in the scene"
    reasons = {
        "plane": why_plane,
        "friction": by_request if friction != "auto" else "a [path] follows the history of friction" if scene.path_asked else _DEFAULT,
        "elasticity": by_request if scene.effects.elasticity != "auto" else _WHY_ELASTIC[elasticity],
        "rotation": why_rotation,
    }
    return Effects(
        plane,
        "coulomb" if friction == "auto" else friction,
        elasticity,
        reach=False,  # until the reduced answer is proven, see `la_core.analysis.reach`
        displacement="finite",
        recording="states",
        reasons=reasons,
        rotation=rotation,
        sliding_excluded=friction == "none-slides",
    )


BOUNDS_HOLD = "bounds hold for every history of friction"
BOUNDS_WITHOUT_STRAIN = "bounds do not depend on the joints' strain"
_DEFAULT = "joints may slide, and real friction does not dilate"
_WHY_ELASTIC = {
    "none": BOUNDS_WITHOUT_STRAIN,
    "plateau": "friction without dilatancy follows the joints' strain from rest to the plateau",
    "path": "a [path] is requested",
}


def _decide_plane(scene: Scene) -> tuple[bool, str]:
    """Whether the model is plane, and why."""
    obstacle = _obstacle_to_plane(scene)
    request = scene.effects.plane
    if request is True and obstacle:
        raise SceneError("effects.plane", obstacle, value=True, hint='leave it out or say "auto"')
    plane = not obstacle if request == "auto" else bool(request)
    fits = f"every block is a prism from {_depth_words(scene)}, and gravity and the motion lie in the xz plane"
    return plane, obstacle or (fits if plane else f"requested in the scene, although {fits}")


def _decide_rotation(scene: Scene) -> tuple[str, str]:
    """Whether rotations are "small" or "finite", and why."""
    friction, request = scene.effects.friction, scene.effects.rotation
    bounds_alone = friction in ("associated", "none-slides")
    if request == "finite" and bounds_alone:
        obstacle = f'friction = "{friction}" yields bounds, which hold for every rotation'
        raise SceneError("effects.rotation", obstacle, value=request, hint='leave it out or say "auto"')
    if request != "auto":
        return request, "requested in the scene"
    return "small", BOUNDS_HOLD if bounds_alone else "the answer is for small displacements"


def _obstacle_to_elasticity(scene: Scene) -> str | None:
    """Why the requested elasticity contradicts the requested friction, or None where it does not."""
    friction, elasticity = scene.effects.friction, scene.effects.elasticity
    if elasticity == "none" and friction == "coulomb":
        return "friction without dilatancy follows the joints' strain, and without strain its answer is not unique"
    if elasticity == "none" and scene.path_asked:
        return "a [path] is a path of strain"
    if elasticity != "none" and friction in ("associated", "none-slides"):
        return f'friction = "{friction}" yields bounds, which do not depend on the joints\' strain'
    return None


def _depth_words(scene: Scene) -> str:
    """Extent of all blocks together along y, such as "y = 0 to 0.4 m"."""
    return f"y = {coordinate_text(scene.blocks.low[:, 1].min())} to {coordinate_text(scene.blocks.high[:, 1].max())} m"


def _obstacle_to_plane(scene: Scene) -> str:
    """Why the scene is not plane, or "" where it is."""
    blocks, parts = scene.blocks, scene.blocks.parts  # a block with dents in plan spans the depth, but its parts do not
    low, high = parts.low[:, 1], parts.high[:, 1]
    depth = high.max() - low.min()
    for outlier in np.flatnonzero((low - low.min() > FLAT * depth) | (high.max() - high > FLAT * depth)):
        return f'block "{parts.names[outlier]}" does not span the whole depth, {_depth_words(scene)}'
    for outlier in np.flatnonzero(np.minimum(np.abs(blocks.face_normal[:, 1]), 1.0 - np.abs(blocks.face_normal[:, 1])) > FLAT):
        return f'block "{blocks.names[blocks.face_block[outlier]]}" is not a prism along y'
    if abs(scene.gravity[1]) > FLAT * np.linalg.norm(scene.gravity):
        return "gravity has a component along y"
    if scene.live is not None and abs(scene.live[1]) > FLAT:
        return "the tilt pushes along y" if scene.tilt is not None else "the live load has a component along y"
    if scene.support_twists is not None:
        turns = np.any(scene.support_twists[:, 3:], axis=1)
        out_of_plane = np.where(turns, np.hypot(*scene.support_twists[:, [3, 5]].T), np.abs(scene.support_twists[:, 1]))
        if out_of_plane.max() > FLAT:
            return "the support does not move in the xz plane"
    return _load_out_of_plane(scene)


def applied_wrenches(scene: Scene) -> np.ndarray:
    """Dead loads and ties of a scene as wrenches (B, 6) about the centroids, N and N m."""
    applied = scene.loads.wrenches(scene.blocks.centroid)
    return applied if scene.ties is None else applied + scene.ties.forces.wrenches(scene.blocks.centroid)


def _load_out_of_plane(scene: Scene) -> str:
    """Why loads and ties are not in the xz plane, or "" where they are."""
    wrenches, blocks = applied_wrenches(scene), scene.blocks
    size = np.linalg.norm(blocks.high - blocks.low, axis=1)
    scale = np.maximum(np.linalg.norm(wrenches[:, :3], axis=1), np.linalg.norm(wrenches[:, 3:], axis=1) / size)
    masses = scene.loads.wrenches(blocks.centroid, per_mass=np.zeros(3) if scene.live is None else scene.live)
    across = np.abs(wrenches[:, 1]) + np.abs(wrenches[:, [3, 5]]).max(axis=1) / size
    turning = np.abs(masses[:, [3, 5]]).max(axis=1) / size
    bent = np.flatnonzero((across > FLAT * scale) | (turning > FLAT * np.linalg.norm(masses[:, :3], axis=1)))
    where = "acts out of the xz plane, or beside the middle of the depth"
    return f'a load or tie on block "{blocks.names[bent[0]]}" {where}' if len(bent) else ""
