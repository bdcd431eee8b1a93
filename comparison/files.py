"""Files of a run's folder: one process works there at a time; the scene with its meshes lies beside the results made from them."""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from la_core.errors import SceneError
from la_core.scene import Scene
from la_core.schema_mesh import FOLDER_FORMATS
from la_core.sealed_file import write_whole

RESULTS = ("scene.toml", "case.h5", "run.h5", "yade.log", "comparison.json")  # no mesh, or folder of them, can have a result's name
ANIMATION = "animation.gif"  # of the results beside it: `crosscheck report` takes it into the page
REPORTS = ("report.html", "report.md", "report.json")  # beside the folders of scenes
LOCK = ".lock"
UNFINISHED = "*.[0-9]*.part"  # what a process that was killed left


class FolderInUseError(Exception):
    """Another process works in a run's folder."""


def refuse_name(scene: Scene) -> None:
    """Raise SceneError for a scene whose name cannot be that of a folder of results."""
    if scene.name in (".", "..", *REPORTS) or "/" in scene.name:
        raise SceneError(str(scene.path), f'"{scene.name}" cannot name a folder of results', hint="rename the file")


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Hold a run's folder, which the system lets go of however the process ends; what another was writing when it ended is taken away.

    Raises FolderInUseError where another process holds it.
    """
    with (folder / LOCK).open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise FolderInUseError(f"{folder}: another crosscheck works in this folder; wait for it, or take another by -o") from error
        for unfinished in folder.rglob(UNFINISHED):
            unfinished.unlink()
        yield


def write_text(path: Path, text: str) -> None:
    """Write a text file that a crash leaves as it was or whole."""
    write_whole(path, text.encode("utf-8"))


def copy_inputs(scene: Scene, folder: Path) -> None:
    """Write a scene and its meshes, as they were read, into a run's folder, where `crosscheck report` reads them again.

    A folder of meshes is left with those of the scene alone, for each file in it is a body.
    Raises SceneError for a mesh that has the name of a result.
    """
    for mesh in scene.meshes:
        if mesh.path.parts[0] in RESULTS:
            raise SceneError(str(scene.path), f'the mesh "{mesh.path}" has the name of a result', hint="rename the file")
        if not (folder / mesh.path).parent.resolve().is_relative_to(folder.resolve()):
            raise SceneError(
                str(scene.path), f'the mesh "{mesh.path}" would be copied out of {folder} through a link', hint="remove the link"
            )
    write_text(folder / "scene.toml", scene.text)
    own = {folder / mesh.path: mesh.content for mesh in scene.meshes}
    for path, content in own.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, content)
    for parent in {(folder / mesh.path).parent for mesh in scene.meshes if mesh.of_folder}:
        for stray in parent.iterdir():
            if stray.suffix.lower() in FOLDER_FORMATS and stray not in own:
                stray.unlink()
