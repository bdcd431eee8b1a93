"""Plateau of a curve: flat or not, what its scatter leaves open, and which values are one plateau."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scenes

from la_core.coulomb import PredictionSettings, plateau, predict, prediction
from la_core.limit import Drive, Status, solve_associated
from la_core.model import assemble, joint_stiffness

PROGRESS = np.concatenate([[0.0], np.geomspace(1e-4, 1.0, 200)])


@pytest.mark.parametrize(("values", "flat"), [
    (0.2 + 0.1 * np.exp(-PROGRESS / 0.02), True),
    (0.2 + 0.1 * np.exp(-PROGRESS / 0.2), False),
    (0.2 - 0.01 * np.log10(PROGRESS + 1e-3), False),  # creeps on and on
    (np.zeros_like(PROGRESS), True),
    (1e-8 * np.cos(40.0 * PROGRESS), True),  # a reaction of zero, but for noise
])  # fmt: skip
def test_a_curve_is_flat_where_its_mean_no_longer_changes(values: np.ndarray, flat: bool) -> None:
    assert bool(plateau.plateau_of(PROGRESS, values, 1.0, values[-1]).is_flat) is flat


def test_a_plateau_states_its_change_and_its_scatter_without_a_stray_jump() -> None:
    progress = np.linspace(0.0, 1.0, 1001)
    values = np.where(progress <= 0.5, 0.3, 0.2)
    values[900] = 1372.0  # a jump in progress
    found = plateau.plateau_of(progress, values, 1.0, 0.201)
    assert found.change > 0.09
    assert found.scatter == pytest.approx(0.001)


@pytest.mark.parametrize(("values", "expected"), [
    ([0.2], [[0]]),
    ([0.2, 0.2001], [[0, 1]]),
    ([0.2962, 0.2792, 0.29615], [[1], [2, 0]]),
    ([0.0, 1e-6, -1e-6], [[2, 0, 1]]),
])  # fmt: skip
def test_values_closer_than_a_hundredth_are_one_plateau(values: list[float], expected: list[list[int]]) -> None:
    assert plateau.groups(values) == expected


def test_paths_that_end_apart_are_told_as_several_plateaus(monkeypatch: pytest.MonkeyPatch) -> None:
    """Paths are made to end 5 % apart by their viscosity; a third one decides, and the uncertainty covers both values."""
    scene = scenes.build(*scenes.wall(4, 3, split=0.8), friction=0.6)
    assembly = assemble(scene)
    stiffness, associated = joint_stiffness(assembly, 0.0, {}), solve_associated(assembly, Drive.YIELDING)
    whole = predict(assembly, stiffness, associated)
    original, made = prediction.follow, []

    def apart(*arguments: Any) -> Any:
        made.append(one := original(*arguments))
        assert one is not None
        return replace(one, plateau=replace(one.plateau, value=1.05 * one.plateau.value)) if len(made) == 1 else one

    monkeypatch.setattr(prediction, "follow", apart)
    several = predict(assembly, stiffness, associated, settings=PredictionSettings())
    assert len(several.viscosities) == 3
    assert several.plateaus == pytest.approx([whole.value, 1.05 * whole.value], rel=1e-3)
    assert several.value == pytest.approx(whole.value, rel=1e-3)
    assert several.uncertainty == pytest.approx(0.05 * whole.value, rel=0.05)
    assert several.status is Status.SOLVED
