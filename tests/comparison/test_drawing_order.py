"""Nearer blocks are drawn over those behind them, and points inside a wall are hidden."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from counted_rows import Counted
from figure_scenes import DOWN, SCENES, scene_of
from matplotlib.collections import LineCollection
from scenes import load, shipped

from comparison.figures import canvas as drawing
from comparison.figures import structure
from comparison.figures.drawing_order import are_behind, back_to_front
from la_core.analysis.stage import analyse
from la_core.geometry import Blocks, box, prism
from la_core.model.assembly import assemble
from la_core.scene.shipped import starter_text

LINEAR = 1.1  # largest growth of the looks at faces, over the growth of the wall


def test_nearer_blocks_are_drawn_over_those_they_rest_on(tmp_path: Path) -> None:
    analysis = analyse(scene_of(tmp_path, SCENES["solid"]))
    canvas = drawing.canvases(structure.Figure(), analysis.assembly, 1)[0]
    # Seen from above, the block hides its pads, although its centroid is not nearer than the right pad's.
    assert list(canvas.order).index(2) == 2


def test_points_inside_a_thick_wall_are_hidden(tmp_path: Path) -> None:
    wall = """
[[wall]]
bond = "stack"
origin = [0.0, 0.0, 0.0]
block = [0.5, 0.5, 0.5]
per_course = 5
courses = 5
[[wall]]
name = "behind"
bond = "stack"
origin = [0.0, 0.5, 0.0]
block = [0.5, 0.5, 0.5]
per_course = 5
courses = 5
[[block]]
name = "ground"
role = "fixed"
box = { from = [0.0, 0.0, -0.5], to = [1.5, 1.0, 0.0] }
[[block]]
name = "yields"
role = "support"
box = { from = [1.5, 0.0, -0.5], to = [2.5, 1.0, 0.0] }
"""
    analysis = analyse(scene_of(tmp_path, wall + DOWN + "[effects]\nplane = false\n"))
    canvas = drawing.canvases(structure.Figure(), analysis.assembly, 1)[0]
    assert list(canvas.seen(np.array([[1.0, 0.001, 1.0], [1.0, 0.5, 1.0], [2.499, 0.5, 1.0], [1.0, 0.999, 1.0]]))) == [
        True,
        False,
        True,
        False,
    ]


def plainly_behind(parts: Blocks, toward: np.ndarray, points: np.ndarray, least: float) -> np.ndarray:
    """Return a mask of the points behind more than `least`, m, of a part; all faces of all parts cut the line to the viewer."""
    along = parts.face_normal @ toward
    hidden = np.zeros(len(points), dtype=bool)
    for k, point in enumerate(points):
        for part in range(len(parts)):
            faces = parts.face_block == part
            inside = parts.face_offset[faces] - parts.face_normal[faces] @ point
            towards, away, beside = along[faces] > 1e-9, along[faces] < -1e-9, np.abs(along[faces]) <= 1e-9
            enter = (inside[away] / along[faces][away]).max(initial=0.0)
            leave = (inside[towards] / along[faces][towards]).min(initial=np.inf)
            hidden[k] |= bool(leave - enter > least and not (inside[beside] < 0.0).any())
    return hidden


@pytest.mark.parametrize("name", ["dome_sector", "corner_settling_end", "arch_spreading"])
@pytest.mark.parametrize("plane", [True, False], ids=["from the front", "aslant"])
def test_points_are_behind_the_parts_that_a_look_at_all_of_them_finds(name: str, plane: bool) -> None:
    blocks = shipped(name).blocks
    view, low, high = np.stack(drawing.view_axes(plane)), blocks.low.min(axis=0), blocks.high.max(axis=0)
    points = np.concatenate([np.random.default_rng(3).uniform(low - 0.1, high + 0.1, (150, 3)), blocks.centroid[::10]])
    for least in (0.0, drawing.HIDING * drawing.structure_size(blocks)):
        found = are_behind(blocks.parts, view, points, least)
        assert found.tolist() == plainly_behind(blocks.parts, view[2], points, least).tolist()
        assert 0 < found.sum() < len(points)
    assert are_behind(blocks.parts, view, points[:0], 0.0).tolist() == []


def test_points_of_a_wall_four_times_as_long_take_four_times_the_looks_at_faces() -> None:
    looks = []
    for length in (20, 80):
        place = np.stack(np.meshgrid(np.arange(length), np.arange(6), indexing="ij"), axis=-1).reshape(-1, 2)
        boxes = [box(np.array([x, 0.0, z]), np.array([x + 1.0, 0.5, z + 1.0])) for x, z in place.astype(float)]
        blocks = Blocks.gather([str(k) for k in range(len(boxes))], ["free"] * len(boxes), [1.0] * len(boxes), boxes)
        parts, Counted.read = replace(blocks, face_offset=Counted.of(blocks.face_offset)), 0
        assert are_behind(parts, np.stack(drawing.view_axes(plane=False)), blocks.vertices, 0.1).any()
        looks.append(Counted.read)
    assert 0 < looks[1] < LINEAR * 4.0 * looks[0]


@pytest.mark.parametrize("name", ["corner_settling_end", "vault_spreading", "dome_sector", "rubble_wall"])
@pytest.mark.parametrize("toward", [(0.3, -0.8, 0.5), (-0.7, -0.5, 0.5)])
def test_blocks_set_aside_are_drawn_behind_those_that_stand_before_them(name: str, toward: tuple[float, float, float]) -> None:
    """All blocks are set aside. Without interfaces the faces decide the order, because the bounding boxes of voussoirs overlap."""
    whole = assemble(shipped(name))
    none = whole.interfaces.subset(np.zeros(len(whole.interfaces), dtype=bool))
    order = back_to_front(replace(whole, aside=np.ones(len(whole.blocks), dtype=bool), interfaces=none), np.array(toward))
    assert sorted(order) == list(range(len(whole.blocks)))
    rank, along = np.argsort(order), whole.interfaces.normal @ toward
    a, b, seen = whole.interfaces.block_a, whole.interfaces.block_b, np.abs(along) > 1e-6
    assert np.all((rank[np.where(along > 0.0, a, b)] < rank[np.where(along > 0.0, b, a)])[seen])


def test_a_block_in_the_notch_of_one_that_was_set_aside_is_drawn_before_it() -> None:
    """The L is so high that its centroid is nearer than the other block's. No face of a whole block separates the two."""
    angle = prism([(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 9.0), (0.0, 9.0)], (0.0, 1.0))
    inner, toward = box((1.0, 0.0, 1.0), (2.0, 1.0, 2.0)), np.array([0.3, -0.8, 0.5])
    for shapes, order in (((angle, inner), [0, 1]), ((inner, angle), [1, 0])):
        blocks = Blocks.gather(["one", "other"], ["fixed", "fixed"], [np.nan, np.nan], shapes)
        assembly = assemble(shipped("two_pads"))
        none = assembly.interfaces.subset(np.zeros(len(assembly.interfaces), dtype=bool))
        for aside in ([True, False], [False, True], [True, True]):
            assert back_to_front(replace(assembly, blocks=blocks, interfaces=none, aside=np.array(aside)), toward).tolist() == order


def test_a_support_that_walls_hide_is_drawn_by_dashed_edges() -> None:
    settles_behind, settles_in_front = "{ from = [1.1, 1.2], to = [1.3, 1.6] }", "{ from = [1.6, 0.0], to = [2.4, 0.2] }"
    for plan, settling, dashed_faces in (("cross", settles_behind, 3), ("L", settles_in_front, 0)):
        text = starter_text("building").replace(settles_in_front, settling).replace('plan       = "L"', f'plan = "{plan}"')
        scene = load(text[: text.index("[[building.opening]]")] + "[settlement]\ndirection = [0.0, 0.0, -1.0]\n")
        lines = [
            drawn for drawn in structure.assembly_figure(scene, assemble(scene)).axes[0].collections if isinstance(drawn, LineCollection)
        ]
        dashed = [line for line in lines if line.get_linestyle()[0][1] is not None]
        assert sum(len(line.get_segments()) for line in dashed) == dashed_faces


@pytest.mark.parametrize("chords", [19, 22])
def test_a_stone_beside_a_round_opening_shows_no_edges_of_its_parts(chords: int, tmp_path: Path) -> None:
    """Corners of some convex parts lie on edges of other parts. Round-off must not open slits there."""
    angles = np.linspace(np.pi, np.pi / 2.0, chords + 1)
    arc = np.stack([2.0 + np.cos(angles), 2.5 + np.sin(angles)], axis=1).tolist()
    stone = f'[[block]]\nname = "stone"\nprism = {{ profile = {[[0.0, 4.0], [0.0, 2.5], *arc, [2.0, 4.0]]}, y = [0.0, 0.4] }}\n'
    ground = '[[block]]\nname = "ground"\nrole = "fixed"\nbox = { from = [0.0, 0.0, 2.0], to = [0.9, 0.4, 2.5] }\n'
    assembly = assemble(scene_of(tmp_path, ground + stone + "[live]\ndirection = [1.0, 0.0, 0.0]\n"))
    canvas = drawing.canvases(structure.Figure(), assembly, 1)[0]
    canvas.solids(assembly.blocks.vertices, *structure.looks(assembly))
    assert sum(len(drawn.get_paths()) for drawn in canvas.axes.collections) == len(assembly.blocks)


def test_a_name_has_the_room_that_its_leaning_block_leaves_beside_the_centroid(tmp_path: Path) -> None:
    leaning = "[[0.0, 0.0], [1.0, 0.0], [3.0, 2.0], [2.0, 2.0]]"  # 3 m from end to end, and 1 m wide at every height
    blocks = f"""
[[block]]
name = "ground"
role = "fixed"
box = {{ from = [0.0, 0.0, -0.5], to = [3.0, 0.4, 0.0] }}
[[block]]
name = "leaning"
prism = {{ profile = {leaning}, y = [0.0, 0.4] }}
[live]
direction = [1.0, 0.0, 0.0]
"""
    canvas = drawing.canvases(structure.Figure(), assemble(scene_of(tmp_path, blocks)), 1)[0]
    of = canvas.blocks
    assert canvas.outer.room_beside(canvas.flat(of.centroid), canvas.flat(of.vertices[of.face_vertex])) == pytest.approx([3.0, 1.0])
