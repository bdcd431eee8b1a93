"""Generators: a `[[wall]]` table becomes the same blocks a user could have typed; curved masonry does so in `vault` and `dome`."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from la_core.errors import SceneError
from la_core.schema import Opening, Wall
from la_core.shapes import Shape, box

SHORTEST_PIECE = 0.25  # of a block's length: what an opening leaves of a block joins its neighbour below this
ON_LINE = 1e-6  # of a block's length: openings this close to a course line lie on it


@dataclass(frozen=True)
class NamedShape:
    """A block before its mass is known: `density` None means the scene's stone."""

    name: str
    role: str
    density: float | None
    shape: Shape


def wall_blocks(wall: Wall) -> Iterator[NamedShape]:
    """Blocks of a wall, course by course from the bottom, left to right; openings are cut out and bridged by lintels."""
    _, depth, height = wall.block
    x0, y0, z0 = wall.origin
    for course in range(wall.courses):
        z = z0 + course * height
        for number, (start, end) in enumerate(_course(wall, course), 1):
            shape = box((x0 + start, y0, z), (x0 + end, y0 + depth, z + height))
            yield NamedShape(f"{wall.name} {course + 1}.{number}", "free", wall.density, shape)


def _course(wall: Wall, course: int) -> list[tuple[float, float]]:
    """Where the blocks of one course start and end along the wall (m)."""
    length = wall.block[0]
    total = wall.per_course * length
    starts_half = wall.bond == "running" and (course % 2 == 1) != (wall.first == "half")
    joints = [(k + (0.5 if starts_half else 0.0)) * length for k in range(wall.per_course + 1)]
    gaps, lintels = _cuts(wall, course)
    pieces = list(lintels)
    start = 0.0
    for low, high in [*sorted(gaps + lintels), (total, total)]:
        if low < start - ON_LINE * length:
            raise SceneError(f'wall "{wall.name}": course {course + 1}', "openings or their lintels overlap here", value=(low, start))
        if low > start + ON_LINE * length:
            least = SHORTEST_PIECE * length
            inner = [joint for joint in joints if start + least <= joint <= low - least]
            edges = [start, *inner, low]
            pieces += pairwise(edges)
        start = high
    return sorted(pieces)


def _cuts(wall: Wall, course: int) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
    """Openings and lintels that interrupt one course, as (start, end) along the wall."""
    total = wall.per_course * wall.block[0]
    gaps, lintels = [], []
    for opening in wall.opening:
        first, past = _opening_courses(wall, opening)
        if first <= course < past:
            gaps.append((opening.from_[0], opening.to[0]))
        elif course == past:
            lintels.append((max(0.0, opening.from_[0] - opening.bearing), min(total, opening.to[0] + opening.bearing)))
    return gaps, lintels


def _opening_courses(wall: Wall, opening: Opening) -> tuple[int, int]:
    """First course an opening cuts and the course of its lintel."""
    height, total = wall.block[2], wall.per_course * wall.block[0]
    where = f'wall "{wall.name}": opening'
    lines = [z / height for z in (opening.from_[1], opening.to[1])]
    if any(abs(line - round(line)) > ON_LINE for line in lines):
        raise SceneError(where, f"bottom and top must lie on course lines, multiples of {height} m", value=(opening.from_, opening.to))
    first, past = (round(line) for line in lines)
    if first < 0 or past >= wall.courses:
        raise SceneError(
            where, f"must leave a course for the lintel; the wall has {wall.courses} courses", value=(opening.from_, opening.to)
        )
    if opening.from_[0] < 0.0 or opening.to[0] > total:
        raise SceneError(where, f"must lie within the wall's length of {total} m", value=(opening.from_, opening.to))
    return first, past
