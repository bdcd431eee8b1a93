"""A prediction that YADE contradicts is made again in more steps before anybody is said to disagree."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from conftest import Silent
from runs import with_answers

from comparison.workflow import finer_prediction
from comparison.workflow.one_scene import run_scene
from comparison.yade import Results, read_results
from comparison.yade.run_record import Run, read_run
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.settings import AnalysisSettings
from la_core.analysis.stage import analyse
from la_core.coulomb.plateau import STEPS, PredictionSettings
from la_core.scene.scene import Scene, load_scene, scene_of_text

WALL = Path(__file__).parents[2] / "comparison" / "campaigns" / "scenes" / "wall_between.toml"
BLOCKS = 60  # of the wall; three lie in the triangle over the settling zone and come down with it, for no thrust holds them
PREDICTED = 1e-3  # relative: a thrust that the last dilation left
HISTORY = 1e-2  # relative: what steps leave open in friction's history
BY_YADE = 1e-3  # relative: its own uncertainty, twice


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("refined")


@pytest.fixture(scope="module")
def summary(folder: Path) -> dict:
    return run_scene(load_scene(WALL), folder, Silent(), with_yade=True)


def test_eight_steps_leave_a_thrust_that_more_steps_do_not(summary: dict) -> None:
    coulomb, weight = summary["limit_analysis"]["coulomb"], summary["weight"]
    assert coulomb["steps"] > STEPS and summary["verdict"] == "agree", summary["reason"]
    assert coulomb["reaction"] / weight == pytest.approx(3 / BLOCKS, rel=PREDICTED)
    assert summary["yade"]["reaction"] / weight == pytest.approx(3 / BLOCKS, rel=BY_YADE)
    assert [note for note in summary["notes"] if f"in up to {coulomb['steps']}" in note and "weaker" in note]
    first = analyse(load_scene(WALL)).coulomb
    assert first is not None and first.steps == STEPS
    assert abs(first.value / weight - 3 / BLOCKS) > 0.1 * 3 / BLOCKS  # else this scene shows nothing


def test_what_was_made_again_is_kept(summary: dict, folder: Path) -> None:
    heard: list[str] = []

    class Listening(Silent):
        def stage(self, scene: str, stage: str, state: str) -> None:
            heard.append(f"{stage}: {state}")

    assert run_scene(load_scene(WALL), folder, Listening(), with_yade=True) == summary
    assert heard == ["limit analysis: cached", "YADE: cached", "comparison: cached"]
    assert json.loads((folder / "comparison.json").read_text(encoding="utf-8")) == summary


def stored(folder: Path) -> tuple[Scene, LimitAnalysis, Run]:
    results = read_results(folder)
    scene, analysis, run = results.scene, results.analysis, results.recorded
    assert run is not None
    return scene, analysis, read_run(folder / "run.h5", analysis.assembly)


def test_a_prediction_that_is_not_contradicted_is_left_alone(summary: dict, folder: Path) -> None:
    _scene, analysis, run = stored(folder)
    assert analysis.coulomb is not None
    as_if_first = with_answers(analysis, coulomb=replace(analysis.coulomb, steps=STEPS))
    assert list(finer_prediction.predictions(Results(as_if_first, run))) == []


def test_a_contradiction_that_finer_steps_do_not_mend_stands(summary: dict, folder: Path) -> None:
    """A reaction of YADE's that no prediction comes near."""
    scene, _, run = stored(folder)
    wrong = replace(run, result=replace(run.result, reaction=0.3 * scene.weight))
    tried = [steps for steps, _ in finer_prediction.predictions(Results(analyse(scene), wrong))]
    assert tried == [steps for steps, _ in finer_prediction.FINER] and tried == sorted(tried)


def test_blocks_that_jam_in_a_long_first_step_slide_in_a_shorter_one() -> None:
    """Two thirds of the base settle in the middle; a path of small increments tells how far the reaction falls."""
    text = WALL.read_text(encoding="utf-8").replace("0.8, 0.3", "0.4, 0.3").replace("1.6, 0.3", "2.0, 0.3")
    text = text.replace("from = [0.8", "from = [0.4").replace("from = [1.6", "from = [2.0")
    scene = scene_of_text(text, WALL, "wide")
    (steps, long_first), (same, short_first) = finer_prediction.FINER[:2]
    settings = (PredictionSettings(steps, long_first), PredictionSettings(same, short_first))
    jammed, sliding = (analyse(scene, AnalysisSettings(follow_path=True, prediction=one)) for one in settings)
    assert jammed.coulomb is not None and sliding.coulomb is not None and sliding.path is not None
    assert jammed.coulomb.value < 1e-6 * scene.weight
    assert sliding.coulomb.value == pytest.approx(sliding.path.value[-1], rel=HISTORY)
