"""The rungs of `crosscheck cost` in YADE: the derived settings, then each setting changed alone."""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from comparison.studies.cost_limit_analysis import PREDICTION, Method, MethodOutcome, shared_inset
from comparison.yade import Yade, read_run, run_yade
from la_core.analysis import analyse, write_case
from la_core.scene import Scene

FACTORS = {  # of the derived value, by setting of YADE, with the setting's name in words
    "speed": ("settlement speed", (8.0, 4.0, 2.0, 0.5)),
    "normal_stiffness": ("joint stiffness", (0.25, 4.0)),
    "damping_ratio": ("damping", (0.33, 2.0)),
    "plateau_travel": ("least travel before the fit", (0.5, 2.0)),
}
INSET_FACTORS = (2.0, 0.5, 0.2)
TIME_LIMIT = 3600.0  # s of wall time for one rung where the scene says nothing


def yade_methods(
    scene: Scene, yade: Yade, folder: Path, progress: Callable[[dict[str, Any]], None], time_limit: float | None = None
) -> Iterator[Method]:
    """Yield all rungs of YADE; the first uses the derived settings, and the others multiples of these.

    Parameters
    ----------
    scene : Scene
        The scene to solve.
    yade : Yade
        The YADE to run.
    folder : Path
        Each rung runs in a folder inside.
    progress : callable
        Called with YADE's progress lines.
    time_limit : float or None
        Time limit of each run, s of wall time; None takes the scene's own, or TIME_LIMIT.
    """
    derived: dict[str, Any] = {}
    base = shared_inset(scene)  # the inset for YADE where the scene has none

    def run(name: str, inset: float = 1.0, setting: str = "", factor: float = 1.0) -> MethodOutcome:
        requested = dict(scene.yade) | ({setting: factor * derived[setting]} if setting else {})
        outcome, settings = run_once(scene, base * inset, requested, yade, folder / name.replace(" ", "_"), progress, time_limit)
        if not setting and inset == 1.0:
            derived.update(settings)
        return outcome

    yield Method("YADE", "derived settings", PREDICTION, partial(run, "derived"))
    for setting, (label, factors) in FACTORS.items():
        for factor in factors:
            name = f"{label} x {factor:g}"
            yield Method("YADE", name, PREDICTION, partial(run, name, 1.0, setting, factor), beside=True)
    for factor in INSET_FACTORS:
        name = f"inset x {factor:g}"
        yield Method("YADE", name, PREDICTION, partial(run, name, factor), beside=True)


def run_once(
    scene: Scene,
    inset: float,
    settings: dict[str, Any],
    yade: Yade,
    folder: Path,
    progress: Callable[[dict[str, Any]], None],
    time_limit: float | None = None,
) -> tuple[MethodOutcome, dict[str, Any]]:
    """Run YADE once and return the outcome and the settings it used.

    Parameters
    ----------
    scene : Scene
        The scene to solve.
    inset : float
        Inset of the contact points, m.
    settings : dict
        Settings of YADE in place of the scene's; missing settings are derived.
    yade : Yade
        The YADE to run.
    folder : Path
        Folder of the run; created where it does not exist.
    progress : callable
        Called with YADE's progress lines.
    time_limit : float or None
        Time limit of the run, s of wall time; None takes the scene's own, or TIME_LIMIT.
    """
    start = time.perf_counter()
    changed = replace(scene, inset=inset, yade=settings, path_asked=None)
    folder.mkdir(parents=True, exist_ok=True)
    analysis = analyse(changed)  # with the prediction: some settings of a run follow from its path
    write_case(folder / "case.h5", analysis, folder.name)
    predicting = 0.0 if analysis.coulomb is None else analysis.coulomb.seconds
    built = time.perf_counter() - start - predicting
    run_yade(yade, folder, folder.name, time_limit or settings.get("time_limit", TIME_LIMIT), progress)
    run = read_run(folder / "run.h5", analysis.assembly)
    value = run.result.reaction if run.status == "plateau" else float("nan")
    return MethodOutcome(value, run.status, built, run.result.seconds, run.result.uncertainty), dict(run.settings)
