"""Groups of a campaign's cases: sweeps of a scene, and within a sweep lines along one parameter."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import Any

from comparison.campaign.parameter_labels import CLASSIC, words_of
from comparison.campaign.row_values import Row, sweep_of
from comparison.campaign.table import CampaignTable


@dataclass(frozen=True)
class SweepRows:
    """Cases of one sweep that vary the same parameters.

    Attributes
    ----------
    scene : str
        Name of the sweep.
    values : dict
        Values of each varied parameter that occur; numbers in rising order.
    rows : list of Row
        The cases.
    held : dict
        Values of the parameters that are fixed in this slice of a larger sweep.
    named : dict
        The campaign's short names of parameters.
    """

    scene: str
    values: dict[str, list[Any]]
    rows: list[Row]
    held: dict[str, Any] = field(default_factory=dict)
    named: dict[str, str] = field(default_factory=dict)

    @property
    def title(self) -> str:
        """Scene and fixed parameters."""
        return ", ".join(text for text in (self.scene, words_of(self.held, self.named)) if text)

    @property
    def parameters(self) -> list[str]:
        """Varied parameters in the campaign's order."""
        return list(self.values)

    def where(self, place: dict[str, Any]) -> list[Row]:
        """Return the rows in which the parameters of `place` have its values."""
        return [row for row in self.rows if all(key(row.get(name)) == key(value) for name, value in place.items())]


@dataclass(frozen=True)
class Line:
    """Rows along one parameter in order of its values, all others fixed.

    Attributes
    ----------
    held : dict
        Values of the fixed parameters.
    rows : list of Row
        The cases.
    named : dict
        The campaign's short names of parameters.
    """

    held: dict[str, Any]
    rows: list[Row]
    named: dict[str, str]

    @property
    def words(self) -> str:
        """Fixed parameters in words; "" without any."""
        return words_of(self.held, self.named)


def key(value: Any) -> str:
    """Return a text that identifies a parameter's value; 1 and 1.0 are one value, 1 and true are two."""
    return repr(float(value)) if is_number(value) else json.dumps(value, sort_keys=True, default=str)


def is_number(value: Any) -> bool:
    """Return whether a parameter's value is a number (not a choice)."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def sweeps_of(table: CampaignTable, classic: bool = False) -> list[SweepRows]:
    """Return the sweeps in order of their first case.

    classic: whether to keep all cases that differ only in the classic iteration; otherwise only the first of them is kept.
    """
    names = [name for name in table.axes if classic or not name.startswith(CLASSIC)]
    groups: dict[tuple[str, tuple[str, ...]], dict[tuple[str, ...], list[Row]]] = {}
    for row in table.rows:
        known = tuple(name for name in names if row.get(name) is not None)
        places = groups.setdefault((sweep_of(row), known), {})
        places.setdefault(tuple(key(row[name]) for name in known), []).append(row)
    sweeps = []
    for (scene, known), places in groups.items():
        rows = [row for same in places.values() for row in (same if classic else same[:1])]
        free = _varied(known, rows)
        values = {name: ordered([row[name] for row in rows], table.axes[name]) for name in free}
        sweeps.append(SweepRows(scene, values, rows, {}, table.labels))
    return sweeps


def _varied(names: Sequence[str], rows: Sequence[Row]) -> list[str]:
    """Return the parameters with several values; of parameters that vary together one to one, only the first."""
    free: list[str] = []
    for name in names:
        pairs = [{(key(row[other]), key(row[name])) for row in rows} for other in free]
        tied = any(len(both) == len({first for first, _ in both}) == len({second for _, second in both}) for both in pairs)
        if not tied and len({key(row[name]) for row in rows}) > 1:
            free.append(name)
    return free


def ordered(values: Sequence[Any], order: Sequence[Any] = ()) -> list[Any]:
    """Return the distinct values: first numbers, rising, then choices in the given order."""
    distinct = list({key(value): value for value in values}.values())
    listed = [key(value) for value in order]

    def rank(value: Any) -> tuple[bool, float, str]:
        if is_number(value):
            return False, float(value), ""
        place = key(value)
        return True, float(listed.index(place) if place in listed else len(listed)), place

    return sorted(distinct, key=rank)


def lines(sweep: SweepRows, parameter: str) -> list[Line]:
    """Return the lines of a sweep along one parameter, in order of the other parameters' values."""
    others = [name for name in sweep.parameters if name != parameter]
    groups: dict[tuple[str, ...], list[Row]] = {}
    for row in sweep.rows:
        groups.setdefault(tuple(key(row[name]) for name in others), []).append(row)
    place = {name: {key(value): k for k, value in enumerate(sweep.values[name])} for name in sweep.parameters}

    def rank(item: tuple[tuple[str, ...], list[Row]]) -> tuple[int, ...]:
        return tuple(place[name][at] for name, at in zip(others, item[0], strict=True))

    in_order = []
    for _, rows in sorted(groups.items(), key=rank):
        along = sorted(rows, key=lambda row: place[parameter][key(row[parameter])])
        in_order.append(Line({name: rows[0][name] for name in others}, along, sweep.named))
    return in_order


def longest(sweep: SweepRows) -> list[str]:
    """Return the sweep's parameters, those with more values first."""
    return sorted(sweep.parameters, key=lambda name: -len(sweep.values[name]))


def slices(sweep: SweepRows, kept: Sequence[str]) -> list[SweepRows]:
    """Return slices of a sweep: one for each combination of values of the parameters not in `kept`, without empty ones."""
    others = [name for name in sweep.parameters if name not in kept]
    places: dict[tuple[str, ...], list[Row]] = {}
    for row in sweep.rows:
        places.setdefault(tuple(key(row[name]) for name in others), []).append(row)
    values = {name: sweep.values[name] for name in kept}
    in_order = []
    for held in product(*(sweep.values[name] for name in others)):
        rows = places.get(tuple(key(value) for value in held))
        if rows:
            in_order.append(SweepRows(sweep.scene, values, rows, dict(zip(others, held, strict=True)), sweep.named))
    return in_order
