"""`crosscheck run`: solve scenes by both methods, compare the answers and write the report."""

import argparse
from typing import Any

from comparison.cli.conclude import conclude
from comparison.cli.context import Context
from comparison.errors import FolderInUseError
from comparison.progress import Narration
from comparison.run_folder import refuse_names
from comparison.workflow import run_scene
from la_core.analysis import StructuralModel, structural_model, with_accuracy
from la_core.errors import SceneError
from la_core.scene import full_model, load_scene, shipped


def execute(context: Context) -> int:
    """Run every scene in a folder of its own and write the report; an invalid scene is refused before the first run."""
    options = context.options
    models = _models(options)
    for model in models:
        context.warn(model.scene)
    comparisons: list[dict[str, Any]] = []
    try:
        with Narration(context.narrator) as narration:
            for model in models:
                folder = options.output / model.scene.name
                comparisons.append(run_scene(model, folder, narration, not options.no_yade, options.time_limit))
    except (SceneError, FolderInUseError):  # an error found only during the run: earlier scenes keep their report
        if comparisons:
            conclude([(options.output, comparisons)], context)
        raise
    return conclude([(options.output, comparisons)], context)


def _models(options: argparse.Namespace) -> list[StructuralModel]:
    """Return one model for each distinct scene, with the accuracy and the effects that the options request; raises SceneError."""
    scenes = [load_scene(path) for path in dict.fromkeys(shipped.find(name).resolve() for name in options.scenes)]
    if options.accuracy is not None:
        scenes = [with_accuracy(scene, options.accuracy) for scene in scenes]
    if options.full:
        scenes = [full_model(scene) for scene in scenes]
    refuse_names(scenes)
    return [structural_model(scene) for scene in scenes]
