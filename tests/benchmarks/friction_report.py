"""Tables, conclusions and figure of the page friction.md, from the record of predictions with friction."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from friction_record import ALIKE, COARSER, DEFAULT, GALLERY, RECORD, REFERENCE, SMOOTH, Result, read
from marked_text import sentences, with_part
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from rich.table import Table

from comparison.figures import FAINT, INK, method_colour
from comparison.numbers import percent
from la_core.text_table import number_text

PART, SMOOTH_PART = "predictions", "smooth joints"  # parts of friction.md that are written from the record
FAR = 0.01  # relative; a larger difference would decide a verdict
NAMES = (
    "settings",
    "median error",
    "90 %",
    "worst",
    "median uncertainty",
    "uncertainty holds",
    "worst excess",
    "several",
    "not solved",
    "s",
)


def rows(results: list[Result], names: tuple[str, ...] = (COARSER, DEFAULT, REFERENCE)) -> Iterator[tuple[str, ...]]:
    """One row for each setting: errors against the reference, stated uncertainties, and cost."""
    for name in names:
        runs = [result.runs[name] for result in results]
        off = np.array([result.deviation(name) for result in results])
        stated = np.array([result.runs[name].uncertainty / result.scale for result in results])
        excess = np.array([result.excess(name) for result in results])
        errors = [percent(float(error)) for error in (np.median(off), np.quantile(off, 0.9), off.max())]
        holds = [f"{np.sum(excess <= 1.0)} of {len(results)}", f"{excess.max():.1f}"]
        yield (
            name,
            *(errors if name != REFERENCE else ["", "", ""]),
            percent(float(np.median(stated))),
            *(holds if name != REFERENCE else ["", ""]),
            f"{sum(len(one.plateaus) > 1 for one in runs)}",
            f"{sum(one.status != 'solved' for one in runs)}",
            f"{sum(one.seconds for one in runs):.0f}",
        )


def summary(results: list[Result]) -> Table:
    """One row for each setting."""
    table = Table(title=f"{len(results)} walls. Errors and uncertainties are relative to the reaction of the reference.")
    for name in NAMES:
        table.add_column(name, justify="right")
    for row in rows(results):
        table.add_row(*row)
    return table


def listing(results: list[Result]) -> Table:
    """One row for each wall."""
    table = Table("wall", "reference", "its uncertainty", "default", "off", "stated", "excess", "travel", "certificate", "plateaus")
    for result in results:
        fine, one = result.runs[REFERENCE], result.runs[DEFAULT]
        table.add_row(
            str(result.case),
            f"{fine.value:.6f}",
            f"{fine.uncertainty / result.scale:.3%}",
            f"{one.value:.6f}",
            f"{result.deviation(DEFAULT):.3%}",
            f"{one.uncertainty / result.scale:.3%}",
            f"{result.excess(DEFAULT):.1f}",
            f"{one.travel:.1f}",
            f"{one.certificate:.0e}",
            " ".join(f"{value:.4f}" for value in one.plateaus),
        )
    return table


def page_part(folder: Path = GALLERY) -> str:
    """Return the table and conclusions of the page friction.md, from the record in the folder."""
    results = read(folder / RECORD)
    table = [NAMES, ("---",) * len(NAMES), *rows(results)]
    return "\n".join(f"| {' | '.join(row)} |" for row in table) + "\n\n" + conclusions(results)


def smooth_part(folder: Path = GALLERY) -> str:
    """Return the table of predictions with smooth joints, one row per number of blocks, and its conclusions."""
    results = [result for result in read(folder / RECORD) if SMOOTH in result.runs]
    sizes = sorted({result.case.per_course * result.case.courses for result in results})
    table = [("blocks", *NAMES[1:]), ("---",) * len(NAMES)]
    for size in sizes:
        alike = [result for result in results if result.case.per_course * result.case.courses == size]
        table += [(str(size), *row[1:]) for row in rows(alike, (SMOOTH,))]
    failed = [result.runs[SMOOTH].uncertainty / result.scale for result in results if result.excess(SMOOTH) > 1.0]
    warned = f"These walls state at least {percent(min(failed))}, too much for a verdict." if failed and min(failed) > FAR else ""
    said = sentences([f"The stated uncertainty {_held(results, SMOOTH)}.", warned])
    return "\n".join(f"| {' | '.join(row)} |" for row in table) + "\n\n" + said


def conclusions(results: list[Result]) -> str:
    """Return the conclusions from the table."""
    off = [result.deviation(DEFAULT) for result in results]
    each = sum(result.runs[DEFAULT].seconds for result in results) / len(results)
    return sentences(
        [
            f"By default nine predictions in ten are within {percent(float(np.quantile(off, 0.9)))} of the reference and all "
            f"{len(results)} within {percent(max(off))}, for {number_text(each, 2)} s a wall on average.",
            *_far(results),
            f"The stated uncertainty {_held(results, DEFAULT)}; that of coarser paths {_held(results, COARSER)}.",
        ]
    )


def _far(results: list[Result]) -> Iterator[str]:
    """Yield the sizes and the least stated uncertainty of walls that are far from the reference, if there are any."""
    far = [result for result in results if result.deviation(DEFAULT) > FAR]
    if far:
        stated = min(result.runs[DEFAULT].uncertainty / result.scale for result in far)
        least = min(result.case.per_course * result.case.courses for result in far)
        yield (
            f"{len(far)} walls are off by more than {percent(FAR)}: they have {least} blocks and more, and each states an "
            f"uncertainty of at least {percent(stated)}."
        )


def _held(results: list[Result], name: str) -> str:
    """State the number of walls on which the stated uncertainty holds, and the largest excess on the others."""
    excess = [result.excess(name) for result in results]
    held = sum(one <= 1.0 for one in excess)
    fails = f"; elsewhere the difference is up to {number_text(max(excess), 2)} times as large" if held < len(results) else ""
    return f"holds on {held} of {len(results)} walls{fails}"


def figure(results: list[Result]) -> Figure:
    """Draw the stated uncertainty of every wall over its difference from the reference, for coarser paths and for the default."""
    drawn = Figure(figsize=(5.6, 5.0), layout="constrained")
    FigureCanvasAgg(drawn)
    axes = drawn.subplots()
    looks: dict[str, dict[str, Any]] = {
        COARSER: {"marker": "^", "color": INK, "markerfacecolor": "none"},
        DEFAULT: {"marker": "o", "color": method_colour(DEFAULT)},
    }
    for name, look in looks.items():
        places = [(max(result.deviation(name), ALIKE), result.runs[name].uncertainty / result.scale) for result in results]
        axes.plot(*zip(*places, strict=True), linestyle="none", markersize=4.5, markeredgewidth=0.8, alpha=0.8, label=name, **look)
    axes.set(xscale="log", yscale="log", xlabel="difference from the reference (-)", ylabel="stated uncertainty (-)")
    ends = [ALIKE / 2.0, 2.0 * axes.get_ylim()[1]]
    axes.plot(ends, ends, color=INK, linewidth=0.8, linestyle="--", label="equal: above it the uncertainty holds")
    axes.set(xlim=(ALIKE / 2.0, None), ylim=(1e-4, None))
    axes.grid(True, which="major", color=FAINT, linewidth=0.4, alpha=0.6)
    axes.set_title(f"{len(results)} walls, relative to the reaction; differences below {ALIKE:g} are drawn there", fontsize=8)
    axes.legend(fontsize=8, loc="upper left")
    return drawn


def write_page(folder: Path = GALLERY) -> None:
    """Write both parts of friction.md and the figure from the record in the folder."""
    page = folder / "friction.md"
    text = with_part(page.read_text(encoding="utf-8"), PART, page_part(folder))
    page.write_text(with_part(text, SMOOTH_PART, smooth_part(folder)), encoding="utf-8")
    figure(read(folder / RECORD)).savefig(folder / "friction.png", dpi=110)
