"""Area loads on random blocks of several convex parts agree with a count by columns of cells."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import label

from la_core.geometry import Blocks, box, compound
from la_core.scene.loads.top_faces import COVERED, carried

Cell = tuple[int, ...]


def grown(random: np.random.Generator, size: Cell, most: int) -> np.ndarray:
    """Owner of every cell of a grid. A block has up to `most` cells, each of which shares a face with another cell of the block."""
    owner = np.full(size, -1)
    cells = list(itertools.product(*(range(count) for count in size)))
    random.shuffle(cells)
    for number, first in enumerate(tuple(cell) for cell in cells):
        if owner[first] >= 0:
            continue
        block = [first]
        owner[first] = number
        for _ in range(int(random.integers(0, most))):
            beside = [cell for own in block for cell in neighbours(own, size) if owner[cell] < 0]
            if not beside:
                break
            block.append(beside[random.integers(len(beside))])
            owner[block[-1]] = number
    return np.unique(owner, return_inverse=True)[1].reshape(size)


def neighbours(cell: Cell, size: Cell) -> list[Cell]:
    steps = itertools.product(range(3), (1, -1))
    moved = [tuple(place + step * (axis == k) for k, place in enumerate(cell)) for axis, step in steps]
    return [cell for cell in moved if all(0 <= place < count for place, count in zip(cell, size, strict=True))]


def by_columns(mine: np.ndarray, others: np.ndarray, area: np.ndarray) -> float:
    """Area that carries the load on the cells `mine` (X, Y, Z) beside `others`; area: of each column (X, Y), m2."""
    above = np.zeros_like(mine)
    above[:, :, :-1] = np.cumsum(mine[:, :, :0:-1], axis=2)[:, :, ::-1] > 0
    seen, covered = mine & ~above, np.zeros_like(mine)
    covered[:, :, :-1] = others[:, :, 1:]
    faces = []
    for level in range(mine.shape[2]):
        number, count = label(seen[:, :, level])
        for face in range(1, count + 1):
            own = number == face
            faces.append((float(area[own].sum()), float(area[own & covered[:, :, level]].sum())))
    carry = [size for size, joint in faces if joint < COVERED * size]
    return sum(carry or [size for size, _ in faces])


@pytest.mark.parametrize("turn", [0.0, 17.0])
def test_the_open_faces_of_a_compound_block_carry_the_load(turn: float) -> None:
    """The 280 cells of a grid make blocks of 1 to 8 cells. A sixth of the blocks is left out, and half of the others carry the load."""
    random = np.random.default_rng(20261129)
    ways = [np.cumsum([0.0, *random.uniform(0.2, 0.6, count)]) for count in (8, 7, 5)]
    owner = grown(random, (8, 7, 5), 8)
    kept = np.flatnonzero(random.random(owner.max() + 1) > 1.0 / 6.0)
    cosine, sine = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    rotation = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
    shapes = []
    for block in kept:
        ends = [[(way[k], way[k + 1]) for way, k in zip(ways, cell, strict=True)] for cell in np.argwhere(owner == block)]
        parts = [box([low for low, _ in cell], [high for _, high in cell]) for cell in ends]
        shapes.append(compound([replace(part, vertices=part.vertices @ rotation.T) for part in parts]))
    blocks = Blocks.gather([str(block) for block in kept], ["free"] * len(kept), [2000.0] * len(kept), shapes)
    chosen, area = random.random(len(kept)) < 0.5, np.outer(np.diff(ways[0]), np.diff(ways[1]))
    found = carried(blocks, chosen, None)
    solid = np.isin(owner, kept)
    expected = [by_columns(owner == block, solid & (owner != block), area) * loaded for block, loaded in zip(kept, chosen, strict=True)]
    assert np.bincount(found.block, found.share, len(kept)) == pytest.approx(np.array(expected), rel=1e-6)
    assert blocks.is_compound.sum() > 20
