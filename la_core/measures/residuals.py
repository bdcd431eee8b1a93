"""Residuals of contact forces and mechanisms, recomputed from the answer and independent of the solver.

Residuals of undefined forces or twists are NaN. The maximum is NumPy's, which keeps a NaN; Python's may lose it.
"""

import numpy as np

from la_core.measures.mechanism import contact_speeds, fastest_speed
from la_core.model import PLANE_FREEDOMS, Assembly, per_length


def reaction(assembly: Assembly, forces: np.ndarray) -> float:
    """Reaction, N or N m, of contact forces (C, 3), N: minus the power of the support's wrench on the structure in its unit motion."""
    return float(np.sum(assembly.support_twist * assembly.contact_wrenches(forces)))


def multiplier(assembly: Assembly, forces: np.ndarray) -> float:
    """Multiplier of the live load that best balances contact forces (C, 3), N, and dead load by least squares."""
    free = assembly.blocks.free
    unbalanced = (assembly.contact_wrenches(forces) + assembly.dead_load)[free]
    live = assembly.live_load[free]
    return float(-np.sum(unbalanced * live) / np.sum(live * live))


def equilibrium_residual(assembly: Assembly, forces: np.ndarray, multiplier: float = 0.0) -> float:
    """Largest unbalanced force, or moment over the mean block size, on a free block, over the mean free-block weight.

    forces (C, 3): contact forces, N. multiplier: of the live load.
    """
    unbalanced = per_length(_unbalanced(assembly, forces, multiplier), assembly.length)
    kept = unbalanced[:, PLANE_FREEDOMS] if assembly.effects.plane else unbalanced
    return float(np.abs(kept).max() / assembly.mean_weight)


def power_of_unbalanced(assembly: Assembly, twists: np.ndarray, forces: np.ndarray, multiplier: float = 0.0) -> float:
    """Error of an associated value from unbalanced forces: the sum over the blocks of their absolute powers in the mechanism.

    The contact forces balance loads that differ from the given loads by the unbalanced wrenches. To first order, the power of these
    wrenches is the change of the reaction (N, N m) or multiplier. Small residuals of heavy blocks may therefore matter beside the reaction
    of light ones.

    twists (B, 6): the mechanism for the support's unit motion, or for unit power of the unit live load. forces (C, 3): contact forces, N.
    multiplier: of the live load.
    """
    return float(np.abs(np.sum(_unbalanced(assembly, forces, multiplier) * twists[assembly.blocks.free], axis=1)).sum())


def most_power_of_unbalanced(assembly: Assembly, twists: np.ndarray, forces: np.ndarray, multiplier: float = 0.0) -> float:
    """Cautious estimate of the error of a value without dilatancy from unbalanced forces; infinite where it is unknown.

    A force that presses on a sliding joint also changes its friction. The wrench of a block is therefore multiplied by the block's own
    speed, or by 1 + mu times the fastest slip at its joints, whichever is larger. Parameters and unit are those of `power_of_unbalanced`.
    """
    size = np.linalg.norm(per_length(_unbalanced(assembly, forces, multiplier), assembly.length), axis=1)
    speed = np.hypot(np.linalg.norm(twists[:, :3], axis=1), assembly.length * np.linalg.norm(twists[:, 3:], axis=1))
    slip = (1.0 + assembly.points.friction) * contact_speeds(assembly, twists)[1]
    for block in assembly.contact_blocks:
        np.maximum.at(speed, block, slip)
    return float(np.nan_to_num(np.sum(size * speed[assembly.blocks.free]), nan=np.inf))


def _unbalanced(assembly: Assembly, forces: np.ndarray, multiplier: float) -> np.ndarray:
    """Unbalanced wrenches (F, 6) of the F free blocks about their centroids, N and N m."""
    return (assembly.contact_wrenches(forces) + assembly.dead_load + multiplier * assembly.live_load)[assembly.blocks.free]


def cone_violation(assembly: Assembly, forces: np.ndarray) -> float:
    """Largest tension or excess of |t| over mu n of contact forces (C, 3), over the mean free-block weight.

    Where sliding is excluded, only tension counts.
    """
    normal, friction = assembly.split(forces)
    excess = np.zeros(1) if assembly.effects.sliding_excluded else np.linalg.norm(friction, axis=1) - assembly.points.friction * normal
    return float(np.max([0.0, -normal.min(), excess.max()]) / assembly.mean_weight)


def flow_rule_violation(assembly: Assembly, twists: np.ndarray) -> float:
    """Largest violation of u_n >= mu |u_t| (scaled by 1/sqrt(1 + mu^2)) over `fastest_speed`.

    The largest relative velocity is no suitable scale, because it is zero where blocks move along with their support.
    """
    normal, tangential = contact_speeds(assembly, twists)
    if assembly.effects.sliding_excluded:
        violation = np.maximum(tangential, -normal)
    else:
        excess = (assembly.points.friction * tangential - normal) / np.hypot(1.0, assembly.points.friction)
        violation = np.maximum(excess, -normal)  # a large mu must not hide penetration
    return over_fastest(assembly, twists, violation)


def penetration(assembly: Assembly, twists: np.ndarray) -> float:
    """Largest speed at which blocks penetrate each other, over `fastest_speed`, for twists (B, 6)."""
    normal, _ = contact_speeds(assembly, twists)
    return over_fastest(assembly, twists, -normal)


def over_fastest(assembly: Assembly, twists: np.ndarray, violation: np.ndarray) -> float:
    """Largest violation (C,), at least 0, over `fastest_speed`; 0 where all blocks rest."""
    fastest = fastest_speed(assembly, twists)
    return float(np.maximum(0.0, violation.max()) / fastest) if fastest != 0.0 else 0.0
