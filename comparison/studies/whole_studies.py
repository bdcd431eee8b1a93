"""The studies of one scene as a whole: every rung of the cost study, the references and runs of the sensitivity study."""

import tempfile
import threading
from pathlib import Path
from typing import Any

from comparison.progress import Narration
from comparison.studies.cost import CostStudy, measure_study, prediction_inset
from comparison.studies.cost_limit_analysis import limit_analysis_methods
from comparison.studies.cost_yade import yade_methods
from comparison.studies.sensitivity import Sensitivity, study
from comparison.yade import find_yade
from la_core.analysis import analyse, drives
from la_core.errors import CannotStandError, SceneError
from la_core.limit import Status, solve_associated
from la_core.model import assemble
from la_core.scene import Scene

References = dict[str, tuple[float, int | None]]


def study_cost(scene: Scene, with_yade: bool, narration: Narration, workers: int = 1, time_limit: float | None = None) -> CostStudy:
    """Run every setting of every method on a scene.

    Raises SceneError for a structure without an answer.

    Parameters
    ----------
    scene : Scene
        The scene.
    with_yade : bool
        Whether to include YADE.
    narration : Narration
        Receives the progress.
    workers : int
        Number of runs of YADE side by side.
    time_limit : float or None
        Time limit of each run of YADE, s of wall time; None takes the scene's own, or an hour.
    """
    stopped = threading.Event()

    def hear(report: dict[str, Any]) -> None:
        _end_if(stopped)
        if workers == 1:  # reports of several runs would mix in the scene's one bar
            narration.progress(scene.name, {**report, "unit": scene.settlement_unit})

    def begin(number: int, words: str) -> None:
        _end_if(stopped)
        narration.fraction(scene.name, number / count, f"rung {number + 1} of {count}: {words}")

    status = solve_associated(assemble(scene), drives(scene)[0]).status
    if status is not Status.SOLVED:
        raise _unanswered(scene, status, "the study has no reference value")
    with tempfile.TemporaryDirectory() as runs:
        methods = list(limit_analysis_methods(scene, prediction_inset(scene)))
        if with_yade:
            methods += yade_methods(scene, find_yade(), Path(runs), hear, time_limit)
        count = len(methods)
        return measure_study(scene, methods, begin, workers, stopped.set)


def _unanswered(scene: Scene, status: Status, so: str) -> SceneError:
    """Return the error for a structure without an answer; `so` is the consequence, as a clause."""
    if status is Status.INFEASIBLE:
        return CannotStandError(str(scene.path), f"the structure cannot stand under its weight and dead loads, so {so}")
    return SceneError(str(scene.path), f"associated limit analysis ends as {status}, so {so}")


def _end_if(stopped: threading.Event) -> None:
    """End a rung where another one has failed, or the user has interrupted the program."""
    if stopped.is_set():
        raise InterruptedError("another rung has ended the study")


def study_sensitivity(scene: Scene, narration: Narration) -> tuple[Sensitivity, References]:
    """Study a scene; returns the study, and each reference's value and number of programmes, None without any.

    Raises SceneError for a structure without an answer.
    """
    analysis = analyse(scene)
    main, coulomb = analysis.bounds[analysis.main], analysis.coulomb
    if main.status is not Status.SOLVED:
        raise _unanswered(scene, main.status, "the classic iteration has no starting point")
    references: References = {"associated": (main.value, 1)}
    if coulomb is not None:
        references["Coulomb, elastic joints"] = (coulomb.value, None)
    result = study(
        scene,
        analysis.whole,
        progress=lambda done, of, _: narration.fraction(scene.name, done / of, f"run {done} of {of}"),
    )
    return result, references
