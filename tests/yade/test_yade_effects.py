"""Effects of the run in YADE: small or finite displacements, and which states are recorded."""

import functools
import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import scenes
from conftest import Silent
from runs import made_up_run

from comparison.judge.reduced_model import check_displacement, largest_displacements
from comparison.judge.run_checks import check_run
from comparison.verdict.check import Check, Verdict
from comparison.workflow.one_scene import TIME_LIMIT, run_scene
from comparison.yade import Results, process
from comparison.yade.run_record import Run, read_run
from la_core.analysis.case_file import read_case, write_case
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.errors import SceneError
from la_core.model import dem_effects
from la_core.model.assembly import Assembly, assemble
from la_core.model.effects import Effects
from la_core.model.joints import joint_stiffness
from la_core.scene.scene import Scene

SAME = 1e-7  # relative: one model whose forces are added up in another order; friction's history amplifies round-off
# Of the stated uncertainty: a face as a box and as a polyhedron's triangles rounds differently, which history amplifies.
ALIKE = 1.0 / 20.0
HALF_PER_CENT = 5e-3  # of the reaction: what the method promises where its value is known
TRAVEL = 1.2e-3  # m, asked for where a block runs into another one
GAP = 2e-4  # m between the two at first
RADIUS = (
    5e-4  # m, of a contact sphere at an inset of 1 mm: so deep the block is in when its sphere, one inset from its side, meets the face
)
Ran = tuple[LimitAnalysis, Run]


def with_effects(toml: str, **entries: str) -> Scene:
    """The scene of a text, with entries added to its table of effects."""
    lines = "".join(f"{name} = {scenes.inline(value)}\n" for name, value in entries.items())
    return scenes.load(toml.replace("[effects]\n", f"[effects]\n{lines}") if "[effects]" in toml else f"{toml}\n[effects]\n{lines}")


TEXTS = {
    "two_pads": scenes.shipped("two_pads").text,
    "arch": scenes.shipped("arch_spreading").text,
    "wall": scenes.text(*scenes.wall(3, 4, split=0.7), inset=0.001, model="coulomb"),
}


def buffer(gap: float = GAP, travel: float = TRAVEL) -> str:
    """A block on a pad that moves sideways towards a fixed stop, which reaches down to the spheres under the block."""
    parts = (
        scenes.box("pad", (-0.2, -0.2, -0.2), (0.6, 0.4, 0.0), "support"),
        scenes.box("block", (0.0, 0.0, 0.0), (0.4, 0.2, 0.2)),
        scenes.box("stop", (0.4 + gap, -0.1, 0.0), (0.8, 0.3, 0.4), "fixed"),
    )
    goes_on = scenes.table("yade", max_travel=travel, plateau_travel=0.8 * travel)  # beyond the plateau of zero before the stop
    return scenes.text(*parts, inset=0.001, settlement=(1.0, 0.0, 0.0), plane=False) + goes_on + "\n"


def run_in_yade(scene: Scene, folder: Path, time_limit: float = TIME_LIMIT) -> Ran:
    """Both methods' results of a scene, each read back from its file."""
    folder.mkdir(parents=True, exist_ok=True)
    write_case(folder / "case.h5", analyse(scene), "test")
    process.run_yade(process.find_yade(), folder, "test", time_limit, lambda report: None)
    analysis = read_case(folder / "case.h5", scene)
    return analysis, read_run(folder / "run.h5", analysis.assembly)


every_text = pytest.mark.parametrize("name", [name if name == "two_pads" else pytest.param(name, marks=pytest.mark.slow) for name in TEXTS])


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, str, str], Ran]:
    """Results of one of the TEXTS with the displacement and recording asked for, run once a module."""
    results = tmp_path_factory.mktemp("effects")

    @functools.cache
    def run(name: str, displacement: str, recording: str = "states") -> Ran:
        scene = with_effects(TEXTS[name], displacement=displacement, recording=recording)
        return run_in_yade(scene, results / f"{name} {displacement} {recording}")

    return run


def decided(scene: Scene) -> tuple[Effects, float]:
    """Effects of the run and the least gap, limit analysis left out."""
    assembly = assemble(scene)
    settled, gap = dem_effects.decide_dem_effects(scene, assembly, joint_stiffness(assembly, assembly.inset, scene.yade))
    return settled.effects, gap


def cost(scene: Scene, folder: Path) -> dict:
    """What YADE builds for a scene, and what it costs."""
    write_case(folder / "case.h5", analyse(scene), "test")
    yade, script = process.find_yade(), Path(__file__).parents[1] / "benchmarks" / "yade_cost.py"
    environment = {**process.yade_environment(), "YADE_MODULES": str(yade.modules)}
    command = [yade.python, "-s", script, folder / "case.h5", "10"]
    answer = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return json.loads(answer.stdout.splitlines()[-1])


# --- displacement: agreement and difference ------------------------------------------------------------------------------------


@every_text
def test_small_and_finite_displacements_give_one_plateau_where_no_other_blocks_can_meet(name: str, ran: Callable[..., Ran]) -> None:
    """Contacts open and close in all of them: the pairs that were set once are found again without a collider."""
    (small_analysis, small), (_, finite) = ran(name, "small"), ran(name, "finite")
    assert small_analysis.assembly.effects.displacement == "small"
    assert small.status == finite.status == "plateau"
    close = ALIKE * small.result["uncertainty"] / small.result["reaction"] if name == "arch" else SAME
    assert small.result["reaction"] == pytest.approx(finite.result["reaction"], rel=close)
    assert small.mechanism() == pytest.approx(finite.mechanism(), abs=close * np.abs(finite.mechanism()).max())


@pytest.mark.yade
def test_a_block_that_runs_into_a_stop_is_held_up_by_it_only_where_displacements_are_finite(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The stop then holds the block by the friction under it, mu W; without it the pad carries the block along for nothing."""
    scene = with_effects(buffer(), displacement="finite")
    _, finite = run_in_yade(scene, tmp_path / "finite")
    monkeypatch.setattr(dem_effects, "GAP_OVER_TRAVEL", 0.5 * GAP / TRAVEL)  # past the guard: nothing counts as within reach
    analysis, small = run_in_yade(with_effects(buffer(), displacement="small"), tmp_path / "small")
    names = analysis.assembly.blocks.names
    block, settled = names.index("block"), small.poses["settlement"][-1]
    assert {names[k] for k in finite.extra_contacts.ravel()} == {"block", "stop"} and not len(small.extra_contacts)
    assert settled > GAP + RADIUS
    assert finite.result["reaction"] == pytest.approx(-scene.friction * scene.weight, rel=HALF_PER_CENT)
    assert small.record["reaction"][-1] == pytest.approx(0.0, abs=SAME * scene.weight)
    assert small.poses["displacement"][-1, block, 0] == pytest.approx(settled, rel=1e-3)
    assert finite.poses["displacement"][-1, block, 0] == pytest.approx(GAP + RADIUS, rel=0.05)  # the stop gives way elastically
    assert verdict(check_run(Results(analysis, small)), "displacements").verdict is Verdict.INCONCLUSIVE


@pytest.mark.yade
@pytest.mark.slow
def test_a_small_run_that_went_too_far_is_run_again_with_finite_displacements(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Through both methods: the block carried through the stop is noticed, and what was called back is found again by the next call."""
    monkeypatch.setattr(dem_effects, "GAP_OVER_TRAVEL", 0.5 * GAP / TRAVEL)
    scene, heard = with_effects(buffer()), []

    class Listener(Silent):
        def stage(self, scene: str, stage: str, state: str) -> None:
            heard.append(f"{stage}: {state}")

    summary = run_scene(scene, tmp_path / scene.name, Listener(), with_yade=True)
    assert sum("repeated with effects that were left out (displacement: In YADE block" in one for one in heard) == 1
    assert summary["effects"]["displacement"] == "finite"
    assert "moved" in summary["effects"]["reasons"]["displacement"]
    assert summary["yade"]["reaction"] == pytest.approx(-scene.friction * scene.weight, rel=HALF_PER_CENT)
    heard.clear()
    run_scene(scene, tmp_path / scene.name, Listener(), with_yade=True)
    assert heard == ["limit analysis: cached", "YADE: cached", "comparison: cached"]


@pytest.mark.yade
@pytest.mark.slow
def test_without_a_collider_there_is_none_and_pairs_are_those_listed(tmp_path: Path) -> None:
    built = {displacement: cost(with_effects(TEXTS["wall"], displacement=displacement), tmp_path) for displacement in ("small", "finite")}
    small, finite = built["small"], built["finite"]
    assert set(finite["engines"]) - set(small["engines"]) == {"InsertionSortCollider"}
    assert len(small["engines"]) == len(finite["engines"]) - 1
    assert small["interactions"] == small["spheres"] == finite["spheres"]


# --- displacement: the choice ----------------------------------------------------------------------------------------------------


def test_auto_takes_finite_displacements_where_blocks_may_meet_and_names_them() -> None:
    effects, gap = decided(with_effects(buffer()))
    assert effects.displacement == "finite"
    assert 'blocks "block" and "stop" are 0.0002 m apart without a joint' in effects.reasons["displacement"]
    assert gap == pytest.approx(GAP, rel=1e-9)


def test_small_displacements_asked_for_where_blocks_may_meet_are_refused_with_their_names() -> None:
    with pytest.raises(SceneError, match=r'effects.displacement = \'small\': blocks "block" and "stop" are 0.0002 m apart.*"finite"'):
        decided(with_effects(buffer(), displacement="small"))


def test_small_displacements_asked_for_say_so_and_why_they_may_be() -> None:
    effects, gap = decided(with_effects(TEXTS["arch"], displacement="small"))
    assert effects.reasons["displacement"].startswith("requested in the scene, and blocks without a joint")
    assert f"{gap:.3g} m apart" in effects.reasons["displacement"]


def test_finite_displacements_are_always_allowed() -> None:
    for text in (*TEXTS.values(), buffer()):
        effects, gap = decided(with_effects(text, displacement="finite"))
        assert effects.displacement == "finite" and effects.reasons["displacement"] == "requested in the scene" and np.isnan(gap)


@pytest.mark.parametrize(("share", "choice"), [(0.99, "finite"), (1.01, "small")])
def test_the_choice_turns_at_the_reach_of_the_motion(share: float, choice: str) -> None:
    effects, _ = decided(with_effects(buffer(gap=share * dem_effects.GAP_OVER_TRAVEL * TRAVEL)))
    assert effects.displacement == choice


@pytest.mark.parametrize("name", ["arch_spreading", "vault_spreading", "rubble_wall", "two_pads", "slab_four_corners"])
def test_arches_and_vaults_whose_bounding_boxes_overlap_come_out_small_in_any_position(name: str) -> None:
    scene = scenes.shipped(name)
    turn = scenes.rotation((1.0, 2.0, -0.5), 0.7)
    for one in (scene, scenes.moved(scene, turn, shift=(3.0, -2.0, 1.0), plane=False)):
        assert decided(one)[0].displacement == "small"


def test_two_held_blocks_and_blocks_with_a_joint_do_not_count() -> None:
    """The halves of the base meet in an upright face, and every other pair within reach shares a joint."""
    effects, _ = decided(scenes.build(*scenes.wall(2, 1, split=0.3), inset=0.001))
    assert effects.displacement == "small"


@pytest.mark.parametrize("seed", range(3))
def test_the_least_gap_is_never_more_than_the_distance_of_any_two_blocks(seed: int) -> None:
    """Turned boxes over a floor: distances between points drawn from both are upper bounds of the true one."""
    chance = np.random.default_rng(seed)
    box = np.array([(x, y, z) for x in (0.0, 0.2) for y in (0.0, 0.2) for z in (0.0, 0.2)])
    free = [box @ scenes.rotation((0.0, 0.0, 1.0), chance.uniform(0.0, 1.5)).T + (0.5 * k, chance.uniform(0.0, 0.1), 0.0) for k in range(4)]
    parts = [scenes.block(f"block {k}", polyhedron=vertices) for k, vertices in enumerate(free)]
    scene = scenes.build(scenes.box("floor", (-2.0, -2.0, -0.2), (4.0, 2.0, 0.0), "support"), *parts, inset=0.001, plane=False)
    gap, pair = dem_effects.least_gap(assemble(scene), 10.0)
    shares = chance.dirichlet(np.full(8, 0.2), 500)
    apart = [np.linalg.norm((shares @ a)[:, None] - (shares @ b)[None], axis=2).min() for k, a in enumerate(free) for b in free[k + 1 :]]
    assert pair is not None and 0.0 < gap <= min(apart)


# --- displacement: the guard ------------------------------------------------------------------------------------------------------


def made_up(assembly: Assembly, shift: float, turn: float) -> Run:
    """A run whose second block moves by `shift` (m) along x and turns by `turn` (rad) about y."""
    displacement, rotation = np.zeros((2, len(assembly.blocks), 3)), np.zeros((2, len(assembly.blocks), 3))
    displacement[1, 1, 0], rotation[1, 1, 1] = shift, turn
    return made_up_run(poses={"displacement": displacement, "rotation": rotation})


def verdict(checks: list[Check], name: str) -> Check:
    return next(check for check in checks if check.name.startswith(name))


@pytest.mark.parametrize(("share", "expected"), [(0.99, Verdict.AGREE), (1.01, Verdict.INCONCLUSIVE)])
def test_a_run_that_moved_its_blocks_by_half_the_least_gap_decides_nothing(share: float, expected: Verdict) -> None:
    analysis = analyse(with_effects(TEXTS["arch"], displacement="small"))
    limit = 0.5 * analysis.least_gap
    (check,) = check_displacement(Results(analysis, made_up(analysis.assembly, share * limit, 0.0)))
    assert check.verdict is expected
    if expected is Verdict.INCONCLUSIVE:
        assert analysis.assembly.blocks.names[1] in check.reason and 'displacement = "finite"' in check.next_step


def test_a_turn_counts_with_the_size_of_its_block() -> None:
    """The exact displacement of every vertex under a small turn is bounded, and nearly attained by one of them."""
    assembly = assemble(scenes.shipped("arch_spreading"))
    blocks, turn = assembly.blocks, 1e-3
    vertices = blocks.vertices[blocks.vertex_start[1] : blocks.vertex_start[2]] - blocks.centroid[1]
    exact = np.linalg.norm(vertices @ (scenes.rotation((0.0, 1.0, 0.0), turn) - np.eye(3)).T, axis=1).max()
    bound = largest_displacements(blocks, made_up(assembly, 0.0, turn))
    assert exact <= bound[1] <= np.linalg.norm(vertices, axis=1).max() * turn * (1.0 + 1e-12)
    assert not bound[[0, *range(2, len(blocks))]].any()


def test_an_undefined_displacement_decides_nothing() -> None:
    analysis = analyse(with_effects(TEXTS["two_pads"], displacement="small"))
    (check,) = check_displacement(Results(analysis, made_up(analysis.assembly, np.nan, 0.0)))
    assert check.verdict is Verdict.INCONCLUSIVE


@pytest.mark.slow
def test_a_real_run_with_small_displacements_keeps_within_its_gap(ran: Callable[..., Ran]) -> None:
    analysis, run = ran("arch", "small")
    (check,) = check_displacement(Results(analysis, run))
    travel = analysis.stiffness.travel * analysis.assembly.support_speed
    assert check.verdict is Verdict.AGREE
    assert check.yade is not None and check.yade >= run.result.settlement  # the springer itself moves so far
    assert analysis.least_gap == dem_effects.GAP_OVER_TRAVEL * travel


# --- recording --------------------------------------------------------------------------------------------------------------------


@every_text
def test_recording_the_plateau_alone_changes_no_number_that_is_judged(name: str, ran: Callable[..., Ran]) -> None:
    (_, states), (analysis, plateau) = ran(name, "small"), ran(name, "small", "plateau")
    assert analysis.assembly.effects.recording == "plateau"
    assert plateau.result["reaction"] == states.result["reaction"]
    assert np.array_equal(plateau.mechanism(), states.mechanism()) and np.isfinite(plateau.mechanism()).all()
    assert np.array_equal(plateau.plateau_forces(), states.plateau_forces())


@every_text
def test_recording_the_plateau_alone_keeps_rest_and_plateau_and_nothing_between(name: str, ran: Callable[..., Ran]) -> None:
    kept, every = (ran(name, "small", recording)[1].poses["settlement"] for recording in ("plateau", "states"))
    start = ran(name, "small")[1].result["plateau_start"]
    assert kept[0] == every[0]
    assert np.array_equal(kept[1:], every[every >= start])
    assert len(kept) < len(every)


@pytest.mark.yade
def test_a_run_without_a_plateau_keeps_rest_and_the_last_state(tmp_path: Path) -> None:
    endless = TEXTS["wall"] + scenes.table("yade", speed=1e-12) + "\n"  # no plateau before the limit on any machine
    _, run = run_in_yade(with_effects(endless, recording="plateau"), tmp_path, time_limit=4.0)
    assert run.status == "timeout"
    assert 1 <= len(run.poses.settlement) <= 2


@pytest.mark.slow
def test_what_auto_takes_for_the_size_of_the_states_is_their_size(ran: Callable[..., Ran]) -> None:
    _, run = ran("wall", "small")
    bytes_of_one = sum(run.poses[name][0].nbytes for name in ("displacement", "rotation", "forces"))
    count = round(dem_effects.LARGE_RECORD * 1e6 / bytes_of_one)
    for poses, choice in ((round(0.99 * count), "states"), (round(1.01 * count), "plateau")):
        effects, _ = decided(with_effects(TEXTS["wall"] + scenes.table("yade", poses=poses) + "\n"))
        assert effects.recording == choice
        assert f"{1e-6 * (poses + 1) * bytes_of_one:.3g} MB" in effects.reasons["recording"]
