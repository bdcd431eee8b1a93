"""Numbers as texts, and tables of texts as plain text or HTML."""

import html
import math
from collections.abc import Iterable, Sequence
from importlib import import_module
from typing import Any, TypeGuard

from la_core.errors import SceneError, extra_hint

ROUND_OFF = 1e-8  # of the weight: a smaller reaction counts as zero
PLACES = 5  # decimal places of a coordinate, m: no drawing or survey is more accurate than 0.01 mm
OVER_WEIGHT = {"": "", "N": "over W", "N m": "over W, m"}  # headings of values over the weight, by their unit; multipliers have none


def exists(value: Any) -> TypeGuard[float]:
    """Return whether a value is a finite number."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def number_text(value: float | None, digits: int = 6) -> str:
    """A number with `digits` significant digits, or a dash if undefined; below a million the whole part is never shortened."""
    if value is None or not math.isfinite(value):
        return "–"
    rounded = float(f"{value:.{digits}g}") + 0.0  # + 0.0: no negative zero
    text = f"{value:.0f}" if 10.0**digits <= abs(rounded) < 1e6 else f"{value + 0.0:.{digits}g}"
    return text.replace("-", "−", 1) if value < 0.0 else text


def coordinate_text(value: float, places: int = PLACES) -> str:
    """A coordinate, m, with at most `places` decimals however far the origin is, without trailing zeros.

    Digits beyond PLACES are dropped: they are round-off from reading a drawing or from closing its joints.
    """
    text = f"{round(value, min(places, PLACES)) + 0.0:.{places}f}"
    return (text.rstrip("0").rstrip(".") if "." in text else text).replace("-", "−")


def place_text(place: Iterable[float]) -> str:
    """A place, m, such as "(1.5, 0, 2) m": four significant digits below 10 m, else to the centimetre, as in the grid of a survey."""
    return f"({', '.join(number_text(along + 0.0, 4) if abs(along) < 10.0 else coordinate_text(along, 2) for along in place)}) m"


def over_weight(value: float | None, weight: float) -> float | None:
    """A value (N or N m) over the weight (N); 0 where the value is only round-off, None where there is no value."""
    return None if value is None else without_round_off(value, weight) / weight


def without_round_off(value: float, weight: float) -> float:
    """A value (N, N m, multiplier), or 0 where it is only round-off. weight: size to compare with, W in N, or 1 for a multiplier."""
    return 0.0 if abs(value) < ROUND_OFF * weight else value


def as_text(title: str, head: Sequence[str], body: Sequence[Sequence[str]]) -> str:
    """A table as plain text, in the layout of the command line: `title`, headings `head`, rows `body`."""
    widths = [max(len(cell) for cell in column) for column in zip(head, *body, strict=True)]
    lines = ["  " + "   ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in (head, *body)]
    lines.insert(1, " " + "─" * (sum(widths) + 3 * len(widths) - 1))
    return "\n".join([title, *(line.rstrip() for line in lines)])


def as_html(title: str, head: Sequence[str], body: Sequence[Sequence[str]]) -> str:
    """A table as HTML for a notebook: `title`, headings `head`, rows `body`; every text is escaped."""
    lines = [f"<table><caption>{html.escape(title)}</caption>"]
    for row, tag in ((head, "th"), *((row, "td") for row in body)):
        lines.append("<tr>" + "".join(f'<{tag} style="text-align: left">{html.escape(cell)}</{tag}>' for cell in row) + "</tr>")
    return "\n".join([*lines, "</table>"])


def dataframe(rows: Sequence[dict[str, Any]], columns: Sequence[str] | None = None) -> Any:
    """Rows as a table of pandas, NaN where undefined; raises SceneError where pandas is not installed.

    columns: names and order of the columns, also of a table without rows; None takes those of the rows.
    """
    try:
        pandas = import_module("pandas")
    except ImportError as error:
        raise SceneError("to_dataframe", "needs pandas, which is not installed", hint=extra_hint("pandas", "pandas")) from error
    table = pandas.DataFrame(list(rows), columns=None if columns is None else list(columns))
    undefined = [name for name in table if len(table) and table[name].isna().all()]  # pandas leaves None in a column without a number
    return table.astype(dict.fromkeys(undefined, float))


class Tabled:
    """Base class of objects that show themselves as a table: as text in print, as HTML in a notebook."""

    def _table(self) -> tuple[str, Sequence[str], Sequence[Sequence[str]]]:
        """Title, headings and rows."""
        raise NotImplementedError

    def __repr__(self) -> str:
        return as_text(*self._table())

    def _repr_html_(self) -> str:
        return as_html(*self._table())
