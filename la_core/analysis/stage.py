"""Entry of the limit-analysis stage: from a scene, or its model, to its complete results."""

from dataclasses import replace

from la_core.analysis.accuracy import analyse_to_accuracy, finer_paths
from la_core.analysis.modelling import StructuralModel, structural_model
from la_core.analysis.one_pass import analyse_once
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.settings import AnalysisListener, AnalysisSettings, Silent
from la_core.scene import Scene


def analyse(
    scene: Scene | StructuralModel, settings: AnalysisSettings | None = None, listener: AnalysisListener | None = None
) -> LimitAnalysis:
    """Analyse a scene once, or repeatedly until it reaches the accuracy that it requests.

    Parameters
    ----------
    scene : Scene or StructuralModel
        Scene, or its model where the caller has one, so that it is not assembled twice.
    settings : AnalysisSettings, optional
        Settings of the analysis; None takes the defaults.
    listener : AnalysisListener, optional
        Receives the bounds as soon as they are known, then the progress of the paths.

    Returns
    -------
    LimitAnalysis
        Complete results. With a requested accuracy: the best attempt, with a record of all attempts.

    Raises
    ------
    SceneError
        The scene requests an effect that it does not allow.
    """
    model = scene if isinstance(scene, StructuralModel) else structural_model(scene)
    settings = settings or AnalysisSettings()
    if model.scene.effort == "high":
        settings = replace(settings, prediction=finer_paths())
    analyse_model = analyse_once if model.scene.accuracy is None or settings.bounds_only else analyse_to_accuracy
    return analyse_model(model, settings, listener or Silent())
