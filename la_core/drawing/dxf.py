"""Outlines of a DXF file, by ezdxf: polylines with arcs, lines, circles and splines, also within inserted blocks."""

import io
import itertools
import math
import re
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from la_core.drawing.outlines import CLIPPED, ELSEWHERE, HIDDEN, MISSING, Drawn

INSERT_UNITS = {
    1: 0.0254,
    2: 0.3048,
    3: 1609.344,
    4: 1e-3,
    5: 1e-2,
    6: 1.0,
    7: 1e3,
    9: 2.54e-5,
    10: 0.9144,
    13: 1e-6,
    14: 1e-1,
    15: 10.0,
    16: 100.0,
    21: 0.3048,
}  # $INSUNITS of a DXF header, in m; 21 is a US survey foot
COLOURS = {1: "red", 2: "yellow", 3: "green", 4: "cyan", 5: "blue", 6: "magenta", 7: "white"}
BY_BLOCK, BY_LAYER = 0, 256
CURVES = ("LINE", "ARC", "LWPOLYLINE", "POLYLINE", "CIRCLE", "ELLIPSE", "SPLINE")
MOST_ENTITIES = 500_000
SPLINE_FRAME = 16  # flag of the vertices of a polyline that only guide its curve
DEEPEST = 20  # inserts within inserts
LEAST_CHORDS, MOST_CHORDS = 2, 1024  # of a curve; MOST_CHORDS follow half a circle to within FINEST of its size
CUBIC = 3  # degree of most splines
BEZIER_ARC = 30.0  # degrees: most of an arc that one Bézier curve follows, to within 4e-7 of the radius; over 90 degrees it is 3e-4
LARGEST = 1e12  # units of the file: largest extent of one entity
FINEST = 1e-6  # of an entity's extent: smallest sagitta in use
DWG = b"AC10"  # the first bytes of a DWG file
BINARY = b"AutoCAD Binary DXF"  # the first bytes of a binary DXF file
CONFLICT = re.compile(r"(\w+)\(#(\w+)\) with a conflicting handle")  # message of ezdxf about an entity that it left out
REMOVED = re.compile(r"Removed SPLINE\(#\w+\) with (invalid .*)")  # message of ezdxf about a spline that it removed
RECOVERED = re.compile(r'value "(.*)" near line (\d+)')  # message of ezdxf about a number that it guessed


@np.errstate(over="ignore", invalid="ignore", divide="ignore")  # a number that is too large is refused with a message
def read_dxf(content: bytes, unit: float | None, sagitta: float, scale: float = 1.0) -> Drawn:
    """Outlines and lines in the model space of a DXF file; parameters and errors are those of `read_outlines`."""
    if content.startswith(DWG):
        raise ValueError("is a DWG file; save it as DXF")
    if content.startswith(BINARY):
        raise ValueError("is a binary DXF file; save it as a DXF file of text (ASCII)")
    from ezdxf import recover  # noqa: PLC0415 - an optional extra

    try:
        document, auditor = recover.read(io.BytesIO(content))
        code = int(document.header.get("$INSUNITS", 0))
    except Exception as error:  # damaged bytes may raise any error in ezdxf
        raise ValueError(f"is not a whole DXF file: {_words(error)}; save it again in a CAD program") from error
    _refuse_damage(auditor)
    paper = unit or INSERT_UNITS.get(code)
    if paper is None:
        fault = f"has an unknown code for its unit ($INSUNITS = {code})" if code else "does not say its unit"
        raise ValueError(f'{fault}; state it: unit = "mm"')
    metres = paper * scale
    drawn = Drawn(metres)
    for kind, count in _out_of_reach(document, auditor).items():
        drawn.ignored |= {kind: count} if count else {}
    try:
        for entity, layer, colour, motion in _entities(document.modelspace(), document, "0", "white", None, 0, itertools.count(1)):
            _add(drawn, entity, (layer, colour), motion, metres, sagitta)
    except ValueError:
        raise
    except Exception as error:
        raise ValueError(f"holds an entity that cannot be read: {_words(error)}") from error
    return drawn


def _refuse_damage(auditor: Any) -> None:
    """Raise ValueError if ezdxf guessed a coordinate, or removed a spline or one of two entities with one handle: stones would be wrong."""
    from ezdxf.audit import AuditError  # noqa: PLC0415

    for damage in (found[1] for found in (REMOVED.match(fix.message) for fix in auditor.fixes) if found):
        raise ValueError(f"holds a SPLINE that cannot be read: {damage}; save it again in a CAD program")
    removed = [fix.message for fix in auditor.fixes if fix.code == AuditError.REMOVED_INVALID_DXF_OBJECT]
    for kind, handle in (found.groups() for found in map(CONFLICT.search, removed) if found):
        if kind in (*CURVES, "INSERT"):
            where = f"holds a {kind} and another entity with the same handle {handle} (code 5)"
            raise ValueError(f"{where}, which must be unique; save it again in a CAD program, or leave all handles out")
    guessed = [error.message for error in auditor.errors if error.code == AuditError.INVALID_FLOATING_POINT_VALUE]
    for text, line in (found.groups() for found in map(RECOVERED.search, guessed) if found):
        if not _is_number(text):  # the list also has the valid coordinates of the same point
            raise ValueError(f'holds "{text[:40]}" near its line {line}, where a number is expected; write it with digits and a point')


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _out_of_reach(document: Any, auditor: Any) -> dict[str, int]:
    """Number of entities in paper space, and of inserts of blocks that are missing in the file, by kind."""
    from ezdxf.audit import AuditError  # noqa: PLC0415

    sheets = [layout for layout in document.layouts if not layout.is_modelspace]
    on_sheets = sum(entity.dxftype() != "VIEWPORT" for sheet in sheets for entity in sheet)
    missing = sum(fix.code == AuditError.UNDEFINED_BLOCK for fix in auditor.fixes)
    return {"entities in paper space": on_sheets, MISSING: missing}


def _entities(
    entities: Iterable[Any], document: Any, layer: str, colour: str, motion: Any, depth: int, numbers: Iterator[int]
) -> Iterator[tuple[Any, str, str, Any]]:
    """Yield every entity with its layer, its colour, and the matrix that places the entity of an inserted block; None for no matrix.

    Layer 0 of a block is the layer of its insert. For an entity that is counted only, such as a hidden one, its kind is yielded instead.
    `numbers` counts entities and copies, because copies of an empty block yield nothing. Matrices are multiplied here, because ezdxf
    places a turned block in a stretched one wrongly.
    """
    if depth > DEEPEST:
        raise ValueError(f"has inserts more than {DEEPEST} deep")
    for entity in entities:
        _refuse_too_many(next(numbers) + (entity.mcount if entity.dxftype() == "INSERT" else 0))
        own = _layer(entity, document)
        where = layer if own == "0" and depth else own
        if _is_hidden(entity, document, where):
            yield HIDDEN, where, "", None
            continue
        drawn_in = _colour(entity, document, where, colour)
        if entity.dxftype() != "INSERT":
            yield entity, where, drawn_in, motion
            continue
        for word in _not_followed(entity):
            yield word, where, "", None
        for insert in entity.multi_insert() if entity.mcount > 1 else (entity,):
            _refuse_too_many(next(numbers))
            own_motion = insert.matrix44()
            whole = own_motion if motion is None else own_motion * motion  # row vectors: the inner one comes first
            yield from _entities(insert.block() or (), document, where, drawn_in, whole, depth + 1, numbers)


def _layer(entity: Any, document: Any) -> str:
    """Name of an entity's layer as the file's table of layers spells it: DXF does not distinguish `Stones` and `STONES`."""
    own = str(entity.dxf.get("layer", "0")) or "0"
    return str(document.layers.get(own).dxf.name) if own in document.layers else own


def _not_followed(insert: Any) -> Iterator[str]:
    """Yield the kinds of the parts of an insert that are not read: a drawing in another file, and the clip path of the insert (xclip)."""
    from ezdxf.xclip import XClip  # noqa: PLC0415

    block = insert.block()
    if block is not None and block.block.is_xref:
        yield ELSEWHERE
    if XClip(insert).is_clipping_enabled:
        yield CLIPPED


def _refuse_too_many(number: int) -> None:
    if number > MOST_ENTITIES:
        raise ValueError(f"has more than {MOST_ENTITIES} entities, copies by inserts among them; delete those that are no blocks")


def _add(drawn: Drawn, entity: Any, place: tuple[str, str], motion: Any, scale: float, sagitta: float) -> None:
    kind = entity if isinstance(entity, str) else entity.dxftype()
    is_surface = kind == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline)  # a mesh
    if kind not in CURVES or is_surface:
        drawn.ignore(kind)
        return
    try:
        size, points, curves, meets = (_spline_chords if _is_general_spline(entity) else _chords)(entity, motion, sagitta / scale)
    except Exception as error:  # damaged bytes may raise any error in ezdxf
        raise ValueError(f"holds a {kind} that cannot be read: {_words(error)}") from error
    if not size <= LARGEST:
        raise ValueError(f"holds a {kind} larger than {LARGEST:g} units, or with a coordinate that is not a number; delete it")
    closed = bool(getattr(entity, "is_closed", False) or getattr(entity, "closed", False) or meets)
    drawn.add(scale * points, closed, *place)
    drawn.curves += [scale * points for points in curves]


def _chords(entity: Any, motion: Any, sagitta: float) -> tuple[float, np.ndarray, list[np.ndarray], bool]:
    """Extent of an entity, its corners (n, 2), the chords (m, 2) of each curve, and whether it is closed; in the file's unit."""
    pieces = max(math.ceil(_widest_arc(entity) / BEZIER_ARC), 1)
    curve = _path_of(entity, pieces) if motion is None else _path_of(entity, pieces).transform(motion)
    guides = _flat(curve.control_vertices())
    size = float(np.ptp(guides, axis=0).max()) if len(guides) else 0.0
    if not size <= LARGEST:  # also true for NaN
        return size, guides[:0], [], False
    finest = max(sagitta, FINEST * size)  # limits the number of chords of a huge circle
    least = math.ceil(LEAST_CHORDS / pieces)
    return size, _flat(curve.flattening(finest, least)), _curves(curve, finest, least) if curve.has_curves else [], bool(curve.is_closed)


def _flat(points: Iterable[Any]) -> np.ndarray:
    return np.array([(point[0], point[1]) for point in points], dtype=float).reshape(-1, 2)


def _path_of(entity: Any, pieces: int) -> Any:
    """The path of an entity, as a CAD program shows it, with at least this number of Bézier curves for an arc."""
    from ezdxf import path  # noqa: PLC0415

    if entity.dxftype() == "POLYLINE":  # the frame of a smoothed polyline is not shown
        entity.vertices[:] = [vertex for vertex in entity.vertices if not vertex.dxf.get("flags", 0) & SPLINE_FRAME]
    return path.make_path(entity, segments=3 * pieces if "POLYLINE" in entity.dxftype() else pieces)  # ezdxf takes a third of it for bulges


def _widest_arc(entity: Any) -> float:
    """Largest angle, degrees, that an arc of an entity covers: of an ellipse in its parameter, of a polyline by its bulges; else 0."""
    kind, dxf = entity.dxftype(), entity.dxf
    if kind in ("ARC", "ELLIPSE"):
        span = dxf.end_angle - dxf.start_angle if kind == "ARC" else math.degrees(dxf.end_param - dxf.start_param)
        return float(span - 1e-6) % 360.0 + 1e-6  # a whole turn may end a little beyond its start
    bulges = [vertex.dxf.get("bulge", 0.0) for vertex in entity.vertices] if kind == "POLYLINE" else []
    bulges += [bulge for _, _, bulge in entity.get_points("xyb")] if kind == "LWPOLYLINE" else []
    return 360.0 if kind == "CIRCLE" else math.degrees(4.0 * math.atan(max(map(abs, bulges), default=0.0)))


def _is_general_spline(entity: Any) -> bool:
    """Whether an entity is a spline that ezdxf does not follow exactly.

    ezdxf is exact for cubic splines without weights that begin at their first knot and end at their last one. For any other spline it
    draws a smooth curve through some points, also where the spline has corners. It follows a periodic spline beyond its ends.
    """
    if entity.dxftype() != "SPLINE" or not len(entity.control_points) or not len(entity.knots):
        return False
    degree, knots = entity.dxf.degree, entity.knots
    is_clamped = knots[0] == knots[degree] and knots[-degree - 1] == knots[-1]
    return bool(degree != CUBIC or len(entity.weights) or not is_clamped)


def _spline_chords(spline: Any, motion: Any, sagitta: float) -> tuple[float, np.ndarray, list[np.ndarray], bool]:
    """As `_chords`, for a spline of any degree. The corners lie on the curve itself, and every knot is a corner."""
    from scipy.interpolate import BSpline  # noqa: PLC0415 - few drawings have such splines

    degree, weights = spline.dxf.degree, np.array(spline.weights or [1.0] * len(spline.control_points), dtype=float)
    guides = _flat(spline.control_points if motion is None else motion.transform_vertices(spline.control_points))
    size = float(np.ptp(guides, axis=0).max())
    if not size <= LARGEST:
        return size, guides[:0], [], False
    knots, finest = np.array(spline.knots, dtype=float), max(sagitta, FINEST * size)
    curve = BSpline(knots, np.column_stack([guides * weights[:, None], weights]), degree)
    ends = np.unique(knots[degree : len(knots) - degree])
    spans = [_span(curve, start, end, finest, LEAST_CHORDS if degree > 1 else 1) for start, end in itertools.pairwise(ends)]
    points = np.concatenate([spans[0][:1], *(span[1:] for span in spans)])
    meets = bool(np.hypot(*(points[-1] - points[0])) <= FINEST * size)
    return size, points, spans if degree > 1 else [], meets


def _span(curve: Any, start: float, end: float, finest: float, count: int) -> np.ndarray:
    """Points (n, 2) of a spline at equal steps between two knots. Their chords, at least `count`, stay within `finest` of the spline."""
    while True:
        weighted = curve(np.linspace(start, end, 2 * count + 1))
        points = weighted[:, :2] / weighted[:, 2:]
        away = np.hypot(*(points[1::2] - (points[:-1:2] + points[2::2]) / 2.0).T).max()
        if away <= finest or count >= MOST_CHORDS:
            return np.asarray(points[::2])
        count *= 2


def _curves(curve: Any, finest: float, least: int) -> list[np.ndarray]:
    """The chords (n, 2), at least `least`, of each curve of a path; straight parts are left out."""
    from ezdxf.path import Command, Path  # noqa: PLC0415

    found, start = [], curve.start
    for command in curve.commands():
        if command.type in (Command.CURVE3_TO, Command.CURVE4_TO):
            part = Path(start)
            part.append_path_element(command)
            found.append(np.array([(point.x, point.y) for point in part.flattening(finest, least)], dtype=float))
        start = command.end
    return found


def _is_hidden(entity: Any, document: Any, layer: str) -> bool:
    """Whether an entity is invisible, or its layer is frozen or off. An insert on a layer that is off still shows other layers."""
    if entity.dxf.get("invisible", 0) or layer not in document.layers:
        return bool(entity.dxf.get("invisible", 0))
    drawn_on = document.layers.get(layer)
    return bool(drawn_on.is_frozen() or (drawn_on.is_off() and entity.dxftype() != "INSERT"))


def _colour(entity: Any, document: Any, layer: str, of_block: str) -> str:
    """Name or number of the colour of an entity, of its layer or of its block; "#rrggbb" for a true colour."""
    if entity.dxf.hasattr("true_color"):
        return f"#{int(entity.dxf.true_color) & 0xFFFFFF:06x}"
    number = int(entity.dxf.get("color", BY_LAYER))
    if number == BY_BLOCK:
        return of_block
    if number == BY_LAYER:  # a layer that the file does not describe is white
        number = abs(int(document.layers.get(layer).dxf.get("color", 7))) if layer in document.layers else 7
    return COLOURS.get(number, str(number))


def _words(error: Exception) -> str:
    return " ".join(str(error).split())[:200] or type(error).__name__
