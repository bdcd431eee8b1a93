"""Small drawings as text: the same wall as DXF and as SVG."""

from collections.abc import Iterable, Sequence

Points = Sequence[Sequence[float]]
WALL = {  # mm; a base and six bricks with 10 mm joints
    "GROUND": [[(0, -205), (1600, -205), (1600, -5), (0, -5)]],
    "SETTLING": [[(1600, -205), (2400, -205), (2400, -5), (1600, -5)]],
    "BRICKS": [
        *([(x + 5, 5), (x + 795, 5), (x + 795, 195), (x + 5, 195)] for x in (0, 800, 1600)),
        [(5, 205), (395, 205), (395, 395), (5, 395)],
        *([(x + 5, 205), (x + 795, 205), (x + 795, 395), (x + 5, 395)] for x in (400, 1200)),
        [(2005, 205), (2395, 205), (2395, 395), (2005, 395)],
    ],
}


def rows(*pairs: tuple[int, object]) -> str:
    """Return group codes and values as text of a DXF file."""
    return "".join(f"{code}\n{value}\n" for code, value in pairs)


def begun(kind: str, layer: str) -> tuple[tuple[int, object], ...]:
    """The first rows of an entity."""
    return (0, kind), (100, "AcDbEntity"), (8, layer)


def polyline(points: Points, layer: str, colour: int = 256, bulges: Sequence[float] = (), closed: bool = True) -> str:
    """An LWPOLYLINE."""
    corners: list[tuple[int, object]] = []
    for k, (x, y) in enumerate(points):
        corners += [(10, x), (20, y), *([(42, bulges[k])] if bulges else [])]
    return rows(*begun("LWPOLYLINE", layer), (62, colour), (100, "AcDbPolyline"), (90, len(points)), (70, int(closed)), *corners)


def line(start: Sequence[float], end: Sequence[float], layer: str) -> str:
    """A LINE."""
    return rows(*begun("LINE", layer), (100, "AcDbLine"), (10, start[0]), (20, start[1]), (11, end[0]), (21, end[1]))


def lines(points: Points, layer: str) -> str:
    """A closed outline as LINEs."""
    return "".join(line(start, end, layer) for start, end in zip(points, [*points[1:], points[0]], strict=True))


def insert(
    name: str,
    at: Sequence[float],
    layer: str,
    columns: int = 1,
    spacing: float = 0.0,
    scale: Sequence[float] = (1.0, 1.0),
    turn: float = 0.0,
    courses: int = 1,
) -> str:
    """An INSERT, repeated along x, and along y for several courses. scale: along its own x and y; turn: degrees."""
    many = [(70, columns), (44, spacing)] if columns > 1 else []
    many += [(71, courses), (45, spacing)] if courses > 1 else []
    many += [(41, scale[0]), (42, scale[1]), (50, turn)] if (*scale, turn) != (1.0, 1.0, 0.0) else []
    return rows(*begun("INSERT", layer), (100, "AcDbBlockReference"), (2, name), (10, at[0]), (20, at[1]), *many)


def dxf(entities: Iterable[str], unit: int | None = 4, blocks: dict[str, str] | None = None) -> bytes:
    """Return a DXF file of entities, with blocks by name. unit: code of $INSUNITS, None for a file without it."""
    header = rows((0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1015"), *([] if unit is None else [(9, "$INSUNITS"), (70, unit)]))
    text = header + rows((0, "ENDSEC"))
    if blocks:
        text += rows((0, "SECTION"), (2, "BLOCKS"))
        for name, content in blocks.items():
            text += (
                rows(*begun("BLOCK", "0"), (100, "AcDbBlockBegin"), (2, name), (70, 0), (10, 0), (20, 0), (3, name))
                + content
                + rows(*begun("ENDBLK", "0"), (100, "AcDbBlockEnd"))
            )
        text += rows((0, "ENDSEC"))
    text += rows((0, "SECTION"), (2, "ENTITIES")) + "".join(entities) + rows((0, "ENDSEC"), (0, "EOF"))
    return text.encode()


def wall_dxf() -> bytes:
    """Return the wall as DXF: polylines, one brick of lines, one brick as a block, one brick drawn twice."""
    entities = [polyline(outline, layer) for layer in ("GROUND", "SETTLING") for outline in WALL[layer]]
    first, second, third, *others = WALL["BRICKS"]
    entities += [lines(first, "BRICKS"), insert("BRICK", second[0], "BRICKS"), polyline(third, "BRICKS"), polyline(third, "BRICKS")]
    entities += [polyline(outline, "BRICKS", colour=3) for outline in others]
    return dxf(entities, blocks={"BRICK": polyline([(0, 0), (790, 0), (790, 190), (0, 190)], "0")})


def wall_svg() -> bytes:
    """Return the same wall as SVG, on a page of 3 m, moved by a group."""
    groups = []
    for layer, outlines in WALL.items():
        paths = "".join(f'<path fill="red" d="M {" L ".join(f"{x},{-z}" for x, z in outline)} Z"/>' for outline in outlines)
        groups.append(f'<g id="{layer}" transform="translate(100, 0)"><g transform="translate(-100)">{paths}</g></g>')
    page = '<svg xmlns="http://www.w3.org/2000/svg" width="3000mm" height="1000mm" viewBox="0 -500 3000 1000">'
    return f"{page}{''.join(groups)}</svg>".encode()
