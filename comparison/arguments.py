"""Kinds of arguments of the command line; each raises argparse's error for a text that is none."""

import argparse
from pathlib import Path

FIGURE_FORMATS = (".png", ".svg", ".pdf")


def figure(text: str) -> Path:
    """A figure's path, whose ending names its format."""
    path = Path(text)
    if path.suffix not in FIGURE_FORMATS:
        raise argparse.ArgumentTypeError(f"{text}: a figure's name ends in {', '.join(FIGURE_FORMATS)}")
    return path


def seconds(text: str) -> float:
    """A positive time."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text}: must be a positive number of seconds")
    return value
