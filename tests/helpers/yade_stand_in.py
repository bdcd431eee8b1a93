"""Loads modules of `yade_scripts` without YADE: an empty stand-in replaces YADE while the modules load."""

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
    """Return the module `name` of `yade_scripts`. The stand-in does not stay in `sys.modules`."""
    sys.modules |= {one: StandIn(one) for one in YADE}
    try:
        return importlib.import_module(f"yade_scripts.{name}")
    finally:
        for one in YADE:
            del sys.modules[one]
