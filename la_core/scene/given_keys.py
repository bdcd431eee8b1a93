"""Every key that a scene file gives, with its value, unit and meaning, for reports and for people without the program."""

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import pydantic

from la_core.exchange import setting_unit
from la_core.scene.schema.scene_file import SceneFile
from la_core.scene.validation import table_of

MOST_BLOCKS = 8  # [[block]] tables that are listed key by key; for more tables, only their number is listed


@dataclass(frozen=True)
class GivenKey:
    """One key of a scene file.

    Attributes
    ----------
    key : str
        Path of the key, as campaigns and `la_core.variant` take it: wall[0].courses.
    value : str
        Value as text.
    unit, meaning : str
        Unit and meaning by the schema, "" where it has none.
    """

    key: str
    value: str
    unit: str
    meaning: str


def given_keys(text: str) -> list[GivenKey]:
    """Return the keys of the TOML text of a valid scene, in their order."""
    return list(_keys(tomllib.loads(text), SceneFile, ""))


def _keys(data: dict[str, Any], table: type[pydantic.BaseModel], path: str) -> Iterator[GivenKey]:
    fields = {field.alias or name: field for name, field in table.model_fields.items()}
    for name, value in data.items():
        field = fields.get(name)
        if field is None:  # a key of another version
            yield GivenKey(f"{path}{name}", _value_text(value), "", "")
            continue
        extra = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
        meaning, unit = field.description or "", str(extra.get("unit", ""))
        if "per" in fields and " or " in unit:  # a load: for each block, metre or square metre
            unit = unit.replace(" or ", ", ").split(", ")[("block", "m", "m2").index(data.get("per", "block"))]
        key = f"{path}{name}"
        tables = value if isinstance(value, list) and value and isinstance(value[0], dict) else [value]
        if not isinstance(tables[0], dict):
            yield GivenKey(key, _value_text(value), unit, meaning)
        elif name == "block" and len(tables) > MOST_BLOCKS:
            yield GivenKey(key, f"{len(tables)} blocks", "", meaning)
        elif name == "yade":
            turns = "axis" in (data.get("settlement") or {})
            for setting, number in value.items():
                yield GivenKey(f"{key}.{setting}", _value_text(number), setting_unit(setting, turns), meaning)
        else:
            for place, entry in enumerate(tables):
                inner = f"{key}[{place}]" if isinstance(value, list) else key
                yield from _keys(entry, table_of(field.annotation), f"{inner}.")


def _value_text(value: Any) -> str:
    """Return a value as a scene file spells it, without quotes."""
    if isinstance(value, list):
        return f"[{', '.join(map(_value_text, value))}]"
    return str(value).lower() if isinstance(value, bool) else str(value)
