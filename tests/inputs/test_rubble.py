"""Rubble fills its wall with stones drawn from a seed, and no joint of the wall is short."""

from typing import Any

import numpy as np
import pytest
import scenes
from measured_shapes import ROUND_OFF, exposed, free_volume, upright

from la_core.errors import SceneError
from la_core.geometry.interfaces import find_interfaces
from la_core.scene.generators import rubble as generator


def rubble(**changes: Any) -> str:
    entries = {
        "origin": (0.3, -0.2, 0.1), "size": (1.8, 1.2), "depth": 0.4, "stones": 20, "seed": 3, "shortest": 0.05,
        "footing": {"height": 0.2, "settling": (1.2, 1.8)},
    }  # fmt: skip
    return scenes.table("[rubble]", **(entries | changes))


@pytest.mark.parametrize("changes", [{}, {"seed": 8, "stones": 45, "shortest": 0.04}, {"flatness": 3.0, "stones": 8}, {"angle": 40.0}])
def test_rubble_fills_its_wall_and_has_no_short_joint(changes: dict[str, Any]) -> None:
    scene = scenes.build(rubble(**changes))
    volume, surface = upright(1.8 * 1.2, 1.8 + 2 * 1.2)
    assert scene.blocks.free.sum() == changes.get("stones", 20)
    assert free_volume(scene) == pytest.approx(volume, rel=ROUND_OFF) and exposed(scene) == pytest.approx(surface, rel=ROUND_OFF)
    joints = find_interfaces(scene.blocks)
    own = scene.blocks.free[joints.block_a] & scene.blocks.free[joints.block_b]
    assert (joints.area[own] / 0.4).min() >= changes.get("shortest", 0.05) * (1.0 - ROUND_OFF)


def test_a_seed_draws_the_same_stones_and_another_seed_others() -> None:
    first, again, other = (scenes.build(rubble(seed=seed)).blocks.vertices for seed in (5, 5, 6))
    assert np.array_equal(first, again) and (first.shape != other.shape or not np.allclose(first, other))


def test_rubble_whose_joints_cannot_be_so_long_says_what_can(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(SceneError, match=r"`shortest` may be at most 0.131 m: these stones are about 0.33 m long"):
        scenes.build(rubble(shortest=0.4))
    monkeypatch.setattr(generator, "MOST_MOVES", 1)
    with pytest.raises(SceneError, match=r'rubble "rubble": shortest = 0.1: cannot be reached: these stones keep .* such as 0.033 m'):
        scenes.build(rubble(shortest=0.1))
