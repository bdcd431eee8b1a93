"""Imported bodies: the same structure by any format, every defect by name, and nothing outside of the scene's folder is read."""

import json
import struct
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import make_rubble_wall
import numpy as np
import pytest
import scenes
from conftest import CrossChecked

from comparison.cli.commands import main
from la_core.analysis.case_file import scene_digest
from la_core.errors import SceneError
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble
from la_core.scene.generators import mesh, mesh_surface
from la_core.scene.scene import Scene, load_scene

EXACT = 1e-6  # of the weight: residuals of a solved answer are below this
SINGLE = 1e-5  # of the weight: what coordinates in single precision change in lengths of a block
DAMAGES = 20  # a format
AS_WRITTEN = 1e-9  # m: half a unit of the last digit written, and round-off

Corners = np.ndarray
BOX_FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
TRIANGLES = tuple(t for a, b, c, d in BOX_FACES for t in ((a, b, c), (a, c, d)))


def corners(low: Sequence[float], high: Sequence[float]) -> Corners:
    (x0, y0, z0), (x1, y1, z1) = low, high
    return np.array([(x, y, z) for z in (z0, z1) for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))])


def wall() -> dict[str, tuple[Corners, str]]:
    """Three courses in running bond on a base in two parts that meet at x = 1.2, and the role of every block."""
    bodies = {}
    for course in range(3):
        cuts = [0.0, 0.4, 0.8, 1.2, 1.6] if course % 2 == 0 else [0.0, 0.2, 0.6, 1.0, 1.4, 1.6]
        for number, (start, end) in enumerate(pairwise(cuts)):
            bodies[f"stone {course}.{number}"] = (corners((start, 0.0, 0.2 * course), (end, 0.3, 0.2 * (course + 1))), "free")
    bodies["ground"] = (corners((0.0, 0.0, -0.2), (1.2, 0.3, 0.0)), "fixed")
    bodies["pad"] = (corners((1.2, 0.0, -0.2), (1.6, 0.3, 0.0)), "support")
    return bodies


def obj(bodies: dict[str, Corners], faces: Sequence[Sequence[int]] = BOX_FACES, part: str = "o") -> str:
    lines, first = ["mtllib /etc/passwd"], 1
    for name, vertices in bodies.items():
        lines += [f"{part} {name}", *(f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist())]
        lines += ["f " + " ".join(f"{corner + first}//1" for corner in face) for face in faces]
        first += len(vertices)
    return "\n".join(lines) + "\n"


def ply(vertices: Corners) -> str:
    head = ["ply", "format ascii 1.0", "comment TextureFile /etc/passwd", f"element vertex {len(vertices)}"]
    head += [f"property double {axis}" for axis in "xyz"] + [f"element face {len(BOX_FACES)}", "property list uchar int vertex_indices"]
    rows = [" ".join(map(repr, point)) for point in vertices.tolist()] + ["4 " + " ".join(map(str, face)) for face in BOX_FACES]
    return "\n".join([*head, "end_header", *rows]) + "\n"


def stl(vertices: Corners, triangles: Sequence[Sequence[int]] = TRIANGLES) -> bytes:
    """Binary, so in single precision."""
    rows = [struct.pack("<12fH", 0.0, 0.0, 0.0, *vertices[list(triangle)].ravel(), 0) for triangle in triangles]
    return b"\0" * 80 + struct.pack("<I", len(rows)) + b"".join(rows)


def compas_mesh(vertices: Corners, keys: Callable[[int], Any] = int) -> dict[str, Any]:
    return {
        "vertex": {str(k): dict(zip("xyz", point, strict=True)) for k, point in enumerate(vertices.tolist())},
        "face": {str(k): [keys(corner) for corner in face] for k, face in enumerate(BOX_FACES)},
    }


def compas(bodies: dict[str, tuple[Corners, str]]) -> str:
    """As compas 2 and compas_assembly 0.7 write an assembly."""
    node = {}
    for key, (name, (vertices, role)) in enumerate(bodies.items()):
        block = {"dtype": "compas_assembly.datastructures/Block", "data": compas_mesh(vertices), "name": name}
        node[str(key)] = {"block": block, "is_support": role != "free"}
    graph = {"dtype": "compas.datastructures/Graph", "data": {"node": node, "edge": {}}}
    return json.dumps({"dtype": "compas_assembly.datastructures/Assembly", "data": {"attributes": {}, "graph": graph}})


def compas_of_old(bodies: dict[str, tuple[Corners, str]]) -> str:
    """As compas_assembly 0.1 wrote it: nameless blocks beside a network, corners of faces as texts."""
    marks = {str(key): {"is_support": role != "free"} for key, (_, role) in enumerate(bodies.values())}
    blocks = {str(key): compas_mesh(vertices, str) for key, (vertices, _) in enumerate(bodies.values())}
    return json.dumps({"assembly": {"vertex": marks}, "blocks": blocks})


def scene_text(file: str, settlement: Any = scenes.DOWN, gravity: Sequence[float] = (0.0, 0.0, -9.81), **entries: Any) -> str:
    roles = {"fixed": ["ground"], "support": ["pad"]} if "fixed" not in entries else {}
    table = "\n".join(["[[mesh]]", *(f"{key} = {scenes.inline(value)}" for key, value in {"file": file, **roles, **entries}.items())])
    return scenes.text(table, settlement=settlement, gravity=gravity, plane=False)


def written(folder: Path, file: str, content: str | bytes, **entries: Any) -> Path:
    """A scene beside a mesh with that content."""
    path = folder / file
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    scene = folder / "scene.toml"
    scene.write_text(scene_text(file, **entries))
    return scene


def reaction(scene: Scene) -> float:
    solution = solve_associated(assemble(scene), Drive.YIELDING)
    assert solution.status is Status.SOLVED
    return solution.value / scene.weight


def refusal(path: Path) -> str:
    with pytest.raises(SceneError) as error:
        load_scene(path)
    message = str(error.value)
    assert message.startswith(str(path)) and "\n" not in message
    return message


def boxes() -> Scene:
    parts = [scenes.box(name, vertices[0], vertices[6], role) for name, (vertices, role) in wall().items()]
    return scenes.build(*parts, plane=False)


def as_obj(folder: Path) -> Path:
    return written(folder, "wall.obj", obj({name: vertices for name, (vertices, _) in wall().items()}))


def as_obj_groups(folder: Path) -> Path:
    text = "o everything\ng default\n" + obj({name: vertices for name, (vertices, _) in wall().items()}, TRIANGLES, part="g")
    return written(folder, "wall.obj", text)


def as_ply_folder(folder: Path) -> Path:
    for name, (vertices, _) in wall().items():
        path = written(folder, f"stones/{name}.ply", ply(vertices))
    path.write_text(scene_text("stones"))
    return path


def as_stl_folder(folder: Path) -> Path:
    for name, (vertices, _) in wall().items():
        path = written(folder, f"stones/{name}.stl", stl(1000.0 * vertices))
    path.write_text(scene_text("stones", scale=0.001))
    return path


def as_compas(folder: Path) -> Path:
    return written(folder, "wall.json", compas(wall()), fixed=[], support=["pad"])


def as_old_compas(folder: Path) -> Path:
    return written(folder, "wall.json", compas_of_old(wall()), fixed=[], support=[f"block {len(wall()) - 1}"])


# --- one structure, whatever its format ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("write", "tolerance"),
    [
        (as_obj, EXACT), (as_obj_groups, EXACT), (as_ply_folder, EXACT), (as_stl_folder, SINGLE),
        (as_compas, EXACT), (as_old_compas, EXACT),
    ],
)  # fmt: skip
def test_a_wall_is_the_same_by_any_format(write: Callable[[Path], Path], tolerance: float, tmp_path: Path) -> None:
    imported, typed = load_scene(write(tmp_path)), boxes()
    assert sorted(imported.blocks.role) == sorted(typed.blocks.role)
    assert np.sort(imported.blocks.mass) == pytest.approx(np.sort(typed.blocks.mass), rel=tolerance, nan_ok=True)
    assert np.all(np.bincount(imported.blocks.face_block) == len(BOX_FACES))
    assert len(assemble(imported).points) == len(assemble(typed).points)
    assert reaction(imported) == pytest.approx(reaction(typed), abs=tolerance)


def test_names_roles_and_densities_come_from_the_table(tmp_path: Path) -> None:
    bodies = {name: vertices for name, (vertices, _) in wall().items()}
    scene = load_scene(written(tmp_path, "w.obj", obj(bodies), name="west", fixed=["gr?und"], support=["p*"], density=1000.0))
    assert scene.blocks.names == tuple(f"west {name}" for name in bodies)
    assert {name: scenes.ROLE_NAMES[int(role)] for name, role in zip(bodies, scene.blocks.role, strict=True)} == {
        name: role for name, (_, role) in wall().items()
    }
    assert scene.weight == pytest.approx(1000.0 * 9.81 * 1.6 * 0.3 * 0.6)


def test_a_mesh_is_scaled_then_turned_then_shifted(tmp_path: Path) -> None:
    bodies = {name: 1000.0 * vertices for name, (vertices, _) in wall().items()}
    turn = {"axis": [0.0, 0.0, 2.0], "degrees": 90.0}
    scene = load_scene(written(tmp_path, "w.obj", obj(bodies), scale=0.001, turn=turn, shift=[10.0, 20.0, 30.0]))
    assert scene.blocks.low.min(axis=0) == pytest.approx([10.0 - 0.3, 20.0, 30.0 - 0.2])
    assert scene.blocks.high.max(axis=0) == pytest.approx([10.0, 20.0 + 1.6, 30.0 + 0.6])


# --- the shipped wall of irregular stones -------------------------------------------------------------------------------------


def test_the_rubble_wall_is_what_its_script_makes_and_fills_its_box() -> None:
    scene = scenes.shipped("rubble_wall")
    made = make_rubble_wall.stones()
    assert int(scene.blocks.free.sum()) == len(made)
    for vertices, k in zip(made, np.flatnonzero(scene.blocks.free), strict=True):
        own = scene.blocks.vertices[scene.blocks.vertex_start[k] : scene.blocks.vertex_start[k + 1]]
        assert own.min(axis=0) == pytest.approx(vertices.min(axis=0), abs=AS_WRITTEN)
        assert own.max(axis=0) == pytest.approx(vertices.max(axis=0), abs=AS_WRITTEN)
    box = make_rubble_wall.LENGTH * make_rubble_wall.DEPTH * make_rubble_wall.HEIGHT
    assert scene.weight == pytest.approx(2200.0 * 9.81 * box, rel=EXACT)


@pytest.mark.parametrize("seed", range(2))
def test_the_rubble_wall_turned_with_its_gravity_and_settlement_has_the_same_answer(seed: int, tmp_path: Path) -> None:
    chance = np.random.default_rng(seed)
    axis, degrees, shift = chance.normal(size=3), float(chance.uniform(0.0, 360.0)), chance.uniform(-5.0, 5.0, 3)
    turn = scenes.rotation(axis, np.radians(degrees))
    content = make_rubble_wall.OBJ.read_bytes()
    upright = load_scene(written(tmp_path, "rubble.obj", content))
    moved = load_scene(
        written(
            tmp_path,
            "rubble.obj",
            content,
            turn={"axis": axis, "degrees": degrees},
            shift=shift,
            gravity=turn @ [0.0, 0.0, -9.81],
            settlement=turn @ scenes.DOWN,
        )
    )
    assert moved.blocks.centroid == pytest.approx(upright.blocks.centroid @ turn.T + shift, abs=AS_WRITTEN)
    assert reaction(moved) == pytest.approx(reaction(upright), abs=EXACT)


def test_both_methods_agree_on_irregular_stones(cross_checked: Callable[[str], CrossChecked]) -> None:
    assert cross_checked("rubble_wall").summary["verdict"] == "agree"


# --- defects of bodies --------------------------------------------------------------------------------------------------------

CUBE = corners((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
FLIPPED = (BOX_FACES[0][::-1], *BOX_FACES[1:])


def pyramid_dent(depth: float) -> tuple[Corners, tuple[tuple[int, ...], ...]]:
    """A cube whose top is a pyramid that points down by `depth`."""
    top = tuple((a, b, 8) for a, b in ((4, 5), (5, 6), (6, 7), (7, 4)))
    return np.vstack([CUBE, [0.5, 0.5, 1.0 - depth]]), (BOX_FACES[0], *BOX_FACES[2:], *top)


def folded_roof() -> tuple[Corners, tuple[tuple[int, ...], ...]]:
    """A cube with two corners of its top raised by 0.2 and the diagonal that makes a valley, 0.2 / sqrt(1.08) below the ridge's planes."""
    vertices = CUBE.copy()
    vertices[[5, 7], 2] += 0.2
    return vertices, (BOX_FACES[0], (4, 5, 6), (4, 6, 7), *(t for a, b, c, d in BOX_FACES[2:] for t in ((a, b, c), (a, c, d))))


def two_cubes() -> tuple[Corners, tuple[tuple[int, ...], ...]]:
    return np.vstack([CUBE, CUBE + np.array([3.0, 0.0, 0.0])]), (*BOX_FACES, *(tuple(k + 8 for k in face) for face in BOX_FACES))


BODIES: dict[str, tuple[tuple[Corners, Sequence[Sequence[int]]], str]] = {
    "open": ((CUBE, BOX_FACES[1:]), "is open: 4 of its 12 edges lack a partner"),
    "one face turned": ((CUBE, FLIPPED), "has inconsistent normals: 4 of its 12 edges run the same way in both faces"),
    "three faces at an edge": (
        (np.vstack([CUBE, [0.5, -0.5, 0.5]]), (*BOX_FACES, (0, 1, 8))),
        "is open: 2 of its 14 edges lack a partner",
    ),
    "a face twice": ((CUBE, (*BOX_FACES, BOX_FACES[1], BOX_FACES[1][::-1])), "4 of its 12 edges belong to more than two faces"),
    "dented": (pyramid_dent(0.3), "is not convex: its deepest dent, near (0.5, 0.5, 0.7), lies 0.3 m below its convex hull"),
    "valley": (folded_roof(), "is not convex: its deepest dent, near (0.5, 0.5, 1), lies 0.192 m below its convex hull"),
    "two shells": (two_cubes(), "consists of 2 separate shells"),
    "flat": ((CUBE * [1.0, 1.0, 0.0], BOX_FACES), "is degenerate: it has no volume"),
    "a point": ((CUBE * 0.0, BOX_FACES), "is degenerate: every face has shrunk to a line or a point"),
    "not a number": ((CUBE * [1.0, 1.0, float("nan")], BOX_FACES), "has a coordinate that is not a number"),
}


@pytest.mark.parametrize(("body", "rule"), BODIES.values(), ids=BODIES)
def test_a_defect_is_named_with_file_and_body(body: tuple[Corners, Sequence[Sequence[int]]], rule: str, tmp_path: Path) -> None:
    path = written(tmp_path, "bad.obj", obj({"cornerstone": body[0]}, body[1]), fixed=[])
    message = refusal(path)
    assert 'mesh "bad.obj": body "cornerstone"' in message
    assert rule in message


def test_a_cup_with_walls_too_thin_to_see_is_no_cube() -> None:
    """Every corner is within the tolerance of a cube's surface, but the walls, 1/20,000 thick, hold no more than they are."""
    thin = 5e-5
    inner = corners((thin, thin, thin), (1.0 - thin, 1.0 - thin, 1.0))
    sides = [face for face in BOX_FACES if face != BOX_FACES[1]]
    rim = [(a, b, b + 8, a + 8) for a, b in ((4, 5), (5, 6), (6, 7), (7, 4))]
    faces = [*sides, *(tuple(k + 8 for k in face[::-1]) for face in sides), *rim]
    with pytest.raises(ValueError, match=r"is folded: its faces enclose 0\.00025 of the volume of its convex hull"):
        mesh_surface.convex_shape(mesh_surface.surface("cup", np.vstack([CUBE, inner]), faces))


def test_an_inverted_body_is_the_same_body() -> None:
    """All faces turned inwards is a matter of convention, not a defect."""
    inward = mesh_surface.convex_shape(mesh_surface.surface("b", CUBE, [face[::-1] for face in BOX_FACES]))
    outward = mesh_surface.convex_shape(mesh_surface.surface("b", CUBE, BOX_FACES))
    assert inward.faces == outward.faces


def test_single_precision_is_no_dent(tmp_path: Path) -> None:
    """Irregular stones 30 m from the origin, in single precision."""
    for k, vertices in enumerate(make_rubble_wall.stones()):
        text = make_rubble_wall.obj({"stone": vertices + 30.0})
        points = np.array([[float(x) for x in line.split()[1:]] for line in text.splitlines() if line.startswith("v ")])
        faces = [[int(x) - 1 for x in line.split()[1:]] for line in text.splitlines() if line.startswith("f ")]
        path = written(tmp_path, f"stones/stone {k}.stl", stl(points, faces))
    path.write_text(scene_text("stones", fixed=["stone 0"], support=["stone 1"]))
    assert len(load_scene(path).blocks) == len(make_rubble_wall.stones())


# --- defects of files and tables ----------------------------------------------------------------------------------------------

GOOD = obj({name: vertices for name, (vertices, _) in wall().items()})
HUGE_PROMISE = ply(CUBE).replace("vertex 8", "vertex 99999999999").replace("ascii", "binary_little_endian")
FILES = {
    "empty group": ("x.obj", GOOD + "o nothing\n", {}, 'body "nothing": is empty: it has no faces'),
    "no body": ("x.obj", "v 0 0 0\n", {}, 'mesh "x.obj": contains no body with faces'),
    "a corner too high": (
        "x.obj",
        "o a\nv 0 0 0\nf 1 2 3\n",
        {},
        "line 3, `f 1 2 3`, cannot be read: the face refers to vertex 2, but only 1 are defined above it",
    ),
    "a face with two corners": ("x.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", {}, "a face has at least three corners"),
    "words for numbers": ("x.obj", "v 0 zero 0\n", {}, "line 1, `v 0 zero 0`, cannot be read"),
    "not JSON": ("x.json", "{", {}, "not an assembly as COMPAS writes it"),
    "JSON of something else": ("x.json", "[1, 2]", {}, "not an assembly as COMPAS writes it"),
    "JSON without end": ("x.json", "[" * 100_000, {}, "not an assembly as COMPAS writes it"),
    "not PLY": ("x.ply", "nothing of the kind", {}, "not a whole PLY file"),
    "not STL": ("x.stl", b"\xff" * 200, {}, "not a whole STL file"),
    "a huge promise": (
        "x.ply",
        ply(CUBE).replace("vertex 8", "vertex 99999999999").replace("ascii", "binary_little_endian"),
        {},
        "not a whole PLY file",
    ),
    "a pattern without body": ("x.obj", GOOD, {"fixed": ["grond"]}, "fixed = 'grond': no name of a body matches; did you mean \"ground\"?"),
    "two roles": (
        "x.obj",
        GOOD,
        {"fixed": ["ground"], "support": ["*"]},
        'body "ground": matches a pattern of `fixed` and one of `support`',
    ),
    "a control character": ("x.obj", GOOD.replace("o pad", "o p\x07d"), {"fixed": ["ground"]}, "must be printable text"),
    "another format": ("x.3ds", GOOD, {}, "`file` must end in .obj, .ply, .stl, .json, or be a folder of .ply or .stl files"),
    "no scale": ("x.obj", GOOD, {"scale": 0.0}, "mesh[0].scale = 0.0: must be greater than 0"),
    "no axis": ("x.obj", GOOD, {"turn": {"axis": [0.0, 0.0, 0.0], "degrees": 1.0}}, "must not be the zero vector"),
}


@pytest.mark.parametrize(("file", "content", "entries", "rule"), FILES.values(), ids=FILES)
def test_a_bad_file_or_table_is_refused(file: str, content: str | bytes, entries: dict[str, Any], rule: str, tmp_path: Path) -> None:
    assert rule in refusal(written(tmp_path, file, content, **entries))


@pytest.mark.parametrize("write", [as_obj, as_ply_folder, as_stl_folder, as_compas])
@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.9, 0.98])
def test_a_truncated_file_is_refused(write: Callable[[Path], Path], share: float, tmp_path: Path) -> None:
    scene = write(tmp_path)
    cut = sorted(path for path in tmp_path.rglob("*") if path.is_file() and path != scene)[0]
    cut.write_bytes(cut.read_bytes()[: int(share * cut.stat().st_size)])
    assert cut.name in refusal(scene) or "no name of a body matches" in refusal(scene)


@pytest.mark.parametrize("write", [as_obj, as_ply_folder, as_stl_folder, as_compas, as_old_compas])
def test_a_file_with_damaged_bytes_is_read_or_refused_and_nothing_else(write: Callable[[Path], Path], tmp_path: Path) -> None:
    chance, scene = np.random.default_rng(0), write(tmp_path)
    path = sorted(path for path in tmp_path.rglob("*") if path.is_file() and path != scene)[0]
    whole, refused = path.read_bytes(), 0
    for _ in range(DAMAGES):
        damaged, place = bytearray(whole), int(chance.integers(len(whole)))
        damaged[place : place + int(chance.integers(20))] = chance.bytes(int(chance.integers(1, 6)))
        path.write_bytes(damaged)
        try:
            load_scene(scene)
        except SceneError:
            refused += 1
    assert refused > DAMAGES / 2


def test_a_missing_reader_is_named_with_the_extra_and_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = as_stl_folder(tmp_path)
    monkeypatch.setattr(mesh.importlib.util, "find_spec", lambda name: None)
    message = refusal(path)
    assert 'install the extra "mesh"' in message and "pip install" in message


# --- safety -------------------------------------------------------------------------------------------------------------------

ESCAPES = {
    "absolute": ("/etc/wall.obj", "must be a path relative to the scene file"),
    "drive": ("C:/wall.obj", "must be a path relative to the scene file"),
    "backslash": ("..\\\\wall.obj", "must be a path relative to the scene file"),
    "above": ("../wall.obj", "leads out of the scene's folder by `..`"),
    "above by a detour": ("a/../../wall.obj", "leads out of the scene's folder by `..`"),
    "address": ("https://example.org/wall.obj", "is an address"),
    "missing": ("nowhere.obj", "cannot be read: No such file or directory; the path is relative to the scene file"),
    "missing folder": ("nowhere", "neither a mesh file nor a folder of them"),
}


@pytest.mark.parametrize(("file", "reason"), ESCAPES.values(), ids=ESCAPES)
def test_nothing_outside_of_the_scene_s_folder_is_read(file: str, reason: str, tmp_path: Path) -> None:
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "wall.obj").write_text(GOOD)
    (inner / "scene.toml").write_text(scene_text(file.replace("\\\\", "\\")))
    assert reason in refusal(inner / "scene.toml")


def test_a_link_out_of_the_scene_s_folder_is_refused(tmp_path: Path) -> None:
    inner = tmp_path / "inner"
    path = written(inner, "wall.obj", GOOD)
    (tmp_path / "wall.obj").write_text(GOOD)
    (inner / "wall.obj").unlink()
    (inner / "wall.obj").symlink_to(tmp_path / "wall.obj")
    assert "a link that leads out" in refusal(path)
    (inner / "stones").mkdir()
    (inner / "stones" / "a.ply").symlink_to(tmp_path / "wall.obj")
    path.write_text(scene_text("stones"))
    assert "a link that leads out" in refusal(path)


def test_size_and_number_of_bodies_are_limited(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = as_obj(tmp_path)
    monkeypatch.setattr(mesh, "MOST_BLOCKS", 3)
    assert f"contains {len(wall())} bodies; at most 3 are allowed" in refusal(path)
    monkeypatch.setattr(mesh, "LARGEST_FILE", 100)
    assert "larger than 100 bytes" in refusal(path)


def test_a_ball_is_no_block(tmp_path: Path) -> None:
    ring = np.linspace(0.0, 2.0 * np.pi, mesh_surface.MOST_CORNERS, endpoint=False)
    front = np.stack([np.cos(ring), 0.0 * ring, np.sin(ring)], axis=1)
    faces = make_rubble_wall.obj({"drum": np.vstack([front, front + np.array([0.0, 1.0, 0.0])])})
    assert "has 2000 corners; simplify it" in refusal(written(tmp_path, "x.obj", faces, fixed=[]))


# --- runs and their cache -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("write", [as_obj, as_ply_folder])
def test_a_run_keeps_the_meshes_and_can_be_reported_alone(write: Callable[[Path], Path], tmp_path: Path) -> None:
    source, out = tmp_path / "source", tmp_path / "out"
    source.mkdir()
    scene = write(source)
    assert main(["run", "-q", str(scene), "-o", str(out), "--no-yade"]) == 0
    for path in source.rglob("*"):
        path.unlink() if path.is_file() and path != scene else None
    assert main(["report", "-q", str(out)]) == 0


def test_a_changed_mesh_is_solved_again_and_an_unchanged_one_is_not(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene, out = as_obj(tmp_path), tmp_path / "out"
    run = ["run", str(scene), "-o", str(out), "--no-yade"]
    assert main(run) == 0
    capsys.readouterr()
    assert main(run) == 0
    assert capsys.readouterr().err.count("cached") == 2
    before = scene_digest(load_scene(scene))
    lower = {name: vertices * [1.0, 1.0, 0.5] for name, (vertices, _) in wall().items()}
    (tmp_path / "wall.obj").write_text(obj(lower))
    assert scene_digest(load_scene(scene)) != before
    assert main(run) == 0
    assert "cached" not in capsys.readouterr().err
    summary = json.loads((out / "scene" / "comparison.json").read_text())
    assert summary["weight"] == pytest.approx(boxes().weight / 2.0)


def test_a_stone_taken_out_of_the_folder_leaves_the_run_s_folder(tmp_path: Path) -> None:
    scene, out = as_ply_folder(tmp_path), tmp_path / "out"
    run = ["run", "-q", str(scene), "-o", str(out), "--no-yade"]
    assert main(run) == 0
    (tmp_path / "stones" / "stone 2.3.ply").unlink()
    assert main(run) == 0
    assert not (out / "scene" / "stones" / "stone 2.3.ply").exists()
    assert main(["report", "-q", str(out)]) == 0


def test_a_mesh_named_like_a_result_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = written(tmp_path, "comparison.json", compas(wall()), fixed=[], support=["pad"])
    assert main(["run", str(scene), "-o", str(tmp_path / "out"), "--no-yade"]) == 2
    assert "has the name of a result; rename the file" in capsys.readouterr().err
