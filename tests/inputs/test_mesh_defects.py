"""Defects of imported bodies and their files are named, and nothing outside of the scene's folder is read."""

import json
import shlex
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import make_rubble_wall
import numpy as np
import pytest
from mesh_files import (
    BOX_FACES,
    Corners,
    as_compas,
    as_obj,
    as_old_compas,
    as_ply_folder,
    as_stl_folder,
    compas_meshes,
    compas_model,
    corners,
    obj,
    ply,
    refusal,
    scene_text,
    stl,
    wall,
    written,
)
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from la_core.errors import SceneError
from la_core.geometry import ROLES, Shape, prism
from la_core.scene import scene_from_file
from la_core.scene.changes import change_rows, geometry_changes
from la_core.scene.generators import mesh, mesh_surface
from la_core.scene.scene import load_scene

DAMAGES = 20  # for each format
CUBE = corners((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
FLIPPED = (BOX_FACES[0][::-1], *BOX_FACES[1:])


def shape_of(body: mesh_surface.Surface, tolerance: float = 0.0) -> Shape:
    return mesh_surface.shape_of(body, tolerance)[0]


def pyramid_dent(depth: float) -> tuple[Corners, tuple[tuple[int, ...], ...]]:
    """A cube whose top is a pyramid that points down by `depth`."""
    top = tuple((a, b, 8) for a, b in ((4, 5), (5, 6), (6, 7), (7, 4)))
    return np.vstack([CUBE, [0.5, 0.5, 1.0 - depth]]), (BOX_FACES[0], *BOX_FACES[2:], *top)


def folded_roof(rise: float = 0.2) -> tuple[Corners, tuple[tuple[int, ...], ...]]:
    """A cube with two opposite corners of its top raised. The diagonal between the other two corners is a valley."""
    vertices = CUBE.copy()
    vertices[[5, 7], 2] += rise
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
    "dented": (pyramid_dent(0.3), "is not convex: its deepest dent, near (0.5, 0.5, 0.7) m, lies 0.3 m below its convex hull"),
    "valley": (folded_roof(), "is not convex: its deepest dent, near (0.5, 0.5, 1) m, lies 0.192 m below its convex hull"),
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
    """Every corner lies within the tolerance of a cube's surface, but the body consists of walls alone, 1/20,000 thick."""
    thin = 5e-5
    inner = corners((thin, thin, thin), (1.0 - thin, 1.0 - thin, 1.0))
    sides = [face for face in BOX_FACES if face != BOX_FACES[1]]
    rim = [(a, b, b + 8, a + 8) for a, b in ((4, 5), (5, 6), (6, 7), (7, 4))]
    faces = [*sides, *(tuple(k + 8 for k in face[::-1]) for face in sides), *rim]
    with pytest.raises(ValueError, match=r"is folded: its faces enclose 0\.00025 of the volume of its convex hull"):
        shape_of(mesh_surface.surface("cup", np.vstack([CUBE, inner]), faces))


def quoin(middle: bool) -> tuple[Corners, list[tuple[int, ...]]]:
    """A prism with an L-shaped profile, 0.5 deep. Its sides may be divided at y = 0.2."""
    profile = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.4], [0.3, 0.4], [0.3, 1.0], [0.0, 1.0]])
    rows = [0.0, 0.2, 0.5] if middle else [0.0, 0.5]
    vertices = np.array([[x, y, z] for y in rows for x, z in profile])
    n, last = len(profile), len(profile) * (len(rows) - 1)
    sides = [(r + (k + 1) % n, r + k, r + k + n, r + (k + 1) % n + n) for r in range(0, last, n) for k in range(n)]
    ends = [(0, 1, 2, 3), (0, 3, 4, 5), *((last + d, last + c, last + b, last + a) for a, b, c, d in ((0, 1, 2, 3), (0, 3, 4, 5)))]
    return vertices, [*ends, *sides]


@pytest.mark.parametrize("middle", [False, True])
@pytest.mark.parametrize("degrees", [0.0, 30.0])
def test_a_prism_with_dents_is_the_block_that_its_profile_makes(middle: bool, degrees: float) -> None:
    vertices, faces = quoin(middle)
    turn = Rotation.from_euler("zx", [degrees, degrees], degrees=True).as_matrix()
    read = shape_of(mesh_surface.surface("quoin", vertices @ turn.T, faces))
    typed = prism([(0.0, 0.0), (1.0, 0.0), (1.0, 0.4), (0.3, 0.4), (0.3, 1.0), (0.0, 1.0)], (0.0, 0.5))
    assert len(read.parts) == len(typed.parts) == 2
    volume = [sorted(ConvexHull(part.vertices).volume for part in shape.parts) for shape in (read, typed)]
    assert sum(volume[0]) == pytest.approx(sum(volume[1])) == pytest.approx(0.5 * 0.58)
    corner = np.linalg.norm((read.vertices @ turn)[:, None] - vertices[[*range(6), *range(-6, 0)]], axis=2)
    assert corner.min(axis=0).max() < 1e-5


@pytest.mark.parametrize("middle", [False, True])
def test_a_prism_with_dents_whose_coordinates_have_three_digits_is_read_within_the_tolerance(middle: bool) -> None:
    """After the rounding, the ends of the turned prism are plane only to about a millimetre."""
    vertices, faces = quoin(middle)
    for seed in range(10):
        rounded = np.round(vertices @ Rotation.random(random_state=seed).as_matrix().T, 3)
        read = shape_of(mesh_surface.surface("quoin", rounded, faces), 0.003)
        assert sum(ConvexHull(part.vertices).volume for part in read.parts) == pytest.approx(0.5 * 0.58, rel=0.01)


def test_a_prism_of_a_profile_with_very_many_corners_is_refused_before_it_is_divided() -> None:
    """The profile has the teeth of a saw. The division of 500 corners took three minutes."""
    n = 102
    along = np.linspace(0.0, 1.0, n - 2)
    profile = [*zip(along, 0.5 + 0.1 * (np.arange(n - 2) % 2), strict=True), (1.0, 0.0), (0.0, 0.0)][::-1]
    vertices = np.array([[x, y, z] for y in (0.0, 0.5) for x, z in profile])
    sides = [((k + 1) % n, k, k + n, (k + 1) % n + n) for k in range(n)]
    body = mesh_surface.surface("saw", vertices, [tuple(range(n)), tuple(range(2 * n - 1, n - 1, -1)), *sides])
    with pytest.raises(ValueError, match="prism of a profile with dents and 102 corners; at most 100 can be divided"):
        shape_of(body)


def test_a_body_of_many_corners_is_refused_without_a_search_in_each_of_its_planes(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ball of 300 corners has a dent. An outline was sought in each of its 600 planes; a body of 1000 corners took 15 s."""
    points = np.random.default_rng(0).normal(size=(300, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    hull = ConvexHull(points)
    outward = np.sum(
        np.cross(*np.moveaxis(points[hull.simplices[:, 1:]] - points[hull.simplices[:, :1]], 1, 0)) * hull.equations[:, :3], axis=1
    )
    faces = [tuple((face if out > 0.0 else face[::-1]).tolist()) for face, out in zip(hull.simplices, outward, strict=True)]
    points[0] *= 0.7
    monkeypatch.setattr(mesh_surface, "_outline", lambda *_, **__: pytest.fail("an outline is sought"))
    with pytest.raises(ValueError, match="is not convex"):
        shape_of(mesh_surface.surface("ball", points, faces))


def test_a_prism_with_a_hole_is_refused() -> None:
    """The body is a frame: its ends are squares with a square hole."""
    outer, inner = corners((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), corners((0.2, 0.2, 0.0), (0.8, 0.8, 1.0))
    ring = [(k, (k + 1) % 4, (k + 1) % 4 + 8, k + 8) for k in range(4)]
    sides = list(BOX_FACES[2:])
    faces = [*sides, *(tuple(k + 8 for k in face[::-1]) for face in sides), *(face[::-1] for face in ring)]
    faces += [tuple(k + 4 for k in face) for face in ring]
    with pytest.raises(ValueError, match=r"is not convex: .* only a prism may have dents; divide the body into convex ones"):
        shape_of(mesh_surface.surface("frame", np.vstack([outer, inner]), faces))


@pytest.mark.parametrize("body", [pyramid_dent(0.002), folded_roof(0.002)], ids=["a dent", "a warped top"])
def test_a_dent_within_the_tolerance_is_filled(body: tuple[Corners, tuple[tuple[int, ...], ...]], tmp_path: Path) -> None:
    path = written(tmp_path, "warped.obj", obj({"stone": body[0]}, body[1]), fixed=[])
    assert "; [geometry] tolerance fills dents that are no deeper than it" in refusal(path)
    filled = shape_of(mesh_surface.surface("stone", *body), 0.003)
    assert len(filled.faces) == len(BOX_FACES) and len(filled.vertices) == len(CUBE)
    with pytest.raises(ValueError, match="is not convex"):
        shape_of(mesh_surface.surface("stone", *body), 0.001)


def test_the_number_of_bodies_whose_dents_are_filled_is_told(tmp_path: Path) -> None:
    """The volume of these bodies grows, but the report said that nothing had to be moved."""
    vertices, faces = pyramid_dent(0.002)
    stones = {"dented": vertices, "upper": vertices + np.array([0.0, 0.0, 1.0])}
    path = written(tmp_path, "dented.obj", obj(stones, faces), fixed=["dented"], support=["upper"], shift=[0.0, 0.0, -2.0])
    block = '[[block]]\nname = "free"\nbox = { from = [0.0, 0.0, 0.0], to = [1.0, 1.0, 1.0] }\n'
    path.write_text(f"{path.read_text()}\n[geometry]\ntolerance = 0.003\n{block}")
    changes = geometry_changes(load_scene(path), 0, 0)
    assert changes is not None
    assert next(change_rows(changes)) == ("bodies of meshes made convex within the tolerance", "2")


def test_a_body_of_which_a_file_has_every_face_twice_is_read_once() -> None:
    twice = shape_of(mesh_surface.surface("b", CUBE, [*BOX_FACES, *(np.roll(face, 1).tolist() for face in BOX_FACES)]))
    assert twice.faces == shape_of(mesh_surface.surface("b", CUBE, BOX_FACES)).faces


def test_a_new_scene_is_written_for_bodies_with_dents_deeper_than_its_tolerance(tmp_path: Path) -> None:
    dented = pyramid_dent(0.01)
    (tmp_path / "dented.obj").write_text(obj({"stone": dented[0]}, dented[1]))
    scene = tmp_path / "dented.toml"
    scene.write_text(scene_from_file(tmp_path / "dented.obj", tmp_path))
    assert "lies 0.01 m below its convex hull; [geometry] tolerance fills dents" in refusal(scene)
    scene.write_text(scene.read_text().replace("tolerance = 0.003", "tolerance = 0.011"))
    assert load_scene(scene).blocks.names[-1] == "stone"


def test_a_new_scene_is_written_for_bodies_in_millimetres_whose_dents_are_small(tmp_path: Path) -> None:
    """A dent of half a millimetre was taken for half a metre, before the unit was known."""
    cube, faces = pyramid_dent(0.0005)
    (tmp_path / "mm.obj").write_text(obj({"stone": 1000.0 * cube}, faces))
    scene = tmp_path / "mm.toml"
    scene.write_text(scene_from_file(tmp_path / "mm.obj", tmp_path))
    assert "scale = 0.001 " in scene.read_text() and load_scene(scene).blocks.volume[-1] == pytest.approx(1.0)


def test_an_inverted_body_is_the_same_body() -> None:
    """A body with all faces turned inwards follows another convention and has no defect."""
    inward = shape_of(mesh_surface.surface("b", CUBE, [face[::-1] for face in BOX_FACES]))
    outward = shape_of(mesh_surface.surface("b", CUBE, BOX_FACES))
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
    "JSON of another object": (
        "x.json",
        '{"courses": []}',
        {},
        "(it lacks 'node'); write its blocks as OBJ, each as an object of its own",
    ),
    "an element to be moved": (
        "x.json",
        compas_model(wall(), transformation={"data": {}}),
        {},
        "element 0 has a transformation, which is not read; write its blocks as OBJ",
    ),
    "blocks to be cut": (
        "x.json",
        compas_model(wall(), modifiers=[{"type": "cut"}]),
        {},
        "a model has modifiers, such as cuts by neighbours",
    ),
    "loads beside a model": (
        "x.json",
        json.dumps({"dtype": "compas_dem.problem/Problem", "data": {"model": json.loads(compas_model(wall())), "boundary_conditions": {}}}),
        {},
        "a problem of compas_dem has loads and supports beside its model, which is not read",
    ),
    "JSON without end": ("x.json", "[" * 100_000, {}, "not an assembly as COMPAS writes it"),
    "not PLY": ("x.ply", "nothing of the kind", {}, "not a whole PLY file"),
    "not STL": ("x.stl", b"\xff" * 200, {}, "not a whole STL file"),
    "a number without end": ("x.obj", f"v 0 0 0\nf 1 2 {5000 * '9'}\n", {}, "cannot be read: a number has too many digits"),
    "a number of JSON without end": ("x.json", f'{{"data": {5000 * "9"}}}', {}, "(ValueError: a number has too many digits)"),
    "a promise of triangles": ("x.stl", b"\x00" * 80 + b"\xff" * 4 + b"\x80" * 50, {}, "not a whole STL file"),
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
    said = refusal(written(tmp_path, file, content, **entries))
    assert rule in said
    assert "set_int_max_str_digits" not in said and "No module named" not in said  # advice for programmers


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
    assert f'install the extra "mesh": {shlex.quote(sys.executable)} -m pip install trimesh' in refusal(path)
    (tmp_path / "pipx_metadata.json").touch()  # the file of pipx in the environment of a program, which has no pip of its own
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    assert 'install the extra "mesh": pipx inject crosscheck-masonry trimesh' in refusal(path)


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


def test_an_element_with_a_frame_of_its_own_is_refused(tmp_path: Path) -> None:
    """The frame was ignored without a message, so the element stood in another place."""
    model = json.loads(compas_model(wall()))
    for element in model["data"]["elements"].values():
        element["data"]["frame"] = {"dtype": "compas.geometry/Frame", "data": {"point": [0, 0, 0], "xaxis": [1, 0, 0], "yaxis": [0, 1, 0]}}
    load_scene(written(tmp_path, "wall.json", json.dumps(model), fixed=[], support=["pad"]))
    element["data"]["frame"]["data"]["point"] = [5, 0, 0]
    rule = refusal(written(tmp_path, "wall.json", json.dumps(model), fixed=[], support=["pad"]))
    assert "has a frame of its own, which is not read" in rule


def test_meshes_of_a_list_that_are_marked_as_supports_are_held(tmp_path: Path) -> None:
    """Templates of compas_dem mark supports in this way. Such meshes were free blocks."""
    meshes = json.loads(compas_meshes(wall()))
    for item, (_, role) in zip(meshes, wall().values(), strict=True):
        mesh = item[0] if isinstance(item, list) else item
        mesh["data"]["attributes"] = {"is_support": role == "fixed"}
    scene = load_scene(written(tmp_path, "wall.json", json.dumps(meshes), fixed=[], support=["pad"]))
    assert [scene.blocks.names[k] for k in np.flatnonzero(scene.blocks.role == ROLES["fixed"])] == ["ground"]


def test_a_body_with_no_face_but_one_without_corners_is_refused(tmp_path: Path) -> None:
    """Such a file caused a traceback."""
    meshes = json.loads(compas_meshes(wall()))
    meshes[0]["data"]["face"] = {"0": []}
    assert "is empty: it has no faces" in refusal(written(tmp_path, "wall.json", json.dumps(meshes)))
