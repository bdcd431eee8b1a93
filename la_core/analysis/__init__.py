"""The limit-analysis stage: bounds, prediction, reduced region and accuracy of one scene, from its text to `case.h5`."""

from la_core.analysis import case_file, reach
from la_core.analysis.accuracy import HISTORY, INSET_SHARE, has_history, lacks_sharp_prediction, scale, shared_parts, with_accuracy
from la_core.analysis.answer import Answer, answer_headings, answer_rows, solve
from la_core.analysis.case_file import write_case
from la_core.analysis.decisions import DecidedModel, decided_model
from la_core.analysis.modelling import StructuralModel, drives, has_given_stiffness, smallest_inset, structural_model, wedging
from la_core.analysis.result import Attempt, LimitAnalysis, answer_values, associated_values, coulomb_values
from la_core.analysis.settings import AnalysisListener, AnalysisSettings, Silent
from la_core.analysis.stage import analyse

__all__ = [
    "HISTORY",
    "INSET_SHARE",
    "AnalysisListener",
    "AnalysisSettings",
    "Answer",
    "Attempt",
    "DecidedModel",
    "LimitAnalysis",
    "Silent",
    "StructuralModel",
    "analyse",
    "answer_headings",
    "answer_rows",
    "answer_values",
    "associated_values",
    "case_file",
    "coulomb_values",
    "decided_model",
    "drives",
    "has_given_stiffness",
    "has_history",
    "lacks_sharp_prediction",
    "reach",
    "scale",
    "shared_parts",
    "smallest_inset",
    "solve",
    "structural_model",
    "wedging",
    "with_accuracy",
    "write_case",
]
