"""The scenes that come with the program, as the commands name them."""

from la_core.shipped import FOLDER, find, names

__all__ = ["FOLDER", "LONG", "find", "names"]

LONG = ("building_corner",)  # minutes of limit analysis and most of an hour of YADE
