"""Stages of one scene whose results are stored: limit analysis and YADE. A stage whose inputs did not change is not run again."""

import dataclasses
import hashlib
import json
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from comparison.errors import YadeFailedError, YadeMissingError
from comparison.judge import requested_accuracy, without_run, yade_summary
from comparison.yade import ROOT, Run, find_yade, read_run, run_yade
from la_core import exchange
from la_core.analysis import LimitAnalysis, StructuralModel, analyse, case_file
from la_core.digests import code_digest

REPEATED = ("timeout", "failed")  # outcomes of a machine, not of a scene: tried again by the next call
YADE_CODE = (ROOT / "yade_scripts",)
COMPARISON_CODE = tuple(  # of the rooms that make comparison.json and the figures; the command line, studies and campaigns only use them
    ROOT / "comparison" / name
    for name in ("numbers.py", "provenance.py", "run_folder.py", "settings.py", "yade", "judge", "figures", "report", "workflow")
)


class Listener(Protocol):
    """Hears what happens while it happens."""

    def stage(self, scene: str, stage: str, state: str) -> None:
        """A stage began, was found cached, or ended in a way worth a word."""

    def progress(self, scene: str, report: dict[str, Any]) -> None:
        """YADE reports where it is."""


def stage_digest(made_of: str, code: tuple[Path, ...]) -> str:
    """Digest of a stage's inputs: what it is made of, and the code that makes it."""
    return hashlib.sha256((made_of + code_digest(*code)).encode()).hexdigest()


def limit_analysis_stage(model: StructuralModel, folder: Path, listener: Listener) -> tuple[LimitAnalysis, str]:
    """Limit analysis, stored or new, and the digest of its inputs; a new one makes a run on the old one worthless."""
    scene, path = model.scene, folder / "case.h5"
    inputs = case_file.scene_digest(scene)
    if exchange.inputs_digest(path) == inputs:
        try:
            stored = case_file.read_case(path, scene, model.assembly.interfaces)
            listener.stage(scene.name, "limit analysis", "cached")
            return stored, inputs
        except exchange.ExchangeError as error:
            listener.stage(scene.name, "limit analysis", f"done again: {error}")
    else:
        listener.stage(scene.name, "limit analysis", "running")
    analysis = analyse(model)
    for attempt in analysis.accuracy.limit_analysis if analysis.accuracy else ():
        listener.stage(scene.name, "limit analysis", requested_accuracy.attempt_words(attempt))
    (folder / "run.h5").unlink(missing_ok=True)
    case_file.write_case(path, analysis, inputs)
    return analysis, inputs


def store_changed(before: LimitAnalysis, analysis: LimitAnalysis, inputs: str, folder: Path) -> LimitAnalysis:
    """Write the analysis that YADE's next run is made from, where it is not the one before, whose run is worthless with it."""
    if analysis is not before:
        (folder / "run.h5").unlink(missing_ok=True)
        case_file.write_case(folder / "case.h5", analysis, inputs)
    return analysis


def run_inputs(inputs: str, analysis: LimitAnalysis) -> str:
    """Digest of what makes a run in YADE: the scene's, which model of it `case.h5` carries, and with which settings."""
    effects, aside, record = analysis.assembly.effects, analysis.assembly.aside, analysis.accuracy
    model = [effects.plane, effects.displacement, effects.recording, np.flatnonzero(aside).tolist()]
    model += [analysis.assembly.inset, dataclasses.asdict(analysis.stiffness), record and record.settings]
    return stage_digest(json.dumps([inputs, model]), YADE_CODE)


def yade_stage(
    analysis: LimitAnalysis, inputs: str, folder: Path, listener: Listener, time_limit: float
) -> tuple[Run | None, dict[str, Any]]:
    """YADE's run, stored or new, and its summary; no run when YADE is missing or failed. inputs: digest of the run's inputs."""
    scene, path = analysis.scene, folder / "run.h5"
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
        caution = " (untested version, see `crosscheck doctor`)" if yade.caution else ""
        listener.stage(scene.name, "YADE", f"running YADE {yade.version}{caution}")
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
