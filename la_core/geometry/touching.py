"""Search for touching faces of blocks. Interfaces, contacts at edges and areas of joints share this search."""

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from la_core.geometry.blocks import Blocks, Held
from la_core.geometry.faces import face_overlaps, near_parts, opposite_faces

TOUCH = 1e-5  # of the smaller block's size: faces closer than this touch; typed coordinates seldom have more digits
OPPOSITE = 1e-3  # rad: largest angle between candidate faces; then the distance at every corner of the overlap decides


@dataclass(frozen=True, eq=False, repr=False)
class TouchingFaces(Held):
    """The T pairs of touching faces of a structure; parts and faces have the indices of `Blocks.parts`.

    Attributes
    ----------
    near : (N, 2) array of int
        Parts of different blocks whose bounding boxes touch, within TOUCH of each block's size.
    tolerance : (N,) array
        Distance within which faces of a near pair touch, m.
    pair : (T,) array of int
        Near pair that each pair of touching faces belongs to.
    face_a, face_b : (T,) arrays of int
        Face of the first and of the second part.
    corners : (Q, 3) array
        Corners of the overlaps of the faces, overlap after overlap, m.
    overlap : (Q,) array of int
        Pair of touching faces that each corner belongs to.
    """

    near: np.ndarray
    tolerance: np.ndarray
    pair: np.ndarray
    face_a: np.ndarray
    face_b: np.ndarray
    corners: np.ndarray
    overlap: np.ndarray

    @property
    def parts(self) -> np.ndarray:
        """Both parts (T, 2) of each pair of touching faces."""
        return self.near[self.pair]

    @property
    def start(self) -> np.ndarray:
        """First corner of each overlap, and the number of all corners: (T + 1,) array."""
        return np.concatenate([[0], np.cumsum(np.bincount(self.overlap, minlength=len(self.pair)))])


_FOUND: WeakKeyDictionary[Blocks, TouchingFaces] = WeakKeyDictionary()  # the checks of a scene and then its model need the same search


def touching_faces(blocks: Blocks) -> TouchingFaces:
    """Return the faces of different blocks that touch; blocks may overlap. The search is made once for each `blocks` object."""
    if blocks not in _FOUND:
        _FOUND[blocks] = _search(blocks)
    return _FOUND[blocks]


def _search(blocks: Blocks) -> TouchingFaces:
    parts = blocks.parts
    size, near = near_parts(blocks, TOUCH)
    tolerance = TOUCH * size[near].min(axis=1)
    pair, face_a, face_b = opposite_faces(parts, near, tolerance, size, OPPOSITE)
    kept, corners, owner, gap = face_overlaps(parts, face_a, face_b, tolerance[pair])
    close = gap <= tolerance[pair[kept]]
    kept, of_close = kept[close], close[owner]
    return TouchingFaces(
        near, tolerance, pair[kept], face_a[kept], face_b[kept], corners[of_close], (np.cumsum(close) - 1)[owner[of_close]]
    )
