"""Rigid-block limit analysis of dry-joint structures on a moving support.

A module is loaded only when a name in it is used, so that YADE's own interpreter can load `la_core.exchange` alone.
The names in `__all__` are stable; type checkers read them in `__init__.pyi`.
"""

from importlib import import_module as _load

_HOMES = {
    "Answer": "analysis",
    "Scene": "scene",
    "SceneError": "errors",
    "Status": "limit",
    "build": "scene",
    "load": "scene",
    "names": "scene",
    "solve": "analysis",
    "variant": "scene",
}
__all__ = sorted(_HOMES)  # noqa: PLE0605


def __getattr__(name: str) -> object:
    """Load a stable name from the room that defines it (PEP 562)."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(_load(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return [*globals(), *__all__]
