"""Properties of SVG elements from attributes, from style sheets and from the attribute `style`."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from xml.etree import ElementTree

from la_core.drawing.outlines import CLIPPED

OPACITIES = ("fill-opacity", "stroke-opacity")
READ = ("display", "visibility", "opacity", "color", "fill", "stroke", *OPACITIES, "transform", "transform-origin")
SIZES = ("x", "y", "width", "height", "cx", "cy", "r", "rx", "ry", "d")  # attributes of shapes that a style may give, too
MOVES = {  # properties beside `transform` that move an element, and values that move nothing; other values are refused
    "translate": re.compile(r"none|0(px|%)?(\s+0(px|%)?){0,2}"),
    "rotate": re.compile(r"none|0(deg)?"),
    "scale": re.compile(r"none|(1|100%)(\s+(1|100%)){0,2}"),
}
# Properties that change the picture but are not read, and the kind by which they are counted.
UNREAD = {"clip-path": CLIPPED, "mask": "masks"} | dict.fromkeys(("marker", "marker-start", "marker-mid", "marker-end"), "markers")
PROPERTIES = (*READ, *UNREAD)
NO_LENGTH = re.compile(r"[-+]?(?=[\d.]*[1-9])[\d.]+(?:e[-+]?\d+)?")  # a number without a unit, unless 0: CSS ignores it
PART = re.compile(r"\*|[.#]?[\w-]+")  # of a selector: any element, a kind of element, .class or #id
BRACES = re.compile(r"[{}]|[^{}]+")
IMPORTANT = re.compile(r"\s*!\s*important\s*$")
# States that an element has only while a program shows it to a user, and parts that are no elements.
STATES = re.compile(r":(hover|active|focus|visited|link|any-link|target|checked|:)", re.IGNORECASE)
UNSET = ("", "inherit", "unset")  # values that leave a property to the group around
NO_OPACITY = r"\s*[-+]?(?:0+\.?0*|\.0+)%?\s*"
CLEAR = re.compile(  # paints that show nothing
    r"none|transparent|#[0-9a-f]{3}0|#[0-9a-f]{6}00|"
    rf"(?:rgba?|hsla?|hwb|(?:ok)?l(?:ab|ch)|color)\((?:(?:[^,]*,){{3}}|[^,/]*/){NO_OPACITY}\)"
)


@dataclass(frozen=True)
class Paint:
    """Fill and stroke of a shape.

    Attributes
    ----------
    fill, stroke : str
        Fill and stroke; "" if neither the shape nor a group gives them.
    clear : frozenset of str
        Names of the OPACITIES that are 0.
    colour : str
        Value of `currentColor`.
    """

    fill: str = ""
    stroke: str = ""
    clear: frozenset[str] = frozenset()
    colour: str = ""

    def with_given(self, given: dict[str, str]) -> "Paint":
        """The paint of an inner element that gives these properties itself."""
        zero = {name for name in OPACITIES if is_zero(given.get(name, "1"))}
        fill, stroke, colour = (
            given.get(name) or own for name, own in (("fill", self.fill), ("stroke", self.stroke), ("color", self.colour))
        )
        return Paint(fill, stroke, self.clear.difference(given) | zero, colour)

    @property
    def is_filled(self) -> bool:
        """Whether an open line is meant as an area: it has a fill, or it has neither fill nor stroke, which SVG fills."""
        if "fill-opacity" in self.clear:
            return False
        return not self._is_clear(self.fill) if self.fill else not self._has_stroke

    @property
    def is_unseen(self) -> bool:
        """Whether a shape is invisible: the fill given by itself or by a group shows nothing, and it has no stroke.

        Programs write pages and artboards in this way.
        """
        return ("fill-opacity" in self.clear or self._is_clear(self.fill)) and not self._has_stroke

    @property
    def _has_stroke(self) -> bool:
        return bool(self.stroke) and not self._is_clear(self.stroke) and "stroke-opacity" not in self.clear

    def _is_clear(self, paint: str) -> bool:
        return CLEAR.fullmatch(self.colour if paint == "currentcolor" else paint) is not None


def is_zero(opacity: str) -> bool:
    """Whether an opacity is 0."""
    return re.fullmatch(NO_OPACITY, opacity) is not None


@dataclass(frozen=True)
class Rule:
    """A rule of a style sheet for one selector.

    Attributes
    ----------
    parts : frozenset of str
        Conditions on an element: its kind, `.class`, `#id`, or `*` for any.
    weight : tuple of int
        Number of ids, classes and kinds in the selector, and position of the rule in the sheet: the rule of greater weight wins.
    values : dict
        Value of every property, and whether it is marked as important.
    """

    parts: frozenset[str]
    weight: tuple[int, int, int, int]
    values: dict[str, tuple[str, bool]]


class StyleSheet:
    """Rules of all <style> elements of a drawing; selectors that depend on other elements, and rules within @media, are not read."""

    def __init__(self, text: str) -> None:
        self._rules: dict[str, list[Rule]] = {}
        self.unread = 0  # rules for our properties whose selectors are not read
        self.may_paint = False  # whether one of them gives more than sizes and moves
        for place, (selectors, body) in enumerate(_blocks(text)):
            if not (values := _values(body)):
                continue
            for selector in selectors.split(","):
                parts = PART.findall(selector)
                if not parts or "".join(parts) != selector.strip():
                    if not STATES.search(selector):
                        self.unread += 1
                        self.may_paint |= not values.keys() <= {*SIZES, *MOVES}
                    continue
                ids, classes, any_kind = (sum(part[0] == sign for part in parts) for sign in "#.*")
                weight = (ids, classes, len(parts) - ids - classes - any_kind, place)
                self._rules.setdefault(parts[-1], []).append(Rule(frozenset(parts), weight, values))

    def properties(self, element: ElementTree.Element, kind: str) -> dict[str, str]:
        """Properties that are given to an element itself: `style` wins over the sheet, the sheet over attributes.

        SIZES and MOVES are among them where a style gives them.
        """
        names = {"*", kind, f"#{element.get('id', '')}", *(f".{name}" for name in element.get("class", "").split())}
        rules = sorted((rule for name in names for rule in self._rules.get(name, ()) if rule.parts <= names), key=lambda rule: rule.weight)
        sources = [rule.values for rule in rules] + [_values(element.get("style", ""))]
        found = {name: element.get(name, "").strip().lower() for name in PROPERTIES}
        for is_important in (False, True):
            for values in sources:
                found |= {name: value for name, (value, important) in values.items() if important == is_important}
        return {name: value for name, value in found.items() if value not in UNSET}


def sheet_of(root: ElementTree.Element) -> StyleSheet:
    """The style sheet of a drawing, from all its <style> elements."""
    styles = (element for element in root.iter() if isinstance(element.tag, str) and element.tag.rsplit("}", 1)[-1] == "style")
    return StyleSheet("\n".join("".join(element.itertext()) for element in styles))


def _blocks(text: str) -> Iterator[tuple[str, str]]:
    """Yield selectors and body of every rule outside other blocks; of a rule in an @media block for screens, "@media" and its body."""
    first, *others = text.split("/*")
    plain = first + " ".join(other.partition("*/")[2] for other in others)
    around: list[str] = []
    before = ""
    for token in BRACES.findall(plain):
        if token == "{":
            around.append(before.rpartition(";")[2].strip())
        elif token == "}":
            if len(around) == 1 and not around[0].startswith("@"):
                yield around[0], before
            elif len(around) == 2 and around[0].lower().startswith("@media") and "print" not in around[0].lower():
                yield "@media", before
            around = around[:-1]
        before = "" if token in "{}" else token


def _values(text: str) -> dict[str, tuple[str, bool]]:
    """Values of our PROPERTIES, SIZES and MOVES in a list of declarations, and whether each is marked as important."""
    found: dict[str, tuple[str, bool]] = {}
    for entry in text.split(";"):
        name, _, value = entry.partition(":")
        key = name.strip().lower()
        plain = IMPORTANT.sub("", value.strip().lower())
        if key in PROPERTIES or key in MOVES or (key in SIZES and not NO_LENGTH.fullmatch(plain)):
            found[key] = (plain.strip(), plain != value.strip().lower())
    return found
