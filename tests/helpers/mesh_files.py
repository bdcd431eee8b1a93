"""One structure in files of every mesh format, and the scene that reads them."""

import json
import struct
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scenes

from la_core.errors import SceneError
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble
from la_core.scene.scene import Scene, load_scene

Corners = np.ndarray
BOX_FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
TRIANGLES = tuple(t for a, b, c, d in BOX_FACES for t in ((a, b, c), (a, c, d)))


def corners(low: Sequence[float], high: Sequence[float]) -> Corners:
    (x0, y0, z0), (x1, y1, z1) = low, high
    return np.array([(x, y, z) for z in (z0, z1) for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))])


def wall() -> dict[str, tuple[Corners, str]]:
    """Return corners and role of every block: three courses in running bond on a base in two parts that meet at x = 1.2."""
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


def ply(vertices: Corners, faces: Sequence[Sequence[int]] = BOX_FACES, indices: str = "vertex_indices") -> str:
    rows = [" ".join(map(repr, point)) for point in vertices.tolist()] + [" ".join(map(str, [len(face), *face])) for face in faces]
    return "\n".join([*_ply_head("ascii", len(vertices), len(faces), indices), *rows]) + "\n"


def binary_ply(
    vertices: Corners, faces: Sequence[Sequence[int]] = BOX_FACES, indices: str = "vertex_indices", order: str = "big", colour: bool = False
) -> bytes:
    """Return a binary PLY file. order: of bytes, "big" or "little"; colour: one more number before each vertex and after each face."""
    code = ">" if order == "big" else "<"
    head = "\n".join([*_ply_head(f"binary_{order}_endian", len(vertices), len(faces), indices), ""])
    rows = [struct.pack(code + "3d", *point) for point in vertices.tolist()]
    loops = [struct.pack(f"{code}B{len(face)}i", len(face), *face) for face in faces]
    if colour:
        head = head.replace("property double x", "property uchar red\nproperty double x").replace(
            "end_header", "property short n\nend_header"
        )
        rows, loops = [b"\x07" + row for row in rows], [loop + struct.pack(code + "h", -3) for loop in loops]
    return head.encode() + b"".join(rows + loops)


def _ply_head(form: str, vertices: int, faces: int, indices: str) -> list[str]:
    head = ["ply", f"format {form} 1.0", "comment TextureFile /etc/passwd", f"element vertex {vertices}"]
    head += [f"property double {axis}" for axis in "xyz"]
    return [*head, f"element face {faces}", f"property list uchar int {indices}", "end_header"]


def stl(vertices: Corners, triangles: Sequence[Sequence[int]] = TRIANGLES) -> bytes:
    """Return a binary STL file, which has single precision."""
    rows = [struct.pack("<12fH", 0.0, 0.0, 0.0, *vertices[list(triangle)].ravel(), 0) for triangle in triangles]
    return b"\0" * 80 + struct.pack("<I", len(rows)) + b"".join(rows)


def compas_mesh(vertices: Corners, keys: Callable[[int], Any] = int) -> dict[str, Any]:
    return {
        "vertex": {str(k): dict(zip("xyz", point, strict=True)) for k, point in enumerate(vertices.tolist())},
        "face": {str(k): [keys(corner) for corner in face] for k, face in enumerate(BOX_FACES)},
    }


def compas(bodies: dict[str, tuple[Corners, str]]) -> str:
    """Return an assembly as compas 2 and compas_assembly 0.7 write it."""
    node = {}
    for key, (name, (vertices, role)) in enumerate(bodies.items()):
        block = {"dtype": "compas_assembly.datastructures/Block", "data": compas_mesh(vertices), "name": name}
        node[str(key)] = {"block": block, "is_support": role != "free"}
    graph = {"dtype": "compas.datastructures/Graph", "data": {"node": node, "edge": {}}}
    return json.dumps({"dtype": "compas_assembly.datastructures/Assembly", "data": {"attributes": {}, "graph": graph}})


def compas_of_old(bodies: dict[str, tuple[Corners, str]]) -> str:
    """Return an assembly as compas_assembly 0.1 wrote it: nameless blocks beside a network, corners of faces as texts."""
    marks = {str(key): {"is_support": role != "free"} for key, (_, role) in enumerate(bodies.values())}
    blocks = {str(key): compas_mesh(vertices, str) for key, (vertices, _) in enumerate(bodies.values())}
    return json.dumps({"assembly": {"vertex": marks}, "blocks": blocks})


def compas_network(bodies: dict[str, tuple[Corners, str]]) -> str:
    """Return an assembly as compas_assembly 0.2 wrote it: the assembly is itself a network, with blocks wrapped twice."""
    node = {}
    for key, (name, (vertices, role)) in enumerate(bodies.items()):
        inner = {"compas": "0.18.1", "datatype": "compas_assembly.datastructures/Block", "data": compas_mesh(vertices)}
        block = {"dtype": "compas_assembly.datastructures/Block", "value": inner, "name": name}
        node[str(key)] = {"x": 0.0, "block": block, "is_support": role != "free"}
    return json.dumps({"attributes": {"name": "Network"}, "node": node, "edge": {}})


def compas_model(bodies: dict[str, tuple[Corners, str]], is_list: bool = False, transformation: Any = None, modifiers: Any = None) -> str:
    """Return a model as compas_model and compas_dem write it: named elements by id, or a list of named meshes, beside a graph."""
    elements = {}
    for name, (vertices, role) in bodies.items():
        mesh = {"dtype": "compas.datastructures/Mesh", "data": compas_mesh(vertices)} | ({"name": name} if is_list else {})
        data = {
            "name": "Block" if is_list else name,
            "transformation": transformation,
            "shape" if is_list else "geometry": mesh,
            "is_support": role != "free",
        }
        elements[f"id of {name}"] = {"dtype": "compas_dem.elements/Block", "data": data}
    data = {
        "elements": list(elements.values()) if is_list else elements,
        "graph": {"node": {}, "edge": {"0": {"1": {"modifiers": modifiers}}}},
    }
    return json.dumps({"dtype": "compas_dem.models/BlockModel", "data": data})


def compas_meshes(bodies: dict[str, tuple[Corners, str]]) -> str:
    """Return a list of meshes. Every second mesh is alone in an inner list."""
    meshes: list[Any] = [
        {"dtype": "compas.datastructures/Mesh", "data": compas_mesh(vertices), "name": name} for name, (vertices, _) in bodies.items()
    ]
    return json.dumps([[mesh] if k % 2 else mesh for k, mesh in enumerate(meshes)])


def scene_text(file: str, settlement: Any = scenes.DOWN, gravity: Sequence[float] = (0.0, 0.0, -9.81), **entries: Any) -> str:
    roles = {"fixed": ["ground"], "support": ["pad"]} if "fixed" not in entries else {}
    table = "\n".join(["[[mesh]]", *(f"{key} = {scenes.inline(value)}" for key, value in {"file": file, **roles, **entries}.items())])
    return scenes.text(table, settlement=settlement, gravity=gravity, plane=False)


def written(folder: Path, file: str, content: str | bytes, **entries: Any) -> Path:
    """Write a mesh file with this content, and the scene file beside it. Return the scene's path."""
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


def as_compas_network(folder: Path) -> Path:
    return written(folder, "wall.json", compas_network(wall()), fixed=[], support=["pad"])


def as_compas_model(folder: Path) -> Path:
    return written(folder, "wall.json", compas_model(wall()), fixed=[], support=["pad"])


def as_compas_list_of_elements(folder: Path) -> Path:
    return written(folder, "wall.json", compas_model(wall(), is_list=True), fixed=[], support=["pad"])


def as_compas_meshes(folder: Path) -> Path:
    return written(folder, "wall.json", compas_meshes(wall()))
