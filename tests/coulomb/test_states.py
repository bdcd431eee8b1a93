"""States at the end of a prediction: equilibrium, cones, no dilation, the balance of work, and the interval of their mechanism."""

import itertools
import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scenes
from coulomb_problems import (
    DIGIT,
    FOUND,
    PLATEAU,
    SCENES,
    STRAIN,
    answer,
    bounds,
    every_scene,
    great_wall,
    small_wall,
    unit,
    value,
)

import la_core
from la_core.coulomb import (
    ACCEPTED_RESIDUAL,
    interval,
)
from la_core.limit import ProgrammeOutcome
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.measures import residuals

NO_DILATION = 0.02  # of the support's speed: elastic strain rate at loaded sliding joints; associated flow would part at mu |u_t|
BALANCE = 2e-2  # of the input: elastic energy that the last step still stores, and the dilation that is left
DRIVES = {
    "up": (0.0, 0.0, 1.0),
    "out": (1.0, 0.0, 0.0),
    "in": (-1.0, 0.0, 0.0),
    "askew": (0.4, 0.0, -1.0),
}


@every_scene
def test_state_is_in_equilibrium_and_within_the_cone(name) -> None:
    assembly, solution = answer(SCENES[name]())
    multiplier = solution.value if assembly.has_live_load else 0.0
    assert residuals.equilibrium_residual(assembly, solution.forces, multiplier) == solution.equilibrium_residual <= ACCEPTED_RESIDUAL
    assert residuals.cone_violation(assembly, solution.forces) == solution.cone_violation <= ACCEPTED_RESIDUAL
    reaction = residuals.multiplier(assembly, solution.forces) if assembly.has_live_load else residuals.reaction(assembly, solution.forces)
    assert solution.value == pytest.approx(reaction, abs=FOUND * unit(assembly))


@every_scene
def test_value_lies_between_the_associated_bounds_and_within_its_interval(name) -> None:
    assembly, solution = answer(SCENES[name]())
    near = STRAIN * unit(assembly)
    if assembly.has_live_load:
        assert solution.value <= solve_associated(assembly, Drive.LIVE).value + near
    else:
        least, greatest = (solve_associated(assembly, drive) for drive in (Drive.YIELDING, Drive.PUSHING))
        assert least.value - near <= solution.value
        if greatest.status is Status.SOLVED:
            assert solution.value <= greatest.value + near
    low, high = solution.interval
    assert low <= high + near and low - near <= solution.value <= high + near


@pytest.mark.parametrize("drive", DRIVES)
def test_support_may_move_anywhere(drive) -> None:
    assembly, solution = answer(small_wall(settlement=DRIVES[drive]))
    assert solve_associated(assembly, Drive.YIELDING).value <= solution.value + FOUND * assembly.weight


@pytest.mark.parametrize(("axis", "point"), [((0.0, 1.0, 0.0), (1.2, 0.0, 0.0)), ((1.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
                                             ((0.0, 0.0, 1.0), (1.6, 0.15, 0.0)), ((0.0, 1.0, 0.2), (0.9, 0.0, -0.4))])  # fmt: skip
def test_support_may_turn_about_any_axis(axis, point) -> None:
    assembly, solution = answer(small_wall(settlement={"axis": axis, "point": point}, plane=False))
    low, high = solution.interval
    associated, near = solve_associated(assembly, Drive.YIELDING).value, STRAIN * assembly.weight
    assert associated - near <= solution.value
    assert math.isnan(low) or low - near <= solution.value <= high + near  # unknown where its ends move with the threshold


def test_far_axis_is_a_translation() -> None:
    far = 1e4
    assembly, solution = answer(small_wall(settlement={"axis": (0.0, 1.0, 0.0), "point": (-far, 0.0, 0.0)}))
    assert solution.value / (assembly.weight * far) == pytest.approx(value(small_wall()), rel=PLATEAU)


@pytest.mark.parametrize("name", ["wall", "crossing beams", "live load"])
def test_mechanism_does_not_dilate(name) -> None:
    """Loaded points that slide open only elastically. In the associated mechanism they open at mu |u_t|."""
    assembly, solution = answer(SCENES[name]())
    associated = solve_associated(assembly, Drive.LIVE if assembly.has_live_load else Drive.YIELDING)

    def opening(twists: np.ndarray, forces: np.ndarray) -> float:
        """Greatest opening rate of points that slide under load, over the greatest sliding rate."""
        velocity = assembly.relative_velocity(twists)
        parting = np.sum(velocity * assembly.normal, axis=1)
        slip = np.linalg.norm(velocity - parting[:, None] * assembly.normal, axis=1)
        loaded = np.sum(forces * assembly.normal, axis=1) > 0.01 * assembly.mean_weight
        sliding = loaded & (slip > 0.1 * slip.max())
        return float(np.abs(parting[sliding]).max() / slip.max()) if sliding.any() else 0.0

    assert opening(solution.twists, solution.forces) < NO_DILATION
    assert opening(associated.twists, associated.forces) > 3.0 * NO_DILATION


@pytest.mark.parametrize("name", ["wall", "crossing beams", "live load"])
def test_work_of_the_weights_goes_into_the_support_and_friction(name) -> None:
    """The work of the weights and the live load is the work taken by the support plus the dissipation by friction."""
    assembly, solution = answer(SCENES[name]())
    velocity = assembly.relative_velocity(solution.twists)
    slip = velocity - np.sum(velocity * assembly.normal, axis=1)[:, None] * assembly.normal
    dissipated = -float(np.sum(solution.forces * slip))
    weights = float(np.sum(assembly.dead_load * solution.twists))
    put_in = weights + solution.value * float(np.sum(assembly.live_load * solution.twists))
    taken = 0.0 if assembly.has_live_load else solution.value
    assert dissipated > 0.0
    scale = abs(weights) + abs(solution.value)
    assert put_in - taken == pytest.approx(dissipated, abs=BALANCE * scale)
    tangential = np.linalg.norm(solution.forces - np.sum(solution.forces * assembly.normal, axis=1)[:, None] * assembly.normal, axis=1)
    assert dissipated <= float(np.sum(tangential * np.linalg.norm(slip, axis=1))) + FOUND * scale


@pytest.mark.slow_after_first
@pytest.mark.parametrize("threshold", [0.01, 0.03, 0.1])
@pytest.mark.parametrize(
    ("mu", "split", "expected"), [(0.6, 1.6, (0.0613, 0.0833)), (0.6, 1.2, (0.1287, 0.1750)), (0.3, 1.6, (0.0765, 0.0833))]
)
def test_interval_does_not_depend_on_the_threshold_within_a_decade(mu, split, expected, threshold, monkeypatch) -> None:
    monkeypatch.setattr(interval, "THRESHOLDS", (threshold, threshold))
    assert bounds(great_wall(mu, split)) == pytest.approx(expected, abs=DIGIT)


@pytest.mark.parametrize("plane", [True, False], ids=["plane", "3D"])
def test_interval_of_a_plane_wall_is_the_same_in_3d(plane) -> None:
    assert bounds(great_wall(0.6, 1.6, plane)) == pytest.approx((0.0613, 0.0833), abs=DIGIT)


def test_the_width_of_an_interval_is_over_the_value_or_over_a_thousandth_of_the_weight() -> None:
    assert interval.relative_width((270.0, 300.0), 280.0, 1000.0) == pytest.approx(30.0 / 280.0)
    assert interval.relative_width((-300.0, -270.0), -280.0, 1000.0) == pytest.approx(30.0 / 280.0)
    assert interval.relative_width((0.0, 0.5), 0.1, 1000.0) == pytest.approx(0.5)


@pytest.mark.parametrize("live", [False, True], ids=["settlement", "live load"])
@pytest.mark.parametrize("side", [0, 1], ids=["low", "high"])
def test_an_end_that_nothing_limits_is_infinite_on_its_own_side(side: int, live: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """A programme without an admissible velocity does not limit its end. The other end keeps its value."""
    given: dict[str, Any] = {"settlement": None, "live": (1.0, 0.0, 0.0)} if live else {}
    scene = scenes.build(*scenes.wall(4, 3, split=None if live else 0.8), friction=0.6, **given)
    _, usual = answer(scene)
    original, calls = interval.optimum, itertools.count()

    def optimum(*arguments: Any) -> Any:
        found = original(*arguments)
        return replace(found, outcome=ProgrammeOutcome.EMPTY) if next(calls) % 2 == side else found

    monkeypatch.setattr(interval, "optimum", optimum)
    _, other = answer(scene)
    assert other.interval[side] == (-math.inf, math.inf)[side]
    assert other.interval[1 - side] == pytest.approx(usual.interval[1 - side]) and math.isfinite(usual.interval[1 - side])


@pytest.mark.parametrize(
    ("ends", "stated"),
    [
        ([(0.9, 1.2), (0.9, 1.2), (0.9, 1.2)], (0.9, 1.2)),
        ([(0.9, math.inf), (0.9, math.inf), (0.9, math.inf)], (0.9, math.inf)),
        ([(0.9, 1.2), (0.9, 1.22), (0.9, 1.2)], None),  # it moves with the threshold
        ([(0.9, 1.2), (0.9, 1.2), (0.88, 1.2)], None),  # it moves with the mechanism
        ([(1.1, 1.2), (1.1, 1.2), (1.1, 1.2)], None),  # it does not contain the value, 1.0
    ],
)
def test_an_interval_that_is_not_sure_is_not_stated(
    ends: list[tuple[float, float]], stated: tuple[float, float] | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """ends: by both thresholds for the first of two mechanisms, then for the second; they may differ by 1 % of the value."""
    found = iter(ends)
    monkeypatch.setattr(interval, "joint_rates", lambda *_: None)
    monkeypatch.setattr(interval, "reaction_interval", lambda *_: next(found))
    state: Any = SimpleNamespace(joints=None)
    joints: Any = SimpleNamespace(value_in_units=lambda scaled: scaled)
    low, high = interval.stated_interval(joints, [(state, state), (state, state)], 1.0, 0.01)
    assert (low, high) == stated if stated else math.isnan(low) and math.isnan(high)


@pytest.mark.parametrize("mu", [0.2, 0.6])
def test_interval_of_a_reaction_of_zero_is_stated_although_its_ends_are_rounded(mu: float) -> None:
    """A block that hangs in a dovetail stays when the pad below it leaves. Every history of friction gives a reaction of 0."""
    slot = [[-1, 0], [-0.2, 0], [-0.4, 0.5], [0.4, 0.5], [0.2, 0], [1, 0], [1, 1], [-1, 1]]
    tail = [[-0.2, -1], [0.2, -1], [0.2, 0], [0.4, 0.5], [-0.4, 0.5], [-0.2, 0]]
    bodies = [
        scenes.block(name, role, prism=(profile, (0.0, 0.5))) for name, role, profile in (("slot", "fixed", slot), ("tail", "free", tail))
    ]
    pad = scenes.box("pad", (-0.2, 0.0, -1.5), (0.2, 0.5, -1.0), "support")
    hung = la_core.solve(scenes.build(*bodies, pad, friction=mu, model="coulomb"))
    low, high = hung.interval
    assert low <= high
    assert [hung.coulomb, low, high] == pytest.approx([0.0] * 3, abs=1e-6 * hung.scene.weight)
