"""The tolerance of the geometry: surveyed walls close again, every change is reported, and what cannot be repaired is named."""

from itertools import pairwise

import numpy as np
import pytest
import rubble_walls
import scenes

from la_core.analysis.modelling import structural_model
from la_core.analysis.stage import analyse
from la_core.errors import SceneError
from la_core.geometry import Blocks, find_interfaces, prism
from la_core.limit.problem import Drive
from la_core.repair import close_joints
from la_core.repair.outline_motion import moved_outline
from la_core.scene import Scene
from la_core.scene.generators.placing import leaning, turned

LENGTH, HEIGHT, DEPTH = 0.6, 0.3, 0.4
ROUND_OFF = 1e-9


def surveyed(
    courses: int,
    per_course: int,
    error: float,
    seed: int = 0,
    digits: int = 12,
    joint: float = 0.0,
    tolerance: float = 0.0,
    bond: str = "running",
) -> Scene:
    """A wall whose corners are wrong by up to `error`, m, each by itself, then rounded."""
    chance, parts, width = (
        np.random.default_rng(seed),
        list(scenes.base(round(per_course * 2 / 3) * LENGTH, per_course * LENGTH, DEPTH)),
        LENGTH / 2,
    )
    for course in range(courses):
        first = 1 if course % 2 and bond == "running" else 2
        ends = [0.0, *(np.arange(first, 2 * per_course, 2) * width).tolist(), per_course * LENGTH]
        for number, (left, right) in enumerate(pairwise(ends), 1):
            low, high = course * HEIGHT, (course + 1) * HEIGHT
            grown = np.array([(left, low), (right, low), (right, high), (left, high)])
            drawn = grown + joint / 2.0 * np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)]) + chance.uniform(-error, error, (4, 2))
            parts.append(scenes.block(f"{course}.{number}", prism=(np.round(drawn, digits).tolist(), (0.0, DEPTH))))
    if tolerance:
        parts.append(scenes.table("geometry", tolerance=tolerance))
    return scenes.build(*parts)


def joints(scene: Scene) -> list[tuple[str, str]]:
    """Pairs of blocks with a joint that counts."""
    found = structural_model(scene).assembly.interfaces
    return sorted((scene.blocks.names[a], scene.blocks.names[b]) for a, b in zip(found.block_a, found.block_b, strict=True))


def reaction(scene: Scene) -> float:
    return analyse(scene).bounds[Drive.YIELDING].value / scene.weight


@pytest.mark.parametrize(("error", "tolerance"), [(0.0005, 0.001), (0.002, 0.003), (0.004, 0.005), (0.005, 0.005)])
@pytest.mark.parametrize(("seed", "bond"), [(1, "running"), (2, "running"), (3, "stack")])
def test_a_surveyed_wall_has_the_joints_of_the_true_one(error: float, tolerance: float, seed: int, bond: str) -> None:
    """In stack bond four corners meet, and errors make joints of some millimetres between blocks that meet in a corner only."""
    true, survey = surveyed(6, 8, 0.0, bond=bond), surveyed(6, 8, error, seed, tolerance=tolerance, bond=bond)
    assert joints(survey) == joints(true)
    repairs = survey.repairs
    assert 0.0 < repairs.largest_move < 3.0 * tolerance and repairs.moved_block in survey.blocks.names
    assert not repairs.unclosed and repairs.gaps_closed + repairs.overlaps_closed > 0.9 * len(joints(true))
    assert reaction(survey) == pytest.approx(reaction(true), rel=0.05)


@pytest.mark.parametrize("digits", [2, 3])
def test_rounded_coordinates_close_again(digits: int) -> None:
    turned = surveyed(5, 6, 0.4 * 10.0**-digits, digits=digits, tolerance=10.0**-digits)
    assert joints(turned) == joints(surveyed(5, 6, 0.0))


def test_a_true_wall_stays_as_it_is() -> None:
    plain, repaired = surveyed(4, 5, 0.0), surveyed(4, 5, 0.0, tolerance=0.005)
    assert repaired.blocks.vertices == pytest.approx(plain.blocks.vertices, abs=ROUND_OFF)
    assert repaired.repairs.largest_move < ROUND_OFF
    assert (repaired.repairs.gaps_closed, repaired.repairs.overlaps_closed, repaired.repairs.overlaps_cut) == (0, 0, 0)
    assert plain.repairs is None


def test_mortar_within_the_tolerance_is_closed_in_its_middle() -> None:
    """Two blocks 4 mm apart and 4 mm above the ground: every face moves by 2 mm."""
    pads = scenes.base(0.5, 1.0, 1.0)
    blocks = [scenes.box("a", (0.0, 0.0, 0.004), (0.498, 1.0, 0.5)), scenes.box("b", (0.502, 0.0, 0.004), (1.0, 1.0, 0.5))]
    scene = scenes.build(*pads, *blocks, scenes.table("geometry", tolerance=0.0025))
    place = dict(zip(scene.blocks.names, zip(scene.blocks.low, scene.blocks.high, strict=True), strict=True))
    assert place["a"][1][0] == pytest.approx(0.5, abs=1e-6) == place["b"][0][0]
    assert [place[name][0][2] for name in "ab"] == pytest.approx([0.002, 0.002], abs=1e-6)
    assert scene.repairs.gaps_closed == 3
    assert scene.repairs.largest_move == pytest.approx(0.002 * np.sqrt(2.0), rel=1e-4)


def test_what_is_wider_than_the_tolerance_stays_open() -> None:
    pads = scenes.base(0.5, 1.0, 1.0)
    scene = scenes.build(*pads, scenes.box("a", (0.0, 0.0, 0.02), (1.0, 1.0, 0.5)), scenes.table("geometry", tolerance=0.005))
    with pytest.raises(SceneError, match=r'block "a": touches nothing'):
        find_interfaces(scene.blocks)


def test_an_overlap_beyond_the_tolerance_is_named_with_its_place_and_refused() -> None:
    parts = (*scenes.base(0.5, 1.0), scenes.box("a", (0.0, 0.0, -0.05), (1.0, 1.0, 0.5)))
    scene = scenes.build(*parts, scenes.table("geometry", tolerance=0.005))
    assert {one.blocks for one in scene.repairs.unclosed} == {("fixed base", "a"), ("settling base", "a")}
    assert [one.gap for one in scene.repairs.unclosed] == pytest.approx([-0.05, -0.05])
    assert all(-0.05 <= one.vertex[2] <= 0.0 for one in scene.repairs.unclosed)
    with pytest.raises(SceneError, match=r'"fixed base" and "a": overlap by about 0.05 m; so do "settling base" and "a" by 0.05 m'):
        find_interfaces(scene.blocks)


def test_a_short_joint_within_the_tolerance_goes() -> None:
    """A block that rests on two pads, on the second one by 3 mm only."""
    pads = [
        scenes.box("fixed", (0.0, 0.0, -0.5), (0.997, 1.0, 0.0), "fixed"),
        scenes.box("settling", (0.997, 0.0, -0.5), (2.0, 1.0, 0.0), "support"),
    ]
    blocks = [scenes.box("a", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5)), scenes.box("b", (1.0, 0.0, 0.0), (2.0, 1.0, 0.5))]
    counts = {}
    for tolerance in (0.001, 0.002):
        analysis = analyse(scenes.build(*pads, *blocks, scenes.table("geometry", tolerance=tolerance)))
        counts[tolerance] = len(analysis.whole.interfaces)
    assert counts == {0.001: 4, 0.002: 3}


def test_what_cannot_lie_on_one_plane_is_named_with_its_corner() -> None:
    """The last metre of a bed of five falls by 9.9 mm: the block upon it cannot lie on both within 5 mm."""
    pads = [scenes.block("fixed", "fixed", prism=([(0, -1), (4, -1), (4, 0), (0, 0)], (0.0, 1.0)))]
    pads.append(scenes.block("settling", "support", prism=([(4, -1), (5, -1), (5, -0.0099), (4, 0)], (0.0, 1.0))))
    scene = scenes.build(*pads, scenes.box("a", (0.0, 0.0, 0.0), (5.0, 1.0, 0.5)), scenes.table("geometry", tolerance=0.005))
    (unclosed,) = scene.repairs.unclosed
    assert set(unclosed.blocks) == {"settling", "a"}
    assert unclosed.gap == pytest.approx(0.0099, rel=0.01)
    assert unclosed.vertex[0] == pytest.approx(5.0, abs=0.01)


def test_bodies_in_space_close_too() -> None:
    """Boxes of a pile of three by two by two with errors in all directions."""
    chance, parts = np.random.default_rng(3), [scenes.box("ground", (0.0, 0.0, -0.5), (0.75, 1.0, 0.0), "fixed")]
    parts.append(scenes.box("settling", (0.75, 0.0, -0.5), (1.5, 1.0, 0.0), "support"))
    for i, j, k in np.ndindex(3, 2, 2):
        corners = np.array(np.meshgrid([i, i + 1], [j, j + 1], [k, k + 1])).T.reshape(-1, 3) * 0.5
        low, high = corners.min(axis=0) + chance.uniform(-0.002, 0.002, 3), corners.max(axis=0) + chance.uniform(-0.002, 0.002, 3)
        parts.append(scenes.box(f"{i}{j}{k}", low, high))
    scene = scenes.build(*parts, scenes.table("geometry", tolerance=0.004))
    assert len(joints(scene)) == 8 + 6 + 8 + 6


def test_a_structure_far_from_the_origin_closes_as_one_near_it() -> None:
    near, far = ([], [])
    for parts, east in ((near, 0.0), (far, 3_512_345.0)):
        for name, role, x, low, high in (("a", "fixed", 0, -1.0, -0.002), ("b", "support", 1, -1.0, 0.001), ("c", "free", 0, 0.0, 0.5)):
            width = 2.0 if role == "free" else 1.0
            parts.append(scenes.box(name, (x + east, 0.0, low), (x + width + east, 1.0, high), role))
        parts.append(scenes.table("geometry", tolerance=0.002))
    one, other = scenes.build(*near), scenes.build(*far)
    assert other.blocks.vertices - (3_512_345.0, 0.0, 0.0) == pytest.approx(one.blocks.vertices, abs=1e-8)
    assert joints(one) == joints(other) and one.repairs.largest_move == pytest.approx(other.repairs.largest_move, abs=1e-8)


STONES = {"origin": (0.0, 0.0, 0.0), "size": (4.0, 2.5), "depth": 0.5, "stones": 50, "shortest": 0.02}


def rubble_of(seed: int, error: float, tolerance: float) -> tuple[Scene, Scene]:
    """A rubble wall of fifty stones, and its survey: every corner of every stone wrong by up to `error` (m), then rounded to 1 mm."""
    pads, chance = scenes.base(2.7, 4.0, 0.5), np.random.default_rng(seed)
    true = scenes.build(*pads, scenes.table("[rubble]", **STONES, seed=seed))
    parts = [*pads, scenes.table("geometry", tolerance=tolerance)]
    for k in np.flatnonzero(true.blocks.free):
        corners = true.blocks.vertices[slice(*true.blocks.vertex_start[k : k + 2])]
        outline = corners[: len(corners) // 2, [0, 2]]  # a prism has its front corners first
        drawn = np.round(outline + chance.uniform(-error, error, outline.shape), 3)
        parts.append(scenes.block(true.blocks.names[k], prism=(drawn.tolist(), (0.0, 0.5))))
    return true, scenes.build(*parts)


def lengths_of_joints(scene: Scene) -> dict[tuple[str, str], float]:
    """Length of every joint that counts, m, by its two blocks."""
    found, names = structural_model(scene).assembly.interfaces, scene.blocks.names
    return {(names[a], names[b]): area / 0.5 for a, b, area in zip(found.block_a, found.block_b, found.area, strict=True)}


@pytest.mark.parametrize(("error", "tolerance"), [(0.0005, 0.001), (0.002, 0.004)])
@pytest.mark.parametrize("seed", range(1, 6))
def test_surveyed_rubble_has_the_joints_and_the_weight_of_the_true_one(error: float, tolerance: float, seed: int) -> None:
    """Many stones are not quite convex as drawn, and corners between nearly level faces slide along them."""
    true, survey = rubble_of(seed, error, tolerance)
    before, after = lengths_of_joints(true), lengths_of_joints(survey)
    assert not survey.repairs.unclosed
    assert {pair for pair, length in before.items() if length > 8.0 * tolerance} <= set(after)
    assert all(after[pair] <= 8.0 * tolerance for pair in set(after) - set(before))
    assert survey.weight == pytest.approx(true.weight, rel=tolerance / 2.0)


@pytest.mark.parametrize("seed", [6, 7])
def test_no_stone_keeps_a_corner_between_two_faces_that_came_onto_one_plane(seed: int) -> None:
    """In wall 7 a short joint is gathered with the long one beside it; YADE refuses a stone whose corner lies on a straight edge."""
    stones = rubble_walls.shrunk(rubble_walls.profiles(seed), 0.005)
    true, parts = rubble_walls.wall(stones), rubble_walls.wall(stones, tolerance=0.003).blocks.parts
    same_block = parts.face_block[:, None] == parts.face_block
    level = same_block & (parts.face_normal @ parts.face_normal.T > 1.0 - 1e-7)
    assert not np.triu(level, 1).any()
    assert parts.volume.sum() == pytest.approx(true.blocks.volume.sum(), rel=1e-3)


def test_a_dent_within_the_tolerance_makes_no_second_part() -> None:
    dented = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.5, 0.497], [0.0, 0.5]]
    parts = (*scenes.base(0.5, 1.0), scenes.block("a", prism=(dented, (0.0, 1.0))))
    compound, plain = scenes.build(*parts), scenes.build(*parts, scenes.table("geometry", tolerance=0.004))
    assert compound.blocks.is_compound[-1] and not plain.blocks.is_compound.any()
    assert plain.blocks.volume[-1] == pytest.approx(0.5, abs=1e-6)


def test_a_part_thinner_than_its_errors_may_vanish() -> None:
    """A dent of 3 mm divides the stone; its lower part is thinner than the faces beside it move."""
    step = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.7, 0.5], [0.7, 0.502], [0.0, 0.502]]
    above = [[0.0, 0.502], [0.7, 0.502], [0.7, 0.5], [1.0, 0.5], [1.0, 1.0], [0.0, 1.0]]
    parts = (scenes.block("a", prism=(step, (0.0, 1.0))), scenes.block("b", prism=(above, (0.0, 1.0))))
    scene = scenes.build(*scenes.base(0.5, 1.0), *parts, scenes.table("geometry", tolerance=0.0012))
    assert ("a", "b") in joints(scene) and scene.blocks.volume[-2:].sum() == pytest.approx(1.0, rel=2e-3)


@pytest.mark.parametrize("gap", [0.0, 0.002])
def test_stones_that_lean_and_are_not_convex_close_their_joints_too(gap: float) -> None:
    """Front and back of both lean, and both are turned in plan: the cut through the first one ends within its outline on either side."""
    step = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (0.5, 0.5), (0.5, 1.0), (0.0, 1.0)]
    beside = [(0.5 + gap, 0.5 + gap), (1.0, 0.5 + gap), (1.0, 1.0), (0.5 + gap, 1.0)]
    shapes = [turned(leaning(one, (0.0, 0.4), (0.05, 0.38), (0.0, 1.0)), (0.0, 0.0, 0.0), 30.0) for one in (step, beside)]
    closed, repairs = close_joints(["step", "beside"], shapes, 0.002, np.zeros(2))
    blocks = Blocks.gather(["step", "beside"], ["fixed", "free"], [1.0, 1.0], closed)
    assert len(closed[0].parts) == 2
    assert repairs.largest_move <= gap + ROUND_OFF
    assert len(find_interfaces(blocks)) == 2
    by_height = 0.4 - 0.07 * np.array([0.25, 0.75])  # depth in the middle of the lower and of the upper half, m
    assert blocks.volume == pytest.approx([0.5 * by_height[0] + 0.25 * by_height[1], 0.25 * by_height[1]], abs=0.5 * gap * 0.4 + ROUND_OFF)
    assert blocks.volume.sum() == pytest.approx(0.5 * by_height.sum(), abs=ROUND_OFF)


JOGGLE = [(0.0, 0.0), (0.0, 0.15), (-0.05, 0.15), (-0.05, 0.3)]  # a joint between two stones that rest on each other by a step, m


def joggled_arch(error: float, seed: int, tolerance: float) -> Scene:
    """A flat arch of a keystone and two stones on each side, whose joints are stepped; corners are wrong by up to `error`, m."""
    left, right = ([[(x + side * px, z) for px, z in JOGGLE] for x in places] for side, places in ((1, (0.2, 0.4)), (-1, (0.6, 0.8))))
    ends = [[(-0.2, 0.0), (-0.2, 0.3)], *left, *right, [(1.2, 0.0), (1.2, 0.3)]]
    chance = np.random.default_rng(seed)
    held = [((-0.2, -0.2), (0.2, 0.0), "fixed"), ((0.8, -0.2), (1.2, 0.0), "support")]
    parts = [scenes.block(role, role=role, box=((a[0], 0.0, a[1]), (b[0], 0.3, b[1]))) for a, b, role in held]
    for number, (before, after) in enumerate(pairwise(ends)):
        corners = np.array([*after, *before[::-1]])
        parts.append(scenes.block(f"{number}", prism=((corners + chance.uniform(-error, error, corners.shape)).tolist(), (0.0, 0.3))))
    return scenes.build(*parts, scenes.table("geometry", tolerance=tolerance))


@pytest.mark.parametrize("seed", range(12))
def test_surveyed_stones_with_steps_have_the_joints_of_the_true_ones(seed: int) -> None:
    """The cut through such a stone is all but level with its steps: its parts alone would slide far along it."""
    true, survey = joggled_arch(0.0, 0, 0.001), joggled_arch(0.003, seed, 0.006)
    assert joints(survey) == joints(true)
    assert len(joints(true)) == 2 + 4 * 3
    assert not survey.repairs.unclosed
    assert survey.weight == pytest.approx(true.weight, rel=0.02)


@pytest.mark.parametrize(("dip", "x"), [(0.0028, 0.0), (0.003, 0.0), (0.003, 1e6), (0.0032, 0.0)])
def test_where_one_of_two_nearly_level_faces_moves_the_corner_between_them_becomes_a_step(dip: float, x: float) -> None:
    """The left half of an L's bed closes a gap of 2 mm to a pad and the right half is free: their planes meet 0.05 m beside the corner."""
    tolerance = 0.002
    stone = [(0.0, 0.0), (0.5, -dip), (1.0, 0.0), (1.0, 0.5), (0.4, 0.5), (0.4, 1.0), (0.0, 1.0)]
    pad = [(0.0, -0.5), (0.5, -0.5), (0.5, -0.002), (0.0, -0.002)]
    shapes = [prism([(x + px, z) for px, z in profile], (0.0, 0.4)) for profile in (stone, pad)]
    closed, repairs = close_joints(["stone", "pad"], shapes, tolerance, np.zeros(2))
    drawn, moved = (Blocks.gather(["stone", "pad"], ["free", "fixed"], [1.0, 1.0], some) for some in (shapes, closed))
    assert repairs.largest_move == pytest.approx(tolerance / 2.0, rel=1e-3) and repairs.moved_block == "stone"
    assert find_interfaces(moved).area == pytest.approx([0.5 * 0.4], rel=0.01)
    assert moved.volume == pytest.approx(drawn.volume, abs=tolerance * 0.5 * 0.4)


@pytest.mark.parametrize("degrees", [-0.45, -0.2])
def test_beside_neighbours_that_are_turned_in_plan_a_stone_that_is_not_convex_keeps_plane_faces(degrees: float) -> None:
    """Its end faces turn halfway towards the neighbours. Its back is then no copy of its front, and a cut between them is warped."""
    profiles = [
        [(0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (0.4, 0.5), (0.5, 1.0), (0.0, 1.0)],
        [(1.0, 0.0), (1.6, 0.0), (1.6, 0.5), (1.0, 0.5)],
        [(-0.6, 0.0), (0.0, 0.0), (0.0, 1.0), (-0.6, 1.0)],
    ]
    stone, right, left = (prism(profile, (0.0, 0.5)) for profile in profiles)
    names, turns = ["stone", "right", "left"], (turned(right, (1.0, 0.25, 0.0), degrees), turned(left, (0.0, 0.25, 0.0), -degrees))
    closed, _ = close_joints(names, [stone, *turns], 0.012, np.zeros(3))
    for part in closed[0].parts:
        for loop in part.faces:
            corners = part.vertices[list(loop)]
            assert np.linalg.svd(corners - corners.mean(axis=0))[1][-1] < ROUND_OFF
    assert len(find_interfaces(Blocks.gather(names, ["free"] * 3, [1.0] * 3, closed))) == 2


def test_what_would_vanish_far_from_the_origin_is_told_where_the_scene_has_it() -> None:
    far = 1e6
    low_high = {"sheet": (1.0, 1.001), "below": (0.0, 1.004), "above": (0.997, 2.0)}
    shapes = [prism([(far, low), (far + 1.0, low), (far + 1.0, high), (far, high)], (0.0, 0.4)) for low, high in low_high.values()]
    with pytest.raises(SceneError, match=r"near x = 1e\+06 m and z = 1 m"):
        close_joints(list(low_high), shapes, 0.004, np.zeros(3))


@pytest.mark.parametrize("first", range(6))
@pytest.mark.parametrize(("side", "width"), [(1.0, 0.4), (-1.0, 0.4), (1.0, 0.6), (-1.0, 0.6)])
def test_a_notch_closes_on_what_stands_in_it_wherever_its_outline_begins(first: int, side: float, width: float) -> None:
    """The sides of cuts lie along edges of the outline, too, and run the other way."""
    corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (width, 0.5), (width, 1.0), (0.0, 1.0)]
    stone = [(side * x, z) for x, z in [*corners[first:], *corners[:first]]]
    inner = [(side * x, z) for x, z in [(width + 0.002, 0.502), (1.0, 0.502), (1.0, 1.0), (width + 0.002, 1.0)]]
    closed, repairs = close_joints(["stone", "inner"], [prism(profile, (0.0, 0.4)) for profile in (stone, inner)], 0.002, np.zeros(2))
    assert repairs.largest_move <= 0.002
    blocks = Blocks.gather(["stone", "inner"], ["free"] * 2, [1.0] * 2, closed)
    assert sorted(find_interfaces(blocks).area) == pytest.approx(sorted([0.5 * 0.4, (1.0 - width) * 0.4]), rel=5e-3)
    assert blocks.volume == pytest.approx([0.5 * (1.0 + width) * 0.4, 0.5 * (1.0 - width) * 0.4], rel=5e-3)


def test_what_moves_farther_than_allowed_does_not_move_as_a_whole() -> None:
    shape = prism([(0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (0.5, 0.5), (0.5, 1.0), (0.0, 1.0)], (0.0, 0.4))
    parts = Blocks.gather(["stone"], ["free"], [1.0], [shape]).parts
    for push, moves in ((0.009, True), (0.011, False)):
        offset = parts.face_offset + np.where(parts.face_normal[:, 2] < -0.5, push, 0.0)  # the bed alone
        assert (moved_outline(shape, parts.face_normal, offset, 0.01) is not None) is moves


def test_an_outline_leans_and_turns_with_its_shape() -> None:
    profile = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (0.5, 0.5), (0.5, 1.0), (0.0, 1.0)]
    shape = turned(leaning(profile, (0.0, 0.4), (0.05, 0.38), (0.0, 1.0)), (0.3, 0.2, 0.0), 30.0)
    assert shape.outline is not None
    distance = np.linalg.norm(shape.outline.reshape(-1, 1, 3) - shape.vertices[None], axis=2)
    assert distance.min(axis=1) == pytest.approx(0.0, abs=ROUND_OFF)
