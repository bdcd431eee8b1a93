"""Small structures under a live load with little blocks that come loose: wedges in gaps, stones in corners and on ledges."""

import numpy as np
import scenes
from scipy.spatial import Voronoi

from la_core.errors import SceneError
from la_core.model import assemble
from la_core.scene.scene import Scene

KINDS = ("wedge", "corner", "ledge", "filler", "arch", "rubble", "pinched", "tail", "opening")
INSET, DEPTH = 1e-3, 0.2  # m
GROUND = 4.0  # m, length of the ground to either side

Profile = tuple[tuple[float, float], ...]


def drawn(random: np.random.Generator) -> tuple[str, Scene]:
    """Draw kind and scene of a random structure: friction 0.2 to 0.8, a push to either side, level or with a slope of up to a quarter."""
    while True:
        kind = str(random.choice(KINDS))
        push = (float(random.choice((-1.0, 1.0))), 0.0, float(random.choice((0.0, 1.0)) * random.uniform(-0.25, 0.25)))
        parts = [_box("ground", (-GROUND, -0.2), (GROUND, 0.0), "fixed"), *_DRAW[kind](random)]
        friction = random.uniform(0.2, 0.8)
        try:
            scene = scenes.build(*parts, friction=friction, inset=INSET, live=push, model="auto")
            assemble(scene)
        except SceneError:  # a stone with an edge that is too short
            continue
        return kind, scene


def _wedge(random: np.random.Generator) -> list[str]:
    """Two piers whose inner faces open upwards, and a little wedge between them, above the ground."""
    height, foot = random.uniform(0.5, 1.2), random.uniform(0.03, 0.15)
    left, right = random.uniform(0.02, 0.3, 2)
    widths = random.uniform(0.3, 0.8, 2)
    low, high = sorted(random.uniform(0.3, 1.0, 2) * height)
    high = max(high, low + 0.1)

    def inner(z: float) -> tuple[float, float]:
        return -foot / 2.0 - left * z, foot / 2.0 + right * z

    top = inner(height)
    wedge = ((inner(low)[0], low), (inner(low)[1], low), (inner(high)[1], high), (inner(high)[0], high))
    if high > height:
        wedge = ((inner(low)[0], low), (inner(low)[1], low), (top[1], height), (top[0], height))
    return [
        _prism("left", ((-widths[0] - left * height, 0.0), (-foot / 2.0, 0.0), (top[0], height), (-widths[0] - left * height, height))),
        _prism("right", ((foot / 2.0, 0.0), (widths[1] + right * height, 0.0), (widths[1] + right * height, height), (top[1], height))),
        _prism("wedge", wedge),
    ]


def _corner(random: np.random.Generator) -> list[str]:
    """Two blocks, one upon the other. One corner of each block is a separate stone."""
    width, first, second = random.uniform(0.5, 1.2), random.uniform(0.3, 0.7), random.uniform(0.3, 0.7)
    parts = []
    for name, low, height in (("lower", 0.0, first), ("upper", first, second)):
        a, b = random.uniform(0.05, 0.3, 2)
        corner = str(random.choice(("top left", "top right", "bottom left", "bottom right")))
        x = 0.0 if corner.endswith("left") else width
        inward = 1.0 if corner.endswith("left") else -1.0
        z = low + height if corner.startswith("top") else low
        down = -1.0 if corner.startswith("top") else 1.0
        cut = ((x, z + down * b), (x + inward * a, z))
        square = ((0.0, low), (width, low), (width, low + height), (0.0, low + height))
        profile = [point for corner_of in square for point in (_ordered(cut, corner_of, square) if corner_of == (x, z) else [corner_of])]
        parts.append(_prism(name, tuple(profile)))
        parts.append(_prism(f"{name} stone", ((x, z), *cut)))
    return parts


def _ordered(cut: Profile, corner: tuple[float, float], square: Profile) -> list[tuple[float, float]]:
    """Return the ends of a cut in the order of the square's corners. The end on the edge that leads to the corner comes first."""
    before = square[square.index(corner) - 1]
    on_edge = [point for point in cut if point[0] == before[0] == corner[0] or point[1] == before[1] == corner[1]]
    return [on_edge[0], next(point for point in cut if point != on_edge[0])]


def _ledge(random: np.random.Generator) -> list[str]:
    """A stepped pier with a little block on its step, against the upper part, and sometimes a little block on its top."""
    width, height = random.uniform(0.6, 1.2), random.uniform(0.3, 0.6)
    step = random.uniform(0.1, 0.3)
    parts = [
        _box("lower", (0.0, 0.0), (width, height)),
        _box("upper", (step, height), (width - step * random.uniform(0.0, 1.0), 2 * height)),
    ]
    for k in range(int(random.integers(1, 3))):
        size, tall = random.uniform(0.04, 1.0) * step, random.uniform(0.05, 0.3)
        left = step - size if k == 0 else random.uniform(step, width / 2.0)
        level = height if k == 0 else 2 * height
        lean = random.uniform(-0.3, 0.3) * size
        profile = ((left, level), (left + size, level), (left + size, level + tall), (left + (lean if lean > 0.0 else 0.0), level + tall))
        parts.append(_prism(f"little {k}", profile))
    return parts


def _filler(random: np.random.Generator) -> list[str]:
    """Two piers with a lintel and little fillers: one between a pier and a held block, or three between the lintel and a beam."""
    width, height, gap = random.uniform(0.3, 0.6), random.uniform(0.5, 1.0), random.uniform(0.03, 0.12)
    span, rise = random.uniform(0.3, 0.8), random.uniform(0.1, 0.3)
    lean = random.uniform(0.0, 0.15)
    side = random.uniform(0.3, 0.9) * height
    face = width + gap
    foot = gap * random.uniform(0.1, 1.0)
    parts = [
        _box("left", (0.0, 0.0), (width, height)),
        _box("right", (width + span, 0.0), (2 * width + span, height)),
        _box("lintel", (0.0, height), (2 * width + span, height + rise)),
    ]
    kind = int(random.integers(0, 2))
    if kind == 0:  # a held block inside the opening, and a wedge between this block and the pier
        parts.append(_prism("rest", ((face - gap + foot, 0.0), (face + 0.1, 0.0), (face + 0.1, side), (face + lean * side, side)), "fixed"))
        parts.append(_prism("filler", ((width, 0.0), (width + foot, 0.0), (width + gap + lean * side, side), (width, side))))
    else:  # little blocks between the lintel and a beam on it
        heights = height + rise, height + rise + gap
        for k, x in enumerate((0.0, (2 * width + span) * random.uniform(0.3, 0.6), 2 * width + span - gap)):
            parts.append(_box(f"filler {k}", (x, heights[0]), (x + gap, heights[1])))
        parts.append(_box("beam", (-0.05, heights[1]), (2 * width + span + 0.05, heights[1] + rise)))
    return parts


def _arch(random: np.random.Generator) -> list[str]:
    """A flat arch of one to three voussoirs between two abutments on piers."""
    width, height, rise = random.uniform(0.3, 0.7), random.uniform(0.3, 0.8), random.uniform(0.15, 0.35)
    count, lean = int(random.integers(1, 4)), random.uniform(0.1, 0.5)
    shares = random.uniform(0.2, 1.0, count)
    lengths = random.uniform(0.3, 0.7) * np.cumsum(np.concatenate([[0.0], shares / shares.sum()]))
    middle = lengths[-1] / 2.0
    tops = [x + lean * rise * (x - middle) / middle for x in lengths]
    parts = []
    for k in range(count):
        profile = ((lengths[k], height), (lengths[k + 1], height), (tops[k + 1], height + rise), (tops[k], height + rise))
        parts.append(_prism(f"voussoir {k}", profile))
    left, right = lengths[0], lengths[-1]
    parts.append(
        _prism("left", ((left - width, 0.0), (left, 0.0), (left, height), (tops[0], height + rise), (left - width, height + rise)))
    )
    parts[-1] = _prism("left abutment", ((left - width, height), (left, height), (tops[0], height + rise), (left - width, height + rise)))
    outer = right + width
    parts.append(_prism("right abutment", ((right, height), (outer, height), (outer, height + rise), (tops[-1], height + rise))))
    parts += [_box("left pier", (left - width, 0.0), (left, height)), _box("right pier", (right, 0.0), (outer, height))]
    return parts


def _rubble(random: np.random.Generator) -> list[str]:
    """Convex stones of random shapes that fill a wall of 2 x 1 m: Voronoi cells of random points, mirrored at the wall's sides."""
    points = random.random((int(random.integers(4, 12)), 2)) * [2.0, 1.0]
    mirrored = [points * [1, -1], points * [-1, 1], points * [-1, 1] + [4, 0], points * [1, -1] + [0, 2]]
    cells = Voronoi(np.vstack([points, *mirrored]))
    polygons = [cells.vertices[cells.regions[cells.point_region[k]]] for k in range(len(points))]
    return [_prism(f"stone {k}", tuple(map(tuple, np.round(polygon, 6).tolist()))) for k, polygon in enumerate(polygons)]


def _pinched(random: np.random.Generator) -> list[str]:
    """A block that holds down little stones on slopes. Some slopes are too steep for friction alone."""
    width, first, second = random.uniform(0.5, 1.2), random.uniform(0.3, 0.7), random.uniform(0.3, 1.0)
    low, parts = [(0.0, 0.0), (width, 0.0)], []
    for x, inward in ((width, -1.0), (0.0, 1.0)):
        a = random.uniform(0.05, 0.3) * width
        b = min(random.uniform(0.3, 1.2) * a, 0.8 * first)
        if x > 0.0 or random.uniform() < 0.5:
            ends = ((x, first - b), (x + inward * a, first))
            low += ends if x > 0.0 else ends[::-1]
            parts.append(_prism(f"stone {len(parts)}", ((x, first), *ends)))
        else:
            low.append((x, first))
    return [_prism("lower", tuple(low)), *parts, _box("upper", (0.0, first), (width, first + second))]


def _tail(random: np.random.Generator) -> list[str]:
    """A pier with an overhanging bracket. A block on the bracket's tail holds the bracket."""
    width, height, thin = random.uniform(0.4, 0.8), random.uniform(0.3, 0.8), random.uniform(0.03, 0.12)
    tail, over = random.uniform(0.1, 0.6) * width, random.uniform(0.05, 1.2)
    out = width + tail * over * random.uniform(0.5, 1.5)
    level = height + thin
    return [
        _box("pier", (0.0, 0.0), (width, height)),
        _box("bracket", (width - tail, height), (out, level)),
        _box("packing", (0.0, height), (width - tail, level)),
        _box("top", (0.0, level), (width, level + random.uniform(0.2, 0.8))),
    ]


def _opening(random: np.random.Generator) -> list[str]:
    """A wall in running bond with an opening, and little blocks on it."""
    per_course, courses = int(random.integers(2, 5)), int(random.integers(2, 5))
    size = (random.uniform(0.2, 0.5), DEPTH, random.uniform(0.1, 0.3))
    length, top = per_course * size[0], courses * size[2]
    left, span = random.uniform(0.2, 0.5), random.uniform(0.15, 0.4)
    opening = {"from": (left * length, 0.0), "to": (min(left + span, 0.85) * length, (courses - 1) * size[2]), "bearing": 0.25 * size[0]}
    parts = [
        scenes.table(
            "[wall]", bond="running", origin=(0.0, 0.0, 0.0), block=size, per_course=per_course, courses=courses, opening=[opening]
        )
    ]
    for k, x in enumerate(np.sort(random.uniform(0.0, 0.9, int(random.integers(1, 3)))) * length):
        little = random.uniform(0.01, 0.04, 2)
        parts.append(_box(f"little {k}", (float(x), top), (float(x + little[0]), float(top + 2.0 * little[1]))))
    return parts


_DRAW = {
    "pinched": _pinched,
    "tail": _tail,
    "opening": _opening,
    "wedge": _wedge,
    "corner": _corner,
    "ledge": _ledge,
    "filler": _filler,
    "arch": _arch,
    "rubble": _rubble,
}


def _box(name: str, low: tuple[float, float], high: tuple[float, float], role: str = "free") -> str:
    return scenes.box(name, (low[0], 0.0, low[1]), (high[0], DEPTH, high[1]), role)


def _prism(name: str, profile: Profile, role: str = "free") -> str:
    return scenes.block(name, role, prism=(profile, (0.0, DEPTH)))
