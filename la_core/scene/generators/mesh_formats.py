"""Bodies from the content of mesh files: OBJ, PLY, STL and COMPAS assemblies. Content is data; nothing it names is opened or run."""

import io
import json
from collections import Counter
from typing import Any

import numpy as np

from la_core.scene.generators.mesh_surface import Surface, surface

DEFAULT_GROUP = "default"  # what the format calls the group before any `g`; some programs write it out, and empty


def surfaces(suffix: str, content: bytes, stem: str) -> list[Surface]:
    """All bodies in a file's content; `stem` names a body that has no name of its own.

    Raises ValueError saying what is wrong with the content, ImportError where PLY or STL lack their reader.
    """
    if suffix == ".obj":
        return _obj_surfaces(content.decode("utf-8", errors="replace"), stem)
    if suffix == ".json":
        return _compas_surfaces(content)
    return _triangle_surfaces(suffix, content, stem)


def _obj_surfaces(text: str, stem: str) -> list[Surface]:
    """Bodies of a Wavefront OBJ: one per `o`, or one per `g` where there is at most one `o`. Materials are not looked at."""
    lines = [line.split(maxsplit=1) for line in text.replace("\\\r\n", " ").replace("\\\n", " ").splitlines()]
    declared = Counter(words[0] for words in lines if words)
    part = "g" if declared["g"] and declared["o"] <= 1 else "o"
    vertices: list[list[float]] = []
    bodies: dict[str, list[tuple[int, ...]]] = {}
    name = stem
    for number, words in enumerate(lines, 1):
        key, rest = (*words, "", "")[:2]
        try:
            if key == "v":
                x, y, z, *_ = map(float, rest.split("#")[0].split())
                vertices.append([x, y, z])
            elif key == "f":
                bodies.setdefault(name, []).append(_obj_face(rest.split("#")[0], len(vertices)))
            elif key == part:
                name = rest.strip() or stem
                bodies.setdefault(name, [])
        except ValueError as error:
            raise ValueError(f"line {number}, `{key} {rest.strip()[:60]}`, cannot be read: {error}") from error
    if bodies.get(DEFAULT_GROUP) == []:
        del bodies[DEFAULT_GROUP]
    points = np.array(vertices).reshape(-1, 3)
    return [surface(body, points, faces) for body, faces in bodies.items()]


def _obj_face(text: str, count: int) -> tuple[int, ...]:
    """Vertex indices of one `f` line: the first number of each corner, from 1, or from the end where negative."""
    given = [int(corner.split("/")[0]) for corner in text.split()]
    face = tuple(index - 1 if index > 0 else count + index for index in given)
    if len(face) < 3:
        raise ValueError("a face has at least three corners")
    if any(index == 0 for index in given) or any(not 0 <= index < count for index in face):
        raise ValueError(f"a corner is none of the {count} vertices so far")
    return face


def _triangle_surfaces(suffix: str, content: bytes, stem: str) -> list[Surface]:
    """Bodies of a PLY or STL file by trimesh: no resolver, so that no texture is followed, and nothing mended."""
    import trimesh  # noqa: PLC0415 - an optional extra

    try:
        loaded = trimesh.load_scene(io.BytesIO(content), file_type=suffix[1:], process=False, skip_materials=True, resolver=None)
        found = {str(name): (np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces)) for name, mesh in loaded.geometry.items()}
    except Exception as error:  # whatever a reader of foreign bytes stumbles over
        raise ValueError(f"not a whole {suffix[1:].upper()} file: {error or type(error).__name__}") from error
    if any(faces.size and not 0 <= faces.min() <= faces.max() < len(vertices) for vertices, faces in found.values()):
        raise ValueError("a face has a corner that is none of the vertices")
    return [surface(stem if len(found) == 1 else name, vertices, faces.tolist()) for name, (vertices, faces) in found.items()]


def _compas_surfaces(content: bytes) -> list[Surface]:
    """Blocks of an assembly as `compas_assembly` writes it: nodes with a block each (0.4 and later), or a table of blocks (before)."""
    try:
        data = _unwrapped(json.loads(content))
        if "blocks" in data:
            marks = data["assembly"].get("vertex") or data["assembly"].get("node") or {}
            nodes = [(key, block, marks.get(key, {})) for key, block in data["blocks"].items()]
        else:
            graph = _unwrapped(data["graph"])
            nodes = [(key, node.get("block") or node["part"], node) for key, node in graph["node"].items()]
        named = [(str(key), *_compas_mesh(block), bool(marks.get("is_support"))) for key, block, marks in nodes]
    except (ValueError, KeyError, TypeError, AttributeError, IndexError, OverflowError, RecursionError) as error:
        raise ValueError(f"not an assembly as COMPAS writes it ({type(error).__name__}: {error})") from error
    shared = Counter(name for _, name, *_ in named)
    return [
        surface(name if name and shared[name] == 1 else f"block {key}", vertices, faces, held) for key, name, vertices, faces, held in named
    ]


def _unwrapped(value: dict[str, Any]) -> dict[str, Any]:
    """COMPAS wraps an object as {"dtype": ..., "data": ...}; version 1 called the second key "value"."""
    if "dtype" not in value:
        return value
    return dict(value["data"] if "data" in value else value["value"])


def _compas_mesh(block: dict[str, Any]) -> tuple[str, np.ndarray, list[list[int]]]:
    """Name (or nothing), vertices and faces of a mesh; keys of vertices are texts that a face may give as numbers."""
    mesh = _unwrapped(block)
    place = {str(key): number for number, key in enumerate(mesh["vertex"])}
    default = mesh.get("default_vertex_attributes") or mesh.get("dva") or {}
    vertices = [[float({**default, **vertex}[axis]) for axis in "xyz"] for vertex in mesh["vertex"].values()]
    faces = [[place[str(corner)] for corner in face] for face in mesh["face"].values()]
    return str(block.get("name") or ""), np.array(vertices).reshape(-1, 3), faces
