"""Associated limit analysis and its relatives; the only room that talks to the conic solver."""

from la_core.limit import section_forces
from la_core.limit.associated import Solution, Status, solve_associated
from la_core.limit.classic_iteration import ClassicParameters, ClassicSolution, solve_sequentially
from la_core.limit.conic import Cones, Programme, ProgrammeAnswer, ProgrammeOutcome, maximise, optimum
from la_core.limit.falling import share_of_free_fall
from la_core.limit.linearised import solve_linearised
from la_core.limit.plane_in_space import residual_in_space
from la_core.limit.problem import ACCEPTED, Drive, ScaledProblem, box_limits, scaled_problem
from la_core.limit.static import consistent_reaction

__all__ = [
    "ACCEPTED",
    "ClassicParameters",
    "ClassicSolution",
    "Cones",
    "Drive",
    "Programme",
    "ProgrammeAnswer",
    "ProgrammeOutcome",
    "ScaledProblem",
    "Solution",
    "Status",
    "box_limits",
    "consistent_reaction",
    "maximise",
    "optimum",
    "residual_in_space",
    "scaled_problem",
    "section_forces",
    "share_of_free_fall",
    "solve_associated",
    "solve_linearised",
    "solve_sequentially",
]
