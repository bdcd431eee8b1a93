"""Warnings about loads, ties and friction that are allowed but seldom meant: kN for N, an uplift, a point beside its block."""

from collections.abc import Iterator

import numpy as np

from la_core.geometry import Blocks
from la_core.scene.loads.dead_loads import GROUND, Ties, lines_beside_blocks
from la_core.scene.loads.point_forces import PointForces
from la_core.scene.loads.support_motion import bent_over_supports
from la_core.scene.schema.scene_file import SceneFile
from la_core.text_table import number_text

FRICTION = 1.2  # no dry joint of stone is known to have more; 1.2 is 50 degrees
SMALL, LARGE = 1e-4, 10.0  # of the weight of the blocks: a smaller load changes nothing, a larger load is many floors on one wall
ROUND_OFF = 1e-9  # of a force: a smaller component against gravity is round-off
BESIDE = 1e-3  # of the size of a block: round-off of typed coordinates


def implausible_loads(
    file: SceneFile, loads: PointForces, names: tuple[str, ...], ties: Ties | None, blocks: Blocks, gravity: np.ndarray
) -> Iterator[str]:
    """Yield one sentence for each load, tie, class of joints or profile of a settlement that is probably a slip.

    Parameters
    ----------
    file : SceneFile
        Tables of the scene.
    loads : PointForces
        Dead loads of the scene.
    names : tuple of str
        Name of each [[load]].
    ties : Ties or None
        Ties of the scene.
    blocks : Blocks
        Blocks of the scene.
    gravity : ndarray, shape (3,)
        Acceleration of gravity, m/s2.
    """
    weight = float(blocks.mass[blocks.free].sum() * np.linalg.norm(gravity))
    for number, name in enumerate(names):
        own = loads.table == number
        force = loads.force[own].sum(axis=0)
        yield from _of_size(f'load "{name}"', float(np.linalg.norm(force)), weight)
        if force @ gravity < -ROUND_OFF * np.linalg.norm(force) * np.linalg.norm(gravity):
            yield f'load "{name}" lifts: it acts against gravity; a load downward has a force such as [0, 0, -1000].'
        yield from _beside(f'load "{name}" acts', loads.point[own], loads.block[own], blocks)
    for number, name in enumerate(ties.names if ties is not None else ()):
        assert ties is not None
        yield from _of_size(f'tie "{name}"', float(ties.tension[number]), weight)
        held = ties.block[number] != GROUND
        yield from _beside(f'tie "{name}" ends', ties.ends[number][held], ties.block[number][held], blocks)
        if ties.at_support[number]:
            yield f'tie "{name}" ends at a support: the reaction is the force of its joints alone, without the pull of the tie.'
    yield from lines_beside_blocks(file.load, blocks)
    yield from bent_over_supports(file, blocks)
    for number, one in enumerate(file.friction):
        if one.friction > FRICTION:
            yield f"friction[{number}].friction = {one.friction:g} is above {FRICTION:g}, but dry stone has 0.5 to 0.75."


def _of_size(what: str, size: float, weight: float) -> Iterator[str]:
    if size < SMALL * weight:
        yield f"{what} is {number_text(size, 3)} N, less than {SMALL:g} of the weight of the blocks; forces are in N, not in kN."
    if size > LARGE * weight:
        yield f"{what} is {number_text(size, 3)} N, more than {LARGE:g} times the weight of the blocks; forces are in N, masses in kg."


def _beside(what: str, point: np.ndarray, block: np.ndarray, blocks: Blocks) -> Iterator[str]:
    """Yield a warning for the point (N, 3) that lies farthest outside the box around its block (N,)."""
    low, high = blocks.low[block], blocks.high[block]
    outside = np.linalg.norm(np.maximum(np.maximum(low - point, point - high), 0.0), axis=1)
    farthest = int(outside.argmax()) if len(outside) else 0
    if len(outside) and outside[farthest] > BESIDE * np.linalg.norm(high - low, axis=1)[farthest]:
        yield f'{what} {outside[farthest]:.3g} m outside its block "{blocks.names[block[farthest]]}".'
