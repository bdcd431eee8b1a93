"""Arches over openings of a coursed wall: voussoirs whose outer corners lie on course lines, so that no block of the wall has a notch."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from la_core.errors import SceneError
from la_core.scene.schema.masonry import ROUND, Opening

CROWN = 0.5  # of an arch's thickness: least height of the key above the intrados
WITHIN = 0.9  # of half the key's width: a radial joint that ends farther out would leave a sliver, so the key's top is divided equally
Span = tuple[float, float]  # from, to along the wall, m
Cut = tuple[Span, Span]  # stretches of a course that an arch takes up: at the foot and at the head of the course
Corner = tuple[float, float]  # along the wall and above its foot, m


@dataclass(frozen=True)
class ArchedHead:
    """An arch over an opening.

    Attributes
    ----------
    cuts : dict of int to Cut
        Stretches that the arch takes up in each course that it crosses.
    voussoirs : tuple of tuples of Corner
        Profiles of the voussoirs from left to right, m.
    """

    cuts: dict[int, Cut]
    voussoirs: tuple[tuple[Corner, ...], ...]


@dataclass(frozen=True)
class _Outline:
    """Right half of an arch about its vertical axis: `outer` corners on course lines, from the springing up; top of the key."""

    middle: float
    radius: float
    centre: float
    springing: Corner
    outer: tuple[Corner, ...]
    top: float

    def inside(self, angle: float) -> Corner:
        """The point of the intrados at an angle (rad) from the crown."""
        return self.radius * math.sin(angle), self.centre + self.radius * math.cos(angle)

    def angle(self, corner: Corner) -> float:
        """Angle (rad) of a point from the crown, about the centre."""
        return math.atan2(corner[0], corner[1] - self.centre)


def arched_head(where: str, lines: Sequence[float], springing: int, opening: Opening) -> ArchedHead:
    """The arch over an opening. The top of the opening is the course line `springing`.

    The intrados is a part of a circle. The joints are radial, and their outer ends lie on the course lines that the arch crosses. The top
    of the key lies on the line above, and its sides are upright in that course. The first joint of a semicircle is level. That of a flatter
    arch is a skewback through one course.

    Parameters
    ----------
    where : str
        Name of the wall in messages.
    lines : sequence of float
        Heights of the course lines, m.
    springing : int
        Number of the course line from which the arch springs.
    opening : Opening
        The opening, with a `rise`.

    Raises
    ------
    SceneError
        The arch is higher than the wall, bears too far into it, or has too few voussoirs.
    """
    assert opening.rise is not None  # the schema demands it
    half, foot = (opening.to[0] - opening.from_[0]) / 2.0, lines[springing]
    radius = (half**2 + opening.rise**2) / (2.0 * opening.rise)
    is_semicircle = opening.rise >= half * (1.0 - ROUND)
    centre = foot if is_semicircle else foot + opening.rise - radius
    first = springing if is_semicircle else springing + 1
    extrados = math.hypot(half + opening.bearing, lines[min(first, len(lines) - 1)] - centre)
    least = foot + opening.rise + CROWN * (extrados - radius)
    top = next((number for number in range(first, len(lines)) if lines[number] >= least - ROUND * extrados), None)
    if top is None:
        rule = f"the wall ends at {lines[-1]:g} m, below the key of its arch, which needs {least:g} m; add courses"
        raise SceneError(f"{where}: opening", rule, value=(opening.from_, opening.to))
    outer = [(half + opening.bearing, lines[first])]
    outer += [(math.sqrt(extrados**2 - (lines[k] - centre) ** 2), lines[k]) for k in range(first + 1, top)]
    outline = _Outline((opening.to[0] + opening.from_[0]) / 2.0, radius, centre, (half, foot), tuple(outer), lines[top])
    halves = [x for x, _ in outer] + ([outer[-1][0]] if top > first else [])
    crossed = {first + k: pair for k, pair in enumerate(pairwise(halves))}
    if not is_semicircle:
        crossed[springing] = half, halves[0]
    return ArchedHead({course: _about(outline.middle, *pair) for course, pair in crossed.items()}, _voussoirs(where, opening, outline))


def _about(middle: float, low: float, high: float) -> Cut:
    """Cut with these half widths (m) at the foot and the head of a course."""
    return (middle - low, middle + low), (middle - high, middle + high)


def _voussoirs(where: str, opening: Opening, outline: _Outline) -> tuple[tuple[Corner, ...], ...]:
    """Profiles from left to right: one on either side in every course, and the rest between them, up to the top of the key."""
    sides = outline.outer[1:]
    keys = opening.voussoirs - 2 * len(sides)
    if keys < 1:
        rule = f"its arch crosses so many courses that it needs {2 * len(sides) + 1} `voussoirs` or more"
        raise SceneError(f"{where}: opening", rule, value=opening.voussoirs)
    angles = [outline.angle(outline.springing), *map(outline.angle, sides)]
    if any(after >= before for before, after in pairwise(angles)):
        raise SceneError(f"{where}: opening", "its arch bears too far into the wall for its rise", value=opening.bearing)
    joints = [
        (outline.springing, outline.outer[0]),
        *((outline.inside(angle), corner) for angle, corner in zip(angles[1:], sides, strict=True)),
    ]
    right = [(a[0], a[1], b[1], b[0]) for a, b in pairwise(joints)]
    key = _key(outline, angles[-1], joints[-1][0], keys)
    mirrored = [tuple((-x, z) for x, z in reversed(profile)) for profile in right]
    return tuple(tuple((outline.middle + x, z) for x, z in profile) for profile in [*mirrored, *key, *reversed(right)])


def _key(outline: _Outline, widest: float, inside: Corner, count: int) -> list[tuple[Corner, ...]]:
    """Profiles of the voussoirs below the top of the key, from left to right, between joints at the angles -`widest` and `widest`."""
    width, line = outline.outer[-1]
    shares = [2.0 * k / count - 1.0 for k in range(count + 1)]
    heads = [(outline.top - outline.centre) * math.tan(share * widest) for share in shares[1:-1]]
    if any(abs(head) > WITHIN * width for head in heads):
        heads = [share * width for share in shares[1:-1]]
    lower = [(-inside[0], inside[1]), *(outline.inside(share * widest) for share in shares[1:-1]), inside]
    upper = [(x, outline.top) for x in (-width, *heads, width)]
    profiles = [[lower[k], lower[k + 1], upper[k + 1], upper[k]] for k in range(count)]
    if outline.top > line:  # the sides of the key are upright in its uppermost course
        profiles[0].append((-width, line))
        profiles[-1].insert(2, (width, line))
    return [tuple(profile) for profile in profiles]
