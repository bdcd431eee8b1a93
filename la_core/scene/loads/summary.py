"""Dead loads, ties, classes of joints and motions of supports of a scene as plain values, for tables, reports and JSON."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from la_core.geometry import ROLES, Blocks
from la_core.scene.loads.dead_loads import GROUND, Ties
from la_core.scene.loads.point_forces import PointForces
from la_core.scene.schema.loads import JointFriction

MOST_NAMES = 12  # names of supports with the same motion


def loads_as_dicts(loads: PointForces, names: Sequence[str]) -> list[dict[str, Any]]:
    """Each load: `name`, total `force` (3 components, N), `mass` (kg; None for a force), number of `blocks`, `point` of the resultant (m).

    names: names of the [[load]] tables, in their order.
    """
    rows = []
    for number, name in enumerate(names):
        own = loads.table == number
        mass = float(loads.mass[own].sum())
        force = loads.force[own].sum(axis=0).tolist()
        point = np.average(loads.point[own], axis=0, weights=np.abs(loads.force[own]).sum(axis=1)).tolist()  # all are parallel
        rows.append({"name": name, "force": force, "mass": mass or None, "blocks": len(np.unique(loads.block[own])), "point": point})
    return rows


def ties_as_dicts(ties: Ties | None, blocks: Sequence[str]) -> list[dict[str, Any]]:
    """Each tie: `name`, `tension` (N), `length` (m), `ends` (two points, m), `between` (blocks at the ends). blocks: all names."""
    if ties is None:
        return []
    lengths = np.linalg.norm(ties.ends[:, 1] - ties.ends[:, 0], axis=1)
    held = ["support" if is_support else "ground" for is_support in ties.at_support.tolist()]
    ends = [[held[tie] if end == GROUND else blocks[end] for end in pair] for tie, pair in enumerate(ties.block.tolist())]
    return [
        {"name": name, "tension": float(ties.tension[k]), "length": float(lengths[k]), "between": ends[k], "ends": ties.ends[k].tolist()}
        for k, name in enumerate(ties.names)
    ]


def motions_as_dicts(twists: np.ndarray | None, blocks: Blocks) -> list[dict[str, Any]]:
    """Each distinct unit motion of supports: at most 12 `names` of its supports, `velocity` of their middle, `spin` (angular velocity).

    twists: (B, 6), velocity of the origin and angular velocity; None without a settlement.
    """
    supports = np.flatnonzero(blocks.role == ROLES["support"])
    if twists is None:
        return []
    distinct, alike = np.unique(twists[supports], axis=0, return_inverse=True)
    motions = []
    for k, twist in enumerate(distinct):
        own = supports[alike.ravel() == k]
        velocity = twist[:3] + np.cross(twist[3:], np.average(blocks.centroid[own], axis=0)) + 0.0  # without negative zeros
        names = [blocks.names[block] for block in own[:MOST_NAMES]]
        motions.append({"names": names, "velocity": velocity.tolist(), "spin": twist[3:].tolist()})
    return motions


def classes_as_dicts(classes: Sequence[JointFriction]) -> list[dict[str, Any]]:
    """Each class of joints: `joints` and `between` as given, None where left out, and its `friction`."""
    return [{"joints": one.joints, "between": list(one.between) if one.between else None, "friction": one.friction} for one in classes]
