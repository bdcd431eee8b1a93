from comparison.campaign_result import CampaignChanges as CampaignChanges
from comparison.campaign_result import CampaignResult as CampaignResult
from comparison.campaign_result import compare as compare
from comparison.campaign_result import read_campaign as read_campaign
from comparison.campaign_result import run_campaign as run_campaign
from comparison.picture import Picture as Picture
from comparison.picture import draw as draw
from comparison.result import Result as Result
from comparison.result import animate as animate
from comparison.result import export as export
from comparison.result import read as read
from comparison.result import run as run
from comparison.study_result import CostResult as CostResult
from comparison.study_result import SensitivityResult as SensitivityResult
from comparison.study_result import cost as cost
from comparison.study_result import sensitivity as sensitivity
from comparison.verdict.check import Check as Check
from comparison.verdict.check import Verdict as Verdict
from comparison.yade.run_record import Run as Run

__all__ = [
    "CampaignChanges",
    "CampaignResult",
    "Check",
    "CostResult",
    "Picture",
    "Result",
    "Run",
    "SensitivityResult",
    "Verdict",
    "animate",
    "compare",
    "cost",
    "draw",
    "export",
    "read",
    "read_campaign",
    "run",
    "run_campaign",
    "sensitivity",
]
