"""Bodies from the content of mesh files: OBJ, PLY, STL, and assemblies, models and lists of meshes by COMPAS.

The content is data: no other file that it names is opened or run.
"""

import codecs
import io
import json
import re
import struct
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np

from la_core.errors import words_of
from la_core.scene.generators.mesh_surface import Surface, surface

_AS_OBJ = "write its blocks as OBJ, each as an object of its own"
_PLY_NUMBERS = {  # codes of `struct` for the types of the format
    "char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d",
    "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "float32": "f", "float64": "d",
}  # fmt: skip
STL_IN_TEXT = re.compile(rb"(\xef\xbb\xbf)?\s*solid[^\0]*\Z", re.IGNORECASE)  # the head of a binary file may begin with the same word
DEFAULT_GROUP = "default"  # name of the group before any `g`; some programs write it although it is empty


def surfaces(suffix: str, content: bytes, stem: str) -> list[Surface]:
    """All bodies in the content of a file with this suffix; `stem` is the name of a body without one.

    Raises ValueError with the fault of the content, and ImportError where the reader of PLY and STL is missing.
    """
    if suffix == ".obj":
        return _obj_surfaces(_text(content), stem)
    if suffix == ".json":
        return _compas_surfaces(content)
    return _surfaces_by_trimesh(suffix, content, stem)


def _text(content: bytes) -> str:
    """Decode a text file: UTF-16 with its byte order mark, else UTF-8. A line that is not UTF-8 is read as Windows-1252."""
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return content.decode("utf-16", errors="replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return "\n".join(map(_line, content.removeprefix(codecs.BOM_UTF8).split(b"\n")))


def _line(content: bytes) -> str:
    try:
        return content.decode()
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")


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
        if suffix == ".ply":
            content = _ply_in_text(content)
        elif STL_IN_TEXT.match(content):
            content = _text(content).encode()
        loaded = trimesh.load_scene(io.BytesIO(content), file_type=suffix[1:], process=False, skip_materials=True, resolver=None)
        is_cloud = any(not hasattr(mesh, "faces") for mesh in loaded.geometry.values())
        bodies = {} if is_cloud else {str(name): _vertices_and_faces(mesh) for name, mesh in loaded.geometry.items()}
    except ImportError as error:  # trimesh takes invalid STL for text in an unknown encoding, and lacks the package for that
        raise ValueError(f"not a whole {suffix[1:].upper()} file: it is cut off, or damaged") from error
    except Exception as error:  # the reader may raise any error for invalid bytes
        raise ValueError(f"not a whole {suffix[1:].upper()} file: {error or type(error).__name__}") from error
    if is_cloud:
        raise ValueError("holds points without faces; export its surfaces instead of a cloud of points")
    for vertices, faces in bodies.values():
        if faces and not 0 <= min(map(min, faces)) <= max(map(max, faces)) < len(vertices):
            raise ValueError("a face refers to a vertex that does not exist")
    return [surface(stem if len(bodies) == 1 else name, vertices, faces) for name, (vertices, faces) in bodies.items()]


def _ply_in_text(content: bytes) -> bytes:
    """Turn a PLY file into text without comments: trimesh reads faces with different numbers of corners only from text.

    Raises ValueError where a binary file has fewer or more bytes than its head says.
    """
    head, end, body = content.partition(b"end_header")
    form = re.search(rb"^format\s+(ascii|binary_little_endian|binary_big_endian)\b", head, re.MULTILINE)
    if form is None or not end:
        return content
    words = (b"element", b"property")
    kept = [line for line in head.replace(b"\r", b"\n").splitlines() if line.startswith(words)]
    body = body.partition(b"\n")[2]
    if form[1] != b"ascii":
        body = _rows(kept, body, "<" if form[1] == b"binary_little_endian" else ">")
    return b"\n".join([b"ply", b"format ascii 1.0", *kept, end, body])


def _rows(head: list[bytes], body: bytes, order: str) -> bytes:
    """Lines of text with the items of a binary PLY file, whose bytes have this order (a code of `struct`)."""
    rows, position = [], 0
    for count, properties in _ply_elements(head):
        for _ in range(count):
            row: list[float] = []
            for length, number in properties:
                many = 1
                if length:
                    many = int(_numbers(order + length, body, position)[0])
                    row.append(many)
                    position += struct.calcsize(order + length)
                row += _numbers(f"{order}{many}{number}", body, position)
                position += struct.calcsize(f"{order}{many}{number}")
            rows.append(" ".join(map(repr, row)))
    if position != len(body):
        raise ValueError(f"it has more bytes than its head says ({len(body) - position})")
    return "\n".join([*rows, ""]).encode()


def _numbers(code: str, body: bytes, position: int) -> tuple[float, ...]:
    try:
        return struct.unpack_from(code, body, position)
    except struct.error as error:
        raise ValueError("it is cut off, or damaged") from error


def _ply_elements(head: list[bytes]) -> list[tuple[int, list[tuple[str, str]]]]:
    """Elements of a PLY file: the number of items, and the codes (length or "", number) of the properties of each item."""
    elements: list[tuple[int, list[tuple[str, str]]]] = []
    for fields in (line.decode("ascii", errors="replace").split() for line in head):
        if fields[:1] == ["element"]:
            elements.append((int(fields[2]), []))
        elif fields[:2] == ["property", "list"]:
            elements[-1][1].append((_PLY_NUMBERS[fields[2]], _PLY_NUMBERS[fields[3]]))
        elif fields[:1] == ["property"]:
            elements[-1][1].append(("", _PLY_NUMBERS[fields[1]]))
    return [(count, properties) for count, properties in elements if properties]


def _vertices_and_faces(mesh: Any) -> tuple[np.ndarray, list[list[int]]]:
    """Vertices (n, 3) of a mesh by trimesh, and the loop of each face.

    The faces of a PLY file are taken from the file itself. trimesh divides a face into triangles about its first corner. In a face with
    dents, parts of these triangles lie outside the face.
    """
    vertices, triangles = np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces)
    raw = mesh.metadata.get("_ply_raw")
    if raw is None:
        return vertices, triangles.tolist()
    faces = raw["face"]["data"]
    loops = faces[next((name for name in faces if name in ("vertex_index", "vertex_indices")), next(iter(faces)))]
    if loops.dtype != object:  # all lists have one length; trimesh flattens a single list
        loops = np.atleast_2d(loops)
    vertices = np.column_stack([raw["vertex"]["data"][axis] for axis in "xyz"]).astype(float)
    return vertices, [loop.tolist() for loop in loops if len(loop) >= 3]


class _NotReadError(ValueError):
    """Error for a file by COMPAS with data that would change its blocks and are not read."""


def _compas_surfaces(content: bytes) -> list[Surface]:
    """Blocks of a file by COMPAS. A block without a name, or with a name that other blocks have, is named by its key in the file."""
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
        for key, item in enumerate(content):
            mesh = item[0] if isinstance(item, list) and len(item) == 1 else item
            yield key, mesh, _unwrapped(mesh).get("attributes") or {}  # templates of compas_dem mark supports there
        return
    data = _unwrapped(content)
    if "boundary_conditions" in data:
        raise _NotReadError("a problem of compas_dem has loads and supports beside its model")
    if "elements" in data:  # compas_model and compas_dem
        elements, edges = data["elements"], _unwrapped(data.get("graph") or {}).get("edge") or {}
        if any(edge.get("modifiers") for ends in edges.values() for edge in ends.values()):
            raise _NotReadError("a model has modifiers, such as cuts by neighbours")
        for key, element in enumerate(elements.values() if isinstance(elements, dict) else elements):
            marks = _unwrapped(element)
            if data.get("transformation") or marks.get("transformation"):
                raise _NotReadError(f"element {key} has a transformation")
            if _is_placed(_unwrapped(marks.get("frame") or {})):
                raise _NotReadError(f"element {key} has a frame of its own")
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


def _is_placed(frame: dict[str, Any]) -> bool:
    """Whether the frame of an element differs from that of the model; earlier versions of compas_model placed elements by frames."""
    world = {"point": [0.0, 0.0, 0.0], "xaxis": [1.0, 0.0, 0.0], "yaxis": [0.0, 1.0, 0.0]}
    return any(not np.allclose(np.array(frame.get(key, axis), dtype=float), axis, rtol=0.0) for key, axis in world.items())


def _unwrapped(value: dict[str, Any]) -> dict[str, Any]:
    """The data of an object that COMPAS wraps as {"dtype": ..., "data": ...}; version 1 writes "value" for "data", and may wrap twice."""
    while "dtype" in value or "datatype" in value:
        value = value["data"] if "data" in value else value["value"]
    return dict(value)


def _compas_mesh(block: dict[str, Any]) -> tuple[str, np.ndarray, list[list[int]]]:
    """Name (or ""), vertices and faces of a mesh. The keys of vertices are texts, but a face may give them as numbers."""
    mesh = _unwrapped(block)
    place = {str(key): number for number, key in enumerate(mesh["vertex"])}
    default = mesh.get("default_vertex_attributes") or mesh.get("dva") or {}
    vertices = [[float({**default, **vertex}[axis]) for axis in "xyz"] for vertex in mesh["vertex"].values()]
    faces = [[place[str(corner)] for corner in face] for face in mesh["face"].values() if len(face) >= 3]
    return str(block.get("name") or ""), np.array(vertices).reshape(-1, 3), faces
