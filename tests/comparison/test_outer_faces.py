"""A block that is not convex is drawn as one stone: no edges separate its convex parts, and nearer parts hide those behind them."""

from typing import Any

import numpy as np
import pytest
import scenes
import shapely
from matplotlib.collections import LineCollection, PolyCollection

from comparison.figures import canvas as drawing
from comparison.figures import structure
from la_core.model.assembly import Assembly, assemble

TEE = [[1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [3.0, 1.0], [3.0, 2.0], [0.0, 2.0], [0.0, 1.0], [1.0, 1.0]]
CHANNEL = [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [2.0, 2.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]
STEPS = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0], [1.0, 3.0], [0.0, 3.0]]
SEEN = {"tee": (TEE, 4), "channel": (CHANNEL, 6), "steps": (STEPS, 7)}  # profile; number of faces seen from the right, the front and above
BASES = 2  # blocks below the stone; three faces of each are seen


def stone_on_bases(profile: list[list[float]], deep: float = 1.0) -> Assembly:
    """Return a stone with this profile on two bases 1 m deep. The model is plane if the stone has the same depth."""
    return assemble(scenes.build(*scenes.base(1.5, 3.0), scenes.block("stone", prism=(profile, [0.0, deep])), plane=deep == 1.0))


def drawn(assembly: Assembly, turned: float = 0.0) -> tuple[drawing.Canvas, list[np.ndarray]]:
    """Return the canvas and the drawn faces, (n, 2) each, of the structure sheared by `turned` per height."""
    canvas = drawing.canvases(structure.Figure(), assembly, 1)[0]
    vertices = assembly.blocks.vertices + turned * assembly.blocks.vertices[:, 2:] * np.array([1.0, 0.0, 0.0])
    canvas.solids(vertices, *structure.looks(assembly))
    shapes: Any = [one for one in canvas.axes.collections if isinstance(one, PolyCollection)]
    return canvas, [path.vertices[:-1] for one in shapes for path in one.get_paths()]


@pytest.mark.parametrize("turned", [0.0, 0.1])
@pytest.mark.parametrize("name", SEEN)
def test_a_plane_stone_is_one_polygon(name: str, turned: float) -> None:
    profile, _ = SEEN[name]
    canvas, faces = drawn(stone_on_bases(profile), turned)
    assert len(faces) == BASES + 1
    sheared = np.array(profile) @ np.array([[1.0, 0.0], [turned, 1.0]])
    assert shapely.Polygon(faces[-1]).symmetric_difference(shapely.Polygon(sheared)).area < 1e-5
    canvas.block_outlines(canvas.blocks.free, "black")
    (outlines,) = (one for one in canvas.axes.collections if isinstance(one, LineCollection))
    assert len(outlines.get_segments()) == 1


@pytest.mark.parametrize("name", SEEN)
def test_a_stone_in_space_has_no_faces_between_its_parts_and_nothing_is_drawn_over_its_front(name: str) -> None:
    profile, seen = SEEN[name]
    canvas, faces = drawn(stone_on_bases(profile, 0.8))
    assert len(faces) == 3 * BASES + seen
    front = canvas.flat(np.insert(np.array(profile), 1, 0.0, axis=1))
    areas = [shapely.Polygon(face).symmetric_difference(shapely.Polygon(front)).area for face in faces]
    assert min(areas) < 1e-5
    later = [shapely.Polygon(face) for face in faces[int(np.argmin(areas)) + 1 :]]
    assert shapely.union_all(later).intersection(shapely.Polygon(front)).area < 1e-5


def test_a_point_in_the_notch_of_a_stone_is_seen_and_one_behind_its_leg_is_hidden() -> None:
    canvas, _ = drawn(stone_on_bases(CHANNEL, 0.8))
    canvas.few = False
    assert canvas.seen(np.array([[1.5, 0.0, 1.2], [2.5, 0.9, 1.2]])).tolist() == [True, False]
