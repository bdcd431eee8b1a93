"""The schema of scene files as JSON Schema, which editors read: they complete keys, show meanings and mark mistakes."""

from typing import Any

from la_core.exchange import SETTINGS, json_rules
from la_core.scene.schema.scene_file import SceneFile

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def scene_schema() -> dict[str, Any]:
    """JSON Schema of a scene file: every table and key with its meaning, unit, default, limits and allowed words."""
    schema = SceneFile.model_json_schema()
    schema["properties"]["yade"] |= {
        "properties": {name: json_rules(name) for name in SETTINGS},
        "additionalProperties": False,
    }
    for table in (schema, schema["properties"]["yade"], *schema["$defs"].values()):
        for entry in table["properties"].values():
            if unit := entry.get("unit"):
                entry["description"] = f"{entry['description']} ({unit})"
    return {"$schema": DIALECT, **schema, "title": "Scene of Crosscheck Masonry"}


def part_of_schema(name: str) -> dict[str, Any] | None:
    """JSON Schema of one table of the scene file, such as "wall" or "opening"; None for a name that is no table.

    A table within a table is named by its key. Of two tables with the same key the first is returned.
    """
    schema = scene_schema()
    if name == "yade":  # its settings are in the schema itself, without a reference
        return dict(schema["properties"]["yade"])
    tables = [schema, *schema["$defs"].values()]
    entries = (table["properties"][name] for table in tables if name in table["properties"])
    reference = next((found for entry in entries if (found := _reference(entry)) is not None), None)
    return None if reference is None else schema["$defs"][reference.rsplit("/", 1)[1]]


def tables_of_schema() -> list[str]:
    """Keys of all tables of a scene file, each once, those at the top first."""
    schema = scene_schema()
    keys = [
        key
        for table in (schema, *schema["$defs"].values())
        for key, entry in table["properties"].items()
        if key == "yade" or _reference(entry) is not None
    ]
    return list(dict.fromkeys(keys))


def _reference(entry: dict[str, Any]) -> str | None:
    """Reference to the table that a key holds, alone or as the entries of an array; None where the key holds no table."""
    for part in (entry, *entry.get("anyOf", ()), *entry.get("allOf", ()), entry.get("items", {})):
        if "$ref" in part:
            return str(part["$ref"])
    return None
