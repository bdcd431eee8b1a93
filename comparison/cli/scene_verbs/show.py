"""`crosscheck show`: draw a scene and list its counts and effects."""

from pathlib import Path

from comparison.cli import tables
from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from comparison.figures import assembly_figure, save
from la_core.analysis import decided_model
from la_core.errors import SceneError
from la_core.model import unjoined
from la_core.scene import load_scene, shipped


def execute(context: Context) -> int:
    """Draw a scene and print its facts; raises SceneError, after drawing what is wrong where that has a place."""
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
    facts = tables.scene_facts(scene, decided)
    if options.json:
        context.print_json(facts | {"figure": str(figure)})
    else:
        context.out.print(tables.facts_table(scene.title, facts))
        if facts["geometry"] is not None:
            context.out.print(tables.changes_table(facts["geometry"]))
        context.out.print(tables.effects_table(facts["effects"], options.long))
        context.narrator.print(f"drawn in {figure}", markup=False)
    return AGREE
