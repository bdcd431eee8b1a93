"""Nearer blocks are drawn over those behind them, and points inside a wall are hidden."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from figure_scenes import DOWN, SCENES, scene_of
from matplotlib.collections import LineCollection
from scenes import load, shipped

from comparison.figures import canvas as drawing
from comparison.figures import structure
from comparison.figures.drawing_order import back_to_front
from la_core.analysis.stage import analyse
from la_core.model.assembly import assemble
from la_core.scene.shipped import starter_text


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


def test_blocks_set_aside_are_drawn_behind_those_that_stand_before_them() -> None:
    """Here all blocks are set aside: the model has no interfaces, and the order comes from the boxes."""
    whole, toward = assemble(shipped("corner_settling_end")), np.array([0.3, -0.8, 0.5])
    none = whole.interfaces.subset(np.zeros(len(whole.interfaces), dtype=bool))
    rank = np.argsort(back_to_front(replace(whole, aside=np.ones(len(whole.blocks), dtype=bool), interfaces=none), toward))
    facing = whole.interfaces.normal @ toward > 0.0
    a, b = whole.interfaces.block_a, whole.interfaces.block_b
    assert np.all(rank[np.where(facing, a, b)] < rank[np.where(facing, b, a)])


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
