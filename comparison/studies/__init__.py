"""Studies of the methods' settings: the cost of accuracy in time, the sensitivity of the classic iteration, and the time of a run."""

from comparison.studies import cost, sensitivity
from comparison.studies.cost import CostStudy, cost_dict
from comparison.studies.figure_of_cost import cost_figure
from comparison.studies.figure_of_sensitivity import sensitivity_figure
from comparison.studies.sensitivity import Sensitivity
from comparison.studies.time_estimate import TimeEstimate, estimated_times
from comparison.studies.whole_studies import References, study_cost, study_sensitivity

__all__ = [
    "CostStudy",
    "References",
    "Sensitivity",
    "TimeEstimate",
    "cost",
    "cost_dict",
    "cost_figure",
    "estimated_times",
    "sensitivity",
    "sensitivity_figure",
    "study_cost",
    "study_sensitivity",
]
