"""Scenes with effects of the run in YADE, and the decisions of limit analysis about these effects."""

import scenes

from la_core.model import dem_effects
from la_core.model.assembly import assemble
from la_core.model.effects import Effects
from la_core.model.joints import joint_stiffness
from la_core.scene.scene import Scene

TRAVEL = 1.2e-3  # m, requested where a block runs into another block
GAP = 2e-4  # m, between the two blocks at first


def with_effects(toml: str, **entries: str) -> Scene:
    """Return the scene of a text, with entries added to its table of effects."""
    lines = "".join(f"{name} = {scenes.inline(value)}\n" for name, value in entries.items())
    return scenes.load(toml.replace("[effects]\n", f"[effects]\n{lines}") if "[effects]" in toml else f"{toml}\n[effects]\n{lines}")


TEXTS = {
    "two_pads": scenes.shipped("two_pads").text,
    "arch": scenes.shipped("arch_spreading").text,
    "wall": scenes.text(*scenes.wall(3, 4, split=0.7), inset=0.001, model="coulomb"),
}


def buffer(gap: float = GAP, travel: float = TRAVEL) -> str:
    """A block on a pad moves sideways towards a fixed stop. The stop reaches down to the spheres under the block."""
    parts = (
        scenes.box("pad", (-0.2, -0.2, -0.2), (0.6, 0.4, 0.0), "support"),
        scenes.box("block", (0.0, 0.0, 0.0), (0.4, 0.2, 0.2)),
        scenes.box("stop", (0.4 + gap, -0.1, 0.0), (0.8, 0.3, 0.4), "fixed"),
    )
    goes_on = scenes.table("yade", max_travel=travel, plateau_travel=0.8 * travel)  # past the plateau of zero before the stop
    return scenes.text(*parts, inset=0.001, settlement=(1.0, 0.0, 0.0), plane=False) + goes_on + "\n"


def decided(scene: Scene) -> tuple[Effects, float]:
    """Return the effects of the run and the least gap, without limit analysis."""
    assembly = assemble(scene)
    settled, gap = dem_effects.decide_dem_effects(scene, assembly, joint_stiffness(assembly, scene.yade))
    return settled.effects, gap
