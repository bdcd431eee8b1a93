"""Scenes for tests of the laws of the associated problem, their solutions, and tolerances."""

from collections.abc import Iterator

import numpy as np
import pytest
import scenes

from la_core.limit.associated import Solution, Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import Assembly, assemble
from la_core.scene.scene import Scene

ROUND_OFF = 1e-7  # relative: solver tolerance 1e-9 on two differently conditioned copies of one problem
INDEPENDENT = 1e-6  # share of the weight: HiGHS' own feasibility tolerance is 1e-7 of a force scaled to one

WALL = scenes.text(*scenes.wall(5, 6, split=1.2))
ARCH = scenes.text(scenes.arch(11, 0.15), settlement=(1.0, 0.0, -1.0), friction=0.7)
CROSSING = scenes.text(
    *scenes.crossing_beams(),
    settlement=(0.3, 0.2, -1.0),
)
LIVE = scenes.text(*scenes.wall(4, 5), live=(1.0, 0.0, 0.0))
TURNING = scenes.text(*scenes.wall(5, 6, split=1.2), settlement={"axis": (0.0, 1.0, 0.0), "point": (0.9, 0.0, -0.4)})
TEXTS = {"wall": WALL, "arch": ARCH, "crossing beams": CROSSING, "live": LIVE, "turning base": TURNING}

every_scene = pytest.mark.parametrize("name", TEXTS)


def solutions(model: Scene | Assembly) -> Iterator[tuple[Assembly, Drive, Solution]]:
    assembly = assemble(model) if isinstance(model, Scene) else model
    for drive in [Drive.LIVE] if assembly.has_live_load else [Drive.YIELDING, Drive.PUSHING]:
        solution = solve_associated(assembly, drive)
        assert solution.status is Status.SOLVED, drive
        yield assembly, drive, solution


def values(model: Scene | Assembly) -> list[float]:
    """Return the least and greatest reaction over the weight (a moment also over the structure's size), or the multiplier."""

    def unit(assembly: Assembly) -> float:
        size = float(np.cbrt(assembly.blocks.volume.sum())) if np.any(assembly.support_twist[:, 3:]) else 1.0
        return 1.0 if assembly.has_live_load else assembly.weight * size

    return [solution.value / unit(assembly) for assembly, _, solution in solutions(model)]
