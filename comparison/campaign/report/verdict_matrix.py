"""The verdict matrix: one cell for each case; rows are scenes or a parameter, columns another parameter."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from comparison.campaign.parameter_labels import label, short, shown
from comparison.campaign.row_groups import SweepRows, key, longest, ordered, slices, sweeps_of
from comparison.campaign.row_values import Row, deviation, failed, link
from comparison.campaign.table import CampaignTable
from comparison.numbers import format_number
from comparison.verdict import VERDICTS
from la_core.text_table import exists

FAILURE = ("!", "failed")
MOST_COLUMNS = 24  # fit side by side; a parameter with more values goes downwards


@dataclass(frozen=True)
class MatrixCell:
    """Cell of one case.

    Attributes
    ----------
    case : str
        Name of the case.
    symbol, word : str
        Verdict as sign and word.
    href : str
        Relative address of the case's report; "" without one.
    words : str
        Description: name, verdict and difference.
    """

    case: str
    symbol: str
    word: str
    href: str
    words: str


@dataclass(frozen=True)
class Panel:
    """A table of cells.

    Attributes
    ----------
    title, corner, heading : str
        Title, label of the rows, and label of the columns.
    columns : list of str
        Headings of the columns.
    rows : list of tuple
        Heading of each row, and for each column the list of its cells: empty without a case, several for cases with the same values.
    """

    title: str
    corner: str
    heading: str
    columns: list[str]
    rows: list[tuple[str, list[list[MatrixCell]]]]


def verdict_symbol(row: Row) -> tuple[str, str]:
    """Return the sign and the word of a case's verdict or failure."""
    return FAILURE if failed(row) else VERDICTS.get(row.get("verdict"), VERDICTS[None])


def matrix_panels(table: CampaignTable) -> list[Panel]:
    """Return the panels: one for unvaried scenes, one per single parameter, and two-way panels for every larger sweep."""
    sweeps = sweeps_of(table, classic=True)
    still = [sweep for sweep in sweeps if not sweep.parameters]
    result = [_scenes(table, "", still)] if still else []
    for parameter in table.axes:
        along = [sweep for sweep in sweeps if sweep.parameters == [parameter]]
        result += [_scenes(table, parameter, along)] if along else []
    for sweep in sweeps:
        if len(sweep.parameters) > 1:
            result += _of_two(table.folder, sweep)
    return result


def cell(folder: Path, row: Row) -> MatrixCell:
    """Return the cell of a case; folder: of the campaign."""
    apart = deviation(row)
    words = f"{row.get('case')}: {verdict_symbol(row)[1]}"
    words += f", difference {format_number(apart, 2)} of the allowed one" if exists(apart) else ""
    return MatrixCell(str(row.get("case")), *verdict_symbol(row), link(folder, row), words)


def _scenes(table: CampaignTable, parameter: str, sweeps: list[SweepRows]) -> Panel:
    """Return a panel with one row per scene and one column per value of the parameter; without a parameter, "", one column."""
    folder = table.folder
    if not parameter:
        rows = [(sweep.scene, [[cell(folder, row) for row in sweep.rows]]) for sweep in sweeps]
        return Panel("Cases without varied parameters", "scene", "", ["verdict"], rows)
    values = ordered([value for sweep in sweeps for value in sweep.values[parameter]], table.axes[parameter])
    rows = [
        (sweep.scene, [[cell(folder, row) for row in sweep.where({parameter: value})] for value in values]) for sweep in sweeps
    ]  # fmt: skip
    named = sweeps[0].named
    return Panel(f"Over {short(parameter, named)}", "scene", label(parameter, named), [shown(value) for value in values], rows)


def _of_two(folder: Path, sweep: SweepRows) -> Iterator[Panel]:
    """Yield a panel for each combination of other parameters: the parameter with most values to the right if it fits, another downwards."""
    across, down = longest(sweep)[:2]
    if len(sweep.values[across]) > MOST_COLUMNS:
        across, down = down, across
    for sweep_slice in slices(sweep, (across, down)):
        places: dict[tuple[str, str], list[MatrixCell]] = {}
        for row in sweep_slice.rows:
            places.setdefault((key(row[down]), key(row[across])), []).append(cell(folder, row))
        columns = sweep_slice.values[across]
        rows = [(shown(low), [places.get((key(low), key(right)), []) for right in columns]) for low in sweep_slice.values[down]]
        corner, heading = (label(name, sweep_slice.named) for name in (down, across))
        yield Panel(sweep_slice.title, corner, heading, [shown(value) for value in columns], rows)
