"""Figure of a sensitivity study: the classic iteration's value and number of programmes against its relaxation."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from comparison.figures import FAINT, INK, LIMIT_ANALYSIS, own_style, tint
from comparison.studies.sensitivity import Sensitivity, Trial
from la_core.limit import Status

MARKERS = "osD^vP*h"
LINES = ("-", "--", "-.", ":")
REFERENCE_LINES = ((0, (8, 2)), (0, (2, 2)), (0, (8, 2, 2, 2)), (0, (1, 1)))
LIGHTEST = 0.55  # share of white in the colour of the largest slope
DODGE = 0.12  # of the step between relaxations: lines that coincide stay apart


@own_style()
def sensitivity_figure(result: Sensitivity, references: Mapping[str, tuple[float, int | None]] | None = None) -> Figure:
    """Draw the reaction over the weight, or the multiplier, on the left and the number of programmes on the right.

    Each slope is a line. A hollow marker with a range is a run that did not converge: the range is that of its last ten values. A
    cross is a run that found no equilibrium.

    Parameters
    ----------
    result : Sensitivity
        The study.
    references : mapping of str to (float, int or None), optional
        Value (N, N m or multiplier) and number of programmes of other methods, by name; drawn as horizontal lines. The number is None
        for a method that solves none.
    """
    figure = Figure(figsize=(11.0, 5.0), layout="constrained")
    FigureCanvasAgg(figure)
    value, count = figure.subplots(1, 2)
    slopes = sorted({trial.slope for trial in result.trials})
    relaxations = sorted({trial.relaxation for trial in result.trials})
    step = min(np.diff(relaxations), default=0.2)
    for k, slope in enumerate(slopes):
        trials = sorted((trial for trial in result.trials if trial.slope == slope), key=lambda trial: trial.relaxation)
        shift = DODGE * step * (k - (len(slopes) - 1) / 2.0)
        _draw_slope(value, trials, shift, [trial.last / result.divisor for trial in trials], _style(k, len(slopes)))
        _draw_ranges(value, trials, shift, result.divisor)
        _draw_slope(count, trials, shift, [float(trial.iterations) for trial in trials], _style(k, len(slopes)))
    for k, (reference, programmes) in enumerate((references or {}).values()):
        style = {"color": INK, "linewidth": 1.2, "linestyle": REFERENCE_LINES[k % len(REFERENCE_LINES)], "zorder": 1}
        value.axhline(reference / result.divisor, **style)
        if programmes is not None:
            count.axhline(programmes, **style)
    _finish(value, count, result, relaxations)
    handles = [*_slope_handles(slopes), *_reference_handles(references or {}), *_status_handles(result)]
    figure.legend(handles=handles, loc="outside lower center", ncols=4, fontsize=8, frameon=False, handlelength=3.5)
    return figure


def _style(k: int, count: int) -> dict[str, Any]:
    """Return the line style of the k-th of `count` slopes: from dark to light, with different markers and dashes."""
    colour = tint(LIMIT_ANALYSIS, LIGHTEST * k / max(count - 1, 1))
    return {
        "color": colour,
        "marker": MARKERS[k % len(MARKERS)],
        "linestyle": LINES[k % len(LINES)],
        "markeredgecolor": INK,
    }


def _draw_slope(axes: Any, trials: list[Trial], shift: float, values: list[float], style: dict[str, Any]) -> None:
    """Draw a line through the converged runs of one slope, and a marker of its status for each run."""
    place = np.array([trial.relaxation for trial in trials]) + shift
    joined = np.where([trial.status is Status.SOLVED for trial in trials], values, np.nan)
    axes.plot(place, joined, color=style["color"], linestyle=style["linestyle"], linewidth=1.2, zorder=3)
    mark = {"linestyle": "none", "marker": style["marker"], "markersize": 7.0, "markeredgewidth": 0.8}
    for x, y, trial in zip(place, values, trials, strict=True):
        face = style["color"] if trial.status is Status.SOLVED else "white"
        axes.plot([x], [y], markerfacecolor=face, markeredgecolor=INK, zorder=4, **mark)
        if trial.status not in (Status.SOLVED, Status.INACCURATE):
            axes.plot([x], [y], marker="x", markersize=11, markeredgecolor=INK, markeredgewidth=0.9, zorder=5)


def _draw_ranges(axes: Any, trials: list[Trial], shift: float, divisor: float) -> None:
    """Draw the range of the last ten values of runs that did not converge."""
    for trial in trials:
        if trial.status is Status.INACCURATE:
            x = trial.relaxation + shift
            axes.plot([x, x], [trial.lowest / divisor, trial.highest / divisor], color=INK, linewidth=1.0, marker="_", zorder=3)


def _finish(value: Any, count: Any, result: Sensitivity, relaxations: list[float]) -> None:
    """Set labels with units, and titles."""
    rotation = result.unit == "N m"
    names = {"multiplier": "collapse multiplier"}
    value.set_ylabel(names.get(result.quantity, f"reaction over weight, R / W{' (m)' if rotation else ''}"))
    count.set_ylabel("programmes solved")
    count.set_ylim(bottom=0.0)
    for axes in (value, count):
        axes.set_xlabel("relaxation b, share of the new normal forces (slopes drawn side by side)")
        axes.set_xticks(relaxations)
        axes.tick_params(labelsize=8)
        axes.grid(color=FAINT, alpha=0.25, linewidth=0.5)
        axes.margins(y=0.1)
    shared = result.parameters
    settings = f"cohesion {shared.cohesion:g} and tolerance {shared.tolerance:g} of the mean block weight"
    value.set_title(f"{result.scene}: {settings}", fontsize=9, loc="left", parse_math=False)
    count.set_title(f"at most {shared.iterations} programmes", fontsize=9, loc="left")


def _slope_handles(slopes: list[float]) -> list[Line2D]:
    styles = [_style(k, len(slopes)) for k in range(len(slopes))]
    return [Line2D([], [], label=f"classic, slope a = {slope:g}", **style) for slope, style in zip(slopes, styles, strict=True)]


def _reference_handles(references: Mapping[str, tuple[float, int | None]]) -> list[Line2D]:
    dashes = [REFERENCE_LINES[k % len(REFERENCE_LINES)] for k in range(len(references))]
    return [Line2D([], [], color=INK, linewidth=1.2, linestyle=dash, label=name) for name, dash in zip(references, dashes, strict=True)]


def _status_handles(result: Sensitivity) -> list[Line2D]:
    """Return legend entries of the statuses without convergence that occur in this study."""
    hollow: dict[str, Any] = {"linestyle": "none", "markerfacecolor": "white", "markeredgecolor": INK}
    handles = []
    statuses = {trial.status for trial in result.trials}
    if Status.INACCURATE in statuses:
        handles.append(Line2D([], [], marker="o", label="not converged, range of the last ten", **hollow))
    if statuses - {Status.SOLVED, Status.INACCURATE}:
        handles.append(Line2D([], [], marker="x", markersize=9, label="no equilibrium found: last value", **hollow))
    return handles
