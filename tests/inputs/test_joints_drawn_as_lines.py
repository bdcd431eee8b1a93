"""Joints drawn as lines divide outlines, curves bound the stones on both their sides, and lines that divide nothing are reported."""

import io
import itertools
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from la_core.errors import SceneError
from la_core.geometry import find_interfaces
from la_core.scene import Scene, build, scene_from_file

Drawing = Callable[[Any], None]
WALL = [(0, 0), (2000, 0), (2000, 1000), (0, 1000)]
BEDS = [((0, z), (2000, z)) for z in (250, 500, 750)]
HEADS = [((x, z), (x, z + 250)) for z in (0, 250, 500, 750) for x in ((500, 1000, 1500) if z % 500 == 0 else (250, 750, 1250, 1750))]
SIDES = [((0, 0), (2000, 0)), ((0, 1000), (2000, 1000)), ((0, 0), (0, 1000)), ((2000, 0), (2000, 1000))]
BRICKS = 18
PLACE = {"layer": "WALL"}


def content_of(draw: Drawing, unit: int = 4) -> bytes:
    document = ezdxf.new(units=unit)
    draw(document.modelspace())
    text = io.StringIO()
    document.write(text)
    return text.getvalue().encode()


def scene_of(folder: Path, draw: Drawing, tolerance: float = 0.003, **drawing: Any) -> Scene:
    (folder / "wall.dxf").write_bytes(content_of(draw))
    table = {"file": "wall.dxf", "thickness": 0.4, **drawing}
    tables = {"stone": {"density": 2000.0}, "joint": {"friction": 0.6}, "drawing": [table], "live": {"direction": [1.0, 0.0, 0.0]}}
    return build(tables | ({"geometry": {"tolerance": tolerance}} if tolerance else {}), "wall", folder)


def areas(scene: Scene) -> np.ndarray:
    return np.sort(scene.blocks.volume / 0.4)


def draw_lines(space: Any, lines: list[Any], layer: str = "WALL") -> None:
    for start, end in lines:
        space.add_line(start, end, dxfattribs={"layer": layer})


def on_one_layer(space: Any) -> None:
    draw_lines(space, SIDES + BEDS + HEADS)


def on_two_layers(space: Any) -> None:
    draw_lines(space, SIDES + BEDS, "BED")
    draw_lines(space, HEADS, "HEAD")


def in_an_outline(space: Any) -> None:
    space.add_lwpolyline(WALL, close=True, dxfattribs=PLACE)
    draw_lines(space, BEDS + HEADS)


def with_an_axis_and_a_crack(space: Any) -> None:
    in_an_outline(space)
    draw_lines(space, [((1100, -300), (1100, 1300))], "AXIS OF THE DOOR")
    draw_lines(space, [((1050, 50), (1200, 200))], "CRACKS")


@pytest.mark.parametrize("draw", [on_one_layer, on_two_layers, in_an_outline, with_an_axis_and_a_crack])
def test_lines_divide_a_wall_into_its_bricks(draw: Drawing, tmp_path: Path) -> None:
    scene = scene_of(tmp_path, draw)
    halves = [0.25 * 0.25] * 4
    assert areas(scene) == pytest.approx([*halves, *[0.5 * 0.25] * (BRICKS - 4)], rel=1e-9)
    expected = {with_an_axis_and_a_crack: '1 line on layer "CRACKS"', on_two_layers: f'{len(HEADS)} lines on layer "HEAD"'}
    assert len(scene.warnings) == (draw in expected)
    assert all(expected[draw] in warning for warning in scene.warnings)


def test_bed_joints_divide_a_closed_outline(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_lwpolyline(WALL, close=True, dxfattribs=PLACE)
        draw_lines(space, BEDS)

    scene = scene_of(tmp_path, draw)
    assert areas(scene) == pytest.approx([0.5] * 4, rel=1e-9)


def test_a_joint_that_ends_in_a_block_is_told_with_its_place(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        on_one_layer(space)
        draw_lines(space, [((300, 20), (300, 200))])

    scene = scene_of(tmp_path, draw)
    assert len(scene.blocks) == BRICKS
    (warning,) = scene.warnings
    assert '1 line on layer "WALL" (the first near (0.3, 0.11) m) lies within a block and does not divide it' in warning
    assert "# CHECK: 1 line on layer" in scene_from_file(tmp_path / "wall.dxf", tmp_path)


def test_a_detail_within_a_block_of_lines_is_told(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        draw_lines(space, [*SIDES, ((0, 500), (2000, 500))])
        hole = [(900, 100), (1100, 100), (1100, 300), (900, 300)]
        draw_lines(space, list(zip(hole, [*hole[1:], hole[0]], strict=True)))

    scene = scene_of(tmp_path, draw, tolerance=0.0)
    (warning,) = scene.warnings
    assert '1 outline on layer "WALL" (the first near (' in warning and "around others is left out" in warning


@pytest.mark.parametrize("order", [1, -1])
def test_of_an_outline_and_its_bevel_the_outline_is_the_block(order: int, tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        for edge in (0, 12)[::order]:
            space.add_lwpolyline([(edge, edge), (500 - edge, edge), (500 - edge, 250 - edge), (edge, 250 - edge)], close=True)

    scene = scene_of(tmp_path, draw)
    assert areas(scene) == pytest.approx([0.125], rel=1e-9)
    assert scene.drawn[0].doubles == 1


@pytest.mark.parametrize("jitter", [0.0, 1.0, 2.0, 3.0])
def test_edges_that_are_drawn_again_as_lines_change_nothing(jitter: float, tmp_path: Path) -> None:
    """Surveyed bricks, each corner off by up to `jitter` (mm), and the bed joints drawn again as lines through the whole wall."""
    random = np.random.default_rng(1)

    def draw(space: Any) -> None:
        for z in range(0, 1000, 250):
            edges = [0, *range(500 if z % 500 == 0 else 250, 2000, 500), 2000]
            for left, right in itertools.pairwise(edges):
                corners = np.array([(left, z), (right, z), (right, z + 250), (left, z + 250)]) + random.uniform(-jitter, jitter, (4, 2))
                space.add_lwpolyline(corners.tolist(), close=True, dxfattribs=PLACE)
        draw_lines(space, BEDS)

    assert len(scene_of(tmp_path, draw).blocks) == BRICKS


NINE = [(x, z) for z in (0, 250, 500) for x in (0, 500, 1000)]


@pytest.mark.parametrize("missing", [(500, 250), (1000, 250), (0, 500)])
@pytest.mark.parametrize("jitter", [0.0, 1.0])
def test_a_stone_of_lines_between_closed_ones_is_a_block(jitter: float, missing: tuple[int, int], tmp_path: Path) -> None:
    """The stone is in the middle, at the end or at the top of a wall. All of its lines, or all but one or two, run along neighbours."""
    random = np.random.default_rng(1)

    def draw(space: Any) -> None:
        for x, z in NINE:
            corners = np.array([(x, z), (x + 500, z), (x + 500, z + 250), (x, z + 250)]) + random.uniform(-jitter, jitter, (4, 2))
            if (x, z) == missing:
                draw_lines(space, list(itertools.pairwise([*corners.tolist(), (corners[0] + 0.4 * jitter).tolist()])))
            else:
                space.add_lwpolyline(corners.tolist(), close=True, dxfattribs=PLACE)

    scene = scene_of(tmp_path, draw)
    assert len(scene.blocks) == len(NINE) and not scene.warnings
    assert scene.blocks.volume.sum() == pytest.approx(0.4 * 1.5 * 0.75, rel=5e-3)
    assert scene.drawn[0].loose_lines == 0


def test_joints_drawn_again_past_an_opening_leave_it_open(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        for x, z in NINE:
            if (x, z) != (500, 250):
                space.add_lwpolyline([(x, z), (x + 500, z), (x + 500, z + 250), (x, z + 250)], close=True, dxfattribs=PLACE)
        draw_lines(space, [((0, z), (1500, z)) for z in (250, 500)] + [((x, 0), (x, 750)) for x in (500, 1000)])

    assert len(scene_of(tmp_path, draw).blocks) == len(NINE) - 1


def test_an_open_brick_between_others_is_told_although_they_have_its_edges(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        for x, z in ((0, 0), (500, 0), (1000, 0), (0, 250), (1000, 250), (0, 500), (500, 500), (1000, 500)):
            space.add_lwpolyline([(x, z), (x + 500, z), (x + 500, z + 250), (x, z + 250)], close=True, dxfattribs=PLACE)
        space.add_lwpolyline([(500, 250), (1000, 250), (1000, 500), (500, 500), (500, 270)], dxfattribs=PLACE)

    (warning,) = scene_of(tmp_path, draw).warnings
    assert "is open by 20 mm, so it is left out" in warning


def test_a_sliver_thinner_than_the_tolerance_is_no_block(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_lwpolyline(WALL, close=True)
        space.add_lwpolyline([(0, 1000), (2000, 1000), (2000, 1001.5), (0, 1001.5)], close=True)

    scene = scene_of(tmp_path, draw)
    assert len(scene.blocks) == 1 and scene.drawn[0].specks == 1


# --- curves ------------------------------------------------------------------------------------------------------------------

INNER, OUTER, VOUSSOIRS = 1000.0, 1300.0, 11


def polar(radius: float, angle: float) -> tuple[float, float]:
    return radius * math.cos(angle), radius * math.sin(angle)


def arch_of_two_arcs(space: Any) -> None:
    for radius in (INNER, OUTER):
        space.add_arc((0, 0), radius, 0.0, 180.0)
    for angle in np.linspace(0.0, math.pi, VOUSSOIRS + 1):
        space.add_line(polar(INNER, angle), polar(OUTER, angle))


def ring_of_two_circles(space: Any) -> None:
    for radius in (INNER, OUTER):
        space.add_circle((0, 0), radius)
    for angle in np.linspace(0.1, 2.0 * math.pi + 0.1, 2 * VOUSSOIRS, endpoint=False):
        space.add_line(polar(INNER, angle), polar(OUTER, angle))


@pytest.mark.parametrize("tolerance", [0.0, 0.001, 0.003])
@pytest.mark.parametrize("sagitta", [0.005, 0.02])
def test_an_arch_of_arcs_and_radial_lines_has_all_its_voussoirs(tolerance: float, sagitta: float, tmp_path: Path) -> None:
    scene = scene_of(tmp_path, arch_of_two_arcs, tolerance, sagitta=sagitta)
    exact = 0.5 * (OUTER**2 - INNER**2) * 1e-6 * math.pi / VOUSSOIRS
    assert len(scene.blocks) == VOUSSOIRS
    assert areas(scene) == pytest.approx([exact] * VOUSSOIRS, rel=2.0 * sagitta / 0.3)  # a chord is off by the sagitta at either face
    assert len(find_interfaces(scene.blocks)) == VOUSSOIRS - 1
    assert scene.drawn[0].loose_lines == 0 and not scene.warnings


def test_a_ring_of_circles_and_radial_lines_has_all_its_voussoirs_and_what_lies_within(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, ring_of_two_circles)
    assert len(scene.blocks) == 2 * VOUSSOIRS + 1
    assert areas(scene)[-1] == pytest.approx(math.pi * 1e-6 * INNER**2, rel=0.02)


def test_two_rings_of_other_stones_share_the_chords_of_the_curve_between_them(tmp_path: Path) -> None:
    """A ring of nine stones within one of thirteen, each a closed outline with arcs. Drawn exactly, they leave no gap and no overlap."""

    def draw(space: Any) -> None:
        for count, low, high in ((9, 2000.0, 2300.0), (13, 2300.0, 2600.0)):
            for first, last in zip(*(np.linspace(0.0, math.pi, count + 1)[k:][:count] for k in (0, 1)), strict=True):
                bulge = math.tan(0.25 * (last - first))
                corners = [(*polar(low, first), 0.0), (*polar(high, first), bulge), (*polar(high, last), 0.0), (*polar(low, last), -bulge)]
                space.add_lwpolyline(corners, format="xyb", close=True)

    scene = scene_of(tmp_path, draw)
    assert len(scene.blocks) == 22
    assert scene.repairs is not None and scene.repairs.unclosed == ()
    exact = 0.5 * math.pi * (2.6**2 - 2.0**2)
    assert areas(scene).sum() == pytest.approx(exact, rel=0.01)
    across = {tuple(sorted((one < 9, other < 9))) for one, other in zip(*_pairs(scene), strict=True)}
    assert (False, True) in across


def _pairs(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    interfaces = find_interfaces(scene.blocks)
    return interfaces.block_a, interfaces.block_b


# --- entities that are not read ----------------------------------------------------------------------------------------------


def test_meshes_are_counted_and_the_rest_is_read(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_lwpolyline(WALL, close=True)
        space.add_polymesh((3, 3))
        space.add_polyface()

    scene = scene_of(tmp_path, draw)
    assert len(scene.blocks) == 1 and scene.drawn[0].ignored == {"POLYLINE": 2}


def test_a_drawing_without_outlines_says_what_it_holds(tmp_path: Path) -> None:
    def hatched(space: Any) -> None:
        space.add_hatch().paths.add_polyline_path(WALL, is_closed=True)

    with pytest.raises(
        SceneError,
        match="holds no closed outline; it has 0 lines that enclose nothing; not read: 1 HATCH; where these are stones, draw",
    ):
        scene_of(tmp_path, hatched)
    document = ezdxf.new(units=4)
    document.layout("Layout1").add_lwpolyline(WALL, close=True)
    document.saveas(tmp_path / "sheet.dxf")
    with pytest.raises(SceneError, match="1 entities in paper space"):
        scene_from_file(tmp_path / "sheet.dxf", tmp_path)


def test_an_elevation_that_stands_upright_in_the_file_is_refused_in_words(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_polyline3d([(0, 0, 0), (1000, 0, 0), (1000, 0, 500), (0, 0, 500)], close=True)

    def draw_lines(space: Any) -> None:
        corners = [(0, 0, 0), (1000, 0, 0), (1000, 0, 500), (0, 0, 500)]
        for start, end in zip(corners, [*corners[1:], corners[0]], strict=True):
            space.add_line(start, end)

    for draws, what in ((draw, "outlines"), (draw_lines, "lines")):
        with pytest.raises(SceneError, match=f"has only {what} without height; the elevation must lie in the xy plane of the file"):
            scene_of(tmp_path, draws)


@pytest.mark.parametrize(
    ("layer", "key"),
    [
        ("WINDOWS", "openings"), ("doorOpening", "openings"), ("Maueröffnung", "openings"), ("GROUND_1", "ground"),
        ("A-DIMENSIONS", "ignore"), ("SETTLING PIER", "support"), ("WINDOW_JAMBS", ""),
        ("ROSE_WINDOW_VOUSSOIRS", ""), ("ROUGH_TEXTURE", ""), ("PREFIXED_STONE", ""),
        ("SUPPORTING_PIERS", ""), ("Fenstersturz", ""), ("DOOR_SURROUND", ""),
    ],
)  # fmt: skip
def test_words_of_a_layer_s_name_say_what_it_may_be(layer: str, key: str, tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        space.add_lwpolyline(WALL, close=True, dxfattribs={"layer": layer})
        space.add_lwpolyline([(0, 1000), (2000, 1000), (2000, 2000), (0, 2000)], close=True, dxfattribs={"layer": "ASHLAR"})

    (tmp_path / "wall.dxf").write_bytes(content_of(draw))
    text = scene_from_file(tmp_path / "wall.dxf", tmp_path)
    named = [row for row in text.splitlines() if row.startswith(("ignore", "openings", "support", "ground"))]
    assert [row.split("=")[0].strip() for row in named] == ([key] if key else [])
    assert all("# CHECK: " in row for row in named)


def test_a_unit_without_a_name_is_left_to_the_file_and_a_scale_is_doubted(tmp_path: Path) -> None:
    page = '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="50mm" viewBox="0 0 2000 1000">{}</svg>'
    rectangles = "".join(f'<rect x="{x}" y="0" width="500" height="250"/>' for x in (0, 500, 1000))
    (tmp_path / "wall.svg").write_text(page.format(rectangles))
    text = scene_from_file(tmp_path / "wall.svg", tmp_path)
    assert "unit      =" not in text and "# one unit of the file is 5e-05 m" in text
    assert "most blocks are then 0.025 m long or less; a drawing to scale" in text
