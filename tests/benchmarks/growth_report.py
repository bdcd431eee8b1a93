"""Growth of time and memory: power laws fitted to measurements, their tables in Markdown and their figure."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from marked_text import sentences
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from comparison.figures.canvas import FAINT, INK, method_colour
from comparison.numbers import percent
from comparison.studies.figure_of_cost import MARKERS
from la_core.text_table import number_text

LARGER = 0.1  # share of the largest size; larger sizes are fitted
FEWEST = 3  # least number of sizes of a fit; a line through two sizes has no error
SMALL_SHARE = 0.1  # of the time of an analysis, outside the solver
DIMENSIONS = {"plane": {"linestyle": "-"}, "3D": {"linestyle": "--", "markerfacecolor": "white"}}
INTRODUCTION = """\
Running-bond walls with as many courses as blocks per course settle under a third of their base. Every block is modelled. The tables
give the CPU time and memory of limit analysis and of YADE against the number of blocks N, and the exponent b of N^b fitted to the larger
sizes.

Every size runs in a process of its own. Quick runs are repeated, and the quickest one counts. *build* is scene, contacts, assembly and
matrices; *solver* is set-up and solution of cone programmes and the steps of the paths; *rest* is everything else. *associated* is one
bound; *Coulomb* is a bound and the prediction; *all of associated* and *all of Coulomb* are the whole analysis of the program, with the
inset and with sharp edges.

Walls in space are symmetric about their middle plane. From 167 blocks on, their bounds are solved with half of the unknowns.

Predictions of more than 2,500 unknowns (833 blocks in the plane, 417 in space) follow a third path where the smoothing of the first two
leaves an uncertainty of more than 1 % ([large structures](large.md)). Their seconds are the processor time of all paths."""
BESIDE = """\
The earlier version ran its own benchmark on the same machine, within the same hour. Exponents are fitted to the sizes that both
versions ran. The prediction of an earlier version may be another method: in version 0.2.0 it was a sequence of cone programmes, whose value
did not converge with the number of its steps."""


@dataclass(frozen=True)
class Growth:
    """A power law, values = factor * blocks ** exponent. error: standard error of the exponent; sizes: the sizes fitted."""

    exponent: float
    error: float
    factor: float
    sizes: tuple[int, ...]

    def __str__(self) -> str:
        return f"{self.exponent:.2f} ± {self.error:.2f}"


def fit(blocks: Sequence[int], values: Sequence[float]) -> Growth | None:
    """Fit the larger sizes, at least three, by least squares in logarithms. None where there are fewer, or a value is not positive."""
    order = np.argsort(blocks)
    sizes, measured = np.array(blocks)[order], np.array(values, dtype=float)[order]
    first = min(int(np.searchsorted(sizes, LARGER * sizes[-1])), len(sizes) - FEWEST) if len(sizes) >= FEWEST else len(sizes)
    sizes, measured = sizes[first:], measured[first:]
    if len(sizes) < FEWEST or np.any(measured <= 0.0):
        return None
    x, y = np.log(sizes), np.log(measured)
    x0 = x - x.mean()
    slope = float(x0 @ y / (x0 @ x0))
    left = y - y.mean() - slope * x0
    error = float(np.sqrt(left @ left / (len(x) - 2) / (x0 @ x0)))
    return Growth(slope, error, float(np.exp(y.mean() - slope * x.mean())), tuple(int(size) for size in sizes))


def table(heads: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return a Markdown table. Numbers have two significant digits, so that a second run differs little."""
    return "\n".join([row(heads), row(["---"] * len(heads)), *map(row, rows)])


def row(values: Sequence[object]) -> str:
    """Return one line of a Markdown table."""
    return "| " + " | ".join(map(_cell, values)) + " |"


def _cell(value: object) -> str:
    if isinstance(value, float):
        return number_text(value, 2)
    return "–" if value is None else f"{value:,}" if isinstance(value, int) else str(value)


def exponents(series: dict[tuple[str, str], list[dict[str, Any]]], quantities: Sequence[str]) -> str:
    """Return a table of the exponents of every quantity, by method and dimension."""
    rows = []
    for (method, dimension), measured in series.items():
        found = [fit(*_points(measured, quantity)) for quantity in quantities]
        sizes = next((growth.sizes for growth in found if growth), ())
        rows.append([method, dimension, f"{sizes[0]:,} to {sizes[-1]:,}" if sizes else "–", *found])
    return table(["method", "model", "blocks fitted", *quantities], rows)


def _points(measured: Sequence[dict[str, Any]], quantity: str) -> tuple[list[int], list[float]]:
    """Return blocks and values of a quantity where it was measured. A run that did not end has no value."""
    known = [one for one in measured if quantity in one]
    return [one["blocks"] for one in known], [one[quantity] for one in known]


def beside(before: Sequence[dict[str, Any]], measured: Sequence[dict[str, Any]], version: str) -> str:
    """Return the seconds of an earlier version beside today's: exponents over the sizes that both measured, then every such size."""
    today = {_size(one): one for one in measured}
    both = [(one, today[_size(one)]) for one in before if _size(one) in today and "seconds" in one]
    powers, rows = [], []
    for series in dict.fromkeys(_size(one)[:2] for one, _ in both):
        mine = [(then, now) for then, now in both if _size(then)[:2] == series]
        ended = [(then, now) for then, now in mine if "seconds" in now]
        blocks = [then["blocks"] for then, _ in ended]
        grown = [fit(*_points(measurements, "seconds")) for measurements in zip(*ended, strict=True)]
        powers.append([*series, f"{blocks[0]:,} to {blocks[-1]:,}", *grown])
        for then, now in mine:
            times = then["seconds"], now.get("seconds")
            rows.append([*series, then["blocks"], then["status"], now["status"], *times, times[0] / times[1] if times[1] else None])
    return "\n\n".join(
        [
            table(["method", "model", "blocks", f"exponent of the time, {version}", "today"], powers),
            table(["method", "model", "blocks", f"{version} ends", "today", f"{version}, s", "today, s", "times faster"], rows),
        ]
    )


def _size(one: dict[str, Any]) -> tuple[str, str, int]:
    return one["method"], one["dimension"], one["asked"]


def conclusions(measured: Sequence[dict[str, Any]]) -> str:
    """Return the conclusions from the measurements, as a list. A quantity that was not measured has no line."""
    times = {name: _powers(measured, name, "seconds") for name in ("associated", "Coulomb", "YADE")}
    memory, step = _powers(measured, "associated", "memory"), _powers(measured, "step", "step")
    return sentences(
        [
            times["associated"] and f"The time of one bound grows as {times['associated']}.",
            memory and f"Its memory grows as {memory}.",
            times["Coulomb"] and f"The time of Coulomb's prediction grows as {times['Coulomb']}; few sizes were fitted, so this is rough.",
            step and f"One step of YADE grows as {step}.",
            times["YADE"] and f"A whole run of YADE, to its verdict, grows as {times['YADE']}.",
            _memory_per_block(measured),
            *(_solver_share(measured, law) for law in ("Coulomb", "associated")),
            *(_driver_cost(one) for one in measured if one["method"] == "driver"),
        ]
    )


def _powers(measured: Sequence[dict[str, Any]], method: str, quantity: str) -> str:
    """Return the growth of a method in the plane and in 3D, in words; empty where too few sizes are known."""
    found = []
    for dimension, words in (("plane", "in the plane"), ("3D", "in space")):
        growth = fit(*_points([one for one in measured if (one["method"], one["dimension"]) == (method, dimension)], quantity))
        found += [f"N^({growth}) {words}"] if growth else []
    return " and ".join(found)


def _memory_per_block(measured: Sequence[dict[str, Any]]) -> str:
    """State the memory of one more block, between the smallest and the largest size of each method."""
    found = []
    for method, words in (("associated", "a bound"), ("Coulomb", "the prediction"), ("YADE", "YADE")):
        for dimension in ("plane", "3D"):
            of_both = [one for one in measured if (one["method"], one["dimension"]) == (method, dimension)]
            rows = sorted(zip(*_points(of_both, "memory"), strict=True))
            if len(rows) > 1:
                (few, least), (many, most) = rows[0], rows[-1]
                found.append(f"{words} {1024.0 * (most - least) / (many - few):,.0f} KiB ({dimension}, {few:,} to {many:,} blocks)")
    return f"Memory for each further block: {'; '.join(found)}." if found else ""


def _solver_share(measured: Sequence[dict[str, Any]], law: str) -> str:
    """State the size from which the solver takes nine tenths of an analysis, and the time of the rest below this size."""
    sizes, below = [], []
    for dimension, words in (("plane", "in the plane"), ("3D", "in space")):
        rows = sorted(
            (one for one in measured if (one["method"], one["dimension"]) == (f"all of {law}", dimension)), key=lambda one: one["blocks"]
        )
        slow = [k for k, one in enumerate(rows) if one["outside"] >= SMALL_SHARE]
        first = slow[-1] + 1 if slow else 0
        below += [one["build"] + one["rest"] for one in rows[:first]]
        sizes += [f"{rows[first]['blocks']:,} blocks {words}"] if first < len(rows) else []
    if not sizes:
        return ""
    what = "with Coulomb friction" if law == "Coulomb" else "by the associated law (bounds alone)"
    rest = f"; in smaller walls the rest takes up to {number_text(1e3 * max(below), 2)} ms" if below else ""
    return f"In an analysis {what} the solver takes at least nine tenths of the time from {' and '.join(sizes)} on{rest}."


def _driver_cost(row: dict[str, Any]) -> str:
    return (
        f"Moving the support, watching the run and recording it (*driver*) adds {percent(row['overhead'])} to the "
        f"{number_text(row['bare'], 2)} s that YADE takes for the {row['steps']:,} steps of `{row['dimension']}`."
    )


def growth_figure(panels: dict[str, tuple[str, dict[tuple[str, str], list[dict[str, Any]]]]]) -> Figure:
    """Draw the panels with fitted lines. panels: by label of the ordinate, the quantity and its series by method and dimension."""
    figure = Figure(figsize=(5.2 * len(panels), 6.0), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, (label, (quantity, series)) in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels.items(), strict=True):
        axes.set(xscale="log", yscale="log", xlabel="blocks N (-)", ylabel=label)
        axes.grid(True, which="major", color=FAINT, linewidth=0.4, alpha=0.6)
        for (method, dimension), measured in series.items():
            blocks, values = _points(measured, quantity)
            growth = fit(blocks, values)
            words = f"{method}, {dimension}: " + (rf"$N^{{{growth.exponent:.2f} \pm {growth.error:.2f}}}$" if growth else "too few")
            colour = method_colour(method)
            look = {"marker": MARKERS[method], "color": colour, "markersize": 6} | DIMENSIONS[dimension]
            axes.plot(blocks, values, linewidth=0.8, label=words, **look)
            if growth:
                ends = np.array([growth.sizes[0], growth.sizes[-1]], dtype=float)
                axes.plot(ends, growth.factor * ends**growth.exponent, color=INK, linewidth=0.7, linestyle=":")
        if series:
            axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2, frameon=False)
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter(StrMethodFormatter("{x:,.0f}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.yaxis.set_minor_formatter(NullFormatter())
        axes.margins(y=0.06)
    figure.suptitle("Running-bond walls over a settling third; dotted: power laws fitted to the larger sizes", fontsize=10)
    return figure
