"""Studies of the methods' settings: the cost of accuracy in time, the sensitivity of the classic iteration, and the time of a run."""

from comparison.studies import cost, sensitivity
from comparison.studies.cost import CostStudy, cost_dict, measure_study, prediction_inset
from comparison.studies.cost_limit_analysis import limit_analysis_methods
from comparison.studies.cost_yade import yade_methods
from comparison.studies.figure_of_cost import cost_figure
from comparison.studies.figure_of_sensitivity import sensitivity_figure
from comparison.studies.sensitivity import Sensitivity, study
from comparison.studies.time_estimate import TimeEstimate, estimated_times

__all__ = [
    "CostStudy",
    "Sensitivity",
    "TimeEstimate",
    "cost",
    "cost_dict",
    "cost_figure",
    "estimated_times",
    "limit_analysis_methods",
    "measure_study",
    "prediction_inset",
    "sensitivity",
    "sensitivity_figure",
    "study",
    "yade_methods",
]
