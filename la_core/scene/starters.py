"""Commented scenes from which users start their own; `crosscheck new` writes them, and the page of keys shows them."""

from pathlib import Path

from la_core.errors import SceneError, nearest

FOLDER = Path(__file__).parent / "starters"


def starter_names() -> list[str]:
    """Kinds of structures for which there is a commented scene, in alphabetical order."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def starter_text(kind: str) -> str:
    """The commented scene of a kind, as TOML; raises SceneError for a kind that there is not."""
    if kind not in starter_names():
        raise SceneError(f'"{kind}"', "no kind of structure", hint=nearest(kind, starter_names(), "kinds"))
    return (FOLDER / f"{kind}.toml").read_text(encoding="utf-8")


def starter_purpose(kind: str) -> str:
    """What the scene of a kind shows: the first line of its comment."""
    return starter_text(kind).splitlines()[0].removeprefix("# ")
