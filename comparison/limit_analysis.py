"""The stored stage of limit analysis, for `crosscheck run` and `crosscheck solve`."""

import contextlib
from pathlib import Path
from typing import Any, Protocol

from comparison.errors import FolderInUseError
from comparison.judge import answer_of_text, requested_accuracy
from comparison.provenance import describe
from comparison.run_folder import LOCK, alone_in, copy_inputs, refuse_name
from la_core import exchange
from la_core.analysis import AnalysisListener, LimitAnalysis, StructuralModel, analyse, case_file
from la_core.errors import SceneError
from la_core.scene import Scene


class Listener(AnalysisListener, Protocol):
    """Receives the progress of the stages while they run."""

    def stage(self, scene: str, stage: str, state: str) -> None:
        """Receive the new state of a scene's stage as one phrase: it began, was found cached, or ended unusually."""

    def progress(self, scene: str, report: dict[str, Any]) -> None:
        """Receive a progress report of YADE, as `comparison.yade.run_yade` describes it, with unit and quantity of the scene."""


def limit_analysis_stage(model: StructuralModel, folder: Path, listener: Listener) -> tuple[LimitAnalysis, str]:
    """Return the stored or a new limit analysis, and the digest of its inputs. A new one deletes YADE's run of the old one, and its log.

    model: model of the scene. folder: folder of its results. listener: receives the progress.
    """
    scene, path = model.scene, folder / "case.h5"
    inputs = case_file.scene_digest(scene)
    if exchange.inputs_digest(path) == inputs:
        try:
            stored = case_file.read_case(path, scene, model.assembly.interfaces)
            first_prediction(stored, folder)  # raises an error for an unreadable one, which is damage, too
            listener.stage(scene.name, "limit analysis", "cached")
            return stored, inputs
        except exchange.ExchangeError as error:
            listener.stage(scene.name, "limit analysis", f"repeated, because the stored result cannot be read: {error}")
    else:
        listener.stage(scene.name, "limit analysis", "running")
    analysis = _analysed(model, listener)
    for name in ("run.h5", "yade.log"):
        (folder / name).unlink(missing_ok=True)
    case_file.write_case(path, analysis, inputs, made_by=describe())
    return analysis, inputs


def first_prediction(analysis: LimitAnalysis, folder: Path) -> dict[str, Any] | None:
    """Return the answer of limit analysis before YADE ran, in the form of `answer_of`; None where no effect was restored since.

    Raises exchange.ExchangeError where the stored text is no such answer. analysis: content of `case.h5`. folder: the scene's results.
    """
    path = folder / "case.h5"
    text = case_file.read_first_prediction(path) if analysis.assembly.effects.called_back else ""
    with exchange.values_of(path):
        return answer_of_text(text) if text else None


def limit_analysis_alone(model: StructuralModel, folder: Path, listener: Listener) -> LimitAnalysis:
    """Return the stored or a new limit analysis, and store a new one for `crosscheck run` unless it would replace another result.

    A folder that is in use, cannot be read or cannot be written is no error: the analysis is then made, and not stored. The folder is
    locked only while results are written, so that no other process waits for an analysis.

    Parameters
    ----------
    model : StructuralModel
        Model of the scene.
    folder : Path
        Folder of the scene's results; made only where something is stored.
    listener : Listener
        Receives the progress.
    """
    scene, path = model.scene, folder / "case.h5"
    inputs = case_file.scene_digest(scene)
    with contextlib.suppress(exchange.ExchangeError):
        if (
            exchange.inputs_digest(path) == inputs
            and not (stored := case_file.read_case(path, scene, model.assembly.interfaces)).assembly.effects.called_back
        ):
            listener.stage(scene.name, "limit analysis", "cached")
            return stored
    analysis = _analysed(model, listener)
    with contextlib.suppress(OSError, SceneError, FolderInUseError):
        _store_as_first(analysis, inputs, folder)
    return analysis


def _analysed(model: StructuralModel, listener: Listener) -> LimitAnalysis:
    """Return a new analysis, and tell the listener the attempts to reach a requested accuracy."""
    analysis = analyse(model, listener=listener)
    for attempt in analysis.accuracy.limit_analysis if analysis.accuracy else ():
        listener.stage(model.scene.name, "limit analysis", requested_accuracy.attempt_words(attempt))
    return analysis


def _store_as_first(analysis: LimitAnalysis, inputs: str, folder: Path) -> None:
    """Store an analysis as `crosscheck run` would, unless the folder holds anything else.

    Raises OSError for a folder that cannot be written, FolderInUseError for one in use, and SceneError for a scene that `run` refuses.
    """
    scene = analysis.scene
    refuse_name(scene)
    if folder.exists() and not _is_free(folder, scene):
        return
    folder.mkdir(parents=True, exist_ok=True)
    with alone_in(folder):
        if _is_free(folder, scene):  # another process may have been faster
            copy_inputs(scene, folder)
            case_file.write_case(folder / "case.h5", analysis, inputs, made_by=describe())


def _is_free(folder: Path, scene: Scene) -> bool:
    """Return whether a folder holds at most a lock and a copy of the same scene, as an interrupted call leaves them."""
    names, copied = {path.name for path in folder.iterdir()}, folder / "scene.toml"
    is_same = copied.name not in names or (copied.is_file() and copied.read_bytes() == scene.text.encode())
    return is_same and names <= {LOCK, copied.name}
