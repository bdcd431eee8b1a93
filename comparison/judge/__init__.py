"""The judge: every check with its tolerance, the verdict, and the summary that is `comparison.json`."""

from comparison.judge import requested_accuracy
from comparison.judge.check import Check, Verdict, overall
from comparison.judge.effects_table import effects_summary
from comparison.judge.prediction import INTERVAL_CHECK, REACTION_CHECK, check_prediction, slides_unforeseen
from comparison.judge.reduced_model import check_displacement, check_plane, check_reach
from comparison.judge.requested_accuracy import METHODS, check_accuracy, percent
from comparison.judge.run_checks import check_expected, check_run
from comparison.judge.summary import comparison_summary, limit_analysis_summary, without_run, without_undefined, yade_summary
from comparison.judge.tolerances import HISTORY, LEAST_REACTION
from comparison.judge.verdict_table import SYMBOLS, VERDICT_HEADINGS, VERDICT_TITLE, verdict_cells

__all__ = [
    "HISTORY",
    "INTERVAL_CHECK",
    "LEAST_REACTION",
    "METHODS",
    "REACTION_CHECK",
    "SYMBOLS",
    "VERDICT_HEADINGS",
    "VERDICT_TITLE",
    "Check",
    "Verdict",
    "check_accuracy",
    "check_displacement",
    "check_expected",
    "check_plane",
    "check_prediction",
    "check_reach",
    "check_run",
    "comparison_summary",
    "effects_summary",
    "limit_analysis_summary",
    "overall",
    "percent",
    "requested_accuracy",
    "slides_unforeseen",
    "verdict_cells",
    "without_run",
    "without_undefined",
    "yade_summary",
]
