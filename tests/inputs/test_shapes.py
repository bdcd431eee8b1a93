"""Shapes of walls, arches and rubble: volumes by formulas, joints closed all over, symmetry, limits in which shapes coincide, reactions."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import scenes
from scipy.spatial import cKDTree

from la_core.errors import SceneError
from la_core.geometry.interfaces import find_interfaces
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble
from la_core.scene.generators import rubble as generator
from la_core.scene.generators.arches import stations
from la_core.scene.scene import Scene
from la_core.scene.schema.curved import Arch

ROUND_OFF = 1e-9  # of a length, an area or a volume
EXACT = 1e-6  # of the weight: residuals up to 1e-6 of a block's weight are accepted
LENGTH, DEPTH, HEIGHT, COURSES, PER_COURSE = 0.6, 0.4, 0.3, 6, 8
WIDE, HIGH = PER_COURSE * LENGTH, COURSES * HEIGHT
SPREADS = (1.0, 0.0, 0.0)


def wall(**changes: Any) -> str:
    entries = {
        "bond": "running", "origin": (0.3, -0.2, 0.1), "block": (LENGTH, DEPTH, HEIGHT), "per_course": PER_COURSE, "courses": COURSES,
        "footing": {"height": 0.3, "settling": (3.0, WIDE)},
    }  # fmt: skip
    return scenes.table("[wall]", **(entries | changes))


def window(**changes: Any) -> dict[str, Any]:
    return {"from": (1.8, 0.3), "to": (3.0, 0.6), "bearing": 0.3, "head": "arch", "rise": 0.6, "voussoirs": 7} | changes


def arch(**changes: Any) -> str:
    entries = {
        "centre": (0.3, -0.2, 0.1), "span": 3.0, "rise": 1.5, "thickness": 0.4, "depth": 0.5, "voussoirs": 11,
        "springers": {"left": "fixed", "right": "support"},
    }  # fmt: skip
    return scenes.table("[arch]", **{key: value for key, value in (entries | changes).items() if value is not None})


def rubble(**changes: Any) -> str:
    entries = {
        "origin": (0.3, -0.2, 0.1), "size": (1.8, 1.2), "depth": 0.4, "stones": 20, "seed": 3, "shortest": 0.05,
        "footing": {"height": 0.2, "settling": (1.2, 1.8)},
    }  # fmt: skip
    return scenes.table("[rubble]", **(entries | changes))


def free_volume(scene: Scene) -> float:
    return float(scene.blocks.volume[scene.blocks.free].sum())


def exposed(scene: Scene) -> float:
    """Area of the free blocks' faces less that of all joints, m2: every face of a joint belongs to one of them."""
    blocks, joints = scene.blocks, find_interfaces(scene.blocks)
    total = 0.0
    for face, block in enumerate(blocks.face_block):
        corners = blocks.vertices[blocks.face_vertex[blocks.face_start[face] : blocks.face_start[face + 1]]]
        arms = corners[1:] - corners[0]
        area = np.linalg.norm(np.sum([np.cross(a, b) for a, b in pairwise(arms)], axis=0)) / 2.0
        total += area if blocks.free[block] else 0.0
    sides = blocks.free[joints.block_a].astype(int) + blocks.free[joints.block_b]
    return float(total - np.sum(sides * joints.area))


def reaction(scene: Scene, drive: Drive = Drive.YIELDING) -> float:
    solution = solve_associated(assemble(scene), drive)
    assert solution.status is Status.SOLVED
    return solution.value / scene.weight


# --- walls: volume, and what is exposed of an otherwise closed wall ---------------------------------------------------------------


def chords(half: float, outer: float) -> float:
    """Length of the inner face of a semicircle over courses of 0.3 m, from its springing: two courses, then a key in three parts."""
    angles = [0.0, math.asin(HEIGHT / outer), math.asin(2.0 * HEIGHT / outer)]
    angles += [angles[-1] + (math.pi - 2.0 * angles[-1]) * k / 3.0 for k in (1, 2, 3)] + [math.pi - angles[1], math.pi]
    return sum(2.0 * half * math.sin((b - a) / 2.0) for a, b in pairwise(angles))


def under_arch(half: float, outer: float) -> float:
    """Area below the chords of `chords`, m2."""
    angles = [0.0, math.asin(HEIGHT / outer), math.asin(2.0 * HEIGHT / outer)]
    angles += [angles[-1] + (math.pi - 2.0 * angles[-1]) * k / 3.0 for k in (1, 2, 3)] + [math.pi - angles[1], math.pi]
    return sum(half**2 * math.sin(b - a) / 2.0 for a, b in pairwise(angles))


def upright(area: float, edges: float, depth: float = DEPTH) -> tuple[float, float]:
    """Volume and exposed surface of a wall with this face and these free edges, its foot aside."""
    return area * depth, 2.0 * area + edges * depth


SLANT = math.hypot(0.9, HIGH)
RAFTER = math.hypot(WIDE / 2.0, 1.5)
WALLS = {
    "plain": ({}, upright(WIDE * HIGH, WIDE + 2 * HIGH)),
    "turned": ({"angle": 35.0}, upright(WIDE * HIGH, WIDE + 2 * HIGH)),
    "along y": ({"angle": 90.0}, upright(WIDE * HIGH, WIDE + 2 * HIGH)),
    "courses of two heights": ({"heights": (0.4, 0.2)}, upright(WIDE * HIGH, WIDE + 2 * HIGH)),
    "buttress": ({"rake": (0.0, 0.9)}, upright((WIDE - 0.45) * HIGH, WIDE - 0.9 + HIGH + SLANT)),
    "gable": ({"gable": 1.5}, upright(WIDE * HIGH + WIDE * 0.75, 2 * HIGH + 2 * RAFTER)),
    "buttressed gable": (
        {"rake": (0.9, 0.9), "gable": 1.0},
        upright((WIDE - 0.9) * HIGH + (WIDE - 1.8) / 2, 2 * SLANT + 2 * math.hypot((WIDE - 1.8) / 2, 1.0)),
    ),
    "semicircle": (
        {"opening": [window()]},
        upright(WIDE * HIGH - 1.2 * 0.3 - under_arch(0.6, 0.9), WIDE + 2 * HIGH + 1.2 + 0.6 + chords(0.6, 0.9)),
    ),
    "taper": (
        {"taper": (0.05, 0.1)},
        (WIDE * HIGH * (DEPTH - 0.075),
         WIDE * (math.hypot(HIGH, 0.05) + math.hypot(HIGH, 0.1) + DEPTH - 0.15) + 2 * HIGH * (DEPTH - 0.075)),
    ),
    "pier": (
        {"per_course": 1, "bond": "stack", "taper": (0.05, 0.05), "rake": (0.1, 0.1), "footing": {"height": 0.3, "settling": (0.2, 0.6)}},
        (HIGH / 6 * (0.6 * 0.4 + 4 * 0.5 * 0.35 + 0.4 * 0.3),
         0.4 * 0.3 + (0.6 + 0.4) * math.hypot(HIGH, 0.05) + (0.4 + 0.3) * math.hypot(HIGH, 0.1)),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", WALLS)
def test_a_wall_has_its_volume_and_is_closed_all_over(name: str) -> None:
    changes, (volume, surface) = WALLS[name]
    scene = scenes.build(wall(**changes))
    assert free_volume(scene) == pytest.approx(volume, rel=ROUND_OFF)
    assert exposed(scene) == pytest.approx(surface, rel=ROUND_OFF)


@pytest.mark.parametrize(
    ("changes", "key_area"),
    [({"rise": 0.3, "bearing": 0.15, "voussoirs": 5}, 0.0), ({"rise": 0.1, "bearing": 0.1, "voussoirs": 5}, 0.0), ({"voussoirs": 11}, 0.0)],
)
def test_an_arched_head_leaves_no_more_than_its_segment_and_closes_with_the_wall(changes: dict[str, Any], key_area: float) -> None:
    """What is exposed beyond the wall's own sides is the opening's jambs, its sill and a polygon within the arc."""
    scene = scenes.build(wall(opening=[window(**changes)]))
    half, rise = 0.6, changes.get("rise", 0.6)
    radius = (half**2 + rise**2) / (2.0 * rise)
    angle = 2.0 * math.atan2(half, radius - rise)
    segment = radius**2 * (angle - math.sin(angle)) / 2.0
    missing = WIDE * HIGH - 1.2 * 0.3 - free_volume(scene) / DEPTH
    assert 0.75 * segment < missing < segment
    edges = (exposed(scene) - 2.0 * (WIDE * HIGH - 1.2 * 0.3 - missing)) / DEPTH - (WIDE + 2 * HIGH + 1.2 + 0.6)
    assert 0.95 * radius * angle < edges < radius * angle


def test_a_wall_with_an_arched_head_in_its_middle_is_symmetric() -> None:
    for opening in (window(), window(rise=0.25, bearing=0.2)):
        text = wall(opening=[opening], origin=(-WIDE / 2, 0.0, 0.0), footing={"height": 0.3})
        vertices = scenes.build(text, settlement=None, live=SPREADS).blocks.vertices
        assert np.allclose(*(np.unique(np.round(v, 9), axis=0) for v in (vertices, vertices * (-1, 1, 1))), atol=2e-9)


def test_heights_that_are_all_those_of_a_block_change_nothing() -> None:
    one, other = scenes.build(wall()).blocks, scenes.build(wall(heights=(HEIGHT,))).blocks
    assert one.names == other.names and np.allclose(one.vertices, other.vertices, atol=1e-12)


@pytest.mark.parametrize("angle", [30.0, 90.0, -135.0])
def test_a_turned_wall_carries_what_it_carried(angle: float) -> None:
    small = {"per_course": 3, "courses": 3, "footing": {"height": 0.3, "settling": (1.2, 1.8)}}
    straight = reaction(scenes.build(wall(**small), plane=False))
    assert reaction(scenes.build(wall(**small, angle=angle))) == pytest.approx(straight, abs=EXACT)


def test_a_pier_stands_on_its_footing_as_on_a_balance() -> None:
    """The weight acts at the middle; the fixed part ends at 0.2 m, and the settling part at 0.6 m: R = W (0.3 - 0.2) / (0.6 - 0.2)."""
    changes, _ = WALLS["pier"]
    assert reaction(scenes.build(wall(**changes))) == pytest.approx(0.25, abs=EXACT)


def test_a_footing_without_a_settling_part_is_fixed() -> None:
    scene = scenes.build(wall(footing={"height": 0.3}), settlement=None, live=SPREADS)
    assert not scene.blocks.role.max() > 1 and (~scene.blocks.free).sum() == 1


REFUSED_WALLS = {
    "rise of a lintel": ({"opening": [window(head="lintel", voussoirs=None)]}, '`head = "arch"` needs a `rise`, and only an arch has one'),
    "arch without rise": ({"opening": [window(rise=None)]}, '`head = "arch"` needs a `rise`'),
    "too high an arch": ({"opening": [window(rise=0.7)]}, "the `rise` of an arch over an opening is at most half the opening's width"),
    "arch beyond the wall": (
        {"opening": [window(**{"from": (1.8, 0.6), "to": (3.0, 1.2)})]},
        "the wall ends at 1.8 m, below the key of its arch, which needs 1.95 m; add courses",
    ),
    "too few voussoirs": ({"opening": [window(voussoirs=4)]}, "so many courses that it needs 5 `voussoirs` or more"),
    "arch at the end": ({"opening": [window(**{"from": (0.3, 0.3), "to": (1.5, 0.6)})]}, "an arch needs a block on either side"),
    "bearing beyond the rise": ({"opening": [window(rise=0.3, bearing=1.2)]}, "bears too far into the wall for its rise"),
    "two leaves": ({"leaves": 2, "taper": (0.1, 0.0)}, "`taper`, `rake`, `gable` and openings under an arch go with one leaf"),
    "taper": ({"taper": (0.2, 0.2)}, "the entries of `taper` together must be less than the depth of a `block`"),
    "rake": ({"rake": (2.4, 2.4)}, "the entries of `rake` together must be less than the length of the wall"),
    "settling beyond the wall": ({"footing": {"height": 0.3, "settling": (3.0, 5.0)}}, "must lie within the wall's length, 0 to 4.8 m"),
    "settling backwards": ({"footing": {"height": 0.3, "settling": (3.0, 2.0)}}, "second entry of `settling` must be greater than the"),
    "between courses": (
        {"heights": (0.4, 0.2), "opening": [window(**{"from": (1.8, 0.3)})]},
        "bottom and top must lie on course lines, of which 0 m and 0.4 m are nearest",
    ),
    "opening in a rake": ({"rake": (4.0, 0.0), "opening": [window(head="lintel", rise=None, voussoirs=None)]}, "openings or their heads"),
}


@pytest.mark.parametrize("case", REFUSED_WALLS)
def test_a_wall_that_cannot_be_built_is_refused_with_the_reason(case: str) -> None:
    changes, reason = REFUSED_WALLS[case]
    if "opening" in changes:
        changes = changes | {"opening": [{key: value for key, value in one.items() if value is not None} for one in changes["opening"]]}
    with pytest.raises(SceneError) as error:
        assemble(scenes.build(wall(**changes)))
    assert reason in str(error.value)


def random_wall(chance: np.random.Generator) -> dict[str, Any]:
    """A wall with an arched or a plain opening that may or may not fit, and some of what else walls can have."""
    block, per_course, courses = chance.uniform(0.2, 0.8, 3), int(chance.integers(2, 9)), int(chance.integers(2, 9))
    length = float(block[0]) * per_course
    heights = chance.choice([0.2, 0.25, 0.4], 2).tolist() if chance.random() < 0.5 else [float(block[2])]
    lines = [0.0, *np.cumsum([heights[k % len(heights)] for k in range(courses)]).tolist()]
    low, high = sorted(chance.choice(len(lines), 2, replace=False).tolist())
    start, end = sorted(chance.uniform(0.0, length, 2).tolist())
    rise = (end - start) / 2.0 * float(chance.choice([1.0, chance.uniform(0.05, 1.0)]))
    opening = {"from": (start, lines[low]), "to": (end, lines[high]), "bearing": float(chance.uniform(0.05, 0.3))}
    arched = {"head": "arch", "rise": rise, "voussoirs": int(chance.integers(1, 15))}
    return {
        "block": block.tolist(), "per_course": per_course, "courses": courses, "heights": heights,
        "bond": str(chance.choice(["running", "stack"])), "angle": float(chance.choice([0.0, 90.0, 37.5])),
        "taper": (chance.uniform(0.0, 0.1, 2) * block[1]).tolist(), "rake": (chance.uniform(0.0, 0.2, 2) * length).tolist(),
        "opening": [opening | arched if chance.random() < 0.7 else opening], "footing": {"height": 0.3},
        **({"gable": float(chance.uniform(0.2, 2.0))} if chance.random() < 0.5 else {}),
    }  # fmt: skip


def test_random_walls_are_refused_for_a_reason_or_have_neither_gaps_nor_overlaps() -> None:
    """Blocks that overlap, or touch nothing, would be refused by the assembly: a fault of the generator, and none of the wall's."""
    chance, built = np.random.default_rng(5), 0
    for _ in range(150):
        text = wall(**random_wall(chance))
        try:
            scene = scenes.build(text, settlement=None, live=SPREADS)
        except SceneError as error:
            assert "opening" in str(error) and "convex" not in str(error)
            continue
        assemble(scene)
        built += 1
    assert built > 30


# --- arches: curves, volume, symmetry, rings ----------------------------------------------------------------------------------------

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
    across = np.abs(joints.normal[:, 0]) > 0  # all but nothing; areas of joints across the ring are those of its thickness
    ends = stations(ring(**changes))
    thickness = sum(math.dist(end.at(0.0), end.at(0.4)) for end in ends)
    between = sum(math.dist(a.at(0.4 * k / rings), b.at(0.4 * k / rings)) for a, b in pairwise(ends) for k in range(1, rings))
    assert across.any() and joints.area.sum() == pytest.approx(0.5 * (thickness + between), rel=ROUND_OFF)
    assert ends[0].at(0.0) == pytest.approx((-1.5, 0.0), abs=ROUND_OFF) and ends[-1].at(0.0) == pytest.approx((1.5, 0.0), abs=ROUND_OFF)
    crown = stations(ring(**(changes | {"voussoirs": 12})))[6]
    assert crown.at(0.0) == pytest.approx((0.0, changes.get("rise", 1.5)), abs=ROUND_OFF)


@pytest.mark.parametrize("rings", [1, 2])
def test_a_notched_keystone_follows_the_apex(rings: int) -> None:
    """Its profile is that of the plain one with a triangle more above and a triangle less below."""
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
    """Its joints are those of the plain one, and both are symmetric: a plain one that weighs as much pushes as much."""
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
    """In many voussoirs, chords approach the curve; the apex of a pointed arch is no smooth point."""
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
    """What two rings can carry, one ring can: its least thrust is no greater, and its greatest no less."""
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


# --- rubble ---------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("changes", [{}, {"seed": 8, "stones": 45, "shortest": 0.04}, {"flatness": 3.0, "stones": 8}, {"angle": 40.0}])
def test_rubble_fills_its_wall_and_has_no_short_joint(changes: dict[str, Any]) -> None:
    scene = scenes.build(rubble(**changes))
    volume, surface = upright(1.8 * 1.2, 1.8 + 2 * 1.2)
    assert scene.blocks.free.sum() == changes.get("stones", 20)
    assert free_volume(scene) == pytest.approx(volume, rel=ROUND_OFF) and exposed(scene) == pytest.approx(surface, rel=ROUND_OFF)
    joints = find_interfaces(scene.blocks)
    own = scene.blocks.free[joints.block_a] & scene.blocks.free[joints.block_b]
    assert (joints.area[own] / 0.4).min() >= changes.get("shortest", 0.05) * (1.0 - ROUND_OFF)


def test_a_seed_draws_the_same_stones_and_another_seed_others() -> None:
    first, again, other = (scenes.build(rubble(seed=seed)).blocks.vertices for seed in (5, 5, 6))
    assert np.array_equal(first, again) and (first.shape != other.shape or not np.allclose(first, other))


def test_rubble_whose_joints_cannot_be_so_long_says_what_can(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(SceneError, match=r"`shortest` may be at most 0.131 m: these stones are about 0.33 m long"):
        scenes.build(rubble(shortest=0.4))
    monkeypatch.setattr(generator, "MOST_MOVES", 1)
    with pytest.raises(SceneError, match=r'rubble "rubble": shortest = 0.1: cannot be reached: these stones keep .* such as 0.033 m'):
        scenes.build(rubble(shortest=0.1))
