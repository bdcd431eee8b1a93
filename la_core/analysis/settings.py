"""Settings of limit analysis that are not part of the scene."""

from dataclasses import dataclass, field

from la_core.coulomb import PredictionSettings


@dataclass(frozen=True)
class AnalysisSettings:
    """Settings of one analysis.

    Attributes
    ----------
    follow_path : bool
        Whether to follow the curve from rest to the plateau, as a [path] table of the scene does.
    sliding_reason : str
        Reason why joints are known to slide, such as an earlier run of YADE. It keeps friction in the model where
        "auto" might leave it out. "" where nothing is known.
    prediction : PredictionSettings
        Viscosities and steps of the paths to the plateau. A scene that requests an accuracy overrides them.
    """

    follow_path: bool = False
    sliding_reason: str = ""
    prediction: PredictionSettings = field(default_factory=PredictionSettings)
