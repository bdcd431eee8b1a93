"""Blocks that touch only along an edge or at a corner. Such a contact is no joint."""

from dataclasses import dataclass

import numpy as np

from la_core.geometry.blocks import Blocks
from la_core.geometry.interfaces import gaps, overlaps
from la_core.geometry.polygons import group_members, next_corners, owners
from la_core.geometry.touching import touching_faces

SAME = 10.0  # over the tolerance of a contact: a shorter contact is at a corner, and a block this close to a contact reaches it


@dataclass(frozen=True)
class EdgeContacts:
    """Pairs of blocks that touch but share no face, where no blocks at the same place connect them by joints.

    Attributes
    ----------
    pairs : (P, 2) array of int
        The blocks; at least one of them is free.
    place : (P, 3) array
        Middle of each contact, m.
    length : (P,) array
        Length of each contact, m; 0 at a corner.
    """

    pairs: np.ndarray
    place: np.ndarray
    length: np.ndarray


def edge_contacts(blocks: Blocks) -> EdgeContacts:
    """Find the pairs of blocks that touch only along an edge or at a corner.

    Where courses cross, as in a stack bond, opposite blocks touch in this way, too. Joints connect them through the blocks beside them,
    so no joint is missing, and such pairs are left out. Blocks that share volume are left out, too, because the model refuses them.
    """
    parts, owner, found = blocks.parts, blocks.part_block, touching_faces(blocks)
    pairs, tolerance, joined = found.near, found.tolerance, _both_ways(owner[found.parts])
    is_free = blocks.free[owner[pairs]].any(axis=1)
    alone = is_free & ~_are_among(owner[pairs], joined)
    pairs, tolerance = pairs[alone], tolerance[alone]
    near = np.abs(gaps(parts, pairs)) <= tolerance
    pairs, tolerance = pairs[near], tolerance[near]
    low, high = _shared_box(parts, pairs, tolerance)
    touches = np.isfinite(low).all(axis=1)
    pairs, low, high, reach = pairs[touches], low[touches], high[touches], SAME * tolerance[touches]
    place, length = (low + high) / 2.0, np.linalg.norm(high - low, axis=1)
    alone = ~_filled(blocks, joined, pairs, place, reach)
    alone[alone] = ~_overlap(parts, pairs[alone], reach[alone] / SAME)
    length = np.where(length > reach, length, 0.0)
    both, first = np.unique(owner[pairs[alone]], axis=0, return_index=True)
    return EdgeContacts(both, place[alone][first], length[alone][first])


def _both_ways(pairs: np.ndarray) -> np.ndarray:
    """Sorted pairs (J, 2), each in both orders."""
    return np.unique(np.concatenate([pairs, pairs[:, ::-1]]), axis=0)


def _overlap(parts: Blocks, pairs: np.ndarray, tolerance: np.ndarray) -> np.ndarray:
    """Mask (P,) of the pairs (P, 2) of convex blocks that share volume, deeper than the tolerance (P,), m."""
    deep = np.array([(a, b) for a, b, *_ in overlaps(parts, pairs, tolerance)], dtype=int).reshape(-1, 2)
    return _are_among(pairs, deep)


def _are_among(pairs: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Mask (P,) of the pairs (P, 2) that are also in `others` (J, 2)."""
    both = np.concatenate([pairs, others])
    number = both @ np.array([1 + both.max(initial=0), 1])
    return np.isin(number[: len(pairs)], number[len(pairs) :])


def _shared_box(parts: Blocks, pairs: np.ndarray, tolerance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bounding box, as two corners (P, 3), m, of the pieces of edges of each block of a pair in the other block; infinite without any."""
    low, high = np.full((len(pairs), 3), np.inf), np.full((len(pairs), 3), -np.inf)
    for two in (pairs, pairs[:, ::-1]):
        row, ends = _edges_within(parts, two, tolerance)
        for end in ends:
            np.minimum.at(low, row, end)
            np.maximum.at(high, row, end)
    return low, high


def _edges_within(parts: Blocks, pairs: np.ndarray, tolerance: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, np.ndarray]]:
    """Pieces of edges of the first block of each pair (P, 2) that lie in the second one, grown by the tolerance (P,), m.

    Returns the pair of each of the E pieces, and its two ends (E, 3).
    """
    first, second = parts.face_vertex, parts.face_vertex[next_corners(parts.face_start)]
    once = first < second  # every edge belongs to two faces, which run along it in opposite directions
    first, second, of_part = first[once], second[once], parts.face_block[owners(parts.face_start)][once]
    edge_start = np.searchsorted(of_part, np.arange(len(parts) + 1))
    face_start = parts.part_face_start
    row, place = group_members(np.diff(edge_start)[pairs[:, 0]])
    edge = edge_start[pairs[row, 0]] + place
    start, along = parts.vertices[first[edge]], parts.vertices[second[edge]] - parts.vertices[first[edge]]
    piece, place = group_members(np.diff(face_start)[pairs[row, 1]])
    face = face_start[pairs[row[piece], 1]] + place
    room = parts.face_offset[face] + tolerance[row[piece]] - np.sum(parts.face_normal[face] * start[piece], axis=1)
    speed = np.sum(parts.face_normal[face] * along[piece], axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = np.where(speed == 0.0, np.where(room < 0.0, -np.inf, np.inf), room / speed)
    leave, enter = np.ones(len(edge)), np.zeros(len(edge))
    np.minimum.at(leave, piece, np.where(speed >= 0.0, at, np.inf))
    np.maximum.at(enter, piece, np.where(speed < 0.0, at, -np.inf))
    inside = enter <= leave
    start, along = start[inside], along[inside]
    return row[inside], (start + enter[inside, None] * along, start + leave[inside, None] * along)


def _filled(blocks: Blocks, joined: np.ndarray, pairs: np.ndarray, place: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Mask (P,) of the pairs (P, 2) of parts whose blocks are connected by joints through one or two blocks that reach the place (P, 3).

    Where three planes of joints cross, opposite blocks meet at a corner, and two blocks lie between them.
    """
    (row, beside), (other_row, beside_other) = (_neighbours_at(blocks, joined, own, place, reach) for own in blocks.part_block[pairs].T)
    start = np.searchsorted(other_row, np.arange(len(pairs) + 1))
    one, nth = group_members(np.diff(start)[row])
    near, far = beside[one], beside_other[start[row[one]] + nth]
    linked = (near == far) | _are_among(np.stack([near, far], axis=1), joined)
    filled = np.zeros(len(pairs), dtype=bool)
    filled[row[one[linked]]] = True
    return filled


def _neighbours_at(
    blocks: Blocks, joined: np.ndarray, own: np.ndarray, place: np.ndarray, reach: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Blocks that touch a block of `own` (P,) by faces and are at most `reach` (P,), m, from its place (P, 3).

    Returns two arrays (N,): the row of `own` and the block, sorted by row.
    """
    parts, every = blocks.parts, np.arange(len(blocks) + 1)
    joint_start, part_start = np.searchsorted(joined[:, 0], every), np.searchsorted(blocks.part_block, every)
    row, nth = group_members(np.diff(joint_start)[own])
    beside = joined[joint_start[own[row]] + nth, 1]
    of_beside, nth = group_members(np.diff(part_start)[beside])
    part = part_start[beside[of_beside]] + nth
    of_part, nth = group_members(np.diff(parts.part_face_start)[part])
    face = parts.part_face_start[part[of_part]] + nth
    at = row[of_beside][of_part]
    distance = np.sum(parts.face_normal[face] * place[at], axis=1) - parts.face_offset[face]
    farthest = np.full(len(part), -np.inf)
    np.maximum.at(farthest, of_part, distance)
    reaches = farthest <= reach[row[of_beside]]
    return row[of_beside][reaches], beside[of_beside][reaches]
