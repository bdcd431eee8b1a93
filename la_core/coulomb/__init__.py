"""Friction without dilatancy: the way to the plateau, the whole equilibrium path, the mechanism's interval."""

from la_core.coulomb.equilibrium_path import Path, follow_path
from la_core.coulomb.plateau import ACCEPTED, FIRST_SAGS, STEPS, CoulombSolution, predict, reaction_at_rest
from la_core.coulomb.sliding import (
    SLIDING_SHARE,
    STATIONS,
    Sliding,
    look_for_sliding,
    may_leave_out_friction,
    settled_effects,
    slides_in_mechanism,
)

__all__ = [
    "ACCEPTED",
    "FIRST_SAGS",
    "SLIDING_SHARE",
    "STATIONS",
    "STEPS",
    "CoulombSolution",
    "Path",
    "Sliding",
    "follow_path",
    "look_for_sliding",
    "may_leave_out_friction",
    "predict",
    "reaction_at_rest",
    "settled_effects",
    "slides_in_mechanism",
]
