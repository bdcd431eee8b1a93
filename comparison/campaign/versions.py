"""Which version of YADE made a campaign's cases: what the cases' own results say."""

import json
from dataclasses import replace
from typing import Any

from comparison.campaign.outcomes import own_folder
from comparison.campaign.table import CampaignTable

NAME = "yade_version"


def with_versions(table: CampaignTable) -> CampaignTable:
    """The table whose provenance names the versions of YADE that its cases met; as it was where none is known."""
    found: set[str] = set()
    for folder in dict.fromkeys(own_folder(table.folder, row) for row in table.rows):
        if folder is not None:
            found.update(_version(path.read_text(encoding="utf-8")) for path in folder.glob("*/comparison.json"))
    known = sorted(found - {""})
    return replace(table, provenance=table.provenance | {NAME: ", ".join(known)}) if known else table


def _version(text: str) -> str:
    """Version in a comparison.json, "" where there is none; a damaged one says nothing."""
    try:
        stored: Any = json.loads(text)
        return str(stored["yade"]["version"] or "")
    except (ValueError, KeyError, TypeError, RecursionError):
        return ""
