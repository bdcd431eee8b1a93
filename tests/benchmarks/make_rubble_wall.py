"""Makes la_core/scenes/rubble_wall.obj: `python tests/benchmarks/make_rubble_wall.py` writes the same file again.

Stones are the cells of the Voronoi diagram of seeded points in the box of the wall. The diagram is taken with heights stretched
by BED, so that beds come out flatter than head joints; an affine map keeps cells convex and the tiling exact. Reflecting the
points in the six sides of the box makes its sides faces of the diagram. Below lie two blocks of foundation.
"""

from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull, Voronoi

OBJ = Path(__file__).parents[2] / "la_core" / "scenes" / "rubble_wall.obj"
SEED = 2
LENGTH, DEPTH, HEIGHT = 1.2, 0.4, 1.8  # m
PER_COURSE, COURSES = 3, 7
# Largest distance of a point from its place in a running bond, as shares of a stone's length, depth and height. Stones go through the wall,
# so that the structure is plane.
SCATTER = np.array([0.2, 0.0, 0.1])
BED = 2.0  # factor by which heights are stretched
EDGE = 0.02  # m; no point is nearer to a side of the wall
FOUNDATION, SETTLING = 0.2, 0.5  # m: depth; share of the length that settles


def points(seed: int = SEED) -> np.ndarray:
    """Return the points (N, 3) of the stones, m, course by course. Every other course begins and ends with a half stone."""
    chance = np.random.default_rng(seed)
    size = np.array([LENGTH / PER_COURSE, DEPTH, HEIGHT / COURSES])
    places = []
    for course in range(COURSES):
        along = np.arange(PER_COURSE) + 0.5 if course % 2 == 0 else np.clip(np.arange(PER_COURSE + 1.0), 0.2, PER_COURSE - 0.2)
        places += [(x, 0.5, course + 0.5) for x in along]
    scatter = SCATTER * chance.uniform(-1.0, 1.0, (len(places), 3))
    box = np.array([LENGTH, DEPTH, HEIGHT])
    return np.clip((np.array(places) + scatter) * size, EDGE, box - EDGE)


def stones(seed: int = SEED) -> list[np.ndarray]:
    """Return the vertices (n, 3) of every stone, m."""
    stretch, box = np.array([1.0, 1.0, BED]), np.array([LENGTH, DEPTH, HEIGHT])
    inside = points(seed) * stretch
    mirrored = [inside]
    for axis in range(3):
        for plane in (0.0, (box * stretch)[axis]):
            image = inside.copy()
            image[:, axis] = 2.0 * plane - image[:, axis]
            mirrored.append(image)
    diagram = Voronoi(np.concatenate(mirrored))
    return [diagram.vertices[diagram.regions[diagram.point_region[k]]] / stretch for k in range(len(inside))]


def foundation() -> dict[str, np.ndarray]:
    """Return the vertices of the two blocks that the wall stands on, m."""
    split = (1.0 - SETTLING) * LENGTH

    def corners(start: float, end: float) -> np.ndarray:
        return np.array([(x, y, z) for x in (start, end) for y in (0.0, DEPTH) for z in (-FOUNDATION, 0.0)])

    return {"ground": corners(0.0, split), "pad": corners(split, LENGTH)}


def obj(bodies: dict[str, np.ndarray]) -> str:
    """Return convex bodies as the text of an OBJ file. Each hull has triangles that run counter-clockwise seen from outside."""
    lines, first = [], 1
    for name, vertices in bodies.items():
        hull = ConvexHull(vertices)
        corners = vertices[hull.simplices]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        inward = np.sum(normal * hull.equations[:, :3], axis=1) < 0.0
        triangles = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)
        lines.append(f"o {name}")
        lines += [f"v {x:.9f} {y:.9f} {z:.9f}" for x, y, z in vertices + 0.0]
        lines += [f"f {a} {b} {c}" for a, b, c in triangles + first]
        first += len(vertices)
    return "\n".join(lines) + "\n"


def rubble_wall(seed: int = SEED) -> str:
    """Return the text of the whole file."""
    head = "# Made by tests/benchmarks/make_rubble_wall.py, m: stones are Voronoi cells in a wall, on a foundation in two blocks.\n"
    return head + obj({**foundation(), **{f"stone {k}": vertices for k, vertices in enumerate(stones(seed), 1)}})


if __name__ == "__main__":
    OBJ.write_text(rubble_wall(), encoding="utf-8")
