"""A quantity of both methods against a varied parameter: one panel per scene, one line per value of the other parameters."""

import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.transforms import ScaledTranslation

from comparison.campaign.figures import shared_axes
from comparison.campaign.figures.shared_axes import OUTSIDE, SERIES, Scale, series_style, shade
from comparison.campaign.parameter_labels import quantity
from comparison.campaign.row_groups import Line, SweepRows, lines, longest, slices
from comparison.campaign.row_values import LIMIT, Row, bounds, interval, mechanism_name, of_mechanism, over_weight, prediction, units_of
from comparison.figures import INK, LIMIT_ANALYSIS, YADE, tint
from la_core.text_table import exists

PANELS = 9  # in a figure; further panels go to further figures
MOST_PANELS = 18  # over one parameter; a larger number is thinned out evenly
HEIGHT = 3.1  # inches, of a row of panels
TITLE_WIDTH = 55  # characters
DODGE = 3.0  # pt between the intervals of two lines


@dataclass(frozen=True)
class Drawn:
    """A drawn figure.

    Attributes
    ----------
    figure : Figure
        The figure.
    parameter : str
        Dotted path of its parameter.
    left_out : str
        Sentences on omitted panels and series; "" without any.
    """

    figure: Figure
    parameter: str
    left_out: str


def reaction_figures(sweeps: Sequence[SweepRows]) -> Iterator[Drawn]:
    """Yield figures of reaction over weight against every parameter; bounds and interval are bands if a panel has one line."""
    of_one_unit = [part for sweep in sweeps for part in _by_unit(sweep)]
    for parameter, group, left_out in _groups(of_one_unit, _has_reaction):
        yield _figure(parameter, group, left_out, _draw_reactions, "", reactions=True)


def participation_figures(sweeps: Sequence[SweepRows]) -> Iterator[Drawn]:
    """Yield figures of the participation index against every parameter."""
    for parameter, group, left_out in _groups(sweeps, _has_participation):
        yield _figure(parameter, group, left_out, _draw_participation, "participation index (-)", reactions=False)


def _by_unit(sweep: SweepRows) -> list[SweepRows]:
    """Return the sweep in parts whose values have one unit: a force over W and a moment over W share no axis. Failed cases are in all."""
    parts = [replace(sweep, rows=[row for row in sweep.rows if row.get("unit") in (None, unit)]) for unit in units_of(sweep.rows)]
    return parts or [sweep]


def _has_reaction(row: Row) -> bool:
    return any(over_weight(row, name) is not None for name in (prediction(row), "yade"))


def _has_participation(row: Row) -> bool:
    return any(exists(of_mechanism(row, method, "participation")) for method in (LIMIT, "yade"))


def _groups(sweeps: Sequence[SweepRows], has: Callable[[Row], bool]) -> Iterator[tuple[str, list[SweepRows], str]]:
    """Yield the panels of each figure: parameter, sweeps with the same parameters, and a sentence on omitted panels.

    The other parameter with most values gives the lines. Further parameters are fixed, with one panel for each combination of values.
    has: whether a case has a value to draw; a panel needs at least one such case.
    """
    kinds = dict.fromkeys(tuple(sweep.parameters) for sweep in sweeps)
    for kind in kinds:
        alike = [sweep for sweep in sweeps if tuple(sweep.parameters) == kind]
        for parameter in kind:
            group = []
            for sweep in alike:
                others = [name for name in longest(sweep) if name != parameter]
                group += slices(sweep, (parameter, *others[:1])) if len(sweep.values[parameter]) > 1 else []
            group = [panel for panel in group if any(map(has, panel.rows))]
            drawn = shared_axes.spread(group, MOST_PANELS)
            left_out = f"{len(drawn)} of {len(group)} panels are drawn." if len(drawn) < len(group) else ""
            for k in range(0, len(drawn), PANELS):
                yield parameter, drawn[k : k + PANELS], left_out


def _figure(parameter: str, group: list[SweepRows], left_out: str, draw: Any, words: str, reactions: bool) -> Drawn:
    """Draw panels of one parameter with one legend; series with the same text look the same in all panels."""
    figure, axes = shared_axes.panel_figure(len(group), HEIGHT)
    names = list(dict.fromkeys(line.words for sweep in group for line in lines(sweep, parameter)))
    drawn = shared_axes.spread(names, SERIES)
    for place, sweep in zip(axes, group, strict=True):
        scale = Scale(parameter, sweep.values[parameter], sweep.named)
        chosen = [line for line in lines(sweep, parameter) if line.words in drawn]
        draw(place, scale, [(line, drawn.index(line.words), len(drawn)) for line in chosen])
        scale.label(place)
        place.set_title(textwrap.fill(sweep.title, TITLE_WIDTH), fontsize=9, parse_math=False)
        place.set_ylabel(words or quantity(next(iter(units_of(sweep.rows)), None)), fontsize=8)
    shown = [line for sweep in group for line in lines(sweep, parameter) if line.words in drawn]
    shared_axes.legend(figure, [*_method_handles(shown, len(drawn) == 1 and scale.numeric, reactions), *_series_handles(drawn)])
    series = f"{len(drawn)} of {len(names)} series are drawn." if len(drawn) < len(names) else ""
    return Drawn(figure, parameter, f"{left_out} {series}".strip())


def _draw_reactions(axes: Any, scale: Scale, chosen: list[tuple[Line, int, int]]) -> None:
    """Draw the prediction as lines and YADE as larger marks with its uncertainty; bands only for a single line."""
    drawn: list[float] = []
    for line, k, count in chosen:
        place = [scale.place(row[scale.parameter]) for row in line.rows]
        predicted = _values(line.rows, [prediction(row) for row in line.rows])
        yade, uncertainty = (_values(line.rows, [name] * len(place)) for name in ("yade", "yade_uncertainty"))
        low, high = np.array([interval(row) for row in line.rows]).T
        if count == 1 and scale.numeric:
            _draw_bands(axes, line.rows, place, low, high)
            _draw_switches(axes, scale, line.rows)
        else:
            _draw_intervals(axes, place, low, high, k, count)
        _draw_methods(axes, scale, place, predicted, yade, k, count)
        axes.vlines(place, yade - uncertainty, yade + uncertainty, color=INK, linewidth=0.9, zorder=6)
        wrong = [row.get("verdict") == "disagree" for row in line.rows]
        axes.plot(np.array(place)[wrong], yade[wrong], "x", color=INK, markersize=10, markeredgewidth=1.3, zorder=7)
        drawn += [*predicted, *low, *high, *(yade - uncertainty), *(yade + uncertainty), *yade]
    shared_axes.span(axes, drawn)


def _draw_participation(axes: Any, scale: Scale, chosen: list[tuple[Line, int, int]]) -> None:
    drawn: list[float] = []
    for line, k, count in chosen:
        place = [scale.place(row[scale.parameter]) for row in line.rows]
        limit, yade = (_measure(line.rows, method, "participation") for method in (LIMIT, "yade"))
        _draw_methods(axes, scale, place, limit, yade, k, count)
        drawn += [*limit, *yade]
    greatest = np.nanmax(drawn) if np.isfinite(drawn).any() else 1.0  # the index is a share, so the axis begins at 0
    axes.set_ylim(-0.03 * greatest, 1.1 * greatest)


def _draw_methods(axes: Any, scale: Scale, place: list[float], limit: np.ndarray, yade: np.ndarray, k: int, count: int) -> None:
    """Draw limit analysis as a line with small marks, YADE as larger marks with a thin line; no lines between choices."""
    style = series_style(k) if scale.numeric else series_style(k) | {"linestyle": "none"}
    small = {"markersize": 3.5 if scale.numeric else 5.0, "markeredgewidth": 0.0, "linewidth": 1.5}
    large = {"markersize": 6.5, "markeredgewidth": 0.6, "markeredgecolor": INK, "linewidth": 0.8}
    axes.plot(place, yade, color=shade(YADE, k, count), zorder=4, **style, **large)
    axes.plot(place, limit, color=shade(LIMIT_ANALYSIS, k, count), zorder=5, **style, **small)


def _draw_bands(axes: Any, rows: list[Row], place: list[float], low: np.ndarray, high: np.ndarray) -> None:
    """Draw R_min to R_max pale, infinite without a bound, and the mechanism's interval darker."""
    bottom, top, low, high = np.clip([*np.array([bounds(row) for row in rows]).T, low, high], -OUTSIDE, OUTSIDE)
    axes.fill_between(place, bottom, top, color=tint(LIMIT_ANALYSIS), alpha=0.22, linewidth=0.0, zorder=0)
    axes.fill_between(place, low, high, color=tint(LIMIT_ANALYSIS), alpha=0.6, linewidth=0.0, zorder=1)


def _draw_intervals(axes: Any, place: list[float], low: np.ndarray, high: np.ndarray, k: int, count: int) -> None:
    """Draw the intervals of a line, slightly beside its own marks and those of other lines."""
    beside = ScaledTranslation(DODGE * (k - (count - 1) / 2.0) / 72.0, 0.0, axes.figure.dpi_scale_trans)
    style = {"color": shade(LIMIT_ANALYSIS, k, count), "linewidth": 1.1, "alpha": 0.7, "zorder": 2}
    for x, bottom, top in zip(place, *np.clip([low, high], -OUTSIDE, OUTSIDE), strict=True):
        axes.plot([x, x], [bottom, top], transform=axes.transData + beside, **style)


def _draw_switches(axes: Any, scale: Scale, rows: list[Row]) -> None:
    """Draw a dotted line wherever limit analysis' mechanism changes between neighbouring values of the parameter."""
    for first, second in _switches(rows):
        middle = (scale.place(first[scale.parameter]) + scale.place(second[scale.parameter])) / 2.0
        axes.axvline(middle, color=INK, linewidth=0.9, linestyle=":", zorder=2)


def _switches(rows: list[Row]) -> list[tuple[Row, Row]]:
    """Return the pairs of neighbouring cases between which limit analysis' mechanism changes."""
    names = [mechanism_name(row, LIMIT) for row in rows]
    return [pair for pair, (one, other) in zip(pairwise(rows), pairwise(names), strict=True) if None not in (one, other) and one != other]


def _values(rows: list[Row], names: list[str]) -> np.ndarray:
    """Return reactions over weight, NaN where undefined."""
    return np.array([over_weight(row, name) for row, name in zip(rows, names, strict=True)], dtype=float)


def _measure(rows: list[Row], method: str, name: str) -> np.ndarray:
    """Return a measure of the method's mechanisms, NaN where undefined."""
    return np.array([of_mechanism(row, method, name) for row in rows], dtype=float)


def _method_handles(shown: list[Line], bands: bool, reactions: bool) -> list[Any]:
    """Return the legend entries of the lines, bands and marks of all panels."""
    rows = [row for line in shown for row in line.rows]
    words = "limit analysis" if not reactions else "limit analysis' prediction"
    handles: list[Any] = [Line2D([], [], color=LIMIT_ANALYSIS, marker="o", markersize=3.5, label=words)]
    mark: dict[str, Any] = {"marker": "o", "markersize": 6.5, "markeredgecolor": INK, "markeredgewidth": 0.6, "linewidth": 0.8}
    if any(row.get("yade") is not None for row in rows):
        handles.append(Line2D([], [], color=YADE, label="YADE", **mark))
    if not reactions:
        return handles
    if not bands:
        handles.append(Line2D([], [], color=LIMIT_ANALYSIS, linewidth=1.1, alpha=0.7, marker="|", label="interval of the mechanism"))
    else:
        handles.append(Patch(facecolor=tint(LIMIT_ANALYSIS), alpha=0.6, label="interval of the mechanism"))
        handles.append(Patch(facecolor=tint(LIMIT_ANALYSIS), alpha=0.22, label="bounds (associated)"))
        if any(_switches(line.rows) for line in shown):
            handles.append(Line2D([], [], color=INK, linewidth=0.9, linestyle=":", label="limit analysis' mechanism changes"))
    if any(row.get("verdict") == "disagree" for row in rows):
        handles.append(Line2D([], [], color=INK, linestyle="none", marker="x", markersize=9, label="disagree"))
    return handles


def _series_handles(names: list[str]) -> list[Line2D]:
    if names == [""]:
        return []
    count = len(names)
    return [Line2D([], [], color=shade(INK, k, count), markersize=5, label=name, **series_style(k)) for k, name in enumerate(names)]
