"""`crosscheck schema`: print the schema of scene files for editors, or the keys of one table for readers."""

from collections.abc import Callable
from typing import Any

from rich.table import Table

from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from comparison.cli.tables import new_table, plain
from la_core.errors import SceneError, nearest
from la_core.exchange import setting_default
from la_core.scene import default_words, part_of_schema, scene_schema, tables_of_schema, value_words


def execute(context: Context) -> int:
    """Print the JSON Schema of scene files; for one table, print a list of its keys, or its schema with `--json`."""
    typed = context.options.table
    if typed is None:
        context.print_json(scene_schema())
        return AGREE
    name = typed.strip("[]")
    table = part_of_schema(name)
    if table is None:
        raise SceneError(f'"{typed}"', "no table of a scene file", hint=nearest(typed, tables_of_schema(), "tables"))
    if context.options.json:
        context.print_json(table)
    else:
        if "description" in table:
            context.tell(" ".join(table["description"].split()))
        context.table(keys_table(table, setting_default if name == "yade" else None))
    return AGREE


def keys_table(table: dict[str, Any], default_of: Callable[[str], str] | None = None) -> Table:
    """Return one row per key: its allowed values, its default and its meaning.

    default_of: the default of a key, where the schema does not have it.
    """
    shown = new_table("key", "value", "default", "meaning")
    for key, entry in table["properties"].items():
        value = value_words(entry, str.lower).replace("`", "")
        default = default_of(key) if default_of else "needed" if key in table.get("required", ()) else default_words(entry).strip("`")
        shown.add_row(*map(plain, (key, value, default, entry["description"])))
    return shown
