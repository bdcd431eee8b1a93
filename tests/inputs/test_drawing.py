"""Drawings: outlines of DXF and SVG become the blocks that a user would have typed, or are refused with a message."""

import tomllib
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
import wall_drawings as drawn
from wall_drawings import WALL, dxf, insert, lines, polyline

from la_core import drawing
from la_core.analysis.modelling import structural_model
from la_core.analysis.stage import analyse
from la_core.errors import SceneError
from la_core.geometry import find_interfaces
from la_core.limit.problem import Drive
from la_core.scene import Scene, build, scene_from_file

SQUARE = [(0, 0), (1000, 0), (1000, 500), (0, 500)]
ABOVE = [(0, 500), (1000, 500), (1000, 1000), (0, 1000)]
CROSSED = [(0, 0), (1000, 500), (1000, 0), (0, 500)]
BASE = [(0, -100), (1000, -100), (1000, 0), (0, 0)]
ROUND_OFF = 1e-9


def scene_of(folder: Path, content: bytes, suffix: str = ".dxf", tables: dict[str, Any] | None = None, **drawing: Any) -> Scene:
    """A scene with one drawing in a folder; a live load needs no support."""
    folder.mkdir(exist_ok=True)
    (folder / f"wall{suffix}").write_bytes(content)
    table = {"file": f"wall{suffix}", "thickness": 0.3, **drawing}
    whole = {"stone": {"density": 2000.0}, "joint": {"friction": 0.6}, "drawing": [table], **(tables or {})}
    return build({"live": {"direction": [1.0, 0.0, 0.0]}} | whole if "settlement" not in whole else whole, "wall", folder)


def areas(scene: Scene) -> list[float]:
    """Area of the outline of every block, m2."""
    return (scene.blocks.volume / 0.3).tolist()


SETTLING = {"settlement": {"direction": [0.0, 0.0, -1.0]}}
ROLES = {"ground": ["GROUND"], "support": ["SETT*"], "joints": 0.012}


@pytest.mark.parametrize(("content", "suffix"), [(drawn.wall_dxf(), ".dxf"), (drawn.wall_svg(), ".svg")])
def test_a_drawn_wall_is_the_wall_of_whole_blocks(content: bytes, suffix: str, tmp_path: Path) -> None:
    """Polylines, lines, an insert and 10 mm joints, against the same blocks drawn without joints."""
    scene = scene_of(tmp_path, content, suffix, SETTLING, **ROLES)
    typed = typed_wall()
    assert [len(scene.blocks), len(typed.blocks)] == [9, 9]
    assert [one.doubles for one in scene.drawn] == [1 if suffix == ".dxf" else 0]
    counts = [len(find_interfaces(one.blocks)) for one in (scene, typed)]
    assert counts[0] == counts[1]
    inner = scene.repairs.largest_move
    assert inner == pytest.approx(0.005 * np.sqrt(2.0), rel=1e-3)  # half a joint along x and half a joint along z
    values = [analyse(one).bounds[Drive.YIELDING].value / one.weight for one in (scene, typed)]
    assert values[0] == pytest.approx(values[1], rel=0.02)  # the outer faces stay 5 mm within


def typed_wall() -> Scene:
    """The blocks of the drawing with half a joint, 5 mm, added wherever an outline ends 5 mm beside a joint's middle."""
    boxes = []
    for layer, role in (("GROUND", "fixed"), ("SETTLING", "support"), ("BRICKS", "free")):
        for k, outline in enumerate(WALL[layer]):
            low, high = np.min(outline, axis=0), np.max(outline, axis=0)
            (x0, z0), (x1, z1) = np.where(low % 10 == 5, low - 5, low) / 1e3, np.where(high % 10 == 5, high + 5, high) / 1e3
            boxes.append({"name": f"{layer} {k}", "role": role, "box": {"from": [x0, 0.0, z0], "to": [x1, 0.3, z1]}})
    return build({"stone": {"density": 2000.0}, "joint": {"friction": 0.6}, "block": boxes, **SETTLING})


ONE_OUTLINE = {
    "polyline": polyline(SQUARE, "A"),
    "polyline that ends where it begins": polyline([*SQUARE, SQUARE[0]], "A", closed=False),
    "polyline the other way round": polyline(SQUARE[::-1], "A"),
    "corner on an edge": polyline([(0, 0), (400, 0), (1000, 0), (1000, 500), (0, 500)], "A"),
    "lines": lines(SQUARE, "A"),
    "lines that stop a little short": lines([(0.05, 0), (1000, 0.05), (1000, 499.95), (0, 500)], "A"),
    "two polylines": polyline(SQUARE[:3], "A", closed=False) + polyline([SQUARE[2], SQUARE[3], SQUARE[0]], "A", closed=False),
    "drawn twice": polyline(SQUARE, "A") + polyline([(x + 1, z) for x, z in SQUARE], "A"),
    "a speck beside it": polyline(SQUARE, "A") + polyline([(0, 600), (0.1, 600), (0, 600.1)], "A"),
}


@pytest.mark.parametrize("name", ONE_OUTLINE)
def test_one_outline_is_one_block(name: str, tmp_path: Path) -> None:
    scene = scene_of(
        tmp_path, dxf([polyline(BASE, "GROUND"), ONE_OUTLINE[name]]), ground=["GROUND"], tables={"geometry": {"tolerance": 0.001}}
    )
    assert areas(scene) == pytest.approx([0.1, 0.5], rel=1e-3)


@pytest.mark.parametrize(
    ("code", "metres"), [(1, 0.0254), (2, 0.3048), (4, 1e-3), (5, 1e-2), (6, 1.0), (10, 0.9144), (13, 1e-6), (14, 0.1)]
)
def test_the_unit_is_the_file_s(code: int, metres: float, tmp_path: Path) -> None:
    scene = scene_of(tmp_path, dxf([polyline(BASE, "GROUND"), polyline(SQUARE, "A")], unit=code), ground=["GROUND"])
    assert areas(scene) == pytest.approx([1e5 * metres**2, 5e5 * metres**2], rel=ROUND_OFF)


def test_a_stated_unit_counts(tmp_path: Path) -> None:
    content = dxf([polyline(BASE, "GROUND"), polyline(SQUARE, "A")], unit=None)
    assert areas(scene_of(tmp_path, content, ground=["GROUND"], unit="cm")) == pytest.approx([10.0, 50.0], rel=ROUND_OFF)


@pytest.mark.parametrize(("content", "suffix"), [(drawn.wall_dxf(), ".dxf"), (drawn.wall_svg(), ".svg")])
def test_a_drawing_to_scale_is_enlarged_but_no_other_key(content: bytes, suffix: str, tmp_path: Path) -> None:
    full = scene_of(tmp_path, content, suffix, SETTLING, **ROLES)
    scene = scene_of(tmp_path, content, suffix, SETTLING, **ROLES | {"joints": 0.024, "scale": 2.0})
    assert areas(scene) == pytest.approx([4.0 * area for area in areas(full)], rel=ROUND_OFF)


def test_inserts_repeat_a_block_on_their_own_layer(tmp_path: Path) -> None:
    content = dxf(
        [polyline([(0, -100), (3000, -100), (3000, 0), (0, 0)], "GROUND"), insert("B", (0, 0), "A", 3, 1000.0)],
        blocks={"B": polyline(SQUARE, "0")},
    )
    scene = scene_of(tmp_path, content, ground=["GROUND"], blocks=["A"])
    assert scene.blocks.centroid[1:, 0] == pytest.approx([0.5, 1.5, 2.5], rel=ROUND_OFF)


def test_layers_and_colours_say_what_an_outline_is(tmp_path: Path) -> None:
    hole, inside = [(2000, 0), (3000, 0), (3000, 1000), (2000, 1000)], [(2100, 100), (2200, 100), (2200, 200), (2100, 200)]
    content = dxf(
        [
            polyline(BASE, "G", 5),
            polyline(SQUARE, "A", 1),
            polyline(ABOVE, "A", 3),
            polyline(hole, "O"),
            polyline(inside, "A", 1),
            polyline(SQUARE, "N"),
        ]
    )
    table = {"ground": ["colour:blue"], "openings": ["O"], "ignore": ["N"], "thickness_of": {"colour:green": 0.2}}
    scene = scene_of(tmp_path, content, **table)
    assert scene.blocks.volume == pytest.approx([0.03, 0.15, 0.1], rel=ROUND_OFF)
    assert scene.blocks.free.tolist() == [False, True, True]
    assert (scene.drawn[0].openings, scene.drawn[0].in_openings) == (1, 1)


def test_arcs_become_chords_within_the_sagitta(tmp_path: Path) -> None:
    """A half circle of 1 m radius on a base. Its drawn area lacks the segments between the chords and the circle."""
    content = dxf(
        [polyline([(-1000, -100), (1000, -100), (1000, 0), (-1000, 0)], "G"), polyline([(-1000, 0), (1000, 0)], "A", bulges=[0.0, 1.0])]
    )
    for sagitta in (0.02, 0.002):
        area = areas(scene_of(tmp_path, content, ground=["G"], sagitta=sagitta))[1]
        assert np.pi / 2.0 - np.pi * sagitta <= area <= np.pi / 2.0


PAGE = '<svg xmlns="http://www.w3.org/2000/svg" width="2000mm" height="2000mm" viewBox="0 0 2000 2000">'
SVG = PAGE + '<g id="G">{ground}</g><g id="A">{shape}</g></svg>'
SHAPES = {
    "rect": ('<rect x="0" y="-500" width="1000" height="500"/>', 0.5),
    "polygon": ('<polygon points="0,0 1000,0 1000,-500 0,-500"/>', 0.5),
    "relative path": ('<path d="m0,0h1000v-500h-1000z"/>', 0.5),
    "path without commas": ('<path d="M0 0L1000 0 1000-500 0-500Z"/>', 0.5),
    "two subpaths": ('<path d="M0,0h500v-500h-500z m500,0h500v-500h-500z"/>', 0.25),
    "half a circle": ('<path d="M0,0h1000a500,500 0 0 0 -1000,0z"/>', np.pi / 8.0),
    "scaled": ('<g transform="scale(2)"><rect x="0" y="-250" width="500" height="250"/></g>', 0.5),
    "turned": ('<g transform="rotate(-90) translate(0,0)"><rect x="0" y="0" width="500" height="1000"/></g>', 0.5),
    "cubic": ('<path d="M0,0H1000V-500C1000,-500 0,-500 0,-500z"/>', 0.5),
    "quadratic": ('<path d="M0,0H1000Q500,-1000 0,0z"/>', 1.0 / 3.0),
}


@pytest.mark.parametrize("name", SHAPES)
def test_shapes_of_svg(name: str, tmp_path: Path) -> None:
    shape, area = SHAPES[name]
    content = SVG.format(ground='<rect x="0" y="0" width="1000" height="100"/>', shape=shape).encode()
    scene = scene_of(tmp_path, content, ".svg", ground=["G"], sagitta=0.001)
    assert areas(scene)[:2] == pytest.approx([0.1, area], rel=5e-3)
    assert scene.blocks.centroid[1, 2] > 0.0  # z is up


WORLD = drawn.rows(*drawn.begun("CIRCLE", "A"), (100, "AcDbCircle"), (10, 0), (20, 0), (40, 1e300))
REFUSED = {
    "no unit": (dxf([polyline(SQUARE, "A")], unit=None), {}, 'does not say its unit; state it: unit = "mm"'),
    "unknown unit": (dxf([polyline(SQUARE, "A")], unit=20), {}, 'has an unknown code for its unit ($INSUNITS = 20); state it: unit = "mm"'),
    "DWG": (b"AC1032 and bytes", {}, "is a DWG file; save it as DXF"),
    "not DXF": (b"hello", {}, "is not a whole DXF file"),
    "nothing in it": (dxf([]), {}, "holds no closed outline; nothing is drawn in it; make sure that the file is whole"),
    "lines on two layers": (
        dxf([drawn.line((0, k), (1, k), "A") for k in (0, 1)] + [drawn.line((k, 0), (k, 1), "B") for k in (0, 1)]),
        {},
        "it has 4 lines that enclose nothing; lines enclose blocks together on one layer, and these are on A, B",
    ),
    "one layer twice": (
        dxf([polyline(SQUARE, "A")]),
        {"ground": ["A"], "support": ["A"]},
        '"A" is named by both `ground` and `support`; name it once',
    ),
    "loose lines": (dxf([drawn.line((0, 0), (1, 1), "A")]), {}, "holds no closed outline; it has 1 lines that enclose nothing"),
    "no such layer": (dxf([polyline(SQUARE, "BRICK")]), {"ground": ["BRICKS"]}, 'ground = \'BRICKS\': no outline is on such a layer'),
    "crossing": (dxf([polyline(CROSSED, "A")]), {}, 'layer "A", near (0.5, 0.25) m: the outline crosses itself; correct it, or list'),
    "crossing far away": (dxf([polyline([(x + 45e6, z) for x, z in CROSSED], "A")]), {}, 'near (45000.5, 0.25) m: the outline'),
    "copies of nothing": (dxf([insert("B", (0, 0), "A", 32_000, 1.0, courses=20)], blocks={"B": ""}), {}, "has more than 500000 entities"),
    "circle of the world": (dxf([WORLD]), {}, "holds a CIRCLE larger than 1e+12 units"),
    "insert of itself": (dxf([insert("B", (0, 0), "A")], blocks={"B": insert("B", (1, 1), "0")}), {}, 'drawing "wall.dxf": '),
}  # fmt: skip
WITHOUT_AREA = {
    "no width": [(1000, 0), (1000, 0), (1000, 500), (1000, 500)],
    "no height": [(0, 500), (700, 500), (1000, 500)],
    "to and fro": [(0, 500), (1000, 500), (300, 500), (700, 500)],
    "a spike with a bend": [(0, 500), (300, 700), (300, 900), (300, 700)],
}
REFUSED_SVG = {
    "not XML": (b"hello", "is not a whole SVG file"),
    "another XML": (b"<html/>", "is not an SVG file: its first element is <html>"),
    "entities": (b'<!DOCTYPE svg [<!ENTITY a "b"><!ENTITY c "&a;&a;">]><svg/>', "defines entities within entities"),
    "entity of a file": (b'<!DOCTYPE svg [<!ENTITY a SYSTEM "file:///b">]><svg/>', "defines entities within entities or from other files"),
    "no unit": (b'<svg width="100" height="100"/>', "does not say its unit"),
    "broken path": (b'<svg width="1mm"><path d="M 1 2 3"/></svg>', "has a path whose command M has 3 numbers"),
    "path of letters": (b'<svg width="1mm"><path d="L 1 2"/></svg>', "has a path that does not begin with M"),
    "no number": (b'<svg width="1mm"><rect width="wide"/></svg>', 'width = "wide", which is no number'),
}


@pytest.mark.parametrize("tolerance", [None, 0.003])
@pytest.mark.parametrize("name", WITHOUT_AREA)
def test_an_outline_without_area_is_dropped_and_counted(name: str, tolerance: float | None, tmp_path: Path) -> None:
    """Otherwise it would be refused as an outline that crosses itself."""
    content = dxf([polyline(SQUARE, "A"), polyline(WITHOUT_AREA[name], "A"), polyline(BASE, "GROUND")])
    tables = {"geometry": {"tolerance": tolerance}} if tolerance else {}
    scene = scene_of(tmp_path, content, tables=tables, ground=["GROUND"])
    assert areas(scene) == pytest.approx([0.1, 0.5], rel=1e-9) and scene.drawn[0].specks == 1
    assert 'outlines on each layer: "A" 1' in scene_from_file(tmp_path / "wall.dxf", tmp_path)


def test_a_drawing_of_outlines_without_area_is_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="holds no closed outline; 1 outline is thinner than the tolerance"):
        scene_of(tmp_path, dxf([polyline(WITHOUT_AREA["a spike with a bend"], "A")]))


@pytest.mark.parametrize("name", REFUSED)
def test_a_bad_dxf_is_refused_in_words(name: str, tmp_path: Path) -> None:
    content, table, words = REFUSED[name]
    with pytest.raises(SceneError) as error:
        scene_of(tmp_path, content, **table)
    assert words in str(error.value) and "\n" not in str(error.value)


def test_copies_of_many_inserts_count_together(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("la_core.drawing.dxf.MOST_ENTITIES", 1000)
    with pytest.raises(SceneError, match="has more than 1000 entities, copies by inserts among them"):
        scene_of(tmp_path, dxf([insert("B", (0, 0), "A", 100, 1.0)] * 20, blocks={"B": ""}))


@pytest.mark.parametrize(("turn", "corners"), [(90.0, (0.6, 0.5)), (0.0, (1.0, 0.3))])
def test_a_turned_block_in_a_stretched_one_keeps_its_corners(turn: float, corners: tuple[float, float], tmp_path: Path) -> None:
    """A stone of 0.5 x 0.3 m is turned, then stretched along x by 2. It was stretched along its own x axis, and became 1 m high."""
    stone = polyline([(0, 0), (500, 0), (500, 300), (0, 300)], "0")
    blocks = {"STONE": stone, "UPRIGHT": insert("STONE", (300 if turn else 0, 0), "0", turn=turn)}
    drawn = [polyline([(-500, -100), (1500, -100), (1500, 0), (-500, 0)], "GROUND"), insert("UPRIGHT", (0, 0), "A", scale=(2.0, 1.0))]
    scene = scene_of(tmp_path, dxf(drawn, blocks=blocks), ground=["GROUND"])
    (free,) = np.flatnonzero(scene.blocks.free)
    assert scene.blocks.low[free, ::2] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert scene.blocks.high[free, ::2] == pytest.approx(corners)


ELL = [(505, 5), (1000, 5), (1000, 800), (5, 800), (5, 405), (505, 405)]


@pytest.mark.parametrize("joints", [0.011, 0.012, 0.015])
def test_an_open_joint_in_line_with_the_cut_of_a_stone_is_closed(joints: float, tmp_path: Path) -> None:
    """A stone lies in the notch of an L with joints of 10 mm. The cut that divides the L kept its faces from moving."""
    stones = [polyline([(-200, -300), (1500, -300), (1500, -5), (-200, -5)], "G"), polyline([(5, 5), (495, 5), (495, 395), (5, 395)], "A")]
    scene = scene_of(tmp_path, dxf([*stones, polyline(ELL, "B")]), ground=["G"], joints=joints)
    assert scene.repairs is not None and not scene.repairs.unclosed and not scene.warnings
    (ground,), free = np.flatnonzero(~scene.blocks.free), np.flatnonzero(scene.blocks.free)
    interfaces = structural_model(scene).assembly.interfaces
    pairs = {frozenset(pair) for pair in zip(interfaces.block_a.tolist(), interfaces.block_b.tolist(), strict=True)}
    assert pairs == {frozenset(pair) for pair in ((ground, free[0]), (ground, free[1]), (free[0], free[1]))}
    assert len(interfaces) == 4  # the stone lies beside and below the L


def test_a_thickness_in_millimetres_is_told_by_its_key_and_without_a_tolerance_that_would_be_refused(tmp_path: Path) -> None:
    squares = [polyline([(x + left, z) for x, z in SQUARE], layer) for left, layer in ((0.0, "A"), (1300.0, "B"))]
    told = " ".join(scene_of(tmp_path, dxf(squares), thickness=400.0, ground=["A"]).warnings)
    assert "drawing[0].thickness = 400 m is more than 10 m; if it is in mm, write 0.4." in told
    assert "tolerance" not in told, "no gap as wide as 0.1 m is an error of a survey"


def test_a_vast_circle_has_no_more_chords_than_memory_holds(tmp_path: Path) -> None:
    vast = drawn.rows(*drawn.begun("CIRCLE", "A"), (100, "AcDbCircle"), (10, 0), (20, 0), (40, 1e11))
    found = drawing.read_outlines(".dxf", dxf([vast]), None, 0.005)
    assert 100 < len(found.outlines[0].points) < 100_000


ON_TWO_LAYERS = [drawn.line((0, z), (1000, z), "BED") for z in (0, 500)] + [drawn.line((x, 0), (x, 500), "HEAD") for x in (0, 1000)]
ALL_TAKEN = "list layers of free blocks in `blocks` alone"
NONE_FREE = {  # entities, keys of the drawing, and end of the message
    "lines on two layers": (
        ON_TWO_LAYERS,
        {"ground": ["GROUND"]},
        'block: no block is free, so there is no structure; drawing "wall.dxf": it has 4 lines that enclose nothing; '
        f"lines enclose blocks together on one layer, and these are on BED, HEAD; `ground` takes 1 outline: {ALL_TAKEN}",
    ),
    "openings": (
        [polyline(SQUARE, "A"), polyline(ABOVE, "A")],
        {"ground": ["GROUND"], "openings": ["A"]},
        f'so there is no structure; drawing "wall.dxf": `openings` takes 2 outlines, `ground` takes 1 outline: {ALL_TAKEN}',
    ),
    "all ignored": (
        [polyline(SQUARE, "A"), *ON_TWO_LAYERS],
        {"ignore": ["*"]},
        f'drawing "wall.dxf": holds no outline of a block; `ignore` takes 2 outlines and 4 lines: {ALL_TAKEN}',
    ),
    "not named by `blocks`": (
        [polyline(SQUARE, "A")],
        {"ground": ["GROUND"], "blocks": ["GROUND*"]},
        f"`blocks` does not name the layer of 1 outline, `ground` takes 1 outline: {ALL_TAKEN}",
    ),
}


@pytest.mark.parametrize("name", NONE_FREE)
def test_a_drawing_without_a_free_block_says_what_became_of_its_outlines(name: str, tmp_path: Path) -> None:
    entities, keys, words = NONE_FREE[name]
    with pytest.raises(SceneError) as error:
        scene_of(tmp_path, dxf([*entities, polyline(BASE, "GROUND")]), **keys)
    assert str(error.value).endswith(words)


def test_layers_that_are_left_out_because_of_their_names_are_named(tmp_path: Path) -> None:
    (tmp_path / "wall.dxf").write_bytes(dxf([polyline(SQUARE, "TEXT"), polyline(ABOVE, "AXIS 2")]))
    with pytest.raises(SceneError) as error:
        scene_from_file(tmp_path / "wall.dxf", tmp_path)
    left_out = "layers that are left out because of their names: AXIS 2, TEXT; rename those of blocks"
    assert str(error.value).endswith(f"wall.dxf: holds no closed outline; {left_out}")


@pytest.mark.parametrize("other", ["A", "B"])
def test_an_overlap_is_named_with_its_place_and_its_layers_and_is_no_open_joint(other: str, tmp_path: Path) -> None:
    above = [(x + 250, z - 100) for x, z in ABOVE]
    content = dxf([polyline(SQUARE, "A"), polyline(above, other), polyline(BASE, "GROUND")])
    scene = scene_of(tmp_path, content, tables={"geometry": {"tolerance": 0.003}}, ground=["GROUND"], shift=[10.0, 0.0])
    assert not [words for words in scene.warnings if "not closed" in words]
    with pytest.raises(SceneError, match="overlap by about") as error:
        structural_model(scene)
    layers = '"A"' if other == "A" else '"A" and "B"'
    hint = "correct the outlines there, or list a layer without blocks in `ignore`"
    assert "overlap by about 0.1 m; blocks may touch but not share volume; near (10." in str(error.value)
    assert str(error.value).endswith(f", 0.45) m, on layer {layers} of the drawing: {hint}")


@pytest.mark.parametrize("name", REFUSED_SVG)
def test_a_bad_svg_is_refused_in_words(name: str, tmp_path: Path) -> None:
    content, words = REFUSED_SVG[name]
    with pytest.raises(SceneError) as error:
        scene_of(tmp_path, content, ".svg")
    assert words in str(error.value) and "\n" not in str(error.value)


def test_a_missing_drawing_and_a_link_out_of_the_folder_are_refused(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r'drawing "other\.dxf": cannot be read'):
        scene_of(tmp_path, b"", file="other.dxf")
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "out.dxf").symlink_to(tmp_path / "wall.dxf")
    with pytest.raises(SceneError, match="a link that leads out of the scene's folder"):
        scene_of(tmp_path / "inner", b"", file="out.dxf")


OPEN = [(0, 0), (1000, 0), (1000, 500), (0, 500), (0, 12)]  # 12 mm are missing


@pytest.mark.parametrize("points", [OPEN, OPEN[::-1]], ids=["forwards", "backwards"])
def test_an_outline_that_is_not_closed_is_warned_of(points: list[tuple[float, float]], tmp_path: Path) -> None:
    crack = polyline([(100, 600), (300, 800), (500, 700), (900, 900)], "CRACK", closed=False)
    scene = scene_of(
        tmp_path, dxf([polyline(BASE, "B"), polyline(points, "BRICK", closed=False), polyline(ABOVE, "B"), crack]), shift=[2.0, 1.0]
    )
    assert len(scene.blocks) == 2
    warning, of_crack = scene.warnings
    assert '1 line on layer "CRACK"' in of_crack
    x, z = points[0]
    place = f"({2.0 + 1e-3 * x:.4g}, {1.0 + 1e-3 * z:.4g}) m"
    assert all(words in warning for words in ('"wall.dxf"', 'layer "BRICK"', place, "open by 12 mm, so it is left out", "close"))


def test_many_open_outlines_are_one_warning_and_a_layer_may_have_any_name(tmp_path: Path) -> None:
    squares = [[(x, z) for x, z in ((k, 0), (k + 90, 0), (k + 90, 50), (k, 50), (k, 10 + k // 100))] for k in range(0, 500, 100)]
    shapes = "".join(f'<polyline points="{" ".join(f"{x},{-z}" for x, z in points)}" stroke="black"/>' for points in squares)
    layer = '<g xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" inkscape:groupmode="layer" inkscape:label="a&#10;b = [">'
    text = f'<svg xmlns="http://www.w3.org/2000/svg" width="600mm" height="600mm" viewBox="0 0 600 600">{layer}{shapes}</g>'
    (tmp_path / "wall.svg").write_text(f'{text}<rect x="0" y="100" width="500" height="50"/></svg>')
    written = tomllib.loads(scene_from_file(tmp_path / "wall.svg", tmp_path))
    (warning,) = build(written, "wall", tmp_path).warnings
    assert "5 outlines on layer" in warning and ", ... are open by up to 14 mm" in warning
    assert warning.count(" m,") <= 3 and "\n" not in warning


def test_what_a_drawing_hides_is_not_read(tmp_path: Path) -> None:
    document = ezdxf.new(units=4)
    space = document.modelspace()
    document.layers.add("FROZEN").freeze()
    document.layers.add("OFF").off()
    for points, layer in ((BASE, "B"), (SQUARE, "FROZEN"), (ABOVE, "OFF")):
        space.add_lwpolyline(points, close=True, dxfattribs={"layer": layer})
    space.add_lwpolyline(ABOVE, close=True, dxfattribs={"layer": "B", "invisible": 1})
    inner = document.blocks.new("INNER")
    inner.add_lwpolyline(SQUARE, close=True, dxfattribs={"layer": "B"})
    inner.add_lwpolyline(SQUARE, close=True, dxfattribs={"layer": "0"})
    space.add_blockref("INNER", (5000, 0), dxfattribs={"layer": "FROZEN"})
    space.add_blockref("INNER", (5000, 0), dxfattribs={"layer": "OFF"})  # an entity on another layer is seen
    document.saveas(tmp_path / "hidden.dxf")
    scene = scene_of(tmp_path, (tmp_path / "hidden.dxf").read_bytes())
    np.testing.assert_allclose(sorted(scene.blocks.high[:, 2]), [0.0, 0.5])
    assert scene.drawn[0].ignored == {"hidden entities": 5}
