"""Stones of a `[[rubble]]` table: cells of a Voronoi diagram in which no joint is shorter than a given length."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy

from la_core.errors import SceneError
from la_core.geometry import prism
from la_core.scene.generators.placing import turned
from la_core.scene.generators.wall import NamedShape, footing_blocks
from la_core.scene.schema.rubble import Rubble

EVEN = 3  # moves of all points to the centroids of their cells (Lloyd's algorithm); after them no stone is a splinter
MOST_MOVES = 200  # of the points beside short joints; two hundred stones need at most 60 for the longest joints that are allowed
MARGIN = 1.02  # of the least length: moves aim at this greater length, so that they end
ON_SIDE = 1e-9  # of the wall's size: corners this close to a side lie on it


@dataclass(frozen=True)
class _Diagram:
    """Voronoi cells of N points in a rectangle. Mirror images of the points in its sides make the sides edges of the diagram.

    Attributes
    ----------
    voronoi : Voronoi
        Diagram of the points, followed by their images in each side.
    points : (N, 2) array
        Points in stretched coordinates, m.
    size : (2,) array
        Sides of the stretched rectangle, m.
    """

    voronoi: "scipy.spatial.Voronoi"
    points: np.ndarray
    size: np.ndarray

    @classmethod
    def of(cls, points: np.ndarray, size: np.ndarray) -> "_Diagram":
        images = [points]
        for axis in (0, 1):
            for side in (0.0, size[axis]):
                image = points.copy()
                image[:, axis] = 2.0 * side - image[:, axis]
                images.append(image)
        return cls(scipy.spatial.Voronoi(np.concatenate(images)), points, size)

    def cells(self) -> list[np.ndarray]:
        """Corners (n, 2) of each point's cell, counter-clockwise, m; corners near a side of the rectangle are moved onto it."""
        corners = self.voronoi.vertices.copy()
        near = ON_SIDE * self.size.max()
        for axis in (0, 1):
            for side in (0.0, self.size[axis]):
                corners[np.abs(corners[:, axis] - side) <= near, axis] = side
        cells = []
        for number, point in enumerate(self.points):
            cell = corners[self.voronoi.regions[self.voronoi.point_region[number]]]
            arm = cell - point
            cells.append(cell[np.argsort(np.arctan2(arm[:, 1], arm[:, 0]))])
        return cells

    def joints(self, stretch: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Edges of the points' cells, with their lengths (J,) without the stretch, m.

        Returns the indices of the points (J, 2) on both sides, the indices of the corners (J, 2) at both ends, and the lengths.
        """
        sites, ends = self.voronoi.ridge_points, np.array(self.voronoi.ridge_vertices)
        own = (sites < len(self.points)).any(axis=1)
        sites, ends = sites[own], ends[own]
        length = np.linalg.norm((self.voronoi.vertices[ends[:, 0]] - self.voronoi.vertices[ends[:, 1]]) / stretch, axis=1)
        return sites, ends, length

    def moved(self, short: tuple[np.ndarray, np.ndarray, np.ndarray], least: float) -> np.ndarray:
        """The points (N, 2) after a move that lengthens short edges: the points on both sides of an edge approach each other.

        The points beyond the ends of the edge move apart. The move of an image moves the point of that image.
        """
        count = len(self.points)
        beyond = self._sites_by_corner()
        move = np.zeros_like(self.points)
        every = self.voronoi.points
        for (one, other), ends, length in zip(*(array.tolist() for array in short), strict=True):
            step = 0.25 * (MARGIN * least - length)
            apart = [next((site for site in beyond[end] if site not in (one, other)), None) for end in ends]
            pairs: list[tuple[int | None, int | None, float]] = [(one, other, 1.0), (apart[0], apart[1], -1.0)]
            for first, second, sign in pairs:
                if first is None or second is None:
                    continue
                way = every[second] - every[first]
                way = sign * step * way / np.linalg.norm(way)
                for site, part in ((first, way), (second, -way)):
                    image = site // count
                    mirror = np.array([-1.0 if image in (1, 2) else 1.0, -1.0 if image in (3, 4) else 1.0])
                    move[site % count] += mirror * part
        edge = ON_SIDE * self.size
        return np.clip(self.points + move, edge, self.size - edge)

    def _sites_by_corner(self) -> dict[int, list[int]]:
        sites: dict[int, list[int]] = {}
        for pair, ends in zip(self.voronoi.ridge_points.tolist(), self.voronoi.ridge_vertices, strict=True):
            for end in ends:
                sites.setdefault(end, []).extend(site for site in pair if site not in sites.get(end, ()))
        return sites


def rubble_blocks(rubble: Rubble) -> Iterator[NamedShape]:
    """Stones from the bottom up, then the footing; raises SceneError where joints of the least length cannot be reached."""
    x0, y0, z0 = rubble.origin
    for number, cell in enumerate(_stones(rubble), 1):
        shape = prism([(x0 + x, z0 + z) for x, z in cell], (y0, y0 + rubble.depth))
        yield NamedShape(f"{rubble.name} {number}", "free", rubble.density, turned(shape, rubble.origin, rubble.angle))
    if rubble.footing:
        yield from footing_blocks(rubble.name, rubble.footing, rubble.origin, (rubble.size[0], rubble.depth), rubble.angle)


def _stones(rubble: Rubble) -> list[list[tuple[float, float]]]:
    """Corners (x, z) of the stones from the wall's lower left corner, m, the lowest stones first."""
    stretch = np.array([1.0, rubble.flatness])  # an affine map keeps cells convex and the tiling exact
    size = np.array(rubble.size) * stretch
    diagram = _Diagram.of(np.random.default_rng(rubble.seed).uniform(0.02, 0.98, (rubble.stones, 2)) * size, size)
    for _ in range(EVEN):
        diagram = _Diagram.of(np.array([_centroid(cell) for cell in diagram.cells()]), size)
    least = rubble.shortest_joint
    for _ in range(MOST_MOVES):
        sites, ends, length = diagram.joints(stretch)
        short = length < least
        if not short.any():
            cells = [cell / stretch for cell in diagram.cells()]
            order = np.lexsort((diagram.points[:, 0], diagram.points[:, 1]))
            return [[(float(x), float(z)) for x, z in cells[k]] for k in order]
        diagram = _Diagram.of(diagram.moved((sites[short], ends[short], length[short]), least), size)
    where = f'rubble "{rubble.name}": shortest'
    rule = f"cannot be reached: these stones keep a joint of {diagram.joints(stretch)[2].min():.2g} m"
    hint = f"take another `seed`, or a smaller value such as {0.1 * rubble.stone_size:.2g} m"
    raise SceneError(where, rule, value=least, hint=hint)


def _centroid(cell: np.ndarray) -> np.ndarray:
    """Middle (2,) of a polygon's area."""
    following = np.roll(cell, -1, axis=0)
    cross = cell[:, 0] * following[:, 1] - following[:, 0] * cell[:, 1]
    return np.asarray(np.sum((cell + following) * cross[:, None], axis=0) / (3.0 * cross.sum()))
