"""The stored stage of YADE, and digests for all stages. A stage with unchanged inputs is not run again."""

import contextlib
import dataclasses
import hashlib
import importlib
import json
import threading
from pathlib import Path
from typing import Any

import numpy as np

from comparison.errors import YadeFailedError, YadeMissingError
from comparison.judge import answer_of, without_run, without_undefined, yade_summary
from comparison.limit_analysis import Listener, first_prediction
from comparison.provenance import describe
from comparison.run_folder import is_second_attempt
from comparison.yade import ROOT, Run, Yade, locate_yade, read_run, run_yade
from la_core import exchange
from la_core.analysis import LimitAnalysis, case_file
from la_core.digests import code_digest

REPEATED = ("timeout", "failed")  # statuses that depend on the machine, not on the scene: the next call runs YADE again
YADE_CODE = (ROOT / "yade_scripts",)
COMPARISON_CODE = tuple(  # code that makes comparison.json and the figures; command line, studies and campaigns only read these
    ROOT / "comparison" / name
    for name in (
        *("limit_analysis.py", "numbers.py", "provenance.py", "run_folder.py", "settings.py"),
        *("yade", "verdict", "judge", "figures", "report", "workflow"),
    )
)


def stage_digest(made_of: str, code: tuple[Path, ...]) -> str:
    """Return the digest of a stage's inputs: its data as text, and the files or folders of its code."""
    return hashlib.sha256((made_of + code_digest(*code)).encode()).hexdigest()


def store_changed(before: LimitAnalysis, analysis: LimitAnalysis, inputs: str, folder: Path) -> LimitAnalysis:
    """Store the analysis for YADE's next run, and delete the earlier run; nothing is done if both analyses are the same object.

    The file also keeps the answer of limit analysis from before the first effect was restored.

    Parameters
    ----------
    before : LimitAnalysis
        The analysis in `case.h5`.
    analysis : LimitAnalysis
        The analysis for the next run, which is returned.
    inputs : str
        Digest of the scene's inputs, to be stored with it.
    folder : Path
        Folder of the scene's results.
    """
    if analysis is not before:
        first = first_prediction(before, folder)
        if analysis.assembly.effects.called_back and not before.assembly.effects.called_back:
            first = answer_of(before)
        (folder / "run.h5").unlink(missing_ok=True)
        text = json.dumps(without_undefined(first), sort_keys=True) if first else ""
        case_file.write_case(folder / "case.h5", analysis, inputs, text, describe())
    return analysis


def run_inputs(inputs: str, analysis: LimitAnalysis) -> str:
    """Return the digest of the inputs of a YADE run: the scene's digest `inputs`, the model in `case.h5`, and YADE's settings."""
    effects, aside, record = analysis.assembly.effects, analysis.assembly.aside, analysis.accuracy
    model = [effects.plane, effects.displacement, effects.recording, np.flatnonzero(aside).tolist()]
    model += [analysis.assembly.inset, dataclasses.asdict(analysis.stiffness), record and record.settings]
    return stage_digest(json.dumps([inputs, model]), YADE_CODE)


def yade_stage(
    analysis: LimitAnalysis, inputs: str, folder: Path, listener: Listener, time_limit: float
) -> tuple[Run | None, dict[str, Any]]:
    """Return YADE's run, stored or new, and its summary; the run is None if YADE is missing or failed.

    Parameters
    ----------
    analysis : LimitAnalysis
        The analysis in `case.h5`.
    inputs : str
        Digest of the run's inputs.
    folder : Path
        Folder of the scene's results.
    listener : Listener
        Receives the progress.
    time_limit : float
        Time limit of the run, s of wall time.
    """
    scene, path = analysis.scene, folder / "run.h5"
    if (stored := _stored_run(analysis, inputs, path, listener)) is not None:
        listener.stage(scene.name, "YADE", "cached")
        return stored, yade_summary(stored)
    path.unlink(missing_ok=True)
    try:
        installation = locate_yade()

        def hear(report: dict[str, Any]) -> None:
            if report.get("stage") == "loaded":
                yade = Yade(installation.python, installation.modules, str(report.get("version")), tuple(report.get("lacks") or ()))
                caution = f" ({yade.short_caution})" if yade.short_caution else ""
                listener.stage(scene.name, "YADE", f"running YADE {yade.version}{caution}")
            of_scene = {"unit": scene.settlement_unit, "quantity": scene.quantity, "is_second_attempt": is_second_attempt(scene)}
            listener.progress(scene.name, report | of_scene)

        (folder / "comparison.json").unlink(missing_ok=True)  # it is of earlier results, or of limit analysis alone
        run_yade(installation, folder, inputs, time_limit, hear, _load_drawing)
        run = read_run(path, analysis.assembly)
        if exchange.inputs_digest(path) != inputs:
            raise exchange.ExchangeError(f"{path}: its digest is not that of the run that was started; run the scene again")
        return run, yade_summary(run)
    except YadeMissingError as error:
        listener.stage(scene.name, "YADE", f"missing: {error}")
        return None, without_run("missing", str(error))
    except (YadeFailedError, exchange.ExchangeError) as error:
        listener.stage(scene.name, "YADE", f"failed: {error}")
        return None, without_run("failed", str(error))


def _stored_run(analysis: LimitAnalysis, inputs: str, path: Path, listener: Listener) -> Run | None:
    """Return the stored run of these inputs; None if no run is stored, if it cannot be read, or if another try may end differently."""
    if exchange.inputs_digest(path) != inputs:
        return None
    try:
        stored = read_run(path, analysis.assembly)
    except exchange.ExchangeError as error:
        listener.stage(analysis.scene.name, "YADE", f"repeated, because the stored run cannot be read: {error}")
        return None
    return None if stored.status in REPEATED else stored


def _load_drawing() -> None:
    """Load the modules for figures and reports in a thread, which takes about as long as the start of YADE."""

    def load() -> None:
        with contextlib.suppress(Exception):  # the comparison loads the modules again and reports the error
            importlib.import_module("comparison.report")

    threading.Thread(target=load, daemon=True).start()
