"""The straight line of one scene: limit analysis, YADE, comparison, figures; each stage is redone only when its inputs change."""

import dataclasses
import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from comparison import provenance
from comparison.errors import YadeFailedError, YadeMissingError
from comparison.figures import figures as _figures
from comparison.figures import structure
from comparison.judge import Check, Verdict, check_expected, check_run, comparison_summary, requested_accuracy, without_run, yade_summary
from comparison.report import viewer
from comparison.run_folder import ANIMATION, alone_in, copy_inputs, write_text
from comparison.workflow import finer_prediction, restored_effects
from comparison.yade import ROOT, Run, accuracy_settings, find_yade, read_results, read_run, run_yade
from la_core import exchange
from la_core.analysis import LimitAnalysis, accuracy, case_file, code_digest
from la_core.analysis import digest as scene_digest
from la_core.limit import Status
from la_core.scene import Scene

TIME_LIMIT = 3600.0  # s of wall time for one YADE run, when neither scene nor command says otherwise
REPEATED = ("timeout", "failed")  # outcomes of a machine, not of a scene: tried again by the next call


class Listener(Protocol):
    """Hears what happens while it happens."""

    def stage(self, scene: str, stage: str, state: str) -> None:
        """A stage began, was found cached, or ended in a way worth a word."""

    def progress(self, scene: str, report: dict[str, Any]) -> None:
        """YADE reports where it is."""


@dataclass(frozen=True)
class Stored:
    """Results of both methods as they lie in a run's folder; `run` is None, and `yade` says why, where YADE gave none.

    inputs: digest of what made the latest stage. yade is None where YADE was not asked.
    """

    scene: Scene
    analysis: LimitAnalysis
    run: Run | None
    yade: dict[str, Any] | None
    notes: list[str]
    inputs: str


def run_scene(scene: Scene, folder: Path, listener: Listener, with_yade: bool, time_limit: float | None = None) -> dict[str, Any]:
    """Take a scene through both methods in `folder`, where every file is whole or absent; returns what comparison.json holds.

    time_limit: wall seconds for YADE; None takes the scene's own, or TIME_LIMIT. Raises files.FolderInUseError where another works there.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with alone_in(folder):
        return _run_alone(scene, folder, listener, with_yade, time_limit)


def _run_alone(scene: Scene, folder: Path, listener: Listener, with_yade: bool, time_limit: float | None) -> dict[str, Any]:
    copy_inputs(scene, folder)
    analysis, inputs = _limit_analysis(scene, folder, listener)
    notes = _notes(scene, analysis)
    if scene.live is not None:
        notes.append("A live load is a matter of limit analysis alone, so YADE was not run.")
    if scene.live is not None or not with_yade:
        return _compare(Stored(scene, analysis, None, None, notes, inputs), folder, listener)
    limit = time_limit or scene.yade.get("time_limit", TIME_LIMIT)
    analysis = _settle_case(scene, analysis, accuracy_settings.first_settings(scene, analysis), inputs, folder)
    run, yade = _yade(scene, analysis, _run_inputs(inputs, analysis), folder, listener, limit)
    while run is not None and (better := _better(scene, analysis, run, listener, limit)) is not None:
        analysis = _settle_case(scene, analysis, better, inputs, folder)
        run, yade = _yade(scene, analysis, _run_inputs(inputs, analysis), folder, listener, limit)
    for steps, finer in finer_prediction.predictions(scene, analysis, run) if run is not None else ():
        listener.stage(scene.name, "limit analysis", f"prediction made again in {steps} steps, for YADE contradicts it")
        case_file.write_case(folder / "case.h5", scene, finer, inputs)
        analysis = finer
    notes += finer_prediction.note(analysis)
    run_inputs = _run_inputs(inputs, analysis)
    return _compare(Stored(scene, analysis, run, yade, notes, run_inputs), folder, listener)


def _settle_case(scene: Scene, before: LimitAnalysis, analysis: LimitAnalysis, inputs: str, folder: Path) -> LimitAnalysis:
    """The analysis that YADE's next run is made from, written where it is not the one before, whose run is worthless with it."""
    if analysis is not before:
        (folder / "run.h5").unlink(missing_ok=True)
        case_file.write_case(folder / "case.h5", scene, analysis, inputs)
    return analysis


def _better(scene: Scene, analysis: LimitAnalysis, run: Run, listener: Listener, limit: float) -> LimitAnalysis | None:
    """What to model again after a run: with effects that it shows to be needed, or slower, for the accuracy asked for; None for neither."""
    if needed := restored_effects.needed(scene, analysis, run):
        words = "; ".join(f"{effect}: {reason}" for effect, (_, reason) in needed.items())
        listener.stage(scene.name, "limit analysis", f"done again with what was left out ({words})")
        whole = restored_effects.analyse_with(scene, restored_effects.called_back(analysis) | needed)
        return accuracy_settings.first_settings(scene, accuracy_settings.after(analysis, run, whole))
    if slower := accuracy_settings.again(scene, analysis, run, limit):
        listener.stage(scene.name, "YADE", requested_accuracy.why_again(accuracy_settings.attempt_of(scene, analysis, run), slower))
    return slower


def _run_inputs(inputs: str, analysis: LimitAnalysis) -> str:
    """Digest of what makes a run in YADE: the scene's, which model of it `case.h5` carries, and with which settings."""
    effects, aside, purchase = analysis.assembly.effects, analysis.assembly.aside, analysis.purchase
    model = [effects.plane, effects.displacement, effects.recording, np.flatnonzero(aside).tolist()]
    model += [analysis.assembly.inset, dataclasses.asdict(analysis.stiffness), purchase and purchase.settings]
    return _digest(json.dumps([inputs, model]), "yade_scripts")


def report_again(folder: Path, listener: Listener) -> dict[str, Any]:
    """Judge and draw the stored results of a run's folder again; raises exchange.ExchangeError where limit analysis is missing.

    Raises files.FolderInUseError where another works there.
    """
    if not (folder / "case.h5").is_file():  # nothing is touched in a folder that is somebody else's
        raise exchange.ExchangeError(f"{folder}: holds no results of `crosscheck run`")
    with alone_in(folder):
        scene, analysis, run = read_results(folder)
        previous = _stored_summary(folder)
        yade = yade_summary(run) if run else previous.get("yade")
        inputs = exchange.inputs_digest(folder / ("run.h5" if run else "case.h5"))
        notes = previous.get("notes") or _notes(scene, analysis)
        return _compare(Stored(scene, analysis, run, yade, notes, inputs), folder, listener)


def _notes(scene: Scene, analysis: LimitAnalysis) -> list[str]:
    shared = analysis.assembly.inset
    if shared == scene.inset or (scene.accuracy is not None and scene.inset != 0.0):
        return []
    return [f"The scene has sharp arrises (inset 0); YADE takes its smallest inset, {shared:g} m, and is judged by limit analysis with it."]


def _limit_analysis(scene: Scene, folder: Path, listener: Listener) -> tuple[LimitAnalysis, str]:
    """Limit analysis, stored or new, and the digest of its inputs; a new one makes a run on the old one worthless."""
    path, inputs = folder / "case.h5", scene_digest(scene)
    if exchange.inputs_digest(path) == inputs:
        try:
            stored = case_file.read_case(path, scene)
            listener.stage(scene.name, "limit analysis", "cached")
            return stored, inputs
        except exchange.ExchangeError as error:
            listener.stage(scene.name, "limit analysis", f"done again: {error}")
    else:
        listener.stage(scene.name, "limit analysis", "running")
    analysis = accuracy.analyse(scene)
    for attempt in analysis.purchase.limit_analysis if analysis.purchase else ():
        listener.stage(scene.name, "limit analysis", requested_accuracy.words(attempt))
    (folder / "run.h5").unlink(missing_ok=True)
    case_file.write_case(path, scene, analysis, inputs)
    return analysis, inputs


def _yade(
    scene: Scene, analysis: LimitAnalysis, inputs: str, folder: Path, listener: Listener, time_limit: float
) -> tuple[Run | None, dict[str, Any]]:
    """YADE's run, stored or new, and its summary; no run when YADE is missing or failed."""
    path = folder / "run.h5"
    if exchange.inputs_digest(path) == inputs:
        try:
            stored = read_run(path, analysis.assembly)
            if stored.status not in REPEATED:
                listener.stage(scene.name, "YADE", "cached")
                return stored, yade_summary(stored)
        except exchange.ExchangeError as error:
            listener.stage(scene.name, "YADE", f"done again: {error}")
    path.unlink(missing_ok=True)
    try:
        yade = find_yade()
        caution = ", of which `crosscheck doctor` has a word to say" if yade.caution else ""
        listener.stage(scene.name, "YADE", f"running {yade.version}{caution}")
        run_yade(yade, folder, inputs, time_limit, lambda report: listener.progress(scene.name, {**report, "unit": scene.settlement_unit}))
        run = read_run(path, analysis.assembly)
        if exchange.inputs_digest(path) != inputs:
            raise exchange.ExchangeError(f"{path}: not of the run that was started; run it again")
        return run, yade_summary(run)
    except YadeMissingError as error:
        listener.stage(scene.name, "YADE", f"missing: {error}")
        return None, without_run("missing", str(error))
    except (YadeFailedError, exchange.ExchangeError) as error:
        listener.stage(scene.name, "YADE", f"failed: {error}")
        return None, without_run("failed", str(error))


def _digest(of: str, room: str) -> str:
    """Digest of a stage's inputs: what it is made `of`, and the code of the `room` that makes it."""
    return hashlib.sha256((of + code_digest(ROOT / room)).encode()).hexdigest()


def _compare(stored: Stored, folder: Path, listener: Listener) -> dict[str, Any]:
    """Judge, draw the figures, and write comparison.json last; nothing is done when it was made from the same."""
    scene, analysis, run = stored.scene, stored.analysis, stored.run
    effects = dataclasses.asdict(analysis.assembly.effects)
    steps = analysis.coulomb and analysis.coulomb.steps
    inputs = _digest(json.dumps([stored.inputs, stored.yade, stored.notes, effects, steps], sort_keys=True), "comparison")
    figures = {folder / f"{name}.png": draw for name, draw in _figures(scene, analysis, run).items()}
    previous = _stored_summary(folder)
    view = folder / viewer.FILE
    if previous.get("inputs") == inputs and all(path.is_file() for path in (*figures, view)):
        listener.stage(scene.name, "comparison", "cached")
        return previous
    listener.stage(scene.name, "comparison", "running")
    if previous.get("inputs") != inputs:
        (folder / ANIMATION).unlink(missing_ok=True)
    checks = [*check_expected(scene, analysis), *_judge(stored), *requested_accuracy.check_accuracy(scene, analysis, run)]
    summary = comparison_summary(scene, analysis, stored.yade, run, checks, stored.notes)
    summary |= {"provenance": provenance.describe(), "inputs": inputs}
    for path, draw in figures.items():
        structure.save(draw(), path)
    write_text(view, viewer.viewer_text(scene, analysis, run))
    summary["sum"] = _sum_of(summary)
    write_text(folder / "comparison.json", json.dumps(summary, indent=2, ensure_ascii=False) + "\n")
    return summary


def _judge(stored: Stored) -> list[Check]:
    """Checks of a run, or the one sentence on why there are none."""
    if stored.run is not None:
        return check_run(stored.scene, stored.analysis, stored.run)
    if stored.yade is not None:
        reason = str(stored.yade["message"]).splitlines()[0]
        return [Check("YADE's run", Verdict.INCONCLUSIVE, reason=reason)]
    associated, coulomb = stored.analysis.rounded[stored.analysis.main], stored.analysis.coulomb
    if associated.status not in (Status.SOLVED, Status.INFEASIBLE, Status.UNBOUNDED):
        return [Check("limit analysis", Verdict.INCONCLUSIVE, reason=f"Limit analysis ended as {associated.status}.")]
    if coulomb is not None and coulomb.status in (Status.INACCURATE, Status.FAILED):
        reason = f"Coulomb limit analysis ended as {coulomb.status} (strain residual {coulomb.strain_residual:.1e})."
        return [Check("Coulomb limit analysis", Verdict.INCONCLUSIVE, reason=reason)]
    return []


def _stored_summary(folder: Path) -> dict[str, Any]:
    """What comparison.json says, or nothing where there is none, or where it is not as this program wrote it."""
    try:
        stored = json.loads((folder / "comparison.json").read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return stored if isinstance(stored, dict) and stored.get("sum") == _sum_of(stored) else {}


def _sum_of(summary: dict[str, Any]) -> str:
    """Digest of all that comparison.json says besides."""
    content = {name: value for name, value in summary.items() if name != "sum"}
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
