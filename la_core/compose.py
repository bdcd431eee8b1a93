"""Scenes made in code: from tables with the keys of a scene file, or from another scene with some of its keys changed.

Both write the scene as TOML and read it like a file, so that one schema speaks about all scenes and results can be stored and cached.
"""

import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from la_core.errors import SceneError, nearest
from la_core.scene import Scene, scene_of_text

LONGEST_NAME = 80  # characters of a name made from changes: it becomes a folder's


def build(tables: Mapping[str, Any], name: str = "scene", folder: Path | str = ".") -> Scene:
    """A scene from tables with the keys of a scene file; raises SceneError as for a file.

    tables: as `tomllib` would read them, arrays (NumPy's, too) and tuples for lists. name: of the scene and of its folder of results.
    folder: what the files of [[mesh]] tables are relative to.

    >>> import la_core
    >>> pad = {"name": "pad", "role": "support", "box": {"from": [0, 0, -1], "to": [1, 1, 0]}}
    >>> block = {"name": "block", "density": 2000, "box": {"from": [0, 0, 0], "to": [1, 1, 1]}}
    >>> motion = {"direction": [0, 0, -1]}
    >>> la_core.build({"joint": {"friction": 0.6}, "block": [pad, block], "settlement": motion}).weight
    19620.0
    """
    return scene_of_text(tomli_w.dumps(_plain(dict(tables), "")), Path(folder) / f"{name}.toml", name)


def variant(scene: Scene, changes: Mapping[str, Any], name: str = "") -> Scene:
    """The scene with some keys changed; raises SceneError for a key that leads nowhere and for what the schema refuses.

    changes: new values by dotted key, such as "joint.friction"; None takes a key or a table away. In an array of tables the next step
    is an entry's name ("block.pad.density"), its number from 1 on ("wall.2.courses"), or nothing where there is one ("wall.courses").
    What the original scene expects is left out unless changed, too. name: made from the changes where none is given.

    >>> import la_core
    >>> smooth = la_core.variant(la_core.load("wall_third"), {"joint.friction": 0.4})
    >>> smooth.name, smooth.friction
    ('wall_third_joint.friction=0.4', 0.4)
    """
    tables = tomllib.loads(scene.text)
    if not any(key.split(".")[0] == "expected" for key in changes):
        tables.pop("expected", None)
    for key, value in changes.items():
        _change(tables, key, value)
    own = name or f"{scene.name}_{name_of(changes)}"[:LONGEST_NAME]
    return build(tables, own, scene.path.parent)


def name_of(changes: Mapping[str, Any]) -> str:
    """Changes in one word that can name a folder."""
    return "_".join(re.sub(r"[^\w.+=-]+", "-", f"{key}={value}").strip("-") for key, value in changes.items())


def _change(tables: dict[str, Any], key: str, value: Any) -> None:
    """Set one dotted key, with new tables on the way where there are none."""
    steps, place = key.split("."), tables
    while len(steps) > 1:
        below = place.setdefault(steps.pop(0), {})
        if isinstance(below, list) and below and all(isinstance(entry, dict) for entry in below):
            below = _entry(below, steps, key)
        if not isinstance(below, dict):
            raise SceneError(key, "leads through a value that is no table")
        place = below
    if value is None:
        place.pop(steps[0], None)
    else:
        place[steps[0]] = value


def _entry(entries: list[dict[str, Any]], steps: list[str], key: str) -> dict[str, Any]:
    """The entry of an array of tables that the first of the `steps` means, which is taken from them unless there is but one entry."""
    known = {str(number): entry for number, entry in enumerate(entries, 1)} | {entry["name"]: entry for entry in entries if "name" in entry}
    if steps[0] in known and len(steps) > 1:
        return known[steps.pop(0)]
    if len(entries) == 1:
        return entries[0]
    names = [entry.get("name", str(number)) for number, entry in enumerate(entries, 1)]
    raise SceneError(key, "does not say which entry of several, and which of its keys", hint=nearest(steps[0], names, "entries"))


def _plain(value: Any, key: str) -> Any:
    """A value in the types of TOML; raises SceneError for one that has none."""
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist(), key)
    if isinstance(value, Mapping):
        return {str(name): _plain(item, f"{key}.{name}".removeprefix(".")) for name, item in value.items()}
    if isinstance(value, str | bool | int | float):
        return value
    if isinstance(value, Sequence):
        return [_plain(item, f"{key}[{number}]") for number, item in enumerate(value, 1)]
    raise SceneError(key, f"a {type(value).__name__} has no place in a scene", hint="leave out a key that has no value")
