"""Live loads by both methods: closed forms, published walls, the servo that drives YADE, and the judge."""

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scenes
from conftest import CrossChecked, Silent
from runs import TRAVEL, made_up_run, perfect_run, with_answers

from comparison.figures.motion import motions
from comparison.judge import check_run
from comparison.report.details import energies
from comparison.verdict import Check, Verdict
from comparison.workflow import run_scene
from comparison.yade import Results, Run, read_run
from la_core.analysis import LimitAnalysis, analyse
from la_core.analysis.case_file import read_case
from la_core.limit import Drive
from la_core.measures import residuals
from la_core.scene import Scene
from la_core.scene.scene import load_scene
from yade_scripts.driving.servo import Servo

INSET = 1e-3  # m
PER_MILLE = 1e-3  # relative: agreement with closed forms


def column(breadth: float, height: float, courses: int = 1, **options: Any) -> Scene:
    """A stack of equal blocks on a fixed plane, pushed along x."""
    blocks = [
        scenes.box(f"block {k}", (0.0, 0.0, k * height / courses), (breadth, 0.3 * breadth, (k + 1) * height / courses))
        for k in range(courses)
    ]
    plane = scenes.box("plane", (-breadth, 0.0, -0.2 * breadth), (2.0 * breadth, 0.3 * breadth, 0.0), "fixed")
    given = {"inset": INSET, "model": "coulomb", "live": (1.0, 0.0, 0.0)} | options
    return scenes.build(plane, *blocks, **given)


def by_both(scene: Scene, folder: Path) -> tuple[dict[str, Any], LimitAnalysis, Run]:
    summary = run_scene(scene, folder, Silent(), with_yade=True, figures=lambda _: {})
    analysis = read_case(folder / "case.h5", scene)
    return summary, analysis, read_run(folder / "run.h5", analysis.assembly)


def tilted(friction_or_ratio: float, tilt: float) -> float:
    """Multiplier along a plane tilted by `tilt` that moves a block at this ratio of force along the plane to force across it."""
    return friction_or_ratio * math.cos(tilt) - math.sin(tilt)


TILT = math.radians(10.0)
DOWNHILL = tuple(9.81 * np.array([math.sin(TILT), 0.0, -math.cos(TILT)]))
TIPPING = (0.5 - 2.0 * INSET) / 0.7  # the block turns about its outer contact points
CLOSED_FORMS = {
    "slides": (lambda: column(0.6, 0.4, friction=0.35), 0.35),
    "tips": (lambda: column(0.5, 0.7, friction=0.9), TIPPING),
    "slides downhill": (lambda: column(0.6, 0.4, friction=0.35, gravity=DOWNHILL), tilted(0.35, TILT)),
    "tips downhill": (lambda: column(0.5, 0.7, friction=0.9, gravity=DOWNHILL), tilted(TIPPING, TILT)),
    "stack tips": (lambda: column(0.5, 1.0, courses=10, friction=0.7), (0.5 - 2.0 * INSET) / 1.0),
    "in space": (lambda: column(0.5, 0.7, friction=0.9, plane=False), TIPPING),
}

FAST = ("slides", "tips")


@pytest.mark.slow_after_first
@pytest.mark.yade
@pytest.mark.parametrize("name", [name if name in FAST else pytest.param(name, marks=pytest.mark.slow) for name in CLOSED_FORMS])
def test_both_methods_meet_the_closed_form(name: str, tmp_path: Path) -> None:
    build, exact = CLOSED_FORMS[name]
    summary, analysis, run = by_both(build(), tmp_path / "results")
    assert summary["verdict"] == "agree", summary["reason"]
    assert analysis.coulomb is not None and analysis.coulomb.value == pytest.approx(exact, rel=PER_MILLE)
    assert run.reaction == pytest.approx(exact, rel=PER_MILLE)
    assert abs(run.reaction - exact) <= run.uncertainty <= 5.0 * PER_MILLE * exact


TALL = """
[stone]
density = 2000.0
[joint]
friction = 0.6
[[block]]
name = "ground"
role = "fixed"
box = {{ from = [-1.0, 0.0, -0.2], to = [1.0, 0.2, 0.0] }}
[[block]]
name = "tall"
box = {{ from = [0.0, 0.0, 0.0], to = [{breadth}, 0.2, {height}] }}
[[block]]
name = "cap"
box = {{ from = [0.02, 0.0, {height}], to = [{breadth}, 0.2, {top}] }}
[[friction]]
between = ["tall", "cap"]
friction = {friction}
[live]
direction = [1.0, 0.0, 0.0]
"""


@pytest.mark.slow_after_first
@pytest.mark.yade
@pytest.mark.parametrize(("breadth", "height", "friction"), [(0.28, 1.5, 0.057), (0.4, 2.6, 0.011)])
def test_a_block_slides_on_a_tall_one_at_the_speed_that_is_set(breadth: float, height: float, friction: float, tmp_path: Path) -> None:
    """The cap slides at its friction coefficient. The servo once swung with the tall block: the cap was half too fast, without verdict."""
    path = tmp_path / "tall.toml"
    path.write_text(TALL.format(breadth=breadth, height=height, top=height + 0.2, friction=friction))
    summary, _, run = by_both(load_scene(path), tmp_path / "results")
    assert summary["verdict"] == "agree", summary["reason"]
    assert run.reaction == pytest.approx(friction, rel=PER_MILLE)


@pytest.mark.yade
def test_friction_takes_what_the_load_brings(tmp_path: Path) -> None:
    """A block slides on a level bed. The load alone does work, and all mechanisms are per unit power of the load."""
    summary, analysis, run = by_both(column(0.5, 0.3, friction=0.4), tmp_path / "results")
    measures, energy = summary["mechanism_measures"], summary["energy"]
    assert [measures[method]["dissipated_power"] for method in ("associated", "coulomb", "yade")] == pytest.approx([0.4] * 3, rel=0.01)
    assert [measures[method]["dissipated_share"] for method in measures] == [None] * 3  # no weight settles
    way = run.poses.settlement[-1] - run.poses.settlement[0]
    assert abs(energy["weights"]) <= 0.001 * energy["load"] and energy["support"] == 0.0
    assert energy["load"] == pytest.approx(0.4 * analysis.assembly.weight * way, rel=0.05)  # less on the way to the plateau
    rows = {row["name"] for row in energies(summary)}
    assert "work of the live load" in rows and "work of the support" not in rows


@pytest.mark.slow
@pytest.mark.yade
def test_a_block_of_another_size_takes_the_same_steps(tmp_path: Path) -> None:
    """All gains follow from the case: sizes and weights change no digit but round-off."""
    runs = []
    for factor in (1.0, 1e-3):
        scene = column(0.5 * factor, 0.7 * factor, friction=0.9, inset=INSET * factor, density=2000.0 / factor)
        runs.append(by_both(scene, tmp_path / f"{factor:g}")[2])
    assert runs[0].result.steps == runs[1].result.steps
    assert runs[1].reaction == pytest.approx(runs[0].reaction, rel=1e-6)


@pytest.mark.slow
@pytest.mark.yade
@pytest.mark.parametrize("name", ["ferris_tin_loi_1", "ferris_tin_loi_2"])
def test_published_walls_go_through_both_methods(name: str, cross_checked: Callable[[str], CrossChecked]) -> None:
    found = cross_checked(name)
    coulomb, expected = found.analysis.coulomb, found.scene.expected
    assert found.summary["verdict"] == "agree", found.summary["reason"]
    assert coulomb is not None and expected is not None and expected.multiplier is not None
    assert found.run.reaction == pytest.approx(coulomb.value, rel=PER_MILLE)
    assert abs(found.run.reaction - coulomb.value) <= found.run.uncertainty + coulomb.uncertainty
    assert found.run.reaction == pytest.approx(expected.multiplier, abs=expected.tolerance)
    assert found.run.reaction <= found.analysis.bounds[Drive.LIVE].value
    assert found.summary["curves"]["mean"] <= 5.0 * PER_MILLE


@pytest.mark.yade
def test_the_recorded_multiplier_is_the_one_that_acts_and_the_blocks_move_steadily(tmp_path: Path) -> None:
    _, analysis, run = by_both(column(0.5, 0.7, friction=0.9), tmp_path / "results")
    for k in range(len(run.poses)):
        acting = residuals.multiplier(analysis.assembly, run.poses.forces[k])
        recorded = np.interp(run.poses.settlement[k], run.settling("settlement"), run.settling("reaction"))
        assert acting == pytest.approx(recorded, abs=0.02)
    free = analysis.assembly.blocks.free
    mass = analysis.assembly.blocks.mass[free]
    along = (run.poses.displacement[:, free, 0] - run.poses.displacement[0, free, 0]) @ mass / mass.sum()
    np.testing.assert_allclose(run.poses.settlement, along, atol=1e-12)
    kept = run.settling("settlement") >= run.result.plateau_start
    speed = np.ptp(run.settling("settlement")[kept]) / np.ptp(run.settling("time")[kept])
    assert speed == pytest.approx(run.settings["speed"], rel=0.02)  # of the only block


@pytest.mark.slow
@pytest.mark.yade
def test_a_block_that_no_push_moves_has_no_plateau(tmp_path: Path) -> None:
    """A block stands between two fixed walls. Limit analysis finds no limit, and in YADE the block never moves steadily."""
    held = scenes.box("left", (-0.5, 0.0, 0.0), (0.0, 0.3, 0.4), "fixed"), scenes.box("right", (0.6, 0.0, 0.0), (1.1, 0.3, 0.4), "fixed")
    plane = scenes.box("plane", (-0.5, 0.0, -0.2), (1.1, 0.3, 0.0), "fixed")
    block = scenes.box("block", (0.0, 0.0, 0.0), (0.6, 0.3, 0.4))
    scene = scenes.build(plane, *held, block, inset=INSET, friction=0.4, live=(1.0, 0.0, 0.0), model="coulomb")
    summary, analysis, run = by_both(scene, tmp_path / "results")
    assert analysis.bounds[Drive.LIVE].status.value == "unbounded"
    assert run.status == "no plateau" and math.isnan(run.reaction)
    assert summary["verdict"] in ("inconclusive", "agree")


# --- the servo, without YADE -------------------------------------------------------------------------------------------------


def pulled(servo: Servo, resistance: float, steps: int, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """Multiplier and speed of a rigid block that slides at this multiplier, under gravity of 9.81 m/s2."""
    speed = multiplier = 0.0
    records = []
    for step in range(steps):
        if step % servo.every == 0:
            multiplier = servo.multiplier(step * dt, speed)
        drive = multiplier - resistance if speed > 0.0 or multiplier > resistance else 0.0
        speed = max(0.0, speed + 9.81 * drive * dt)
        records.append((multiplier, speed))
    return np.array(records).T


def test_the_servo_holds_the_speed_and_shows_the_resistance_as_a_plateau() -> None:
    frequency = 200.0  # rad/s
    servo = Servo(frequency**2 / 9.81, 2.0 * frequency / 9.81, speed=4e-4, ramp_time=0.05, every=20, window=1.0)
    multiplier, speed = pulled(servo, 0.35, steps=60_000, dt=1e-5)
    settled = slice(40_000, None)
    assert np.ptp(multiplier[settled]) <= 1e-5 and multiplier[-1] == pytest.approx(0.35, abs=1e-6)
    np.testing.assert_allclose(speed[settled], servo.speed, rtol=1e-4)
    assert multiplier.max() <= 1.01 * 0.35  # it hardly overshoots as the block breaks away


def test_the_point_that_pulls_starts_from_rest_and_moves_at_its_speed() -> None:
    servo = Servo(1.0, 1.0, speed=2.0, ramp_time=0.5, every=1, window=1.0)
    assert servo.pulled(0.0) == (0.0, 0.0)
    places, speeds = np.array([servo.pulled(time) for time in np.linspace(0.0, 1.0, 10_001)]).T
    assert np.all(np.diff(speeds) >= -1e-12) and speeds[-1] == 2.0
    np.testing.assert_allclose(np.diff(places) / 1e-4, 0.5 * (speeds[1:] + speeds[:-1]), atol=1e-5)


def test_the_servo_follows_the_blocks_that_move() -> None:
    """A tenth of the mass moves. The servo holds its speed, not the mean of all masses."""
    servo = Servo(1.0, 1.0, speed=1.0, ramp_time=0.0, every=1, window=1.0)
    masses = np.array([9.0, 1.0])
    servo.renew(0.0, masses, np.array([0.0, 5.0]))
    assert servo.weighted(np.array([0.0, 1.0])) == pytest.approx(0.1)
    for k in range(1, 20):
        servo.renew(float(k), masses, np.array([0.0, 5.0 + k]))
    assert servo.weighted(np.array([0.0, 1.0])) == pytest.approx(1.0, abs=1e-4)
    servo.renew(20.0, masses, np.array([0.0, 24.0]))  # no block moved: the weights stay
    assert servo.weighted(np.array([0.0, 1.0])) == pytest.approx(1.0, abs=1e-4)


# --- the judge ---------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def pushed() -> LimitAnalysis:
    return analyse(column(0.5, 0.7, friction=0.9))


def followed(analysis: LimitAnalysis, speed: float = 1.0, **result: object) -> Run:
    """A run that follows limit analysis to the digit. speed: of its blocks, over the set speed."""
    bound = analysis.bounds[Drive.LIVE]
    per_metre = dataclasses.replace(bound, twists=bound.twists * analysis.assembly.weight)
    run = perfect_run(with_answers(analysis, bounds={Drive.YIELDING: per_metre}), **result)
    settlement = np.linspace(0.0, TRAVEL, 100)
    acting = np.full(100, float(bound.value))
    free, mass = analysis.assembly.blocks.free, analysis.assembly.blocks.mass
    along = per_metre.twists[free, 0]
    factor = float(mass[free] @ along**2 / (mass[free] @ along))  # speed that the servo holds, over the mean speed
    record = {"stage": np.ones(100, dtype=int), "time": settlement * factor / (speed * 4e-4), "settlement": settlement, "reaction": acting}
    return dataclasses.replace(run, record=made_up_run(record=record).record, settings={"speed": 4e-4})


def judged(name: str, found: list[Check]) -> Verdict:
    return next(check.verdict for check in found if check.name == name)


def test_a_run_that_follows_limit_analysis_agrees(pushed: LimitAnalysis) -> None:
    found = check_run(Results(pushed, followed(pushed)))
    assert {check.verdict for check in found} == {Verdict.AGREE}
    assert {
        "speed along the load", "balance along the mechanism", "multiplier below its upper bound", "multiplier against prediction",
        "mechanism similarity", "moving blocks", "force sums over sections", "equilibrium of the YADE state", "plane answer in space",
    } <= {check.name for check in found}  # fmt: skip


def test_both_mechanisms_are_drawn_to_one_scale(pushed: LimitAnalysis) -> None:
    drawn = motions(Results(pushed, followed(pushed)))
    ours, theirs = (method.displacement[-1] for method in drawn.methods)
    assert np.abs(theirs).max() > 0.0
    np.testing.assert_allclose(ours, theirs, atol=1e-6 * np.abs(theirs).max())


def test_a_multiplier_above_the_upper_bound_disagrees(pushed: LimitAnalysis) -> None:
    found = check_run(Results(pushed, followed(pushed, reaction=1.02 * pushed.bounds[Drive.LIVE].value)))
    assert judged("multiplier below its upper bound", found) is Verdict.DISAGREE


def test_a_multiplier_below_the_prediction_obeys_the_bound_and_disagrees_with_the_prediction(pushed: LimitAnalysis) -> None:
    found = check_run(Results(pushed, followed(pushed, reaction=0.98 * pushed.bounds[Drive.LIVE].value)))
    assert judged("multiplier below its upper bound", found) is Verdict.AGREE
    assert judged("multiplier against prediction", found) is Verdict.DISAGREE


def test_blocks_that_speed_up_decide_nothing(pushed: LimitAnalysis) -> None:
    found = check_run(Results(pushed, followed(pushed, speed=1.5)))
    assert judged("speed along the load", found) is Verdict.INCONCLUSIVE


def test_a_multiplier_that_does_not_act_is_out_of_balance(pushed: LimitAnalysis) -> None:
    run = followed(pushed)
    record = dataclasses.replace(run.record, reaction=1.05 * run.record.reaction)
    found = check_run(Results(pushed, dataclasses.replace(run, record=record)))
    assert judged("balance along the mechanism", found) is Verdict.INCONCLUSIVE


def test_a_mechanism_of_other_blocks_disagrees() -> None:
    """In the run the upper half rocks by itself; in limit analysis the whole stack tips."""
    analysis = analyse(column(0.5, 1.0, courses=4, friction=0.7))
    hinge, free = np.array([0.5 - INSET, 0.15 * 0.5, 0.5]), analysis.assembly.blocks.free
    rocking = np.zeros((len(free), 6))
    rocking[-2:, 4] = 1.0
    rocking[-2:, :3] = np.cross([0.0, 1.0, 0.0], analysis.assembly.blocks.centroid[-2:] - hinge)
    bound = analysis.bounds[Drive.LIVE]
    other = dataclasses.replace(bound, twists=rocking / rocking[free, 0].sum() * free.sum() / analysis.assembly.weight)
    run = followed(with_answers(analysis, bounds={Drive.LIVE: other}))
    found = check_run(Results(analysis, run))
    assert judged("multiplier against prediction", found) is Verdict.AGREE
    assert judged("mechanism similarity", found) is judged("moving blocks", found) is Verdict.DISAGREE
