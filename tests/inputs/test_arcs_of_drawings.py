"""Arcs of a DXF drawing are followed to within the sagitta, and stones that share an arc touch along it, also after a repair."""

import math
from itertools import pairwise
from pathlib import Path

import ezdxf
import numpy as np
import pytest

import la_core
from la_core.analysis import structural_model
from la_core.drawing.dxf import read_dxf
from la_core.scene import Scene

METRES = 6  # $INSUNITS
THICK, VOUSSOIRS = 0.3, 9


def polar(radius: float, angle: float) -> tuple[float, float]:
    return radius * math.cos(angle), radius * math.sin(angle)


@pytest.mark.parametrize("sagitta", [1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("kind", ["circle", "bulges", "ellipse"])
def test_the_corners_of_a_curve_lie_on_it(kind: str, sagitta: float, tmp_path: Path) -> None:
    """One Bézier curve per quarter circle left the circle by 2.7e-4 of its radius, and the area exceeded that of the circle."""
    document = ezdxf.new(units=METRES)
    space = document.modelspace()
    if kind == "circle":
        space.add_circle((0.0, 0.0), 1.0)
    elif kind == "ellipse":
        space.add_ellipse((0.0, 0.0), (1.0, 0.0), 1.0)
    else:
        space.add_lwpolyline([(1.0, 0.0, 1.0), (-1.0, 0.0, 1.0)], format="xyb", close=True)
    document.saveas(tmp_path / "round.dxf")
    (outline,) = read_dxf((tmp_path / "round.dxf").read_bytes(), None, sagitta).outlines
    x, z = outline.points.T
    area = 0.5 * abs(float(np.sum(x * np.roll(z, -1) - z * np.roll(x, -1))))
    middle = 0.5 * (outline.points + np.roll(outline.points, -1, axis=0))
    assert np.hypot(x, z) == pytest.approx(1.0, abs=1e-6)
    assert np.hypot(*middle.T).min() >= 1.0 - sagitta - 1e-6
    assert area < math.pi


def tympanum(folder: Path, radius: float, keys: str) -> Scene:
    """Half a disc under a ring of voussoirs. Both have the same arc, drawn as one bulge and as nine."""
    document = ezdxf.new(units=METRES)
    space, outer = document.modelspace(), radius + THICK
    space.add_lwpolyline([(radius, 0.0, 1.0), (-radius, 0.0, 0.0)], format="xyb", close=True, dxfattribs={"layer": "STONE"})
    bulge = math.tan(math.pi / VOUSSOIRS / 4.0)
    for a, b in pairwise(np.linspace(0.0, math.pi, VOUSSOIRS + 1).tolist()):
        corners = [(*polar(radius, a), 0.0), (*polar(outer, a), bulge), (*polar(outer, b), 0.0), (*polar(radius, b), -bulge)]
        space.add_lwpolyline(corners, format="xyb", close=True, dxfattribs={"layer": "STONE"})
    for layer, left, right in (("GROUND", -outer, 0.0), ("SUPPORT", 0.0, outer)):
        base = [(left, -0.3), (right, -0.3), (right, 0.0), (left, 0.0)]
        space.add_lwpolyline(base, close=True, dxfattribs={"layer": layer})
    document.saveas(folder / "tympanum.dxf")
    text = '[stone]\ndensity = 2000.0\n[joint]\nfriction = 0.6\n[[drawing]]\nfile = "tympanum.dxf"\nthickness = 0.3\n'
    text += f'ground = ["GROUND"]\nsupport = ["SUPPORT"]\n{keys}\n[settlement]\ndirection = [0.0, 0.0, -1.0]\n'
    (folder / "tympanum.toml").write_text(text, encoding="utf-8")
    return la_core.load(folder / "tympanum.toml")


def length_on_arc(scene: Scene, radius: float) -> float:
    """Return the length of the joints between the disc and the ring over that of the arc."""
    joints = structural_model(scene).assembly.interfaces
    disc = int(np.argmax(np.where(scene.blocks.free, scene.blocks.volume, 0.0)))
    here = (joints.block_a == disc) | (joints.block_b == disc)
    return float(joints.area[here].sum() / 0.3 - 2.0 * radius) / (math.pi * radius)


@pytest.mark.slow_after_first
@pytest.mark.parametrize("radius", [2.0, 5.0, 10.0])
@pytest.mark.parametrize("keys", ["", "sagitta = 0.002"])
def test_stones_on_both_sides_of_an_arc_touch_along_it(radius: float, keys: str, tmp_path: Path) -> None:
    """They overlapped by up to 6 mm, and the drawing was refused."""
    assert length_on_arc(tympanum(tmp_path, radius, keys), radius) == pytest.approx(1.0, abs=2e-3)


@pytest.mark.parametrize("radius", [1.0, 3.0, 5.0])
def test_a_repair_leaves_an_arc_that_touches_as_it_is(radius: float, tmp_path: Path) -> None:
    """Neighbouring chords were put on one plane: corners moved by 60 mm within a tolerance of 3 mm, and 4 % of the joint was lost."""
    scene = tympanum(tmp_path, radius, "[geometry]\ntolerance = 0.003")
    assert scene.repairs is not None and scene.repairs.largest_move < 1e-9
    assert length_on_arc(scene, radius) == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("radius", [1.0, 10.0, 25.0])
@pytest.mark.parametrize("keys", ["", "sagitta = 0.001"])
def test_joints_that_end_on_large_arcs_bound_voussoirs(radius: float, keys: str, tmp_path: Path) -> None:
    """The lines ended beside the chords, so that stones were lost."""
    document = ezdxf.new(units=METRES)
    space, inner, outer = document.modelspace(), radius, 1.1 * radius
    for one in (inner, outer):
        space.add_arc((0.0, 0.0), one, 0.0, 180.0, dxfattribs={"layer": "STONE"})
    for angle in np.linspace(0.0, math.pi, 22).tolist():
        space.add_line(polar(inner, angle), polar(outer, angle), dxfattribs={"layer": "STONE"})
    for layer, left in (("GROUND", -1.2 * radius), ("SUPPORT", 0.9 * radius)):
        base = [(left, -0.3), (left + 0.3 * radius, -0.3), (left + 0.3 * radius, 0.0), (left, 0.0)]
        space.add_lwpolyline(base, close=True, dxfattribs={"layer": layer})
    document.saveas(tmp_path / "arch.dxf")
    text = '[stone]\ndensity = 2000.0\n[joint]\nfriction = 0.6\n[[drawing]]\nfile = "arch.dxf"\nthickness = 0.3\n'
    text += f'ground = ["GROUND"]\nsupport = ["SUPPORT"]\n{keys}\n[settlement]\ndirection = [0.0, 0.0, -1.0]\n'
    (tmp_path / "arch.toml").write_text(text, encoding="utf-8")
    scene = la_core.load(tmp_path / "arch.toml")
    assert int(scene.blocks.free.sum()) == 21 and not scene.warnings
