"""Studies of a method's own settings: what accuracy costs in time, and how sensitive the classic iteration is."""

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
    "measure_study",
    "cost",
    "cost_figure",
    "cost_dict",
    "limit_analysis_methods",
    "prediction_inset",
    "sensitivity",
    "sensitivity_figure",
    "study",
    "yade_methods",
]
