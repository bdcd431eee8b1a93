"""The reaction against the settlement: YADE's record and plateau, limit analysis' bounds, prediction, interval and path.

Under a live load the same for its multiplier against the displacement along it.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from comparison.drawing import FAINT, INK, LIMIT_ANALYSIS, YADE
from comparison.record import Run
from la_core.case import LimitAnalysis
from la_core.limit import Drive, Solution, Status
from la_core.scene import Scene

NEAR = 2.5  # times the range of all other values: a greatest reaction farther than this is only pointed at
PREFIXES = ((1e6, "M"), (1e3, "k"), (1.0, ""))
BAND = 0.16  # opacity
POINT = 1e-4  # of the value: an interval narrower than this is a point
PLATEAU = ("reaction", "uncertainty", "slope", "plateau_start")


@dataclass(frozen=True)
class _Scales:
    """Divisors from SI to the axes' units, and the units' names."""

    settlement: float
    settlement_unit: str
    reaction: float
    reaction_unit: str


def reaction_figure(scene: Scene, analysis: LimitAnalysis, run: Run | None) -> Figure:
    """Left the whole curve from rest, right the plateau close up; all at the inset both methods share, the sharp bound dotted.

    Without `run` and without a path only levels are drawn. A second axis gives the reaction over the free blocks' weight.
    """
    figure = Figure(figsize=(11.0, 4.6), layout="constrained")
    FigureCanvasAgg(figure)
    obstacle = _obstacle(scene, analysis)
    if obstacle and run is None:
        figure.text(0.5, 0.5, obstacle, ha="center", va="center", fontsize=11)
        return figure
    scales, end = _scales(scene, analysis, run), _reached(analysis, run)
    whole, *close = figure.subplots(1, 2, width_ratios=(1.25, 1.0)) if _has_plateau(run) else [figure.subplots()]
    panels = [(whole, _whole_limits(analysis, run)), *((axes, _plateau_limits(analysis, run)) for axes in close)]
    for axes, limits in panels:
        _draw_bounds(axes, analysis, scales, limits)
        _draw_prediction(axes, analysis, scales)
        if run is not None and end > 0.0:
            _draw_run(axes, run, scales, end)
        _finish(axes, scene, scales, end, limits)
    for axes in close:
        axes.set_title("close to the plateau", fontsize=9, loc="left")
    whole.set_title(_status_words(run, obstacle), fontsize=9, parse_math=False, loc="left")
    if not close:
        figure.set_figwidth(7.5)
    named = {name: handle for axes, _ in panels for handle, name in zip(*axes.get_legend_handles_labels(), strict=True)}
    figure.legend(list(named.values()), list(named), loc="outside lower center", ncols=4 if close else 2, fontsize=8, frameon=False)
    return figure


def _has_plateau(run: Run | None) -> bool:
    return run is not None and bool(np.isfinite([run.result[name] for name in PLATEAU]).all())


def _obstacle(scene: Scene, analysis: LimitAnalysis) -> str:
    """Why limit analysis has no reaction to show, or ""."""
    status, value = analysis.rounded[analysis.main].status, analysis.rounded[analysis.main].value
    if status is Status.INFEASIBLE:
        return f"Limit analysis: the structure cannot stand under its own weight, so no {scene.quantity} exists."
    return "" if np.isfinite(value) else f"Limit analysis ended as {status}: it has no {scene.quantity}."


def _status_words(run: Run | None, obstacle: str) -> str:
    words = "" if run is None else "the whole run" if run.status == "plateau" else f"YADE ended as: {run.status}"
    return "\n".join(part for part in (words, obstacle) if part)


def _lines(analysis: LimitAnalysis) -> dict[str, float]:
    """Finite reactions of limit analysis by label."""
    named = {
        "least": _value(analysis.rounded, analysis.main),
        "sharp": _value(analysis.sharp, analysis.main),
        "greatest": _value(analysis.rounded, Drive.PUSHING),
    }
    if analysis.coulomb is not None:
        named |= {"coulomb": analysis.coulomb.value, "lowest": analysis.coulomb.interval[0], "highest": analysis.coulomb.interval[1]}
    return {name: value for name, value in named.items() if np.isfinite(value)}


def _value(solutions: dict[Drive, Solution], drive: Drive) -> float:
    return solutions[drive].value if drive in solutions else float("nan")


def _reached(analysis: LimitAnalysis, run: Run | None) -> float:
    """Largest settlement recorded or followed, m or rad; 0 where none is. A path goes on where a run has stopped: it is cut there."""
    if run is not None:
        return float(run.settling("settlement").max(initial=0.0))
    return float(analysis.path.settlement.max(initial=0.0)) if analysis.path is not None else 0.0


def _scales(scene: Scene, analysis: LimitAnalysis, run: Run | None) -> _Scales:
    values = [abs(value) for value in _lines(analysis).values()]
    if run is not None:
        values += list(np.abs(run.settling("reaction")))
    if analysis.path is not None:
        values += list(np.abs(analysis.path.value))
    largest = max((value for value in values if np.isfinite(value)), default=1.0)
    divisor, prefix = next(((d, p) for d, p in PREFIXES if largest >= 10.0 * d), (1.0, ""))
    tiny = _reached(analysis, run) < 1e-5
    length = ("µrad" if tiny else "mrad") if scene.is_rotation else ("µm" if tiny else "mm")
    return _Scales(1e-6 if tiny else 1e-3, length, divisor, f"{prefix}{scene.unit}")


def _padded(low: float, high: float) -> tuple[float, float]:
    pad = 0.08 * (high - low) if high > low else max(abs(high), 1.0) * 0.1
    return low - pad, high + pad


def _whole_limits(analysis: LimitAnalysis, run: Run | None) -> tuple[float, float]:
    """Reaction range of the whole run: zero, the record and limit analysis; the greatest reaction only where it is near."""
    lines = _lines(analysis)
    alone = run is None and analysis.path is None
    values = [0.0] + [value for name, value in lines.items() if name != "greatest" or alone]
    if analysis.path is not None:
        values += list(analysis.path.value)
    if run is not None:
        record = run.settling("reaction")
        values += [float(value) for value in record[np.isfinite(record)]]
    low, high = min(values), max(values)
    if "greatest" in lines and lines["greatest"] - low <= NEAR * (high - low):
        high = max(high, lines["greatest"])
    return _padded(low, high)


def _plateau_limits(analysis: LimitAnalysis, run: Run | None) -> tuple[float, float]:
    """Reaction range around the fitted line, its uncertainty and the least reactions, with room for the record's noise."""
    values = [value for name, value in _lines(analysis).items() if name != "greatest"]
    if run is not None and _has_plateau(run):
        reaction, uncertainty = run.result["reaction"], run.result["uncertainty"]
        late = run.settling("reaction")[run.settling("settlement") >= run.result["plateau_start"]]
        values += [reaction - 2.0 * uncertainty, reaction + 2.0 * uncertainty, *np.quantile(late, (0.02, 0.98))]
    return _padded(min(values, default=0.0), max(values, default=1.0))


def _draw_bounds(axes: Any, analysis: LimitAnalysis, scales: _Scales, limits: tuple[float, float]) -> None:
    """Admissible band and its ends; a greatest reaction beyond the axes is named above them."""
    lines = {name: value / scales.reaction for name, value in _lines(analysis).items()}
    low, high = (limit / scales.reaction for limit in limits)
    if analysis.main is Drive.LIVE:
        axes.axhline(lines["least"], color=LIMIT_ANALYSIS, linewidth=1.8, linestyle="--", label="limit analysis, associated")
    elif "least" in lines:
        top = max(lines["least"], min(lines.get("greatest", np.inf), 2.0 * high - low))
        axes.axhspan(lines["least"], top, color=LIMIT_ANALYSIS, alpha=BAND / 2.0, linewidth=0.0, label="admissible (associated)")
        axes.axhline(lines["least"], color=LIMIT_ANALYSIS, linewidth=1.8, linestyle="--", label=r"limit analysis, $R_{\min}$")
    if "sharp" in lines and lines["sharp"] != lines.get("least"):
        name = r"$R_{\min}$" if analysis.main is not Drive.LIVE else "associated,"
        axes.axhline(lines["sharp"], color=LIMIT_ANALYSIS, linewidth=1.2, linestyle=":", label=f"{name} of sharp arrises")
    if "greatest" in lines and lines["greatest"] <= high:
        axes.axhline(lines["greatest"], color=LIMIT_ANALYSIS, linewidth=1.2, linestyle="-.", label=r"limit analysis, $R_{\max}$")
    elif "greatest" in lines:
        words = rf"$R_{{\max}}$ = {lines['greatest']:.4g} {scales.reaction_unit} lies above $\uparrow$"
        axes.set_title(words, fontsize=8, color=LIMIT_ANALYSIS, loc="right")


def _draw_prediction(axes: Any, analysis: LimitAnalysis, scales: _Scales) -> None:
    """The Coulomb prediction, the interval of its mechanism where it has a width, and the path from rest."""
    lines, path = {name: value / scales.reaction for name, value in _lines(analysis).items()}, analysis.path
    if "coulomb" in lines:
        width = lines.get("highest", np.nan) - lines.get("lowest", np.nan)
        if width > POINT * abs(lines["coulomb"]):
            look = {"facecolor": "none", "edgecolor": LIMIT_ANALYSIS, "alpha": 0.45, "hatch": "///", "linewidth": 0.0}
            axes.axhspan(lines["lowest"], lines["highest"], label="interval: friction's history decides", **look)
        axes.axhline(lines["coulomb"], color=LIMIT_ANALYSIS, linewidth=2.2, label="limit analysis, Coulomb prediction")
    if path is not None:
        # The thin line lies under YADE's record and the marks above it, so that both show where they are one.
        marks = {"marker": "o", "markersize": 4, "markerfacecolor": "white", "markeredgewidth": 1.0, "linewidth": 0.0, "zorder": 5}
        at, values = path.settlement / scales.settlement, path.value / scales.reaction
        axes.plot(at, values, color=LIMIT_ANALYSIS, linewidth=1.0, zorder=2)
        axes.plot(at, values, color=LIMIT_ANALYSIS, label="limit analysis, path on elastic joints", **marks)


def _draw_run(axes: Any, run: Run, scales: _Scales, end: float) -> None:
    """The record, the fitted line from rest on, and the reaction at rest with its uncertainty."""
    axes.plot(
        run.settling("settlement") / scales.settlement, run.settling("reaction") / scales.reaction,
        color=YADE, linewidth=1.0, label="YADE, recorded", zorder=4,
    )  # fmt: skip
    if not _has_plateau(run):
        return
    reaction, uncertainty, slope = (run.result[name] / scales.reaction for name in ("reaction", "uncertainty", "slope"))
    start = run.result["plateau_start"]
    for first, last, style, label in ((0.0, start, "--", "YADE, extrapolated to rest"), (start, end, "-", "YADE, fitted plateau")):
        s = np.array([first, last])
        axes.plot(s / scales.settlement, reaction + slope * s, color=INK, linewidth=1.6, linestyle=style, label=label)
    s = np.array([0.0, end])
    low, high = (reaction + slope * s + sign * uncertainty for sign in (-1.0, 1.0))
    axes.fill_between(s / scales.settlement, low, high, color=INK, alpha=BAND, linewidth=0.0, label="its uncertainty")
    marker = {"marker": "s", "markersize": 5, "markerfacecolor": YADE, "capsize": 4}
    axes.errorbar([0.0], [reaction], [uncertainty], color=INK, zorder=6, **marker)


def _finish(axes: Any, scene: Scene, scales: _Scales, end: float, limits: tuple[float, float]) -> None:
    """Axes, units and the second scale R/W."""
    live = scene.live is not None
    motion = "mean displacement along the load" if live else f"{'rotation' if scene.is_rotation else 'settlement'} of the support"
    axes.set_ylim(*np.array(limits) / scales.reaction)
    if end > 0.0:
        axes.set_xlim(-0.03 * end / scales.settlement, 1.03 * end / scales.settlement)
        axes.set_xlabel(f"{motion} ({scales.settlement_unit})")
    else:
        axes.set_xticks([])
        axes.set_xlabel(f"{motion}: none recorded")
    axes.set_ylabel("multiplier of the live load" if live else f"reaction R ({scales.reaction_unit})")
    axes.tick_params(labelsize=8)
    axes.grid(color=FAINT, alpha=0.25, linewidth=0.5)
    if live:
        return
    ratio = scales.reaction / scene.weight
    second = axes.secondary_yaxis("right", functions=(lambda r: r * ratio, lambda q: q / ratio))
    second.set_ylabel("R / W (m)" if scene.is_rotation else "R / W")
    second.tick_params(labelsize=8)
