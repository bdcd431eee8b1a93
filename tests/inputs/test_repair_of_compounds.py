"""The tolerance of the geometry for blocks that are not convex: their outline moves as a whole and is then divided."""

from itertools import pairwise

import numpy as np
import pytest
import scenes

from la_core.errors import SceneError
from la_core.geometry import Blocks, find_interfaces, prism
from la_core.repair import close_joints
from la_core.repair.closing import _refuse_far
from la_core.repair.outline_motion import _faces_of_edges, _sides, moved_outline
from la_core.scene import Scene
from la_core.scene.generators.placing import leaning, turned

ROUND_OFF = 1e-9


@pytest.mark.parametrize("mirrored", [False, True])
def test_of_two_edges_on_one_line_each_has_the_face_that_lies_along_it(mirrored: bool) -> None:
    """Three feet of one stone stand on one line, and their faces may move apart."""
    feet = [[x, z] for x in (0.0, 0.4, 0.8) for x, z in ((x, 0.4), (x, 0.0), (x + 0.2, 0.0), (x + 0.2, 0.4))]
    profile = np.array([*feet[1:-1], [1.0, 0.8], [0.0, 0.8]])
    shape = prism((profile * ([1.0, -1.0] if mirrored else [1.0, 1.0])).tolist(), (0.0, 1.0))
    assert shape.outline is not None
    corners = shape.outline[0]
    faces, sides = _faces_of_edges(shape, corners), {number: ends for number, *ends in _sides(shape)}
    assert faces is not None
    for face, first, last in zip(faces.tolist(), corners, np.roll(corners, -1, axis=0), strict=True):
        low = np.maximum(np.minimum(first, last), np.minimum(*sides[face]))
        high = np.minimum(np.maximum(first, last), np.maximum(*sides[face]))
        assert np.all(high >= low) and np.linalg.norm(high - low) > 0.1  # overlap of edge and side, which are parallel to the axes


@pytest.mark.parametrize("height", [0.9, 1.1])
def test_a_surface_that_would_move_too_far_is_refused_with_the_way_that_it_would_move(height: float) -> None:
    """The top of a cube of 1 m sinks or rises by 0.1 m."""
    blocks = scenes.build(*scenes.base(0.5, 1.0), scenes.box("cube", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))).blocks
    is_top = blocks.vertices[:, 2] == 1.0
    assert is_top.sum() == 4
    moved = np.where(is_top[:, None], [1.0, 1.0, height], 1.0) * blocks.vertices
    offset = np.where((blocks.face_normal[:, 2] > 0.5) & (blocks.face_offset > 0.5), height, blocks.face_offset)
    with pytest.raises(SceneError, match=r"would have to move 0\.1 m to close its joints, more than 0\.05 m"):
        _refuse_far(blocks, moved, blocks.face_normal, offset, 0.05, np.zeros(3))
    _refuse_far(blocks, moved, blocks.face_normal, offset, 0.15, np.zeros(3))


def test_a_dent_within_the_tolerance_makes_no_second_part() -> None:
    dented = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.5, 0.497], [0.0, 0.5]]
    parts = (*scenes.base(0.5, 1.0), scenes.block("a", prism=(dented, (0.0, 1.0))))
    compound, plain = scenes.build(*parts), scenes.build(*parts, scenes.table("geometry", tolerance=0.004))
    assert compound.blocks.is_compound[-1] and not plain.blocks.is_compound.any()
    assert plain.blocks.volume[-1] == pytest.approx(0.5, abs=1e-6)


def test_a_part_thinner_than_its_errors_may_vanish() -> None:
    """A step of 2 mm divides both stones. A part that is thinner than the errors of its faces may vanish."""
    step = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.7, 0.5], [0.7, 0.502], [0.0, 0.502]]
    above = [[0.0, 0.502], [0.7, 0.502], [0.7, 0.5], [1.0, 0.5], [1.0, 1.0], [0.0, 1.0]]
    parts = (scenes.block("a", prism=(step, (0.0, 1.0))), scenes.block("b", prism=(above, (0.0, 1.0))))
    scene = scenes.build(*scenes.base(0.5, 1.0), *parts, scenes.table("geometry", tolerance=0.0012))
    assert ("a", "b") in scenes.joints(scene) and scene.blocks.volume[-2:].sum() == pytest.approx(1.0, rel=2e-3)


@pytest.mark.parametrize("gap", [0.0, 0.002])
def test_stones_that_lean_and_are_not_convex_close_their_joints_too(gap: float) -> None:
    """Front and back of both stones lean, and both are turned in plan. The cut through the first ends within its outline on both sides."""
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
    """The cut through such a stone is nearly level with its steps, so its parts, moved separately, would slide far along it."""
    true, survey = joggled_arch(0.0, 0, 0.001), joggled_arch(0.003, seed, 0.006)
    assert scenes.joints(survey) == scenes.joints(true)
    assert len(scenes.joints(true)) == 2 + 4 * 3
    assert not survey.repairs.unclosed
    assert survey.weight == pytest.approx(true.weight, rel=0.02)


@pytest.mark.parametrize(("dip", "x"), [(0.0028, 0.0), (0.003, 0.0), (0.003, 1e6), (0.0032, 0.0)])
def test_where_one_of_two_nearly_level_faces_moves_the_corner_between_them_becomes_a_step(dip: float, x: float) -> None:
    """The left half of an L's bed closes a gap of 2 mm to a pad; the right half is free. Their planes meet 0.05 m beside the corner."""
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
    """The stone's end faces turn halfway to the neighbours. Its back is then no copy of its front, and a cut between them is warped."""
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
    far = 1234567.25
    low_high = {"sheet": (1.0, 1.001), "below": (0.0, 1.004), "above": (0.997, 2.0)}
    shapes = [prism([(far, low), (far + 1.0, low), (far + 1.0, high), (far, high)], (0.0, 0.4)) for low, high in low_high.values()]
    with pytest.raises(SceneError, match=r"near \(x, z\) = \(1234567\.75, 1\) m"):
        close_joints(list(low_high), shapes, 0.004, np.zeros(3))


@pytest.mark.parametrize("first", range(6))
@pytest.mark.parametrize(("side", "width"), [(1.0, 0.4), (-1.0, 0.4), (1.0, 0.6), (-1.0, 0.6)])
def test_a_notch_closes_on_what_stands_in_it_wherever_its_outline_begins(first: int, side: float, width: float) -> None:
    """Sides of cuts may lie along edges of the outline, too, and run the other way."""
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
