"""The shipped scenes, and commented scenes from which users start their own."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from la_core.errors import SceneError, nearest
from la_core.scene.scene import Scene, load_scene

FOLDER = Path(__file__).parents[1] / "scenes"
STARTERS = Path(__file__).parent / "starters"
LONG = ("building_corner",)  # some minutes of limit analysis and 20 to 40 minutes of YADE


def names() -> list[str]:
    """Return the names of the shipped scenes.

    Returns
    -------
    list of str
        Names in alphabetical order; `load` takes each of them.

    Examples
    --------
    >>> import la_core
    >>> "two_pads" in la_core.names()
    True
    """
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def place(name: str) -> Path:
    """Path of a shipped scene."""
    return FOLDER / f"{name}.toml"


def find(scene: str, folder: Path = Path()) -> Path:
    """Path of a scene file, given by a path relative to `folder`, with or without `.toml`, or by the name of a shipped scene.

    Raises SceneError where neither exists, where the operating system refuses the path (such as a name that is too long), and where a
    shipped scene and a file in the folder have the same name.
    """
    hint = "give the path of a scene file, or a shipped scene; `crosscheck scenes` lists them, in Python `la_core.names()`"
    if not scene:
        raise SceneError('""', "names no scene", hint=hint)
    try:
        return _found(scene, folder / scene)
    except OSError as error:
        raise SceneError("scene", f"cannot be read: {error.strerror}", value=scene, hint=hint) from error


def _found(scene: str, path: Path) -> Path:
    complete = path.with_name(f"{path.name}.toml") if path.name else path
    if scene in names():
        refuse_two(scene, place(scene), (path, complete), "scene")
        return place(scene)
    if path.is_file() or path.suffix == ".toml":
        return path
    if complete.is_file():
        return complete
    if path.is_dir():
        raise SceneError(scene, "is a folder, not a scene file")
    guess = nearest(scene, names(), "scenes")
    hint = f"{guess}{'' if guess.endswith('?') else ';'} `crosscheck scenes` lists them, in Python `la_core.names()`"
    raise SceneError(scene, "neither a file nor a shipped scene", hint=hint)


def refuse_two(name: str, shipped: Path, here: Iterable[Path], kind: str) -> None:
    """Raise SceneError where a path in `here` is a file other than the shipped one of this name. kind: "scene" or "campaign"."""
    if file := next((path for path in here if path.is_file() and not path.samefile(shipped)), None):
        hint = f'"{file}" is the file; rename the file to use the shipped {kind}'
        raise SceneError(name, f"names both a shipped {kind} and a file here", hint=hint)


def load(scene: Scene | Path | str) -> Scene:
    """Read and validate a scene file.

    Parameters
    ----------
    scene : Scene, Path or str
        Path of a scene file (TOML), or the name of a shipped scene; a scene is returned as it is.

    Returns
    -------
    Scene
        Validated scene, ready for `solve`.

    Raises
    ------
    SceneError
        The file is missing, is not valid TOML, or breaks a rule of the schema; or the argument names no scene.

    Examples
    --------
    >>> import la_core
    >>> la_core.load("two_pads").title
    'Right pad settles under a block'
    """
    if isinstance(scene, Scene):
        return scene
    if not isinstance(scene, Path | str):
        rule = "must be a scene, the path of a scene file, or the name of a shipped scene"
        raise SceneError("scene", rule, hint=f"it is of the type {type(scene).__name__}")
    if "\n" in str(scene):
        hint = "for the text of a scene, `la_core.build(tomllib.loads(text))`"
        raise SceneError("scene", "must be the path of a scene file, or the name of a shipped scene", value=scene, hint=hint)
    loaded = load_scene(find(str(scene)))
    return replace(loaded, path=loaded.path.absolute())  # variants find their meshes from any working directory


def starter_names() -> list[str]:
    """Kinds of structures with a commented scene, in alphabetical order."""
    return sorted(path.stem for path in STARTERS.glob("*.toml"))


def starter_text(kind: str) -> str:
    """The commented scene of a kind, as TOML; raises SceneError for an unknown kind."""
    if kind not in starter_names():
        raise SceneError(f'"{kind}"', "no kind of structure", hint=nearest(kind, starter_names(), "kinds"))
    return (STARTERS / f"{kind}.toml").read_text(encoding="utf-8")


def starter_purpose(kind: str) -> str:
    """Purpose of the commented scene of a kind: the first line of its comment."""
    return starter_text(kind).splitlines()[0].removeprefix("# ")
