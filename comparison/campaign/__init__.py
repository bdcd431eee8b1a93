"""Campaigns: many scenes, or one over ranges of its keys, run side by side and gathered in one table."""

from comparison.campaign import definition
from comparison.campaign.cases import expand
from comparison.campaign.definition import shipped_campaigns
from comparison.campaign.engine import Campaign, Engine, run_campaign
from comparison.campaign.narration import CampaignNarration
from comparison.campaign.report.compare import compare
from comparison.campaign.report.compare_report import MOST_SHOWN, sentence, stored_comparison, terminal_tables, write_comparison
from comparison.campaign.report.report import stored_campaign_report, write_campaign_report
from comparison.campaign.report.yade_versions import with_versions
from comparison.campaign.table import STORED, CampaignTable, read_campaign
from comparison.campaign.workers.dask import Dask
from comparison.campaign.workers.local import Local

__all__ = [
    "MOST_SHOWN",
    "STORED",
    "Campaign",
    "CampaignNarration",
    "CampaignTable",
    "Dask",
    "Engine",
    "Local",
    "compare",
    "definition",
    "expand",
    "read_campaign",
    "run_campaign",
    "sentence",
    "shipped_campaigns",
    "stored_comparison",
    "stored_campaign_report",
    "terminal_tables",
    "with_versions",
    "write_campaign_report",
    "write_comparison",
]
