"""`crosscheck cost`: measure error against time for each scene; write `SCENE-cost.png` and `SCENE-cost.json`."""

import json
from pathlib import Path

from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from comparison.figures import save
from comparison.progress import Narration
from comparison.provenance import describe
from comparison.run_folder import refuse_names, write_text
from comparison.studies import CostStudy, cost, cost_dict, cost_figure, study_cost
from la_core.scene import Scene, load_scene, shipped

CAN_GO = ("range s", "post s", "build s", "solve s", "status")  # columns that a narrow table leaves out, the first to go first


def execute(context: Context) -> int:
    """Run the cost study of every scene and print a table for each reference; raises SceneError."""
    options = context.options
    scenes = [load_scene(path) for path in dict.fromkeys(shipped.find(name).resolve() for name in options.scenes)]
    refuse_names(scenes)
    with Narration(context.narrator) as narration:
        ladders = [climb_and_draw(scene, options.output, not options.no_yade, narration, options.workers) for scene in scenes]
    if options.json:
        context.print_json({"ladders": [cost_dict(ladder) for ladder in ladders]})
    else:
        for ladder in ladders:
            for target in ladder.references:
                context.table(cost.cost_table(ladder, target), CAN_GO)
    context.narrator.print(f"drawn in {options.output}", markup=False)
    return AGREE


def climb_and_draw(scene: Scene, folder: Path, with_yade: bool, narration: Narration, workers: int = 1) -> CostStudy:
    """Run every setting of every method on a scene, and write the figure and the numbers into a folder.

    with_yade, narration, workers: as in `study_cost`. Raises SceneError for a structure without an answer.
    """
    folder.mkdir(parents=True, exist_ok=True)  # a folder that cannot be made is told before the measurement
    ladder = study_cost(scene, with_yade, narration, workers)
    save(cost_figure(ladder), folder / f"{scene.name}-cost.png")
    stored = cost_dict(ladder) | {"provenance": describe()}
    write_text(folder / f"{scene.name}-cost.json", json.dumps(stored, indent=2, ensure_ascii=False) + "\n")
    return ladder
