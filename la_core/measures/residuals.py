"""Residuals of contact forces and mechanisms, recomputed from the answer and independent of the solver.

Of forces or twists that are undefined, every residual is NaN: numpy's maximum keeps a NaN, Python's loses it.
"""

import numpy as np

from la_core.measures.mechanism import contact_speeds, fastest_speed
from la_core.model import PLANE_FREEDOMS, Assembly, per_length


def reaction(assembly: Assembly, forces: np.ndarray) -> float:
    """Reaction (N or N m) of forces (C, 3): minus the support's unit motion times its wrench on the structure."""
    return float(np.sum(assembly.support_twist * assembly.contact_wrenches(forces)))


def multiplier(assembly: Assembly, forces: np.ndarray) -> float:
    """Multiplier of the live load that balances contact forces (C, 3), N, and dead load best by least squares."""
    free = assembly.blocks.free
    unbalanced = (assembly.contact_wrenches(forces) + assembly.dead_load)[free]
    live = assembly.live_load[free]
    return float(-np.sum(unbalanced * live) / np.sum(live * live))


def equilibrium_residual(assembly: Assembly, forces: np.ndarray, multiplier: float = 0.0) -> float:
    """Largest unbalanced force, or moment over the mean block size, on a free block, over the mean free-block weight.

    forces (C, 3): contact forces, N. multiplier: of the live load.
    """
    wrenches = assembly.contact_wrenches(forces) + assembly.dead_load + multiplier * assembly.live_load
    unbalanced = per_length(wrenches[assembly.blocks.free], assembly.length)
    kept = unbalanced[:, PLANE_FREEDOMS] if assembly.effects.plane else unbalanced
    return float(np.abs(kept).max() / assembly.mean_weight)


def power_of_unbalanced(assembly: Assembly, twists: np.ndarray, forces: np.ndarray, multiplier: float = 0.0) -> float:
    """Sum over the free blocks of the power of their unbalanced wrenches in a mechanism with twists (B, 6).

    The forces balance loads that differ from the given ones by these wrenches. To first order, this changes the reaction (N, N m) or
    multiplier by their power in the mechanism: small residuals of heavy blocks may matter beside the reaction of light ones.
    forces (C, 3): contact forces, N. multiplier: of the live load. The unit is that of the value, because the twists are per unit motion
    of the support or per unit power of the live load.
    """
    wrenches = assembly.contact_wrenches(forces) + assembly.dead_load + multiplier * assembly.live_load
    return float(np.abs(np.sum(wrenches * twists, axis=1))[assembly.blocks.free].sum())


def cone_violation(assembly: Assembly, forces: np.ndarray) -> float:
    """Largest tension or excess of |t| over mu n of contact forces (C, 3), over the mean free-block weight.

    Where sliding is excluded, only tension counts.
    """
    normal, friction = assembly.split(forces)
    excess = np.zeros(1) if assembly.effects.sliding_excluded else np.linalg.norm(friction, axis=1) - assembly.points.friction * normal
    return float(np.max([0.0, -normal.min(), excess.max()]) / assembly.mean_weight)


def flow_rule_violation(assembly: Assembly, twists: np.ndarray) -> float:
    """Largest violation of u_n >= mu |u_t| (scaled by 1/sqrt(1 + mu^2)) over `fastest_speed`.

    The largest relative velocity is no measure, because it is zero where blocks move along with their support.
    """
    normal, tangential = contact_speeds(assembly, twists)
    if assembly.effects.sliding_excluded:
        violation = np.maximum(tangential, -normal)
    else:
        excess = (assembly.points.friction * tangential - normal) / np.hypot(1.0, assembly.points.friction)
        violation = np.maximum(excess, -normal)  # a large mu must not hide penetration
    return _over_fastest(assembly, twists, violation)


def penetration(assembly: Assembly, twists: np.ndarray) -> float:
    """Largest speed at which blocks penetrate each other, over `fastest_speed`, for twists (B, 6)."""
    normal, _ = contact_speeds(assembly, twists)
    return _over_fastest(assembly, twists, -normal)


def _over_fastest(assembly: Assembly, twists: np.ndarray, violation: np.ndarray) -> float:
    """Largest violation (C,), at least 0, over `fastest_speed`; 0 where all blocks rest."""
    fastest = fastest_speed(assembly, twists)
    return float(np.maximum(0.0, violation.max()) / fastest) if fastest != 0.0 else 0.0
