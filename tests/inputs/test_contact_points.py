"""Joints and contact points have the number, places and normals of counts by hand, and no contact point is redundant."""

import math

import numpy as np
import pytest
import scenes
from gathered_blocks import EXACT, TURNED, gathered, turned

from la_core.exchange.fields import FIXED, FREE
from la_core.geometry.interfaces import TOUCH, find_interfaces
from la_core.geometry.shapes import box, polyhedron, prism
from la_core.model.assembly import Assembly, assemble


def corners_of(points: np.ndarray) -> list[tuple[float, ...]]:
    return sorted(tuple(np.round(point, 9) + 0.0) for point in points)


def stacked(low: tuple[float, float], high: tuple[float, float], inset: float = 0.0) -> Assembly:
    """A unit cube on the plane z = 0, and a block with this footprint on the cube; both joints are in 3D."""
    return assemble(
        scenes.build(
            scenes.box("base", (0.0, 0.0, -0.5), (1.0, 1.0, 0.0), "fixed"),
            scenes.box("below", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
            scenes.box("above", (*low, 1.0), (*high, 2.0)),
            inset=inset,
            live=(1.0, 0.0, 0.0),
            plane=False,
        )
    )


def upper_points(assembly: Assembly) -> np.ndarray:
    return assembly.points.position[assembly.points.position[:, 2] > 0.5]


def test_some_of_the_joints_keep_their_own_outlines() -> None:
    """A selection of joints with three and with four corners keeps their outlines."""
    gable = [scenes.block(f"gable {k}", prism=([[0.0, 0.0], [1.0, 0.0], [0.5, 0.4]], (0.5 * k, 0.5 * (k + 1)))) for k in range(3)]
    joints = find_interfaces(scenes.build(*scenes.base(0.5, 1.0, 1.5), *gable, plane=False).blocks)
    sides = np.diff(joints.polygon_start)
    assert {3, 4} <= set(sides.tolist())
    for kept in (sides == 3, sides == 4, np.arange(len(joints)) % 2 == 1):
        some = joints.subset(kept)
        for row, number in enumerate(np.flatnonzero(kept)):
            own = joints.polygon[joints.polygon_start[number] : joints.polygon_start[number + 1]]
            np.testing.assert_array_equal(some.polygon[some.polygon_start[row] : some.polygon_start[row + 1]], own)


# --- counts ------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("plane", "per_joint"), [(True, 2), (False, 4)])
@pytest.mark.parametrize(("per_course", "courses"), [(2, 2), (5, 4), (6, 10)])
def test_running_bond_has_the_joints_one_counts_on_paper(per_course, courses, plane, per_joint) -> None:
    assembly = assemble(scenes.build(*scenes.wall(per_course, courses), live=(1.0, 0.0, 0.0), plane=plane))
    even, odd = (courses + 1) // 2, courses // 2
    head = even * (per_course - 1) + odd * per_course
    bed = per_course + (courses - 1) * 2 * per_course
    assert len(assembly.interfaces) == head + bed
    assert len(assembly.points) == per_joint * (head + bed)
    assert assembly.blocks.free.sum() == even * per_course + odd * (per_course + 1)


def test_long_foundation_block_touches_every_block_above() -> None:
    """A contact search by nearest centroids would lose these joints."""
    count = 200
    above = [box((k * 0.1, 0.0, 0.0), ((k + 1) * 0.1, 0.3, 0.1)) for k in range(count)]
    interfaces = find_interfaces(gathered(box((0.0, 0.0, -0.2), (count * 0.1, 0.3, 0.0)), *above, held=1))
    on_base = interfaces.block_a == 0
    assert on_base.sum() == count and (~on_base).sum() == count - 1
    assert sorted(interfaces.block_b[on_base]) == list(range(1, count + 1))


def test_held_blocks_have_no_contact_between_them() -> None:
    parts = scenes.base(1.0, 2.0)
    assembly = assemble(scenes.build(*parts, scenes.box("block", (0.5, 0.0, 0.0), (1.5, 1.0, 1.0))))
    assert len(assembly.interfaces) == 2
    roles = assembly.blocks.role[np.stack([assembly.interfaces.block_a, assembly.interfaces.block_b], axis=1)]
    assert (roles == FREE).any(axis=1).all() and (roles[:, 0] >= FREE).all()
    assert FIXED in roles


# --- places and normals ------------------------------------------------------------------------------------------------------


def test_normals_point_from_the_lower_to_the_higher_index() -> None:
    middle = box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    around = {
        (1.0, 0.0, 0.0): box((1.0, 0.2, 0.2), (2.0, 0.8, 0.8)),
        (-1.0, 0.0, 0.0): box((-1.0, 0.2, 0.2), (0.0, 0.8, 0.8)),
        (0.0, 1.0, 0.0): box((0.2, 1.0, 0.2), (0.8, 2.0, 0.8)),
        (0.0, -1.0, 0.0): box((0.2, -1.0, 0.2), (0.8, 0.0, 0.8)),
        (0.0, 0.0, 1.0): box((0.2, 0.2, 1.0), (0.8, 0.8, 2.0)),
        (0.0, 0.0, -1.0): box((0.2, 0.2, -1.0), (0.8, 0.8, 0.0)),
    }
    interfaces = find_interfaces(gathered(middle, *around.values()))
    assert interfaces.block_a.tolist() == [0] * 6 and interfaces.block_b.tolist() == [1, 2, 3, 4, 5, 6]
    assert interfaces.normal == pytest.approx(np.array(list(around)), abs=EXACT)
    assert interfaces.area == pytest.approx(np.full(6, 0.36), abs=EXACT)


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        ((0.0, 0.0), (1.0, 1.0), ((0.0, 0.0), (1.0, 1.0))),
        ((0.5, 0.0), (1.5, 1.0), ((0.5, 0.0), (1.0, 1.0))),
        ((0.7, 0.6), (2.0, 3.0), ((0.7, 0.6), (1.0, 1.0))),
        ((0.2, 0.3), (0.4, 0.5), ((0.2, 0.3), (0.4, 0.5))),
        ((-1.0, 0.4), (2.0, 0.6), ((0.0, 0.4), (1.0, 0.6))),
    ],
    ids=["full", "half", "corner", "inside", "crossed"],
)
@pytest.mark.parametrize("inset", [0.0, 0.001, 0.03])
def test_points_are_the_corners_of_the_overlap_drawn_in_by_the_inset(low, high, expected, inset) -> None:
    (x0, y0), (x1, y1) = expected
    drawn = [(x, y, 1.0) for x in (x0 + inset, x1 - inset) for y in (y0 + inset, y1 - inset)]
    assert corners_of(upper_points(stacked(low, high, inset))) == corners_of(np.array(drawn))


def test_blocks_crossed_askew_meet_in_an_octagon() -> None:
    """A square lies on a square turned by 45 degrees. All corners are crossings of edges, and none is a vertex of a block."""
    turn = scenes.rotation((0.0, 0.0, 1.0), math.pi / 4.0)
    below, above = box((-0.5, -0.5, -1.0), (0.5, 0.5, 0.0)), turned(box((-0.5, -0.5, 0.0), (0.5, 0.5, 1.0)), turn)
    interfaces = find_interfaces(gathered(below, above))
    assert len(interfaces.polygon) == 8
    near = (math.sqrt(2.0) - 1.0) / 2.0
    assert sorted(np.abs(interfaces.polygon[:, :2]).max(axis=1)) == pytest.approx([0.5] * 8, abs=TURNED)
    assert sorted(np.abs(interfaces.polygon[:, :2]).min(axis=1)) == pytest.approx([near] * 8, abs=TURNED)
    assert interfaces.area == pytest.approx([2.0 * (math.sqrt(2.0) - 1.0)], abs=TURNED)


def test_inset_of_a_triangle_moves_its_edges_not_its_corners() -> None:
    """Every contact point keeps the inset as its distance from both edges that meet at its corner."""
    inset = 0.01
    scene = scenes.build(
        scenes.box("base", (-1.0, -1.0, -0.5), (2.0, 2.0, 0.0), "fixed"),
        scenes.block("wedge", polyhedron=[(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)]),
        inset=inset,
        live=(1.0, 0.0, 0.0),
    )
    points = assemble(scene).points.position
    far = 1.0 - inset * (1.0 + math.sqrt(2.0))
    assert corners_of(points) == corners_of(np.array([(inset, inset, 0.0), (far, inset, 0.0), (inset, far, 0.0)]))


def test_plane_points_lie_at_mid_depth() -> None:
    assembly = assemble(scenes.build(*scenes.wall(3, 2, block_size=(0.4, 0.3, 0.2)), inset=0.001, live=(1.0, 0.0, 0.0)))
    assert assembly.effects.plane
    assert assembly.points.position[:, 1] == pytest.approx(0.15, abs=EXACT)
    base_points = assembly.points.position[np.abs(assembly.points.position[:, 2]) < EXACT]
    assert sorted(base_points[:, 0]) == pytest.approx([0.001, 0.399, 0.401, 0.799, 0.801, 1.199], abs=EXACT)


@pytest.mark.parametrize("axis", [(0.3, -0.5, 0.8), (1.0, 1.0, 1.0), (0.0, 0.0, 1.0)])
@pytest.mark.parametrize("inset", [0.0, 0.002])
def test_contacts_turn_with_the_blocks(axis, inset) -> None:
    text = scenes.text(*scenes.wall(3, 4, split=0.8), inset=inset, plane=False)
    scene = scenes.load(text)
    turn, shift = scenes.rotation(axis, 1.234), np.array([10.0, -4.0, 2.0])
    still, moved = assemble(scene), assemble(scenes.moved(scene, turn, shift=shift, plane=False))
    assert moved.interfaces.block_a.tolist() == still.interfaces.block_a.tolist()
    assert moved.interfaces.block_b.tolist() == still.interfaces.block_b.tolist()
    assert moved.interfaces.normal == pytest.approx(still.interfaces.normal @ turn.T, abs=TURNED)
    assert moved.interfaces.area == pytest.approx(still.interfaces.area, abs=TURNED)
    expected = corners_of(still.points.position)
    back = corners_of((moved.points.position - shift) @ turn)
    assert np.array(back) == pytest.approx(np.array(expected), abs=TURNED)


# --- no redundant points -----------------------------------------------------------------------------------------------------


def test_vertices_on_an_edge_give_no_points() -> None:
    """Both profiles have a vertex in the middle of their common straight edge. The joint is still a rectangle."""
    base = prism([(0.0, -0.5), (2.0, -0.5), (2.0, 0.0), (1.0, 0.0), (0.0, 0.0)], (0.0, 1.0))
    above = prism([(0.0, 0.0), (0.5, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)], (0.0, 1.0))
    interfaces = find_interfaces(gathered(base, above))
    assert corners_of(interfaces.polygon) == [(0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (2.0, 0.0, 0.0), (2.0, 1.0, 0.0)]


def test_corners_that_nearly_coincide_are_one() -> None:
    """Footprints that differ by less than the tolerance share their corners. Typed coordinates differ in this way in their last digits."""
    slip = 0.2 * TOUCH
    below = box((0.0, 0.0, -1.0), (1.0, 1.0, 0.0))
    above = polyhedron([(x + slip * y, y - slip * x, z) for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
    assert len(find_interfaces(gathered(below, above)).polygon) == 4
