"""Tolerances of the reaction, one of zero included."""

from comparison.yade import Results
from la_core.analysis import LimitAnalysis

REACTION = 5e-3  # of the reaction: finite stiffness, settlement and speed of a YADE run, measured on cases with exact values
HISTORY = 1e-2  # of the reaction where joints slide: friction's history in a run of finite speed, beside both stated uncertainties
REACH = 5e-3  # of the reaction, in addition: effect of friction's history next to blocks set aside (`la_core.analysis.reach`)
LEAST_REACTION = 1e-4  # of the weight: tolerance of a reaction of zero
UNBALANCED = 0.02  # of the mean block weight: inertia and damping of a quasi-static run
BROAD = 0.05  # of the reaction: an uncertainty above this decides nothing


def reaction_tolerance(results: Results, share: float = REACTION) -> float:
    """Return the tolerance of YADE's reaction, N or N m.

    It is `share` of the reaction, at least a share of the weight (`least_reaction`), plus YADE's own uncertainty (19 in 20).
    """
    analysis, run = results.analysis, results.recorded
    return max(share * abs(run.result.reaction), least_reaction(analysis)) + float(run.result.uncertainty)


def accuracy_share(analysis: LimitAnalysis) -> float:
    """Return the requested relative accuracy, 0 if none was requested."""
    return analysis.accuracy.asked if analysis.accuracy else 0.0


def least_reaction(analysis: LimitAnalysis) -> float:
    """Return the tolerance of a reaction of zero: N, or N m with the size of a mean block as lever arm."""
    scene = analysis.scene
    return LEAST_REACTION * scene.weight * (analysis.assembly.length if scene.is_rotation else 1.0)


def is_broad(results: Results) -> bool:
    """Return whether YADE's own uncertainty is too large for any verdict."""
    analysis, run = results.analysis, results.recorded
    return bool(run.result.uncertainty > BROAD * max(abs(run.result.reaction), least_reaction(analysis)))
