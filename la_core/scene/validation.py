"""Errors of pydantic as sentences with the line, the key, the value, the rule and the next step."""

import json
import math
import re
import types
from collections.abc import Iterator
from typing import Any, Literal, Union, get_args, get_origin

import pydantic

from la_core.errors import SceneError, nearest, shortened
from la_core.scene.line_numbers import KeyPath, key_lines, line_of

MOST_MESSAGES = 20  # shown for one file; further ones are counted
Fault = tuple[KeyPath, str]  # place in the file, and message

RANGE = re.compile(r"([-+]?\d*\.?\d+)\s*(?::|\.{2,3}|-|–|to)\s*([-+]?\d*\.?\d+)")  # a range of two numbers as text
_RULES = {  # in place of pydantic's messages, which use Python's terms
    "bool_type": "must be true or false",
    "dict_type": "must be a table",
    "finite_number": "must be a finite number",
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "model_type": "must be a table",
    "string_type": "must be text in quotes",
    "string_unicode": "must be text that a file can hold; this one has half of a character, a lone surrogate",
    "too_long": "has too many entries, {actual_length} where at most {max_length} belong",
    "too_short": "has too few entries, {actual_length} where at least {min_length} belong",
    "tuple_type": "must be an array",
}
_NOT_IN_A_SCENE = {  # keys that users try, each with its hint
    "cohesion": "joints have none: they are dry and open without force",
    "tension": "joints have none: they are dry and open without force; the tension of a rod stands in [[tie]]",
    "load": "dead loads stand in [[load]] tables of their own, ties in [[tie]]; [live] pushes in proportion to weight",
    "sweep": "this is a campaign, not a scene: `crosscheck campaign` runs it",
    "unit": "all numbers are in SI units: m, kg, N",
    "units": "all numbers are in SI units: m, kg, N",
}


def as_scene_error(refused: pydantic.ValidationError, data: dict[str, Any], table: type[pydantic.BaseModel], text: str = "") -> SceneError:
    """Turn the errors in a table's data into one SceneError, with the key path, the value, the rule and the next step of each error.

    Parameters
    ----------
    refused : ValidationError
        Error of pydantic.
    data : dict
        Table as read from TOML.
    table : class
        Schema of the table.
    text : str
        TOML text for line numbers in messages; "" gives none.
    """
    return joined(_faults(refused, data, table, explains=bool(text)), text)


def _faults(refused: pydantic.ValidationError, data: dict[str, Any], table: type[pydantic.BaseModel], explains: bool) -> list[Fault]:
    """One fault for each wrong key in a table's data. A key that is missing because it was misspelt is not named a second time.

    explains: whether valid keys are listed with their meaning, on lines of their own.
    """
    errors: list[Any] = sorted(refused.errors(), key=lambda error: error["loc"][-1:] == ("constrained-int",))
    meant = {_meant(error, table) for error in errors if error["type"] == "extra_forbidden"}
    by_place: dict[KeyPath, str] = {}
    told: set[str] = set()  # meanings of keys, each shown once
    for error in errors:
        place = tuple(step for step in error["loc"] if not _is_of_a_type(step))
        if error["type"] == "too_short" and len(error["input"]) >= error["ctx"]["min_length"]:
            continue  # pydantic counts the valid entries only, and reports each invalid entry by itself
        if error["type"] == "missing" and isinstance(place[-1], int):
            place = place[:-1]  # one fault for the array, and none where one of its entries is invalid
            if any(other["type"] != "missing" and other["loc"][: len(error["loc"]) - 1] == error["loc"][:-1] for other in errors):
                continue
        if error["type"] != "missing" or place not in meant:
            by_place.setdefault(place, str(_explained(error, data, table, told if explains else None)))
    return list(by_place.items())


def joined(faults: list[Fault], text: str) -> SceneError:
    """One error with the messages of all faults, in the order of their lines in the TOML `text`; "" gives no lines."""
    lines = key_lines(text) if text else {}
    numbered = sorted(((line_of(lines, place) or 0, message) for place, message in faults), key=lambda pair: pair[0])
    messages = [f"line {line}: {message}" if line else message for line, message in numbered]
    if len(messages) == 1:
        return SceneError.told(messages[0])
    left = len(messages) - MOST_MESSAGES
    shown = [*messages[:MOST_MESSAGES], *([f"and {left} more"] if left > 0 else ())]
    return SceneError.told("\n  ".join([f"{len(messages)} errors", *(message.replace("\n", "\n  ") for message in shown)]))


def _explained(error: Any, data: dict[str, Any], table: type[pydantic.BaseModel], told: set[str] | None) -> SceneError:
    """One error of pydantic as a SceneError. told: meanings of keys that were shown already; None lists no keys."""
    path, value = _key_path(error["loc"], data), error["input"]
    if error["type"] == "extra_forbidden":
        *parents, key = error["loc"]
        own = _table_at(table, parents)
        if refused := getattr(own, "refuses", {}).get(key):
            return SceneError(path, refused)
        return SceneError(path, "unknown key", hint=_valid_keys(str(key), own, told))
    if error["type"] == "missing" and isinstance(error["loc"][-1], int):
        return SceneError(_key_path(error["loc"][:-1], data), "has too few entries", value=value, hint=_wanted(table, error["loc"][:-1]))
    if error["type"] == "missing":
        wanted = _wanted(table, error["loc"])
        if told is not None and wanted in told:
            wanted = ""
        elif told is not None:
            told.add(wanted)
        return SceneError(path, "missing", hint=wanted)
    if error["type"] == "value_error":
        return SceneError(path or "scene", str(error["ctx"]["error"]), value=None if isinstance(value, dict) else value)
    rule = _RULES.get(error["type"], error["msg"].replace("Input should", "must"))
    if error["type"] == "float_type" and type(value) is int:
        rule = "has too many digits"
    if isinstance(value, str):
        rule = rule.replace("entries", "characters")
    hint = (_wanted(table, error["loc"]) or _as_array(value)) if error["type"] == "tuple_type" else _slip(error)
    hint = "; ".join(part for part in (hint, _brackets(error, table)) if part)
    return SceneError(path, rule.format(**error.get("ctx", {})), value=value, hint=hint)


def _brackets(error: Any, table: type[pydantic.BaseModel]) -> str:
    """Hint for a single table written as an array of tables, or the reverse; "" for any other error."""
    value, (*parents, key) = error["input"], error["loc"]
    field = _keys(_table_at(table, parents)).get(str(key))
    if field is None or table_of(field.annotation) is None:  # such as a vector or a list of names
        return ""
    name = ".".join(step for step in error["loc"] if isinstance(step, str))
    if error["type"] == "tuple_type" and isinstance(value, dict):
        return f"write it below [[{name}]] in double brackets, or as [{{ ... }}]"
    if error["type"] == "model_type" and isinstance(value, list) and value and isinstance(value[0], dict):
        return f"write it below [{name}] in single brackets, or as {{ ... }}"
    return ""


def _as_array(value: Any) -> str:
    """Hint with the array to write in place of a single value or of a range in words; "" for any other value."""
    if isinstance(value, str) and (ends := RANGE.fullmatch(value.strip())):
        return f"list all values: [{ends[1]}, ..., {ends[2]}], with numbers in place of the dots"
    is_single = isinstance(value, str) or (isinstance(value, int | float) and math.isfinite(value))
    return f"write [{json.dumps(value)}]" if is_single else ""


def _slip(error: Any) -> str:
    """Hint on the probable meaning of a value of a wrong type; "" where none is known."""
    value = error["input"]
    if error["type"] == "too_long" and isinstance(value, list) and len(value) == 2 * error["ctx"]["max_length"]:
        return "a decimal comma makes two numbers of one, so write 0.6 instead of 0,6"
    if error["type"] not in ("float_type", "int_type") or not isinstance(value, str):
        return ""
    number = re.match(r"\s*([-+]?\d+(?:[.,]\d+)?)(.*)", value, re.DOTALL)
    if number is None:
        return ""
    plain, unit = number[1].replace(",", "."), number[2].strip()
    if error["loc"][-1] == "friction" and unit.startswith(("deg", "°")):
        return f"the friction of {plain} degrees is the tangent of this angle, {math.tan(math.radians(float(plain))):.3f}"
    alone = "write the number alone, without quotes"
    if unit.startswith("%"):
        return f"{alone}, as a share of one: {float(plain) / 100.0:g} for {plain} %"
    return f"{alone} and unit: {plain}; all numbers are in SI units (m, kg, N, s)" if unit else f"{alone}: {plain}"


def _is_of_a_type(step: str | int) -> bool:
    """Whether a step of pydantic's location names one of several allowed types, and no key."""
    return isinstance(step, str) and step.startswith(("constrained-", "literal[", "tuple[", "bool"))


def _key_path(location: tuple[Any, ...], data: Any) -> str:
    names: list[str] = []
    for step in location:
        try:
            data = data[step]
        except (KeyError, IndexError, TypeError):
            data = None
        if not isinstance(step, int):
            names.append(shortened(str(step)))
        elif isinstance(data, dict) and isinstance(data.get("name"), str):
            names[-1] += f' "{shortened(data["name"])}"'
        else:
            names[-1] += f"[{step}]"
    return ".".join(name for name in names if not _is_of_a_type(name))


def _meant(error: Any, table: type[pydantic.BaseModel]) -> KeyPath:
    """Place of the valid key nearest to an unknown key; place of the unknown key itself where no valid key is near."""
    *parents, key = error["loc"]
    hint = re.fullmatch(r'did you mean "(.*)"\?', nearest(str(key), _keys(_table_at(table, parents))))
    return (*parents, hint[1] if hint else key)


def _valid_keys(key: str, table: type[pydantic.BaseModel], told: set[str] | None) -> str:
    """Hint for an unknown key: the nearest valid key, or all valid keys. A list not in `told` gives each key a line with its meaning."""
    if key in _NOT_IN_A_SCENE:
        return _NOT_IN_A_SCENE[key]
    keys = _keys(table)
    hint = nearest(key, keys)
    if told is None or hint in told or not hint.startswith("valid keys"):
        return hint
    told.add(hint)
    width = max(map(len, keys))
    return "\n  ".join([hint, *(f"{name:{width}}  {_meaning(field)}" for name, field in keys.items())])


def _keys(table: type[pydantic.BaseModel]) -> dict[str, Any]:
    """Fields of a table by their keys in a file."""
    return {field.alias or name: field for name, field in table.model_fields.items()}


def _meaning(field: Any) -> str:
    extra = field.json_schema_extra
    unit = extra.get("unit", "") if isinstance(extra, dict) else ""
    return f"{field.description or ''}{f' ({unit})' if unit else ''}"


def _wanted(table: type[pydantic.BaseModel], location: tuple[Any, ...]) -> str:
    """Hint for a missing key: the words to choose from, and its meaning."""
    *parents, key = location
    if isinstance(key, int):  # an entry of an array has the hint of the array
        return _wanted(table, tuple(parents))
    field = _keys(_table_at(table, parents)).get(str(key))
    if field is None:
        return ""
    choices = " or ".join(f'"{word}"' for word in _words(field.annotation))
    return ": ".join(part for part in (f"choose {choices}" if choices else "needed", _meaning(field)) if part)


def _words(annotation: Any) -> Iterator[str]:
    """The words that are valid values of a key."""
    if get_origin(annotation) is Literal:
        yield from (word for word in get_args(annotation) if isinstance(word, str))
    elif get_origin(annotation) in (Union, types.UnionType):
        for member in get_args(annotation):
            yield from _words(member)


def _table_at(table: type[pydantic.BaseModel], parents: list[Any]) -> type[pydantic.BaseModel]:
    """The table at the path `parents` below `table`."""
    for step in parents:
        if not isinstance(step, int):
            field = _keys(table).get(step)
            table = (field and table_of(field.annotation)) or pydantic.BaseModel  # a table of free keys has no class
    return table


def table_of(annotation: Any) -> Any:
    """The table class inside an annotation such as `tuple[Block, ...]` or `Stone | None`; None without one, as in `dict[str, Any]`."""
    if isinstance(annotation, type) and issubclass(annotation, pydantic.BaseModel):
        return annotation
    return next((table for member in get_args(annotation) if (table := table_of(member))), None)
