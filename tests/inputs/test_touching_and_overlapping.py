"""Blocks that touch have a joint. Blocks that overlap or touch nothing are refused by name."""

import itertools
import math

import numpy as np
import pytest
import scenes
from gathered_blocks import gathered, turned
from scipy.spatial.transform import Rotation

from la_core.errors import SceneError
from la_core.geometry import interfaces
from la_core.geometry.blocks import Blocks
from la_core.geometry.interfaces import TOUCH, find_interfaces, nearest_gap
from la_core.geometry.shapes import Shape, box, polyhedron, prism
from la_core.model.assembly import assemble

# --- contacts and gaps -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("gap", "touches"), [(0.5 * TOUCH, True), (-0.5 * TOUCH, True), (5.0 * TOUCH, False)])
def test_gap_within_and_beyond_tolerance(gap, touches) -> None:
    blocks = gathered(box((0.0, 0.0, -1.0), (1.0, 1.0, 0.0)), box((0.0, 0.0, gap), (1.0, 1.0, 1.0)))
    if touches:
        assert len(find_interfaces(blocks)) == 1
    else:
        with pytest.raises(SceneError, match=r"touch(es)? nothing"):
            find_interfaces(blocks)


@pytest.mark.parametrize(("angle", "touches"), [(0.5 * TOUCH, True), (5.0 * TOUCH, False)])
def test_tilt_within_and_beyond_tolerance(angle, touches) -> None:
    """The gap opens to the angle times one metre at the far edge."""
    above = turned(box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), scenes.rotation((0.0, 1.0, 0.0), -angle))
    blocks = gathered(box((0.0, 0.0, -1.0), (1.0, 1.0, 0.0)), above)
    if touches:
        assert len(find_interfaces(blocks).polygon) == 4
    else:
        with pytest.raises(SceneError, match=r"touch(es)? nothing.*faces that do not fit each other; \[geometry\] tolerance fits"):
            find_interfaces(blocks)


@pytest.mark.parametrize("shift", [(1.0, 1.0, 0.0), (1.0, 0.0, 1.0), (1.0, 1.0, 1.0)], ids=["edge", "other edge", "corner"])
def test_edges_and_corners_are_no_interface(shift) -> None:
    low = np.array(shift)
    with pytest.raises(SceneError, match=r"touch(es)? nothing.*at most in an edge or a corner, which carries nothing"):
        find_interfaces(gathered(box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), box(low, low + 1.0)))


def test_diagonal_neighbours_in_a_stack_do_not_touch() -> None:
    blocks = [box((x, 0.0, z), (x + 1.0, 1.0, z + 1.0)) for x in (0.0, 1.0) for z in (0.0, 1.0)]
    interfaces = find_interfaces(gathered(*blocks))
    assert list(zip(interfaces.block_a, interfaces.block_b, strict=True)) == [(0, 1), (0, 2), (1, 3), (2, 3)]


def test_edge_on_a_face_is_no_interface() -> None:
    """A block that balances on its edge touches the other block only along a line."""
    roof = turned(box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), scenes.rotation((0.0, 1.0, 0.0), -math.pi / 4.0))
    with pytest.raises(SceneError, match=r"touch(es)? nothing"):
        find_interfaces(gathered(box((-1.0, 0.0, -1.0), (1.0, 1.0, 0.0)), roof))


ENOUGH_DIGITS = 5  # after the point, in metres: 10 micrometres is about TOUCH of these blocks of half a metre


@pytest.mark.parametrize("digits", [4, 5, 6, 7, 9, 15])
def test_boxes_typed_with_few_digits_share_the_interfaces_they_were_meant_to(digits: int) -> None:
    """The boxes are rotated and typed as polyhedra, with corners rounded as by a person or a spreadsheet."""
    turn = Rotation.from_rotvec([0.3, -0.2, 0.5])

    def typed(name: str, low: tuple[float, ...], high: tuple[float, ...], role: str = "free") -> str:
        corners = np.array(list(itertools.product(*zip(low, high, strict=True))))
        return scenes.block(name, role, polyhedron=np.round(turn.apply(corners), digits).tolist())

    pads = [typed("left", (0, 0, -0.1), (0.4, 0.2, 0), "fixed"), typed("right", (0.5, 0, -0.1), (1, 0.2, 0), "support")]
    scene = scenes.build(*pads, typed("block", (0, 0, 0), (1, 0.2, 0.5)), settlement=turn.apply([0, 0, -1]).tolist())
    if digits < ENOUGH_DIGITS:  # the faces no longer meet; this is reported, and half of an interface is never kept
        with pytest.raises(SceneError, match="overlap"):
            find_interfaces(scene.blocks)
        return
    interfaces = find_interfaces(scene.blocks)
    assert len(interfaces) == 2
    assert np.diff(interfaces.polygon_start).tolist() == [4, 4]


# --- overlaps ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("depth", [1e-3, 0.1, 0.5])
def test_overlap_is_refused_with_its_depth(depth) -> None:
    below, above = box((0.0, 0.0, -1.0), (1.0, 1.0, 0.0)), box((0.2, 0.2, -depth), (0.8, 0.8, 1.0))
    with pytest.raises(SceneError, match=f'blocks "a" and "b": overlap by about {depth:.3g} m') as refused:
        find_interfaces(gathered(below, above))
    assert ("[geometry] tolerance removes" in str(refused.value)) == (depth < 0.05)  # a deeper one is no error of coordinates


@pytest.mark.parametrize("high", [2.0, 4.0])
def test_block_inside_a_block_is_refused_and_may_be_meant_as_a_hole(high: float) -> None:
    around, inner = box((0.0, 0.0, 0.0), (3.0, 3.0, 3.0)), box((1.0, 1.0, 1.0), (2.0, 2.0, high))
    for pair in ((around, inner), (inner, around)):
        with pytest.raises(SceneError, match='blocks "a" and "b": overlap') as refused:
            find_interfaces(gathered(*pair))
        assert ("draw a hole within the outline of its block" in str(refused.value)) == (high < 3.0)


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
    """The shapes, each on its own pad on the side away from the others, so that no shape floats."""
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


def test_of_many_blocks_that_touch_nothing_ten_are_named_and_the_others_counted() -> None:
    base, stone = box((0.0, 0.0, -1.0), (1.0, 1.0, 0.0)), box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    apart = (box((2.0 * i, 0.0, 2.0), (2.0 * i + 1.0, 1.0, 3.0)) for i in range(12))
    with pytest.raises(SceneError, match=r'^blocks "c", .*, "l" and 2 more: touch nothing: '):
        find_interfaces(gathered(base, stone, *apart, held=1))


def test_gap_hint_names_the_nearest_block_and_the_distance() -> None:
    base, near, far = (box((x, 0.0, z), (x + 1.0, 1.0, z + 1.0)) for x, z in ((0.0, -1.0), (0.0, 0.0), (5.0, -1.0)))
    lone = box((1.25, 0.0, 0.0), (2.25, 1.0, 1.0))
    pad = box((5.0, 0.0, 0.0), (6.0, 1.0, 1.0))
    with pytest.raises(SceneError, match=r'block "e": touches nothing.*"[ab]" is nearest to "e", about 0.25 m away'):
        find_interfaces(gathered(base, near, far, pad, lone, held=1))


@pytest.mark.parametrize("gap", [0.0, 0.02, 0.2])
def test_gap_of_leaning_blocks_is_not_that_of_their_boxes(gap) -> None:
    """The bounding box of a stone above a slope overlaps that of the slope. The message said that both meet in an edge."""

    def leaning(low: float, high: float, bottom: float, top: float) -> Shape:
        corners = ((low, bottom), (high, bottom), (high, top), (low, top))
        return prism([(0.8 * u - 0.6 * v, 0.6 * u + 0.8 * v) for u, v in corners], (0.0, 1.0))

    blocks = gathered(leaning(-1.0, 1.0, -0.5, 0.0), leaning(-0.3, 0.3, gap, gap + 0.4), box((2.0, 0.0, 0.0), (3.0, 1.0, 1.0)), held=1)
    told = nearest_gap(blocks, np.array([1]), np.array([0, 2]))
    assert told.startswith('"a" is nearest to "b"' + (f", about {gap:g} m away" if gap else " and meets it"))


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


def test_of_many_overlaps_the_message_says_how_many_there_are_and_how_deep() -> None:
    """Each cube of a row overlaps the one before by 1 mm more. A tolerance must remove the deepest overlap, which is the last one."""
    start = np.cumsum([0.0, *(1.0 - 0.001 * depth for depth in range(1, 8))])
    row = [box((x, 0.0, 0.0), (x + 1.0, 1.0, 1.0)) for x in start]
    with pytest.raises(SceneError, match=r'so do "b" and "c" by 0\.002 m, .*"d" and "e" by 0\.004 m, and 3 others by up to 0\.007 m;'):
        find_interfaces(gathered(*row))


def test_where_not_all_overlaps_are_sought_the_message_says_at_least_how_many_there_are(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interfaces, "MOST_SOUGHT", 6)
    row = [box((0.9 * k, 0.0, 0.0), (0.9 * k + 1.0, 1.0, 1.0)) for k in range(8)]
    with pytest.raises(SceneError, match="and at least 2 others by up to"):
        find_interfaces(gathered(*row))
    with pytest.raises(SceneError, match="and 2 others by up to"):
        find_interfaces(gathered(*row[:-1]))
