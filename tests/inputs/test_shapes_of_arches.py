"""Arches follow their curves, are symmetric and closed, and coincide where their shapes coincide."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import scenes
from measured_shapes import EXACT, ROUND_OFF, SPREADS, free_volume, reaction
from scipy.spatial import cKDTree

from la_core.errors import SceneError
from la_core.geometry.interfaces import find_interfaces
from la_core.limit.problem import Drive
from la_core.scene.generators.arches import stations
from la_core.scene.schema.curved import Arch


def arch(**changes: Any) -> str:
    entries = {
        "centre": (0.3, -0.2, 0.1), "span": 3.0, "rise": 1.5, "thickness": 0.4, "depth": 0.5, "voussoirs": 11,
        "springers": {"left": "fixed", "right": "support"},
    }  # fmt: skip
    return scenes.table("[arch]", **{key: value for key, value in (entries | changes).items() if value is not None})


SHAPES = {
    "semicircle": {},
    "segment": {"rise": 0.8},
    "pointed": {"shape": "pointed", "rise": 2.2},
    "pointed with a joint at the apex": {"shape": "pointed", "rise": 2.2, "voussoirs": 12},
    "elliptical": {"shape": "elliptical", "rise": 0.9},
    "high ellipse": {"shape": "elliptical", "rise": 2.4},
    "basket": {"shape": "basket", "rise": 1.0},
}


def ring(**changes: Any) -> Arch:
    entries = {"centre": (0.0, 0.0, 0.0), "span": 3.0, "rise": 1.5, "thickness": 0.4, "depth": 0.5, "voussoirs": 11}
    return Arch(**(entries | changes))


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("rings", [1, 2])
def test_an_arch_is_symmetric_closed_and_as_high_and_wide_as_asked(name: str, rings: int) -> None:
    changes = SHAPES[name]
    scene = scenes.build(arch(**changes, rings=rings, centre=(0.0, 0.0, 0.0)), settlement=SPREADS)
    vertices = scene.blocks.vertices
    assert np.allclose(*(np.unique(np.round(v, 9), axis=0) for v in (vertices, vertices * (-1, 1, 1))), atol=2e-9)
    count, joints = changes.get("voussoirs", 11), find_interfaces(scene.blocks)
    assert len(joints) == (count + 1) * rings + count * (rings - 1)
    across = np.abs(joints.normal[:, 0]) > 0  # nearly all joints; the areas of joints across the ring follow from its thickness
    ends = stations(ring(**changes))
    thickness = sum(math.dist(end.at(0.0), end.at(0.4)) for end in ends)
    between = sum(math.dist(a.at(0.4 * k / rings), b.at(0.4 * k / rings)) for a, b in pairwise(ends) for k in range(1, rings))
    assert across.any() and joints.area.sum() == pytest.approx(0.5 * (thickness + between), rel=ROUND_OFF)
    assert ends[0].at(0.0) == pytest.approx((-1.5, 0.0), abs=ROUND_OFF) and ends[-1].at(0.0) == pytest.approx((1.5, 0.0), abs=ROUND_OFF)
    crown = stations(ring(**(changes | {"voussoirs": 12})))[6]
    assert crown.at(0.0) == pytest.approx((0.0, changes.get("rise", 1.5)), abs=ROUND_OFF)


@pytest.mark.parametrize("rings", [1, 2])
def test_a_notched_keystone_follows_the_apex(rings: int) -> None:
    """Its profile is that of a plain keystone with a triangle added above and a triangle removed below."""
    changes = {"shape": "pointed", "rise": 2.2, "rings": rings}
    notched, plain = (scenes.build(arch(**changes, keystone=kind), settlement=SPREADS) for kind in ("notched", "plain"))
    assert notched.blocks.is_compound.sum() == rings
    left, right = stations(ring(**changes))[5:7]
    apex = stations(ring(**(changes | {"voussoirs": 12})))[6]
    triangles = [0.5 * 0.5 * (right.at(d)[0] - left.at(d)[0]) * (apex.at(d)[1] - right.at(d)[1]) for d in (0.0, 0.4)]
    assert free_volume(notched) - free_volume(plain) == pytest.approx(triangles[1] - triangles[0], rel=1e-6)
    joints = find_interfaces(notched.blocks)
    assert len(joints) == 12 * rings + (11 + 1) * (rings - 1)  # the keystones of two rings share two faces
    for where in (notched.blocks.centroid, joints.polygon):  # symmetric about its middle, x = 0.3
        assert cKDTree(where).query(where * (-1, 1, 1) + (0.6, 0, 0))[0].max() < ROUND_OFF


def test_of_a_notched_keystone_only_the_weight_counts() -> None:
    """Its joints are those of a plain keystone, and both are symmetric. A plain keystone of the same weight causes the same thrust."""
    notched, plain = (scenes.build(arch(shape="pointed", rise=2.2, keystone=kind), settlement=SPREADS) for kind in ("notched", "plain"))
    blocks, key = plain.blocks, plain.blocks.names.index("arch 6")
    parts = []
    for k, name in enumerate(blocks.names):
        corners = blocks.vertices[slice(*blocks.vertex_start[k : k + 2])]
        heavier = float(notched.blocks.mass[key] / blocks.mass[key]) if k == key else 1.0
        profile = corners[: len(corners) // 2, [0, 2]].tolist()  # a prism has its front corners first
        role = ("free", "fixed", "support")[blocks.role[k]]
        parts.append(scenes.block(name, role, heavier * 2000.0, prism=(profile, (-0.2, 0.3))))
    loaded = scenes.build(*parts, settlement=SPREADS, density=2000.0)
    assert loaded.weight == pytest.approx(notched.weight, rel=1e-9)
    assert loaded.weight != pytest.approx(plain.weight, rel=1e-3)
    assert reaction(loaded) == pytest.approx(reaction(notched), abs=EXACT)


def test_points_of_the_inner_face_lie_on_the_curve() -> None:
    for joint in stations(ring(**SHAPES["elliptical"])):
        x, z = joint.at(0.0)
        assert (x / 1.5) ** 2 + (z / 0.9) ** 2 == pytest.approx(1.0, rel=ROUND_OFF)
    radius = (1.5**2 + 2.2**2) / 3.0
    for joint in stations(ring(**SHAPES["pointed"])):
        x, z = joint.at(0.0)
        assert math.hypot(abs(x) - 1.5 + radius, z) == pytest.approx(radius, rel=ROUND_OFF)


@pytest.mark.parametrize("name", SHAPES)
def test_joints_leave_the_inner_face_at_right_angles_and_at_equal_lengths(name: str) -> None:
    """With many voussoirs, the chords approach the curve. The apex of a pointed arch, where the curve is not smooth, is left out."""
    joints = stations(ring(**(SHAPES[name] | {"voussoirs": 2000})))
    points = np.array([joint.at(0.0) for joint in joints])
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert np.ptp(lengths) <= 1e-5 * lengths.mean()
    along = points[2:] - points[:-2]
    out = np.array([joint.at(1.0) for joint in joints])[1:-1] - points[1:-1]
    off = np.abs(np.sum(along * out, axis=1)) / np.linalg.norm(along, axis=1)
    off[999] = 0.0  # the middle
    assert off.max() <= 2e-3


@pytest.mark.parametrize("shape", ["pointed", "elliptical", "basket"])
def test_every_shape_as_high_as_half_its_span_is_the_semicircle(shape: str) -> None:
    circle = scenes.build(arch(), settlement=SPREADS).blocks.vertices
    by_radius = arch(span=None, rise=None, radius=1.7)
    assert np.allclose(scenes.build(by_radius, settlement=SPREADS).blocks.vertices, circle, atol=1e-9)
    assert np.allclose(scenes.build(arch(shape=shape), settlement=SPREADS).blocks.vertices, circle, atol=1e-7)


@pytest.mark.parametrize("name", ["semicircle", "elliptical", "high ellipse", "basket"])
def test_the_volume_tends_to_that_of_the_curved_ring_at_second_order(name: str) -> None:
    """A band of thickness t along a curve of length L that turns by pi has the area t L + pi t^2 / 2."""
    fine = stations(ring(**(SHAPES[name] | {"voussoirs": 4000})))
    length = sum(math.dist(a.at(0.0), b.at(0.0)) for a, b in pairwise(fine))
    band = 0.5 * (0.4 * length + math.pi * 0.4**2 / 2.0)
    missing = [band - free_volume(scenes.build(arch(**(SHAPES[name] | {"voussoirs": n})), settlement=SPREADS)) for n in (24, 48)]
    assert missing[1] > 0.0 and missing[0] / missing[1] == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize("name", SHAPES)
def test_an_arch_pushes_alike_on_both_springings(name: str) -> None:
    right = reaction(scenes.build(arch(**SHAPES[name]), settlement=SPREADS, friction=0.9))
    other = arch(**SHAPES[name], springers={"left": "support", "right": "fixed"})
    left = reaction(scenes.build(other, settlement=(-1.0, 0.0, 0.0), friction=0.9))
    assert left == pytest.approx(right, abs=EXACT)
    assert right > 0.0


def test_a_joint_between_rings_cannot_strengthen_an_arch() -> None:
    """One ring can carry all forces of two rings, so its least thrust is no greater and its greatest thrust no smaller."""
    one, two = (scenes.build(arch(rings=rings), settlement=SPREADS, friction=0.7) for rings in (1, 2))
    assert free_volume(one) == pytest.approx(free_volume(two), rel=ROUND_OFF)
    assert reaction(one) <= reaction(two) + EXACT
    assert reaction(one, Drive.PUSHING) >= reaction(two, Drive.PUSHING) - EXACT


def test_a_turned_arch_pushes_as_it_did() -> None:
    straight = reaction(scenes.build(arch(**SHAPES["pointed"]), settlement=SPREADS, friction=0.9, plane=False))
    turned = scenes.build(arch(**SHAPES["pointed"], angle=90.0), settlement=(0.0, 1.0, 0.0), friction=0.9)
    assert reaction(turned) == pytest.approx(straight, abs=EXACT)


REFUSED_ARCHES = {
    "no measure": ({"span": None, "rise": None}, "needs either a `radius`, or both `span` and `rise`"),
    "both measures": ({"radius": 2.0}, "needs either a `radius`, or both `span` and `rise`"),
    "radius of an ellipse": ({"span": None, "rise": None, "radius": 2.0, "shape": "elliptical"}, "needs `span` and `rise` in place of"),
    "embrace and span": ({"embrace": 120.0}, "`embrace` goes with `radius`"),
    "flat pointed": ({"shape": "pointed", "rise": 1.0}, "the `rise` of the shape pointed over this `span` is 1.5 m or more"),
    "high basket": ({"shape": "basket", "rise": 1.6}, "the `rise` of the shape basket over this `span` is 0.422 m to 1.5 m"),
    "two voussoirs": ({"voussoirs": 2}, "needs at least 3 `voussoirs`"),
    "notch in a circle": ({"keystone": "notched"}, '`keystone = "notched"` needs `shape = "pointed"` and an odd number'),
    "notch at a joint": ({"shape": "pointed", "rise": 2.2, "voussoirs": 12, "keystone": "notched"}, "an odd number of `voussoirs`"),
    "unknown shape": ({"shape": "gothic"}, "must be 'circular', 'pointed', 'elliptical' or 'basket'"),
}


@pytest.mark.parametrize("case", REFUSED_ARCHES)
def test_an_arch_that_cannot_be_built_is_refused_with_the_reason(case: str) -> None:
    changes, reason = REFUSED_ARCHES[case]
    with pytest.raises(SceneError) as error:
        scenes.build(arch(**changes), settlement=SPREADS)
    assert reason in str(error.value)
