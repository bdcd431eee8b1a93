"""Blocks from files, and the repair of a scene's geometry within its tolerance."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from la_core.repair import Repairs, close_joints
from la_core.scene.generators.drawings import DrawnBlocks, drawing_blocks, read_drawing
from la_core.scene.generators.mesh import MeshFile, mesh_blocks, read_files
from la_core.scene.generators.wall import NamedShape
from la_core.scene.schema.scene_file import SceneFile

LEAST_TOLERANCE = 1e-4  # m: where open joints are closed without a stated tolerance


def imported_blocks(file: SceneFile, folder: Path) -> tuple[list[NamedShape], tuple[MeshFile, ...], tuple[DrawnBlocks, ...]]:
    """Blocks of all meshes and drawings of a scene in `folder`, the files read, and what became of the drawings."""
    shapes: list[NamedShape] = []
    files: list[MeshFile] = []
    drawn: list[DrawnBlocks] = []
    for mesh in file.mesh:
        content = read_files(mesh, folder)
        files += content
        shapes += mesh_blocks(mesh, content)
    for drawing in file.drawing:
        files.append(read_drawing(drawing, folder))
        blocks, became = drawing_blocks(drawing, files[-1], file.geometry.tolerance or 0.0)
        shapes += blocks
        drawn.append(became)
    return shapes, tuple(files), tuple(drawn)


def repaired(named: list[NamedShape], file: SceneFile) -> tuple[list[NamedShape], Repairs | None]:
    """The blocks with closed joints, and what was changed; None where the scene asks for no repair."""
    joints = np.array([one.joint for one in named])
    if file.geometry.tolerance is None and not joints.any():
        return named, None
    tolerance = file.geometry.tolerance or min(LEAST_TOLERANCE, float(joints.max()) / 10.0)
    shapes, repairs = close_joints([one.name for one in named], [one.shape for one in named], tolerance, joints)
    return [replace(one, shape=shape) for one, shape in zip(named, shapes, strict=True)], repairs
