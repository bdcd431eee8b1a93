"""`crosscheck compare`, and `crosscheck report` on a campaign's folder: what their words mean, what they print, how they end."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rich.console import Console

from comparison.campaign import (
    MOST_SHOWN,
    STORED,
    CampaignTable,
    compare,
    read_campaign,
    sentence,
    stored_campaign_report,
    stored_comparison,
    terminal_tables,
    with_versions,
    write_campaign_report,
    write_comparison,
)
from comparison.cli.exit_codes import AGREE, DISAGREE, GRAVITY
from comparison.cli.study_verbs.campaign import exit_code, show
from la_core.errors import SceneError

MOST_NAMES = 8  # of cases in one campaign only, on a terminal


def is_campaign(folder: Path) -> bool:
    """Whether the folder holds a campaign's results."""
    return (folder / STORED).is_file()


def report_campaigns(options: argparse.Namespace, out: Console, print_json: Callable[[Any], None]) -> int:
    """Write the reports of campaigns again; the gravest exit code of all cases."""
    strangers = [folder for folder in options.folders if not is_campaign(folder)]
    if strangers:
        raise SceneError(str(strangers[0]), "holds no campaign, unlike the other folders", hint="report campaigns and runs apart")
    codes, stored = [], []
    for folder in options.folders:
        found = read_campaign(folder)
        write_campaign_report(found)
        codes.append(exit_code(found))
        stored.append(stored_campaign_report(with_versions(found)))
        if not options.json:
            show(found, out)
    if options.json:
        print_json(stored[0] if len(stored) == 1 else {"reports": stored})
    return max(codes, key=GRAVITY.index)


def compare_campaigns(options: argparse.Namespace, narrator: Console, out: Console, print_json: Callable[[Any], None]) -> int:
    """Hold two campaigns against each other: 0 where nothing of substance changed, 1 where something did."""
    found = compare(_read(options.before), _read(options.after))
    if options.output is not None:
        write_comparison(found, options.output)
        narrator.print(f"written in {options.output}", markup=False)
    if options.json:
        print_json(stored_comparison(found))
    else:
        for table in terminal_tables(found):
            out.print(table)
        if len(found.changes) > MOST_SHOWN:
            out.print(f"and {len(found.changes) - MOST_SHOWN} more changes", markup=False)
        for words, names in (("before", found.only_before), ("after", found.only_after)):
            if names:
                more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
                out.print(f"only {words}: {', '.join(names[:MOST_NAMES])}{more}", markup=False)
        out.print(sentence(found), markup=False)
    return DISAGREE if found.changed else AGREE


def _read(folder: Path) -> CampaignTable:
    if not is_campaign(folder):
        raise SceneError(str(folder), "holds no results of `crosscheck campaign`")
    return with_versions(read_campaign(folder))
