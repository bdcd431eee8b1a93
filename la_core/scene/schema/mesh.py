"""The table of imported bodies in a scene file."""

from pathlib import PurePosixPath, PureWindowsPath
from typing import Annotated, Self

from pydantic import AfterValidator, model_validator

from la_core.scene.schema.types import Direction, Name, Positive, Real, Table, Text, Vector

FORMATS = (".obj", ".ply", ".stl", ".json")
FOLDER_FORMATS = (".ply", ".stl")  # of a folder with one body per file


def _within_the_scene_s_folder(file: str) -> str:
    if "://" in file:
        raise ValueError("is an address; a mesh is a file beside the scene")
    if PurePosixPath(file).is_absolute() or PureWindowsPath(file).drive or "\\" in file:
        raise ValueError("must be a path relative to the scene file, with forward slashes, so that scene and mesh can be moved together")
    if ".." in PurePosixPath(file).parts:
        raise ValueError("leads out of the scene's folder by `..`; put the mesh beside the scene or below it")
    return file


Pattern = Name  # as a shell's: `*`, `?` and `[...]`


class Turn(Table):
    """Rotation about an axis through the origin, degrees, right-handed."""

    axis: Direction
    degrees: Real


class Mesh(Table):
    """Convex bodies read from a file or a folder; scaled to m first, then turned about the origin, then shifted.

    `fixed` and `support` are shell-style patterns of the names that the bodies have in the file; all others are free.
    """

    file: Annotated[Name, AfterValidator(_within_the_scene_s_folder)]
    name: Text = ""  # goes before the bodies' names, for scenes with several meshes
    density: Positive | None = None
    fixed: tuple[Pattern, ...] = ()
    support: tuple[Pattern, ...] = ()
    scale: Positive = 1.0  # metres per unit of the file: 0.001 for mm
    turn: Turn | None = None
    shift: Vector = (0.0, 0.0, 0.0)

    @model_validator(mode="after")
    def _is_readable(self) -> Self:
        suffix = PurePosixPath(self.file).suffix.lower()
        if suffix and suffix not in FORMATS:
            raise ValueError(f"`file` must end in {', '.join(FORMATS)}, or be a folder of {' or '.join(FOLDER_FORMATS)} files")
        return self
