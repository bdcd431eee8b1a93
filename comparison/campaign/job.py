"""What a worker does: one scene through both methods in its own folder, and what the campaign's tables say of it."""

import contextlib
import hashlib
import json
import math
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from comparison.campaign.cases import CaseRun
from comparison.campaign.columns import answers_of, costs_of
from comparison.campaign.mechanism_labels import mechanism_label
from comparison.errors import FolderInUseError, message_of
from comparison.judge import without_undefined
from comparison.provenance import describe
from comparison.report import write_report
from comparison.run_folder import alone_in, write_text
from comparison.workflow import COMPARISON_CODE, REPEATED, YADE_CODE, Listener, run_scene
from comparison.yade import ROOT, read_results
from la_core.analysis import LimitAnalysis, structural_model
from la_core.digests import code_digest
from la_core.limit import ClassicParameters, Drive, Status, solve_sequentially
from la_core.scene import Scene

OUTCOME = "outcome.json"
HERE = Path(__file__).parent
OWN_CODE = tuple(HERE / name for name in ("columns.py", "job.py", "mechanism_labels.py"))  # the other modules only gather and draw
CODE = (ROOT / "la_core", *YADE_CODE, *COMPARISON_CODE, *OWN_CODE)  # what an outcome is made by
PATIENCE = 600.0  # s for another process to leave a case's folder: one that an earlier call began and that has not seen its end yet
LOOKS_EVERY = 0.2  # s
OTHER_CODE = "the worker runs another version of this program than the campaign; restart the worker, and run the campaign again"

JobOutcome = dict[str, Any]


@dataclass(frozen=True)
class Job:
    """A scene to take through both methods in `folder`, and through the classic iteration for each of some cases, by name.

    inputs: digest of all that decides the outcome. code: that of the program that asks for it. time_limit: wall seconds for YADE, None
    for the scene's own.
    """

    scene: Scene
    folder: Path
    yade: bool
    classic: dict[str, ClassicParameters]
    inputs: str
    code: str
    time_limit: float | None = None

    @property
    def scene_folder(self) -> Path:
        """Where the scene's own results lie, as `crosscheck run -o FOLDER` lays them."""
        return self.folder / self.scene.name


class StoppedError(BaseException):
    """The campaign that a job belongs to has ended; no failure, so nothing that collects failures sees it."""


def code() -> str:
    """Digest of the code and versions that decide an outcome, as they lie on the disk."""
    versions = {name: version for name, version in describe().items() if name != "machine"}
    return hashlib.sha256(json.dumps([code_digest(*CODE), versions]).encode()).hexdigest()


LOADED = code()  # of what this process works with, however long it lives and whatever is installed meanwhile


def digest(run: CaseRun, yade: bool, classic: dict[str, ClassicParameters], by: str) -> str:
    """Digest of all that decides what a run comes to; `by` is that of the code."""
    what = [by, run.scene_name, run.text, run.meshes, yade, {name: asdict(parameters) for name, parameters in classic.items()}]
    return hashlib.sha256(json.dumps(what).encode()).hexdigest()


def stored_outcome(folder: Path, scene_name: str, inputs: str) -> JobOutcome | None:
    """What a job came to, where it was done from the same inputs and its results are still there; None where it is to be done."""
    try:
        stored = json.loads((folder / OUTCOME).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    if not isinstance(stored, dict) or stored.get("sum") != _sum_of(stored) or stored.get("inputs") != inputs:
        return None
    files = [folder / "report.html", folder / scene_name / "case.h5", folder / scene_name / "comparison.json"]
    if stored["answers"]["yade_status"] is not None:
        files.append(folder / scene_name / "run.h5")
    is_final = stored["state"] == "done" and stored["answers"]["yade_status"] not in REPEATED
    return stored if is_final and all(path.is_file() for path in files) else None


def run_job(job: Job, listener: Listener) -> JobOutcome:
    """Do a job; whatever goes wrong is a failed outcome with its reason. A done one is stored in the job's folder."""
    began = time.monotonic()
    try:
        if {LOADED, code()} != {job.code}:  # stages store under the code on the disk what the loaded code makes
            return failure(OTHER_CODE, job)
        job.folder.mkdir(parents=True, exist_ok=True)
        with _alone_after_waiting(job.folder):
            if (stored := stored_outcome(job.folder, job.scene.name, job.inputs)) is not None:
                return stored
            outcome = _done(job, listener)
            outcome["costs"]["seconds"] = time.monotonic() - began
            outcome = without_undefined(outcome | {"inputs": job.inputs})
            write_text(job.folder / OUTCOME, json.dumps(outcome | {"sum": _sum_of(outcome)}, indent=1, ensure_ascii=False) + "\n")
            return outcome
    except Exception as error:  # whatever it is, the other cases go on
        return failure(message_of(error), job)


def failure(reason: str, job: Job) -> JobOutcome:
    """A job's failed outcome, for a reason."""
    return {"state": "failed", "answers": {"reason": _told(reason, job)}, "costs": {}, "classic": {}}


def _told(reason: str, job: Job) -> str:
    """The first line of a reason, with paths from the case's or its scene's folder on: tables must not hang on where these lie."""
    for folder in (job.folder, job.scene.path.parent):
        reason = reason.replace(f"{folder}/", "") if folder.name else reason
    return next(iter(reason.splitlines()), "")


def _done(job: Job, listener: Listener) -> JobOutcome:
    model = structural_model(job.scene)
    summary = run_scene(model, job.scene_folder, listener, job.yade, job.time_limit)
    write_report(job.folder, [summary], describe())
    results = read_results(job.scene_folder, model.assembly.interfaces)
    scene, analysis, run = results.scene, results.analysis, results.run
    main = analysis.bounds[analysis.main]
    mechanisms = {"associated": main.twists}
    if analysis.coulomb is not None:
        mechanisms["coulomb"] = analysis.coulomb.twists
    if run is not None and summary["yade"] is not None:  # a run may lie there from a call that asked for YADE
        mechanisms["yade"] = run.mechanism()
    labels = {method: mechanism_label(analysis.assembly.blocks, twists) for method, twists in mechanisms.items()}
    answers = answers_of(summary, labels)
    answers["reason"] = _told(answers["reason"] or "", job)
    state = "failed" if answers["yade_status"] in ("missing", "failed") else "done"
    outcome: JobOutcome = {"state": state, "answers": answers, "costs": costs_of(summary), "classic": {}}
    for name, parameters in job.classic.items():
        listener.stage(scene.name, "classic iteration", name)
        outcome["classic"][name] = _classic(analysis, parameters)
    return outcome


def _classic(analysis: LimitAnalysis, parameters: ClassicParameters) -> dict[str, Any]:
    """The classic iteration on the whole structure, at the inset that both methods share."""
    assembly = analysis.whole
    found = solve_sequentially(assembly, Drive.LIVE if assembly.has_live_load else Drive.YIELDING, parameters)
    value = found.value if found.status is Status.SOLVED else math.nan
    return {"value": value, "status": found.status.value, "iterations": found.iterations, "seconds": found.seconds}


@contextlib.contextmanager
def _alone_after_waiting(folder: Path) -> Iterator[None]:
    deadline = time.monotonic() + PATIENCE
    with contextlib.ExitStack() as stack:
        while True:
            try:
                stack.enter_context(alone_in(folder))
                break
            except FolderInUseError:
                if time.monotonic() > deadline:
                    raise
                time.sleep(LOOKS_EVERY)
        yield


def _sum_of(outcome: JobOutcome) -> str:
    content = {name: value for name, value in outcome.items() if name != "sum"}
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
