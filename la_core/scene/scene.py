"""From a TOML file to a `Scene`, with every check that needs no solver."""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, islice
from pathlib import Path
from typing import Any

import numpy as np
import pydantic

from la_core.errors import SceneError, nearest, visible
from la_core.exchange import FREE, SETTINGS
from la_core.geometry import ROLES, Blocks, shapes
from la_core.pictures import picture
from la_core.repair import Repairs
from la_core.scene import reading
from la_core.scene.generators import arches, building, dome, rubble, wall
from la_core.scene.generators.drawings import DrawnBlocks
from la_core.scene.generators.mesh import MeshFile
from la_core.scene.generators.placing import shape_of
from la_core.scene.generators.wall import NamedShape
from la_core.scene.imported import imported_blocks, repaired
from la_core.scene.plausibility import implausible
from la_core.scene.schema import scene_file
from la_core.scene.schema.motion import support_twist, unit_vector
from la_core.scene.schema.types import MOST_BLOCKS
from la_core.scene.validation import Fault, as_scene_error, joined
from la_core.text_table import Tabled, number_text


@dataclass(frozen=True, repr=False)
class Scene(Tabled):
    """Validated scene: blocks, joint law, support motion or live load, requested effects and expected values.

    Units are SI; the axis z points up. `load`, `build` and `variant` make scenes. `print(scene)` shows a summary as a
    table, and so does a notebook.

    Attributes
    ----------
    name : str
        Name of the scene and of its folder of results.
    path : Path
        File of the scene, which messages name; a scene from `build` has no file there.
    text : str
        Scene as TOML.
    title : str
        Title; the name where the file has none.
    source : str
        Source of the geometry or of the expected value, "" where the file names none.
    gravity : ndarray, shape (3,)
        Acceleration of gravity, m/s2.
    friction : float
        Friction coefficient of every joint, tan(phi).
    inset : float
        Distance by which contact points lie inside the edges of an interface, m.
    blocks : Blocks
        Geometry, mass and role of every block.
    support_twist : ndarray, shape (6,), or None
        Unit motion of the supports: velocity of the origin, then angular velocity. None for a live load.
    live : ndarray, shape (3,), or None
        Unit direction of a load proportional to weight. None for a settlement.
    effects : RequestedEffects
        Choice for every effect, "auto" where the program decides.
    path_asked : RequestedPath or None
        Settlement and increments of the requested equilibrium path. None without a [path] table.
    expected : Expected or None
        Expected values for sharp arrises. None without an [expected] table.
    yade : dict of str to float
        YADE settings that replace the derived ones, by name.
    meshes : tuple of MeshFile
        Files of the [[mesh]] and [[drawing]] tables with their contents.
    accuracy : float or None
        Requested relative accuracy of the answer. None without a request.
    effort : str
        "normal", or "high" for finer and longer paths of the prediction.
    project : str
        Project that the report belongs to, "" where the file names none.
    author : str
        Who answers for the report, "" where the file names nobody.
    date : str
        Date in the head of the report, "" where the file has none.
    drawn : tuple of DrawnBlocks
        What became of the outlines of each [[drawing]].
    repairs : Repairs or None
        Changes of the geometry within its tolerance. None where none was asked for.
    warnings : tuple of str
        Sentences about values that are allowed but seldom meant, such as an angle for friction.
    """

    name: str
    path: Path
    text: str
    title: str
    source: str
    gravity: np.ndarray
    friction: float
    inset: float
    blocks: Blocks
    support_twist: np.ndarray | None
    live: np.ndarray | None
    effects: scene_file.RequestedEffects
    path_asked: scene_file.RequestedPath | None
    expected: scene_file.Expected | None
    yade: dict[str, Any]
    meshes: tuple[MeshFile, ...] = ()
    accuracy: float | None = None
    effort: str = "normal"
    project: str = ""
    author: str = ""
    date: str = ""
    drawn: tuple[DrawnBlocks, ...] = ()
    repairs: Repairs | None = None
    warnings: tuple[str, ...] = ()

    @property
    def weight(self) -> float:
        """Weight of all free blocks, N."""
        return float(self.blocks.mass[self.blocks.free].sum() * np.linalg.norm(self.gravity))

    @property
    def shortest_joint(self) -> float:
        """Length of the shortest joint that counts, m; 0 without a tolerance of the geometry."""
        return 0.0 if self.repairs is None else self.repairs.shortest_joint

    @property
    def is_rotation(self) -> bool:
        """Whether the support rotates; the reaction is then a moment in N m."""
        return self.support_twist is not None and bool(np.any(self.support_twist[3:]))

    @property
    def settlement_unit(self) -> str:
        """Unit for the support's motion in figures and tables: "mm", or "mrad" for a rotation."""
        return "mrad" if self.is_rotation else "mm"

    @property
    def quantity(self) -> str:
        """Name of the computed quantity: "reaction" for a settlement, "multiplier" for a live load."""
        return "reaction" if self.live is None else "multiplier"

    @property
    def unit(self) -> str:
        """Unit of the computed quantity: "N", "N m" for a rotation, "" for a multiplier."""
        return "" if self.live is not None else "N m" if self.is_rotation else "N"

    def draw(self) -> Any:
        """Draw the assembly.

        Returns
        -------
        comparison.Picture
            Picture of blocks, roles and contact points, which a notebook shows.
        """
        return picture(self)

    def _table(self) -> tuple[str, Sequence[str], Sequence[Sequence[str]]]:
        counts = [(f"{name} blocks", str(int((self.blocks.role == role).sum())), "") for name, role in ROLES.items()]
        values = (("weight of the free blocks", self.weight, "N"), ("friction", self.friction, ""), ("inset", self.inset, "m"))
        return self.title, (self.name, "", "unit"), [*counts, *((name, number_text(value), unit) for name, value, unit in values)]


def load_scene(path: Path, name: str = "") -> Scene:
    """Read, validate and expand a scene file; raises SceneError with every fault of it, each with its line.

    name: name of the scene instead of the file's stem, for copies.
    """
    return scene_of_text(reading.read_text(path), path, name or path.stem, counts_lines=True)


def scene_of_text(text: str, path: Path, name: str, counts_lines: bool = False) -> Scene:
    """Validate and expand the TOML `text` of a scene; its meshes lie beside `path`, which messages name.

    counts_lines: whether messages name lines, because the text is that of a file.
    """
    data, counted = reading.tables_of(text, path), text if counts_lines else ""
    try:
        return _build(path, name, text, _validate(data, counted), counted)
    except SceneError as error:
        raise SceneError(str(path), str(error)) from error


def _validate(data: dict[str, Any], counted: str) -> scene_file.SceneFile:
    try:
        return scene_file.SceneFile.model_validate(data)
    except pydantic.ValidationError as error:
        raise as_scene_error(error, data, scene_file.SceneFile, counted) from error


def _build(path: Path, name: str, text: str, file: scene_file.SceneFile, counted: str) -> Scene:
    if not name.isprintable():
        rule = "must be printable text, because it names a folder of results"
        raise SceneError(f'the name "{visible(name)}"', rule, hint="rename the file")
    imported, files, drawn = imported_blocks(file, path.parent)
    faults: list[Fault] = []
    named = list(islice(chain(_named_shapes(file, faults), imported), MOST_BLOCKS + 1))
    if faults:
        raise joined(faults, counted)
    if len(named) > MOST_BLOCKS:
        raise SceneError("scene", f"has more than {MOST_BLOCKS} blocks", hint="use fewer or larger blocks")
    _require_sense(named, file)
    named, repairs = repaired(named, file)
    shapes.refuse_slivers([n.name for n in named], [n.shape for n in named])
    densities = _densities(named, file)
    blocks = Blocks.gather([n.name for n in named], [n.role for n in named], _with_floors(named, densities), [n.shape for n in named])
    gravity, twist = np.array(file.gravity), support_twist(file.settlement)
    return Scene(
        name=name,
        path=path,
        text=text,
        title=file.title or name,
        source=file.source,
        gravity=gravity,
        friction=file.joint.friction,
        inset=file.joint.inset,
        blocks=blocks,
        support_twist=twist,
        live=unit_vector(file.live.direction) if file.live else None,
        effects=file.effects,
        path_asked=file.path,
        expected=file.expected,
        yade=file.yade,
        meshes=files,
        accuracy=file.accuracy,
        effort=file.effort,
        project=file.project,
        author=file.author,
        date=file.date,
        drawn=drawn,
        repairs=repairs,
        warnings=implausible(blocks, densities, file.joint.friction, gravity, twist),
    )


def _named_shapes(file: scene_file.SceneFile, faults: list[Fault]) -> Iterator[NamedShape]:
    """Blocks of all tables but those of meshes; what cannot be built is added to `faults`, and the next table follows."""
    for place, block in enumerate(file.block):
        try:
            yield NamedShape(block.name, block.role, block.density, shape_of(block))
        except ValueError as error:
            faults.append((("block", place), f'block "{block.name}": {error}'))
    for kind, blocks_of in _GENERATORS.items():
        for place, table in enumerate(getattr(file, kind)):
            try:
                yield from blocks_of(table)
            except ValueError as error:
                faults.append(((kind, place), f'{kind} "{table.name}": {error}'))
            except SceneError as error:  # which names the table already
                faults.append(((kind, place), str(error)))


_GENERATORS: dict[str, Callable[[Any], Iterator[NamedShape]]] = {
    "wall": wall.wall_blocks,
    "building": building.building_blocks,
    "arch": arches.arch_blocks,
    "vault": arches.vault_blocks,
    "dome": dome.dome_blocks,
    "rubble": rubble.rubble_blocks,
}


_WHERE_A_SUPPORT_IS = 'give a [[block]] role = "support", a wall a `footing` with a `settling` part, or an arch `springers`'


def _require_sense(named: list[NamedShape], file: scene_file.SceneFile) -> None:
    twice = [name for name, count in Counter(n.name for n in named).items() if count > 1]
    if twice:
        raise SceneError(f'block "{twice[0]}"', "the name is used twice; every block needs its own")
    roles = {n.role for n in named}
    if "free" not in roles:
        raise SceneError("block", "no block is free, so there is no structure", hint='give a [[block]] the role "free"')
    if file.settlement and "support" not in roles:
        raise SceneError("settlement", "no block has the role of support", hint=_WHERE_A_SUPPORT_IS)
    if file.live and "support" in roles:
        raise SceneError("live", "a [live] scene has no support", hint='give its held blocks role = "fixed"')
    if file.expected and (file.expected.multiplier is None) != (file.live is None):
        wanted = "multiplier" if file.live else "reaction_over_weight"
        raise SceneError("expected", f"a [{'live' if file.live else 'settlement'}] scene expects a `{wanted}`")
    for name in file.yade:
        if name not in SETTINGS:
            raise SceneError(f"yade.{name}", "unknown key", hint=nearest(name, SETTINGS))


def _densities(named: list[NamedShape], file: scene_file.SceneFile) -> list[float | None]:
    """Density of every block; None for a held block without one. Raises SceneError for a free block without one."""
    stone = file.stone.density if file.stone else None
    densities = [n.density if n.density is not None else stone for n in named]
    for n, density in zip(named, densities, strict=True):
        if density is None and ROLES[n.role] == FREE:
            raise SceneError(f'block "{n.name}": density', "missing", hint="give it one, or give all blocks one by [stone] density")
    return densities


def _with_floors(named: list[NamedShape], densities: list[float | None]) -> list[float]:
    """Density of every block with what it carries; NaN for a held block without one."""
    return [np.nan if density is None else density + n.added_density for n, density in zip(named, densities, strict=True)]
