"""What the figures of a campaign share: panels, axes along a parameter, styles of series, and how many of them are drawn."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from comparison.campaign.parameter_labels import label, shown
from comparison.campaign.row_groups import is_number, key
from comparison.figures import FAINT

WIDTH = 11.0  # inches, as in the other figures of the report
COLUMNS = 3  # of panels
EVENER = 1.5  # times that the nearest values must be farther apart, of the whole, on a logarithmic axis for it to be taken
APART = 0.06  # of the axis for each four signs: values nearer than this are not both written
SIGNS = 36  # of all choices together from which on they are turned
MARKERS = "osD^vP*h"
DASHES = ("-", "--", "-.", ":", (0, (8, 2)), (0, (3, 1, 1, 1)))
LIGHTEST = 0.55  # share of white in the colour of the last series
NARROW = 0.06  # of the largest value: axes of a quantity that hardly changes span this much, so that round-off looks like none
MARGIN = 0.08
LEGEND_SIGNS, KEY_SIGNS = 165, 9  # that fit into a line of the legend, and that a key takes besides its words

Item = TypeVar("Item")


@dataclass(frozen=True)
class Scale:
    """Where values of a parameter lie on an axis: numbers at themselves, choices one after the other."""

    parameter: str
    values: list[Any]
    named: dict[str, str]

    @property
    def numeric(self) -> bool:
        """Whether all values are numbers."""
        return all(is_number(value) for value in self.values)

    def place(self, value: Any) -> float:
        """Where on the axis a value lies."""
        return float(value) if self.numeric else float([key(own) for own in self.values].index(key(value)))

    def label(self, axes: Any) -> None:
        """Scale, ticks and label of the x axis."""
        places = [self.place(value) for value in self.values]
        words = [shown(value) for value in self.values]
        even = np.array(places)
        if self.numeric and is_logarithmic(places):
            axes.set_xscale("log")
            even = np.log(even)
        turned = not self.numeric and sum(map(len, words)) > SIGNS
        kept = apart(even, words) if self.numeric else list(range(len(places)))
        axes.xaxis.set_minor_locator(NullLocator())
        style = {"rotation": 25, "ha": "right"} if turned else {}
        axes.set_xticks([places[k] for k in kept], [words[k] for k in kept], parse_math=False, **style)
        axes.set_xlabel(label(self.parameter, self.named), fontsize=8, parse_math=False)


def is_logarithmic(places: Sequence[float]) -> bool:
    """Whether rising numbers lie more evenly on a logarithmic axis."""
    if len(places) < 3 or min(places) <= 0.0:
        return False
    gaps, ratios = np.diff(places), np.diff(np.log(places))
    return bool(ratios.min() / ratios.sum() > EVENER * gaps.min() / gaps.sum())


def apart(places: np.ndarray, words: Sequence[str]) -> list[int]:
    """Which of rising places can have their words under them without touching the ones before."""
    kept: list[int] = []
    room = APART * max(float(np.ptp(places)), 1e-300) / 4.0
    for k, place in enumerate(places):
        if not kept or place - places[kept[-1]] >= room * (len(words[k]) + len(words[kept[-1]])) / 2.0:
            kept.append(k)
    return kept


def panel_figure(count: int, height: float, columns: int = COLUMNS) -> tuple[Figure, list[Any]]:
    """A figure with so many axes, in rows; `height` inches for each row. Places left over stay empty."""
    across = min(count, columns)
    rows = -(-count // across)
    figure = Figure(figsize=(WIDTH, height * rows + 0.9), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.subplots(rows, across, squeeze=False).ravel()
    for axes in grid[count:]:
        axes.set_axis_off()
    for axes in grid[:count]:
        axes.tick_params(labelsize=8)
        axes.grid(color=FAINT, alpha=0.25, linewidth=0.5)
    return figure, list(grid[:count])


def spread(items: Sequence[Item], most: int) -> list[Item]:
    """At most so many of the items, evenly spaced, the first and the last among them."""
    if len(items) <= most:
        return list(items)
    return [items[k] for k in np.unique(np.linspace(0, len(items) - 1, most).round().astype(int))]


def shade(colour: str, k: int, count: int) -> str:
    """Colour of the k-th of so many series, from the full one to a lighter one."""
    white = LIGHTEST * k / max(count - 1, 1)
    red, green, blue = ((1.0 - white) * part + white for part in to_rgb(colour))
    return to_hex((red, green, blue))


def series_style(k: int) -> dict[str, Any]:
    """Marker and dashes of the k-th series."""
    return {"marker": MARKERS[k % len(MARKERS)], "linestyle": DASHES[k % len(DASHES)]}


def span(axes: Any, values: Sequence[float]) -> None:
    """Limits of the y axis for these values; what hardly changes looks so."""
    finite = [value for value in values if np.isfinite(value)]
    if not finite:
        return
    low, high = min(finite), max(finite)
    least = NARROW * max(abs(low), abs(high)) or 1.0
    middle, half = (low + high) / 2.0, max(high - low, least) / 2.0 * (1.0 + 2.0 * MARGIN)
    axes.set_ylim(middle - half, middle + half)
    axes.ticklabel_format(axis="y", useOffset=False)


def legend(figure: Figure, handles: Sequence[Any], columns: int = 4) -> None:
    """Keys under the figure, their texts as they are."""
    longest = max(len(str(handle.get_label())) for handle in handles)
    fitting = max(LEGEND_SIGNS // (longest + KEY_SIGNS), 1)
    made = figure.legend(
        handles=list(handles),
        loc="outside lower center",
        ncols=min(len(handles), columns, fitting),
        fontsize=8,
        frameon=False,
        handlelength=3.2,
    )
    for text in made.get_texts():
        text.set_parse_math(False)
