"""From a campaign's definition to its cases: each a scene with values of its own, under a name that is safe as a file's."""

import dataclasses
import hashlib
import json
import re
import tomllib
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomli_w

from comparison.campaign.definition import Definition, Sweep
from comparison.campaign.parameter_labels import CLASSIC
from la_core.analysis import structural_model
from la_core.errors import SceneError, nearest
from la_core.limit import ClassicParameters
from la_core.scene import Scene, key_paths, load_scene, override, scene_of_text, shipped

LONGEST = 120  # characters of a case's name
_CLASSIC_RULE = "needs relaxation in (0, 1], slope from 0, iterations from 1, and cohesion from 0 and below tolerance"
_UNSAFE = re.compile(r"[^\w.+=-]", re.ASCII)


@dataclass(frozen=True)
class CaseRun:
    """One scene to take through both methods, in a folder of its own: what cases share that differ in the classic iteration alone.

    path: of the scene it is made from, beside which its meshes lie. meshes: their paths and digests.
    """

    name: str
    scene_name: str
    path: Path
    text: str
    meshes: tuple[str, ...]

    def scene(self) -> Scene:
        """The scene; raises SceneError for anything wrong in it."""
        return scene_of_text(self.text, self.path, self.scene_name)


@dataclass(frozen=True)
class Case:
    """One row of the campaign's tables. values: of every varied key that its scene knows, None for the others."""

    name: str
    sweep: str
    run: CaseRun
    values: dict[str, Any]
    classic: ClassicParameters | None


def expand(definition: Definition) -> list[Case]:
    """All cases in order, equal ones of a sweep once; raises SceneError, which names campaign and case, for any whose scene is wrong."""
    labels = _labels(definition)
    runs: dict[tuple[Path, str], CaseRun] = {}
    found: dict[tuple[str, CaseRun, ClassicParameters | None], Case] = {}
    names, folders, sweeps = _Names(), _Names(), _Names()
    for sweep in definition.file.sweep:
        path, original = _scene_of(definition, sweep)
        stem = _stem(sweep.name or path.stem)
        title = sweeps.unique(stem)
        for values in sweep.combinations():
            parts = _parts(sweep, values, labels)
            name = "_".join([stem, *parts.values()])
            own = [part for key, part in parts.items() if not key.startswith(CLASSIC)]
            try:
                data, whole = _overridden(path, original, {**sweep.set, **values})
                parameters = _classic({**sweep.set, **values})
                identity = (path.resolve(), json.dumps(whole))
                if identity not in runs:
                    text = _titled(data, path.stem, own) if data != tomllib.loads(original) else original
                    runs[identity] = _run(folders.unique("_".join([stem, *own])), path, text)
                run = runs[identity]
                if (title, run, parameters) not in found:
                    of_keys = _values(whole, parameters, definition.keys)
                    found[title, run, parameters] = Case(names.unique(name), title, run, of_keys, parameters)
            except SceneError as error:
                raise SceneError(f"{definition.path}: case {name}", str(error)) from error
    return list(found.values())


def axes(definition: Definition, cases: list[Case]) -> dict[str, list[Any]]:
    """Values of every varied key among the cases, in order of their first appearance."""
    found: dict[str, dict[str, Any]] = {key: {} for key in definition.keys}
    for case in cases:
        for key, value in case.values.items():
            if value is not None:
                found[key].setdefault(json.dumps(value), value)
    return {key: list(values.values()) for key, values in found.items()}


def _scene_of(definition: Definition, sweep: Sweep) -> tuple[Path, str]:
    """Path and text of a sweep's scene: beside the campaign, or shipped."""
    own = definition.path.parent / sweep.scene
    try:
        path = own if own.is_file() or own.suffix == ".toml" else shipped.find(sweep.scene)
        return path, load_scene(path).text
    except SceneError as error:
        raise SceneError(str(definition.path), str(error)) from error


def _overridden(path: Path, original: str, given: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """A scene's data with other values, and all of it with the schema's defaults."""
    data = tomllib.loads(original)
    return data, override(data, {key: value for key, value in given.items() if not key.startswith(CLASSIC)}, path)


def _classic(given: dict[str, Any]) -> ClassicParameters | None:
    """The classic iteration's parameters, None where none is given."""
    own = {key.removeprefix(CLASSIC): value for key, value in given.items() if key.startswith(CLASSIC)}
    defaults = dataclasses.asdict(ClassicParameters())
    for name, value in own.items():
        if name not in defaults:
            raise SceneError(f"{CLASSIC}{name}", "unknown key", hint=nearest(name, defaults))
        kinds = (int,) if isinstance(defaults[name], int) else (int, float)
        if type(value) not in kinds:
            raise SceneError(f"{CLASSIC}{name}", f"must be a {'' if float in kinds else 'whole '}number", value=value)
    try:
        return ClassicParameters(**{name: type(defaults[name])(value) for name, value in own.items()}) if own else None
    except (ValueError, OverflowError) as error:
        given_words = ", ".join(f"{name} = {value}" for name, value in own.items())
        raise SceneError(CLASSIC.rstrip("."), _CLASSIC_RULE, hint=f"given: {given_words}; the rest is as by default") from error


def _run(folder: str, path: Path, text: str) -> CaseRun:
    """A run of a scene, which is checked by being built and modelled, all but solved."""
    name = _stem(path.stem)
    scene = scene_of_text(text, path, name)
    structural_model(scene)
    meshes = [f"{mesh.path} {hashlib.sha256(mesh.content).hexdigest()}" for mesh in scene.meshes]
    return CaseRun(folder, name, path, text, tuple(meshes))


def _values(whole: dict[str, Any], parameters: ClassicParameters | None, varied: tuple[str, ...]) -> dict[str, Any]:
    """Values of the varied keys as the scene has them, its defaults included."""
    classic = dataclasses.asdict(parameters) if parameters else {}
    return {key: classic.get(key.removeprefix(CLASSIC)) if key.startswith(CLASSIC) else key_paths.get(whole, key) for key in varied}


def _titled(data: dict[str, Any], stem: str, parts: list[str]) -> str:
    """The scene's text, whose title says what it is a case of."""
    title = f"{data.get('title') or stem}{': ' if parts else ''}{', '.join(part.replace('=', ' = ') for part in parts)}"
    return tomli_w.dumps({"title": title} | {key: value for key, value in data.items() if key != "title"})


def _labels(definition: Definition) -> dict[str, str]:
    """Short names of the varied keys: as given, else the last name in their path where no other key has it, else all of it."""
    last = {key: key.split(".")[-1] for key in definition.keys}
    often = Counter(last.values())
    return {key: definition.file.labels.get(key) or (short if often[short] == 1 else key) for key, short in last.items()}


def _parts(sweep: Sweep, values: dict[str, Any], labels: dict[str, str]) -> dict[str, str]:
    """What names a case among its sweep's, by key: its values; of keys that go together the first."""
    naming = [*sweep.vary, *(next(iter(group)) for group in sweep.together)]
    ranges = sweep.vary | {key: values for group in sweep.together for key, values in group.items()}
    return {key: _safe(f"{labels[key]}={_word(values[key], ranges[key])}") for key in naming}


def _word(value: Any, values: tuple[Any, ...]) -> str:
    """A value as a word; an array or table by its place among the values."""
    if isinstance(value, bool):
        return str(value).lower()
    return f"v{values.index(value) + 1}" if isinstance(value, list | dict) else str(value)


def _safe(text: str) -> str:
    """The text without anything that leads out of a folder, or that a shell or a file system reads otherwise."""
    return _UNSAFE.sub("", text)[:LONGEST]


def _stem(text: str) -> str:
    """The same without a dot, so that no name of a folder begins with one, or is that of a file beside it."""
    return _safe(text).replace(".", "") or "scene"


class _Names:
    """Names that were given; each is given once, whatever the case of its letters."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def unique(self, wanted: str) -> str:
        name, number = wanted[:LONGEST], 1
        while name.casefold() in self._taken:
            number += 1
            name = f"{wanted[:LONGEST]}-{number}"
        self._taken.add(name.casefold())
        return name
