"""The report states a live load that exceeds its plateau on the way there, by both methods. This load has no part in the verdict."""

from dataclasses import replace

import numpy as np
import pytest
import scenes
from runs import made_up_run

from comparison.judge import greatest_load_summary
from comparison.judge.greatest_load import _of_curve, _of_peak
from comparison.report.plain_words import angle_words
from comparison.yade import Results
from la_core.analysis import analyse
from la_core.analysis.result import LimitAnalysis
from la_core.limit import Status
from la_core.limit.problem import Drive


def pushed(**changes: object) -> LimitAnalysis:
    """Return the analysis of a pushed block on a fixed base; `changes` replaces numbers of its prediction."""
    scene = scenes.build(
        scenes.box("base", (0.0, 0.0, -0.2), (1.0, 0.3, 0.0), "fixed"),
        scenes.box("block", (0.2, 0.0, 0.0), (0.6, 0.3, 0.4)),
        friction=0.3,
        live=(1.0, 0.0, 0.0),
        model="coulomb",
    )
    analysis = analyse(scene)
    assert analysis.coulomb is not None
    answers = replace(analysis.at_inset, coulomb=replace(analysis.coulomb, **changes))
    return replace(analysis, at_inset=answers)


def test_a_curve_that_rises_to_its_plateau_has_no_greater_load() -> None:
    analysis = pushed()
    assert analysis.coulomb is not None and len(analysis.coulomb.path_value)
    assert greatest_load_summary(Results(analysis)) is None


@pytest.mark.parametrize(("greatest", "told"), [(0.28, 0.28), (0.2, None), (0.208, None), (5.0, None)])
def test_a_greater_load_on_the_way_is_told_up_to_the_bound(greatest: float, told: float | None) -> None:
    """The plateau is 0.2. Drag may add 4 %, and no state above the bound of 0.3 is in equilibrium."""
    analysis = pushed(value=0.2, uncertainty=1e-4, path_settlement=np.array([0.0, 1e-4, 1e-3]), path_value=np.array([0.0, greatest, 0.2]))
    found = greatest_load_summary(Results(analysis))
    if told is None:
        assert found is None
        return
    assert found is not None and found["limit_analysis"] == pytest.approx(told, rel=1e-3) and "yade" not in found
    assert f"rose to about {told:.3f} in limit analysis. Under a load that only grows" in found["words"]


def test_a_load_after_the_plateau_is_not_on_the_way_to_it() -> None:
    """The curve first reaches the plateau of 0.2, and rises to 0.28 when blocks meet."""
    curve = {"path_settlement": np.linspace(0.0, 1e-3, 5), "path_value": np.array([0.0, 0.2, 0.2, 0.25, 0.28])}
    assert greatest_load_summary(Results(pushed(value=0.2, uncertainty=1e-4, **curve))) is None
    curve["path_value"] = np.array([0.0, 0.24, 0.2, 0.25, 0.28])
    found = greatest_load_summary(Results(pushed(value=0.2, uncertainty=1e-4, **curve)))
    assert found is not None and found["limit_analysis"] == 0.24


@pytest.mark.parametrize(("at_most", "is_told"), [(0.2, False), (0.25, True)])
def test_the_greatest_load_of_yade_is_told_beside_that_of_limit_analysis_alone(at_most: float, is_told: bool) -> None:
    """The inertia of blocks that gain speed lifts YADE's record, so its greatest load alone proves nothing."""
    way = {"path_settlement": np.linspace(0.0, 1e-3, 3), "path_value": np.array([0.0, at_most, 0.2])}
    analysis = pushed(value=0.2, uncertainty=1e-4, **way)
    record = {"stage": np.ones(4, dtype=int), "settlement": np.linspace(0.0, 1e-3, 4), "reaction": np.array([0.0, 0.26, 0.21, 0.2])}
    run = made_up_run({"status": "plateau", "reaction": 0.2, "uncertainty": 0.002}, record)
    found = greatest_load_summary(Results(analysis, run))
    assert (found is not None) is is_told
    if found is not None:
        assert found["limit_analysis"] == at_most and found["yade"] == 0.26


def test_a_structure_of_five_blocks_stands_at_more_than_its_plateau() -> None:
    """An independent model of contacts, under a growing load, is at rest at 0.240 and 0.245. It falls from a load of 0.250 to 0.255 on."""
    right, height, depth = 1.078, 1.0793, 0.5715
    edges = ((0.0, 0.539, 257.0), (0.539, right, 2062.0), (0.0, 0.2148, 547.0), (0.2148, 0.7538, 1419.0), (0.7538, right, 4967.0))
    parts = [
        scenes.box(f"b{k}", (left, 0.0, height * (k > 1)), (end, depth, height * (1 + (k > 1))), density=density)
        for k, (left, end, density) in enumerate(edges)
    ]
    ground = (-0.2, 0.4578, 0.7618, 0.8303, 1.278)
    parts += [scenes.box(f"g{k}", (ground[k], 0.0, -0.3), (ground[k + 1], depth, 0.0), "fixed") for k in range(4)]
    parts.append(scenes.table("[friction]", between=["b3", "b2"], friction=0.4862))
    analysis = analyse(scenes.build(*parts, friction=0.4923, inset=0.001, live=(-1.0, 0.0, 0.0), model="auto"))
    found = greatest_load_summary(Results(analysis))
    assert analysis.coulomb is not None and analysis.coulomb.value == pytest.approx(0.197, rel=0.01)
    assert found is not None and 0.245 < found["limit_analysis"] < 0.255
    peak, stated = analysis.coulomb.peak
    assert found["limit_analysis"] == peak and found["limit_analysis_uncertainty"] == stated
    assert 0.0 < stated < 0.002 and peak - stated > 0.245 and peak + stated < 0.250
    assert f"rose to {peak:.4f} ± {stated:.4f} in limit analysis. By limit analysis the structure stands up to there" in found["words"]


@pytest.mark.parametrize(("peak", "told"), [(0.2025, None), (0.205, 0.205), (0.3005, 0.3), (0.302, None)])
def test_a_peak_with_its_uncertainty_is_told_from_one_per_cent_on_and_is_not_above_the_bound(peak: float, told: float | None) -> None:
    """The plateau is 0.2 and the bound 0.3. A peak of 0.3005 ± 0.001 may be at the bound."""
    analysis = pushed(value=0.2, uncertainty=1e-4, peak=np.array([peak, 0.001]))
    found = greatest_load_summary(Results(analysis))
    assert (found and found["limit_analysis"]) == (None if told is None else pytest.approx(told, rel=1e-5))


def test_the_peak_of_a_tilted_structure_is_told_as_an_angle_with_its_uncertainty() -> None:
    box, base = scenes.box("block", (0.2, 0.0, 0.0), (0.6, 0.3, 0.4)), scenes.box("base", (0.0, 0.0, -0.2), (1.0, 0.3, 0.0), "fixed")
    analysis = analyse(scenes.build(base, box, tilt=(0.0, 1.0, 0.0), friction=0.3, model="coulomb"))
    assert analysis.coulomb is not None
    coulomb = replace(analysis.coulomb, value=0.2, uncertainty=1e-4, peak=np.array([0.25, 0.001]))
    found = greatest_load_summary(Results(replace(analysis, at_inset=replace(analysis.at_inset, coulomb=coulomb))))
    assert found is not None and "rose to 0.250 ± 0.001 (14.04 ± 0.05 degrees) in limit analysis" in found["words"]  # atan(0.25)


@pytest.mark.parametrize(
    ("level", "uncertainty", "least"),
    [(0.3, 0.002, 0.306), (-0.3, 0.002, -0.294), (0.3, 0.03, 0.334), (0.0, 0.0, 0.0011), (0.004, 0.0, 0.0051)],
)
def test_a_peak_is_above_its_plateau_by_both_uncertainties_and_a_hundredth(level: float, uncertainty: float, least: float) -> None:
    """The uncertainty of the peak is 0.001. The hundredth is a share of the plateau's level, but at least of 0.01."""
    told = [_of_peak(np.array([least + more, 0.001]), level, uncertainty, np.inf) for more in (-1e-5, 1e-5)]
    assert told[0] is None and told[1] == (pytest.approx(least + 1e-5), 0.001)


@pytest.mark.parametrize(
    ("level", "uncertainty", "least"),
    [(0.3, 0.0, 0.315), (0.3, 0.002, 0.317), (-0.3, 0.002, -0.283), (0.0, 0.0, 0.0005), (0.004, 0.0, 0.0045)],
)
def test_a_curve_is_above_its_plateau_by_its_uncertainty_and_a_twentieth(level: float, uncertainty: float, least: float) -> None:
    """The twentieth is a share of the plateau's level, but at least of 0.01."""
    told = [_of_curve(np.array([-1.0, least + more, level]), level, uncertainty, np.inf) for more in (-1e-5, 1e-5)]
    assert told[0] is None and told[1] is not None and told[1].greatest == pytest.approx(least + 1e-5) and np.isnan(told[1].uncertainty)


def test_only_a_solved_bound_limits_a_load_and_only_a_plateau_of_yade_has_one_before_it() -> None:
    way = {"path_settlement": np.linspace(0.0, 1e-3, 3), "path_value": np.array([0.0, 0.31, 0.2])}
    analysis = pushed(value=0.2, uncertainty=1e-4, **way)
    assert greatest_load_summary(Results(analysis)) is None  # above the bound of 0.3
    bound = replace(analysis.bounds[Drive.LIVE], status=Status.INACCURATE)
    doubtful = replace(analysis, at_inset=replace(analysis.at_inset, bounds={Drive.LIVE: bound}))
    record = {"stage": np.ones(4, dtype=int), "settlement": np.linspace(0.0, 1e-3, 4), "reaction": np.array([0.0, 0.26, 0.21, 0.2])}
    for status, methods in (("plateau", {"limit_analysis", "yade"}), ("no plateau", {"limit_analysis"})):
        run = made_up_run({"status": status, "reaction": 0.2, "uncertainty": 0.002}, record)
        found = greatest_load_summary(Results(doubtful, run))
        assert found is not None and set(found) == methods | {"words"}  # an unknown uncertainty is left out
        assert ("in YADE" in found["words"]) is (status == "plateau")


def test_a_settlement_has_no_greatest_load() -> None:
    assert greatest_load_summary(Results(analyse(scenes.shipped("two_pads")))) is None


def test_the_angle_of_a_plateau_is_not_called_the_angle_of_failure_where_the_structure_has_stood_steeper() -> None:
    comparison = {"limit_analysis": {"coulomb": {"angle": 20.0, "angle_uncertainty": 0.01}}, "structure": {"tilt": [0.0, 1.0, 0.0]}}
    assert angle_words(comparison).startswith("The structure fails at a tilt of the ground about y of 20")
    steeper = comparison | {"greatest_load": {"words": "..."}}
    assert angle_words(steeper).startswith("The blocks keep moving at a tilt of the ground about y of 20")
