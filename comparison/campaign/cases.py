"""Expansion of a campaign's definition into cases: scenes with their own values, under names that are safe as file names."""

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
from la_core.errors import SceneError, nearest, real_path
from la_core.limit import ClassicParameters
from la_core.scene import Scene, key_paths, load_scene, override, scene_of_text, shipped

LONGEST = 120  # characters of a case's name
_CLASSIC_RULE = "needs relaxation in (0, 1], slope from 0, iterations from 1, and cohesion from 0 and below tolerance"
_UNSAFE = re.compile(r"[^\w.+=-]", re.ASCII)


@dataclass(frozen=True)
class CaseRun:
    """One scene to run by both methods in a folder of its own; cases that differ only in the classic iteration share a run.

    Attributes
    ----------
    name : str
        Name of the run's folder, unique in the campaign.
    scene_name : str
        Name of the scene.
    path : Path
        File of the original scene; paths of meshes are relative to its folder.
    text : str
        TOML text of the scene with the case's values.
    meshes : tuple of str
        Path and SHA-256 digest of every mesh.
    warnings : tuple of str
        Warnings about implausible values of the scene.
    """

    name: str
    scene_name: str
    path: Path
    text: str
    meshes: tuple[str, ...]
    warnings: tuple[str, ...] = ()

    def scene(self) -> Scene:
        """Return the scene; raises SceneError for an invalid one."""
        return scene_of_text(self.text, self.path, self.scene_name)


@dataclass(frozen=True)
class Case:
    """One row of the campaign's tables.

    Attributes
    ----------
    name : str
        Name of the case, unique in the campaign.
    sweep : str
        Name of its sweep, as the campaign file has it.
    run : CaseRun
        Run of its scene.
    values : dict
        Value of every varied key, by its dotted path; None for a key that the scene does not have.
    classic : ClassicParameters or None
        Parameters of the classic iteration; None without one.
    """

    name: str
    sweep: str
    run: CaseRun
    values: dict[str, Any]
    classic: ClassicParameters | None


def expand(definition: Definition) -> list[Case]:
    """Return all cases in order, without duplicates within a sweep.

    Raises SceneError for a case with an invalid scene; the message names the campaign and the case.
    """
    labels = _labels(definition)
    runs: dict[tuple[Path, str], CaseRun] = {}
    cases: dict[tuple[str, CaseRun, ClassicParameters | None], Case] = {}
    names, folders, sweeps = _Names(LONGEST), _Names(LONGEST), _Names()
    scenes = [_scene_of(definition, sweep) for sweep in definition.file.sweep]
    for sweep, (path, original) in zip(definition.file.sweep, scenes, strict=True):
        called = sweep.name or _scene_name(path, [other for other, _ in scenes])
        stem, title = folder_name(called), sweeps.unique(called)
        for values in sweep.combinations():
            parts = _parts(sweep, values, labels)
            name = "_".join([stem, *parts.values()])
            scene_parts = [part for key, part in parts.items() if not key.startswith(CLASSIC)]
            given = {**sweep.set, **values}
            try:
                data, whole = _overridden(path, original, given)
                parameters = _classic(given)
                identity = (real_path(path), json.dumps(whole))
                if identity not in runs:
                    text = _titled(data, path.stem, scene_parts) if data != tomllib.loads(original) else original
                    runs[identity] = _run(folders.unique("_".join([stem, *scene_parts])), path, text)
                run = runs[identity]
                if (title, run, parameters) not in cases:
                    of_keys = _values(whole, parameters, definition.keys)
                    cases[title, run, parameters] = Case(names.unique(name), title, run, of_keys, parameters)
            except SceneError as error:
                told = str(error).removeprefix(f"{path}: ") if given else str(error)  # the fault is in a given value, not in the file
                raise SceneError(f"{definition.path}: case {name}", told) from error
    return list(cases.values())


def axes(definition: Definition, cases: list[Case]) -> dict[str, list[Any]]:
    """Return the values of every varied key among the cases, in order of their first appearance."""
    distinct: dict[str, dict[str, Any]] = {key: {} for key in definition.keys}
    for case in cases:
        for key, value in case.values.items():
            if value is not None:
                distinct[key].setdefault(json.dumps(value), value)
    return {key: list(values.values()) for key, values in distinct.items()}


def _scene_of(definition: Definition, sweep: Sweep) -> tuple[Path, str]:
    """Return the path and the text of a sweep's scene: relative to the campaign's folder, with or without `.toml`, or shipped."""
    try:
        path = shipped.find(sweep.scene, definition.path.parent)
        return path, load_scene(path).text
    except SceneError as error:
        raise SceneError(str(definition.path), str(error)) from error


def _scene_name(path: Path, others: list[Path]) -> str:
    """Return the name of a scene's file, after that of its folder where two folders have scenes of this name."""
    place = real_path(path)
    is_alone = all(real_path(other) == place for other in others if other.stem.casefold() == path.stem.casefold())
    return path.stem if is_alone else f"{place.parent.name}_{path.stem}"


def _overridden(path: Path, original: str, given: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return a scene's data with the given values, and the same data with the schema's defaults filled in."""
    data = tomllib.loads(original)
    of_scene = {key: value for key, value in given.items() if not key.startswith(CLASSIC)}
    return data, override(data, of_scene, path)


def _classic(given: dict[str, Any]) -> ClassicParameters | None:
    """Return the parameters of the classic iteration, or None if none is given."""
    parameters = {key.removeprefix(CLASSIC): value for key, value in given.items() if key.startswith(CLASSIC)}
    defaults = dataclasses.asdict(ClassicParameters())
    for name, value in parameters.items():
        if name not in defaults:
            raise SceneError(f"{CLASSIC}{name}", "unknown key", hint=nearest(name, defaults))
        kinds = (int,) if isinstance(defaults[name], int) else (int, float)
        if type(value) not in kinds:
            raise SceneError(f"{CLASSIC}{name}", f"must be a {'' if float in kinds else 'whole '}number", value=value)
    try:
        return ClassicParameters(**{name: type(defaults[name])(value) for name, value in parameters.items()}) if parameters else None
    except (ValueError, OverflowError) as error:
        given_words = ", ".join(f"{name} = {value}" for name, value in parameters.items())
        raise SceneError(CLASSIC.rstrip("."), _CLASSIC_RULE, hint=f"given: {given_words}; the others have their defaults") from error


def _run(folder: str, path: Path, text: str) -> CaseRun:
    """Build and model a scene, and return its run; raises SceneError for an invalid scene."""
    name = folder_name(path.stem)
    scene = scene_of_text(text, path, name)
    structural_model(scene)
    meshes = [f"{mesh.path} {hashlib.sha256(mesh.content).hexdigest()}" for mesh in scene.meshes]
    return CaseRun(folder, name, path, text, tuple(meshes), tuple(scene.warnings))


def _values(whole: dict[str, Any], parameters: ClassicParameters | None, varied: tuple[str, ...]) -> dict[str, Any]:
    """Return the varied keys' values in the scene, defaults included."""
    classic = dataclasses.asdict(parameters) if parameters else {}
    return {key: classic.get(key.removeprefix(CLASSIC)) if key.startswith(CLASSIC) else key_paths.get(whole, key) for key in varied}


def _titled(data: dict[str, Any], stem: str, parts: list[str]) -> str:
    """Return the scene's text with the case's values added to its title."""
    title = f"{data.get('title') or stem}{': ' if parts else ''}{', '.join(part.replace('=', ' = ') for part in parts)}"
    return tomli_w.dumps({"title": title} | {key: value for key, value in data.items() if key != "title"})


def _labels(definition: Definition) -> dict[str, str]:
    """Return short names of the varied keys: the given label, else the last name of the path if it is unique, else the path."""
    last = {key: key.split(".")[-1] for key in definition.keys}
    occurrences = Counter(last.values())
    return {key: definition.file.labels.get(key) or (short if occurrences[short] == 1 else key) for key, short in last.items()}


def _parts(sweep: Sweep, values: dict[str, Any], labels: dict[str, str]) -> dict[str, str]:
    """Return the parts of a case's name by key, such as "mu=0.5"; of keys that go together, only the first counts.

    The key replaces a label with letters that names of folders leave out, such as Greek ones.
    """
    naming = [*sweep.vary, *(next(iter(group)) for group in sweep.together)]
    ranges = sweep.vary | {key: values for group in sweep.together for key, values in group.items()}
    return {key: _safe(f"{_of_folders(labels[key], key)}={_word(values[key], ranges[key])}") for key in naming}


def _of_folders(label: str, key: str) -> str:
    """Return the label for names of folders; the key where such a name would leave out a letter or everything."""
    letters = sum(map(str.isalpha, label))
    return _safe(label) if letters == sum(map(str.isalpha, _UNSAFE.sub("", label))) and _safe(label) else key


def _word(value: Any, values: tuple[Any, ...]) -> str:
    """Return a value as a word; "v2" for the second array or table of its range."""
    if isinstance(value, bool):
        return str(value).lower()
    return f"v{values.index(value) + 1}" if isinstance(value, list | dict) else str(value)


def _safe(text: str) -> str:
    """Return the text without characters that leave a folder or are special to a shell or a file system."""
    return _UNSAFE.sub("", text)[:LONGEST]


def folder_name(text: str) -> str:
    """Return the safe text without dots, so that a folder is neither hidden nor named like a file beside it."""
    return _safe(text).replace(".", "") or "scene"


class _Names:
    """Register of names. Each name is given once, whatever its upper and lower case, and is cut after `longest` characters."""

    def __init__(self, longest: int | None = None) -> None:
        self._taken: set[str] = set()
        self._longest = longest

    def unique(self, wanted: str) -> str:
        """Return the wanted name, with a number added if it is taken."""
        name, number = wanted[: self._longest], 1
        while name.casefold() in self._taken:
            number += 1
            name = f"{wanted[: self._longest]}-{number}"
        self._taken.add(name.casefold())
        return name
