"""Campaigns: many scenes, or one over ranges of its keys, run side by side and gathered in one table."""

from comparison.campaign import definition
from comparison.campaign.cases import Case, expand
from comparison.campaign.definition import default_folder, find_campaign, shipped_campaigns
from comparison.campaign.engine import Campaign, Engine, run_cases
from comparison.campaign.report.compare import Comparison, compare_tables
from comparison.campaign.report.compare_report import (
    MOST_SHOWN,
    change_words,
    sentence,
    stored_comparison,
    terminal_tables,
    write_comparison,
)
from comparison.campaign.report.report import stored_campaign_report, write_campaign_report
from comparison.campaign.report.yade_versions import with_versions
from comparison.campaign.row_values import title_of_values, value_cells, verdict_counts
from comparison.campaign.table import STORED, CampaignTable, read_table, write_tables
from comparison.campaign.workers.dask import Dask
from comparison.campaign.workers.local import Local

__all__ = [
    "MOST_SHOWN",
    "STORED",
    "Campaign",
    "CampaignTable",
    "Case",
    "Comparison",
    "Dask",
    "Engine",
    "Local",
    "change_words",
    "compare_tables",
    "default_folder",
    "definition",
    "expand",
    "find_campaign",
    "read_table",
    "run_cases",
    "sentence",
    "shipped_campaigns",
    "stored_campaign_report",
    "stored_comparison",
    "terminal_tables",
    "title_of_values",
    "value_cells",
    "verdict_counts",
    "with_versions",
    "write_campaign_report",
    "write_comparison",
    "write_tables",
]
