"""Blocks of all tables of a scene file: checks across the tables, and repair of the geometry within its tolerance."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from la_core.drawing import straightened
from la_core.errors import SceneError, nearest
from la_core.exchange import FREE, SETTINGS, broken_rule
from la_core.geometry import ROLES, Blocks, shapes
from la_core.repair import Repairs, close_joints, without_bent_faces
from la_core.scene.generators import arches, building, dome, rubble, wall
from la_core.scene.generators.drawings import LAYER, DrawnBlocks, drawing_blocks, read_drawing, why_none_is_free
from la_core.scene.generators.mesh import MeshFile, mesh_blocks, read_files
from la_core.scene.generators.wall import NamedShape
from la_core.scene.line_numbers import KeyPath, with_lines
from la_core.scene.loads.tilt import faults_of_tilt
from la_core.scene.schema import scene_file
from la_core.scene.schema.types import MOST_BLOCKS
from la_core.scene.validation import Fault, joined
from la_core.text_table import place_text

LEAST_TOLERANCE = 1e-4  # m: greatest tolerance where open joints are closed and the scene states none
WHERE_A_SUPPORT_IS = (
    'give a [[block]] role = "support", a wall a `footing` or a building a `foundation` with a `settling` part, an arch '
    "`springers`, or a [[drawing]] or [[mesh]] a `support` list that names its settling blocks"
)
Placed = tuple[KeyPath, NamedShape]  # place of a table in the file, and one of its blocks


class Tables:
    """Blocks that the tables of a file build, and the faults of the tables.

    Attributes
    ----------
    named : list of NamedShape
        Blocks of all tables.
    places : list of tuples
        Table of each block, such as ("wall", 0).
    faults : list of Fault
        Error of each table that could not be built, with the place of the table.
    files : list of MeshFile
        Files of meshes and drawings as read.
    drawn : list of DrawnBlocks
        Record of each drawing: outlines that became blocks, were changed or were left out.
    """

    def __init__(self, file: scene_file.SceneFile, folder: Path) -> None:
        self.faults: list[Fault] = []
        self.files: list[MeshFile] = []
        self.drawn: list[DrawnBlocks] = []
        placed = list(islice(self._placed(file, folder), MOST_BLOCKS + 1))
        self.places, self.named = [place for place, _ in placed], [named for _, named in placed]

    def _placed(self, file: scene_file.SceneFile, folder: Path) -> Iterator[Placed]:
        """Blocks of every table. An error of a table becomes a fault, and the next table follows."""
        for kind in ("block", *_GENERATORS, "mesh", "drawing"):
            for number, table in enumerate(getattr(file, kind)):
                place = (kind, number)
                try:
                    for named in self._blocks_of(kind, table, file.geometry.tolerance or 0.0, folder):
                        yield place, named
                except ValueError as error:
                    self.faults.append((place, f'{kind} "{table.name}": {error}'))
                except SceneError as error:  # its message names the table already
                    self.faults.append((place, str(error)))

    def _blocks_of(self, kind: str, table: Any, tolerance: float, folder: Path) -> Iterator[NamedShape]:
        if kind == "block":
            yield NamedShape(table.name, table.role, table.density, _shape(table, tolerance))
        elif kind == "mesh":
            content = read_files(table, folder)
            self.files += content
            yield from mesh_blocks(table, content, tolerance)
        elif kind == "drawing":
            self.files.append(read_drawing(table, folder))
            blocks, became = drawing_blocks(table, self.files[-1], tolerance)
            self.drawn.append(became)
            yield from blocks
        else:
            yield from _GENERATORS[kind](table)


_GENERATORS: dict[str, Callable[[Any], Iterator[NamedShape]]] = {
    "wall": wall.wall_blocks,
    "building": building.building_blocks,
    "arch": arches.arch_blocks,
    "vault": arches.vault_blocks,
    "dome": dome.dome_blocks,
    "rubble": rubble.rubble_blocks,
}


def _shape(block: scene_file.Block, tolerance: float) -> shapes.Shape:
    if block.box:
        return shapes.box(block.box.from_, block.box.to)
    if block.prism:
        return shapes.prism(straightened(block.prism.profile, tolerance), block.prism.y)
    assert block.polyhedron is not None  # the schema demands exactly one shape
    return without_bent_faces(shapes.polyhedron(block.polyhedron.vertices), tolerance)


def _faults_of_names(tables: Tables) -> Iterator[Fault]:
    """Yield one fault for each table of the file that repeats names of blocks."""
    seen: set[str] = set()
    taken: dict[KeyPath, list[str]] = {}
    for place, one in zip(tables.places, tables.named, strict=True):
        if one.name in seen:
            taken.setdefault(place, []).append(one.name)
        seen.add(one.name)
    for place, names in taken.items():
        more = len(names) - 1
        others = f", like that of {more} other block{'s' * (more > 1)} of this table" if more else ""
        rule = f"the name is used twice{others}"
        hint = "every block needs its own"
        if place[0] in _GENERATORS:
            hint = f"give each [[{place[0]}]] a `name` of its own, with which the names of its blocks begin"
        yield place, str(SceneError(f'block "{names[0]}"', rule, hint=hint))


def faults_of_sense(tables: Tables, file: scene_file.SceneFile) -> Iterator[Fault]:
    """Yield the faults across tables: repeated names, missing densities, wrong settings, and roles or expected values that do not fit."""
    yield from _faults_of_names(tables)
    roles = {one.role for one in tables.named}
    if "free" not in roles:
        yield ("block",), str(SceneError("block", "no block is free, so there is no structure", hint=_why_none_is_free(tables, file)))
    if file.settlement and "support" not in roles:
        yield ("settlement",), str(SceneError("settlement", "no block has the role of support", hint=WHERE_A_SUPPORT_IS))
    driven = next(name for name in ("settlement", "live", "tilt") if getattr(file, name) is not None)
    if driven != "settlement" and "support" in roles:
        yield (driven,), str(SceneError(driven, f"a [{driven}] scene has no support", hint='give its held blocks role = "fixed"'))
    if file.expected and (file.expected.multiplier is None) != (driven == "settlement"):
        wanted = "multiplier" if driven != "settlement" else "reaction_over_weight"
        rule = f"a [{driven}] scene expects a `{wanted}`"
        yield ("expected",), str(SceneError("expected", rule))
    for name, value in file.yade.items():
        if name not in SETTINGS:
            yield ("yade", name), str(SceneError(f"yade.{name}", "unknown key", hint=nearest(name, SETTINGS)))
        elif rule := broken_rule(name, value):
            yield ("yade", name), str(SceneError(f"yade.{name}", f"must be {rule}", value=value))
    if driven != "settlement" and file.yade.get("wedging"):
        lifts = SceneError("yade.wedging", f"lifts the support, and a [{driven}] scene has none", hint="leave it out")
        yield ("yade", "wedging"), str(lifts)
    share = file.yade.get("time_step_share", 0.0)
    if share > 1.0 and "time_step" not in file.yade:  # a given time step replaces the share
        rule = "must be at most 1: beyond that the integration is unstable"
        yield ("yade", "time_step_share"), str(SceneError("yade.time_step_share", rule, value=share))
    yield from faults_of_tilt(file)
    yield from _faults_of_density(tables, file)


def _why_none_is_free(tables: Tables, file: scene_file.SceneFile) -> str:
    """Hint for a scene without free blocks: the reason in each drawing, or else the advice to give a block the role "free"."""
    drawings = zip(file.drawing, tables.files[len(tables.files) - len(file.drawing) :], strict=True)
    return "; ".join(why_none_is_free(*one, file.geometry.tolerance or 0.0) for one in drawings) or 'give a [[block]] the role "free"'


def _faults_of_density(tables: Tables, file: scene_file.SceneFile) -> Iterator[Fault]:
    """Yield one fault for each table with a free block that has no density."""
    told: set[KeyPath] = set()
    for place, one, density in zip(tables.places, tables.named, densities(tables.named, file), strict=True):
        if density is None and ROLES[one.role] == FREE and place not in told:
            told.add(place)
            hint = "give it one, or give all blocks one by [stone] density"
            yield place, str(SceneError(f'block "{one.name}": density', "missing", hint=hint))


def checked_blocks(
    tables: Tables, file: scene_file.SceneFile, counted: str
) -> tuple[Blocks, list[float | None], np.ndarray | None, Repairs | None]:
    """Blocks of all tables, their densities without floors (kg/m3), the mass of floors on each (kg), and the repairs of the geometry.

    Raises SceneError with every fault. counted: text of the file, for line numbers in messages; "" gives none.
    """
    if faults := tables.faults or list(faults_of_sense(tables, file)):
        raise joined(faults, counted)
    names = [one.name for one in tables.named]
    try:
        named, repairs = repaired(tables.named, file)
        shapes.refuse_slivers(names, [one.shape for one in named])
    except SceneError as error:
        raise with_lines(error, counted, names, tables.places) from error
    stones = densities(named, file)
    blocks, floor_mass = gathered(named, stones)
    return blocks, stones, floor_mass, repairs


def where_drawn(error: SceneError, blocks: Blocks, places: Sequence[KeyPath]) -> SceneError:
    """Add to an error of blocks its first spot and the layers of the blocks, if it has a spot and all of its blocks come from drawings.

    places: table of each block.
    """
    at_fault = [k for k, name in enumerate(blocks.names) if name in error.blocks]
    if not (error.spots and error.where.startswith("block") and all(places[k][0] == "drawing" for k in at_fault)):
        return error
    layers = dict.fromkeys(f'"{group.removeprefix(LAYER)}"' for k in at_fault for group in blocks.groups[k] if group.startswith(LAYER))
    x, _, z = error.spots[0]
    where = f"near {place_text((x, z))}, on layer {' and '.join(layers)} of the drawing"
    return SceneError.told(f"{error}; {where}: correct the outlines there, or list a layer without blocks in `ignore`", error)


def densities(named: list[NamedShape], file: scene_file.SceneFile) -> list[float | None]:
    """Density of every block without floors, kg/m3; None where neither the block nor [stone] gives one."""
    stone = file.stone.density if file.stone else None
    return [one.density if one.density is not None else stone for one in named]


def gathered(named: list[NamedShape], stones: list[float | None]) -> tuple[Blocks, np.ndarray | None]:
    """The blocks, whose masses include floors, and the mass of a building's floors on each (B,), kg; None without floors.

    stones: density of every block without floors, kg/m3.
    """
    added = np.array([one.added_density for one in named])
    loaded = np.array([np.nan if stone is None else stone for stone in stones]) + added
    shapes_of, groups = [one.shape for one in named], [one.groups for one in named]
    blocks = Blocks.gather([one.name for one in named], [one.role for one in named], loaded, shapes_of, groups)
    return blocks, added * blocks.volume if added.any() else None


def repaired(named: list[NamedShape], file: scene_file.SceneFile) -> tuple[list[NamedShape], Repairs | None]:
    """The blocks with closed joints, and the repairs; None in place of the repairs where the scene requests none."""
    joints = np.array([one.joint for one in named])
    if file.geometry.tolerance is None and not joints.any():
        return named, None
    tolerance = file.geometry.tolerance or min(LEAST_TOLERANCE, float(joints.max()) / 10.0)
    closed, repairs = close_joints([one.name for one in named], [one.shape for one in named], tolerance, joints)
    repairs = replace(repairs, made_convex=sum(one.made_convex for one in named))
    return [replace(one, shape=shape) for one, shape in zip(named, closed, strict=True)], repairs
