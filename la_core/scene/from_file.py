"""Writes a commented scene for a drawing or a file of bodies. Values that the file does not give are guessed and marked."""

import importlib.util
import json
import math
import re
from collections.abc import Sequence
from fnmatch import fnmatchcase
from pathlib import Path, PurePosixPath

import numpy as np
import shapely

from la_core.drawing import ADVICE, DRAWING_FORMATS, UNITS, Cleaned, Drawn, Outline, cleaned, read_outlines, remarks, unseen_words, why_none
from la_core.errors import SceneError, extra_hint, printable_name, real_path
from la_core.scene.generators.mesh import MOST_DENT, extent, mesh_blocks, read_files
from la_core.scene.plausibility import SIZE
from la_core.scene.schema.mesh import FORMATS, Mesh
from la_core.scene.schema.types import LARGEST_FILE
from la_core.text_table import number_text

SOURCE_FORMATS = (*DRAWING_FORMATS, *FORMATS)  # of files for which a scene can be written
WORDS = {  # patterns for a word in the name of a layer or a body, by list; the first list with a match counts
    "ignore": (
        *("dim", "dims", "dimension*", "text", "texts", "texte*", "testo", "testi", "bema*", "hatch*", "schraff*", "hachur*", "trattegg*"),
        *("axis", "axes", "achs*", "axe", "assi", "eje", "ejes", "frame", "rahmen", "cadre", "cartiglio", "defpoints", "note", "notes"),
        *("quote*", "cotes", "cotation*", "cotas"),
    ),
    "openings": (
        *("opening*", "window*", "door*", "void*", "*fenster*", "*öffnung*", "*oeffnung*", "*tür", "*türen", "*tuer", "*tueren"),
        *("aperture*", "finestr*", "porta", "porte", "vano", "vani", "hueco*", "puerta*", "ventana*"),
        *("ouverture*", "fenêtre*", "fenetre*", "portes", "baie", "baies"),
    ),
    "support": (
        *("support", "supports", "settl*", "sink*", "setz*", "senk*", "*senkung", "*setzung"),
        *("cediment*", "asient*", "tassement*", "affaiss*"),
    ),
    "ground": (
        *("ground*", "fix", "fixed", "earth", "foundation*", "footing*", "boden*", "*fundament*", "*gründung*"),
        *("abutment*", "*widerlager*", "*auflager*", "fest", "feste", "spalla", "spalle", "culée*", "culee*", "estribo*"),
        *("fisso", "fissi", "fixe", "fixes", "fijo", "fijos"),
        *("terren*", "terrain*", "suelo*", "fondazion*", "fondation*", "semelle*", "cimient*"),
    ),
}
OF_STONE = (  # patterns for words that name stones: the jambs of a window are no opening
    *("jamb*", "surround*", "voussoir*", "lintel*", "sill*", "arch", "arches", "quoin*", "reveal*"),
    *("stone*", "block*", "brick*", "masonry"),
    *("*stein*", "*ziegel*", "*gewände*", "*sturz*", "architrav*", "stipit*", "dintel*", "jamba*", "linteau*", "pierre*", "piédroit*"),
    *("jambage*", "claveau*"),
)
MEANING = {"ignore": "not read", "openings": "nothing is built there", "support": "moves", "ground": "stays"}  # of each list
THICKNESS = 0.4  # m, a guess, because a drawing gives no thickness
TOLERANCE = 0.003  # m
SHORTEST, LONGEST = 0.05, 2.0  # m: the lengths of most blocks lie between
LARGEST_SIZE = 500.0  # m: a structure with a larger size is probably drawn in mm
WIDEST_JOINT, LEAST_JOINT = 0.03, 0.001  # m: blocks farther apart have no joint; blocks closer than the second value touch
WEDGE = 1.3  # greatest width of a wedge-shaped joint over its width at the narrow end
SHARE_OF_JOINTS = 0.3  # least share of neighbours with open joints in a drawing with open joints
FARTHEST = 1000.0  # m: coordinates beyond this are shifted to the origin, because round-off grows with the distance
TURNED = 1.0  # degrees: least slope of the edges of a turned drawing, and greatest deviation of an edge from their common direction
ALIKE = 0.5  # of the length of all edges: least part in the common direction of a turned drawing
SETTLING = 1.0 / 3.0  # of the length of a base that is added under a structure without ground: this part settles
CURVE = 0.005  # m: greatest distance between a curve and its chords


def scene_from_file(source: Path, folder: Path) -> str:
    """Text of a scene in `folder` for a drawing (DXF, SVG) or for bodies (OBJ, PLY, STL, COMPAS); raises SceneError."""
    try:
        relative = real_path(source).relative_to(folder.resolve())
    except ValueError as error:
        raise SceneError(
            str(source), f"does not lie in {folder} or below it", hint="a scene stands beside its files or above them"
        ) from error
    place = PurePosixPath(printable_name(relative.as_posix()))
    suffix = source.suffix.lower()
    if suffix in (*SOURCE_FORMATS, "") and not source.exists():
        raise SceneError(str(source), "cannot be read: there is no such file or folder")
    if source.is_dir() and suffix not in (*FORMATS, ""):
        raise SceneError(str(source), f'a folder whose name ends in "{source.suffix}" is taken for a file in a scene', hint="rename it")
    if suffix in DRAWING_FORMATS:
        return _drawing_text(source, place)
    if suffix in FORMATS or source.is_dir():
        return _mesh_text(place, folder)
    known = ", ".join(SOURCE_FORMATS)
    hint = ADVICE.get(suffix, f"files end in {known}")
    raise SceneError(str(source), "is neither a drawing nor a file of bodies", hint=hint)


def _drawing_text(source: Path, place: PurePosixPath) -> str:
    unit, doubt, drawn, clean, lists = _in_a_likely_unit(source)
    if not clean.outlines:
        words = f"layers that are left out because of their names: {', '.join(lists['ignore'])}; rename those of blocks"
        raise SceneError(str(source), "holds no closed outline", hint=why_none(clean, drawn, words if lists["ignore"] else ""))
    joints, held = _joint_width(clean), lists["ground"] + lists["support"]
    blocks = [outline for outline in clean.outlines if outline.layer not in lists["openings"]]
    rows = ["[[drawing]]", f"file      = {_quoted(str(place))}"]
    rows.append(f'unit      = "{unit}"{doubt}' if unit else f"# one unit of the file is {drawn.unit:g} m{doubt}")
    rows.append(f"thickness = {THICKNESS}   # m, CHECK: a drawing does not say it; thickness_of = {{ LAYER = 0.6 }} for others")
    rows.append(f"joints    = {joints:g}   # m, greatest width of open joints, which are closed; 0 where blocks are drawn touching")
    rows += _of_layers(drawn, clean, lists, [*_left_out(drawn, clean, blocks), *_turned(blocks)])
    low, high, shifted = _near_the_origin(np.concatenate([outline.points for outline in blocks] or [np.zeros((1, 2))]), "shift    ")
    rows += shifted
    base = [] if held else _base((low[0], 0.0), (high[0], THICKNESS), float(low[1]) - joints / 2.0)
    return _text(source.name, rows, base, has_support=bool(lists["support"]) or not held)


def _in_a_likely_unit(source: Path) -> tuple[str, str, Drawn, Cleaned, dict[str, list[str]]]:
    """Unit of a drawing ("" for a unit without a name), a comment on the unit, and the results of `_read`; raises SceneError."""
    content = _content(source)
    if source.suffix.lower() == ".dxf" and importlib.util.find_spec("ezdxf") is None:
        raise SceneError(str(source), "DXF files are read by ezdxf, which is not installed", hint=extra_hint("drawing", "ezdxf"))
    try:
        unit, unsaid = _unit(source.suffix, content)
        drawn, clean, lists = _read(source.suffix, content, unit)
        doubt = unsaid and f"  # CHECK: the file {unsaid}"
        if not unsaid and clean.specks and not clean.outlines and SHORTEST <= _length(drawn.outlines) / drawn.unit <= LONGEST:
            doubt = f"  # CHECK: a unit of {drawn.unit:g} m, which the file says, makes every outline thinner than {TOLERANCE:g} m"
            unit = "m"  # a header often has the default unit of the program that wrote it
            drawn, clean, lists = _read(source.suffix, content, unit)
    except ValueError as error:
        raise SceneError(str(source), str(error)) from error
    return unit, doubt or _doubt(clean), drawn, clean, lists


def _of_layers(drawn: Drawn, clean: Cleaned, lists: dict[str, list[str]], remarked: list[str]) -> list[str]:
    """Rows with the lists of layers and comments on them. remarked: comments on the outlines, which follow the lists."""
    layers = sorted({layer for layer, _ in drawn.places} - set(lists["ignore"]))
    counts = {layer: sum(outline.layer == layer for outline in clean.outlines) for layer in layers}
    counted = ", ".join(f"{json.dumps(layer, ensure_ascii=False)} {count}" for layer, count in counts.items())
    rows = [f"# closed outlines on each layer: {counted}"]
    rows += [f"{key:9} = {_array(names)}   # CHECK: {MEANING[key]}; guessed from the name" for key, names in lists.items() if names]
    rows += remarked
    if lists["support"] and not lists["ground"]:
        rows.append("# CHECK: no layer was taken for ground; name those of the blocks that stay in `ground`")
    held = lists["ground"] + lists["support"]
    built = sorted((layer for layer in counts if layer not in lists["openings"]), key=lambda layer: (layer in held, -counts[layer]))
    if len(built := [layer for layer in built if counts[layer]]) > 1 and built[0] not in held:
        rows.append(f"# joints of another friction: a [[friction]] table with between = {_array([f'layer:{name}' for name in built[:2]])}")
    return rows


def _read(suffix: str, content: bytes, unit: str) -> tuple[Drawn, Cleaned, dict[str, list[str]]]:
    """A drawing in a unit ("" for the file's), its cleaned outlines, and the layers of each list."""
    drawn = read_outlines(suffix, content, UNITS.get(unit), CURVE)
    layers = sorted({layer for layer, _ in drawn.places})
    lists = {key: [layer for layer in layers if _list_of(layer) == key] for key in WORDS}
    stones = drawn.without(lambda layer, _: layer in lists["ignore"])
    return drawn, cleaned(stones, TOLERANCE, lambda layer, _: _list_of(layer) or "blocks"), lists


def _length(outlines: Sequence[Outline]) -> float:
    """Median length of outlines, m; 0 for none."""
    return float(np.median([np.ptp(outline.points, axis=0).max() for outline in outlines])) if outlines else 0.0


def _doubt(clean: Cleaned) -> str:
    """Comment on the file's unit where the median length of the blocks is unusual; "" elsewhere."""
    size = _length(clean.outlines)
    if SHORTEST <= size <= SIZE[1]:
        return ""
    more = "long or more" if size > SIZE[1] else "long or less; a drawing to scale 1 : 50 needs scale = 50"
    return f"  # CHECK: the file says it, and most blocks are then {number_text(size, 3)} m {more}"


def _left_out(drawn: Drawn, clean: Cleaned, blocks: list[Outline]) -> list[str]:
    """Comments on open outlines, on lines and outlines that are left out, and on entities that the drawing hides or does not hold."""
    left_out = clean.stray(blocks), clean.around, clean.across
    told = remarks(clean.open_outlines, *left_out, (), clean.edges, clean.areas, clean.shared, clean.of_two_kinds)
    return [f"# CHECK: {words}" for words in (*told, *unseen_words(drawn.ignored))]


def _turned(blocks: list[Outline]) -> list[str]:
    """Comment on a turned drawing, where most edges are at right angles to each other, but neither level nor upright."""
    edges = np.concatenate([np.roll(block.points, -1, axis=0) - block.points for block in blocks] or [np.zeros((0, 2))])
    length, angle = np.hypot(*edges.T), np.arctan2(*edges.T[::-1])
    mean = np.sum(length * np.exp(4j * angle))  # edges at right angles count as parallel
    degrees = float(np.degrees(np.angle(mean)) / 4.0)
    aside = (np.degrees(angle) - degrees + 45.0) % 90.0 - 45.0  # a leaning wall with level beds has no edge in the mean direction
    if abs(degrees) < TURNED or length[np.abs(aside) < TURNED].sum() <= ALIKE * length.sum():
        return []
    slope = f"most edges slope by {abs(degrees):.2g} degrees"
    return [f"# CHECK: {slope}; gravity acts down the drawing's y, so turn the drawing if it is not upright"]


def _content(source: Path) -> bytes:
    try:
        with source.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except OSError as error:
        raise SceneError(str(source), f"cannot be read: {error.strerror}") from error
    if len(content) > LARGEST_FILE:
        raise SceneError(str(source), f"larger than {LARGEST_FILE} bytes", hint="save only the layers of the elevation")
    return content


def _unit(suffix: str, content: bytes) -> tuple[str, str]:
    """Unit of a drawing ("" for a unit without a name), and the reason for a guess ("" for a known unit): mm above 500 units, else m."""
    try:
        metres = read_outlines(suffix, content, None, CURVE).unit
        return next((name for name, size in UNITS.items() if math.isclose(size, metres, rel_tol=1e-6)), ""), ""
    except ValueError as error:
        drawn = read_outlines(suffix, content, 1.0, CURVE)
        points = [outline.points for outline in drawn.outlines] + [line for lines in drawn.lines.values() for line in lines]
        size = float(np.ptp(np.concatenate(points), axis=0).max()) if points else 0.0
        return "mm" if size > LARGEST_SIZE else "m", re.split("[,;]", str(error))[0]


def _list_of(name: str) -> str:
    """The list of a `[[drawing]]` that the words of a layer's name suggest; "" for none."""
    words = re.findall(r"[^\W\d_]+", re.sub(r"(?<=[a-zäöü])(?=[A-ZÄÖÜ])", " ", name))

    def has(patterns: tuple[str, ...]) -> bool:
        return any(fnmatchcase(word.lower(), pattern) for word in words for pattern in patterns)

    key = next((key for key, patterns in WORDS.items() if has(patterns)), "")
    return "" if key == "openings" and has(OF_STONE) else key


def _joint_width(clean: Cleaned) -> float:
    """Greatest width of the open joints between outlines, m, with a margin; 0 where most neighbours touch."""
    polygons = np.array([shapely.Polygon(outline.points) for outline in clean.outlines])
    first, second = shapely.STRtree(polygons).query(polygons, predicate="dwithin", distance=WIDEST_JOINT)
    low, high = np.split(shapely.bounds(polygons), 2, axis=1)
    thin = (high - low).min(axis=1)
    pairs = first < second
    width = shapely.distance(polygons[first[pairs]], polygons[second[pairs]])
    width = width[width < 0.5 * np.minimum(thin[first[pairs]], thin[second[pairs]])]  # farther apart, a block may be missing between them
    is_open = width > LEAST_JOINT
    if not len(width) or is_open.mean() < SHARE_OF_JOINTS:
        return 0.0
    return math.ceil(1e3 * (WEDGE * float(np.median(width[is_open])) + TOLERANCE)) / 1e3


def _mesh_text(place: PurePosixPath, folder: Path) -> str:
    table = Mesh(file=str(place))
    files = read_files(table, folder)
    scale = 1e-3 if extent(table, files) > LARGEST_SIZE else 1.0
    bodies = mesh_blocks(Mesh(file=str(place), scale=scale), files, MOST_DENT)  # fills more dents, as a larger tolerance would
    vertices = np.concatenate([body.shape.vertices for body in bodies])
    lists = {key: [body.name for body in bodies if _list_of(body.name) == key] for key in ("ground", "support")}
    rows = ["[[mesh]]", f"file  = {_quoted(str(place))}", f"scale = {scale:g}   # metres per unit, CHECK: 0.001 for mm"]
    rows.append("# turn = { axis = [1, 0, 0], degrees = 90 }   # where y is up in the file")
    rows += [f"{key} = {_array(lists[name])}" for key, name in (("fixed", "ground"), ("support", "support")) if lists[name]]
    held = lists["ground"] or lists["support"] or any(body.role != "free" for body in bodies)
    low, high, shifted = _near_the_origin(vertices, "shift")
    rows += shifted
    base = [] if held else _base((low[0], low[1]), (high[0], high[1]), float(low[2]))
    return _text(place.name, rows, base, has_support=bool(lists["support"]) or not held)


def _near_the_origin(points: np.ndarray, key: str) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Least and greatest coordinates of points, m; points in the grid of a survey are shifted to the origin by a row with this key."""
    low, high = points.min(axis=0), points.max(axis=0)
    if np.abs(points).max() <= FARTHEST:
        return low, high, []
    shift = -np.round(low)
    row = f"{key} = [{', '.join(f'{part + 0.0:.0f}' for part in shift)}]   # m, from the grid of the survey to the origin"
    return low + shift, high + shift, [row]


def _base(low: tuple[float, float], high: tuple[float, float], top: float) -> list[str]:
    """Two blocks under a structure that has no ground: the right one settles."""
    split = high[0] - SETTLING * (high[0] - low[0])
    depth = 0.1 * (high[0] - low[0])
    rows = ["# CHECK: no ground was found, so this base was added; its right third settles"]
    for name, role, left, right in (("base", "fixed", low[0], split), ("settling base", "support", split, high[0])):
        corners = f"from = [{left:.6g}, {low[1]:.6g}, {top - depth:.6g}], to = [{right:.6g}, {high[1]:.6g}, {top:.6g}]"
        rows += ["[[block]]", f'name = "{name}"', f'role = "{role}"', f"box  = {{ {corners} }}", ""]
    return rows


def _text(name: str, table: list[str], base: list[str], has_support: bool) -> str:
    motion = ["[settlement]", "direction = [0.0, 0.0, -1.0]   # the support moves down"]
    push = [
        "# No support was found, so the structure is pushed sideways. For a settlement name the part that moves",
        "# in `support`, and write [settlement] direction = [0.0, 0.0, -1.0] in place of [live].",
        "[live]",
        "direction = [1.0, 0.0, 0.0]",
    ]
    rows = [f"title = {_quoted(name)}", "# Written by `crosscheck new --from`. Check every line marked CHECK.", ""]
    rows += ["[stone]", "density = 2000.0   # kg/m3, CHECK", "", "[joint]", "friction = 0.6   # tan(phi), CHECK", ""]
    rows += ["[geometry]", f"tolerance = {TOLERANCE}   # m, error of the coordinates; `crosscheck show` lists what it changes", ""]
    return "\n".join([*rows, *table, "", *base, *(motion if has_support else push)]) + "\n"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _array(names: list[str]) -> str:
    return "[" + ", ".join(_quoted(_literal(name)) for name in names) + "]"


def _literal(name: str) -> str:
    """A pattern that only this name matches."""
    return "".join(f"[{letter}]" if letter in "*?[" else letter for letter in name)
