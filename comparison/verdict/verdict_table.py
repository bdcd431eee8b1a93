"""A row of the table of `crosscheck run`: bounds, prediction and YADE's reaction over the weight, and the time of each method.

The row of a rotating support has its moment over the weight, in m. The row of a live load has its multiplier, with the associated answer as
upper bound and no lower bound.
"""

from collections.abc import Collection
from typing import Any

from comparison.numbers import DASH, format_number, several_plateaus, with_uncertainty
from la_core.text_table import number_text, over_weight

VERDICT_HEADINGS = ("scene", "least", "Coulomb", "greatest", "YADE", "verdict", "LA s", "YADE s")
BY_BOTH = "limit analysis' bounds and prediction, YADE's plateau"
TITLES = {  # titles of the table, by the unit of the values
    "N": f"reaction over the weight W of the free blocks and their loads: {BY_BOTH}",
    "N m": f"moment on the turning support over the weight W of the free blocks and their loads, in m: {BY_BOTH}",
    "": "multiplier of the live load: limit analysis' upper bound and prediction, YADE's plateau",
}
BESIDE = {"N m": "; of a turning support its moment over W, in m", "": "; of a live load its multiplier, bounded from above"}
ANSWERS = {"associated": "limit analysis, associated", "coulomb": "limit analysis, Coulomb", "yade": "YADE"}  # words for each answer
VERDICTS = {  # sign and words for the verdict of a comparison
    "agree": ("✓", "agree"),
    "disagree": ("✗", "disagree"),
    "inconclusive": ("?", "inconclusive"),
    "expected": ("○", "expected value met (YADE not run)"),
    "unexpected": ("⊗", "expected value not met (no result of YADE)"),
    "cannot stand": ("↓", "cannot stand"),
    None: (DASH, "not compared"),
}


def mark_of(verdict: str | None) -> str:
    """Return the sign and the words of a comparison's verdict."""
    return " ".join(VERDICTS.get(verdict, VERDICTS[None]))


def check_words(verdict: str | None) -> tuple[str, str]:
    """Return the sign and the words of a check's verdict; for an expected value "met" or "not met", without or with a run of YADE."""
    return {"expected": ("✓", "met"), "unexpected": ("✗", "not met")}.get(str(verdict)) or VERDICTS.get(verdict, VERDICTS[None])


def verdict_title(units: Collection[str]) -> str:
    """Return the title of a table with values in these units: reactions, moments, multipliers, or several of them."""
    first, *others = [unit for unit in TITLES if unit in units] or ["N"]
    return TITLES[first] + "".join(BESIDE[unit] for unit in others)


def verdict_cells(comparison: dict[str, Any]) -> list[str]:
    """Return the cells of a row of the verdict table, as VERDICT_HEADINGS has them. comparison: the content of `comparison.json`."""
    answer, yade, weight = comparison["limit_analysis"]["associated"], comparison["yade"] or {}, comparison["weight"]
    coulomb = comparison["limit_analysis"]["coulomb"] or {}
    shared, predicted = answer.get("shared_inset", answer), coulomb.get("shared_inset", coulomb)
    name, divisor = ("multiplier", 1.0) if "multiplier" in answer else ("reaction", weight)

    def uncertain(values: dict[str, Any], key: str) -> str:
        return with_uncertainty(over_weight(values.get(key), divisor), over_weight(values.get("uncertainty"), divisor))

    bounds = ("reaction", "reaction_max") if name == "reaction" else ("", "multiplier")
    least, greatest = (format_number(over_weight(shared.get(key), divisor), 5) for key in bounds)
    values = [least, uncertain(predicted, name), greatest, uncertain(yade, "reaction")]
    if answer["status"] != "solved":
        values[0 if name == "reaction" else 2] = answer["status"]
    elif coulomb and coulomb["status"] != "solved":
        values[1] = f"{values[1]} {coulomb['status']}"
    if several := several_plateaus([over_weight(value, divisor) for value in predicted.get("plateaus") or ()], ""):
        values[1] = f"{values[1]}; {several}"
    if yade and yade["status"] != "plateau":
        values[3] = yade["status"]
    seconds = [number_text(answer["seconds"] + coulomb.get("seconds", 0.0), 2), number_text(yade.get("seconds"), 2)]
    return [comparison["scene"], *values, mark_of(comparison["verdict"]), *seconds]
