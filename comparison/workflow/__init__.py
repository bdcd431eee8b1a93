"""One scene through both methods, stage by stage. A stage with unchanged inputs is not run again. Scenes run in parallel."""

from comparison.limit_analysis import Listener
from comparison.workflow.harder import refuse_names_of_attempts, try_harder
from comparison.workflow.one_scene import report_again, run_scene, would_run_slower
from comparison.workflow.stages import COMPARISON_CODE, REPEATED, YADE_CODE
from comparison.workflow.worker_processes import ATTEMPTS, StoppedError, WorkerProcesses

__all__ = [
    "ATTEMPTS",
    "COMPARISON_CODE",
    "REPEATED",
    "YADE_CODE",
    "Listener",
    "StoppedError",
    "WorkerProcesses",
    "refuse_names_of_attempts",
    "report_again",
    "run_scene",
    "try_harder",
    "would_run_slower",
]
