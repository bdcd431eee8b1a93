"""Blocks of a `[[mesh]]` table from imported bodies, identical to blocks that a user types one by one."""

import importlib.util
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from pathlib import Path, PurePosixPath

import numpy as np
import scipy

from la_core.errors import OF_LOCALE, SceneError, extra_hint, nearest, real_path, shortened
from la_core.scene.generators.mesh_formats import surfaces
from la_core.scene.generators.mesh_surface import MOST_DENT, Surface, shape_of
from la_core.scene.generators.wall import NamedShape
from la_core.scene.schema.mesh import FOLDER_FORMATS, FORMATS, Mesh
from la_core.scene.schema.types import LARGEST_FILE, LONGEST_NAME, MOST_BLOCKS

__all__ = ["MOST_DENT", "MeshFile", "extent", "mesh_blocks", "read_files"]


@dataclass(frozen=True)
class MeshFile:
    """A mesh file of a scene.

    Attributes
    ----------
    path : PurePosixPath
        Path relative to the scene's folder.
    content : bytes
        Content of the file.
    of_folder : bool
        Whether it is one of several files in a folder with one body each.
    """

    path: PurePosixPath
    content: bytes
    of_folder: bool


def read_files(mesh: Mesh, folder: Path) -> list[MeshFile]:
    """Read the file of a mesh table, or all files of its folder in the order of their names; `folder` is the scene's.

    Raises SceneError for a file that is missing, unreadable or too large, and for a link that leads out of the
    scene's folder.
    """
    root = folder.resolve()
    path = root / mesh.file
    try:
        if not real_path(path).is_relative_to(root):
            raise SceneError(_where(mesh), "is a link that leads out of the scene's folder", hint="put a copy of the mesh there")
        if not path.is_dir():
            if path.suffix.lower() not in FORMATS or (path.exists() and not path.is_file()):
                raise SceneError(_where(mesh), "neither a mesh file nor a folder of them")
            return [MeshFile(PurePosixPath(mesh.file), _content(mesh, path, LARGEST_FILE), of_folder=False)]
        members = sorted(member for member in path.iterdir() if member.suffix.lower() in FOLDER_FORMATS)
        if not members:
            raise SceneError(_where(mesh), f"a folder without {' or '.join(FOLDER_FORMATS)} files")
        if any(not (member.is_file() and member.resolve().is_relative_to(root)) for member in members):
            raise SceneError(_where(mesh), "contains an entry that is not a file, or a link that leads out of the scene's folder")
        left, files = LARGEST_FILE, []
        for member in members:
            files.append(MeshFile(PurePosixPath(mesh.file) / member.name, _content(mesh, member, left), of_folder=True))
            left -= len(files[-1].content)
    except (OSError, ValueError) as error:  # Python raises ValueError for an impossible file name
        reason = getattr(error, "strerror", None) or error
        hint = OF_LOCALE if isinstance(error, UnicodeEncodeError) else "the path is relative to the scene file"
        raise SceneError(_where(mesh), f"cannot be read: {reason}", hint=hint) from error
    return files


def _content(mesh: Mesh, path: Path, largest: int) -> bytes:
    with path.open("rb") as file:
        content = file.read(largest + 1)
    if len(content) > largest:
        rule = f"larger than {LARGEST_FILE} bytes in all"
        raise SceneError(_where(mesh), rule, hint="write fewer or coarser bodies, or binary files")
    return content


def mesh_blocks(mesh: Mesh, files: list[MeshFile], tolerance: float) -> list[NamedShape]:
    """Blocks of a mesh table from the contents of its files, in order; a SceneError names file, body and defect.

    tolerance: largest error of the coordinates, m; 0 for none.
    """
    bodies = [(file, surface) for file in files for surface in _surfaces(mesh, file)]
    if not bodies:
        raise SceneError(_where(mesh), "contains no body with faces")
    if len(bodies) > MOST_BLOCKS:
        raise SceneError(_where(mesh), f"contains {len(bodies)} bodies; at most {MOST_BLOCKS} are allowed")
    roles = _roles(mesh, [surface for _, surface in bodies])
    return list(_shapes(mesh, bodies, roles, tolerance))


def extent(mesh: Mesh, files: list[MeshFile]) -> float:
    """Longest side of the box around all bodies, in the unit of the files; 0 for none."""
    vertices = np.concatenate([surface.vertices for file in files for surface in _surfaces(mesh, file)] or [np.zeros((1, 3))])
    vertices = vertices[np.isfinite(vertices).all(axis=1)]
    return float(np.ptp(vertices, axis=0).max()) if len(vertices) else 0.0


def _surfaces(mesh: Mesh, file: MeshFile) -> list[Surface]:
    suffix = file.path.suffix.lower()
    if suffix in FOLDER_FORMATS and importlib.util.find_spec("trimesh") is None:
        raise SceneError(_where(mesh), f"{suffix} files are read by trimesh, which is not installed", hint=extra_hint("mesh", "trimesh"))
    try:
        return surfaces(suffix, file.content, file.path.stem)
    except ValueError as error:
        raise SceneError(f'mesh "{file.path}"', str(error)) from error


def _shapes(mesh: Mesh, bodies: list[tuple[MeshFile, Surface]], roles: list[str], tolerance: float) -> Iterator[NamedShape]:
    turn = np.eye(3) if mesh.turn is None else _rotation(mesh)
    for (file, surface), role in zip(bodies, roles, strict=True):
        where, name = f'mesh "{file.path}": body "{shortened(surface.name)}"', f"{mesh.name} {surface.name}".strip()
        if not 0 < len(name) <= LONGEST_NAME or not name.isprintable():
            raise SceneError(where, f"a body's name must be printable text of at most {LONGEST_NAME} characters")
        placed = replace(surface, vertices=mesh.scale * surface.vertices @ turn.T + np.array(mesh.shift))
        try:
            shape, made_convex = shape_of(placed, tolerance)
            yield NamedShape(name, role, mesh.density, shape, made_convex=made_convex)
        except ValueError as error:
            raise SceneError(where, str(error)) from error


def _rotation(mesh: Mesh) -> np.ndarray:
    assert mesh.turn is not None  # the caller checks it
    axis = np.array(mesh.turn.axis) / np.abs(mesh.turn.axis).max()
    return scipy.spatial.transform.Rotation.from_rotvec(mesh.turn.degrees * axis / np.linalg.norm(axis), degrees=True).as_matrix()


def _roles(mesh: Mesh, bodies: list[Surface]) -> list[str]:
    """Role of every body by the patterns. A body marked as held in its file is fixed, unless a pattern makes it a support."""
    names = [body.name for body in bodies]
    matched = {"fixed": [False] * len(names), "support": [False] * len(names)}
    for role, patterns in (("fixed", mesh.fixed), ("support", mesh.support)):
        for pattern in patterns:
            hits = [fnmatchcase(name, pattern) for name in names]
            if not any(hits):
                raise SceneError(
                    f"{_where(mesh)}: {role}", "no name of a body matches", value=pattern, hint=nearest(pattern, names, "names")
                )
            matched[role] = [old or hit for old, hit in zip(matched[role], hits, strict=True)]
    both = [name for name, *hits in zip(names, *matched.values(), strict=True) if all(hits)]
    if both:
        raise SceneError(f'{_where(mesh)}: body "{both[0]}"', "matches a pattern of `fixed` and one of `support`; a body has one role")
    rows = zip(bodies, matched["fixed"], matched["support"], strict=True)
    return ["support" if support else "fixed" if fixed or body.held else "free" for body, fixed, support in rows]


def _where(mesh: Mesh) -> str:
    return f'mesh "{mesh.file}"'
