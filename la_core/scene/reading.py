"""Reads the text and the tables of a scene file; errors for other files and for invalid TOML name the next step."""

import re
import shlex
import tomllib
from pathlib import Path
from typing import Any

from la_core.drawing import DRAWING_FORMATS
from la_core.errors import SceneError, words_of
from la_core.scene.schema.types import LARGEST_FILE

_MESHES = (".obj", ".ply", ".stl")
_SHEETS = (".csv", ".xls", ".xlsx", ".ods")
_PICTURES = (".ifc", ".pdf", ".png", ".jpg", ".jpeg", ".tif", ".tiff")
_ENDINGS = {**dict.fromkeys(_MESHES, "a mesh"), **dict.fromkeys((*DRAWING_FORMATS, ".dwg"), "a drawing"),
            **dict.fromkeys(_PICTURES, "a drawing or a picture"), **dict.fromkeys(_SHEETS, "a spreadsheet"),
            ".json": "a JSON file"}  # fmt: skip
_NUMBER = r"=\s*([-+]?[\d.]+)\s*"
_BEFORE = r"[=\[,]\s*[-+]?"  # the characters before a number
_OUTSIDE = r"""(?:[^"'#]|"[^"]*"|'[^']*')*"""  # start of a line up to a comment; a # in quotes begins no comment
_SLIPS = (  # patterns of lines that are not valid TOML, each with its hint; the first match counts
    (r"=[^\"'#]*[“”„«»‘’]", 'write text in straight quotes, as in "text"; word processors make curved ones of them'),
    (r"=[^\"'#]*[−–—]", "write a minus sign with the key -; a longer dash comes with text copied from a page"),
    (
        rf"^{_OUTSIDE}[\u00a0\u2007\u202f\u200b\ufeff]",
        "a space on this line is no plain one, as on web pages: delete the line's spaces and type them again",
    ),
    (r"^[^\"'#:]*//", "a comment begins with #, not with //"),
    (r"^([^\"'#]*[{,])?\s*[\w-]+\s*:", "write = between a key and its value"),
    (r"=\s*\(", "write lists in square brackets, as in [0.0, 0.0, -1.0]"),
    (_BEFORE + r"(math\.)?(tan|sin|cos|sqrt|atan|radians|pi)\b", "a scene does not calculate: write the number that comes out"),
    (_BEFORE + r"[\d.]+\s*[*/^]+\s*(?!\d+/)([\d.(]|pi)", "a scene does not calculate: write the number that comes out"),
    (_BEFORE + r"(\.\d|\d+\.(?![\d.]))", "write a digit on both sides of a decimal point, as in 0.5 and 1.0"),
    (r"=\s*(True|TRUE|False|FALSE)\b", "write true or false in small letters"),
    (r"\{[^}]*,\s*\}", "no comma stands before the closing brace"),
    (r"\{[^}\[]*(\[[^\]]*\][^}\[]*)*$", "a table in braces { } begins and ends on one line"),
    (r"=\s*[-+]?\d{1,3}([.' ]\d{3})+(,\d+)?\s*(#.*)?$", "write numbers with a decimal point and no other mark, as in 2200.5"),
    (
        r"=\s*([-+]?[1-9]\d{0,2}),(\d{3})\s*(#.*)?$",
        r"write numbers with a decimal point and no other mark: \1\2, or \1.\2 if the comma is a decimal mark",
    ),
    (r"=\s*([-+]?\d+),(\d+)\s*(#.*)?$", r"write numbers with a decimal point, \1.\2"),
    (_NUMBER + "(degrees?|deg|°)", r"write the number alone, \1; the friction is the tangent of the angle"),
    (_NUMBER + "%", "write the number alone, as a share of one: 0.6 for 60 %"),
    (r";\s*(#.*)?$", "a line ends without a semicolon"),
    (_NUMBER + r"[^\W\d_][\w-]*\s*=", "write a comma between two keys of a table in braces"),
    (_NUMBER + r"(?!e[-+]?\d)([^\W\d_][\w/³²]*)", r"write the number alone, \1; all numbers are in SI units (m, kg, N)"),
    (r"=\s*[^\W\d][^\"'\[\]{}=]*$", "write text in quotes"),
)
_SAVE_AS_UTF_8 = "save the file in the encoding UTF-8; editors offer it beside the file's name"
_LONGEST_LINE = 2000  # characters: longer lines are not searched, because the time of the search grows with the square of the length
_DEEPEST_KEY = 30  # parts between dots; the time of Python's parser grows with the square of their number
_PART = r"""(?:"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+'|[A-Za-z0-9_-]++)[ \t]*+"""
_DEEP_KEY = re.compile(rf"(?:^|[\[{{,])[ \t]*+(?:{_PART}\.[ \t]*+){{{_DEEPEST_KEY}}}", re.MULTILINE)
_TABLE_TWICE = "a table in single brackets stands once; tables of which a scene may have several have double brackets, as [[block]]"


def read_text(path: Path) -> str:
    """The text of a scene file; raises SceneError for a file that cannot be a scene."""
    try:
        if path.exists() and not (path.is_file() or path.is_dir()):
            raise SceneError(str(path), "neither a file nor a folder, so reading it might never end")
        _refuse_other_kinds(path)
        if path.stat().st_size > LARGEST_FILE:
            raise SceneError(str(path), f"larger than {LARGEST_FILE} bytes; a scene is a short text")
        content = path.read_bytes()
        _refuse_other_texts(content, path)
        return content.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")  # some editors write a byte order mark
    except OSError as error:
        raise SceneError(str(path), f"cannot be read: {error.strerror}", hint="`crosscheck scenes` lists the shipped ones") from error
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        rule = f"not UTF-8 text (byte {error.start}, line {line})"
        raise SceneError(str(path), rule, hint=_SAVE_AS_UTF_8) from error


def _refuse_other_texts(content: bytes, path: Path) -> None:
    """Raise SceneError for a file of a word processor, and for text with two bytes for each character."""
    if content.startswith((b"{\\rtf", b"PK\x03\x04", b"\xd0\xcf\x11\xe0")):
        raise SceneError(str(path), "a file of a word processor, not plain text", hint="save it there as plain text, in the encoding UTF-8")
    if b"\0" in content:
        raise SceneError(str(path), "not UTF-8 text: it holds zero bytes, as UTF-16 does", hint=_SAVE_AS_UTF_8)


def _refuse_other_kinds(path: Path) -> None:
    """Raise SceneError for a mesh, drawing, picture, spreadsheet or JSON file in place of a scene; the hint tells how to get a scene."""
    ending = path.suffix.lower()
    kind = _ENDINGS.get(ending)
    if kind is None or not path.is_file():
        return
    if ending in (*_MESHES, *DRAWING_FORMATS):
        hint = f"`crosscheck new --from {shlex.quote(str(path))}` writes a scene for it"
    elif ending == ".json":
        hint = f"where it is an assembly of COMPAS, `crosscheck new --from {shlex.quote(str(path))}` writes a scene for it"
    elif ending == ".dwg":
        hint = f"save it as DXF; `crosscheck new --from {shlex.quote(str(path.with_suffix('.dxf')))}` then writes a scene for it"
    else:
        hint = (
            "write its blocks as [[block]] tables with a `box` or a `prism`, or generate them: `crosscheck new` lists kinds of structures"
        )
    raise SceneError(str(path), f"is {kind}, not a scene", hint=hint)


def tables_of(text: str, path: Path) -> dict[str, Any]:
    """The tables of a TOML text; raises SceneError, which names `path`, for invalid TOML."""
    if deep := _DEEP_KEY.search(text):
        line = text.count("\n", 0, deep.start() + 1) + 1
        raise SceneError(str(path), f"line {line}: a key has more than {_DEEPEST_KEY} parts between dots; no key of a scene has so many")
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # Python raises ValueError for a number of too many digits
        fault = words_of(error)
        raise SceneError(str(path), f"not valid TOML: {fault}", hint=_slip(text, str(error))) from error


def refuse_a_campaign(data: dict[str, Any], path: Path) -> None:
    """Raise SceneError for the tables of a campaign in place of those of a scene."""
    if "sweep" in data and "joint" not in data:
        raise SceneError(str(path), "is a campaign, not a scene", hint=f"`crosscheck campaign {shlex.quote(str(path))}` runs it")


def _slip(text: str, message: str) -> str:
    """Hint on the probable mistake in the line of a TOML error with this message; "" where none is known."""
    place = re.search(r"line (\d+)", message)
    line = text.split("\n")[int(place[1]) - 1].strip(" \t") if place else ""
    if "Cannot declare" in message or "Cannot overwrite" in message:
        return _TABLE_TWICE if line.startswith("[") else "the key stands twice; give it once"
    if len(line) > _LONGEST_LINE:
        return ""
    if comment := re.match(rf"({_OUTSIDE})#", line):  # a comment may hold anything, such as the formula for the number
        line = comment[1].rstrip(" \t")
    for pattern, hint in _SLIPS:
        if found := re.search(pattern, line):
            return found.expand(hint)
    return ""
