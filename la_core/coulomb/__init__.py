"""Friction without dilatancy: the way to the plateau, the whole equilibrium path, the mechanism's interval."""

from la_core.coulomb.equilibrium_path import EquilibriumPath, follow_path
from la_core.coulomb.path_progress import PathProgress
from la_core.coulomb.plateau import ACCEPTED_RESIDUAL, FIRST_SAGS, STEPS, CoulombSolution, PredictionSettings, predict, reaction_at_rest
from la_core.coulomb.sliding import SLIDING_SHARE, STATIONS, Sliding, look_for_sliding, slides_in_mechanism

__all__ = [
    "ACCEPTED_RESIDUAL",
    "FIRST_SAGS",
    "SLIDING_SHARE",
    "STATIONS",
    "STEPS",
    "CoulombSolution",
    "EquilibriumPath",
    "PathProgress",
    "PredictionSettings",
    "Sliding",
    "follow_path",
    "look_for_sliding",
    "predict",
    "reaction_at_rest",
    "slides_in_mechanism",
]
