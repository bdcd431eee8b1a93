"""Dead loads, ties and classes of joints of a scene as plain values, for tables, reports and JSON."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from la_core.scene.loads.dead_loads import GROUND, Ties
from la_core.scene.loads.point_forces import PointForces
from la_core.scene.schema.loads import JointFriction


def loads_as_dicts(loads: PointForces, names: Sequence[str]) -> list[dict[str, Any]]:
    """Each load with its sum: `name`, `force` (3 components, N), `mass` (kg; None for a force), number of `blocks`.

    names: of the tables, in their order.
    """
    rows = []
    for number, name in enumerate(names):
        own = loads.table == number
        mass = float(loads.mass[own].sum())
        force = loads.force[own].sum(axis=0).tolist()
        rows.append({"name": name, "force": force, "mass": mass or None, "blocks": len(np.unique(loads.block[own]))})
    return rows


def ties_as_dicts(ties: Ties | None, blocks: Sequence[str]) -> list[dict[str, Any]]:
    """Each tie: `name`, `tension` (N), `length` (m), and `between`, the names of its two ends. blocks: names of all blocks."""
    if ties is None:
        return []
    lengths = np.linalg.norm(ties.ends[:, 1] - ties.ends[:, 0], axis=1)
    ends = [["ground" if end == GROUND else blocks[end] for end in pair] for pair in ties.block.tolist()]
    return [
        {"name": name, "tension": float(ties.tension[k]), "length": float(lengths[k]), "between": ends[k]}
        for k, name in enumerate(ties.names)
    ]


def classes_as_dicts(classes: Sequence[JointFriction]) -> list[dict[str, Any]]:
    """Each class of joints: `joints` and `between` as given, None where left out, and its `friction`."""
    return [{"joints": one.joints, "between": list(one.between) if one.between else None, "friction": one.friction} for one in classes]
