"""Polyhedra with many narrow facets, or with corners that lie on a face within round-off, have the right volume and joints."""

import itertools
import math

import numpy as np
import pytest
import scenes
import scipy

from la_core.analysis import analyse
from la_core.geometry.shapes import Shape, compound, polyhedron
from la_core.limit import Drive


def around(sides: int, radius: float, height: float) -> list[tuple[float, float, float]]:
    """Corners of a regular polygon about the z axis, at a height."""
    turns = 2.0 * math.pi * np.arange(sides) / sides
    return [(radius * math.cos(turn), radius * math.sin(turn), height) for turn in turns]


def filleted_box() -> list[tuple[float, float, float]]:
    """Corners of a box whose edges along y are rounded in eight steps."""
    turns = np.linspace(0.0, math.pi / 2.0, 9)
    corner = [(0.48 + 0.02 * math.cos(turn), 0.28 + 0.02 * math.sin(turn)) for turn in turns]
    return [(i * x, y, k * z) for x, z in corner for i, k in itertools.product((-1, 1), (-1, 1)) for y in (0.0, 0.5)]


BODIES = {
    "cylinder of 144 sides": around(144, 0.09, 0.0) + around(144, 0.09, 2.0),
    "cylinder of 2,000 sides": around(2000, 1.0, 0.0) + around(2000, 1.0, 1.0),
    "cone of 400 sides": around(400, 1.0, 0.0) + around(400, 0.6, 1.0),
    "half of a ball": [corner for lift in np.linspace(0.0, 1.5, 40) for corner in around(60, math.cos(lift), math.sin(lift))],
    "rounded box": filleted_box(),
}


def volume_of(shape: Shape) -> float:
    """Volume between the faces of a shape."""
    loops = [shape.vertices[list(face)] for face in compound([shape]).faces]
    return sum(float(loop[0] @ np.cross(loop[1:-1] - loop[0], loop[2:] - loop[0]).sum(axis=0)) for loop in loops) / 6.0


@pytest.mark.slow_after_first
@pytest.mark.parametrize("name", BODIES)
def test_each_part_of_a_surface_belongs_to_one_face(name: str) -> None:
    """Narrow facets belonged to several faces: the cylinder of 144 sides was a tenth too heavy, and the cone had 1.6 times its volume."""
    hull = scipy.spatial.ConvexHull(np.array(BODIES[name]))
    assert volume_of(polyhedron(BODIES[name])) == pytest.approx(hull.volume, rel=1e-9)


def test_a_round_shaft_weighs_what_its_section_says() -> None:
    """A block on two pads carries a shaft of 144 sides on its right half. Moments about the left pad's inner edge give the reaction."""
    shaft = [(x + 0.5, y + 0.25, z + 0.2) for x, y, z in around(144, 0.09, 0.0) + around(144, 0.09, 2.0)]
    scene = scenes.build(
        scenes.box("left", (-0.1, 0.0, -0.2), (0.1, 0.5, 0.0), "fixed"),
        scenes.box("right", (0.5, 0.0, -0.2), (0.7, 0.5, 0.0), "support"),
        scenes.box("block", (-0.1, 0.0, 0.0), (0.7, 0.5, 0.2)),
        scenes.block("shaft", polyhedron=shaft),
    )
    own, above = 2000.0 * 9.81 * 0.8 * 0.5 * 0.2, 2000.0 * 9.81 * 2.0 * 144.0 / 2.0 * 0.09**2 * math.sin(2.0 * math.pi / 144.0)
    assert scene.weight == pytest.approx(own + above, rel=1e-9)
    least = analyse(scene).sharp.bounds[Drive.YIELDING].value
    assert least == pytest.approx((own * (0.3 - 0.1) + above * (0.5 - 0.1)) / (0.7 - 0.1), rel=1e-6)


CUBE = list(itertools.product((0.0, 1.0), repeat=3))
NICKS = [
    (0.00001, 0.99999, -1e-7), (0.0002, 0.9998, -1e-6), (0.001, 0.999, -1e-6), (0.99999, 0.99999, -1e-6), (0.5, 0.00001, -1e-6),
    (0.999, 0.001, -5e-6),
]  # fmt: skip


@pytest.mark.parametrize("nick", NICKS)
def test_a_corner_within_a_face_by_round_off_cuts_no_joint_away(nick: tuple[float, float, float]) -> None:
    """A cube on three slabs has an additional corner just below its underside, near a corner or an edge."""
    scene = scenes.build(
        scenes.box("long", (0.0, 0.0, -0.2), (0.45, 1.0, 0.0), "fixed"),
        scenes.box("short", (0.55, 0.55, -0.2), (1.0, 1.0, 0.0), "fixed"),
        scenes.box("pad", (0.55, 0.0, -0.2), (1.0, 0.5, 0.0), "support"),
        scenes.block("cube", polyhedron=[*CUBE, nick]),
    )
    analysis = analyse(scene)
    assert sorted(analysis.whole.interfaces.area) == pytest.approx([0.45 * 0.45, 0.45 * 0.5, 0.45], rel=1e-4)
    values = [analysis.sharp.bounds[drive].value / scene.weight for drive in (Drive.YIELDING, Drive.PUSHING)]
    assert values == pytest.approx([0.0, 1.0 / 1.1], abs=2e-5)  # the pad's corner at 0.55 m carries at most W 0.5 / 0.55


@pytest.mark.parametrize(("digits", "seed"), [(6, 26), (6, 36), (7, 37)])
def test_a_body_of_many_inexact_triangles_has_its_volume(digits: int, seed: int) -> None:
    """Corners of a fine mesh lie within the faces of a box, all with errors of the last digit."""
    rng = np.random.default_rng(seed)
    corners = np.array([p for p in itertools.product((0.0, 0.5, 1.0), repeat=3) if any(c in (0.0, 1.0) for c in p)]) * [1.0, 0.5, 0.5]
    turn = np.array([[math.cos(0.3), -math.sin(0.3), 0.0], [math.sin(0.3), math.cos(0.3), 0.0], [0.0, 0.0, 1.0]])
    inexact = np.round(corners @ turn.T + rng.normal(size=corners.shape) * 0.3 * 10.0**-digits, digits)
    assert volume_of(polyhedron(inexact)) == pytest.approx(0.25, rel=1e-4)
