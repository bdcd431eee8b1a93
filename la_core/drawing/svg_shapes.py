"""Lines of the basic shapes and paths of SVG; curves become chords."""

import math
import re
from collections.abc import Mapping

import numpy as np

from la_core.drawing.svg_coordinates import NUMBER, Viewport

SHAPES = {"path", "polygon", "polyline", "rect", "line", "circle", "ellipse"}
FILLED = {"path", "polyline"}  # shapes that may be open and filled
NEXT_NUMBER = re.compile(rf"[\s,]*({NUMBER.pattern})")
NEXT_FLAG = re.compile(r"[\s,]*([01])")  # one digit, which needs no separator after it
COMMAND = re.compile(r"([MmZzLlHhVvCcSsQqTtAa])")
TAKES = {"M": 2, "L": 2, "H": 1, "V": 1, "C": 6, "S": 4, "Q": 4, "T": 2, "A": 7, "Z": 0}
STRAIGHT = "LHV"
FLAGS = (3, 4)  # places of the flags among the seven values of an arc
FAMILIES = {"S": "CS", "T": "QT"}  # commands whose last control point a smooth curve reflects
MOST_CHORDS = 200  # of one Bézier curve
CIRCLE_CHORDS, MOST_ARC_CHORDS = 8, 1000  # least number of a circle, and largest number of an arc


def shape_lines(
    given: Mapping[str, str], kind: str, viewport: Viewport, sagitta: float, curves: list[np.ndarray]
) -> list[tuple[np.ndarray, bool]]:
    """Lines (n, 2) of one of the SHAPES, in its own units, and whether each is closed.

    Parameters
    ----------
    given : mapping
        Attributes of the shape.
    kind : str
        Its kind, one of SHAPES.
    viewport : Viewport
        Viewport to which lengths of the shape refer.
    sagitta : float
        Largest distance between a curve and its chords, in the units of the shape.
    curves : list of (n, 2) array
        The chords of every curve are added to this list, in the units of the shape.

    Raises
    ------
    ValueError
        A length is no number with a unit, or a path breaks the grammar of SVG.
    """

    def length(name: str, along: str = "") -> float:
        return viewport.length(given.get(name, "0"), f"a <{kind}> with {name}", along)

    if kind == "path":
        return path_lines(given.get("d", ""), sagitta, curves)
    if kind in ("polygon", "polyline"):
        return [(_corners(given.get("points", ""), kind), kind == "polygon")]
    if kind == "line":
        return [(np.array([(length("x1", "x"), length("y1", "y")), (length("x2", "x"), length("y2", "y"))]), False)]
    if kind == "rect":
        place, size = np.array([length("x", "x"), length("y", "y")]), np.array([length("width", "x"), length("height", "y")])
        radii = _radii(given, viewport, size) if {"rx", "ry"} & given.keys() else np.zeros(2)
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


def _corners(text: str, kind: str) -> np.ndarray:
    """Corners (n, 2) of a <polygon> or <polyline>."""
    numbers: list[float] = []
    place = 0
    while match := NEXT_NUMBER.match(text, place):
        numbers.append(float(match[1]))
        place = match.end()
    if rest := " ".join(text[place:].split()).strip(" ,"):
        raise ValueError(f'has a <{kind}> with "{rest[:20]}" in its points, where a number is expected; correct the points')
    if len(numbers) % 2:
        raise ValueError(f"has a <{kind}> whose points have {len(numbers)} numbers, where each point has two; correct the points")
    return np.array(numbers).reshape(-1, 2)


def _radii(given: Mapping[str, str], viewport: Viewport, size: np.ndarray) -> np.ndarray:
    """Radii (2,) of the corners of a <rect>: a single radius sets both, and neither is more than half a side."""
    radii: list[float | None] = [None, None]
    for axis, (name, along) in enumerate((("rx", "x"), ("ry", "y"))):
        if (text := given.get(name, "auto").strip()) != "auto":
            radii[axis] = viewport.length(text, f"a <rect> with {name}", along)
    first, second = radii
    both = (first if first is not None else second or 0.0, second if second is not None else first or 0.0)
    return np.clip(both, 0.0, np.abs(size) / 2.0)


def _rectangle(size: np.ndarray, radii: np.ndarray, sagitta: float) -> tuple[np.ndarray, list[np.ndarray]]:
    """Corners (n, 2) of a rectangle from the origin, and its arcs. Corners stay sharp if their arcs lie within `sagitta` of them."""
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


def path_lines(text: str, sagitta: float, curves: list[np.ndarray]) -> list[tuple[np.ndarray, bool]]:
    """Every subpath as points (n, 2), and whether it is closed.

    Parameters
    ----------
    text : str
        Commands of the path.
    sagitta : float
        Largest distance between a curve and its chords, in the units of the path.
    curves : list of (n, 2) array
        The chords of every curve are added to this list.

    Raises
    ------
    ValueError
        The commands do not follow SVG's grammar.
    """
    lines: list[tuple[np.ndarray, bool]] = []
    points: list[np.ndarray] = []
    handle = at = start = np.zeros(2)
    previous = ""
    for command, numbers in _commands(text):
        kind = command.upper()
        base = at if command.islower() else np.zeros(2)
        if kind == "M":
            _finish(lines, points, closed=False)
            at = start = base + numbers
            points = [at]
        elif kind == "Z":
            _finish(lines, points, closed=True)
            at, points = start, [start]
        else:
            control = handle if previous in FAMILIES.get(kind, "") else at
            before = at
            at, handle, new = _drawn(kind, numbers, base, at, control, sagitta)
            points += new
            if kind not in STRAIGHT:
                curves.append(np.array([before, *new]))
        previous = kind
    _finish(lines, points, closed=False)
    return lines


def _finish(lines: list[tuple[np.ndarray, bool]], points: list[np.ndarray], closed: bool) -> None:
    if len(points) > 1:
        lines.append((np.array(points), closed))


def _commands(text: str) -> list[tuple[str, np.ndarray]]:
    """Commands of a path with their numbers; repeated commands are written out."""
    before, *parts = COMMAND.split(text)
    if start := " ".join(before.split()):
        raise ValueError(f'has a path that begins with "{start[:20]}"; a path begins with the command M')
    found: list[tuple[str, np.ndarray]] = []
    for command, values in zip(parts[::2], parts[1::2], strict=True):
        numbers, takes = _numbers(command, values), TAKES[command.upper()]
        if bool(numbers) != bool(takes) or len(numbers) % (takes or 1):
            raise ValueError(f"has a path whose command {command} has {len(numbers)} numbers; it takes {takes} each time")
        if not takes:
            found.append((command, np.zeros(0)))
        for k in range(0, len(numbers), takes or 1):
            repeated = {"M": "L", "m": "l"}.get(command, command) if k else command
            found.append((repeated, np.array(numbers[k : k + takes])))
    if found and found[0][0].upper() != "M":
        raise ValueError("has a path that does not begin with M")
    return found


def _numbers(command: str, text: str) -> list[float]:
    """Numbers after a command; flags of an arc are single digits."""
    numbers: list[float] = []
    place = 0
    while match := _pattern(command, len(numbers)).match(text, place):
        numbers.append(float(match[1]))
        place = match.end()
    if rest := " ".join(text[place:].split()).strip(" ,"):
        is_flag = _pattern(command, len(numbers)) is NEXT_FLAG
        rule = "a flag of an arc, which is 0 or 1," if is_flag else "a number"
        raise ValueError(f'has a path with "{rest[:20]}" after the command {command}, where {rule} is expected; correct the path')
    return numbers


def _pattern(command: str, place: int) -> re.Pattern[str]:
    return NEXT_FLAG if command in "Aa" and place % TAKES["A"] in FLAGS else NEXT_NUMBER


def _drawn(
    kind: str, numbers: np.ndarray, base: np.ndarray, before: np.ndarray, control: np.ndarray, sagitta: float
) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """End point of a command, its last control point, and its points after the first one."""
    if kind in "HV":
        axis = "HV".index(kind)
        end = before.copy()
        end[axis] = base[axis] + numbers[0]
        return end, end, [end]
    if kind == "L":
        end = base + numbers
        return end, end, [end]
    if kind == "A":
        end = base + numbers[5:]
        return end, end, _arc(before, numbers[:5], end, sagitta)
    mirrored = 2.0 * before - control
    corners = [base + numbers[k : k + 2] for k in range(0, len(numbers), 2)]
    corners = [before, *([mirrored] if kind in "ST" else []), *corners]
    return corners[-1], corners[-2], _bezier(np.array(corners), sagitta)


def _bezier(corners: np.ndarray, sagitta: float) -> list[np.ndarray]:
    """Points of a Bézier curve of degree 2 or 3 after its first one. The second difference of its control points bounds the sagitta."""
    degree = len(corners) - 1
    bend = np.hypot(*np.diff(corners, 2, axis=0).T).max()
    count = math.ceil(math.sqrt(degree * (degree - 1) * bend / (8.0 * sagitta))) if sagitta > 0.0 and np.isfinite(bend) else 1
    share = np.linspace(0.0, 1.0, min(MOST_CHORDS, max(1, count)) + 1)[1:, None]
    weights = [math.comb(degree, k) * share**k * (1.0 - share) ** (degree - k) for k in range(degree + 1)]
    return list(sum(weight * corner for weight, corner in zip(weights, corners, strict=True)))


def _arc(start: np.ndarray, shape: np.ndarray, end: np.ndarray, sagitta: float) -> list[np.ndarray]:
    """Points of an elliptical arc after its first one (W3C, SVG 1.1, appendix F.6)."""
    rx, ry, degrees, large, sweep = shape.tolist()
    rx, ry, turn = abs(rx), abs(ry), math.radians(degrees)
    if rx == 0.0 or ry == 0.0 or np.array_equal(start, end):
        return [end]
    turned = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    half = turned @ (start - end) / 2.0
    reach = math.hypot(half[0] / rx, half[1] / ry)
    if reach > 1.0:
        rx, ry = rx * reach, ry * reach
    unit = half / (rx, ry)
    square = float(unit @ unit)
    away = math.sqrt(max(0.0, 1.0 / square - 1.0)) if square > 0.0 else 0.0
    centre = (away if bool(large) != bool(sweep) else -away) * np.array([unit[1], -unit[0]])
    first, last = unit - centre, -unit - centre
    angle = math.atan2(first[1], first[0])
    span = math.atan2(last[1], last[0]) - angle
    span += 2.0 * math.pi * ((sweep and span < 0.0) - (not sweep and span > 0.0))
    angles = angle + np.linspace(0.0, span, chords(max(rx, ry), span, sagitta) + 1)[1:]
    points = (np.column_stack([np.cos(angles), np.sin(angles)]) + centre) * (rx, ry) @ turned + (start + end) / 2.0
    points[-1] = end
    return list(points)


def chords(radius: float, angle: float, sagitta: float) -> int:
    """Number of equal chords that stay within `sagitta` of an arc of `angle` (rad), at most MOST_ARC_CHORDS."""
    least = max(1, math.ceil(CIRCLE_CHORDS * abs(angle) / (2.0 * math.pi)))
    if not 0.0 < sagitta < radius:
        return least
    each = 4.0 * math.asin(math.sqrt(0.5 * sagitta / radius))
    if abs(angle) >= MOST_ARC_CHORDS * each:
        return MOST_ARC_CHORDS
    return max(least, math.ceil(abs(angle) / each))
