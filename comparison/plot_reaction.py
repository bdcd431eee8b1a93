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
    scales = _scales(scene, analysis, run)
    ends = _ends(run)
    panels = (
        figure.subplots(1, 2, width_ratios=(1.25, 1.0)) if run is not None and np.isfinite(run.result["reaction"]) else [figure.subplots()]
    )
    for axes, limits in zip(panels, (_whole_limits(analysis, run), _plateau_limits(analysis, run)), strict=False):
        _draw_bounds(axes, analysis, scales, ends, limits)
        if run is not None:
            _draw_run(axes, run, scales, ends)
        _finish(axes, scene, scales, ends, limits)
    if len(panels) == 2:
        panels[1].set_title("close to the plateau", fontsize=9, loc="left")
    panels[0].set_title(_status_words(run, obstacle), fontsize=9, parse_math=False, loc="left")
    handles, labels = panels[-1].get_legend_handles_labels()
    more = [pair for pair in zip(*panels[0].get_legend_handles_labels(), strict=True) if pair[1] not in labels]
    figure.legend(
        handles + [h for h, _ in more], labels + [name for _, name in more], loc="outside lower center", ncols=4, fontsize=8, frameon=False
    )
    return figure


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
    least, sharp, greatest = (_value(solutions, drive) for solutions, drive in (
        (analysis.rounded, Drive.YIELDING), (analysis.sharp, Drive.YIELDING), (analysis.rounded, Drive.PUSHING)
    ))  # fmt: skip
    named = {"least": least, "sharp": sharp, "greatest": greatest}
    return {name: value for name, value in named.items() if np.isfinite(value)}


def _value(solutions: dict[Drive, Solution], drive: Drive) -> float:
    return solutions[drive].value if drive in solutions else float("nan")


def _ends(run: Run | None) -> float:
    """Largest settlement drawn, m or rad."""
    reached = run.settling("settlement") if run is not None else np.zeros(0)
    return float(reached.max()) if len(reached) and reached.max() > 0.0 else 1.0


def _scales(scene: Scene, analysis: LimitAnalysis, run: Run | None) -> _Scales:
    values = [abs(value) for value in _lines(analysis).values()]
    if run is not None:
        values += list(np.abs(run.settling("reaction")))
    largest = max((value for value in values if np.isfinite(value)), default=1.0)
    divisor, prefix = next(((d, p) for d, p in PREFIXES if largest >= 10.0 * d), (1.0, ""))
    end = _ends(run)
    tiny = end < 1e-5
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
    if run is not None and np.isfinite(run.result["reaction"]):
        reaction, uncertainty = run.result["reaction"], run.result["uncertainty"]
        late = run.settling("reaction")[run.settling("settlement") >= run.result["plateau_start"]]
        values += [reaction - 2.0 * uncertainty, reaction + 2.0 * uncertainty, *np.quantile(late, (0.02, 0.98))]
    return _padded(min(values, default=0.0), max(values, default=1.0))


def _draw_bounds(axes: Any, analysis: LimitAnalysis, scales: _Scales, end: float, limits: tuple[float, float]) -> None:
    lines = {name: value / scales.reaction for name, value in _lines(analysis).items()}
    low, high = (limit / scales.reaction for limit in limits)
    if "least" in lines:
        top = lines.get("greatest", high)
        axes.axhspan(
            lines["least"],
            max(min(top, 2.0 * high - low), lines["least"]),
            color=LIMIT_ANALYSIS,
            alpha=BAND / 2.0,
            linewidth=0.0,
            label="admissible (associated)",
        )
        axes.axhline(lines["least"], color=LIMIT_ANALYSIS, linewidth=1.8, linestyle="--", label=r"limit analysis, $R_{\min}$")
    if "sharp" in lines and lines["sharp"] != lines.get("least"):
        axes.axhline(lines["sharp"], color=LIMIT_ANALYSIS, linewidth=1.2, linestyle=":", label=r"$R_{\min}$ of sharp arrises")
    if "greatest" in lines and lines["greatest"] <= high:
        axes.axhline(lines["greatest"], color=LIMIT_ANALYSIS, linewidth=1.2, linestyle="-.", label=r"limit analysis, $R_{\max}$")
    elif "greatest" in lines:
        words = rf"$R_{{\max}}$ = {lines['greatest']:.4g} {scales.reaction_unit} lies above $\uparrow$"
        axes.set_title(words, fontsize=8, color=LIMIT_ANALYSIS, loc="right")


def _draw_run(axes: Any, run: Run, scales: _Scales, end: float) -> None:
    axes.plot(
        run.settling("settlement") / scales.settlement, run.settling("reaction") / scales.reaction,
        color=YADE, linewidth=1.0, label="YADE, recorded",
    )  # fmt: skip
    reaction, uncertainty, slope = (run.result[name] / scales.reaction for name in ("reaction", "uncertainty", "slope"))
    start = run.result["plateau_start"]
    if not np.isfinite([reaction, uncertainty, slope, start]).all():
        return
    for settlement, style, label in (
        ((0.0, start), (0, (4, 2)), "YADE, extrapolated to rest"),
        ((start, end), "-", "YADE, fitted plateau"),
    ):
        s = np.array(settlement)
        axes.plot(s / scales.settlement, reaction + slope * s, color=INK, linewidth=1.6, linestyle=style, label=label)
    s = np.array([0.0, end])
    line = reaction + slope * s
    axes.fill_between(
        s / scales.settlement, line - uncertainty, line + uncertainty, color=INK, alpha=BAND, linewidth=0.0, label="its uncertainty"
    )
    axes.errorbar(
        [0.0], [reaction], [uncertainty], color=INK, marker="s", markersize=5, markerfacecolor=YADE, capsize=4, clip_on=False, zorder=6
    )


def _finish(axes: Any, scene: Scene, scales: _Scales, end: float, limits: tuple[float, float]) -> None:
    """Axes, units and the second scale R/W."""
    axes.set(xlim=(-0.03 * end / scales.settlement, 1.03 * end / scales.settlement), ylim=np.array(limits) / scales.reaction)
    kind = "rotation" if scene.is_rotation else "settlement"
    axes.set_xlabel(f"{kind} of the support ({scales.settlement_unit})")
    axes.set_ylabel(f"reaction R ({scales.reaction_unit})")
    ratio = scales.reaction / scene.weight
    second = axes.secondary_yaxis("right", functions=(lambda r: r * ratio, lambda q: q / ratio))
    second.set_ylabel("R / W (m)" if scene.is_rotation else "R / W")
    for each in (axes, second):
        each.tick_params(labelsize=8)
    axes.grid(color=FAINT, alpha=0.25, linewidth=0.5)
