"""How near a reaction has to come, and what a reaction of zero is judged by."""

from comparison.yade import Results
from la_core.analysis import LimitAnalysis

REACTION = 5e-3  # of the reaction: finite stiffness, settlement and speed of a YADE run, measured on cases with exact values
HISTORY = 1e-2  # of the reaction where joints slide: what the steps of either method leave open in friction's history
REACH = 5e-3  # of the reaction, besides: what friction's history next to blocks set aside may change (`la_core.analysis.reach`)
LEAST_REACTION = 1e-4  # of the weight: what a reaction of zero is judged by
UNBALANCED = 0.02  # of the mean block weight: inertia and damping of a quasi-static run
BROAD = 0.05  # of the reaction: an uncertainty above this decides nothing


def reaction_tolerance(results: Results, share: float = REACTION) -> float:
    """Tolerance (N or N m) of a reaction: a share of it, not less than a share of the weight, and YADE's own uncertainty (19 in 20)."""
    analysis, run = results.analysis, results.recorded
    return max(share * abs(run.result.reaction), least_reaction(analysis)) + float(run.result.uncertainty)


def accuracy_share(analysis: LimitAnalysis) -> float:
    """Share of the reaction by which each method may be off, because no more accuracy was asked for; 0 where none was."""
    return analysis.accuracy.asked if analysis.accuracy else 0.0


def least_reaction(analysis: LimitAnalysis) -> float:
    """What a reaction of zero is judged by, N, or N m by the arm of a mean block."""
    scene = analysis.scene
    return LEAST_REACTION * scene.weight * (analysis.assembly.length if scene.is_rotation else 1.0)


def is_broad(results: Results) -> bool:
    """Whether YADE's own uncertainty is too large to judge anything by."""
    analysis, run = results.analysis, results.recorded
    return bool(run.result.uncertainty > BROAD * max(abs(run.result.reaction), least_reaction(analysis)))
