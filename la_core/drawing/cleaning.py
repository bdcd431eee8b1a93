"""Outlines of blocks from a drawing: lines that enclose outlines are found, doubles are dropped, and outlines are simplified."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
import shapely

from la_core.drawing.curves import Curves
from la_core.drawing.doubts import ends_within, lost, retraced, shared_areas, within
from la_core.drawing.enclosing import conforming, divided, dividing, enclosed, of_own_lines, touched
from la_core.drawing.outlines import (
    Drawn,
    Found,
    LayerCount,
    OpenOutline,
    Outline,
    SharedAreas,
    all_but_closed,
    by_layer,
    by_places,
    end_met,
    refuse_flat,
)
from la_core.text_table import place_text

SNAP = 1e-4  # m: ends of lines this close to each other meet, also where the tolerance is smaller
DOUBLE = 0.8  # of the area of each: two outlines that share this much are one outline drawn twice
MOST_PAIRS = 1_000_000  # pairs of outlines whose bounding boxes meet; 50,000 blocks side by side have a quarter of this number
AT_A_TIME = 200  # outlines whose pairs are counted together, to save memory
MOST_CUT = 1.1  # over the tolerance times the perimeter of the hull: largest area of dents within the tolerance, with a margin
ALIKE = 1e-3  # relative difference up to which two areas count as equal
FILLED, FILLED_BY_ALL = 0.5, 0.8  # of a contour's area: least share filled by outlines of its layer and colour, or of all layers
BUILT = ("ground", "support", "blocks")  # lists of layers whose outlines become blocks
RANKS = ("openings", *BUILT, "ignore")  # lists of layers; of an outline drawn on layers of two lists, the one in the first list is kept
SPECK = 1e-6  # of the median area: smaller outlines are slips of the pen


@dataclass(frozen=True)
class Cleaned:
    """Outlines that may become blocks, and a record of the outlines and lines left out.

    Attributes
    ----------
    outlines : tuple of Outline
        The outlines, from below to above and from left to right.
    doubles : int
        Number of outlines dropped because they are drawn twice.
    specks : int
        Number of outlines dropped because they have no area or are thinner than the tolerance.
    loose : int
        Number of lines that enclose nothing, or are edges of outlines drawn again.
    open_outlines : tuple of OpenOutline
        Loose lines that were meant as outlines.
    straightened : int
        Number of outlines that were convex within the tolerance and were made exactly convex.
    around : tuple of LayerCount
        Outlines around others, which are left out.
    across : tuple of LayerCount
        Lines that divide outlines of other layers.
    idle : tuple of (str, (n, 2) array)
        The lines that enclose nothing, each with its layer.
    rests : tuple of (str, (n, 2) array)
        Parts of other lines that bound nothing, each with its layer.
    edges : tuple of LayerCount
        Idle lines that may be edges of stones: both ends meet other lines or outlines, or nearly meet them.
    areas : tuple of LayerCount
        Areas without an outline that lines and outlines enclose together.
    shared : tuple of SharedAreas
        Areas without an outline that idle lines of several layers or colours enclose together.
    of_two_kinds : tuple of LayerCount
        Outlines dropped because they are drawn twice, and the other one gives the block another role, thickness or density.
    """

    outlines: tuple[Outline, ...]
    doubles: int
    specks: int
    loose: int
    open_outlines: tuple[OpenOutline, ...]
    straightened: int
    around: tuple[LayerCount, ...] = ()
    across: tuple[LayerCount, ...] = ()
    idle: tuple[tuple[str, np.ndarray], ...] = ()
    rests: tuple[tuple[str, np.ndarray], ...] = ()
    edges: tuple[LayerCount, ...] = ()
    areas: tuple[LayerCount, ...] = ()
    shared: tuple[SharedAreas, ...] = ()
    of_two_kinds: tuple[LayerCount, ...] = ()

    def stray(self, blocks: Sequence[Outline]) -> tuple[LayerCount, ...]:
        """Count by layer the idle lines, and the rests of other lines, that lie in blocks."""
        rings = [block.points for block in blocks]
        inside = [*within([line for _, line in self.idle], rings), *ends_within([rest for _, rest in self.rests], rings)]
        return by_layer(one for one, is_inside in zip((*self.idle, *self.rests), inside, strict=True) if is_inside)


def cleaned(
    drawn: Drawn, tolerance: float, list_of: Callable[..., str] = lambda *_: "blocks", values_of: Callable[..., object] = lambda *_: None
) -> Cleaned:
    """Find all outlines of a drawing and clean them.

    Parameters
    ----------
    drawn : Drawn
        Content of the drawing, m.
    tolerance : float
        Largest error of the coordinates, m; 0 for none.
    list_of, values_of : callable
        Of a layer and colour: name of its list, and values of its blocks. Only "blocks" may be contours; "ignore" fills no contour.

    Raises
    ------
    ValueError
        The drawing has no width or height, an outline crosses itself, more than MOST_PAIRS pairs of outlines overlap, or lines cross too
        often.
    """
    curves = Curves(drawn.curves, drawn.sagitta)
    found = _found(drawn, max(SNAP, tolerance), curves)
    outlines, idle = found.outlines, tuple((place[0], line) for place, lines in found.idle.items() for line in lines)
    open_ones = tuple(one for layer, line in (*idle, *found.again) for one in all_but_closed([line], layer))
    loose = len(idle) + len(found.again)
    refuse_flat([outline.points for outline in outlines], [line for _, line in idle])
    found.outlines, polygons, flat = _with_area(outlines, tolerance)
    outlines = found.outlines
    if not outlines:
        return Cleaned((), 0, flat, loose, open_ones, 0, by_layer(found.around), (), idle)
    _refuse_a_heap(polygons)
    area = shapely.area(polygons)
    speck = area <= _speck_area(area, tolerance)
    speck |= shapely.is_empty(shapely.buffer(polygons, -0.5 * tolerance)) if tolerance > 0.0 else False
    lists = np.array([list_of(*outline.place) for outline in outlines])
    double, of_two_kinds = _doubles(polygons, speck, lists, [values_of(*outline.place) for outline in outlines])
    contour = _contours(polygons, outlines, speck | double | (lists == "ignore")) & (lists == "blocks")
    around = by_layer((*found.around, *((outlines[k].layer, outlines[k].points) for k in np.flatnonzero(contour))))
    polygons, straight = _without_dents(polygons, tolerance)
    kept = np.flatnonzero(~speck & ~double & ~contour)
    place = shapely.get_coordinates(shapely.centroid(polygons[kept]))
    order = kept[np.lexsort((place[:, 0], np.round(place[:, 1], 2)))]
    rings = conforming([shapely.get_coordinates(polygons[k])[:-1] for k in order], max(SNAP, tolerance), curves)
    if tolerance > 0.0:  # chords through corners of neighbours may have left dents within the tolerance
        rings = [
            shapely.get_coordinates(one)[:-1] for one in _without_dents(np.array([shapely.Polygon(ring) for ring in rings]), tolerance)[0]
        ]
    clean = tuple(Outline(points, *outlines[k].place) for k, points in zip(order, rings, strict=True))
    counts = int(double.sum()), flat + int(speck.sum()), loose, open_ones, int(straight[kept].sum()), around, by_layer(found.across)
    built = {place: lines for place, lines in found.idle.items() if list_of(*place) in BUILT}
    shared = shared_areas(built, found, [outlines[k].points for k in np.flatnonzero(~contour)], max(SNAP, tolerance), curves)
    edges, areas = lost(found, drawn, built, [area for _, area in shared], max(SNAP, tolerance), curves)
    roles = by_layer((outlines[k].layer, outlines[k].points) for k in np.flatnonzero(of_two_kinds))
    return Cleaned(clean, *counts, idle, tuple(found.rests), edges, areas, by_places(shared), roles)


def _found(drawn: Drawn, snap: float, curves: Curves) -> Found:
    """Find the outlines that are drawn closed, that lines of one layer and colour enclose, or that lines of other layers divide."""
    found = Found([end_met(outline, snap) for outline in drawn.outlines], {}, [], [], [], [])
    for (layer, colour), of_layer in drawn.lines.items():
        every = of_layer
        here = [k for k, outline in enumerate(found.outlines) if outline.place == (layer, colour)]
        again = retraced(every, [found.outlines[k].points for k in here], 2.0 * snap)
        if again.any():  # edges of a stone drawn as lines run along its neighbours, too
            stones = of_own_lines(every, snap, curves, [outline.points for outline in found.outlines])
            found.outlines += [Outline(stone, layer, colour) for stone in stones]
            again &= ~(own := retraced(every, stones, 2.0 * snap))
            every, again = [line for line, is_own in zip(every, own, strict=True) if not is_own], again[~own]
        found.again += [(layer, line) for line, is_again in zip(every, again, strict=True) if is_again]
        lines = [line for line, is_again in zip(every, again, strict=True) if not is_again]
        if not lines:
            continue
        take_part = touched([found.outlines[k].points for k in here], lines, snap + curves.sagitta)
        rings = [here[k] for k in np.flatnonzero(take_part)]
        new = enclosed(lines, snap, curves, [found.outlines[k].points for k in rings])
        replaced = set(rings)
        found.outlines = [outline for k, outline in enumerate(found.outlines) if k not in replaced]
        found.outlines += [Outline(face, layer, colour) for face in new.faces]
        found.around += [(layer, points) for points in new.around]
        found.rests += [(layer, rest) for rest in new.rests]
        found.idle[layer, colour] = [line for line, is_idle in zip(lines, new.idle, strict=True) if is_idle]
    return _with_lines_of_other_layers(found, snap, curves)


def _with_lines_of_other_layers(found: Found, snap: float, curves: Curves) -> Found:
    """Divide outlines by lines that bound nothing on their own layer, because head joints and bed joints often have a layer each."""
    lines = [(place, line) for place, some in found.idle.items() for line in some]
    which, whose = dividing([outline.points for outline in found.outlines], [line for _, line in lines], 2.0 * snap + curves.sagitta)
    used: set[int] = set()
    outlines: list[Outline] = []
    for k, outline in enumerate(found.outlines):
        across = which[whose == k]
        parts = divided(outline.points, [lines[j][1] for j in across], snap, curves) if len(across) else [outline.points]
        used |= set(across.tolist()) if len(parts) > 1 else set()
        outlines += [Outline(part, *outline.place) for part in parts]
    idle: dict[tuple[str, str], list[np.ndarray]] = {}
    for j, (place, line) in enumerate(lines):
        if j not in used:
            idle.setdefault(place, []).append(line)
    return Found(outlines, idle, found.around, [(lines[j][0][0], lines[j][1]) for j in sorted(used)], found.again, found.rests)


def _with_area(outlines: Sequence[Outline], tolerance: float) -> tuple[list[Outline], np.ndarray, int]:
    """Leave out outlines that run to and fro without an area. Return the others, their simplified polygons, and the number left out.

    Raises ValueError for any other outline that crosses itself.
    """
    if not outlines:
        return [], np.zeros(0, dtype=object), 0
    polygons = _simplified(shapely.polygons([shapely.linearrings(outline.points) for outline in outlines]), tolerance)
    crossed = ~shapely.is_valid(polygons)
    area = shapely.area(polygons)
    area[crossed] = shapely.area(shapely.make_valid(polygons[crossed]))  # both loops of a figure of eight count
    flat = crossed & (area <= _speck_area(area, tolerance))
    if (crossed & ~flat).any():
        first = outlines[int(np.argmax(crossed & ~flat))]
        where = f'layer "{first.layer}", near {place_text(first.points.mean(axis=0).tolist())}'
        raise ValueError(f"{where}: the outline crosses itself; correct it, or list its layer in `ignore`")
    return [outline for outline, is_flat in zip(outlines, flat, strict=True) if not is_flat], polygons[~flat], int(flat.sum())


def _speck_area(area: np.ndarray, tolerance: float) -> float:
    """Largest area of a slip of the pen, m2, from the areas (n,) of all outlines, m2, and the tolerance, m."""
    return max(SPECK * float(np.median(area)), 4.0 * tolerance**2)


def straightened(profile: Sequence[Sequence[float]], tolerance: float) -> list[tuple[float, float]]:
    """A profile (n, 2), m, simplified within the tolerance (m), and made convex if its dents are no deeper than the tolerance."""
    outline = shapely.Polygon(profile)
    if tolerance == 0.0 or not outline.is_valid or not outline.area > 0.0:  # an invalid profile is refused later
        return [(float(x), float(z)) for x, z in profile]
    polygons, _ = _without_dents(_simplified(np.array([outline]), tolerance), tolerance)
    corners = shapely.get_coordinates(polygons[0])[:-1]
    return [(float(x), float(z)) for x, z in (profile if len(corners) == len(profile) else corners)]


def _simplified(polygons: np.ndarray, tolerance: float) -> np.ndarray:
    return np.asarray(shapely.simplify(shapely.normalize(polygons), tolerance)) if tolerance > 0.0 else polygons


def _without_dents(polygons: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Make polygons convex whose dents are no deeper than the tolerance (m). Return all polygons, and the mask of the changed ones."""
    hull = shapely.convex_hull(polygons)
    cut = shapely.area(hull) - shapely.area(polygons)
    straight = (cut > 0.0) & (cut <= MOST_CUT * tolerance * shapely.length(hull))  # deeper dents have more area; the next test costs n^2
    dent = shapely.hausdorff_distance(shapely.boundary(hull[straight]), shapely.boundary(polygons[straight]), densify=0.25)
    straight[straight] = (dent > 0.0) & (dent <= tolerance)
    return np.where(straight, hull, polygons), straight


def _refuse_a_heap(polygons: np.ndarray) -> None:
    """Raise ValueError where far too many outlines lie upon each other, because their comparison would take minutes."""
    tree, pairs = shapely.STRtree(polygons), 0.0
    for start in range(0, len(polygons), AT_A_TIME):
        pairs += tree.query(polygons[start : start + AT_A_TIME]).shape[1] / 2.0  # the tree finds each pair twice
        if pairs > MOST_PAIRS:
            raise ValueError(
                f"its {len(polygons)} outlines lie upon each other, in more than {MOST_PAIRS:,} pairs; "
                "draw blocks beside each other, and list layers of other things in `ignore`"
            )


def _doubles(polygons: np.ndarray, left_out: np.ndarray, lists: np.ndarray, values: Sequence[object]) -> tuple[np.ndarray, np.ndarray]:
    """Mask of the polygons that share most of their area with another one, which is kept, and of those whose list or values differ from it.

    The polygon in the first of the lists RANKS is kept; in the same list the larger one, and of equal areas the earlier one.
    """
    double, of_two_kinds = np.zeros((2, len(polygons)), dtype=bool)
    centre, size = shapely.get_coordinates(shapely.centroid(polygons)), np.sqrt(shapely.area(polygons))
    near = scipy.spatial.cKDTree(centre).query_pairs(float(size.max()) * (1.0 - DOUBLE), output_type="ndarray")
    near = np.sort(near[~left_out[near].any(axis=1)], axis=1)
    near = near[np.hypot(*(centre[near[:, 0]] - centre[near[:, 1]]).T) <= (1.0 - DOUBLE) * size[near].min(axis=1)]
    shared = shapely.area(shapely.intersection(polygons[near[:, 0]], polygons[near[:, 1]]))
    twice = near[shared >= DOUBLE * shapely.area(polygons)[near].max(axis=1)]
    area, rank = shapely.area(polygons)[twice], np.array([RANKS.index(one) for one in lists])[twice]
    is_larger = (area[:, 1] > area[:, 0] * (1.0 + ALIKE)) & (rank[:, 0] == rank[:, 1])
    dropped = np.where(is_larger | (rank[:, 1] < rank[:, 0]), twice[:, 0], twice[:, 1])
    double[dropped] = True
    differs = np.array([lists[i] != lists[j] or values[i] != values[j] for i, j in twice], dtype=bool)
    of_two_kinds[dropped[np.isin(lists[twice], BUILT).all(axis=1) & differs]] = True
    return double, of_two_kinds


def _contours(polygons: np.ndarray, outlines: Sequence[Outline], left_out: np.ndarray) -> np.ndarray:
    """Mask of the contours drawn around blocks: polygons that two or more other polygons fill for the most part."""
    area = shapely.area(polygons)
    inner, outer = shapely.STRtree(polygons).query(polygons, predicate="intersects")
    smaller = (area[inner] < area[outer]) & ~left_out[inner] & ~left_out[outer]
    inner, outer = inner[smaller], outer[smaller]
    within = shapely.area(shapely.intersection(polygons[inner], polygons[outer])) >= DOUBLE * area[inner]
    inner, outer = inner[within], outer[within]
    held: dict[int, list[int]] = {}  # outlines in each outline
    holders: dict[int, set[int]] = {}  # outlines around each outline
    for j, k in zip(inner.tolist(), outer.tolist(), strict=True):
        held.setdefault(k, []).append(j)
        holders.setdefault(j, set()).add(k)
    mask = np.zeros(len(area), dtype=bool)
    for k in sorted(held, key=lambda k: float(area[k])):  # the smallest first: a contour does not fill a larger contour, but its stones do
        stones = {j for j in held[k] if not mask[j]}
        some = [j for j in stones if stones.isdisjoint(holders.get(j, ()))]  # an outline within a stone fills no further area
        alike = [j for j in some if outlines[j].place == outlines[k].place]
        mask[k] = any(len(these) > 1 and area[these].sum() >= share * area[k] for these, share in ((alike, FILLED), (some, FILLED_BY_ALL)))
    return mask
