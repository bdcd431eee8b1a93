"""Blocks of a `[[wall]]` table, identical to blocks that a user types one by one."""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from la_core.geometry import Shape, box, prism
from la_core.scene.generators.arched_heads import ArchedHead, arched_head
from la_core.scene.generators.courses import ON_LINE, Face, Piece
from la_core.scene.generators.placing import leaning, turned
from la_core.scene.schema.masonry import Footing, Wall


@dataclass(frozen=True)
class NamedShape:
    """A block before its mass is known.

    Attributes
    ----------
    name : str
        Unique name.
    role : str
        "free", "fixed" or "support".
    density : float or None
        Density, kg/m3; None for the density of the scene's stone.
    shape : Shape
        Shape.
    added_density : float
        Carried mass, such as that of a floor, over the volume of the block, kg/m3.
    joint : float
        Greatest width of the open joints around the block that are to be closed, m; 0 where all joints are drawn closed.
    groups : tuple of str
        Groups by which other tables may choose the block, such as "layer:BRICK".
    made_convex : bool
        Whether dents of a body of a mesh were filled within the tolerance.
    """

    name: str
    role: str
    density: float | None
    shape: Shape
    added_density: float = 0.0
    joint: float = 0.0
    groups: tuple[str, ...] = ()
    made_convex: bool = False


def wall_blocks(wall: Wall) -> Iterator[NamedShape]:
    """Blocks of a wall, course by course from the bottom, leaf by leaf, left to right; then voussoirs of arches, and the footing.

    Heads bridge openings through all leaves.
    """
    face = wall_face(wall)
    for course in range(face.courses):
        number = 0
        for leaves, pieces in _layers(wall, face, course):
            for piece in pieces:
                number += 1
                shape = _solid(wall, face, piece, course, leaves)
                yield NamedShape(f"{wall.name} {course + 1}.{number}", "free", wall.density, shape)
    for opening, head in enumerate(_arches(wall, face), 1):
        for number, profile in enumerate(head.voussoirs, 1):
            name = f"{wall.name} arch {opening}.{number}"
            yield NamedShape(name, "free", wall.density, _leaning(wall, face, profile))
    if wall.footing:
        yield from footing_blocks(wall.name, wall.footing, wall.origin, (wall.length, wall.leaves * wall.block[1]), wall.angle)


def wall_face(wall: Wall) -> Face:
    """The wall seen from its front: course lines, and the start and end of the wall along each line."""
    heights = wall.heights or (wall.block[2],)
    lines = (
        [wall.block[2] * course for course in range(wall.courses + 1)]
        if not wall.heights
        else [0.0, *itertools.accumulate(heights[course % len(heights)] for course in range(wall.courses))]
    )
    top, (start, end) = lines[-1], wall.rake
    ends = [(start * line / top, wall.length - end * line / top) for line in lines]
    if wall.gable is not None:
        count = max(1, round(wall.gable / (top / wall.courses)))
        low, high = ends[-1]
        middle = (low + high) / 2.0
        for k in range(1, count + 1):
            share = k / count
            lines.append(top + wall.gable * share)
            ends.append((low + share * (middle - low), high + share * (middle - high)))
        ends[-1] = middle, middle
    return Face(f'wall "{wall.name}"', wall.length, tuple(lines), wall.block[0], tuple(ends))


def footing_blocks(
    name: str, footing: Footing, origin: tuple[float, float, float], size: tuple[float, float], angle: float
) -> Iterator[NamedShape]:
    """Strip of ground under a structure, cut where a part of it settles.

    Parameters
    ----------
    name : str
        Name of the structure, the prefix of the blocks' names.
    footing : Footing
        Height and settling part.
    origin : tuple of float
        Lower left front corner of the structure, m.
    size : tuple of float
        Length and depth of the structure, m.
    angle : float
        Direction of the structure in plan, degrees.
    """
    x0, y0, z0 = origin
    low, high = footing.settling or (0.0, 0.0)
    near = ON_LINE * size[0]
    cuts = [0.0, *(cut for cut in (low, high) if near < cut < size[0] - near), size[0]]
    for number, (start, end) in enumerate(itertools.pairwise(cuts), 1):
        settles = low < (start + end) / 2.0 < high
        shape = box((x0 + start, y0, z0 - footing.height), (x0 + end, y0 + size[1], z0))
        yield NamedShape(f"{name} footing {number}", "support" if settles else "fixed", None, turned(shape, origin, angle))


def _arches(wall: Wall, face: Face) -> Iterator[ArchedHead]:
    for opening in wall.opening:
        if opening.head == "arch":
            yield arched_head(face.where, face.lines, face.opening_courses(opening)[1], opening)


def _solid(wall: Wall, face: Face, piece: Piece, course: int, leaves: tuple[int, int]) -> Shape:
    """A piece of a course in space; a box or a prism where the wall is upright."""
    depth, (x0, y0, z0) = wall.block[1], wall.origin
    low, high = face.lines[course : course + 2]
    if any(wall.taper):
        return _leaning(wall, face, piece.corners(low, high))
    shape = piece_shape(piece, x0, (y0 + leaves[0] * depth, y0 + leaves[1] * depth), (z0 + low, z0 + high))
    return turned(shape, wall.origin, wall.angle)


def _leaning(wall: Wall, face: Face, profile: Sequence[tuple[float, float]]) -> Shape:
    """A profile of the wall's face in space, through a wall of one leaf."""
    (x0, y0, z0), (front, back) = wall.origin, wall.taper
    foot, head = (y0, y0 + wall.block[1]), (y0 + front, y0 + wall.block[1] - back)
    shape = leaning([(x0 + x, z0 + z) for x, z in profile], foot, head, (z0, z0 + face.lines[-1]))
    return turned(shape, wall.origin, wall.angle)


def _layers(wall: Wall, face: Face, course: int) -> Iterator[tuple[tuple[int, int], list[Piece]]]:
    """Layers of a course across the wall: range of leaves (first, last + 1), and pieces; a head of an opening spans all leaves."""
    starts_half = wall.bond == "running" and (course % 2 == 1) != (wall.first == "half")
    stretchers = face.pieces(course, wall.block[0] / 2.0 if starts_half else 0.0, (), wall.opening)
    spanning = [piece for piece in stretchers if _is_head(face, wall, course, piece)] if wall.leaves > 1 else []
    stretchers = [piece for piece in stretchers if piece not in spanning]
    if wall.headers_every and course % wall.headers_every == wall.headers_every - 1:
        # Headers are shifted by a quarter of a block, so that no joint of theirs lies on a joint between stretchers.
        headers = face.pieces(course, wall.block[0] / 4.0, (), wall.opening, pitch=0.5)
        headers = [piece for piece in headers if not _is_head(face, wall, course, piece)]
        tied = (course // wall.headers_every) % 2 if wall.leaves == 3 else 0
        yield (tied, tied + 2), headers
        if wall.leaves == 3:
            yield ((2, 3) if tied == 0 else (0, 1)), stretchers
    else:
        for leaf in range(wall.leaves):
            yield (leaf, leaf + 1), stretchers
    yield (0, wall.leaves), spanning


def _is_head(face: Face, wall: Wall, course: int, piece: Piece) -> bool:
    """Whether a piece is a lintel or belongs to a flat arch or its skewbacks."""
    above = [opening for opening in wall.opening if opening.head != "arch" and face.opening_courses(opening)[1] == course]
    return piece.foot != piece.head or any(piece.head[0] <= opening.from_[0] and piece.head[1] >= opening.to[0] for opening in above)


def piece_shape(piece: Piece, x0: float, y: tuple[float, float], z: tuple[float, float]) -> Shape:
    """Solid of a piece of a wall along x.

    Parameters
    ----------
    piece : Piece
        Foot and head along the wall, m.
    x0 : float
        Start of the wall, m.
    y : tuple of float
        Front and back, m.
    z : tuple of float
        Bottom and top, m.
    """
    if piece.foot == piece.head:
        return box((x0 + piece.foot[0], y[0], z[0]), (x0 + piece.foot[1], y[1], z[1]))
    return prism([(x0 + along, up) for along, up in piece.corners(*z)], y)
