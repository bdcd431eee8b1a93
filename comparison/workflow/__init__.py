"""One scene through both methods, stage by stage; a stage whose inputs did not change is not run again."""

from comparison.workflow.one_scene import REPEATED, Listener, report_again, run_scene

__all__ = [
    "REPEATED",
    "Listener",
    "report_again",
    "run_scene",
]
