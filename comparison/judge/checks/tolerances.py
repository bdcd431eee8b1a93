"""Tolerances of the reaction, one of zero included, and how uncertain a method may be that is judged.

A tolerance is a floor for what neither method states, and the uncertainties that both state. Where a method is too uncertain, only the
floor counts: no uncertainty, however large, turns a difference into agreement. Reactions are in N, moments in N m; under a live load the
multiplier, which has no unit, takes their place.
"""

from dataclasses import dataclass

from comparison.yade import Results
from la_core import exchange
from la_core.analysis import LimitAnalysis
from la_core.limit import Status, share_of_free_fall
from la_core.model import Assembly

# Of the reaction: what neither method states. YADE's blocks move, by at most 1/400 of a block's size, and the prediction is for the
# undeformed geometry. That changes a lever arm of half a block by 1/200. Rounded edges, joints' stiffness and gravity are the same in both.
FLOOR = 5e-3
# Of the reaction: where a method states more, the floor alone counts; twice the floor, so that the floor still matters.
UNCERTAIN = exchange.UNCERTAIN
MOST_UNCERTAIN = 0.05  # of the reaction: a value that is known no better agrees with nothing, however near another one lies
LEAST_REACTION = exchange.LEAST_REACTION  # of the weight: floor of a reaction of zero; UNCERTAIN of a reaction of 1 % of the weight
UNBALANCED = exchange.UNBALANCED  # of the mean block weight: inertia and damping of a quasi-static run


@dataclass(frozen=True)
class Unsure:
    """A method whose stated uncertainty is too large for a verdict.

    Attributes
    ----------
    method : str
        "limit analysis" or "YADE".
    uncertainty : float
        What it states, N or N m.
    allowed : float
        What a verdict allows, N or N m.
    share : float
        The uncertainty over the reaction, or over the smallest reaction that is judged by its size.
    """

    method: str
    uncertainty: float
    allowed: float
    share: float


def reaction_tolerance(results: Results, stated: float = 0.0) -> float:
    """Return the tolerance of YADE's reaction, N or N m: the floor, YADE's own uncertainty, and what limit analysis states.

    stated: the uncertainty of the prediction, or the error of a bound that stands for it, N or N m; 0 for bounds around it.
    """
    run = results.recorded
    return floor(results) + float(run.result.uncertainty) + stated


def floor(results: Results) -> float:
    """Return what neither method states, N or N m; either may be off by a requested accuracy."""
    analysis, reaction = results.analysis, abs(results.recorded.result.reaction)
    return max(max(FLOOR, 2.0 * accuracy_share(analysis)) * reaction, least_reaction(analysis))


def unbalanced(results: Results) -> float:
    """Return the largest unbalanced force of a quasi-static state, over the mean block weight.

    It is a share of a block's weight, or of AT_STAKE of the reaction where this is more: of a thousand blocks a few always move.
    """
    assembly = results.analysis.assembly
    if assembly.has_live_load:
        return UNBALANCED
    reaction = abs(results.recorded.result.reaction) / assembly.support_speed
    return UNBALANCED * max(1.0, exchange.AT_STAKE * reaction / assembly.mean_weight)  # 1 where the reaction is undefined


def falls_slowly(assembly: Assembly) -> bool:
    """Return whether a structure that cannot stand starts to fall so slowly that YADE may take it for a state in balance."""
    return share_of_free_fall(assembly) <= UNBALANCED


def accuracy_share(analysis: LimitAnalysis) -> float:
    """Return the requested relative accuracy, 0 if none was requested."""
    return analysis.accuracy.asked if analysis.accuracy else 0.0


def least_reaction(analysis: LimitAnalysis) -> float:
    """Return the floor of a reaction of zero: N, or N m with the size of a mean block as lever arm; without unit for a multiplier."""
    scene = analysis.scene
    if scene.live is not None:
        return LEAST_REACTION
    return LEAST_REACTION * scene.weight * (analysis.assembly.length if scene.is_rotation else 1.0)


def unsure_methods(results: Results, stated: float) -> list[Unsure]:
    """Return the methods whose stated uncertainty is too large to be judged, limit analysis first: it is the cheaper one to refine.

    stated: the uncertainty of the prediction, N or N m.
    """
    analysis, run = results.analysis, results.recorded
    share = max(UNCERTAIN, accuracy_share(analysis))
    size = max(abs(run.result.reaction), least_reaction(analysis) / UNCERTAIN)
    pairs = (("limit analysis", stated), ("YADE", float(run.result.uncertainty)))
    return [Unsure(method, value, share * size, value / size) for method, value in pairs if value > share * size]


def stated_uncertainty(analysis: LimitAnalysis) -> float:
    """Return the uncertainty that the prediction states, N or N m; 0 where it states none, as a bound or a file of version 0.2.0."""
    coulomb = analysis.coulomb
    if coulomb is None or coulomb.status not in (Status.SOLVED, Status.INACCURATE) or not coulomb.uncertainty > 0.0:
        return 0.0
    return float(coulomb.uncertainty)
