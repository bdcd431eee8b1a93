"""Reading a scene file: its text and its tables, with the next step for what is no scene."""

import re
import tomllib
from pathlib import Path
from typing import Any

from la_core.drawing import DRAWING_FORMATS
from la_core.errors import SceneError
from la_core.scene.schema.types import LARGEST_FILE

_MESHES = (".obj", ".ply", ".stl")
_PICTURES = (".ifc", ".pdf", ".png", ".jpg", ".jpeg", ".tif", ".tiff")
_ENDINGS = {**dict.fromkeys(_MESHES, "a mesh"), **dict.fromkeys((*DRAWING_FORMATS, ".dwg"), "a drawing"),
            **dict.fromkeys(_PICTURES, "a drawing or a picture"), ".json": "a JSON file"}  # fmt: skip


def read_text(path: Path) -> str:
    """The text of a scene file; raises SceneError where it cannot be one."""
    try:
        if path.exists() and not (path.is_file() or path.is_dir()):
            raise SceneError(str(path), "neither a file nor a folder, so reading it might never end")
        _refuse_other_kinds(path)
        if path.stat().st_size > LARGEST_FILE:
            raise SceneError(str(path), f"larger than {LARGEST_FILE} bytes; a scene is a short text")
        content = path.read_bytes()
        return content.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")  # some editors begin a file with a mark
    except OSError as error:
        raise SceneError(str(path), f"cannot be read: {error.strerror}", hint="`crosscheck scenes` lists the shipped ones") from error
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        rule = f"not UTF-8 text (byte {error.start}, line {line})"
        raise SceneError(str(path), rule, hint="save the file in the encoding UTF-8; editors offer it beside the file's name") from error


def _refuse_other_kinds(path: Path) -> None:
    """Raise SceneError for a mesh or a drawing in place of a scene, with the command that writes a scene for it."""
    ending = path.suffix.lower()
    kind = _ENDINGS.get(ending)
    if kind is None or not path.is_file():
        return
    if ending in (*_MESHES, *DRAWING_FORMATS):
        hint = f"`crosscheck new --from {path}` writes a scene for it"
    elif ending == ".json":
        hint = f"where it is an assembly of COMPAS, `crosscheck new --from {path}` writes a scene for it"
    elif ending == ".dwg":
        hint = f"save it as DXF; `crosscheck new --from {path.with_suffix('.dxf')}` then writes a scene for it"
    else:
        hint = "draw its blocks as [[block]] tables with a `prism`, or generate them: `crosscheck new` lists kinds of structures"
    raise SceneError(str(path), f"is {kind}, not a scene", hint=hint)


def tables_of(text: str, path: Path) -> dict[str, Any]:
    """The tables of a TOML text; raises SceneError, which names `path`, where it is not valid."""
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # Python raises ValueError for a number of too many digits
        raise SceneError(str(path), f"not valid TOML: {error}", hint=_slip(text, str(error))) from error


def _slip(text: str, message: str) -> str:
    """What the line of an error was probably meant to be, as a hint; "" where nothing is known."""
    place = re.search(r"line (\d+)", message)
    line = text.split("\n")[int(place[1]) - 1].strip() if place else ""
    if number := re.search(r"=\s*([-+]?\d+),(\d+)\s*(#.*)?$", line):
        return f"write numbers with a decimal point, {number[1]}.{number[2]}"
    if number := re.search(r"=\s*([-+]?[\d.]+)\s*(degrees?|deg|°)", line):
        return f"write the number alone, {number[1]}; the friction is the tangent of the angle"
    if number := re.search(r"=\s*([-+]?[\d.]+)\s*([^\W\d_][\w/³²]*)", line):
        return f"write the number alone, {number[1]}; all numbers are in SI units (m, kg, N)"
    if re.search(r"=\s*[^\W\d][^\"'\[\]{}=]*$", line):
        return "write text in quotes"
    return ""
