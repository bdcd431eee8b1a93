"""The comparison of two campaigns as a page, as Markdown, as JSON, and in a terminal's table."""

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from rich import box
from rich.table import Table

from comparison.campaign.report.compare import Change, Comparison, Cost
from comparison.campaign.row_values import METHODS
from comparison.judge import without_undefined
from comparison.numbers import DASH, format_number, plural, signed
from comparison.report import template_environment
from comparison.run_folder import write_text

WHAT = {
    "least": "least, associated",
    "greatest": "greatest, associated",
    "coulomb": "Coulomb prediction",
    "coulomb_sharp": "Coulomb prediction, sharp arrises",
    "yade": "YADE's reaction",
    "classic": "classic iteration",
    "associated_status": "associated programme ended",
    "coulomb_status": "Coulomb prediction ended",
    "yade_status": "YADE's run ended",
    "classic_status": "classic iteration ended",
}
UNCHANGED = "Nothing of substance changed."
MOST_SHOWN = 60  # changes on a terminal


def write_comparison(found: Comparison, path: Path) -> None:
    """Write the comparison in the format that the file's name ends with."""
    text = json_text(found) if path.suffix == ".json" else _rendered(found, path.suffix)
    write_text(path, text)


def stored_comparison(found: Comparison) -> dict[str, Any]:
    """What the JSON holds."""
    return dict(
        without_undefined(
            {
                "changed": found.changed,
                "titles": list(found.titles),
                "folders": list(found.folders),
                "matched": found.matched,
                "provenance": [{"name": name, "before": first, "after": second} for name, first, second in found.provenance],
                "only_before": found.only_before,
                "only_after": found.only_after,
                "changes": [_change(change) for change in found.changes],
                "within_uncertainty": [_change(change) for change in found.within],
                "costs": [vars(cost) | {"ratio": cost.ratio} for cost in found.costs],
                "case_costs": [{"case": case, "method": method, "ratio": ratio} for case, method, ratio in found.case_costs],
            }
        )
    )


def json_text(found: Comparison) -> str:
    """The JSON, as text."""
    return json.dumps(stored_comparison(found), indent=2, sort_keys=True, ensure_ascii=False, allow_nan=False) + "\n"


def terminal_tables(found: Comparison) -> Iterator[Table]:
    """Changes and costs as tables for a terminal; at most so many changes."""
    if found.provenance:
        yield _terminal("provenance", ("", "before", "after"), found.provenance)
    if found.changes:
        rows = [
            (row["case"], row["what"], row["before"], row["after"], row["difference"], row["allowed"])
            for row in map(change_words, found.changes)
        ]
        yield _terminal("changes", ("case", "what", "before", "after", "difference", "allowed"), rows[:MOST_SHOWN])
    if found.costs:
        costs = [
            (row["method"], row["cases"], row["before"], row["after"], row["ratio"], row["typical"]) for row in map(_cost, found.costs)
        ]
        yield _terminal("seconds", ("method", "cases", "before", "after", "after / before", "median of cases"), costs)


def sentence(found: Comparison) -> str:
    """What it comes to."""
    cases = {change.case for change in found.changes}
    verdicts = sum(change.kind == "verdict" for change in found.changes)
    only = len(found.only_before) + len(found.only_after)
    parts = [f"{len(cases)} of {plural(found.matched, 'case')} changed, {verdicts} of them in their verdict"] if cases else []
    parts += [f"{plural(only, 'case')} {'is' if only == 1 else 'are'} in one campaign only"] if only else []
    shown = len(found.within)
    moved = f" {plural(shown, 'reaction')} moved within what both state." if shown else ""
    both = f"{UNCHANGED} {plural(found.matched, 'case')} {'is' if found.matched == 1 else 'are'} in both."
    return (f"{'; '.join(parts)}." if parts else both) + moved


def change_words(change: Change) -> dict[str, str]:
    """A change in words and short numbers."""
    if change.kind == "reaction":
        unit = f" {change.unit}".rstrip()
        apart = f"{signed(change.difference, 3)}{unit}" if change.difference is not None else DASH
        values = [f"{format_number(value, 6)}{unit}" if value is not None else DASH for value in (change.before, change.after)]
        return _row(change, WHAT[change.what], values, apart, f"{format_number(change.allowed, 2)}{unit}")
    what = {"mechanism": f"mechanism, {METHODS.get(change.what, '')}", "verdict": "verdict"}.get(change.kind) or WHAT[change.what]
    return _row(change, what, [DASH if value is None else str(value) for value in (change.before, change.after)], "", "")


def _row(change: Change, what: str, values: list[str], difference: str, allowed: str) -> dict[str, str]:
    return {"case": change.case, "what": what, "before": values[0], "after": values[1], "difference": difference, "allowed": allowed}


def _change(change: Change) -> dict[str, Any]:
    return vars(change) | {"difference": change.difference}


def _cost(cost: Cost) -> dict[str, str]:
    return {"method": cost.method, "cases": format_number(cost.cases)} | {
        name: format_number(value, 3)
        for name, value in (("before", cost.before), ("after", cost.after), ("ratio", cost.ratio), ("typical", cost.typical))
    }


def _rendered(found: Comparison, suffix: str) -> str:
    page = {
        "title": "Two campaigns compared",
        "found": found,
        "sentence": sentence(found),
        "changes": [change_words(change) for change in found.changes],
        "within": [change_words(change) for change in found.within],
        "costs": [_cost(cost) for cost in found.costs],
        "case_costs": [{"case": case, "method": method, "ratio": format_number(ratio, 3)} for case, method, ratio in found.case_costs],
    }
    name = f"compare{suffix}"
    return template_environment(name).get_template(f"{name}.j2").render(page)


def _terminal(title: str, headings: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> Table:
    table = Table(*headings, title=title, box=box.SIMPLE_HEAD, title_justify="left")
    for row in rows:
        table.add_row(*(cell.replace("[", r"\[") for cell in row))
    return table
