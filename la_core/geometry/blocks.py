"""Blocks as flat arrays: vertices, faces, and their mass properties."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from la_core.exchange import FIXED, FREE, SUPPORT
from la_core.geometry.polygons import owners
from la_core.geometry.shapes import Shape

ROLES = {"free": FREE, "fixed": FIXED, "support": SUPPORT}


@dataclass(frozen=True, eq=False)
class Blocks:
    """All B blocks of a structure as flat arrays (see `la_core.exchange` for the layout); SI units.

    Attributes
    ----------
    names : tuple of str
        Unique name of each block.
    role : (B,) array of int
        FREE, FIXED or SUPPORT.
    density : (B,) array
        Density, kg/m3; NaN for a held block without one.
    vertices : (V, 3) array
        Vertices of all blocks, block after block, m.
    vertex_start : (B + 1,) array of int
        Block i has vertices[vertex_start[i]:vertex_start[i + 1]].
    face_vertex : (L,) array of int
        Face loops: rows of `vertices`, counter-clockwise seen from outside.
    face_start : (F + 1,) array of int
        Face j has face_vertex[face_start[j]:face_start[j + 1]].
    face_block : (F,) array of int
        Block of each face.
    face_normal : (F, 3) array
        Outward unit normal of each face.
    face_offset : (F,) array
        Offset of each face plane, normal . x = offset, m.
    volume : (B,) array
        Volume, m3.
    centroid : (B, 3) array
        Centroid, m.
    inertia : (B, 3, 3) array
        Inertia about the centroid, global axes, kg m2; NaN for a held block without density.
    part_block : (P,) array of int
        Block of each convex part. A convex block has one part; the parts of another block move as one.
    part_vertex_start, part_face_start : (P + 1,) arrays of int
        Part i has vertices[part_vertex_start[i]:part_vertex_start[i + 1]], and likewise its faces.
    groups : tuple of tuples of str
        Groups of each block, such as "layer:BRICK" for its layer in a drawing; () where no block has one.
    """

    names: tuple[str, ...]
    role: np.ndarray
    density: np.ndarray
    vertices: np.ndarray
    vertex_start: np.ndarray
    face_vertex: np.ndarray
    face_start: np.ndarray
    face_block: np.ndarray
    face_normal: np.ndarray
    face_offset: np.ndarray
    volume: np.ndarray
    centroid: np.ndarray
    inertia: np.ndarray
    part_block: np.ndarray
    part_vertex_start: np.ndarray
    part_face_start: np.ndarray
    groups: tuple[tuple[str, ...], ...] = ()

    @classmethod
    def gather(
        cls,
        names: Sequence[str],
        roles: Sequence[str],
        densities: Sequence[float],
        shapes: Sequence[Shape],
        groups: Sequence[tuple[str, ...]] = (),
    ) -> "Blocks":
        """Gather single shapes into flat arrays, with their face planes and mass properties.

        Parameters
        ----------
        names : sequence of str
            Unique name of each of the B blocks.
        roles : sequence of str
            Role of each block: "free", "fixed" or "support".
        densities : sequence of float
            Density of each block, kg/m3; NaN for a held block without one.
        shapes : sequence of Shape
            Shape of each block.
        groups : sequence of tuples of str, optional
            Groups of each block.
        """
        vertices = np.concatenate([shape.vertices for shape in shapes])
        vertex_start = np.concatenate([[0], np.cumsum([len(shape.vertices) for shape in shapes])])
        loops = [np.array(face) + start for shape, start in zip(shapes, vertex_start, strict=False) for face in shape.faces]
        face_vertex = np.concatenate(loops)
        face_start = np.concatenate([[0], np.cumsum([len(loop) for loop in loops])])
        face_block = np.repeat(np.arange(len(shapes)), [len(shape.faces) for shape in shapes])
        normal, offset = _face_planes(vertices, face_vertex, face_start)
        density = np.array(densities, dtype=float)
        volume, centroid, inertia = _mass_properties(vertices, vertex_start, face_vertex, face_start, face_block)
        role = np.array([ROLES[role] for role in roles])
        sizes = [shape.part_sizes or ((len(shape.vertices), len(shape.faces)),) for shape in shapes]
        part_block = np.repeat(np.arange(len(shapes)), [len(parts) for parts in sizes])
        part_start = np.concatenate([np.zeros((1, 2), dtype=int), np.cumsum(np.concatenate([np.array(parts) for parts in sizes]), axis=0)])
        return cls(
            tuple(names), role, density, vertices, vertex_start, face_vertex, face_start, face_block,
            normal, offset, volume, centroid, inertia * density[:, None, None], part_block, part_start[:, 0], part_start[:, 1],
            tuple(groups),
        )  # fmt: skip

    def __len__(self) -> int:
        return len(self.names)

    def __repr__(self) -> str:
        """Return one line: the arrays would fill pages."""
        return f"<Blocks: {int(self.free.sum())} free of {len(self)}, {len(self.vertices)} vertices, {len(self.face_block)} faces>"

    @property
    def is_compound(self) -> np.ndarray:
        """Mask (B,) of the blocks that consist of several convex parts."""
        return np.bincount(self.part_block, minlength=len(self)) > 1

    @cached_property
    def parts(self) -> "Blocks":
        """Every convex part as a block of its own, with the name, role and density of its block; the same object if all are convex."""
        count = len(self.part_block)
        if count == len(self):
            return self
        face_block = owners(self.part_face_start)
        measures = _mass_properties(self.vertices, self.part_vertex_start, self.face_vertex, self.face_start, face_block)
        density = self.density[self.part_block]
        return Blocks(
            tuple(self.names[block] for block in self.part_block), self.role[self.part_block], density,
            self.vertices, self.part_vertex_start, self.face_vertex, self.face_start, face_block, self.face_normal, self.face_offset,
            measures[0], measures[1], measures[2] * density[:, None, None],
            np.arange(count), self.part_vertex_start, self.part_face_start,
        )  # fmt: skip

    @property
    def free(self) -> np.ndarray:
        """Mask (B,) of the free blocks."""
        return self.role == FREE

    @property
    def mass(self) -> np.ndarray:
        """Mass (B,), kg; NaN for a held block without density."""
        return self.density * self.volume

    @property
    def vertex_block(self) -> np.ndarray:
        """Block (V,) of each vertex."""
        return owners(self.vertex_start)

    @property
    def low(self) -> np.ndarray:
        """Lower corner (B, 3) of each bounding box, m."""
        return np.minimum.reduceat(self.vertices, self.vertex_start[:-1])

    @property
    def high(self) -> np.ndarray:
        """Upper corner (B, 3) of each bounding box, m."""
        return np.maximum.reduceat(self.vertices, self.vertex_start[:-1])


class Held:
    """Base of a frozen dataclass with read-only contents: its arrays and tables, and the arrays of records in it.

    They stay read-only in copies, and after unpickling in another process. With `repr=False` the object shows itself in one line.
    """

    def __post_init__(self) -> None:
        # A record derived from Held has already protected its own arrays.
        others = (value for value in vars(self).values() if is_dataclass(value) and not isinstance(value, Held))
        records = [self, *others]
        for array in (value for record in records for value in vars(record).values() if isinstance(value, np.ndarray)):
            array.setflags(write=False)
        for name, table in [(name, value) for name, value in vars(self).items() if isinstance(value, dict)]:
            object.__setattr__(self, name, MappingProxyType(dict(table)))

    def __getstate__(self) -> dict[str, Any]:
        return {name: dict(value) if isinstance(value, MappingProxyType) else value for name, value in vars(self).items()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self.__post_init__()

    def __repr__(self) -> str:
        """Return one line with the shape of each array: their values would fill pages."""
        return f"<{type(self).__name__}: {', '.join(_brief(field.name, vars(self)[field.name]) for field in fields(self))}>"  # type: ignore[arg-type]


def _brief(name: str, value: Any) -> str:
    """A named value of a record in a few words."""
    if isinstance(value, np.ndarray):
        return f"{name} {value.shape}"
    if isinstance(value, float):
        return f"{name} {value:.6g}"
    return f"{name} {value}" if isinstance(value, str | int) else name


def _triangles(face_vertex: np.ndarray, face_start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Fan triangulation of every face: vertex indices (T, 3) and the face of each triangle (T,)."""
    counts = np.diff(face_start) - 2
    face = np.repeat(np.arange(len(counts)), counts)
    place = np.arange(len(face)) - np.repeat(np.cumsum(counts) - counts, counts) + 1
    first = face_start[face]
    return face_vertex[np.stack([first, first + place, first + place + 1], axis=1)], face


def _face_planes(vertices: np.ndarray, face_vertex: np.ndarray, face_start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Outward unit normal (F, 3) and offset (F,), m, of the plane of every face, through the mean of its corners."""
    corners, face = _triangles(face_vertex, face_start)
    a, b, c = (vertices[corners[:, k]] for k in range(3))
    normal = np.zeros((len(face_start) - 1, 3))
    np.add.at(normal, face, np.cross(b - a, c - a))
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    mean = np.add.reduceat(vertices[face_vertex], face_start[:-1]) / np.diff(face_start)[:, None]
    return normal, np.sum(normal * mean, axis=1)


def _mass_properties(
    vertices: np.ndarray, vertex_start: np.ndarray, face_vertex: np.ndarray, face_start: np.ndarray, face_block: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Volume (B,), centroid (B, 3) and inertia (B, 3, 3) about the centroid at unit density.

    A tetrahedron joins the first vertex of each block to every triangle of its faces.
    """
    count = len(vertex_start) - 1
    corners, face = _triangles(face_vertex, face_start)
    block = face_block[face]
    origin = vertices[vertex_start[:-1]]
    a, b, c = (vertices[corners[:, k]] - origin[block] for k in range(3))
    six_volumes = np.sum(a * np.cross(b, c), axis=1)
    total = a + b + c
    # Over a tetrahedron (0, a, b, c), with s = a+b+c, det = a . (b x c): integral of x, det/24 s; of x x', det/120 (ss' + aa' + bb' + cc').
    volume, first, second = np.zeros(count), np.zeros((count, 3)), np.zeros((count, 3, 3))
    np.add.at(volume, block, six_volumes / 6.0)
    np.add.at(first, block, six_volumes[:, None] * total / 24.0)
    outer = sum(vector[:, :, None] * vector[:, None, :] for vector in (total, a, b, c))
    np.add.at(second, block, six_volumes[:, None, None] * outer / 120.0)
    arm = first / volume[:, None]
    second -= volume[:, None, None] * arm[:, :, None] * arm[:, None, :]
    inertia = np.trace(second, axis1=1, axis2=2)[:, None, None] * np.eye(3) - second
    return volume, origin + arm, inertia
