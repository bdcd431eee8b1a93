"""The presentation of a verdict: checks, marks, the conclusion with its next step, its row among the results, and terminal tables."""

from comparison.verdict.check import Check, Verdict, finite_or_none, inside, overall, stored_check, within, without_contradiction
from comparison.verdict.check_table import Checks
from comparison.verdict.conclusion import BEARS_NOTHING, CARRIED_OUT, HARDER, UNCONFIRMED, Conclusion, conclusion, named_blocks
from comparison.verdict.terminal_table import new_table, plain
from comparison.verdict.verdict_table import ANSWERS, VERDICT_HEADINGS, VERDICTS, check_words, mark_of, verdict_cells, verdict_title

__all__ = [
    "ANSWERS",
    "BEARS_NOTHING",
    "CARRIED_OUT",
    "HARDER",
    "UNCONFIRMED",
    "VERDICTS",
    "VERDICT_HEADINGS",
    "Check",
    "Checks",
    "Conclusion",
    "Verdict",
    "check_words",
    "conclusion",
    "finite_or_none",
    "inside",
    "mark_of",
    "named_blocks",
    "new_table",
    "overall",
    "plain",
    "stored_check",
    "verdict_cells",
    "verdict_title",
    "within",
    "without_contradiction",
]
