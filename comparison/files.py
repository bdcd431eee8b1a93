"""Files of a run's folder: each whole or absent, and the scene with its meshes beside the results made from them."""

import os
from pathlib import Path

from la_core.errors import SceneError
from la_core.scene import Scene
from la_core.schema_mesh import FOLDER_FORMATS

RESULTS = ("comparison.json",)  # no mesh can have a result's name


def write_text(path: Path, text: str) -> None:
    """Write a text file beside its name and rename, so that a crash leaves the old one or the new one."""
    write_bytes(path, text.encode("utf-8"))


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file beside its name and rename."""
    unwritten = path.with_name(f"{path.name}.{os.getpid()}.part")
    try:
        unwritten.write_bytes(content)
        unwritten.replace(path)
    finally:
        unwritten.unlink(missing_ok=True)


def copy_inputs(scene: Scene, folder: Path) -> None:
    """Write a scene and its meshes, as they were read, into a run's folder, where `crosscheck report` reads them again.

    A folder of meshes is left with those of the scene alone, for each file in it is a body.
    Raises SceneError for a mesh that has the name of a result.
    """
    for mesh in scene.meshes:
        if str(mesh.path) in RESULTS:
            raise SceneError(str(scene.path), f'the mesh "{mesh.path}" has the name of a result', hint="rename the file")
    write_text(folder / "scene.toml", scene.text)
    own = {folder / mesh.path: mesh.content for mesh in scene.meshes}
    for path, content in own.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        write_bytes(path, content)
    for parent in {(folder / mesh.path).parent for mesh in scene.meshes if mesh.of_folder}:
        for stray in parent.iterdir():
            if stray.suffix.lower() in FOLDER_FORMATS and stray not in own:
                stray.unlink()
