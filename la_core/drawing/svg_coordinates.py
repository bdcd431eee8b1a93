"""Coordinates of SVG: lengths with units, transformations, and the view boxes of the page and of drawings within it."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np

from la_core.drawing.outlines import UNITS

PIXEL = 0.0254 / 96.0  # m
PAPER_UNITS = {**UNITS, "pt": 0.0254 / 72.0, "pc": 0.0254 / 6.0, "q": 2.5e-4}  # in m
ANGLES = {"": 1.0, "deg": 1.0, "grad": 0.9, "rad": 180.0 / math.pi, "turn": 360.0}  # in degrees
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
LENGTH = re.compile(rf"\s*({NUMBER.pattern})\s*([a-z%]*)\s*")
ARGUMENT = re.compile(rf"[\s,]*({NUMBER.pattern})([a-z%]*)")
FUNCTION = re.compile(r"[\s,]*([a-z]+)\s*\(([^()]*)\)")
ALIGNED = re.compile(r"x(min|mid|max)y(min|mid|max)")
SHARES = {"min": 0.0, "mid": 0.5, "max": 1.0}
SAME_ASPECT = 1e-3  # programs round the sizes of a page
SAME_UNIT = 1e-9


@dataclass(frozen=True)
class Viewport:
    """Size and unit to which lengths refer.

    Attributes
    ----------
    width, height : float or None
        Size of the nearest view box or page, in user units; None if the file does not state it.
    per_metre : float
        Number of user units per metre, for lengths with a unit.
    """

    width: float | None = None
    height: float | None = None
    per_metre: float = 1.0 / PIXEL

    def length(self, text: str, what: str, along: str) -> float:
        """A length in user units.

        Parameters
        ----------
        text : str
            Number, alone or with a unit of CSS or `%`.
        what : str
            Element and attribute, for the message.
        along : str
            Size to which a percentage refers: "x" for the width, "y" for the height, "" for the diagonal over the root of 2.

        Raises
        ------
        ValueError
            The text is no length, or a percentage of a size that the file does not state.
        """
        where = f'{what} = "{" ".join(text.split())[:40]}"'
        found = LENGTH.fullmatch(text.lower())
        factor = self._unit(found[2], where, along) if found else None
        if found is None or factor is None or not math.isfinite(float(found[1])):
            raise ValueError(f'has {where}, which is no number, alone or with a unit such as mm; write it so, as in "120mm"')
        return float(found[1]) * factor

    def _unit(self, name: str, where: str, along: str) -> float | None:
        if name in ("", "px"):
            return 1.0
        if name != "%":
            return PAPER_UNITS[name] * self.per_metre if name in PAPER_UNITS else None
        sides = [side for side, axis in ((self.width, "x"), (self.height, "y")) if along in ("", axis)]
        known = [side for side in sides if side is not None]
        if len(known) < len(sides):
            raise ValueError(f"has {where}, but no view box or page size that it is a share of; give the drawing a viewBox")
        return math.sqrt(sum(side**2 for side in known) / len(known)) / 100.0


def page_of(root: ElementTree.Element) -> tuple[float | None, np.ndarray, Viewport]:
    """Metres per user unit (None if the file does not state it), stretch (2,) of x and y, and viewport of a page.

    Without a view box, a plain number counts in the unit of the page's width.
    """
    (width, unit), (height, _) = _side(root, "width"), _side(root, "height")
    box = _view_box(root.attrib)
    is_paper = width is not None and unit in PAPER_UNITS
    if box is None:
        user = PAPER_UNITS[unit] if is_paper else PIXEL
        across, along = (None if side is None else side / user for side in (width, height))
        return (user if is_paper else None), np.ones(2), Viewport(across, along, 1.0 / user)
    viewport = Viewport(float(box[2]), float(box[3]))
    if width is None:
        return None, np.ones(2), viewport
    ratios = np.array([width / box[2], (height or 0.0) / box[3]])
    if height is None or math.isclose(*ratios, rel_tol=SAME_ASPECT):
        ratios[1] = ratios[0]
    ratios = _fitted(ratios, root.attrib)
    least = float(ratios.min())
    if not 0.0 < least <= float(ratios.max()) < math.inf:
        return None, np.ones(2), viewport
    user = next((size for size in PAPER_UNITS.values() if math.isclose(size, least, rel_tol=SAME_UNIT)), least)
    return (user if is_paper else None), ratios / least, viewport


def nested(given: Mapping[str, str], around: Viewport) -> tuple[np.ndarray, Viewport]:
    """Matrix (3, 3) from the coordinates within a nested <svg> with these attributes to coordinates around it, and its viewport."""

    def length(name: str, along: str, otherwise: str) -> float:
        said = given.get(name, otherwise)
        return around.length(otherwise if said.strip().lower() == "auto" else said, f"a nested <svg> with {name}", along)

    place = np.array([length("x", "x", "0"), length("y", "y", "0")])
    box = _view_box(given)
    named = {name: along for name, along in (("width", "x"), ("height", "y")) if box is not None or name in given}
    sides = {name: length(name, along, "100%") for name, along in named.items()}
    if any(side <= 0.0 for side in sides.values()):
        raise ValueError("has a nested <svg> whose width or height is not positive, so that it shows nothing; correct or delete it")
    matrix = np.eye(3)
    matrix[:2, 2] = place
    if box is None:
        return matrix, Viewport(sides.get("width", around.width), sides.get("height", around.height), around.per_metre)
    size = np.array([sides["width"], sides["height"]])
    ratios = _fitted(size / box[2:], given)
    aligned = ALIGNED.search(given.get("preserveAspectRatio", "").lower())
    shares = np.array([SHARES[word] for word in aligned.groups()] if aligned else [0.5, 0.5])
    matrix[:2, :2] = np.diag(ratios)
    matrix[:2, 2] += shares * (size - ratios * box[2:]) - ratios * box[:2]
    return matrix, Viewport(float(box[2]), float(box[3]), around.per_metre)


def _fitted(ratios: np.ndarray, given: Mapping[str, str]) -> np.ndarray:
    """Scales (2,) of x and y that fit an element's view box to its sides, by `preserveAspectRatio`."""
    words = given.get("preserveAspectRatio", "").lower().split()
    if "none" in words:
        return ratios
    return np.full(2, ratios.max() if "slice" in words else ratios.min())


def _side(root: ElementTree.Element, name: str) -> tuple[float | None, str]:
    """A side of the page in metres, and its unit; None if the side is missing, a percentage, or not positive."""
    found = LENGTH.fullmatch(root.get(name, "").lower())
    if found is None or (found[2] not in PAPER_UNITS and found[2] not in ("", "px")):
        return None, ""
    metres = float(found[1]) * PAPER_UNITS.get(found[2], PIXEL)
    return (metres, found[2]) if 0.0 < metres < math.inf else (None, "")


def _view_box(given: Mapping[str, str]) -> np.ndarray | None:
    text = given.get("viewBox", "")
    numbers = np.array([float(number) for number in NUMBER.findall(text)])
    if not text.strip():
        return None
    if len(numbers) != 4 or not np.isfinite(numbers).all() or not (numbers[2:] > 0.0).all():
        shown = " ".join(text.split())[:60]
        raise ValueError(f'has viewBox = "{shown}", which is not x, y and a positive width and height; correct it')
    return numbers


def transformation(text: str) -> np.ndarray:
    """Matrix (3, 3) of a `transform`, as an attribute or as CSS writes it."""
    whole, place, lower = np.eye(3), 0, text.lower()
    while found := FUNCTION.match(lower, place):
        whole = whole @ _single(found[1], found[2])
        place = found.end()
    rest = " ".join(lower[place:].split()).strip(" ,")
    if rest and (rest != "none" or place):
        raise ValueError(f'has a transform with "{rest[:40]}", which is not read; apply it in the drawing program')
    return whole


def _numbers(function: str, text: str, units: Mapping[str, float]) -> list[float]:
    """Arguments of a function of a transform, in user units or degrees."""
    numbers: list[float] = []
    place = 0
    while (found := ARGUMENT.match(text, place)) and found[2] in units:
        numbers.append(float(found[1]) * units[found[2]])
        place = found.end()
    if rest := " ".join(text[place:].split()).strip(" ,"):
        known = ", ".join(name for name in units if name) or "none"
        raise ValueError(f'has a transform {function} with "{rest[:40]}"; its units may be {known}; write it as a plain number')
    if not all(map(math.isfinite, numbers)):
        raise ValueError(f"has a transform {function} whose numbers are too large; apply it in the drawing program")
    return numbers


def _single(name: str, arguments: str) -> np.ndarray:
    """Matrix (3, 3) of one function of a transform."""
    lengths = {"": 1.0, "px": 1.0}
    units = {"translate": lengths, "translatex": lengths, "translatey": lengths, "rotate": ANGLES, "skewx": ANGLES, "skewy": ANGLES}
    counts = {"matrix": (6,), "translate": (1, 2), "scale": (1, 2), "rotate": (1, 3), "skewx": (1,), "skewy": (1,)}
    counts |= {"translatex": (1,), "translatey": (1,), "scalex": (1,), "scaley": (1,)}
    if name not in counts:
        raise ValueError(f"has a transform {name[:40]}, which is not read; apply it in the drawing program")
    numbers = _numbers(name, arguments, units.get(name, {"": 1.0}))
    if len(numbers) not in counts[name]:
        raise ValueError(f"has a transform {name} with {len(numbers)} numbers; it takes {' or '.join(map(str, counts[name]))}")
    if name == "matrix":
        a, b, c, d, e, f = numbers
        return np.array([[a, c, e], [b, d, f], [0.0, 0.0, 1.0]])
    if name.startswith("translate"):
        x, y = {"translatex": (numbers[0], 0.0), "translatey": (0.0, numbers[0])}.get(name, (*numbers, 0.0)[:2])
        return np.array([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]])
    if name.startswith("scale"):
        x, y = {"scalex": (numbers[0], 1.0), "scaley": (1.0, numbers[0])}.get(name, (numbers[0], numbers[-1]))
        return np.diag([x, y, 1.0])
    angle = math.radians(numbers[0])
    if name == "rotate":
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        centre = np.array(numbers[1:] or [0.0, 0.0])
        whole = np.eye(3)
        whole[:2, :2], whole[:2, 2] = turn, centre - turn @ centre
        return whole
    shear = np.eye(3)
    shear[(0, 1) if name == "skewx" else (1, 0)] = math.tan(angle)
    return shear
