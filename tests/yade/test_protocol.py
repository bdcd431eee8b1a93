"""The protocol of a run: attempts at two speeds, stiffer joints where a curve creeps, parts of the uncertainty."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scenes
from conftest import CrossChecked, Silent
from protocol_scenes import wall
from verdict_scenes import EARLIER_SEED, drawn

from comparison.workflow.one_scene import run_scene
from comparison.yade import Run, read_results
from la_core import exchange
from la_core.analysis import analyse, case_file
from la_core.analysis.accuracy import with_accuracy
from la_core.analysis.path_settings import JUMPS, settings_after_path, settings_of_long_run
from la_core.coulomb import CoulombSolution
from la_core.exchange import PLATEAU_SHARE
from la_core.scene import Scene, same_structure
from yade_scripts import case, settings
from yade_scripts.expected_steps import expected_steps
from yade_scripts.plateau import STARTS

PARTS = ("scatter", "fit", "rate", "stiffness")


def case_of(path: Path) -> case.Case:
    """Return the case of a case file, with its live load where it has one."""
    optional = (exchange.LIVE_DIRECTION, *exchange.LOAD_FIELDS)
    held = [field for field in optional if exchange.holds(path, field.path)]
    return case.from_fields(exchange.read(path, (*exchange.CASE_FIELDS, exchange.SWAY, *held)))


def by_both_methods(scene: Scene, folder: Path) -> tuple[Run, CoulombSolution]:
    """Run a scene by both methods; return YADE's run and the Coulomb prediction."""
    run_scene(scene, folder, Silent(), with_yade=True, figures=lambda results: {})
    results = read_results(folder)
    assert results.analysis.coulomb is not None
    return results.recorded, results.analysis.coulomb


@pytest.mark.parametrize("name", ["two_pads", "arch_spreading", "wall_third"])
def test_the_stated_uncertainty_is_that_of_its_parts(name: str, cross_checked: Callable[[str], CrossChecked]) -> None:
    result = cross_checked(name).run.result
    parts = [result[f"uncertainty_{part}"] for part in PARTS]
    assert all(math.isfinite(part) and part >= 0.0 for part in parts)
    assert result.uncertainty == pytest.approx(sum(parts))


@pytest.mark.parametrize("name", ["two_pads", "arch_spreading", "wall_third", "ferris_tin_loi_1", "flat_arch"])
def test_the_steps_of_a_run_are_foretold_within_a_factor_of_two(name: str, cross_checked: Callable[[str], CrossChecked]) -> None:
    checked = cross_checked(name)
    one, chosen = case_of(checked.folder / "case.h5"), settings.Settings(**checked.run.settings)
    pace = chosen.quick_speed
    assert pace > 1.0, "a quick attempt comes first"
    foretold = expected_steps(one, replace(chosen, speed=pace * chosen.speed, ramp_time=chosen.ramp_time / pace), pace)
    assert 0.5 * checked.run.result["steps"] <= foretold.left(0, 0) <= 2.0 * checked.run.result["steps"]
    alone = expected_steps(one, chosen, 1.0)
    assert alone.later == 0.0 and alone.left(0, 0) == pytest.approx(foretold.later), "the attempt at the run's own speed"
    assert expected_steps(one, chosen, 0.25).later == 0.0, "a slower attempt is the last one"


@pytest.mark.parametrize("name", ["arch_spreading", "wall_third"])
def test_a_run_without_jumps_keeps_its_light_damping(name: str, cross_checked: Callable[[str], CrossChecked]) -> None:
    run = cross_checked(name).run
    assert run.settings["damping_ratio"] == pytest.approx(0.3) and "rattle" not in run.result.message


@pytest.mark.slow
@pytest.mark.yade
def test_a_wall_that_rattles_is_run_again_with_its_swing_damped(cross_checked: Callable[[str], CrossChecked]) -> None:
    """With light dashpots alone this wall's reaction stays 1.9 % above the prediction at any speed; a damped swing keeps its time step."""
    found = cross_checked("wall_half")
    assert found.run.settings["swing_damping"] > 0.0 and "blocks rattle" in found.run.result.message
    assert found.run.settings["damping_ratio"] == pytest.approx(0.3)
    assert found.summary["verdict"] == "agree" and found.run.result.uncertainty < 0.01 * found.run.result.reaction


@pytest.mark.slow
@pytest.mark.yade
def test_friction_that_feeds_a_swing_does_not_hide_the_plateau(tmp_path: Path) -> None:
    """A wall, friction 0.87, pulled obliquely: its blocks flutter, and without damping of the swing the reaction has no plateau."""
    run, coulomb = by_both_methods(drawn(95, EARLIER_SEED).scene, tmp_path)
    assert run.status == "plateau"
    assert abs(run.reaction - coulomb.value) <= run.uncertainty + coulomb.uncertainty
    assert run.settings["swing_damping"] > 0.0 and run.uncertainty <= 0.01 * run.reaction


@pytest.mark.slow
@pytest.mark.yade
def test_a_single_jump_calls_for_critical_damping(tmp_path: Path) -> None:
    """A leaning wall, friction 1.2. Under light damping one block jumps by inertia, which no scatter of the plateau shows."""
    run, coulomb = by_both_methods(scenes.load(wall("leaning", 1.2, 2).text), tmp_path)
    assert run.settings["damping_ratio"] == pytest.approx(1.0) and "blocks rattle" in run.result.message
    assert abs(run.reaction - coulomb.value) <= run.uncertainty + coulomb.uncertainty + 5e-3 * coulomb.value


@pytest.mark.slow
@pytest.mark.yade
def test_a_wall_whose_joints_still_strain_gets_stiffer_ones_and_comes_to_its_plateau(tmp_path: Path) -> None:
    """A leaning wall, friction 0.7: over one travel at the derived stiffness the reaction falls by 7 % above its plateau."""
    run, coulomb = by_both_methods(scenes.load(wall("leaning", 0.7, 1).text), tmp_path)
    assert run.status == "plateau"
    assert run.settings["stiffening"] > 4.0
    assert abs(run.reaction - coulomb.value) <= run.uncertainty + coulomb.uncertainty
    assert run.uncertainty <= 0.02 * run.reaction


@pytest.mark.slow
@pytest.mark.yade
def test_a_plateau_that_the_reaction_leaves_is_kept(tmp_path: Path) -> None:
    """A wall of two leaves, friction 0.96: a thrust across it is locked in, and released as blocks turn; the reaction falls by a fifth."""
    run, coulomb = by_both_methods(drawn(64, EARLIER_SEED).scene, tmp_path)
    assert run.status == "plateau" and "the reaction leaves it" in run.result.message
    assert abs(run.reaction - coulomb.value) <= run.uncertainty + coulomb.uncertainty
    assert run.poses.settlement[-1] == run.record.settlement[-1] == run.result.settlement  # the record ends with the plateau
    assert run.result.asked_settlement == pytest.approx(run.result.settlement, rel=1e-3)


@pytest.mark.slow
@pytest.mark.yade
def test_joints_four_times_stiffer_show_the_same_plateau(tmp_path: Path) -> None:
    """The wall of the last test. Stiffer joints release the thrust within half the settlement, which once was before the first fit."""
    scene = drawn(64, EARLIER_SEED).scene
    first, _ = by_both_methods(scene, tmp_path / "usual")
    stiffer = same_structure(scene, {"yade.stiffening": 4.0 * first.settings["stiffening"]}, "stiffer")
    second, _ = by_both_methods(stiffer, tmp_path / "stiffer")
    assert second.status == "plateau" and second.settings["stiffening"] > 3.9 * first.settings["stiffening"]
    assert abs(second.reaction - first.reaction) <= first.uncertainty <= 0.01 * first.reaction


@pytest.mark.slow
@pytest.mark.yade
def test_weights_leave_no_trace_of_how_they_came(tmp_path: Path) -> None:
    """Weights that come at once reduce this scene's reaction at rest by 0.6 %, and friction keeps a trace of 2 % to the plateau."""
    run, coulomb = by_both_methods(drawn(139, EARLIER_SEED).scene, tmp_path)
    assert run.settings["gravity_ramp"] > 0.0
    at_rest = run.record.reaction[run.record.stage == 0][-1]
    assert at_rest == pytest.approx(coulomb.at_rest, rel=1e-3)  # blocks count as resting with unbalanced forces of 1e-3 of their weight
    assert abs(run.reaction - coulomb.value) <= run.uncertainty + coulomb.uncertainty


@pytest.mark.slow
@pytest.mark.yade
def test_states_are_near_enough_for_any_plateau_to_hold_several(tmp_path: Path) -> None:
    """Stiff joints may show their plateau anywhere on the way. States at fixed distances once left a single one on it, and no mechanism."""
    stiff = same_structure(
        scenes.shipped("two_pads"), {"yade.stiffening": 64.0, "yade.stop_uncertainty": 1e-9, "yade.record_rows": 600}, "stiff"
    )
    run, _ = by_both_methods(stiff, tmp_path)
    way = run.poses.settlement[run.poses.settlement >= run.settings["plateau_travel"]]
    assert way[-1] > 10.0 * way[0] and np.max(np.diff(way) / way[1:]) <= 0.15


@pytest.mark.parametrize("travel", [1.0, 2.0, 8.0, 64.0])
@pytest.mark.parametrize("settled", [0.0, 0.5, 0.9])
def test_a_run_may_stop_only_where_its_plateau_lies_beyond_the_way_that_the_path_took_to_settle(travel: float, settled: float) -> None:
    """Travel over sag counts. The run gets up to 32 times the stiffness, then more of the travel, and at most all of it."""
    scene, way = scenes.shipped("two_pads"), np.linspace(0.0, travel, 200)
    value = np.where(way <= settled * travel, 1.0015, 1.0009)  # never flat at the value

    def sets(scene: Scene) -> dict[str, float]:
        return settings_after_path(analysis_of(scene, way, value, 1.0))

    if travel == 1.0:
        assert sets(scene) == {}
        return
    found = sets(scene)
    assert found["least_stiffening"] == min(4.0 * travel, 32.0)
    share = found.get("plateau_share", PLATEAU_SHARE)
    enough = min(settled * travel / found["least_stiffening"] / STARTS[-1], 1.0)
    assert share == pytest.approx(max(enough, PLATEAU_SHARE), rel=0.02, abs=way[1] / 32.0)
    assert sets(same_structure(scene, {"yade.normal_stiffness": 1e8}, "stiff")) == {}
    noise = settings_after_path(analysis_of(scene, way, 1e-9 * np.sin(way), 0.0))
    assert "plateau_share" not in noise  # noise about a reaction of zero is small beside the weight


@pytest.mark.parametrize(("apart", "travels"), [(0.0, 1.0), (0.0004, 1.0), (0.0006, 16.0)])
@pytest.mark.parametrize("settled", [0.0, 0.2, 1.5])
def test_a_path_that_went_on_after_its_curve_was_flat_at_its_value_asks_for_no_stiffer_joints(
    apart: float, travels: float, settled: float
) -> None:
    """The path waited up to 16 travels for a contact point to change its state. Its value then was the same, or another."""
    scene, way = scenes.shipped("two_pads"), np.linspace(0.0, 16.0, 2000)
    found = settings_after_path(analysis_of(scene, way, np.where(way <= settled, 2.0, 1.0 + apart), 1.0))
    flat = travels if settled < 1.0 else max(travels, 8.0)  # the curve is flat over three quarters of the way
    assert found.get("least_stiffening", 4.0) == min(4.0 * flat, 32.0)


def test_a_curve_that_leaves_its_value_after_it_was_flat_there_is_followed_until_it_is_back() -> None:
    way = np.linspace(0.0, 16.0, 2000)
    found = settings_after_path(analysis_of(scenes.shipped("two_pads"), way, np.where((way > 2.5) & (way < 6.0), 1.1, 1.0), 1.0))
    assert found == {"least_stiffening": 32.0, "plateau_share": pytest.approx(6.0 / 32.0 / 0.6, rel=2e-3)}


@pytest.mark.parametrize(("near", "stiffening", "share"), [(0.3, 4.0, 0.125), (0.1, 4.0, None), (3.0, 12.0, 0.4167), (40.0, 32.0, 1.0)])
@pytest.mark.parametrize("jump", [0.0, 0.5])
def test_a_long_run_covers_the_way_to_half_a_percent(near: float, stiffening: float, share: float | None, jump: float) -> None:
    """A path of 64 travels settles at `near` within 0.4 %, but for a later jump, and never within 0.1 %.

    jump: its length over the longest that counts as a jump.
    """
    scene, way = scenes.shipped("two_pads"), np.linspace(0.0, 64.0, 640001)
    last = near if jump else near * (1.0 + JUMPS)  # without a later jump the last hundredth of this way may pass for a jump
    analysis = analysis_of(scene, way, np.where((way <= last) | jumps_at(50.0, jump, way), 1.01, 1.004), 1.0)
    found = settings_of_long_run(analysis)
    assert found["least_stiffening"] == pytest.approx(stiffening, rel=1e-3) and found["settings_uncertainty"] == 0.005
    assert found.get("plateau_share") == (None if share is None else pytest.approx(share, rel=1e-3))
    assert settings_after_path(analysis) == {"least_stiffening": 32.0, "plateau_share": 1.0}
    short = way[way <= 1.0]
    assert settings_of_long_run(analysis_of(scene, short, np.ones(len(short)), 1.0)) == {}
    assert settings_of_long_run(analysis_of(with_accuracy(scene, 0.01), way, np.ones(len(way)), 1.0)) == {}


def test_what_is_longer_than_a_jump_is_part_of_the_curve() -> None:
    """In a long run the curve settles only behind such a stretch: at five travels, with 20 times the stiffness."""
    scene, way = scenes.shipped("two_pads"), np.linspace(0.0, 64.0, 640001)
    jump = settings_of_long_run(analysis_of(scene, way, np.where((way <= 1.0) | jumps_at(5.0, 0.9, way), 1.01, 1.004), 1.0))
    longer = settings_of_long_run(analysis_of(scene, way, np.where((way <= 1.0) | jumps_at(5.0, 1.2, way), 1.01, 1.004), 1.0))
    assert jump["least_stiffening"] == pytest.approx(4.0, rel=1e-3)
    assert longer["least_stiffening"] == pytest.approx(20.0, rel=0.02)


def jumps_at(place: float, jump: float, way: np.ndarray) -> np.ndarray:
    """Mask (T,) of a path's jump at a place, in travels. jump: its length over the longest that counts as a jump."""
    return (way > place) & (way <= place * (1.0 + jump * JUMPS))


def analysis_of(scene: Scene, way: np.ndarray, values: np.ndarray, value: float) -> Any:
    """Limit analysis of a weight of 10 N whose path had these values (T,), N, on its way (T,), in travels, to a value, N."""
    coulomb = SimpleNamespace(travel=way[-1], value=value, path_settlement=8e-4 * way, path_value=values)
    effects = SimpleNamespace(friction="coulomb", rotation="small")
    assembly = SimpleNamespace(effects=effects, weight=10.0, in_value_unit=lambda weight: weight)
    stiffness, at_inset = SimpleNamespace(travel=8e-4), SimpleNamespace(sharpest=coulomb)
    return SimpleNamespace(scene=scene, coulomb=coulomb, stiffness=stiffness, assembly=assembly, at_inset=at_inset)


@pytest.mark.parametrize(("points", "most"), [(100, 3e6), (1400, 1.5e6), (8000, 7.5e5)])
def test_all_attempts_together_take_a_bounded_number_of_steps(points: int, most: float) -> None:
    """A small structure may take 3e8 steps times contact points, a larger one 1.5 million steps, and none more than some 40 minutes."""
    assert settings.most_steps(points) == most


@pytest.mark.parametrize(("reaction", "allowed"), [(0.0, 0.02), (249.0, 0.02), (-1000.0, 0.08)])
def test_what_counts_as_rattling_is_small_beside_a_block_or_beside_the_reaction(reaction: float, allowed: float) -> None:
    """A jumping block of 10 N is negligible beside a reaction of 1 kN."""
    one: Any = SimpleNamespace(live=None, support_speed=1.0, block_weight=10.0)
    chosen: Any = SimpleNamespace(rattling=0.02)
    assert settings.rattling_of(one, chosen, reaction) == pytest.approx(allowed)
    one.live, one.support_speed = np.array([1.0, 0.0, 0.0]), 1.0
    assert settings.rattling_of(one, chosen, reaction) == chosen.rattling  # the reaction to a live load is a multiplier


def test_steps_are_longer_while_the_support_moves_but_for_critical_dashpots_and_a_given_step(tmp_path: Path) -> None:
    """Local damping ends with the gravity stage."""
    case_file.write_case(tmp_path / "case.h5", analyse(scenes.shipped("two_pads")), "test")
    one = case.from_fields(exchange.read(tmp_path / "case.h5", (*exchange.CASE_FIELDS, exchange.SWAY)))
    usual = settings.derive(one)
    assert 1.1 * usual.time_step < usual.settling_step < 1.3 * usual.time_step
    for given in ({"damping_ratio": 1.0}, {"time_step": 0.5 * usual.time_step}, {"gravity_damping": 0.0}):
        chosen = settings.derive(replace(one, overrides=given))
        assert chosen.settling_step == pytest.approx(chosen.time_step)
    with pytest.raises(case.CaseError, match=r"settling_step is .* it must be at most"):
        settings.derive(replace(one, overrides={"settling_step": 2.0 * usual.settling_step}))


def test_a_run_has_the_defaults_that_pages_and_terminal_show(tmp_path: Path) -> None:
    """The structure is small, and limit analysis requests nothing else. All other settings are derived from the structure."""
    case_file.write_case(tmp_path / "case.h5", analyse(scenes.shipped("two_pads")), "test")
    one = case.from_fields(exchange.read(tmp_path / "case.h5", (*exchange.CASE_FIELDS, exchange.SWAY)))
    chosen = settings.derive(replace(one, overrides={}))
    assert {name: getattr(chosen, name) for name in exchange.SETTING_DEFAULTS} == pytest.approx(exchange.SETTING_DEFAULTS)


def test_joints_without_dashpots_have_a_time_step(tmp_path: Path) -> None:
    """Without dashpots nothing decays, so that the step is the longest that the swing allows."""
    case_file.write_case(tmp_path / "case.h5", analyse(scenes.shipped("two_pads")), "test")
    one = case.from_fields(exchange.read(tmp_path / "case.h5", (*exchange.CASE_FIELDS, exchange.SWAY)))
    slight, none = (settings.derive(replace(one, overrides={"damping_ratio": ratio})) for ratio in (1e-9, 0.0))
    assert none.normal_damping == none.shear_damping == 0.0
    assert (none.time_step, none.settling_step) == pytest.approx((slight.time_step, slight.settling_step), rel=1e-6)


def test_a_run_that_would_be_long_takes_the_settings_of_a_long_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Settings of the scene hold in both sets. A file without settings of a long run, as of version 0.2.0, has one set for both."""
    analysis = analyse(same_structure(scenes.shipped("wall_third"), {"yade.rattling": 0.03}, "set"))
    assert analysis.coulomb is not None
    never_flat = replace(analysis.coulomb, travel=16.0, path_value=1.0009 * analysis.coulomb.path_value)
    late = replace(analysis.at_inset, coulomb=never_flat)
    case_file.write_case(tmp_path / "case.h5", replace(analysis, at_inset=late), "test")
    data = exchange.read(tmp_path / "case.h5", (*exchange.CASE_FIELDS, exchange.SWAY, exchange.LONG_RUN_SETTINGS))
    one = case.from_fields(data)
    assert one.overrides == {"least_stiffening": 32.0, "rattling": 0.03}
    assert one.long_overrides == {"least_stiffening": 4.0, "rattling": 0.03, "settings_uncertainty": 0.005}
    assert settings.affordable(one) is one
    monkeypatch.setattr(settings, "SMALL_WORK", 0.9 * settings.steps_to_plateau(settings.derive(one)) * len(one.host))
    short = settings.affordable(one)
    assert short.overrides == one.long_overrides
    steps, steps_before = (settings.steps_to_plateau(settings.derive(which, large=False)) for which in (short, one))
    assert steps < steps_before
    del data["scene/settings_of_long_run"]
    alike = case.from_fields(data)
    assert alike.long_overrides == alike.overrides == one.overrides


def test_a_large_structure_has_its_swing_damped_at_once_moves_faster_and_stops_sooner(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = scenes.build(*scenes.wall(4, 3, split=0.8), inset=0.001)
    case_file.write_case(tmp_path / "case.h5", analyse(scene), "test")
    one = case.from_fields(exchange.read(tmp_path / "case.h5", (*exchange.CASE_FIELDS, exchange.SWAY)))
    small = settings.derive(one)
    assert (small.swing_damping, small.stop_uncertainty, small.travel_periods) == (0.0, 0.002, pytest.approx(1200.0))
    monkeypatch.setattr(settings, "SMALL_WORK", 0.9 * settings.steps_to_plateau(small) * len(one.host))
    large = settings.derive(one)
    assert (large.swing_damping, large.stop_uncertainty, large.travel_periods) == (0.5, 0.005, pytest.approx(600.0))
    assert large.speed == pytest.approx(2.0 * small.speed)
    assert large.damping_ratio < small.damping_ratio and large.time_step > small.time_step
    assert large.damping_ratio == 0.1 and settings.is_content(large) and not settings.is_content(small)
    slender = settings.derive(replace(one, sway=100.0 * one.sag))
    assert (slender.swing_damping, slender.damping_ratio, slender.stop_uncertainty) == (0.0, 0.3, 0.005)
    asked = settings.derive(replace(one, overrides={"swing_damping": 0.0, "stop_uncertainty": 1e-3}))
    assert asked.damping_ratio == 0.3  # no other damping acts
    assert (asked.swing_damping, asked.stop_uncertainty, asked.travel_periods) == (0.0, 1e-3, pytest.approx(600.0))
