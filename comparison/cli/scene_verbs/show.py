"""`crosscheck show`: draw a scene and list its dimensions, counts, effects, and the time that a run takes."""

from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from comparison.cli import tables
from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from comparison.figures import assembly_figure, save
from comparison.judge import effects_summary
from comparison.numbers import class_words, plural
from comparison.report import stone_density
from comparison.studies import TimeEstimate, estimated_times
from la_core.analysis import DecidedModel, decided_model
from la_core.errors import SceneError
from la_core.model import unjoined
from la_core.scene import (
    Scene,
    classes_as_dicts,
    geometry_changes,
    joints_per_class,
    load_scene,
    loads_as_dicts,
    motions_as_dicts,
    shipped,
    ties_as_dicts,
)
from la_core.text_table import number_text

FACTS = ("weight", "free_blocks", "fixed_blocks", "support_blocks", "interfaces", "contact_points", "friction_coefficient", "inset")

# Settings of YADE that change its number of steps: the estimate of the time holds only where all of them follow from the structure.
PACE = {"speed", "travel_periods", "max_travel", "plateau_travel", "plateau_share", "ramp_time", "gravity_ramp", "gravity_time"}
PACE |= {"time_step", "settling_step", "time_step_share", "stiffening", "normal_stiffness", "shear_stiffness", "quick_speed", "added_mass"}


def execute(context: Context) -> int:
    """Draw a scene and print its facts; raises SceneError, after a drawing of the faults that have a place."""
    options = context.options
    scene = load_scene(shipped.find(options.scene))
    context.warn(scene)
    figure = options.output or Path(f"{scene.name}.png")
    try:
        decided = decided_model(scene)
    except SceneError as error:
        if error.spots:
            save(assembly_figure(scene, unjoined(scene), spots=error.spots), figure)
            context.narrator.print(f"drawn in {figure}, with a red cross at each place to correct", markup=False)
        raise
    save(assembly_figure(scene, decided.assembly), figure)
    facts = scene_facts(scene, decided)
    if options.json:
        context.print_json(facts | {"figure": str(figure)})
    else:
        context.table(facts_table(scene.title, facts))
        if facts["geometry"] is not None:
            context.table(tables.changes_table(facts["geometry"]))
        context.table(tables.effects_table(facts["effects"], options.long))
        context.narrator.print(f"drawn in {figure}", markup=False)
    return AGREE


def scene_facts(scene: Scene, decided: DecidedModel) -> dict[str, Any]:
    """Return counts, dimensions (m), densities (kg/m3), mass of floors (kg), weight (N), effects, and times of both methods (s)."""
    assembly, blocks = decided.assembly, scene.blocks
    roles = {name: int((blocks.role == code).sum()) for code, name in enumerate(("free", "fixed", "support"))}
    facts: dict[str, Any] = {"scene": scene.name, "warnings": list(scene.warnings), "weight": scene.weight}
    facts |= {f"{name}_blocks": count for name, count in roles.items()}
    facts |= {"interfaces": len(assembly.interfaces), "contact_points": len(assembly.points)}
    facts |= {"friction_coefficient": scene.friction, "inset": scene.inset}
    facts["dimensions"] = (blocks.high[blocks.free].max(axis=0) - blocks.low[blocks.free].min(axis=0)).tolist()
    facts["densities"] = np.unique(np.round(stone_density(scene)[blocks.free], 6)).tolist()
    facts["floor_mass"] = None if scene.floor_mass is None else float(scene.floor_mass.sum())
    counts = joints_per_class(scene.joint_classes, blocks, decided.whole.interfaces)
    facts["joint_classes"] = [one | {"interfaces": n} for one, n in zip(classes_as_dicts(scene.joint_classes), counts, strict=True)]
    facts["loads"], facts["ties"] = loads_as_dicts(scene.loads, scene.load_names), ties_as_dicts(scene.ties, blocks.names)
    facts["motion"] = None if scene.support_twist is None else scene.support_twist.tolist()
    facts["motions"] = [] if scene.own_twists is None else motions_as_dicts(scene.support_twists, blocks)
    facts["tilt"] = None if scene.tilt is None else scene.tilt.tolist()
    facts["own_pace"] = sorted(PACE & scene.yade.keys())
    times = estimated_times(len(assembly.points), not facts["own_pace"], assembly.effects.rotation == "finite")
    facts["estimated_seconds"] = {method: [time.least, time.greatest] for method, time in times.items()}
    facts["geometry"] = geometry_changes(scene, decided.whole.slivers, decided.whole.short_joints)
    return facts | {"effects": effects_summary(scene, decided.whole, assembly)}


def facts_table(title: str, facts: dict[str, Any]) -> Table:
    """Return a table of scene facts, one per row, without the effects and the warnings."""
    units = {"weight": "N", "inset": "m"}
    table = tables.new_table("what", "value", "unit", title=title)
    table.add_row("scene", tables.plain(facts["scene"]), "")
    table.add_row("dimensions (x, y, z)", " × ".join(number_text(length, 4) for length in facts["dimensions"]), "m")
    table.add_row("density", _several(facts["densities"]), "kg/m3")
    if facts["floor_mass"] is not None:
        table.add_row("mass of floors on the blocks", number_text(facts["floor_mass"]), "kg")
    for name in FACTS:
        value = facts[name]
        table.add_row(name.replace("_", " "), number_text(value) if isinstance(value, float) else str(value), units.get(name, ""))
    for load in facts["loads"]:
        across = ", ".join(number_text(part, 4) for part in load["force"])
        table.add_row(tables.plain(f"load {load['name']}, {plural(load['blocks'], 'block')}"), f"({across})", "N")
    for tie in facts["ties"]:
        table.add_row(tables.plain(f"tie {tie['name']}, {' to '.join(tie['between'])}"), number_text(tie["tension"], 4), "N")
    for joints in facts["joint_classes"]:
        count = plural(joints["interfaces"], "interface")
        table.add_row(tables.plain(f"friction of {class_words(joints)}, {count}"), number_text(joints["friction"], 4), "")
    for motion in facts["motions"]:
        across, names = ", ".join(number_text(part, 4) for part in motion["velocity"]), ", ".join(motion["names"])
        if any(facts["motion"][3:]):
            table.add_row(tables.plain(f"motion in the middle per rad of the rotation, {names}"), f"({across})", "m")
        else:
            table.add_row(tables.plain(f"share of the settlement, {names}"), f"({across})", "")
    if facts["tilt"] is not None:
        table.add_row("axis about which the ground tilts", f"({', '.join(number_text(part, 4) for part in facts['tilt'])})", "")
    for method, words in (("limit_analysis", "limit analysis takes"), ("yade", "YADE takes")):
        if method in facts["estimated_seconds"]:
            table.add_row(words, str(TimeEstimate(*facts["estimated_seconds"][method])), "roughly")
    if facts["own_pace"]:
        table.add_row("YADE takes", tables.plain(f"unknown: [yade] sets {', '.join(facts['own_pace'])}"), "")
    return table


def _several(values: list[float]) -> str:
    """Return one value, or the range of several."""
    return number_text(values[0]) if len(values) == 1 else f"{number_text(values[0])} to {number_text(values[-1])}"
