"""Area loads on random blocks of several convex parts agree with a count by columns of cells, and with the top of random profiles."""

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from scipy.ndimage import label

import la_core
from la_core.geometry import Blocks, box, compound, prism
from la_core.scene.loads.top_faces import COVERED, UPWARD, carried

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


def random_profiles(seed: int, count: int) -> list[np.ndarray]:
    """Star-shaped polygons (n, 2), most of them notched, with flanks of every slope."""
    random, profiles = np.random.default_rng(seed), []
    while len(profiles) < count:
        corners = int(random.integers(5, 10))
        angle, radius = np.sort(random.uniform(0.0, 2.0 * np.pi, corners)), random.uniform(0.3, 1.0, corners)
        profile = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]).round(3)
        polygon = shapely.Polygon(profile)
        if polygon.is_valid and polygon.area > 0.1 and polygon.area < 0.99 * polygon.convex_hull.area:
            profiles.append(profile)
    return profiles


def by_strips(profile: np.ndarray, strips: int = 20_000) -> tuple[float, np.ndarray]:
    """Loaded length of the top of a profile (n, 2), and its middle (2,): the highest edge in each of many strips, unless it is steep."""
    edges = np.linspace(profile[:, 0].min(), profile[:, 0].max(), strips + 1)
    x, z, rise = 0.5 * (edges[1:] + edges[:-1]), np.full(strips, -np.inf), np.zeros(strips)
    for start, end in zip(profile, np.roll(profile, -1, axis=0), strict=True):
        along = end - start
        over = (x > min(start[0], end[0])) & (x < max(start[0], end[0]))
        height = start[1] + (x - start[0]) * along[1] / along[0] if along[0] else z
        higher = over & (height > z)
        z[higher], rise[higher] = height[higher], abs(along[0]) / np.linalg.norm(along)
    kept = rise > UPWARD
    return float(kept.sum() * (edges[1] - edges[0])), np.array([x[kept].mean(), z[kept].mean()])


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_notched_block_carries_its_load_on_its_outline(mirrored: bool) -> None:
    """Cuts between the convex parts of a block reach its top, or lie under a steep flank. Some carried the load in place of the top."""
    for profile in random_profiles(20261130, 60):
        shape = prism(profile * [-1.0, 1.0] if mirrored else profile, (0.0, 2.0))
        found = carried(Blocks.gather(["block"], ["free"], [2000.0], [shape]), np.array([True]), None)
        length, middle = by_strips(profile * [-1.0, 1.0] if mirrored else profile)
        assert found.share.sum() == pytest.approx(2.0 * length, abs=1e-3)
        assert found.share @ found.point / found.share.sum() == pytest.approx(np.array([middle[0], 1.0, middle[1]]), abs=1e-3)


def test_a_notched_body_in_general_position_carries_its_load(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """GEOS left lines of the length of round-off beside a visible part, and the next operation refused them."""
    profile = [
        (0.504, 0.108), (0.185, 0.193), (0.116, 0.246), (0.011, 0.858), (-0.196, 0.198), (-0.607, -0.099), (-0.763, -0.209),
        (0.304, -0.349), (0.29, -0.297), (0.251, -0.239), (0.696, -0.082),
    ]  # fmt: skip
    turn = np.array(
        [
            [-0.48336783962907504, 0.5050310566639977, -0.7150518606486997],
            [-0.8085026897092966, 0.05566356715341167, 0.5858540501051358],
            [0.33567682723887016, 0.8613043591533739, 0.3814129894985777],
        ]
    )
    count = len(profile)
    corners = np.array([(x, y, z) for y in (0.0, 1.0) for x, z in profile]) @ turn.T + [0.0, 0.0, 0.33583673398846065]
    sides = [(k, (k + 1) % count) for k in range(count)]
    faces = [range(count), range(2 * count - 1, count - 1, -1), *((b, a, count + a, count + b) for a, b in sides)]
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in corners] + ["f " + " ".join(str(k + 1) for k in face) for face in faces]
    (tmp_path / "body.obj").write_text("\n".join(["o body", *lines]) + "\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    scene = la_core.build(
        {
            "stone": {"density": 2000.0}, "joint": {"friction": 0.6}, "mesh": [{"file": "body.obj"}],
            "block": [{"name": "ground", "role": "support", "box": {"from": [-3.0, -3.0, -5.0], "to": [3.0, 3.0, 0.0]}}],
            "load": [{"blocks": ["body"], "per": "m2", "force": [0.0, 0.0, -1.0]}], "settlement": {"direction": [0.0, 0.0, -1.0]},
        }
    )  # fmt: skip
    shadow = shapely.MultiPoint(corners[:, :2]).convex_hull.area
    assert 0.3 * shadow < -scene.loads.force[:, 2].sum() < shadow


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_floor_on_a_notched_block_is_pushed_at_the_height_of_its_top(side: float) -> None:
    """The block tips about its edge at y = 0.5. Both are pushed at their centres: m g (0.25) + M g (0.25) = a (m z + M 0.7) g."""
    profile = [[0.0, 0.0], [0.1, 0.0], [0.9, 0.4], [1.5, 0.0], [1.6, 0.0], [1.6, 0.7], [0.0, 0.7]]
    mirrored = [[side * x, z] for x, z in profile]
    ground = {"name": "ground", "role": "fixed", "box": {"from": [-2.0, 0.0, -0.2], "to": [2.0, 0.5, 0.0]}}
    scene = la_core.build(
        {
            "stone": {"density": 2000.0}, "joint": {"friction": 0.9, "inset": 0.0},
            "block": [ground, {"name": "block", "prism": {"profile": mirrored[:: int(side)], "y": [0.0, 0.5]}}],
            "load": [{"blocks": ["block"], "per": "m2", "mass": 5000.0}], "live": {"direction": [0.0, 1.0, 0.0]},
        }
    )  # fmt: skip
    whole, notch = 1.6 * 0.7, 0.5 * 1.4 * 0.4
    mass, centre = 2000.0 * 0.5 * (whole - notch), (whole * 0.35 - notch * 0.4 / 3.0) / (whole - notch)
    floor = 5000.0 * 1.6 * 0.5
    answer = la_core.solve(scene, bounds_only=True)
    assert answer.multiplier == pytest.approx((mass + floor) * 0.25 / (mass * centre + floor * 0.7), rel=1e-6)
