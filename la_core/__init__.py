"""Rigid-block limit analysis of dry-joint structures on a moving support.

The stable names:

- `load`, `names`: read a scene file or a shipped scene; list the shipped ones.
- `build`, `variant`: make a `Scene` from tables, or from another scene with some keys changed.
- `solve`: solve a scene; returns an `Answer` with a `Status`.
- `SceneError`: raised for an invalid scene or argument.

All other names may change. A module is loaded only when a name in it is used, so that YADE's own interpreter can load
`la_core.exchange` alone. Type checkers read the stable names in `__init__.pyi`.
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
