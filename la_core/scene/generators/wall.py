"""Blocks of a `[[wall]]` table, the same as a user could have typed."""

from collections.abc import Iterator
from dataclasses import dataclass

from la_core.geometry import Shape, box, prism
from la_core.scene.generators.courses import Face, Piece
from la_core.scene.schema.masonry import Wall


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
        Carried mass, such as a floor's, over the volume of the block, kg/m3.
    joint : float
        Greatest width of the open joints around the block, which are to be closed, m; 0 where they are drawn closed.
    """

    name: str
    role: str
    density: float | None
    shape: Shape
    added_density: float = 0.0
    joint: float = 0.0


def wall_blocks(wall: Wall) -> Iterator[NamedShape]:
    """Blocks of a wall, course by course from the bottom, leaf by leaf, left to right; heads bridge openings through all leaves."""
    length, depth, height = wall.block
    x0, y0, z0 = wall.origin
    face = Face(f'wall "{wall.name}"', wall.per_course * length, height, wall.courses, length)
    for course in range(wall.courses):
        z = (z0 + course * height, z0 + (course + 1) * height)
        number = 0
        for leaves, pieces in _layers(wall, face, course):
            y = (y0 + leaves[0] * depth, y0 + leaves[1] * depth)
            for piece in pieces:
                number += 1
                yield NamedShape(f"{wall.name} {course + 1}.{number}", "free", wall.density, piece_shape(piece, x0, y, z))


def _layers(wall: Wall, face: Face, course: int) -> Iterator[tuple[tuple[int, int], list[Piece]]]:
    """Layers of a course across the wall: first and last leaf, and their pieces; a head of an opening spans all leaves."""
    starts_half = wall.bond == "running" and (course % 2 == 1) != (wall.first == "half")
    stretchers = face.pieces(course, wall.block[0] / 2.0 if starts_half else 0.0, (), wall.opening)
    spanning = [piece for piece in stretchers if _is_head(face, wall, course, piece)] if wall.leaves > 1 else []
    stretchers = [piece for piece in stretchers if piece not in spanning]
    if wall.headers_every and course % wall.headers_every == wall.headers_every - 1:
        # A quarter of a block aside, so that no header's joint lies on a stretcher's.
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
    above = [opening for opening in wall.opening if face.opening_courses(opening)[1] == course]
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
    (left, right), (top_left, top_right) = piece.foot, piece.head
    if piece.foot == piece.head:
        return box((x0 + left, y[0], z[0]), (x0 + right, y[1], z[1]))
    return prism([(x0 + left, z[0]), (x0 + right, z[0]), (x0 + top_right, z[1]), (x0 + top_left, z[1])], y)
