"""`crosscheck run`: solve scenes by both methods, compare the answers and write the report."""

import argparse
from collections import deque
from collections.abc import Iterator
from functools import partial
from typing import Any

from comparison.cli.context import Context
from comparison.errors import FolderInUseError, StderrConsole, WorkerLostError
from comparison.progress import Narration
from comparison.run_folder import refuse_names
from comparison.settings import HARDER_SECONDS
from comparison.workflow import WorkerProcesses, refuse_names_of_attempts, run_scene, try_harder
from la_core.analysis import StructuralModel, structural_model, with_accuracy
from la_core.errors import SceneError, real_path
from la_core.scene import Scene, full_model, load_scene, same_structure, shipped


def execute(context: Context) -> int:
    """Run every scene in a folder of its own and write the report; an invalid scene is refused before the first run."""
    options = context.options
    models = _models(options)
    for model in models:
        context.warn(model.scene)
    comparisons: list[dict[str, Any]] = []
    made = _side_by_side(models, context) if min(options.workers, len(models)) > 1 else _in_turn(models, context)
    try:
        for comparison in made:
            comparisons.append(comparison)
    except (SceneError, FolderInUseError, WorkerLostError, OSError):  # an error during the run: the report of earlier scenes is written
        if comparisons:
            _conclude(comparisons, context)
        raise
    return _conclude(comparisons, context)


def _conclude(comparisons: list[dict[str, Any]], context: Context) -> int:
    """Write the report of these comparisons and return the exit code."""
    from comparison.cli.conclude import conclude  # loads matplotlib, which a run loads while YADE works

    return conclude([(context.options.output, comparisons)], context)


def _in_turn(models: list[StructuralModel], context: Context) -> Iterator[dict[str, Any]]:
    """Yield the comparisons of each model, one model after the other."""
    with Narration(context.narrator) as narration:
        for model in models:
            yield from _run_one(model, context.options, narration)


def _side_by_side(models: list[StructuralModel], context: Context) -> Iterator[dict[str, Any]]:
    """Yield the comparisons in the order of the models, made by several processes of one thread each."""
    made: dict[str, list[dict[str, Any]] | Exception] = {}  # by the name of the scene
    waiting = deque(models)
    with WorkerProcesses(partial(_run_quietly, options=context.options), min(context.options.workers, len(models))) as workers:
        for scene in [model.scene.name for model in models]:
            while scene not in made:
                has_failed = any(isinstance(ended, Exception) for ended in made.values())  # it ends the run when its scene's turn comes
                while waiting and not workers.is_busy and not has_failed:
                    workers.begin(waiting.popleft())
                made |= {model.scene.name: ended for model, ended in workers.ended()}
            ended = made.pop(scene)
            if isinstance(ended, WorkerLostError):
                raise WorkerLostError(f"{scene}: {ended}")
            if isinstance(ended, Exception):
                raise ended
            yield from ended


def _run_quietly(model: StructuralModel, options: argparse.Namespace) -> list[dict[str, Any]]:
    """Run one model in a process of its own, which prints lines and no bars."""
    with Narration(StderrConsole(options.quiet, has_bars=False)) as narration:
        return list(_run_one(model, options, narration))


def _run_one(model: StructuralModel, options: argparse.Namespace, narration: Narration) -> Iterator[dict[str, Any]]:
    """Yield the comparison of a model, then that of its second attempt, where one is requested and needed."""
    with_yade = not options.no_yade
    first = run_scene(model, options.output / model.scene.name, narration, with_yade, options.time_limit)
    yield first
    if _may_try_harder(options):
        again = try_harder(first, model.scene, options.output, narration, with_yade, options.try_harder_limit or HARDER_SECONDS)
        yield from [again] if again is not None else []


def _may_try_harder(options: argparse.Namespace) -> bool:
    return options.try_harder or options.try_harder_limit is not None


def _models(options: argparse.Namespace) -> list[StructuralModel]:
    """Return one model for each distinct scene, with the accuracy and the effects that the options request; raises SceneError."""
    scenes = [load_scene(path) for path in dict.fromkeys(real_path(shipped.find(name)) for name in options.scenes)]
    if options.accuracy is not None:
        scenes = [with_accuracy(scene, options.accuracy) for scene in scenes]
    if options.full:
        scenes = [full_model(scene) for scene in scenes]
    if options.threads is not None and not options.no_yade:  # without YADE the scene and its stored limit analysis stay unchanged
        scenes = [_with_threads(scene, options.threads) for scene in scenes]
    refuse_names(scenes)
    if _may_try_harder(options):
        refuse_names_of_attempts(scenes, with_yade=not options.no_yade)
    return [structural_model(scene) for scene in scenes]


def _with_threads(scene: Scene, threads: int) -> Scene:
    """Return the scene with a number of threads of YADE; the scene itself where it has this number."""
    return scene if scene.yade.get("threads", 1) == threads else same_structure(scene, {"yade.threads": threads}, scene.name)
