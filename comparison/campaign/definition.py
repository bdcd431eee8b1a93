"""The campaign file: scenes, and ranges of their keys. All errors of the file itself are raised here."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Annotated, Any, Self

import pydantic
from pydantic import Field, Strict, field_validator, model_validator

from la_core.errors import SceneError, nearest, printable_name
from la_core.scene import LARGEST_FILE, Name, Table, Text, as_scene_error, described, key_paths, shipped, tables_of

MOST_CASES = 10_000  # per campaign: a typing error must not fill the disk
Values = Annotated[tuple[Any, ...], Field(min_length=1)]


def _dotted(table: Any) -> Any:
    """Return a table with the keys of its inner tables joined by dots; any other value as it is."""
    if not isinstance(table, dict):
        return table
    flat: dict[str, Any] = {}
    for key, value in table.items():
        own = {f"{key}.{inner}": entry for inner, entry in _dotted(value).items()} if isinstance(value, dict) and value else {key: value}
        if twice := flat.keys() & own.keys():
            raise ValueError(f'"{min(twice)}" is given twice, with quotes and without')
        flat |= own
    return flat


class Sweep(Table):
    """One scene over the product of ranges of its keys."""

    scene: Name = described("name of a shipped scene, or a path relative to the campaign file")
    name: Name | None = described("name of the sweep and its cases, in place of the scene's", default=None)
    set: dict[str, Any] = described(
        'fixed values in place of the scene\'s own, by key; a table replaces the whole table, so one key needs quotes: "joint.friction"',
        default_factory=dict,
    )
    vary: dict[str, Values] = described("lists of values by key; every value is combined with every other", default_factory=dict)
    together: tuple[Annotated[dict[str, Values], Field(min_length=1)], ...] = described(
        "tables of keys whose values go together: the first with the first, and so on; equally many of each", default=()
    )

    @field_validator("vary", "together", mode="before")
    @classmethod
    def _with_dotted_keys(cls, given: Any) -> Any:
        """Return ranges by dotted keys: "joint.friction" = [...] for joint.friction = [...], which TOML reads as a table in a table."""
        return [_dotted(group) for group in given] if isinstance(given, list) else _dotted(given)

    @model_validator(mode="after")
    def _goes_together(self) -> Self:
        for group in self.together:
            counts = {key: len(values) for key, values in group.items()}
            if len(set(counts.values())) > 1:
                raise ValueError(f"keys that go together need equally many values, not {', '.join(f'{k}: {n}' for k, n in counts.items())}")
        for key, values in self.vary.items():
            whole = [value for value in values if type(value) is int]  # a decimal comma splits a number into whole numbers
            if len(set(whole)) < len(whole):
                again = next(value for number, value in enumerate(whole) if value in whole[:number])
                comma = "a decimal comma makes two numbers of one, so write 0.6 instead of 0,6"
                raise ValueError(f'"{key}" takes the value {again} twice; give it once; {comma}')
        keys = [*self.set, *self.varied()]
        if twice := [key for key in keys if keys.count(key) > 1]:
            raise ValueError(f'"{twice[0]}" is given twice')
        return self

    def varied(self) -> list[str]:
        """Return the varied keys in the order of the file."""
        return [*self.vary, *(key for group in self.together for key in group)]

    def count(self) -> int:
        """Return the number of cases."""
        lengths = [len(values) for values in self.vary.values()]
        return math.prod(lengths + [len(next(iter(group.values()))) for group in self.together])

    def combinations(self) -> Iterator[dict[str, Any]]:
        """Yield the varied keys' values of each case; the last key varies fastest."""
        ranges = [[{key: value} for value in values] for key, values in self.vary.items()]
        ranges += [[dict(zip(group, values, strict=True)) for values in zip(*group.values(), strict=True)] for group in self.together]
        for combination in product(*ranges):
            yield {key: value for values in combination for key, value in values.items()}


class CampaignFile(Table):
    """The whole campaign file: the keys above its first table, and its tables."""

    title: Text = described("heading of the report", default="")
    yade: Annotated[bool, Strict()] = described("false runs limit analysis only", default=True)
    sweep: Annotated[tuple[Sweep, ...], Field(min_length=1)] = described("scenes with ranges of their keys; at least one")
    labels: dict[str, Name] = described("short names of varied keys, for axes and the names of cases", default_factory=dict)

    @field_validator("labels", mode="before")
    @classmethod
    def _with_dotted_keys(cls, given: Any) -> Any:
        """Return labels by dotted keys, as in `Sweep`."""
        return _dotted(given)


@dataclass(frozen=True)
class Definition:
    """A campaign file after reading.

    Attributes
    ----------
    path : Path
        The file.
    text : str
        Its text.
    file : CampaignFile
        Its validated content.
    keys : tuple of str
        Dotted paths of all varied keys, in the order of the file.
    """

    path: Path
    text: str
    file: CampaignFile
    keys: tuple[str, ...]

    @property
    def title(self) -> str:
        """The campaign's title; without one, the name of its file."""
        return self.file.title or self.path.stem


def _refuse_a_scene(path: Path, data: dict[str, Any]) -> None:
    if "joint" in data and "sweep" not in data:
        hint = f'a campaign names it: [[sweep]] scene = "{path.name}", vary = {{ "joint.friction" = [0.5, 0.6, 0.7] }}'
        raise SceneError("the file", "is a scene, not a campaign", hint=hint)


def load_campaign(path: Path) -> Definition:
    """Read and validate a campaign file; raises SceneError for an invalid one."""
    try:
        printable_name(path.stem)
        text = _read(path)
    except SceneError as error:
        raise SceneError(str(path), str(error)) from error
    data = tables_of(text, path)
    try:
        _refuse_a_scene(path, data)
        file = CampaignFile.model_validate(data)
        varied = list(dict.fromkeys(key for sweep in file.sweep for key in sweep.varied()))
        _require_sense(file, varied)
    except pydantic.ValidationError as error:
        raise SceneError(str(path), str(as_scene_error(error, data, CampaignFile))) from error
    except SceneError as error:
        raise SceneError(str(path), str(error)) from error
    return Definition(path, text, file, tuple(varied))


def _read(path: Path) -> str:
    try:
        if path.exists() and not path.is_file():
            raise SceneError("campaign", "not a file", hint="name the campaign file itself")
        if path.stat().st_size > LARGEST_FILE:
            raise SceneError("campaign", f"larger than {LARGEST_FILE} bytes; a campaign is a short text")
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise SceneError(
            "campaign", f"cannot be read: {error.strerror}", hint="`crosscheck campaign seed_paper` runs the shipped one"
        ) from error
    except UnicodeDecodeError as error:
        raise SceneError("campaign", f"not UTF-8 text (byte {error.start})", hint="save the file in the encoding UTF-8") from error


def _require_sense(file: CampaignFile, varied: list[str]) -> None:
    for number, sweep in enumerate(file.sweep):
        for key in [*sweep.set, *sweep.varied()]:
            try:
                key_paths.steps(key)
            except SceneError as error:
                raise SceneError(f"sweep[{number}]", str(error)) from error
    if (count := sum(sweep.count() for sweep in file.sweep)) > MOST_CASES:
        raise SceneError("sweep", f"at most {MOST_CASES} cases make a campaign", value=count, hint="take fewer values")
    if unknown := [key for key in file.labels if key not in varied]:
        hint = f"varied keys: {', '.join(varied)}" if varied else "no key is varied"
        raise SceneError("labels", f'no sweep varies "{unknown[0]}"', hint=hint)
    key_of: dict[str, str] = {}
    for key, label in file.labels.items():
        if (other := key_of.setdefault(label, key)) != key:
            raise SceneError("labels", f'"{other}" and "{key}" have the same label', value=label, hint="give each key its own")


def shipped_campaigns() -> dict[str, Path]:
    """Return the files of the shipped campaigns, by name."""
    return {path.stem: path for path in sorted((Path(__file__).parents[1] / "campaigns").glob("*.toml"))}


def find_campaign(path_or_name: Path) -> Path:
    """Return the path of a campaign given by its path or shipped name; raises SceneError if neither exists, or both do.

    SceneError is also raised where the system cannot look up the path, such as a name that is too long.
    """
    try:
        return _found(path_or_name)
    except OSError as error:
        hint = "give the path of a campaign file, or the name of a shipped campaign"
        raise SceneError("campaign", f"cannot be read: {error.strerror}", value=str(path_or_name), hint=hint) from error


def _found(path_or_name: Path) -> Path:
    known = shipped_campaigns()
    name = str(path_or_name)
    complete = path_or_name.with_name(f"{path_or_name.name}.toml") if path_or_name.name else path_or_name  # "." has no name
    if name in known:
        shipped.refuse_two(name, known[name], (path_or_name, complete), "campaign")
        return known[name]
    if path_or_name.exists() or path_or_name.suffix == ".toml":
        return path_or_name
    if complete.is_file():
        return complete
    raise SceneError(name, "neither a file nor a shipped campaign", hint=nearest(name, known, "campaigns"))


def default_folder(path: Path) -> Path:
    """Return the default folder of a campaign's results."""
    return Path("crosscheck-campaigns") / path.stem
