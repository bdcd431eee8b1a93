"""Files of a run's folder: results, and copies of the scene and its meshes; one process at a time works there."""

import errno
import fcntl
import os
import re
from collections.abc import Container, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from comparison.errors import FolderInUseError
from la_core.errors import SceneError, path_of
from la_core.exchange import write_whole
from la_core.scene import FOLDER_FORMATS, Scene

RESULTS = ("scene.toml", "case.h5", "run.h5", "yade.log", "comparison.json")  # names that no mesh and no folder of meshes may have
ANIMATION = "animation.gif"  # `crosscheck report` shows it with the results in its folder
REPORTS = ("report.html", "report.md", "report.json")  # beside the folders of scenes
LOCK = ".lock"
FIGURE_FORMATS = (".png", ".svg", ".pdf")  # allowed endings of a figure's name
MOVING_FORMATS = (".gif", ".mp4")  # allowed endings of an animation's name
LONGEST_NAME = 240  # bytes: file systems allow 255, and a second attempt adds to it
MOST_FRAMES = 50  # per second: a GIF counts hundredths of a second, and players refuse delays below two
FIGURES = ("assembly.png", "mechanisms.png", "reaction.png", "forces.png", "dissipation.png", "viewer.json")  # of a scene's results
TABLES = tuple(f"{stem}.{ending}" for stem in ("results", "costs") for ending in ("csv", "parquet"))
CASES = "cases"  # folder of the folders of a campaign's cases
OUTCOME = "outcome.json"  # of a case of a campaign, beside the folder of its results
HEAD = ("title", "project", "author", "date")  # parts of a report's head that a command may set
SECOND_ATTEMPT = "_harder"  # ends the name of the scene of a second attempt, and so of its folder
DEFINITION = "campaign.toml"  # copy of a campaign's file in its folder, from the start of the campaign on
OF_CAMPAIGN = (DEFINITION, "campaign.h5", "campaign.json", *TABLES, OUTCOME, ".call")
WRITTEN = frozenset((*RESULTS, *FIGURES, ANIMATION, *REPORTS, *OF_CAMPAIGN))  # names of this program's files in folders that it locks
RENAMED = "rename the file, or in Python choose another `name`"
_UNFINISHED = re.compile(r"(.+)\.\d+\.part", re.DOTALL)  # names of unfinished files, from `la_core.exchange.checksummed_file`


def refuse_name(scene: Scene) -> None:
    """Raise SceneError for a scene whose name cannot name a folder of results."""
    if scene.name in ("", ".", "..", *REPORTS) or "/" in scene.name:
        raise SceneError(str(scene.path), f'"{scene.name}" cannot name a folder of results', hint=RENAMED)
    if len(scene.name.encode()) > LONGEST_NAME:
        raise SceneError(str(scene.path), f"its name is longer than the {LONGEST_NAME} bytes of a folder's name", hint=RENAMED)


def refuse_names(scenes: Iterable[Scene]) -> None:
    """Raise SceneError for scenes of the same name: each scene needs a folder of results of its own."""
    seen: dict[str, Scene] = {}
    for scene in scenes:
        refuse_name(scene)
        if scene.name in seen:
            raise SceneError(str(scene.path), f'has the same name as {seen[scene.name].path}, "{scene.name}"', hint="rename one file")
        seen[scene.name] = scene


def is_second_attempt(scene: Scene) -> bool:
    """Return whether a scene is that of a second attempt (`--try-harder`), by its name and its effort; stored results have both, too.

    The effort alone does not suffice, because any scene may set it.
    """
    return scene.effort == "high" and scene.name.endswith(SECOND_ATTEMPT)


def name_in_results(comparison: Mapping[str, Any]) -> str:
    """Return the name of the folder that holds a comparison and its figures: the name of the scene, unless the folder was renamed."""
    return str(comparison.get("folder") or comparison.get("scene"))


def folder_of_results(folder: Path | str) -> Path:
    """Return the folder of results that an argument names; raises SceneError where it is no path, or leads through a file."""
    path = path_of("folder", folder)
    if files := [place for place in (path, *path.parents) if os.path.lexists(place) and not place.is_dir()]:
        what = "a file" if files[0].exists() else "a link that leads nowhere"
        raise SceneError("folder", f"{what}, {files[0]}, stands where a folder is needed", value=str(path), hint="choose another folder")
    return path


def require_ending(path: Path, endings: tuple[str, ...], what: str) -> None:
    """Raise SceneError for the path of a file to write with another ending; what: the file in a phrase, such as "a figure"."""
    if path.suffix not in endings:
        raise SceneError(str(path), f"the file name of {what} must end in {', '.join(endings[:-1])} or {endings[-1]}")


def require_folder_of(path: Path) -> None:
    """Raise SceneError for the path of a file to write that is itself a folder, or whose folder does not exist or is a file."""
    if path.parent.is_file():
        raise SceneError(str(path), f"{path.parent} is a file, and not a folder for another file", hint="name a file in a folder")
    if not path.parent.is_dir():
        raise SceneError(str(path), f"its folder {path.parent} does not exist", hint="make that folder first, or name another file")
    if path.is_dir():
        raise SceneError(str(path), "is a folder, and a file is to be written", hint="name a file in it, or another one")


def is_writable(folder: Path) -> bool:
    """Return whether this process may write in the folder; results on a read-only disk need no lock."""
    return os.access(folder, os.W_OK)


def make_writable(folder: Path) -> None:
    """Make a folder of results; raises OSError where it cannot be made, or where nothing can be written in it."""
    folder.mkdir(parents=True, exist_ok=True)
    if not is_writable(folder):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(folder))


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Lock a run's folder for this process, and delete the files that a killed process left unfinished there.

    The system releases the lock however the process ends. Folders inside have locks of their own and are not touched, because another
    process may be writing there. Raises FolderInUseError where another process holds the lock.
    """
    lock = os.open(folder / LOCK, os.O_RDWR | os.O_CREAT, 0o666)  # write-only would wait for a reader if the file were a pipe
    try:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise FolderInUseError(
                f"{folder}: the folder is in use by another crosscheck process or thread; "
                "wait, or choose another folder (-o, in Python `folder`)"
            ) from error
        _take_away_unfinished(folder, WRITTEN)
        yield
    finally:
        os.close(lock)


def _take_away_unfinished(folder: Path, names: Container[str]) -> None:
    """Delete unfinished files of these names in this folder, as a killed process leaves them, and no file of the user's."""
    for path in folder.iterdir():
        unfinished = _UNFINISHED.fullmatch(path.name)
        if unfinished and unfinished[1] in names and not path.is_dir():
            path.unlink(missing_ok=True)


def read_text(path: Path) -> str:
    """Return the text of a stored file; raises OSError for a path that is no file, because reading a pipe might never end."""
    if path.exists() and not path.is_file():
        raise OSError(errno.EINVAL, "not a file", str(path))
    return path.read_text(encoding="utf-8")


def write_text(path: Path, text: str) -> None:
    """Write a text file; after a crash it holds the old text or the new one, never a part."""
    write_whole(path, text.encode("utf-8"))


def copy_inputs(scene: Scene, folder: Path) -> None:
    """Copy a scene and its meshes, as they were read, into a run's folder, where `crosscheck report` reads them again.

    Other meshes are deleted from a copied folder of meshes, because each file there is a body of the scene.
    Raises SceneError for a mesh that has the name of a result, or that a link would copy out of the folder.
    """
    for mesh in scene.meshes:
        if mesh.path.parts[0] in RESULTS:
            raise SceneError(str(scene.path), f'the mesh "{mesh.path}" has the name of a result', hint="rename the file")
        if not (folder / mesh.path).parent.resolve().is_relative_to(folder.resolve()):
            raise SceneError(
                str(scene.path), f'the mesh "{mesh.path}" would be copied out of {folder} through a link', hint="remove the link"
            )
    write_text(folder / "scene.toml", scene.text)
    copies = {folder / mesh.path: mesh.content for mesh in scene.meshes}
    for path, content in copies.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        _take_away_unfinished(path.parent, (path.name,))
        write_whole(path, content)
    for parent in {(folder / mesh.path).parent for mesh in scene.meshes if mesh.of_folder}:
        for stray in parent.iterdir():
            if stray.suffix.lower() in FOLDER_FORMATS and stray not in copies:
                stray.unlink()
