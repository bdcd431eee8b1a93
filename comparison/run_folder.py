"""Files of a run's folder: one process works there at a time; the scene with its meshes lies beside the results made from them."""

import fcntl
import re
from collections.abc import Container, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from comparison.errors import FolderInUseError
from la_core.errors import SceneError
from la_core.exchange import write_whole
from la_core.scene import FOLDER_FORMATS, Scene

RESULTS = ("scene.toml", "case.h5", "run.h5", "yade.log", "comparison.json")  # no mesh, or folder of them, can have a result's name
ANIMATION = "animation.gif"  # of the results beside it: `crosscheck report` takes it into the page
REPORTS = ("report.html", "report.md", "report.json")  # beside the folders of scenes
LOCK = ".lock"
FIGURE_FORMATS = (".png", ".svg", ".pdf")  # what a figure's name may end in
FIGURES = ("assembly.png", "mechanisms.png", "reaction.png", "dissipation.png", "viewer.json")  # of a scene's results
TABLES = tuple(f"{stem}.{ending}" for stem in ("results", "costs") for ending in ("csv", "parquet"))
OF_CAMPAIGN = ("campaign.toml", "campaign.h5", "campaign.json", *TABLES, "outcome.json", ".call")
WRITTEN = frozenset((*RESULTS, *FIGURES, ANIMATION, *REPORTS, *OF_CAMPAIGN))  # names of this program's files in folders that it locks
_UNFINISHED = re.compile(r"(.+)\.\d+\.part", re.DOTALL)  # as `la_core.exchange.checksummed_file` names what it writes


def refuse_name(scene: Scene) -> None:
    """Raise SceneError for a scene whose name cannot be that of a folder of results."""
    if scene.name in (".", "..", *REPORTS) or "/" in scene.name:
        raise SceneError(str(scene.path), f'"{scene.name}" cannot name a folder of results', hint="rename the file")


def refuse_names(scenes: Iterable[Scene]) -> None:
    """Raise SceneError for scenes that cannot all have a folder of their own: each is named after its scene."""
    seen: dict[str, Scene] = {}
    for scene in scenes:
        refuse_name(scene)
        if scene.name in seen:
            raise SceneError(str(scene.path), f'has the same name as {seen[scene.name].path}, "{scene.name}"', hint="rename one file")
        seen[scene.name] = scene


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Hold a run's folder, which the system lets go of however the process ends; what another was writing when it ended is taken away.

    Folders below it are not touched: they are held by themselves, and another process may be writing there.
    Raises FolderInUseError where another process holds it.
    """
    with (folder / LOCK).open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise FolderInUseError(f"{folder}: another crosscheck works in this folder; wait for it, or take another by -o") from error
        _take_away_unfinished(folder, WRITTEN)
        yield


def _take_away_unfinished(folder: Path, names: Container[str]) -> None:
    """Delete what a process that was killed left of files of these names in this very folder, and nothing of the user's."""
    for path in folder.iterdir():
        found = _UNFINISHED.fullmatch(path.name)
        if found and found[1] in names and not path.is_dir():
            path.unlink(missing_ok=True)


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
        _take_away_unfinished(path.parent, (path.name,))
        write_whole(path, content)
    for parent in {(folder / mesh.path).parent for mesh in scene.meshes if mesh.of_folder}:
        for stray in parent.iterdir():
            if stray.suffix.lower() in FOLDER_FORMATS and stray not in own:
                stray.unlink()
