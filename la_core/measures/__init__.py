"""Measures of contact forces and twists: residuals, mechanism, dissipation."""

from la_core.measures import mechanism, residuals
from la_core.measures.dissipation import ContactState, MechanismMeasures, contact_states, measure
from la_core.measures.joint_measures import (
    eccentricity,
    ground_reactions,
    joint_centres,
    joint_forces,
    joint_rows,
    joint_states,
    thrust_line,
)
from la_core.measures.mechanism import MOVING_SHARE, block_speeds, contact_speeds, corner_speeds, fastest_speed

__all__ = [
    "MOVING_SHARE",
    "ContactState",
    "MechanismMeasures",
    "block_speeds",
    "contact_speeds",
    "contact_states",
    "corner_speeds",
    "eccentricity",
    "fastest_speed",
    "ground_reactions",
    "joint_centres",
    "joint_forces",
    "joint_rows",
    "joint_states",
    "measure",
    "mechanism",
    "residuals",
    "thrust_line",
]
