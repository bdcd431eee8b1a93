"""YADE's reaction against limit analysis' prediction: one mark per case, on the 1:1 line where both agree."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import NullLocator

from comparison.campaign.figures import shared_axes
from comparison.campaign.figures.shared_axes import MARKERS, NARROW, OUTSIDE
from comparison.campaign.parameter_labels import quantity
from comparison.campaign.row_values import Row, bounds, compared_with, interval, over_weight, prediction, sweep_of
from comparison.figures import FAINT, INK, LIMIT_ANALYSIS, YADE, tint
from comparison.judge import FLOOR
from comparison.numbers import percent
from la_core.limit import Drive
from la_core.text_table import exists

BOUNDED = 60  # cases; the bounds of more cases would cover each other
FAINTLY = 1e-3  # of the largest reaction: below this a relative difference is meaningless
FAR = 0.5  # of the largest value: axes of a smaller spread do not include zero
MANY = 100  # cases; from here on marks are small
SIZE, SMALL = 6.5, 4.0  # pt
LINEAR = 1.0  # per cent: the scale of differences is linear up to here, logarithmic beyond
LEVELS = (1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0)  # per cent
PALE = tint(tint(tint(LIMIT_ANALYSIS)))  # bars that cover each other stay as pale as one
VERDICT_FACE = {"agree": INK, "inconclusive": "white", "disagree": "#d62728", "cannot stand": "#d62728"}


def prediction_figure(rows: Sequence[Row], unit: str) -> Figure | None:
    """Draw YADE over the prediction (left) and their difference (right); None unless a case has both.

    unit: of the reactions, empty for multipliers. Horizontal bars are the mechanism's interval and, pale, R_min to R_max; vertical bars
    are YADE's uncertainty.
    """
    both = [row for row in rows if exists(over_weight(row, compared_with(row))) and exists(over_weight(row, "yade"))]
    if not both:
        return None
    figure, (left, right) = shared_axes.panel_figure(2, 4.6)
    scenes = list(dict.fromkeys(sweep_of(row) for row in both))
    largest = max(abs(_value(row, name)) for row in both for name in (compared_with(row), "yade"))
    for row in both:
        style = _style(row, scenes, SIZE if len(both) < MANY else SMALL)
        _draw_bars(left, row, bounded=len(both) <= BOUNDED)
        left.plot([_value(row, compared_with(row))], [_value(row, "yade")], **style)
        if abs(_value(row, compared_with(row))) > FAINTLY * largest:
            _draw_difference(right, row, style)
    _finish(left, right, both, quantity(unit))
    shared_axes.legend(figure, [*_scene_handles(scenes), *_verdict_handles(both), *_bar_handles(both)])
    return figure


def _value(row: Row, name: str) -> float:
    value = over_weight(row, name)
    return value if value is not None else float("nan")


def _style(row: Row, scenes: list[str], size: float) -> dict[str, Any]:
    """Return the style of a case's mark: its shape by the scene, its face by the verdict."""
    marker = MARKERS[min(scenes.index(sweep_of(row)), len(MARKERS) - 1)]
    face = VERDICT_FACE.get(str(row.get("verdict")), FAINT)
    return {
        "marker": marker, "markersize": size, "markerfacecolor": face, "markeredgecolor": INK, "linestyle": "none",
        "zorder": 5 if row.get("verdict") == "agree" else 6,
    }  # fmt: skip


def _draw_bars(axes: Any, row: Row, bounded: bool) -> None:
    """Draw bounds and interval as horizontal bars, YADE's uncertainty as a vertical bar."""
    at, yade = _value(row, compared_with(row)), _value(row, "yade")
    if bounded:
        axes.plot(np.clip(bounds(row), -OUTSIDE, OUTSIDE), [yade, yade], color=PALE, linewidth=3.5, solid_capstyle="butt", zorder=1)
    style = {"linewidth": 1.6} if bounded else {"linewidth": 0.7, "alpha": 0.5}
    if compared_with(row) == prediction(row):  # the interval of a mechanism after a release is unknown
        axes.plot(np.clip(interval(row), -OUTSIDE, OUTSIDE), [yade, yade], color=LIMIT_ANALYSIS, zorder=2, **style)
    uncertainty = _value(row, "yade_uncertainty")
    axes.plot([at, at], [yade - uncertainty, yade + uncertainty], color=YADE, linewidth=1.8, zorder=4)


def _draw_difference(axes: Any, row: Row, style: dict[str, Any]) -> None:
    at = _value(row, compared_with(row))
    apart, wide = (100.0 * value / abs(at) for value in (_value(row, "yade") - at, _value(row, "yade_uncertainty")))
    axes.plot([at, at], [apart - wide, apart + wide], color=YADE, linewidth=1.8, zorder=4)
    axes.plot([at], [apart], **style)


def _finish(left: Any, right: Any, rows: list[Row], words: str) -> None:
    """Set the axes, and draw the lines of agreement and the tolerance without stated uncertainties."""
    low, high = _range(rows)
    room = 0.06 * (high - low)
    left.plot([low - room, high + room], [low - room, high + room], color=INK, linewidth=0.8, linestyle="--", zorder=2)
    left.set(xlim=(low - room, high + room), ylim=(low - room, high + room), aspect="equal")
    left.set_ylabel(f"YADE: {words}", fontsize=9)
    right.axhspan(-100.0 * FLOOR, 100.0 * FLOOR, color=FAINT, alpha=0.25, linewidth=0.0, zorder=0)
    right.axhline(0.0, color=INK, linewidth=0.8, linestyle="--", zorder=2)
    right.set_xlim(left.get_xlim())
    right.set_yscale("symlog", linthresh=LINEAR)
    highest = max(map(abs, right.get_ylim()))
    beyond = next((k for k, level in enumerate(LEVELS) if level >= 0.8 * highest), len(LEVELS) - 1)
    levels = LEVELS[: beyond + 1]
    right.set_ylim(-1.3 * levels[-1], 1.3 * levels[-1])
    right.set_yticks(
        [*(-level for level in levels), 0.0, *levels], [*(f"−{level:g}" for level in levels), "0", *(f"{level:g}" for level in levels)]
    )
    right.yaxis.set_minor_locator(NullLocator())
    right.set_ylabel("YADE minus prediction (% of the prediction)", fontsize=9)
    after = ", after a release where both agree on it" if any(compared_with(row) != prediction(row) for row in rows) else ""
    for axes in (left, right):
        axes.set_xlabel(f"limit analysis' prediction{after}: {words}", fontsize=9)


def _range(rows: list[Row]) -> tuple[float, float]:
    """Return the range of the axes: all values with YADE's uncertainty, and zero unless all are far from it."""
    ends = [_value(row, "yade") + sign * _value(row, "yade_uncertainty") for row in rows for sign in (-1.0, 1.0)]
    values = [value for value in (*ends, *(_value(row, name) for row in rows for name in (compared_with(row), "yade"))) if exists(value)]
    low, high = min(values), max(values)
    largest = max(abs(low), abs(high)) or 1.0
    if high - low >= FAR * largest:
        return min(low, 0.0), max(high, 0.0)
    wider = max(NARROW * largest - (high - low), 0.0) / 2.0
    return low - wider, high + wider


def _scene_handles(scenes: list[str]) -> list[Line2D]:
    named = scenes if len(scenes) <= len(MARKERS) else [*scenes[: len(MARKERS) - 1], f"{len(scenes) - len(MARKERS) + 1} other scenes"]
    style: dict[str, Any] = {"linestyle": "none", "markerfacecolor": FAINT, "markeredgecolor": INK}
    return [Line2D([], [], marker=marker, label=name, **style) for marker, name in zip(MARKERS, named, strict=False)]


def _verdict_handles(rows: list[Row]) -> list[Line2D]:
    present = {str(row.get("verdict")) for row in rows}
    style: dict[str, Any] = {"linestyle": "none", "marker": "o", "markeredgecolor": INK}
    return [Line2D([], [], markerfacecolor=face, label=word, **style) for word, face in VERDICT_FACE.items() if word in present]


def _bar_handles(rows: list[Row]) -> list[Any]:
    handles = [
        Line2D([], [], color=YADE, linewidth=1.8, label="YADE's uncertainty"),
        Line2D([], [], color=LIMIT_ANALYSIS, linewidth=1.6, label="interval of the mechanism"),
    ]
    if len(rows) <= BOUNDED:
        handles.append(Line2D([], [], color=PALE, linewidth=3.5, label=f"{Drive.YIELDING.symbol} to {Drive.PUSHING.symbol}"))
    return [*handles, Patch(facecolor=FAINT, alpha=0.25, label=f"± {percent(FLOOR)}: tolerance without uncertainties")]
