"""The one style of tables in the terminal, and the one rule by which texts of others stay texts in them."""

from rich import box
from rich.markup import escape
from rich.table import Table


def new_table(*headings: str, title: str | None = None) -> Table:
    """Return an empty table in the program's style, its title and headings as they are written; long words fold.

    Cells may hold the terminal library's markup: what others wrote goes through `plain` first.
    """
    table = Table(*map(plain, headings), title=None if title is None else plain(title), box=box.SIMPLE_HEAD, title_justify="left")
    for column in table.columns:
        column.overflow = "fold"
    return table


def plain(text: str) -> str:
    """Return a text with the terminal library's markup escaped, so that it is shown as it is written."""
    return escape(text)
