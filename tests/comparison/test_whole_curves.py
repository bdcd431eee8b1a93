"""The curves of both methods are compared up to the end of the shorter one."""

import dataclasses
import math
import warnings

import numpy as np
import pytest
import scenes
from judged_runs import coulomb_of, judged
from runs import coulomb_run, made_up_run

import la_core
from comparison.figures.reaction_levels import curve_of
from comparison.judge.checks.curves import compare_curves
from comparison.verdict.check import Verdict, overall
from comparison.yade import Results
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse


@pytest.fixture(scope="module")
def wall() -> LimitAnalysis:
    """A wall whose joints slide."""
    return analyse(scenes.shipped("wall_third"))


def test_whole_curves_are_compared_where_both_exist(wall: LimitAnalysis) -> None:
    coulomb = coulomb_of(wall)
    settlement = np.linspace(0.0, coulomb.path_settlement[-1] * 0.8, 300)
    reaction = np.interp(settlement, coulomb.path_settlement, coulomb.path_value)
    bump = np.exp(-(((settlement - settlement[100]) / settlement[5]) ** 2))
    record = {"stage": np.ones(300, dtype=int), "settlement": settlement, "reaction": reaction + 50.0 * bump}
    run = dataclasses.replace(coulomb_run(wall), record=made_up_run(record=record).record)
    found = compare_curves(Results(wall, run))
    assert found is not None
    assert found.largest == pytest.approx(50.0) and found.settlement == pytest.approx(settlement[100])
    assert found.until == pytest.approx(settlement[-1])
    assert found.mean == pytest.approx(float(50.0 * np.mean(bump)), rel=0.01)
    assert overall(judged(wall, run))[0] is Verdict.AGREE  # the verdict rests on the plateaus


def test_a_path_is_put_to_the_stiffness_of_yades_joints(wall: LimitAnalysis) -> None:
    coulomb, stiffer = coulomb_of(wall), 4.0
    settlement = np.linspace(0.0, coulomb.path_settlement[-1] / stiffer, 200)
    reaction = np.interp(stiffer * settlement, coulomb.path_settlement, coulomb.path_value)
    record = {"stage": np.ones(200, dtype=int), "settlement": settlement, "reaction": reaction}
    settings = {"normal_stiffness": stiffer * wall.stiffness.normal}
    run = dataclasses.replace(coulomb_run(wall), record=made_up_run(record=record).record, settings=settings)
    found = compare_curves(Results(wall, run))
    assert found is not None
    assert found.largest <= 1e-9 * coulomb.value and found.until == pytest.approx(settlement[-1])


@pytest.mark.parametrize(("own", "prediction", "path"), [(False, 8.0, 2.0), (True, 2.0, 2.0)], ids=["derived", "given"])
def test_a_path_with_finite_rotations_is_put_to_where_yades_joints_have_released_as_much(
    wall: LimitAnalysis, own: bool, prediction: float, path: float
) -> None:
    """A release's settlement grows with the root of the sag. The prediction is for joints 16 times as stiff, unless the scene sets them."""
    effects = wall.assembly.effects.with_effect("rotation", "finite", "")
    scene = la_core.variant(wall.scene, {"yade.normal_stiffness": wall.stiffness.normal}) if own else wall.scene
    turning = dataclasses.replace(wall.with_effects(effects), scene=scene)
    run = dataclasses.replace(coulomb_run(wall), settings={"normal_stiffness": 4.0 * wall.stiffness.normal})
    results = Results(turning, run)
    assert (results.prediction_scale, results.path_scale) == pytest.approx((prediction, path))
    assert (Results(wall, run).prediction_scale, Results(wall, run).path_scale) == (4.0, 4.0)


def test_curves_are_compared_as_far_as_both_go_and_not_at_all_without_one(wall: LimitAnalysis) -> None:
    coulomb = coulomb_of(wall)
    beyond = np.linspace(0.0, 2.0 * coulomb.path_settlement[-1], 50)
    record = {"stage": np.ones(50, dtype=int), "settlement": beyond, "reaction": np.full(50, coulomb.value)}
    run = dataclasses.replace(coulomb_run(wall), record=made_up_run(record=record).record)
    found = compare_curves(Results(wall, run))
    assert found is not None and found.until <= coulomb.path_settlement[-1]
    assert compare_curves(Results(wall, made_up_run())) is None and compare_curves(Results(wall)) is None
    arch = analyse(scenes.shipped("arch_spreading"))
    assert compare_curves(Results(arch, coulomb_run(arch))) is None  # no joint slides: no path was followed
    assert math.isfinite(found.largest)


@pytest.mark.parametrize("stiffness", [0.0, math.nan])
def test_curves_are_not_compared_where_yades_stiffness_is_undefined(wall: LimitAnalysis, stiffness: float) -> None:
    """In a damaged record the path cannot be scaled to the run's settlements. No warning of a division reaches the user."""
    run = dataclasses.replace(coulomb_run(wall), settings={"normal_stiffness": stiffness})
    results = Results(wall, run)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert math.isnan(results.stiffening) and compare_curves(results) is None
        assert [len(part) for part in curve_of(results, 1e-3)] == [0, 0]
