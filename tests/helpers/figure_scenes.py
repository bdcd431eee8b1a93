"""Scenes of every kind for tests of figures, and a run to draw with them."""

from pathlib import Path
from typing import Any

import numpy as np
from runs import made_up_run

from comparison.yade.run_record import Run
from la_core.analysis.result import LimitAnalysis
from la_core.limit.problem import Drive
from la_core.scene.scene import Scene, load_scene

HEAD = """
title = "{title}"
[stone]
density = 2000.0
[joint]
friction = 0.6
"""
PADS = """
[[block]]
name = "fixed $\\\\frac$ <pad>"
role = "fixed"
box = { from = [0.0, 0.0, -0.1], to = [0.4, 0.2, 0.0] }
[[block]]
name = "settling"
role = "support"
box = { from = [0.5, 0.0, -0.1], to = [1.0, 0.2, 0.0] }
"""
BLOCK = """
[[block]]
name = "block"
box = { from = [0.0, 0.0, 0.0], to = [1.0, 0.2, 0.5] }
"""
NARROW = BLOCK.replace("0.2, 0.5]", "0.15, 0.5]")
OVERHANG = """
[[block]]
name = "overhang"
box = { from = [0.9, 0.0, 0.0], to = [1.9, 0.2, 0.5] }
[[block]]
name = "stands"
box = { from = [0.0, 0.0, 0.0], to = [0.4, 0.2, 0.5] }
"""
DOWN = "[settlement]\ndirection = [0.0, 0.0, -1.0]\n"
TURN = "[settlement]\naxis = [0.0, 1.0, 0.0]\npoint = [0.5, 0.0, 0.0]\n"
LIVE = "[live]\ndirection = [1.0, 0.0, 0.0]\n"
SCENES = {
    "plane": PADS + BLOCK + DOWN,
    "solid": PADS + NARROW + DOWN,
    "turning": PADS + BLOCK + TURN,
    "falling": PADS + OVERHANG + DOWN,
    "live": PADS.replace('"support"', '"fixed"') + BLOCK + LIVE,
}


def scene_of(folder: Path, body: str, title: str = "A scene") -> Scene:
    path = folder / "scene.toml"
    path.write_text(HEAD.format(title=title) + body, encoding="utf-8")
    return load_scene(path)


def synthetic_run(analysis: LimitAnalysis, **result: Any) -> Run:
    """Return a run whose reaction falls to a plateau 1 % of the weight above the least reaction, with the associated mechanism."""
    least = analysis.bounds[Drive.YIELDING]
    weight = analysis.assembly.weight
    settlement = np.linspace(0.0, 4e-4, 200)
    plateau = least.value + 0.01 * weight
    reaction = plateau + 0.4 * weight * np.exp(-settlement / 3e-5)
    record = {"stage": np.ones(200, dtype=int), "settlement": settlement, "reaction": reaction}
    poses = {
        "settlement": settlement[::20],
        "displacement": settlement[::20, None, None] * least.twists[None, :, :3],
        "rotation": settlement[::20, None, None] * least.twists[None, :, 3:],
    }
    known = {"status": "plateau", "reaction": plateau, "uncertainty": 2.0, "plateau_start": 2e-4, "slope": 0.0, "message": "settled"}
    return made_up_run({**known, **result}, record, poses)
