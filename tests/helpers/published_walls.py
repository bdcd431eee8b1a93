"""The six walls of Ferris and Tin-Loi (2001), pushed sideways by a load in proportion to weight: geometry and multipliers.

The geometry is that of the authors' GAMS models (MPECLib, frictionalblock); the examples of HybriDFEM (github.com/thlgrs/HybriDFEM) have
the same geometry. The associated multipliers are those of an independent linear programme. Multipliers without dilatancy are published for
walls 1 and 2. The least multipliers are the lowest stationary values that an independent programme with complementarity constraints found.
It searches all states of rigid blocks, whatever friction's history: such a state exists, but elastic joints need not reach it.
"""

from typing import Any

import numpy as np

LENGTH, HEIGHT, DEPTH = 0.4, 0.175, 0.3  # m, of a whole block; the depth is arbitrary
ASSOCIATED = {1: 0.64286, 2: 0.58000, 3: 0.40369, 4: 0.33195, 5: 0.23964, 6: 0.347825}
COULOMB = {1: 0.63982, 2: 0.56260}
LEAST_FOUND = {1: 0.63898, 2: 0.55741, 3: 0.35582, 4: 0.26374, 5: 0.20863}
BLOCKS = {1: 33, 2: 55, 3: 46, 4: 55, 5: 61, 6: 146}

# Blocks of a course from left to right, in lengths of a block; a negative length is a gap. E: even, U: uneven course; W: with windows.
Course = tuple[float, ...]
WIDE: dict[str, Course] = {"E": (0.5, 1, 1, 1, 1, 0.5), "U": (1,) * 5}
KINDS: dict[int, dict[str, Course]] = {
    1: WIDE,
    2: WIDE,
    3: {"E": (1,) * 4, "U": (0.5, 1, 1, 1, 0.5), "WE": (1, 0.5, -1, 0.5, 1), "WU": (0.5, 1, -1, 1, 0.5)},
    4: WIDE | {"WE": (0.5, 0.5, -1, 0.5, 0.5, -1, 0.5, 0.5), "WU": (1, -1, 1, -1, 1)},
    5: {"E": (0.5, 1, 1, 0.5), "U": (1,) * 3, "WE": (0.5, 0.5, -1, 0.5, 0.5), "WU": (1, -1, 1)},
    6: {
        "E": (0.5, 1, 1, 1, 1, 1, 1, 0.5),
        "U": (1,) * 7,
        "WE": (1, 0.5, -1, 0.5, 1, 0.5, -1, 0.5, 1),
        "WU": (0.5, 1, -1, 1, 1, -1, 1, 0.5),
    },
}
WINDOWS = "WU WE WU WE WU"
STACKS = {
    1: "E U E U E U",
    2: "E U E U E U E U E U",
    3: f"E U E {WINDOWS} E U E",
    4: f"E U E {WINDOWS} E U E",
    5: f"E U E {WINDOWS} E U E {WINDOWS} E U E",
    6: f"E U E U {WINDOWS} U E U {WINDOWS} U E U E",
}


def courses(number: int) -> list[Course]:
    """Return the courses of a wall, bottom first."""
    return [KINDS[number][kind] for kind in STACKS[number].split()]


def tables(number: int, inset: float = 0.0, **effects: Any) -> dict[str, Any]:
    """Return the tables of the scene of a wall. inset: m, 0 as published. effects: keys of [effects]."""
    blocks: list[dict[str, Any]] = []
    breadth = LENGTH * sum(map(abs, courses(number)[0]))
    for row, course in enumerate(courses(number)):
        ends = LENGTH * np.cumsum(np.abs(course))
        for place, (end, length) in enumerate(zip(ends, course, strict=True)):
            if length > 0.0:
                low, high = (end - LENGTH * length, 0.0, row * HEIGHT), (end, DEPTH, (row + 1) * HEIGHT)
                blocks.append({"name": f"course {row + 1}, {place + 1}", "box": {"from": rounded(low), "to": rounded(high)}})
    blocks.append({"name": "base", "role": "fixed", "box": {"from": [0.0, 0.0, -0.2], "to": rounded((breadth, DEPTH, 0.0))}})
    push = {"live": {"direction": [1.0, 0.0, 0.0]}} | ({"effects": effects} if effects else {})
    return {"stone": {"density": 2000.0}, "joint": {"friction": 0.65, "inset": inset}, "block": blocks} | push


def rounded(point: tuple[float, ...]) -> list[float]:
    """Return coordinates without the round-off of their sums, so that blocks touch."""
    return [round(float(value), 9) for value in point]
