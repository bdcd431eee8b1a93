"""Versions of YADE that computed a campaign's cases, from the cases' own results."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from comparison.campaign.row_values import own_folder
from comparison.campaign.table import CampaignTable
from comparison.run_folder import read_text

NAME = "yade_version"


def with_versions(table: CampaignTable) -> CampaignTable:
    """Return the table with the cases' versions of YADE in its provenance; unchanged if none is known."""
    versions: set[str] = set()
    for folder in dict.fromkeys(own_folder(table.folder, row) for row in table.rows):
        if folder is not None:
            versions.update(_version(path) for path in folder.glob("*/comparison.json"))
    known = sorted(versions - {""})
    return replace(table, provenance=table.provenance | {NAME: ", ".join(known)}) if known else table


def _version(path: Path) -> str:
    """Return the version in a comparison.json; "" without one, or for a damaged or unreadable file."""
    try:
        stored: Any = json.loads(read_text(path))
        return str(stored["yade"]["version"] or "")
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return ""
