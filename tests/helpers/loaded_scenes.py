"""Blocks for loads and ties, tables of loads, ties and friction, and their solutions."""

from collections.abc import Sequence
from typing import Any

import scenes

from la_core.limit.associated import Solution, Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble
from la_core.scene.scene import Scene

EXACT = 1e-6  # share of the weight: accuracy of the solver
PREDICTED = 1e-3  # share of the weight: joints are slightly elastic in the prediction
BEAM = (
    scenes.box("left", (0.0, 0.0, -0.2), (0.2, 1.0, 0.0), "fixed"),
    scenes.box("right", (0.8, 0.0, -0.2), (1.0, 1.0, 0.0), "support"),
    scenes.box("beam", (0.0, 0.0, 0.0), (1.0, 1.0, 0.3)),
)
STACK = (
    scenes.box("ground", (0.0, 0.0, -0.2), (1.0, 1.0, 0.0), "fixed"),
    scenes.box("lower", (0.0, 0.0, 0.0), (1.0, 1.0, 0.2)),
    scenes.box("upper", (0.0, 0.0, 0.2), (1.0, 1.0, 0.4)),
)


def load(**entries: Any) -> str:
    """Return a [[load]] on the beam, unless other blocks are given. start: its key `from`."""
    if "start" in entries:
        entries["from"] = entries.pop("start")
    return scenes.table("[load]", **({"blocks": ["beam"]} | entries))


def tie(blocks: Sequence[str], start: Sequence[float], to: Sequence[float], force: float) -> str:
    return scenes.table("[tie]", blocks=blocks, **{"from": start}, to=to, force=force)


def friction(**entries: Any) -> str:
    return scenes.table("[friction]", **entries)


def solved(scene: Scene, drive: Drive = Drive.YIELDING) -> Solution:
    solution = solve_associated(assemble(scene), drive)
    assert solution.status is Status.SOLVED
    return solution
