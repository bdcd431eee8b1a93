"""The uncertainty that a prediction states, and the certificate of its limit state."""

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scenes
from coulomb_problems import PLATEAU, SCENES, answer, every_scene, great_wall, problem

from la_core.coulomb import (
    ACCEPTED_RESIDUAL,
    PredictionSettings,
    predict,
)
from la_core.coulomb.certificate import Certificate, certify
from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.quasi_static_path import Falling, QuasiStaticPath
from la_core.coulomb.path.rest import come_to_rest
from la_core.coulomb.path.tangent import Tangent
from la_core.coulomb.plateau import Plateau
from la_core.coulomb.several_paths import SAFETY, disagree, joints_of_path, on_one_plateau, stated_uncertainty
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive

FRICTIONS = (0.01, 0.1, 0.6, 5.0, 1000.0)


@pytest.mark.parametrize("mu", FRICTIONS)
@pytest.mark.parametrize("name", ["two_blocks", "stack_bond_wall"])
def test_columns_that_nothing_presses_weigh_what_they_weigh_whatever_the_friction(name, mu) -> None:
    """Statics: the head joints are unloaded, so half, or a third, of the weight rests on the settling base."""
    scene = scenes.shipped(name)
    assembly, stiffness = problem(scene)
    assembly = replace(assembly, points=replace(assembly.points, friction=np.full(len(assembly.points), mu)))
    solution = predict(assembly, stiffness, solve_associated(assembly, Drive.YIELDING))
    assert solution.status is Status.SOLVED
    assert solution.value / assembly.weight == pytest.approx({"two_blocks": 1.0 / 2.0, "stack_bond_wall": 1.0 / 3.0}[name], abs=1e-6)


@pytest.mark.slow_after_first
@pytest.mark.parametrize(("mu", "split"), [(0.3, 1.6), (0.6, 1.6), (0.6, 1.2), (0.8, 1.2)])
def test_stated_uncertainty_holds_against_finer_paths(mu, split) -> None:
    """The reference has a tenth of the viscosities and of the steps. All 128 walls: tests/benchmarks/benchmark_friction.py."""
    scene = great_wall(mu, split)
    assembly, solution = answer(scene)
    finer = PredictionSettings((1e-3, 1e-4), finer=10.0)
    reference = predict(assembly, problem(scene)[1], solve_associated(assembly, Drive.YIELDING), settings=finer)
    assert abs(solution.value - reference.value) <= solution.uncertainty <= PLATEAU * solution.value


def test_uncertainty_of_a_value_beyond_its_bound_reaches_to_the_bound() -> None:
    """A light post tips first, at b/h. This short path ends while drag still holds the post and the heavy block slides at mu."""
    grounds = (
        scenes.box("ground", (0.0, 0.0, -0.2), (1.0, 1.0, 0.0), "fixed"),
        scenes.box("other", (5.0, 0.0, -0.2), (6.0, 1.0, 0.0), "fixed"),
    )
    block = scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    post = scenes.box("post", (5.0, 0.0, 0.0), (5.1, 1.0, 0.3), density=0.2)
    assembly, stiffness = problem(scenes.build(*grounds, block, post, inset=0.001, live=(1.0, 0.0, 0.0)))
    bound = solve_associated(assembly, Drive.LIVE)
    assert bound.value == pytest.approx(0.098 / 0.3, rel=1e-4)
    solution = predict(assembly, stiffness, bound, settings=PredictionSettings(effort=2e3))
    assert solution.status is Status.INACCURATE and solution.value > 1.5 * bound.value
    assert solution.value - solution.uncertainty <= bound.value + 1e-12


@every_scene
def test_end_of_the_path_is_certified(name) -> None:
    _, solution = answer(SCENES[name]())
    assert solution.certificate <= ACCEPTED_RESIDUAL
    assert solution.uncertainty >= 0.0
    assert len(solution.path_value) == len(solution.path_settlement) > 10
    assert (np.diff(solution.path_settlement) > 0.0).all()
    assert solution.path_value[0] == pytest.approx(solution.at_rest)  # the curve is in newtons from rest to the plateau
    assert solution.path_value[-1] == pytest.approx(solution.value, rel=0.02)


def ended(value: float, worst: float) -> SimpleNamespace:
    """A made-up path that ends on a plateau of this value, with this largest residual."""
    certificate = SimpleNamespace(worst=worst)
    return SimpleNamespace(smooth_error=0.0, plateau=SimpleNamespace(value=value), end=SimpleNamespace(certificate=certificate))


@pytest.mark.parametrize(
    ("worst", "chosen"),
    [((1e-6, 1e-6), 1), ((1e-6, 1e-3), 0), ((1e-3, 1e-3), 1), ((math.nan, 1e-3), 1), ((1e-6, math.nan), 0)],
)
def test_the_answer_is_the_finest_path_that_ends_in_a_limit_state(worst: tuple[float, float], chosen: int) -> None:
    """An undefined residual proves no limit state."""
    paths = [ended(0.3, one) for one in worst]
    alike = on_one_plateau(paths)
    assert alike[0] is paths[chosen] and len(alike) == 2


@pytest.mark.parametrize(
    ("ends", "chosen"),
    [
        ([(0.3, 1e-6), (0.2, 1e-3)], [0]),
        ([(0.3, 1e-6), (0.2, math.nan)], [0]),
        ([(0.3, 1e-6), (0.2, 1e-6)], [1]),
        ([(0.3, 1e-3), (0.2, 1e-3)], [1]),
        ([(0.2, 1e-3), (0.3, 1e-6), (0.2, 1e-3)], [2, 0]),
        ([(0.2, 1e-6), (0.2, 1e-6), (0.2, 1e-3)], [1, 0, 2]),
        ([(0.3, 1e-6), (0.2, 1e-6), (0.2, 1e-6), (0.3, 1e-6)], [3, 0]),  # the finest path decides
        ([(0.3, 1e-6), (0.3, 1e-3), (0.2, 1e-3), (0.2, 1e-3)], [0, 1]),  # one of its two paths in a limit state is enough
    ],
)
def test_of_plateaus_with_as_many_paths_one_with_a_limit_state_counts(ends: list[tuple[float, float]], chosen: list[int]) -> None:
    """Where blocks turn, their order decides the axes of each path. It must not decide whether an answer exists."""
    paths = [ended(*end) for end in ends]
    assert on_one_plateau(paths) == [paths[i] for i in chosen]


def test_paths_with_smooth_joints_are_on_one_plateau_however_far_apart() -> None:
    """The smoothing causes their difference, not the structure."""
    paths = [ended(0.3, 1e-3), ended(0.2, 1e-6)]
    assert on_one_plateau(paths) == [paths[1]]
    for path in paths:
        path.smooth_error = 1e-4
    assert on_one_plateau(paths) == paths[::-1]


@pytest.mark.parametrize(("end", "mean"), [(0.303, 0.3), (0.3, 0.303)])
def test_what_paths_differ_by_at_their_end_or_on_their_way_is_uncertain(end: float, mean: float) -> None:
    """Both paths come to one plateau, without change or scatter."""
    coarse, fine = (SimpleNamespace(smooth_error=0.0, plateau=Plateau(*values, 0.0, 0.0, 1.0)) for values in ((end, mean), (0.3, 0.3)))
    assert stated_uncertainty(fine, [coarse, fine]) == pytest.approx(SAFETY * 0.003)


def test_of_paths_on_several_plateaus_the_farthest_from_the_answer_says_what_is_uncertain() -> None:
    low, chosen, high = (SimpleNamespace(smooth_error=0.0, plateau=Plateau(value, value, 0.0, 0.0, 1.0)) for value in (0.1, 0.2, 0.4))
    assert stated_uncertainty(chosen, [low, chosen, high]) == pytest.approx(0.2)
    assert stated_uncertainty(high, [low, chosen, high]) == pytest.approx(0.3)


def test_the_axes_of_a_coarse_path_turn_with_the_other_block_and_those_of_the_finest_do_not() -> None:
    other = object()
    joints: Any = SimpleNamespace(with_axes_of_first=lambda: other)
    settings = PredictionSettings(viscosities=(1e-1, 1e-2, 1e-3))
    assert [joints_of_path(joints, number, settings) for number in (1, 2, 3, 4)] == [other, other, joints, joints]


def test_of_three_paths_the_two_finest_say_what_is_uncertain() -> None:
    paths = [SimpleNamespace(smooth_error=0.0, plateau=Plateau(value, value, 0.0, 0.0, 1.0)) for value in (0.302, 0.3004, 0.3)]
    assert stated_uncertainty(paths[-1], paths) == pytest.approx(2.0 * 0.0004)


def test_paths_whose_mean_on_the_way_is_another_than_their_end_but_the_same_differ_in_nothing() -> None:
    paths = [SimpleNamespace(smooth_error=0.0, plateau=Plateau(0.3, 0.305, 0.0, 0.0, 1.0)) for _ in range(2)]
    assert stated_uncertainty(paths[1], paths) == pytest.approx(3e-4 * 0.3)


@pytest.mark.parametrize(("values", "apart"), [((0.3, 0.302), False), ((0.3, 0.2), True), ((0.3, 0.2, 0.302), True), ((0.3,), False)])
def test_paths_disagree_where_they_end_on_two_plateaus(values: tuple[float, ...], apart: bool) -> None:
    paths: Any = [ended(value, 1e-6) for value in values]
    assert disagree(paths) is apart


def test_paths_that_end_alike_are_as_uncertain_as_their_curve_and_their_steps() -> None:
    """Steps leave an uncertainty of 3e-4 of the value. A greater scatter of the curve counts in its place."""
    for scatter, left in ((0.0, 3e-4 * 0.3), (5e-5, 3e-4 * 0.3), (5e-3, 5e-3), (math.nan, 3e-4 * 0.3)):
        path = SimpleNamespace(smooth_error=0.0, plateau=Plateau(0.3, 0.3, 0.0, scatter, 1.0))
        assert stated_uncertainty(path, [path, path]) == pytest.approx(left)
    unknown = SimpleNamespace(smooth_error=0.0, plateau=Plateau(0.3, 0.3, math.nan, math.nan, 1.0))
    assert stated_uncertainty(unknown, [unknown, unknown]) == pytest.approx(3e-4 * 0.3)


@pytest.mark.parametrize(
    ("coarse", "reached", "law", "left"),
    [
        (0.306, 0.301, 0.002, 2.0 * 0.006),  # the paths differ by 0.006
        (0.3, 0.301, 0.002, 5.0 * 0.001),  # the limit state is 0.001 away from the end of the path
        (0.3, 0.301, 0.004, 2.0 * 0.004),  # the law of the joints is off by 0.004
    ],
)
def test_a_path_with_smooth_joints_is_uncertain_by_the_largest_of_what_its_smoothing_leaves(
    coarse: float, reached: float, law: float, left: float
) -> None:
    """The largest of twice the paths' difference, twice the law's error and five times the way to the limit state. Means do not count."""
    ends = ((coarse, 0.5), (0.3, 0.3))
    paths = [SimpleNamespace(smooth_error=law, plateau=Plateau(*end, 0.0, 0.0, 1.0), values=np.array([0.9, reached])) for end in ends]
    assert stated_uncertainty(paths[1], paths) == pytest.approx(left)


def test_of_three_paths_with_smooth_joints_the_two_sharpest_say_what_is_uncertain() -> None:
    ends = zip((0.32, 0.301, 0.3), (0.1, 0.2, 0.3), strict=True)
    paths = [SimpleNamespace(smooth_error=1e-9, plateau=Plateau(*end, 0.0, 0.0, 1.0), values=np.array([0.3])) for end in ends]
    assert stated_uncertainty(paths[-1], paths) == pytest.approx(2.0 * 0.001)


def test_a_curve_that_is_not_flat_may_still_change_by_three_times_its_last_change() -> None:
    """A flat curve may change by its last change. A larger scatter is the doubt of either."""
    assert Plateau(0.3, 0.3, 1e-4, 0.0, 1.0).doubt == 1e-4
    assert Plateau(0.3, 0.3, 1e-3, 0.0, 1.0).doubt == pytest.approx(3e-3)
    assert Plateau(0.3, 0.3, 1e-3, 5e-3, 1.0).doubt == 5e-3


def test_mechanism_that_is_not_the_states_own_fails_the_certificate() -> None:
    """A step across a jump, or a state in motion, is no limit state: its powers do not balance."""
    assembly, stiffness = problem(great_wall(0.6, 1.6))
    joints = ElasticJoints(assembly, stiffness)
    rest, _ = come_to_rest(joints, tangent := Tangent(joints))
    assert rest is not None
    path = QuasiStaticPath(joints, tangent, rest, Falling(1e-2, 1e-2, 1.0))
    for _ in path.advance_to(0.01):
        pass
    early = certify(joints, path.before, path.last)
    assert early.power > 100.0 * ACCEPTED_RESIDUAL and early.equilibrium > ACCEPTED_RESIDUAL  # strain still changes, the drag acts
    assert max(early.cone, early.parting, early.sliding) <= ACCEPTED_RESIDUAL  # the law of the joints holds in every state


BED = scenes.box("bed", (-1.0, 0.0, -0.1), (2.0, 0.5, 0.0), "fixed")
ETA = 0.05  # drag at unit rate over the weight: a viscosity five times the greatest of a prediction
BRAKED = {  # scene and exact value: a block pushed along a bed of friction 0.4; the column on a settling pad beside a fixed one
    "pushed": (lambda: scenes.build(BED, scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.5, 0.5)), friction=0.4, live=(1.0, 0.0, 0.0)), 0.4),
    "settling": (lambda: scenes.shipped("two_blocks"), 0.5),
}


@pytest.mark.parametrize("name", BRAKED)
def test_the_drag_is_taken_out_of_the_value_to_its_last_digits(name: str) -> None:
    """In a steady mechanism at unit rate the drag adds eta to a multiplier and takes eta times the moving share off a reaction."""
    make, exact = BRAKED[name]
    assembly, stiffness = problem(make())
    joints = ElasticJoints(assembly, stiffness)
    rest, _ = come_to_rest(joints, tangent := Tangent(joints))
    assert rest is not None
    *_, end = QuasiStaticPath(joints, tangent, rest, Falling(ETA, ETA, 1.0)).advance_to(1.0)
    assert end.value == pytest.approx(exact, abs=1e-6 * ETA)
    assert end.drag == pytest.approx(-ETA if assembly.has_live_load else 0.5 * ETA, abs=1e-6 * ETA)


@pytest.mark.parametrize("place", range(5))
def test_an_undefined_residual_certifies_nothing(place: int) -> None:
    residuals = [0.0] * 5
    residuals[place] = float("nan")
    assert np.isnan(Certificate(*residuals).worst)
