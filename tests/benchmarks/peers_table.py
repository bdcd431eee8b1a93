"""Rows of the comparison with peers, their record, and how they are written: few digits and fixed columns, so that the file diffs well."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from statistics import median
from typing import TypeVar

LEAST_REACTION, EQUILIBRIUM = "least reaction", "any equilibrium"
SOLVED, INACCURATE, FAILED, CANNOT = "solved", "inaccurate", "failed", "cannot pose"
OURS = "clarabel, ours"
LEAST_WIDTH = {"CPU s": 7, "range": 18, "clock s": 7, "ratio": 7}  # of columns whose entries change from run to run
Kind = TypeVar("Kind")
LEAST_ERROR = 1e-10  # smaller differences of a value are round-off: they count as this


@dataclass(frozen=True)
class Row:
    """One solver on one scene. value: reaction over the weight; residual: the largest recomputed one; NaN where undefined.

    processor: seconds of the processor, one for each repeat; beside: those of our solve that followed it in the same process;
    clock: of the clock. limit: seconds of the processor after which it was ended without an answer. note: why there is none, or what the
    solver says of itself.
    """

    scene: str
    solver: str
    setting: str
    posed: str
    status: str
    value: float = math.nan
    residual: float = math.nan
    processor: tuple[float, ...] = ()
    beside: tuple[float, ...] = ()
    clock: tuple[float, ...] = ()
    limit: float = math.nan
    note: str = ""

    @property
    def key(self) -> str:
        """What two states of one row share: a solver has a row for each programme that it poses, not for each tolerance it tries."""
        return self.setting.partition(",")[2]

    @property
    def seconds(self) -> float:
        """Median over the repeats, of the processor."""
        return median(self.processor) if self.processor else math.nan

    @property
    def ratio(self) -> float:
        """Median over the repeats of its seconds over those of ours right after it: other work on the machine slows both."""
        return median(a / b for a, b in zip(self.processor, self.beside, strict=True)) if self.beside else math.nan


def best_known(rows: Sequence[Row], scene: str) -> float:
    """Value of the certified answer with the least residual; NaN where there is none."""
    certified = [row for row in rows if (row.scene, row.posed, row.status) == (scene, LEAST_REACTION, SOLVED)]
    return min(certified, key=lambda row: row.residual).value if certified else math.nan


def error(row: Row, reference: float) -> float:
    """Relative error of the least reaction, NaN for a row that did not ask for it."""
    if row.posed == LEAST_REACTION and math.isfinite(row.value) and reference:
        return max(abs(row.value - reference) / abs(reference), LEAST_ERROR)
    return math.nan


def limit_table(rows: Sequence[Row]) -> str:
    """Markdown of the rows, in their order."""
    heads = ("scene", "solver", "setting", "posed", "status", "R/W", "error", "residual", "CPU s", "range", "clock s", "ratio", "note")
    lines = []
    for row in rows:
        wrong = power(error(row, best_known(rows, row.scene)))
        clock, bound = median(row.clock) if row.clock else math.nan, row.limit / own_seconds(rows, row.scene)
        spread = f"{number(min(row.processor))} to {number(max(row.processor))}" if len(row.processor) > 1 else "–"
        lines.append(
            (
                row.scene, row.solver, row.setting, row.posed, row.status,
                f"{row.value:.6f}" if math.isfinite(row.value) else "–", wrong, power(row.residual),
                at_least(row.seconds, row.limit), spread, number(clock), at_least(row.ratio, bound), row.note,
            )
        )  # fmt: skip
    return markdown(heads, lines)


def summary_table(rows: Sequence[Row]) -> str:
    """Markdown: for each scene our seconds, HiGHS's better algorithm and the fastest peer, by ratios of certified answers alone."""
    lines = []
    for scene in dict.fromkeys(row.scene for row in rows):
        certified = [row for row in rows if (row.scene, row.status) == (scene, SOLVED) and math.isfinite(row.ratio)]
        own = [row for row in certified if row.solver == OURS]
        highs = [row for row in certified if row.solver.startswith("HiGHS")]
        others = [row for row in certified if row.solver != OURS]
        lines.append((scene, number(own[0].seconds) if own else "–", *_fastest(highs), *_fastest(others)))
    return markdown(("scene", "ours, CPU s", "HiGHS's better algorithm", "ratio", "fastest peer", "ratio"), lines)


def _fastest(rows: Sequence[Row]) -> tuple[str, str]:
    best = min(rows, key=lambda row: row.ratio, default=None)
    return ("none certified", "–") if best is None else (f"{best.solver}, {best.setting}", number(best.ratio))


def own_seconds(rows: Sequence[Row], scene: str) -> float:
    """Our own seconds on a scene, NaN where they are not known."""
    return next((row.seconds for row in rows if (row.scene, row.solver) == (scene, OURS)), math.nan)


def at_least(value: float, bound: float) -> str:
    """A number, or what it is above where there is only a bound."""
    return f"> {number(bound)}" if math.isnan(value) and math.isfinite(bound) else number(value)


def number(value: float, digits: int = 2) -> str:
    """A number with so many significant digits, a dash where there is none."""
    if not math.isfinite(value):
        return "–"
    rounded = float(f"{value:.{digits - 1}e}")
    if rounded == 0.0 or 1e-3 <= abs(rounded) < 1e5:
        places = max(0, digits - 1 - math.floor(math.log10(abs(rounded)))) if rounded else 0
        return f"{rounded:.{places}f}"
    return f"{rounded:.{digits - 1}e}"


def power(value: float) -> str:
    """A small number by its power of ten and one digit."""
    return f"{value:.0e}" if math.isfinite(value) else "–"


def markdown(heads: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """A Markdown table whose columns are as wide as their longest entry, and wide enough for any number."""
    widths = [max(LEAST_WIDTH.get(head, 0), *(len(line[k]) for line in [heads, *lines])) for k, head in enumerate(heads)]
    written = [heads, ["-" * width for width in widths], *lines]
    return "\n".join("| " + " | ".join(text.ljust(width) for text, width in zip(line, widths, strict=True)) + " |" for line in written)


def as_record(row: object) -> dict:
    """A row's fields for JSON, undefined numbers as null."""
    content = {field.name: getattr(row, field.name) for field in fields(row)}  # type: ignore[arg-type]
    return {name: None if isinstance(value, float) and not math.isfinite(value) else value for name, value in content.items()}


def restored(kind: type[Kind], record: dict) -> Kind:
    """A row from its record: null is an undefined number, a list a tuple."""
    content = {name: math.nan if value is None else tuple(value) if isinstance(value, list) else value for name, value in record.items()}
    return kind(**content)
