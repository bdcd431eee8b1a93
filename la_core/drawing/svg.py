"""Outlines of an SVG file: paths and shapes, with groups, transformations and the unit of the page.

A drawing hangs from the upper left corner of its page; z is up, so heights are negative. Only what draws a line is
read: text, images, clones and styles in sheets are not.
"""

import math
import re
from xml.etree import ElementTree

import numpy as np

from la_core.drawing.outlines import UNITS, Drawn
from la_core.drawing.svg_paths import path_lines

NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
LENGTH = re.compile(rf"\s*({NUMBER.pattern})\s*([a-z%]*)\s*$")
TRANSFORM = re.compile(r"(matrix|translate|scale|rotate|skewX|skewY)\s*\(([^)]*)\)")
SILENT = {"defs", "metadata", "namedview", "title", "desc", "style", "clipPath", "mask", "symbol", "marker", "pattern", "linearGradient"}
DEEPEST = 100  # groups within groups
PAGE_UNITS = {**UNITS, "pt": 0.0254 / 72.0, "pc": 0.0254 / 6.0}
LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
CIRCLE_CHORDS = 8  # at least


def read_svg(content: bytes, unit: float | None, sagitta: float) -> Drawn:
    """Outlines and lines of an SVG file; parameters and errors are those of `read_outlines`."""
    if b"<!ENTITY" in content:  # nested entities can fill the memory
        raise ValueError("defines entities, which no drawing needs; save it again as plain SVG")
    try:
        root = ElementTree.fromstring(content)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise ValueError(f"is not a whole SVG file: {error}") from error
    if _tag(root) != "svg":
        raise ValueError(f"is not an SVG file: its first element is <{_tag(root)[:40]}>")
    scale = unit or _unit(root)
    if scale is None:
        raise ValueError('does not say its unit, such as width = "2000mm"; state it: unit = "mm"')
    drawn = Drawn(scale)
    try:
        _walk(root, drawn, np.diag([scale, -scale, 1.0]), ("", "none"), sagitta, 0)
    except (ValueError, OverflowError) as error:
        raise ValueError(f"{error}") from error
    return drawn


def _unit(root: ElementTree.Element) -> float | None:
    """Metres per unit of the drawing, from the width of the page and its view box; None where they do not say."""
    width, box = LENGTH.match(root.get("width", "")), NUMBER.findall(root.get("viewBox", ""))
    if width is None or width[2] not in PAGE_UNITS:
        return None
    metres = float(width[1]) * PAGE_UNITS[width[2]]
    across = float(box[2]) if len(box) == 4 else float(width[1])
    return metres / across if metres > 0.0 and across > 0.0 else None


def _tag(element: ElementTree.Element) -> str:
    return element.tag.rsplit("}", 1)[-1] if isinstance(element.tag, str) else ""


def _walk(element: ElementTree.Element, drawn: Drawn, matrix: np.ndarray, style: tuple[str, str], sagitta: float, depth: int) -> None:
    """Add an element and all below it; `style` is the layer and the colour of the group around it."""
    if depth > DEEPEST:
        raise ValueError(f"has groups more than {DEEPEST} deep")
    kind = _tag(element)
    if kind in SILENT or _property(element, "display") == "none":
        return
    matrix = matrix @ _matrix(element.get("transform", ""))
    layer, colour = style
    if kind == "g":
        layer = element.get(LABEL) or element.get("id") or layer
    colour = _colour(element) or colour
    lines = _lines(element, kind, sagitta / max(math.sqrt(abs(np.linalg.det(matrix[:2, :2]))), 1e-300))
    if lines is None and kind not in ("svg", "g", "a", "switch"):
        drawn.ignore(kind)
    for points, closed in lines or ():
        drawn.add(points @ matrix[:2, :2].T + matrix[:2, 2], closed, layer, colour)
    for child in element:
        _walk(child, drawn, matrix, (layer, colour), sagitta, depth + 1)


def _property(element: ElementTree.Element, name: str) -> str:
    """A property of the style attribute, or an attribute of this name; "" for neither."""
    for entry in element.get("style", "").split(";"):
        key, _, value = entry.partition(":")
        if key.strip() == name:
            return value.strip()
    return element.get(name, "").strip()


def _colour(element: ElementTree.Element) -> str:
    fill = _property(element, "fill").lower()
    return fill if fill and fill != "none" else _property(element, "stroke").lower()


def _matrix(text: str) -> np.ndarray:
    """Matrix (3, 3) of a transform attribute."""
    whole = np.eye(3)
    for name, arguments in TRANSFORM.findall(text):
        numbers = [float(number) for number in NUMBER.findall(arguments)]
        whole = whole @ _single(name, numbers)
    return whole


def _single(name: str, numbers: list[float]) -> np.ndarray:
    counts = {"matrix": (6,), "translate": (1, 2), "scale": (1, 2), "rotate": (1, 3), "skewX": (1,), "skewY": (1,)}[name]
    if len(numbers) not in counts:
        raise ValueError(f"has a transform {name} with {len(numbers)} numbers")
    if name == "matrix":
        a, b, c, d, e, f = numbers
        return np.array([[a, c, e], [b, d, f], [0.0, 0.0, 1.0]])
    if name == "translate":
        return np.array([[1.0, 0.0, numbers[0]], [0.0, 1.0, (*numbers, 0.0)[1]], [0.0, 0.0, 1.0]])
    if name == "scale":
        return np.diag([numbers[0], numbers[-1], 1.0])
    angle = math.radians(numbers[0])
    if name == "rotate":
        turn = np.array([[math.cos(angle), -math.sin(angle), 0.0], [math.sin(angle), math.cos(angle), 0.0], [0.0, 0.0, 1.0]])
        there = _single("translate", numbers[1:] or [0.0, 0.0])
        return there @ turn @ _single("translate", [-number for number in numbers[1:]] or [0.0, 0.0])
    shear = np.eye(3)
    shear[(0, 1) if name == "skewX" else (1, 0)] = math.tan(angle)
    return shear


def _lines(element: ElementTree.Element, kind: str, sagitta: float) -> list[tuple[np.ndarray, bool]] | None:
    """Lines (n, 2) that an element draws, in its own units, and whether each is closed; None for an element that draws none."""

    def number(name: str) -> float:
        found = NUMBER.match(element.get(name, "0").strip())
        if found is None:
            raise ValueError(f'has a <{kind}> with {name} = "{element.get(name, "")[:40]}", which is no number')
        return float(found[0])

    if kind == "path":
        return path_lines(element.get("d", ""), sagitta)
    if kind in ("polygon", "polyline"):
        numbers = [float(text) for text in NUMBER.findall(element.get("points", ""))]
        return [(np.array(numbers[: len(numbers) // 2 * 2]).reshape(-1, 2), kind == "polygon")]
    if kind == "rect":
        x, y, width, height = (number(name) for name in ("x", "y", "width", "height"))
        return [(np.array([(x, y), (x + width, y), (x + width, y + height), (x, y + height)]), True)]
    if kind == "line":
        return [(np.array([(number("x1"), number("y1")), (number("x2"), number("y2"))]), False)]
    if kind in ("circle", "ellipse"):
        radii = (number("r"),) * 2 if kind == "circle" else (number("rx"), number("ry"))
        turn = 2.0 * np.pi * np.arange(chords(max(radii), 2.0 * np.pi, sagitta)) / chords(max(radii), 2.0 * np.pi, sagitta)
        return [(np.column_stack([number("cx") + radii[0] * np.cos(turn), number("cy") + radii[1] * np.sin(turn)]), True)]
    return None


def chords(radius: float, angle: float, sagitta: float) -> int:
    """Number of equal chords that stay within `sagitta` of an arc; at least CIRCLE_CHORDS for a circle, at most 1000."""
    if not 0.0 < sagitta < radius:
        return CIRCLE_CHORDS
    each = 2.0 * math.acos(1.0 - sagitta / radius)
    return min(1000, max(1, math.ceil(abs(angle) / each), math.ceil(CIRCLE_CHORDS * abs(angle) / (2.0 * math.pi))))
