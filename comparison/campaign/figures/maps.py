"""Maps of mechanisms: cells over one or two parameters, lettered by mechanism, limit analysis beside YADE."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from comparison.campaign.figures import shared_axes
from comparison.campaign.mechanism_changes import letters
from comparison.campaign.parameter_labels import label, short, shown
from comparison.campaign.row_groups import SweepRows, key, longest, slices
from comparison.campaign.row_values import LIMIT, WORDS, Row, failed, falls, mechanism_name
from comparison.figures import FAINT, INK
from comparison.numbers import DASH

STRIPS = 8  # scenes in a figure of strips
ROWS = 3  # maps over two parameters in a figure
SHADES = ("#f3f0e8", "#8fb1d3", "#efd3a6", "#9fb09a", "#e3d5ea", "#b9a58f", "#cfe3c3", "#9a9ab8")  # light and dark in turn, for greyscale
FONT = 9.0  # pt
WIDE = 16  # columns; in wider maps only the first of equal neighbours is lettered
BOTH = [LIMIT, "yade"]
APART, FALLS, FAILED = "≠", "↓", "!"


@dataclass(frozen=True)
class MapGrid:
    """Cells of a map.

    Attributes
    ----------
    title : str
        Title.
    rows : list of list
        Case of each cell, by row from the top and by column; None without a case.
    methods : list of str
        Methods to draw.
    row_words, column_words : list of str
        Texts of the ticks.
    across, down : str
        Labels of the axes.
    over : str
        Both parameters in words, for the caption.
    """

    title: str
    rows: list[list[Row | None]]
    methods: list[str]
    row_words: list[str]
    column_words: list[str]
    across: str
    down: str
    over: str


def map_figures(sweeps: list[SweepRows]) -> Iterator[tuple[Figure, str]]:
    """Yield strips over one parameter, with several scenes, then maps over two parameters; each figure with its parameters in words."""
    lettered = letters(sweeps)
    for parameter in dict.fromkeys(sweep.parameters[0] for sweep in sweeps if len(sweep.parameters) == 1):
        along = [sweep for sweep in sweeps if sweep.parameters == [parameter] and _known(sweep.rows) and len(sweep.rows) > 1]
        for k in range(0, len(along), STRIPS):
            yield _strips(parameter, along[k : k + STRIPS], lettered), short(parameter, along[0].named)
    maps = [(sweep.scene, grid) for sweep in sweeps if len(sweep.parameters) > 1 and _known(sweep.rows) for grid in _maps(sweep)]
    for methods in (BOTH, BOTH[:1]):
        alike = [(scene, grid) for scene, grid in maps if grid.methods == methods]
        for k in range(0, len(alike), ROWS):
            group = alike[k : k + ROWS]
            yield _paired(group, lettered), group[0][1].over


def _methods(rows: list[Row]) -> list[str]:
    """Return the methods of these cases: limit analysis, and YADE if any case has a run."""
    return BOTH if any(row.get("yade_status") is not None for row in rows) else BOTH[:1]


def _known(rows: list[Row]) -> bool:
    return any(mechanism_name(row, method) for row in rows for method in BOTH)


def _strips(parameter: str, along: list[SweepRows], lettered: dict[str, dict[str, str]]) -> Figure:
    """Draw two rows per scene: the mechanisms of limit analysis and of YADE at each value."""
    height = sum(0.95 + 0.1 for _ in along)
    figure, axes = shared_axes.panel_figure(len(along), height / len(along) + 0.35, columns=1)
    panels = []
    for place, sweep in zip(axes, along, strict=True):
        values = sweep.values[parameter]
        rows: list[Row | None] = [next(iter(sweep.where({parameter: value})), None) for value in values]
        methods = _methods(sweep.rows)
        row_words = [WORDS[method] for method in methods]
        texts = [shown(value) for value in values]
        grid = MapGrid(sweep.scene, [rows] * len(methods), methods, row_words, texts, label(parameter, sweep.named), "", "")
        panels.append((grid, methods))
        _draw(place, grid, methods, lettered[sweep.scene])
        place.set_title(sweep.scene, fontsize=9, loc="left", parse_math=False)
        if place is not axes[-1]:
            place.set_xlabel("")
    shared_axes.legend(figure, _handles(panels))
    return figure


def _maps(sweep: SweepRows) -> Iterator[MapGrid]:
    """Yield a map over the two parameters with most values, for each combination of the other parameters' values."""
    across, down = longest(sweep)[:2]
    methods = _methods(sweep.rows)
    columns, levels = sweep.values[across], sweep.values[down][::-1]  # the vertical axis points upwards
    right, up = (label(name, sweep.named) for name in (across, down))
    over = " and ".join(short(name, sweep.named) for name in (across, down))
    level_words, column_words = ([shown(value) for value in values] for values in (levels, columns))
    for sweep_slice in slices(sweep, (across, down)):
        places = {(key(row[down]), key(row[across])): row for row in sweep_slice.rows}
        rows = [[places.get((key(low), key(right))) for right in columns] for low in levels]
        yield MapGrid(sweep_slice.title, rows, methods, level_words, column_words, right, up, over)


def _paired(maps: list[tuple[str, MapGrid]], lettered: dict[str, dict[str, str]]) -> Figure:
    """Draw one map per row, limit analysis left and YADE right; maps without YADE stand side by side."""
    tallest = max(len(grid.rows) for _, grid in maps)
    panels = [(scene, grid, method) for scene, grid in maps for method in grid.methods]
    figure, axes = shared_axes.panel_figure(len(panels), float(np.clip(0.32 * tallest, 1.0, 5.0)) + 0.8, columns=2)
    for place, (scene, grid, method) in zip(axes, panels, strict=True):
        _draw(place, grid, [method] * len(grid.rows), lettered[scene])
        place.set_title(f"{grid.title}: {WORDS[method]}", fontsize=9, parse_math=False)
    shared_axes.legend(figure, _handles([(grid, [method] * len(grid.rows)) for _, grid, method in panels]))
    return figure


def _draw(axes: Any, grid: MapGrid, methods: list[str], lettered: Mapping[str, str]) -> None:
    """Draw the cells, lines between different mechanisms, and a sign where the methods differ."""
    for i, (line, method) in enumerate(zip(grid.rows, methods, strict=True)):
        signs = [_sign(row, method, lettered) for row in line]
        for j, row in enumerate(line):
            apart, crowded = _differ(row), len(line) > WIDE
            words = "" if crowded and j and signs[j] == signs[j - 1] else f"{signs[j]} {APART}" if apart and not crowded else signs[j]
            _draw_cell(axes, (j, i), row, _name(row, method), words, lettered, apart)
    for x, y in _borders(grid, methods):
        axes.plot(x, y, color=INK, linewidth=2.4, solid_capstyle="butt", zorder=4)
    _finish(axes, grid)


def _borders(grid: MapGrid, methods: list[str]) -> Iterator[tuple[list[float], list[float]]]:
    """Yield both ends, as x and y, of each line between neighbouring cells of different mechanisms; not between strips of two methods."""
    names = [[_name(row, method) for row in line] for line, method in zip(grid.rows, methods, strict=True)]
    for i, line in enumerate(names):
        for j, name in enumerate(line):
            if j and _changes(line[j - 1], name):
                yield [j - 0.5, j - 0.5], [i - 0.5, i + 0.5]
            if i and methods[i - 1] == methods[i] and _changes(names[i - 1][j], name):
                yield [j - 0.5, j + 0.5], [i - 0.5, i - 0.5]


def _finish(axes: Any, grid: MapGrid) -> None:
    columns, rows = len(grid.column_words), len(grid.row_words)
    axes.set(xlim=(-0.5, columns - 0.5), ylim=(rows - 0.5, -0.5))
    axes.grid(False)
    shown_columns, shown_rows = (range(0, count, -(-count // most)) for count, most in ((columns, 12), (rows, 14)))
    turned = max(len(grid.column_words[k]) for k in shown_columns) * len(shown_columns) > 60
    style = {"rotation": 30, "ha": "right"} if turned else {}
    axes.set_xticks(shown_columns, [grid.column_words[k] for k in shown_columns], parse_math=False, **style)
    axes.set_yticks(shown_rows, [grid.row_words[k] for k in shown_rows], parse_math=False)
    axes.tick_params(length=0)
    axes.set_xlabel(grid.across, fontsize=8, parse_math=False)
    if grid.down:
        axes.set_ylabel(grid.down, fontsize=8, parse_math=False)


def _draw_cell(
    axes: Any, place: tuple[int, int], row: Row | None, name: str | None, words: str, lettered: Mapping[str, str], apart: bool
) -> None:
    """Draw a cell in its mechanism's shade with a text; apart: hatch it because the methods differ."""
    if row is None:
        return
    corner = (place[0] - 0.5, place[1] - 0.5)
    face = SHADES[list(lettered).index(name) % len(SHADES)] if name is not None else "white"
    axes.add_patch(Rectangle(corner, 1.0, 1.0, facecolor=face, edgecolor=FAINT, linewidth=0.4, zorder=1))
    if apart:
        axes.add_patch(Rectangle(corner, 1.0, 1.0, facecolor="none", edgecolor="#8a8a8a", hatch="////", linewidth=0.0, zorder=2))
    if words:
        box = {"facecolor": face, "linewidth": 0.0, "pad": 0.8} if apart else None
        weight = "bold" if apart else "normal"
        axes.text(*place, words, ha="center", va="center", fontsize=FONT, color=INK, weight=weight, bbox=box, zorder=3)


def _sign(row: Row | None, method: str, lettered: Mapping[str, str]) -> str:
    """Return the text of a cell: the mechanism's letter, or a sign for its absence."""
    name = _name(row, method)
    if row is None or name is not None:
        return "" if name is None else lettered[name]
    return FALLS if falls(row, method) else FAILED if failed(row) else DASH


def _name(row: Row | None, method: str) -> str | None:
    return None if row is None else mechanism_name(row, method)


def _changes(first: str | None, second: str | None) -> bool:
    return first is not None and second is not None and first != second


def _differ(row: Row | None) -> bool:
    """Return whether the two methods have different mechanisms in this case."""
    return row is not None and _changes(*(mechanism_name(row, method) for method in BOTH))


def _handles(panels: list[tuple[MapGrid, list[str]]]) -> list[Any]:
    """Return the legend entries of the panels; a panel is a map with the method of each of its rows."""
    cells = [(row, method) for grid, methods in panels for line, method in zip(grid.rows, methods, strict=True) for row in line]
    without = [(row, method) for row, method in cells if row is not None and _name(row, method) is None]
    signs = {_sign(row, method, {}) for row, method in without}
    handles: list[Any] = [
        Patch(facecolor=SHADES[0], edgecolor=FAINT, label="A, B, ...: mechanisms of a scene, equal letters for equal ones")
    ]
    if any(True for panel in panels for _ in _borders(*panel)):
        handles.append(Line2D([], [], color=INK, linewidth=2.4, label="mechanism changes"))
    if any(_differ(row) for row, _ in cells):
        handles.append(Patch(facecolor="white", edgecolor="#8a8a8a", hatch="////", label=f"{APART} methods' mechanisms differ"))
    words = {FAILED: "failed", FALLS: "cannot stand", DASH: "no mechanism known"}
    told = [f"{sign} {word}" for sign, word in words.items() if sign in signs]
    return [*handles, *([Line2D([], [], linestyle="none", label=", ".join(told))] if told else [])]
