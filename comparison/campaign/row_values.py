"""Values derived from a campaign's row: reaction over weight, prediction, deviation of YADE, address of the report."""

import math
from collections import Counter
from collections.abc import Iterable
from pathlib import Path, PurePosixPath
from typing import Any
from urllib.parse import quote

from comparison.campaign.table import CampaignTable
from comparison.judge import FLOOR, LEAST_REACTION
from comparison.numbers import format_number
from comparison.verdict import ANSWERS, VERDICTS, verdict_title
from la_core import text_table
from la_core.limit import Status
from la_core.text_table import exists

Row = dict[str, Any]
FAILED = "failed"
LIMIT = "limit"  # prediction of limit analysis: the Coulomb prediction if the case has it, else the associated answer
WORDS = ANSWERS | {LIMIT: "limit analysis"}


def sweep_of(row: Row) -> str:
    """Return the name of a row's sweep; the cases of a sweep are drawn and listed together."""
    return str(row.get("sweep") or row.get("scene"))


def units_of(rows: Iterable[Row]) -> list[str]:
    """Return the distinct units of the rows' values in order of the rows; a failed case has none."""
    return list(dict.fromkeys(row["unit"] for row in rows if row.get("unit") is not None))


def over_weight(row: Row, name: str) -> float | None:
    """Return a reaction of the row over the weight of the free blocks, or the multiplier; 0 for round-off, None where undefined.

    name: column of the reaction. The ratio of a moment has the unit m.
    """
    value, weight = row.get(name), row.get("weight")
    if not exists(value):
        return None
    if not row.get("unit"):
        return text_table.without_round_off(value, 1.0)
    return text_table.over_weight(value, weight) if exists(weight) and weight > 0.0 else None


def bounds(row: Row) -> tuple[float, float]:
    """Return least and greatest reaction of associated limit analysis over the weight, or bounds of the multiplier.

    A value is infinite without a bound, and both are NaN without an answer.
    """
    least, greatest = over_weight(row, "least"), over_weight(row, "greatest")
    is_live, is_unlimited = not row.get("unit"), row.get("associated_status") == Status.UNBOUNDED.value
    if is_unlimited:
        least = math.inf if is_live else -math.inf
    if least is None:
        return math.nan, math.nan
    if is_live:
        return -math.inf, least  # the associated multiplier is an upper bound for friction without dilatancy
    return least, math.inf if greatest is None else greatest


def interval(row: Row) -> tuple[float, float]:
    """Return least and greatest value that the prediction's mechanism allows, over the weight; infinite without a limit, NaN if unknown."""
    low, high = over_weight(row, "coulomb_low"), over_weight(row, "coulomb_high")
    if low is None and high is None:
        return math.nan, math.nan
    return -math.inf if low is None else low, math.inf if high is None else high


def value_cells(row: Row) -> list[str]:
    """Return least, Coulomb, greatest and YADE's value of the row as texts, over the weight; a multiplier has its bound as the greatest."""
    least, greatest = bounds(row)
    return [format_number(value, 5) for value in (least, over_weight(row, "coulomb"), greatest, over_weight(row, "yade"))]


def title_of_values(rows: Iterable[Row]) -> str:
    """Return the title of a table of `value_cells`; failed cases have no values."""
    return verdict_title({str(row.get("unit") or "") for row in rows if not failed(row)})


def prediction(row: Row) -> str:
    """Return the column of the prediction: Coulomb's if it exists, else the associated least."""
    return "coulomb" if exists(row.get("coulomb")) else "least"


def compared_with(row: Row) -> str:
    """Return the column that YADE's reaction is compared with: the prediction.

    Where the methods agree on the value after turning blocks have released a thrust, it is the column of that value.
    """
    first = prediction(row)
    released = _deviation(row, "coulomb_released")
    is_released = row.get("verdict") == "agree" and released is not None and released <= 1.0 < (_deviation(row, first) or 0.0)
    return "coulomb_released" if is_released else first


def difference(row: Row) -> float | None:
    """Return YADE's reaction minus the value that it is compared with (N or N m); None if one of them is undefined."""
    return _difference(row, compared_with(row))


def _difference(row: Row, column: str) -> float | None:
    predicted, reaction = row.get(column), row.get("yade")
    return reaction - predicted if exists(predicted) and exists(reaction) else None


def uncertainty_of(column: str) -> str:
    """Return the column with the uncertainty that a prediction states; the associated answer, which states none, has no such column."""
    return f"{column}_uncertainty"


def least_tolerance(row: Row) -> float:
    """Return the difference that is always allowed, N or N m, of a multiplier without unit.

    Tables of earlier versions do not have this column. The result is then 1e-4 of the weight, without the lever arm of a moment.
    """
    known = row.get("least_tolerance")
    if exists(known):
        return float(known)
    return LEAST_REACTION * (float(row.get("weight") or 0.0) if row.get("unit") else 1.0)  # a multiplier is over the weight already


def deviation(row: Row) -> float | None:
    """Return the size of the difference over its tolerance; None where undefined.

    Tolerance: 0.5 % of YADE's reaction, at least `least_tolerance`, plus the uncertainties that both methods state.
    """
    return _deviation(row, compared_with(row))


def _deviation(row: Row, column: str) -> float | None:
    apart, weight = _difference(row, column), row.get("weight")
    if apart is None or not exists(weight):
        return None
    stated = [row.get("yade_uncertainty"), row.get(uncertainty_of(column))]
    allowed = max(FLOOR * abs(row["yade"]), least_tolerance(row)) + sum(value for value in stated if exists(value))
    return abs(apart) / allowed if allowed > 0.0 else None


def worst_first(rows: list[Row]) -> list[Row]:
    """Return rows by falling deviation; rows without one come last, by severity of the verdict; equal rows keep their order."""
    severity = {"disagree": 0, "unexpected": 0, "cannot stand": 1, "inconclusive": 1}

    def key(row: Row) -> tuple[bool, float, int]:
        apart = deviation(row)
        return apart is None, -(apart or 0.0), severity.get(str(row.get("verdict")), 2)

    return sorted(rows, key=key)


def failed(row: Row) -> bool:
    """Return whether the case failed."""
    return row.get("state") == FAILED


def verdict_counts(rows: Iterable[Row]) -> str:
    """Return the numbers of cases with each verdict, and of failed cases, as words; "" without cases."""
    counts = Counter(FAILED if failed(row) else VERDICTS[row["verdict"] or None][1] for row in rows)
    return ", ".join(f"{count} {word}" for word, count in counts.items())


def own_folder(folder: Path, row: Row) -> Path | None:
    """Return the case's folder; None unless it exists inside the campaign's folder."""
    inside = PurePosixPath(str(row.get("folder") or ""))
    own = folder / inside
    return own if inside.parts and not inside.is_absolute() and ".." not in inside.parts and own.is_dir() else None


def link(folder: Path, row: Row) -> str:
    """Return the relative address of the case's report; "" unless it exists inside the campaign's folder."""
    own = own_folder(folder, row)
    return quote(f"{PurePosixPath(row['folder'])}/report.html") if own is not None and (own / "report.html").is_file() else ""


def runs_of(table: CampaignTable) -> dict[str, str]:
    """Return the folder of each case's run, by case; cases that differ only in the classic iteration share a run."""
    return {str(row["case"]): str(row.get("folder") or row["case"]) for row in table.rows}


def costs_once(table: CampaignTable) -> list[Row]:
    """Return the costs of one case per run, the first."""
    runs = runs_of(table)
    first: dict[str, Row] = {}
    for cost in table.costs:
        first.setdefault(runs.get(str(cost["case"]), str(cost["case"])), cost)
    return list(first.values())


def of_mechanism(row: Row, method: str, quantity: str) -> Any:
    """Return a measure of a method's mechanism; None where unknown.

    method: key of WORDS. quantity: ending of the column, such as 'participation'.
    """
    name = ("associated" if prediction(row) == "least" else "coulomb") if method == LIMIT else method
    return row.get(f"{name}_{quantity}")


def mechanism_name(row: Row, method: str) -> str | None:
    """Return the label of the method's mechanism; None where unknown."""
    name = of_mechanism(row, method, "mechanism")
    return None if name is None or name == "" else str(name)


def falls(row: Row, method: str) -> bool:
    """Return whether, by this method, the structure cannot stand under its own weight; it then has no labelled mechanism."""
    return row.get("yade_status") == "collapsed" if method == "yade" else row.get("associated_status") == "infeasible"
