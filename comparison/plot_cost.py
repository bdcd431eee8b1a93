"""Error against seconds, both on logarithmic axes: a panel for the associated answer and one for the prediction."""

import math
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from comparison.cost import Ladder, Rung, front
from comparison.cost_methods import ASSOCIATED, PREDICTION
from comparison.drawing import FAINT, INK, method_colour

MARKERS = {"cone programme": "o", "linearised": "v", "inset": "s", "contact points": "D", "associated": "X", "classic iteration": "P",
           "Coulomb": "o", "path": "^", "YADE": "s"}  # fmt: skip
SHORTEST, MARGIN = 3.2, 2.0  # half of a panel's range of times, as a factor, and the room beside it
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
    _draw_front(axes, front(rungs), INK, "Pareto front")
    alone = [rung for rung in rungs if rung.family == "YADE"]
    if alone:
        _draw_front(axes, front(alone), method_colour("YADE"), "Pareto front of YADE alone")
    low, high = (bound(rung.total for rung in rungs) for bound in (min, max))
    middle, half = math.sqrt(low * high), max(math.sqrt(high / low), SHORTEST) * MARGIN
    axes.set_xlim(middle / half, middle * half)
    axes.margins(y=0.1)
    axes.legend(fontsize=7.5, loc="best", framealpha=0.9)


def _draw_front(axes: Any, rungs: list[Rung], colour: str, words: str) -> None:
    """The front as a line, and the names of its rungs."""
    axes.plot([r.total for r in rungs], [_height(r) for r in rungs], color=colour, linestyle="--", linewidth=1.0, label=words)
    for k, rung in enumerate(rungs):
        place = (6, 7) if k % 2 == 0 else (6, -11)
        axes.annotate(f"{rung.family}, {rung.setting}", (rung.total, _height(rung)), xytext=place, textcoords="offset points", fontsize=6.5)


def _height(rung: Rung) -> float:
    return max(rung.error, LEAST_ERROR)
