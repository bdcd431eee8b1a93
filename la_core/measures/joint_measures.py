"""Measures of joints: the resultant force of each interface, where it acts, its state, and the line of thrust."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from la_core.measures.dissipation import ContactState, contact_states, loaded_compression
from la_core.model import Assembly

CHAIN = 2.0 / 3.0  # of the free blocks: where as many have two joints only, the thrust follows a line
SHORTEST = 3  # blocks of such a chain


@dataclass(frozen=True)
class JointForces:
    """Resultant forces of the I interfaces.

    Attributes
    ----------
    force : (I, 3) array
        Force on block b, global axes, N.
    normal : (I,) array
        Its component along the normal, compression positive, N.
    shear : (I,) array
        Size of its component across the normal, N.
    centre : (I, 3) array
        Centre of pressure, m: mean of the contact points, weighted by their compression. NaN without compression.
    """

    force: np.ndarray
    normal: np.ndarray
    shear: np.ndarray
    centre: np.ndarray


def joint_forces(assembly: Assembly, forces: np.ndarray) -> JointForces:
    """Sum contact forces (C, 3), N on block b, over each interface; all NaN where a force is NaN."""
    interfaces, points = assembly.interfaces, assembly.points
    force = np.zeros((len(interfaces), 3))
    np.add.at(force, points.interface, forces)
    normal = np.einsum("ij,ij->i", force, interfaces.normal)
    shear = np.linalg.norm(force - normal[:, None] * interfaces.normal, axis=1)
    pressed = loaded_compression(assembly, forces)
    total = np.bincount(points.interface, weights=pressed, minlength=len(interfaces))
    moment = np.zeros((len(interfaces), 3))
    np.add.at(moment, points.interface, pressed[:, None] * points.position)
    with np.errstate(invalid="ignore", divide="ignore"):
        centre = np.where(total[:, None] > 0.0, moment / total[:, None], np.nan)
    return JointForces(force, normal, shear, centre)


def joint_centres(assembly: Assembly) -> np.ndarray:
    """Mean position (I, 3) of the contact points of each interface, m."""
    points = assembly.points
    total = np.zeros((len(assembly.interfaces), 3))
    np.add.at(total, points.interface, points.position)
    return total / np.bincount(points.interface, minlength=len(total))[:, None]


def joint_states(assembly: Assembly, states: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """State (I,) of each interface, a ContactState, from those (C,) of its contact points.

    An interface slides where friction does work in one of its points. Otherwise it opens where a point opens, slides
    where a point slides without force, and sticks where a point is compressed. It is UNKNOWN where a point is.

    Parameters
    ----------
    assembly : Assembly
        Structure.
    states : (C,) array of int
        ContactState of each contact point.
    forces : (C, 3) array
        Contact forces on block b, N, global axes.
    """
    count = len(assembly.interfaces)
    if np.any(states == ContactState.UNKNOWN):
        return np.full(count, int(ContactState.UNKNOWN))
    ranked = (ContactState.IDLE, ContactState.STICKING, ContactState.SLIDING, ContactState.OPENING, ContactState.SLIDING)
    rank = np.select([states == state for state in ranked[:4]], range(4))
    rank[(states == ContactState.SLIDING) & (loaded_compression(assembly, forces) > 0.0)] = 4
    highest = np.zeros(count, dtype=int)
    np.maximum.at(highest, assembly.points.interface, rank)
    return np.array(ranked, dtype=int)[highest]


def joint_rows(assembly: Assembly, twists: np.ndarray, forces: np.ndarray) -> list[dict[str, Any]]:
    """Every joint as a row of a table: names of its blocks, state, normal and shear force (N), centre of pressure (m).

    twists (B, 6) and forces (C, 3), N: the mechanism and its contact forces.
    """
    names, interfaces = assembly.blocks.names, assembly.interfaces
    states = joint_states(assembly, contact_states(assembly, twists, forces), forces)
    joints = joint_forces(assembly, forces)
    columns = (interfaces.block_a, interfaces.block_b, states, joints.normal.tolist(), joints.shear.tolist(), joints.centre.tolist())
    return [
        {"block_a": names[a], "block_b": names[b], "state": ContactState(state).name.lower(), "normal": normal, "shear": shear}
        | dict(zip("xyz", centre, strict=True))
        for a, b, state, normal, shear, centre in zip(*columns, strict=True)
    ]


def thrust_line(assembly: Assembly) -> np.ndarray:
    """Pairs (T, 2) of the interfaces on both sides of a free block with two joints, as in an arch or a tower.

    A line through the centres of pressure of each pair is the line of thrust. Empty where fewer than three free
    blocks, or less than two thirds of them, have two joints only: in a wall the thrust spreads.
    """
    interfaces, blocks = assembly.interfaces, assembly.blocks
    sides = np.concatenate([interfaces.block_a, interfaces.block_b])
    joint = np.tile(np.arange(len(interfaces)), 2)
    passed = blocks.free & (np.bincount(sides, minlength=len(blocks)) == 2)
    if passed.sum() < max(CHAIN * blocks.free.sum(), SHORTEST):
        return np.zeros((0, 2), dtype=int)
    order = np.argsort(sides, kind="stable")
    return joint[order][passed[sides[order]]].reshape(-1, 2)
