"""Elevations from drawings: closed outlines with their layers and colours, from DXF and SVG files."""

from la_core.drawing.cleaning import Cleaned, cleaned, straightened
from la_core.drawing.outlines import (
    HIDDEN,
    UNITS,
    Drawn,
    LeftOut,
    OpenOutline,
    Outline,
    across_words,
    around_words,
    open_words,
    stray_words,
)
from la_core.drawing.reading import DRAWING_FORMATS, read_outlines

__all__ = [
    "DRAWING_FORMATS",
    "HIDDEN",
    "UNITS",
    "Cleaned",
    "Drawn",
    "LeftOut",
    "OpenOutline",
    "Outline",
    "across_words",
    "around_words",
    "cleaned",
    "open_words",
    "read_outlines",
    "straightened",
    "stray_words",
]
