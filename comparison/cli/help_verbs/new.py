"""`crosscheck new`: write a commented scene to start from."""

from pathlib import Path

from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from comparison.cli.tables import new_table, plain
from la_core.errors import SceneError
from la_core.scene import starter_names, starter_purpose, starter_text


def execute(context: Context) -> int:
    """Write the scene of a kind to a file, or list the kinds; a file that exists is never replaced."""
    options = context.options
    if options.kind is None:
        return _list(context)
    text, path = starter_text(options.kind), options.output or Path(f"{options.kind}.toml")
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError as error:
        raise SceneError(str(path), "exists already and is not replaced", hint="name another file with -o") from error
    if options.json:
        context.print_json({"kind": options.kind, "file": str(path)})
    else:
        context.out.print(f"written: {path}", markup=False)
        context.narrator.print(f"next: `crosscheck show {path}` draws it, `crosscheck solve {path}` solves it", markup=False)
    return AGREE


def _list(context: Context) -> int:
    """Print every kind with what its scene shows."""
    kinds = {kind: starter_purpose(kind) for kind in starter_names()}
    if context.options.json:
        context.print_json({"kinds": kinds})
        return AGREE
    table = new_table("kind", "what it shows")
    for kind, purpose in kinds.items():
        table.add_row(kind, plain(purpose))
    context.out.print(table)
    return AGREE
