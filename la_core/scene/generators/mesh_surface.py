"""A surface from a file, and the check that it encloses one body: convex, or a prism of any profile."""

from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy
import shapely
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from shapely.geometry.polygon import orient

from la_core.geometry import FACE_FLATNESS, Shape, divided_loft, plane_axes, polyhedron, without_straight_corners
from la_core.repair import with_plane_faces, without_bent_faces
from la_core.scene.schema.types import LARGEST
from la_core.text_table import place_text

WELD = 1e-6  # of the body's size: corners closer than this are one; single precision resolves a tenth of it
MOST_CORNERS = 1000  # of one body: more belong to a scan or an ornament, not to a block with plane joints
MOST_PROFILE = 100  # corners of a profile with dents: its division into convex parts takes a second, or eight for twice as many corners
MOST_DENT = 0.02  # m: errors of coordinates are smaller
STRAIGHT = (1e-9, 1e-6, 1e-5, FACE_FLATNESS)  # of the size: corners this close to a line lie on it; the least value that works is taken
NEAR_END = 6.0  # over the tolerance: corners this close to the outermost corner belong to its end, as a triangle's plane is inexact
FOLDED = 1e-2  # of the hull's volume: largest difference between the volumes of a surface on its hull and of the hull


@dataclass(frozen=True)
class Surface:
    """Surface of one body of a file.

    Attributes
    ----------
    name : str
        Name of the body in the file.
    vertices : (n, 3) array
        Vertices, in the file's unit.
    faces : tuple of tuples of int
        Loop of vertices of each face.
    held : bool
        Whether the file marks the body as held.
    """

    name: str
    vertices: np.ndarray
    faces: tuple[tuple[int, ...], ...]
    held: bool = False


def surface(name: str, vertices: np.ndarray, faces: Sequence[Sequence[int]], held: bool = False) -> Surface:
    """Make a surface from faces and the vertices that the faces use.

    Parameters
    ----------
    name : str
        Name of the body.
    vertices : (m, 3) array
        Vertices of the file.
    faces : sequence of sequences of int
        Loop of vertices of each face.
    held : bool
        Whether the file marks the body as held.
    """
    if not faces:
        return Surface(name, np.zeros((0, 3)), (), held)
    used, numbers = np.unique(np.concatenate([np.array(face, dtype=int) for face in faces]), return_inverse=True)
    loops = np.split(numbers, np.cumsum([len(face) for face in faces])[:-1])
    return Surface(name, vertices[used], tuple(tuple(loop.tolist()) for loop in loops), held)


def shape_of(body: Surface, tolerance: float = 0.0) -> tuple[Shape, bool]:
    """Turn a surface into a convex shape with plane faces, or into a compound where it is a prism of a profile with dents.

    Dents no deeper than the tolerance (m) are filled; the second value says whether dents were filled.

    Raises ValueError with the defect: no faces, open, inconsistent normals, several shells, not convex, no volume.
    """
    if not body.faces:
        raise ValueError("is empty: it has no faces")
    if not np.all(np.abs(body.vertices) <= LARGEST):  # also false for NaN
        raise ValueError(f"has a coordinate that is not a number or beyond {LARGEST:g} m")
    vertices, triangles, faces = _welded(body)
    if not faces:
        raise ValueError("is degenerate: every face has shrunk to a line or a point")
    _refuse_unpaired_edges(faces)
    try:
        shape = polyhedron(vertices.tolist())
    except ValueError as error:
        raise ValueError(f"is degenerate: it {str(error).removeprefix('the polyhedron ')}") from error
    size = float(np.ptp(vertices, axis=0).max())
    try:
        deepest = _deepest_dent(vertices, triangles, faces, tolerance)
    except ValueError:
        if (prism := _exact_or_surveyed_prism(vertices, triangles, faces, tolerance)) is None:
            raise
        return prism, False
    if deepest <= FACE_FLATNESS * size:  # a program may have made the body convex already, with bent faces
        return without_bent_faces(shape, tolerance), False
    return with_plane_faces(polyhedron(vertices.tolist(), 2.0 * deepest / size), tolerance), True


def _welded(body: Surface) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """Vertices with near vertices merged, triangles (T, 3), and faces without equal corners in a row."""
    points, number = np.unique(body.vertices, axis=0, return_inverse=True)
    if len(points) > MOST_CORNERS:
        raise ValueError(f"has {len(points)} corners; simplify it to the plane faces of a block, with at most {MOST_CORNERS} corners")
    near = scipy.spatial.cKDTree(points).query_pairs(WELD * np.ptp(points, axis=0).max(), output_type="ndarray")
    group = _groups(near, len(points)) if len(near) else np.arange(len(points))
    first = np.unique(group, return_index=True)[1]
    loops = [group[number.ravel()[list(face)]] for face in body.faces]
    faces = [loop[loop != np.roll(loop, 1)] for loop in loops]
    faces = _once([face for face in faces if len(face) >= 3])
    fans = [(face[0], second, third) for face in faces for second, third in pairwise(face[1:])]
    return points[first], np.array(fans, dtype=int).reshape(-1, 3), faces


def _once(faces: list[np.ndarray]) -> list[np.ndarray]:
    """The faces; each face once where the file has every face several times."""
    first: dict[tuple[int, ...], np.ndarray] = {}
    count: Counter[tuple[int, ...]] = Counter()
    for face in faces:
        corners = tuple(np.roll(face, -int(np.argmin(face))).tolist())
        first.setdefault(corners, face)
        count[corners] += 1
    return list(first.values()) if count and min(count.values()) > 1 else faces


def _groups(pairs: np.ndarray, count: int) -> np.ndarray:
    """Connected component (count,) of each of `count` nodes that pairs (P, 2) connect."""
    return np.asarray(connected_components(sparse.coo_matrix((np.ones(len(pairs)), pairs.T), shape=(count, count)), directed=False)[1])


def _refuse_unpaired_edges(faces: list[np.ndarray]) -> None:
    """Raise ValueError for a surface that is open, inconsistently oriented, or of several shells.

    A closed oriented surface runs along every edge twice, once in each direction. The edges connect the faces of one shell.
    """
    owner = np.repeat(np.arange(len(faces)), [len(face) for face in faces])
    ends = np.stack([np.concatenate(faces), np.concatenate([np.roll(face, -1) for face in faces])], axis=1)
    _, edge, uses = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True, return_counts=True)
    edge = edge.ravel()
    if lone := int(np.sum(uses == 1)):
        raise ValueError(f"is open: {lone} of its {len(uses)} edges lack a partner; close its holes in the program that made it")
    if np.any(uses > 2):
        several = f"{np.sum(uses > 2)} of its {len(uses)} edges belong to more than two faces"
        raise ValueError(f"is not the surface of one body: {several}; give every body its own object, group or file")
    forward = np.bincount(edge, weights=np.where(ends[:, 0] < ends[:, 1], 1.0, -1.0))
    if np.any(forward != 0.0):
        raise ValueError(f"has inconsistent normals: {np.sum(forward != 0.0)} of its {len(uses)} edges run the same way in both faces")
    neighbours = owner[np.argsort(edge)].reshape(-1, 2)
    shells = _groups(neighbours, len(faces)).max() + 1
    if shells > 1:
        raise ValueError(f"consists of {shells} separate shells; give every body its own object, group or file")


def _deepest_dent(vertices: np.ndarray, triangles: np.ndarray, faces: list[np.ndarray], tolerance: float) -> float:
    """Depth (m) of a closed surface's deepest dent; raises ValueError where it is deeper than the tolerance (m), or the surface is folded.

    The vertices, edges and triangles of a convex surface lie on its convex hull, and the surface encloses the hull's volume.
    """
    centre, size = vertices.mean(axis=0), float(np.ptp(vertices, axis=0).max())
    points = (vertices - centre) / size
    hull = scipy.spatial.ConvexHull(points)
    edges = np.concatenate([points[face] + points[np.roll(face, -1)] for face in faces]) / 2.0
    corners = points[triangles]
    on_surface = np.concatenate([points, edges, corners.mean(axis=1)])
    depth = -np.max(on_surface @ hull.equations[:, :3].T + hull.equations[:, 3], axis=1)
    deepest = size * float(depth.max())
    if deepest > max(FACE_FLATNESS * size, tolerance):
        where = place_text((centre + size * on_surface[np.argmax(depth)]).tolist())
        raise ValueError(f"is not convex: its deepest dent, near {where}, lies {deepest:.3g} m below its convex hull{_advice(deepest)}")
    volume = abs(np.sum(corners[:, 0] * np.cross(corners[:, 1], corners[:, 2]))) / 6.0
    filled = tolerance / size * hull.area if deepest > FACE_FLATNESS * size else 0.0
    if abs(volume - hull.volume) > FOLDED * hull.volume + filled:
        raise ValueError(f"is folded: its faces enclose {volume / hull.volume:.3g} of the volume of its convex hull")
    return deepest


def _exact_or_surveyed_prism(vertices: np.ndarray, triangles: np.ndarray, faces: list[np.ndarray], tolerance: float) -> Shape | None:
    """The body as a prism, else None. An exact prism keeps all corners of its curves; a prism within the tolerance (m) loses some."""
    with suppress(ValueError):  # an outline that cannot be divided
        if tolerance > 0.0 and (exact := _prism(vertices, triangles, faces)) is not None:
            return exact
    return _prism(vertices, triangles, faces, tolerance)


def _prism(vertices: np.ndarray, triangles: np.ndarray, faces: list[np.ndarray], tolerance: float = 0.0) -> Shape | None:
    """The body as a prism, else None: faces in two parallel planes fill the same outline without holes; other corners lie on the sides.

    tolerance: largest error of the coordinates, m. A corner of an end lies within twice the tolerance of the plane that fits the ends
    best, and of the corner at the other end, because both may be wrong by the tolerance.
    """
    flat_within = FACE_FLATNESS * float(np.ptp(vertices, axis=0).max())
    slack = max(flat_within, 2.0 * tolerance)
    corners = vertices[triangles] - vertices[0]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(area, axis=1)
    order = np.argsort(-length, kind="stable")[: np.count_nonzero(length > max(flat_within, tolerance) ** 2)]
    volume, surface = abs(np.sum(corners[:, 0] * np.cross(corners[:, 1], corners[:, 2]))) / 6.0, float(length.sum()) / 2.0
    for across in area[order] / length[order, None]:  # the largest triangle of an end gives its plane best
        normal, low, high = _ends(vertices, across, tolerance)
        height, axes = vertices @ normal, np.concatenate(plane_axes(normal[None]))
        flat = vertices @ axes.T
        on_ends = [np.abs(height[triangles] - at).max(axis=1) <= slack for at in (high, low)]
        enclosed = [abs(float((area[on_end] @ normal).sum())) / 2.0 * (high - low) for on_end in on_ends]
        if np.abs(np.subtract(enclosed, volume)).max() > FOLDED * volume + tolerance * surface:  # this check alone excludes most planes
            continue
        ends = [_outline(flat, [face for face in faces if np.abs(height[face] - at).max() <= slack]) for at in (high, low)]
        if any(end.is_empty for end in ends):
            continue
        # The volume between the ends must equal that of the body. Only the corners of the ends may be wrong, by up to the slack.
        filled = (high - low) * shapely.area(ends)
        if np.abs(filled - volume).max() > min(FOLDED * volume, flat_within * surface) + tolerance * surface:
            continue
        between = shapely.points(flat[(height > low + slack) & (height < high - slack)])
        is_same = shapely.hausdorff_distance(ends[0].exterior, ends[1].exterior) <= slack
        if is_same and np.all(shapely.distance(between, ends[0].exterior) <= slack):
            outline = ends[0] if tolerance == 0.0 else _mean_outline(ends, tolerance)
            if shapely.hausdorff_distance(outline.exterior, outline.convex_hull.exterior) > tolerance:  # else it has no dents
                return _divided(outline, axes, normal, (low, high), slack)
    return None


def _ends(vertices: np.ndarray, normal: np.ndarray, tolerance: float) -> tuple[np.ndarray, float, float]:
    """Unit normal (3,) of two ends, and their heights along it (m): of the outermost corners, or of best-fit planes of inexact ends.

    normal: unit normal (3,) of a triangle of an end; its corners may be wrong by the tolerance (m).
    """
    height = vertices @ normal
    if tolerance == 0.0:
        return normal, float(height.min()), float(height.max())
    for _ in range(2):  # the first fit improves the choice of the corners of the ends
        on_ends = [np.abs(height - at) <= NEAR_END * tolerance for at in (height.min(), height.max())]
        beside = np.concatenate([vertices[on_end] - vertices[on_end].mean(axis=0) for on_end in on_ends])
        fitted = np.linalg.svd(beside, full_matrices=False)[2][-1]
        normal = fitted if fitted @ normal > 0.0 else -fitted
        height = vertices @ normal
    low, high = (float(height[on_end].mean()) for on_end in on_ends)
    return normal, low, high


def _mean_outline(ends: list[shapely.Polygon], tolerance: float) -> shapely.Polygon:
    """The outline half way between the outlines of two ends, without corners within the tolerance (m) of a line between other corners."""
    points, others = (shapely.get_coordinates(end.exterior)[:-1] for end in ends)
    distance, nearest = scipy.spatial.cKDTree(others).query(points)
    near = distance <= 2.0 * tolerance
    points[near] = (points[near] + others[nearest[near]]) / 2.0
    outline = shapely.Polygon(points).simplify(tolerance)
    return outline if outline.is_valid else ends[0]


def _divided(outline: shapely.Polygon, axes: np.ndarray, normal: np.ndarray, heights: tuple[float, float], slack: float) -> Shape:
    """The prism of an outline in the plane of two axes (2, 3) between two heights along their unit normal (3,), m.

    Inexact coordinates make slight dents at corners of straight edges, from which a cut may be impossible. Where the outline cannot be
    divided, these corners are left out, as long as the outline moves by no more than the slack, m.
    """
    points, (low, high) = shapely.get_coordinates(orient(outline).exterior)[:-1], heights
    fault = ValueError("the outline cannot be divided")
    for flatness in STRAIGHT:
        profile = without_straight_corners(points, flatness)
        if len(profile) > MOST_PROFILE:
            raise ValueError(f"is a prism of a profile with dents and {len(profile)} corners; at most {MOST_PROFILE} can be divided")
        if len(profile) < 3 or shapely.hausdorff_distance(shapely.LinearRing(profile), outline.exterior) > slack:
            break
        front = profile @ axes + high * normal
        try:
            return divided_loft(front, front - (high - low) * normal, normal)
        except ValueError as error:
            fault = error
    raise fault


def _outline(flat: np.ndarray, faces: list[np.ndarray]) -> shapely.Polygon:
    """The polygon that faces in a plane fill together; empty where they have holes, are apart, or cross. flat: corners (n, 2), m.

    The edges of the polygon are the edges that belong to a single face. A union of areas is not used: round-off leaves holes between the
    areas, and the triangles of a face with dents may lie outside the face, or have no area.
    """
    if not faces:  # a face may leave the plane although some of its triangles lie in it
        return shapely.Polygon()
    ends = np.stack([np.concatenate(faces), np.concatenate([np.roll(face, -1) for face in faces])], axis=1)
    rim = ends[~np.isin(ends @ [len(flat), 1], ends @ [1, len(flat)])]
    tail, head = rim[np.argsort(rim[:, 0])].T
    if len(rim) < 3 or np.any(tail[1:] == tail[:-1]):  # several edges begin at a corner where the outline touches itself
        return shapely.Polygon()
    after, ring = np.searchsorted(tail, head), [0]
    while after[ring[-1]] != 0:
        ring.append(int(after[ring[-1]]))
    outline = shapely.Polygon(flat[tail[ring]])
    return outline if len(ring) == len(rim) and outline.is_valid else shapely.Polygon()


def _advice(dent: float) -> str:
    if dent <= MOST_DENT:
        return "; [geometry] tolerance fills dents that are no deeper than it"
    return "; only a prism may have dents; divide the body into convex ones"
