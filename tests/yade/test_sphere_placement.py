"""Contact spheres stay inside the blocks that carry them, also in sharp corners."""

from pathlib import Path

import numpy as np
import pytest
import rubble_walls as rubble
import scenes
from counted_rows import Counted
from scipy.spatial import ConvexHull

from la_core import exchange
from la_core.analysis.case_file import write_case
from la_core.analysis.stage import analyse
from la_core.geometry import Blocks, box
from la_core.scene.generators.placing import leaning
from yade_scripts import case, settings
from yade_scripts.contacts.convex_parts import are_within, faces_of_parts, parts_of
from yade_scripts.contacts.rows import rows_of
from yade_scripts.contacts.sphere_placement import depth_in_faces, hosts, largest_radius

LINEAR = 1.1  # most growth of the looks, over that of the row of blocks
SHARP = 7  # seed of a wall with a corner of 51 degrees


@pytest.mark.parametrize(
    ("boxes", "deeper", "host"),
    [
        ((True, False), "b", "b"),  # a box offers its face, however near an edge the point lies
        ((False, True), "a", "a"),
        ((True, True), "a", "b"),  # of two boxes or none, the block offers its face whose edges are farther from the point
        ((True, True), "b", "a"),
        ((False, False), "a", "b"),
        ((False, False), "b", "a"),
    ],
)
def test_the_sphere_lies_in_the_block_whose_face_is_the_worse_target(boxes: tuple[bool, bool], deeper: str, host: str) -> None:
    depth = np.array([[0.2, 0.1] if deeper == "a" else [0.1, 0.2]])
    assert hosts(np.array(boxes), np.array([0]), np.array([1]), depth).tolist() == ["ab".index(host)]


def test_spheres_keep_clear_of_the_other_faces_of_their_block(tmp_path: Path) -> None:
    """A sphere with a radius of half the inset reaches out of a corner of less than 53 degrees, and touches the next block."""
    scene = rubble.wall(rubble.shrunk(rubble.profiles(SHARP), 0.005))
    write_case(tmp_path / "case.h5", analyse(scene), "test")
    one = case.from_fields(exchange.read(tmp_path / "case.h5", exchange.CASE_FIELDS))
    radius = settings.derive(one).sphere_radius * one.own_inset / one.inset
    out = np.where((one.host == one.block_a)[:, None], one.normal, -one.normal)
    centre = one.position - radius[:, None] * out
    gaps = []  # between each sphere and the nearest of the other faces of its block, over its radius
    for host, middle, size, outward in zip(one.host, centre, radius, out, strict=True):
        planes = ConvexHull(one.vertices[host][:, [0, 2]]).equations  # outward normal and minus the offset of each edge
        others = planes[planes[:, :2] @ outward[[0, 2]] < 1.0 - 1e-6]
        gaps.append((-(others[:, :2] @ middle[[0, 2]] + others[:, 2]).max() - size) / size)
    assert min(gaps) >= 0.5 - 1e-6
    sharp = one.own_inset < 0.999 * one.inset
    assert 0 < sharp.sum() < 0.2 * len(sharp) and one.own_inset.min() > 0.5 * one.inset  # few joints end in a sharp corner


def test_faces_between_the_parts_of_a_stone_do_not_shrink_its_spheres(tmp_path: Path) -> None:
    """Parts of a stone around a curve meet in the planes of the curve's chords. The stone's contact points lie in these planes, too."""
    angles = np.linspace(np.pi, np.pi / 2.0, 7)
    arc = [[float(x), float(z)] for x, z in np.stack([1.0 + np.cos(angles), np.sin(angles)], axis=1)]
    around = scenes.block("around", prism=([[-0.5, 0.0], *arc, [1.0, 1.5], [-0.5, 1.5]], [0.0, 0.4]))
    within = scenes.block("within", prism=([*arc, [1.0, 0.0]], [0.0, 0.4]))
    scene = scenes.build(*scenes.base(0.2, 1.0, 0.4), around, within, inset=0.001)
    analysis = analyse(scene)
    write_case(tmp_path / "case.h5", analysis, "test")
    fields = (*exchange.CASE_FIELDS, *exchange.PART_FIELDS)
    one = case.from_fields(exchange.read(tmp_path / "case.h5", fields))
    assert len(one.parts[analysis.assembly.blocks.names.index("around")]) > 2
    assert one.own_inset.min() > 0.5 * one.inset


TEE = [[0.4, 0.0], [0.6, 0.0], [0.6, 0.5], [1.0, 0.5], [1.0, 0.8], [0.0, 0.8], [0.0, 0.5], [0.4, 0.5]]  # its stem meets its bar
FOOT = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.35], [0.4, 0.35], [0.4, 0.8], [0.0, 0.8]]  # its toe meets its leg


@pytest.mark.parametrize("profile", [TEE, FOOT])
@pytest.mark.parametrize(("foot", "head"), [((0.0, 0.4), (0.0, 0.4)), ((0.0, 0.4), (0.05, 0.3)), ((0.1, 0.2), (0.0, 0.4))])
def test_a_face_lies_within_its_stone_where_all_of_it_meets_other_parts(
    profile: list[list[float]], foot: tuple[float, float], head: tuple[float, float]
) -> None:
    """This holds in walls with leaning faces, too. Of two faces that meet, only the smaller one lies within."""
    blocks = Blocks.gather(["stone"], ["free"], [2000.0], [leaning(profile, foot, head, (0.0, 0.8))])
    data = {f"blocks/{name}": getattr(blocks, name) for name in ("vertices", "face_vertex", "face_start", "vertex_start")}
    data |= {"parts/block": blocks.part_block, "parts/face_start": blocks.part_face_start}
    (face,) = np.flatnonzero(are_within(data, (blocks.face_block, blocks.face_normal, blocks.face_offset)))
    corners = blocks.vertices[blocks.face_vertex[blocks.face_start[face] : blocks.face_start[face + 1]]]
    ends = ([0.4, 0.5], [0.6, 0.5]) if profile is TEE else ([0.4, 0.0], [0.4, 0.35])
    assert np.unique(corners[:, [0, 2]], axis=0) == pytest.approx(np.array(ends))


def test_a_plane_in_which_a_point_lies_to_rounding_does_not_shrink_its_sphere() -> None:
    """An inner corner of the stone has such a plane."""
    normal = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]])
    offset = np.array([1.0, 0.0, 1.0, 0.0, 0.25])
    point, down, block = np.array([[0.25, 0.0, 0.0]]), normal[3:4], np.zeros(1, dtype=int)
    alone, with_plane = (
        largest_radius(point, down, block, (np.zeros(count, dtype=int), normal[:count], offset[:count] + 1e-14), True) for count in (4, 5)
    )
    assert with_plane == pytest.approx(alone)


def test_rows_of_an_owner_are_those_that_a_look_at_all_rows_finds() -> None:
    owner = np.random.default_rng(5).choice([0, 2, 3, 7], 100)
    for count in (8, 11):
        assert [rows.tolist() for rows in rows_of(owner, count)] == [np.flatnonzero(owner == one).tolist() for one in range(count)]
    assert [rows.tolist() for rows in rows_of(np.zeros(0, dtype=int), 2)] == [[], []]


def test_a_row_of_four_times_the_blocks_takes_four_times_the_looks_at_the_blocks_of_points_and_faces() -> None:
    """Every block has one point in the middle of its top, which is 0.1 m from its nearest side."""
    looks = []
    for count in (10, 40):
        boxes = [box(np.array([one, 0.0, 0.0]), np.array([one + 0.8, 0.2, 0.3])) for one in np.arange(float(count))]
        blocks = Blocks.gather([str(one) for one in range(count)], ["free"] * count, [1.0] * count, boxes)
        middle, normal = blocks.centroid + np.array([0.0, 0.0, 0.15]), np.tile([0.0, 0.0, 1.0], (count, 1))
        index, owner, Counted.read = np.arange(count), Counted.of(blocks.face_block), 0
        depth = depth_in_faces(middle, normal, Counted.of(index), (owner, blocks.face_normal, blocks.face_offset), plane=False)
        assert depth == pytest.approx(0.1)
        data = {"parts/block": Counted.of(index), "parts/vertex_start": blocks.vertex_start, "parts/face_start": blocks.part_face_start}
        data |= {"blocks/role": blocks.role, "blocks/vertices": blocks.vertices}
        assert [len(parts) for parts in parts_of(data, index, ())] == [1] * count
        planes = faces_of_parts(data, index, (blocks.face_block, blocks.face_normal, blocks.face_offset))
        assert [[len(part) for part in parts] for parts in planes] == [[6]] * count
        looks.append(Counted.read)
    assert looks[1] < LINEAR * 4.0 * looks[0]
