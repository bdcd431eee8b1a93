"""Missing joints between faces that nearly touch, for example because coordinates have too few digits."""

from dataclasses import dataclass

import numpy as np

from la_core.geometry.blocks import Blocks
from la_core.geometry.faces import face_corners, face_overlaps, near_parts, opposite_faces
from la_core.geometry.polygons import polygon_areas
from la_core.geometry.touching import TOUCH, touching_faces

ALL_BUT = 1e-3  # of the smaller block's size: a gap this narrow is seldom intended
ANGLE = 3e-3  # rad: largest angle between faces with such a gap at one end


@dataclass(frozen=True)
class MissedJoints:
    """Pairs of blocks with two faces that nearly touch, but share no interface there. Bent faces may share an interface beside the gap.

    Attributes
    ----------
    pairs : (P, 2) array of int
        The blocks; at least one of them is free.
    gap : (P,) array
        Largest distance between the two faces where they are opposite, m. The blocks may also overlap by this distance.
    """

    pairs: np.ndarray
    gap: np.ndarray


def missed_joints(blocks: Blocks) -> MissedJoints:
    """Find the joints that are missing for gaps of up to ALL_BUT of the smaller block's size."""
    parts, owner = blocks.parts, blocks.part_block
    size, pairs = near_parts(blocks, ALL_BUT)
    pairs = pairs[parts.free[pairs].any(axis=1)]
    smaller = np.minimum(size[pairs[:, 0]], size[pairs[:, 1]])
    pair, face_a, face_b = opposite_faces(parts, pairs, ALL_BUT * smaller, size, ANGLE)
    # Nearly all face pairs lie on one plane and need no comparison. Half of TOUCH is the limit: corners of a bent face lie off its plane.
    off_plane = _largest_distance(parts, face_a, face_b) > 0.5 * TOUCH * smaller[pair]
    pair, face_a, face_b = pair[off_plane], face_a[off_plane], face_b[off_plane]
    # A narrower overlap is no joint: where four blocks meet in a corner, opposite blocks overlap by the error of the coordinates.
    overlap, _, _, gap = face_overlaps(parts, face_a, face_b, ALL_BUT * smaller[pair])
    both, smaller = owner[pairs[pair[overlap]]] @ np.array([len(blocks), 1]), smaller[pair[overlap]]  # one number for each pair of blocks
    missed = (gap > TOUCH * smaller) & (gap <= ALL_BUT * smaller)
    order = np.lexsort((-gap[missed], both[missed]))
    both, first = np.unique(both[missed][order], return_index=True)
    return MissedJoints(np.stack(np.divmod(both, len(blocks)), axis=1), gap[missed][order][first])


def joint_areas(blocks: Blocks) -> tuple[np.ndarray, np.ndarray]:
    """The two blocks (J, 2) of every joint between convex parts of different blocks, and the joint's area (J,), m2; blocks may overlap."""
    found = touching_faces(blocks)
    return blocks.part_block[found.parts], polygon_areas(found.corners, found.start, blocks.parts.face_normal[found.face_a])


def _largest_distance(blocks: Blocks, face_a: np.ndarray, face_b: np.ndarray) -> np.ndarray:
    """Largest distance (N,), m, of a corner of each face b from the plane of face a."""
    row, corner = face_corners(blocks, face_b)
    distance = np.zeros(len(face_a))
    np.maximum.at(distance, row, np.abs(np.einsum("ij,ij->i", corner, blocks.face_normal[face_a[row]]) - blocks.face_offset[face_a[row]]))
    return distance
