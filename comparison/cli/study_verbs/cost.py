"""`crosscheck cost`: measure error against time for each scene; write `SCENE-cost.png` and `SCENE-cost.json`."""

import json
from pathlib import Path

from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from comparison.figures import save
from comparison.progress import Narration
from comparison.provenance import describe
from comparison.run_folder import make_writable, refuse_names, write_text
from comparison.studies import CostStudy, cost, cost_dict, cost_figure, study_cost
from la_core.errors import real_path
from la_core.scene import load_scene, shipped

CAN_GO = ("range s", "post s", "build s", "solve s", "status")  # columns that a narrow table leaves out, in this order


def execute(context: Context) -> int:
    """Run the cost study of every scene and print a table for each reference; raises SceneError."""
    options = context.options
    scenes = [load_scene(path) for path in dict.fromkeys(real_path(shipped.find(name)) for name in options.scenes)]
    refuse_names(scenes)
    make_writable(options.output)  # an error for a folder that cannot be written comes before the measurement
    ladders: list[CostStudy] = []
    try:
        with Narration(context.narrator) as narration:
            for scene in scenes:
                ladders.append(study_cost(scene, not options.no_yade, narration, options.workers, options.time_limit))
                _store(ladders[-1], options.output / f"{scene.name}-cost")
    finally:  # after a full disk the numbers may be stored nowhere, so they are printed
        if ladders:
            _print(ladders, context)
    context.narrator.print(f"drawn in {options.output}", markup=False)
    return AGREE


def _print(ladders: list[CostStudy], context: Context) -> None:
    """Print a table for each reference of each study, or all of them as JSON."""
    if context.options.json:
        context.print_json({"ladders": [cost_dict(ladder) for ladder in ladders]})
        return
    for ladder in ladders:
        for target in ladder.references:
            context.table(cost.cost_table(ladder, target), CAN_GO)


def _store(ladder: CostStudy, stem: Path) -> None:
    """Write the numbers of a study, then its figure, to `stem` with the endings .json and .png."""
    stored = cost_dict(ladder) | {"provenance": describe()}
    write_text(stem.with_name(f"{stem.name}.json"), json.dumps(stored, indent=2, ensure_ascii=False) + "\n")
    save(cost_figure(ladder), stem.with_name(f"{stem.name}.png"))
