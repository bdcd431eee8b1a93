"""Interfaces and contact points: how many, where, which way; what touches, what overlaps and what is apart."""

import itertools
import math

import numpy as np
import pytest
import scenes
from scipy.spatial.transform import Rotation

from la_core.errors import SceneError
from la_core.exchange.fields import FIXED, FREE
from la_core.geometry.blocks import Blocks
from la_core.geometry.interfaces import TOUCH, find_interfaces
from la_core.geometry.shapes import Shape, box, polyhedron, prism
from la_core.model.assembly import Assembly, assemble

EXACT = 1e-12  # m, on coordinates of order one: only sums and products of doubles
TURNED = 1e-9  # m, after a rotation and a convex hull


def gathered(*shapes: Shape, held: int = 0) -> Blocks:
    """Blocks named a, b, c...; the first `held` of them are fixed."""
    roles = ["fixed"] * held + ["free"] * (len(shapes) - held)
    return Blocks.gather([chr(97 + k) for k in range(len(shapes))], roles, [1.0] * len(shapes), shapes)


def turned(shape: Shape, turn: np.ndarray, about: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Shape:
    centre = np.array(about)
    return polyhedron((shape.vertices - centre) @ turn.T + centre)


def corners_of(points: np.ndarray) -> list[tuple[float, ...]]:
    return sorted(tuple(np.round(point, 9) + 0.0) for point in points)


def stacked(low: tuple[float, float], high: tuple[float, float], inset: float = 0.0) -> Assembly:
    """A unit cube on the plane z = 0 and on it a block with this footprint; both joints in 3D."""
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


# --- counts ------------------------------------------------------------------------------------------------------------------


def faces_of(blocks: Blocks, block: int) -> list[np.ndarray]:
    """Face polygons of one block, each (n, 3) in m."""
    faces = np.flatnonzero(blocks.face_block == block)
    return [blocks.vertices[blocks.face_vertex[blocks.face_start[f] : blocks.face_start[f + 1]]] for f in faces]


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
    """Contact search by nearest centroids loses these."""
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


# --- where and which way -----------------------------------------------------------------------------------------------------


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
    """Square on a square turned by 45 degrees: corners are crossings of edges, none is a vertex of either block."""
    turn = scenes.rotation((0.0, 0.0, 1.0), math.pi / 4.0)
    below, above = box((-0.5, -0.5, -1.0), (0.5, 0.5, 0.0)), turned(box((-0.5, -0.5, 0.0), (0.5, 0.5, 1.0)), turn)
    interfaces = find_interfaces(gathered(below, above))
    assert len(interfaces.polygon) == 8
    near = (math.sqrt(2.0) - 1.0) / 2.0
    assert sorted(np.abs(interfaces.polygon[:, :2]).max(axis=1)) == pytest.approx([0.5] * 8, abs=TURNED)
    assert sorted(np.abs(interfaces.polygon[:, :2]).min(axis=1)) == pytest.approx([near] * 8, abs=TURNED)
    assert interfaces.area == pytest.approx([2.0 * (math.sqrt(2.0) - 1.0)], abs=TURNED)


def test_inset_of_a_triangle_moves_its_edges_not_its_corners() -> None:
    """Mitred: every point keeps the inset as its distance from both edges that meet there."""
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
    """A profile with a vertex in the middle of its straight base, on a base with the same: still a rectangle."""
    base = prism([(0.0, -0.5), (2.0, -0.5), (2.0, 0.0), (1.0, 0.0), (0.0, 0.0)], (0.0, 1.0))
    above = prism([(0.0, 0.0), (0.5, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)], (0.0, 1.0))
    interfaces = find_interfaces(gathered(base, above))
    assert corners_of(interfaces.polygon) == [(0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (2.0, 0.0, 0.0), (2.0, 1.0, 0.0)]


def test_corners_that_nearly_coincide_are_one() -> None:
    """Footprints that differ by less than the tolerance share their corners; digits of typed coordinates differ like this."""
    slip = 0.2 * TOUCH
    below = box((0.0, 0.0, -1.0), (1.0, 1.0, 0.0))
    above = polyhedron([(x + slip * y, y - slip * x, z) for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
    assert len(find_interfaces(gathered(below, above)).polygon) == 4


def test_coplanar_triangles_of_a_hull_are_one_face() -> None:
    cube = polyhedron(box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)).vertices)
    assert sorted(len(face) for face in cube.faces) == [4] * 6
    hexagon = polyhedron([(math.cos(k * math.pi / 3.0), math.sin(k * math.pi / 3.0), z) for k in range(6) for z in (0.0, 1.0)])
    assert sorted(len(face) for face in hexagon.faces) == [4] * 6 + [6] * 2


# --- what touches, what does not ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("gap", "touches"), [(0.5 * TOUCH, True), (-0.5 * TOUCH, True), (5.0 * TOUCH, False)])
def test_gap_within_and_beyond_tolerance(gap, touches) -> None:
    blocks = gathered(box((0.0, 0.0, -1.0), (1.0, 1.0, 0.0)), box((0.0, 0.0, gap), (1.0, 1.0, 1.0)))
    if touches:
        assert len(find_interfaces(blocks)) == 1
    else:
        with pytest.raises(SceneError, match="touches nothing"):
            find_interfaces(blocks)


@pytest.mark.parametrize(("angle", "touches"), [(0.5 * TOUCH, True), (5.0 * TOUCH, False)])
def test_tilt_within_and_beyond_tolerance(angle, touches) -> None:
    """The gap opens to the angle times one metre at the far edge."""
    above = turned(box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), scenes.rotation((0.0, 1.0, 0.0), -angle))
    blocks = gathered(box((0.0, 0.0, -1.0), (1.0, 1.0, 0.0)), above)
    if touches:
        assert len(find_interfaces(blocks).polygon) == 4
    else:
        with pytest.raises(SceneError, match="touches nothing"):
            find_interfaces(blocks)


@pytest.mark.parametrize("shift", [(1.0, 1.0, 0.0), (1.0, 0.0, 1.0), (1.0, 1.0, 1.0)], ids=["edge", "other edge", "corner"])
def test_edges_and_corners_are_no_interface(shift) -> None:
    low = np.array(shift)
    with pytest.raises(SceneError, match="touches nothing"):
        find_interfaces(gathered(box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), box(low, low + 1.0)))


def test_diagonal_neighbours_in_a_stack_do_not_touch() -> None:
    blocks = [box((x, 0.0, z), (x + 1.0, 1.0, z + 1.0)) for x in (0.0, 1.0) for z in (0.0, 1.0)]
    interfaces = find_interfaces(gathered(*blocks))
    assert list(zip(interfaces.block_a, interfaces.block_b, strict=True)) == [(0, 1), (0, 2), (1, 3), (2, 3)]


def test_edge_on_a_face_is_no_interface() -> None:
    """A block that balances on its edge touches along a line only."""
    roof = turned(box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), scenes.rotation((0.0, 1.0, 0.0), -math.pi / 4.0))
    with pytest.raises(SceneError, match="touches nothing"):
        find_interfaces(gathered(box((-1.0, 0.0, -1.0), (1.0, 1.0, 0.0)), roof))


# --- overlaps ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("depth", [1e-3, 0.1, 0.5])
def test_overlap_is_refused_with_its_depth(depth) -> None:
    below, above = box((0.0, 0.0, -1.0), (1.0, 1.0, 0.0)), box((0.2, 0.2, -depth), (0.8, 0.8, 1.0))
    with pytest.raises(SceneError, match=f'blocks "a" and "b": overlap by about {depth:.3g} m'):
        find_interfaces(gathered(below, above))


def test_block_inside_a_block_is_refused() -> None:
    with pytest.raises(SceneError, match='blocks "a" and "b": overlap'):
        find_interfaces(gathered(box((0.0, 0.0, 0.0), (3.0, 3.0, 3.0)), box((1.0, 1.0, 1.0), (2.0, 2.0, 2.0))))


def test_same_block_twice_is_refused() -> None:
    cube = box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    with pytest.raises(SceneError, match="overlap"):
        find_interfaces(gathered(cube, cube))


def crossed_edges(distance: float) -> tuple[Shape, Shape]:
    """Two cubes edge to edge at right angles, `distance` apart: no face separates them, only a plane between the edges."""
    eighth = math.pi / 4.0
    low = turned(box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)), scenes.rotation((1.0, 0.0, 0.0), eighth))
    high = turned(box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)), scenes.rotation((0.0, 1.0, 0.0), eighth))
    lift = np.array([0.0, 0.0, 2.0 * math.sqrt(2.0) + distance])
    askew = scenes.rotation((0.3, -0.5, 0.8), 1.1)  # so that bounding boxes do not tell them apart
    return turned(low, askew), turned(Shape(high.vertices + lift, high.faces), askew)


def grounded(*shapes: Shape) -> Blocks:
    """The shapes, each on a pad of its own on the side away from the others, so that none of them floats."""
    pads, middle = [], np.mean([shape.vertices.mean(axis=0) for shape in shapes], axis=0)
    for shape in shapes:
        faces = [shape.vertices[list(face)] for face in shape.faces]
        face = max(faces, key=lambda corners: float(np.linalg.norm(corners.mean(axis=0) - middle)))
        outward = face.mean(axis=0) - shape.vertices.mean(axis=0)
        outward /= np.linalg.norm(outward)
        pads.append(polyhedron(np.concatenate([face + s * outward for s in (0.0, 0.1)])))
    return gathered(*pads, *shapes, held=len(pads))


def test_edge_to_edge_boxes_apart_are_not_an_overlap() -> None:
    blocks = grounded(*crossed_edges(0.01))
    assert (blocks.low[3] < blocks.high[2]).all() and (blocks.low[2] < blocks.high[3]).all()
    interfaces = find_interfaces(blocks)
    assert list(zip(interfaces.block_a, interfaces.block_b, strict=True)) == [(0, 2), (1, 3)]


def test_edge_to_edge_boxes_pushed_together_are_an_overlap() -> None:
    with pytest.raises(SceneError, match='blocks "c" and "d": overlap'):
        find_interfaces(grounded(*crossed_edges(-0.05)))


# --- complaints --------------------------------------------------------------------------------------------------------------


def test_gap_hint_names_the_nearest_block_and_the_distance() -> None:
    base, near, far = (box((x, 0.0, z), (x + 1.0, 1.0, z + 1.0)) for x, z in ((0.0, -1.0), (0.0, 0.0), (5.0, -1.0)))
    lone = box((1.25, 0.0, 0.0), (2.25, 1.0, 1.0))
    pad = box((5.0, 0.0, 0.0), (6.0, 1.0, 1.0))
    with pytest.raises(SceneError, match=r'block "e": touches nothing.*"[ab]" is nearest to "e", about 0.25 m away'):
        find_interfaces(gathered(base, near, far, pad, lone, held=1))


@pytest.mark.parametrize("inset", [0.05, 0.06])
@pytest.mark.parametrize("plane", [True, False])
def test_inset_larger_than_an_interface_names_the_pair(inset, plane) -> None:
    parts = (
        scenes.box("base", (0.0, 0.0, -0.5), (1.0, 1.0, 0.0), "fixed"),
        scenes.box("post", (0.0, 0.0, 0.0), (0.1, 1.0, 1.0)),
        scenes.box("pier", (0.2, 0.0, 0.0), (1.0, 1.0, 1.0)),
    )
    rule = f'joint.inset = {inset}: larger than half the interface between "base" and "post", .*; take less than 0.05 m'
    with pytest.raises(SceneError, match=rule):
        assemble(scenes.build(*parts, inset=inset, live=(1.0, 0.0, 0.0), plane=plane))
    assemble(scenes.build(*parts, inset=0.04999, live=(1.0, 0.0, 0.0), plane=plane))


# --- blocks themselves -------------------------------------------------------------------------------------------------------


def test_mass_properties_of_known_solids() -> None:
    blocks = gathered(
        box((1.0, 2.0, 3.0), (2.0, 4.0, 6.0)),
        prism([(0.0, 0.0), (3.0, 0.0), (0.0, 3.0)], (0.0, 2.0)),
        polyhedron([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]),
    )
    assert blocks.volume == pytest.approx([6.0, 9.0, 1.0 / 6.0], rel=EXACT)
    assert blocks.centroid == pytest.approx(np.array([(1.5, 3.0, 4.5), (1.0, 1.0, 1.0), (0.25, 0.25, 0.25)]), abs=EXACT)
    cuboid = np.diag([2.0**2 + 3.0**2, 1.0 + 3.0**2, 1.0 + 2.0**2]) * 6.0 / 12.0
    tetrahedron = np.full((3, 3), 1.0 / 480.0) + np.eye(3) * (1.0 / 80.0 - 1.0 / 480.0)  # of unit legs, about its centroid
    assert blocks.inertia[0] == pytest.approx(cuboid, abs=1e-11)
    assert blocks.inertia[2] == pytest.approx(tetrahedron, abs=EXACT)


@pytest.mark.parametrize("turn", [None, scenes.rotation((0.3, -0.5, 0.8), 1.1)], ids=["upright", "turned"])
def test_faces_look_outward_and_close_the_block(turn) -> None:
    shape = prism([(0.0, 0.0), (0.0, 1.0), (1.0, 1.5), (2.0, 0.0)], (-1.0, 2.0))  # clockwise on purpose
    blocks = gathered(shape if turn is None else turned(shape, turn))
    middles = np.array([face.mean(axis=0) for face in faces_of(blocks, 0)])
    assert (np.sum((middles - blocks.centroid[0]) * blocks.face_normal, axis=1) > 0.0).all()
    areas = [np.linalg.norm(sum(np.cross(f[k] - f[0], f[k + 1] - f[0]) for k in range(1, len(f) - 1))) / 2.0 for f in faces_of(blocks, 0)]
    assert np.array(areas) @ blocks.face_normal == pytest.approx(np.zeros(3), abs=TURNED)


ENOUGH_DIGITS = 5  # after the point, in metres: 10 micrometres is about TOUCH of these blocks of half a metre


@pytest.mark.parametrize("digits", [4, 5, 6, 7, 9, 15])
def test_boxes_typed_with_few_digits_share_the_interfaces_they_were_meant_to(digits: int) -> None:
    """Rotated boxes as polyhedra, their corners rounded as a person or a spreadsheet would."""
    turn = Rotation.from_rotvec([0.3, -0.2, 0.5])

    def typed(name: str, low: tuple[float, ...], high: tuple[float, ...], role: str = "free") -> str:
        corners = np.array(list(itertools.product(*zip(low, high, strict=True))))
        return scenes.block(name, role, polyhedron=np.round(turn.apply(corners), digits).tolist())

    pads = [typed("left", (0, 0, -0.1), (0.4, 0.2, 0), "fixed"), typed("right", (0.5, 0, -0.1), (1, 0.2, 0), "support")]
    scene = scenes.build(*pads, typed("block", (0, 0, 0), (1, 0.2, 0.5)), settlement=turn.apply([0, 0, -1]).tolist())
    if digits < ENOUGH_DIGITS:  # the faces no longer meet; that is said, and never half of an interface kept
        with pytest.raises(SceneError, match="overlap"):
            find_interfaces(scene.blocks)
        return
    interfaces = find_interfaces(scene.blocks)
    assert len(interfaces) == 2
    assert np.diff(interfaces.polygon_start).tolist() == [4, 4]
