"""Drawings in coordinates of three decimals: dents of rounding are filled, and no joint is counted once for each side of a cut."""

from itertools import pairwise

import numpy as np
import pytest
import scenes

import la_core
from la_core.analysis import structural_model
from la_core.geometry.division import SHALLOW, convex_parts
from la_core.scene import Scene

DEPTH, WIDTH = 0.3, 2.4
Corners = list[tuple[float, float]]


@pytest.mark.parametrize("dent", [1e-9, 1e-8, 1e-7, 1e-6])
def test_a_shallow_dent_is_filled_and_its_joint_counts_once(dent: float) -> None:
    """A dent of 1e-9 to 1e-7 m was refused: "the profile cannot be divided into convex parts"."""
    stone = scenes.block("stone", prism=([(0.0, 0.0), (0.4, 0.0), (0.4, 0.2), (0.15, 0.2 - dent), (0.0, 0.2)], (0.0, DEPTH)))
    top = scenes.box("top", (0.0, 0.0, 0.2), (0.4, DEPTH, 0.4))
    scene = scenes.build(*scenes.base(0.2, 0.4, DEPTH), stone, top)
    joints = structural_model(scene).assembly.interfaces
    assert len(joints) == 3 and joints.area.sum() == pytest.approx(2.0 * 0.4 * DEPTH, rel=1e-9)
    assert scene.blocks.volume[-2:].sum() == pytest.approx(0.4 * 0.4 * DEPTH, rel=1e-5)


def test_a_deeper_dent_is_cut() -> None:
    profile = np.array([(0.0, 0.0), (0.4, 0.0), (0.4, 0.2), (0.15, 0.2 - 4.0 * SHALLOW), (0.0, 0.2)])
    assert len(convex_parts(profile)) == 2
    profile[3, 1] = 0.2 - 0.2 * SHALLOW
    assert [len(part) for part in convex_parts(profile)] == [4]


def sloping_wall(seed: int, decimals: int) -> Scene:
    """A wall whose beds slope. Every outline has the corners of its neighbours, in mm with this number of decimals."""
    random = np.random.default_rng(seed)
    left, right = (np.cumsum([0.0, *random.uniform(0.2, 0.4, 4)]) for _ in range(2))
    stones: list[Corners] = []
    for low, high in pairwise(np.stack([left, right], axis=1).tolist()):
        cuts = np.linspace(0.0, WIDTH, int(random.integers(3, 6))) + random.uniform(-0.1, 0.1)
        ends = [0.0, *cuts[1:-1].tolist(), WIDTH]
        for a, b in pairwise(ends):
            (bottom_a, top_a), (bottom_b, top_b) = ([z[0] + (z[1] - z[0]) * x / WIDTH for z in (low, high)] for x in (a, b))
            stones.append([(a, bottom_a), (b, bottom_b), (b, top_b), (a, top_a)])
    corners = np.unique(np.array([corner for stone in stones for corner in stone]), axis=0)
    blocks = [scenes.block(f"stone {k}", prism=(with_corners(stone, corners, decimals), (0.0, DEPTH))) for k, stone in enumerate(stones)]
    return scenes.build(*scenes.base(0.6 * WIDTH, WIDTH, DEPTH), *blocks, friction=0.5, inset=1e-3)


def with_corners(stone: Corners, corners: np.ndarray, decimals: int) -> Corners:
    """Return an outline with all corners (n, 2) that lie on its edges, rounded."""
    outline = []
    for start, end in zip(np.array(stone), np.roll(stone, -1, axis=0), strict=True):
        along, (x, z) = end - start, (corners - start).T
        length = float(np.hypot(*along))
        share, off = (x * along[0] + z * along[1]) / length**2, np.abs(x * along[1] - z * along[0]) / length
        on_edge = np.flatnonzero((off < 1e-9) & (share > 1e-6) & (share < 1.0 - 1e-6))
        outline += [start, *corners[on_edge[np.argsort(share[on_edge])]]]
    return [(x / 1e3, z / 1e3) for x, z in np.round(1e3 * np.array(outline), decimals).tolist()]


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("decimals", [3, 4, 6])
def test_outlines_with_rounded_corners_have_the_joints_of_exact_ones(seed: int, decimals: int) -> None:
    """Nearly all such walls were refused. In the others a sliver and the cut behind it touched one neighbour, and a joint counted twice."""
    exact, rounded = sloping_wall(seed, 12), sloping_wall(seed, decimals)
    joints, found = (structural_model(scene).assembly.interfaces for scene in (exact, rounded))
    assert len(found) == len(joints) and found.area.sum() == pytest.approx(joints.area.sum(), rel=1e-5)
    answers = [la_core.solve(scene, bounds_only=True) for scene in (exact, rounded)]
    assert answers[1].least / rounded.weight == pytest.approx(answers[0].least / exact.weight, abs=1e-4)
    assert answers[1].greatest / rounded.weight == pytest.approx(answers[0].greatest / exact.weight, abs=1e-4)


@pytest.mark.parametrize(("radius", "chords"), [(10.0, 30), (10.0, 100), (100.0, 60)])
def test_a_curve_of_many_chords_is_not_filled_bit_by_bit(radius: float, chords: int) -> None:
    """Two stones share a cambered bed. Each fill is shallow, but many of them would fill the whole camber."""
    x = np.linspace(0.0, 1.0, chords + 1)
    bed = [
        (a, b) for a, b in zip(x.tolist(), (0.3 + np.sqrt(radius**2 - 0.25) - np.sqrt(radius**2 - (x - 0.5) ** 2)).tolist(), strict=True)
    ]
    lower = scenes.block("lower", prism=([(0.0, 0.0), (1.0, 0.0), *bed[::-1]], (0.0, DEPTH)))
    upper = scenes.block("upper", prism=([*bed, (1.0, 0.6), (0.0, 0.6)], (0.0, DEPTH)))
    joints = structural_model(scenes.build(*scenes.base(0.5, 1.0, DEPTH), lower, upper)).assembly.interfaces
    assert joints.area.sum() / DEPTH == pytest.approx(2.0, abs=1e-3)
