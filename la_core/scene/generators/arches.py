"""Arches and barrel vaults: rings of straight-sided voussoirs in the xz plane, extruded along y, and turned in plan.

The joints of a ring stand at equal lengths along its inner face: a circle, a pointed arch, an ellipse or a basket arch.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import scipy

from la_core.geometry import Shape, prism
from la_core.scene.generators.placing import Corner, turned
from la_core.scene.generators.wall import NamedShape
from la_core.scene.schema.curved import Arch, Ring, Vault


@dataclass(frozen=True)
class Station:
    """A joint across a ring: a line that leaves the inner face at right angles.

    Attributes
    ----------
    foot : Corner
        Point on the line within the arch, such as the centre of its circle, m.
    angle : float
        Direction of the line from the vertical, positive to the right, rad.
    inner : float
        Distance of the inner face from the foot, m.
    circle : tuple of float or None
        At the apex of a pointed arch, where two circles meet on a vertical joint: distance of their centres from the middle and their
        radius, m. None elsewhere.
    """

    foot: Corner
    angle: float
    inner: float
    circle: tuple[float, float] | None = None

    def at(self, depth: float) -> Corner:
        """The point of the joint at a depth (m) within the ring, from its inner face."""
        along = self.inner + depth
        if self.circle is not None:
            apart, radius = self.circle
            along = math.sqrt((radius + depth) ** 2 - apart**2)
        return self.foot[0] + along * math.sin(self.angle), self.foot[1] + along * math.cos(self.angle)


def arch_blocks(arch: Arch) -> Iterator[NamedShape]:
    """Voussoirs from the left springing to the right one, ring by ring from the inner one; then the springers, if the table has them."""
    joints, y = stations(arch), (0.0, arch.depth)
    for ring in range(arch.rings):
        layer = arch.thickness * ring / arch.rings, arch.thickness * (ring + 1) / arch.rings
        for number, (left, right) in enumerate(pairwise(joints), 1):
            name = f"{arch.name} {number}" if arch.rings == 1 else f"{arch.name} {ring + 1}.{number}"
            yield NamedShape(name, "free", arch.density, _voussoir(arch, left, right, layer, y))
    yield from _springers(arch, arch.name, joints, arch.depth)


def vault_blocks(vault: Vault) -> Iterator[NamedShape]:
    """Voussoirs course by course from the left springing, along y within a course; then the springers, if requested.

    In running bond the second, fourth, ... course begins and ends with half voussoirs.
    """
    joints = stations(vault)
    for course, (left, right) in enumerate(pairwise(joints), 1):
        halves = vault.bond == "running" and course % 2 == 0
        inner = [ring + 0.5 for ring in range(vault.rings)] if halves else range(1, vault.rings)
        ends = [vault.length * place / vault.rings for place in (0, *inner, vault.rings)]
        for number, y in enumerate(pairwise(ends), 1):
            shape = _voussoir(vault, left, right, (0.0, vault.thickness), y)
            yield NamedShape(f"{vault.name} {course}.{number}", "free", vault.density, shape)
    yield from _springers(vault, vault.name, joints, vault.length)


def _voussoir(ring: Ring, left: Station, right: Station, layer: Sequence[float], y: Sequence[float]) -> Shape:
    """Solid between two joints and two depths within the ring (m), from y[0] to y[1] beyond the ring's centre (m).

    A notched keystone follows the apex of a pointed arch: it has a notch below and a ridge above.
    """
    below, above = ([joint.at(depth) for joint in (left, right)] for depth in layer)
    if ring.keystone == "notched" and left.angle < 0.0 < right.angle:
        apex = _apex(ring)
        below.insert(1, apex.at(layer[0]))
        above.insert(1, apex.at(layer[1]))
    return _placed(ring, [*below, *reversed(above)], y)


def _placed(ring: Ring, profile: Sequence[tuple[float, float]], y: Sequence[float]) -> Shape:
    """Solid of a profile about the ring's centre, m."""
    x0, y0, z0 = ring.centre
    return turned(prism([(x0 + x, z0 + z) for x, z in profile], (y0 + y[0], y0 + y[1])), ring.centre, ring.angle)


def _springers(ring: Ring, name: str, joints: list[Station], depth: float) -> Iterator[NamedShape]:
    """One held block behind each springing joint: as long as `depth` (m) along y and as thick as the ring."""
    if ring.springers is None:
        return
    for side, joint in (("left", joints[0]), ("right", joints[-1])):
        away = math.copysign(ring.thickness, joint.angle)
        face = [joint.at(0.0), joint.at(ring.thickness)]
        beyond = [(x + away * math.cos(joint.angle), z - away * math.sin(joint.angle)) for x, z in face]
        shape = _placed(ring, [face[0], face[1], beyond[1], beyond[0]], (0.0, depth))
        yield NamedShape(f"{name} springer {side}", getattr(ring.springers, side), ring.density, shape)


@dataclass(frozen=True)
class _Arc:
    """A circular arc in the right half of a ring. Its angles `start` and `end` count from the vertical to the right, rad."""

    centre: Corner
    radius: float
    start: float
    end: float

    @property
    def length(self) -> float:
        return self.radius * (self.end - self.start)


def stations(ring: Ring) -> list[Station]:
    """Joints of a ring from the left springing to the right one, about its centre in the xz plane, m; symmetric about the middle."""
    right, half = _right_half(ring)
    lengths = [half * (2.0 * k / ring.voussoirs - 1.0) for k in range(ring.voussoirs + 1)]
    joints = [right(abs(length)) if 2 * k != ring.voussoirs else _middle(ring, right) for k, length in enumerate(lengths)]
    return [_mirrored(joint) if length < 0.0 else joint for joint, length in zip(joints, lengths, strict=True)]


def _mirrored(joint: Station) -> Station:
    return Station((-joint.foot[0], joint.foot[1]), -joint.angle, joint.inner, joint.circle)


def _middle(ring: Ring, right: Callable[[float], Station]) -> Station:
    """The joint at the crown; at the apex of a pointed arch it is vertical."""
    return _apex(ring) if ring.shape == "pointed" else right(0.0)


def _apex(ring: Ring) -> Station:
    """The vertical line through the apex of a pointed arch."""
    assert ring.span is not None and ring.rise is not None  # the schema demands both
    radius = (ring.span**2 / 4.0 + ring.rise**2) / ring.span
    return Station((0.0, 0.0), 0.0, ring.rise, (radius - ring.span / 2.0, radius))


def _right_half(ring: Ring) -> tuple[Callable[[float], Station], float]:
    """The joint at a length from the crown along the right half of the inner face, and the length of that half, m."""
    if ring.radius is not None:
        return _along([_Arc((0.0, 0.0), ring.radius - ring.thickness / 2.0, 0.0, math.radians(ring.embrace) / 2.0)])
    assert ring.span is not None and ring.rise is not None  # the schema demands both
    a, b = ring.span / 2.0, ring.rise
    if ring.shape == "elliptical":
        return _along_ellipse(a, b)
    if ring.shape == "pointed":
        radius = (a**2 + b**2) / ring.span
        return _along([_Arc((a - radius, 0.0), radius, math.asin((radius - a) / radius), math.pi / 2.0)])
    if ring.shape == "circular":
        radius = (a**2 + b**2) / (2.0 * b)
        return _along([_Arc((0.0, b - radius), radius, 0.0, math.atan2(a, radius - b))])
    small = (b - (2.0 - math.sqrt(3.0)) * a) / (math.sqrt(3.0) - 1.0)  # three arcs of 60 degrees with common tangents
    great = 2.0 * a - small
    turn = math.pi / 6.0
    return _along([_Arc((0.0, b - great), great, 0.0, turn), _Arc((a - small, 0.0), small, turn, math.pi / 2.0)])


def _along(arcs: list[_Arc]) -> tuple[Callable[[float], Station], float]:
    """Joints along arcs that follow each other from the crown."""

    def at(length: float) -> Station:
        for arc in arcs:
            if length <= arc.length or arc is arcs[-1]:
                break
            length -= arc.length
        return Station(arc.centre, min(arc.start + length / arc.radius, arc.end), arc.radius)

    return at, sum(arc.length for arc in arcs)


def _along_ellipse(a: float, b: float) -> tuple[Callable[[float], Station], float]:
    """Joints along a quarter of an ellipse with the half span `a` and the rise `b`, m."""
    flatness = 1.0 - (b / a) ** 2  # below 0 for an ellipse higher than wide
    half = a * float(scipy.special.ellipeinc(math.pi / 2.0, flatness))

    def turn_at(place: float) -> float:
        return float(scipy.optimize.brentq(lambda t: a * scipy.special.ellipeinc(t, flatness) - place, 0.0, math.pi / 2.0, xtol=1e-14))

    def at(length: float) -> Station:
        turn = math.pi / 2.0 if length >= half else turn_at(length)
        return Station((a * math.sin(turn), b * math.cos(turn)), math.atan2(b * math.sin(turn), a * math.cos(turn)), 0.0)

    return at, half
