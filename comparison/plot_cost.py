"""Error against seconds, both on logarithmic axes: a panel for the associated answer and one for the prediction."""

import math
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from comparison.cost import Ladder, Rung
from comparison.cost_methods import ASSOCIATED, PREDICTION
from comparison.drawing import FAINT, INK, method_colour

MARKERS = {"cone programme": "o", "linearised": "v", "inset": "s", "contact points": "D", "associated": "X", "classic iteration": "P",
           "Coulomb": "o", "path": "^", "YADE": "s"}  # fmt: skip
LEAST_ERROR = 1e-10  # smaller ones, and none at all, are drawn here
PANELS = {ASSOCIATED: "the associated answer", PREDICTION: "the prediction, friction without dilatancy"}


def cost_figure(ladder: Ladder) -> Figure:
    """Every rung as a mark by its method; the Pareto front as a line, its rungs named."""
    figure = Figure(figsize=(12.5, 5.6), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(ladder.title, parse_math=False, fontsize=11)
    for axes, (target, words) in zip(figure.subplots(1, 2), PANELS.items(), strict=True):
        rungs = [rung for rung in ladder.rungs if rung.target == target and math.isfinite(rung.error)]
        _draw(axes, rungs)
        value, source = ladder.references[target]
        axes.set_title(f"{words}\nheld against {value:.6g}: {source}", fontsize=8.5, parse_math=False)
        axes.set_xlabel("time of one run (s)")
        axes.set_ylabel("error over the reference (-)")
    return figure


def _draw(axes: Any, rungs: list[Rung]) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.grid(True, which="major", color=FAINT, linewidth=0.4, alpha=0.6)
    for family in dict.fromkeys(rung.family for rung in rungs):
        own = [rung for rung in rungs if rung.family == family]
        style = {"marker": MARKERS.get(family, "h"), "color": method_colour(family), "markeredgecolor": INK, "linestyle": "none"}
        axes.plot([r.total for r in own], [_height(r) for r in own], label=family, markersize=7, alpha=0.85, **style)
    front = sorted((rung for rung in rungs if rung.pareto), key=lambda rung: rung.total)
    axes.plot([r.total for r in front], [_height(r) for r in front], color=INK, linestyle="--", linewidth=1.0, label="Pareto front")
    for k, rung in enumerate(front):
        place = (6, 7) if k % 2 == 0 else (6, -11)
        axes.annotate(rung.setting, (rung.total, _height(rung)), xytext=place, textcoords="offset points", fontsize=7)
    axes.margins(x=0.18, y=0.1)
    axes.legend(fontsize=7.5, loc="best", framealpha=0.9)


def _height(rung: Rung) -> float:
    return max(rung.error, LEAST_ERROR)
