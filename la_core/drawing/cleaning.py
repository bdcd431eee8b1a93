"""Outlines made fit for blocks: enclosed by lines, without doubles, simplified within a tolerance."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
import shapely

from la_core.drawing.outlines import Drawn, OpenOutline, Outline, all_but_closed, enclosed

SNAP = 1e-4  # m: ends of lines this close meet, whatever the tolerance
DOUBLE = 0.8  # of the area of both: outlines that share so much are one outline drawn twice
SPECK = 1e-6  # of the median area: smaller outlines are slips of the pen


@dataclass(frozen=True)
class Cleaned:
    """Outlines that may become blocks, and what was left out.

    Attributes
    ----------
    outlines : tuple of Outline
        The outlines, from below to above and from left to right.
    doubles : int
        Outlines that were drawn twice and are dropped.
    specks : int
        Outlines without area that are dropped.
    loose : int
        Lines that enclose nothing.
    open_outlines : tuple of OpenOutline
        Those of the loose lines that were meant to be outlines.
    straightened : int
        Outlines that were convex but for the tolerance, and are convex now.
    """

    outlines: tuple[Outline, ...]
    doubles: int
    specks: int
    loose: int
    open_outlines: tuple[OpenOutline, ...]
    straightened: int


def cleaned(drawn: Drawn, tolerance: float) -> Cleaned:
    """Find all outlines of a drawing and clean them.

    Parameters
    ----------
    drawn : Drawn
        Content of the drawing, m.
    tolerance : float
        Largest error of the coordinates, m; 0 for none.

    Raises
    ------
    ValueError
        An outline crosses itself.
    """
    outlines, loose, open_ones = list(drawn.outlines), 0, list[OpenOutline]()
    for (layer, colour), lines in drawn.lines.items():
        faces, idle = enclosed(lines, max(SNAP, tolerance))
        outlines += [Outline(face, layer, colour) for face in faces]
        loose += len(idle)
        open_ones += all_but_closed(idle, layer)
    if not outlines:
        return Cleaned((), 0, 0, loose, tuple(open_ones), 0)
    polygons = _simplified(shapely.polygons([shapely.linearrings(outline.points) for outline in outlines]), tolerance)
    crossed = ~shapely.is_valid(polygons)
    if crossed.any():
        raise ValueError(f"{_place(outlines[int(np.argmax(crossed))])}: the outline crosses itself")
    area = shapely.area(polygons)
    speck = area <= max(SPECK * float(np.median(area)), 4.0 * tolerance**2)
    double = _doubles(polygons, speck)
    polygons, straight = _without_dents(polygons, tolerance)
    kept = np.flatnonzero(~speck & ~double)
    place = shapely.get_coordinates(shapely.centroid(polygons[kept]))
    order = kept[np.lexsort((place[:, 0], np.round(place[:, 1], 2)))]
    rings = [shapely.get_coordinates(polygons[k])[:-1] for k in order]
    found = tuple(Outline(ring, outlines[k].layer, outlines[k].colour) for k, ring in zip(order, rings, strict=True))
    return Cleaned(found, int(double.sum()), int(speck.sum()), loose, tuple(open_ones), int(straight[kept].sum()))


def straightened(profile: Sequence[Sequence[float]], tolerance: float) -> list[tuple[float, float]]:
    """A simple profile (n, 2), m, simplified within the tolerance (m), and convex where only dents within it made it not so."""
    outline = shapely.Polygon(profile)
    if tolerance == 0.0 or not outline.is_valid or not outline.area > 0.0:  # which is refused where the block is made
        return [(float(x), float(z)) for x, z in profile]
    polygons, _ = _without_dents(_simplified(np.array([outline]), tolerance), tolerance)
    corners = shapely.get_coordinates(polygons[0])[:-1]
    return [(float(x), float(z)) for x, z in (profile if len(corners) == len(profile) else corners)]


def _simplified(polygons: np.ndarray, tolerance: float) -> np.ndarray:
    return np.asarray(shapely.simplify(shapely.normalize(polygons), tolerance)) if tolerance > 0.0 else polygons


def _without_dents(polygons: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """The polygons, convex where their dents are no deeper than the tolerance (m), and the mask of those that were made so."""
    hull = shapely.convex_hull(polygons)
    dent = shapely.hausdorff_distance(shapely.boundary(hull), shapely.boundary(polygons), densify=0.25)
    straight = (dent > 0.0) & (dent <= tolerance) & (shapely.area(hull) > shapely.area(polygons))
    return np.where(straight, hull, polygons), straight


def _doubles(polygons: np.ndarray, left_out: np.ndarray) -> np.ndarray:
    """Mask of the polygons that share most of their area with an earlier one."""
    double = np.zeros(len(polygons), dtype=bool)
    centre, size = shapely.get_coordinates(shapely.centroid(polygons)), np.sqrt(shapely.area(polygons))
    near = scipy.spatial.cKDTree(centre).query_pairs(float(size.max()) * (1.0 - DOUBLE), output_type="ndarray")
    near = near[~left_out[near].any(axis=1)]
    near = near[np.hypot(*(centre[near[:, 0]] - centre[near[:, 1]]).T) <= (1.0 - DOUBLE) * size[near].min(axis=1)]
    shared = shapely.area(shapely.intersection(polygons[near[:, 0]], polygons[near[:, 1]]))
    whole = shapely.area(polygons)[near].max(axis=1)
    double[near[shared >= DOUBLE * whole].max(axis=1)] = True
    return double


def _place(outline: Outline) -> str:
    x, z = outline.points.mean(axis=0)
    return f'layer "{outline.layer}", near ({x:.4g}, {z:.4g})'
