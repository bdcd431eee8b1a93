"""`crosscheck campaign`: run a campaign, print its table, and return the exit code."""

import contextlib
import importlib.util
import os
import signal
import threading
from collections.abc import Iterator

from comparison.campaign import (
    Campaign,
    CampaignTable,
    Case,
    Dask,
    Engine,
    Local,
    default_folder,
    definition,
    expand,
    find_campaign,
    run_cases,
    title_of_values,
    value_cells,
    verdict_counts,
    write_campaign_report,
)
from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE, EXIT_OF_VERDICT, SEVERITY, TOOL
from comparison.cli.tables import coloured, new_table, plain
from comparison.numbers import plural
from comparison.progress import CampaignNarration
from comparison.verdict import UNCONFIRMED, mark_of
from la_core.errors import SceneError, extra_hint, real_path
from la_core.side_by_side import cores

MOST_WARNINGS = 10  # on a terminal
MOST_SHOWN = 60  # rows on a terminal; all of them are in results.csv


def execute(context: Context) -> int:
    """Run a campaign, print its table, and return the most severe exit code of its cases."""
    options = context.options
    if options.parquet and importlib.util.find_spec("pyarrow") is None:
        raise SceneError("--parquet", "needs pyarrow, which is not installed", hint=extra_hint("parquet", "pyarrow"))
    path = find_campaign(options.campaign)
    campaign_definition = definition.load_campaign(path)
    folder = real_path(options.output or default_folder(path))
    yade = campaign_definition.file.yade and not options.no_yade
    cases = expand(campaign_definition)
    _warn(cases, context)
    campaign = Campaign(campaign_definition, cases, folder, yade, options.parquet, options.time_limit)
    engine: Engine = Dask(options.scheduler, folder) if options.scheduler else Local(options.workers or cores(), yade)
    with _sigterm_interrupts(), CampaignNarration(context.narrator, campaign_definition.title) as narration:
        table = run_cases(campaign, engine, narration, write_campaign_report)
    if options.json:
        stored = {name: value for name, value in vars(table).items() if name != "folder"}
        context.print_json(stored | {"folder": str(folder)})
    else:
        show(table, context)
    return exit_code(table)


def _warn(cases: list[Case], context: Context) -> None:
    """Print the warnings about the scenes of a campaign, each warning once, with the first case that it concerns."""
    about: dict[str, list[str]] = {}
    for case in cases:
        for warning in case.run.warnings:
            about.setdefault(warning, []).append(case.name)
    for warning, names in list(about.items())[:MOST_WARNINGS]:
        others = f" and {plural(len(names) - 1, 'more case')}" if len(names) > 1 else ""
        context.warn_of(f"{names[0]}{others}", warning)
    if len(about) > MOST_WARNINGS:
        context.warn_of(plural(len(about) - MOST_WARNINGS, "more warning"), "the reports of the cases have them all.")


@contextlib.contextmanager
def _sigterm_interrupts() -> Iterator[None]:
    """Treat SIGTERM, which batch schedulers send, like Ctrl-C: the tables are written, and the exit code is 130."""
    if threading.current_thread() is not threading.main_thread():  # Python handles signals in the main thread only
        yield
        return
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def exit_code(table: CampaignTable) -> int:
    """Return the exit code of the most severe case: a failed one, then a disagreement, then a fall, then an inconclusive one."""
    if table.failures:
        return TOOL
    return max((EXIT_OF_VERDICT[row["verdict"] or None] for row in table.rows), key=SEVERITY.index, default=AGREE)


def show(table: CampaignTable, context: Context) -> None:
    """Print the first rows, the reasons of failures and disagreements, the counts, and the paths of results and report."""
    out, headings = context.out, ("case", "least", "Coulomb", "greatest", "YADE", "verdict")
    terminal_table = new_table(*headings, title=title_of_values(table.rows))
    for row in table.rows[:MOST_SHOWN]:
        verdict = "failed" if row["state"] == "failed" else mark_of(row["verdict"])
        terminal_table.add_row(plain(row["case"]), *value_cells(row), coloured(verdict, row["verdict"]))
    unused = () if any(row["yade"] is not None for row in table.rows) else ("YADE",)
    context.table(terminal_table, ("greatest", "least", *unused))
    if len(table.rows) > MOST_SHOWN:
        out.print(f"and {len(table.rows) - MOST_SHOWN} more", markup=False)
    for row in table.rows:
        if row["state"] != "failed" and row["verdict"] in UNCONFIRMED:
            continue  # the mark in the table says it already
        if row["reason"]:
            context.tell(f"{row['case']}: {row['reason']}")
        if row.get("next_step"):
            context.tell(f"{row['case']}: next: {row['next_step']}")
    out.print(f"{plural(len(table.rows), 'case')}: {verdict_counts(table.rows) or 'nothing ran'}", markup=False)
    if table.unfinished:
        context.tell(table.unfinished)
    out.print(f"results: {os.path.relpath(table.folder / 'results.csv')}", markup=False)
    context.show_report(table.folder / "report.html")
