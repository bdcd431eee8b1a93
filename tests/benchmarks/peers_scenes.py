"""Scenes of the comparison with peers: the shipped arch, wall and corner, and walls of growing size, in the plane and in space."""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
from collections.abc import Callable
from functools import partial

import benchmark_scale
import scenes

from la_core.scene.scene import Scene

SCENES: dict[str, Callable[[], Scene]] = {
    "arch_spreading": partial(scenes.shipped, "arch_spreading"),
    "wall_third": partial(scenes.shipped, "wall_third"),
    "plane wall 1000": partial(benchmark_scale.wall, 1000, plane=True),
    "corner_settling_end": partial(scenes.shipped, "corner_settling_end"),
    "wall 100 in space": partial(benchmark_scale.wall, 100, plane=False),
    "wall 1000 in space": partial(benchmark_scale.wall, 1000, plane=False),
}
