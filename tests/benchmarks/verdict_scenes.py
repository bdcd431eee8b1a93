"""Random irregular scenes for which no method was tuned: unequal blocks, leaning walls, inclined beds, lintels, leaves in space.

Each scene follows from the seed and its number alone. Supports go down, aside or turn. A scene that cannot stand, or whose drawing breaks
a rule of the scene file, is drawn again.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

import la_core
from la_core.errors import SceneError
from la_core.limit import Drive, Status, solve_associated
from la_core.model import assemble
from la_core.scene import Scene

SEED, SCENES = 20261126, 200
FRESH_SEED = 20261127  # of the second page of verdicts
EARLIER_SEED = 20261122  # its scenes have led to changes of both methods, like those of 20261123 to 20261125; tests keep some of them
KINDS = ("wall", "leaning wall", "inclined beds", "lintel", "two leaves")
MOTIONS = ("down", "oblique", "turning")
LEAST_BLOCKS, MOST_BLOCKS = 10, 40
FRICTION = (0.2, 1.2)
GRID = 0.05  # m; every vertical joint lies on this grid, so that no joint is shorter
DEPTH = 0.4  # m
INSET = 1e-3  # m
Corners = list[tuple[float, float]]


@dataclass(frozen=True)
class Stone:
    """A block between two heights and two depths; `low` and `high` are its ends in x."""

    low: float
    high: float
    bottom: float
    top: float
    near: float = 0.0
    far: float = DEPTH


@dataclass(frozen=True)
class Drawn:
    """A random scene with its number, kind and motion."""

    number: int
    kind: str
    motion: str
    scene: Scene


def drawn(number: int, seed: int = SEED, size: float = 1.0) -> Drawn:
    """Return the random scene of a number from 0 to SCENES - 1. size: factor on the usual length and number of courses."""
    kind, motion = KINDS[number % len(KINDS)], MOTIONS[number // len(KINDS) % len(MOTIONS)]
    attempt = 0
    while True:
        random = np.random.default_rng((seed, number, attempt))
        attempt += 1
        try:
            scene = la_core.build(tables(random, kind, motion, size), f"verdict_{number:03d}")
        except SceneError:
            continue
        if LEAST_BLOCKS <= int(scene.blocks.free.sum()) / size**2 <= MOST_BLOCKS and _stands(scene):
            return Drawn(number, kind, motion, scene)


def _stands(scene: Scene) -> bool:
    try:
        return solve_associated(assemble(scene), Drive.YIELDING).status is Status.SOLVED
    except SceneError:
        return False


def tables(random: np.random.Generator, kind: str, motion: str, size: float = 1.0) -> dict[str, Any]:
    """Return the tables of a random scene."""
    length = GRID * int(size * random.integers(36, 64))
    stones = list({"lintel": _lintel, "two leaves": _leaves}.get(kind, _wall)(random, length, size))
    lean = random.uniform(0.02, 0.1) * random.choice((-1.0, 1.0)) if kind == "leaning wall" else 0.0
    slope = random.uniform(0.03, 0.15) * random.choice((-1.0, 1.0)) if kind == "inclined beds" else 0.0
    share = GRID * round(length * random.uniform(0.2, 0.55) / GRID)
    right = bool(random.integers(2))
    edge = length - share if right else share
    base = {"fixed": (0.0, edge) if right else (edge, length), "support": (edge, length) if right else (0.0, edge)}
    blocks = [_block(f"{role} base", Stone(*ends, -0.2, 0.0), lean, slope, role) for role, ends in base.items()]
    blocks += [_block(f"s{count}", stone, lean, slope) for count, stone in enumerate(stones)]
    if kind == "two leaves":  # the support carries one leaf only, or both
        blocks[1:2] = _split_support(random, Stone(*base["support"], -0.2, 0.0))
    return {
        "title": f"Random scene: {kind}, support {motion}",
        "stone": {"density": round(float(random.uniform(1600.0, 2600.0)), 0)},
        "joint": {"friction": round(float(random.uniform(*FRICTION)), 3), "inset": INSET},
        "block": blocks,
        "settlement": _motion(random, motion, edge, right, kind == "two leaves"),
    }


def _motion(random: np.random.Generator, motion: str, edge: float, right: bool, space: bool) -> dict[str, Any]:
    """Return the motion of a support to the right or left of `edge`. A turning support goes down at its far end."""
    if motion == "turning":
        return {"axis": [0.0, 1.0 if right else -1.0, 0.0], "point": [edge, 0.0, 0.0]}
    aside = random.uniform(0.1, 0.6) * random.choice((-1.0, 1.0)) if motion == "oblique" else 0.0
    out = random.uniform(-0.4, 0.4) if motion == "oblique" and space else 0.0
    return {"direction": [round(float(aside), 3), round(float(out), 3), -1.0]}


def _cuts(random: np.random.Generator, low: float, high: float) -> list[float]:
    """Return the joints of a course between two ends. Its blocks are 0.25 m to 0.8 m long."""
    found = [low]
    while high - found[-1] > 0.8:
        found.append(round(found[-1] + GRID * int(random.integers(5, 12)), 6))
    return [*found, high]


def _wall(random: np.random.Generator, length: float, size: float) -> Iterator[Stone]:
    """Yield a wall of courses of different heights."""
    bottom = 0.0
    for _ in range(int(size * random.integers(4, 8))):
        top = round(bottom + float(random.uniform(0.18, 0.4)), 3)
        cuts = _cuts(random, 0.0, length)
        yield from (Stone(low, high, bottom, top) for low, high in pairwise(cuts))
        bottom = top


def _lintel(random: np.random.Generator, length: float, size: float) -> Iterator[Stone]:
    """Yield two piers, a lintel over their opening, and courses above it."""
    first = GRID * int(size * random.integers(10, 14))
    last = length - GRID * int(size * random.integers(10, 14))
    bottom, piers, above = 0.0, int(size * random.integers(3, 5)), int(size * random.integers(1, 4))
    for course in range(piers + 1 + above):
        top = round(bottom + float(random.uniform(0.2, 0.4)), 3)
        if course < piers:
            parts = [_cuts(random, 0.0, first), _cuts(random, last, length)]
        elif course == piers:
            bearing = GRID * int(random.integers(3, 7))
            parts = [[0.0, first - bearing, last + bearing, length]]
        else:
            parts = [_cuts(random, 0.0, length)]
        for cuts in parts:
            yield from (Stone(low, high, bottom, top) for low, high in pairwise(cuts))
        bottom = top


def _leaves(random: np.random.Generator, length: float, size: float) -> Iterator[Stone]:
    """Yield a wall of two leaves in space. The last course and some others consist of through-stones."""
    bottom, courses, middle = 0.0, int(size * random.integers(3, 6)), GRID * int(random.integers(3, 6))
    for course in range(courses):
        top = round(bottom + float(random.uniform(0.2, 0.4)), 3)
        through = course == courses - 1 or random.uniform() < 0.3
        for near, far in ((0.0, DEPTH),) if through else ((0.0, middle), (middle, DEPTH)):
            cuts = _cuts(random, 0.0, length)
            yield from (Stone(low, high, bottom, top, near, far) for low, high in pairwise(cuts))
        bottom = top


def _split_support(random: np.random.Generator, stone: Stone) -> list[dict[str, Any]]:
    """Return the whole support, or a support of half its depth and a fixed other half."""
    if random.uniform() < 0.5:
        return [_block("support base", stone, 0.0, 0.0, "support")]
    halves = [Stone(stone.low, stone.high, stone.bottom, stone.top, near, near + DEPTH / 2.0) for near in (0.0, DEPTH / 2.0)]
    return [_block("support base", halves[0], 0.0, 0.0, "support"), _block("fixed half", halves[1], 0.0, 0.0, "fixed")]


def _block(name: str, stone: Stone, lean: float, slope: float, role: str = "free") -> dict[str, Any]:
    """Return a block's table. lean: inclination of the wall, x over z; slope: inclination of its beds, z over x."""
    around = ((stone.low, stone.bottom), (stone.high, stone.bottom), (stone.high, stone.top), (stone.low, stone.top))
    profile: Corners = [(x + lean * z, z + slope * x) for x, z in around]
    assert all(math.isfinite(value) for corner in profile for value in corner)
    return {"name": name, "role": role, "prism": {"profile": profile, "y": [stone.near, stone.far]}}
