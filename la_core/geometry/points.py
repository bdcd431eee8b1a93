"""Contact points at the corners of interfaces, drawn in from their edges by the inset.

All joints have the inset of the scene, except short joints. Where a joint is shorter than four insets, its points lie at a
quarter of its length, so that one short joint does not reduce the inset of all others. A joint shorter than half an inset
is no joint, because the inset represents worn edges, and such wear would have removed the joint.
"""

from dataclasses import dataclass, replace

import numpy as np
import shapely

from la_core.errors import SceneError
from la_core.geometry.blocks import Blocks, Held
from la_core.geometry.interfaces import Interfaces
from la_core.geometry.polygons import owners, plane_axes, polygons_of, true_corners

SHORT = 0.5  # largest inset over the room of a joint, half its length: the points of a short joint lie at its quarters
SLIVER = 0.25  # least room of a joint over the inset
RADIUS_HALVINGS = 20  # halvings of the interval in which an inner radius is searched: a millionth of the interval is left


@dataclass(frozen=True, eq=False, repr=False)
class ContactPoints(Held):
    """The C contact points of a structure as flat arrays.

    Attributes
    ----------
    interface : (C,) array of int
        Interface of each point.
    position : (C, 3) array
        Position, m.
    friction : (C,) array
        Friction coefficient, tan(phi).
    inset : (C,) array
        Distance from the edges of the interface, m.
    """

    interface: np.ndarray
    position: np.ndarray
    friction: np.ndarray
    inset: np.ndarray

    def __len__(self) -> int:
        return len(self.interface)

    def subset(self, kept: np.ndarray) -> "ContactPoints":
        """The points in a mask (C,)."""
        return ContactPoints(self.interface[kept], self.position[kept], self.friction[kept], self.inset[kept])


def contact_points(blocks: Blocks, interfaces: Interfaces, friction: float | np.ndarray, inset: float, plane: bool) -> ContactPoints:
    """Place contact points at the corners of each interface.

    Parameters
    ----------
    blocks : Blocks
        Blocks, for the names in messages.
    interfaces : Interfaces
        Interfaces of the blocks.
    friction : float or (I,) array
        Friction coefficient of all interfaces, or of each, tan(phi).
    inset : float
        Distance of the points from the edges of their interface, m; less in a short joint. 0 places them on the corners.
    plane : bool
        True for two points at mid depth per interface, at its ends in the xz plane; False for one point at every
        corner.

    Raises
    ------
    SceneError
        The inset is too large for at least half of the interfaces.
    """
    if inset > 0.0:
        room = joint_rooms(interfaces, plane, inset / SHORT)
        _refuse_large(blocks, interfaces, np.minimum(room, _depths(interfaces) / 2.0) if plane else room, inset)
        own = np.minimum(inset, SHORT * room)
    else:
        own = np.zeros(len(interfaces))
    position, interface = (_plane_points if plane else _solid_points)(interfaces, own)
    of_interface = np.broadcast_to(np.asarray(friction, dtype=float), len(interfaces))
    return ContactPoints(interface, position, of_interface[interface], own[interface])


def without_slivers(blocks: Blocks, interfaces: Interfaces, least: float, plane: bool) -> Interfaces:
    """Drop the interfaces with less room than `least`, m. Raises SceneError where a free block has no other interface."""
    slivers = joint_rooms(interfaces, plane, least) < least if least > 0.0 else np.zeros(len(interfaces), dtype=bool)
    if not slivers.any():
        return interfaces
    kept = replace(interfaces.subset(~slivers), dropped=interfaces.dropped + int(slivers.sum()))
    alone = np.setdiff1d(np.stack([interfaces.block_a, interfaces.block_b]), np.stack([kept.block_a, kept.block_b]))
    alone = alone[blocks.free[alone]]
    if len(alone):
        rule = f"has no joint of {2.0 * least:.3g} m or more, and shorter ones do not count"
        name = blocks.names[alone[0]]
        raise SceneError(f'block "{name}"', rule, hint="take a smaller inset and tolerance, or remove the block", blocks=[name])
    return kept


def joint_rooms(interfaces: Interfaces, plane: bool, largest: float) -> np.ndarray:
    """Room (I,) of each interface, m: half its length in the plane, the radius of its largest inscribed circle in space.

    In space, a room of more than `largest` (m) counts as `largest`.
    """
    if plane:
        low, high = _ends(interfaces)[:2]
        return (high - low) / 2.0
    flat, _, _ = _flattened(interfaces)
    polygons = polygons_of(flat, np.diff(interfaces.polygon_start))
    room = np.full(len(interfaces), largest)
    small = np.flatnonzero(shapely.area(polygons) < largest * shapely.length(polygons))  # the radius is at least area over length
    low, high = np.zeros(len(small)), room[small]
    high = np.where(shapely.is_empty(shapely.buffer(polygons[small], -largest, join_style="mitre")), high, 0.0)
    searched = high > 0.0
    for _ in range(RADIUS_HALVINGS if searched.any() else 0):
        middle = (low + high) / 2.0
        gone = shapely.is_empty(shapely.buffer(polygons[small], -middle, join_style="mitre"))
        low, high = np.where(gone, low, middle), np.where(gone, middle, high)
    room[small] = np.where(searched, low, largest)
    return room


def _ends(interfaces: Interfaces) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Both ends (I,) of each interface along its first tangent, from its middle, m; the middle (I, 3), m; and the tangent (I, 3)."""
    tangent, _ = plane_axes(interfaces.normal)
    owner = owners(interfaces.polygon_start)
    start = interfaces.polygon_start[:-1]
    middle = np.add.reduceat(interfaces.polygon, start) / np.diff(interfaces.polygon_start)[:, None]
    along = np.sum((interfaces.polygon - middle[owner]) * tangent[owner], axis=1)
    return np.minimum.reduceat(along, start), np.maximum.reduceat(along, start), middle, tangent


def _depths(interfaces: Interfaces) -> np.ndarray:
    """Depth (I,) of each interface of a plane structure along y, m. YADE and the check in space place points along the depth, too."""
    start, across = interfaces.polygon_start[:-1], interfaces.polygon[:, 1]
    return np.maximum.reduceat(across, start) - np.minimum.reduceat(across, start)


def _plane_points(interfaces: Interfaces, inset: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two points of each interface at mid depth, (2 I, 3), m, and the interface of each; inset: (I,), m."""
    low, high, middle, tangent = _ends(interfaces)
    place = np.stack([low + inset, high - inset], axis=1)
    position = middle[:, None, :] + place[:, :, None] * tangent[:, None, :]
    return position.reshape(-1, 3), np.repeat(np.arange(len(interfaces)), 2)


def _flattened(interfaces: Interfaces) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Corners (Q, 2) of each interface in its plane, and its two tangents (I, 3); the first corner is the origin."""
    owner = owners(interfaces.polygon_start)
    first, second = plane_axes(interfaces.normal)
    arm = interfaces.polygon - interfaces.polygon[interfaces.polygon_start[:-1]][owner]
    return np.stack([np.sum(arm * first[owner], axis=1), np.sum(arm * second[owner], axis=1)], axis=1), first, second


def _solid_points(interfaces: Interfaces, inset: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A point at every corner of each interface, (C, 3), m, and the interface of each; inset: (I,), m."""
    if not inset.any():
        return interfaces.polygon, owners(interfaces.polygon_start)
    flat, first, second = _flattened(interfaces)
    shrunk = shapely.buffer(polygons_of(flat, np.diff(interfaces.polygon_start)), -inset, join_style="mitre")
    flat, owner = true_corners(shrunk, 1e-3 * inset)
    origin = interfaces.polygon[interfaces.polygon_start[:-1]]
    return origin[owner] + flat[:, :1] * first[owner] + flat[:, 1:] * second[owner], owner


def _refuse_large(blocks: Blocks, interfaces: Interfaces, room: np.ndarray, inset: float) -> None:
    """Raise SceneError where the inset is at least the lower median of all rooms (I,), m: half of the joints or more would be too short."""
    middle = int(np.argsort(room, kind="stable")[(len(room) - 1) // 2]) if len(room) else 0
    if len(room) and room[middle] <= inset:
        a, b = blocks.names[interfaces.block_a[middle]], blocks.names[interfaces.block_b[middle]]
        rule = f'larger than half the interface between "{a}" and "{b}", and half of all joints are no longer than that one'
        raise SceneError("joint.inset", rule, value=inset, hint=f"take less than {room[middle]:.3g} m")
