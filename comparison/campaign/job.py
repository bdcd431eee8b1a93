"""The job of a worker: run one scene by both methods in its own folder, and return its values for the campaign's tables."""

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
from comparison.run_folder import OUTCOME, alone_in, read_text, write_text
from comparison.workflow import COMPARISON_CODE, REPEATED, YADE_CODE, Listener, run_scene, would_run_slower
from comparison.yade import ROOT, read_results
from la_core.analysis import LimitAnalysis, structural_model
from la_core.digests import code_digest
from la_core.exchange import inputs_digest
from la_core.limit import ClassicParameters, Drive, Status, solve_sequentially
from la_core.scene import Scene

HERE = Path(__file__).parent
OWN_CODE = tuple(HERE / name for name in ("columns.py", "job.py", "mechanism_labels.py"))  # the other modules only gather and draw
CODE = (ROOT / "la_core", *YADE_CODE, *COMPARISON_CODE, *OWN_CODE)  # code that an outcome depends on
PATIENCE = 600.0  # s to wait for a case's folder, which a worker of an earlier, interrupted call may still lock
LOOKS_EVERY = 0.2  # s
END_OF_PAGE = b"</html>\n"
OTHER_CODE = "the worker runs another version of this program than the campaign; restart the worker, and run the campaign again"

JobOutcome = dict[str, Any]


@dataclass(frozen=True)
class Job:
    """A scene to run by both methods and by the classic iteration.

    Attributes
    ----------
    scene : Scene
        The scene.
    folder : Path
        Folder of the results.
    yade : bool
        Whether YADE runs.
    classic : dict
        Parameters of the classic iteration, by the name of the case.
    inputs : str
        Digest of everything that decides the outcome.
    code : str
        Digest of the code of the campaign's process.
    time_limit : float or None
        Wall time limit of YADE (s); None takes the scene's own.
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
        """Folder of the scene's results, the same as for `crosscheck run -o FOLDER`."""
        return self.folder / self.scene.name


def code() -> str:
    """Return the digest of the code on the disk and of the versions that decide an outcome."""
    versions = {name: version for name, version in describe().items() if name != "machine"}
    return hashlib.sha256(json.dumps([code_digest(*CODE), versions]).encode()).hexdigest()


LOADED = code()  # code of this process: the code on the disk may change while it runs


def digest(run: CaseRun, yade: bool, classic: dict[str, ClassicParameters], by: str) -> str:
    """Return the digest of everything that decides the outcome of a run.

    yade: whether YADE runs. classic: parameters of the classic iteration by case. by: digest of the code.
    """
    inputs = [by, run.scene_name, run.text, run.meshes, yade, {name: asdict(parameters) for name, parameters in classic.items()}]
    return hashlib.sha256(json.dumps(inputs).encode()).hexdigest()


def stored_outcome(folder: Path, scene_name: str, inputs: str, time_limit: float | None = None) -> JobOutcome | None:
    """Return the stored outcome of a job; None if its inputs changed, its files are missing or damaged, or it has to be repeated.

    It has to be repeated where a time limit ended YADE's run, and where `time_limit` allows a slower run that a requested accuracy needs.
    """
    try:
        stored = json.loads(read_text(folder / OUTCOME))
    except (OSError, ValueError, RecursionError):
        return None
    if not isinstance(stored, dict) or stored.get("sum") != _sum_of(stored) or stored.get("inputs") != inputs:
        return None
    is_final = stored["state"] == "done" and stored["answers"]["yade_status"] not in REPEATED
    with_run, results = stored["answers"]["yade_status"] is not None, folder / scene_name
    is_whole = is_final and _are_whole(folder, results, with_run)
    return stored if is_whole and not would_run_slower(results, time_limit) else None


def _are_whole(folder: Path, results: Path, with_run: bool) -> bool:
    """Return whether a job's page and results exist undamaged; else links to it and `crosscheck report` or `animate` would fail."""
    sealed = [results / name for name in (("case.h5", "run.h5") if with_run else ("case.h5",))]
    if not all(inputs_digest(path) for path in sealed) or not (results / "scene.toml").is_file():
        return False
    try:
        json.loads(read_text(results / "comparison.json"))
        with (folder / "report.html").open("rb") as page:  # only its end is read, because a page has a megabyte
            page.seek(-len(END_OF_PAGE), 2)
            return page.read() == END_OF_PAGE
    except (OSError, ValueError, RecursionError):
        return False


def run_job(job: Job, listener: Listener) -> JobOutcome:
    """Run a job, store its outcome in the job's folder and return it; any error gives a failed outcome with its reason."""
    began = time.monotonic()
    try:
        if {LOADED, code()} != {job.code}:  # stages are stored under the digest of the code on the disk, which must be the loaded code
            return failure(OTHER_CODE, job)
        job.folder.mkdir(parents=True, exist_ok=True)
        with _alone_after_waiting(job.folder):
            if (stored := stored_outcome(job.folder, job.scene.name, job.inputs, job.time_limit)) is not None:
                return stored
            outcome = _done(job, listener)
            outcome["costs"]["seconds"] = time.monotonic() - began
            outcome = without_undefined(outcome | {"inputs": job.inputs})
            write_text(job.folder / OUTCOME, json.dumps(outcome | {"sum": _sum_of(outcome)}, indent=1, ensure_ascii=False) + "\n")
            return outcome
    except Exception as error:  # an error of one case must not stop the others
        return failure(message_of(error), job)


def failure(reason: str, job: Job) -> JobOutcome:
    """Return a failed outcome of a job with its reason."""
    return {"state": "failed", "answers": {"reason": _shortened(reason, job)}, "costs": {}, "classic": {}}


def _shortened(reason: str, job: Job) -> str:
    """Return the first line of a reason; its paths become relative, so that tables do not depend on the folders' places."""
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
    if run is not None and summary["yade"] is not None:  # without YADE a run of an earlier call may still be stored
        mechanisms["yade"] = run.mechanism()
    labels = {method: mechanism_label(analysis.assembly, twists) for method, twists in mechanisms.items()}
    answers = answers_of(summary, labels)
    answers["reason"] = _shortened(answers["reason"] or "", job)
    state = "failed" if answers["yade_status"] in ("missing", "failed") else "done"
    outcome: JobOutcome = {"state": state, "answers": answers, "costs": costs_of(summary), "classic": {}}
    for name, parameters in job.classic.items():
        listener.stage(scene.name, "classic iteration", name)
        outcome["classic"][name] = _classic(analysis, parameters)
    return outcome


def _classic(analysis: LimitAnalysis, parameters: ClassicParameters) -> dict[str, Any]:
    """Return the result of the classic iteration on the whole structure, at the inset that both methods share."""
    assembly = analysis.whole
    solution = solve_sequentially(assembly, Drive.LIVE if assembly.has_live_load else Drive.YIELDING, parameters)
    value = solution.value if solution.status is Status.SOLVED else math.nan
    counts = {"iterations": solution.iterations, "seconds": solution.seconds}
    return {"value": value, "status": solution.status.value} | counts


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
