"""Blocks come to rest under gravity: a light stone under a heavy block stays in place where friction can pinch it."""

import math
from dataclasses import replace

import numpy as np
import pytest
import scenes
from coulomb_problems import FOUND, PLATEAU, problem

import la_core
from la_core.coulomb import predict, prediction
from la_core.coulomb.path import rest
from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.implicit_step import State, Target, Trial
from la_core.coulomb.path.rest import come_to_rest
from la_core.coulomb.path.tangent import Tangent
from la_core.coulomb.solution import without_answer
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.scene import Scene

FRICTION = 0.6
PINCHED_UP_TO = 2.0 * math.atan(FRICTION)  # rad: steepest slope at which friction pinches a weightless stone under a level roof


def pinched_stone(slope: float, friction: float = FRICTION) -> Scene:
    """The corner of a lower block is a separate stone on a slope (rad). The block above is pushed away from the stone."""
    across = 0.1
    down = across * math.tan(slope)
    lower = ((0.0, 0.0), (1.0, 0.0), (1.0, 0.5 - down), (1.0 - across, 0.5), (0.0, 0.5))
    stone = ((1.0, 0.5 - down), (1.0, 0.5), (1.0 - across, 0.5))
    parts = (
        scenes.box("ground", (-1.0, 0.0, -0.2), (2.0, 0.2, 0.0), "fixed"),
        scenes.block("lower", prism=(lower, (0.0, 0.2))),
        scenes.block("stone", prism=(stone, (0.0, 0.2))),
        scenes.box("upper", (0.0, 0.0, 0.5), (1.0, 0.2, 1.0)),
    )
    return scenes.build(*parts, friction=friction, inset=0.001, live=(-1.0, 0.0, 0.0), model="coulomb")


@pytest.mark.parametrize("slope", [20.0, 40.0, 50.0, 58.0])
def test_a_stone_that_friction_can_pinch_comes_to_rest(slope: float) -> None:
    """On a slope steeper than the friction angle (31 degrees) the stone slips unless the block above presses it at once."""
    assert math.radians(slope) < PINCHED_UP_TO
    joints = ElasticJoints(*problem(pinched_stone(math.radians(slope))))
    found, _ = come_to_rest(joints, Tangent(joints))
    assert found is not None and np.abs(found.blocks).max() < 3.0 * joints.sag


def test_a_stone_that_no_friction_can_pinch_has_no_equilibrium() -> None:
    assembly, _ = problem(pinched_stone(PINCHED_UP_TO + 0.1))
    assert solve_associated(assembly, Drive.LIVE).status is Status.INFEASIBLE


def test_joints_that_slide_on_the_way_to_rest_keep_the_trace_of_weights_that_grow() -> None:
    """A part of a dome: YADE finds 0.0627 W at any speed, damping and stiffness. All the weight at once would give 0.0632 W."""
    part = {
        "centre": [0.0, 0.0, 0.0], "radius": 2.4, "thickness": 0.436, "courses": 3, "lunes": 20, "embrace": 65.0, "oculus": 10.0,
        "sector": 90.0, "sides": "fixed", "support": [2, 2],
    }  # fmt: skip
    tables = {"stone": {"density": 2091}, "joint": {"friction": 0.943}, "dome": [part], "settlement": {"direction": [0.0, 0.0, -1.0]}}
    answer = la_core.solve(la_core.build(tables, "dome"))
    assert answer.coulomb / answer.scene.weight == pytest.approx(0.06274, rel=2e-3)


@pytest.mark.parametrize("drag", [1e-4, 1e-2])
def test_the_drag_of_growing_weights_does_not_decide(monkeypatch, drag: float) -> None:
    joints = ElasticJoints(*problem(pinched_stone(math.radians(50.0))))
    usual, _ = come_to_rest(joints, Tangent(joints))
    monkeypatch.setattr("la_core.coulomb.path.rest.GROWING_DRAG", drag)
    other, _ = come_to_rest(joints, Tangent(joints))
    assert usual is not None and other is not None
    assert np.abs(other.joints.force - usual.joints.force).max() < 0.05 * np.abs(usual.joints.force).max()


def test_the_push_on_blocks_over_a_pinched_stone_has_its_multiplier() -> None:
    """The upper block slides on its bed at mu, unless the stone gives way before; no state of equilibrium bears more than the bound."""
    assembly, stiffness = problem(pinched_stone(math.radians(50.0)))
    bound = solve_associated(assembly, Drive.LIVE)
    solution = predict(assembly, stiffness, bound)
    assert solution.status is Status.SOLVED
    assert solution.value <= bound.value + FOUND and solution.value == pytest.approx(bound.value, rel=PLATEAU)


@pytest.mark.parametrize(
    ("value", "uncertainty", "plateaus", "is_held_back"),
    [
        (-0.2, 1e-3, (), True),
        (-1e-4, 1e-3, (), False),
        (0.2, 1e-3, (), False),
        (0.2, 30.0, (0.2, -30.0), True),
        (0.2, 0.1, (0.2, 0.1, -1e-5), False),
    ],
)
def test_a_load_against_the_push_holds_back_what_falls(
    value: float, uncertainty: float, plateaus: tuple[float, ...], is_held_back: bool
) -> None:
    assembly, _ = problem(pinched_stone(math.radians(50.0)))
    solution = replace(without_answer(assembly, Status.SOLVED), value=value, uncertainty=uncertainty, plateaus=np.array(plateaus))
    assert bool(prediction._is_held_back(solution, 1.0)) is is_held_back


def test_a_block_that_a_dead_load_carries_off_once_it_fails_has_no_multiplier() -> None:
    """Pushed along y until it slides, the block moves along x. The path gave 0.338, above its bound of 0.300, or -83 to hold it back."""
    ground, block = scenes.box("ground", (-1.0, 0.0, -0.3), (5.0, 1.0, 0.0), "fixed"), scenes.box("dam", (0.0, 0.0, 0.0), (1.286, 1.0, 3.0))
    water = scenes.table("[load]", blocks=["dam"], at=(0.0, 0.5, 1.0), force=(44145.0, 0.0, 0.0))
    assembly, stiffness = problem(scenes.build(ground, block, water, friction=0.9, live=(0.0, 1.0, 0.0), plane=False))
    solution = predict(assembly, stiffness, solve_associated(assembly, Drive.LIVE))
    assert solution.status is Status.FAILED and math.isnan(solution.value) and math.isinf(solution.uncertainty)


def test_a_live_load_that_would_hold_blocks_back_has_no_value(monkeypatch) -> None:
    monkeypatch.setattr(prediction, "_is_held_back", lambda *_: True)
    assembly, stiffness = problem(pinched_stone(math.radians(50.0)))
    solution = predict(assembly, stiffness, solve_associated(assembly, Drive.LIVE))
    assert solution.status is Status.FAILED and math.isnan(solution.value) and math.isinf(solution.uncertainty)


def test_a_share_of_the_weights_scales_the_state() -> None:
    """Elastic joints with friction are laid without force, so that half of the weights causes half of all forces."""
    joints = ElasticJoints(*problem(pinched_stone(math.radians(20.0))))
    half, whole = (come_to_rest(one, Tangent(one))[0] for one in (joints.under(0.5), joints))
    assert half is not None and whole is not None
    assert half.joints.force == pytest.approx(0.5 * whole.joints.force, abs=1e-6)


def test_weights_that_grow_only_by_tiny_shares_end_the_search(monkeypatch) -> None:
    joints = ElasticJoints(*problem(pinched_stone(math.radians(50.0))))
    state, steps = State(0.0, np.zeros_like(joints.weights), joints.laid), []

    def stubborn(grown: ElasticJoints, tangent: Tangent, before: State, target: Target, drag: float, *others: object) -> Trial:
        steps.append(rest.GROWING_DRAG / joints.sag / drag)
        return Trial(before if steps[-1] < 1e-9 else None, 1)

    monkeypatch.setattr(rest, "advance", stubborn)
    assert rest._under_growing_weights(joints, Tangent(joints), state, 0.0) == (None, rest.MOST_GROWING_STEPS)
    assert len(steps) == rest.MOST_GROWING_STEPS and rest.SHORTEST_SHARE < min(steps) < 1e-9


def test_a_step_that_never_converges_is_shortened_only_so_far(monkeypatch) -> None:
    joints = ElasticJoints(*problem(pinched_stone(math.radians(50.0))))
    state = State(0.0, np.zeros_like(joints.weights), joints.laid)
    monkeypatch.setattr(rest, "advance", lambda *_: Trial(None, 7))
    found, iterations = come_to_rest(joints, Tangent(joints))
    assert found is None and 7 < iterations < 7 * 30
    assert rest.rest_from(joints, Tangent(joints), state, 0.0) == (None, 7 * rest.MOST_REST_STEPS)


def test_a_stone_that_slips_out_as_the_weights_grow_falls() -> None:
    """The slope is too steep for friction alone, and no block above pinches the stone."""
    ground = scenes.block("ground", "fixed", prism=(((-1.0, -0.2), (1.0, -0.2), (1.0, 0.0), (0.0, 1.0), (-1.0, 1.0)), (0.0, 0.2)))
    stone = scenes.block("stone", prism=(((0.5, 0.5), (1.0, 0.0), (1.0, 0.5)), (0.0, 0.2)))
    joints = ElasticJoints(*problem(scenes.build(ground, stone, friction=FRICTION, inset=0.001, live=(1.0, 0.0, 0.0), model="coulomb")))
    assert come_to_rest(joints, Tangent(joints))[0] is None


def test_a_tiny_share_of_the_weights_has_friction_as_the_whole() -> None:
    """The threshold of round-off shrinks with the weights. Otherwise no stone would be held while the weights are small."""
    joints = ElasticJoints(*problem(pinched_stone(math.radians(20.0))))
    found, _ = come_to_rest(joints, Tangent(joints))
    assert found is not None
    whole, share = joints.state(found.joints.displacement, joints.laid)[0].force, 1e-9
    small = joints.under(share).state(share * found.joints.displacement, joints.laid)[0].force
    assert np.abs(whole[:, 1]).max() > 0.0 and small == pytest.approx(share * whole, rel=1e-9, abs=1e-20)


@pytest.mark.parametrize("smoothing", [0.0375, 0.00375])
@pytest.mark.parametrize("slope", [20.0, 50.0, 58.0])
def test_a_stone_that_fell_is_not_at_rest_on_smooth_joints_either(slope: float, smoothing: float) -> None:
    """Smooth joints creep for ever, so that the last step does not show a fall. Large structures begin with smooth joints."""
    joints = ElasticJoints(*problem(pinched_stone(math.radians(slope))))
    found, _ = come_to_rest(joints, Tangent(joints), 0.0, smoothing)
    assert found is None or np.abs(found.blocks).max() < rest.FALLEN
    assert found is not None or slope > 20.0
