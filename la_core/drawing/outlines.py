"""What a drawing holds: closed outlines, and lines that only together enclose something."""

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy
import shapely

from la_core.text_table import number_text

UNITS = {"mm": 1e-3, "cm": 1e-2, "dm": 1e-1, "m": 1.0, "in": 0.0254, "ft": 0.3048}  # in m
HIDDEN = "hidden entities"  # kind of those that a drawing does not show
ALL_BUT_CLOSED = 0.15  # of its length: a polyline whose ends are closer than this was meant to be an outline
MOST_NAMED = 3  # open outlines that a sentence names
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
    """

    unit: float
    outlines: list[Outline] = field(default_factory=list)
    lines: dict[tuple[str, str], list[np.ndarray]] = field(default_factory=dict)
    ignored: dict[str, int] = field(default_factory=dict)
    count: int = 0

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
        outlines = [outline for outline in self.outlines if not left_out(outline.layer, outline.colour)]
        return Drawn(self.unit, outlines, {place: lines for place, lines in self.lines.items() if not left_out(*place)}, self.ignored)

    @property
    def places(self) -> set[tuple[str, str]]:
        """Every layer with every colour on it that holds outlines or lines."""
        return {(outline.layer, outline.colour) for outline in self.outlines} | set(self.lines)

    def ignore(self, kind: str) -> None:
        """Count an entity that is no outline."""
        self.ignored[kind] = self.ignored.get(kind, 0) + 1


def enclosed(lines: list[np.ndarray], snap: float) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Outlines (n, 2) that lines enclose together, and the lines that enclose nothing.

    Ends of lines closer to each other than `snap` (m) meet. An end that meets no other reaches on by twice as much,
    so that a line that stops just short of another one meets it. A ring around other rings is no outline.
    """
    ends = np.concatenate([[line[0], line[-1]] for line in lines])
    place = _merged(ends, snap)
    _, number, uses = np.unique(place, axis=0, return_inverse=True, return_counts=True)
    lone = (uses[number.ravel()] == 1).reshape(-1, 2)
    drawn = []
    for line, (first, last), (reaches_back, reaches_on) in zip(lines, place.reshape(-1, 2, 2), lone, strict=True):
        inner = line[1:-1]
        points = np.concatenate([[first], inner, [last]])
        before = [points[0] + _ahead(points[1], points[0], 2.0 * snap)] if reaches_back else []
        after = [points[-1] + _ahead(points[-2], points[-1], 2.0 * snap)] if reaches_on else []
        drawn.append(shapely.LineString(np.concatenate([np.reshape(before, (-1, 2)), points, np.reshape(after, (-1, 2))])))
    noded = shapely.unary_union(np.array(drawn))
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(noded)))
    faces = faces[shapely.get_num_interior_rings(faces) == 0]
    used = shapely.unary_union(shapely.boundary(faces)) if len(faces) else shapely.LineString()
    idle = shapely.length(shapely.intersection(np.array(drawn), used)) < 0.5 * shapely.length(np.array(drawn))
    return [shapely.get_coordinates(face)[:-1] for face in faces], [line for line, is_idle in zip(lines, idle, strict=True) if is_idle]


def open_words(outlines: Sequence[OpenOutline]) -> str:
    """What is open in a drawing, and where, as a sentence without its full stop; "" where nothing is."""
    if not outlines:
        return ""
    gap = number_text(1e3 * max(one.gap for one in outlines), 3)
    layers = ", ".join(json.dumps(layer, ensure_ascii=False) for layer in dict.fromkeys(one.layer for one in outlines))
    places = ", ".join(f"({one.x:.4g}, {one.z:.4g}) m" for one in outlines[:MOST_NAMED])
    if len(outlines) == 1:
        return f"the outline on layer {layers} that begins at {places} is open by {gap} mm, so it is left out"
    more = ", ..." if len(outlines) > MOST_NAMED else ""
    return f"{len(outlines)} outlines on layer {layers} that begin at {places}{more} are open by up to {gap} mm, so they are left out"


def all_but_closed(lines: Iterable[np.ndarray], layer: str) -> Iterator[OpenOutline]:
    """Those of the lines (n, 2) that were meant to be outlines: of three sides or more, and all but closed."""
    for line in lines:
        gap, length = float(np.hypot(*(line[-1] - line[0]))), float(np.hypot(*np.diff(line, axis=0).T).sum())
        if len(line) > 3 and gap <= ALL_BUT_CLOSED * length:
            yield OpenOutline(layer, float(line[0, 0]), float(line[0, 1]), gap)


def _merged(points: np.ndarray, snap: float) -> np.ndarray:
    """Points (n, 2), each group of points closer than `snap` replaced by its first one."""
    pairs = scipy.spatial.cKDTree(points).query_pairs(snap, output_type="ndarray") if snap > 0.0 else np.zeros((0, 2), dtype=int)
    first = np.arange(len(points))
    for a, b in pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))].tolist():
        first[b] = min(first[b], first[a])
    return points[first]


def _ahead(start: np.ndarray, end: np.ndarray, reach: float) -> np.ndarray:
    length = float(np.hypot(*(end - start)))
    return (end - start) * (reach / length) if length > 0.0 else np.zeros(2)
