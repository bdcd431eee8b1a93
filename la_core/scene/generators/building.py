"""Walls that meet at right angles and interlock: whole buildings, and L, T and cross junctions."""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from la_core.errors import SceneError
from la_core.geometry import Shape, box, prism
from la_core.scene.generators.arched_heads import arched_head
from la_core.scene.generators.courses import ON_LINE, Face, Span
from la_core.scene.generators.wall import NamedShape, piece_shape
from la_core.scene.schema.masonry import SIDES, Building


@dataclass(frozen=True)
class Line:
    """One wall in plan.

    Attributes
    ----------
    side : str
        Name of the wall in its plan.
    axis : int
        Axis along the wall: 0 for x, 1 for y.
    low, high : tuple of float
        Corners with the least and the greatest x and y, m.
    nodes : tuple of Span
        Stretches along the wall, from its start, in which other walls cross it, m.
    """

    side: str
    axis: int
    low: tuple[float, float]
    high: tuple[float, float]
    nodes: tuple[Span, ...] = ()

    @property
    def span(self) -> Span:
        """Start and end of the wall along its axis, m."""
        return self.low[self.axis], self.high[self.axis]


def building_blocks(building: Building) -> Iterator[NamedShape]:
    """Blocks wall by wall, course by course, then the voussoirs of the wall's arches; at the end the strips of the foundation.

    Raises SceneError for openings that do not fit, and for a settling region that cuts a strip lengthwise or contains no strip.
    """
    length, thickness, height = building.block
    lines = _lines(building)
    for line in lines:
        face = Face.upright(f'building "{building.name}": {line.side}', line.span[1] - line.span[0], height, building.courses, length)
        openings = [opening for opening in building.opening if opening.side == line.side]
        for course in range(building.courses):
            through = (line.axis == 0) == (course % 2 == 0)
            added = sum(f.mass for f in building.floor if f.course == course + 1 and line.side in (f.sides or (line.side,)))
            pieces = face.pieces(course, 0.0 if through else length / 2.0, () if through else line.nodes, openings)
            for number, piece in enumerate(pieces, 1):
                flat = piece_shape(piece, 0.0, (0.0, thickness), (face.lines[course], face.lines[course + 1]))
                shape = _placed(building, line, flat)
                name = f"{building.name} {line.side} {course + 1}.{number}"
                yield NamedShape(name, "free", building.density, shape, added_density=added / (thickness * height))
        arches = (opening for opening in openings if opening.head == "arch")
        for opening, head in enumerate((arched_head(face.where, face.lines, face.opening_courses(one)[1], one) for one in arches), 1):
            for number, profile in enumerate(head.voussoirs, 1):
                name = f"{building.name} {line.side} arch {opening}.{number}"
                yield NamedShape(name, "free", building.density, _placed(building, line, prism(profile, (0.0, thickness))))
    if building.foundation:
        yield from _foundation(building, lines)


def _lines(building: Building) -> list[Line]:
    """The walls of a plan, each with the stretches in which the walls of the other direction cross it."""
    x, y = building.size
    t = building.block[1]
    middle_x, middle_y = (x - t) / 2.0, (y - t) / 2.0
    corners = {
        "south": ((0.0, 0.0), (x, t)), "north": ((0.0, y - t), (x, y)), "west": ((0.0, 0.0), (t, y)), "east": ((x - t, 0.0), (x, y)),
        "stem": ((middle_x, 0.0), (middle_x + t, y)), "along x": ((0.0, middle_y), (x, middle_y + t)),
        "along y": ((middle_x, 0.0), (middle_x + t, y)),
    }  # fmt: skip
    walls = [Line(side, "xy".index(axis), *corners[side]) for side, axis in SIDES[building.plan].items()]
    lines = []
    for wall in walls:
        crossing = [other for other in walls if other.axis != wall.axis]
        start = wall.span[0]
        nodes = sorted((other.low[wall.axis] - start, other.high[wall.axis] - start) for other in crossing)
        lines.append(Line(wall.side, wall.axis, wall.low, wall.high, tuple(nodes)))
    return lines


def _placed(building: Building, line: Line, flat: Shape) -> Shape:
    """Move the solid of a wall along x from the origin to its place; the solid of a wall along y is first turned about z by 90 degrees."""
    thickness = building.block[1]

    def motion(points: np.ndarray) -> np.ndarray:
        along, across, up = points[..., 0], points[..., 1], points[..., 2]
        plan = np.stack([along, across] if line.axis == 0 else [thickness - across, along], axis=-1)
        return np.concatenate([plan + line.low, up[..., None]], axis=-1) + building.origin

    return flat.moved(motion)


def _foundation(building: Building, lines: list[Line]) -> Iterator[NamedShape]:
    """Strips under the walls: those along x run through, those along y lie between them."""
    assert building.foundation is not None  # the caller checks it
    settles = False
    for line in lines:
        start, total = line.span[0], line.span[1] - line.span[0]
        cuts = sorted({0.0, total, *(end for node in (line.nodes if line.axis else ()) for end in node)})
        taken = {node for node in line.nodes if line.axis}
        for low, high in itertools.pairwise(cuts):
            if (low, high) in taken or high - low <= ON_LINE * building.block[0]:
                continue
            for number, (span, role) in enumerate(_spans_with_roles(building, line, (start + low, start + high)), 1):
                settles |= role == "support"
                yield NamedShape(f"{building.name} foundation {line.side} {low:g}.{number}", role, None, _strip(building, line, span))
    region = building.foundation.settling
    if region is not None and not settles:
        where = f'building "{building.name}": foundation.settling'
        rule = f"contains no part of a foundation, so nothing settles; its coordinates count from the building's origin, {building.origin}"
        raise SceneError(where, rule, value=(region.from_, region.to))


def _spans_with_roles(building: Building, line: Line, stretch: Span) -> list[tuple[Span, str]]:
    """Spans of a stretch of a strip, cut at the ends of the settling region, each with its role."""
    assert building.foundation is not None
    region, across = building.foundation.settling, 1 - line.axis
    if region is None:
        return [(stretch, "fixed")]
    near = ON_LINE * building.block[0]
    low, high = region.from_[line.axis], region.to[line.axis]
    beside = region.to[across] <= line.low[across] + near or region.from_[across] >= line.high[across] - near
    if beside or high <= stretch[0] + near or low >= stretch[1] - near:
        return [(stretch, "fixed")]
    if region.from_[across] > line.low[across] + near or region.to[across] < line.high[across] - near:
        where = f'building "{building.name}": foundation.settling'
        breadth = f"{line.low[across]:g} to {line.high[across]:g} m"
        rule = f"must contain the strip under the {line.side} wall over its whole breadth, {breadth}"
        raise SceneError(where, rule, value=(region.from_, region.to))
    edges = [stretch[0], *(edge for edge in (low, high) if stretch[0] + near < edge < stretch[1] - near), stretch[1]]
    middles = [(a + b) / 2.0 for a, b in itertools.pairwise(edges)]
    roles = ["support" if low <= middle <= high else "fixed" for middle in middles]
    return list(zip(itertools.pairwise(edges), roles, strict=True))


def _strip(building: Building, line: Line, span: Span) -> Shape:
    """Solid of a span of the strip under a wall."""
    assert building.foundation is not None
    low, high = list(line.low), list(line.high)
    low[line.axis], high[line.axis] = span
    corners = np.array([[*low, -building.foundation.height], [*high, 0.0]]) + building.origin
    return box(*corners.tolist())
