"""The limit-analysis stage: bounds, prediction, reach and accuracy of one scene, from its text to `case.h5`."""

from la_core.analysis import accuracy, case_file, reach
from la_core.analysis.accuracy import HISTORY, INSET_SHARE, has_history, scale, shared_parts, with_accuracy
from la_core.analysis.accuracy_record import Attempt
from la_core.analysis.answer import Answer, associated_values, coulomb_values, path_values, solve
from la_core.analysis.case_file import write_case
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.analysis.structural_model import drives, smallest_inset, wedging

__all__ = [
    "HISTORY",
    "INSET_SHARE",
    "Answer",
    "Attempt",
    "LimitAnalysis",
    "accuracy",
    "analyse",
    "associated_values",
    "case_file",
    "coulomb_values",
    "drives",
    "has_history",
    "path_values",
    "reach",
    "scale",
    "shared_parts",
    "smallest_inset",
    "solve",
    "wedging",
    "with_accuracy",
    "write_case",
]
