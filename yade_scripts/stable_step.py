"""Stable time step from the highest frequency and the fastest decay of the assembly, with springs and dashpots at its contact points.

No matrix is built. A vector holds one twist per block, (B, 6), about the centroids; held blocks stay at 0.
"""

from dataclasses import dataclass

import numpy as np

from yade_scripts.case import Case

_PLANE_FREEDOMS = np.array([1.0, 0.0, 1.0, 0.0, 1.0, 0.0])
_POWER_ITERATIONS = 300  # Rayleigh quotient then within about 1 % of the highest eigenvalue, below it


@dataclass(frozen=True)
class Springs:
    """Bilateral springs, or dashpots, at every contact point, as operator K and block-diagonal mass matrix M.

    Attributes
    ----------
    case : Case
        B blocks and C contact points.
    normal, shear : np.ndarray
        Stiffness (C,) of every contact point along its normal and across it, N/m; of dashpots the viscosity, N s/m.
    arm_a, arm_b : np.ndarray
        Arms (C, 3) from the centroids of blocks a and b to the contact points, m.
    freedoms : np.ndarray
        1.0 for each free component of the twists (B, 6), else 0.0.
    inverse_inertia : np.ndarray
        Inverse of the inertia (B, 3, 3), 1/(kg m2).
    """

    case: Case
    normal: np.ndarray
    shear: np.ndarray
    arm_a: np.ndarray
    arm_b: np.ndarray
    freedoms: np.ndarray
    inverse_inertia: np.ndarray

    def contact_forces(self, twists: np.ndarray) -> np.ndarray:
        """Return the spring forces (C, 3), N, as stiffness times the displacement of b relative to a; twists (B, 6), m and rad."""
        case = self.case
        of_a, of_b = twists[case.block_a], twists[case.block_b]
        relative = of_b[:, :3] + np.cross(of_b[:, 3:], self.arm_b) - of_a[:, :3] - np.cross(of_a[:, 3:], self.arm_a)
        along = np.einsum("ci,ci->c", relative, case.normal)[:, None] * case.normal
        return self.shear[:, None] * relative + (self.normal - self.shear)[:, None] * along

    def stiffness(self, twists: np.ndarray) -> np.ndarray:
        """Return K times twists (B, 6): generalised forces (B, 6), N and N m."""
        force = self.contact_forces(twists)
        case = self.case
        on_b = np.hstack([force, np.cross(self.arm_b, force)])
        on_a = -np.hstack([force, np.cross(self.arm_a, force)])
        blocks = np.concatenate([case.block_a, case.block_b])
        weights = np.vstack([on_a, on_b])
        total = np.column_stack([np.bincount(blocks, weights[:, i], len(case.mass)) for i in range(6)])
        return total * self.freedoms

    def compliance_of_mass(self, wrenches: np.ndarray) -> np.ndarray:
        """Return M^-1 times wrenches (B, 6), N and N m: accelerations (B, 6), m/s2 and rad/s2."""
        linear = wrenches[:, :3] / self.case.mass[:, None]
        angular = np.einsum("bij,bj->bi", self.inverse_inertia, wrenches[:, 3:])
        return np.hstack([linear, angular]) * self.freedoms


def springs(case: Case, normal: np.ndarray | float, shear: np.ndarray | float) -> Springs:
    """Return springs of `normal` and `shear` stiffness (N/m), alike or one (C,) for each contact point of the case."""
    freedoms = np.outer(np.isin(np.arange(len(case.mass)), case.free), _PLANE_FREEDOMS if case.plane else np.ones(6))
    inertia = case.inertia
    if case.plane:
        inertia = inertia[:, 1, 1, None, None] * np.eye(3)
    arm_a, arm_b = case.position - case.centroid[case.block_a], case.position - case.centroid[case.block_b]
    normal, shear = (np.broadcast_to(stiffness, len(case.position)) for stiffness in (normal, shear))
    return Springs(case, normal, shear, arm_a, arm_b, freedoms.astype(float), np.linalg.inv(inertia))


def highest_eigenvalue(system: Springs) -> float:
    """Return the highest eigenvalue of M^-1 K, by power iteration from a fixed starting vector.

    Of springs it is the square of the highest natural frequency (rad2/s2), of dashpots the fastest rate of decay (1/s).
    """
    twists = np.random.default_rng(0).standard_normal(system.freedoms.shape)
    twists[:, 3:] /= np.median(np.linalg.norm(np.concatenate([system.arm_a, system.arm_b]), axis=1))
    twists *= system.freedoms
    eigenvalue = 0.0
    for _ in range(_POWER_ITERATIONS):
        forces = system.stiffness(twists)
        following = system.compliance_of_mass(forces)
        # |K x| in the metric of M^-1 over (x, K x): a Rayleigh quotient of the current vector, one product ahead.
        eigenvalue = float(np.vdot(forces, following) / np.vdot(twists, forces))
        twists = following / np.abs(following).max()
    return eigenvalue


def stable_time_step(frequency: float, decay: float) -> float:
    """Return the largest stable step (s) of the leapfrog scheme with viscous forces that lag half a step: 2/w (sqrt(1 + x^2) - x).

    frequency: highest natural frequency w, rad/s. decay: highest eigenvalue of the viscosities over the masses, 1/s; x = decay / (2 w) is
    at least the damping ratio of the fastest mode, and no mode is unstable, whichever shape it has.
    """
    ratio = 0.5 * decay / frequency
    return float(2.0 / frequency * (np.hypot(1.0, ratio) - ratio))
