"""The table of imported bodies in a scene file."""

from pathlib import PurePosixPath, PureWindowsPath
from typing import Annotated, Self

from pydantic import AfterValidator, model_validator

from la_core.scene.schema.types import Direction, Name, Positive, Real, Table, Text, Vector, described

FORMATS = (".obj", ".ply", ".stl", ".json")
FOLDER_FORMATS = (".ply", ".stl")  # of a folder with one body per file


def within_the_scene_s_folder(file: str) -> str:
    """Return the path of a file of a scene; raises ValueError for a path that leaves the scene's folder."""
    if "://" in file:
        raise ValueError("is an address; only a file beside the scene is read")
    if PurePosixPath(file).is_absolute() or PureWindowsPath(file).drive or "\\" in file:
        raise ValueError("must be a path relative to the scene file, with forward slashes, so that scene and file can be moved together")
    if ".." in PurePosixPath(file).parts:
        raise ValueError("leads out of the scene's folder by `..`; put the file beside the scene or below it")
    return file


Pattern = Name  # shell-style, with `*`, `?` and `[...]`


class Turn(Table):
    """Rotation about an axis through the origin, degrees, right-handed."""

    axis: Direction = described("axis through the origin, of any length")
    degrees: Real = described("angle, right-handed", "degrees")


class Mesh(Table):
    """Convex bodies and prisms of any profile from a file or a folder; scaled to m first, then turned about the origin, then shifted.

    `fixed` and `support` are shell-style patterns of the names that the bodies have in the file; all others are free.
    """

    file: Annotated[Name, AfterValidator(within_the_scene_s_folder)] = described(
        "an .obj, .ply, .stl or .json file, or a folder of .ply or .stl files; a path from the scene's folder on, and within it"
    )
    name: Text = described("prefix of the bodies' names, for scenes with several meshes", default="")
    density: Positive | None = described("density of these blocks, in place of [stone]'s", "kg/m3", default=None)
    fixed: tuple[Pattern, ...] = described("patterns of the names of bodies that are ground, such as `ground*`", default=())
    support: tuple[Pattern, ...] = described("patterns of the names of bodies that move with the settlement", default=())
    scale: Positive = described("metres per unit of the file: 0.001 for mm", default=1.0)
    turn: Turn | None = described("rotation after scaling", default=None)
    shift: Vector = described("translation after turning", "m", default=(0.0, 0.0, 0.0))

    @model_validator(mode="after")
    def _is_readable(self) -> Self:
        suffix = PurePosixPath(self.file).suffix.lower()
        if suffix and suffix not in FORMATS:
            raise ValueError(f"`file` must end in {', '.join(FORMATS)}, or be a folder of {' or '.join(FOLDER_FORMATS)} files")
        return self
