"""Bodies from the content of mesh files: OBJ, PLY, STL, and assemblies, models and lists of meshes by COMPAS.

The content is data: no other file that it names is opened or run.
"""

import io
import json
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np

from la_core.errors import words_of
from la_core.scene.generators.mesh_surface import Surface, surface

_AS_OBJ = "write its blocks as OBJ, each as an object of its own"
DEFAULT_GROUP = "default"  # name of the group before any `g`; some programs write it although it is empty


def surfaces(suffix: str, content: bytes, stem: str) -> list[Surface]:
    """All bodies in the content of a file with this suffix; `stem` is the name of a body without one.

    Raises ValueError with the fault of the content, and ImportError where the reader of PLY and STL is missing.
    """
    if suffix == ".obj":
        return _obj_surfaces(content.decode("utf-8", errors="replace"), stem)
    if suffix == ".json":
        return _compas_surfaces(content)
    return _surfaces_by_trimesh(suffix, content, stem)


def _obj_surfaces(text: str, stem: str) -> list[Surface]:
    """Bodies of a Wavefront OBJ: one per `o`, or one per `g` where there is at most one `o`. Materials are ignored."""
    lines = [line.split(maxsplit=1) for line in text.replace("\\\r\n", " ").replace("\\\n", " ").splitlines()]
    declared = Counter(fields[0] for fields in lines if fields)
    body_key = "g" if declared["g"] and declared["o"] <= 1 else "o"
    vertices: list[list[float]] = []
    bodies: dict[str, list[tuple[int, ...]]] = {}
    name = stem
    for number, fields in enumerate(lines, 1):
        key, rest = (*fields, "", "")[:2]
        try:
            if key == "v":
                x, y, z, *_ = map(float, rest.split("#")[0].split())
                vertices.append([x, y, z])
            elif key == "f":
                bodies.setdefault(name, []).append(_obj_face(rest.split("#")[0], len(vertices)))
            elif key == body_key:
                name = rest.strip() or stem
                bodies.setdefault(name, [])
        except ValueError as error:
            raise ValueError(f"line {number}, `{key} {rest.strip()[:60]}`, cannot be read: {words_of(error)}") from error
    if bodies.get(DEFAULT_GROUP) == []:
        del bodies[DEFAULT_GROUP]
    points = np.array(vertices).reshape(-1, 3)
    return [surface(body, points, faces) for body, faces in bodies.items()]


def _obj_face(text: str, count: int) -> tuple[int, ...]:
    """Vertex indices of one `f` line: the first number of each corner, from 1, or from the end where negative."""
    numbers = [int(corner.split("/")[0]) for corner in text.split()]
    face = tuple(number - 1 if number > 0 else count + number for number in numbers)
    if len(face) < 3:
        raise ValueError("a face has at least three corners")
    for number, index in zip(numbers, face, strict=True):
        if number == 0 or not 0 <= index < count:
            raise ValueError(f"the face refers to vertex {number}, but only {count} are defined above it")
    return face


def _surfaces_by_trimesh(suffix: str, content: bytes, stem: str) -> list[Surface]:
    """Bodies of a PLY or STL file by trimesh, without a resolver that would open textures, and without repairs."""
    import trimesh  # noqa: PLC0415 - an optional extra

    try:
        loaded = trimesh.load_scene(io.BytesIO(content), file_type=suffix[1:], process=False, skip_materials=True, resolver=None)
        bodies = {str(name): _vertices_and_faces(mesh) for name, mesh in loaded.geometry.items()}
    except ImportError as error:  # trimesh takes bytes that are no STL for text in an unknown encoding, and has no package for that
        raise ValueError(f"not a whole {suffix[1:].upper()} file: it is cut off, or damaged") from error
    except Exception as error:  # any error of a reader of foreign bytes
        raise ValueError(f"not a whole {suffix[1:].upper()} file: {error or type(error).__name__}") from error
    for vertices, faces in bodies.values():
        if faces and not 0 <= min(map(min, faces)) <= max(map(max, faces)) < len(vertices):
            raise ValueError("a face refers to a vertex that does not exist")
    return [surface(stem if len(bodies) == 1 else name, vertices, faces) for name, (vertices, faces) in bodies.items()]


def _vertices_and_faces(mesh: Any) -> tuple[np.ndarray, list[list[int]]]:
    """Vertices (n, 3) of a mesh by trimesh, and the loop of each face.

    The faces of a PLY file are those of the file. trimesh divides them into triangles about their first corners, which lie partly outside
    of a face with dents.
    """
    vertices, triangles = np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces)
    raw = mesh.metadata.get("_ply_raw")
    if raw is None:
        return vertices, triangles.tolist()
    # trimesh keeps columns by their names for a file in text, and an array of records, with the length of each list, for a binary one.
    faces, is_text = raw["face"]["data"], isinstance(raw["face"]["data"], dict)
    names = list(faces if is_text else faces.dtype.names)
    name = next((name for name in names if name in ("vertex_index", "vertex_indices")), names[0])
    loops = faces[name] if is_text else faces[name]["f1"]
    if loops.dtype != object:  # lists of one length; of a single list, trimesh keeps its numbers alone
        loops = np.atleast_2d(loops)
    vertices = np.column_stack([raw["vertex"]["data"][axis] for axis in "xyz"]).astype(float)
    return vertices, [loop.tolist() for loop in loops if len(loop) >= 3]


class _NotReadError(ValueError):
    """A file by COMPAS has something that would change its blocks."""


def _compas_surfaces(content: bytes) -> list[Surface]:
    """Blocks of a file by COMPAS; the number of a block in the file is its name, where it has none of its own."""
    try:
        named = [
            (str(key), *_compas_mesh(block), bool(marks.get("is_support"))) for key, block, marks in _compas_blocks(json.loads(content))
        ]
    except _NotReadError as error:
        raise ValueError(f"{error}, which is not read; {_AS_OBJ}") from error
    except (ValueError, KeyError, TypeError, AttributeError, IndexError, OverflowError, RecursionError) as error:
        what = f"it lacks {error}" if isinstance(error, KeyError) else f"{type(error).__name__}: {words_of(error)}"
        raise ValueError(f"not an assembly as COMPAS writes it ({what}); {_AS_OBJ}") from error
    shared = Counter(name for _, name, *_ in named)
    return [
        surface(name if name and shared[name] == 1 else f"block {key}", vertices, faces, held) for key, name, vertices, faces, held in named
    ]


def _compas_blocks(content: Any) -> Iterator[tuple[Any, dict[str, Any], dict[str, Any]]]:
    """Key, mesh and marks of every block: of a list of meshes, a model of elements, a table of blocks, or a graph."""
    if isinstance(content, list):
        for key, mesh in enumerate(content):
            yield key, mesh[0] if isinstance(mesh, list) and len(mesh) == 1 else mesh, {}
        return
    data = _unwrapped(content)
    if "elements" in data:  # compas_model and compas_dem
        elements, edges = data["elements"], _unwrapped(data.get("graph") or {}).get("edge") or {}
        if any(edge.get("modifiers") for ends in edges.values() for edge in ends.values()):
            raise _NotReadError("a model has modifiers, such as cuts by neighbours")
        for key, element in enumerate(elements.values() if isinstance(elements, dict) else elements):
            marks = _unwrapped(element)
            if data.get("transformation") or marks.get("transformation"):
                raise _NotReadError(f"element {key} has a transformation")
            mesh = marks.get("shape") or marks["geometry"]
            yield key, {**mesh, "name": mesh.get("name") or marks.get("name")}, marks
    elif "blocks" in data:  # compas_assembly before 0.2
        of_all = data["assembly"].get("vertex") or data["assembly"].get("node") or {}
        for key, block in data["blocks"].items():
            yield key, block, of_all.get(key, {})
    else:  # a graph in an assembly, or an assembly that is a network itself
        graph = _unwrapped(data["graph"]) if "graph" in data else data
        for key, node in graph["node"].items():
            yield key, node.get("block") or node["part"], node


def _unwrapped(value: dict[str, Any]) -> dict[str, Any]:
    """The data of an object that COMPAS wraps as {"dtype": ..., "data": ...}; version 1 names the second "value", and may wrap twice."""
    while "dtype" in value or "datatype" in value:
        value = value["data"] if "data" in value else value["value"]
    return dict(value)


def _compas_mesh(block: dict[str, Any]) -> tuple[str, np.ndarray, list[list[int]]]:
    """Name (or ""), vertices and faces of a mesh; the keys of vertices are texts, which a face may give as numbers."""
    mesh = _unwrapped(block)
    place = {str(key): number for number, key in enumerate(mesh["vertex"])}
    default = mesh.get("default_vertex_attributes") or mesh.get("dva") or {}
    vertices = [[float({**default, **vertex}[axis]) for axis in "xyz"] for vertex in mesh["vertex"].values()]
    faces = [[place[str(corner)] for corner in face] for face in mesh["face"].values()]
    return str(block.get("name") or ""), np.array(vertices).reshape(-1, 3), faces
