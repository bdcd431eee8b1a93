"""Costs of a campaign's cases: seconds of both methods against the number of blocks, and case by case."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, MaxNLocator, NullFormatter, NullLocator

from comparison.campaign.figures import shared_axes
from comparison.campaign.row_values import costs_once
from comparison.campaign.table import CampaignTable
from comparison.figures import INK, LIMIT_ANALYSIS, YADE
from comparison.numbers import format_number
from la_core.text_table import exists

SECONDS = {"limit_analysis_seconds": ("limit analysis", LIMIT_ANALYSIS, "o"), "yade_seconds": ("YADE", YADE, "s")}
SIZES = (1, 2, 3, 4, 5, 6, 8)  # numbers of blocks at the ticks of every decade
FEW = 12  # cases; the names of at most this number stand under the axis


def case_cost_figure(table: CampaignTable) -> Figure | None:
    """Draw seconds against free blocks (left) and of each case, the most expensive first (right); None without known seconds."""
    blocks = {row["case"]: row.get("free_blocks") for row in table.rows}
    once = costs_once(table)
    total = {cost["case"]: sum(cost[name] for name in SECONDS if exists(cost.get(name))) for cost in once}
    known = [cost for cost in once if total[cost["case"]] > 0.0 and exists(blocks.get(cost["case"]))]
    dearest = sorted(known, key=lambda cost: (-total[cost["case"]], cost["case"]))
    if not dearest:
        return None
    figure, (left, right) = shared_axes.panel_figure(2, 3.8)
    for name, (_, colour, marker) in SECONDS.items():
        style = {"color": colour, "marker": marker, "linestyle": "none", "markersize": 5.5, "markeredgecolor": INK, "markeredgewidth": 0.6}
        existing = [(k, cost) for k, cost in enumerate(dearest, 1) if exists(cost.get(name)) and cost[name] > 0.0]
        left.plot([blocks[cost["case"]] for _, cost in existing], [cost[name] for _, cost in existing], **style)
        right.plot([k for k, _ in existing], [cost[name] for _, cost in existing], **style)
    _finish(left, right, [cost["case"] for cost in dearest], np.unique([blocks[cost["case"]] for cost in dearest]).tolist())
    shared_axes.legend(figure, [_handle(table, name) for name in SECONDS])
    return figure


def _finish(left: Any, right: Any, names: list[str], numbers: list[Any]) -> None:
    """Set scales, ticks and labels. names: names of the cases; numbers: rising numbers of free blocks."""
    left.set_xscale("log")
    for axes in (left, right):
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.yaxis.set_minor_formatter(_between_decades(*axes.get_ylim()))
        axes.set_ylabel("time of the method (s)", fontsize=9)
    left.margins(x=0.1)
    low, high = left.get_xlim()
    round_sizes = [first * 10**k for k in range(7) for first in SIZES if low <= first * 10**k <= high]
    sizes = round_sizes if len(round_sizes) > 1 else numbers
    kept = [sizes[k] for k in shared_axes.apart(np.log(sizes), [str(size) for size in sizes])]
    left.set_xticks(kept, [str(size) for size in kept])
    left.xaxis.set_minor_locator(NullLocator())
    left.set_xlabel("free blocks", fontsize=9)
    if len(names) <= FEW:
        right.set_xticks(range(1, len(names) + 1), names, rotation=25, ha="right", parse_math=False)
    else:
        right.xaxis.set_major_locator(MaxNLocator(integer=True))
        right.set_xlabel("cases, the most expensive first", fontsize=9)


def _between_decades(low: float, high: float) -> Any:
    """Return the formatter of the ticks between powers of ten; it writes texts only if the axis would otherwise have fewer than two."""
    if high < 20.0 * low:
        return FuncFormatter(lambda value, _: f"{value:g}")
    if np.floor(np.log10(high)) > np.ceil(np.log10(low)):
        return NullFormatter()
    return FuncFormatter(lambda value, _: f"{value:g}" if f"{value:e}"[0] in "25" else "")


def _handle(table: CampaignTable, name: str) -> Line2D:
    words, colour, marker = SECONDS[name]
    known = [cost[name] for cost in costs_once(table) if exists(cost.get(name))]
    label = f"{words}, total {format_number(sum(known), 3)} s" if known else f"{words}: not run"
    return Line2D([], [], color=colour, marker=marker, linestyle="none", markeredgecolor=INK, label=label)
