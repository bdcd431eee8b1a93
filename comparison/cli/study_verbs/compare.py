"""`crosscheck compare`: compare two campaigns, before and after a change."""

from pathlib import Path

from comparison.campaign import (
    MOST_SHOWN,
    CampaignTable,
    Comparison,
    compare_tables,
    read_table,
    sentence,
    stored_comparison,
    terminal_tables,
    with_versions,
    write_comparison,
)
from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE, DISAGREE
from comparison.cli.study_verbs.campaign_report import is_campaign
from comparison.numbers import first_names
from la_core.errors import SceneError

MOST_NAMES = 8  # of cases that only one campaign has, on a terminal


def execute(context: Context) -> int:
    """Compare two campaigns; the exit code is 1 for any change beyond the stated uncertainties. Raises SceneError."""
    options = context.options
    comparison = compare_tables(_read(options.before), _read(options.after))
    if options.output is not None:
        write_comparison(comparison, options.output)
        context.narrator.print(f"written in {options.output}", markup=False)
    if options.json:
        context.print_json(stored_comparison(comparison))
    else:
        _show(comparison, context)
    return DISAGREE if comparison.changed else AGREE


def _show(comparison: Comparison, context: Context) -> None:
    """Print the tables, the cases that only one campaign has, and a summary."""
    for table in terminal_tables(comparison):
        context.table(table)
    if len(comparison.changes) > MOST_SHOWN:
        context.tell(f"and {len(comparison.changes) - MOST_SHOWN} more changes")
    for when, names in (("before", comparison.only_before), ("after", comparison.only_after)):
        if names:
            context.tell(f"only {when}: {first_names(names, MOST_NAMES)}")
    context.tell(sentence(comparison))


def _read(folder: Path) -> CampaignTable:
    if not is_campaign(folder):
        raise SceneError(str(folder), "holds no results of `crosscheck campaign`", hint="`crosscheck campaign FILE` makes some")
    return with_versions(read_table(folder))
