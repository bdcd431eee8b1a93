"""Runs of YADE with small and finite displacements, and with the plateau's states or all of them."""

import functools
import json
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scenes
from conftest import Silent
from displaced_blocks import GAP, TEXTS, TRAVEL, buffer, decided, with_effects
from verdict_scenes import EARLIER_SEED, drawn

from comparison.judge.checks.reduced_model import check_displacement
from comparison.judge.checks.run_checks import check_run
from comparison.verdict.check import Check, Verdict
from comparison.workflow.one_scene import TIME_LIMIT, run_scene
from comparison.yade import Results, installation, process
from comparison.yade.run_record import Run, read_run
from la_core.analysis.case_file import read_case, write_case
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.model import dem_effects
from la_core.scene import Scene, same_structure

SAME = 1e-7  # relative: one model whose forces are added up in another order; friction's history amplifies round-off
# Of the stated uncertainty: faces of boxes and of polyhedra round differently, which friction's history amplifies.
ALIKE = 1.0 / 20.0
HALF_PER_CENT = 5e-3  # of the reaction: promised accuracy where its value is known
ONE_ATTEMPT = {"yade.quick_speed": 0.0, "yade.swing_damping": 0.0, "yade.damping_ratio": 0.3}  # a reaction of zero has no plateau
RADIUS = 5e-4  # m, of a contact sphere at an inset of 1 mm; also the overlap of the block when its sphere, one inset inside, meets the face
Ran = tuple[LimitAnalysis, Run]


def run_in_yade(scene: Scene, folder: Path, time_limit: float = TIME_LIMIT) -> Ran:
    """Both methods' results of a scene, each read back from its file."""
    folder.mkdir(parents=True, exist_ok=True)
    write_case(folder / "case.h5", analyse(scene), "test")
    process.run_yade(installation.find_yade(), folder, "test", time_limit, lambda report: None)
    analysis = read_case(folder / "case.h5", scene)
    return analysis, read_run(folder / "run.h5", analysis.assembly)


every_text = pytest.mark.parametrize("name", [name if name == "two_pads" else pytest.param(name, marks=pytest.mark.slow) for name in TEXTS])


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str, str, str], Ran]:
    """Results of one of the TEXTS with the requested displacement and recording, run once per module."""
    results = tmp_path_factory.mktemp("effects")

    @functools.cache
    def run(name: str, displacement: str, recording: str = "states") -> Ran:
        scene = with_effects(TEXTS[name], displacement=displacement, recording=recording)
        return run_in_yade(scene, results / f"{name} {displacement} {recording}")

    return run


def cost(scene: Scene, folder: Path) -> dict:
    """Objects that YADE builds for a scene, and their cost."""
    return measured("yade_cost.py", analyse(scene), folder, "10")


def measured(script: str, analysis: LimitAnalysis, folder: Path, *options: str) -> dict:
    """Measurements of a benchmark script on a case in YADE's interpreter. The script builds the case unchanged, including a search."""
    write_case(folder / "case.h5", analysis, "test")
    yade = installation.find_yade()
    environment = {**installation.yade_environment(), "YADE_MODULES": str(yade.modules)}
    command = [yade.python, "-s", Path(__file__).parents[1] / "benchmarks" / script, folder / "case.h5", *options]
    answer = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return json.loads(answer.stdout.splitlines()[-1])


# --- displacement: agreement and difference ------------------------------------------------------------------------------------


@pytest.mark.slow
@every_text
def test_finite_displacements_cost_nothing_where_no_other_blocks_can_meet(name: str, ran: Callable[..., Ran]) -> None:
    """YADE looks for no new contact in either case, so that the results are equal to the last bit."""
    (small_analysis, small), (_, finite) = ran(name, "small"), ran(name, "finite")
    assert small_analysis.assembly.effects.displacement == "small"
    assert small.status == finite.status == "plateau"
    assert np.array_equal(small.record["reaction"], finite.record["reaction"])
    assert np.array_equal(small.mechanism(), finite.mechanism())


@pytest.mark.yade
@pytest.mark.parametrize("name", ["two_pads", *(pytest.param(name, marks=pytest.mark.slow) for name in ("arch", "wall", "leaning wall"))])
def test_a_search_that_finds_no_new_contact_changes_no_reaction(name: str, tmp_path: Path) -> None:
    """Contacts open and close in all scenes, and the collider finds them again. The arch and the leaning wall have polyhedra as blocks."""
    scene = drawn(11, EARLIER_SEED).scene if name == "leaning wall" else with_effects(TEXTS[name])
    analysis, found = analyse(scene), {}
    for displacement in ("small", "finite"):
        effects = replace(analysis.assembly.effects, displacement=displacement)
        found[displacement] = measured("protocol_attempt.py", analysis.with_effects(effects), tmp_path, "2", "1", "{}")
    small, finite = found["small"], found["finite"]
    assert small["status"] == finite["status"] == "plateau" and small["steps"] == finite["steps"]
    close = SAME if name in ("two_pads", "wall") else ALIKE * small["uncertainty"] / small["reaction"]
    assert finite["reaction"] == pytest.approx(small["reaction"], rel=close)


@pytest.mark.slow
@pytest.mark.yade
def test_a_block_that_runs_into_a_stop_is_held_up_by_it_only_where_displacements_are_finite(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The stop then holds the block against the friction under it, mu W. Without the stop the pad carries the block along freely."""
    scene = with_effects(buffer(), displacement="finite")
    _, finite = run_in_yade(scene, tmp_path / "finite")
    monkeypatch.setattr(dem_effects, "GAP_OVER_TRAVEL", 0.5 * GAP / TRAVEL)  # past the guard: no block counts as within reach
    analysis, small = run_in_yade(same_structure(with_effects(buffer(), displacement="small"), ONE_ATTEMPT, "small"), tmp_path / "small")
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
    """Both methods run. The passage of the block through the stop is noticed, and the next call finds the restored effect in its files."""
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


# --- displacement: the guard ------------------------------------------------------------------------------------------------------


def verdict(checks: list[Check], name: str) -> Check:
    return next(check for check in checks if check.name.startswith(name))


@pytest.mark.slow
def test_a_real_run_with_small_displacements_keeps_within_its_gap(ran: Callable[..., Ran]) -> None:
    analysis, run = ran("arch", "small")
    (check,) = check_displacement(Results(analysis, run))
    travel = analysis.stiffness.travel * analysis.assembly.support_speed
    assert check.verdict is Verdict.AGREE
    assert check.yade is not None and check.yade >= run.result.settlement  # the springer itself moves so far
    assert analysis.least_gap == dem_effects.GAP_OVER_TRAVEL * travel


# --- recording --------------------------------------------------------------------------------------------------------------------


@pytest.mark.slow
@every_text
def test_recording_the_plateau_alone_changes_no_number_that_is_judged(name: str, ran: Callable[..., Ran]) -> None:
    (_, states), (analysis, plateau) = ran(name, "small"), ran(name, "small", "plateau")
    assert analysis.assembly.effects.recording == "plateau"
    assert plateau.result["reaction"] == states.result["reaction"]
    assert np.array_equal(plateau.mechanism(), states.mechanism()) and np.isfinite(plateau.mechanism()).all()
    assert np.array_equal(plateau.plateau_forces(), states.plateau_forces())


@pytest.mark.slow
@every_text
def test_recording_the_plateau_alone_keeps_rest_and_plateau_and_nothing_between(name: str, ran: Callable[..., Ran]) -> None:
    kept, every = (ran(name, "small", recording)[1].poses["settlement"] for recording in ("plateau", "states"))
    start = ran(name, "small")[1].result["plateau_start"]
    assert kept[0] == every[0]
    assert np.array_equal(kept[1:], every[every >= start])
    assert len(kept) < len(every)


@pytest.mark.slow
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
