"""Where along a parameter a method's mechanism changes, and how steep its reaction is on both sides."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from comparison.campaign.row_groups import Line, SweepRows, is_number, lines
from comparison.campaign.row_values import LIMIT, METHODS, Row, mechanism_name, over_weight, prediction


@dataclass(frozen=True)
class MechanismChange:
    """A method's mechanism between two neighbouring values of a parameter, all others held.

    cases: names of the two. slopes: of the reaction over weight (or multiplier) against the parameter, where two neighbours share a
    mechanism; None elsewhere.
    """

    scene: str
    held: str
    parameter: str
    low: Any
    high: Any
    cases: tuple[str, str]
    method: str
    before: str
    after: str
    slope_before: float | None
    slope_after: float | None


def mechanism_changes_along(found: list[SweepRows]) -> Iterator[MechanismChange]:
    """Every change of mechanism along every parameter, by both methods."""
    for sweep in found:
        for parameter in sweep.parameters:
            for line in lines(sweep, parameter):
                for method in (LIMIT, "yade"):
                    yield from _along(sweep, parameter, line, method)


def letters(found: list[SweepRows]) -> dict[str, dict[str, str]]:
    """Letters of every scene's mechanisms by their labels, in order of appearance: equal labels are equal letters."""
    named: dict[str, dict[str, str]] = {}
    for sweep in found:
        own = named.setdefault(sweep.scene, {})
        for row in sweep.rows:
            for name in (mechanism_name(row, method) for method in METHODS):
                if name is not None:
                    own.setdefault(name, letter(len(own)))
    return named


def letter(k: int) -> str:
    """A, B, ..., Z, AA, AB, ..."""
    return ("" if k < 26 else letter(k // 26 - 1)) + chr(ord("A") + k % 26)


def _along(sweep: SweepRows, parameter: str, line: Line, method: str) -> Iterator[MechanismChange]:
    known = [(row, name) for row in line.rows if (name := mechanism_name(row, method)) is not None]
    slopes = [_slope(first, second, parameter, method) for first, second in pairwise(known)]
    for k, ((first, before), (second, after)) in enumerate(pairwise(known)):
        if before != after:
            sides = (slopes[k - 1] if k else None, slopes[k + 1] if k + 1 < len(slopes) else None)
            cases = (str(first.get("case")), str(second.get("case")))
            yield MechanismChange(
                sweep.scene, line.words, parameter, first[parameter], second[parameter], cases, method, before, after, *sides
            )


def _slope(first: tuple[Row, str], second: tuple[Row, str], parameter: str, method: str) -> float | None:
    """Difference quotient of the reaction between two neighbours of one mechanism."""
    places = [row[parameter] for row, _ in (first, second)]
    values = [over_weight(row, prediction(row) if method == LIMIT else method) for row, _ in (first, second)]
    if first[1] != second[1] or not all(map(is_number, places)) or values[0] is None or values[1] is None:
        return None
    return (values[1] - values[0]) / (places[1] - places[0])


def change_view(change: MechanismChange, lettered: Mapping[str, Mapping[str, str]]) -> dict[str, Any]:
    """A change as the report's JSON holds it."""
    own = lettered[change.scene]
    return vars(change) | {"cases": list(change.cases), "before": own[change.before], "after": own[change.after]}
