"""The style of all tables in the terminal, and the escape of markup in their texts."""

from rich import box
from rich.markup import escape
from rich.table import Table


def new_table(*headings: str, title: str | None = None) -> Table:
    """Return an empty table in the program's style; long words fold, and markup in title and headings is escaped.

    Cells may contain the terminal library's markup. So texts of users and scenes must go through `plain` first.
    """
    table = Table(*map(plain, headings), title=None if title is None else plain(title), box=box.SIMPLE_HEAD, title_justify="left")
    for column in table.columns:
        column.overflow = "fold"
    return table


def plain(text: str) -> str:
    """Return a text with the terminal library's markup escaped, so that the terminal shows the text unchanged."""
    return escape(text)
