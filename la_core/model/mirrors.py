"""Vertical planes in which a structure is its own mirror image, block by block and contact point by contact point.

Only free blocks and contact points are compared: a held block may have any shape where nothing touches it.
"""

from dataclasses import dataclass

import numpy as np

from la_core.geometry import plane_axes
from la_core.model.assembly import Assembly, per_length

ASKEW = np.sqrt([2.0, 3.0, 5.0, 7.0, 11.0, 13.0])  # a direction along which no two points of a regular grid have the same coordinate
SAME_LOAD = 1e-8  # relative difference below which loads and velocities are the same
SAME_PLACE = 1e-9  # of the mean size of a block: distance below which two points are the same


@dataclass(frozen=True)
class Image:
    """A mapping of a structure onto itself, by no mirror, one mirror, or two.

    Attributes
    ----------
    signs : (3,) array
        Factor of each component of a vector along the axes of the mirrors: -1 across a mirror, else 1.
    matrix : (3, 3) array
        Matrix of the mapping for vectors in global axes.
    block : (F,) array of int
        Free block onto which each free block is mapped, counted among the free blocks.
    point : (C,) array of int
        Contact point onto which each contact point is mapped.
    swap : (C,) array
        -1 where the mapping exchanges blocks a and b of the contact point, else 1.
    """

    signs: np.ndarray
    matrix: np.ndarray
    block: np.ndarray
    point: np.ndarray
    swap: np.ndarray


def images(assembly: Assembly) -> tuple[np.ndarray, list[Image]]:
    """Find the mirrors of a structure.

    Loads, the motion of supports, and the blocks of each contact point are not compared here. The caller compares them.

    Parameters
    ----------
    assembly : Assembly
        The structure.

    Returns
    -------
    axes : ndarray, shape (3, 3)
        Orthonormal rows: two horizontal directions, to which mirrors are normal, and the direction of gravity.
    images : list of Image
        The 1, 2 or 4 images of the structure; the first one is by no mirror. Each image is its own inverse.
    """
    best = _axes_by_gravity(assembly), [_itself(assembly)]
    most = 2 if assembly.effects.plane else 4
    for axes in _candidates(assembly):
        if len(best[1]) == most:
            break
        found = [_itself(assembly)]
        for across in (0,) if assembly.effects.plane else (0, 1):
            mirror = _mirror(assembly, axes, across)
            found += [_after(first, mirror) for first in found] if mirror is not None else []
        if len(found) > len(best[1]):
            best = axes, found
    return best


def mirrored_across(assembly: Assembly) -> np.ndarray | None:
    """Horizontal direction (3,) normal to the only mirror that a structure shares with its loads and the motion of its supports.

    Such a structure stays its own mirror image, so that it never sways along this direction. None without such a mirror, or with two.
    """
    axes, found = images(assembly)
    shared = [image for image in found if np.prod(image.signs) < 0.0 and _is_shared(assembly, image)]
    return axes[int(np.argmin(shared[0].signs))] if len(shared) == 1 else None


def _is_shared(assembly: Assembly, image: Image) -> bool:
    """Whether an image maps the loads and the motion of the supports onto themselves."""
    free = assembly.blocks.free
    velocity = assembly.relative_velocity(assembly.support_twist)
    pairs = [(image.swap[:, None] * velocity[image.point], velocity @ image.matrix)]
    turn = np.prod(image.signs)  # a mirror reverses the sense of a moment
    for load in (per_length(one[free], assembly.length) for one in (assembly.dead_load, assembly.live_load)):
        pairs.append((load[image.block], np.hstack([load[:, :3] @ image.matrix, turn * load[:, 3:] @ image.matrix])))
    return all(np.abs(one - other).max() <= SAME_LOAD * np.abs(other).max() for one, other in pairs)


def _candidates(assembly: Assembly) -> list[np.ndarray]:
    """Axes that mirrors may be normal to: the axes of the model, and the principal axes of the blocks' centroids."""
    axes = _axes_by_gravity(assembly)
    if assembly.effects.plane:
        return [axes]
    centroid = assembly.blocks.centroid[assembly.blocks.free]
    level = (centroid - centroid.mean(axis=0)) @ axes[:2].T
    principal = np.linalg.eigh(level.T @ level)[1].T @ axes[:2]
    return [axes, np.vstack([principal, assembly.down])]


def _axes_by_gravity(assembly: Assembly) -> np.ndarray:
    """The axes of the model, turned so that the last one is the direction of gravity; the second is y in a plane model."""
    first, second = plane_axes(assembly.down[None])
    return np.vstack([first, second, assembly.down])


def _itself(assembly: Assembly) -> Image:
    blocks, points = int(assembly.blocks.free.sum()), len(assembly.points)
    return Image(np.ones(3), np.eye(3), np.arange(blocks), np.arange(points), np.ones(points))


def _after(first: Image, mirror: Image) -> Image:
    """The image by `first` and then by another mirror across another axis."""
    return Image(
        first.signs * mirror.signs,
        first.matrix @ mirror.matrix,
        mirror.block[first.block],
        mirror.point[first.point],
        first.swap * mirror.swap[first.point],
    )


def _mirror(assembly: Assembly, axes: np.ndarray, across: int) -> Image | None:
    """The image by a mirror normal to axis `across` of `axes` (3, 3), or None where the structure is not symmetric."""
    free, normal, same = assembly.blocks.free, axes[across], SAME_PLACE * assembly.length
    centroid, interface, position = assembly.blocks.centroid[free], assembly.points.interface, assembly.points.position
    middle = (centroid @ normal).mean()
    for places in (centroid, position):
        place = np.sort(places @ normal)
        if np.abs(place + place[::-1] - 2.0 * middle).max() > same:  # excludes most structures without a mirror before any search
            return None

    def mirrored(position: np.ndarray) -> np.ndarray:
        return position - 2.0 * ((position @ normal) - middle)[:, None] * normal

    block = _matched(centroid, mirrored(centroid), same)
    if block is None:
        return None
    counts = np.bincount(interface)[interface]
    middles = np.stack([np.bincount(interface, component)[interface] / counts for component in position.T], axis=1)
    point = _matched(np.hstack([position, middles]), np.hstack([mirrored(position), mirrored(middles)]), same)
    if point is None:
        return None
    signs = np.where(np.arange(3) == across, -1.0, 1.0)
    matrix = np.eye(3) - 2.0 * np.outer(normal, normal)
    facing = np.einsum("cj,cj->c", assembly.normal[point], assembly.normal @ matrix)
    friction = assembly.points.friction
    is_same = np.abs(np.abs(facing) - 1.0).max() <= SAME_PLACE and np.array_equal(friction[point], friction)
    return Image(signs, matrix, block, point, np.sign(facing)) if is_same else None


def _matched(places: np.ndarray, images: np.ndarray, same: float) -> np.ndarray | None:
    """The row (N,) of `places` (N, d) that each row of `images` (N, d) coincides with, within `same`; None if they do not match one to one.

    Both are sorted along one direction. A search tree would also find the rows, but takes 0.1 s to load.
    """
    along, row = ASKEW[: places.shape[1]], np.empty(len(places), dtype=int)
    row[np.argsort(images @ along)] = np.argsort(places @ along)
    distance = np.linalg.norm(places[row] - images, axis=1)
    is_inverse = np.array_equal(row[row], np.arange(len(row)))
    return row if distance.max() <= same and is_inverse else None
