"""One scene from start to end: limit analysis, YADE, comparison, figures. A stage is repeated only if its inputs change."""

import contextlib
import dataclasses
import hashlib
import json
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from comparison.judge import (
    INTERRUPTED_RUN,
    check_answer,
    check_expected,
    check_run,
    comparison_summary,
    for_a_failed_run,
    requested_accuracy,
    without_run,
    without_undefined,
    yade_summary,
)
from comparison.limit_analysis import Listener, first_prediction, limit_analysis_stage
from comparison.numbers import first_names
from comparison.run_folder import ANIMATION, FIGURES, alone_in, copy_inputs, is_writable, read_text, write_text
from comparison.verdict import VERDICTS, Check, Verdict
from comparison.workflow import restored_effects
from comparison.workflow.stages import COMPARISON_CODE, run_inputs, stage_digest, store_changed, yade_stage
from comparison.yade import Results, accuracy_settings, read_results, results_beside
from la_core import exchange
from la_core.analysis import LimitAnalysis, StructuralModel, structural_model
from la_core.scene import Scene

TIME_LIMIT: float = exchange.SETTING_DEFAULTS["time_limit"]  # s of wall time, if neither scene nor command sets another limit
NAMED = 3  # largest number of scenes in one message
MAKES_RESULTS = "`crosscheck run SCENE` makes some, in Python `comparison.run`"
INSTALL_YADE = "See `crosscheck doctor`; then run the scene again."  # it names no log, because a missing YADE has written none
LIVE_WITHOUT_YADE = (
    "A live load is a matter of limit analysis alone, so YADE was not run."  # version 0.2.0 stored it; YADE runs live loads now
)
AFTER_RELEASE = (
    'Rotations are finite ([effects] rotation = "finite"): both methods answer for a motion after which turning blocks have released '
    "the thrusts that friction locked in."
)
Figures = Callable[[Results], Mapping[str, Callable[[], Any]]]  # returns the function that draws each figure of the results, by name


@dataclasses.dataclass(frozen=True)
class SceneOutcome:
    """Results of both methods before the comparison.

    Attributes
    ----------
    results : Results
        Limit analysis and YADE's run.
    yade : dict or None
        Summary of YADE's run, or the reason why there is no run; None if YADE was not requested.
    notes : list of str
        Sentences for the reader of the report.
    inputs : str
        Digest of the inputs of the latest stage.
    first_verdict : dict or None
        Verdict and values of an earlier attempt with coarser settings; None for a first attempt.
    """

    results: Results
    yade: dict[str, Any] | None
    notes: list[str]
    inputs: str
    first_verdict: dict[str, Any] | None = None


def run_scene(
    scene: Scene | StructuralModel,
    folder: Path,
    listener: Listener,
    with_yade: bool,
    time_limit: float | None = None,
    figures: Figures | None = None,
    first_verdict: dict[str, Any] | None = None,
) -> dict[str, Any]:
    """Run a scene through both methods and return the content of comparison.json; every file in the folder is complete or absent.

    Raises FolderInUseError if another process works in the folder.

    Parameters
    ----------
    scene : Scene or StructuralModel
        The scene, or its model if it is already assembled.
    folder : Path
        Folder of the scene's results; created if it does not exist.
    listener : Listener
        Receives the progress.
    with_yade : bool
        Whether YADE runs.
    time_limit : float or None
        Time limit of a YADE run, s of wall time; None for the limit of the scene, or else TIME_LIMIT.
    figures : callable or None
        Returns the drawing functions by figure name; None for all figures.
    first_verdict : dict or None
        Verdict and values of an earlier attempt with coarser settings; they are stored with the comparison and do not affect it.
    """
    model = scene if isinstance(scene, StructuralModel) else structural_model(scene)
    folder.mkdir(parents=True, exist_ok=True)
    with alone_in(folder):
        copy_inputs(model.scene, folder)
        outcome = _solved(model, folder, listener, with_yade, time_limit)
        return _compare(dataclasses.replace(outcome, first_verdict=first_verdict), folder, listener, figures)


def report_again(folder: Path, listener: Listener) -> dict[str, Any]:
    """Compare and draw the stored results of a run's folder again, and return the content of comparison.json.

    A folder that cannot be written is read without a lock, and nothing is stored there.
    Raises exchange.ExchangeError if limit analysis is missing, and FolderInUseError if another process works in the folder.
    folder, listener: as in `run_scene`.
    """
    if not (folder / "case.h5").is_file():  # a folder of other files is not changed
        if (folder / "comparison.json").is_file() or (folder / "run.h5").is_file():
            raise exchange.ExchangeError(f"{folder / 'case.h5'}: missing beside the other results of `crosscheck run`; run the scene again")
        inside = sorted(path.parent.name for path in folder.glob("*/case.h5"))
        hint = f"name the folder of one of its scenes: {first_names(inside, NAMED)}" if inside else results_beside(folder) or MAKES_RESULTS
        raise exchange.ExchangeError(f"{folder}: holds no results of `crosscheck run`; {hint}")
    with alone_in(folder) if is_writable(folder) else contextlib.nullcontext():
        results = read_results(folder)
        previous = _stored_summary(folder)
        if results.run and _came_without_yade(previous, folder):
            results = dataclasses.replace(results, run=None)
        yade = yade_summary(results.run) if results.run else _without_run(previous.get("yade"), folder)
        inputs = exchange.inputs_digest(folder / ("run.h5" if results.run else "case.h5"))
        notes = [note for note in previous.get("notes") or [] if note != LIVE_WITHOUT_YADE] or _notes(results.analysis)
        outcome = SceneOutcome(results, yade, notes, inputs, previous.get("first_verdict"))
        summary = _compare(outcome, folder, listener, None)
    if previous.get("verdict", summary["verdict"]) != summary["verdict"] and _values(previous) == _values(summary):
        now, before = (VERDICTS[one["verdict"]][1] for one in (summary, previous))
        listener.stage(results.scene.name, "comparison", f"{now}; the same results were judged before: {before}")
    return summary


def _values(summary: Mapping[str, Any]) -> list[Any]:
    """Return the values and statuses of both methods in a comparison; they are equal in comparisons of the same results."""
    answers = summary.get("limit_analysis") or {}
    parts = (answers.get("associated"), answers.get("coulomb"), summary.get("yade"))
    return [(part or {}).get(name) for part in parts for name in ("status", "reaction", "multiplier", "steps")]


def would_run_slower(folder: Path, time_limit: float | None) -> bool:
    """Return whether `run_scene` with this time limit would repeat the stored run more slowly, because it missed the requested accuracy.

    An earlier, smaller limit may not have allowed this run. A scene whose stored results cannot be read is also run again.
    folder, time_limit: as in `run_scene`.
    """
    accuracy = _stored_summary(folder).get("accuracy") or {}
    if accuracy.get("yade", {"kept": True})["kept"]:
        return False
    try:
        results = read_results(folder)
    except exchange.ExchangeError:
        return True
    return accuracy_settings.slower_settings(results, _limit(results.scene, time_limit)) is not None


def _limit(scene: Scene, time_limit: float | None) -> float:
    """Return the time limit of a YADE run, s of wall time: the requested limit, the limit of the scene, or TIME_LIMIT."""
    return time_limit or float(scene.yade.get("time_limit", TIME_LIMIT))


def _came_without_yade(previous: dict[str, Any], folder: Path) -> bool:
    """Return whether a comparison without YADE, as by `crosscheck run --no-yade`, is newer than the record of YADE in the folder."""
    if "yade" not in previous or previous["yade"] is not None:
        return False
    compared, recorded = ((folder / name).stat().st_mtime for name in ("comparison.json", "run.h5"))
    return compared >= recorded


def _without_run(yade: dict[str, Any] | None, folder: Path) -> dict[str, Any] | None:
    """Return the summary of YADE in a folder without its run: None, the earlier failure, or a failure as interrupted or missing.

    A run that was interrupted has left its log, but no comparison.
    """
    if yade is None and (folder / "yade.log").is_file() and not (folder / "comparison.json").exists():
        return without_run("failed", f"{INTERRUPTED_RUN}, so nothing can be compared")
    if yade is None or yade["status"] in ("missing", "failed"):
        return yade
    return without_run("failed", f"{folder / 'run.h5'}: the record of YADE's run is missing, so nothing can be compared")


def _solved(model: StructuralModel, folder: Path, listener: Listener, with_yade: bool, time_limit: float | None) -> SceneOutcome:
    """Return both methods' results, stored or new; limit analysis alone without YADE."""
    scene = model.scene
    analysis, inputs = limit_analysis_stage(model, folder, listener)
    if not with_yade:
        return SceneOutcome(Results(analysis), None, _notes(analysis), inputs)
    limit = _limit(scene, time_limit)
    analysis = store_changed(analysis, accuracy_settings.initial_settings(analysis), inputs, folder)
    run, yade = yade_stage(analysis, run_inputs(inputs, analysis), folder, listener, limit)
    while run is not None and (better := _better(Results(analysis, run), listener, limit)) is not None:
        analysis = store_changed(analysis, better, inputs, folder)
        run, yade = yade_stage(analysis, run_inputs(inputs, analysis), folder, listener, limit)
    return SceneOutcome(Results(analysis, run), yade, _notes(analysis), run_inputs(inputs, analysis))


def _better(results: Results, listener: Listener, limit: float) -> LimitAnalysis | None:
    """Return the analysis for another run, with restored effects that this run needs or with slower settings; None for neither."""
    scene, analysis = results.scene, results.analysis
    if (whole := restored_effects.restore(results)) is not None:
        effects = whole.assembly.effects
        restored = [effect for effect in effects.called_back if effect not in analysis.assembly.effects.called_back]
        reasons = "; ".join(f"{effect}: {effects.reasons[effect]}" for effect in restored)
        listener.stage(scene.name, "limit analysis", f"repeated with effects that were left out ({reasons})")
        return accuracy_settings.initial_settings(accuracy_settings.carry_attempts_over(results, whole))
    if slower := accuracy_settings.slower_settings(results, limit):
        listener.stage(scene.name, "YADE", requested_accuracy.why_again(accuracy_settings.attempt_of(results), slower))
    return slower


def _notes(analysis: LimitAnalysis) -> list[str]:
    """Return the notes that a reader needs on the problem that both methods solve."""
    scene, shared = analysis.scene, analysis.assembly.inset
    notes = [AFTER_RELEASE] if analysis.assembly.effects.rotation == "finite" else []
    if shared == scene.inset or (scene.accuracy is not None and scene.inset != 0.0):
        return notes
    rounded = f"YADE needs an inset, and takes {shared:g} m"
    return [*notes, f"The scene has sharp edges (inset 0). {rounded}: the methods are compared at this inset."]


def _compare(outcome: SceneOutcome, folder: Path, listener: Listener, figures: Figures | None) -> dict[str, Any]:
    """Compare both methods, draw the figures, and write comparison.json last; nothing is done if the inputs are unchanged."""
    from comparison.figures import report_figures, save  # noqa: PLC0415  `yade_stage` loads these while YADE runs
    from comparison.report import structure_facts, viewer  # noqa: PLC0415

    results = outcome.results
    scene, analysis = results.scene, results.analysis
    effects = analysis.assembly.effects.as_dict
    first = first_prediction(analysis, folder)
    made_of = [outcome.inputs, outcome.yade, outcome.notes, effects, first, outcome.first_verdict]
    inputs = stage_digest(json.dumps(made_of, sort_keys=True), COMPARISON_CODE)
    drawings = {folder / f"{name}.png": draw for name, draw in (figures or report_figures)(results).items()}
    previous = _stored_summary(folder)
    view = folder / viewer.FILE
    if previous.get("inputs") == inputs and _digests((*drawings, view)).items() <= previous.get("files", {}).items():
        listener.stage(scene.name, "comparison", "cached")
        return previous
    listener.stage(scene.name, "comparison", "running")
    checks = [*check_expected(analysis), *_judge(outcome), *requested_accuracy.check_accuracy(results)]
    summary = comparison_summary(results, outcome.yade, checks, outcome.notes, first)
    summary |= {"structure": without_undefined(structure_facts(results)), "first_verdict": outcome.first_verdict}
    summary |= {"provenance": _made_by(folder, previous), "inputs": inputs}
    if not is_writable(folder):
        return summary
    if previous.get("inputs") != inputs:
        (folder / ANIMATION).unlink(missing_ok=True)
    for name in FIGURES:  # figures of an earlier run, which these results may not have
        (folder / name).unlink(missing_ok=True)
    for path, draw in drawings.items():
        save(draw(), path)
    write_text(view, viewer.viewer_text(results))
    summary["files"] = _digests((*drawings, view))
    summary["sum"] = _sum_of(summary)
    write_text(folder / "comparison.json", json.dumps(summary, indent=2, ensure_ascii=False) + "\n")
    return summary


def _made_by(folder: Path, previous: Mapping[str, Any]) -> dict[str, str]:
    """Return versions and machine of the limit analysis in a folder; empty if neither its file nor the earlier comparison has them."""
    stored = exchange.made_by(folder / "case.h5")
    return {name: words for name, words in stored.items() if name != exchange.MADE_AT} or previous.get("provenance") or {}


def _judge(outcome: SceneOutcome) -> list[Check]:
    """Return the checks of a run; without a run, the checks with the reason why nothing was compared."""
    results = outcome.results
    if results.run is not None:
        return check_run(results)
    if outcome.yade is not None:
        reason = str(outcome.yade["message"]).splitlines()[0]
        step = INSTALL_YADE if outcome.yade["status"] == "missing" else for_a_failed_run(reason)
        return [Check("YADE's run", Verdict.INCONCLUSIVE, reason=reason, next_step=step)]
    return list(check_answer(results.analysis))


def _stored_summary(folder: Path) -> dict[str, Any]:
    """Return the content of comparison.json, or an empty dict if it is missing or was changed after this program wrote it."""
    try:
        stored = json.loads(read_text(folder / "comparison.json"))
    except (OSError, ValueError, RecursionError):
        return {}
    return stored if isinstance(stored, dict) and stored.get("sum") == _sum_of(stored) else {}


def _digests(paths: Iterable[Path]) -> dict[str, str]:
    """Return the digest of each file by its name; "" for a missing file."""
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else "" for path in paths}


def _sum_of(summary: dict[str, Any]) -> str:
    """Return the digest of the content of comparison.json, without the digest itself."""
    content = {name: value for name, value in summary.items() if name != "sum"}
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
