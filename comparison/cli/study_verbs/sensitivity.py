"""The study of the classic iteration on one scene: references, runs, figure."""

from pathlib import Path

from comparison.figures import structure
from comparison.progress import Narration
from comparison.studies import Sensitivity, sensitivity_figure, study
from la_core.analysis import analyse
from la_core.errors import SceneError
from la_core.limit import Status
from la_core.scene import Scene


def study_and_draw(scene: Scene, figure: Path, narration: Narration) -> tuple[Sensitivity, dict[str, tuple[float, int]]]:
    """Study a scene and write the figure; also returns the value and the number of programmes of what it is held against.

    Raises SceneError for a structure without an answer.
    """
    analysis = analyse(scene)
    main, coulomb = analysis.bounds[analysis.main], analysis.coulomb
    if main.status is not Status.SOLVED:
        raise SceneError(str(scene.path), f"limit analysis ends as {main.status}, so there is nothing to iterate on")
    references = {"associated": (main.value, 1)}
    if coulomb is not None:
        references["Coulomb, elastic joints"] = (coulomb.value, coulomb.iterations)
    result = study(
        scene,
        analysis.whole,
        progress=lambda done, of, _: narration.fraction(scene.name, done / of, f"run {done} of {of}"),
    )
    structure.save(sensitivity_figure(result, references), figure)
    return result, references
