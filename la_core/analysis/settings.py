"""Optional inputs of an analysis beside its scene: settings and a listener."""

from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

from la_core.analysis.result import LimitAnalysis
from la_core.coulomb import PathProgress, PredictionSettings
from la_core.errors import SceneError


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
        Viscosities and steps of the paths to the plateau. A scene that requests an accuracy or a high effort overrides them.
    bounds_only : bool
        Whether the analysis ends with the bounds, without prediction, path and requested accuracy. Its effects say so.
    """

    follow_path: bool = False
    sliding_reason: str = ""
    prediction: PredictionSettings = field(default_factory=PredictionSettings)
    bounds_only: bool = False


@runtime_checkable
class AnalysisListener(Protocol):
    """Receives the results of an analysis while it still runs."""

    def bounds(self, analysis: LimitAnalysis) -> None:
        """Receive the bounds as soon as they are known, before the paths; `analysis` has no prediction yet.

        With a requested accuracy, each attempt has its own bounds, at its own inset.
        """

    def path(self, report: PathProgress) -> None:
        """Receive the progress of a path; the path belongs to the bounds that were received last."""


def checked(listener: AnalysisListener | None) -> AnalysisListener | None:
    """Return the listener that a caller gave; raises SceneError where it lacks a method, before anything is computed."""
    if listener is not None and not isinstance(listener, AnalysisListener):
        raise SceneError("listener", "must have the methods `bounds` and `path`, or be None", value=type(listener).__name__)
    return listener


class Silent:
    """An `AnalysisListener` that reports nothing."""

    def bounds(self, analysis: LimitAnalysis) -> None:
        """Do nothing."""

    def path(self, report: PathProgress) -> None:
        """Do nothing."""
