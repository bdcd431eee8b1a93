"""A tuple of checks that is displayed as a table."""

from collections.abc import Sequence

from comparison.numbers import format_number, range_words
from comparison.verdict.check import Check
from comparison.verdict.verdict_table import check_words
from la_core.text_table import Tabled

HEADINGS = ("check", "verdict", "limit analysis", "YADE", "difference", "tolerance", "unit")
DIGITS = 5


class Checks(tuple[Check, ...], Tabled):
    """Checks that are displayed as a table; a range check has its range there."""

    def _table(self) -> tuple[str, Sequence[str], Sequence[Sequence[str]]]:
        return "checks", HEADINGS, [_cells(check) for check in self]

    __repr__ = Tabled.__repr__


def _cells(check: Check) -> list[str]:
    """Return the cells of a check's row."""
    predicted = range_words(*check.range, DIGITS) if check.range else format_number(check.limit_analysis, DIGITS)
    others = (format_number(value, DIGITS) for value in (check.yade, check.difference, check.tolerance))
    return [check.name, " ".join(check_words(check.verdict)), predicted, *others, check.unit]
