"""Content of a drawing: closed outlines, and open lines that enclose outlines together."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np
import shapely

UNITS = {"mm": 1e-3, "cm": 1e-2, "dm": 1e-1, "m": 1.0, "in": 0.0254, "ft": 0.3048}  # in m
CLIPPED = "clip paths"  # kind of clip paths: they are counted, and the shapes that they clip are read whole
HIDDEN = "hidden entities"  # kind of entities that a drawing does not show
ELSEWHERE = "drawings in other files"  # kind of inserts of other files (external references)
MISSING = "inserts of missing blocks"  # kind of inserts of blocks that are missing in the file
ABSENT = "use"  # kind of copies (<use>) in an SVG file whose original is missing in the file
REFERENCE = "refX or refY of symbols"  # kind of copies of SVG symbols that have such a reference point, which is not read
AREAS = ("REGION", "MPOLYGON", "MLINE", "TRACE", "3DFACE")  # kinds of DXF entities that are not read, but may be stones
FILLINGS = ("HATCH", "SOLID")  # kinds of DXF entities that fill areas and are not read; they are seldom stones
ALL_BUT_CLOSED = 0.15  # of a polyline's length: if its ends are closer than this, it was meant as an outline
MOST_POINTS = 2_000_000  # points of all lines of a drawing together; a drawing with more is a scan, or an attack


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
    """A polyline whose ends nearly meet, and that encloses nothing.

    Attributes
    ----------
    layer : str
        Layer in the drawing.
    x, z : float
        First point of the polyline, m.
    gap : float
        Distance between the ends, m.
    """

    layer: str
    x: float
    z: float
    gap: float


@dataclass(frozen=True)
class LayerCount:
    """Number of lines or outlines on one layer, and place of the first one.

    Attributes
    ----------
    layer : str
        Layer in the drawing.
    count : int
        Number of lines or outlines.
    x, z : float
        Middle of the first line or outline, m.
    """

    layer: str
    count: int
    x: float
    z: float


@dataclass(frozen=True)
class SharedAreas:
    """Number of areas that lines of several layers or colours enclose together, and place of the first one.

    Attributes
    ----------
    layers : tuple of str
        Layers of these lines; one layer if the lines differ in colour only.
    count : int
        Number of areas.
    x, z : float
        Middle of the first area, m.
    """

    layers: tuple[str, ...]
    count: int
    x: float
    z: float


@dataclass
class Drawn:
    """Content of a drawing as it is read, with all coordinates in m.

    Attributes
    ----------
    outlines : list of Outline
        Closed outlines.
    lines : dict
        Open lines, (n, 2) arrays, by layer and colour.
    unit : float
        Length in the structure of one unit of the file, m.
    ignored : dict of int
        Number of entities that are not read, by kind.
    count : int
        Number of points added so far.
    sagitta : float
        Largest distance between a curve and its chords, m.
    curves : list of (n, 2) array
        Chords of each curve in the file, m; the outlines and lines contain the same chords.
    """

    unit: float
    outlines: list[Outline] = field(default_factory=list)
    lines: dict[tuple[str, str], list[np.ndarray]] = field(default_factory=dict)
    ignored: dict[str, int] = field(default_factory=dict)
    count: int = 0
    sagitta: float = 0.0
    curves: list[np.ndarray] = field(default_factory=list)

    def add(self, points: np.ndarray, closed: bool, layer: str, colour: str) -> None:
        """Add a polyline (n, 2), m. It is closed if `closed` says so, or if its last point repeats its first one.

        Raises ValueError for a coordinate that is not a number, and for more than MOST_POINTS points in all.
        """
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
        """Every pair of a layer and a colour that has outlines or lines."""
        return {outline.place for outline in self.outlines} | set(self.lines)

    def ignore(self, kind: str) -> None:
        """Count an entity of this kind, which is not read."""
        self.ignored[kind] = self.ignored.get(kind, 0) + 1


@dataclass
class Found:
    """Outlines found in a drawing, and the lines beside them.

    Attributes
    ----------
    outlines : list of Outline
        Outlines that are drawn closed, and outlines that lines enclose.
    idle : dict
        Lines that bound no outline, (n, 2) arrays, by layer and colour.
    around : list of (str, (n, 2) array)
        Outlines around others, each with its layer.
    across : list of (str, (n, 2) array)
        Lines that divide outlines of other layers.
    again : list of (str, (n, 2) array)
        Lines that are edges of outlines, drawn again.
    rests : list of (str, (n, 2) array)
        Parts of lines that bound no outline, although another part of the line does.
    """

    outlines: list[Outline]
    idle: dict[tuple[str, str], list[np.ndarray]]
    around: list[tuple[str, np.ndarray]]
    across: list[tuple[str, np.ndarray]]
    again: list[tuple[str, np.ndarray]]
    rests: list[tuple[str, np.ndarray]]


def by_layer(places: Iterable[tuple[str, np.ndarray]]) -> tuple[LayerCount, ...]:
    """Count lines or outlines by layer. Each of them is given as its layer and its points (n, 2), m."""
    found: dict[str, LayerCount] = {}
    for layer, points in places:
        x, z = points.mean(axis=0)
        one = found.get(layer, LayerCount(layer, 0, float(x), float(z)))
        found[layer] = replace(one, count=one.count + 1)
    return tuple(found.values())


def by_places(areas: Iterable[tuple[frozenset[tuple[str, str]], np.ndarray]]) -> tuple[SharedAreas, ...]:
    """Count areas by the layers of their lines. Each area is given as the layers and colours of its lines and its corners (n, 2), m."""
    found: dict[tuple[str, ...], SharedAreas] = {}
    for places, points in areas:
        layers = tuple(sorted({layer for layer, _ in places}))
        x, z = points.mean(axis=0)
        one = found.get(layers, SharedAreas(layers, 0, float(x), float(z)))
        found[layers] = replace(one, count=one.count + 1)
    return tuple(found.values())


def refuse_flat(outlines: Iterable[np.ndarray], lines: Iterable[np.ndarray]) -> None:
    """Raise ValueError for a drawing without width or height, such as an elevation in another plane than xy.

    If the drawing has outlines (n, 2), each of them lacks width or height. If it has lines (n, 2) only, all lines lack width, or all lack
    height.
    """
    sizes = [np.ptp(outline, axis=0) > 0.0 for outline in outlines]
    extents = [np.ptp(line, axis=0) > 0.0 for line in lines]
    is_flat = not any(size.all() for size in sizes) if sizes else bool(extents) and not np.any(extents, axis=0).all()
    if is_flat:
        what = "outlines" if sizes else "lines"
        raise ValueError(f"has only {what} without height; the elevation must lie in the xy plane of the file, its heights along y")


def end_met(outline: Outline, snap: float) -> Outline:
    """Return an outline without its last corner if this corner lies within `snap` (m) of the first one and the outline crosses itself.

    Any other outline is returned unchanged.
    """
    first, last = outline.points[[0, -1]]
    if len(outline.points) < 4 or np.hypot(*(last - first)) > snap or shapely.Polygon(outline.points).is_valid:
        return outline
    return replace(outline, points=outline.points[:-1])


def all_but_closed(lines: Iterable[np.ndarray], layer: str) -> Iterator[OpenOutline]:
    """Yield an OpenOutline for each line (n, 2) meant as an outline: it has three sides or more, and its ends nearly meet."""
    for line in lines:
        gap, length = float(np.hypot(*(line[-1] - line[0]))), float(np.hypot(*np.diff(line, axis=0).T).sum())
        if len(line) > 3 and gap <= ALL_BUT_CLOSED * length:
            yield OpenOutline(layer, float(line[0, 0]), float(line[0, 1]), gap)
