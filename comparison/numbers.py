"""Numbers as text: rounded to significant digits, with a dash for an undefined one, and in the units of a report."""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

from la_core.text_table import exists, without_round_off

POINT = 1e-4  # of the value: an interval narrower than this is a point
LEAST_UNCERTAINTY = 1e-7  # a smaller uncertainty is round-off: a tenth of a solver's allowed residual
MOST_PLACES = 6  # decimal places of a small number; a number that needs more is written with an exponent
NEARLY_ZERO = "≈ 0"
LEAST_SHARE = 1e-3  # per cent: a smaller difference is shown as NEARLY_ZERO
A_POINT = "a point"
DASH = "–"  # text of an undefined number
SAME_STIFFNESS = 1e-9  # relative difference below which two stiffnesses count as equal
SMALL = 100.0  # N: structures that weigh less are reported in N, all others in kN


def format_number(value: Any, digits: int = 4) -> str:
    """Return a number rounded to `digits` significant digits, or a dash for a value that is no finite number.

    An exponent is used only for numbers from a million on and below a thousandth.
    """
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


def small_number(value: Any, scale: Any, digits: int = 3) -> str:
    """Return a number with the decimal places that `scale` has at `digits` significant digits.

    A difference has the places of the value or the tolerance that it is compared with, because further digits mean nothing. A number
    that rounds to 0 in these places is NEARLY_ZERO, unless it is exactly 0. Where the scale is zero or undefined, or needs more than
    MOST_PLACES, the number has `digits` significant digits of its own.
    """
    if not (exists(value) and value and exists(scale) and scale):
        return format_number(value, digits)
    places = max(0, digits - 1 - math.floor(math.log10(abs(scale))))
    rounded = round(value, places)
    if not rounded:
        return NEARLY_ZERO
    return f"{rounded:.{places}f}".replace("-", "−") if places <= MOST_PLACES else format_number(value, digits)


def plain_number(value: Any, digits: int = 2) -> str:
    """Return a small number, such as a tolerance, without trailing zeros, and without an exponent unless it needs more than MOST_PLACES."""
    text = small_number(value, value, digits)
    return text.rstrip("0").rstrip(".") if "." in text and "e" not in text else text


def with_uncertainty(value: Any, uncertainty: Any) -> str:
    """Return a value and its uncertainty as text, both rounded to the first digit of the uncertainty.

    An uncertainty is left out where it is unknown, is below LEAST_UNCERTAINTY, or changes none of the value's first five digits.
    """
    text = format_number(value, 5)
    if not (exists(value) and exists(uncertainty)) or uncertainty < LEAST_UNCERTAINTY or format_number(value + uncertainty, 5) == text:
        return text
    places = max(0, -math.floor(math.log10(uncertainty)))
    return f"{round(value, places) + 0.0:.{places}f} ± {uncertainty:.{places}f}".replace("-", "−")  # 0.0: without a negative zero


def several_plateaus(values: Any, unit: str) -> str:
    """Return the values of several plateaus in `unit` as text; "" where there are none."""
    return f"several plateaus: {', '.join(format_number(value, 4) for value in values)} {unit}".rstrip() if values else ""


def value_range(low: Any, high: Any, unbounded: bool, digits: int) -> str:
    """Return two bounds as text, a dash where the lower one is undefined.

    Parameters
    ----------
    low, high : float or None
        The two bounds.
    unbounded : bool
        Whether there is no upper bound.
    digits : int
        Significant digits.
    """
    if not exists(low):
        return DASH
    return f"at least {format_number(low, digits)}" if unbounded else f"{format_number(low, digits)} to {format_number(high, digits)}"


def range_words(low: Any, high: Any, digits: int) -> str:
    """Return a range as text with `digits` significant digits; one end may be missing, and the text is "" where both are."""
    if not exists(low):
        return f"at most {format_number(high, digits)}" if exists(high) else ""
    return value_range(low, high, not exists(high), digits)


def interval_words(low: Any, high: Any, unit: str) -> str:
    """Return an interval in `unit` as text, a dash where both ends are missing; one narrower than POINT is "a point"."""
    if not exists(low) and not exists(high):
        return DASH
    if exists(low) and exists(high):
        if high - low <= POINT * max(abs(low), abs(high)):
            return A_POINT
        return f"{format_number(low, 5)} to {format_number(high, 5)} {unit}".rstrip()
    return f"{range_words(low, high, 5)} {unit}".rstrip()


def half_width(low: Any, high: Any) -> float | None:
    """Return half of an interval's width, at least 0; None where an end is unknown."""
    return max(high - low, 0.0) / 2.0 if exists(low) and exists(high) else None


def signed(value: float, digits: int) -> str:
    """Return a number rounded to `digits` significant digits, with its sign even where it is a plus."""
    return ("+" if value > 0.0 else "") + format_number(value, digits)


def class_words(joints: dict[str, Any]) -> str:
    """Return the joints of a class in words; `joints` is an entry of `la_core.scene.classes_as_dicts`."""
    kind = f"{joints['joints']} joints" if joints["joints"] else "joints"
    return f"{kind} between {' and '.join(joints['between'])}" if joints["between"] else kind


def share_of(difference: Any, value: Any, digits: int = 2) -> str:
    """Return a difference in per cent of a value, with its sign; NEARLY_ZERO below LEAST_SHARE, a dash where it is undefined."""
    if not (exists(difference) and exists(value) and value):
        return DASH
    share = 100.0 * difference / abs(value)
    return f"{NEARLY_ZERO if 0.0 < abs(share) < LEAST_SHARE else signed(share, digits)} %"


def percent(share: float | None, digits: int = 2) -> str:
    """Return a share in per cent with some significant digits, from 100 % on without decimals, or a dash where it is undefined."""
    if share is None or not math.isfinite(share):
        return DASH
    share += 0.0  # turns -0.0 into 0.0, so that the text has no sign
    text = f"{100.0 * share:.0f} %" if abs(share) >= 0.995 else f"{100.0 * share:.{digits}g} %"
    return text.replace("-", "−", 1) if share < 0.0 else text


def plural(count: int, word: str) -> str:
    """Return a count with its word, in the plural unless the count is 1: "2 cases"."""
    return f"{count} {word}{'' if count == 1 else 's'}"


def first_names(names: Sequence[str], most: int) -> str:
    """Return the first names, at most this many, and the number of the others."""
    others = len(names) - most
    return ", ".join(names[:most]) + (f" and {others} more" if others > 0 else "")


def first_sentence(text: str) -> str:
    """Return the first sentence of a text, for places without room for the rest."""
    return sentences(text)[0]


def sentences(text: str) -> list[str]:
    """Return the sentences of a text, each with its full stop."""
    *ended, last = text.split(". ")
    return [*(f"{sentence}." for sentence in ended), last]


def said_once(texts: Iterable[str]) -> list[str]:
    """Return texts without the sentences of earlier texts; empty texts are left out."""
    said: dict[str, None] = {}
    kept = []
    for text in texts:
        new = [sentence for sentence in dict.fromkeys(sentences(text)) if sentence and sentence not in said]
        said |= dict.fromkeys(new)
        kept += [" ".join(new)] if new else []
    return kept


def force_unit(weight: Any, unit: str = "N") -> tuple[float, str]:
    """Return the size, in SI units, of the unit in which a structure's forces are reported, and its name.

    Parameters
    ----------
    weight : float or None
        Weight of the structure, N.
    unit : str
        "N", "N m" for moments, or "" for a multiplier, which has no unit.
    """
    if unit not in ("N", "N m") or (exists(weight) and weight < SMALL):
        return 1.0, unit
    return 1e3, f"k{unit}"


def settlement_text(settlement: float, unit: str) -> str:
    """Return a settlement, m or rad, in its unit for readers, which is "mm" or "mrad"."""
    return f"{1e3 * settlement:.3g} {unit}"


def round_below(value: float) -> float:
    """Return the largest of 1, 2 and 5 times a power of ten that is not above a positive value."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= value * (1.0 + 1e-12))


LENGTHS = {"m": (1e-3, "mm"), "rad": (1e-3, "mrad")}
# Numbers of one SI unit within a sentence: "2552.39 to 3340.92 N", "363.3 ± 0.1 N", "363.3, 402 N", "12.5 N m", "4e-05 m".
_NUMBER = r"[-−]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
# A name between double quotes, such as "pier 2 m", has no number to convert.
_IN_WORDS = re.compile(rf"\"[^\"]*\"|(?<![\w.])(?P<numbers>{_NUMBER}(?:(?: to | ± |, ){_NUMBER})*) (?P<unit>N m|N|m)(?![\w/0-9])")
LONGEST_TEXT = 10  # characters of a number that is written without a power of ten


@dataclass(frozen=True)
class Units:
    """Units of one structure in a report.

    Attributes
    ----------
    weight : float or None
        Weight of the structure, N; it decides between N and kN.
    """

    weight: float | None

    def of(self, unit: str) -> tuple[float, str]:
        """Return size and name of the report's unit for an SI unit such as "N", "N m", "N/m", "m" or "rad"; other units stay."""
        if unit == "N/m":
            size, force = force_unit(self.weight)
            return 1e3 * size, f"{force}/mm"
        return LENGTHS.get(unit) or force_unit(self.weight, unit)

    def value(self, value: Any, unit: str) -> float | None:
        """Return a value, given in an SI unit, in the report's unit: 0 for a force that is only round-off, None where undefined."""
        if not exists(value):
            return None
        if unit in ("N", "N m") and exists(self.weight):
            value = without_round_off(value, self.weight)
        return value / self.of(unit)[0]

    def text(self, value: Any, unit: str, digits: int = 4) -> str:
        """Return a value, given in an SI unit, as text in the report's unit; a dash where it is undefined."""
        return f"{format_number(self.value(value, unit), digits)} {self.of(unit)[1]}".rstrip() if exists(value) else DASH

    def words(self, sentence: str) -> str:
        """Return a sentence with its forces and lengths in the report's units."""
        return _IN_WORDS.sub(self._shown, sentence)

    def _shown(self, found: re.Match[str]) -> str:
        if found["unit"] is None:
            return found[0]
        size, unit = self.of(found["unit"])
        return f"{re.sub(_NUMBER, lambda number: _scaled(number[0], size), found['numbers'])} {unit}"


def _scaled(number: str, size: float) -> str:
    """Return a number, given as text, divided by a power of ten, with the same digits."""
    scaled = Decimal(number.replace("−", "-")).scaleb(-round(math.log10(size)))
    text = f"{scaled:f}".replace("-", "−")
    return text if len(text) <= LONGEST_TEXT else format_number(float(scaled), _digits(number))


def _digits(number: str) -> int:
    """Return the significant digits of a number as text, at least 2."""
    mantissa = re.sub(r"[-−.]", "", re.split("e", number)[0]).lstrip("0")
    return max(len(mantissa), 2)
