"""The row of the table of `crosscheck run`: bounds, prediction and YADE's reaction over the weight, and the time of each method."""

import math
from typing import Any

from la_core.text_table import number_text, over_weight

VERDICT_HEADINGS = ("scene", "least", "Coulomb", "greatest", "YADE", "verdict", "LA s", "YADE s")
VERDICT_TITLE = "reaction over the weight W of the free blocks: limit analysis' bounds and prediction, YADE's plateau"
SYMBOLS = {"agree": "✓ agree", "disagree": "✗ disagree", "inconclusive": "? inconclusive", None: "–"}


def verdict_cells(comparison: dict[str, Any]) -> list[str]:
    """Return the cells of a row of the verdict table, without the verdict itself. comparison: the content of `comparison.json`."""
    answer, yade, weight = comparison["limit_analysis"]["associated"], comparison["yade"] or {}, comparison["weight"]
    coulomb = comparison["limit_analysis"]["coulomb"] or {}
    if "multiplier" in answer:
        values = [number_text(answer["multiplier"], 5), number_text(coulomb.get("multiplier"), 5), "–", "–"]
    else:
        shared, predicted = answer.get("shared_inset", answer), coulomb.get("shared_inset", coulomb).get("reaction")
        values = [_over(value, weight) for value in (shared["reaction"], predicted, shared["reaction_max"])]
        values.append(with_uncertainty(over_weight(yade.get("reaction"), weight), over_weight(yade.get("uncertainty"), weight)))
    if answer["status"] != "solved":
        values[0] = answer["status"]
    elif coulomb and coulomb["status"] != "solved":
        values[1] = f"{values[1]} {coulomb['status']}"
    if yade and yade["status"] != "plateau":
        values[3] = yade["status"]
    seconds = [number_text(answer["seconds"] + coulomb.get("seconds", 0.0), 2), number_text(yade.get("seconds"), 2)]
    return [comparison["scene"], *values, *seconds]


def _over(value: float | None, weight: float) -> str:
    return number_text(over_weight(value, weight), 5)


def with_uncertainty(value: float | None, uncertainty: float | None) -> str:
    """Return a value and its uncertainty as text, rounded to the first digit of the uncertainty."""
    if value is None or uncertainty is None:
        return number_text(value, 5)
    digits = 6 if uncertainty <= 0.0 else min(6, max(0, -math.floor(math.log10(uncertainty))))
    return f"{value:.{digits}f} ± {uncertainty:.{digits}f}"
