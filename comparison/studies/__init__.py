"""Studies of the methods' settings: the cost of accuracy in time, and the sensitivity of the classic iteration."""

from comparison.studies import cost, sensitivity
from comparison.studies.cost import CostStudy, cost_dict, measure_study, prediction_inset
from comparison.studies.cost_limit_analysis import limit_analysis_methods
from comparison.studies.cost_yade import yade_methods
from comparison.studies.figure_of_cost import cost_figure
from comparison.studies.figure_of_sensitivity import sensitivity_figure
from comparison.studies.sensitivity import Sensitivity, study

__all__ = [
    "CostStudy",
    "Sensitivity",
    "cost",
    "cost_dict",
    "cost_figure",
    "limit_analysis_methods",
    "measure_study",
    "prediction_inset",
    "sensitivity",
    "sensitivity_figure",
    "study",
    "yade_methods",
]
