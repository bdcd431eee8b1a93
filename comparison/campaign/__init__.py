"""Campaigns: many scenes, or one over ranges of its keys, run side by side and gathered in one table."""

from comparison.campaign.command import campaign
from comparison.campaign.report_command import compare_campaigns, is_campaign, report_campaigns

__all__ = [
    "campaign",
    "compare_campaigns",
    "is_campaign",
    "report_campaigns",
]
