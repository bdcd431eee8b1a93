"""Tolerances of the reaction, also of a reaction of zero, and the largest uncertainty of a method that allows a verdict.

A tolerance is the sum of both stated uncertainties and a floor. The floor covers errors that neither method states. If a method is too
uncertain, only the floor counts: a large uncertainty never makes two different values agree. Reactions are in N, moments in N m; a live
load has a multiplier instead, without unit.
"""

from dataclasses import dataclass

from comparison.yade import Results
from la_core import exchange
from la_core.analysis import LimitAnalysis
from la_core.limit import Status, share_of_free_fall
from la_core.model import Assembly

# Of the reaction: errors that neither method states. YADE's blocks move by at most 1/400 of a block's size, but the prediction is for the
# undeformed geometry. This changes a lever arm of half a block by 1/200. Rounded edges, joints' stiffness and gravity are the same in both.
FLOOR = 5e-3
# Of the reaction: with a larger uncertainty of a method only the floor counts. It is twice the floor, so that the floor still matters.
UNCERTAIN = exchange.UNCERTAIN
MOST_UNCERTAIN = 0.05  # of the reaction: a value with a larger uncertainty agrees with no other value, not even with a close one
LEAST_REACTION = exchange.LEAST_REACTION  # of the weight: floor for a reaction of zero; it is UNCERTAIN times 1 % of the weight
UNBALANCED = exchange.UNBALANCED  # of the mean block weight: inertia and damping of a quasi-static run


@dataclass(frozen=True)
class Unsure:
    """A method whose stated uncertainty is too large for a verdict.

    Attributes
    ----------
    method : str
        "limit analysis" or "YADE".
    uncertainty : float
        Stated uncertainty, N or N m.
    allowed : float
        Largest uncertainty for a verdict, N or N m.
    share : float
        The uncertainty over the reaction, or over the smallest reaction that is judged by its size.
    """

    method: str
    uncertainty: float
    allowed: float
    share: float


def reaction_tolerance(results: Results, stated: float = 0.0) -> float:
    """Return the tolerance of YADE's reaction, N or N m: the floor, plus the uncertainties of YADE and of limit analysis.

    stated: uncertainty of the prediction, or error of the bound that is used as prediction, N or N m; 0 for a comparison with bounds.
    """
    run = results.recorded
    return floor(results) + float(run.result.uncertainty) + stated


def floor(results: Results) -> float:
    """Return the floor of the tolerance, N or N m; at least twice a requested accuracy, because either method may be off by it."""
    analysis, reaction = results.analysis, abs(results.recorded.result.reaction)
    return max(max(FLOOR, 2.0 * accuracy_share(analysis)) * reaction, least_reaction(analysis))


def unbalanced(results: Results) -> float:
    """Return the largest unbalanced force of a quasi-static state, over the mean block weight.

    It is UNBALANCED, or the same share of AT_STAKE times the reaction if this is more: among a thousand blocks a few always move.
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
    """Return the floor for a reaction of zero: N, or N m with the size of a mean block as lever arm; without unit for a multiplier."""
    scene = analysis.scene
    if scene.live is not None:
        return LEAST_REACTION
    return LEAST_REACTION * scene.weight * (analysis.assembly.length if scene.is_rotation else 1.0)


def unsure_methods(results: Results, stated: float) -> list[Unsure]:
    """Return the methods whose stated uncertainty is too large for a verdict. Limit analysis is first, because it is cheaper to refine.

    stated: the uncertainty of the prediction, N or N m.
    """
    analysis, run = results.analysis, results.recorded
    share = max(UNCERTAIN, accuracy_share(analysis))
    size = max(abs(run.result.reaction), least_reaction(analysis) / UNCERTAIN)
    pairs = (("limit analysis", stated), ("YADE", float(run.result.uncertainty)))
    return [Unsure(method, value, share * size, value / size) for method, value in pairs if value > share * size]


def stated_uncertainty(analysis: LimitAnalysis) -> float:
    """Return the stated uncertainty of the prediction, N or N m; 0 for a bound, and for a file of version 0.2.0, which lacks it."""
    coulomb = analysis.coulomb
    if coulomb is None or coulomb.status not in (Status.SOLVED, Status.INACCURATE) or not coulomb.uncertainty > 0.0:
        return 0.0
    return float(coulomb.uncertainty)
