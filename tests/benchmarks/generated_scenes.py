"""Random structures of the generators: arches, vaults, domes, corners, walls with floors, rubble; settled, pushed or tilted.

They are the second family of the blind verdicts. Each scene follows from the seed and its number alone. A scene is drawn again where it
cannot stand, its tables break a rule of the scene file, or it has too few or too many blocks.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from verdict_scenes import Drawn

import la_core
from la_core.errors import SceneError
from la_core.limit import Drive, Status, solve_associated
from la_core.model import assemble
from la_core.scene import Scene

SEED, SCENES = 20261129, 120
LEAST_BLOCKS, MOST_BLOCKS = 7, 45
MOTIONS = ("down", "oblique", "turning")
LOADS = ("pushed", "tilted")
DEPTH = 0.4  # m
Tables = dict[str, Any]
Random = np.random.Generator


def drawn(number: int, seed: int = SEED) -> Drawn:
    """Return the random scene of a number from 0 to SCENES - 1."""
    attempt = 0
    while True:
        kind, motion, made = tables(number, np.random.default_rng((seed, number, attempt)))
        attempt += 1
        try:
            scene = la_core.build(made, f"generated_{number:03d}")
        except SceneError:
            continue
        if is_fit(scene):
            return Drawn(number, kind, motion, scene)


def tables(number: int, random: Random) -> tuple[str, str, Tables]:
    """Return the kind, the motion and the tables of a scene of this number."""
    kind, makes = list(KINDS.items())[number % len(KINDS)]
    motions = LOADS if kind.startswith("pushed") else MOTIONS
    motion = motions[number // len(KINDS) % len(motions)]
    return kind, motion, _common(random, kind, motion) | makes(random, motion)


def is_fit(scene: Scene) -> bool:
    """Return True if a scene stands and has neither too few nor too many blocks."""
    return LEAST_BLOCKS <= int(scene.blocks.free.sum()) <= MOST_BLOCKS and _stands(scene)


def _stands(scene: Scene) -> bool:
    try:
        return solve_associated(assemble(scene), Drive.LIVE if scene.live is not None else Drive.YIELDING).status is Status.SOLVED
    except SceneError:
        return False


def _common(random: Random, kind: str, motion: str) -> Tables:
    friction, density = round(float(random.uniform(0.35, 1.0)), 3), round(float(random.uniform(1600.0, 2600.0)))
    return {"title": f"Random scene: {kind}, {motion}", "stone": {"density": density}, "joint": {"friction": friction}}


def _between(random: Random, low: float, high: float, step: float = 0.05) -> float:
    """Return a random multiple of a step between two values, both included."""
    return round(step * int(random.integers(round(low / step), round(high / step) + 1)), 6)


def _sign(random: Random) -> float:
    return float(random.choice((-1.0, 1.0)))


def _settlement(random: Random, motion: str, pivot: list[float], axis: list[float], space: bool) -> Tables:
    """Return the motion of a support. A turning support rotates about an axis through `pivot`."""
    if motion == "turning":
        return {"settlement": {"axis": axis, "point": pivot}}
    aside = random.uniform(0.1, 0.8) * _sign(random) if motion == "oblique" else 0.0
    out = random.uniform(-0.4, 0.4) if motion == "oblique" and space else 0.0
    return {"settlement": {"direction": [round(float(aside), 3), round(float(out), 3), -1.0]}}


def _load(random: Random, motion: str, space: bool) -> Tables:
    """Return a push in a nearly level direction, or a tilt. In the plane both act along x."""
    angle = random.uniform(0.0, 2.0 * np.pi) if space else 0.5 * np.pi * (1.0 - _sign(random))
    level = [round(float(np.cos(angle)), 3), round(float(np.sin(angle)), 3), 0.0]
    if motion == "tilted":
        return {"tilt": {"axis": [-level[1], level[0], 0.0]}}
    return {"live": {"direction": [*level[:2], round(float(random.uniform(-0.2, 0.2)), 3)]}}


def _arch_keys(random: Random) -> Tables:
    """Return a ring of a random shape that often stands."""
    shape = str(random.choice(("circular", "pointed", "elliptical", "basket")))
    span = _between(random, 1.5, 4.0)
    low, high = {"circular": (0.2, 0.5), "pointed": (0.55, 0.9), "elliptical": (0.3, 0.6), "basket": (0.3, 0.45)}[shape]
    return {
        "shape": shape, "centre": [0.0, 0.0, 0.0], "span": span, "rise": round(span * float(random.uniform(low, high)), 3),
        "thickness": round(span * float(random.uniform(0.1, 0.2)), 3), "voussoirs": int(random.integers(7, 20)),
        "springers": {"left": "fixed", "right": "support"},
    }  # fmt: skip


def _arch(random: Random, motion: str) -> Tables:
    keys = _arch_keys(random) | {"depth": DEPTH, "rings": int(random.choice((1, 1, 2)))}
    pivot = [0.5 * keys["span"] + _between(random, 0.0, 1.0), 0.0, -_between(random, 0.0, 0.5)]
    return {"arch": [keys]} | _settlement(random, motion, pivot, [0.0, _sign(random), 0.0], space=False)


def _pushed_arch(random: Random, motion: str) -> Tables:
    keys = _arch_keys(random) | {"depth": DEPTH, "springers": {"left": "fixed", "right": "fixed"}}
    return {"arch": [keys]} | _load(random, motion, space=False)


def _vault(random: Random, motion: str) -> Tables:
    keys = _arch_keys(random) | {"length": _between(random, 0.6, 2.0), "rings": 2, "bond": str(random.choice(("running", "stack")))}
    keys["voussoirs"] = int(random.integers(5, 10))
    pivot = [0.5 * keys["span"], 0.0, 0.0]
    axis = [round(float(random.uniform(-0.5, 0.5)), 3), _sign(random), 0.0]
    return {"vault": [keys]} | _settlement(random, motion, pivot, axis, space=True)


def _dome(random: Random, motion: str) -> Tables:
    radius, lunes = _between(random, 1.5, 3.0), int(random.choice((12, 16, 20)))
    first = int(random.integers(1, 3))
    keys = {
        "centre": [0.0, 0.0, 0.0], "radius": radius, "thickness": round(radius * float(random.uniform(0.1, 0.2)), 3),
        "courses": int(random.integers(3, 5)), "lunes": lunes, "embrace": _between(random, 60.0, 90.0, 5.0),
        "oculus": _between(random, 10.0, 25.0, 5.0), "sector": 90.0, "sides": str(random.choice(("fixed", "free"))),
        "support": [first, first + int(random.integers(0, 2))],
    }  # fmt: skip
    return {"dome": [keys]} | _settlement(random, motion, [radius, 0.0, 0.0], [0.0, 1.0, 0.0], space=True)


def _building_keys(random: Random) -> Tables:
    plan = str(random.choice(("L", "L", "T")))
    size = [0.4 * int(random.integers(4, 7)), 0.4 * int(random.integers(3, 5))]
    return {
        "plan": plan, "origin": [0.0, 0.0, 0.0], "size": [round(length, 6) for length in size], "block": [0.4, 0.2, 0.2],
        "courses": int(random.integers(3, 6)), "foundation": {"height": 0.2},
    }  # fmt: skip


def _corner(random: Random, motion: str) -> Tables:
    keys = _building_keys(random)
    length, width = keys["size"]
    start = round(length - 0.2 * int(random.integers(2, 5)), 6)
    keys["foundation"]["settling"] = {"from": [start, 0.0], "to": [length, width]}
    axis = [round(float(random.uniform(-0.5, 0.5)), 3), 1.0, 0.0]
    return {"building": [keys]} | _settlement(random, motion, [start, 0.0, 0.0], axis, space=True)


def _pushed_corner(random: Random, motion: str) -> Tables:
    return {"building": [_building_keys(random)]} | _load(random, motion, space=True)


def _wall_keys(random: Random) -> Tables:
    per_course = int(random.integers(4, 7))
    opening = {"from": [0.9, 0.6], "to": [0.9 + 0.3 * int(random.integers(2, 4)), 1.2], "bearing": 0.3}
    if random.uniform() < 0.5:
        opening |= {"head": str(random.choice(("arch", "flat arch"))), "voussoirs": 5}
        opening |= {"rise": 0.3} if opening["head"] == "arch" else {}
    return {
        "bond": "running", "origin": [0.0, 0.0, 0.0], "block": [0.6, DEPTH, 0.3], "per_course": per_course,
        "courses": int(random.integers(6, 8)), "footing": {"height": 0.3}, "opening": [opening],
    }  # fmt: skip


def _above(random: Random, keys: Tables, has_rod: bool) -> Tables:
    """Return a floor on the top course, and perhaps a rod along this course."""
    length, courses = 0.6 * keys["per_course"], keys["courses"]
    floor = {"blocks": [f"wall {courses}.*"], "per": "m", "from": [0.0, 0.2], "to": [length, 0.2], "mass": _between(random, 50, 800, 10)}
    if not has_rod:
        return {"load": [floor]}
    ends = {"from": [0.0, 0.2, 0.3 * courses - 0.15], "to": [length, 0.2, 0.3 * courses - 0.15]}
    last = keys["per_course"] + (courses % 2 == 0)  # every other course begins and ends with half a block
    rod = {"blocks": [f"wall {courses}.1", f"wall {courses}.{last}"], "force": _between(random, 200, 4000, 100)}
    return {"load": [floor], "tie": [rod | ends]}


def _wall(random: Random, motion: str) -> Tables:
    keys = _wall_keys(random)
    length = 0.6 * keys["per_course"]
    start = round(length - 0.3 * int(random.integers(2, 5)), 6)
    keys["footing"]["settling"] = [start, length]
    return (
        {"wall": [keys]}
        | _above(random, keys, random.uniform() < 0.5)
        | _settlement(random, motion, [start, 0.0, 0.0], [0.0, 1.0, 0.0], space=False)
    )


def _pushed_wall(random: Random, motion: str) -> Tables:
    keys = _wall_keys(random)
    return {"wall": [keys]} | _above(random, keys, motion != "tilted" and random.uniform() < 0.5) | _load(random, motion, space=False)


def _rubble_keys(random: Random) -> Tables:
    return {
        "origin": [0.0, 0.0, 0.0], "size": [_between(random, 1.2, 2.4), _between(random, 0.8, 1.6)], "depth": DEPTH,
        "stones": int(random.integers(12, 30)), "seed": int(random.integers(1, 1_000_000)), "shortest": 0.06,
        "flatness": _between(random, 1.0, 2.5), "footing": {"height": 0.2},
    }  # fmt: skip


def _rubble(random: Random, motion: str) -> Tables:
    keys = _rubble_keys(random)
    length = keys["size"][0]
    start = round(length - length * float(random.uniform(0.25, 0.5)), 2)
    keys["footing"]["settling"] = [start, length]
    return {"rubble": [keys]} | _settlement(random, motion, [start, 0.0, 0.0], [0.0, 1.0, 0.0], space=False)


def _pushed_rubble(random: Random, motion: str) -> Tables:
    return {"rubble": [_rubble_keys(random)]} | _load(random, motion, space=False)


KINDS: dict[str, Callable[[Random, str], Tables]] = {
    "arch": _arch,
    "pushed arch": _pushed_arch,
    "vault": _vault,
    "dome": _dome,
    "corner": _corner,
    "pushed corner": _pushed_corner,
    "wall with floor": _wall,
    "pushed wall with floor": _pushed_wall,
    "rubble": _rubble,
    "pushed rubble": _pushed_rubble,
}
