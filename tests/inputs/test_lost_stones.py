"""No stone of a drawing is lost by short lines or by coordinate errors within the tolerance, and every other loss is reported."""

import io
import itertools
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import shapely

import la_core
from la_core.drawing import cleaned, read_outlines
from la_core.scene import Scene, scene_from_file

GRAVITY, DENSITY, THICKNESS = 9.81, 2000.0, 0.5
GROUND = '<g id="ground"><rect x="-0.5" y="0" width="5" height="0.5"/></g>'


def scene_of(folder: Path, stones: str, tolerance: float = 0.0, ground: str = GROUND, keys: str = "") -> Scene:
    page = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 4 4">{ground}<g id="b" stroke="red" fill="none">{stones}</g></svg>'
    (folder / "wall.svg").write_text(page)
    geometry = f"[geometry]\ntolerance = {tolerance}\n" if tolerance else ""
    (folder / "wall.toml").write_text(
        f"[stone]\ndensity = {DENSITY}\n[joint]\nfriction = 2.0\n{geometry}[[drawing]]\nfile = 'wall.svg'\nunit = 'm'\n"
        f"thickness = {THICKNESS}\nground = ['ground']\n{keys}[live]\ndirection = [-1.0, 0.0, 0.0]\n"
    )
    return la_core.load(folder / "wall.toml")


def line(*points: tuple[float, float]) -> str:
    return f'<polyline points="{" ".join(f"{x:.9f},{-z:.9f}" for x, z in points)}"/>'


def polygon(*points: tuple[float, float]) -> str:
    return f'<polygon points="{" ".join(f"{x:.9f},{-z:.9f}" for x, z in points)}"/>'


def box(x0: float, z0: float, x1: float, z1: float) -> str:
    return polygon((x0, z0), (x1, z0), (x1, z1), (x0, z1))


def told(scene: Scene) -> list[str]:
    return [words for words in scene.warnings if words.startswith("drawing")]


@pytest.mark.parametrize("count", [100, 400, 1000])
def test_a_curve_of_lines_shorter_than_the_tolerance_stays_a_curve(count: int, tmp_path: Path) -> None:
    turn = np.linspace(0.0, np.pi, count + 1)
    rim = [(0.5 + 0.5 * np.cos(a), 1.5 + 0.5 * np.sin(a)) for a in turn]
    stones = box(0, 0, 1, 1) + line((0, 1), (0, 1.5)) + line((1, 1), (1, 1.5))
    scene = scene_of(tmp_path, stones + "".join(line(*pair) for pair in itertools.pairwise(rim)), 0.005)
    weight = (1.0 + 0.5 + np.pi / 8.0) * THICKNESS * DENSITY * GRAVITY
    assert int(scene.blocks.free.sum()) == 2
    assert scene.weight == pytest.approx(weight, rel=0.005 * np.pi / 2.0 / 1.9)  # the curve may be off by the tolerance


JUNCTIONS = [(0, 0), (2, 0), (4, 0), (0, 1), (1.3, 1), (2.4, 1), (4, 1), (0, 2), (1.3, 2), (4, 2)]
EDGES = [(0, 1), (1, 2), (3, 4), (4, 5), (5, 6), (7, 8), (8, 9), (0, 3), (3, 7), (1, 4), (4, 8), (2, 6), (6, 9)]
STONES = [(0, 1, 4, 3), (1, 2, 6, 5, 4), (3, 4, 8, 7), (4, 5, 6, 9, 8)]


@pytest.mark.parametrize("joined", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_ends_that_are_each_right_to_the_tolerance_meet(seed: int, joined: bool, tmp_path: Path) -> None:
    """Four stones are drawn by lines or by longer polylines. Every end is off by the tolerance, each in its own direction."""
    tolerance, rng = 0.01, np.random.default_rng(seed)

    def off(k: int) -> tuple[float, float]:
        angle = rng.uniform(0.0, 2.0 * np.pi)
        return JUNCTIONS[k][0] + tolerance * np.cos(angle), JUNCTIONS[k][1] + tolerance * np.sin(angle)

    drawn = EDGES
    if joined:  # polylines that turn at junctions where others end
        drawn = [(0, 1, 2, 6, 9), (0, 3, 4, 5, 6), (3, 7, 8, 9), (1, 4, 8)]
    scene = scene_of(tmp_path, "".join(line(*(off(k) for k in edge)) for edge in drawn), tolerance)
    areas = sorted(scene.blocks.volume[scene.blocks.free] / THICKNESS)
    expected = sorted((shapely.Polygon([JUNCTIONS[k] for k in stone]) for stone in STONES), key=lambda one: one.area)
    assert len(areas) == 4 and not told(scene)
    for area, stone in zip(areas, expected, strict=True):
        assert area == pytest.approx(stone.area, abs=2.0 * tolerance * stone.length)


def test_outlines_drawn_freehand_that_nearly_close_are_closed_and_open_joints_stay_open(tmp_path: Path) -> None:
    """Three stones are drawn freehand with points 3 mm apart, or by four lines each. Their joints are 8 mm wide, the tolerance is 5 mm."""

    def edge(x0: float, z0: float, x1: float, z1: float) -> list[tuple[float, float]]:
        return list(shapely.segmentize(shapely.LinearRing([(x0, z0), (x1, z0), (x1, z1), (x0, z1)]), 0.003).coords)[:-1]

    stones = [(0.0, 0.0, 0.5, 0.3), (0.508, 0.0, 1.0, 0.3), (0.0, 0.308, 1.0, 0.6)]
    freehand = "".join(line(*edge(*stone)) for stone in stones)
    fours = "".join(line(*pair) for stone in stones for pair in itertools.pairwise(shapely.box(*stone).exterior.coords))
    for drawn in (freehand, fours):
        scene = scene_of(tmp_path, drawn, 0.005, keys="joints = 0.01\n")
        assert int(scene.blocks.free.sum()) == 3 and not told(scene)
        assert scene.blocks.volume[scene.blocks.free].sum() == pytest.approx(0.6 * THICKNESS, rel=0.01)


def test_a_chamfer_is_no_curve_and_moves_nothing(tmp_path: Path) -> None:
    """A lower corner of the block is worn by 4 mm, and a corner of the base is cut. The block turns about the joint's end at x = 0.5."""
    block = polygon((0.5, 1), (1, 1), (1, 2.5), (0.46, 2.5), (0.46, 1.004))
    base = f'<g id="ground">{polygon((0, 0), (1, 0), (1, 1), (0.4, 1), (0, 0.8))}</g>'
    scene = scene_of(tmp_path, block, ground=base)
    centre = shapely.Polygon([(0.5, 1), (1, 1), (1, 2.5), (0.46, 2.5), (0.46, 1.004)]).centroid
    answer = la_core.solve(scene)
    assert answer.analysis.sharp.bounds[answer.analysis.main].value == pytest.approx((centre.x - 0.5) / (centre.y - 1.0), rel=1e-6)


def test_small_stones_with_common_corners_are_exact(tmp_path: Path) -> None:
    stones = [
        [(0.2174, 0), (0.3143, 0), (0.2637, 0.0599), (0.2034, 0.0905), (0.2026, 0.0887)],
        [(0.1721, 0.1377), (0.1209, 0.1101), (0.1086, 0.0995), (0.1649, 0.0427), (0.2026, 0.0887), (0.2034, 0.0905), (0.1935, 0.1251)],
        [(0.1955, 0.1259), (0.279, 0.1479), (0.2637, 0.0599), (0.2034, 0.0905), (0.1935, 0.1251)],
    ]
    scene = scene_of(tmp_path, "".join(polygon(*stone) for stone in stones))
    areas = sum(shapely.Polygon(stone).area for stone in stones)
    assert scene.weight == pytest.approx(areas * THICKNESS * DENSITY * GRAVITY, rel=1e-9)


FRAME = box(0, 0, 3, 1) + box(0, 1, 1, 2) + box(2, 1, 3, 2) + box(0, 2, 3, 3)  # around a hole from (1, 1) to (2, 2)


@pytest.mark.parametrize(
    ("lines", "blocks", "lost"),
    [
        (line((1.5, 1), (1.5, 2)), 4, "2 areas"),
        (line((1, 1.5), (2, 1.5)), 4, "2 areas"),
        (line((1, 1.5), (2, 1.5)) + line((1.5, 1), (1.5, 1.5)), 6, "1 area"),
    ],
)
def test_an_area_between_lines_and_outlines_is_told(lines: str, blocks: int, lost: str, tmp_path: Path) -> None:
    scene = scene_of(tmp_path, FRAME + lines)
    assert int(scene.blocks.free.sum()) == blocks
    (words,) = told(scene)
    assert f'{lost} on layer "b"' in words and "enclosed by lines and outlines together" in words


def test_a_hole_without_lines_and_the_span_of_an_arch_are_not_told(tmp_path: Path) -> None:
    assert not told(scene_of(tmp_path, FRAME))
    arcs = "".join(f'<path d="M{2 - r} 0 A{r} {r} 0 0 1 {2 + r} 0"/>' for r in (1.2, 1.5))
    ends = line((0.5, 0), (0.8, 0)) + line((3.2, 0), (3.5, 0))
    rays = "".join(line((2 + 1.2 * c, 1.2 * s), (2 + 1.5 * c, 1.5 * s)) for c, s in ((0.6, 0.8), (0, 1), (-0.6, 0.8)))
    scene = scene_of(tmp_path, arcs + ends + rays)
    assert int(scene.blocks.free.sum()) == 4 and not told(scene)


def test_lines_that_nearly_close_are_told(tmp_path: Path) -> None:
    stone = line((0, 2), (1, 2)) + line((0, 1), (0, 2)) + line((1, 1), (1, 1.985))
    scene = scene_of(tmp_path, box(0, 0, 1, 1) + stone, 0.005)
    (words,) = told(scene)
    assert int(scene.blocks.free.sum()) == 1 and "3 lines" in words and "enclose nothing, although their ends meet others" in words
    closed = scene_of(tmp_path, box(0, 0, 1, 1) + stone.replace("-1.985", "-1.991"), 0.005)
    assert int(closed.blocks.free.sum()) == 2 and not told(closed)


def test_a_dimension_beside_a_wall_is_not_told(tmp_path: Path) -> None:
    assert not told(scene_of(tmp_path, box(0, 0, 1, 1) + line((0, 1.3), (1, 1.3))))


@pytest.mark.parametrize(("stop", "lines"), [(3.9, 1), (4.0, 0), (4.05, 0)])
def test_a_joint_that_stops_within_a_block_is_told_although_it_divides_others(stop: float, lines: int, tmp_path: Path) -> None:
    scene = scene_of(tmp_path, box(0, 0, 4, 2) + line((0, 1), (stop, 1)) + line((2.5, 0), (2.5, 2)))
    assert int(scene.blocks.free.sum()) == (3 if lines else 4)
    assert len(told(scene)) == lines and all("1 line" in words and "lies within a block" in words for words in told(scene))


JOINTS = {  # bed and head joints of three stones on the boxes below them
    "bed": line((0, 2), (3, 2)) + line((0, 3), (3, 3)),
    "head": "".join(line((x, 1), (x, 2)) for x in (0, 1.5, 3)) + line((0, 2), (0, 3)) + line((3, 2), (3, 3)),
}
BELOW = box(0, 0, 1.5, 1) + box(1.5, 0, 3, 1) + box(3, 0, 4.5, 1)

DIMENSION = line((0, 1), (0, 1.4)) + line((1.5, 1), (1.5, 1.4)) + line((0, 1.3), (1.5, 1.3))
ACROSS = np.linspace(1.1, 2.9, 700)


def on_layers(**layers: str) -> str:
    return "".join(f'<g id="{name}" stroke="red" fill="none">{lines}</g>' for name, lines in layers.items())


@pytest.mark.parametrize(
    ("layers", "whose"),
    [
        (on_layers(**JOINTS), 'layers "bed" and "head"'),
        (on_layers(j=JOINTS["bed"] + JOINTS["head"].replace("<polyline", '<polyline stroke="blue"')), 'several colours on layer "j"'),
    ],
)
def test_stones_between_lines_of_two_layers_are_told(layers: str, whose: str, tmp_path: Path) -> None:
    scene = scene_of(tmp_path, BELOW, ground=GROUND + layers)
    (words,) = told(scene)
    assert (
        int(scene.blocks.free.sum()) == 3 and f"2 areas (the first near (0.75, 1.5) m) are enclosed by lines of {whose} together" in words
    )
    assert "draw these lines on one layer and in one colour" in words and "`ignore`" in words
    comments = scene_from_file(tmp_path / "wall.svg", tmp_path)
    assert f"enclosed by lines of {whose} together" in comments


@pytest.mark.parametrize(
    ("layers", "keys"),
    [
        (on_layers(j=JOINTS["bed"] + JOINTS["head"]), ""),  # these lines enclose stones
        (on_layers(**JOINTS), 'ignore = ["head"]\n'),
        (on_layers(**JOINTS), 'blocks = ["b"]\n'),
        (on_layers(**JOINTS, void=box(0, 1, 3, 3)), 'openings = ["void"]\n'),
        (on_layers(bed=line((0, 2), (3, 2)), head=line((1, 1), (1, 2))), ""),  # an axis and a dimension that enclose nothing
        (on_layers(dim=DIMENSION, axis=line((0.7, 0.9), (0.7, 1.2))), ""),
        (on_layers(a="".join(line((0, z), (3, z)) for z in ACROSS), c="".join(line((x, 1), (x, 3)) for x in ACROSS)), ""),  # hatches
    ],
)  # fmt: skip
def test_lines_of_two_layers_without_a_lost_stone_are_not_told(layers: str, keys: str, tmp_path: Path) -> None:
    assert not [words for words in told(scene_of(tmp_path, BELOW, ground=GROUND + layers, keys=keys)) if "together" in words]


KEYSTONE = {  # lines that enclose it together with the stones below or beside it
    "on one": line((0, 1), (0.2, 2)) + line((0.2, 2), (1.3, 2)) + line((1.3, 2), (1.5, 1)),
    "between two": line((1.5, 1), (3, 1)) + line((1.5, 0), (3, 0)),
}


@pytest.mark.parametrize(
    ("lines", "place"), [(KEYSTONE["on one"], "(0.75, 1.5)"), (KEYSTONE["between two"], "(2.25, 0.5)")], ids=list(KEYSTONE)
)
def test_a_stone_of_lines_on_a_layer_of_its_own_is_told(lines: str, place: str, tmp_path: Path) -> None:
    stones, key = box(0, 0, 1.5, 1) + box(3, 0, 4.5, 1), on_layers(key=lines)
    (words,) = told(scene_of(tmp_path, stones, ground=GROUND + key))
    assert f'1 area on layer "key" (the first near {place} m) is enclosed by lines and outlines together' in words and "`ignore`" in words
    assert 'on layer "key"' in scene_from_file(tmp_path / "wall.svg", tmp_path)
    assert not told(scene_of(tmp_path, stones, ground=GROUND + key, keys='ignore = ["key"]\n'))
    assert not told(scene_of(tmp_path, stones, ground=GROUND + key, keys='blocks = ["b"]\n'))


ACROSS_STONES = {
    "hatches": "".join(line((x, -0.2), (x + 1.5, 1.3)) for x in np.linspace(-1.4, 1.9, 40)),
    "axes": line((0.05, -0.3), (0.05, 1.4)) + line((-0.4, 0.95), (2.4, 0.95)),
}


@pytest.mark.parametrize("lines", ACROSS_STONES.values(), ids=list(ACROSS_STONES))
def test_lines_across_stones_enclose_no_stones(lines: str, tmp_path: Path) -> None:
    """Every second course is shorter, so that such lines enclose small areas together with the ends of the courses."""
    courses = "".join(box(0.1 * (k % 2), 0.1 * k, 2.0, 0.1 * (k + 1)) for k in range(10))
    assert not [words for words in told(scene_of(tmp_path, courses, ground=GROUND + on_layers(other=lines))) if "enclosed" in words]


HATCH = on_layers(hatch=box(-0.01, 1, 2, 2))  # a little larger than the stone


@pytest.mark.parametrize("hatch_first", [False, True])
def test_a_stone_is_kept_though_a_layer_that_no_list_names_has_it_too(hatch_first: bool, tmp_path: Path) -> None:
    """The hatch replaced the stone where it was drawn first or was larger, and then was left out itself."""
    stone = on_layers(stone=box(0, 1, 2, 2))
    both = HATCH + stone if hatch_first else stone + HATCH
    scene = scene_of(tmp_path, "", ground=GROUND + both, keys='blocks = ["stone"]\n')
    assert scene.blocks.volume[scene.blocks.free] == pytest.approx([2.0 * THICKNESS]) and not told(scene)


@pytest.mark.parametrize("pad_first", [False, True])
def test_an_outline_on_layers_of_two_lists_has_the_role_of_the_first_list_and_is_told(pad_first: bool, tmp_path: Path) -> None:
    pad, stones = on_layers(ground=box(0, 0.5, 1, 1)), on_layers(stones=box(0, 0.5, 1, 1) + box(0, 1, 1, 2))
    scene = scene_of(tmp_path, "", ground=pad + stones if pad_first else stones + pad)
    (words,) = told(scene)
    assert '1 outline on layer "stones" (the first near (0.5, 0.75) m) is drawn again on a layer of another role' in words
    assert sorted(scene.blocks.free.tolist()) == [False, True]


@pytest.mark.parametrize("granite_first", [False, True])
def test_a_stone_drawn_again_on_a_layer_of_another_density_is_told(granite_first: bool, tmp_path: Path) -> None:
    stones, granite = on_layers(stones=box(0, 0.5, 1, 1) + box(0, 1, 1, 2)), on_layers(granite=box(0, 1, 1, 2))
    both = GROUND + (granite + stones if granite_first else stones + granite)
    (words,) = told(scene_of(tmp_path, "", ground=both, keys="density_of = { granite = 2700.0 }\n"))
    layer = "stones" if granite_first else "granite"
    assert f'1 outline on layer "{layer}" (the first near (0.5, 1.5) m) is drawn again on a layer of another role, thickness or' in words
    assert not told(scene_of(tmp_path, "", ground=both))


def outline_of(document: ezdxf.document.Drawing) -> shapely.Polygon:
    document.header["$INSUNITS"] = 6
    text = io.StringIO()
    document.write(text)
    (outline,) = read_outlines(".dxf", text.getvalue().encode(), None, 1e-4).outlines
    return shapely.Polygon(outline.points)


def test_the_frame_of_a_smoothed_polyline_is_no_part_of_it() -> None:
    """Vertices with flag 16 guide the curve; vertices with flag 8 lie on it. CAD programs show only the square of the latter."""
    document = ezdxf.new("R2000")
    frame, curve = [(-1, -1), (3, -1), (3, 3), (-1, 3)], [(0, 0), (2, 0), (2, 2), (0, 2)]
    drawn = document.modelspace().add_polyline2d([*frame, *curve], close=True)
    drawn.dxf.flags |= 4
    for number, vertex in enumerate(drawn.vertices):
        vertex.dxf.flags |= 16 if number < len(frame) else 8
    assert outline_of(document).area == pytest.approx(4.0, rel=1e-9)


@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_a_spline_with_corners_keeps_them(degree: int, weighted: bool) -> None:
    """The sides of a stone are spans of one spline, in a stretched block. The reader took a smooth curve through some of its points."""
    corners = np.array([(0, 0), (500, 0), (400, 300), (100, 300), (0, 0)], dtype=float)
    document = ezdxf.new(units=4)
    spline = document.blocks.new("STONE").add_spline(degree=degree)
    sides = [np.linspace(start, end, degree, endpoint=False) for start, end in itertools.pairwise(corners)]
    spline.control_points = [(x, z, 0.0) for x, z in np.concatenate([*sides, corners[:1]]).tolist()]
    spline.knots = [0.0, *np.repeat(np.arange(5.0), degree).tolist(), 4.0]
    spline.weights = [1.0] * len(spline.control_points) if weighted else []
    document.modelspace().add_blockref("STONE", (100, 50), dxfattribs={"xscale": -2.0})
    content = io.StringIO()
    document.write(content)
    drawn = read_outlines(".dxf", content.getvalue().encode(), None, 1e-3)
    true = shapely.Polygon(corners[:-1] * [-2e-3, 1e-3] + [0.1, 0.05])
    assert shapely.Polygon(drawn.outlines[0].points).symmetric_difference(true).area == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("weights", [[], [1.0] * 7])
@pytest.mark.parametrize("shift", [-3.0, 0.0, 5.0])
def test_a_closed_spline_without_a_beginning_is_its_curve(shift: float, weights: list[float]) -> None:
    """A uniform cubic spline about a square. Each span starts at the mean of four corners with the weights (1/6, 2/3, 1/6, 0)."""
    document, square = ezdxf.new("R2000"), np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)])
    spline = document.modelspace().add_spline(degree=3)
    corners = np.concatenate([square, square[:3]])
    spline.control_points = [(x, z, 0.0) for x, z in corners]
    spline.knots = [k + shift for k in range(len(corners) + 4)]
    spline.weights = weights
    spline.closed = True
    t = np.linspace(0.0, 1.0, 2000)[:-1, None]
    basis = [(1 - t) ** 3 / 6, (3 * t**3 - 6 * t**2 + 4) / 6, (-3 * t**3 + 3 * t**2 + 3 * t + 1) / 6, t**3 / 6]
    curve = np.concatenate([sum(one * corners[k + j] for j, one in enumerate(basis)) for k in range(4)])
    found = outline_of(document)
    assert found.is_valid and found.hausdorff_distance(shapely.Polygon(curve)) < 2e-4


@pytest.mark.parametrize(("overrun", "tolerance"), [(1e-7, 0.0), (5e-5, 0.0), (0.002, 0.005)])
@pytest.mark.parametrize("side", [(1, 1), (1, -1), (-1, 1), (-1, -1)])
def test_a_closed_outline_may_overrun_its_start(side: tuple[int, int], overrun: float, tolerance: float, tmp_path: Path) -> None:
    """Programs repeat the first corner of a closed path, rounded, before they close it. Such an outline may cross itself by a hair."""
    corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    points = -np.array([*corners, (overrun * side[0], overrun * side[1])])
    drawing = f'<svg viewBox="-2 -2 4 4"><polygon points="{" ".join(f"{x:.9f},{z:.9f}" for x, z in points)}"/></svg>'
    outlines = cleaned(read_outlines(".svg", drawing.encode(), 1.0, 0.005), tolerance).outlines
    assert [shapely.Polygon(one.points).area for one in outlines] == pytest.approx([1.0], abs=2.0 * overrun)


def test_an_outline_that_overruns_its_start_farther_is_refused() -> None:
    drawing = '<svg viewBox="-2 -2 4 4"><polygon points="0,0 1,0 1,1 0,1 0.01,-0.01"/></svg>'
    with pytest.raises(ValueError, match="the outline crosses itself"):
        cleaned(read_outlines(".svg", drawing.encode(), 1.0, 0.005), 0.005)
