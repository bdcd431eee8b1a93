"""Changes of a method's mechanism along a parameter, with the slope of the reaction on both sides."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from comparison.campaign.row_groups import Line, SweepRows, is_number, lines
from comparison.campaign.row_values import LIMIT, Row, mechanism_name, over_weight, prediction
from comparison.verdict import ANSWERS


@dataclass(frozen=True)
class MechanismChange:
    """A change of mechanism between two neighbouring values of a parameter, all other parameters fixed.

    Attributes
    ----------
    scene, held, parameter, method : str
        Scene, the fixed parameters in words, the changing parameter, and the method.
    low, high : object
        The two values of the parameter.
    cases : tuple of str
        Names of the two cases.
    before, after : str
        Labels of the two mechanisms.
    slope_before, slope_after : float or None
        Slope of reaction over weight (or of the multiplier) against the parameter, between two neighbours with the same mechanism on
        that side; None without such a pair.
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


def mechanism_changes_along(sweeps: list[SweepRows]) -> Iterator[MechanismChange]:
    """Yield every change of mechanism along every parameter, for both methods."""
    for sweep in sweeps:
        for parameter in sweep.parameters:
            for line in lines(sweep, parameter):
                for method in (LIMIT, "yade"):
                    yield from _along(sweep, parameter, line, method)


def letters(sweeps: list[SweepRows]) -> dict[str, dict[str, str]]:
    """Return a letter for each mechanism's label, by scene, in order of appearance."""
    named: dict[str, dict[str, str]] = {}
    for sweep in sweeps:
        of_scene = named.setdefault(sweep.scene, {})
        for row in sweep.rows:
            for name in (mechanism_name(row, method) for method in ANSWERS):
                if name is not None:
                    of_scene.setdefault(name, letter(len(of_scene)))
    return named


def letter(k: int) -> str:
    """Return the k-th name (from 0) of the sequence A, B, ..., Z, AA, AB, ..."""
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
    """Return the slope of the reaction between two neighbours; None for different mechanisms or missing values."""
    places = [row[parameter] for row, _ in (first, second)]
    values = [over_weight(row, prediction(row) if method == LIMIT else method) for row, _ in (first, second)]
    if first[1] != second[1] or not all(map(is_number, places)) or values[0] is None or values[1] is None:
        return None
    return (values[1] - values[0]) / (places[1] - places[0])


def change_view(change: MechanismChange, lettered: Mapping[str, Mapping[str, str]]) -> dict[str, Any]:
    """Return a change in the form of the report's JSON; lettered: letters of mechanisms by scene and label."""
    letter_of = lettered[change.scene]
    return vars(change) | {"cases": list(change.cases), "before": letter_of[change.before], "after": letter_of[change.after]}
