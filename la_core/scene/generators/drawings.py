"""Blocks of a `[[drawing]]` table, and a record of the outlines and lines that are left out."""

import importlib.util
from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from fnmatch import fnmatchcase
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
import shapely

from la_core.drawing import (
    UNITS,
    Cleaned,
    Drawn,
    LayerCount,
    OpenOutline,
    Outline,
    SharedAreas,
    by_layer,
    cleaned,
    lacking_words,
    read_outlines,
    remarks,
    why_none,
)
from la_core.errors import OF_LOCALE, SceneError, extra_hint, nearest, real_path
from la_core.geometry import prism
from la_core.scene.generators.mesh import MeshFile
from la_core.scene.generators.wall import NamedShape
from la_core.scene.schema.drawing import LISTS, Drawing
from la_core.scene.schema.types import LARGEST, LARGEST_FILE, MOST_BLOCKS
from la_core.text_table import place_text

LAYER, COLOUR = "layer:", "colour:"
IN_OPENINGS = 0.8  # of the area of an outline: an outline with at least this part in openings is a pane or a frame
TOLD, REFUSED = 0.1, 0.5  # of an opening's area: a larger part under blocks brings a warning, or an error
ROLES_OF = {"ground": "fixed", "support": "support", "blocks": "free"}  # of the lists of layers


@dataclass(frozen=True)
class DrawnBlocks:
    """Record of a drawing: outlines that became blocks, were changed or were left out.

    Attributes
    ----------
    file : str
        Path of the drawing.
    unit : float
        Length in the structure of one unit of the file, m.
    blocks, compounds : int
        Number of blocks, and number of blocks that are not convex.
    openings : int
        Number of outlines in which nothing is built.
    doubles, specks, loose_lines, straightened, in_openings : int
        Numbers of outlines drawn twice, outlines without area or thinner than the tolerance, lines that enclose nothing or repeat edges,
        outlines made convex within the tolerance, and outlines in an opening. All but the straightened outlines are left out.
    open_outlines : tuple of OpenOutline
        Loose lines that were probably meant to be outlines, with their places in the scene.
    stray_lines : tuple of LayerCount
        Loose lines that lie in blocks.
    around : tuple of LayerCount
        Outlines that are left out because other outlines lie within them.
    across : tuple of LayerCount
        Lines that divide blocks of other layers.
    covered : tuple of LayerCount
        Openings that blocks cover in part; the blocks stay whole.
    ignored : dict of int
        Number of entities that are not read, such as texts, by kind.
    loose_edges : tuple of LayerCount
        Loose lines that may be edges of stones: both ends meet other lines, or nearly meet them.
    areas_without_block : tuple of LayerCount
        Areas that lines and outlines enclose together, and that are no blocks.
    shared_areas : tuple of SharedAreas
        Areas that lines of several layers or colours enclose together, and that are no blocks.
    of_two_kinds : tuple of LayerCount
        Outlines that are drawn again on a layer with another role, thickness or density, which counts instead.
    """

    file: str
    unit: float
    blocks: int
    compounds: int
    openings: int
    doubles: int
    specks: int
    loose_lines: int
    straightened: int
    in_openings: int
    open_outlines: tuple[OpenOutline, ...]
    stray_lines: tuple[LayerCount, ...]
    around: tuple[LayerCount, ...]
    across: tuple[LayerCount, ...]
    covered: tuple[LayerCount, ...]
    ignored: dict[str, int]
    loose_edges: tuple[LayerCount, ...] = ()
    areas_without_block: tuple[LayerCount, ...] = ()
    shared_areas: tuple[SharedAreas, ...] = ()
    of_two_kinds: tuple[LayerCount, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """The record as plain values."""
        return asdict(self)

    def warnings(self) -> tuple[str, ...]:
        """Warnings about outlines and lines that may be misread, see `remarks`, and about stones that are not read or are elsewhere."""
        left_out = (self.stray_lines, self.around, self.across, self.covered)
        lost = (self.loose_edges, self.areas_without_block, self.shared_areas)
        told = remarks(self.open_outlines, *left_out, *lost, self.of_two_kinds)
        return tuple(f'drawing "{self.file}": {words}.' for words in (*told, *lacking_words(self.ignored)))


def read_drawing(table: Drawing, folder: Path) -> MeshFile:
    """Read the file of a drawing in the scene's folder; raises SceneError for a file that is missing, a link out of it, or too large."""
    root = folder.resolve()
    path = root / table.file
    try:
        if not real_path(path).is_relative_to(root):
            raise SceneError(_at(table), "is a link that leads out of the scene's folder", hint="put a copy of the drawing there")
        if path.exists() and not path.is_file():
            raise SceneError(_at(table), "is not a file")
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:  # Python raises ValueError for an impossible file name
        reason = getattr(error, "strerror", None) or error
        hint = OF_LOCALE if isinstance(error, UnicodeEncodeError) else "the path is relative to the scene file"
        raise SceneError(_at(table), f"cannot be read: {reason}", hint=hint) from error
    if len(content) > LARGEST_FILE:
        raise SceneError(_at(table), f"larger than {LARGEST_FILE} bytes", hint="save only the layers of the elevation")
    return MeshFile(PurePosixPath(table.file), content, of_folder=False)


def drawing_blocks(table: Drawing, file: MeshFile, tolerance: float) -> tuple[list[NamedShape], DrawnBlocks]:
    """Blocks of a drawing from the content of its file, and the record of the drawing; raises SceneError with the file and the fault.

    tolerance: largest error of the coordinates, m; 0 for none.
    """
    drawn, clean = _read(table, file, tolerance)
    lists = [_list_of(table, outline.place) for outline in clean.outlines]
    opened = [outline for outline, place in zip(clean.outlines, lists, strict=True) if place == "openings"]
    built = [(outline, ROLES_OF[place]) for outline, place in zip(clean.outlines, lists, strict=True) if place in ROLES_OF]
    outside = _outside([outline for outline, _ in built], opened)
    built = [one for one, is_outside in zip(built, outside, strict=True) if is_outside]
    covered = _covered(table, [outline for outline, _ in built], opened)
    if not built:
        taken = _taken_words(table, drawn)
        rule = "holds no outline of a block" if clean.outlines or taken else "holds no closed outline"
        raise SceneError(_at(table), rule, hint=why_none(clean, drawn, taken))
    if len(built) > MOST_BLOCKS:
        raise SceneError(_at(table), f"holds {len(built)} outlines; at most {MOST_BLOCKS} are allowed")
    shapes = [_named(table, number, outline, role) for number, (outline, role) in enumerate(built, 1)]
    compounds = sum(len(named.shape.parts) > 1 for named in shapes)
    counts = (clean.doubles, clean.specks, clean.loose, clean.straightened, int(np.sum(~outside)))
    stray = clean.stray([outline for outline, _ in built])
    left_out = (_shifted(some, table) for some in (clean.open_outlines, stray, clean.around, clean.across, covered))
    lost = (_shifted(some, table) for some in (clean.edges, clean.areas, clean.shared, clean.of_two_kinds))
    found: tuple[Any, ...] = (table.file, drawn.unit, len(shapes), compounds, len(opened), *counts, *left_out, drawn.ignored, *lost)
    return shapes, DrawnBlocks(*found)


def _read(table: Drawing, file: MeshFile, tolerance: float) -> tuple[Drawn, Cleaned]:
    """The content of a drawing, and its cleaned outlines without those of layers in `ignore`."""
    suffix = file.path.suffix.lower()
    if suffix == ".dxf" and importlib.util.find_spec("ezdxf") is None:
        raise SceneError(_at(table), "DXF files are read by ezdxf, which is not installed", hint=extra_hint("drawing", "ezdxf"))
    try:
        drawn = read_outlines(suffix, file.content, UNITS.get(table.unit or ""), table.sagitta, table.scale)
        _refuse_unmatched(table, drawn.places)
        stones = drawn.without(lambda *place: _names(table.ignore, place))
        return drawn, cleaned(stones, tolerance, lambda *place: _list_of(table, place), lambda *place: _values_of(table, place))
    except ValueError as error:
        raise SceneError(_at(table), str(error)) from error


def why_none_is_free(table: Drawing, file: MeshFile, tolerance: float) -> str:
    """Hint with the reason why a readable drawing has no free block; parameters as of `drawing_blocks`."""
    drawn, clean = _read(table, file, tolerance)
    return f"{_at(table)}: {why_none(clean, drawn, _taken_words(table, drawn))}"


def _taken_words(table: Drawing, drawn: Drawn) -> str:
    """Words for the number of outlines and lines on layers of other lists than `blocks`, or of no list; "" without any."""
    told = []
    named = {place: _naming_list(table, place) for place in drawn.places}
    for key in ("", *(key for key in LISTS if key != "blocks")):
        outlines = sum(named[outline.place] == key for outline in drawn.outlines)
        lines = sum(len(some) for place, some in drawn.lines.items() if named[place] == key)
        counted = ((outlines, "outline"), (lines, "line"))
        if what := " and ".join(f"{count} {word}{'s' * (count > 1)}" for count, word in counted if count):
            told.append(f"`{key}` takes {what}" if key else f"`blocks` does not name the layer of {what}")
    return f"{', '.join(told)}: list layers of free blocks in `blocks` alone" if told else ""


def _shifted(left_out: tuple[Any, ...], table: Drawing) -> tuple[Any, ...]:
    """Counts of left-out outlines and lines, with their places moved by the `shift` of the table."""
    return tuple(replace(one, x=one.x + table.shift[0], z=one.z + table.shift[1]) for one in left_out)


def _at(table: Drawing) -> str:
    return f'drawing "{table.file}"'


def _names(patterns: Iterable[str], place: tuple[str, str]) -> bool:
    """Whether a pattern names a place (layer, colour) in the drawing: by its colour after the prefix COLOUR, else by its layer.

    A pattern for a layer may have the prefix LAYER.
    """
    layer, colour = place
    return any(fnmatchcase(colour, p.removeprefix(COLOUR)) if p.startswith(COLOUR) else _names_layer(p, layer) for p in patterns)


def _names_layer(pattern: str, layer: str) -> bool:
    return fnmatchcase(layer, pattern) or (pattern.startswith(LAYER) and fnmatchcase(layer, pattern.removeprefix(LAYER)))


def _refuse_unmatched(table: Drawing, places: set[tuple[str, str]]) -> None:
    valid = [*sorted({layer for layer, _ in places}), *sorted({f"{COLOUR}{colour}" for _, colour in places})]
    for key in (*LISTS, "thickness_of", "density_of"):
        for pattern in getattr(table, key):
            if not any(_names((pattern,), place) for place in places):
                rule = "no outline is on such a layer or of such a colour"
                raise SceneError(f"{_at(table)}.{key}", rule, value=pattern, hint=nearest(pattern, valid, "layers"))


def _list_of(table: Drawing, place: tuple[str, str]) -> str:
    """The list of the table to which a layer with a colour belongs; "ignore" where none names it."""
    return _naming_list(table, place) or "ignore"


def _naming_list(table: Drawing, place: tuple[str, str]) -> str:
    """The list that names a layer with a colour, "" for none; a table that lists no blocks has all other layers in "blocks"."""
    every = {key: getattr(table, key) for key in LISTS} | {"blocks": table.blocks or ("*",)}
    return next((key for key, patterns in every.items() if _names(patterns, place)), "")


def _outside(outlines: list[Outline], openings: list[Outline]) -> np.ndarray:
    """Mask of the outlines that do not lie in openings."""
    if not openings or not outlines:
        return np.ones(len(outlines), dtype=bool)
    polygons = _polygons(outlines)
    inside = shapely.area(shapely.intersection(polygons, shapely.union_all(_polygons(openings))))
    return np.asarray(inside < IN_OPENINGS * shapely.area(polygons))


def _covered(table: Drawing, blocks: list[Outline], openings: list[Outline]) -> tuple[LayerCount, ...]:
    """Openings that blocks cover in part, by layer; raises SceneError for an opening mostly in blocks, which would be built solid."""
    if not openings or not blocks:
        return ()
    stones, holes = _polygons(blocks), _polygons(openings)
    hole, stone = shapely.STRtree(stones).query(holes)
    shared = shapely.area(shapely.intersection(holes[hole], stones[stone])) / shapely.area(holes)[hole]
    share = np.bincount(hole, weights=shared, minlength=len(holes))
    worst = int(np.argmax(share))
    if share[worst] > REFUSED:
        where = place_text((openings[worst].points.mean(axis=0) + np.array(table.shift)).tolist())
        layers = ", ".join(dict.fromkeys(f'"{blocks[k].layer}"' for k in stone[(hole == worst) & (shared > 0.0)].tolist()))
        raise SceneError(
            f'{_at(table)}: the opening on layer "{openings[worst].layer}" near {where}',
            f"lies in blocks on layer {layers}, and an opening cuts nothing out of a block",
            hint="draw the block around the opening, with a slit of 1 mm from the hole to an edge; list a layer of frames in `ignore`, and "
            "also the opening's own layer where the block may stay solid",
        )
    return by_layer((openings[k].layer, openings[k].points) for k in np.flatnonzero(share > TOLD))


def _polygons(outlines: list[Outline]) -> np.ndarray:
    return np.array([shapely.Polygon(outline.points) for outline in outlines])


def _named(table: Drawing, number: int, outline: Outline, role: str) -> NamedShape:
    place = outline.place
    thickness, density = _values_of(table, place)
    profile = outline.points + np.array(table.shift)
    name = f"{table.name} {number}"
    x, z = profile.mean(axis=0)
    if not np.abs(profile).max() <= LARGEST:
        raise SceneError(
            _at(table), f'the outline on layer "{outline.layer}" lies beyond {LARGEST:g} m', hint="state the unit of the drawing"
        )
    try:
        shape = prism(profile.tolist(), (0.0, thickness))
    except ValueError as error:
        where = f'{_at(table)}: block "{name}" on layer "{outline.layer}", near {place_text((x, z))}'
        raise SceneError(where, str(error)) from error
    groups = (f"{LAYER}{outline.layer}", f"{COLOUR}{outline.colour}")
    return NamedShape(name, role, density, shape, joint=table.joints, groups=groups)


def _values_of(table: Drawing, place: tuple[str, str]) -> tuple[float, float | None]:
    """Thickness (m) and density (kg/m3, None for the scene's) of the blocks of a place in the drawing."""
    return _own(table.thickness_of, place, table.thickness), _own(table.density_of, place, table.density)


def _own(values: dict[str, float], place: tuple[str, str], common: float | None) -> Any:
    """The value of the first pattern that names a place in the drawing; `common` where none does."""
    return next((value for pattern, value in values.items() if _names((pattern,), place)), common)
