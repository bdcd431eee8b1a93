"""What a campaign's row says beyond its numbers: reaction over weight, prediction, how far YADE is from it, where its page lies."""

import math
from pathlib import Path, PurePosixPath
from typing import Any
from urllib.parse import quote

from comparison.campaign.table import CampaignTable
from comparison.judge import HISTORY, LEAST_REACTION
from comparison.numbers import exists

Row = dict[str, Any]
FAILED = "failed"
METHODS = {"associated": "limit analysis, associated", "coulomb": "limit analysis, Coulomb", "yade": "YADE"}
LIMIT = "limit"  # what limit analysis predicts: by Coulomb's law where the case asks for it, else by the associated one
WORDS = METHODS | {LIMIT: "limit analysis"}


def sweep_of(row: Row) -> str:
    """Name of the sweep that a row is of: what is drawn and tabled together."""
    return str(row.get("sweep") or row.get("scene"))


def over_weight(row: Row, name: str) -> float | None:
    """A reaction of the row over the weight of its free blocks; a multiplier as it is; None where either does not exist."""
    value, weight = row.get(name), row.get("weight")
    if not exists(value):
        return None
    if not row.get("unit"):
        return value
    return value / weight if exists(weight) and weight > 0.0 else None


def bounds(row: Row) -> tuple[float, float]:
    """What associated limit analysis allows, over the weight: least and greatest reaction, or what a multiplier is at most.

    Infinite where there is no bound, NaN where nothing is known.
    """
    least, greatest = over_weight(row, "least"), over_weight(row, "greatest")
    if least is None:
        return math.nan, math.nan
    if not row.get("unit"):
        return -math.inf, least  # the associated multiplier is not below that of friction without dilatancy
    return least, math.inf if greatest is None else greatest


def prediction(row: Row) -> str:
    """Name of the reaction that YADE is held against: Coulomb's where there is one, else the associated least."""
    return "coulomb" if exists(row.get("coulomb")) else "least"


def difference(row: Row) -> float | None:
    """YADE's reaction less the prediction, N or N m; None where one does not exist."""
    predicted, found = row.get(prediction(row)), row.get("yade")
    return found - predicted if exists(predicted) and exists(found) else None


def deviation(row: Row) -> float | None:
    """|YADE - prediction| over what sliding joints are allowed: 1 % of the reaction or 1e-4 of the weight, and YADE's uncertainty."""
    apart, uncertainty, weight = difference(row), row.get("yade_uncertainty"), row.get("weight")
    if apart is None or not exists(weight):
        return None
    allowed = max(HISTORY * abs(row["yade"]), LEAST_REACTION * weight) + (uncertainty if exists(uncertainty) else 0.0)
    return abs(apart) / allowed if allowed > 0.0 else None


def worst_first(rows: list[Row]) -> list[Row]:
    """Rows by falling deviation; those without one at the end, disagreeing ones first; by name where they are equal."""
    gravity = {"disagree": 0, "inconclusive": 1}

    def key(row: Row) -> tuple[bool, float, int, str]:
        apart = deviation(row)
        return apart is None, -(apart or 0.0), gravity.get(str(row.get("verdict")), 2), str(row.get("case"))

    return sorted(rows, key=key)


def failed(row: Row) -> bool:
    """Whether the case came to no result."""
    return row.get("state") == FAILED


def own_folder(folder: Path, row: Row) -> Path | None:
    """The case's own folder; None where there is none inside the campaign's."""
    inside = PurePosixPath(str(row.get("folder") or ""))
    own = folder / inside
    return own if inside.parts and not inside.is_absolute() and ".." not in inside.parts and own.is_dir() else None


def link(folder: Path, row: Row) -> str:
    """Relative address of the case's own report; "" where there is none inside the campaign's folder."""
    own = own_folder(folder, row)
    return quote(f"{PurePosixPath(row['folder'])}/report.html") if own is not None and (own / "report.html").is_file() else ""


def runs_of(table: CampaignTable) -> dict[str, str]:
    """Which run each case is of, by their names: the methods ran once for all cases of one run."""
    return {str(row["case"]): str(row.get("folder") or row["case"]) for row in table.rows}


def costs_once(table: CampaignTable) -> list[Row]:
    """Costs without those of cases that share a run with an earlier one."""
    runs = runs_of(table)
    first: dict[str, Row] = {}
    for cost in table.costs:
        first.setdefault(runs.get(str(cost["case"]), str(cost["case"])), cost)
    return list(first.values())


def of_mechanism(row: Row, method: str, quantity: str) -> Any:
    """A measure of the method's mechanism; None where none is known."""
    name = ("associated" if row.get("coulomb_status") is None else "coulomb") if method == LIMIT else method
    return row.get(f"{name}_{quantity}")


def mechanism_name(row: Row, method: str) -> str | None:
    """Label of the method's mechanism; None where none is known."""
    name = of_mechanism(row, method, "mechanism")
    return None if name is None or name == "" else str(name)


def falls(row: Row, method: str) -> bool:
    """Whether the method finds that the structure cannot stand under its own weight, so that there is no mechanism to name."""
    return row.get("yade_status") == "collapsed" if method == "yade" else row.get("associated_status") == "infeasible"
