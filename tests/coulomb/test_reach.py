"""Reach: blocks that the support's motion cannot affect are set aside and no answer changes. A guard refuses a wrong choice."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scenes
from conftest import Silent
from runs import made_up_run, with_answers

from comparison.judge.checks.reduced_model import check_reach
from comparison.verdict.check import Verdict
from comparison.workflow.one_scene import run_scene
from comparison.yade import Results, read_results
from comparison.yade.run_record import Run
from la_core import exchange
from la_core.analysis import reach
from la_core.analysis.case_file import read_case, write_case
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.coulomb import ACCEPTED_RESIDUAL, PathProgress, predict, prediction
from la_core.errors import SceneError
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.measures import residuals
from la_core.model.assembly import Assembly, assemble
from la_core.scene import shipped
from la_core.scene.scene import Scene, load_scene
from yade_scripts import case as yade_case

HISTORY = 1e-2  # of the reaction: largest change by friction's history next to blocks set aside, on these walls

SAME = 1e-9  # of the value: one and the same computation
SOLVER = 1e-6  # of the weight: two solutions of one programme
INSET = 0.001


class Heard(Silent):
    """A listener that keeps the number of blocks and of the path in each report."""

    def __init__(self) -> None:
        self.paths: dict[int, set[int]] = {}

    def path(self, report: PathProgress) -> None:
        self.paths.setdefault(report.blocks, set()).add(report.path)


def end_settles(**options: Any) -> Scene:
    """A wall of 30 x 6 blocks whose right end settles."""
    return scenes.build(*scenes.wall(30, 6, split=11.2), **{"inset": INSET, "model": "coulomb", **options})


def middle_settles(**options: Any) -> Scene:
    """A wall of 40 x 6 blocks that settles on the four in its middle."""
    below = (
        scenes.box("left", (0.0, 0.0, -0.2), (7.2, 0.3, 0.0), "fixed"),
        scenes.box("support", (7.2, 0.0, -0.2), (8.8, 0.3, 0.0), "support"),
        scenes.box("right", (8.8, 0.0, -0.2), (16.0, 0.3, 0.0), "fixed"),
    )
    return scenes.build(scenes.wall(40, 6)[0], *below, inset=INSET, model="coulomb", **options)


def window_beside(**options: Any) -> Scene:
    """A wall of 30 x 8 blocks with two windows far from its settling end and one near to it."""
    openings = [{"from": [x, 0.4], "to": [x + 0.8, 1.0], "bearing": 0.2} for x in (1.2, 4.0, 8.0)]
    return scenes.build(*scenes.wall(30, 8, split=11.2, opening=openings), inset=INSET, model="coulomb", **options)


def pushed_row(**options: Any) -> Scene:
    """A wall of 20 x 2 blocks that slides off as a whole, pushed at its left end."""
    push = scenes.box("support", (-0.4, 0.0, 0.0), (0.0, 0.3, 0.2), "support")
    return scenes.build(*scenes.wall(20, 2), push, settlement=(1.0, 0.0, 0.0), inset=INSET, model="coulomb", **options)


def reaction(analysis: LimitAnalysis) -> float:
    assert analysis.coulomb is not None
    return analysis.coulomb.value


def reduced(scene: Scene, layers: int) -> tuple[Assembly, Assembly]:
    """The whole assembly, and the assembly reduced to the region with `layers` of neighbours, without any guard."""
    whole = assemble(scene)
    return whole, reach.set_aside(whole, whole.blocks.free & ~reach.region(whole, layers))


# --- agreement -----------------------------------------------------------------------------------------------------------------


@pytest.mark.slow_after_first
@pytest.mark.parametrize("scene", [end_settles, middle_settles, window_beside])
def test_setting_aside_changes_no_answer(scene) -> None:
    part, whole = analyse(scene(reach="auto")), analyse(scene(reach=False))
    assert part.assembly.effects.reach and not whole.assembly.effects.reach
    assert part.assembly.aside.sum() >= reach.LEAST_BLOCKS
    weight = whole.assembly.weight
    for drive in (Drive.YIELDING, Drive.PUSHING):
        assert part.bounds[drive].value == pytest.approx(whole.bounds[drive].value, abs=SOLVER * weight)
        assert part.sharp.bounds[drive].value == pytest.approx(whole.sharp.bounds[drive].value, abs=SOLVER * weight)
    assert part.coulomb is not None and whole.coulomb is not None
    assert part.coulomb.status is Status.SOLVED
    assert part.coulomb.value == pytest.approx(whole.coulomb.value, rel=HISTORY)
    assert part.sharp.coulomb is None and whole.sharp.coulomb is None  # joints slide, and the edges are rounded
    assert whole.coulomb.interval[0] <= part.coulomb.value <= whole.coulomb.interval[1]
    assert part.coulomb.at_rest == pytest.approx(whole.coulomb.at_rest, rel=SAME)


def test_where_no_joint_may_slide_the_answer_is_the_same_too() -> None:
    part, whole = (analyse(end_settles(model="none-slides", reach=asked)) for asked in (True, False))
    assert part.assembly.effects.reach
    for drive in (Drive.YIELDING, Drive.PUSHING):
        assert part.bounds[drive].status is whole.bounds[drive].status
    assert part.bounds[Drive.YIELDING].value == pytest.approx(whole.bounds[Drive.YIELDING].value, abs=SOLVER * whole.assembly.weight)


@pytest.mark.slow
def test_a_wall_far_away_is_set_aside_whole_and_leaves_the_reaction_as_it_is() -> None:
    near = scenes.wall(10, 6, split=2.8)
    far = (scenes.box("far base", (20.0, 0.0, -0.2), (24.0, 0.3, 0.0), "fixed"),)
    row = [
        scenes.box(f"far {i} {k}", (20.0 + 0.4 * i, 0.0, 0.2 * k), (20.4 + 0.4 * i, 0.3, 0.2 * k + 0.2))
        for i in range(10)
        for k in range(6)
    ]
    alone = analyse(scenes.build(*near, inset=INSET, model="coulomb"))
    both = analyse(scenes.build(*near, *far, *row, inset=INSET, model="coulomb", reach=True))
    names = np.array(both.assembly.blocks.names)
    assert set(names[both.assembly.aside]) >= {name for name in names if name.startswith("far ") and name != "far base"}
    assert reaction(both) == pytest.approx(reaction(alone), rel=HISTORY)


def test_both_parts_together_are_a_state_of_the_whole_structure() -> None:
    scene = end_settles()
    part = analyse(scene)
    assert part.coulomb is not None
    whole = assemble(scene)
    lifted, _ = reach.extend_forces(whole, part.assembly, part.coulomb.forces)
    assert residuals.equilibrium_residual(whole, lifted) <= ACCEPTED_RESIDUAL
    assert residuals.cone_violation(whole, lifted) <= ACCEPTED_RESIDUAL
    assert residuals.reaction(whole, lifted) == pytest.approx(part.coulomb.value, rel=SAME)


def test_what_is_set_aside_rests_and_the_support_s_blocks_never_are() -> None:
    part = analyse(end_settles())
    assert part.coulomb is not None
    assert not np.any(part.coulomb.twists[part.assembly.aside])
    a, b = part.assembly.contact_blocks
    touching = np.union1d(b[part.assembly.blocks.role[a] == exchange.SUPPORT], a[part.assembly.blocks.role[b] == exchange.SUPPORT])
    assert len(touching) and not part.assembly.aside[touching].any()


def test_shares_of_the_mass_are_of_all_free_blocks() -> None:
    scene = end_settles()
    assert analyse(scene).assembly.movable_mass * np.linalg.norm(scene.gravity) == pytest.approx(scene.weight, rel=1e-12)


# --- difference and guard ------------------------------------------------------------------------------------------------------


def test_a_region_too_small_has_another_answer_and_is_refused() -> None:
    scene = middle_settles(reach=False)
    whole, part = reduced(scene, 0)
    analysis = analyse(scene)
    wrong = predict(part, analysis.stiffness, analysis.bounds[Drive.YIELDING])
    assert wrong.value < 0.9 * reaction(analysis)  # the wall hangs by friction between blocks that cannot yield
    assert "on the support" in reach.why_not_valid(whole, part, wrong.twists, wrong.forces)


def test_a_mechanism_that_comes_near_what_is_set_aside_refuses_the_region() -> None:
    """A block at rest beside the blocks set aside is made to move by more than 5 % of the support's speed, and by less."""
    part = analyse(end_settles())
    assert part.coulomb is not None
    whole, region, forces = assemble(part.scene), part.assembly, part.coulomb.forces
    assert reach.why_not_valid(whole, region, part.coulomb.twists, forces) == ""
    a, b = whole.interfaces.block_a, whole.interfaces.block_b
    pairs = (*zip(a, b, strict=True), *zip(b, a, strict=True))
    beside = next(two for one, two in pairs if region.aside[one] and region.blocks.free[two])
    for speed, refused in ((0.06, True), (0.04, False)):
        twists = part.coulomb.twists.copy()
        twists[beside] = [0.0, 0.0, -speed, 0.0, 0.0, 0.0]
        words = f'block "{whole.blocks.names[beside]}" moves within {reach.MARGIN} layers of the blocks set aside'
        assert reach.why_not_valid(whole, region, twists, forces) == (words if refused else "")


def test_a_value_after_a_release_is_told_where_its_own_state_is_proven(monkeypatch: pytest.MonkeyPatch) -> None:
    told = analyse(end_settles())
    assert told.assembly.aside.any() and told.coulomb is not None and told.coulomb.released_state is not None
    _, released = told.coulomb.released_state
    original = reach.why_not_valid

    def refused(whole: Assembly, reduced: Assembly, twists: np.ndarray, forces: np.ndarray) -> str:
        return "its blocks fall" if np.array_equal(forces, released) else original(whole, reduced, twists, forces)

    monkeypatch.setattr(reach, "why_not_valid", refused)
    left_out = analyse(end_settles())
    assert left_out.assembly.aside.any() and left_out.coulomb is not None
    assert np.isfinite(told.coulomb.released) and np.isnan(left_out.coulomb.released)
    assert left_out.coulomb.value == told.coulomb.value
    assert "turning blocks may release a thrust" in left_out.assembly.effects.reasons["rotation"]


@pytest.mark.parametrize(("requested", "rounds"), [(True, 3), (False, 1)])
def test_paths_that_begin_again_say_how_many_blocks_they_model(requested: bool, rounds: int) -> None:
    heard = Heard()
    analysis = analyse(pushed_row(reach=requested), listener=heard)
    counts = list(heard.paths)
    assert len(counts) == rounds and counts == sorted(counts) and counts[-1] == analysis.assembly.blocks.free.sum()
    assert {1, 2} <= heard.paths[counts[-1]]
    assert all(heard.paths[count] == {1} for count in counts[:-1])  # the coarsest path shows that the answer would not hold


@pytest.mark.slow_after_first
@pytest.mark.parametrize("threads", ["1", "2"])
def test_smooth_paths_side_by_side_give_up_a_region_and_find_the_same_answer(threads: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(prediction, "LARGE", 0.0)
    monkeypatch.setenv("OMP_NUM_THREADS", threads)
    heard, (asked, plain) = Heard(), (pushed_row(reach=request) for request in (True, False))
    given_up, whole = analyse(asked, listener=heard), analyse(plain)
    assert len(heard.paths) == 3 and "moves within" in given_up.assembly.effects.reasons["reach"]
    assert reaction(given_up) == pytest.approx(reaction(whole), rel=SAME)


def test_what_moves_as_a_whole_is_modelled_as_a_whole_and_the_reason_is_told() -> None:
    whole, part = reduced(pushed_row(), reach.LAYERS[0])
    assert part.aside.any()
    asked, plain = analyse(pushed_row(reach=True)), analyse(pushed_row(reach=False))
    effects = asked.assembly.effects
    assert not effects.reach and not asked.assembly.aside.any()
    assert "the whole structure is modelled, because" in effects.reasons["reach"] and 'block "' in effects.reasons["reach"]
    assert reaction(asked) == pytest.approx(reaction(plain), rel=SAME)
    assert reaction(asked) == pytest.approx(-0.6 * whole.weight, rel=HISTORY)  # the whole row slides on its bed


def test_a_part_that_cannot_stand_is_found_although_it_could_be_set_aside() -> None:
    ledge = scenes.box("ledge", (20.0, 0.0, -0.2), (20.4, 0.3, 0.0), "fixed")
    overhang = scenes.box("overhang", (20.3, 0.0, 0.0), (20.9, 0.3, 0.2))
    scene = scenes.build(*scenes.wall(30, 6, split=11.2), ledge, overhang, inset=INSET, model="coulomb", reach=True)
    analysis = analyse(scene)
    assert analysis.bounds[Drive.YIELDING].status is Status.INFEASIBLE
    assert analysis.bounds[Drive.YIELDING].falling == ("overhang",)
    whole, part = reduced(scene, reach.LAYERS[0])
    assert part.aside[whole.blocks.names.index("overhang")]
    answer = solve_associated(part, Drive.YIELDING)  # the region does not contain the overhang
    assert answer.status is Status.SOLVED
    assert '"overhang"' in reach.why_not_valid(whole, part, np.full((len(whole.blocks), 6), np.nan), answer.forces)


# --- choice --------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [name for name in shipped.names() if name not in shipped.LONG])
def test_small_shipped_scenes_are_modelled_whole(name: str) -> None:
    scene = load_scene(shipped.find(name))
    masks, why = reach.candidate_masks(scene, assemble(scene), INSET)
    assert masks == [] and why


@pytest.mark.parametrize(("per_course", "split", "most"), [(36, 7.0, 1), (36, 6.0, 0), (24, 3.2, 0)])
def test_what_is_far_from_the_support_is_set_aside_where_it_is_enough(per_course, split, most) -> None:
    """140 of 511 blocks lie beyond the reach, 112 of 511, and 20 of 343."""
    auto, asked = (scenes.build(*scenes.wall(per_course, 14, split=split), model="coulomb", reach=choice) for choice in ("auto", True))
    assembly = assemble(auto)
    assert len(reach.candidate_masks(auto, assembly, INSET)[0]) == most
    masks, _ = reach.candidate_masks(asked, assembly, INSET)
    assert masks and not any((mask & reach.region(assembly, reach.LAYERS[0])).any() for mask in masks)


def two_walls(gap: float, *parts: str, **options: Any) -> Scene:
    """A wall of 5 x 4 blocks whose right end settles, and one of 3 x 3 blocks on ground of its own, a gap (m) beyond its end."""
    left = 2.0 + gap
    other = scenes.table(
        "[wall]", name="other", bond="running", origin=(left, 0.0, 0.0), block=(0.4, 0.3, 0.2), per_course=3, courses=3, first="full"
    )
    ground = scenes.box("ground of the other", (left, 0.0, -0.2), (left + 1.2, 0.3, 0.0), "fixed")
    return scenes.build(*scenes.wall(5, 4, split=1.2), other, ground, *parts, inset=INSET, model="coulomb", **options)


def test_blocks_that_nothing_joins_to_the_support_are_set_aside_and_change_no_answer() -> None:
    """The other wall stands half a metre away: both methods leave it out, however few its blocks are."""
    part, whole = analyse(two_walls(0.5)), analyse(two_walls(0.5, reach=False))
    free = [name for name, is_free in zip(whole.assembly.blocks.names, whole.assembly.blocks.free, strict=True) if is_free]
    aside = [name for name, is_aside in zip(part.assembly.blocks.names, part.assembly.aside, strict=True) if is_aside]
    assert len(aside) == len(free) - int(analyse(scenes.build(*scenes.wall(5, 4, split=1.2), inset=INSET)).assembly.blocks.free.sum()) > 0
    assert part.coulomb is not None and whole.coulomb is not None
    assert part.coulomb.status is Status.SOLVED
    assert reaction(part) == pytest.approx(reaction(whole), abs=part.coulomb.uncertainty + whole.coulomb.uncertainty)


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(two_walls(1e-4), id="they may meet"),
        pytest.param(two_walls(0.5, scenes.box("beam", (1.7, 0.0, 0.8), (2.7, 0.3, 0.9))), id="a beam joins them"),
    ],
)
def test_walls_that_may_meet_or_that_a_beam_joins_are_modelled_together(scene: Scene) -> None:
    assert not analyse(scene).assembly.aside.any()


def test_a_fixed_block_joins_nothing_to_the_support() -> None:
    """The same two walls lean against one fixed pier between them."""
    pier = scenes.box("pier", (2.0, 0.0, 0.0), (2.5, 0.3, 0.6), "fixed")
    analysis = analyse(two_walls(0.5, pier))
    assert analysis.assembly.aside.any()


def test_a_live_load_reaches_every_block() -> None:
    parts = scenes.wall(3, 3)
    assert "every block" in analyse(scenes.build(*parts, live=(1.0, 0.0, 0.0))).assembly.effects.reasons["reach"]
    with pytest.raises(SceneError, match=r"effects.reach.*live load"):
        analyse(scenes.build(*parts, live=(1.0, 0.0, 0.0), reach=True))


# --- case.h5 and YADE ----------------------------------------------------------------------------------------------------------


def test_case_file_keeps_what_was_set_aside_and_yade_lays_no_body_it_does_not_need(tmp_path: Path) -> None:
    scene = end_settles()
    analysis = analyse(scene)
    write_case(tmp_path / "case.h5", analysis, "")
    again = read_case(tmp_path / "case.h5", scene)
    assert again.assembly.effects == analysis.assembly.effects
    assert np.array_equal(again.assembly.aside, analysis.assembly.aside)
    assert np.array_equal(again.assembly.points.position, analysis.assembly.points.position)
    assert reaction(again) == reaction(analysis)
    one = yade_case.from_fields(exchange.read(tmp_path / "case.h5", exchange.CASE_FIELDS))
    assert one.total == len(scene.blocks) > len(one.index)
    assert np.array_equal(one.centroid, scene.blocks.centroid[one.index])
    assert np.array_equal(one.index[one.block_a], analysis.assembly.contact_blocks[0])
    assert len(one.free) == analysis.assembly.blocks.free.sum()
    assert set(np.flatnonzero(analysis.assembly.aside)) > set(one.index[one.role == exchange.FIXED][1:])


def plateau_of(analysis: LimitAnalysis, forces: np.ndarray) -> Run:
    """A run whose plateau carries these forces (C, 3) and whose blocks move by the Coulomb mechanism."""
    assert analysis.coulomb is not None
    moved = np.stack([np.zeros_like(analysis.coulomb.twists), analysis.coulomb.twists])
    poses = {"settlement": np.array([0.0, 1.0]), "forces": np.stack([forces, forces])}
    poses |= {"displacement": moved[..., :3], "rotation": moved[..., 3:]}
    return made_up_run({"plateau_start": 0.0}, poses=poses)


def test_forces_of_yade_that_the_part_set_aside_cannot_bear_are_noticed() -> None:
    scene = end_settles()
    analysis = analyse(scene)
    assert analysis.coulomb is not None
    (check,) = check_reach(Results(analysis, plateau_of(analysis, analysis.coulomb.forces)))
    assert check.verdict is Verdict.AGREE
    a, b = analysis.assembly.contact_blocks
    thrust = np.where(
        (analysis.assembly.aside[a] | analysis.assembly.aside[b])[:, None], analysis.assembly.weight * analysis.assembly.normal, 0.0
    )
    (check,) = check_reach(Results(analysis, plateau_of(analysis, analysis.coulomb.forces + thrust)))
    assert check.verdict is Verdict.INCONCLUSIVE
    assert "would not stand" in check.reason and "reach = false" in check.next_step
    moving = plateau_of(analysis, analysis.coulomb.forces)
    moving.poses.displacement[1, analysis.assembly.aside] = 1.0
    (check,) = check_reach(Results(analysis, moving))
    assert check.verdict is Verdict.INCONCLUSIVE and "moves within" in check.reason
    whole = with_answers(analysis, assembly=assemble(scene))
    assert list(check_reach(Results(whole, plateau_of(analysis, analysis.coulomb.forces)))) == []


@pytest.mark.yade
@pytest.mark.slow
def test_yade_agrees_with_itself_whether_a_part_is_set_aside_or_not(tmp_path: Path) -> None:
    found = {}
    for asked in (True, False):
        path = tmp_path / f"reach_{asked}.toml".lower()
        path.write_text(scenes.text(*scenes.wall(20, 3, split=7.2), inset=INSET, model="coulomb", reach=asked))
        summary = run_scene(load_scene(path), tmp_path / path.stem, Silent(), with_yade=True)
        assert summary["verdict"] == "agree", summary["reason"]
        results = read_results(tmp_path / path.stem)
        analysis, run = results.analysis, results.recorded
        assert run is not None
        found[asked] = run
        assert analysis.assembly.effects.reach is asked
        assert not np.any(run.poses.displacement[:, analysis.assembly.aside])
    part, whole = found[True].result, found[False].result
    tolerance = HISTORY * abs(whole["reaction"]) + whole["uncertainty"] + part["uncertainty"]
    assert part["reaction"] == pytest.approx(whole["reaction"], abs=tolerance)
    assert found[True].poses["forces"].shape[1] < found[False].poses["forces"].shape[1]
