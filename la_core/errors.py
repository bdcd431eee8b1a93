"""Errors in a scene, with messages that say what to do next."""

import difflib
import math
import numbers
import os
import re
import shlex
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Self

CONTROL = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]"
)  # characters that control a terminal, except tab and new line
MOST_LISTED, FEW_LISTED = 40, 10  # valid names in a hint: most that it lists in full, and number of the first ones of a longer list
ON_WINDOWS = (
    "crosscheck does not run on Windows itself; install it in WSL, the Linux within Windows (`wsl --install`), where YADE runs, too: "
    "https://learn.microsoft.com/windows/wsl/install"
)
OF_LOCALE = "this shell's locale is not in UTF-8: set one that is, such as `export LC_ALL=C.UTF-8`"


class SceneError(Exception):
    """Error in a scene or in an argument, with a message that says where it is, the rule and what to do next.

    The message reads `where = value: rule; hint`.

    Parameters
    ----------
    where : str
        Place of the error: a file, a key, a block or an argument.
    rule : str
        Rule that the place breaks.
    value : object, optional
        Value that breaks the rule; the message shows at most 80 characters of it. None leaves it out.
    hint : str, optional
        Next step for the user; "" leaves it out.
    blocks : sequence of str, optional
        Names of the blocks at fault, from which the lines of the scene file follow.
    spots : sequence of points, optional
        Places of the fault, (x, y, z) in m, for the figure.
    """

    def __init__(
        self,
        where: str,
        rule: str,
        *,
        value: object = None,
        hint: str = "",
        blocks: Sequence[str] = (),
        spots: Sequence[tuple[float, float, float]] = (),
    ) -> None:
        shown = "" if value is None else f" = {_short(value)}"
        super().__init__(f"{where}{shown}: {rule}" + (f"; {hint}" if hint else ""))
        self.where, self.blocks, self.spots = where, tuple(blocks), tuple(spots)

    @classmethod
    def told(cls, message: str, about: "SceneError | None" = None) -> Self:
        """An error with a complete message, such as the joined messages of several errors; it takes its place from the error `about`."""
        error = cls("", "") if about is None else cls(about.where, "", blocks=about.blocks, spots=about.spots)
        error.args = (message,)
        return error

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the error so that it leaves a worker process with its message unchanged and with its place."""
        return type(self).told, self.args, self.__dict__


class CannotStandError(SceneError):
    """Error of a command that has nothing to show, because the structure cannot stand under its weight and dead loads."""


def whole_number(where: str, value: Any, least: int, most: float = math.inf) -> int:
    """The value of an argument that must be a whole number from `least` to `most`; raises SceneError for any other."""
    if not isinstance(value, numbers.Integral) or isinstance(value, bool) or not least <= int(value) <= most:
        rule = f"must be a whole number from {least} to {most}" if most < math.inf else f"must be a whole number of at least {least}"
        raise SceneError(where, rule, value=value)
    return int(value)


def true_or_false(where: str, value: Any) -> bool:
    """The value of an argument that must be True or False; raises SceneError otherwise: the text "no" would count as True."""
    if not (isinstance(value, bool) or type(value).__name__ in ("bool", "bool_")):  # these are the names of NumPy's type
        raise SceneError(where, "must be True or False", value=value)
    return bool(value)


def path_of(where: str, value: Any) -> Path:
    """The path that an argument gives; raises SceneError for a value that is no path."""
    if not isinstance(value, str | os.PathLike):
        raise SceneError(where, "must be a path, as a text or as a Path", value=value)
    return Path(value)


def seconds_or_none(where: str, value: Any) -> float | None:
    """The value of an argument that must be a positive number of seconds, or None; raises SceneError for any other."""
    if value is None:
        return None
    is_number = isinstance(value, numbers.Real) and not isinstance(value, bool)
    try:
        seconds = float(value) if is_number else math.nan
    except OverflowError:
        seconds = math.inf
    if not 0.0 < seconds < math.inf:
        raise SceneError(where, "must be a positive number of seconds, or None", value=value)
    return seconds


def nearest(word: str, valid: Iterable[str], kind: str = "keys") -> str:
    """A hint with the valid key (or other `kind`) nearest to `word`. If none is similar, it lists the valid ones, of many the first."""
    choices = list(valid)
    near = difflib.get_close_matches(word, choices, n=1)
    if near:
        return f'did you mean "{near[0]}"?'
    listed = choices if len(choices) <= MOST_LISTED else [*choices[:FEW_LISTED], f"... ({len(choices)} in all)"]
    return f"valid {kind}: {', '.join(listed)}"


def extra_hint(extra: str, package: str) -> str:
    """A next step for a missing optional package: the extra that contains it, and the command that installs it."""
    return f'install the extra "{extra}": {how_to_install(package)}'


def how_to_install(package: str) -> str:
    """The command that installs a package for this program's Python: a bare `pip` may belong to another Python."""
    if _is_pipx():
        return f"pipx inject crosscheck-masonry {package}"
    return f"{shlex.quote(sys.executable)} -m pip install {package}"


def missing_part(error: ImportError) -> str:
    """A message for a Python package that cannot be loaded although the program always needs it."""
    what = f"the Python module {error.name} is missing" if isinstance(error, ModuleNotFoundError) else f"a Python module fails ({error})"
    command = "pipx reinstall crosscheck-masonry" if _is_pipx() else f"{shlex.quote(sys.executable)} -m pip install --editable ."
    place = "" if _is_pipx() else " in the project's folder"
    return f"{what}: the installation of crosscheck is incomplete; `{command}`{place} completes it"


def _is_pipx() -> bool:
    return (Path(sys.prefix) / "pipx_metadata.json").is_file()


def visible(text: str) -> str:
    """The text with an escape in place of every control character, and of every lone surrogate."""
    return CONTROL.sub(lambda match: f"\\x{ord(match[0]):02x}", text).encode("utf-8", "backslashreplace").decode("utf-8")


def real_path(path: Path | str) -> Path:
    """The absolute path without links. A link to itself stays, and opening it fails later; `Path.resolve` would raise RuntimeError."""
    return Path(os.path.realpath(path))


def printable_name(name: str) -> str:
    """The name of a file; raises SceneError where it cannot be printed or has only spaces.

    Python replaces the bytes that are not text in this locale by surrogates, which cannot be printed.
    """
    if name.isspace() or not name.isprintable():
        hint = OF_LOCALE if is_of_locale(name) else "rename the file"
        rule = "must be printable text and more than spaces: results are named by it"
        raise SceneError(f'the name "{visible(name)}"', rule, hint=hint)
    return name


def is_of_locale(text: str) -> bool:
    """Whether this locale loses characters of a name or word, because its encoding is not UTF-8."""
    return not text.isascii() and sys.getfilesystemencoding() != "utf-8"


def words_of(error: Exception) -> str:
    """The message of an error in a text that was read, without Python's advice to programmers on numbers of thousands of digits."""
    return "a number has too many digits" if "set_int_max_str_digits" in str(error) else shortened(str(error), 300)


def shortened(text: str, limit: int = 80) -> str:
    """At most `limit` characters of a text; three dots replace the rest."""
    return text if len(text) <= limit else text[: limit - 3] + "..."


def _short(value: object) -> str:
    try:
        return shortened(str(value).lower() if isinstance(value, bool) else repr(value))
    except ValueError:  # Python prints no integer of thousands of digits
        return "an integer of thousands of digits"
