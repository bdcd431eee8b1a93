"""Laws of random structures: the laws of `test_laws.py` and others, checked on any number of structures and by independent solvers.

    python -m pytest tests/limit/test_random_laws.py --hypothesis-profile long     many scenes for each law
    python tests/benchmarks/random_laws_report.py -o comparison/gallery                 the same, counted

A law that fails prints the smallest scene on which it fails. Each such scene becomes a named test in `test_regressions.py`.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
import scenes
from hypothesis import assume, given
from independent_mechanics import (
    FACETS,
    RESIDUAL,
    VERDICTS,
    cone_residual,
    distance_from_equilibrium,
    drives,
    fastest_support,
    flow_residual,
    reaction,
    slack,
    unbalanced,
    value_slack,
    work,
)
from random_scenes import far_away, random_scenes

from la_core.coulomb import predict
from la_core.limit.associated import Solution, Status, solve_associated
from la_core.limit.conic import maximise
from la_core.limit.linearised import solve_linearised
from la_core.limit.problem import Drive, box_limits, scaled_problem
from la_core.limit.static import coulomb_limits, solve_static
from la_core.model.assembly import Assembly, assemble
from la_core.model.joints import joint_stiffness
from la_core.model.scaling import twists_of
from la_core.scene.scene import Scene

COULOMB_RESIDUAL = 1e-5  # residual that the Coulomb prediction allows
ROUNDING = 1e-9  # of the weight, or as a multiplier: sums of numbers of order one
UNDECIDED = 1e-6  # of the weight: least work at unit speed by which two solvers must agree that a structure falls
INTERVAL = 1e-5  # of the weight, or as a multiplier: equilibrium residual that the prediction allows
CIRCUMSCRIBED = 1.0 / np.cos(np.pi / FACETS)


def with_verdict(assembly: Assembly, drive: Drive) -> Solution:
    """The answer. A scene without a verdict is skipped; a law of its own counts it."""
    solution = solve_associated(assembly, drive)
    assume(solution.status in VERDICTS)
    return solution


# --- equilibrium, cones, flow rule -------------------------------------------------------------------------------------------


@given(scene=random_scenes())
def test_every_scene_gets_a_verdict(scene: Scene) -> None:
    """every scene is solved, infeasible or unbounded"""
    assembly = assemble(scene)
    for drive in drives(assembly):
        assert solve_associated(assembly, drive).status in VERDICTS


@given(scene=random_scenes())
def test_what_is_solved_is_in_equilibrium_within_the_cones_and_obeys_the_flow_rule(scene: Scene) -> None:
    """solved: equilibrium, friction cones and flow rule hold, recomputed"""
    assembly = assemble(scene)
    for drive in drives(assembly):
        solution = with_verdict(assembly, drive)
        assume(solution.status is Status.SOLVED)
        left = unbalanced(scene, assembly, solution.forces, solution.value if drive is Drive.LIVE else 0.0)
        assert np.abs(left).max() <= (RESIDUAL + ROUNDING) * assembly.mean_weight
        assert cone_residual(assembly, solution.forces) <= (RESIDUAL + ROUNDING) * assembly.mean_weight
        assert flow_residual(assembly, solution.twists) <= RESIDUAL + ROUNDING


# --- duality -----------------------------------------------------------------------------------------------------------------


@given(scene=random_scenes(settles=True))
def test_any_admissible_mechanism_bounds_any_admissible_forces(scene: Scene) -> None:
    """weak duality: mechanisms of more friction bound the reactions of all forces within less, on the right side"""
    frictions = (0.6 * scene.friction, scene.friction, 1.7 * scene.friction + 0.1)
    found = [[with_verdict(assemble(replace(scene, friction=mu)), drive) for drive in (Drive.YIELDING, Drive.PUSHING)] for mu in frictions]
    assembly = assemble(scene)
    mechanisms = [(s, drive) for both in found[1:] for s, drive in zip(both, (1.0, -1.0), strict=True) if s.status is Status.SOLVED]
    states = [s for both in found[:2] for s in both if s.status is Status.SOLVED]
    assume(mechanisms and states)
    for mechanism, sign in mechanisms:
        bound = sign * work(assembly, mechanism.twists)
        for state in states:
            beyond = sign * (bound - reaction(assembly, state.forces))
            assert beyond <= slack(assembly, mechanism.twists, state.forces)


@given(scene=random_scenes())
def test_kinematic_and_static_value_and_status_agree(scene: Scene) -> None:
    """strong duality: the static form by its own programme has the same value and status"""
    assembly = assemble(scene)
    for drive in drives(assembly):
        kinematic, static = with_verdict(assembly, drive), solve_static(assembly, drive, *coulomb_limits(assembly))
        assume(static.status in VERDICTS)
        if kinematic.status is Status.INFEASIBLE and drive is Drive.LIVE:
            continue  # the static form looks for any multiplier, also for one that is needed to hold the structure up
        assert kinematic.status == static.status
        if kinematic.status is Status.SOLVED:
            assert abs(kinematic.value - static.value) <= value_slack(assembly, drive, kinematic, static)


@given(scene=random_scenes())
def test_highs_agrees_in_the_plane_and_brackets_the_answer_in_space(scene: Scene) -> None:
    """HiGHS: same value and status in the plane, pyramids bracket both in space"""
    assembly = assemble(scene)
    for drive in drives(assembly):
        conic = with_verdict(assembly, drive)
        inside, outside = (solve_linearised(assembly, drive, FACETS, inscribed) for inscribed in (True, False))
        assume(inside.status in VERDICTS and outside.status in VERDICTS)
        if assembly.effects.plane:
            assert conic.status == inside.status == outside.status
        if conic.status is Status.INFEASIBLE:
            assert inside.status is Status.INFEASIBLE
        if outside.status is Status.INFEASIBLE:
            assert conic.status is Status.INFEASIBLE
        if {conic.status, inside.status, outside.status} == {Status.SOLVED}:
            tolerance = value_slack(assembly, drive, conic, inside) + value_slack(assembly, drive, conic, outside)
            low, high = (outside.value, inside.value) if drive is Drive.YIELDING else (inside.value, outside.value)
            assert low - tolerance <= conic.value <= high + tolerance


# --- structures that cannot stand --------------------------------------------------------------------------------------------


def _part_sinks(assembly: Assembly, block: int, twist: np.ndarray) -> bool:
    blocks = assembly.blocks
    corners = blocks.vertices[blocks.vertex_block == block]
    return any((twist[:3] + np.cross(twist[3:], corner - blocks.centroid[block])) @ assembly.down > 0.0 for corner in corners)


@given(scene=random_scenes())
def test_what_is_called_infeasible_falls(scene: Scene) -> None:
    """infeasible: weights do work on an admissible motion, all named blocks sink, at least in part, and HiGHS finds no equilibrium"""
    assembly = assemble(scene)
    solution = with_verdict(assembly, drives(assembly)[0])
    assume(solution.status is Status.INFEASIBLE)
    problem = scaled_problem(assembly)
    motion = twists_of(assembly, maximise(problem.power, *box_limits(problem)).x)
    assert not motion[~assembly.blocks.free].any()
    assert flow_residual(assembly, motion) <= RESIDUAL
    share = work(assembly, motion) / assembly.weight
    assert share > 0.0
    power = np.sum(assembly.dead_load * motion, axis=1)
    sinking = {name for k, name in enumerate(scene.blocks.names) if power[k] > 0.0 or _part_sinks(assembly, k, motion[k])}
    assert solution.falling and set(solution.falling) <= sinking
    most = distance_from_equilibrium(scene, assembly, 1.0)
    least = most if assembly.effects.plane else distance_from_equilibrium(scene, assembly, CIRCUMSCRIBED)
    assert least - UNDECIDED <= share <= most + UNDECIDED


@given(scene=random_scenes())
def test_what_is_not_called_infeasible_can_stand(scene: Scene) -> None:
    """solved or unbounded: HiGHS finds an equilibrium under the weights alone"""
    assembly = assemble(scene)
    assume(all(with_verdict(assembly, drive).status is not Status.INFEASIBLE for drive in drives(assembly)))
    assert distance_from_equilibrium(scene, assembly, CIRCUMSCRIBED) <= UNDECIDED


@given(scene=random_scenes(settles=True))
def test_no_status_depends_on_the_drive_where_nothing_stands(scene: Scene) -> None:
    """infeasible for one bound is infeasible for the other"""
    assembly = assemble(scene)
    statuses = [with_verdict(assembly, drive).status for drive in drives(assembly)]
    assert len({status is Status.INFEASIBLE for status in statuses}) == 1


# --- friction that does not dilate -------------------------------------------------------------------------------------------


@given(scene=random_scenes())
def test_coulomb_prediction_lies_between_the_bounds_and_within_its_interval(scene: Scene) -> None:
    """R_min <= R of Coulomb friction <= R_max, and R within its mechanism's interval"""
    assembly = assemble(scene)
    bounds = [with_verdict(assembly, drive) for drive in drives(assembly)]
    assume(bounds[0].status is Status.SOLVED)
    prediction = predict(assembly, joint_stiffness(assembly, {}), bounds[0])
    assume(prediction.status is Status.SOLVED)
    live = assembly.has_live_load
    for bound, sign in zip(bounds, (-1.0,) if live else (1.0, -1.0), strict=True):
        if bound.status is Status.SOLVED:
            assert sign * (bound.value - prediction.value) <= slack(assembly, bound.twists, prediction.forces, COULOMB_RESIDUAL)
    unit = 1.0 if live else assembly.weight * fastest_support(assembly)
    low, high = prediction.interval
    assert math.isnan(low) or low - INTERVAL * unit <= prediction.value <= high + INTERVAL * unit  # NaN: not stated


# --- the same structure, described differently -------------------------------------------------------------------------------


def assert_same_answers(first: Scene, second: Scene) -> None:
    """Assert equal statuses, and equal values over weight and speed of the support, within the residuals of both answers."""
    one, other = assemble(first), assemble(second)
    for drive in drives(one):
        answers = [with_verdict(assembly, drive) for assembly in (one, other)]
        assert answers[0].status == answers[1].status
        if answers[0].status is Status.SOLVED:
            units = [1.0 if drive is Drive.LIVE else a.weight * fastest_support(a) for a in (one, other)]
            open_ends = [value_slack(a, drive, s, s) / unit for a, s, unit in zip((one, other), answers, units, strict=True)]
            assert answers[0].value / units[0] == pytest.approx(answers[1].value / units[1], abs=sum(open_ends) + ROUNDING)


def turn(plane: bool) -> np.ndarray:
    """Any turn, about y alone in the plane."""
    return scenes.rotation((0.0, 1.0, 0.0) if plane else (0.3, -0.5, 0.8), 1.1)


def told(scene: Scene, **changes: object) -> Scene:
    return scenes.moved(scene, plane=bool(scene.effects.plane), **changes)  # type: ignore[arg-type]


@given(scene=random_scenes())
def test_a_moved_structure_has_the_same_answer(scene: Scene) -> None:
    """invariance: turned and shifted"""
    assert_same_answers(scene, told(scene, turn=turn(bool(scene.effects.plane)), shift=(3.0, 0.0 if scene.effects.plane else -2.0, 5.0)))


@given(scene=random_scenes())
def test_a_mirrored_structure_has_the_same_answer(scene: Scene) -> None:
    """invariance: mirrored"""
    assert_same_answers(scene, told(scene, turn=np.diag([-1.0, 1.0, 1.0])))


@given(scene=random_scenes())
def test_units_do_not_matter(scene: Scene) -> None:
    """invariance: in mm and km, light and heavy"""
    for scale, density in ((1e3, 1e-3), (1e-3, 1e3)):
        assert_same_answers(scene, told(scene, scale=scale, density=density))


@given(scene=random_scenes())
def test_order_of_blocks_does_not_matter(scene: Scene) -> None:
    """invariance: blocks in another order"""
    assert_same_answers(scene, told(scene, order=np.random.default_rng(1).permutation(len(scene.blocks))))


@given(scene=random_scenes())
def test_a_fixed_block_far_away_changes_nothing(scene: Scene) -> None:
    """fixed blocks far away change nothing"""
    assert_same_answers(scene, far_away(scene))


@given(scene=random_scenes())
def test_answers_are_proportional_to_gravity(scene: Scene) -> None:
    """reactions grow with gravity, multipliers do not"""
    assert_same_answers(scene, replace(scene, gravity=7.0 * scene.gravity))


# --- monotony ----------------------------------------------------------------------------------------------------------------


@given(scene=random_scenes())
def test_more_friction_widens_the_interval_and_lets_nothing_fall(scene: Scene) -> None:
    """more friction: R_min no larger, R_max and multiplier no smaller, and what stood stands"""
    less, more = assemble(scene), assemble(replace(scene, friction=1.3 * scene.friction + 0.01))
    for drive in drives(less):
        before, after = with_verdict(less, drive), with_verdict(more, drive)
        assume(before.status is not Status.INFEASIBLE)
        assert after.status is not Status.INFEASIBLE
        if before.status is Status.UNBOUNDED:
            assert after.status is Status.UNBOUNDED
        elif after.status is Status.SOLVED:
            sign = 1.0 if drive is Drive.YIELDING else -1.0
            tolerance = slack(less, after.twists, before.forces) + 2.0 * RESIDUAL * (
                1.0 if drive is Drive.LIVE else less.mean_weight * fastest_support(less)
            )
            assert sign * (after.value - before.value) <= tolerance
