"""The scenes and campaigns that come with the program, as the commands name them."""

from pathlib import Path

from la_core.scene import FOLDER, find, names

__all__ = ["FOLDER", "LONG", "campaigns", "find", "names"]

LONG = ("building_corner",)  # minutes of limit analysis and most of an hour of YADE


def campaigns() -> dict[str, Path]:
    """Campaign files by name."""
    return {path.stem: path for path in sorted((Path(__file__).parent / "campaigns").glob("*.toml"))}
