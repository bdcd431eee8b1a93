"""The figures of a campaign's report: drawn, stored in the campaign's folder, and described in words."""

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
from comparison.figures import save

FOLDER = "figures"
KINDS = ("prediction", "reaction", "map", "participation", "classic", "costs")
OWN = re.compile(rf"(?:{'|'.join(KINDS)})-[1-9]\d*\.png(?:\.\d+\.part)?")  # what this program writes there, or was writing when killed
PREDICTION = (
    "Left: YADE's reaction against limit analysis' prediction, equal on the dashed line. Right: their difference, linear up to 1 % and "
    "logarithmic beyond; cases whose prediction is all but zero are left out there."
)
REACTION = (
    "Reaction against {}: limit analysis' prediction and YADE with its uncertainty; with one line in a panel the associated bounds and "
    "what the mechanism allows are bands, with several the latter are bars beside the marks."
)
MAP = "Mechanisms over {}: a letter a mechanism (the blocks that move), heavy lines where it changes, hatched where the methods differ."
PARTICIPATION = "Distribution index of dissipation against {}: 1 where all interfaces dissipate alike, 1/J where one of J does it alone."
CLASSIC_WORDS = "The classic iteration against {}: what it converges to, and how many programmes it solves."
COSTS = "Seconds of both methods against the number of free blocks, and case by case."


@dataclass(frozen=True)
class Drawing:
    """A stored figure. kind: the part of the report it belongs to. path: relative to the campaign's folder."""

    kind: str
    caption: str
    path: str
    content: bytes


def draw_campaign(table: CampaignTable) -> list[Drawing]:
    """Draw and store every figure that the campaign has something for; those of an earlier report are taken away, and nothing else.

    Raises OSError where the folder of figures is a link, through which files elsewhere would be written and taken away.
    """
    folder = table.folder / FOLDER
    if folder.is_symlink():
        raise OSError(
            errno.ELOOP, "is a symbolic link; take it away, for figures are written in the campaign's own folder only", str(folder)
        )
    folder.mkdir(exist_ok=True)
    drawn, counts = [], dict[str, int]()
    for kind, figure, caption in _figures(table):
        counts[kind] = counts.get(kind, 0) + 1
        path = folder / f"{kind}-{counts[kind]}.png"
        save(figure, path)
        drawn.append(Drawing(kind, caption, f"{FOLDER}/{path.name}", path.read_bytes()))
    current = {Path(one.path).name for one in drawn}
    for path in folder.iterdir():
        if OWN.fullmatch(path.name) and path.name not in current:
            path.unlink(missing_ok=True)
    return drawn


def _figures(table: CampaignTable) -> Iterator[tuple[str, Any, str]]:
    """Kind, figure and caption of each."""
    found = sweeps_of(table)
    for unit in dict.fromkeys(row.get("unit") or "" for row in table.rows):
        rows = [row for row in table.rows if (row.get("unit") or "") == unit]
        figure = prediction.prediction_figure(_once(table, rows), unit)
        if figure is not None:
            yield "prediction", figure, PREDICTION
    for kind, caption, drawings in (
        ("reaction", REACTION, lines.reaction_figures(found)),
        ("participation", PARTICIPATION, lines.participation_figures(found)),
    ):
        for drawn in drawings:
            yield kind, drawn.figure, f"{caption.format(short(drawn.parameter, table.labels))} {drawn.left_out}".strip()
    for figure, words in maps.map_figures(found):
        yield "map", figure, MAP.format(words)
    for figure, parameter in classic.classic_figures(sweeps_of(table, classic=True)):
        yield "classic", figure, CLASSIC_WORDS.format(short(parameter, table.labels))
    costs = case_costs.case_cost_figure(table)
    if costs is not None:
        yield "costs", costs, COSTS


def _once(table: CampaignTable, rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Rows without those that differ from another in the classic iteration alone."""
    if not any(name.startswith(CLASSIC) for name in table.axes):
        return rows
    kept = {id(row) for sweep in sweeps_of(table) for row in sweep.rows}
    return [row for row in rows if id(row) in kept]
