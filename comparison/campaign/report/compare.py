"""Two campaigns, before and after a change of code, settings or versions: what differs, and whether it is of substance."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from statistics import median
from typing import Any

from comparison.campaign.report.verdict_matrix import verdict_symbol
from comparison.campaign.row_values import METHODS, Row, mechanism_name, runs_of
from comparison.campaign.table import CampaignTable
from comparison.judge import HISTORY
from comparison.numbers import exists
from comparison.report import flat

SOLVER = 1e-6  # of the weight (of a multiplier): what the cone solver leaves of a bound, and round-off
DILATANCY = 1e-3  # of a prediction: the dilatancy residual above which it would be called inaccurate
CONVERGED = 1e-3  # of the classic iteration's value
STATUSES = ("associated_status", "coulomb_status", "yade_status", "classic_status")
REACTIONS = ("least", "greatest", "coulomb", "coulomb_sharp", "yade", "classic")
SECONDS = {"limit_analysis_seconds": "limit analysis", "yade_seconds": "YADE"}
EVERY_TIME = ("seconds", "ended")  # provenance that differs between any two calls and says nothing on what made the results


@dataclass(frozen=True)
class Change:
    """One thing of one case that differs: `kind` is verdict, status, mechanism or reaction.

    Reactions are in N, N m or multipliers, after less before; allowed: what the stated uncertainties of both cover; None for words.
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
        """After less before, None where either is no number."""
        return self.after - self.before if exists(self.before) and exists(self.after) else None

    @property
    def share(self) -> float:
        """The difference over what is allowed; infinite for words and for what exists in one campaign only."""
        if self.difference is None or self.allowed is None:
            return math.inf
        return abs(self.difference) / self.allowed if self.allowed > 0.0 else math.inf


@dataclass(frozen=True)
class Cost:
    """Seconds of a method over the cases of both campaigns that have them; ratio: total after over before; typical: median of ratios, on a
    logarithmic scale."""

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
    """What differs between two campaigns. changes: of substance; within: reactions that moved by no more than is stated."""

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

    @property
    def changed(self) -> bool:
        """Whether anything of substance differs; costs and versions are none."""
        return bool(self.changes or self.only_before or self.only_after)


def compare(before: CampaignTable, after: CampaignTable) -> Comparison:
    """Hold two campaigns against each other, cases matched by name."""
    first, second = ({str(row["case"]): row for row in table.rows} for table in (before, after))
    both = [name for name in first if name in second]
    moved = [change for name in both for change in _reactions(first[name], second[name])]
    words = [change for name in both for change in _words(first[name], second[name])]
    substance = [*words, *(change for change in moved if change.share > 1.0)]
    place = {name: k for k, name in enumerate(sorted(both))}
    costs = _case_costs(before, after)
    return Comparison(
        (before.title, after.title),
        (str(before.folder), str(after.folder)),
        len(both),
        _provenance(before.provenance, after.provenance),
        sorted(name for name in first if name not in second),
        sorted(name for name in second if name not in first),
        sorted(substance, key=lambda change: place[change.case]),
        sorted((change for change in moved if change.share <= 1.0), key=lambda change: (-change.share, change.case, change.what)),
        list(_costs(costs)),
        sorted(((case, method, late / early) for case, method, early, late in costs), key=lambda item: (-abs(math.log(item[2])), item[:2])),
    )


def _words(before: Row, after: Row) -> Iterator[Change]:
    """Verdict, statuses and mechanisms that differ."""
    case = str(before["case"])
    pairs: list[tuple[str, str, Any, Any]] = [("verdict", "verdict", verdict_symbol(before)[1], verdict_symbol(after)[1])]
    pairs += [("status", name, before.get(name), after.get(name)) for name in STATUSES]
    pairs += [("mechanism", method, mechanism_name(before, method), mechanism_name(after, method)) for method in METHODS]
    for kind, what, first, second in pairs:
        if first != second:
            yield Change(case, kind, what, first, second)


def _reactions(before: Row, after: Row) -> Iterator[Change]:
    """Reactions that differ at all, each with what may be between two answers that are both right."""
    for name in REACTIONS:
        first, second = (row.get(name) if exists(row.get(name)) else None for row in (before, after))
        if first != second:
            yield Change(
                str(before["case"]),
                "reaction",
                name,
                first,
                second,
                _allowed(name, before) + _allowed(name, after),
                str(before.get("unit") or ""),
            )


def _allowed(name: str, row: Row) -> float:
    """By how much this reaction of one campaign may be off: stated uncertainty of YADE, accuracy of the iterations, of the solver.

    A prediction within an interval that friction's history leaves open may move in it, by at most what sliding joints are allowed.
    """
    value, weight, uncertainty = (_or_zero(row.get(key)) for key in (name, "weight", "yade_uncertainty"))
    solver = SOLVER * (weight if row.get("unit") else abs(value))
    if name == "yade":
        return solver + uncertainty
    if name == "classic":
        return solver + CONVERGED * abs(value)
    if name in ("coulomb", "coulomb_sharp"):
        low, high = row.get("coulomb_low"), row.get("coulomb_high")
        open_width = (high - low) / 2.0 if exists(low) and exists(high) else 0.0
        return solver + max(DILATANCY * abs(value), min(open_width, HISTORY * abs(value))) / 2.0
    return solver


def _or_zero(value: Any) -> float:
    return value if exists(value) else 0.0


def _provenance(before: Mapping[str, Any], after: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    """Facts that differ, with both values, "" for one that only the other has."""
    first, second = dict(flat(dict(before))), dict(flat(dict(after)))
    names = sorted((first.keys() | second.keys()) - set(EVERY_TIME))
    return [(name, first.get(name, ""), second.get(name, "")) for name in names if first.get(name) != second.get(name)]


def _case_costs(before: CampaignTable, after: CampaignTable) -> list[tuple[str, str, float, float]]:
    """Case, method, and its seconds in both campaigns, where both have some; of cases that share a run in either, one."""
    first, second = ({str(cost["case"]): cost for cost in table.costs} for table in (before, after))
    return [
        (case, method, first[case][key], second[case][key])
        for key, method in SECONDS.items()
        for case in _once(before, after)
        if case in first and case in second and all(exists(costs[case].get(key)) and costs[case][key] > 0.0 for costs in (first, second))
    ]


def _once(before: CampaignTable, after: CampaignTable) -> list[str]:
    """Cases of both, in order of their names, without those whose run in either campaign is that of an earlier one."""
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
        own = [(early, late) for _, method, early, late in costs if method == name]
        if own:
            early, late = (math.fsum(times) for times in zip(*own, strict=True))
            yield Cost(name, len(own), early, late, math.exp(median(math.log(after / before) for before, after in own)))
