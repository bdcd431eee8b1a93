"""The stable time step, from the fastest swing and the fastest decay of the blocks."""

import numpy as np

from yade_scripts.vibration.inertia import Inertia
from yade_scripts.vibration.springs import Springs

_POWER_ITERATIONS = 300  # Rayleigh quotient then within about 1 % of the highest eigenvalue, below it


def highest_eigenvalue(system: Springs, inertia: Inertia) -> float:
    """Return the highest eigenvalue of M^-1 K, with the mass matrix M of the inertia, by power iteration from a fixed starting vector.

    Of springs it is the square of the highest natural frequency (rad2/s2), of dashpots the fastest rate of decay (1/s); 0 where all of
    them have been set to 0.
    """
    twists = np.random.default_rng(0).standard_normal(system.freedoms.shape)
    twists[:, 3:] /= np.median(np.linalg.norm(np.concatenate([system.arm_a, system.arm_b]), axis=1))
    twists *= system.freedoms
    eigenvalue = 0.0
    for _ in range(_POWER_ITERATIONS):
        forces = system.stiffness(twists)
        if not forces.any():
            return 0.0
        following = inertia.accelerations(forces)
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
