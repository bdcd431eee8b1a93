"""`crosscheck new --from` writes a scene for a drawing or a file of bodies, and marks the values that the file does not state."""

import tomllib
from pathlib import Path

import ezdxf
import mesh_files as meshes
import numpy as np
import pytest
import wall_drawings as drawn
from wall_drawings import dxf, polyline

from comparison.cli.commands import main
from la_core.errors import SceneError
from la_core.geometry import find_interfaces
from la_core.scene import build, load_scene, scene_from_file

SQUARE = [(0, 0), (1000, 0), (1000, 500), (0, 500)]
ABOVE = [(0, 500), (1000, 500), (1000, 1000), (0, 1000)]
BASE = [(0, -100), (1000, -100), (1000, 0), (0, 0)]


def test_a_scene_for_a_drawing_is_written_and_can_be_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "wall.dxf").write_bytes(drawn.wall_dxf())
    assert main(["new", "--from", str(tmp_path / "wall.dxf")]) == 0
    scene = load_scene(tmp_path / "wall.toml")
    assert len(scene.blocks) == 9 and scene.support_twist is not None
    assert not scene.repairs.unclosed and scene.repairs.gaps_closed == 14
    assert main(["new", "--from", str(tmp_path / "wall.dxf")]) == 2
    assert "exists already and is not replaced" in capsys.readouterr().err


def test_the_hint_on_friction_names_layers_that_may_have_a_joint(tmp_path: Path) -> None:
    """Most outlines are on the layer of the stones. Ground and support are held and have no joint with each other."""
    entities = [polyline(outline, "ARCH") for outline in (SQUARE, ABOVE)] + [polyline(BASE, "GROUND")]
    (tmp_path / "arch.dxf").write_bytes(dxf(entities))
    assert 'between = ["layer:ARCH", "layer:GROUND"]' in scene_from_file(tmp_path / "arch.dxf", tmp_path)
    (tmp_path / "one.dxf").write_bytes(dxf([polyline(SQUARE, "STONES")]))
    assert "[[friction]]" not in scene_from_file(tmp_path / "one.dxf", tmp_path)


def test_a_structure_without_ground_gets_a_base(tmp_path: Path) -> None:
    page = '<svg xmlns="http://www.w3.org/2000/svg" width="2000mm" height="2000mm" viewBox="0 0 2000 2000">'
    (tmp_path / "stones.svg").write_text(f'{page}<g id="A"><polygon points="0,0 1000,0 1000,-500 0,-500"/></g></svg>')
    assert main(["new", "-q", "--from", str(tmp_path / "stones.svg")]) == 0
    scene = load_scene(tmp_path / "stones.toml")
    assert set(scene.blocks.names) == {"base", "settling base", "block 1"}
    assert len(find_interfaces(scene.blocks)) == 2


def test_a_new_scene_tells_of_what_a_clip_path_would_cut_off(tmp_path: Path) -> None:
    page = '<svg xmlns="http://www.w3.org/2000/svg" width="2000mm" height="2000mm" viewBox="0 0 2000 2000">'
    stone = '<polygon clip-path="url(#left)" points="0,0 1000,0 1000,-500 0,-500"/>'
    (tmp_path / "stones.svg").write_text(
        f'{page}<clipPath id="left"><rect width="500" height="500"/></clipPath><g id="A">{stone}</g></svg>'
    )
    assert "# CHECK: clip paths are not read (1)" in scene_from_file(tmp_path / "stones.svg", tmp_path)


def test_a_drawing_in_the_grid_of_a_country_is_shifted_to_the_origin(tmp_path: Path) -> None:
    """Millimetres from an origin 6,000 km away leave too few digits for joints."""
    far = [[(x + 3_512_345_678, z + 5_401_234_567) for x, z in outline] for outline in (BASE, SQUARE, ABOVE)]
    (tmp_path / "far.dxf").write_bytes(dxf([polyline(far[0], "GROUND"), polyline(far[1], "A"), polyline(far[2], "A")]))
    assert main(["new", "-q", "--from", str(tmp_path / "far.dxf")]) == 0
    scene = load_scene(tmp_path / "far.toml")
    assert np.abs(scene.blocks.vertices).max() < 3.0 and len(find_interfaces(scene.blocks)) == 2


@pytest.mark.parametrize(("degrees", "is_told"), [(-30.0, True), (-2.0, True), (0.5, False), (2.0, True), (90.0, False)])
def test_a_turned_drawing_is_told_of(degrees: float, is_told: bool, tmp_path: Path) -> None:
    turn = np.exp(1j * np.radians(degrees))
    turned = [[((x + 1j * z) * turn).real, ((x + 1j * z) * turn).imag] for outline in (SQUARE, ABOVE) for x, z in outline]
    (tmp_path / "turned.dxf").write_bytes(dxf([polyline(turned[:4], "A"), polyline(turned[4:], "A")]))
    text = scene_from_file(tmp_path / "turned.dxf", tmp_path)
    assert (f"# CHECK: most edges slope by {abs(degrees):.0f} degrees" in text) is is_told
    assert is_told or "slope" not in text


@pytest.mark.parametrize("lean", [0.1, 0.2])
def test_a_leaning_wall_with_level_beds_is_not_turned(lean: float, tmp_path: Path) -> None:
    stones = [[(x + lean * z, z) for x, z in outline] for outline in (SQUARE, ABOVE)]
    (tmp_path / "leaning.dxf").write_bytes(dxf([polyline(stone, "A") for stone in stones]))
    assert "slope" not in scene_from_file(tmp_path / "leaning.dxf", tmp_path)


def test_the_edges_of_rubble_do_not_look_like_those_of_a_turned_drawing(tmp_path: Path) -> None:
    stones = [[(0, 0), (900, 100), (800, 600), (100, 500)], [(100, 500), (800, 600), (400, 1200)], [(900, 100), (1500, 0), (800, 600)]]
    (tmp_path / "rubble.dxf").write_bytes(dxf([polyline(stone, "A") for stone in stones]))
    assert "slope" not in scene_from_file(tmp_path / "rubble.dxf", tmp_path)


def test_a_new_scene_marks_what_may_be_wrong_in_its_drawing(tmp_path: Path) -> None:
    """The scene marks an open outline, a unit that makes bricks 240 m long, and a support without ground, but no unread layer."""
    courses = [[(x, z), (x + 240, z), (x + 240, z + 30), (x, z + 30)] for z in (0, 30, 60) for x in (0, 240)]
    missing = [*courses[2], (0, 40)]
    pad = polyline([(0, -100), (480, -100), (480, 0), (0, 0)], "SUPPORT")
    drawings = [pad, *(polyline(points, "BRICK") for k, points in enumerate(courses) if k != 2), polyline(missing, "BRICK", closed=False)]
    (tmp_path / "wall.dxf").write_bytes(dxf([*drawings, polyline(SQUARE, "DIM")], unit=6))
    text = scene_from_file(tmp_path / "wall.dxf", tmp_path)
    for words in (
        '# CHECK: the outline on layer "BRICK" that begins at (0, 30) m is open by 10000 mm, so it is left out',
        'unit      = "m"  # CHECK: the file says it, and most blocks are then 240 m long or more',
        "# CHECK: no layer was taken for ground",
        'between = ["layer:BRICK", "layer:SUPPORT"]',
    ):
        assert words in text, words
    (tmp_path / "wall.dxf").write_bytes(dxf([*drawings, polyline(SQUARE, "DIM")]))
    text = scene_from_file(tmp_path / "wall.dxf", tmp_path)
    assert "joints    = 0 " in text  # the place of the missing brick, 30 mm wide, is no joint
    assert 'unit      = "mm"\n' in text and "open by 10 mm" in text


@pytest.mark.parametrize(
    ("layers", "lists"),
    [
        (
            ("MAUERSTEINE", "STURZ", "TÜR", "FUNDAMENT", "FUNDAMENT_SENKUNG", "ACHSEN"),
            {"openings": ["TÜR"], "ground": ["FUNDAMENT"], "support": ["FUNDAMENT_SENKUNG"], "ignore": ["ACHSEN"]},
        ),
        (
            ("KEILSTEINE", "WIDERLAGER_LINKS", "WIDERLAGER_RECHTS_SETZUNG", "FEST", "BEMASSUNG"),
            {"ground": ["FEST", "WIDERLAGER_LINKS"], "support": ["WIDERLAGER_RECHTS_SETZUNG"], "ignore": ["BEMASSUNG"], "openings": None},
        ),
        (
            ("Pierres", "Linteau porte", "Porte", "Fenêtre", "Fondation", "Fondation-tassement", "Cotes"),
            {"openings": ["Fenêtre", "Porte"], "ground": ["Fondation"], "support": ["Fondation-tassement"], "ignore": ["Cotes"]},
        ),
        (
            ("PIETRE", "STIPITE PORTA", "PORTA", "FONDAZIONE", "CEDIMENTO", "ASSI"),
            {"openings": ["PORTA"], "ground": ["FONDAZIONE"], "support": ["CEDIMENTO"], "ignore": ["ASSI"]},
        ),
        (
            ("SILLARES", "DINTEL PUERTA", "PUERTA", "CIMIENTO", "CIMIENTO ASIENTO", "EJES"),
            {"openings": ["PUERTA"], "ground": ["CIMIENTO"], "support": ["CIMIENTO ASIENTO"], "ignore": ["EJES"]},
        ),
    ],
)
def test_layers_are_guessed_in_german_french_italian_and_spanish(
    layers: tuple[str, ...], lists: dict[str, list[str]], tmp_path: Path
) -> None:
    document = ezdxf.new(units=4)
    for k, layer in enumerate(layers):
        corners = [(1000 * k + x, z) for x, z in ((0, 0), (900, 0), (900, 500), (0, 500))]
        document.modelspace().add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
    document.saveas(tmp_path / "wall.dxf")
    (table,) = tomllib.loads(scene_from_file(tmp_path / "wall.dxf", tmp_path))["drawing"]
    assert {key: table.get(key) for key in ("openings", "ground", "support", "ignore")} == lists


@pytest.mark.parametrize("unit", [1.0, 1000.0])
def test_bodies_become_a_scene_without_typing(unit: float, tmp_path: Path) -> None:
    bodies = {name: unit * 2.0 * np.asarray(vertices) for name, (vertices, _) in meshes.wall().items()}
    (tmp_path / "bodies.obj").write_text(meshes.obj(bodies))
    assert main(["new", "-q", "--from", str(tmp_path / "bodies.obj")]) == 0
    scene = load_scene(tmp_path / "bodies.toml")
    assert len(scene.blocks) >= len(bodies)
    assert 0.1 < np.ptp(scene.blocks.vertices, axis=0).max() < 100.0


@pytest.mark.parametrize(("name", "words"), [("wall.dwg", "is neither a drawing nor a file of bodies"), ("none.dxf", "cannot be read")])
def test_what_is_no_drawing_is_refused(name: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "--from", str(tmp_path / name)]) == 2
    assert words in capsys.readouterr().err


def test_bodies_in_the_current_folder_become_a_scene_beside_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    meshes.as_ply_folder(tmp_path)
    monkeypatch.chdir(tmp_path / "stones")
    assert main(["new", "--from", ".", "-q"]) == 0
    assert len(load_scene(tmp_path / "stones.toml").blocks) >= len(meshes.wall())


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("bodies.v1", 'whose name ends in ".v1" is taken for a file'),
        ("plan.svg", 'whose name ends in ".svg" is taken for a file'),
        ("/", "/: has no name"),
    ],
)
def test_a_folder_that_gives_a_scene_no_name_is_refused(
    name: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for folder in ("bodies.v1", "plan.svg"):
        (tmp_path / folder).mkdir()
    assert main(["new", "--from", name]) == 2
    assert words in capsys.readouterr().err


def test_a_drawing_on_paper_is_told_to_state_its_scale(tmp_path: Path) -> None:
    """At 1 : 50 a block of 0.5 m is 10 mm long; the scale that the comment asks for is a key of the table."""
    page = '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">{}</svg>'
    (tmp_path / "plan.svg").write_text(page.format("".join(f'<rect x="{10 * i}" y="0" width="10" height="5"/>' for i in range(4))))
    text = scene_from_file(tmp_path / "plan.svg", tmp_path)
    assert "a drawing to scale 1 : 50 needs scale = 50" in text
    scaled = text.replace("thickness =", "scale = 50\nthickness =").replace("tolerance = 0.003", "tolerance = 0.001")
    scene = build(tomllib.loads(scaled), "plan", tmp_path)
    assert scene.blocks.volume[scene.blocks.free] == pytest.approx(np.full(4, 0.5 * 0.25 * 0.4), rel=1e-6)


@pytest.mark.parametrize("said", [1, 4])
def test_a_unit_in_which_no_outline_is_a_block_is_not_believed(said: int, tmp_path: Path) -> None:
    """Bricks of 250 by 65 mm drawn in metres, under a header that says inches or millimetres."""
    bricks = [[(x, z), (x + 0.25, z), (x + 0.25, z + 0.065), (x, z + 0.065)] for x in (0.0, 0.25) for z in (0.0, 0.065)]
    (tmp_path / "wall.dxf").write_bytes(dxf([polyline(brick, "A") for brick in bricks], unit=said))
    assert main(["new", "-q", "--from", str(tmp_path / "wall.dxf")]) == 0
    text = (tmp_path / "wall.toml").read_text()
    unit = {1: 0.0254, 4: 0.001}[said]
    assert f'unit      = "m"  # CHECK: a unit of {unit} m, which the file says, makes every outline thinner than 0.003 m' in text
    assert len(load_scene(tmp_path / "wall.toml").blocks) == len(bricks) + 2
    (tmp_path / "own.toml").write_text(text.replace('unit      = "m"', ""))
    with pytest.raises(
        SceneError, match=r"4 outlines are thinner than the tolerance, where one unit of the file is .* m; state another `unit`"
    ):
        load_scene(tmp_path / "own.toml")


def test_numbers_of_a_large_drawing_far_away_are_written_in_full(tmp_path: Path) -> None:
    stone = [(0, -2_000_000), (1_000_000, -2_000_000), (1_000_000, -1_999_000), (0, -1_999_000)]
    (tmp_path / "wall.dxf").write_bytes(dxf([polyline(stone, "A")]))
    text = scene_from_file(tmp_path / "wall.dxf", tmp_path)
    assert "most blocks are then 1000 m long or more" in text and "shift     = [0, 2000]" in text


@pytest.mark.parametrize(("unit", "why"), [(None, "does not say its unit"), (20, "has an unknown code for its unit ($INSUNITS = 20)")])
def test_a_guessed_unit_is_marked_with_the_reason(unit: int | None, why: str, tmp_path: Path) -> None:
    stone = [(0, 0), (1000, 0), (1000, 500), (0, 500)]
    (tmp_path / "wall.dxf").write_bytes(dxf([polyline(stone, "A")], unit=unit))
    assert f'unit      = "mm"  # CHECK: the file {why}\n' in scene_from_file(tmp_path / "wall.dxf", tmp_path)


@pytest.mark.parametrize(("file", "step"), [("wall.pdf", "convert a PDF to SVG, such as by `pdftocairo -svg"), ("wall.DWG", "save a DWG")])
def test_a_file_of_another_format_is_to_be_converted(file: str, step: str, tmp_path: Path) -> None:
    (tmp_path / file).write_bytes(b"%PDF-1.7")
    with pytest.raises(SceneError, match=f"is neither a drawing nor a file of bodies; {step}"):
        scene_from_file(tmp_path / file, tmp_path)
    with pytest.raises(SceneError, match=rf"`file` must end in \.dxf or \.svg; {step}"):
        build({"drawing": [{"file": file, "thickness": 0.3}], "joint": {"friction": 0.6}}, "wall", tmp_path)
