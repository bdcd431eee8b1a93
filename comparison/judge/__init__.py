"""The judge: every check with its tolerance, the verdict, and the summary that is `comparison.json`."""

from comparison.judge import requested_accuracy
from comparison.judge.checks.answer import check_answer, check_expected
from comparison.judge.checks.curves import compare_curves
from comparison.judge.checks.next_steps import INTERRUPTED_RUN, for_a_failed_run, refuses_setting
from comparison.judge.checks.prediction import slides_unforeseen
from comparison.judge.checks.reduced_model import check_displacement, check_plane, check_reach
from comparison.judge.checks.run_checks import check_run
from comparison.judge.checks.tolerances import FLOOR, LEAST_REACTION, UNCERTAIN
from comparison.judge.effects_table import effects_summary
from comparison.judge.first_prediction import answer_of, answer_of_text
from comparison.judge.greatest_load import greatest_load_summary
from comparison.judge.requested_accuracy import METHODS, check_accuracy
from comparison.judge.summary import (
    comparison_summary,
    conclusion_of,
    limit_analysis_summary,
    limit_analysis_values,
    without_run,
    without_undefined,
    yade_summary,
)

__all__ = [
    "FLOOR",
    "INTERRUPTED_RUN",
    "LEAST_REACTION",
    "METHODS",
    "UNCERTAIN",
    "answer_of",
    "answer_of_text",
    "check_accuracy",
    "check_answer",
    "check_displacement",
    "check_expected",
    "check_plane",
    "check_reach",
    "check_run",
    "compare_curves",
    "comparison_summary",
    "conclusion_of",
    "effects_summary",
    "for_a_failed_run",
    "greatest_load_summary",
    "limit_analysis_summary",
    "limit_analysis_values",
    "refuses_setting",
    "requested_accuracy",
    "slides_unforeseen",
    "without_run",
    "without_undefined",
    "yade_summary",
]
