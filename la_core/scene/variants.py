"""Scenes made in code: from tables with the keys of a scene file, or from another scene with some of its keys changed.

Both ways write the scene as TOML and read it like a file, so that one schema checks all scenes and their results can be
stored.
"""

import copy
import datetime
import hashlib
import re
import sys
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pydantic
import tomli_w

from la_core.errors import SceneError, path_of
from la_core.exchange import SHARED_SETTINGS
from la_core.scene import key_paths
from la_core.scene.scene import Scene, scene_of_text
from la_core.scene.schema.scene_file import Expected, SceneFile
from la_core.scene.shipped import load
from la_core.scene.validation import as_scene_error

# A change of these keys, or of settings in [yade] that limit analysis does not read, keeps the expected values.
KEEP_EXPECTED = ("title", "project", "author", "date", "source", "accuracy", "effort", "expected")
ASSOCIATED = ("associated_reaction_over_weight", "associated_multiplier")  # expected values that nearly every change makes wrong
LONGEST_NAME = 80  # characters of a name made from changes; it names a folder
DEEPEST = 20  # tables and arrays within each other: a scene needs eight
LONGEST_TITLE = 120  # characters of a title made from changes
EVERY_EFFECT = {"plane": False, "friction": "coulomb", "reach": False, "displacement": "finite", "recording": "states"}
FULL_SUFFIX = "_full"


def build(tables: Mapping[str, Any], name: str = "scene", folder: Path | str = ".") -> Scene:
    """Build a scene from tables with the keys of a scene file.

    Parameters
    ----------
    tables : mapping of str to Any
        Tables as `tomllib` reads them from a file; SI units. NumPy arrays and tuples may replace lists.
    name : str
        Name of the scene and of its folder of results.
    folder : Path or str
        Folder to which the file names of [[mesh]] and [[drawing]] tables are relative.

    Returns
    -------
    Scene
        Validated scene. Its path is `folder/name.toml`; no file is written.

    Raises
    ------
    SceneError
        A key or a value breaks a rule of the schema, as in a file.

    Examples
    --------
    >>> import la_core
    >>> pad = {"name": "pad", "role": "support", "box": {"from": [0, 0, -1], "to": [1, 1, 0]}}
    >>> block = {"name": "block", "density": 2000, "box": {"from": [0, 0, 0], "to": [1, 1, 1]}}
    >>> motion = {"direction": [0, 0, -1]}
    >>> la_core.build({"joint": {"friction": 0.6}, "block": [pad, block], "settlement": motion}).weight
    19620.0
    """
    if not isinstance(tables, Mapping):
        raise SceneError("tables", "must be a table", value=tables)
    place = path_of("folder", folder)
    return _built(_plain(dict(tables), ""), name, place)


def variant(scene: Scene | Path | str, changes: Mapping[str, Any], name: str = "") -> Scene:
    """Copy a scene with some of its keys changed.

    Parameters
    ----------
    scene : Scene, Path or str
        Original scene, which stays as it is; path of its file, or name of a shipped scene.
    changes : mapping of str to Any
        New values by dotted key, such as "joint.friction" or "wall[0].courses". None deletes a key or a table.
    name : str
        Name of the new scene; "" makes a name from the changes.

    Returns
    -------
    Scene
        Changed scene.

    Raises
    ------
    SceneError
        A key does not exist, or a value breaks a rule of the schema.

    Notes
    -----
    The changes are appended to the title, unless `changes` has a title. `source` and [expected] belong to the original scene. They are
    deleted, unless `changes` gives new ones, or affects only the title, project, author, date, `accuracy`, `effort` and settings in [yade]
    that do not change limit analysis. A change of [expected] alone keeps the source and the other expected values. Otherwise a new expected
    value keeps the others, except those by the associated flow rule: each of these is deleted unless `changes` names it, too.

    Examples
    --------
    >>> import la_core
    >>> smooth = la_core.variant("wall_third", {"joint.friction": 0.4})
    >>> smooth.name, smooth.friction
    ('wall_third,joint.friction=0.4', 0.4)
    """
    scene = load(scene)
    if not isinstance(changes, Mapping):
        raise SceneError("changes", 'must be a table such as {"joint.friction": 0.3}', value=changes)
    tables = tomllib.loads(scene.text)
    plain = {key: None if value is None else _plain(value, str(key)) for key, value in changes.items()}
    name = name or _shortened(",".join([scene.name, *(_name_of(key, value) for key, value in plain.items())]))
    override(tables, plain, f"variant of {scene.name}")
    if changes and "title" not in changes:
        tables["title"] = ": ".join([scene.title, ", ".join(f"{key} = {value}" for key, value in plain.items())])[:LONGEST_TITLE]
    return _built(tables, name, scene.path.parent, f"variant of {scene.name}")


def same_structure(scene: Scene, changes: Mapping[str, Any], name: str) -> Scene:
    """The scene with changed keys that do not affect its structure; its title and its expected values stay.

    Parameters and errors are those of `variant`, but `name` is required.
    """
    tables = tomllib.loads(scene.text)
    for key, value in changes.items():
        key_paths.put(tables, key, _plain(value, str(key)))
    return _built(tables, name, scene.path.parent, f"variant of {scene.name}")


def full_model(scene: Scene) -> Scene:
    """The scene with every effect modelled, and with FULL_SUFFIX in its name.

    A requested associated or no-sliding law stays. The requested `rotation` stays, too, because it decides for which
    settlements the answer holds.
    """
    law, rotation = scene.effects.friction, scene.effects.rotation
    effects = EVERY_EFFECT | {"rotation": rotation} | ({"friction": law} if law in ("associated", "none-slides") else {})
    return same_structure(scene, {"effects": effects}, f"{scene.name}{FULL_SUFFIX}")


def _built(tables: dict[str, Any], name: str, folder: Path, where: str = "") -> Scene:
    """A scene from plain tables; messages name `where`, or else its file. Its path is absolute: the working directory may change."""
    if not isinstance(name, str):
        raise SceneError("name", "must be a text", value=name)
    made = scene_of_text(tomli_w.dumps(tables), folder / f"{name}.toml", name, where=where)
    return replace(made, path=made.path.absolute())


def override(tables: dict[str, Any], changes: Mapping[str, Any], where: Path | str) -> dict[str, Any]:
    """Set several keys of a scene's tables, in place, and return all tables with the schema's defaults.

    Source and expected values belong to one structure. Both are removed where its answer by limit analysis may change, unless `changes`
    names them. A change of one expected value keeps the others, except those by the associated flow rule: each of these is removed
    unless `changes` names it, too.

    Parameters
    ----------
    tables : dict
        Tables as read from TOML.
    changes : mapping
        New value by dotted key; None removes the key.
    where : Path or str
        Name of the scene in messages: its file, or words for a scene without a file.
    """
    _refuse_overwritten(list(changes))
    before = _whole(tables, where)
    for key, value in changes.items():
        key_paths.put(tables, key, copy.deepcopy(value))
    whole = _whole(tables, where)
    if _deciding(before) == _deciding(whole):
        return whole
    if "source" not in changes and whole["source"]:
        del tables["source"]
        whole["source"] = ""
    if "expected" in changes or whole["expected"] is None:
        return whole
    named = [key.removeprefix("expected.") for key in changes if key.startswith("expected.")]
    if not set(named) & set(Expected.values()):
        del tables["expected"]
        whole["expected"] = None
        return whole
    for name in ASSOCIATED:
        if name not in named:
            tables["expected"].pop(name, None)
            whole["expected"][name] = None
    return whole


def _deciding(whole: dict[str, Any]) -> dict[str, Any]:
    """The tables and settings that decide the answer of limit analysis, and so the validity of source and expected values."""
    shared = {name: value for name, value in whole["yade"].items() if name in SHARED_SETTINGS}
    return {table: content for table, content in whole.items() if table not in KEEP_EXPECTED} | {"yade": shared}


def _refuse_overwritten(keys: list[str]) -> None:
    """Raise SceneError for a key whose table a later key sets as a whole: its value would be lost silently."""
    paths = [key_paths.steps(key) for key in keys]
    for later, path in enumerate(paths):
        for earlier, part in enumerate(paths[:later]):
            if len(path) < len(part) and part[: len(path)] == path:
                rule = f'is a part of "{keys[later]}", which is set after it as a whole'
                raise SceneError(f'"{keys[earlier]}"', rule, hint=f'write it within "{keys[later]}"')


def _whole(tables: dict[str, Any], where: Path | str) -> dict[str, Any]:
    try:
        return SceneFile.model_validate(tables).model_dump(by_alias=True, mode="json")
    except pydantic.ValidationError as error:
        raise SceneError(str(where), str(as_scene_error(error, tables, SceneFile))) from error


def _name_of(key: str, value: Any) -> str:
    """A change as part of a folder's name; a digest distinguishes values that such a name cannot show."""
    is_row = isinstance(value, list) and all(isinstance(item, int | float) for item in value)
    words = f"{key}={'_'.join(map(str, value)) if is_row else value}"
    safe = re.sub(r"[^\w.+=-]", "", words)
    shows = is_row or value is None or isinstance(value, int | float) or (isinstance(value, str) and str(value) in safe)
    return safe if shows else f"{safe}-{_digest(repr(value))}"


def _shortened(name: str) -> str:
    """A name of at most LONGEST_NAME characters; a digest distinguishes long names."""
    return name if len(name) <= LONGEST_NAME else f"{name[: LONGEST_NAME - 9]}-{_digest(name)}"


def _digest(text: str) -> str:
    """The first eight hexadecimal digits of a text's SHA-256."""
    return hashlib.sha256(text.encode()).hexdigest()[:8]


def _plain(value: Any, key: str) -> Any:
    """A value in the types of TOML; raises SceneError for a value that TOML cannot express."""
    if len(re.findall(r"[.\[]", key)) > DEEPEST:
        raise SceneError(re.split(r"[.\[]", key)[0], f"must be at most {DEEPEST} tables and arrays deep; it may contain itself")
    if isinstance(value, np.floating):  # `tolist` gives no Python number for np.longdouble
        return float(value)
    if isinstance(value, np.ndarray | np.generic) and not isinstance(value, np.complexfloating):
        return _plain(value.tolist(), key)
    if isinstance(value, Mapping):
        return {str(name): _plain(item, f"{key}.{name}".removeprefix(".")) for name, item in value.items()}
    if isinstance(value, int) and abs(value) > sys.float_info.max:
        raise SceneError(key, "has too many digits", value=value)
    if isinstance(value, str | bool | int | float | datetime.date | datetime.time):
        return value
    if isinstance(value, Sequence) and not isinstance(value, bytes | bytearray):
        return [_plain(item, f"{key}[{number}]") for number, item in enumerate(value)]
    hint = "leave out a key that has no value" if value is None else "give a number, a text, true or false, an array or a table"
    raise SceneError(key, f"a {type(value).__name__} has no place in a scene", hint=hint)
