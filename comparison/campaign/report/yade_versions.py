"""Which version of YADE made a campaign's cases: what the cases' own results say."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

from comparison.campaign.row_values import own_folder
from comparison.campaign.table import CampaignTable

NAME = "yade_version"


def with_versions(table: CampaignTable) -> CampaignTable:
    """The table whose provenance names the versions of YADE that its cases met; as it was where none is known."""
    found: set[str] = set()
    for folder in dict.fromkeys(own_folder(table.folder, row) for row in table.rows):
        if folder is not None:
            found.update(_version(path) for path in folder.glob("*/comparison.json"))
    known = sorted(found - {""})
    return replace(table, provenance=table.provenance | {NAME: ", ".join(known)}) if known else table


def _version(path: Path) -> str:
    """Version in a comparison.json, "" where there is none; a damaged one, or one that cannot be read, says nothing."""
    try:
        stored: Any = json.loads(path.read_text(encoding="utf-8"))
        return str(stored["yade"]["version"] or "")
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return ""
