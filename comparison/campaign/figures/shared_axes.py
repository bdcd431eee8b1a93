"""Shared parts of a campaign's figures: panels, axes along a parameter, styles and selection of series."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from comparison.campaign.parameter_labels import label, shown
from comparison.campaign.row_groups import is_number, key
from comparison.figures import FAINT, tint

WIDTH = 11.0  # inches, as in the other figures of the report
COLUMNS = 3  # of panels
SERIES = 5  # lines in a panel; a larger number is thinned out evenly
OUTSIDE = 1e9  # end of an infinite bar or band, outside every frame
EVENER = 1.5  # a logarithmic axis is used if it widens the smallest gap, relative to the axis, by this factor
APART = 0.06  # share of the axis that four characters need; of closer values only one is written
SIGNS = 36  # characters of all choices together; beyond this the texts are turned
MARKERS = "osD^vP*h"
DASHES = ("-", "--", "-.", ":", (0, (8, 2)), (0, (3, 1, 1, 1)))
LIGHTEST = 0.55  # share of white in the colour of the last series
NARROW = 0.06  # of the largest value: least span of an axis, so that round-off does not look like a change
MARGIN = 0.08
LEGEND_COLUMNS = 4  # at most
LEGEND_SIGNS, KEY_SIGNS = 165, 9  # characters per line of the legend, and of a key without its text

Item = TypeVar("Item")


@dataclass(frozen=True)
class Scale:
    """Positions of a parameter's values on an axis: numbers at their value, choices one after the other.

    Attributes
    ----------
    parameter : str
        Dotted path.
    values : list
        All values, in order.
    named : dict
        The campaign's short names of parameters.
    """

    parameter: str
    values: list[Any]
    named: dict[str, str]

    @property
    def numeric(self) -> bool:
        """Whether all values are numbers."""
        return all(is_number(value) for value in self.values)

    def place(self, value: Any) -> float:
        """Return the position of a value on the axis."""
        return float(value) if self.numeric else float([key(other) for other in self.values].index(key(value)))

    def label(self, axes: Any) -> None:
        """Set scale, ticks and label of the x axis."""
        places = [self.place(value) for value in self.values]
        texts = [shown(value) for value in self.values]
        even = np.array(places)
        if self.numeric and is_logarithmic(places):
            axes.set_xscale("log")
            even = np.log(even)
        turned = not self.numeric and sum(map(len, texts)) > SIGNS
        kept = apart(even, texts) if self.numeric else list(range(len(places)))
        axes.xaxis.set_minor_locator(NullLocator())
        style = {"rotation": 25, "ha": "right"} if turned else {}
        axes.set_xticks([places[k] for k in kept], [texts[k] for k in kept], parse_math=False, **style)
        axes.set_xlabel(label(self.parameter, self.named), fontsize=8, parse_math=False)


def is_logarithmic(places: Sequence[float]) -> bool:
    """Return whether rising numbers lie more evenly on a logarithmic axis."""
    if len(places) < 3 or min(places) <= 0.0:
        return False
    gaps, ratios = np.diff(places), np.diff(np.log(places))
    return bool(ratios.min() / ratios.sum() > EVENER * gaps.min() / gaps.sum())


def apart(places: np.ndarray, words: Sequence[str]) -> list[int]:
    """Return the indices of rising places whose texts (`words`) fit without touching the previous text."""
    kept: list[int] = []
    room = APART * max(float(np.ptp(places)), 1e-300) / 4.0 if len(places) else 0.0
    for k, place in enumerate(places):
        if not kept or place - places[kept[-1]] >= room * (len(words[k]) + len(words[kept[-1]])) / 2.0:
            kept.append(k)
    return kept


def panel_figure(count: int, height: float, columns: int = COLUMNS) -> tuple[Figure, list[Any]]:
    """Return a figure with `count` axes in rows of `columns`; height: of a row (inches). Unused places stay empty."""
    across = min(count, columns)
    rows = -(-count // across)
    figure = Figure(figsize=(WIDTH, height * rows + 0.9), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.subplots(rows, across, squeeze=False).ravel()
    for axes in grid[count:]:
        axes.set_axis_off()
    for axes in grid[:count]:
        axes.tick_params(which="both", labelsize=8)
        axes.grid(color=FAINT, alpha=0.25, linewidth=0.5)
    return figure, list(grid[:count])


def spread(items: Sequence[Item], most: int) -> list[Item]:
    """Return at most `most` items, evenly spaced, with the first and the last."""
    if len(items) <= most:
        return list(items)
    return [items[k] for k in np.unique(np.linspace(0, len(items) - 1, most).round().astype(int))]


def shade(colour: str, k: int, count: int) -> str:
    """Return the colour of the k-th of `count` series, from the full colour to a lighter one."""
    return tint(colour, LIGHTEST * k / max(count - 1, 1))


def series_style(k: int) -> dict[str, Any]:
    """Return marker and dashes of the k-th series."""
    return {"marker": MARKERS[k % len(MARKERS)], "linestyle": DASHES[k % len(DASHES)]}


def span(axes: Any, values: Sequence[float]) -> None:
    """Set the limits of the y axis for these values, at least NARROW of the largest one apart."""
    finite = [value for value in values if np.isfinite(value)]
    if not finite:
        return
    low, high = min(finite), max(finite)
    least = NARROW * max(abs(low), abs(high)) or 1.0
    middle, half = (low + high) / 2.0, max(high - low, least) / 2.0 * (1.0 + 2.0 * MARGIN)
    axes.set_ylim(middle - half, middle + half)
    axes.ticklabel_format(axis="y", useOffset=False)


def legend(figure: Figure, handles: Sequence[Any]) -> None:
    """Draw the legend under the figure, with texts taken literally."""
    longest = max(len(str(handle.get_label())) for handle in handles)
    fitting = max(LEGEND_SIGNS // (longest + KEY_SIGNS), 1)
    drawn = figure.legend(
        handles=list(handles),
        loc="outside lower center",
        ncols=min(len(handles), LEGEND_COLUMNS, fitting),
        fontsize=8,
        frameon=False,
        handlelength=3.2,
    )
    for text in drawn.get_texts():
        text.set_parse_math(False)
