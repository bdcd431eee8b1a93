"""The scenes that are part of the program."""

from pathlib import Path

from la_core.errors import SceneError, nearest
from la_core.scene.scene import Scene, load_scene

FOLDER = Path(__file__).parents[1] / "scenes"
LONG = ("building_corner",)  # minutes of limit analysis and most of an hour of YADE


def names() -> list[str]:
    """Names of the shipped scenes, in order."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def find(scene: str) -> Path:
    """Path of a scene given by path or by a shipped scene's name; raises SceneError when there is neither."""
    path = Path(scene)
    if path.suffix == ".toml" or path.is_file():
        return path
    if scene not in names():
        if path.is_dir():
            raise SceneError(scene, "is a folder, not a scene file")
        raise SceneError(scene, "neither a file nor a shipped scene", hint=nearest(scene, names()) + "; `crosscheck scenes` lists them")
    return FOLDER / f"{scene}.toml"


def load(scene: Path | str) -> Scene:
    """A scene by its file's path or by a shipped scene's name; raises SceneError for anything a user must mend.

    >>> import la_core
    >>> la_core.load("two_pads").title
    'Right pad settles under a block'
    """
    return load_scene(find(str(scene)))
