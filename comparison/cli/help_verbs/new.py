"""`crosscheck new`: write a commented scene to start from, of a kind of structure or for a drawing or a file of bodies."""

import shlex
from pathlib import Path

from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from comparison.cli.tables import new_table, plain
from la_core.errors import SceneError
from la_core.exchange import write_whole
from la_core.scene import load_scene, scene_from_file, starter_names, starter_purpose, starter_text


def execute(context: Context) -> int:
    """Write the scene, or list the kinds where neither a kind nor a file is named; a file that exists is never replaced."""
    options = context.options
    if options.source is not None:
        return write_from(context, options.source)
    if options.kind is None:
        return _list(context)
    path = options.output or Path(f"{options.kind}.toml")
    _write(context, options.kind, starter_text(options.kind), path)
    typed = _typed(path)
    context.narrator.print(f"next: `crosscheck show {typed}` draws it, `crosscheck solve {typed}` solves it", markup=False)
    return AGREE


def write_from(context: Context, source: Path) -> int:
    """Write a scene for a file beside it, and say whether it can be read."""
    named = source if source.name.strip(".") else source.resolve()  # "." and ".." have no name of their own
    if not named.name:
        raise SceneError(str(source), "has no name, and no folder beside it for a scene", hint="name the file or folder of the bodies")
    path = context.options.output or named.with_suffix(".toml")
    _write(context, "from file", scene_from_file(source, path.parent), path)
    try:
        blocks = len(load_scene(path).blocks)
    except SceneError as error:
        context.narrator.print(f"it must be corrected before it can be read: {error}", markup=False)
    else:
        context.narrator.print(
            f"{blocks} blocks; check the lines marked CHECK, then `crosscheck show {_typed(path)}` draws it", markup=False
        )
    return AGREE


def _typed(path: Path) -> str:
    """Return a path as a user types it after a command: quoted where it needs quotes, and never like an option."""
    return shlex.quote(f"./{path}" if str(path).startswith("-") else str(path))


def _write(context: Context, kind: str, text: str, path: Path) -> None:
    try:
        path.touch(exist_ok=False)
    except FileExistsError as error:
        raise SceneError(str(path), "exists already and is not replaced", hint="name another file with -o") from error
    try:
        write_whole(path, text.encode())
    except BaseException:  # a full disk leaves an empty file, which the next call would refuse to replace
        path.unlink(missing_ok=True)
        raise
    if context.options.json:
        context.print_json({"kind": kind, "file": str(path)})
    else:
        context.out.print(f"written: {path}", markup=False)


def _list(context: Context) -> int:
    """Print every kind with the purpose of its scene."""
    kinds = {kind: starter_purpose(kind) for kind in starter_names()}
    if context.options.json:
        context.print_json({"kinds": kinds})
        return AGREE
    table = new_table("kind", "what it shows")
    for kind, purpose in kinds.items():
        table.add_row(kind, plain(purpose))
    context.table(table)
    return AGREE
