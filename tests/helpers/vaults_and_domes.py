"""A vault and a dome as the text of a scene."""

from typing import Any

import scenes

RIGHT = (1.0, 0.0, 0.0)


def vault(**changes: Any) -> str:
    entries = {
        "centre": (0.3, -1.0, 0.5), "radius": 2.0, "thickness": 0.4, "length": 3.0, "voussoirs": 7, "rings": 3, "bond": "running",
        "embrace": 140.0, "springers": {"left": "fixed", "right": "support"},
    }  # fmt: skip
    return scenes.table("[vault]", **{key: value for key, value in (entries | changes).items() if value is not None})


def dome(**changes: Any) -> str:
    entries = {
        "centre": (0.3, -1.0, 0.5), "radius": 2.0, "thickness": 0.4, "courses": 4, "lunes": 12, "embrace": 80.0, "oculus": 20.0,
        "sector": 120.0, "sides": "fixed", "support": (2, 3),
    }  # fmt: skip
    return scenes.table("[dome]", **{key: value for key, value in (entries | changes).items() if value is not None})


WHOLE = {"sector": 360.0, "sides": None}
CLOSED = WHOLE | {"oculus": 0.0}
