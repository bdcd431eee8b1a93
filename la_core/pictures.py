"""Pictures of scenes and answers. The package `comparison` draws them and is loaded only when a picture is requested."""

from importlib import import_module
from typing import Any

from la_core.errors import SceneError


def picture(what: Any, name: str = "") -> Any:
    """A picture of a scene or of an answer, by `comparison.draw`; raises SceneError where that package is missing."""
    try:
        draw = import_module("comparison").draw
    except ModuleNotFoundError as error:
        raise SceneError("draw", f"needs the module {error.name}, which is not installed", hint="install crosscheck-masonry") from error
    return draw(what, name)
