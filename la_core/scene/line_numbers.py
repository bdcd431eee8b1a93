"""Line numbers of the tables and keys of a TOML text; the standard library's parser does not keep them."""

import bisect
import re
from collections.abc import Sequence

from la_core.errors import SceneError

MOST_LINES = 3  # line numbers in one message
KeyPath = tuple[str | int, ...]  # names of keys and indices in arrays, from the top of the file

_BLANK = re.compile(r"(?:[\s,]|#[^\n]*)*")
_TEXT = re.compile(r'"""(?:\\.|[^\\])*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\'', re.DOTALL)
_KEY_PART = re.compile(r'"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\'|[A-Za-z0-9_-]+')
_SCALAR = re.compile(r"[^,\]}\n#]*")


def key_lines(text: str) -> dict[KeyPath, int]:
    """Line, from 1, of every table, key and array entry of a valid TOML text; arrays of tables count as arrays."""
    return _Scan(text).lines


def line_of(lines: dict[KeyPath, int], place: Sequence[str | int]) -> int | None:
    """Line of a key, or of the nearest table around it that the text has; None where the text has neither.

    lines: from `key_lines`.
    """
    around = (tuple(place[:length]) for length in range(len(place), 0, -1))
    return next((lines[path] for path in around if path in lines), None)


def with_lines(error: SceneError, text: str, names: Sequence[str], places: Sequence[KeyPath]) -> SceneError:
    """Add to an error the lines of the blocks that it names, or else the line of its key.

    Parameters
    ----------
    error : SceneError
        Error of the blocks or of a key, found after the file was read.
    text : str
        TOML of the file; "" leaves the error as it is.
    names, places : sequences
        Name of every block, and the table that it comes from.
    """
    lines = key_lines(text) if text else {}
    table = dict(zip(names, places, strict=False)) if error.blocks else {}
    wanted = [table[name] for name in error.blocks if name in table] or [tuple(error.where.split("."))]
    found = sorted({line for place in wanted if (line := line_of(lines, place)) is not None})
    if not found:
        return error
    *rest, last = map(str, found[:MOST_LINES])
    words = f"lines {', '.join(rest)} and {last}" if rest else f"line {last}"
    return SceneError.told(f"{words}: {error}", error)


class _Scan:
    """One pass through a text that `tomllib` accepts; on any other text the pass ends early and finds fewer lines."""

    def __init__(self, text: str) -> None:
        self.lines: dict[KeyPath, int] = {}
        self._text, self._at = text, 0
        self._ends = [match.start() for match in re.finditer("\n", text)]
        self._counts: dict[KeyPath, int] = {}  # entries so far of each array of tables
        self._document()

    def _document(self) -> None:
        table: KeyPath = ()
        while self._skip_blank():
            before = self._at
            if self._next("[["):
                table = self._header(repeats=True)
            elif self._next("["):
                table = self._header(repeats=False)
            else:
                self._pair(table)
            if self._at == before:
                return

    def _header(self, repeats: bool) -> KeyPath:
        line = self._line()
        path: KeyPath = ()
        names = self._dotted()
        for place, name in enumerate(names):
            path = (*path, name)
            if repeats and place == len(names) - 1:
                self.lines.setdefault(path, line)
                self._counts[path] = self._counts.get(path, -1) + 1
            if path in self._counts:
                path = (*path, self._counts[path])
        self.lines.setdefault(path, line)
        while self._next("]"):
            pass
        return path

    def _pair(self, table: KeyPath) -> None:
        line, path = self._line(), table
        for name in self._dotted():
            path = (*path, name)
            self.lines.setdefault(path, line)
        if path != table and self._next("="):
            self._value(path)

    def _value(self, path: KeyPath) -> None:
        self._skip_blank()
        if self._next("["):
            place = 0
            while self._skip_blank() and not self._next("]"):
                self.lines[(*path, place)], before = self._line(), self._at
                self._value((*path, place))
                place += 1
                if self._at == before:
                    return
        elif self._next("{"):
            while self._skip_blank() and not self._next("}"):
                before = self._at
                self._pair(path)
                if self._at == before:
                    return
        else:
            match = _TEXT.match(self._text, self._at) or _SCALAR.match(self._text, self._at)
            assert match is not None  # a scalar may be empty
            self._at = match.end()

    def _dotted(self) -> list[str]:
        names: list[str] = []
        while match := _KEY_PART.match(self._text, self._at):
            names.append(match[0].strip("\"'"))
            self._at = match.end()
            if not self._next("."):
                break
        self._next(" ")
        return names

    def _next(self, mark: str) -> bool:
        """Whether the mark comes next, after spaces; if so, pass the mark and the spaces behind it."""
        at = self._at
        while self._text[at : at + 1] in (" ", "\t"):
            at += 1
        if not self._text.startswith(mark, at):
            return False
        self._at = at + len(mark)
        while self._text[self._at : self._at + 1] in (" ", "\t"):
            self._at += 1
        return True

    def _skip_blank(self) -> bool:
        """Pass spaces, ends of lines, commas and comments; return whether more text follows."""
        match = _BLANK.match(self._text, self._at)
        assert match is not None  # it may be empty
        self._at = match.end()
        return self._at < len(self._text)

    def _line(self) -> int:
        return bisect.bisect_left(self._ends, self._at) + 1
