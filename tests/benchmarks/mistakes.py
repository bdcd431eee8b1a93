"""Possible mistakes in a model. Each changes the tables of a random scene in one place."""

import copy
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from la_core.geometry import find_interfaces
from la_core.scene import Scene

Tables = dict[str, Any]
LOWER, HEAVIER, SMOOTH, FORGOTTEN = 0.9, 1.25, 0.05, 0.05  # factors of friction, density; friction of a smooth joint; share of the weight
ASIDE, ASLANT, SHIFT, INSET = math.radians(10.0), math.radians(1.0), 0.1, 5e-3  # rad, rad, m, m


def _friction(tables: Tables, _scene: Scene, _random: np.random.Generator) -> None:
    tables["joint"]["friction"] *= LOWER


def _smooth_joint(tables: Tables, scene: Scene, random: np.random.Generator) -> None:
    interfaces = find_interfaces(scene.blocks)
    pair = random.integers(len(interfaces))
    names = [scene.blocks.names[side[pair]] for side in (interfaces.block_a, interfaces.block_b)]
    tables["friction"] = [{"between": names, "friction": SMOOTH}]


def _heavy_block(tables: Tables, _scene: Scene, random: np.random.Generator) -> None:
    _free(tables, random)["density"] = HEAVIER * tables["stone"]["density"]


def _held_block(tables: Tables, _scene: Scene, random: np.random.Generator) -> None:
    _free(tables, random)["role"] = "fixed"


def _load(tables: Tables, scene: Scene, random: np.random.Generator) -> None:
    mass = FORGOTTEN * float(scene.blocks.mass[scene.blocks.free].sum())
    tables["load"] = [{"blocks": [_free(tables, random)["name"]], "mass": mass}]


def _motion(tables: Tables, _scene: Scene, _random: np.random.Generator) -> None:
    motion = tables["settlement"]
    if "direction" in motion:
        x, y, z = motion["direction"]
        motion["direction"] = [x * math.cos(ASIDE) - z * math.sin(ASIDE), y, x * math.sin(ASIDE) + z * math.cos(ASIDE)]
    else:
        motion["point"][0] += SHIFT


def _gravity(tables: Tables, _scene: Scene, _random: np.random.Generator) -> None:
    tables["gravity"] = [9.81 * math.sin(ASLANT), 0.0, -9.81 * math.cos(ASLANT)]


def _inset(tables: Tables, _scene: Scene, _random: np.random.Generator) -> None:
    tables["joint"]["inset"] = INSET


def _free(tables: Tables, random: np.random.Generator) -> Tables:
    free = [block for block in tables["block"] if block["role"] == "free"]
    return free[random.integers(len(free))]


MISTAKES: dict[str, Callable[[Tables, Scene, np.random.Generator], None]] = {
    "friction a tenth lower": _friction,
    "one joint smooth, mu = 0.05": _smooth_joint,
    "one block a quarter heavier": _heavy_block,
    "one block held": _held_block,
    "a load of 5 % of the weight on one block": _load,
    "support 10 degrees aside, or its axis 0.1 m off": _motion,
    "gravity 1 degree aslant": _gravity,
    "contact points 5 mm inside the edges, not 1 mm": _inset,
}


def with_mistake(name: str, tables: Tables, scene: Scene, random: np.random.Generator) -> Tables:
    """Return the tables of a scene with a mistake; random: chooses the affected block or joint."""
    wrong = copy.deepcopy(tables)
    MISTAKES[name](wrong, scene, random)
    return wrong
