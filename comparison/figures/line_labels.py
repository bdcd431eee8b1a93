"""Words next to lines and inside bands, where they fit without covering another line."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

ROW = 0.055  # of the axes' height: a row of words with its gap to the line
SIZE = 8.0  # pt
TOUCHING = 0.004  # of the axes' height: words at one of two lines this close do not count as covering the other
BOX = {"facecolor": "white", "alpha": 0.75, "linewidth": 0.0, "pad": 0.6}
RIGHT = 0.98  # of the axes' width: where words end, because records fall on the left


@dataclass(frozen=True)
class Word:
    """Words for a line at one value, or for a band between two; `named` is what the legend calls what they stand for."""

    low: float
    high: float
    words: str
    colour: str
    named: tuple[str, ...]


def write_words(axes: Any, words: Sequence[Word], limits: tuple[float, float], other: Sequence[float] = ()) -> set[str]:
    """Write what fits into axes with these limits, from the top down, lines before bands; returns the `named` of what was written.

    `other` are values that words keep off, too. What does not fit is left to the legend.
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
        level = share(word.low)
        for low, alignment in ((level, "bottom"), (level - ROW, "top")):
            if _is_free(low, levels, rows):
                rows.append((low, low + ROW))
                _write(axes, word, level, alignment)
                written.update(word.named)
                break
    for word in bands:
        height = ROW * len(word.words.splitlines())
        middle = _widest_gap(max(share(word.low), 0.0), min(share(word.high), 1.0), levels, rows, height)
        if middle is not None:
            rows.append((middle - height / 2.0, middle + height / 2.0))
            _write(axes, word, middle, "center")
            written.update(word.named)
    return written


def _is_free(low: float, levels: Sequence[float], rows: Sequence[tuple[float, float]]) -> bool:
    """Whether a row from `low` on lies inside the axes and covers no line and no other row."""
    high = low + ROW
    covers_line = any(low + TOUCHING < level < high - TOUCHING for level in levels)
    covers_row = any(low < end - 1e-9 and start < high - 1e-9 for start, end in rows)
    return low >= 0.0 and high <= 1.0 and not covers_line and not covers_row


def _widest_gap(low: float, high: float, levels: Sequence[float], rows: Sequence[tuple[float, float]], height: float) -> float | None:
    """Middle of the highest free stretch between low and high; None where it is lower than `height`."""
    taken = sorted([*((level, level) for level in levels), *rows, (low, low), (high, high)])
    best, reached = (0.0, 0.0), low
    for start, end in taken:
        first, last = max(reached, low), min(start, high)
        best = max(best, (last - first, (first + last) / 2.0))
        reached = max(reached, end)
    return best[1] if best[0] >= height else None


def _write(axes: Any, word: Word, height: float, alignment: str) -> None:
    """Words over lines and records, but under marks."""
    offset = {"bottom": 2.0, "top": -3.5, "center": 0.0}[alignment]
    axes.annotate(
        word.words, (RIGHT, height), (0.0, offset), xycoords="axes fraction", textcoords="offset points",
        ha="right", va=alignment, fontsize=SIZE, color=word.colour, bbox=BOX, zorder=4.6,
    )  # fmt: skip
