"""`crosscheck sensitivity`: study the classic iteration on one scene: references, runs, figure."""

from pathlib import Path

from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from comparison.figures import save
from comparison.progress import Narration
from comparison.studies import sensitivity, sensitivity_figure, study_sensitivity
from la_core.scene import load_scene, shipped

CAN_GO = ("s", "violation", "programmes", "last ten")  # columns that a narrow table leaves out, in this order


def execute(context: Context) -> int:
    """Study a scene, draw the figure and print the table; raises SceneError."""
    options = context.options
    scene = load_scene(shipped.find(options.scene))
    figure = options.output or Path(f"{scene.name}-sensitivity.png")
    with Narration(context.narrator) as narration:
        result, references = study_sensitivity(scene, narration)
    try:
        save(sensitivity_figure(result, references), figure)
    finally:  # the numbers are stored nowhere, so they are printed after a full disk, too
        if options.json:
            context.print_json(sensitivity.sensitivity_dict(result) | {"figure": str(figure)})
        else:
            context.table(sensitivity.sensitivity_table(result, references), CAN_GO)
    if not options.json:
        if len({f"{trial.value:.4g}" for trial in result.trials}) == 1:
            context.tell("Every run gives the same value: the settings have no effect on this scene. `wall_third` shows a difference.")
        context.narrator.print(f"drawn in {figure}", markup=False)
    return AGREE
