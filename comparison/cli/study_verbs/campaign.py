"""`crosscheck campaign`: what its words mean, what it prints, and with which code it ends."""

import argparse
import contextlib
import importlib.util
import os
import signal
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table

from comparison.campaign import (
    Campaign,
    CampaignNarration,
    CampaignTable,
    Dask,
    Engine,
    Local,
    definition,
    expand,
    run_campaign,
    shipped_campaigns,
    write_campaign_report,
)
from comparison.cli.exit_codes import AGREE, DISAGREE, INCONCLUSIVE, TOOL
from comparison.numbers import DASH, plural
from la_core.errors import SceneError, nearest
from la_core.text_table import number_text

MOST_SHOWN = 60  # rows on a terminal; all of them are in results.csv


def campaign(options: argparse.Namespace, narrator: Console, out: Console, print_json: Callable[[Any], None]) -> int:
    """Run a campaign, print its table, and return the gravest exit code of its cases."""
    if options.parquet and importlib.util.find_spec("pyarrow") is None:
        raise SceneError("--parquet", "is written by pyarrow, which is not installed", hint='install the extra "parquet"')
    path = find_campaign(options.campaign)
    asked = definition.load_campaign(path)
    folder = (options.output or default_folder(path)).resolve()
    yade = asked.file.yade and not options.no_yade
    whole = Campaign(asked, expand(asked), folder, yade, options.parquet, options.time_limit)
    engine: Engine = Dask(options.scheduler, folder) if options.scheduler else Local(options.workers or cores(), yade)
    with _a_request_to_end_is_an_interruption(), CampaignNarration(narrator, asked.title) as narration:
        found = run_campaign(whole, engine, narration, write_campaign_report)
    if options.json:
        print_json({name: value for name, value in vars(found).items() if name != "folder"} | {"folder": str(folder)})
    else:
        show(found, out)
    return exit_code(found)


def find_campaign(asked: Path) -> Path:
    """Path of a campaign given by path or by a shipped one's name; raises SceneError when there is neither."""
    known = shipped_campaigns()
    if asked.suffix == ".toml" or asked.exists():
        return asked
    if str(asked) not in known:
        raise SceneError(str(asked), "neither a file nor a shipped campaign", hint=nearest(str(asked), known, "campaigns"))
    return known[str(asked)]


def default_folder(path: Path) -> Path:
    """Where a campaign's results lie where nobody says."""
    return Path("crosscheck-campaigns") / path.stem


def cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextlib.contextmanager
def _a_request_to_end_is_an_interruption() -> Iterator[None]:
    """SIGTERM, as schedulers of machines send it, ends the campaign as Ctrl-C does: tables are written, the exit code is 130."""
    if threading.current_thread() is not threading.main_thread():  # elsewhere Python lets nobody hear signals
        yield
        return
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def exit_code(found: CampaignTable) -> int:
    """Of the gravest case: one that failed, then one that disagrees, then an inconclusive one."""
    if found.failures:
        return TOOL
    verdicts = {row["verdict"] for row in found.rows}
    return DISAGREE if "disagree" in verdicts else INCONCLUSIVE if "inconclusive" in verdicts else AGREE


def show(found: CampaignTable, out: Console) -> None:
    """Print the first rows, what is not well, and where everything lies."""
    headings = ("case", "least", "Coulomb", "greatest", "YADE", "verdict")
    title = "reaction over the weight W of the free blocks, or the multiplier"
    shown = Table(*headings, title=title, box=box.SIMPLE_HEAD, title_justify="left")
    for row in found.rows[:MOST_SHOWN]:
        divisor = row["weight"] if row["unit"] and row["weight"] else 1.0
        values = [number_text(None if row[name] is None else row[name] / divisor, 5) for name in ("least", "coulomb", "greatest", "yade")]
        shown.add_row(row["case"].replace("[", r"\["), *values, row["verdict"] or ("failed" if row["state"] == "failed" else DASH))
    out.print(shown)
    if len(found.rows) > MOST_SHOWN:
        out.print(f"and {len(found.rows) - MOST_SHOWN} more", markup=False)
    for row in found.rows:
        if row["reason"]:
            out.print(f"{row['case']}: {row['reason']}", markup=False)
    counts = Counter("failed" if row["state"] == "failed" else row["verdict"] or "not compared" for row in found.rows)
    out.print(f"{plural(len(found.rows), 'case')}: {', '.join(f'{count} {word}' for word, count in counts.items())}", markup=False)
    out.print(f"results: {os.path.relpath(found.folder / 'results.csv')}", markup=False)
    out.print(f"report: {os.path.relpath(found.folder / 'report.html')}", markup=False)
