"""Dotted paths into a scene's TOML, such as joint.friction or wall[0].opening[1].from[0]; [0] is the first entry."""

import re
from itertools import pairwise
from typing import Any

from la_core.errors import SceneError

_STEP = re.compile(r"([A-Za-z_][A-Za-z0-9_-]*)((?:\[\d{1,6}\])*)")


def steps(key: str) -> list[str | int]:
    """Names and indices along a dotted path; raises SceneError for an invalid path."""
    if not isinstance(key, str):
        raise SceneError(repr(key), "a key must be a text")
    names_and_indices: list[str | int] = []
    for name in key.split("."):
        step = _STEP.fullmatch(name)
        if step is None:
            raise SceneError(f'"{key}"', "must be a dotted path into a scene, such as joint.friction or wall[0].courses")
        names_and_indices += [step[1], *(int(index) for index in re.findall(r"\d+", step[2]))]
    return names_and_indices


def get(data: Any, key: str) -> Any:
    """Value at a key of a scene's data, or None where the key does not exist."""
    for step in steps(key):
        is_there = step < len(data) if isinstance(data, list) and isinstance(step, int) else isinstance(data, dict) and step in data
        if not is_there:
            return None
        data = data[step]
    return data


def put(data: dict[str, Any], key: str, value: Any) -> None:
    """Set a key of a scene's data, in place; a value of None removes the key.

    Missing tables on the way are created. Raises SceneError for a path that does not fit the data.
    """
    *way, last = steps(key)
    place: Any = data
    walked = ""
    for step, following in pairwise([*way, last]):
        _require(place, step, walked, key)
        if isinstance(step, str) and step not in place:
            if isinstance(following, int):
                raise SceneError(f'"{key}"', f"the scene has no {_joined(walked, step)}; set that array as a whole")
            place[step] = {}
        place, walked = place[step], _joined(walked, step)
    _require(place, last, walked, key)
    if value is None and isinstance(last, int):
        raise SceneError(f'"{key}"', "an entry of an array cannot be deleted", hint=f"set {walked} as a whole, without that entry")
    if value is None:
        place.pop(last, None)
    else:
        place[last] = value


def _joined(walked: str, step: str | int) -> str:
    return f"{walked}[{step}]" if isinstance(step, int) else f"{walked}.{step}".lstrip(".")


def _require(place: Any, step: str | int, walked: str, key: str) -> None:
    """Raise SceneError where a step does not fit its place in a scene's data."""
    if isinstance(step, int):
        if not isinstance(place, list):
            raise SceneError(f'"{key}"', f"{walked} is not an array")
        if step >= len(place):
            raise SceneError(f'"{key}"', f"{walked} has {len(place)} {'entry' if len(place) == 1 else 'entries'}; [0] is the first")
    elif isinstance(place, list):
        raise SceneError(f'"{key}"', f"{walked} is an array", hint=f"select one of its entries: {walked}[0].{step}")
    elif not isinstance(place, dict):
        raise SceneError(f'"{key}"', f"{walked} is a value, not a table", value=place)
