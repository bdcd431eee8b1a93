"""`crosscheck new --from FILE`: write a commented scene for a drawing or a file of bodies."""

from pathlib import Path

from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from la_core.errors import SceneError
from la_core.scene import load_scene, scene_from_file


def execute(context: Context) -> int:
    """Write the scene; a file that exists is never replaced. Raises SceneError."""
    return write_from(context, context.options.source)


def write_from(context: Context, source: Path) -> int:
    """Write a scene for a file beside it, and say whether it can be read."""
    path = context.options.output or source.with_suffix(".toml")
    text = scene_from_file(source, path.parent)
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError as error:
        raise SceneError(str(path), "exists already and is not replaced", hint="name another file with -o") from error
    if context.options.json:
        context.print_json({"kind": "from file", "file": str(path)})
    else:
        context.out.print(f"written: {path}", markup=False)
    try:
        blocks = len(load_scene(path).blocks)
    except SceneError as error:
        context.narrator.print(f"it must be corrected before it can be read: {error}", markup=False)
    else:
        context.narrator.print(f"{blocks} blocks; check the lines marked CHECK, then `crosscheck show {path}` draws it", markup=False)
    return AGREE
