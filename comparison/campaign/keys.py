"""Keys of a campaign: those of its scenes (`la_core.scene.key_paths`), and those of the classic iteration's parameters."""

from typing import Any

from la_core.scene import put, steps

__all__ = ["CLASSIC", "get", "put", "steps"]

CLASSIC = "classic."  # begins the keys of the classic iteration's parameters, which are no keys of a scene


def get(data: Any, key: str) -> Any:
    """Value at a key of a scene's data, None where there is none."""
    for step in steps(key):
        try:
            data = data[step]
        except (KeyError, IndexError, TypeError):
            return None
    return data
