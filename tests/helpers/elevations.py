"""Elevations as a drawing program writes them: DXF with inserts, polylines with arcs, lines, rounded to the millimetre."""

import io
from dataclasses import dataclass

import ezdxf
import numpy as np
import shapely

JOINT = 10.0  # mm, thickness of mortar that is not drawn
BRICK = (400.0, 200.0)  # mm, joints included
CUT_OFF = 8000.0  # mm2; a smaller piece of a brick is left out
CHORDS = 96  # of an arc, while outlines are computed


@dataclass(frozen=True)
class Window:
    """An opening with a segmental arch of `voussoirs`; left edge, sill, width and height of the jambs, rise and thickness, mm."""

    x: float
    sill: float
    width: float = 1200.0
    jamb: float = 1400.0
    rise: float = 250.0
    thickness: float = 300.0
    voussoirs: int = 13

    @property
    def radius(self) -> float:
        """Radius of the intrados."""
        return (self.width**2 / 4.0 + self.rise**2) / (2.0 * self.rise)

    @property
    def centre(self) -> np.ndarray:
        """Centre of the arch."""
        return np.array([self.x + self.width / 2.0, self.sill + self.jamb + self.rise - self.radius])

    @property
    def half_angle(self) -> float:
        """Angle between the vertical and a springing."""
        return float(np.arcsin(self.width / 2.0 / self.radius))

    def ring(self, inner: float, outer: float, start: float, end: float) -> np.ndarray:
        """Return the outline between two radii and two angles from the vertical, clockwise positive."""
        angle = np.linspace(start, end, CHORDS)
        arc = np.column_stack([np.sin(angle), np.cos(angle)])
        return self.centre + np.concatenate([inner * arc, outer * arc[::-1]])

    def void(self) -> shapely.Polygon:
        """Return the area without bricks: the opening and the arch with the joint around it."""
        head = self.ring(0.0, self.radius, -self.half_angle, self.half_angle)
        body = shapely.box(self.x, self.sill, self.x + self.width, self.sill + self.jamb)
        turn = JOINT / (self.radius + self.thickness)
        arch = self.ring(self.radius - 1.0, self.radius + self.thickness + JOINT, -self.half_angle - turn, self.half_angle + turn)
        return shapely.union_all([shapely.Polygon(head), body, shapely.Polygon(arch)])


def bricks(length: int, courses: int, windows: tuple[Window, ...]) -> list[np.ndarray]:
    """Return the outlines (n, 2), mm, of a wall `length` bricks long in running bond around windows, with open joints."""
    void = shapely.union_all([window.void() for window in windows])
    shapely.prepare(void)
    width, height = BRICK
    outlines = []
    for course in range(courses):
        starts = np.arange(length) * width if course % 2 == 0 else np.concatenate([[0.0], np.arange(length) * width + width / 2.0])
        ends = np.append(starts[1:], length * width)
        for left, right in zip(starts, ends, strict=True):
            low = course * height
            brick = shapely.box(left + JOINT / 2, low + JOINT / 2, right - JOINT / 2, low + height - JOINT / 2)
            rest = shapely.difference(brick, void) if shapely.intersects(void, brick) else brick
            parts = [part for part in shapely.get_parts(rest) if shapely.area(part) > CUT_OFF]
            outlines += [shapely.get_coordinates(shapely.normalize(part))[:-1] for part in parts]
    return outlines


def voussoirs(window: Window) -> list[tuple[np.ndarray, float, float]]:
    """Return the corners (4, 2), mm, of each voussoir between wedge-shaped joints, and the bulges of its intrados and its extrados."""
    edges = np.linspace(-window.half_angle, window.half_angle, window.voussoirs + 1)
    gap = JOINT / 2.0 / window.radius
    found = []
    for start, end in zip(edges[:-1] + gap, edges[1:] - gap, strict=True):
        arc = np.array([[np.sin(start), np.cos(start)], [np.sin(end), np.cos(end)]])
        outer = window.radius + window.thickness
        corners = window.centre + np.concatenate([window.radius * arc, outer * arc[::-1]])
        bulge = float(np.tan((end - start) / 4.0))
        found.append((corners, -bulge, bulge))  # clockwise below, anticlockwise above
    return found


def with_bulges(outline: np.ndarray, windows: tuple[Window, ...]) -> list[tuple[float, float, float]]:
    """Return the corners of an outline, each with the bulge of its next edge. Points along an extrados become one arc."""
    on_arc = np.zeros(len(outline), dtype=int)
    for number, window in enumerate(windows, 1):
        distance = np.hypot(*(outline - window.centre).T)
        on_arc[np.abs(distance - window.radius - window.thickness - JOINT) < 0.5] = number
    inner = (on_arc > 0) & (on_arc == np.roll(on_arc, 1)) & (on_arc == np.roll(on_arc, -1))
    kept = np.flatnonzero(~inner)
    rows = []
    for k, following in zip(kept, np.roll(kept, -1), strict=True):
        bulge = 0.0
        if on_arc[k] and on_arc[k] == on_arc[following] and (following - k) % len(outline) > 1:
            arms = [outline[i] - windows[on_arc[k] - 1].centre for i in (k, following)]
            sweep = np.arctan2(arms[0][0] * arms[1][1] - arms[0][1] * arms[1][0], arms[0] @ arms[1])
            bulge = float(np.tan(sweep / 4.0))
        rows.append((*np.round(outline[k]).tolist(), bulge))
    return rows


def elevation(length: int, courses: int, windows: tuple[Window, ...], twice: int = 6) -> bytes:
    """Return a DXF file in mm: bricks as inserts, polylines or lines, arcs at the arches, and about `twice` bricks drawn twice."""
    document = ezdxf.new("R2010", units=4)
    for layer, colour in (("BRICKS", 1), ("ARCHES", 3), ("GROUND", 8), ("SETTLING", 5), ("DIMENSIONS", 2)):
        document.layers.add(layer, color=colour)
    stone = document.blocks.new("BRICK")
    whole = (BRICK[0] - JOINT, BRICK[1] - JOINT)
    stone.add_lwpolyline([(0, 0), (whole[0], 0), whole, (0, whole[1])], close=True, dxfattribs={"layer": "0"})
    space = document.modelspace()
    laid = bricks(length, courses, windows)
    for number, outline in enumerate(laid):
        _draw_brick(space, outline, windows, number, whole)
        if number % (len(laid) // twice) == 7:
            _draw_brick(space, outline, windows, number, whole)
    for window in windows:
        for corners, below, above in voussoirs(window):
            points = [(*np.round(corner).tolist(), bulge) for corner, bulge in zip(corners, (below, 0.0, above, 0.0), strict=True)]
            space.add_lwpolyline(points, format="xyb", close=True, dxfattribs={"layer": "ARCHES"})
    end, split = length * BRICK[0], round(0.7 * length) * BRICK[0]
    for layer, left, right in (("GROUND", 0.0, split), ("SETTLING", split, end)):
        corners = [(left, -300), (right, -300), (right, -JOINT / 2), (left, -JOINT / 2)]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
    space.add_text("Elevation 1:50", dxfattribs={"layer": "DIMENSIONS"})
    space.add_line((0, -600), (end, -600), dxfattribs={"layer": "DIMENSIONS"})
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue().encode()


def _draw_brick(space: object, outline: np.ndarray, windows: tuple[Window, ...], number: int, whole: tuple[float, float]) -> None:
    rows = with_bulges(outline, windows)
    corners = np.array(rows)[:, :2]
    is_whole = len(rows) == 4 and np.ptp(corners, axis=0).tolist() == list(whole)
    layer = {"layer": "BRICKS"}
    if is_whole and number % 3 == 0:
        space.add_blockref("BRICK", corners.min(axis=0), dxfattribs=layer)
    elif number % 3 == 1 and not any(bulge for *_, bulge in rows):
        for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            space.add_line(start, end, dxfattribs=layer)
    else:
        space.add_lwpolyline(rows, format="xyb", close=True, dxfattribs=layer)
