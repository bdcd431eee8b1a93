"""Lines of a drawing that may be joints or edges of stones, but divide and enclose nothing."""

from collections.abc import Mapping, Sequence

import numpy as np
import shapely

from la_core.drawing.curves import Curves
from la_core.drawing.enclosing import enclosed, outline_polygons, share_near, strings_of
from la_core.drawing.outlines import ALL_BUT_CLOSED, Drawn, Found, LayerCount, all_but_closed, by_layer

ON_EDGE = 1e-3  # m: a line this close to an edge does not lie in the outline
LONG_REST = 0.25  # of the square root of a block's area: a shorter part of a line that ends in the block is a careless end
LINED = 0.1  # of an area's perimeter: lines that bound this share are meant to enclose the area
ENDED = 0.95  # of a line's length: a line that runs along areas with less of its length goes on beyond them, as a dimension does


def retraced(lines: Sequence[np.ndarray], outlines: Sequence[np.ndarray], near: float) -> np.ndarray:
    """Mask of the lines (n, 2) that run along outlines (n, 2) all the way, to within `near` (m): edges that are drawn again."""
    if not lines or not outlines:
        return np.zeros(len(lines), dtype=bool)
    return share_near(strings_of(lines), shapely.boundary(outline_polygons(outlines)), near) == 1.0


def within(lines: Sequence[np.ndarray], outlines: Sequence[np.ndarray]) -> np.ndarray:
    """Mask of the lines (n, 2) that lie for the most part inside outlines (n, 2), and not on their edges."""
    return _share_within(lines, outlines) > 0.5


def _share_within(lines: Sequence[np.ndarray], outlines: Sequence[np.ndarray]) -> np.ndarray:
    """Share (lines,) of the length of each line (n, 2) that lies inside outlines (n, 2), and not on their edges."""
    if not lines or not outlines:
        return np.zeros(len(lines))
    polygons, strings = outline_polygons(outlines), strings_of(lines)
    return share_near(strings, polygons, 0.0) - share_near(strings, shapely.boundary(polygons), ON_EDGE)


def ends_within(rests: Sequence[np.ndarray], outlines: Sequence[np.ndarray]) -> np.ndarray:
    """Mask of the rests of lines (n, 2) inside an outline (n, 2) that are long compared with it: joints that stop short of its edge."""
    mask = within(rests, outlines)
    if mask.any():
        polygons = outline_polygons(outlines)
        middle = shapely.line_interpolate_point(strings_of(rests), 0.5, normalized=True)
        rest, outline = shapely.STRtree(polygons).query(middle, predicate="within")
        size = np.full(len(rests), np.inf)
        np.minimum.at(size, rest, np.sqrt(shapely.area(polygons[outline])))
        mask &= shapely.length(strings_of(rests)) > LONG_REST * size
    return mask


def areas_without_outline(
    lines: Sequence[np.ndarray], outlines: Sequence[np.ndarray], others: Sequence[np.ndarray], snap: float, curves: Curves
) -> list[np.ndarray]:
    """Areas (n, 2) that lines and outlines (n, 2) enclose together, outside all outlines and outside `others` (n, 2).

    An area larger than every outline is left out, because it is the span of an arch and no stone. snap, curves: as in `enclosed`.
    """
    if not lines or not outlines:
        return []
    faces = enclosed(lines, snap, curves, outlines).faces
    if not faces:
        return []
    polygons, tree = outline_polygons(faces), shapely.STRtree(outline_polygons([*outlines, *others]))
    is_free = np.ones(len(faces), dtype=bool)
    is_free[tree.query(shapely.point_on_surface(polygons), predicate="within")[0]] = False
    is_free &= ~shapely.is_empty(shapely.buffer(polygons, -2.0 * snap))
    is_free &= shapely.area(polygons) <= shapely.area(outline_polygons(outlines)).max()
    some = [faces[k] for k in np.flatnonzero(is_free)]
    lined = _lengths_along(some, lines, snap)
    return [face for face, length in zip(some, lined, strict=True) if length >= LINED * shapely.LinearRing(face).length]


def _of_ended_lines(
    lines: Sequence[np.ndarray], outlines: Sequence[np.ndarray], others: Sequence[np.ndarray], snap: float, curves: Curves
) -> list[np.ndarray]:
    """Areas as of `areas_without_outline`, bounded by lines that end at their corners.

    Hatches and axes run across outlines, dimensions and axes go on beyond the areas: they bound none.
    """
    lines = [line for line, inside in zip(lines, _share_within(lines, outlines), strict=True) if inside <= 1.0 - ENDED]
    areas = areas_without_outline(lines, outlines, [*outlines, *others], snap, curves)
    if not areas:
        return []
    share = share_near(strings_of(lines), shapely.boundary(outline_polygons(areas)), 2.0 * snap)
    beyond = [line for line, part in zip(lines, share, strict=True) if part < ENDED]
    along = _lengths_along(areas, beyond, snap) if beyond else np.zeros(len(areas))
    return [area for area, length in zip(areas, along, strict=True) if length <= 4.0 * snap]


def _lengths_along(areas: Sequence[np.ndarray], lines: Sequence[np.ndarray], snap: float) -> np.ndarray:
    """Length (areas,), m, of the part of the edge of each area (n, 2) that runs along lines (n, 2), to within twice `snap` (m)."""
    if not areas:
        return np.zeros(0)
    sides = strings_of([side for area in areas for side in np.stack([area, np.roll(area, -1, axis=0)], axis=1)])
    owner = np.repeat(np.arange(len(areas)), [len(area) for area in areas])
    return np.bincount(owner, share_near(sides, strings_of(lines), 2.0 * snap) * shapely.length(sides))


def shared_areas(
    idle: Mapping[tuple[str, str], list[np.ndarray]], found: Found, outlines: Sequence[np.ndarray], snap: float, curves: Curves
) -> list[tuple[frozenset[tuple[str, str]], np.ndarray]]:
    """Areas (n, 2) without an outline that lines of several layers or colours enclose together, each with these layers and colours.

    idle: lines that bound nothing, by layer and colour. outlines: (n, 2) arrays without contours. snap, curves: as in `enclosed`.
    """
    if len(idle) < 2:
        return []
    every = [line for lines in idle.values() for line in lines]
    told = [line for line in every if any(all_but_closed([line], ""))]
    try:
        areas = areas_without_outline(every, outlines, [*told, *(points for _, points in found.around)], snap, curves)
    except ValueError:  # lines that cross each other so often are hatches
        return []
    along = {place: _lengths_along(areas, lines, snap) > 4.0 * snap for place, lines in idle.items()}
    places = [frozenset(place for place, is_along in along.items() if is_along[k]) for k in range(len(areas))]
    return [(some, area) for some, area in zip(places, areas, strict=True) if len(some) > 1]


def lost(
    found: Found,
    drawn: Drawn,
    built: Mapping[tuple[str, str], list[np.ndarray]],
    shared: Sequence[np.ndarray],
    snap: float,
    curves: Curves,
) -> tuple[tuple[LayerCount, ...], tuple[LayerCount, ...]]:
    """Count by layer the lines that may be edges of stones, and the areas that may be stones, but belong to no block.

    Lines and areas with another remark are left out. built: lines that bound nothing, by layer and colour, of layers that become blocks.
    shared: areas (n, 2) that lines of several layers enclose; they have another remark.
    """
    rings = [outline.points for outline in found.outlines]
    around = [points for _, points in found.around]
    edges: list[tuple[str, np.ndarray]] = []
    areas: list[tuple[str, np.ndarray]] = []
    every = [line for lines in drawn.lines.values() for line in lines]
    for (layer, colour), lines in drawn.lines.items():
        alike = [outline.points for outline in found.outlines if outline.place == (layer, colour)]
        idle = found.idle.get((layer, colour), [])
        told = [line for line in (*idle, *(line for _, line in found.again)) if any(all_but_closed([line], layer))]
        if not alike:  # dimensions and the like lie on layers without stones, so single lines there are no edges
            alone = built.get((layer, colour), [])
            here = _of_ended_lines(alone, rings, [*around, *told, *shared], snap, curves)
            areas += [(layer, area) for area in here]
            continue
        here = areas_without_outline(lines, [*alike, *around, *told], rings, snap, curves) if drawn.outlines else []
        meets = nearly_enclosing(idle, every, rings, snap) & ~retraced(idle, [*here, *around, *told, *shared], 2.0 * snap)
        edges += [(layer, line) for line, is_told in zip(idle, meets, strict=True) if is_told]
        areas += [(layer, area) for area in here]
    return by_layer(edges), by_layer(areas)


def nearly_enclosing(idle: Sequence[np.ndarray], lines: Sequence[np.ndarray], outlines: Sequence[np.ndarray], snap: float) -> np.ndarray:
    """Mask of the idle lines (n, 2) outside outlines (n, 2) whose ends both meet another line or an outline, or nearly meet it.

    An end nearly meets a line or outline that is no farther from it than ALL_BUT_CLOSED times the length of the idle line. An idle line
    along an outline is left out, because it is no edge of another stone.
    """
    if not idle:
        return np.zeros(0, dtype=bool)
    strings = strings_of(idle)
    rings = shapely.boundary(outline_polygons(outlines)) if outlines else np.zeros(0, dtype=object)
    every = np.concatenate([strings_of(lines), rings])
    near = ALL_BUT_CLOSED * shapely.length(strings)
    mask = ~within(idle, outlines) & (near > 2.0 * snap)
    if len(rings):
        mask &= share_near(strings, rings, 2.0 * snap) < 0.5
    for end in (0, -1):
        tip, other = shapely.STRtree(every).query(shapely.get_point(strings, end), predicate="dwithin", distance=near)
        apart = ~shapely.equals_exact(strings[tip], every[other])
        met = np.zeros(len(strings), dtype=bool)
        met[tip[apart]] = True
        mask &= met
    return mask
