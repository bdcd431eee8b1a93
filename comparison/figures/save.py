"""A figure as a file: PNG, SVG or PDF, the same bytes for the same figure."""

import io
import warnings
from pathlib import Path

from matplotlib.figure import Figure

from la_core.exchange import write_whole

DPI = 130


def save(figure: Figure, path: Path) -> None:
    """Write a figure in the format its name ends with, PNG, SVG or PDF; the same figure gives the same PNG, no date is stored."""
    write_whole(path, rendered(figure, path.suffix))


def rendered(figure: Figure, suffix: str) -> bytes:
    """What a file of a figure holds whose name ends with ".png", ".svg" or ".pdf"."""
    metadata = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(suffix, {"Software": None})
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph")  # a letter that the font lacks is drawn as a box
        content = io.BytesIO()
        figure.savefig(content, format=suffix[1:], dpi=DPI, metadata=metadata)
    return content.getvalue()
