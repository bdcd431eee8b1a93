"""Reads a TOML file into a `Scene`, with every check that needs no solver."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pydantic

from la_core.errors import SceneError, printable_name
from la_core.geometry import ROLES, Blocks, Held
from la_core.pictures import picture
from la_core.repair import Repairs
from la_core.scene import reading
from la_core.scene.generators.drawings import DrawnBlocks
from la_core.scene.generators.mesh import MeshFile
from la_core.scene.line_numbers import KeyPath, with_lines
from la_core.scene.loads.dead_loads import Ties, faults_of_loads, load_forces, ties_of
from la_core.scene.loads.plausibility import implausible_loads
from la_core.scene.loads.point_forces import PointForces
from la_core.scene.loads.support_motion import faults_of_settlement, own_twists, support_twists
from la_core.scene.loads.tilt import tilt_push
from la_core.scene.plausibility import implausible
from la_core.scene.scene_blocks import Tables, checked_blocks, where_drawn
from la_core.scene.schema import scene_file
from la_core.scene.schema.loads import JointFriction
from la_core.scene.schema.motion import support_twist, unit_vector
from la_core.scene.schema.types import MOST_BLOCKS
from la_core.scene.validation import as_scene_error, joined
from la_core.text_table import Tabled, number_text


@dataclass(frozen=True, repr=False, eq=False)
class Scene(Tabled, Held):
    """Validated scene: blocks, joint law, support motion or live load, requested effects and expected values.

    Units are SI; the axis z points up. `load`, `build` and `variant` make scenes; arrays are read-only. `print(scene)` shows a
    summary as a table, and so does a notebook.

    Attributes
    ----------
    name : str
        Name of the scene and of its folder of results.
    path : Path
        Path of the scene file, which messages name. A scene from `build` has no file at this path.
    text : str
        Scene as TOML.
    title : str
        Title, or the name where the file has no title.
    source : str
        Source of the geometry or of the expected value, "" where the file names none.
    gravity : ndarray, shape (3,)
        Acceleration of gravity, m/s2.
    friction : float
        Friction coefficient of every joint that belongs to no class of [[friction]], tan(phi).
    inset : float
        Distance by which contact points lie inside the edges of an interface, m.
    blocks : Blocks
        Geometry, mass and role of every block.
    support_twist : ndarray, shape (6,), or None
        Unit motion of the supports: velocity of the origin, then angular velocity. None for a live load.
    own_twists : ndarray, shape (B, 6), or None
        Motion of each support by its share of the settlement, as `support_twist`; 0 for others. None where all move by `support_twist`.
    live : ndarray, shape (3,), or None
        Unit direction of the load proportional to weight; a [tilt] is such a load, too. None for a settlement.
    effects : RequestedEffects
        Choice for every effect, "auto" where the program decides.
    path_asked : RequestedPath or None
        Settlement and increments of the requested equilibrium path. None without a [path] table.
    expected : Expected or None
        Expected values for sharp edges. None without an [expected] table.
    yade : mapping of str to float
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
        Person responsible for the report, "" where the file names nobody.
    date : str
        Date in the head of the report, "" where the file has none.
    drawn : tuple of DrawnBlocks
        Record of each [[drawing]]: outlines that became blocks, were changed or were left out.
    repairs : Repairs or None
        Changes of the geometry within its tolerance. None where the scene requests no repair.
    warnings : tuple of str
        Sentences about values that are allowed but seldom meant, such as an angle for friction.
    places : tuple
        Table of the file that each block comes from, such as ("wall", 0).
    loads : PointForces
        Dead loads beside the weight of the blocks, as forces on blocks.
    ties : Ties or None
        Rods of given tension; None without a [[tie]] table.
    joint_classes : tuple of JointFriction
        Classes of joints with a friction of their own.
    load_names : tuple of str
        Name of each [[load]] table.
    tilt : ndarray, shape (3,), or None
        Unit axis about which the ground tilts, right-handed. None without a tilt.
    floor_mass : ndarray, shape (B,), or None
        Mass of a building's floors on each block, a part of its mass, kg. None without a floor.
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
    own_twists: np.ndarray | None
    live: np.ndarray | None
    effects: scene_file.RequestedEffects
    path_asked: scene_file.RequestedPath | None
    expected: scene_file.Expected | None
    yade: Mapping[str, Any]
    meshes: tuple[MeshFile, ...] = ()
    accuracy: float | None = None
    effort: str = "normal"
    project: str = ""
    author: str = ""
    date: str = ""
    drawn: tuple[DrawnBlocks, ...] = ()
    repairs: Repairs | None = None
    warnings: tuple[str, ...] = ()
    places: tuple[KeyPath, ...] = ()
    loads: PointForces = field(default_factory=PointForces.none)
    ties: Ties | None = None
    joint_classes: tuple[JointFriction, ...] = ()
    load_names: tuple[str, ...] = ()
    tilt: np.ndarray | None = None
    floor_mass: np.ndarray | None = None

    def located(self, error: SceneError) -> SceneError:
        """Return an error of blocks or of a key with its place: the path of the file, or else the scene's name, and the lines in the file.

        A file that has changed since it was read gets no lines.

        Parameters
        ----------
        error : SceneError
            Error that names blocks or a key.

        Returns
        -------
        SceneError
            The error with its place.
        """
        try:
            counted = self.text if reading.read_text(self.path) == self.text else ""
        except SceneError:  # a scene that was made in code has no file
            counted = ""
        found = with_lines(where_drawn(error, self.blocks, self.places), counted, self.blocks.names, self.places)
        return SceneError.told(f"{self.path if self.path.exists() else self.name}: {found}", found)

    @property
    def weight(self) -> float:
        """Weight of all free blocks and their dead loads, N. A load counts by its component along gravity; an uplift counts as 0."""
        size = float(np.linalg.norm(self.gravity))
        own, loads = self.blocks.mass[self.blocks.free].sum() * size, self.loads.weight(len(self.blocks), self.gravity / size).sum()
        return float(own + loads)

    @property
    def shortest_joint(self) -> float:
        """Length of the shortest joint that counts, m; 0 without repairs of the geometry."""
        return 0.0 if self.repairs is None else self.repairs.shortest_joint

    @property
    def support_twists(self) -> np.ndarray | None:
        """Unit motion (B, 6) of every support: velocity of the origin, then angular velocity; 0 for other blocks, None for a live load."""
        if self.own_twists is not None or self.support_twist is None:
            return self.own_twists
        return np.where((self.blocks.role == ROLES["support"])[:, None], self.support_twist, 0.0)

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
        weight = ("weight of the free blocks and their loads", self.weight, "N")
        values = (weight, ("friction", self.friction, ""), ("inset", self.inset, "m"))
        return self.title, (self.name, "", "unit"), [*counts, *((name, number_text(value), unit) for name, value, unit in values)]


def load_scene(path: Path, name: str = "") -> Scene:
    """Read, validate and expand a scene file; raises SceneError with every fault of the file and its line.

    name: name of the scene instead of the file's stem, for copies.
    """
    return scene_of_text(reading.read_text(path), path, name or path.stem, counts_lines=True)


def scene_of_text(text: str, path: Path, name: str, counts_lines: bool = False, where: str = "") -> Scene:
    """Validate and expand the TOML `text` of a scene; the files of its meshes and drawings lie in the folder of `path` or below it.

    counts_lines: whether messages name lines; True for the text of a file. where: name of the scene in messages; "" takes `path`.
    """
    data, counted = reading.tables_of(text, path), text if counts_lines else ""
    reading.refuse_a_campaign(data, path)
    try:
        return _build(path, name, text, scene_file.SceneFile.model_validate(data), counted)
    except SceneError as error:
        raise SceneError(where or str(path), str(error)) from error
    except pydantic.ValidationError as error:
        raise SceneError(where or str(path), str(as_scene_error(error, data, scene_file.SceneFile, counted))) from error


def _build(path: Path, name: str, text: str, file: scene_file.SceneFile, counted: str) -> Scene:
    printable_name(name)
    tables = Tables(file, path.parent)
    if len(tables.named) > MOST_BLOCKS:
        raise SceneError("scene", f"has more than {MOST_BLOCKS} blocks", hint="use fewer or larger blocks")
    blocks, stones, floor_mass, repairs = checked_blocks(tables, file, counted)
    gravity = np.array(file.gravity)
    tilt = unit_vector(file.tilt.axis) if file.tilt else None
    if faults := [*faults_of_loads(file, blocks), *faults_of_settlement(file, blocks)]:
        raise joined(faults, counted)
    loads, ties = load_forces(file.load, blocks, gravity), ties_of(file.tie, blocks) if file.tie else None
    names_of_loads = tuple(load.name for load in file.load)
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
        support_twist=support_twist(file.settlement),
        own_twists=own_twists(file.settlement, blocks),
        live=unit_vector(file.live.direction) if file.live else None if tilt is None else tilt_push(tilt, gravity),
        effects=file.effects,
        path_asked=file.path,
        expected=file.expected,
        yade=file.yade,
        meshes=tuple(tables.files),
        accuracy=file.accuracy,
        effort=file.effort,
        project=file.project,
        author=file.author,
        date=file.date,
        drawn=tuple(tables.drawn),
        repairs=repairs,
        warnings=(
            *(words for one in tables.drawn for words in one.warnings()),
            *implausible(blocks, stones, file, gravity, support_twists(file.settlement, blocks), repairs),
            *implausible_loads(file, loads, names_of_loads, ties, blocks, gravity),
        ),
        places=tuple(tables.places),
        loads=loads,
        ties=ties,
        joint_classes=file.friction,
        load_names=names_of_loads,
        tilt=tilt,
        floor_mass=floor_mass,
    )
