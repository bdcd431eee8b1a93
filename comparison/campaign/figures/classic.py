"""The classic iteration for friction against its own parameters: its value, and its number of programmes."""

from collections.abc import Iterator, Sequence
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from comparison.campaign.figures import shared_axes
from comparison.campaign.figures.shared_axes import SERIES, Scale, series_style, shade
from comparison.campaign.parameter_labels import CLASSIC, quantity
from comparison.campaign.row_groups import Line, SweepRows, lines
from comparison.campaign.row_values import Row, over_weight, units_of
from comparison.figures import INK, LIMIT_ANALYSIS
from la_core.text_table import exists

SCENES = 3  # in a figure, one row for each
HEIGHT = 3.3  # inches
CONVERGED = "solved"


def classic_figures(sweeps: Sequence[SweepRows]) -> Iterator[tuple[Figure, str]]:
    """Yield a figure for every parameter of the classic iteration, with the parameter."""
    for kind in dict.fromkeys(tuple(sweep.parameters) for sweep in sweeps):
        for parameter in (name for name in kind if name.startswith(CLASSIC)):
            group = [sweep for sweep in sweeps if tuple(sweep.parameters) == kind and _ran(sweep.rows)]
            for k in range(0, len(group), SCENES):
                yield _figure(parameter, group[k : k + SCENES]), parameter


def _ran(rows: list[Row]) -> bool:
    return any(row.get("classic_status") is not None for row in rows)


def _figure(parameter: str, group: list[SweepRows]) -> Figure:
    figure, axes = shared_axes.panel_figure(2 * len(group), HEIGHT, columns=2)
    names = list(dict.fromkeys(line.words for sweep in group for line in lines(sweep, parameter)))
    drawn = shared_axes.spread(names, SERIES)
    for value, count, sweep in zip(axes[::2], axes[1::2], group, strict=True):
        scale = Scale(parameter, sweep.values[parameter], sweep.named)
        chosen = [line for line in lines(sweep, parameter) if line.words in drawn]
        values = _references(value, chosen, scale)
        for line in chosen:
            k = drawn.index(line.words)
            values += _draw(value, line, scale, k, len(drawn), [over_weight(row, "classic") for row in line.rows])
            _draw(count, line, scale, k, len(drawn), [row.get("classic_iterations") for row in line.rows])
            _mark_lost(value, line, scale)
        shared_axes.span(value, values)
        count.set_ylim(bottom=0.0)
        count.yaxis.set_major_locator(MaxNLocator(integer=True))
        value.set_ylabel(quantity(next(iter(units_of(sweep.rows)), None)), fontsize=8)
        count.set_ylabel("programmes solved", fontsize=8)
        for place in (value, count):
            scale.label(place)
            place.set_title(sweep.scene, fontsize=9, parse_math=False)
    rows = [row for sweep in group for line in lines(sweep, parameter) if line.words in drawn for row in line.rows]
    shared_axes.legend(figure, _handles(drawn, rows))
    return figure


def _references(axes: Any, chosen: list[Line], scale: Scale) -> list[float]:
    """Draw the associated least and the Coulomb prediction of each line's cases; returns the drawn values."""
    drawn: list[float] = []
    for line in chosen:
        place = [scale.place(row[scale.parameter]) for row in line.rows]
        for name, dash in (("least", ":"), ("coulomb", "-")):
            values = [over_weight(row, name) for row in line.rows]
            curve = [float("nan") if value is None else value for value in values]
            axes.plot(place, curve, color=INK, linewidth=1.1, linestyle=dash, zorder=1)
            drawn += [value for value in values if value is not None]
    return drawn


def _draw(axes: Any, line: Line, scale: Scale, k: int, count: int, values: list[Any]) -> list[float]:
    """Draw a line through the values, with filled marks where the iteration converged; returns the drawn values."""
    existing = [(scale.place(row[scale.parameter]), value, row) for row, value in zip(line.rows, values, strict=True) if exists(value)]
    style, colour = series_style(k), shade(LIMIT_ANALYSIS, k, count)
    axes.plot([x for x, _, _ in existing], [y for _, y, _ in existing], color=colour, linestyle=style["linestyle"], linewidth=1.2, zorder=3)
    for x, y, row in existing:
        face = colour if row.get("classic_status") == CONVERGED else "white"
        axes.plot(
            [x], [y], marker=style["marker"], markersize=max(10.0 - 1.7 * k, 3.5), markerfacecolor=face, markeredgecolor=INK, zorder=4
        )
    return [float(y) for _, y, _ in existing]


def _mark_lost(axes: Any, line: Line, scale: Scale) -> None:
    """Draw a cross at the bottom of the axes for every run without a value."""
    lost = [scale.place(row[scale.parameter]) for row in line.rows if row.get("classic_status") and not exists(row.get("classic"))]
    axes.plot(lost, [0.04] * len(lost), "x", transform=axes.get_xaxis_transform(), color=INK, markersize=7, zorder=5)


def _handles(names: list[str], rows: list[Row]) -> list[Line2D]:
    """Return the legend entries of the series, and of the marks that their cases have."""
    count, is_lost = len(names), [not exists(row.get("classic")) for row in rows if row.get("classic_status")]
    is_open = [exists(row.get("classic")) and row.get("classic_status") != CONVERGED for row in rows]
    hollow: dict[str, Any] = {"linestyle": "none", "markeredgecolor": INK, "color": "white"}
    series = [
        Line2D([], [], color=shade(LIMIT_ANALYSIS, k, count), markersize=6, label=name or "classic iteration", **series_style(k))
        for k, name in enumerate(names)
    ]
    not_converged = Line2D([], [], marker="o", label="not converged", **hollow)
    no_value = Line2D([], [], linestyle="none", marker="x", color=INK, label="no value: not converged, or no equilibrium")
    return [
        *series,
        Line2D([], [], color=INK, linewidth=1.1, linestyle="-", label="Coulomb prediction, elastic joints"),
        Line2D([], [], color=INK, linewidth=1.1, linestyle=":", label="associated"),
        *([not_converged] if any(is_open) else []),
        *([no_value] if any(is_lost) else []),
    ]
