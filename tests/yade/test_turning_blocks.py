"""The change of a reaction by the geometry of turning blocks, by differences and by hand."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from yade_scripts import plateau


def turned(spin: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """The vector turned by a rotation vector, by Rodrigues' formula."""
    angle = float(np.linalg.norm(spin))
    axis = spin / angle
    across = np.cross(axis, vector)
    return vector + np.sin(angle) * across + (1.0 - np.cos(angle)) * np.cross(axis, across)


def test_turning_blocks_change_the_reaction_by_force_times_the_curvature_of_the_way_of_each_point_over_its_face() -> None:
    """Two blocks in random motion, which has already begun: the second derivative by differences, in the frame of the turning face."""
    draw = np.random.default_rng(7)
    centroid, velocity, spin, position, before, after, moved, leaning = draw.standard_normal((8, 2, 3))
    begun, travel, step = 0.3, 0.5, 1e-4
    states = (
        plateau.Pose(begun, moved, leaning, before),
        plateau.Pose(begun + travel, moved + travel * velocity, leaning + travel * spin, after),
    )
    for host in (np.array([0, 1]), np.array([1, 0])):
        target, curvature = 1 - host, np.zeros((2, 3))
        for point, (h, t) in enumerate(zip(host, target, strict=True)):

            def place(s: float, p: np.ndarray = position[point], h: int = int(h), t: int = int(t)) -> np.ndarray:
                of_host = centroid[h] + s * velocity[h] + turned(s * spin[h], p - centroid[h])
                return turned(-s * spin[t], of_host - centroid[t] - s * velocity[t])

            curvature[point] = (place(step) - 2.0 * (position[point] - centroid[t]) + place(-step)) / step**2
        on_host = np.where(host == 1, 1.0, -1.0)[:, None] * 0.5 * (before + after)
        expected = (on_host * curvature).sum(axis=1)
        one: Any = SimpleNamespace(host=host, target=target, position=position, centroid=centroid, block_b=np.array([1, 1]))
        assert plateau.turning_slopes(one, *states) == pytest.approx((expected.sum(), np.abs(expected).sum()), rel=1e-5)
        assert plateau.turning_slopes(one, states[1], states[1]) == (0.0, 0.0)


@pytest.mark.parametrize(("live", "slope", "lever"), [(None, 30.0, 0.08), (np.array([1.0, 0.0, 0.0]), -0.03, 0.1)])
def test_geometry_is_told_per_radian_of_a_support_and_per_pushed_weight_of_a_live_load(
    live: Any, slope: float, lever: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Blocks of 0.4 m: the support moves 5 m a radian, and the fastest block 4 times as far as the load.

    Of the weight of 5 kN, 4 kN are a dead load that is not pushed.
    """
    monkeypatch.setattr(plateau, "turning_slopes", lambda *_: (30.0, 50.0))
    masses = {"mass": np.array([0.0, 40.0, 60.0]), "free": np.array([1, 2]), "gravity": np.array([0.0, 0.0, -10.0])}
    one: Any = SimpleNamespace(live=live, live_load=np.zeros((3, 6)), weight=5000.0, block_size=0.4, support_speed=5.0, **masses)
    moved = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -8e-4]])
    first, last = (plateau.Pose(settlement, settlement / 2e-4 * moved, moved, moved) for settlement in (1e-4, 3e-4))
    found = plateau.geometry_of(one, first, last)
    assert (found.slope, found.turning, found.lever) == pytest.approx((slope, abs(slope) * 5.0 / 3.0, lever))
    assert plateau.largest_speed(first, last._replace(settlement=8e-3)) == 1.0  # at least that of the load


def test_a_block_that_tips_under_a_live_load_bears_less_as_it_leans() -> None:
    """The multiplier is the tangent of an angle that falls by the tilt: slope -(1 + tan^2) over the centroid's height above the edge."""
    half, height, weight, turn = 0.25, 0.35, 1000.0, 1e-4
    multiplier = half / height
    forces = np.array([[-multiplier * weight, 0.0, weight]])  # of the ground on the block, along its edge
    spin = np.array([[0.0, 0.0, 0.0], [0.0, turn, 0.0]])
    moved = np.cross(spin, np.array([-half, 0.0, height]))  # of the centroid, from the edge
    states = plateau.Pose(0.0, 0.0 * spin, 0.0 * spin, forces), plateau.Pose(moved[1, 0], moved, spin, forces)
    one: Any = SimpleNamespace(
        live=np.array([1.0, 0.0, 0.0]), live_load=np.zeros((2, 6)), weight=weight, block_size=0.5, gravity=np.array([0.0, 0.0, -10.0]),
        mass=np.array([0.0, weight / 10.0]), free=np.array([1]), host=np.array([1]), target=np.array([0]), block_b=np.array([1]),
        position=np.array([[half, 0.0, 0.0]]), centroid=np.array([[0.0, 0.0, -0.1], [0.0, 0.0, height]]),
    )  # fmt: skip
    assert plateau.geometry_of(one, *states).slope == pytest.approx(-(1.0 + multiplier**2) / height)
