"""Rows of the comparison with peers, their record and their tables. Few digits and fixed columns keep changes of the file small."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from statistics import median
from typing import TypeVar

LEAST_REACTION, EQUILIBRIUM = "least reaction", "any equilibrium"
SOLVED, INACCURATE, FAILED, CANNOT = "solved", "inaccurate", "failed", "cannot pose"
OURS = "clarabel, ours"
LEAST_WIDTH = {"CPU s": 7, "range": 18, "clock s": 7, "ratio": 7}  # characters, of columns whose entries change from run to run
Kind = TypeVar("Kind")
LEAST_ERROR = 1e-10  # relative; smaller errors are round-off and count as this


@dataclass(frozen=True)
class Row:
    """One solver on one scene. value: reaction over the weight; residual: the largest recomputed residual; NaN where undefined.

    processor: processor seconds of each repeat; beside: processor seconds of our solve that followed the repeat in the same process; clock:
    wall seconds of each repeat. limit: processor seconds after which the solver was ended without an answer. note: reason for a missing
    answer, or the solver's own message.
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
        """Key of a row among a solver's rows: a solver has one row for each programme that it solves, not for each tolerance."""
        return self.setting.partition(",")[2]

    @property
    def seconds(self) -> float:
        """Median of the processor seconds over the repeats."""
        return median(self.processor) if self.processor else math.nan

    @property
    def ratio(self) -> float:
        """Median over the repeats of the solver's seconds over those of our next solve. Other work on the machine slows both."""
        return median(a / b for a, b in zip(self.processor, self.beside, strict=True)) if self.beside else math.nan


def best_known(rows: Sequence[Row], scene: str) -> float:
    """Return the value of the certified answer with the least residual; NaN without a certified answer."""
    certified = [row for row in rows if (row.scene, row.posed, row.status) == (scene, LEAST_REACTION, SOLVED)]
    return min(certified, key=lambda row: row.residual).value if certified else math.nan


def error(row: Row, reference: float) -> float:
    """Return the relative error of the least reaction; NaN for a row of another problem."""
    if row.posed == LEAST_REACTION and math.isfinite(row.value) and reference:
        return max(abs(row.value - reference) / abs(reference), LEAST_ERROR)
    return math.nan


def limit_table(rows: Sequence[Row]) -> str:
    """Return the table of the rows as Markdown, in their order."""
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
    """Return a Markdown table: by scene our seconds, HiGHS's better algorithm and the fastest peer. Only certified answers count."""
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
    """Return our own seconds on a scene; NaN where unknown."""
    return next((row.seconds for row in rows if (row.scene, row.solver) == (scene, OURS)), math.nan)


def at_least(value: float, bound: float) -> str:
    """Return a number as text; where only a lower bound is known, `>` and the bound."""
    return f"> {number(bound)}" if math.isnan(value) and math.isfinite(bound) else number(value)


def number(value: float, digits: int = 2) -> str:
    """Return a number as text with `digits` significant digits; a dash where it is not finite."""
    if not math.isfinite(value):
        return "–"
    rounded = float(f"{value:.{digits - 1}e}")
    if rounded == 0.0 or 1e-3 <= abs(rounded) < 1e5:
        places = max(0, digits - 1 - math.floor(math.log10(abs(rounded)))) if rounded else 0
        return f"{rounded:.{places}f}"
    return f"{rounded:.{digits - 1}e}"


def power(value: float) -> str:
    """Return a small number as text: one digit and the power of ten."""
    return f"{value:.0e}" if math.isfinite(value) else "–"


def markdown(heads: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Return a Markdown table. Columns are as wide as their longest entry, and at least LEAST_WIDTH."""
    widths = [max(LEAST_WIDTH.get(head, 0), *(len(line[k]) for line in [heads, *lines])) for k, head in enumerate(heads)]
    written = [heads, ["-" * width for width in widths], *lines]
    return "\n".join("| " + " | ".join(text.ljust(width) for text, width in zip(line, widths, strict=True)) + " |" for line in written)


def as_record(row: object) -> dict:
    """Return a row's fields for JSON. Undefined numbers become null."""
    content = {field.name: getattr(row, field.name) for field in fields(row)}  # type: ignore[arg-type]
    return {name: None if isinstance(value, float) and not math.isfinite(value) else value for name, value in content.items()}


def restored(kind: type[Kind], record: dict) -> Kind:
    """Return a row from its record. Null becomes an undefined number, and a list becomes a tuple."""
    content = {name: math.nan if value is None else tuple(value) if isinstance(value, list) else value for name, value in record.items()}
    return kind(**content)
