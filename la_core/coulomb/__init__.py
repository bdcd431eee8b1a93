"""Friction without dilatancy: the quasi-static path to the plateau, its certificate, and the mechanism's interval."""

from la_core.coulomb.certificate import ACCEPTED_RESIDUAL
from la_core.coulomb.equilibrium_path import EquilibriumPath, follow_path
from la_core.coulomb.followed_path import PathProgress, PredictionSettings
from la_core.coulomb.interval import ONE_VALUE, interval_status, relative_width
from la_core.coulomb.path.rest import reaction_at_rest
from la_core.coulomb.path.turning import STIFFER
from la_core.coulomb.plateau import FLAT, peak_before, plateau_of, reference_size
from la_core.coulomb.prediction import predict
from la_core.coulomb.release import change_by_release, is_changed_by_release
from la_core.coulomb.sliding import SAME_VALUE, SLIDING_SHARE, Sliding, look_for_sliding, slides_in_mechanism
from la_core.coulomb.solution import CoulombSolution

__all__ = [
    "ACCEPTED_RESIDUAL",
    "FLAT",
    "ONE_VALUE",
    "SAME_VALUE",
    "SLIDING_SHARE",
    "STIFFER",
    "CoulombSolution",
    "EquilibriumPath",
    "PathProgress",
    "PredictionSettings",
    "Sliding",
    "change_by_release",
    "follow_path",
    "interval_status",
    "is_changed_by_release",
    "look_for_sliding",
    "peak_before",
    "plateau_of",
    "predict",
    "reaction_at_rest",
    "reference_size",
    "relative_width",
    "slides_in_mechanism",
]
