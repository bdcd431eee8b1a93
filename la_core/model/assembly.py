"""The mechanical model: weights, support motion and the matrix from block twists to relative velocities at contact points."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy import sparse

from la_core.errors import SceneError
from la_core.geometry import (
    SLIVER,
    Blocks,
    ContactPoints,
    Held,
    Interfaces,
    contact_points,
    find_interfaces,
    nearest_gap,
    plane_axes,
    without_slivers,
)
from la_core.model.effects import Effects, applied_wrenches, decide
from la_core.scene import Scene, friction_of_joints, refuse_idle_classes

PLANE_FREEDOMS = (0, 2, 4)  # vx, vz, wy of a block that moves in the xz plane


def per_length(wrenches: np.ndarray, length: float) -> np.ndarray:
    """Wrenches (N, 6) with moments divided by `length` (m), so that all six components are forces.

    It also turns twists (N, 6) whose rotations are measured as length times radians into twists with radians.
    """
    return wrenches / np.array([1.0, 1.0, 1.0, length, length, length])


@dataclass(frozen=True, eq=False, repr=False)
class Assembly(Held):
    """Mechanical model of a scene: blocks, interfaces, contact points, dead load, and the driving motion or load.

    Attributes
    ----------
    blocks : Blocks
        B blocks.
    interfaces : Interfaces
        I interfaces between them.
    points : ContactPoints
        C contact points on the interfaces.
    effects : Effects
        Modelled effects, with reasons.
    inset : float
        Distance of the contact points from the edges of their interface, m; `points.inset` is less in short joints.
    dead_load : (B, 6) array
        Weight, dead loads and ties of each free block as a wrench about its centroid, N and N m.
    applied_load : (B, 6) array
        The part of `dead_load` that is not the weight of the block itself.
    carried : (B,) array
        Component along gravity of the dead loads on each block, N; 0 for a load that lifts. It counts as weight.
    down : (3,) array
        Unit vector of gravity.
    live_load : (B, 6) array
        Live load per unit multiplier as wrenches about the centroids, N and N m; zero for a settlement.
    support_twist : (B, 6) array
        Unit motion of each support block about its centroid; zero for all other blocks.
    aside : (B,) array of bool
        Free blocks of the scene that are held at rest in this model, because the motion does not reach them
        (`la_core.analysis.reach`).
    slivers : int
        Number of joints that were dropped because they are too short to count.
    is_rotation : bool
        Whether the unit motion of the supports is an angle, rad, and the reaction a moment.
    """

    blocks: Blocks
    interfaces: Interfaces
    points: ContactPoints
    effects: Effects
    inset: float
    dead_load: np.ndarray
    applied_load: np.ndarray
    carried: np.ndarray
    down: np.ndarray
    live_load: np.ndarray
    support_twist: np.ndarray
    aside: np.ndarray
    slivers: int
    is_rotation: bool

    @property
    def short_joints(self) -> int:
        """Number of joints whose contact points have a smaller inset than others, because they are short."""
        return len(np.unique(self.points.interface[self.points.inset < self.inset]))

    @cached_property
    def block_weight(self) -> np.ndarray:
        """Weight (B,) of each free block with the dead loads on it, N; 0 for a held block."""
        own = np.linalg.norm((self.dead_load - self.applied_load)[:, :3], axis=1)
        return np.where(self.blocks.free, own + self.carried, 0.0)

    @cached_property
    def weight(self) -> float:
        """Weight of the free blocks and of the dead loads on them, N: the unit of forces in programmes and tolerances."""
        return float(self.block_weight[self.blocks.free].sum())

    @property
    def mean_weight(self) -> float:
        """Mean weight of a free block, N; residuals are relative to it."""
        return self.weight / int(self.blocks.free.sum())

    @property
    def length(self) -> float:
        """Mean size of a free block, m; moments are scaled by it."""
        return float(np.linalg.norm(self.blocks.high - self.blocks.low, axis=1)[self.blocks.free].mean() / np.sqrt(3.0))

    @property
    def movable_mass(self) -> float:
        """Mass of all free blocks of the scene, also those set aside, kg; shares of the mass are relative to it."""
        return float(self.blocks.mass[self.blocks.free | self.aside].sum())

    @cached_property
    def has_live_load(self) -> bool:
        """Whether a live load drives the assembly instead of a support."""
        return bool(np.any(self.live_load))

    @property
    def normal(self) -> np.ndarray:
        """Unit normal (C, 3) at each contact point, from block a to block b."""
        return self.interfaces.normal[self.points.interface]

    @property
    def axes(self) -> np.ndarray:
        """Local axes (C, 3, 3) at each contact point: rows normal, first tangent, second tangent."""
        first, second = plane_axes(self.interfaces.normal)
        return np.stack([self.interfaces.normal, first, second], axis=1)[self.points.interface]

    @property
    def contact_blocks(self) -> tuple[np.ndarray, np.ndarray]:
        """Blocks a and b (C,) of each contact point."""
        return self.interfaces.block_a[self.points.interface], self.interfaces.block_b[self.points.interface]

    @cached_property
    def support_speed(self) -> float:
        """Largest speed of a support's contact point per unit motion: its share of a translation; m for a rotation; 1 for a live load."""
        if self.has_live_load:
            return 1.0
        return float(np.linalg.norm(self.relative_velocity(self.support_twist), axis=1).max())

    def in_value_unit(self, weight: float) -> float:
        """A weight, N, in the unit of the value: N for a reaction; N m, by the arm of a support that turns; 1 for a multiplier."""
        return 1.0 if self.has_live_load else weight * self.support_speed

    def split(self, vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Normal components (..., C) and tangential parts (..., C, 3) of vectors (..., C, 3) at the contact points."""
        normal = np.sum(vectors * self.normal, axis=-1)
        return normal, vectors - normal[..., None] * self.normal

    def relative_velocity(self, twists: np.ndarray) -> np.ndarray:
        """Velocity (C, 3) of block b relative to block a at each contact point, global axes, for twists (B, 6)."""
        velocity = np.zeros_like(self.points.position)
        for block, sign in zip(self.contact_blocks, (-1.0, 1.0), strict=True):
            arm = self.points.position - self.blocks.centroid[block]
            velocity += sign * (twists[block, :3] + np.cross(twists[block, 3:], arm))
        return velocity

    def contact_wrenches(self, forces: np.ndarray) -> np.ndarray:
        """Wrench (B, 6) of contact forces (C, 3; on block b, global axes) on each block, moments about its centroid."""
        wrenches = np.zeros((len(self.blocks), 6))
        for block, sign in zip(self.contact_blocks, (-1.0, 1.0), strict=True):
            arm = self.points.position - self.blocks.centroid[block]
            np.add.at(wrenches, block, sign * np.concatenate([forces, np.cross(arm, forces)], axis=1))
        return wrenches

    def kinematic_matrix(self, length: float) -> sparse.csr_matrix:
        """Matrix from twists of all blocks to local relative velocities; rotations are measured as `length` times radians.

        Rows: normal and tangents of each contact point (2 in a plane model, 3 in space). Columns: vx, vz, wy of each
        block in a plane model, all six components in space. length: m.
        """
        plane = self.effects.plane
        freedoms = np.array(PLANE_FREEDOMS if plane else range(6))
        axes = self.axes[:, : 2 if plane else 3]
        count, rows = axes.shape[:2]
        row = np.arange(count * rows).reshape(count, rows, 1)
        values, columns = [], []
        for block, sign in zip(self.contact_blocks, (-1.0, 1.0), strict=True):
            arm = np.broadcast_to((self.points.position - self.blocks.centroid[block])[:, None, :], axes.shape)
            values.append(sign * np.concatenate([axes, np.cross(arm, axes) / length], axis=2)[..., freedoms])
            columns.append(np.broadcast_to(block[:, None, None] * len(freedoms) + np.arange(len(freedoms)), values[-1].shape))
        place = np.broadcast_to(row, values[0].shape)
        entries = (np.concatenate(values, axis=None), (np.concatenate([place, place], axis=None), np.concatenate(columns, axis=None)))
        return sparse.csr_matrix(entries, shape=(count * rows, len(self.blocks) * len(freedoms)))

    def with_inset(self, scene: Scene, inset: float) -> "Assembly":
        """The same assembly with its contact points drawn in by another `inset` (m)."""
        points = contact_points(self.blocks, self.interfaces, _friction(scene, self.interfaces), inset, self.effects.plane)
        return replace(self, points=points, inset=inset)


def assemble(scene: Scene, interfaces: Interfaces | None = None) -> Assembly:
    """Build the mechanical model of a scene, contact points at the scene's inset.

    Parameters
    ----------
    scene : Scene
        Scene to model.
    interfaces : Interfaces, optional
        Interfaces of the scene's blocks, if they are known; their search is most of the work.

    Raises
    ------
    SceneError
        Blocks overlap or touch nothing, or the scene requests an effect that it does not allow. The message begins
        with the scene's path and the lines of the blocks or keys that it names.
    """
    try:
        return _assemble(scene, interfaces)
    except SceneError as error:
        raise scene.located(error) from error


def _assemble(scene: Scene, interfaces: Interfaces | None) -> Assembly:
    blocks = scene.blocks
    effects = decide(scene)
    found = find_interfaces(blocks) if interfaces is None else interfaces
    least = max(SLIVER * scene.inset, scene.shortest_joint / 2.0)
    interfaces = without_slivers(blocks, found, least, effects.plane)
    points = contact_points(blocks, interfaces, _friction(scene, interfaces), scene.inset, effects.plane)
    refuse_idle_classes(scene.joint_classes, blocks, interfaces)
    if scene.support_twists is not None:
        support = np.any(scene.support_twists, axis=1)
        if not _has_joint(support, interfaces):
            raise _idle_support(blocks, support, 2.0 * least if _has_joint(support, found) else 0.0)
    return _loaded(scene, effects, interfaces, points, slivers=interfaces.dropped)


def _friction(scene: Scene, interfaces: Interfaces) -> np.ndarray:
    """Friction coefficient (I,) of interfaces of a scene. Blocks have the roles of the scene, even if a model holds more blocks at rest."""
    return friction_of_joints(scene.joint_classes, scene.friction, scene.blocks, interfaces)


def unjoined(scene: Scene) -> Assembly:
    """The model without any joint, for a figure of blocks that overlap or touch nothing."""
    none, nowhere = np.zeros(0, dtype=int), np.zeros((0, 3))
    interfaces = Interfaces(none, none, nowhere, np.zeros(0), nowhere, np.zeros(1, dtype=int))
    return _loaded(scene, decide(scene), interfaces, ContactPoints(none, nowhere, np.zeros(0), np.zeros(0)), slivers=0)


def _loaded(scene: Scene, effects: Effects, interfaces: Interfaces, points: ContactPoints, slivers: int) -> Assembly:
    blocks = scene.blocks
    weight, live_load, support_twist = (np.zeros((len(blocks), 6)) for _ in range(3))
    weight[blocks.free, :3] = blocks.mass[blocks.free, None] * scene.gravity
    applied_load = applied_wrenches(scene)
    size = float(np.linalg.norm(scene.gravity))
    if scene.live is not None:
        live_load[:, :3] = np.linalg.norm(weight[:, :3], axis=1)[:, None] * scene.live
        live_load += scene.loads.wrenches(blocks.centroid, per_mass=size * scene.live)
    if scene.support_twists is not None:
        velocity, spin = scene.support_twists[:, :3], scene.support_twists[:, 3:]
        support_twist[:] = np.concatenate([velocity + np.cross(spin, blocks.centroid), spin], axis=1)
    aside = np.zeros(len(blocks), dtype=bool)
    return Assembly(
        blocks, interfaces, points, effects, scene.inset, weight + applied_load, applied_load,
        scene.loads.weight(len(blocks), scene.gravity / size), scene.gravity / size, live_load, support_twist, aside, slivers,
        scene.is_rotation,
    )  # fmt: skip


def _has_joint(chosen: np.ndarray, interfaces: Interfaces) -> bool:
    """Whether one of the chosen blocks (B,) has an interface."""
    return bool((chosen[interfaces.block_a] | chosen[interfaces.block_b]).any())


def _idle_support(blocks: Blocks, support: np.ndarray, shortest: float) -> SceneError:
    """Error for support blocks, mask (B,), without a joint. shortest: least length of a joint, m, if they have shorter ones, else 0."""
    if shortest > 0.0:
        rule = f"the support blocks that move have no joint of {shortest:.3g} m or more, and shorter ones do not count"
        hint = "take a smaller inset and tolerance, or a longer joint"
    else:
        rule = "no support block that moves touches a free block, so its motion changes nothing"
        hint = nearest_gap(blocks, np.flatnonzero(support), np.flatnonzero(blocks.free))
    names, spots = [blocks.names[i] for i in np.flatnonzero(support)], [tuple(centroid) for centroid in blocks.centroid[support].tolist()]
    return SceneError("settlement", rule, hint=hint, blocks=names, spots=spots)
