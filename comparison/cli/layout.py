"""Fit the output to the width of the terminal: tables lose columns that they can spare, and sentences break between words."""

import os
import textwrap
from collections.abc import Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from comparison.numbers import DASH

LEAST_WIDTH = 40  # columns: below, a table is unreadable however it is laid out
INDENT = "  "  # of the second and later lines of a sentence


def columns_asked() -> int | None:
    """Return the width that COLUMNS asks for, at least LEAST_WIDTH; None where it asks for none."""
    columns = os.environ.get("COLUMNS", "")
    return max(int(columns), LEAST_WIDTH) if columns.isdecimal() and len(columns) < 5 and int(columns) else None


def say(console: Console, text: str) -> None:
    """Print sentences, each line broken between words where a terminal or COLUMNS sets a width.

    In a pipe without COLUMNS a line stays whole, for programs that read line by line.
    """
    width = columns_asked() or (max(console.width, LEAST_WIDTH) if console.is_terminal else None)
    for line in text.split("\n"):
        console.print(line if width is None else _broken(line, width), markup=False)


def _broken(line: str, width: int) -> str:
    lead = line[: len(line) - len(line.lstrip())]
    wrapped = textwrap.wrap(line, width, subsequent_indent=lead + INDENT, break_long_words=False, break_on_hyphens=False)
    return "\n".join(wrapped)


def show_table(console: Console, table: Table, can_go: Sequence[str] = (), whole: bool = False) -> None:
    """Print a table, its title as a sentence above it.

    Parameters
    ----------
    console : Console
        Console whose width the table is to fit.
    table : Table
        Table in the program's style.
    can_go : sequence of str
        Headings of the columns that a narrow table leaves out, in this order.
    whole : bool
        Whether to print every column, even where the table is then wider than the terminal.
    """
    title, table.title = Text.from_markup(str(table.title or ""), emoji=False).plain, None
    gone = set() if whole else _gone(table, console.width, can_go)
    if gone:
        title += f" (--long: also {', '.join(heading for heading in can_go if heading in gone)})"
    if title:
        say(console, title)
    terminal = console.width
    # A console prints nothing wider than itself. A table that may lose columns breaks no number, so it may be wider than the terminal.
    console.width = max(terminal, _width(table, gone)) if can_go else terminal
    console.print(_without(table, gone) if gone else table)
    console.width = terminal


def _gone(table: Table, width: int, can_go: Sequence[str]) -> set[str]:
    """Return the headings of the columns that a table must lose to fit into a width; columns without any value go first."""
    gone: set[str] = set()
    empty = {str(column.header) for column in table.columns if set(column.cells) <= {DASH}}
    for heading in sorted(can_go, key=lambda heading: heading not in empty):
        if _width(table, gone) > width:
            gone.add(heading)
    return gone


def _without(table: Table, gone: set[str]) -> Table:
    """Return a copy of a table without some of its columns."""
    kept = [column for column in table.columns if column.header not in gone]
    short = Table(box=table.box)
    for column in kept:
        short.add_column(column.header, justify=column.justify, overflow=column.overflow, min_width=column.min_width)
    for row in zip(*(column.cells for column in kept), strict=True):
        short.add_row(*row)
    return short


def _width(table: Table, gone: set[str]) -> int:
    """Return the columns of a terminal that a table needs without these columns, where no cell is broken."""
    kept = [column for column in table.columns if column.header not in gone]
    return 1 + sum(3 + max(_cell_width(cell) for cell in (column.header, *column.cells)) for column in kept)


def _cell_width(cell: object) -> int:
    return max((Text.from_markup(line, emoji=False).cell_len for line in str(cell).split("\n")), default=0)
