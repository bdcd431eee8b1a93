"""Words for the allowed values and the default of a key of a JSON Schema, for tables of keys on pages and on the terminal."""

import json
from collections.abc import Callable
from typing import Any

from la_core.scene.schema.types import LARGEST

PEN = 100_000  # upper limits from here on only catch typing errors
NameOfTable = Callable[[str], str]  # from the name of a table in the schema to its name for readers


def value_words(entry: dict[str, Any], named: NameOfTable) -> str:
    """Allowed values of a key: the kind of value, its limits, or the words to choose from."""
    if "$ref" in entry or "allOf" in entry:
        return f"table {named((entry.get('$ref') or entry['allOf'][0]['$ref']).rsplit('/', 1)[1])}"
    if "anyOf" in entry:
        return " or ".join(dict.fromkeys(value_words(one, named) for one in entry["anyOf"] if one.get("type") != "null"))
    if "const" in entry or "enum" in entry:
        return ", ".join(f'`"{value}"`' for value in entry.get("enum", [entry.get("const")]))
    if entry["type"] == "array":
        return _entries(entry, named)
    if entry["type"] == "object":
        return "table"
    return {"string": "text", "boolean": "`true`, `false`"}.get(entry["type"], "") or _number(entry)


def default_words(entry: dict[str, Any]) -> str:
    """The default of a key; a dash where it has none."""
    value = entry.get("default")
    if value in (None, "", [], {}) or isinstance(value, dict):
        return "–"
    return f"`{json.dumps(value)}`"


def _entries(entry: dict[str, Any], named: NameOfTable) -> str:
    """Words for an array of a fixed number of values, or of any number of entries."""
    if "prefixItems" in entry:
        kinds = list(dict.fromkeys(value_words(one, named) for one in entry["prefixItems"]))
        assert len(kinds) == 1, "an array of different kinds has no words here"
        return f"{len(entry['prefixItems'])} {kinds[0].replace('number', 'numbers', 1)}"
    if "$ref" in entry["items"]:
        return f"tables {named(entry['items']['$ref'].rsplit('/', 1)[1])}"
    kind = value_words(entry["items"], named)
    return "tables" if kind == "table" else f"list of ({kind})" if kind[0].isdecimal() else f"list of {kind}"


def _number(entry: dict[str, Any]) -> str:
    """A number's kind and limits; limits that only catch typing errors are left out."""
    kind = "whole number" if entry["type"] == "integer" else "number"
    low, high = max(entry.get("minimum", -LARGEST), entry.get("ge", -LARGEST)), min(entry.get("maximum", LARGEST), entry.get("le", LARGEST))
    above, below = entry.get("exclusiveMinimum", -LARGEST), entry.get("exclusiveMaximum", LARGEST)
    least = f"> {above:g}" if above >= low and above > -LARGEST else f"≥ {low:g}" if low > -LARGEST else ""
    most = f"< {below:g}" if below <= high and below < LARGEST else f"≤ {high:g}" if high < PEN else ""
    return " ".join([kind, ", ".join(limit for limit in (least, most) if limit)]).strip()
