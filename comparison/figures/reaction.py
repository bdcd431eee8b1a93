"""Figure of the reaction against the settlement.

It shows YADE's record and plateau, and the bounds, prediction with curve and interval, and path of limit analysis. Under a live load it
shows the multiplier against the displacement along the load. For a tilt a second axis gives the angle, whose tangent
is the multiplier.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from comparison.figures.canvas import FAINT, INK, LIMIT_ANALYSIS, YADE
from comparison.figures.line_labels import Word, write_words
from comparison.figures.reaction_levels import (
    Scales,
    at_joints_of_yade,
    curve_of,
    greatest_level,
    has_plateau,
    has_sharp,
    interval_of,
    is_joint,
    largest_settlement,
    levels,
    obstacle_of,
    plateau_limits,
    scales_of,
    whole_limits,
)
from comparison.figures.save import own_style
from comparison.figures.structure import legend_below
from comparison.judge import compare_curves
from comparison.numbers import format_number, several_plateaus, with_uncertainty
from comparison.yade import Results, Run
from la_core.analysis import LimitAnalysis
from la_core.limit import Drive
from la_core.scene import Scene

BAND = 0.16  # opacity
INTERVAL = 0.14  # opacity of the Coulomb interval, which covers the admissible band: darker in greyscale too
ADMISSIBLE = "admissible (associated)"
LEAST = r"limit analysis, $R_{\min}$"
GREATEST = r"limit analysis, $R_{\max}$"
ASSOCIATED = "limit analysis, associated"
COULOMB = "limit analysis, Coulomb prediction"
RELEASED = "limit analysis, after a release"
HISTORY = "interval: value depends on friction's history"
CURVE = "limit analysis, curve of the prediction"
PATH = "limit analysis, path from rest"
APART = "largest difference of the curves"
FITTED = "YADE, fitted plateau"


@own_style()
def reaction_figure(results: Results) -> Figure:
    """Draw the whole curve from rest on the left, and the plateau close up on the right.

    All values are those at the inset that both methods share; the bound of sharp edges is dotted. Without a run and
    without a path the figure shows levels only. A second axis gives the reaction over the weight of the free blocks.
    """
    scene, analysis, run = results.scene, results.analysis, results.run
    figure = Figure(figsize=(11.0, 4.6), layout="constrained")
    FigureCanvasAgg(figure)
    obstacle, scales, end = obstacle_of(analysis), scales_of(results), largest_settlement(results)
    if obstacle and (run is None or not end > 0.0):  # neither a level nor a record
        words = obstacle if run is None else _status_words(results, obstacle)
        figure.text(0.5, 0.5, words, ha="center", va="center", fontsize=11, parse_math=False)
        return figure
    is_close = has_plateau(run) or (run is None and end > 0.0)
    whole, *close = figure.subplots(1, 2, width_ratios=(1.25, 1.0)) if is_close else [figure.subplots()]
    panels = [(whole, whole_limits(results)), *((axes, plateau_limits(results)) for axes in close)]
    written: set[str] = set()
    for axes, limits in panels:
        _draw_bounds(axes, analysis, scales, limits)
        _draw_prediction(axes, results, scales, limits, end)
        if run is not None and end > 0.0:
            _draw_run(axes, run, scales, end)
            _draw_difference(axes, results, scales)
        _finish(axes, scene, scales, end, limits)
        low, high = (limit / scales.reaction for limit in limits)
        written |= write_words(axes, _words(results, scales, end), (low, high), _kept_clear(results, scales, end))
    for axes in close:
        axes.set_title("close to the plateau", fontsize=9, loc="left")
    whole.set_title(_status_words(results, obstacle), fontsize=9, parse_math=False, loc="left")
    if not close:
        figure.set_figwidth(7.5)
    named = {name: handle for axes, _ in panels for handle, name in zip(*axes.get_legend_handles_labels(), strict=True)}
    keys = {name: handle for name, handle in named.items() if name not in written}  # a labelled line needs no key
    legend_below(figure, list(keys.values()), 4 if close else 2)
    return figure


def draw_levels(axes: Any, results: Results, row: float) -> tuple[Scales, set[str]]:
    """Draw the whole curve's panel without YADE's record.

    Return the axes' scales and the legend's names of labelled lines. row: height of a row of text as a share of the axes' height.
    """
    scene, analysis = results.scene, results.analysis
    scales, end, limits = scales_of(results), largest_settlement(results), whole_limits(results)
    _draw_bounds(axes, analysis, scales, limits)
    _draw_prediction(axes, results, scales, limits, end)
    _finish(axes, scene, scales, end, limits)
    low, high = (limit / scales.reaction for limit in limits)
    return scales, write_words(axes, _words(Results(analysis), scales, end), (low, high), _kept_clear(results, scales, end), row)


def _status_words(results: Results, obstacle: str) -> str:
    analysis, run = results.analysis, results.run
    followed = "the whole path" if analysis.path is not None else "the first travel" if largest_settlement(results) > 0.0 else ""
    title = followed if run is None else "the whole run" if run.status == "plateau" else f"YADE ended as: {run.status}"
    return "\n".join(line for line in (title, obstacle) if line)


def _draw_bounds(axes: Any, analysis: LimitAnalysis, scales: Scales, limits: tuple[float, float]) -> None:
    """Draw the admissible band and its ends; a greatest reaction that is unknown, or beyond the axes, is written above them."""
    lines = {name: value / scales.reaction for name, value in levels(analysis).items()}
    low, high = (limit / scales.reaction for limit in limits)
    live, greatest = analysis.main is Drive.LIVE, greatest_level(analysis) / scales.reaction
    if not (live or np.isnan(greatest)) and "least" in lines:
        top = max(lines["least"], min(greatest, 2.0 * high - low))
        axes.axhspan(lines["least"], top, color=LIMIT_ANALYSIS, alpha=BAND / 2.0, linewidth=0.0, label=ADMISSIBLE)
    if "least" in lines:
        axes.axhline(lines["least"], color=LIMIT_ANALYSIS, linewidth=1.8, linestyle="--", label=ASSOCIATED if live else LEAST)
    if has_sharp(analysis):
        axes.axhline(lines["sharp"], color=LIMIT_ANALYSIS, linewidth=1.2, linestyle=":", label=_sharp_name(analysis))
    if "greatest" in lines and lines["greatest"] <= high:
        axes.axhline(lines["greatest"], color=LIMIT_ANALYSIS, linewidth=1.2, linestyle="-.", label=GREATEST)
    elif "least" in lines and not (live or np.isposinf(greatest)):
        words = "is unknown" if np.isnan(greatest) else rf"= {format_number(greatest)} {scales.reaction_unit} lies above $\uparrow$"
        axes.set_title(rf"$R_{{\max}}$ {words}", fontsize=8, color=LIMIT_ANALYSIS, loc="right")


def _sharp_name(analysis: LimitAnalysis) -> str:
    return "associated, of sharp edges" if analysis.main is Drive.LIVE else r"$R_{\min}$ of sharp edges"


def _words(results: Results, scales: Scales, end: float) -> list[Word]:
    """Return the labels of the lines and the bands, with their values."""
    analysis, run = results.analysis, results.run
    lines = {name: value / scales.reaction for name, value in levels(analysis).items()}
    live, unit = analysis.main is Drive.LIVE, f" {scales.reaction_unit}".rstrip()
    least, named = ("associated", ASSOCIATED) if live else (r"$R_{\min}$, associated", LEAST)
    names: dict[str, tuple[str, tuple[str, ...]]] = {
        "least": (least, (named,)),
        "greatest": (r"$R_{\max}$, associated", (GREATEST,)),
        "coulomb": ("Coulomb prediction", (COULOMB,)),
        "released": ("after turning blocks released a thrust", (RELEASED,)),
    }
    if is_joint(analysis):
        names["least"] = (f"{least}, and Coulomb prediction", (named, COULOMB))
        del names["coulomb"]
    if has_sharp(analysis):
        names["sharp"] = (_sharp_name(analysis), (_sharp_name(analysis),))
    labels = [
        Word(lines[key], lines[key], f"{words}: {_value_words(analysis, scales, key)}", LIMIT_ANALYSIS, keys)
        for key, (words, keys) in names.items()
        if key in lines
    ]
    if run is not None and has_plateau(run):
        value, uncertainty = (run.result[name] / scales.reaction for name in ("reaction", "uncertainty"))
        level = value + run.result.slope / scales.reaction * end
        labels.append(Word(level, level, f"YADE's plateau: {with_uncertainty(value, uncertainty)}{unit}", INK, (FITTED,)))
    return labels + list(_band_words(analysis, scales, unit))


def _value_words(analysis: LimitAnalysis, scales: Scales, key: str) -> str:
    """Return a level with its unit; the prediction, or the bound that equals it, also with its uncertainty and all its plateaus."""
    unit = f" {scales.reaction_unit}".rstrip()
    shown = "coulomb" if key == "least" and is_joint(analysis) else key
    value = levels(analysis)[shown] / scales.reaction
    if shown == "released" and analysis.coulomb is not None:
        return f"{with_uncertainty(value, analysis.coulomb.released_uncertainty / scales.reaction)}{unit}"
    if shown != "coulomb" or analysis.coulomb is None:
        return f"{format_number(value, 5)}{unit}"
    several = several_plateaus((analysis.coulomb.plateaus / scales.reaction).tolist(), scales.reaction_unit)
    return f"{with_uncertainty(value, analysis.coulomb.uncertainty / scales.reaction)}{unit}" + (f"\n{several}" if several else "")


def _band_words(analysis: LimitAnalysis, scales: Scales, unit: str) -> Iterator[Word]:
    """Yield the labels of the Coulomb interval and of the admissible band above it."""
    lines = {name: value / scales.reaction for name, value in levels(analysis).items()}
    interval, above = interval_of(analysis), lines.get("least")
    if interval is not None:
        low, high = (value / scales.reaction for value in interval)
        ends = "without a least value" if np.isfinite(high) else "without a greatest value"
        ends = f"{format_number(low, 4)} to {format_number(high, 4)}{unit}" if np.isfinite([low, high]).all() else ends
        yield Word(low, high, f"interval, {ends}:\nvalue depends on friction's history", LIMIT_ANALYSIS, (HISTORY,))
        above = max(above, high) if above is not None else None
    greatest = greatest_level(analysis) / scales.reaction
    if analysis.main is not Drive.LIVE and above is not None and above < greatest:
        yield Word(above, greatest, ADMISSIBLE, LIMIT_ANALYSIS, (ADMISSIBLE,))


def _kept_clear(results: Results, scales: Scales, end: float) -> list[float]:
    """Return values that labels must not cover: the ends of the interval and the second half of path and curve."""
    analysis = results.analysis
    values = [value for value in interval_of(analysis) or () if np.isfinite(value)]
    settlement, value = curve_of(results, end)
    values += list(value[settlement >= 0.5 * end])
    if analysis.path is not None:
        at = analysis.path.settlement / results.path_scale
        late = (at >= 0.5 * end) & (at <= end)
        values += list(analysis.path.value[late])
    return [value / scales.reaction for value in values]


def _draw_prediction(axes: Any, results: Results, scales: Scales, limits: tuple[float, float], end: float) -> None:
    """Draw the Coulomb prediction, its curve up to the settlement `end`, its interval where it has a width, and the path from rest."""
    analysis = results.analysis
    lines, path = {name: value / scales.reaction for name, value in levels(analysis).items()}, analysis.path
    interval = interval_of(analysis)
    if interval is not None:
        beyond = limits[1] - limits[0]
        low, high = np.clip(interval, limits[0] - beyond, limits[1] + beyond) / scales.reaction
        axes.axhspan(low, high, color=LIMIT_ANALYSIS, alpha=INTERVAL, linewidth=0.0, label=HISTORY)
    if "coulomb" in lines:
        axes.axhline(lines["coulomb"], color=LIMIT_ANALYSIS, linewidth=2.2, label=COULOMB)
        axes.axhline(lines["coulomb"], color=LIMIT_ANALYSIS, linewidth=0.7, zorder=4.1)  # seen through a noisy record, too
    if "released" in lines:
        axes.axhline(lines["released"], color=LIMIT_ANALYSIS, linewidth=1.6, linestyle=(0, (6.0, 1.5, 1.0, 1.5, 1.0, 1.5)), label=RELEASED)
    settlement, value = curve_of(results, end)
    if len(settlement):
        # Short dashes above YADE's solid record, so that both are visible where they coincide, in grey, too.
        style: dict[str, Any] = {"linewidth": 1.6, "linestyle": (0, (2.2, 2.4)), "zorder": 4.05, "color": LIMIT_ANALYSIS}
        axes.plot(settlement / scales.settlement, value / scales.reaction, label=CURVE + at_joints_of_yade(results), **style)
    if path is not None:
        # The thin line is below YADE's record and the marks are above it, so that both are visible where they coincide.
        marks = {"marker": "o", "markersize": 4, "markerfacecolor": "white", "markeredgewidth": 1.0, "linewidth": 0.0, "zorder": 5}
        at, values = path.settlement / results.path_scale / scales.settlement, path.value / scales.reaction
        if not len(settlement):  # its chords would cut the corners of the curve
            axes.plot(at, values, color=LIMIT_ANALYSIS, linewidth=1.0, zorder=2)
        axes.plot(at, values, color=LIMIT_ANALYSIS, label=PATH + at_joints_of_yade(results), **marks)


def _draw_run(axes: Any, run: Run, scales: Scales, end: float) -> None:
    """Draw the record, the fitted line from rest on, and the reaction at rest with its uncertainty."""
    axes.plot(
        run.settling("settlement") / scales.settlement, run.settling("reaction") / scales.reaction,
        color=YADE, linewidth=1.3, label="YADE, recorded", zorder=4,
    )  # fmt: skip
    if not has_plateau(run):
        return
    reaction, uncertainty, slope = (run.result[name] / scales.reaction for name in ("reaction", "uncertainty", "slope"))
    start = run.result.plateau_start
    for first, last, style, label in ((0.0, start, "--", "YADE, extrapolated to rest"), (start, end, "-", FITTED)):
        s = np.array([first, last])
        # Thinner than the record and above it, so that both are visible, with and without noise.
        axes.plot(s / scales.settlement, reaction + slope * s, color=INK, linewidth=0.9, linestyle=style, label=label, zorder=4.3)
    s = np.array([0.0, end])
    low, high = (reaction + slope * s + sign * uncertainty for sign in (-1.0, 1.0))
    axes.fill_between(s / scales.settlement, low, high, color=INK, alpha=BAND, linewidth=0.0, label="its uncertainty", zorder=4.2)
    marker = {"marker": "s", "markersize": 5, "markerfacecolor": YADE, "capsize": 4}
    axes.errorbar([0.0], [reaction], [uncertainty], color=INK, zorder=6, **marker)


def _draw_difference(axes: Any, results: Results, scales: Scales) -> None:
    """Mark where YADE's record and the prediction's curve are farthest apart, with the size of the difference in the legend."""
    apart, coulomb, run = compare_curves(results), results.analysis.coulomb, results.run
    if apart is None or coulomb is None or run is None:
        return
    at, size = run.settling("settlement"), run.settling("reaction")
    ends = [
        size[np.argmin(np.abs(at - apart.settlement))],  # its row: under a live load the displacement does not always rise
        np.interp(apart.settlement, coulomb.path_settlement / results.prediction_scale, coulomb.path_value),
    ]
    where = f"{format_number(apart.settlement / scales.settlement, 2)} {scales.settlement_unit}"
    label = f"{APART}: {f'{format_number(apart.largest / scales.reaction, 2)} {scales.reaction_unit}'.rstrip()} at {where}"
    style: dict[str, Any] = {"color": INK, "linewidth": 2.2, "solid_capstyle": "butt", "zorder": 4.4, "label": label}
    axes.plot([apart.settlement / scales.settlement] * 2, np.array(ends) / scales.reaction, **style)


def _finish(axes: Any, scene: Scene, scales: Scales, end: float, limits: tuple[float, float]) -> None:
    """Set limits, labels with units, and the second scale R/W."""
    live = scene.live is not None
    motion = "mean displacement along the load" if live else f"{'rotation' if scene.is_rotation else 'settlement'} of the support"
    motion = motion if scene.tilt is None else "mean displacement down the slope"
    axes.set_ylim(*np.array(limits) / scales.reaction)
    if end > 0.0:
        axes.set_xlim(-0.03 * end / scales.settlement, 1.03 * end / scales.settlement)
        axes.set_xlabel(f"{motion} ({scales.settlement_unit})")
    else:
        axes.set_xticks([])
        axes.set_xlabel(f"{motion}: none recorded")
    quantity = "multiplier of the live load" if scene.tilt is None else "tangent of the tilt angle"
    axes.set_ylabel(quantity if live else f"reaction R ({scales.reaction_unit})")
    axes.tick_params(labelsize=8)
    axes.grid(color=FAINT, alpha=0.25, linewidth=0.5)
    if scene.tilt is not None:
        angle = axes.secondary_yaxis("right", functions=(lambda t: np.degrees(np.arctan(t)), lambda a: np.tan(np.radians(a))))
        angle.set_ylabel("tilt angle (degrees)")
        angle.tick_params(labelsize=8)
    if live:
        return
    ratio = scales.reaction / scene.weight
    second = axes.secondary_yaxis("right", functions=(lambda r: r * ratio, lambda q: q / ratio))
    second.set_ylabel("R / W (m)" if scene.is_rotation else "R / W")
    second.tick_params(labelsize=8)
