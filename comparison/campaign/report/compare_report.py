"""The comparison of two campaigns as HTML page, Markdown, JSON, and tables for a terminal."""

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from rich.table import Table

from comparison.campaign.report.compare import Change, Comparison, Cost
from comparison.judge import without_undefined
from comparison.numbers import DASH, format_number, plural, signed
from comparison.report import template_environment
from comparison.run_folder import write_text
from comparison.verdict import ANSWERS, new_table, plain

WHAT = {
    "least": "least, associated",
    "greatest": "greatest, associated",
    "coulomb": "Coulomb prediction",
    "coulomb_sharp": "Coulomb prediction, sharp edges",
    "coulomb_low": "mechanism's interval, least",
    "coulomb_high": "mechanism's interval, greatest",
    "coulomb_released": "Coulomb prediction after a release",
    "coulomb_peak": "greatest multiplier on the way",
    "coulomb_plateaus": "plateaus of the Coulomb prediction",
    "free_blocks": "free blocks",
    "weight": "weight",
    "unit": "unit",
    "yade": "YADE's reaction",
    "classic": "classic iteration",
    "associated_status": "associated limit analysis ended",
    "coulomb_status": "Coulomb prediction ended",
    "yade_status": "YADE's run ended",
    "classic_status": "classic iteration ended",
}
UNCHANGED = "Nothing of substance changed."
MOST_SHOWN = 60  # changes on a terminal


def write_comparison(comparison: Comparison, path: Path) -> None:
    """Write the comparison in the format that the ending of the path names."""
    text = json_text(comparison) if path.suffix == ".json" else _rendered(comparison, path.suffix)
    write_text(path, text)


def stored_comparison(comparison: Comparison) -> dict[str, Any]:
    """Return the comparison in the form of its JSON."""
    return dict(
        without_undefined(
            {
                "changed": comparison.changed,
                "titles": list(comparison.titles),
                "folders": list(comparison.folders),
                "matched": comparison.matched,
                "unfinished": list(comparison.unfinished),
                "provenance": [{"name": name, "before": first, "after": second} for name, first, second in comparison.provenance],
                "only_before": comparison.only_before,
                "only_after": comparison.only_after,
                "changes": [_change(change) for change in comparison.changes],
                "within_uncertainty": [_change(change) for change in comparison.within],
                "costs": [vars(cost) | {"ratio": cost.ratio} for cost in comparison.costs],
                "case_costs": [{"case": case, "method": method, "ratio": ratio} for case, method, ratio in comparison.case_costs],
            }
        )
    )


def json_text(comparison: Comparison) -> str:
    """Return the JSON as text."""
    return json.dumps(stored_comparison(comparison), indent=2, sort_keys=True, ensure_ascii=False, allow_nan=False) + "\n"


def terminal_tables(comparison: Comparison) -> Iterator[Table]:
    """Yield tables of provenance, changes (at most MOST_SHOWN) and costs for a terminal."""
    if comparison.provenance:
        yield _terminal("provenance", ("", "before", "after"), comparison.provenance)
    shown = _changes_of_both(comparison)
    if shown:
        rows = [
            (row["case"], row["what"], row["before"], row["after"], row["difference"], row["allowed"]) for row in map(change_words, shown)
        ]
        yield _terminal("changes", ("case", "what", "before", "after", "difference", "allowed"), rows[:MOST_SHOWN])
    if comparison.costs:
        costs = [
            (row["method"], row["cases"], row["before"], row["after"], row["ratio"], row["typical"]) for row in map(_cost, comparison.costs)
        ]
        yield _terminal("seconds", ("method", "cases", "before", "after", "after / before", "median of cases"), costs)


def sentence(comparison: Comparison) -> str:
    """Return a summary in one or two sentences, and one more for each campaign that was interrupted."""
    changes = _changes_of_both(comparison)
    cases = {change.case for change in changes}
    verdicts = sum(change.kind == "verdict" for change in changes)
    only = len(comparison.only_before) + len(comparison.only_after)
    statements = [f"{len(cases)} of {plural(comparison.matched, 'case')} changed, {verdicts} of them in their verdict"] if cases else []
    statements += [f"{plural(only, 'case')} {'is' if only == 1 else 'are'} in one campaign only"] if only else []
    if comparison.yade_in_one:
        statements.append("YADE ran in one campaign only, so its results and the verdicts differ")
    within, moving = len(comparison.within), "other reaction" if cases else "reaction"
    moved = f" {plural(within, moving)} differ{'s' if within == 1 else ''} within the stated uncertainties." if within else ""
    both = f"{UNCHANGED} {plural(comparison.matched, 'case')} {'is' if comparison.matched == 1 else 'are'} in both."
    stopped = [
        f" The campaign {when} was interrupted: {words}"
        for when, words in zip(("before", "after"), comparison.unfinished, strict=True)
        if words
    ]
    return (f"{'; '.join(statements)}." if statements else both) + moved + "".join(stopped)


def _changes_of_both(comparison: Comparison) -> list[Change]:
    """Return the changes; where YADE ran in one campaign only, without those of YADE's results and of verdicts, which rest on YADE."""
    rests = [change.kind == "verdict" or change.what.startswith("yade") for change in comparison.changes]
    return [change for change, on_yade in zip(comparison.changes, rests, strict=True) if not (comparison.yade_in_one and on_yade)]


def change_words(change: Change) -> dict[str, str]:
    """Return a change as words and short numbers."""
    if change.kind in ("reaction", "weight"):
        unit = f" {change.unit}".rstrip()
        apart = f"{signed(change.difference, 3)}{unit}" if change.difference is not None else DASH
        values = [f"{format_number(value, 6)}{unit}" if value is not None else DASH for value in (change.before, change.after)]
        return _row(change, WHAT[change.what], values, apart, f"{format_number(change.allowed, 2)}{unit}")
    what = {"mechanism": f"mechanism, {ANSWERS.get(change.what, '')}", "verdict": "verdict"}.get(change.kind) or WHAT[change.what]
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


def _rendered(comparison: Comparison, suffix: str) -> str:
    page = {
        "title": "Two campaigns compared",
        "found": comparison,
        "sentence": sentence(comparison),
        "changes": [change_words(change) for change in comparison.changes],
        "within": [change_words(change) for change in comparison.within],
        "costs": [_cost(cost) for cost in comparison.costs],
        "case_costs": [{"case": case, "method": method, "ratio": format_number(ratio, 3)} for case, method, ratio in comparison.case_costs],
    }
    name = f"compare{suffix}"
    return template_environment(name).get_template(f"{name}.j2").render(page)


def _terminal(title: str, headings: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> Table:
    table = new_table(*headings, title=title)
    for row in rows:
        table.add_row(*map(plain, row))
    return table
