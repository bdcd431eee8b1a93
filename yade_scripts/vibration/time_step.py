"""The stable time step, from the highest natural frequency and the fastest decay of the blocks."""

import numpy as np

from yade_scripts.vibration.inertia import Inertia
from yade_scripts.vibration.springs import Springs

_POWER_ITERATIONS = 300  # the Rayleigh quotient is then less than the highest eigenvalue by about 1 % at most


def highest_eigenvalue(system: Springs, inertia: Inertia) -> float:
    """Return the highest eigenvalue of M^-1 K, with the mass matrix M of the inertia, by power iteration from a fixed starting vector.

    For springs it is the square of the highest natural frequency (rad2/s2), for dashpots the fastest rate of decay (1/s). It is 0 if all
    springs or dashpots are 0.
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
        # (K x, M^-1 K x) over (x, K x): the Rayleigh quotient of the current vector x in the metric of K, without another product by K.
        eigenvalue = float(np.vdot(forces, following) / np.vdot(twists, forces))
        twists = following / np.abs(following).max()
    return eigenvalue


def stable_time_step(frequency: float, decay: float) -> float:
    """Return the largest stable step (s) of the leapfrog scheme with viscous forces that lag half a step: 2/w (sqrt(1 + x^2) - x).

    frequency: highest natural frequency w, rad/s. decay: highest eigenvalue of the viscosities over the masses, 1/s. The ratio
    x = decay / (2 w) is at least the damping ratio of the fastest mode, so modes of every shape are stable.
    """
    ratio = 0.5 * decay / frequency
    return float(2.0 / frequency * (np.hypot(1.0, ratio) - ratio))
