"""YADE as a process: find it, run it, read its record, and choose its settings for a requested accuracy."""

from comparison.yade import accuracy_settings
from comparison.yade.accuracy_settings import HISTORY_OF_SPEED, attempt_of
from comparison.yade.installation import HOW_TO_GET_YADE, ROOT, Installation, Yade, find_yade, locate_yade
from comparison.yade.process import run_yade
from comparison.yade.run_record import Run, read_run
from comparison.yade.stored import Results, among_results, locate_results, read_results, results_beside

__all__ = [
    "HISTORY_OF_SPEED",
    "HOW_TO_GET_YADE",
    "ROOT",
    "Installation",
    "Results",
    "Run",
    "Yade",
    "accuracy_settings",
    "among_results",
    "attempt_of",
    "find_yade",
    "locate_results",
    "locate_yade",
    "read_results",
    "read_run",
    "results_beside",
    "run_yade",
]
