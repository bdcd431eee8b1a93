"""What decides in `yade_scripts`, loaded where there is no YADE: an empty stand-in has its place while the modules load."""

import importlib
import sys
from types import ModuleType
from typing import Any

YADE = ("yade", "yade.utils", "yade.minieigenHP")


class StandIn(ModuleType):
    """A module in which every name is a class without content."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return type(name, (), {})


def without_yade(name: str) -> Any:
    """Return the module `name` of `yade_scripts`; nothing of the stand-in stays behind in `sys.modules`."""
    sys.modules |= {one: StandIn(one) for one in YADE}
    try:
        return importlib.import_module(f"yade_scripts.{name}")
    finally:
        for one in YADE:
            del sys.modules[one]
