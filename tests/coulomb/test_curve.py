"""Plateau of a curve: its flatness, the uncertainty from its scatter, and the values that count as one plateau."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scenes
from verdict_scenes import EARLIER_SEED, drawn

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


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("share", "scatter"), [(0.04, 0.001), (0.06, 0.1)])
def test_what_strays_over_a_twentieth_of_the_last_quarter_scatters(share: float, scatter: float, sign: float) -> None:
    """Values that stray upwards and downwards count alike. Over a shorter stretch they are a jump in progress."""
    progress = np.linspace(0.0, 1.0, 10_001)
    strays = (progress > 0.9) & (progress <= 0.9 + 0.25 * share)
    found = plateau.plateau_of(progress, 0.2 + sign * np.where(strays, 0.1, 0.001), 1.0, 0.2)
    assert found.scatter == pytest.approx(scatter)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_long_step_scatters_as_any_other_one(sign: float) -> None:
    """The last quarter of the way has only two steps. Each is longer than a twentieth of it."""
    progress, values = np.array([0.0, 0.25, 0.5, 0.75, 0.875, 1.0]), np.array([0.2, 0.2, 0.2, 0.2, 0.2, 0.2 + sign * 0.05])
    assert plateau.plateau_of(progress, values, 1.0, 0.2).scatter == pytest.approx(0.05)


def test_a_curve_changes_from_its_second_quarter_to_its_second_half_and_scatters_over_its_last_quarter() -> None:
    progress = np.linspace(0.0, 1.0, 1001)
    values = np.select([progress <= 0.25, progress <= 0.5, progress <= 0.75], [7.0, 0.3, 0.22], 0.2)
    found = plateau.plateau_of(progress, values, 1.0, 0.201)
    assert (found.mean, found.change, found.scatter) == pytest.approx((0.21, 0.09, 0.001))


@pytest.mark.parametrize(("value", "least"), [(0.2, 0.2), (-0.2, 0.2), (0.0, 1e-3)])
def test_a_plateau_is_known_to_one_per_cent_of_its_value_or_of_a_thousandth_of_the_weight(value: float, least: float) -> None:
    known, unknown = (plateau.Plateau(value, value, 0.0, share * least, 1.0) for share in (0.0099, 0.0101))
    assert known.is_known and not unknown.is_known


@pytest.mark.parametrize(("mean", "most"), [(0.2, 1e-4), (-0.2, 1e-4), (0.0, 5e-7)])
def test_a_curve_is_flat_to_half_a_thousandth_of_its_mean_or_of_a_thousandth_of_the_weight(mean: float, most: float) -> None:
    """The value at the end of the curve does not matter."""
    for value in (0.1, 0.9):
        flat, rising = (plateau.Plateau(value, mean, share * most, 0.0, 1.0) for share in (0.99, 1.01))
        assert flat.is_flat and not rising.is_flat


@pytest.mark.parametrize(("value", "doubt", "most"), [
    (0.3, 2e-3, 6e-3),  # three times its own doubt
    (0.3, 1e-4, 3e-3),  # one per cent of its value
    (-0.3, 1e-4, 3e-3),
    (0.0, 1e-6, 1e-5),
])  # fmt: skip
def test_a_curve_has_left_a_plateau_where_it_is_much_more_doubtful(value: float, doubt: float, most: float) -> None:
    best = plateau.Plateau(value, value, 0.0, doubt, 1.0)
    for later in (0.01, 5.0):
        assert not best.is_left_at(plateau.Plateau(later, later, 0.0, 0.99 * most, 2.0))
        assert best.is_left_at(plateau.Plateau(later, later, 0.0, 1.01 * most, 2.0))
    assert best.is_left_at(plateau.Plateau(value, value, np.nan, np.nan, 2.0))


def test_of_change_and_scatter_the_known_one_is_the_doubt_about_a_plateau() -> None:
    assert plateau.Plateau(0.3, 0.3, 1e-4, np.nan, 1.0).doubt == 1e-4
    assert plateau.Plateau(0.3, np.nan, np.nan, 5e-3, 1.0).doubt == 5e-3
    assert np.isnan(plateau.Plateau(0.3, np.nan, np.nan, np.nan, 1.0).doubt)


@pytest.mark.parametrize("size", [1.0, -1.0, 100.0, 0.001])
def test_values_within_a_hundredth_of_the_greater_one_are_one_plateau(size: float) -> None:
    assert len(plateau.groups([size, 0.9905 * size])) == 1 and len(plateau.groups([size, 0.989 * size])) == 2


def test_the_mean_is_that_over_the_way_and_not_over_the_steps() -> None:
    """A value counts over the step at whose end it is reached: 0.3 over a quarter of the way, 0.1 over another quarter in ten steps."""
    progress = np.concatenate([[0.0, 0.25, 0.5, 0.75], np.linspace(0.775, 1.0, 10)])
    values = np.concatenate([[9.0, 9.0, 0.5, 0.3], np.full(10, 0.1)])
    found = plateau.plateau_of(progress, values, 1.0, 0.1)
    assert (found.mean, found.change, found.scatter) == pytest.approx((0.2, 0.3, 0.0))


@pytest.mark.parametrize(("values", "expected"), [
    ([0.2], [[0]]),
    ([0.2, 0.2001], [[0, 1]]),
    ([0.2962, 0.2792, 0.29615], [[1], [2, 0]]),
    ([0.0, 1e-6, -1e-6], [[2, 0, 1]]),
])  # fmt: skip
def test_values_closer_than_a_hundredth_are_one_plateau(values: list[float], expected: list[list[int]]) -> None:
    assert plateau.groups(values) == expected


def test_paths_that_end_apart_are_told_as_several_plateaus(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first path is made to end 5 % higher than the others. A third path decides, and the uncertainty covers both values."""
    scene = scenes.build(*scenes.wall(4, 3, split=0.8), friction=0.6)
    assembly = assemble(scene)
    stiffness, associated = joint_stiffness(assembly, {}), solve_associated(assembly, Drive.YIELDING)
    whole = predict(assembly, stiffness, associated)
    original, made = prediction.follow, []

    def apart(*arguments: Any) -> Any:
        made.append(one := original(*arguments))
        assert one is not None
        return replace(one, plateau=replace(one.plateau, value=1.05 * one.plateau.value)) if len(made) == 1 else one

    monkeypatch.setattr(prediction, "follow", apart)
    several = predict(assembly, stiffness, associated, settings=PredictionSettings())
    assert len(several.viscosities) == 3
    assert several.plateaus == pytest.approx([whole.value, 1.05 * whole.value], rel=1e-3) and several.plateaus[0] == several.value
    assert several.value == pytest.approx(whole.value, rel=1e-3)
    assert several.uncertainty == pytest.approx(0.05 * whole.value, rel=0.05)
    assert several.status is Status.SOLVED


@pytest.mark.parametrize(("doubts", "is_left"), [
    ((1e-3, 9e-3), False),  # three times the doubt and more, but still known to 1 %
    ((1e-3, 2e-2), True),
    ((9e-3, 2.65e-2), False),  # less than three times the doubt
    ((9e-3, 2.75e-2), True),
    ((1e-3, np.nan), True),
])  # fmt: skip
def test_a_plateau_is_left_where_the_doubt_has_grown(doubts: tuple[float, float], is_left: bool) -> None:
    early, later = (plateau.Plateau(0.2, 0.2, 0.0 * doubt, doubt * 0.2, 1.0) for doubt in doubts)
    assert early.is_left_at(later) is is_left


@pytest.mark.parametrize("number", [pytest.param(159, marks=pytest.mark.slow), 134])
def test_a_plateau_that_the_curve_leaves_is_told(number: int) -> None:
    """The curves of two random walls are flat for four travels and more, then move by 2 %: 159 to no plateau, 134 to a better one."""
    scene = drawn(number, EARLIER_SEED).scene
    assembly = assemble(scene)
    stiffness, associated = joint_stiffness(assembly, {}), solve_associated(assembly, Drive.YIELDING)
    found, finer = (predict(assembly, stiffness, associated, settings=PredictionSettings(pair)) for pair in ((1e-2, 1e-3), (1e-3, 1e-4)))
    assert found.status is Status.SOLVED and found.certificate <= 1e-5
    assert len(found.plateaus) == 2 and abs(np.diff(found.plateaus)) > 0.015 * abs(found.value)
    assert found.plateaus[0] == found.value
    assert finer.value == pytest.approx(found.value, abs=found.uncertainty)
    assert finer.plateaus == pytest.approx(found.plateaus, rel=5e-3)
