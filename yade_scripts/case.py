"""One case for YADE, from the fields of `case.h5`: blocks, contact points and the unit motion of the supports."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from la_core.exchange import FREE, SUPPORT
from yade_scripts.contacts import sphere_placement
from yade_scripts.contacts.convex_parts import box_extents, face_planes, faces_of_parts, parts_of
from yade_scripts.contacts.frame import near_blocks

_UNIT = 1e-9  # largest error in the length of a unit vector: round-off
_JOINT_NUMBERS = ("normal_stiffness", "shear_stiffness", "travel", "sag", "sway")


class CaseError(Exception):
    """The case cannot be run; the message names the field, its value and the rule."""


@dataclass(frozen=True)
class Case:
    """B blocks and C contact points, in SI units with z up; blocks that were set aside and have no contact point are left out.

    Attributes
    ----------
    name : str
        Name of the scene.
    plane : bool
        Whether motion is restricted to the plane x-z.
    displacement : str
        "small": only the listed contacts exist; "finite": YADE also looks for new ones.
    recording : str
        Stored states: "plateau" for those at rest, on the plateau and at the end, "states" for all.
    inset : float
        Inset of the contact points, m.
    own_inset : np.ndarray
        Inset (C,) that sets the radius of each sphere, m: less than `inset` in short joints and sharp corners.
    gravity : np.ndarray
        Acceleration (3,), m/s2.
    support_twist : np.ndarray
        Velocity of the origin and angular velocity (6,) per unit settlement; NaN for a live load.
    support_twists : np.ndarray
        This twist (B, 6) for each block: supports may move by different shares of the settlement; 0 for all other blocks.
    live : np.ndarray or None
        Unit direction (3,) of a load in proportion to the weights, which drives the structure instead of supports.
    overrides : dict
        Settings by name: from the scene's table [yade], and derived from the path of limit analysis.
    long_overrides : dict
        Settings that replace `overrides` if a run with `overrides` would be long.
    role : np.ndarray
        Role (B,) of each block: 0 free, 1 fixed, 2 support.
    mass : np.ndarray
        Mass (B,), kg.
    centroid : np.ndarray
        Centroid (B, 3), m.
    applied_load : np.ndarray
        Constant force and moment (B, 6) about the centroid of each block in addition to its weight, N and N m: dead loads and ties.
    load_weight : np.ndarray
        Part (B,) of the dead loads that counts as weight, N.
    live_load : np.ndarray
        Force and moment (B, 6) that dead loads add to the live load, per unit multiplier, N and N m; 0 for a settlement.
    inertia : np.ndarray
        Inertia (B, 3, 3) about the centroid in global axes, kg m2.
    vertices : tuple of np.ndarray
        Vertices (n, 3) of each block, m.
    parts : tuple of tuple of np.ndarray
        Vertices (n, 3) of the convex parts of each block, m; one part for a convex block.
    faces : tuple of tuple of np.ndarray
        Outward unit normals and offsets (f, 4), m, of the face planes of these parts.
    block_a, block_b : np.ndarray
        Blocks (C,) of each contact point; a is the lower index.
    normal : np.ndarray
        Unit contact normal (C, 3), from a to b.
    position : np.ndarray
        Contact points (C, 3), m.
    friction : np.ndarray
        Friction coefficient (C,).
    normal_stiffness, shear_stiffness : float
        Stiffness of one contact point, N/m.
    travel : float
        Largest settlement, m or rad.
    sag, sway : float
        Largest displacement of a centroid, m, under the weights, and if they act sideways (0: unknown); joints glued, normal stiffness.
    boxes : tuple
        Low and high corner (3,) of each axis-aligned box, m; None for other blocks.
    host : np.ndarray
        Block (C,) that carries the sphere of each contact point.
    index : np.ndarray
        Index (B,) of each block among all blocks of the file.
    total : int
        Number of blocks in the file.
    origin : np.ndarray
        Origin (3,) of all positions and twists here, in the frame of the file, m.
    """

    name: str
    plane: bool
    displacement: str
    recording: str
    inset: float
    own_inset: np.ndarray
    gravity: np.ndarray
    support_twist: np.ndarray
    support_twists: np.ndarray
    live: np.ndarray | None
    overrides: dict[str, Any]
    long_overrides: dict[str, Any]
    role: np.ndarray
    mass: np.ndarray
    centroid: np.ndarray
    applied_load: np.ndarray
    load_weight: np.ndarray
    live_load: np.ndarray
    inertia: np.ndarray
    vertices: tuple[np.ndarray, ...]
    parts: tuple[tuple[np.ndarray, ...], ...]
    faces: tuple[tuple[np.ndarray, ...], ...]
    block_a: np.ndarray
    block_b: np.ndarray
    normal: np.ndarray
    position: np.ndarray
    friction: np.ndarray
    normal_stiffness: float
    shear_stiffness: float
    travel: float
    sag: float
    sway: float
    boxes: tuple[tuple[np.ndarray, np.ndarray] | None, ...]
    host: np.ndarray
    index: np.ndarray
    total: int
    origin: np.ndarray

    @cached_property
    def target(self) -> np.ndarray:
        """Block (C,) whose face each contact sphere touches."""
        return self.block_a + self.block_b - self.host

    @cached_property
    def free(self) -> np.ndarray:
        """Indices of the free blocks."""
        return np.flatnonzero(self.role == FREE)

    @cached_property
    def supports(self) -> np.ndarray:
        """Indices of the blocks that settle."""
        return np.flatnonzero(self.role == SUPPORT)

    @cached_property
    def weight(self) -> float:
        """Total weight of the free blocks with their dead loads, N."""
        return self.block_weight * len(self.free)

    @cached_property
    def block_weight(self) -> float:
        """Mean weight of a free block with its dead loads, N; limits of unbalanced forces are shares of it."""
        return float(np.mean(self.mass[self.free] * np.linalg.norm(self.gravity) + self.load_weight[self.free]))

    @cached_property
    def block_size(self) -> float:
        """Median over the free blocks of their largest extent (in the xz plane for plane cases), m."""
        extents = [np.ptp(self.vertices[block], axis=0)[[0, 2] if self.plane else [0, 1, 2]].max() for block in self.free]
        return float(np.median(extents))

    @cached_property
    def is_rotation(self) -> bool:
        """Whether the settlement is an angle (rad) rather than a length (m)."""
        return self.live is None and bool(np.any(self.support_twist[3:]))

    @cached_property
    def support_speed(self) -> float:
        """Largest speed of a support's contact point per unit of settlement speed (no unit; m for rotations); 1 for live loads."""
        if self.live is not None:
            return 1.0
        moved = self.support_twists[self.block_b] - self.support_twists[self.block_a]
        velocity = moved[:, :3] + np.cross(moved[:, 3:], self.position)
        return float(np.linalg.norm(velocity, axis=1).max())

    @cached_property
    def motions(self) -> np.ndarray:
        """Distinct unit motions (K, 6) of supports that move."""
        return np.unique(self.support_twists[np.any(self.support_twists, axis=1)], axis=0)

    @cached_property
    def leader(self) -> int:
        """Support whose motion measures the settlement: the largest rotation if this is an angle, else the largest displacement."""
        twists = self.support_twists[self.supports]
        moved = twists[:, 3:] if self.is_rotation else twists[:, :3] + np.cross(twists[:, 3:], self.centroid[self.supports])
        return int(self.supports[np.linalg.norm(moved, axis=1).argmax()])


def from_fields(data: Mapping[str, Any]) -> Case:
    """Return the case from the fields of `case.h5` by path; raises CaseError if the case cannot be run."""
    data, origin = near_blocks(data)
    start, interface = data["blocks/vertex_start"], data["contacts/interface"]
    block_a, block_b = data["interfaces/block_a"][interface], data["interfaces/block_b"][interface]
    total = len(data["blocks/role"])
    index = np.flatnonzero((data["blocks/aside"] == 0) | np.isin(np.arange(total), [block_a, block_b]))
    place = np.zeros(total, dtype=int)
    place[index] = np.arange(len(index))
    alike = np.where((data["blocks/role"] == SUPPORT)[:, None], data["scene/support_twist"], 0.0)
    vertices = tuple(data["blocks/vertices"][start[block] : start[block + 1]] for block in index)
    boxes = tuple(box_extents(points) for points in vertices)
    faces = (data["blocks/face_block"], *face_planes(data["blocks/vertices"], data["blocks/face_vertex"], data["blocks/face_start"]))
    host, own_inset = sphere_placement.spheres(data, index[[box is not None for box in boxes]], faces)
    mass, inertia = data["blocks/mass"][index], data["blocks/inertia"][index]
    bare = (data["blocks/role"][index] != FREE) & ~np.isfinite(mass)  # held blocks without density get 1 kg, which has no effect
    case = Case(
        name=data["scene/name"],
        plane=bool(data["scene/plane"]),
        displacement=data["scene/displacement"],
        recording=data["scene/recording"],
        inset=float(data["scene/inset"]),
        own_inset=own_inset,
        gravity=data["scene/gravity"],
        support_twist=data["scene/support_twist"],
        support_twists=data.get("blocks/support_twist", alike)[index],
        live=data.get("scene/live"),
        overrides=_overrides("scene/settings", data),
        long_overrides=_overrides("scene/settings_of_long_run" if "scene/settings_of_long_run" in data else "scene/settings", data),
        role=data["blocks/role"][index],
        mass=np.where(bare, 1.0, mass),
        centroid=data["blocks/centroid"][index],
        applied_load=data.get("blocks/applied_load", np.zeros((total, 6)))[index],
        load_weight=data.get("blocks/load_weight", np.zeros(total))[index],
        live_load=data.get("blocks/live_load", np.zeros((total, 6)))[index],
        inertia=np.where(bare[:, None, None], np.eye(3), inertia),
        vertices=vertices,
        parts=parts_of(data, index, vertices),
        faces=faces_of_parts(data, index, faces),
        block_a=place[block_a],
        block_b=place[block_b],
        normal=data["interfaces/normal"][interface],
        position=data["contacts/position"],
        friction=data["contacts/friction"],
        **{name: float(data.get(f"joints/{name}", 0.0)) for name in _JOINT_NUMBERS},
        boxes=boxes,
        host=place[host],
        index=index,
        total=total,
        origin=origin,
    )
    _refuse_unrunnable(case)
    return case


def _overrides(field: str, data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings in a field of the case file."""
    text = data[field]
    try:
        values = json.loads(text or "{}")
    except json.JSONDecodeError as error:
        raise CaseError(f"{field}: not JSON ({error}): {text!r}") from error
    if not isinstance(values, dict):
        raise CaseError(f"{field}: {text!r} is not a JSON object of settings by name")
    return values


def _refuse_undriven(case: Case) -> None:
    if case.live is not None:
        if not abs(float(np.linalg.norm(case.live)) - 1.0) <= _UNIT:
            raise CaseError(f"scene/live is {case.live}: the direction of the load must be a unit vector")
        if case.overrides.get("wedging"):
            raise CaseError("scene/settings: wedging lifts the support, but under a live load no support moves; leave it out")
        return
    if not np.isin(case.role[np.union1d(case.block_a, case.block_b)], SUPPORT).any():
        raise CaseError("blocks/role: no support block carries a contact point, nothing to settle")
    if not np.all(np.isfinite(case.support_twist)) or not np.any(case.support_twist):
        raise CaseError(f"scene/support_twist is {case.support_twist}: no settlement to impose")
    if not np.all(np.isfinite(case.support_twists)) or np.any(case.support_twists[case.role != SUPPORT]) or not case.support_speed > 0.0:
        raise CaseError("blocks/support_twist: every entry must be finite, 0 for a block that is no support, and some support must move")


def _refuse_unrunnable(case: Case) -> None:
    if not case.inset > 0.0:
        raise CaseError(f"scene/inset is {case.inset}: contact spheres need an inset greater than 0")
    if not np.all((case.own_inset > 0.0) & (case.own_inset <= case.inset)):
        raise CaseError(f"contacts/inset: every entry must be greater than 0 and at most the inset of the scene, {case.inset} m")
    if len(case.free) == 0:
        raise CaseError("blocks/role: no free block, nothing to simulate")
    if not np.all(np.isfinite(case.position)) or not np.all(case.friction >= 0.0):
        raise CaseError("contacts: every position must be finite and every friction coefficient at least 0")
    _refuse_undriven(case)
    if case.displacement not in ("small", "finite") or case.recording not in ("plateau", "states"):
        given = f"displacement is {case.displacement!r} and recording {case.recording!r}"
        raise CaseError(f"scene: {given}; they must be 'small' or 'finite', and 'plateau' or 'states'")
    if not np.all(np.isfinite(case.mass[case.free]) & (case.mass[case.free] > 0.0)):
        raise CaseError("blocks/mass: every free block needs a finite mass greater than 0")
    for name in ("applied_load", "live_load"):
        load = getattr(case, name)
        if not np.all(np.isfinite(load)) or np.any(load[case.role != FREE]):
            raise CaseError(f"blocks/{name}: every entry must be finite, and 0 for a block that is not free")
    for name in _JOINT_NUMBERS:
        value, may_vanish = getattr(case, name), name in ("shear_stiffness", "sway")
        if not np.isfinite(value) or value < 0.0 or (value == 0.0 and not may_vanish):
            raise CaseError(f"joints/{name} is {value}; it must be a finite number {'at least' if may_vanish else 'greater than'} 0")
