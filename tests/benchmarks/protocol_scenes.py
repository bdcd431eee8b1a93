"""Irregular walls for measurements of the protocol of a YADE run. They are not among the shipped scenes.

Courses of unequal height, blocks of unequal length, inclined beds, leaning walls, an opening below a lintel, and supports that
sink, move obliquely or turn. A seed draws everything.
"""

from dataclasses import dataclass

import numpy as np

LENGTH, DEPTH = 2.4, 0.4  # m
COURSES, PER_COURSE = 6, 6
LEAST_OVERLAP = 0.08  # m, of blocks in successive courses
KINDS = ("upright", "leaning", "inclined", "lintel", "oblique", "turning")
FRICTIONS = (0.25, 0.4, 0.6, 0.7, 0.9, 1.2)


@dataclass(frozen=True)
class Wall:
    """One drawn wall: its name, its friction and its scene file."""

    name: str
    friction: float
    text: str


def walls(seeds: range) -> list[Wall]:
    """Draw one wall of every kind for each seed. The frictions rotate, so that every kind has low and high friction."""
    return [wall(kind, FRICTIONS[(place + 2 * seed) % len(FRICTIONS)], seed) for seed in seeds for place, kind in enumerate(KINDS)]


def wall(kind: str, friction: float, seed: int) -> Wall:
    """Draw one wall of the given kind."""
    chance = np.random.default_rng([seed, KINDS.index(kind)])
    split = LENGTH * chance.uniform(0.45, 0.75)
    lean = chance.uniform(0.12, 0.2) if kind == "leaning" else 0.0
    name = f"{kind}_{seed}"
    parts = [
        f'title = "{name}"\n[stone]\ndensity = 2000.0\n[joint]\nfriction = {friction}',
        _prism("ground", "fixed", [(-0.5, -0.3), (split, -0.3), (split, 0.0), (-0.5, 0.0)]),
        _prism("settling", "support", [(split, -0.3), (LENGTH + 0.5, -0.3), (LENGTH + 0.5, 0.0), (split, 0.0)]),
    ]
    number = 0
    for low, high, joints in _courses(kind, chance):
        for left, right in joints:
            profile = [(left, low), (right, low), (right, high), (left, high)]
            number += 1
            parts.append(_prism(f"block {number}", "free", [(x + lean * _at(z, x), _at(z, x)) for x, z in profile]))
    parts.append(_settlement(kind, split, chance))
    return Wall(name, friction, "\n".join(parts) + "\n")


Bed = tuple[float, float]  # height at x = 0, and slope


def _at(bed: Bed, x: float) -> float:
    return bed[0] + bed[1] * x


def _courses(kind: str, chance: np.random.Generator) -> list[tuple[Bed, Bed, list[tuple[float, float]]]]:
    """Return lower bed, upper bed and blocks (left, right) of every course."""
    heights = np.concatenate([[0.0], np.cumsum(chance.uniform(0.2, 0.4, COURSES))])
    steepest = 0.06 if kind == "inclined" else 0.0
    slopes = np.concatenate([[0.0], chance.uniform(-steepest, steepest, COURSES)])
    opening = (0.9, 1.5) if kind == "lintel" else None
    courses, below = [], np.zeros(0)
    for course in range(COURSES):
        joints = _joints(below, chance)
        blocks = list(zip(np.concatenate([[0.0], joints]), np.concatenate([joints, [LENGTH]]), strict=True))
        if opening is not None and course in (1, 2, 3):
            blocks = _around(opening, lintel=course == 3)
        below = np.array([right for _, right in blocks[:-1]])
        low, high = ((float(heights[bed]), float(slopes[bed])) for bed in (course, course + 1))
        courses.append((low, high, [(float(left), float(right)) for left, right in blocks]))
    return courses


def _joints(below: np.ndarray, chance: np.random.Generator) -> np.ndarray:
    """Draw the head joints of a course, each at least LEAST_OVERLAP from those of the course below."""
    while True:
        count = PER_COURSE - 1 + int(chance.integers(0, 2))
        joints = LENGTH * (np.arange(1, count) + chance.uniform(-0.3, 0.3, count - 1)) / count
        if not len(below) or np.abs(joints[:, None] - below).min() >= LEAST_OVERLAP:
            return joints


def _around(opening: tuple[float, float], lintel: bool) -> list[tuple[float, float]]:
    """Return the blocks of a course beside the opening, or of the course with its lintel."""
    left, right = opening
    if lintel:
        return [(0.0, 0.55), (0.55, left - 0.15), (left - 0.15, right + 0.2), (right + 0.2, 2.1), (2.1, LENGTH)]
    return [(0.0, 0.4), (0.4, left), (right, 1.9), (1.9, LENGTH)]


def _settlement(kind: str, split: float, chance: np.random.Generator) -> str:
    if kind == "turning":
        return f"[settlement]\naxis = [0.0, 1.0, 0.0]\npoint = [{split - chance.uniform(0.3, 1.5):.4f}, 0.0, -0.3]"
    across = chance.uniform(0.2, 0.6) if kind == "oblique" else 0.0
    return f"[settlement]\ndirection = [{across:.4f}, 0.0, -1.0]"


def _prism(name: str, role: str, profile: list[tuple[float, float]]) -> str:
    corners = ", ".join(f"[{x:.6f}, {z:.6f}]" for x, z in profile)
    return f'[[block]]\nname = "{name}"\nrole = "{role}"\nprism = {{ profile = [{corners}], y = [0.0, {DEPTH}] }}'
