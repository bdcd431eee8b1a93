"""Sizes of texts, and labels beside lines and inside bands where they cover no other line."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.ticker import MaxNLocator

ROW = 0.055  # of the height of axes 3.8 inches high: one row of text and its gap to the line
SIZE = 8.0  # pt
TOUCHING = 0.004  # of the axes' height: a label at one of two lines this close does not count as covering the other
LONGEST_NAME, SHORTEST_NAME = 24, 8  # characters of a block's name: longer ones are cut, in a narrow block to no fewer than the second
BOX = {"facecolor": "white", "alpha": 0.75, "linewidth": 0.0, "pad": 0.6}
RIGHT = 0.98  # of the axes' width: the right end of labels, because records fall steeply on the left


@dataclass(frozen=True)
class Word:
    """A label of a line at one value, or of a band between two values.

    Attributes
    ----------
    low, high : float
        Values of the band, in the unit of the axes; equal for a line.
    words : str
        Text of the label, one or more lines.
    colour : str
        Colour of the text.
    named : tuple of str
        Names that the line or band has in the legend; the legend leaves them out once the label is written.
    """

    low: float
    high: float
    words: str
    colour: str
    named: tuple[str, ...]


def font_size(words: str, width: float, height: float) -> float:
    """Return the font size (pt) at which words fit into a width and a height (pt), within the allowed sizes."""
    return float(np.clip(np.min(np.array([width, height]) / extent(words, 1.0)), 5.0, 9.0))


def fitted_name(name: str, width: float, height: float) -> tuple[str, float]:
    """Return the words of a block's name and their font size (pt), as large as a width and a height (pt) allow.

    A long name is cut, in a narrow block to few characters.
    """
    whole = _end(name, LONGEST_NAME)
    split = "\n".join(whole.split()) if whole.count(" ") <= 2 else whole
    sizes = {words: font_size(words, width, height) for words in (whole, split)}
    words = max(sizes, key=lambda one: sizes[one])
    if (needed := extent(words, sizes[words])[0]) > width:  # too wide in the smallest letters
        words = _end(whole, max(int(len(whole) * width / needed), SHORTEST_NAME))
    return words, font_size(words, width, height)


def _end(name: str, most: int) -> str:
    """Return the end of a name, of at most `most` characters, because the end tells the blocks of one wall apart."""
    return name if len(name) <= most else "…" + name[1 - most :].lstrip()


def extent(words: str, size: float) -> np.ndarray:
    """Return the approximate width and height (2,), pt, of words at a font size, pt."""
    lines = words.split("\n")
    return size * np.array([0.62 * max(map(len, lines)), 1.2 * len(lines)])


def axis_numbers(low: float, high: float, most: int, spread: np.ndarray) -> tuple[list[float], list[str]]:
    """Return the ticks of an axis between two values, and the numbers beside them, with enough digits to tell them apart.

    There are about `most` ticks, and fewer where long numbers, such as coordinates of a survey, would cover each other.
    spread: width and height (2,), pt, of a unit of the axis.
    """
    for count in range(most, 0, -1):
        ticks = [float(tick) for tick in MaxNLocator(count, min_n_ticks=2).tick_values(low, high) if low <= tick <= high]
        step = min((after - before for before, after in pairwise(ticks)), default=1e-3 * (high - low))
        digits = max(2 - math.floor(math.log10(step)), 0)
        words = [f"{round(tick, digits) + 0.0:.{digits}f}" for tick in ticks]
        words = [word.rstrip("0").rstrip(".") if digits else word for word in words]
        if all(np.any(extent(word, 7.0) <= step * spread) for word in words):
            break
    return ticks, words


def beside_axis(words: Sequence[str], name: str, room: float) -> np.ndarray:
    """Return additional distances (2,), pt, of the numbers and the name of an upright axis, so that they cover neither each other nor it.

    room: unit of distance, pt. Without the additions the middle of the numbers is at 1.2, and that of the name at 3.4.
    """
    half, of_name = (extent(max(some, key=len), size)[0] / 2.0 for some, size in (([*words, ""], 7.0), ([name], 8.0)))
    aside = max(half - room, 0.0)
    return np.array([aside, max(aside + half + of_name - 2.2 * room, 0.0)])


def write_words(axes: Any, words: Sequence[Word], limits: tuple[float, float], other: Sequence[float] = (), row: float = ROW) -> set[str]:
    """Write the labels that fit, from the top down, lines before bands; return the names of these lines and bands in the legend.

    Labels that do not fit are not written; the legend names their lines.

    Parameters
    ----------
    axes : Axes
        Axes of matplotlib.
    words : sequence of Word
        Labels, in the unit of the axes.
    limits : tuple of float
        Lower and upper end of the axes.
    other : sequence of float
        Further values that labels must not cover.
    row : float
        Height of a row of text, as a share of the axes' height.
    """
    bottom, top = limits

    def share(value: float) -> float:
        return (value - bottom) / (top - bottom)

    lines = sorted((word for word in words if word.low == word.high), key=lambda word: -word.low)
    bands = [word for word in words if word.low != word.high]
    levels = [*(share(word.low) for word in lines), *map(share, other)]
    rows: list[tuple[float, float]] = []
    written: set[str] = set()
    for word in lines:
        level, height = share(word.low), row * len(word.words.splitlines())
        for low, alignment in ((level, "bottom"), (level - height, "top")):
            if _is_free((low, low + height), levels, rows):
                rows.append((low, low + height))
                _write(axes, word, level, alignment)
                written.update(word.named)
                break
    for word in bands:
        height = row * len(word.words.splitlines())
        middle = _widest_gap(max(share(word.low), 0.0), min(share(word.high), 1.0), levels, rows, height)
        if middle is not None:
            rows.append((middle - height / 2.0, middle + height / 2.0))
            _write(axes, word, middle, "center")
            written.update(word.named)
    return written


def _is_free(row: tuple[float, float], levels: Sequence[float], rows: Sequence[tuple[float, float]]) -> bool:
    """Return whether a row, from its lower to its upper end, is inside the axes and covers no line and no other row.

    All values are shares of the axes' height.
    """
    low, high = row
    covers_line = any(low + TOUCHING < level < high - TOUCHING for level in levels)
    covers_row = any(low < end - 1e-9 and start < high - 1e-9 for start, end in rows)
    return low >= 0.0 and high <= 1.0 and not covers_line and not covers_row


def _widest_gap(low: float, high: float, levels: Sequence[float], rows: Sequence[tuple[float, float]], height: float) -> float | None:
    """Return the middle of the highest free gap between `low` and `high`.

    The result is None where the gap is lower than `height`.
    """
    taken = sorted([*((level, level) for level in levels), *rows, (low, low), (high, high)])
    best, reached = (0.0, 0.0), low
    for start, end in taken:
        first, last = max(reached, low), min(start, high)
        best = max(best, (last - first, (first + last) / 2.0))
        reached = max(reached, end)
    return best[1] if best[0] >= height else None


def _write(axes: Any, word: Word, height: float, alignment: str) -> None:
    """Write a label above lines and records, but below marks."""
    offset = {"bottom": 2.0, "top": -3.5, "center": 0.0}[alignment]
    axes.annotate(
        word.words, (RIGHT, height), (0.0, offset), xycoords="axes fraction", textcoords="offset points",
        ha="right", va=alignment, fontsize=SIZE, color=word.colour, bbox=BOX, zorder=4.6,
    )  # fmt: skip
