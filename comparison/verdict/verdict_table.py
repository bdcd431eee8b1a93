"""The row of the table of `crosscheck run`: bounds, prediction and YADE's reaction over the weight, and the time of each method.

A live load has its multiplier there. Its associated answer is an upper bound, and it has no other.
"""

from collections.abc import Sequence
from typing import Any

from comparison.numbers import DASH, several_plateaus, with_uncertainty
from la_core.text_table import number_text, over_weight

VERDICT_HEADINGS = ("scene", "least", "Coulomb", "greatest", "YADE", "verdict", "LA s", "YADE s")
VERDICT_TITLE = "reaction over the weight W of the free blocks: limit analysis' bounds and prediction, YADE's plateau"
MULTIPLIER_TITLE = "multiplier of the live load: limit analysis' upper bound and prediction, YADE's plateau"
BOTH_TITLE = f"{VERDICT_TITLE}; of a live load its multiplier, bounded from above"
VERDICTS = {  # sign and words of a comparison's verdict
    "agree": ("✓", "agree"),
    "disagree": ("✗", "disagree"),
    "inconclusive": ("?", "inconclusive"),
    "expected value met": ("○", "expected value met (YADE not run)"),
    "cannot stand": ("↓", "cannot stand"),
    None: (DASH, "not compared"),
}


def mark_of(verdict: str | None) -> str:
    """Return the sign and the words of a comparison's verdict."""
    return " ".join(VERDICTS.get(verdict, VERDICTS[None]))


def check_words(verdict: str | None) -> tuple[str, str]:
    """Return the sign and the words of a check's verdict; an expected value is met, whoever runs beside."""
    return ("✓", "met") if verdict == "expected value met" else VERDICTS.get(verdict, VERDICTS[None])


def verdict_title(comparisons: Sequence[dict[str, Any]]) -> str:
    """Return the title of the table: the scenes have reactions, multipliers, or both."""
    kinds = {"multiplier" in comparison["limit_analysis"]["associated"] for comparison in comparisons}
    return BOTH_TITLE if len(kinds) > 1 else MULTIPLIER_TITLE if kinds == {True} else VERDICT_TITLE


def verdict_cells(comparison: dict[str, Any]) -> list[str]:
    """Return the cells of a row of the verdict table, without the verdict itself. comparison: the content of `comparison.json`."""
    answer, yade, weight = comparison["limit_analysis"]["associated"], comparison["yade"] or {}, comparison["weight"]
    coulomb = comparison["limit_analysis"]["coulomb"] or {}
    shared, predicted = answer.get("shared_inset", answer), coulomb.get("shared_inset", coulomb)
    name, divisor = ("multiplier", 1.0) if "multiplier" in answer else ("reaction", weight)

    def uncertain(values: dict[str, Any], key: str) -> str:
        return with_uncertainty(over_weight(values.get(key), divisor), over_weight(values.get("uncertainty"), divisor))

    bounds = ("reaction", "reaction_max") if name == "reaction" else ("", "multiplier")
    least, greatest = (number_text(over_weight(shared.get(key), divisor), 5) for key in bounds)
    values = [least, uncertain(predicted, name), greatest, uncertain(yade, "reaction")]
    if answer["status"] != "solved":
        values[0] = answer["status"]
    elif coulomb and coulomb["status"] != "solved":
        values[1] = f"{values[1]} {coulomb['status']}"
    if several := several_plateaus([over_weight(value, divisor) for value in predicted.get("plateaus") or ()], ""):
        values[1] = f"{values[1]}; {several}"
    if yade and yade["status"] != "plateau":
        values[3] = yade["status"]
    seconds = [number_text(answer["seconds"] + coulomb.get("seconds", 0.0), 2), number_text(yade.get("seconds"), 2)]
    return [comparison["scene"], *values, *seconds]
