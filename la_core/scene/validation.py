"""Errors of pydantic as sentences with the key, the value and the rule."""

from typing import Any

import pydantic

from la_core.errors import SceneError, nearest


def as_scene_error(refused: pydantic.ValidationError, data: dict[str, Any], table: type[pydantic.BaseModel]) -> SceneError:
    """Turn the first error in a table's data into a SceneError with key path, value, rule and nearest key.

    Parameters
    ----------
    refused : ValidationError
        Error of pydantic.
    data : dict
        Table as read from TOML.
    table : class
        Schema of the table.
    """
    error: Any = min(refused.errors(), key=_says_least)
    path, value = _key_path(error["loc"], data), error["input"]
    if error["type"] == "extra_forbidden":
        *parents, key = error["loc"]
        return SceneError(path, "unknown key", hint=nearest(str(key), _valid_keys(table, parents)))
    if error["type"] == "missing" and isinstance(error["loc"][-1], int):
        return SceneError(_key_path(error["loc"][:-1], data), "has too few entries", value=value)
    if error["type"] == "missing":
        return SceneError(path, "missing", hint="no physical quantity has a silent default")
    if error["type"] == "value_error":
        return SceneError(path or "scene", str(error["ctx"]["error"]), value=None if isinstance(value, dict) else value)
    rule = _RULES.get(error["type"], error["msg"].replace("Input should", "must"))
    return SceneError(path, rule.format(**error.get("ctx", {})), value=value)


def _says_least(error: Any) -> tuple[bool, bool]:
    """Rank of an error, lowest first: an unknown key explains a missing one, and an integer is one of two allowed types."""
    return error["type"] != "extra_forbidden", error["loc"][-1:] == ("constrained-int",)


_RULES = {  # instead of pydantic's messages, which speak of Python
    "bool_type": "must be true or false",
    "dict_type": "must be a table",
    "finite_number": "must be a finite number",
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "model_type": "must be a table",
    "string_type": "must be text in quotes",
    "too_long": "has too many entries, {actual_length} where at most {max_length} belong",
    "too_short": "has too few entries, {actual_length} where at least {min_length} belong",
    "tuple_type": "must be an array",
}


def _key_path(location: tuple[Any, ...], data: Any) -> str:
    names: list[str] = []
    for step in location:
        try:
            data = data[step]
        except (KeyError, IndexError, TypeError):
            data = None
        if not isinstance(step, int):
            names.append(str(step))
        elif isinstance(data, dict) and isinstance(data.get("name"), str):
            names[-1] += f' "{data["name"]}"'
        else:
            names[-1] += f"[{step + 1}]"
    return ".".join(name for name in names if not name.startswith(("constrained-", "literal[", "tuple[", "bool")))


def _valid_keys(model: type[pydantic.BaseModel], parents: list[Any]) -> list[str]:
    """Keys of the table at the path `parents` below the table `model`."""
    for step in parents:
        if isinstance(step, int):
            continue
        field = next(f for name, f in model.model_fields.items() if step in (name, f.alias))
        model = table_of(field.annotation)
    return [field.alias or name for name, field in model.model_fields.items()]


def table_of(annotation: Any) -> Any:
    """The table class inside an annotation such as `tuple[Block, ...]` or `Stone | None`."""
    if isinstance(annotation, type) and issubclass(annotation, pydantic.BaseModel):
        return annotation
    members = (member for member in annotation.__args__ if member is not type(None))
    return next(table for member in members if (table := table_of(member)))
