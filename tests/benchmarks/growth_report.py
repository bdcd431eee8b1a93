"""How time and memory grow: power laws fitted to measurements, their tables in Markdown and their figure."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from comparison.figures.canvas import FAINT, INK, method_colour
from comparison.studies.figure_of_cost import MARKERS
from la_core.text_table import number_text

LARGER = 0.1  # of the largest size: sizes from there on are fitted
FEWEST = 3  # sizes of a fit: a line through two has no error
DIMENSIONS = {"plane": {"linestyle": "-"}, "3D": {"linestyle": "--", "markerfacecolor": "white"}}


@dataclass(frozen=True)
class Growth:
    """values = factor * blocks ** exponent; error: standard error of the exponent; sizes: fitted."""

    exponent: float
    error: float
    factor: float
    sizes: tuple[int, ...]

    def __str__(self) -> str:
        return f"{self.exponent:.2f} ± {self.error:.2f}"


def fit(blocks: Sequence[int], values: Sequence[float]) -> Growth | None:
    """Least squares in logarithms over the larger sizes, at least three of them; None where there are fewer."""
    order = np.argsort(blocks)
    sizes, measured = np.array(blocks)[order], np.array(values, dtype=float)[order]
    first = min(int(np.searchsorted(sizes, LARGER * sizes[-1])), len(sizes) - FEWEST) if len(sizes) >= FEWEST else len(sizes)
    sizes, measured = sizes[first:], measured[first:]
    if len(sizes) < FEWEST or np.any(measured <= 0.0):
        return None
    x, y = np.log(sizes), np.log(measured)
    x0 = x - x.mean()
    slope = float(x0 @ y / (x0 @ x0))
    left = y - y.mean() - slope * x0
    error = float(np.sqrt(left @ left / (len(x) - 2) / (x0 @ x0)))
    return Growth(slope, error, float(np.exp(y.mean() - slope * x.mean())), tuple(int(size) for size in sizes))


def table(heads: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A Markdown table; numbers with two significant digits, so that a second run differs little."""
    lines = [heads, ["---"] * len(heads), *([_cell(value) for value in row] for row in rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _cell(value: object) -> str:
    if isinstance(value, float):
        return number_text(value, 2)
    return "–" if value is None else f"{value:,}" if isinstance(value, int) else str(value)


def exponents(series: dict[tuple[str, str], list[dict[str, Any]]], quantities: Sequence[str]) -> str:
    """Exponents of every quantity by method and dimension."""
    rows = []
    for (method, dimension), measured in series.items():
        found = [
            fit([one["blocks"] for one in measured], [one[quantity] for one in measured]) if quantity in measured[0] else None
            for quantity in quantities
        ]
        sizes = next((growth.sizes for growth in found if growth), ())
        rows.append([method, dimension, f"{sizes[0]:,} to {sizes[-1]:,}" if sizes else "–", *found])
    return table(["method", "model", "blocks fitted", *quantities], rows)


def growth_figure(panels: dict[str, tuple[str, dict[tuple[str, str], list[dict[str, Any]]]]]) -> Figure:
    """Panels, by the label of their ordinate: the quantity and its series by method and dimension, with fitted lines."""
    figure = Figure(figsize=(5.2 * len(panels), 6.0), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, (label, (quantity, series)) in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels.items(), strict=True):
        axes.set(xscale="log", yscale="log", xlabel="blocks N (-)", ylabel=label)
        axes.grid(True, which="major", color=FAINT, linewidth=0.4, alpha=0.6)
        for (method, dimension), measured in series.items():
            blocks, values = ([one[name] for one in measured] for name in ("blocks", quantity))
            growth = fit(blocks, values)
            words = f"{method}, {dimension}: " + (rf"$N^{{{growth.exponent:.2f} \pm {growth.error:.2f}}}$" if growth else "too few")
            colour = method_colour(method)
            look = {"marker": MARKERS[method], "color": colour, "markersize": 6} | DIMENSIONS[dimension]
            axes.plot(blocks, values, linewidth=0.8, label=words, **look)
            if growth:
                ends = np.array([growth.sizes[0], growth.sizes[-1]], dtype=float)
                axes.plot(ends, growth.factor * ends**growth.exponent, color=INK, linewidth=0.7, linestyle=":")
        if series:
            axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2, frameon=False)
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter(StrMethodFormatter("{x:,.0f}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.margins(y=0.06)
    figure.suptitle("Running-bond walls over a settling third; dotted: power laws fitted to the larger sizes", fontsize=10)
    return figure
