"""Lines that the basic shapes and paths of SVG draw."""

import math
from xml.etree import ElementTree

import numpy as np

from la_core.drawing.svg_coordinates import Viewport
from la_core.drawing.svg_paths import NUMBER, chords, path_lines

SHAPES = {"path", "polygon", "polyline", "rect", "line", "circle", "ellipse"}
FILLED = {"path", "polyline"}  # what may be open and yet filled


def shape_lines(
    element: ElementTree.Element, kind: str, viewport: Viewport, sagitta: float, curves: list[np.ndarray]
) -> list[tuple[np.ndarray, bool]]:
    """Lines (n, 2) of one of the SHAPES, in its own units, and whether each is closed.

    Parameters
    ----------
    element : Element
        The shape.
    kind : str
        Its kind, one of SHAPES.
    viewport : Viewport
        What its lengths refer to.
    sagitta : float
        Largest distance between a curve and its chords, in the units of the shape.
    curves : list of (n, 2) array
        Takes the chords of every curve, in the units of the shape.

    Raises
    ------
    ValueError
        A length is no number with a unit, or a path breaks the grammar of SVG.
    """

    def length(name: str, along: str = "") -> float:
        return viewport.length(element.get(name, "0"), f"a <{kind}> with {name}", along)

    if kind == "path":
        return path_lines(element.get("d", ""), sagitta, curves)
    if kind in ("polygon", "polyline"):
        numbers = [float(text) for text in NUMBER.findall(element.get("points", ""))]
        return [(np.array(numbers[: len(numbers) // 2 * 2]).reshape(-1, 2), kind == "polygon")]
    if kind == "line":
        return [(np.array([(length("x1", "x"), length("y1", "y")), (length("x2", "x"), length("y2", "y"))]), False)]
    if kind == "rect":
        place, size = np.array([length("x", "x"), length("y", "y")]), np.array([length("width", "x"), length("height", "y")])
        radii = _radii(element, viewport, size) if {"rx", "ry"} & element.attrib.keys() else np.zeros(2)
        corners, arcs = _rectangle(size, radii, sagitta) if size.min() > 0.0 else (np.zeros((0, 2)), [])
        curves += [place + arc for arc in arcs]
        return [(place + corners, True)] if len(corners) else []  # SVG draws nothing without a size
    radii = np.array([length("r")] * 2 if kind == "circle" else [length("rx", "x"), length("ry", "y")])
    count = chords(float(radii.max()), 2.0 * math.pi, sagitta)
    turn = 2.0 * np.pi * np.arange(count) / count
    points = np.array([length("cx", "x"), length("cy", "y")]) + radii * np.column_stack([np.cos(turn), np.sin(turn)])
    is_drawn = radii.min() > 0.0
    curves += [np.concatenate([points, points[:1]])] if is_drawn else []
    return [(points, True)] if is_drawn else []


def _radii(element: ElementTree.Element, viewport: Viewport, size: np.ndarray) -> np.ndarray:
    """Radii (2,) of the corners of a <rect>: one alone sets both, and neither is more than half a side."""
    given: list[float | None] = [None, None]
    for axis, (name, along) in enumerate((("rx", "x"), ("ry", "y"))):
        if (text := element.get(name, "auto").strip()) != "auto":
            given[axis] = viewport.length(text, f"a <rect> with {name}", along)
    first, second = given
    both = (first if first is not None else second or 0.0, second if second is not None else first or 0.0)
    return np.clip(both, 0.0, np.abs(size) / 2.0)


def _rectangle(size: np.ndarray, radii: np.ndarray, sagitta: float) -> tuple[np.ndarray, list[np.ndarray]]:
    """Corners (n, 2) of a rectangle from the origin, and its arcs; one so little rounded that it lies within `sagitta` stays sharp."""
    if radii.min() <= 0.0 or (math.sqrt(2.0) - 1.0) * radii.max() <= sagitta:
        return np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]) * size, []
    turn = np.linspace(0.0, np.pi / 2.0, chords(float(radii.max()), np.pi / 2.0, sagitta) + 1)
    arc = np.column_stack([np.cos(turn), np.sin(turn)]) * radii  # about the centre of a corner, from x to y
    inner = np.abs(size) / 2.0 - radii
    quarters = [
        size / 2.0 + quarter
        for quarter in (inner + arc, (-1.0, 1.0) * (inner + arc)[::-1], -(inner + arc), (1.0, -1.0) * (inner + arc)[::-1])
    ]
    points = np.concatenate(quarters)
    repeated = (np.abs(points - np.roll(points, 1, axis=0)) <= 1e-12 * np.abs(size).max()).all(axis=1)
    return np.asarray(points[~repeated]), quarters
