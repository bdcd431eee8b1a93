"""Outlines of an SVG file: paths and shapes, with groups, styles, transformations and the unit of the page.

The origin is the upper left corner of the page and z points up, so heights on the page are negative. Only paths and
shapes are read; texts and images are not.
"""

import itertools
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from xml.etree import ElementTree

import numpy as np
import shapely

from la_core.drawing.outlines import ABSENT, HIDDEN, REFERENCE, Drawn
from la_core.drawing.svg_coordinates import Viewport, nested, page_of, transformation
from la_core.drawing.svg_shapes import FILLED, SHAPES, shape_lines
from la_core.drawing.svg_styles import MOVES, SIZES, UNREAD, Paint, StyleSheet, is_zero, sheet_of

SILENT = {"defs", "metadata", "namedview", "title", "desc", "style", "clipPath", "mask", "symbol", "marker", "pattern", "linearGradient"}
ASKS = {"systemLanguage", "requiredExtensions", "requiredFeatures"}  # attributes of elements that not every program draws
CONTAINERS = {"svg", "g", "a", "switch", "use"}
WITH_VIEW = {"svg", "symbol"}  # elements with a view box of their own
DEEPEST = 100  # groups and copies within one another
MOST_COPIED = 200_000  # elements of all copies: copies of copies can fill the memory
ENTITY = re.compile(rb"""<!ENTITY\s+([\w.:-]+)\s+("[^"&%]*"|'[^'&%]*')\s*>""")  # an entity that uses no other entity
MOST_GROWN = 10_000_000  # characters that all entities add where they are used
XLINK = "{http://www.w3.org/1999/xlink}"
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
AT_ZERO = {"0", "0px"}  # values of a `transform-origin` that move nothing
GLYPH = re.compile(r"#(glyph-?|font_)\d+[-_]\d+")  # link to the shape of a letter, as pdftocairo, Inkscape and MuPDF name it
LETTERS = "letters of texts"  # kind of copies of shapes of letters
UNREAD_RULES = "rules of style sheets"  # kind of rules whose selectors are not read
SAME_POINT = 1e-9  # of the size of a line: closer points are the same point


@np.errstate(over="ignore", invalid="ignore", divide="ignore")  # a number that is too large is refused with a message
def read_svg(content: bytes, unit: float | None, sagitta: float, scale: float = 1.0) -> Drawn:
    """Outlines and lines of an SVG file; parameters and errors are those of `read_outlines`."""
    _refuse_growing_entities(content)
    try:
        root = ElementTree.fromstring(content)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise ValueError(f"is not a whole SVG file: {error}") from error
    if _tag(root) != "svg":
        raise ValueError(f"is not an SVG file: its first element is <{_tag(root)[:40]}>")
    own, stretch, viewport = page_of(root)
    paper = unit or own
    if paper is None:
        raise ValueError('does not say its unit, such as width = "2000mm"; state it: unit = "mm"')
    named = {name: element for element in reversed(list(root.iter())) if (name := element.get("id"))}
    metres = paper * scale
    reader = _Reader(Drawn(metres), sheet_of(root), sagitta, named)
    try:
        reader.walk(root, _Around(np.diag([metres * stretch[0], -metres * stretch[1], 1.0]), viewport), 0)
    except OverflowError as error:
        raise ValueError(f"holds a number that is too large: {error}") from error
    for _ in range(reader.sheet.unread):
        reader.drawn.ignore(UNREAD_RULES)
    return reader.drawn


def _refuse_growing_entities(content: bytes) -> None:
    """Raise ValueError for entities that could fill the memory: nested ones, those of other files, and long ones that are used often.

    Other entities are read, because Illustrator defines some for its namespaces, and at times for its styles.
    """
    plain = ENTITY.findall(content)
    if len(plain) < content.count(b"<!ENTITY"):
        raise ValueError("defines entities within entities or from other files, which no drawing needs; save it again as plain SVG")
    grown = sum(len(value) * content.count(b"&" + name + b";") for name, value in plain)
    if grown > MOST_GROWN:
        raise ValueError(f"has entities of {grown} characters where they are used, more than {MOST_GROWN}; save it again as plain SVG")


@dataclass(frozen=True)
class _Around:
    """Properties that an element inherits from the groups around it.

    Attributes
    ----------
    matrix : (3, 3) array
        Transformation from coordinates of the element to metres.
    viewport : Viewport
        Viewport to which lengths of the element refer.
    layer, layer_of_lines : str
        Layer of outlines, and of open lines; "" if no group around the element is a layer.
    is_labelled : bool
        Whether a group around the element is a layer by its label.
    colour : str
        Colour of elements without a colour of their own.
    paint : Paint
        Fill and stroke.
    displayed, visible : bool
        Whether no group hides the element by `display` or `opacity`, and whether the innermost `visibility` shows it.
    is_copied : bool
        Whether a <use> draws the element.
    """

    matrix: np.ndarray
    viewport: Viewport
    layer: str = ""
    layer_of_lines: str = ""
    is_labelled: bool = False
    colour: str = "none"
    paint: Paint = field(default_factory=Paint)
    displayed: bool = True
    visible: bool = True
    is_copied: bool = False


@dataclass
class _Reader:
    """Adds elements to a drawing.

    Attributes
    ----------
    drawn : Drawn
        The drawing.
    sheet : StyleSheet
        Style sheet of the drawing.
    sagitta : float
        Largest distance between a curve and its chords, m.
    named : dict
        Element of each id.
    copied : int
        Number of copied elements so far.
    """

    drawn: Drawn
    sheet: StyleSheet
    sagitta: float
    named: dict[str, ElementTree.Element]
    copied: int = 0

    def walk(self, element: ElementTree.Element, around: _Around, depth: int) -> None:
        """Add an element and all elements within it."""
        self.copied += around.is_copied
        if depth > DEEPEST:
            raise ValueError(f"has groups, or copies by <use>, more than {DEEPEST} deep")
        if self.copied > MOST_COPIED:
            raise ValueError(f"has copies by <use> with more than {MOST_COPIED} elements in all; delete those that are no blocks")
        kind = _tag(element)
        if kind in SILENT:
            return
        given = self.sheet.properties(element, kind)
        sizes = element.attrib | {name: given[name] for name in SIZES if name in given}
        here = self._within(element, kind, given, around)
        if kind == "svg" and depth > 0 and here.displayed:
            matrix, viewport = nested(sizes, around.viewport)
            here = replace(here, matrix=here.matrix @ matrix, viewport=viewport)
        if kind in SHAPES:
            self._add(sizes, kind, here, "d" in given)
        elif kind == "use":
            self._add_copy(sizes, here, depth)
        elif kind not in CONTAINERS:  # a browser shows no shape within such an element, as within a text
            if here.displayed:
                self.drawn.ignore(kind)
            return
        for child in _shown_of(element, kind):
            self.walk(child, here, depth + 1)

    def _add_copy(self, use: Mapping[str, str], here: _Around, depth: int) -> None:
        """Add the element that a <use> copies, at the place of the copy. A copy of an element of another file is only counted."""
        link = use.get("href") or use.get(f"{XLINK}href") or ""
        if GLYPH.fullmatch(link):
            self.drawn.ignore(LETTERS)
            return
        original = self.named.get(link[1:]) if link.startswith("#") else None
        if original is None:
            self.drawn.ignore(ABSENT)
            return
        x, y = (here.viewport.length(use.get(name, "0"), f"a <use> with {name}", name) for name in "xy")
        matrix = here.matrix @ np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]])
        if _tag(original) in WITH_VIEW:  # a copied symbol is a nested drawing, of the size that the copy gives
            size = {name: side for name in ("width", "height") if (side := use.get(name, "auto").strip().lower()) != "auto"}
            if here.displayed and _tag(original) == "symbol" and {"refX", "refY"} & set(original.keys()):
                self.drawn.ignore(REFERENCE)
            nested_drawing = ElementTree.Element("svg", original.attrib | size)
            nested_drawing.extend(original)
            original = nested_drawing
        self.walk(original, replace(here, matrix=matrix, is_copied=True), depth + 1)

    def _within(self, element: ElementTree.Element, kind: str, given: dict[str, str], around: _Around) -> _Around:
        """Inherited properties for an element with the properties `given`, and for the elements within it."""
        fill, stroke, origin = given.get("fill", ""), given.get("stroke", ""), given.get("transform-origin", "").split()
        matrix = around.matrix
        displayed = around.displayed and given.get("display") != "none" and not is_zero(given.get("opacity", "1"))
        for told in {word for name, word in UNREAD.items() if displayed and given.get(name, "none") != "none"}:
            self.drawn.ignore(told)
        may_move = displayed and kind in SHAPES | CONTAINERS  # nothing of a text or an image is read
        for name, still in MOVES.items():
            if may_move and not still.fullmatch(value := given.get(name, "none")):
                raise ValueError(f'has {name} = "{value[:40]}" in a style, which is not read; apply it in the drawing program')
        if may_move and "transform" in given:
            if not set(origin) <= AT_ZERO:
                shown = " ".join(origin)[:40]
                raise ValueError(f'has transform-origin = "{shown}", which is not read; apply the transform in the drawing program')
            matrix = matrix @ transformation(given["transform"])
        here = replace(
            around,
            matrix=matrix,
            colour=(fill if fill not in ("", "none") else stroke) or around.colour,
            paint=around.paint.with_given(given),
            displayed=displayed,
            visible=given.get("visibility", "visible" if around.visible else "hidden") not in ("hidden", "collapse"),
        )
        return _with_layer(element, here) if kind == "g" else here

    def _add(self, sizes: Mapping[str, str], kind: str, here: _Around, has_styled_path: bool) -> None:
        """Add the lines of a shape with these attributes, or count it if it is hidden."""
        if not (here.displayed and here.visible) or (here.paint.is_unseen and not self.sheet.may_paint):
            self.drawn.ignore(HIDDEN)
            return
        if has_styled_path and kind == "path":
            raise ValueError(
                "has a <path> whose d is in a style, which is not read; convert it in the drawing program, or write d as an attribute"
            )
        turn, place = here.matrix[:2, :2], here.matrix[:2, 2]
        if not np.isfinite(here.matrix).all():
            raise ValueError("has a transform whose numbers are too large; apply it in the drawing program")
        curves: list[np.ndarray] = []
        for points, is_closed in shape_lines(sizes, kind, here.viewport, self.sagitta / max(_largest_stretch(turn), 1e-300), curves):
            closed = is_closed or (kind in FILLED and here.paint.is_filled and _encloses(points))
            layer = here.layer if closed or _ends_meet(points) else here.layer_of_lines
            self.drawn.add(points @ turn.T + place, closed, layer, here.colour)
        self.drawn.curves += [points @ turn.T + place for points in curves]


def _shown_of(element: ElementTree.Element, kind: str) -> list[ElementTree.Element]:
    """The children of an element that are drawn: all; of a <switch>, the first one without a condition; of a <use>, none."""
    if kind == "use":
        return []
    children = list(element)
    if kind == "switch":
        return [child for child in children if not ASKS & child.attrib.keys()][:1]
    return children


def _tag(element: ElementTree.Element) -> str:
    return element.tag.rsplit("}", 1)[-1] if isinstance(element.tag, str) else ""


def _largest_stretch(turn: np.ndarray) -> float:
    """Largest factor by which a matrix (2, 2) lengthens a vector: its greatest singular value."""
    (a, b), (c, d) = turn.tolist()
    return 0.5 * (math.hypot(a + d, c - b) + math.hypot(a - d, c + b))


def _with_layer(group: ElementTree.Element, here: _Around) -> _Around:
    """Inherited properties within a group that may be a layer.

    A group is a layer if it has a label, or if Inkscape calls it a layer. A group that has only an id is a layer if no group around it
    has a label, because drawing programs give such ids to all groups. A single open line in a group with only an id belongs to the layer
    around this group, because lines of several such groups enclose outlines together.
    """
    label, name = group.get(f"{INKSCAPE}label"), group.get("id", "")
    if label or (name and group.get(f"{INKSCAPE}groupmode") == "layer"):
        return replace(here, layer=label or name, layer_of_lines=label or name, is_labelled=True)
    if not name or here.is_labelled:
        return here
    holds_many = len(list(itertools.islice(_shapes(group), 2))) > 1
    return replace(here, layer=name, layer_of_lines=name if holds_many else here.layer_of_lines)


def _shapes(group: ElementTree.Element) -> Iterator[ElementTree.Element]:
    """Every shape or copy below a group."""
    waiting = [group]
    while waiting:
        element = waiting.pop()
        if _tag(element) in SHAPES | {"use"}:
            yield element
        waiting += [child for child in element if _tag(child) not in SILENT]


def _encloses(points: np.ndarray) -> bool:
    """Whether a line (n, 2) would enclose an area without crossing itself if it were closed."""
    if len(points) < 3 or not np.isfinite(points).all():
        return False
    polygon = shapely.Polygon(points)
    return bool(polygon.is_valid and polygon.area > SAME_POINT * float(np.ptp(points, axis=0).max()) ** 2)


def _ends_meet(points: np.ndarray) -> bool:
    if len(points) < 3:
        return False
    return bool(np.hypot(*(points[0] - points[-1])) <= SAME_POINT * float(np.ptp(points, axis=0).max()))
