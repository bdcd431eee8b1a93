"""Settings of the program from files and the environment: folder of results, time limit, number of workers, place of YADE.

No setting affects results: all mechanical data are in the scene or on the command line.
"""

import argparse
import os
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import pydantic
from pydantic import BeforeValidator, Field, Strict

from la_core.errors import CONTROL, SceneError, nearest
from la_core.scene import Positive, Table, as_scene_error

OF_A_FOLDER = Path("crosscheck.toml")  # in the current folder
PREFIX = "CROSSCHECK_"
SYSTEM_PYTHON = "/usr/bin/python3"
LARGEST_FILE = 100_000  # bytes; settings are a few lines
HARDER_SECONDS = 900.0  # s of wall time for a second attempt with finer settings, unless the caller says otherwise
MOST_WORKERS = 1000


class SettingError(SceneError):
    """An invalid setting; the message gives file or variable, key, value, rule and next step."""


def _path(value: object) -> object:
    """Return a text as a path, with the user's home for a `~` at its beginning."""
    if isinstance(value, Path):
        return value
    if not isinstance(value, str) or not value or CONTROL.search(value):
        raise ValueError("must be the path of a folder or program, as text in quotes")
    try:
        return Path(value).expanduser()
    except RuntimeError as error:
        raise ValueError("no such user: the home of its `~` is unknown; write the folder in full") from error


PathText = Annotated[Path, BeforeValidator(_path)]


class Settings(Table):
    """Every setting with its default; a relative path starts from the current folder."""

    output: PathText = Field(
        default=Path("crosscheck-results"), description="folder of the results of `crosscheck run` and `crosscheck solve`"
    )
    time_limit: Positive | None = Field(
        default=None, description="longest wall time of each YADE run, s; where none is set, the `time_limit` of the scene, or 3600"
    )
    workers: Annotated[int, Strict(), Field(ge=1, le=MOST_WORKERS)] | None = Field(
        default=None, description="number of campaign cases that run in parallel; where none is set, the number of cores"
    )
    yade: PathText | None = Field(
        default=None, description="folder with YADE's Python package; where none is set, the program `yade` gives it"
    )
    yade_python: PathText = Field(default=Path(SYSTEM_PYTHON), description="interpreter that loads YADE")


NUMBERS = ("time_limit", "workers")
NOT_OF_A_FOLDER = ("yade", "yade_python")  # a folder may come from anybody, so its file must not select a program to run


@dataclass(frozen=True)
class Configuration:
    """The settings in force and their sources.

    Attributes
    ----------
    settings : Settings
        Every setting's value.
    sources : dict of str
        File or environment variable by setting, for settings that are not defaults.
    files : tuple of Path
        Files that settings are read from, where they exist.
    """

    settings: Settings
    sources: dict[str, str]
    files: tuple[Path, ...]

    def source(self, name: str) -> str:
        """Return the source of a setting: a file, a variable or "default"."""
        return self.sources.get(name, "default")

    def place(self, name: str) -> str:
        """Return the place where a user changes a setting: the variable, or the file and the setting in it."""
        source = self.source(name)
        return source if source.startswith(PREFIX) else f"{source}: {name}"


def load_settings() -> Configuration:
    """Return the settings in force.

    The first of these that has a setting decides: the environment, the current folder's file, the user's file, the defaults.
    Raises SettingError for a file or a variable with an invalid setting.
    """
    user = _file_of_the_user()
    files = (*([user] if user else []), OF_A_FOLDER)
    holding: dict[str, Any] = {}
    sources: dict[str, str] = {}
    for path in files:
        data = _read(path)
        _check(str(path), data)
        if path == OF_A_FOLDER:
            _check_of_a_folder(data)
        holding |= data
        sources |= dict.fromkeys(data, str(path))
    for name in Settings.model_fields:
        variable = PREFIX + name.upper()
        if text := os.environ.get(variable):
            data = {name: _number(text) if name in NUMBERS else text}
            _check(variable, data)
            holding |= data
            sources[name] = variable
    return Configuration(Settings.model_validate(holding), sources, files)


def filled(options: argparse.Namespace) -> argparse.Namespace:
    """Return the options, with the settings for those options in `configured` that the command line does not give."""
    settings = load_settings().settings
    for name in options.configured:
        if getattr(options, name) is None:
            setattr(options, name, getattr(settings, name))
    return options


def unknown_variables() -> list[str]:
    """Return a message for each unknown environment variable that begins with CROSSCHECK_, with the nearest known one."""
    known = [PREFIX + name.upper() for name in Settings.model_fields]
    return [f"{name}: {nearest(name, known, 'variables')}" for name in sorted(os.environ) if name.startswith(PREFIX) and name not in known]


def _file_of_the_user() -> Path | None:
    """Return `crosscheck/config.toml` in the user's folder of configurations (XDG Base Directory Specification), None without a home."""
    named = Path(os.environ.get("XDG_CONFIG_HOME", ""))
    try:
        folder = named if named.is_absolute() else Path.home() / ".config"
    except RuntimeError:
        return None
    return folder / "crosscheck" / "config.toml"


def _read(path: Path) -> dict[str, Any]:
    """Return a file's settings, an empty dict where there is no file."""
    try:
        if not path.exists():
            return {}
        if not path.is_file():
            raise SettingError(str(path), "is not a file", hint="settings are read from there")
        if path.stat().st_size > LARGEST_FILE:
            raise SettingError(str(path), f"larger than {LARGEST_FILE} bytes, so it is no file of settings")
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        step = "settings are read from there; make it readable, or set XDG_CONFIG_HOME to another folder"
        raise SettingError(str(path), f"cannot be read: {error.strerror}", hint=step) from error
    except (ValueError, RecursionError) as error:  # UnicodeDecodeError is a ValueError, too
        raise SettingError(str(path), f"not valid TOML: {error}", hint="settings are read from there") from error


def _check(where: str, data: dict[str, Any]) -> None:
    try:
        Settings.model_validate(data)
    except pydantic.ValidationError as error:
        raise SettingError(where, str(as_scene_error(error, data, Settings))) from error


def _check_of_a_folder(data: dict[str, Any]) -> None:
    for name in NOT_OF_A_FOLDER:
        if name in data:
            rule = "not allowed in a folder's file, because it selects a program to run"
            raise SettingError(f"{OF_A_FOLDER}: {name}", rule, hint=f"set it in {_file_of_the_user()} or {PREFIX}{name.upper()}")
    output = str(data.get("output", ""))
    if Path(output).is_absolute() or ".." in Path(output).parts or output.startswith("~"):
        rule = "must be a path inside this folder"
        raise SettingError(f"{OF_A_FOLDER}: output", rule, value=output, hint=f"choose another folder with -o or {PREFIX}OUTPUT")


def _number(text: str) -> object:
    """Return a text as a number where it is one, else the text."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
