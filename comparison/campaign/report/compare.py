"""Comparison of two campaigns, before and after a change of code, settings or versions; changes within uncertainty are listed apart."""

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from statistics import median
from typing import Any

from comparison.campaign.cases import folder_name
from comparison.campaign.report.verdict_matrix import verdict_symbol
from comparison.campaign.row_values import Row, least_tolerance, mechanism_name, runs_of, sweep_of, uncertainty_of
from comparison.campaign.table import CampaignTable
from comparison.judge import UNCERTAIN
from comparison.report import flat
from comparison.verdict import ANSWERS
from la_core.exchange import LEAST_REACTION
from la_core.text_table import exists

SOLVER = 1e-6  # residual of the cone solver and round-off: over the weight, for a moment times a lever arm; absolute for a multiplier
UNSTATED = 1e-3  # relative error of a prediction by an older version, which states no uncertainty
CONVERGED = 1e-3  # relative error of the classic iteration's value
STATUSES = ("associated_status", "coulomb_status", "yade_status", "classic_status")
COUNTS = ("free_blocks", "coulomb_plateaus")
OF_PREDICTION = ("coulomb", "coulomb_sharp", "coulomb_low", "coulomb_high")  # all with the uncertainty of the first
REACTIONS = ("least", "greatest", *OF_PREDICTION, "coulomb_released", "coulomb_peak", "yade", "classic")
SECONDS = {"limit_analysis_seconds": "limit analysis", "yade_seconds": "YADE"}
EVERY_TIME = ("seconds", "ended")  # provenance that differs between any two runs and does not affect results


@dataclass(frozen=True)
class Change:
    """One difference of one case.

    Attributes
    ----------
    case : str
        Name of the case.
    kind : str
        'verdict', 'status', 'mechanism', 'unit', 'count', 'weight' or 'reaction'.
    what : str
        Name of the column, or the method of a mechanism.
    before, after : object
        The two values: texts, counts, weights (N), or reactions (N; N m for a rotation) or multipliers; None where undefined.
    allowed : float or None
        Difference of reactions that the stated uncertainties of both campaigns explain, or of weights by round-off; None for texts and
        counts.
    unit : str
        Unit of reactions and weights; "" for a multiplier.
    """

    case: str
    kind: str
    what: str
    before: Any
    after: Any
    allowed: float | None = None
    unit: str = ""

    @property
    def difference(self) -> float | None:
        """After minus before; None unless both are numbers."""
        return self.after - self.before if exists(self.before) and exists(self.after) else None

    @property
    def share(self) -> float:
        """Difference over the allowed one; infinite for texts, counts, and a value that only one campaign has."""
        if self.difference is None or self.allowed is None:
            return math.inf
        return abs(self.difference) / self.allowed if self.allowed > 0.0 else math.inf


@dataclass(frozen=True)
class Cost:
    """Seconds of a method, over the cases that have them in both campaigns.

    Attributes
    ----------
    method : str
        Name of the method.
    cases : int
        Number of cases.
    before, after : float
        Total of each campaign (s).
    typical : float
        Median over the cases of after / before, on a logarithmic scale.
    """

    method: str
    cases: int
    before: float
    after: float
    typical: float

    @property
    def ratio(self) -> float:
        """Total after over total before."""
        return self.after / self.before


@dataclass(frozen=True)
class Comparison:
    """Differences between two campaigns.

    Attributes
    ----------
    titles, folders : tuple of str
        Title and folder of both campaigns.
    matched : int
        Number of cases that both have.
    provenance : list of tuple
        Differing facts: name, value before, value after.
    only_before, only_after : list of str
        Cases that only one campaign has.
    changes : list of Change
        Differences beyond the stated uncertainties.
    within : list of Change
        Reactions that differ by no more than the stated uncertainties.
    costs : list of Cost
        Seconds of each method.
    case_costs : list of tuple
        Case, method, and seconds after / before; the largest change first.
    unfinished : tuple of str
        Sentence on the number of ended cases of each campaign that was interrupted; else "".
    """

    titles: tuple[str, str]
    folders: tuple[str, str]
    matched: int
    provenance: list[tuple[str, str, str]]
    only_before: list[str]
    only_after: list[str]
    changes: list[Change]
    within: list[Change]
    costs: list[Cost]
    case_costs: list[tuple[str, str, float]]
    unfinished: tuple[str, str] = ("", "")

    @property
    def yade_in_one(self) -> bool:
        """Whether YADE ran in one of the two campaigns only."""
        return any(name == "yade" for name, _, _ in self.provenance)

    @property
    def changed(self) -> bool:
        """Whether results differ beyond the stated uncertainties; costs and versions do not count."""
        return bool(self.changes or self.only_before or self.only_after)


def compare_tables(before: CampaignTable, after: CampaignTable) -> Comparison:
    """Compare two campaigns; cases are matched by the values of their keys, or by name where a campaign varies other keys."""
    after = _named_as(before, after)
    first, second = ({str(row["case"]): row for row in table.rows} for table in (before, after))
    both = [name for name in first if name in second]
    moved = [change for name in both for change in _values(first[name], second[name])]
    texts = [change for name in both for change in _text_changes(first[name], second[name])]
    substance = [*texts, *(change for change in moved if change.share > 1.0)]
    place = {name: k for k, name in enumerate(sorted(both))}
    costs = _case_costs(before, after)
    ratios = [(case, method, late / early) for case, method, early, late in costs]
    return Comparison(
        (before.title, after.title),
        (str(before.folder), str(after.folder)),
        len(both),
        _provenance(before.provenance, after.provenance),
        sorted(name for name in first if name not in second),
        sorted(name for name in second if name not in first),
        sorted(substance, key=lambda change: place[change.case]),
        sorted(
            (one for one in moved if one.share <= 1.0 and one.kind == "reaction"),
            key=lambda change: (-change.share, change.case, change.what),
        ),
        list(_costs(costs)),
        sorted(ratios, key=lambda ratio: (-abs(math.log(ratio[2])), ratio[:2])),
        (before.unfinished, after.unfinished),
    )


def _named_as(before: CampaignTable, after: CampaignTable) -> CampaignTable:
    """Return the second campaign with the first one's names for cases of equal values; other cases with such a name get "(after)".

    A case is named by the place of an array in its range, so cases of the same name may have other values. Values that are tables are
    compared by this name, because another version may know more keys of a table. Sweeps are compared by their safe names, because older
    tables have no others.
    """
    if before.axes.keys() != after.axes.keys():
        return after

    def identity(row: Row) -> str:
        values = (row.get(key) for key in sorted(before.axes))
        return json.dumps([folder_name(sweep_of(row)), *(row["case"] if "{" in json.dumps(value) else value for value in values)])

    names = {identity(row): str(row["case"]) for row in before.rows}
    if len(names) < len(before.rows) or len({identity(row) for row in after.rows}) < len(after.rows):
        return after
    taken = set(names.values())
    own = {}
    for row in after.rows:
        name = str(row["case"])
        own[name] = names.get(identity(row), f"{name} (after)" if name in taken else name)

    def renamed(rows: list[Row]) -> list[Row]:
        return [row | {"case": own.get(str(row["case"]), row["case"])} for row in rows]

    return replace(after, rows=renamed(after.rows), costs=renamed(after.costs))


def _text_changes(before: Row, after: Row) -> Iterator[Change]:
    """Yield differing verdicts, statuses, mechanisms, units and counts."""
    case = str(before["case"])
    pairs: list[tuple[str, str, Any, Any]] = [("verdict", "verdict", verdict_symbol(before)[1], verdict_symbol(after)[1])]
    pairs += [("status", name, before.get(name), after.get(name)) for name in STATUSES]
    pairs += [("mechanism", method, mechanism_name(before, method), mechanism_name(after, method)) for method in ANSWERS]
    pairs += [("unit", "unit", before.get("unit"), after.get("unit"))]
    pairs += [("count", name, before[name], after[name]) for name in COUNTS if name in before and name in after]
    for kind, what, first, second in pairs:
        if first != second:
            yield Change(case, kind, what, first, second)


def _values(before: Row, after: Row) -> Iterator[Change]:
    """Yield all differing reactions and weights, each with the difference that is allowed between two correct answers.

    A column that a table of an earlier version lacks is no change.
    """
    units = {"weight": "N"} | dict.fromkeys(REACTIONS, str(before.get("unit") or ""))
    for name, unit in units.items():
        first, second = (row.get(name) if exists(row.get(name)) else None for row in (before, after))
        if first != second and name in before and name in after:
            kind = name if name == "weight" else "reaction"
            yield Change(str(before["case"]), kind, name, first, second, _allowed(name, before) + _allowed(name, after), unit)


def _allowed(name: str, row: Row) -> float:
    """Return the error that a value may have: the uncertainty that its method states, and the error of the solver.

    A prediction without a stated uncertainty may move within the interval that the history of friction leaves open, at most by the
    uncertainty that a verdict allows.
    """
    value, weight = (_or_zero(row.get(key)) for key in (name, "weight"))
    size = weight if name == "weight" else least_tolerance(row) / LEAST_REACTION
    solver = SOLVER * max(size, 0.0 if row.get("unit") else abs(value))
    stated = row.get(uncertainty_of("coulomb" if name in OF_PREDICTION else name))
    if exists(stated):
        return solver + stated
    if name == "classic":
        return solver + CONVERGED * abs(value)
    if name in ("coulomb", "coulomb_sharp"):
        low, high = row.get("coulomb_low"), row.get("coulomb_high")
        open_width = (high - low) / 2.0 if exists(low) and exists(high) else 0.0
        return solver + max(UNSTATED * abs(value), min(open_width, UNCERTAIN * abs(value))) / 2.0
    return solver + (UNSTATED * abs(value) / 2.0 if name.startswith("coulomb") else 0.0)


def _or_zero(value: Any) -> float:
    return value if exists(value) else 0.0


def _provenance(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    """Return differing facts: name and both values, "" for a missing one."""
    first, second = dict(flat(dict(before))), dict(flat(dict(after)))
    names = sorted((first.keys() | second.keys()) - set(EVERY_TIME))
    return [(name, first.get(name, ""), second.get(name, "")) for name in names if first.get(name) != second.get(name)]


def _case_costs(before: CampaignTable, after: CampaignTable) -> list[tuple[str, str, float, float]]:
    """Return case, method and seconds of both campaigns where both are known; one case per run."""
    first, second = ({str(cost["case"]): cost for cost in table.costs} for table in (before, after))
    return [
        (case, method, first[case][key], second[case][key])
        for key, method in SECONDS.items()
        for case in _once(before, after)
        if case in first and case in second and all(exists(costs[case].get(key)) and costs[case][key] > 0.0 for costs in (first, second))
    ]


def _once(before: CampaignTable, after: CampaignTable) -> list[str]:
    """Return the cases of both campaigns by name, without those that share a run with an earlier one in either campaign."""
    first, second = runs_of(before), runs_of(after)
    kept: list[str] = []
    seen_before, seen_after = set[str](), set[str]()
    for case in sorted(first.keys() & second.keys()):
        if first[case] not in seen_before and second[case] not in seen_after:
            kept.append(case)
            seen_before.add(first[case])
            seen_after.add(second[case])
    return kept


def _costs(costs: list[tuple[str, str, float, float]]) -> Iterator[Cost]:
    for name in SECONDS.values():
        pairs = [(early, late) for _, method, early, late in costs if method == name]
        if pairs:
            early, late = (math.fsum(times) for times in zip(*pairs, strict=True))
            typical = math.exp(median(math.log(after / before) for before, after in pairs))
            yield Cost(name, len(pairs), early, late, typical)
