"""Measures of joints: the resultant force and the centre of pressure of each interface, its state and motion, and the line of thrust."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from la_core.geometry import next_corners, owners
from la_core.measures import mechanism
from la_core.measures.dissipation import ContactState, contact_states, loaded_compression
from la_core.model import Assembly

CHAIN = 2.0 / 3.0  # of the free blocks: where this share has only two joints, the thrust follows a line
SHORTEST = 3  # least number of blocks of such a chain


@dataclass(frozen=True, eq=False)
class JointForces:
    """Resultant forces of the I interfaces.

    Attributes
    ----------
    force : (I, 3) array
        Force on block b, global axes, N.
    normal : (I,) array
        Component of the force along the normal, compression positive, N.
    shear : (I,) array
        Size of the component across the normal, N.
    centre : (I, 3) array
        Centre of pressure, m: mean of the contact points, weighted by their compression. NaN without compression.
    """

    force: np.ndarray
    normal: np.ndarray
    shear: np.ndarray
    centre: np.ndarray


def joint_forces(assembly: Assembly, forces: np.ndarray) -> JointForces:
    """Sum contact forces (C, 3), N on block b, over each interface.

    The sums of an interface are NaN where one of its forces is NaN. The centre of pressure leaves such a contact point out.
    """
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


def ground_reactions(assembly: Assembly, forces: np.ndarray) -> np.ndarray:
    """Force (B, 3) of each fixed and each support block on the free blocks that it touches, N; 0 for a free block.

    forces (C, 3): contact forces on block b, N, global axes.
    """
    interfaces, force = assembly.interfaces, joint_forces(assembly, forces).force
    reaction = np.zeros((len(assembly.blocks), 3))
    np.add.at(reaction, interfaces.block_a, force)
    np.add.at(reaction, interfaces.block_b, -force)
    return np.where(assembly.blocks.free[:, None], 0.0, reaction)


@dataclass(frozen=True, eq=False)
class JointMotion:
    """Motion of block b against block a in the I interfaces, per unit motion of the drive.

    Attributes
    ----------
    opening : (I,) array
        Largest parting speed of its contact points, m; negative where all of them approach.
    slip : (I,) array
        Largest sliding speed of its contact points, m.
    rotation : (I,) array
        Size of the relative rotation, rad.
    """

    opening: np.ndarray
    slip: np.ndarray
    rotation: np.ndarray


def joint_motion(assembly: Assembly, twists: np.ndarray) -> JointMotion:
    """Measure the relative motion in each interface for twists (B, 6) per unit motion of the drive; NaN where a twist is NaN."""
    interfaces, joint = assembly.interfaces, assembly.points.interface
    parting, sliding = mechanism.contact_speeds(assembly, twists)
    opening, slip = np.full(len(interfaces), -np.inf), np.zeros(len(interfaces))
    with np.errstate(invalid="ignore"):  # NaN where a structure cannot stand
        np.maximum.at(opening, joint, parting)
        np.maximum.at(slip, joint, sliding)
    turn = twists[interfaces.block_b, 3:] - twists[interfaces.block_a, 3:]
    return JointMotion(opening, slip, np.linalg.norm(turn, axis=1))


def friction_used(assembly: Assembly, forces: np.ndarray) -> np.ndarray:
    """Shear of each interface over its shear strength (I,), the friction under its compression; NaN where the strength is 0.

    The inverse is the safety against sliding. The value is 1 where the interface slides. It is less where the interface turns in its own
    plane, because shear forces then cancel each other in part. forces (C, 3): contact forces on block b, N.
    """
    borne = assembly.points.friction * loaded_compression(assembly, forces)
    most = np.bincount(assembly.points.interface, weights=borne, minlength=len(assembly.interfaces))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(most > 0.0, joint_forces(assembly, forces).shear / most, np.nan)


def eccentricity(assembly: Assembly, centre: np.ndarray) -> np.ndarray:
    """Relative eccentricity (I,) of the centre of pressure: 0 in the middle of the interface, 1 at its edge, NaN without compression.

    The middle is the centroid of the interface. The edge is the one beyond the centre of pressure. The middle third of a rectangle ends
    at 1/3. centre: centres of pressure (I, 3), m.
    """
    interfaces = assembly.interfaces
    ring, corner = owners(interfaces.polygon_start), interfaces.polygon
    following = corner[next_corners(interfaces.polygon_start)]
    start = interfaces.polygon_start[:-1]
    origin = corner[start][ring]
    area = np.einsum("ij,ij->i", np.cross(corner - origin, following - origin), interfaces.normal[ring])
    whole = np.add.reduceat(area, start)  # below 0 where the corners run the other way about the normal
    middle = np.add.reduceat(area[:, None] * (origin + corner + following) / 3.0, start) / whole[:, None]
    outward = np.cross(following - corner, interfaces.normal[ring]) * np.sign(whole)[ring, None]
    reach = np.einsum("ij,ij->i", corner - middle[ring], outward)
    beyond = np.einsum("ij,ij->i", (centre - middle)[ring], outward)
    return np.asarray(np.maximum.reduceat(beyond / reach, start))


def joint_centres(assembly: Assembly) -> np.ndarray:
    """Mean position (I, 3) of the contact points of each interface, m."""
    points = assembly.points
    total = np.zeros((len(assembly.interfaces), 3))
    np.add.at(total, points.interface, points.position)
    return total / np.bincount(points.interface, minlength=len(total))[:, None]


def joint_states(assembly: Assembly, states: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """State (I,) of each interface, a ContactState, from the states (C,) of its contact points.

    An interface slides where friction does work in one of its points. Otherwise it opens where a point opens, slides
    where a point slides without force, sticks where a point is compressed, and is IDLE where none of these holds. All
    interfaces are UNKNOWN if the state of any point is UNKNOWN.

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
    """Every joint as a row of a table: names of its blocks, state, forces (N), centre of pressure (m), ratios, and motion (m, rad).

    `friction_used`, `eccentricity` and the columns of JointMotion have the meaning of the functions and the class above.
    twists (B, 6) per unit motion of the drive, and forces (C, 3), N: the mechanism and its contact forces.
    """
    names, interfaces = assembly.blocks.names, assembly.interfaces
    states = joint_states(assembly, contact_states(assembly, twists, forces), forces)
    joints, motion = joint_forces(assembly, forces), joint_motion(assembly, twists)
    columns = {
        "block_a": [names[block] for block in interfaces.block_a.tolist()],
        "block_b": [names[block] for block in interfaces.block_b.tolist()],
        "state": [ContactState(state).name.lower() for state in states.tolist()],
        "normal": joints.normal.tolist(),
        "shear": joints.shear.tolist(),
        **dict(zip("xyz", joints.centre.T.tolist(), strict=True)),
        "friction_used": friction_used(assembly, forces).tolist(),
        "eccentricity": eccentricity(assembly, joints.centre).tolist(),
        "opening": motion.opening.tolist(),
        "slip": motion.slip.tolist(),
        "rotation": motion.rotation.tolist(),
    }
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def thrust_line(assembly: Assembly) -> np.ndarray:
    """Pairs (T, 2) of the interfaces on both sides of a free block with two joints, as in an arch or a tower.

    A line through the centres of pressure of each pair is the line of thrust. Empty where fewer than three free
    blocks, or less than two thirds of them, have two joints only, because in a wall the thrust spreads.
    """
    interfaces, blocks = assembly.interfaces, assembly.blocks
    sides = np.concatenate([interfaces.block_a, interfaces.block_b])
    joint = np.tile(np.arange(len(interfaces)), 2)
    passed = blocks.free & (np.bincount(sides, minlength=len(blocks)) == 2)
    if passed.sum() < max(CHAIN * blocks.free.sum(), SHORTEST):
        return np.zeros((0, 2), dtype=int)
    order = np.argsort(sides, kind="stable")
    return joint[order][passed[sides[order]]].reshape(-1, 2)
