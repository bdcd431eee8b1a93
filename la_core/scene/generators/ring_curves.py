"""Inner faces of rings as curves: stations at equal lengths along a circle, a pointed arch, an ellipse or a basket arch."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from scipy.optimize import brentq
from scipy.special import ellipeinc

from la_core.scene.schema.curved import Ring

Corner = tuple[float, float]  # x and z, m


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


@dataclass(frozen=True)
class _Arc:
    """A part of a circle right of the middle, from the angle `start` to `end` from the vertical, rad, outward positive."""

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
    if ring.shape != "pointed":
        return right(0.0)
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
    small = (b - (2.0 - math.sqrt(3.0)) * a) / (math.sqrt(3.0) - 1.0)  # three sixths of a circle that touch each other with one tangent
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
    half = a * float(ellipeinc(math.pi / 2.0, flatness))

    def at(length: float) -> Station:
        place = min(length, half)
        turn = math.pi / 2.0 if place >= half else brentq(lambda t: a * ellipeinc(t, flatness) - place, 0.0, math.pi / 2.0, xtol=1e-14)
        return Station((a * math.sin(turn), b * math.cos(turn)), math.atan2(b * math.sin(turn), a * math.cos(turn)), 0.0)

    return at, half
