"""Blocks have the mass properties of known solids, and their faces have outward normals and enclose them."""

import math

import numpy as np
import pytest
import scenes
from gathered_blocks import EXACT, TURNED, gathered, turned
from measured_shapes import reaction

from la_core.geometry.blocks import Blocks
from la_core.geometry.shapes import box, polyhedron, prism


def faces_of(blocks: Blocks, block: int) -> list[np.ndarray]:
    """Face polygons of one block, each (n, 3) in m."""
    faces = np.flatnonzero(blocks.face_block == block)
    return [blocks.vertices[blocks.face_vertex[blocks.face_start[f] : blocks.face_start[f + 1]]] for f in faces]


def test_coplanar_triangles_of_a_hull_are_one_face() -> None:
    cube = polyhedron(box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)).vertices)
    assert sorted(len(face) for face in cube.faces) == [4] * 6
    hexagon = polyhedron([(math.cos(k * math.pi / 3.0), math.sin(k * math.pi / 3.0), z) for k in range(6) for z in (0.0, 1.0)])
    assert sorted(len(face) for face in hexagon.faces) == [4] * 6 + [6] * 2


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


SHEET, WEDGE, MITRED = "sheet", "wedge", "mitred sheet"
SIXTH = 1.0 / 6.0  # of the weight, on the right of two pads under a block, by moments about the end of the fixed pad


def thin(kind: str, least: float) -> list[tuple[float, float]]:
    """Profile (x, z), 1 m long and `least` (m) thick: all along, at one end, or between ends mitred at 20 degrees."""
    end = least / math.tan(math.radians(20.0))
    return {
        SHEET: [(0.0, 0.0), (1.0, 0.0), (1.0, least), (0.0, least)],
        WEDGE: [(0.0, 0.0), (1.0, 0.0), (1.0, 0.2), (0.0, least)],
        MITRED: [(0.0, 0.0), (1.0, 0.0), (1.0 - end, least), (end, least)],
    }[kind]


@pytest.mark.parametrize("least", [1e-3, 9e-5, 1e-5, 1e-6])
@pytest.mark.parametrize("kind", [SHEET, WEDGE, MITRED])
@pytest.mark.parametrize("turn", [None, scenes.rotation((0.3, -0.5, 0.8), 1.1)], ids=["upright", "turned"])
def test_a_thin_body_has_the_faces_of_the_prism_that_it_is(kind: str, least: float, turn) -> None:
    """The corners of its two sides lie near one plane. The sides were taken for one face, and a sheet had up to 2.7 times its volume."""
    drawn = prism(thin(kind, least), (0.0, 0.2))
    drawn = drawn if turn is None else turned(drawn, turn)
    hull = polyhedron(drawn.vertices)
    assert sorted(len(face) for face in hull.faces) == [4] * 6
    found, known = gathered(hull), gathered(drawn)
    assert found.volume == pytest.approx(known.volume, rel=1e-8)
    assert found.centroid == pytest.approx(known.centroid, abs=1e-8)


@pytest.mark.parametrize("kind", [SHEET, WEDGE])
@pytest.mark.parametrize("least", [9e-5, 1e-6])
def test_a_block_stands_on_a_thin_hull_as_on_a_thin_prism(kind: str, least: float) -> None:
    """A sheet of 1e-6 m was reported to be unable to stand, and thicker sheets to touch nothing."""
    profile = thin(kind, least)
    hull = scenes.block("thin", polyhedron=[(x, y, z) for x, z in profile for y in (0.0, 0.2)])
    top = scenes.block("block", prism=([profile[3], profile[2], (1.0, 0.5), (0.0, 0.5)], (0.0, 0.2)))
    pads = (
        scenes.box("pad", (0.0, 0.0, -0.1), (0.4, 0.2, 0.0), "fixed"),
        scenes.box("settling pad", (0.5, 0.0, -0.1), (1.0, 0.2, 0.0), "support"),
    )
    scene = scenes.build(*pads, hull, top)
    assert reaction(scene) == pytest.approx(SIXTH, abs=1e-6)
