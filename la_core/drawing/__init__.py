"""Elevations from drawings: closed outlines with their layers and colours, from DXF and SVG files."""

from la_core.drawing.cleaning import Cleaned, cleaned, straightened
from la_core.drawing.outlines import UNITS, Drawn, LayerCount, OpenOutline, Outline, SharedAreas, by_layer
from la_core.drawing.reading import ADVICE, DRAWING_FORMATS, read_outlines
from la_core.drawing.remarks import lacking_words, remarks, unseen_words, why_none

__all__ = [
    "ADVICE",
    "DRAWING_FORMATS",
    "UNITS",
    "Cleaned",
    "Drawn",
    "LayerCount",
    "OpenOutline",
    "Outline",
    "SharedAreas",
    "by_layer",
    "cleaned",
    "lacking_words",
    "read_outlines",
    "remarks",
    "straightened",
    "unseen_words",
    "why_none",
]
