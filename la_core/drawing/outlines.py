"""What a drawing holds: closed outlines, and lines that only together enclose something."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np
import shapely

UNITS = {"mm": 1e-3, "cm": 1e-2, "dm": 1e-1, "m": 1.0, "in": 0.0254, "ft": 0.3048}  # in m
CLIPPED = "clip paths"  # kind of those that cut off a part of a drawing, which is read whole
HIDDEN = "hidden entities"  # kind of those that a drawing does not show
ELSEWHERE = "drawings in other files"  # kind of the inserts of such drawings (external references)
MISSING = "inserts of missing blocks"  # kind of inserts of blocks that the file does not hold
ABSENT = "use"  # kind of copies in an SVG file of what it does not hold
REFERENCE = "refX or refY of symbols"  # kind of copies in an SVG file that such a point would move
AREAS = ("REGION", "MPOLYGON", "MLINE", "TRACE", "3DFACE")  # kinds of a DXF file that are not read, and may be stones
FILLINGS = ("HATCH", "SOLID")  # kinds that are not read, and fill areas: seldom are they the stones themselves
ALL_BUT_CLOSED = 0.15  # of its length: a polyline whose ends are closer than this was meant to be an outline
MOST_POINTS = 2_000_000  # of all lines of a drawing: more are a scan, or an attack


@dataclass(frozen=True)
class Outline:
    """A closed outline.

    Attributes
    ----------
    points : (n, 2) array
        Corners in order, x to the right and z up, m; the first one is not repeated.
    layer, colour : str
        Layer and colour in the drawing.
    """

    points: np.ndarray
    layer: str
    colour: str

    @property
    def place(self) -> tuple[str, str]:
        """Layer and colour."""
        return self.layer, self.colour


@dataclass(frozen=True)
class OpenOutline:
    """A polyline that all but closes, and encloses nothing.

    Attributes
    ----------
    layer : str
        Layer in the drawing.
    x, z : float
        Where it begins, m.
    gap : float
        Distance between its ends, m.
    """

    layer: str
    x: float
    z: float
    gap: float


@dataclass(frozen=True)
class LayerCount:
    """Lines or outlines of one layer, counted, and where the first one lies.

    Attributes
    ----------
    layer : str
        Layer in the drawing.
    count : int
        Number of them.
    x, z : float
        Middle of the first one, m.
    """

    layer: str
    count: int
    x: float
    z: float


@dataclass(frozen=True)
class SharedAreas:
    """Areas that lines of several layers or colours enclose together, counted, and where the first one lies.

    Attributes
    ----------
    layers : tuple of str
        Layers of these lines; a single one where they differ in colour alone.
    count : int
        Number of areas.
    x, z : float
        Middle of the first one, m.
    """

    layers: tuple[str, ...]
    count: int
    x: float
    z: float


@dataclass
class Drawn:
    """Content of a drawing as it is read, in m.

    Attributes
    ----------
    outlines : list of Outline
        Closed outlines.
    lines : dict
        Open lines, (n, 2) arrays, by layer and colour.
    unit : float
        Unit of the file, m.
    ignored : dict of int
        Number of entities of each kind that are no outlines.
    sagitta : float
        Largest distance between a curve and its chords, m.
    curves : list of (n, 2) array
        The chords of each curve in the file, which its outlines and lines have, too, m.
    """

    unit: float
    outlines: list[Outline] = field(default_factory=list)
    lines: dict[tuple[str, str], list[np.ndarray]] = field(default_factory=dict)
    ignored: dict[str, int] = field(default_factory=dict)
    count: int = 0
    sagitta: float = 0.0
    curves: list[np.ndarray] = field(default_factory=list)

    def add(self, points: np.ndarray, closed: bool, layer: str, colour: str) -> None:
        """Add a polyline (n, 2), m; it is closed if it says so, or if it ends where it begins."""
        self.count += len(points)
        if self.count > MOST_POINTS:
            raise ValueError(f"has more than {MOST_POINTS} points; draw blocks as a few lines and arcs each")
        if not np.isfinite(points).all():
            raise ValueError("has a coordinate that is not a number")
        size = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
        repeated = len(points) > 2 and np.hypot(*(points[0] - points[-1])) <= 1e-9 * size
        points = points[:-1] if repeated else points
        if (closed or repeated) and len(points) > 2:
            self.outlines.append(Outline(points, layer, colour))
        elif len(points) > 1 and size > 0.0:
            self.lines.setdefault((layer, colour), []).append(points)

    def without(self, left_out: Callable[[str, str], bool]) -> "Drawn":
        """The drawing without the layers and colours for which `left_out` is true."""
        outlines = [outline for outline in self.outlines if not left_out(*outline.place)]
        lines = {place: some for place, some in self.lines.items() if not left_out(*place)}
        return replace(self, outlines=outlines, lines=lines)

    @property
    def places(self) -> set[tuple[str, str]]:
        """Every layer with every colour on it that holds outlines or lines."""
        return {outline.place for outline in self.outlines} | set(self.lines)

    def ignore(self, kind: str) -> None:
        """Count an entity that is no outline."""
        self.ignored[kind] = self.ignored.get(kind, 0) + 1


@dataclass
class Found:
    """What a drawing holds.

    Attributes
    ----------
    outlines : list of Outline
        Outlines that are closed, or that lines enclose.
    idle : dict
        Lines that bound no outline, (n, 2) arrays, by layer and colour.
    around : list of (str, (n, 2) array)
        Outlines around others, each with its layer.
    across : list of (str, (n, 2) array)
        Lines that divide outlines of other layers.
    again : list of (str, (n, 2) array)
        Lines that are edges of outlines, drawn again.
    rests : list of (str, (n, 2) array)
        Parts of lines that bound nothing, where the rest of the line does.
    """

    outlines: list[Outline]
    idle: dict[tuple[str, str], list[np.ndarray]]
    around: list[tuple[str, np.ndarray]]
    across: list[tuple[str, np.ndarray]]
    again: list[tuple[str, np.ndarray]]
    rests: list[tuple[str, np.ndarray]]


def by_layer(places: Iterable[tuple[str, np.ndarray]]) -> tuple[LayerCount, ...]:
    """Lines or outlines, each a layer and points (n, 2), counted by layer."""
    found: dict[str, LayerCount] = {}
    for layer, points in places:
        x, z = points.mean(axis=0)
        one = found.get(layer, LayerCount(layer, 0, float(x), float(z)))
        found[layer] = replace(one, count=one.count + 1)
    return tuple(found.values())


def by_places(areas: Iterable[tuple[frozenset[tuple[str, str]], np.ndarray]]) -> tuple[SharedAreas, ...]:
    """Areas, each the layers and colours of its lines and corners (n, 2), counted by the layers."""
    found: dict[tuple[str, ...], SharedAreas] = {}
    for places, points in areas:
        layers = tuple(sorted({layer for layer, _ in places}))
        x, z = points.mean(axis=0)
        one = found.get(layers, SharedAreas(layers, 0, float(x), float(z)))
        found[layers] = replace(one, count=one.count + 1)
    return tuple(found.values())


def refuse_flat(outlines: Iterable[np.ndarray], lines: Iterable[np.ndarray]) -> None:
    """Raise ValueError for a drawing without width or height, as of an elevation in another plane than xy.

    It has outlines (n, 2), and each lacks one of the two; or it has lines (n, 2) alone, and all of them together lack one.
    """
    sizes = [np.ptp(outline, axis=0) > 0.0 for outline in outlines]
    extents = [np.ptp(line, axis=0) > 0.0 for line in lines]
    is_flat = not any(size.all() for size in sizes) if sizes else bool(extents) and not np.any(extents, axis=0).all()
    if is_flat:
        what = "outlines" if sizes else "lines"
        raise ValueError(f"has only {what} without height; the elevation must lie in the xy plane of the file, its heights along y")


def end_met(outline: Outline, snap: float) -> Outline:
    """An outline that crosses itself as its last corner is its first one again, up to `snap` (m), without this corner; else as it is."""
    first, last = outline.points[[0, -1]]
    if len(outline.points) < 4 or np.hypot(*(last - first)) > snap or shapely.Polygon(outline.points).is_valid:
        return outline
    return replace(outline, points=outline.points[:-1])


def all_but_closed(lines: Iterable[np.ndarray], layer: str) -> Iterator[OpenOutline]:
    """Those of the lines (n, 2) that were meant to be outlines: of three sides or more, and all but closed."""
    for line in lines:
        gap, length = float(np.hypot(*(line[-1] - line[0]))), float(np.hypot(*np.diff(line, axis=0).T).sum())
        if len(line) > 3 and gap <= ALL_BUT_CLOSED * length:
            yield OpenOutline(layer, float(line[0, 0]), float(line[0, 1]), gap)
