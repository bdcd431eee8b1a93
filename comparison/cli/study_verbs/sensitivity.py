"""`crosscheck sensitivity`: study the classic iteration on one scene: references, runs, figure."""

from pathlib import Path

from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from comparison.figures import save
from comparison.progress import Narration
from comparison.studies import Sensitivity, sensitivity, sensitivity_figure, study
from la_core.analysis import analyse
from la_core.errors import SceneError
from la_core.limit import Status
from la_core.scene import Scene, load_scene, shipped

CAN_GO = ("s", "violation", "programmes", "last ten")  # columns that a narrow table leaves out, the first to go first


def execute(context: Context) -> int:
    """Study a scene, draw the figure and print the table; raises SceneError."""
    options = context.options
    scene = load_scene(shipped.find(options.scene))
    figure = options.output or Path(f"{scene.name}-sensitivity.png")
    with Narration(context.narrator) as narration:
        result, references = study_and_draw(scene, figure, narration)
    if options.json:
        context.print_json(sensitivity.sensitivity_dict(result) | {"figure": str(figure)})
    else:
        context.table(sensitivity.sensitivity_table(result, references), CAN_GO)
        if len({f"{trial.value:.4g}" for trial in result.trials}) == 1:
            context.tell("Every run gives the same value: no joint slides while the support moves. `wall_third` shows a difference.")
        context.narrator.print(f"drawn in {figure}", markup=False)
    return AGREE


def study_and_draw(scene: Scene, figure: Path, narration: Narration) -> tuple[Sensitivity, dict[str, tuple[float, int | None]]]:
    """Study a scene and write the figure; returns the study, and each reference's value and number of programmes, None without any.

    Raises SceneError for a structure without an answer.
    """
    analysis = analyse(scene)
    main, coulomb = analysis.bounds[analysis.main], analysis.coulomb
    if main.status is not Status.SOLVED:
        raise SceneError(str(scene.path), f"limit analysis ends as {main.status}, so the classic iteration has no starting point")
    references: dict[str, tuple[float, int | None]] = {"associated": (main.value, 1)}
    if coulomb is not None:
        references["Coulomb, elastic joints"] = (coulomb.value, None)
    result = study(
        scene,
        analysis.whole,
        progress=lambda done, of, _: narration.fraction(scene.name, done / of, f"run {done} of {of}"),
    )
    save(sensitivity_figure(result, references), figure)
    return result, references
