"""What a caller may ask of limit analysis besides the scene."""

from dataclasses import dataclass, field

from la_core.coulomb import PredictionSettings


@dataclass(frozen=True)
class AnalysisSettings:
    """Settings of one analysis.

    follow_path: also follow the curve from rest to the plateau, as a scene's [path] does. sliding_reason: why joints are known to slide,
    which keeps friction in the model where "auto" might leave it out; "" where nothing is known. prediction: steps to the plateau; a
    scene that requests an accuracy chooses its own.
    """

    follow_path: bool = False
    sliding_reason: str = ""
    prediction: PredictionSettings = field(default_factory=PredictionSettings)
