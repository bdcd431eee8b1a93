"""Figure of a cost study: error against seconds on logarithmic axes, one panel for each target."""

import math
import textwrap
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from comparison.figures import FAINT, INK, method_colour, own_style, tint
from comparison.studies.cost import LEAST_ERROR, CostPoint, CostStudy, front
from comparison.studies.cost_limit_analysis import ASSOCIATED, PREDICTION

LIGHTEST = 0.75  # share of white in the lightest shade of a method
MARKERS = {"cone programme": "o", "linearised": "v", "inset": "s", "contact points": "D", "associated": "X", "classic iteration": "P",
           "Coulomb": "o", "path": "^", "YADE": "s"}  # fmt: skip
TITLE_WIDTH, KEY_WIDTH = 80, 92  # characters
SHORTEST, MARGIN = 3.2, 2.0  # half of a panel's range of times, as a factor, and the room beside it
PANELS = {ASSOCIATED: "the associated answer", PREDICTION: "the prediction, friction without dilatancy"}


@own_style()
def cost_figure(ladder: CostStudy) -> Figure:
    """Draw every rung as a mark of its method, and the Pareto fronts as dashed lines.

    A thin line leads from a mark to the uncertainty that the rung states. Letters mark the rungs of the fronts; the text below names them.
    """
    figure = Figure(figsize=(15.0, 7.0), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(ladder.title, parse_math=False, fontsize=11)
    for axes, (target, heading) in zip(figure.subplots(1, 2), PANELS.items(), strict=True):
        named = _draw(axes, [rung for rung in ladder.rungs if rung.target == target and math.isfinite(rung.error)])
        value, source = ladder.references[target]
        title = f"{heading}\n" + textwrap.fill(f"reference {value:.6g}: {source}", TITLE_WIDTH)
        axes.set_title(title, fontsize=8.5, parse_math=False)
        key = ", ".join(f"{letter} = {rung.family} ({rung.setting})" for letter, rung in named)
        axes.set_xlabel(
            "time of one run (s)\n\n" + textwrap.fill(f"on a Pareto front: {key or '–'}", KEY_WIDTH), fontsize=8, parse_math=False
        )
        axes.set_ylabel(f"relative error (-), at least {LEAST_ERROR:.0e}: the error of a solver")
    return figure


def _draw(axes: Any, rungs: list[CostPoint]) -> list[tuple[str, CostPoint]]:
    """Draw all rungs of a panel; return the rungs on a front with their letters."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    if not rungs:
        axes.text(0.5, 0.5, "the reference is zero: no relative error exists", transform=axes.transAxes, ha="center")
        return []
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.grid(True, which="major", color=FAINT, linewidth=0.4, alpha=0.6)
    _draw_rungs(axes, rungs)
    named = _draw_fronts(axes, rungs)
    low, high = (bound(rung.total for rung in rungs) for bound in (min, max))
    middle, half = math.sqrt(low * high), max(math.sqrt(high / low), SHORTEST) * MARGIN
    axes.set_xlim(middle / half, middle * half)
    axes.margins(y=0.1)
    axes.legend(fontsize=7.5, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)  # beside the panel, where it hides no mark
    return named


def _draw_rungs(axes: Any, rungs: list[CostPoint]) -> None:
    """Draw the rungs as marks of their methods, with lines to the uncertainties that they state."""
    families = list(dict.fromkeys(rung.family for rung in rungs))
    own = [family for family in families if method_colour(family) != method_colour("YADE")]
    for family in families:
        members = [rung for rung in rungs if rung.family == family]
        style = {"marker": MARKERS.get(family, "h"), "color": _colour(family, own), "markeredgecolor": INK, "linestyle": "none"}
        axes.plot([r.total for r in members], [_height(r) for r in members], label=family, markersize=7, alpha=0.85, **style)
    stating = [rung for rung in rungs if math.isfinite(_stated(rung))]
    if stating:
        at, stated = [rung.total for rung in stating], [_stated(rung) for rung in stating]
        axes.vlines(at, [_height(rung) for rung in stating], stated, color=FAINT, linewidth=0.9, zorder=1)
        axes.plot(at, stated, color=INK, linestyle="none", marker="_", markersize=8, label="stated uncertainty")


def _draw_fronts(axes: Any, rungs: list[CostPoint]) -> list[tuple[str, CostPoint]]:
    """Draw the Pareto fronts of all rungs and of YADE alone; return their rungs with their letters."""
    named: list[tuple[str, CostPoint]] = []
    by_yade = [rung for rung in rungs if rung.family == "YADE"]
    for candidates, colour, label in ((rungs, INK, "Pareto front"), (by_yade, method_colour("YADE"), "Pareto front of YADE alone")):
        best = front(candidates)
        if best:
            axes.plot([r.total for r in best], [_height(r) for r in best], color=colour, linestyle="--", linewidth=1.0, label=label)
        new = [rung for rung in best if rung not in [known for _, known in named]]
        named += [(chr(ord("a") + len(named) + k), rung) for k, rung in enumerate(new)]
    for letter, rung in named:
        axes.annotate(letter, (rung.total, _height(rung)), xytext=(5, 5), textcoords="offset points", fontsize=9, weight="bold")
    return named


def _colour(family: str, own: list[str]) -> Any:
    """Return YADE's colour, or a shade of limit analysis' for each of its `own` families, from dark to light."""
    if family not in own:
        return method_colour(family)
    return tint(method_colour(family), LIGHTEST * own.index(family) / max(len(own) - 1, 1))


def _stated(rung: CostPoint) -> float:
    """Return the uncertainty that a rung states, over its value; NaN where it states none or has no value."""
    return max(rung.uncertainty / abs(rung.value), LEAST_ERROR) if abs(rung.value) > 0.0 else math.nan


def _height(rung: CostPoint) -> float:
    return max(rung.error, LEAST_ERROR)
