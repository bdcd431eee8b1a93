"""A campaign's cases by what they vary: sweeps of a scene, and within them lines along one parameter."""

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
    """Cases of one scene that vary the same parameters. values: those of each parameter that occur, numbers rising.

    held: values of the parameters that a slice of a larger sweep holds. named: the campaign's short names of parameters.
    """

    scene: str
    values: dict[str, list[Any]]
    rows: list[Row]
    held: dict[str, Any] = field(default_factory=dict)
    named: dict[str, str] = field(default_factory=dict)

    @property
    def title(self) -> str:
        """The scene, and what is held."""
        return ", ".join(part for part in (self.scene, words_of(self.held, self.named)) if part)

    @property
    def parameters(self) -> list[str]:
        """What is varied, in the campaign's order."""
        return list(self.values)

    def where(self, place: dict[str, Any]) -> list[Row]:
        """Rows with these values of parameters."""
        return [row for row in self.rows if all(key(row.get(name)) == key(value) for name, value in place.items())]


@dataclass(frozen=True)
class Line:
    """Rows along one parameter, in order of its values, all others held. held: their values by name."""

    held: dict[str, Any]
    rows: list[Row]
    named: dict[str, str]

    @property
    def words(self) -> str:
        """What is held, in words; "" where nothing is."""
        return words_of(self.held, self.named)


def key(value: Any) -> str:
    """What tells a parameter's values apart; 1 and 1.0 are one value, 1 and true are two."""
    return repr(float(value)) if is_number(value) else json.dumps(value, sort_keys=True, default=str)


def is_number(value: Any) -> bool:
    """Whether a parameter's value is a number, and not a choice."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def sweeps_of(table: CampaignTable, classic: bool = False) -> list[SweepRows]:
    """Sweeps in order of their first case. Without `classic`, cases that differ in the classic iteration alone are one case."""
    names = [name for name in table.axes if classic or not name.startswith(CLASSIC)]
    groups: dict[tuple[str, tuple[str, ...]], dict[tuple[str, ...], list[Row]]] = {}
    for row in table.rows:
        known = tuple(name for name in names if row.get(name) is not None)
        places = groups.setdefault((sweep_of(row), known), {})
        places.setdefault(tuple(key(row[name]) for name in known), []).append(row)
    found = []
    for (scene, known), places in groups.items():
        rows = [row for same in places.values() for row in (same if classic else same[:1])]
        free = _varied(known, rows)
        found.append(
            SweepRows(scene, {name: ordered([row[name] for row in rows], table.axes[name]) for name in free}, rows, {}, table.labels)
        )
    return found


def _varied(names: Sequence[str], rows: Sequence[Row]) -> list[str]:
    """Parameters of more than one value, without those that go together with an earlier one, value by value: they are one axis."""
    free: list[str] = []
    for name in names:
        pairs = [{(key(row[other]), key(row[name])) for row in rows} for other in free]
        tied = any(len(both) == len({first for first, _ in both}) == len({second for _, second in both}) for both in pairs)
        if not tied and len({key(row[name]) for row in rows}) > 1:
            free.append(name)
    return free


def ordered(values: Sequence[Any], order: Sequence[Any] = ()) -> list[Any]:
    """The different values: numbers rising, choices after them in the given order."""
    different = list({key(value): value for value in values}.values())
    listed = [key(value) for value in order]

    def rank(value: Any) -> tuple[bool, float, str]:
        if is_number(value):
            return False, float(value), ""
        place = key(value)
        return True, float(listed.index(place) if place in listed else len(listed)), place

    return sorted(different, key=rank)


def lines(sweep: SweepRows, parameter: str) -> list[Line]:
    """Lines of a sweep along one parameter, in order of the other parameters' values."""
    others = [name for name in sweep.parameters if name != parameter]
    groups: dict[tuple[str, ...], list[Row]] = {}
    for row in sweep.rows:
        groups.setdefault(tuple(key(row[name]) for name in others), []).append(row)
    place = {name: {key(value): k for k, value in enumerate(sweep.values[name])} for name in sweep.parameters}

    def rank(item: tuple[tuple[str, ...], list[Row]]) -> tuple[int, ...]:
        return tuple(place[name][at] for name, at in zip(others, item[0], strict=True))

    found = []
    for _, rows in sorted(groups.items(), key=rank):
        along = sorted(rows, key=lambda row: place[parameter][key(row[parameter])])
        found.append(Line({name: rows[0][name] for name in others}, along, sweep.named))
    return found


def longest(sweep: SweepRows) -> list[str]:
    """The sweep's parameters, those of more values first."""
    return sorted(sweep.parameters, key=lambda name: -len(sweep.values[name]))


def slices(sweep: SweepRows, kept: Sequence[str]) -> list[SweepRows]:
    """The sweep for each value of all parameters but those kept, in their order; slices without cases are left out."""
    others = [name for name in sweep.parameters if name not in kept]
    places: dict[tuple[str, ...], list[Row]] = {}
    for row in sweep.rows:
        places.setdefault(tuple(key(row[name]) for name in others), []).append(row)
    values = {name: sweep.values[name] for name in kept}
    found = []
    for held in product(*(sweep.values[name] for name in others)):
        rows = places.get(tuple(key(value) for value in held))
        if rows:
            found.append(SweepRows(sweep.scene, values, rows, dict(zip(others, held, strict=True)), sweep.named))
    return found
