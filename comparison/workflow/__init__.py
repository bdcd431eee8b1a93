"""One scene through both methods, stage by stage; a stage whose inputs did not change is not run again."""

from comparison.limit_analysis import Listener
from comparison.workflow.harder import try_harder
from comparison.workflow.one_scene import report_again, run_scene
from comparison.workflow.stages import COMPARISON_CODE, REPEATED, YADE_CODE

__all__ = [
    "COMPARISON_CODE",
    "REPEATED",
    "YADE_CODE",
    "Listener",
    "report_again",
    "run_scene",
    "try_harder",
]
