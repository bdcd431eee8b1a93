"""DXF files with a fault that a reader could pass over: a message names the entities that would vanish or move."""

import io
from pathlib import Path

import ezdxf
import pytest
from ezdxf.document import Drawing
from ezdxf.xclip import XClip
from wall_drawings import dxf, polyline

from la_core.drawing import Drawn, read_outlines
from la_core.scene import load_scene, scene_from_file

SQUARE = [(0, 0), (1000, 0), (1000, 500), (0, 500)]
BESIDE = [(1000, 0), (2000, 0), (2000, 500), (1000, 500)]


def with_handle(entity: str, handle: str) -> str:
    """An entity that has a handle."""
    kind, rest = entity.split("100\n", 1)
    return f"{kind}5\n{handle}\n100\n{rest}"


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (dxf([with_handle(polyline(points, "A"), "1F") for points in (SQUARE, BESIDE)]), "with the same handle 1F (code 5)"),
        (dxf([polyline(SQUARE, "A").replace("\n500\n", "\n500,25\n")]), 'holds "500,25" near its line '),
        (dxf([polyline(SQUARE, "A").replace("\n500\n", "\n1.#QNAN\n")]), 'holds "1.#QNAN" near its line '),
    ],
)
def test_a_file_whose_entities_would_vanish_or_move_is_refused(content: bytes, words: str) -> None:
    with pytest.raises(ValueError) as error:
        read_outlines(".dxf", content, None, 0.005)
    assert words in str(error.value)


def test_handles_that_differ_are_read() -> None:
    content = dxf([with_handle(polyline(points, "A"), handle) for points, handle in ((SQUARE, "1E"), (BESIDE, "1F"))])
    assert len(read_outlines(".dxf", content, None, 0.005).outlines) == 2


def read(document: Drawing) -> Drawn:
    text = io.StringIO()
    document.write(text)
    return read_outlines(".dxf", text.getvalue().encode(), None, 0.005)


@pytest.mark.parametrize(
    ("knots", "weights", "words"),
    [([0, 0, 1, 1], [], "knot value count: 4 < 7"), ([0, 0, 0, 0.5, 1, 1, 1], [1, 1], "weight count: 2 != 4")],
)
def test_a_spline_that_lacks_knots_or_weights_does_not_vanish(knots: list[float], weights: list[float], words: str) -> None:
    document = ezdxf.new(units=4)
    spline = document.modelspace().add_spline(degree=2)
    spline.control_points, spline.knots, spline.weights = [(*point, 0) for point in SQUARE], knots, weights
    with pytest.raises(ValueError, match=f"holds a SPLINE that cannot be read: invalid {words}; save it again"):
        read(document)


def with_insert() -> Drawing:
    """A document in mm with an insert of a block that holds one stone."""
    document = ezdxf.new(units=4)
    document.blocks.new("STONE").add_lwpolyline(SQUARE, close=True)
    document.modelspace().add_blockref("STONE", (0, 0))
    return document


def test_a_binary_file_is_told_to_be_saved_as_text() -> None:
    content = io.BytesIO()
    with_insert().write(content, fmt="bin")
    with pytest.raises(ValueError, match="is a binary DXF file; save it as a DXF file of text"):
        read_outlines(".dxf", content.getvalue(), None, 0.005)


def test_names_of_layers_that_differ_by_capitals_are_one_layer() -> None:
    document = ezdxf.new(units=4)
    document.layers.add("Stones", color=3)
    for k in range(4):
        document.modelspace().add_line(SQUARE[k], SQUARE[k - 1], dxfattribs={"layer": ("STONES", "stones")[k % 2]})
    assert {place: len(lines) for place, lines in read(document).lines.items()} == {("Stones", "green"): 4}


def test_a_layer_that_the_file_does_not_describe_is_white() -> None:
    assert read_outlines(".dxf", dxf([polyline(SQUARE, "A")]), None, 0.005).places == {("A", "white")}


def test_drawings_in_other_files_are_counted_and_told_of_in_a_new_scene(tmp_path: Path) -> None:
    document = with_insert()
    document.add_xref_def("arch.dwg", "ARCH")
    document.modelspace().add_blockref("ARCH", (0, 0))
    drawn = read(document)
    assert drawn.ignored == {"drawings in other files": 1}
    assert len(drawn.outlines) == 1
    document.saveas(tmp_path / "wall.dxf")
    assert "# CHECK: drawings in other files are not read (1)" in scene_from_file(tmp_path / "wall.dxf", tmp_path)


def test_a_new_scene_tells_of_inserts_of_missing_blocks(tmp_path: Path) -> None:
    document = with_insert()
    document.modelspace().add_blockref("ARCH", (0, 0))
    document.saveas(tmp_path / "wall.dxf")
    assert "# CHECK: inserts of missing blocks show nothing (1)" in scene_from_file(tmp_path / "wall.dxf", tmp_path)


@pytest.mark.parametrize(
    ("in_other_file", "words"), [(True, "drawings in other files are not read (1)"), (False, "inserts of missing blocks show nothing (1)")]
)
def test_every_command_warns_of_what_the_file_does_not_hold(in_other_file: bool, words: str, tmp_path: Path) -> None:
    document = with_insert()
    if in_other_file:
        document.add_xref_def("arch.dwg", "ARCH")
    document.modelspace().add_blockref("ARCH", (0, 0))
    document.saveas(tmp_path / "wall.dxf")
    (tmp_path / "wall.toml").write_text(scene_from_file(tmp_path / "wall.dxf", tmp_path), encoding="utf-8")
    assert any(warning.startswith(f'drawing "wall.dxf": {words}; ') for warning in load_scene(tmp_path / "wall.toml").warnings)


def test_every_command_warns_of_what_may_be_a_stone_and_is_not_read(tmp_path: Path) -> None:
    document = with_insert()
    document.modelspace().add_mline([(0, 0), (500, 0)])
    document.modelspace().add_3dface([(0, 0), (500, 0), (500, 300), (0, 300)])
    document.modelspace().add_hatch()
    document.saveas(tmp_path / "wall.dxf")
    (tmp_path / "wall.toml").write_text(scene_from_file(tmp_path / "wall.dxf", tmp_path), encoding="utf-8")
    warnings = " ".join(load_scene(tmp_path / "wall.toml").warnings)
    assert 'drawing "wall.dxf": entities that may be stones are not read (1 MLINE, 1 3DFACE); ' in warnings


def test_the_clip_path_of_an_insert_is_counted() -> None:
    document = with_insert()
    clip = XClip(next(iter(document.modelspace())))
    clip.set_block_clipping_path([(0, 0), (500, 500)])
    assert read(document).ignored == {"clip paths": 1}
    clip.disable_clipping()
    assert read(document).ignored == {}


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("100\nAcDbPolyline\n", "", "missing 'AcDbPolyline' subclass in LWPOLYLINE"),
        ("0\nLWPOLYLINE\n", "0\nPOLYLINE\n66\n1\n", "Expected DXF entity"),  # without a SEQEND
    ],
)
def test_a_polyline_that_lacks_a_part_of_its_grammar_is_refused_with_what_to_do(old: str, new: str, words: str) -> None:
    content = dxf([polyline(SQUARE, "A").replace(old, new), polyline(BESIDE, "A")])
    with pytest.raises(ValueError, match=f"is not a whole DXF file: {words}.*; save it again in a CAD program"):
        read_outlines(".dxf", content, None, 0.005)
