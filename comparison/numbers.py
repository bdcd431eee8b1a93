"""Numbers as the report shows them: so many significant digits, a dash for one that does not exist."""

import math
from typing import Any, TypeGuard

POINT = 1e-4  # of the value: an interval narrower than this is a point
A_POINT = "a point"
DASH = "–"  # what a number that does not exist is shown as


def format_number(value: Any, digits: int = 4) -> str:
    """A number to so many significant digits, with an exponent only beyond a million or below a thousandth; a dash for none."""
    if not exists(value):
        return DASH
    if float(value).is_integer() and abs(value) < 1e6:
        return str(int(value)).replace("-", "−")
    rounded = float(f"{value:.{digits - 1}e}")
    magnitude = math.floor(math.log10(abs(rounded)))
    if -3 <= magnitude < 6:
        text = f"{rounded:.{max(0, digits - 1 - magnitude)}f}"
    else:
        mantissa, exponent = f"{rounded:.{digits - 1}e}".split("e")
        mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
        text = f"{mantissa}e{int(exponent)}"
    return text.replace("-", "−", 1) if rounded < 0 else text


def exists(value: Any) -> TypeGuard[float]:
    """Whether a value is a finite number."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def value_range(low: Any, high: Any, unbounded: bool, digits: int) -> str:
    """Two bounds in words; `unbounded` is the greater one."""
    if not exists(low):
        return DASH
    return f"at least {format_number(low, digits)}" if unbounded else f"{format_number(low, digits)} to {format_number(high, digits)}"


def interval_words(low: Any, high: Any, unit: str) -> str:
    """An interval in words, a dash for the end that is not known; a point where it has no width to speak of."""
    if not exists(low) and not exists(high):
        return DASH
    if exists(low) and exists(high) and high - low <= POINT * max(abs(low), abs(high)):
        return A_POINT
    return f"{format_number(low, 5)} to {format_number(high, 5)} {unit}".rstrip()


def half_width(low: Any, high: Any) -> float | None:
    """Half of an interval's width, None where an end is not known; that of a point is not below zero by rounding."""
    return max(high - low, 0.0) / 2.0 if exists(low) and exists(high) else None


def signed(value: float, digits: int) -> str:
    """A number that shows its plus, too."""
    return ("+" if value > 0.0 else "") + format_number(value, digits)


def plural(count: int, word: str) -> str:
    """So many of what a word names, whose plural ends in s."""
    return f"{count} {word}{'' if count == 1 else 's'}"


def first_sentence(text: str) -> str:
    """What comes before the second sentence of a text: the rest is told where there is room."""
    first, more, _ = text.partition(". ")
    return f"{first}." if more else first
