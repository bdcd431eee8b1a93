"""The reaction of the support against its settlement: YADE's record and plateau between the bounds of limit analysis."""

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
PLATEAU = ("reaction", "uncertainty", "slope", "plateau_start")


@dataclass(frozen=True)
class _Scales:
    """Divisors from SI to the axes' units, and the units' names."""

    settlement: float
    settlement_unit: str
    reaction: float
    reaction_unit: str


def reaction_figure(scene: Scene, analysis: LimitAnalysis, run: Run | None) -> Figure:
    """Left the whole run from rest, right the plateau close up; bounds at the inset both methods share, sharp value dotted.

    `run` None draws the bounds alone. A second axis gives the reaction over the free blocks' weight.
    """
    figure = Figure(figsize=(11.0, 4.6), layout="constrained")
    FigureCanvasAgg(figure)
    obstacle = _obstacle(scene, analysis)
    if obstacle and run is None:
        figure.text(0.5, 0.5, obstacle, ha="center", va="center", fontsize=11)
        return figure
    scales, end = _scales(scene, analysis, run), _reached(run)
    whole, *close = figure.subplots(1, 2, width_ratios=(1.25, 1.0)) if _has_plateau(run) else [figure.subplots()]
    panels = [(whole, _whole_limits(analysis, run)), *((axes, _plateau_limits(analysis, run)) for axes in close)]
    for axes, limits in panels:
        _draw_bounds(axes, analysis, scales, limits)
        if run is not None and end > 0.0:
            _draw_run(axes, run, scales, end)
        _finish(axes, scene, scales, end, limits)
    for axes in close:
        axes.set_title("close to the plateau", fontsize=9, loc="left")
    whole.set_title(_status_words(run, obstacle), fontsize=9, parse_math=False, loc="left")
    named = {name: handle for axes, _ in panels for handle, name in zip(*axes.get_legend_handles_labels(), strict=True)}
    figure.legend(list(named.values()), list(named), loc="outside lower center", ncols=4, fontsize=8, frameon=False)
    return figure


def _has_plateau(run: Run | None) -> bool:
    return run is not None and bool(np.isfinite([run.result[name] for name in PLATEAU]).all())


def _obstacle(scene: Scene, analysis: LimitAnalysis) -> str:
    """Why limit analysis has no reaction to show, or ""."""
    if scene.live is not None:
        return "A live load moves no support: there is no reaction to draw."
    status = analysis.rounded[Drive.YIELDING].status
    if status is Status.INFEASIBLE:
        return "Limit analysis: the structure cannot stand under its own weight, so no reaction exists."
    return "" if np.isfinite(analysis.rounded[Drive.YIELDING].value) else f"Limit analysis ended as {status}: it has no least reaction."


def _status_words(run: Run | None, obstacle: str) -> str:
    words = "no YADE run" if run is None else "the whole run" if run.status == "plateau" else f"YADE ended as: {run.status}"
    return "\n".join(part for part in (words, obstacle) if part)


def _lines(analysis: LimitAnalysis) -> dict[str, float]:
    """Finite reactions of limit analysis by label."""
    named = {
        "least": _value(analysis.rounded, Drive.YIELDING),
        "sharp": _value(analysis.sharp, Drive.YIELDING),
        "greatest": _value(analysis.rounded, Drive.PUSHING),
    }
    return {name: value for name, value in named.items() if np.isfinite(value)}


def _value(solutions: dict[Drive, Solution], drive: Drive) -> float:
    return solutions[drive].value if drive in solutions else float("nan")


def _reached(run: Run | None) -> float:
    """Largest settlement recorded, m or rad; 0 where none is."""
    return float(run.settling("settlement").max(initial=0.0)) if run is not None else 0.0


def _scales(scene: Scene, analysis: LimitAnalysis, run: Run | None) -> _Scales:
    values = [abs(value) for value in _lines(analysis).values()]
    if run is not None:
        values += list(np.abs(run.settling("reaction")))
    largest = max((value for value in values if np.isfinite(value)), default=1.0)
    divisor, prefix = next(((d, p) for d, p in PREFIXES if largest >= 10.0 * d), (1.0, ""))
    tiny = _reached(run) < 1e-5
    length = ("µrad" if tiny else "mrad") if scene.is_rotation else ("µm" if tiny else "mm")
    return _Scales(1e-6 if tiny else 1e-3, length, divisor, f"{prefix}{scene.unit}")


def _padded(low: float, high: float) -> tuple[float, float]:
    pad = 0.08 * (high - low) if high > low else max(abs(high), 1.0) * 0.1
    return low - pad, high + pad


def _whole_limits(analysis: LimitAnalysis, run: Run | None) -> tuple[float, float]:
    """Reaction range of the whole run: zero, the record and limit analysis; the greatest reaction only where it is near."""
    lines = _lines(analysis)
    values = [0.0] + [value for name, value in lines.items() if name != "greatest" or run is None]
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
    if "least" in lines:
        top = max(lines["least"], min(lines.get("greatest", np.inf), 2.0 * high - low))
        axes.axhspan(lines["least"], top, color=LIMIT_ANALYSIS, alpha=BAND / 2.0, linewidth=0.0, label="admissible (associated)")
        axes.axhline(lines["least"], color=LIMIT_ANALYSIS, linewidth=1.8, linestyle="--", label=r"limit analysis, $R_{\min}$")
    if "sharp" in lines and lines["sharp"] != lines.get("least"):
        axes.axhline(lines["sharp"], color=LIMIT_ANALYSIS, linewidth=1.2, linestyle=":", label=r"$R_{\min}$ of sharp arrises")
    if "greatest" in lines and lines["greatest"] <= high:
        axes.axhline(lines["greatest"], color=LIMIT_ANALYSIS, linewidth=1.2, linestyle="-.", label=r"limit analysis, $R_{\max}$")
    elif "greatest" in lines:
        words = rf"$R_{{\max}}$ = {lines['greatest']:.4g} {scales.reaction_unit} lies above $\uparrow$"
        axes.set_title(words, fontsize=8, color=LIMIT_ANALYSIS, loc="right")


def _draw_run(axes: Any, run: Run, scales: _Scales, end: float) -> None:
    """The record, the fitted line from rest on, and the reaction at rest with its uncertainty."""
    axes.plot(
        run.settling("settlement") / scales.settlement, run.settling("reaction") / scales.reaction,
        color=YADE, linewidth=0.8, label="YADE, recorded",
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
    motion = f"{'rotation' if scene.is_rotation else 'settlement'} of the support"
    axes.set_ylim(*np.array(limits) / scales.reaction)
    if end > 0.0:
        axes.set_xlim(-0.03 * end / scales.settlement, 1.03 * end / scales.settlement)
        axes.set_xlabel(f"{motion} ({scales.settlement_unit})")
    else:
        axes.set_xticks([])
        axes.set_xlabel(f"{motion}: none recorded")
    axes.set_ylabel(f"reaction R ({scales.reaction_unit})")
    ratio = scales.reaction / scene.weight
    second = axes.secondary_yaxis("right", functions=(lambda r: r * ratio, lambda q: q / ratio))
    second.set_ylabel("R / W (m)" if scene.is_rotation else "R / W")
    for each in (axes, second):
        each.tick_params(labelsize=8)
    axes.grid(color=FAINT, alpha=0.25, linewidth=0.5)
