"""The words of a verdict: checks, verdicts with their marks, and the row of a scene in the table of results."""

from comparison.verdict.check import Check, Verdict, finite_or_none, inside, overall, within
from comparison.verdict.verdict_table import SYMBOLS, VERDICT_HEADINGS, VERDICT_TITLE, verdict_cells

__all__ = [
    "SYMBOLS",
    "VERDICT_HEADINGS",
    "VERDICT_TITLE",
    "Check",
    "Verdict",
    "finite_or_none",
    "inside",
    "overall",
    "verdict_cells",
    "within",
]
