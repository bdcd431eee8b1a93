"""Contact points at the corners of interfaces, drawn in from their edges by the inset."""

from dataclasses import dataclass

import numpy as np
import shapely

from la_core.errors import SceneError
from la_core.geometry.blocks import Blocks
from la_core.geometry.interfaces import Interfaces
from la_core.geometry.polygons import plane_axes, polygons_of, true_corners

RADIUS_HALVINGS = 20  # of the interval in which an inner radius is searched: a millionth of the inset is left


@dataclass(frozen=True)
class ContactPoints:
    """The C contact points of a structure as flat arrays.

    Attributes
    ----------
    interface : (C,) array of int
        Interface of each point.
    position : (C, 3) array
        Position, m.
    friction : (C,) array
        Friction coefficient, tan(phi).
    """

    interface: np.ndarray
    position: np.ndarray
    friction: np.ndarray

    def __len__(self) -> int:
        return len(self.interface)

    def subset(self, kept: np.ndarray) -> "ContactPoints":
        """The points in a mask (C,)."""
        return ContactPoints(self.interface[kept], self.position[kept], self.friction[kept])


def contact_points(blocks: Blocks, interfaces: Interfaces, friction: float, inset: float, plane: bool) -> ContactPoints:
    """Lay contact points at the corners of each interface.

    Parameters
    ----------
    blocks : Blocks
        Blocks, for the names in messages.
    interfaces : Interfaces
        Interfaces of the blocks.
    friction : float
        Friction coefficient of every point, tan(phi).
    inset : float
        Distance of the points from the edges of their interface, m; 0 puts them on its corners.
    plane : bool
        True for two points at mid depth per interface, at its ends in the xz plane; False for one point at every
        corner.

    Raises
    ------
    SceneError
        An interface is too small for the inset.
    """
    position, interface = (_plane_points if plane else _solid_points)(blocks, interfaces, inset)
    return ContactPoints(interface, position, np.full(len(interface), friction))


def _plane_points(blocks: Blocks, interfaces: Interfaces, inset: float) -> tuple[np.ndarray, np.ndarray]:
    tangent, _ = plane_axes(interfaces.normal)
    owner = np.repeat(np.arange(len(interfaces)), np.diff(interfaces.polygon_start))
    start = interfaces.polygon_start[:-1]
    middle = np.add.reduceat(interfaces.polygon, start) / np.diff(interfaces.polygon_start)[:, None]
    along = np.sum((interfaces.polygon - middle[owner]) * tangent[owner], axis=1)
    low, high = np.minimum.reduceat(along, start) + inset, np.maximum.reduceat(along, start) - inset
    _refuse_small(blocks, interfaces, (high - low) / 2.0 + inset, inset)
    place = np.stack([low, high], axis=1)
    position = middle[:, None, :] + place[:, :, None] * tangent[:, None, :]
    return position.reshape(-1, 3), np.repeat(np.arange(len(interfaces)), 2)


def _solid_points(blocks: Blocks, interfaces: Interfaces, inset: float) -> tuple[np.ndarray, np.ndarray]:
    owner = np.repeat(np.arange(len(interfaces)), np.diff(interfaces.polygon_start))
    if inset == 0.0:
        return interfaces.polygon, owner
    first, second = plane_axes(interfaces.normal)
    origin = interfaces.polygon[interfaces.polygon_start[:-1]]
    arm = interfaces.polygon - origin[owner]
    flat = np.stack([np.sum(arm * first[owner], axis=1), np.sum(arm * second[owner], axis=1)], axis=1)
    polygons = polygons_of(flat, np.diff(interfaces.polygon_start))
    shrunk = shapely.buffer(polygons, -inset, join_style="mitre")
    small = shapely.is_empty(shrunk)
    if small.any():
        _refuse_small(blocks, interfaces, np.where(small, _inner_radii(polygons, inset), np.inf), inset)
    flat, owner = true_corners(shrunk, np.full(len(shrunk), 1e-3 * inset))
    return origin[owner] + flat[:, :1] * first[owner] + flat[:, 1:] * second[owner], owner


def _inner_radii(polygons: np.ndarray, largest: float) -> np.ndarray:
    """Radius (N,) of the largest circle within each convex polygon (N,), m, at most `largest`; by bisection."""
    low, high = np.zeros(len(polygons)), np.full(len(polygons), largest)
    for _ in range(RADIUS_HALVINGS):
        middle = (low + high) / 2.0
        gone = shapely.is_empty(shapely.buffer(polygons, -middle, join_style="mitre"))
        low, high = np.where(gone, low, middle), np.where(gone, middle, high)
    return low


def _refuse_small(blocks: Blocks, interfaces: Interfaces, room: np.ndarray, inset: float) -> None:
    """Raise SceneError where an interface leaves its points less room (I,), m, than the inset, with the largest inset that fits all."""
    k = int(np.argmin(room))
    if room[k] <= inset:
        a, b = blocks.names[interfaces.block_a[k]], blocks.names[interfaces.block_b[k]]
        rule = f'larger than half the interface between "{a}" and "{b}"'
        raise SceneError("joint.inset", rule, value=inset, hint=f"take less than {room[k]:.3g} m, the largest that fits every joint")
