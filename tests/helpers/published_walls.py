"""The six walls of Ferris and Tin-Loi (2001), pushed sideways, as tables of a scene: blocks of 0.4 x 0.175 m, friction 0.65.

Walls 1 and 2 are shipped scenes, too. The layouts of walls 3 to 6 are those that the examples of HybriDFEM use (folder "F&TL Walls (WCEE
2024)" of github.com/thlgrs/HybriDFEM).
"""

from itertools import pairwise
from typing import Any

LENGTH, HEIGHT, DEPTH = 0.4, 0.175, 0.3  # m; any depth
# Courses as lengths over that of a block; a negative one is a gap.
HALF, FULL = [0.5, 1, 1, 1, 1, 0.5], [1, 1, 1, 1, 1]
WINDOW_OF = {
    3: ([0.5, 1, -1, 1, 0.5], [1, 0.5, -1, 0.5, 1]),
    4: ([1, -1, 1, -1, 1], [0.5, 0.5, -1, 0.5, 0.5, -1, 0.5, 0.5]),
    5: ([1, -1, 1], [0.5, 0.5, -1, 0.5, 0.5]),
    6: ([0.5, 1, -1, 1, 1, -1, 1, 0.5], [1, 0.5, -1, 0.5, 1, 0.5, -1, 0.5, 1]),
}


def courses(number: int) -> list[list[float]]:
    """The courses of a wall, from below."""
    if number in (1, 2):
        return [HALF, FULL] * (3 if number == 1 else 5)
    window = [WINDOW_OF[number][k % 2] for k in range(5)]
    if number == 3:
        even, odd = [1, 1, 1, 1], [0.5, 1, 1, 1, 0.5]
        return [even, odd, even, *window, even, odd, even]
    if number == 4:
        return [HALF, FULL, HALF, *window, HALF, FULL, HALF]
    if number == 5:
        even, odd = [0.5, 1, 1, 0.5], [1, 1, 1]
        return [even, odd, even, *window, even, odd, even, *window, even, odd, even]
    even, odd = [0.5, 1, 1, 1, 1, 1, 1, 0.5], [1] * 7
    return [even, odd, even, odd, *window, odd, even, odd, *window, odd, even, odd, even]


def tables(number: int, inset: float = 0.0) -> dict[str, Any]:
    """The tables of the scene of a wall. inset: m; 0 as published."""
    blocks: list[dict[str, Any]] = []
    breadth = LENGTH * sum(map(abs, courses(number)[0]))
    for row, course in enumerate(courses(number)):
        ends = [LENGTH * sum(map(abs, course[:k])) for k in range(len(course) + 1)]
        assert abs(ends[-1] - breadth) < 1e-9
        for k, (start, end) in enumerate(pairwise(ends)):
            if course[k] > 0.0:
                low, high = [start, 0.0, row * HEIGHT], [end, DEPTH, (row + 1) * HEIGHT]
                blocks.append({"name": f"course {row + 1}, {k + 1}", "box": {"from": rounded(low), "to": rounded(high)}})
    blocks.append({"name": "base", "role": "fixed", "box": {"from": [0.0, 0.0, -0.2], "to": rounded([breadth, DEPTH, 0.0])}})
    push = {"live": {"direction": [1.0, 0.0, 0.0]}}
    return {"stone": {"density": 2000.0}, "joint": {"friction": 0.65, "inset": inset}, "block": blocks} | push


def rounded(point: list[float]) -> list[float]:
    """Coordinates without the round-off of their sums, so that blocks touch."""
    return [round(value, 9) for value in point]
