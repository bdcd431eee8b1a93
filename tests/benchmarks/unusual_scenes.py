"""Random structures of the generators with unusual keys: gravity, insets, friction, loads, supports that rise, requested effects.

They are the third family of the blind verdicts. Each scene follows from the seed and its number alone. A scene is drawn again where its
keys break a rule of the scene file, or where the structure cannot stand.
"""

from typing import Any

import generated_scenes
import numpy as np
from verdict_scenes import Drawn

import la_core
from la_core.errors import SceneError

SEED, SCENES = 20261130, 120
SHARE = 0.3  # probability of each change
EFFECTS = {"plane": False, "displacement": "finite", "rotation": "finite", "recording": "states", "elasticity": "plateau"}
Random = np.random.Generator


def drawn(number: int, seed: int = SEED) -> Drawn:
    """Return the random scene of a number from 0 to SCENES - 1."""
    attempt = 0
    while True:
        random = np.random.default_rng((seed, number, attempt))
        attempt += 1
        kind, motion, tables = generated_scenes.tables(number, random)
        _change(random, tables)
        try:
            scene = la_core.build(tables, f"unusual_{number:03d}")
        except SceneError:
            continue
        if generated_scenes.is_fit(scene):
            return Drawn(number, kind, motion, scene)


def _change(random: Random, tables: dict[str, Any]) -> None:
    """Change some keys of a scene's tables, each with the probability SHARE."""
    joint, settlement = tables["joint"], tables.get("settlement", {})
    changes = random.uniform(size=7) < SHARE
    if changes[0]:
        joint["inset"] = float(random.choice((1e-4, 3e-3, 1e-2)))  # m
    if changes[1]:
        joint["friction"] = float(random.choice((0.1, 0.2, 1.5, 3.0)))
    if changes[2]:
        size, aside = float(random.choice((1.6, 9.81, 100.0))), random.uniform(-0.1, 0.1, 2)
        tables["gravity"] = [*(round(float(size * share), 3) for share in aside), -size]
    if changes[3]:
        tables["friction"] = [
            {"joints": str(random.choice(("bed", "head", "footing"))), "friction": float(random.choice((0.05, 0.3, 2.0)))}
        ]
    if changes[4]:
        force = [round(float(each), 1) for each in random.normal(0.0, 50.0, 3)]
        tables.setdefault("load", []).append({"name": "on every block", "blocks": ["*"], "force": force})
    if changes[5] and "direction" in settlement:
        settlement["direction"] = [-each for each in settlement["direction"]]
    tables["effects"] = {name: value for name, value in EFFECTS.items() if random.uniform() < 0.5 * SHARE}
    if changes[6]:
        tables["accuracy"] = float(random.choice((0.1, 0.02, 0.01)))
