"""Strategies for small random structures of 2 to 15 free blocks. Many of them cannot stand, on purpose."""

import itertools
from dataclasses import dataclass, replace

import numpy as np
import scenes
from hypothesis import reject
from hypothesis import strategies as st
from scipy.spatial import Voronoi

from la_core.errors import SceneError
from la_core.model.assembly import assemble
from la_core.scene.scene import Scene

SPECIAL_FRICTION = (0.0, 1e-6, 5.0)
GREATEST_FRICTION = 1.5
DENSITY, DENSITY_RATIO = 2000.0, 1e3
DEPTH = 0.5  # m, along y, of all structures drawn in the xz plane
NARROWEST = 0.1  # least distance of a division of the base from its ends, over its length
MOST_STONES, SEEDS = 15, 10**6
SHORTEST_EDGE = 4e-4  # m, of a stone: a polyhedron merges corners nearer than 1e-4 of its size, a prism does not
MOST_TILT = 0.5  # rad, of gravity


@dataclass(frozen=True)
class Structure:
    """Tables of a scene's blocks. plane: True if the structure can be modelled in the plane."""

    parts: tuple[str, ...]
    plane: bool


@st.composite
def structures(draw: st.DrawFn, settles: bool) -> Structure:
    """Draw a structure of any kind. If it `settles`, a part of its base is a support."""
    kind = draw(st.sampled_from([_wall, _pile, _posts, _arch, _rubble, _crossed_pile]))
    return draw(kind(settles))


@st.composite
def random_scenes(draw: st.DrawFn, settles: bool | None = None) -> Scene:
    """Draw a scene with a support that settles or turns (`settles` True) or with a live load (False); None draws one of both."""
    if settles is None:
        settles = draw(st.integers(0, 3)) > 0
    structure = draw(structures(settles))
    plane = structure.plane and draw(st.booleans())
    direction = draw(_directions(plane, likely=scenes.DOWN if settles else (1.0, 0.0, 0.0)))
    tilt = draw(st.just(0.0) | st.floats(-MOST_TILT, MOST_TILT))
    gravity = scenes.rotation((0.0, 1.0, 0.0) if plane else (0.6, 0.8, 0.0), tilt) @ np.array([0.0, 0.0, -9.81])
    driven: dict = {"settlement": direction} if settles else {"live": direction, "settlement": None}
    if settles and draw(st.integers(0, 4)) == 0:
        pivot = (draw(st.floats(-1.0, 3.0)), 0.0, draw(st.floats(-1.0, 1.0)))
        driven = {"settlement": {"axis": (0.0, 1.0, 0.0) if plane else direction, "point": pivot}}
    try:
        scene = scenes.build(*structure.parts, plane=plane, friction=draw(frictions()), gravity=gravity, **driven)
        assemble(scene)
    except SceneError:  # an opening that does not fit, a part of the base that bears nothing
        reject()
    return with_densities(scene, draw(st.integers(0, SEEDS))) if draw(st.booleans()) else scene


def frictions() -> st.SearchStrategy[float]:
    """Coefficients of friction: 0 to GREATEST_FRICTION, often 0.3 to 0.9, and SPECIAL_FRICTION."""
    return st.floats(0.0, GREATEST_FRICTION) | st.floats(0.3, 0.9) | st.sampled_from(SPECIAL_FRICTION)


def with_densities(scene: Scene, seed: int) -> Scene:
    """Return the scene with densities of its blocks drawn over a ratio of 1 : 1000."""
    drawn = DENSITY * DENSITY_RATIO ** np.random.default_rng(seed).uniform(-0.5, 0.5, len(scene.blocks))
    return rewritten(replace(scene, blocks=replace(scene.blocks, density=drawn)))


def rewritten(scene: Scene, *more: str) -> Scene:
    """Return the scene, written as text with `more` tables and read again."""
    text = scenes.moved(scene, plane=bool(scene.effects.plane)).text
    return scenes.load("\n".join([text, *more]))


def far_away(scene: Scene) -> Scene:
    """Return the scene with two more fixed blocks, one on the other, a hundred lengths away."""
    low, high = scene.blocks.low.min(axis=0), scene.blocks.high.max(axis=0)
    size = (high - low).max()
    start = high[0] + 100.0 * size
    heights = (low[2], low[2] + 0.1 * size, low[2] + 0.3 * size)
    pair = [
        scenes.box(f"far {k}", (start, low[1], heights[k]), (start + size, high[1], heights[k + 1]), "fixed", density=DENSITY)
        for k in (0, 1)
    ]
    return rewritten(scene, *pair)


@st.composite
def _directions(draw: st.DrawFn, plane: bool, likely: tuple[float, float, float]) -> tuple[float, ...]:
    if draw(st.booleans()):
        return likely
    angle, height = draw(st.floats(0.0, 2.0 * np.pi)), 0.0 if plane else draw(st.floats(-0.9, 0.9))
    level = np.sqrt(1.0 - height**2)
    return (float(level * np.cos(angle)), height, float(level * np.sin(angle)))


@st.composite
def _base(draw: st.DrawFn, length: float, depth: tuple[float, float], settles: bool) -> tuple[str, ...]:
    """A base from x = 0 to `length` with its top at z = 0. If it `settles`, one part is a support; the parts meet in planes across x."""
    if not settles:
        return (scenes.box("base", (0.0, depth[0], -0.2), (length, depth[1], 0.0), "fixed"),)
    left = draw(st.floats(NARROWEST, 1.0 - NARROWEST))
    right = draw(st.just(1.0) | st.floats(NARROWEST, 1.0 - NARROWEST))
    ends = sorted({0.0, left, right, 1.0})
    if min(np.diff(ends)) < NARROWEST / 2.0:
        ends = [0.0, left, 1.0]
    support = draw(st.integers(0, len(ends) - 2))
    return tuple(
        scenes.box(f"base {k}", (a * length, depth[0], -0.2), (b * length, depth[1], 0.0), "support" if k == support else "fixed")
        for k, (a, b) in enumerate(itertools.pairwise(ends))
    )


@st.composite
def _wall(draw: st.DrawFn, settles: bool) -> Structure:
    """A wall in running or stack bond, sometimes with an opening."""
    per_course, courses = draw(st.integers(2, 4)), draw(st.integers(1, 3))
    size = (draw(st.floats(0.2, 1.0)), DEPTH, draw(st.floats(0.1, 0.5)))
    bond = draw(st.sampled_from(["running", "stack"]))
    entries: dict = {"first": draw(st.sampled_from(["full", "half"]))} if bond == "running" else {}
    if courses > 1 and draw(st.booleans()):
        left, width = draw(st.floats(0.1, 0.6)), draw(st.floats(0.1, 0.4))
        span = (left * per_course * size[0], min(left + width, 0.9) * per_course * size[0])
        entries["opening"] = [{"from": (span[0], 0.0), "to": (span[1], (courses - 1) * size[2]), "bearing": 0.2 * size[0]}]
    wall = scenes.table("[wall]", bond=bond, origin=(0.0, 0.0, 0.0), block=size, per_course=per_course, courses=courses, **entries)
    return Structure((wall, *draw(_base(per_course * size[0], (0.0, DEPTH), settles))), plane=True)


@st.composite
def _column(draw: st.DrawFn, name: str, x: float, heights: list[float], most: float) -> tuple[str, ...]:
    """Boxes one upon the other about x. Their widths are 0.3 to 0.6 of `most`, their distances from x at most 0.2 of `most`."""
    parts, z = [], 0.0
    for k, height in enumerate(heights):
        middle, width = x + most * draw(st.floats(-0.2, 0.2)), most * draw(st.floats(0.3, 0.6))
        parts.append(scenes.box(f"{name} {k}", (middle - width / 2.0, 0.0, z), (middle + width / 2.0, DEPTH, z + height)))
        z += height
    return tuple(parts)


@st.composite
def _pile(draw: st.DrawFn, settles: bool) -> Structure:
    """One pile of boxes with random offsets."""
    heights = draw(st.lists(st.floats(0.05, 1.0), min_size=2, max_size=8))
    return Structure((*draw(_column("box", 0.5, heights, 1.0)), *draw(_base(1.0, (0.0, DEPTH), settles))), plane=True)


@st.composite
def _posts(draw: st.DrawFn, settles: bool) -> Structure:
    """Two or three piles under a lintel, one of them on the support."""
    heights = draw(st.lists(st.floats(0.1, 0.8), min_size=1, max_size=3))
    count = draw(st.integers(2, 3))
    support = draw(st.integers(0, count - 1)) if settles else -1
    parts = []
    for k in range(count):
        role = "support" if k == support else "fixed"
        parts += [*draw(_column(f"post {k}", 1.5 * k, heights, 1.0))]
        parts.append(scenes.box(f"base {k}", (1.5 * k - 0.5, 0.0, -0.2), (1.5 * k + 0.5, DEPTH, 0.0), role))
    top, reach = sum(heights), draw(st.floats(0.0, 0.4))
    thickness = draw(st.floats(0.1, 0.5))
    lintel = scenes.box("lintel", (-reach, 0.0, top), (1.5 * (count - 1) + reach, DEPTH, top + thickness))
    return Structure((*parts, lintel), plane=True)


@st.composite
def _arch(draw: st.DrawFn, settles: bool) -> Structure:
    """A semicircular arch, sometimes too thin to stand."""
    right = "support" if settles else "fixed"
    return Structure((scenes.arch(draw(st.integers(3, 13)), draw(st.floats(0.05, 0.5)), depth=DEPTH, right=right),), plane=True)


@st.composite
def _rubble(draw: st.DrawFn, settles: bool) -> Structure:
    """Convex stones that fill a wall of 2 x 1 m: Voronoi cells of random points, mirrored at the wall's sides."""
    stones = draw(st.integers(2, MOST_STONES))
    points = np.random.default_rng(draw(st.integers(0, SEEDS))).random((stones, 2)) * [2.0, 1.0]
    mirrored = [points * [1, -1], points * [-1, 1], points * [-1, 1] + [4, 0], points * [1, -1] + [0, 2]]
    cells = Voronoi(np.vstack([points, *mirrored]))
    polygons = [cells.vertices[cells.regions[cells.point_region[k]]] for k in range(stones)]
    if min(np.linalg.norm(polygon - np.roll(polygon, 1, axis=0), axis=1).min() for polygon in polygons) < SHORTEST_EDGE:
        reject()
    blocks = [scenes.block(f"stone {k}", prism=(np.round(polygon, 9), (0.0, DEPTH))) for k, polygon in enumerate(polygons)]
    return Structure((*blocks, *draw(_base(2.0, (0.0, DEPTH), settles))), plane=True)


@st.composite
def _crossed_pile(draw: st.DrawFn, settles: bool) -> Structure:
    """Beams piled up at random angles about the vertical: a structure in space."""
    parts, z = [], 0.0
    for k in range(draw(st.integers(2, 7))):
        half = np.array([draw(st.floats(0.2, 0.6)), draw(st.floats(0.1, 0.4)), draw(st.floats(0.05, 0.3))])
        middle = np.array([0.5 + draw(st.floats(-0.15, 0.15)), draw(st.floats(-0.15, 0.15)), z + half[2]])
        corners = np.array([[x, y, h] for x in (-1, 1) for y in (-1, 1) for h in (-1, 1)]) * half
        corners = corners @ scenes.rotation((0.0, 0.0, 1.0), draw(st.floats(0.0, np.pi))).T
        parts.append(scenes.block(f"beam {k}", polyhedron=corners + middle))
        z += 2.0 * half[2]
    return Structure((*parts, *draw(_base(1.0, (-0.5, 0.5), settles))), plane=False)
