"""The numbers of single checks: a test changes one number that a check uses, and the check responds."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
import scenes
from judged_runs import MOVING, REACTION, SIMILARITY, coulomb_of, judged, named
from runs import TRAVEL, coulomb_run, made_up_run, perfect_run, with_answers

from comparison.judge.checks.answer import check_expected
from comparison.judge.checks.sections import SECTION, _transverse_directions, check_sections
from comparison.judge.summary import _where_nothing_is_borne
from comparison.verdict import BEARS_NOTHING
from comparison.verdict.check import Verdict, overall
from comparison.yade import Results, Run
from la_core.analysis.result import AccuracyRecord, LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.limit.problem import Drive
from la_core.model.assembly import Assembly


@pytest.fixture(scope="module")
def wall() -> LimitAnalysis:
    """A wall whose joints slide."""
    return analyse(scenes.shipped("wall_third"))


@pytest.fixture(scope="module")
def pads() -> LimitAnalysis:
    """A block on two pads; no joint slides."""
    return analyse(scenes.shipped("two_pads"))


def pushed(*blocks: str, **options: object) -> LimitAnalysis:
    ground = scenes.box("ground", (-2.0, 0.0, -0.2), (3.0, 0.15, 0.0), "fixed")
    given = {"inset": 1e-3, "model": "coulomb", "live": (1.0, 0.0, 0.0)} | options
    return analyse(scenes.build(ground, *blocks, **given))


def driven(analysis: LimitAnalysis, twists: np.ndarray, forces: np.ndarray, value: float) -> Run:
    """Return a run under a live load at the set speed, with this mechanism per metre of mean displacement."""
    run = perfect_run(with_answers(analysis, bounds={Drive.YIELDING: dataclasses.replace(
        analysis.bounds[Drive.LIVE], twists=twists, forces=forces, value=value)}))  # fmt: skip
    settlement = np.linspace(0.0, TRAVEL, 100)
    free, mass = analysis.assembly.blocks.free, analysis.assembly.blocks.mass
    along = twists[free, 0]
    held = float(mass[free] @ along**2 / (mass[free] @ along))  # the servo holds the mean speed weighted by mass times speed
    record = {"stage": np.ones(100, dtype=int), "time": settlement * held / 4e-4, "settlement": settlement, "reaction": np.full(100, value)}
    return dataclasses.replace(run, record=made_up_run(record=record).record, settings={"speed": 4e-4})


# --- a live load ------------------------------------------------------------------------------------------------------------------


def test_the_speed_of_a_stack_that_tips_is_the_one_that_the_servo_holds() -> None:
    """The upper blocks of the stack are faster: the mean speed weighted by mass times speed is 5/16 above the mean weighted by mass."""
    stack = [scenes.box(f"block {k}", (0.0, 0.0, 0.25 * k), (0.5, 0.15, 0.25 * (k + 1))) for k in range(4)]
    analysis = pushed(*stack, friction=0.7)
    bound = analysis.bounds[Drive.LIVE]
    run = driven(analysis, bound.twists * analysis.assembly.weight, bound.forces, bound.value)
    before = run.record.settlement < run.result.plateau_start
    run.record.time[~before] += run.record.time[before].max()  # the run took twice as long to reach its speed
    run.record.time[before] *= 2.0
    found = judged(analysis, run)
    assert named("speed along the load", found).verdict is Verdict.AGREE
    assert overall(found)[0] is Verdict.AGREE


@pytest.mark.parametrize("pressed", [False, True], ids=["bare", "under forces that are not pushed"])
def test_one_of_two_like_columns_may_tip_alone(pressed: bool) -> None:
    """Both columns tip under the same multiplier, so the mechanism is not unique."""
    columns = [scenes.box(f"column {k}", (1.2 * k, 0.0, 0.0), (1.2 * k + 0.5, 0.15, 0.7)) for k in range(2)]
    force = scenes.table("[load]", blocks=["column *"], force=(0.0, 0.0, -2000.0))
    analysis = pushed(*columns, *([force] if pressed else []), friction=1.5)
    bound, blocks = analysis.bounds[Drive.LIVE], analysis.assembly.blocks
    alone = np.zeros_like(bound.twists)
    alone[1, 4] = 1.0
    alone[1, :3] = np.cross([0.0, 1.0, 0.0], blocks.centroid[1] - [0.5 - 1e-3, 0.075, 0.0])
    alone *= blocks.free.sum() / alone[blocks.free, 0].sum()
    check = named(SIMILARITY, judged(analysis, driven(analysis, alone, bound.forces, bound.value)))
    assert check.verdict is Verdict.AGREE and "not unique" in check.reason


@pytest.mark.parametrize(("multiplier", "is_nothing"), [(0.99e-4, True), (1.01e-4, False), (0.3, False)])
def test_a_multiplier_of_less_than_its_floor_bears_nothing_and_sharp_edges_may_bear_more(multiplier: float, is_nothing: bool) -> None:
    analysis = pushed(scenes.box("block", (0.0, 0.0, 0.0), (0.6, 0.15, 0.4)), friction=0.35)
    bound = dataclasses.replace(analysis.bounds[Drive.LIVE], value=multiplier)
    told = _where_nothing_is_borne(with_answers(analysis, bounds={Drive.LIVE: bound}))
    assert (told != "") is is_nothing
    assert not told or (told.startswith(BEARS_NOTHING) and "With sharp edges the multiplier is 0.35:" in told)


def test_a_block_that_slides_under_a_live_load_has_the_friction_state_of_its_multiplier() -> None:
    analysis = pushed(scenes.box("block", (0.0, 0.0, 0.0), (0.6, 0.15, 0.4)), friction=0.35)
    coulomb = coulomb_of(analysis)
    run = driven(analysis, coulomb.twists * analysis.assembly.weight, coulomb.forces, coulomb.value)
    check = named("YADE's friction state", judged(analysis, run))
    assert check.verdict is Verdict.AGREE and (check.limit_analysis, check.yade) == pytest.approx((0.35, 0.35), rel=1e-3)


@pytest.mark.parametrize(
    ("shares", "verdict"),
    [
        ((0.9, 1.0, 1.0), Verdict.AGREE),
        ((1.1, 1.0, 1.0), Verdict.AGREE),
        ((1.0, 1.0, 1.1), Verdict.DISAGREE),
        ((1.0, 1.0, 0.9), Verdict.DISAGREE),
    ],
    ids=["less load", "more load", "more weight", "less weight"],
)
def test_the_force_sums_under_a_live_load_are_those_of_equilibrium_at_yades_own_multiplier(
    shares: tuple[float, float, float], verdict: Verdict
) -> None:
    """The force sums grow with the multiplier, which another check compares. Here their share of the weight decides."""
    courses = [scenes.box(f"block {k}", (0.0, 0.0, 0.2 * k), (0.6, 0.15, 0.2 * (k + 1))) for k in range(2)]
    analysis = pushed(*courses, friction=0.35)
    forces = coulomb_of(analysis).forces * shares
    run = driven(analysis, coulomb_of(analysis).twists * analysis.assembly.weight, forces, shares[0] * 0.35)
    (check,) = check_sections(Results(analysis, run))
    assert check.verdict is verdict
    if verdict is Verdict.DISAGREE:  # the values belong to one cut and axis: here they are weights
        assert check.limit_analysis == pytest.approx(0.5 * analysis.assembly.weight, rel=1e-6)
        assert check.yade == pytest.approx(shares[2] * check.limit_analysis)


def test_a_mechanism_per_motion_along_a_live_load_moves_the_pushed_weight_by_one_on_the_mean() -> None:
    """A dead load by force is part of the weight, but is not pushed. A mass beside the centroid is pushed at its own place."""
    courses = [scenes.box(f"block {k}", (0.0, 0.0, 0.5 * k), (0.4, 0.15, 0.5 * (k + 1))) for k in range(2)]
    force = scenes.table("[load]", blocks=["block 1"], force=(0.0, 0.0, -3000.0))
    mass = scenes.table("[load]", blocks=["block 1"], mass=50.0, at=(0.2, 0.075, 1.0))
    analysis = pushed(*courses, force, mass, friction=0.9)
    twists, mass = Results(analysis).per_motion(analysis.bounds[Drive.LIVE].twists)[-2:], 2000.0 * 0.4 * 0.15 * 0.5
    of_load = twists[1, 0] + 0.25 * twists[1, 4]  # half a block above the centroid
    assert (mass * twists[:, 0].sum() + 50.0 * of_load) / (2.0 * mass + 50.0) == pytest.approx(1.0)


def test_a_mechanism_against_the_load_has_no_measure_per_power_of_the_load() -> None:
    analysis = pushed(scenes.box("block", (0.0, 0.0, 0.0), (0.6, 0.15, 0.4)), friction=0.35)
    results, twists = Results(analysis), analysis.bounds[Drive.LIVE].twists
    np.testing.assert_allclose(results.per_drive(results.per_motion(twists)), twists)
    assert np.isnan(results.per_drive(-twists)).all() and np.isnan(results.per_drive(0.0 * twists)).all()


# --- states, mechanisms and scatter -------------------------------------------------------------------------------------------------


def twisted(assembly: Assembly, size: float) -> np.ndarray:
    """Return forces (C, 3), N: two opposite forces along a joint at two of its points, which are in equilibrium at any size."""
    interface = assembly.points.interface
    pair = np.flatnonzero(interface == interface[0])[:2]
    along = assembly.points.position[pair[1]] - assembly.points.position[pair[0]]
    forces = np.zeros((len(interface), 3))
    forces[pair] = np.outer([1.0, -1.0], size * along / np.linalg.norm(along))
    return forces


def test_a_state_that_breaks_the_friction_law_is_seen_although_it_is_in_equilibrium(pads: LimitAnalysis) -> None:
    run = perfect_run(pads)
    run.poses.forces[:] += twisted(pads.assembly, 0.5 * pads.assembly.mean_weight)
    found = judged(pads, run)
    assert named("balance along the mechanism", found).verdict is Verdict.AGREE
    assert named("equilibrium of the YADE state", found).verdict is Verdict.INCONCLUSIVE


@pytest.mark.parametrize("is_in_balance", [True, False])
def test_a_state_out_of_equilibrium_does_not_contradict_the_prediction(pads: LimitAnalysis, is_in_balance: bool) -> None:
    """A horizontal force at a base without horizontal motion has no power. A balanced state beyond the friction cones does contradict."""
    run = perfect_run(pads, reaction=1.1 * pads.bounds[Drive.YIELDING].value)
    force = 0.5 * pads.assembly.mean_weight
    across = np.zeros_like(run.poses.forces[0])
    across[0, 0] = force
    run.poses.forces[:] += twisted(pads.assembly, force) if is_in_balance else across
    found = judged(pads, run)
    assert named("equilibrium of the YADE state", found).verdict is Verdict.INCONCLUSIVE
    assert named("balance along the mechanism", found).verdict is Verdict.AGREE
    expected = Verdict.DISAGREE if is_in_balance else Verdict.INCONCLUSIVE
    assert named("reaction against prediction", found).verdict is expected


def test_the_wrenches_of_a_state_act_where_the_run_has_moved_blocks_and_points(pads: LimitAnalysis) -> None:
    """A block has slid and turned over pads at rest. Each contact point is midway between its places on pad and block."""
    assembly, run = pads.assembly, perfect_run(pads)
    (block,) = np.flatnonzero(assembly.blocks.free)
    slid, turned = np.array([0.02, 0.0, -0.01]), np.array([0.0, 0.03, 0.0])
    run.poses.displacement[:], run.poses.rotation[:] = 0.0, 0.0
    run.poses.displacement[-2:, block], run.poses.rotation[-2:, block] = slid, turned
    last = dataclasses.replace(run, result=dataclasses.replace(run.result, plateau_start=run.poses.settlement[-2]))
    found, centroid = last.plateau_wrenches(assembly), assembly.blocks.centroid[block]
    sign = np.where(assembly.contact_blocks[1] == block, 1.0, -1.0)[:, None]
    force, built = sign * run.poses.forces[-1], assembly.points.position - centroid
    arm = built - 0.5 * slid + 0.5 * np.cross(turned, built)  # the block has gone the whole way, the point half of it
    np.testing.assert_allclose(found[block], [*force.sum(axis=0), *np.cross(arm, force).sum(axis=0)], atol=1e-9)


def test_the_forces_of_a_plateau_are_the_mean_of_its_states(pads: LimitAnalysis) -> None:
    run = perfect_run(pads)
    run.poses.forces[:] *= np.array([9.0, 9.0, 1.0, 2.0, 6.0])[:, None, None]  # two states before the plateau, three on it
    np.testing.assert_allclose(run.plateau_forces(), 3.0 * pads.bounds[Drive.YIELDING].forces)


def test_joints_that_slide_in_yade_alone_leave_the_mechanism_undetermined(pads: LimitAnalysis) -> None:
    """Limit analysis modelled friction and found no sliding. Where joints slide in YADE, YADE's friction state is checked."""
    modelled = pads.with_effects(pads.assembly.effects.with_effect("friction", "coulomb", "the scene says so"))
    run = coulomb_run(pads)
    names = [check.name for check in judged(modelled, run)]
    assert REACTION in names and "YADE's friction state" not in names
    run.poses.displacement[:, np.flatnonzero(pads.assembly.blocks.free), 0] += 0.5 * run.poses.settlement[:, None]
    assert "YADE's friction state" in [check.name for check in judged(modelled, run)]


def test_a_mechanism_that_does_the_same_work_but_penetrates_is_another_one() -> None:
    """A voussoir that also moves horizontally into its neighbour belongs to no mechanism of the arch, although the work is the same."""
    arch = analyse(scenes.shipped("arch_spreading"))
    run = perfect_run(arch)
    run.poses.displacement[:, np.flatnonzero(arch.assembly.blocks.free)[3], 0] += 3.0 * run.poses.settlement
    check = named(SIMILARITY, judged(arch, run))
    assert check.verdict is Verdict.DISAGREE and "not unique" not in check.reason
    assert check.limit_analysis == 1.0 and check.yade is not None and check.yade < 0.95
    assert check.difference == check.yade - 1.0  # YADE's number less that of limit analysis, as in every check


def test_a_mechanism_that_yade_does_not_show_is_no_agreement_even_where_the_reactions_agree(wall: LimitAnalysis) -> None:
    run = coulomb_run(wall)
    kept = dataclasses.replace(run.poses, **{name: values[[0, -1]] for name, values in vars(run.poses).items()})
    found = judged(wall, dataclasses.replace(run, poses=kept))
    assert named(REACTION, found).verdict is Verdict.AGREE
    assert named(SIMILARITY, found).verdict is Verdict.INCONCLUSIVE and overall(found)[0] is Verdict.INCONCLUSIVE


def test_a_mechanism_that_yade_does_not_show_is_not_another_one_where_no_joint_slides(pads: LimitAnalysis) -> None:
    run = perfect_run(pads)
    kept = dataclasses.replace(run.poses, **{name: values[[0, -1]] for name, values in vars(run.poses).items()})
    found = judged(pads, dataclasses.replace(run, poses=kept))
    check = named(SIMILARITY, found)
    assert check.verdict is Verdict.INCONCLUSIVE and "fewer than two states" in check.reason and "[yade] poses" in check.next_step
    assert not [check for check in found if check.name == MOVING]


def test_a_sloping_plateau_and_the_way_to_it_are_no_stick_slip(wall: LimitAnalysis) -> None:
    value = coulomb_of(wall).value
    run = coulomb_run(wall, slope=0.1 * value / TRAVEL)
    settlement = run.record.settlement
    run.record.reaction[:] = value * (1.0 + 0.1 * settlement / TRAVEL)
    run.record.reaction[settlement < run.result.plateau_start] *= 1.5
    check = named("steadiness of the plateau", judged(wall, run))
    assert check.yade == pytest.approx(0.0, abs=1e-12) and check.reason == ""


def test_the_state_of_friction_is_known_as_well_as_the_reaction(wall: LimitAnalysis) -> None:
    first, second = (named("YADE's friction state", judged(wall, coulomb_run(wall, uncertainty=one))) for one in (0.0, 5.0))
    assert first.tolerance is not None and second.tolerance == pytest.approx(first.tolerance + 5.0)


# --- standing and falling structures ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("friction", "verdict"), [(0.0, Verdict.DISAGREE), (0.6, Verdict.INCONCLUSIVE)])
def test_a_structure_without_friction_that_can_stand_must_stand(friction: float, verdict: Verdict) -> None:
    """With friction, a structure may fall although an equilibrium exists."""
    pad = [scenes.box(f"pad {k}", (0.6 * k, 0.0, -0.1), (0.6 * k + 0.4, 0.2, 0.0), role) for k, role in enumerate(("fixed", "support"))]
    analysis = analyse(scenes.build(*pad, scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.2, 0.4)), inset=1e-3, friction=friction))
    found = judged(analysis, perfect_run(analysis, status="collapsed", reaction=math.nan))
    assert named("the structure stands", found).verdict is verdict


def test_a_fall_after_a_block_that_moved_far_says_that_contacts_may_have_been_missed(pads: LimitAnalysis) -> None:
    small = pads.with_effects(pads.assembly.effects.with_effect("displacement", "small", "nothing is near"))
    run = perfect_run(pads, status="collapsed", reaction=math.nan)
    for gap, named_checks in ((1e-5, 2), (1.0, 1)):
        found = judged(dataclasses.replace(small, least_gap=gap), run)
        assert len(found) == named_checks and found[-1].name == "the structure stands"


def test_a_transverse_force_may_miss_its_range_by_a_share_of_the_weight(pads: LimitAnalysis) -> None:
    """A share of the reaction would not do: the reaction is 0 where only the support moves, but the blocks have their weight."""
    check = named("support's force along", judged(pads, perfect_run(pads)))
    assert check.tolerance == pytest.approx(SECTION * pads.scene.weight)


def test_a_transverse_force_may_be_as_large_as_friction_under_yades_own_forces_allows() -> None:
    """Friction of the support may push the block against a wall on the left by up to mu R. R is that of YADE's forces, not the plateau."""
    parts = (
        scenes.box("wall", (-1.0, 0.0, 0.0), (0.0, 1.0, 1.0), "fixed"),
        scenes.box("base", (0.0, 0.0, -0.1), (1.0, 1.0, 0.0), "support"),
        scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
    )
    analysis = analyse(scenes.build(*parts, friction=0.5, inset=1e-3))
    weight, (a, b) = analysis.assembly.weight, analysis.assembly.contact_blocks
    run = perfect_run(analysis, reaction=1.02 * weight, uncertainty=0.04 * weight)
    on_base = (np.minimum(a, b) == 1) & (np.maximum(a, b) == 2)
    run.poses.forces[:] = np.where(on_base, np.sign(b - a), 0.0)[:, None] * [0.0, 0.0, weight / on_base.sum()]
    (check,) = (check for check in check_sections(Results(analysis, run)) if check.name == "support's force along x, in its range")
    assert check.verdict is Verdict.AGREE and check.yade == pytest.approx(0.0, abs=1e-9)
    tolerance = 0.005 * 1.02 + 0.04  # of the weight
    assert check.range == pytest.approx((-0.5 * (1.0 + tolerance) * weight, 0.0), abs=1e-5 * weight)


def test_an_expected_value_below_zero_is_met_to_a_requested_accuracy_of_its_size(pads: LimitAnalysis) -> None:
    assert pads.scene.expected is not None
    expected = pads.scene.expected.model_copy(update={"reaction_over_weight": -0.5, "tolerance": 1e-6})
    scene = dataclasses.replace(pads.scene, expected=expected)
    check = next(iter(check_expected(dataclasses.replace(pads, scene=scene, accuracy=AccuracyRecord(0.01)))))
    assert check.tolerance == pytest.approx(0.005)


def test_the_multiplier_of_the_judged_states_is_the_one_that_acted_on_them() -> None:
    """The multiplier rises over the plateau, and so do the forces. Their mean state is in balance under the mean multiplier."""
    analysis = pushed(scenes.box("block", (0.0, 0.0, 0.0), (0.5, 0.15, 0.7)), friction=0.9)
    bound = analysis.bounds[Drive.LIVE]
    run = driven(analysis, bound.twists * analysis.assembly.weight, bound.forces, bound.value)
    kept = run.poses.settlement >= run.result.plateau_start
    mean = run.poses.settlement[kept].mean()
    run.record.reaction[:] = bound.value * (1.0 + 0.1 * (run.record.settlement - mean) / TRAVEL)
    assert named("balance along the mechanism", judged(analysis, run)).verdict is Verdict.AGREE
    assert Results(analysis, run).recorded.plateau_forces() == pytest.approx(bound.forces)


def test_without_a_plateau_the_last_state_is_judged_under_its_own_multiplier() -> None:
    """The load still rises: the last stored state is in balance under the multiplier at the end, but under no earlier multiplier."""
    analysis = pushed(scenes.box("block", (0.0, 0.0, 0.0), (0.5, 0.15, 0.7)), friction=0.9)
    bound = analysis.bounds[Drive.LIVE]
    run = driven(analysis, bound.twists * analysis.assembly.weight, bound.forces, bound.value)
    run.record.reaction[:] = bound.value * run.record.settlement / run.poses.settlement[-1]
    run = dataclasses.replace(run, result=dataclasses.replace(run.result, status="no plateau", plateau_start=math.nan))
    assert named("equilibrium", judged(analysis, run)).verdict is Verdict.AGREE
    run.record.reaction[:] *= 0.9
    assert named("equilibrium", judged(analysis, run)).verdict is Verdict.INCONCLUSIVE


@pytest.mark.parametrize(
    ("settlement", "labels"),
    [
        ({"direction": (0.0, 0.0, -1.0)}, ["x", "y"]),
        ({"direction": (1.0, 0.0, 0.0)}, ["y", "z"]),
        ({"direction": (0.0, 0.0, -1.0), "zone": [{"blocks": ["base"], "ratio": 0.5}]}, ["x", "y", "z"]),
        ({"axis": (0.0, 1.0, 0.0), "point": (0.0, 0.0, 0.0)}, ["x", "y", "z"]),
    ],
    ids=["down", "aside", "by a part of it", "turning"],
)
@pytest.mark.parametrize("plane", [True, False])
def test_the_support_s_force_is_compared_across_its_motion_or_along_all_axes(
    settlement: dict[str, Any], labels: list[str], plane: bool
) -> None:
    """All axes are compared if the reaction is a moment or a sum of shares of forces. A plane model has no force along y."""
    parts = (scenes.box("base", (0.0, 0.0, -0.1), (1.0, 1.0, 0.0), "support"), scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)))
    scene = scenes.build(*parts, plane=plane, settlement=settlement)
    found = dict(_transverse_directions(scene, plane))
    assert sorted(found) == [label for label in labels if label != "y" or not plane]
    assert all(unit == pytest.approx(np.eye(3)["xyz".index(label)]) for label, unit in found.items())


def test_an_oblique_direction_across_a_settlement_is_named_by_its_components_and_points_forwards() -> None:
    parts = (scenes.box("base", (0.0, 0.0, -0.1), (1.0, 1.0, 0.0), "support"), scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)))
    scene = scenes.build(*parts, plane=True, settlement=(0.6, 0.0, -0.8))
    ((label, unit),) = _transverse_directions(scene, True)
    assert label == "(0.8, 0, 0.6)" and unit == pytest.approx([0.8, 0.0, 0.6])
    ((label, _),) = _transverse_directions(scenes.build(*parts, plane=True, settlement=(0.01, 0.0, -1.0)), True)
    assert label == "(1, 0, 0.01)"
