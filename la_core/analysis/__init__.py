"""The limit-analysis stage: bounds, prediction, reach and accuracy of one scene, from its text to `case.h5`."""

from la_core.analysis import accuracy, answer_table, case_file, reach
from la_core.analysis.accuracy import HISTORY, INSET_SHARE, has_history, scale, shared_parts, with_accuracy
from la_core.analysis.accuracy_record import Attempt
from la_core.analysis.answer import Answer, solve
from la_core.analysis.answer_values import associated_values, coulomb_values, path_values
from la_core.analysis.case_file import write_case
from la_core.analysis.prediction import wedging
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse, code_digest, digest, drives, model, settled, smallest_inset

__all__ = [
    "HISTORY",
    "INSET_SHARE",
    "Answer",
    "Attempt",
    "LimitAnalysis",
    "accuracy",
    "analyse",
    "answer_table",
    "associated_values",
    "case_file",
    "code_digest",
    "coulomb_values",
    "digest",
    "drives",
    "has_history",
    "model",
    "path_values",
    "reach",
    "scale",
    "settled",
    "shared_parts",
    "smallest_inset",
    "solve",
    "wedging",
    "with_accuracy",
    "write_case",
]
