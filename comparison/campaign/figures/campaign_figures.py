"""The figures of a campaign's report: draw them, store them in the campaign's folder, and caption them."""

import errno
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from comparison.campaign.figures import case_costs, classic, lines, maps, prediction
from comparison.campaign.parameter_labels import CLASSIC, short
from comparison.campaign.row_groups import sweeps_of
from comparison.campaign.table import CampaignTable
from comparison.figures import own_style, save

FOLDER = "figures"
KINDS = ("prediction", "reaction", "map", "participation", "classic", "costs")
OWN = re.compile(rf"(?:{'|'.join(KINDS)})-[1-9]\d*\.png(?:\.\d+\.part)?")  # finished or unfinished files of this program in FOLDER
PREDICTION = (
    "Left: YADE's value against limit analysis' prediction, equal on the dashed line. Right: their difference, linear up to 1 % and "
    "logarithmic beyond; cases with a prediction near zero are left out there."
)
REACTION = (
    "Limit analysis' prediction{yade}, against {parameter}. In a panel with one line, the associated bounds and the "
    "mechanism's interval are bands; in a panel with several, the intervals are bars beside the marks."
)
MAP = "Mechanisms over {parameters}: one letter per mechanism (set of moving blocks), heavy lines where it changes{yade}."
PARTICIPATION = "Participation index against {parameter}: 1 if all interfaces dissipate equally, 1/J if only one of J dissipates."
CLASSIC_WORDS = "The classic iteration against {}: its value, and its number of programmes."
COSTS = "Seconds of {methods} against the number of free blocks, and case by case."


@dataclass(frozen=True)
class Drawing:
    """A stored figure.

    Attributes
    ----------
    kind : str
        Section of the report, one of KINDS.
    caption : str
        Caption.
    path : str
        Path relative to the campaign's folder.
    content : bytes
        The PNG file.
    """

    kind: str
    caption: str
    path: str
    content: bytes


@own_style()
def draw_campaign(table: CampaignTable) -> list[Drawing]:
    """Draw and store the campaign's figures, and delete those of an earlier report, but no other file.

    Raises OSError if the folder of figures is a link, because files elsewhere would be overwritten or deleted.
    """
    folder = table.folder / FOLDER
    if folder.is_symlink():
        raise OSError(errno.ELOOP, "is a symbolic link; delete it: figures are written in the campaign's own folder only", str(folder))
    folder.mkdir(exist_ok=True)
    drawn, counts = [], dict[str, int]()
    for kind, figure, caption in _figures(table):
        counts[kind] = counts.get(kind, 0) + 1
        path = folder / f"{kind}-{counts[kind]}.png"
        save(figure, path)
        drawn.append(Drawing(kind, caption, f"{FOLDER}/{path.name}", path.read_bytes()))
    current = {Path(drawing.path).name for drawing in drawn}
    for path in folder.iterdir():
        if OWN.fullmatch(path.name) and path.name not in current:
            path.unlink(missing_ok=True)
    return drawn


def _figures(table: CampaignTable) -> Iterator[tuple[str, Any, str]]:
    """Yield kind, figure and caption of each figure."""
    sweeps, ran_yade = sweeps_of(table), table.ran_yade
    for unit in dict.fromkeys(row.get("unit") or "" for row in table.rows):
        rows = [row for row in table.rows if (row.get("unit") or "") == unit]
        figure = prediction.prediction_figure(_once(table, rows), unit)
        if figure is not None:
            yield "prediction", figure, PREDICTION
    for kind, caption, drawings in (
        ("reaction", REACTION, lines.reaction_figures(sweeps)),
        ("participation", PARTICIPATION, lines.participation_figures(sweeps)),
    ):
        for drawn in drawings:
            words = caption.format(
                parameter=short(drawn.parameter, table.labels), yade=" and YADE with its uncertainty" if ran_yade else ""
            )
            yield kind, drawn.figure, f"{words} {drawn.left_out}".strip()
    for figure, parameters in maps.map_figures(sweeps):
        yield "map", figure, MAP.format(parameters=parameters, yade=", hatched where the methods differ" if ran_yade else "")
    for figure, parameter in classic.classic_figures(sweeps_of(table, classic=True)):
        yield "classic", figure, CLASSIC_WORDS.format(short(parameter, table.labels))
    costs = case_costs.case_cost_figure(table)
    if costs is not None:
        yield "costs", costs, COSTS.format(methods="both methods" if ran_yade else "limit analysis")


def _once(table: CampaignTable, rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Return the rows with only the first of the cases that differ only in the classic iteration."""
    if not any(name.startswith(CLASSIC) for name in table.axes):
        return rows
    kept = {id(row) for sweep in sweeps_of(table) for row in sweep.rows}
    return [row for row in rows if id(row) in kept]
