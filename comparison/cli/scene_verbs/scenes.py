"""`crosscheck scenes`: list the shipped scenes."""

from comparison.cli import tables
from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from la_core.scene import Scene, load_scene, shipped


def execute(context: Context) -> int:
    """List the shipped scenes with their expected values."""
    scenes = [load_scene(shipped.place(name)) for name in shipped.names()]
    if context.options.json:
        context.print_json({"scenes": [_row(scene) for scene in scenes]})
    else:
        context.table(tables.scene_table(scenes, context.out.width, context.options.long))
    return AGREE


def _row(scene: Scene) -> dict[str, object]:
    expected = scene.expected.model_dump() if scene.expected else None
    return {"name": scene.name, "title": scene.title, "source": scene.source, "expected": expected}
