"""Forces of the [[load]] and [[tie]] tables on the blocks of a scene."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from la_core.errors import SceneError, nearest
from la_core.geometry import ROLES, Blocks, Held
from la_core.scene.loads.point_forces import PointForces
from la_core.scene.loads.top_faces import carried
from la_core.scene.schema.loads import JointFriction, Load, Tie
from la_core.scene.schema.scene_file import SceneFile

Fault = tuple[tuple[str | int, ...], str]  # place in the file, and message
OF_GROUPS = ("layer:", "colour:")  # prefixes of the names of groups: the layers and colours of a drawing
BESIDE = 1e-3  # of the length of a line: round-off of typed coordinates
GROUND = -1  # index in place of a block where the ground holds an end of a tie


@dataclass(frozen=True, eq=False, repr=False)
class Ties(Held):
    """The T ties of a scene.

    Attributes
    ----------
    names : tuple of str
        Name of each tie.
    block : (T, 2) array of int
        Blocks at both ends; GROUND where the ground holds the end.
    ends : (T, 2, 3) array
        Both ends, m.
    tension : (T,) array
        Tension, N.
    forces : PointForces
        Forces of the ties on blocks.
    at_support : (T,) array of bool
        Whether an end is at a support.
    """

    names: tuple[str, ...]
    block: np.ndarray
    ends: np.ndarray
    tension: np.ndarray
    forces: PointForces
    at_support: np.ndarray

    def __len__(self) -> int:
        return len(self.names)


def chosen_by(blocks: Blocks, pattern: str) -> np.ndarray:
    """Mask (B,) of the blocks that a pattern chooses by their names, or by their groups if it begins with a prefix such as `layer:`.

    A pattern equal to the name of a block chooses this block, even if the name contains characters such as `*`.
    """
    if pattern in blocks.names:
        return np.array([name == pattern for name in blocks.names])
    if pattern.startswith(OF_GROUPS):
        chosen = {group for group in {group for own in blocks.groups for group in own} if fnmatchcase(group, pattern)}
        return np.array([not chosen.isdisjoint(own) for own in blocks.groups or [()] * len(blocks)])
    return np.array([fnmatchcase(name, pattern) for name in blocks.names])


def not_there(pattern: str, kind: str, names: Sequence[str], groups_of: Sequence[tuple[str, ...]]) -> tuple[str, str]:
    """Rule and hint for a pattern that chooses no block of a kind; `names` and `groups_of` belong to the blocks of this kind."""
    groups = sorted({group for own in groups_of for group in own})
    if pattern.startswith(OF_GROUPS):
        hint = nearest(pattern, groups, "layers and colours") if groups else "only blocks of a [[drawing]] have a layer or a colour"
        return f'no {kind} has the {pattern.partition(":")[0]} "{pattern.partition(":")[2]}"', hint
    meant = f"{OF_GROUPS[0]}{pattern}"
    hint = f'did you mean "{meant}"?' if meant in groups else nearest(pattern, names, "names") if names else ""
    return f'no {kind} has the name "{pattern}"', hint


def faults_of_loads(file: SceneFile, blocks: Blocks) -> Iterator[Fault]:
    """Yield a fault for each load, tie or class of joints that names an unknown block, and for each load or tie that cannot act."""
    for number, load in enumerate(file.load):
        yield from _told(("load", number), load.name, _fault_of_load(load, blocks))
    for number, tie in enumerate(file.tie):
        yield from _told(("tie", number), tie.name, _fault_of_tie(tie, blocks))
    for number, rule in enumerate(file.friction):
        yield from _told(("friction", number), "", _fault_of_friction(rule, blocks))


def _told(place: tuple[str, int], name: str, fault: tuple[str, str, str] | None) -> Iterator[Fault]:
    """Yield the fault (key, rule, hint) of a table with its place and name."""
    if fault is not None:
        key, rule, hint = fault
        table = f'{place[0]} "{name}"' if name else f"{place[0]}[{place[1]}]"
        yield (*place, key), str(SceneError(f"{table}.{key}", rule, hint=hint))


def _unknown(pattern: str, blocks: Blocks, key: str, offered: np.ndarray | None = None) -> tuple[str, str, str] | None:
    """Return the fault of a pattern that chooses no block, else None. offered: mask (B,) of blocks for the hint, by default all."""
    if chosen_by(blocks, pattern).any():
        return None
    some = np.arange(len(blocks)) if offered is None else np.flatnonzero(offered)
    groups = [blocks.groups[k] for k in some] if blocks.groups else []
    return key, *not_there(pattern, "block", [blocks.names[k] for k in some], groups)


def _fault_of_load(load: Load, blocks: Blocks) -> tuple[str, str, str] | None:
    faults = (_unknown(pattern, blocks, "blocks", blocks.free) for pattern in load.blocks)  # on a held block a load changes nothing
    unknown = next((fault for fault in faults if fault is not None), None)
    if unknown is not None:
        return unknown
    chosen, key = chosen_blocks(load, blocks), "blocks" if load.blocks else "region"
    if not chosen.any():
        return key, "chooses no free block; a load on a held block changes nothing", "`crosscheck show` draws the blocks with names"
    if load.at is not None and chosen.sum() != 1:
        return "at", f"is a point on one block, but {int(chosen.sum())} blocks are chosen", "choose one block"
    return None if load.per == "block" else _fault_of_faces(load, blocks, chosen, key)


def _fault_of_faces(load: Load, blocks: Blocks, chosen: np.ndarray, key: str) -> tuple[str, str, str] | None:
    """Return the fault of a load on the top faces of the chosen blocks (B,), else None. key: key that chooses the blocks."""
    found = carried(blocks, chosen, _line(load))
    if not len(found.block):
        where = "from" if load.per == "m" else key
        return where, f"no top face of the chosen blocks {'lies under the line' if load.per == 'm' else 'faces up'}", ""
    if found.overlaps:
        rule = "some of the chosen top faces lie above each other, or the line runs along a joint between two of them"
        return (
            key,
            f"{rule}, so that the load would count twice",
            "choose the blocks of one level, or of the outermost ring of an arch, or shift the line a little",
        )
    return None


def _fault_of_tie(tie: Tie, blocks: Blocks) -> tuple[str, str, str] | None:
    for name in tie.blocks:
        if name not in blocks.names:
            many = "a rod ends at one block, so give the name of that block" if chosen_by(blocks, name).any() else ""
            return "blocks", f'no block has the name "{name}"', many or nearest(name, blocks.names, "names")
    if not any(blocks.free[blocks.names.index(name)] for name in tie.blocks):
        return "blocks", "no end is at a free block, so the rod changes nothing", ""
    return None


def _fault_of_friction(rule: JointFriction, blocks: Blocks) -> tuple[str, str, str] | None:
    faults = (_unknown(pattern, blocks, "between") for pattern in rule.between or ())
    return next((fault for fault in faults if fault is not None), None)


def chosen_blocks(load: Load, blocks: Blocks) -> np.ndarray:
    """Mask (B,) of the free blocks that a load acts on."""
    chosen = blocks.free.copy()
    if load.blocks:
        chosen &= np.any([chosen_by(blocks, pattern) for pattern in load.blocks], axis=0)
    if load.region is not None:
        low, high = np.array(load.region.from_), np.array(load.region.to)
        chosen &= np.all((blocks.centroid >= low) & (blocks.centroid <= high), axis=1)
    return chosen


def load_forces(loads: tuple[Load, ...], blocks: Blocks, gravity: np.ndarray) -> PointForces:
    """Forces of all loads; the loads must have no faults. gravity: acceleration (3,), m/s2."""
    return PointForces.gather([_of_load(load, number, blocks, gravity) for number, load in enumerate(loads)])


def _of_load(load: Load, number: int, blocks: Blocks, gravity: np.ndarray) -> PointForces:
    chosen = chosen_blocks(load, blocks)
    if load.per == "block":
        block = np.flatnonzero(chosen)
        point, share = blocks.centroid[block] if load.at is None else np.array([load.at]), np.ones(len(block))
    else:
        found = carried(blocks, chosen, _line(load))
        block, point, share = found.block, found.point, found.share
    mass = share * (load.mass or 0.0)
    force = mass[:, None] * gravity if load.force is None else share[:, None] * np.array(load.force)
    return PointForces(block, point, force, mass, np.full(len(block), number))


def _line(load: Load) -> tuple[tuple[float, float], tuple[float, float]] | None:
    return None if load.from_ is None or load.to is None else (load.from_, load.to)


def lines_beside_blocks(loads: tuple[Load, ...], blocks: Blocks) -> Iterator[str]:
    """Yield a warning for each line load whose line lies only in part over the top faces of its blocks."""
    for load in loads:
        line = _line(load)
        if line is None:
            continue
        length, found = math.dist(*line), carried(blocks, chosen_blocks(load, blocks), line)
        if found.share.sum() < (1.0 - BESIDE) * length:
            part = f"{found.share.sum():.3g} of {length:.3g} m"
            yield f'load "{load.name}": only {part} of its line lie over top faces of its blocks; the rest is left out.'


def ties_of(ties: tuple[Tie, ...], blocks: Blocks) -> Ties:
    """The ties of a scene; they must have no faults. An end at a held block counts as an end in the ground."""
    ends = np.array([(tie.from_, tie.to) for tie in ties]).reshape(-1, 2, 3)
    tension = np.array([tie.force for tie in ties])
    named = [[blocks.names.index(name) for name in tie.blocks] for tie in ties]
    block = np.array([[*found, GROUND][:2] for found in named], dtype=int).reshape(-1, 2)
    at_support = np.any((blocks.role[block] == ROLES["support"]) & (block != GROUND), axis=1)
    block = np.where(blocks.free[block] & (block != GROUND), block, GROUND)
    along = ends[:, 1] - ends[:, 0]
    pull = tension[:, None] * along / np.linalg.norm(along, axis=1)[:, None]
    tie, side = np.nonzero(block != GROUND)
    force = np.where(side == 0, 1.0, -1.0)[:, None] * pull[tie]
    forces = PointForces(block[tie, side], ends[tie, side], force, np.zeros(len(tie)), tie)
    return Ties(tuple(one.name for one in ties), block, ends, tension, forces, at_support)
