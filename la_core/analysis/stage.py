"""The limit-analysis stage: from a scene, or its model, to everything that limit analysis finds out about it."""

from la_core.analysis.accuracy import analyse_to_accuracy
from la_core.analysis.modelling import StructuralModel, structural_model
from la_core.analysis.one_pass import analyse_once
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.settings import AnalysisSettings
from la_core.scene import Scene


def analyse(scene: Scene | StructuralModel, settings: AnalysisSettings | None = None) -> LimitAnalysis:
    """Assemble and solve a scene; where it requests an accuracy, the best of the attempts to reach it, with a record of all of them.

    scene: or its model, so that it is not assembled twice. Raises SceneError for everything that the scene requests and does not allow.
    """
    model = scene if isinstance(scene, StructuralModel) else structural_model(scene)
    analyse_model = analyse_once if model.scene.accuracy is None else analyse_to_accuracy
    return analyse_model(model, settings or AnalysisSettings())
