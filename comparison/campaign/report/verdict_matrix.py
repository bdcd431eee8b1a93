"""The verdict matrix: every case of a campaign as one cell, scenes or one parameter downwards, another parameter to the right."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from comparison.campaign.parameter_labels import label, short, shown
from comparison.campaign.row_groups import SweepRows, key, longest, ordered, slices, sweeps_of
from comparison.campaign.row_values import Row, deviation, failed, link
from comparison.campaign.table import CampaignTable
from comparison.numbers import exists, format_number
from comparison.report import VERDICTS

FAILURE = ("!", "failed")
MOST_COLUMNS = 24  # that fit beside each other: a longer parameter goes downwards


@dataclass(frozen=True)
class MatrixCell:
    """One case: how it ended, and the address of its own report, "" where there is none."""

    case: str
    symbol: str
    word: str
    href: str
    words: str


@dataclass(frozen=True)
class Panel:
    """A table of cells; a place without a case has none, one that several cases share has all of them."""

    title: str
    corner: str
    heading: str
    columns: list[str]
    rows: list[tuple[str, list[list[MatrixCell]]]]


def verdict_symbol(row: Row) -> tuple[str, str]:
    """Sign and word of how a case ended."""
    return FAILURE if failed(row) else VERDICTS.get(row.get("verdict"), VERDICTS[None])


def matrix_panels(table: CampaignTable) -> list[Panel]:
    """Scenes that vary nothing together, those that vary one parameter together, any other sweep by its two longest parameters."""
    found = sweeps_of(table, classic=True)
    still = [sweep for sweep in found if not sweep.parameters]
    result = [_scenes(table.folder, "", still)] if still else []
    for parameter in table.axes:
        along = [sweep for sweep in found if sweep.parameters == [parameter]]
        result += [_scenes(table.folder, parameter, along)] if along else []
    for sweep in found:
        if len(sweep.parameters) > 1:
            result += _of_two(table.folder, sweep)
    return result


def cell(folder: Path, row: Row) -> MatrixCell:
    """The case's cell."""
    apart = deviation(row)
    words = f"{row.get('case')}: {verdict_symbol(row)[1]}"
    words += f", {format_number(apart, 2)} of what sliding joints are allowed apart" if exists(apart) else ""
    return MatrixCell(str(row.get("case")), *verdict_symbol(row), link(folder, row), words)


def _scenes(folder: Path, parameter: str, found: list[SweepRows]) -> Panel:
    """A row a scene; a column a value of the parameter, one column where nothing is varied."""
    if not parameter:
        rows = [(sweep.scene, [[cell(folder, row) for row in sweep.rows]]) for sweep in found]
        return Panel("Cases that vary nothing", "scene", "", ["verdict"], rows)
    values = ordered([value for sweep in found for value in sweep.values[parameter]])
    rows = [
        (sweep.scene, [[cell(folder, row) for row in sweep.where({parameter: value})] for value in values]) for sweep in found
    ]  # fmt: skip
    named = found[0].named
    return Panel(f"Over {short(parameter, named)}", "scene", label(parameter, named), [shown(value) for value in values], rows)


def _of_two(folder: Path, sweep: SweepRows) -> Iterator[Panel]:
    """The sweep's longest parameter to the right, where it fits, the second longest downwards; a panel for each value of the others."""
    across, down = longest(sweep)[:2]
    if len(sweep.values[across]) > MOST_COLUMNS:
        across, down = down, across
    for part in slices(sweep, (across, down)):
        places: dict[tuple[str, str], list[MatrixCell]] = {}
        for row in part.rows:
            places.setdefault((key(row[down]), key(row[across])), []).append(cell(folder, row))
        columns = part.values[across]
        rows = [(shown(low), [places.get((key(low), key(right)), []) for right in columns]) for low in part.values[down]]
        yield Panel(part.title, label(down, part.named), label(across, part.named), [shown(value) for value in columns], rows)
