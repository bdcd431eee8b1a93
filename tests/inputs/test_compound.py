"""Blocks that are not convex: their division into convex parts, their mass, their joints and their reactions."""

import itertools

import numpy as np
import pytest
import scenes
import shapely
from hypothesis import given
from hypothesis import strategies as st

from la_core.analysis.stage import analyse
from la_core.errors import SceneError
from la_core.geometry import find_interfaces
from la_core.geometry.division import convex_parts
from la_core.geometry.shapes import divided_loft, prism
from la_core.limit.problem import Drive

ROUND_OFF = 1e-9
CORNER = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]  # an L
NOTCHED = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.9, 0.6], [1.0, 0.7], [1.0, 1.0], [0.0, 1.0]]
TEE = [[1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [3.0, 1.0], [3.0, 2.0], [0.0, 2.0], [0.0, 1.0], [1.0, 1.0]]


def is_divided(profile: np.ndarray) -> int:
    """Check that the parts are convex, do not overlap and fill the profile; return their number."""
    parts = [shapely.Polygon(part) for part in convex_parts(profile)]
    area = shapely.area(shapely.Polygon(profile))
    assert sum(map(shapely.area, parts)) == pytest.approx(area, rel=ROUND_OFF)
    assert all(shapely.area(shapely.convex_hull(part)) - shapely.area(part) <= ROUND_OFF * area for part in parts)
    assert all(shapely.area(shapely.intersection(*pair)) <= ROUND_OFF * area for pair in itertools.combinations(parts, 2))
    return len(parts)


@pytest.mark.parametrize(("profile", "count"), [(CORNER, 2), (NOTCHED, 2), (TEE, 2), ([[0, 0], [1, 0], [1, 1], [0, 1]], 1)])
def test_a_profile_is_divided_by_as_few_cuts_as_it_has_inward_corners_in_line(profile: list[list[float]], count: int) -> None:
    assert is_divided(np.array(profile, dtype=float)) == count


@pytest.mark.parametrize("mirrored", [False, True])
def test_inward_corners_that_are_all_but_level_leave_no_sliver(mirrored: bool) -> None:
    """In a survey, two such corners are never exactly level. A cut from one to the other would require a second cut beside it."""
    ears = np.array([[0.4, 0.0], [0.6, 0.0], [0.6, 0.15], [0.65, 0.15], [0.65, 0.3], [0.35, 0.3], [0.35, 0.151], [0.4, 0.151]])
    ears = ([1.0, 0.0] + [-1.0, 1.0] * ears)[::-1] if mirrored else ears
    assert sorted(shapely.area(shapely.Polygon(part)) for part in convex_parts(ears)) == pytest.approx([0.00745, 0.0075, 0.06])


@given(st.lists(st.floats(0.2, 1.0), min_size=5, max_size=24), st.floats(0.0, 6.0))
def test_any_star_is_divided_into_convex_parts(radii: list[float], turn: float) -> None:
    angle = turn + np.linspace(0.0, 2.0 * np.pi, len(radii), endpoint=False)
    profile = np.array(radii)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    assert is_divided(profile) <= len(radii)


def test_a_concave_arc_is_divided() -> None:
    angle = np.linspace(0.0, np.pi / 3.0, 9)
    inner = np.column_stack([np.cos(angle), np.sin(angle)])
    assert is_divided(np.concatenate([1.4 * inner, inner[::-1]])) <= 9


@pytest.mark.parametrize("profile", [CORNER, CORNER[::-1], NOTCHED, TEE])
def test_mass_and_inertia_are_those_of_the_profile(profile: list[list[float]]) -> None:
    scene = scenes.build(*scenes.base(1.5, 3.0), scenes.block("stone", prism=(profile, [0.0, 1.0])))
    blocks = scene.blocks
    polygon = shapely.Polygon(profile)
    centre = polygon.centroid
    assert blocks.volume[2] == pytest.approx(polygon.area, rel=ROUND_OFF)
    assert blocks.centroid[2] == pytest.approx([centre.x, 0.5, centre.y], abs=ROUND_OFF)
    assert blocks.inertia[2, 1, 1] / blocks.density[2] == pytest.approx(polar(polygon, (centre.x, centre.y)), rel=ROUND_OFF)
    assert int(np.sum(blocks.part_block == 2)) == 2


def polar(polygon: shapely.Polygon, centre: tuple[float, float]) -> float:
    """Second moment of area about an axis through `centre`, by the formula for the corners of a polygon."""
    x, z = (np.array(polygon.exterior.coords) - centre).T
    cross = x[:-1] * z[1:] - x[1:] * z[:-1]
    squares = x[:-1] ** 2 + x[:-1] * x[1:] + x[1:] ** 2 + z[:-1] ** 2 + z[:-1] * z[1:] + z[1:] ** 2
    return float(abs(np.sum(cross * squares)) / 12.0)


def test_a_face_that_is_cut_between_two_parts_has_one_joint() -> None:
    tall = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.3], [0.6, 0.3], [0.6, 2.0], [0.0, 2.0]]
    scene = scenes.build(*scenes.base(0.5, 1.0), scenes.block("stone", prism=(tall, [0.0, 1.0])))
    assert scene.blocks.is_compound.tolist() == [False, False, True]
    interfaces = find_interfaces(scene.blocks)
    assert list(zip(interfaces.block_a, interfaces.block_b, strict=True)) == [(0, 2), (1, 2)]
    assert interfaces.area == pytest.approx([0.5, 0.5])


def test_a_joint_that_is_not_convex_keeps_the_joints_of_all_its_parts() -> None:
    """An L-shaped stone lies against another stone. Each of its parts has a joint with it."""
    corner = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.3], [0.2, 0.3], [0.2, 1.0], [0.0, 1.0]]
    wall = scenes.block("wall", role="fixed", prism=([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], [0.2, 0.4]))
    scene = scenes.build(scenes.block("corner", prism=(corner, [0.0, 0.2])), wall, live=(1.0, 0.0, 0.0))
    assert sorted(find_interfaces(scene.blocks).area) == pytest.approx([0.14, 0.3])


def test_two_blocks_that_meet_in_two_places_of_one_plane_have_one_joint_in_each() -> None:
    arch = [[0.0, 0.0], [0.4, 0.0], [0.42, 0.15], [0.5, 0.2], [0.58, 0.15], [0.6, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    below = [[x, -z] for x, z in arch]  # extended chords of both profiles cut both feet
    scene = scenes.build(
        *(
            scenes.block(name, role=role, prism=(profile, [0.0, 1.0]))
            for name, role, profile in [("below", "support", below), ("stone", "free", arch)]
        ),
    )
    assert find_interfaces(scene.blocks).area == pytest.approx([0.4, 0.4])


@pytest.mark.parametrize("plane", [True, False])
@pytest.mark.parametrize("turned", [False, True])
def test_a_corner_block_is_carried_at_its_own_centroid(plane: bool, turned: bool) -> None:
    """The reaction follows from moments about the end of the fixed pad. The centroid of the L lies at 5/12 of its width."""
    place = (1.0 - 5.0 / 12.0) if turned else 5.0 / 12.0
    shape = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.5, 0.5], [0.5, 1.0], [0.0, 1.0]]
    profile = [[1.0 - x, z] for x, z in shape] if turned else shape
    scene = scenes.build(*scenes.base(0.4, 1.0), scenes.block("L", prism=(profile, [0.0, 1.0])), plane=plane)
    sharp = analyse(scene).sharp.bounds[Drive.YIELDING].value / scene.weight
    assert sharp == pytest.approx((place - 0.4) / (1.0 - 0.4), abs=1e-6)


def test_two_blocks_may_share_a_joint_on_each_side_of_a_step() -> None:
    lower = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.5, 0.5], [0.5, 1.0], [0.0, 1.0]]
    upper = [[0.5, 0.5], [1.0, 0.5], [1.0, 1.5], [0.0, 1.5], [0.0, 1.0], [0.5, 1.0]]
    parts = (scenes.block(name, prism=(profile, [0.0, 1.0])) for name, profile in (("lower", lower), ("upper", upper)))
    interfaces = find_interfaces(scenes.build(*scenes.base(0.5, 1.0), *parts).blocks)
    assert list(zip(interfaces.block_a, interfaces.block_b, strict=True)).count((2, 3)) == 3
    assert interfaces.area.sum() == pytest.approx(1.0 + 1.5)


def test_what_overlaps_a_notch_is_refused_and_what_lies_in_it_is_not() -> None:
    notch = [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [2.0, 2.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]
    parts = (*scenes.base(1.5, 3.0), scenes.block("notched", prism=(notch, [0.0, 1.0])))
    inside = scenes.build(*parts, scenes.box("key", (1.0, 0.0, 1.0), (2.0, 1.0, 2.0)))
    assert len(find_interfaces(inside.blocks)) == 2 + 3
    across = scenes.build(*parts, scenes.box("key", (0.9, 0.0, 1.0), (2.0, 1.0, 2.0)))
    with pytest.raises(SceneError, match='"notched" and "key": overlap'):
        find_interfaces(across.blocks)


def test_a_convex_profile_stays_one_part() -> None:
    assert prism([[0, 0], [1, 0], [1, 1], [0.5, 1.2], [0, 1]], (0.0, 1.0)).part_sizes == ()


def test_a_dart_that_no_cut_divides_is_refused_and_does_not_hang() -> None:
    dart = [
        (1.299063768816, 2.268321053095),
        (1.299954002477, 2.270142997107),
        (1.441756979275, 2.273290181889),
        (1.300719734863, 2.268378721248),
    ]
    with pytest.raises(ValueError, match="cannot be divided into convex parts"):
        prism(dart, (0.0, 0.4))


def test_a_body_is_divided_between_outlines_of_which_plane_cuts_are_possible() -> None:
    profile = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (0.4, 0.5), (0.5, 1.0), (0.0, 1.0)])
    front, back = (np.column_stack([profile[:, 0], np.full(6, y), profile[:, 1]]) for y in (0.0, 0.4))
    normal = np.array([0.0, -1.0, 0.0])
    sheared = back + 0.1 * back[:, 2:]  # still an affine image of the front
    assert len(divided_loft(front, sheared, normal).parts) == 2
    warped = back.copy()
    warped[3, 0] += 1e-4
    for one, other, told in (
        (front[::-1], back[::-1], "crosses"),
        (front[[0, 2, 1, 3, 4, 5]], back[[0, 2, 1, 3, 4, 5]], "crosses"),
        (front, warped, "not plane"),
    ):
        with pytest.raises(ValueError, match=told):
            divided_loft(one, other, normal)
