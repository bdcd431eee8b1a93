"""Damp the swing of the blocks about their steady motion, without a force on the motion itself.

Friction without dilatancy feeds energy into the swing of some structures (flutter). The swing then grows until blocks stick and slip. The
contacts cannot damp it, because a sliding joint has no dashpot along its face. A drag on the blocks can, but it would also brake the
steady motion. So the drag here acts on the difference between a block's velocity and its own mean velocity over a period of the sag. In a
steady motion the mean of this difference is zero, and so is the mean drag: weights, reaction and contact forces stay in balance.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from yade_scripts.case import Case
from yade_scripts.settings import Settings, sag_of
from yade_scripts.vibration import Inertia

# Periods of the sag over which the mean velocity is taken. In a slow motion the drag acts like inertia: with one period and a damping
# ratio of 0.5 blocks seem seven times as heavy. With half a period they seem four times as heavy, but scene 96 of the random scenes took
# three times as many steps.
MEAN_PERIODS = 1.0
EVERY = 1.0  # time from one damping to the next, times the frequency of the sag (rad/s)


@dataclass
class SwingDamper:
    """The damper of F free blocks.

    Attributes
    ----------
    states : sequence
        State of each block in YADE.
    turns_by_momentum : bool
        Whether YADE rotates the blocks by their angular momentum (cases in space) rather than by their angular velocity (plane cases).
    inertia : np.ndarray
        Moment of inertia (F, 3, 3) about the centroid in global axes, kg m2.
    share : float
        Share of the difference from the mean velocity that one damping takes away.
    renewed : float
        Share of the mean velocity that one damping renews.
    every : int
        Time steps from one damping to the next.
    mass : np.ndarray
        Inert mass (F,), kg.
    taken : float
        Kinetic energy taken so far, J.
    """

    states: Sequence[Any]
    turns_by_momentum: bool
    inertia: np.ndarray
    share: float
    renewed: float
    every: int
    mass: np.ndarray
    taken: float = 0.0
    _mean: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def damp(self) -> None:
        """Bring the velocities of all blocks nearer to their means.

        Scaling a velocity down takes energy at any phase of the swing, so the damping is stable for any interval.
        """
        pairs = [(state.vel, state.angVel) for state in self.states]
        velocities = np.array([(v[0], v[1], v[2], w[0], w[1], w[2]) for v, w in pairs])
        change = self.changes(velocities)
        middle = velocities + 0.5 * change
        self.taken -= float(self.mass @ (middle[:, :3] * change[:, :3]).sum(axis=1))
        self.taken -= float(np.einsum("bi,bij,bj->", middle[:, 3:], self.inertia, change[:, 3:]))
        for state, new in zip(self.states, (velocities + change).tolist(), strict=True):
            state.vel, state.angVel = new[:3], new[3:]
        if self.turns_by_momentum:
            momentum = np.einsum("bij,bj->bi", self.inertia, change[:, 3:]).tolist()
            for state, more in zip(self.states, momentum, strict=True):
                state.angMom = [before + extra for before, extra in zip(state.angMom, more, strict=True)]

    def changes(self, velocities: np.ndarray) -> np.ndarray:
        """Return the corrections of the velocities (F, 6), m/s and rad/s, and renew the mean velocities."""
        if len(self._mean) == 0:
            self._mean = np.zeros_like(velocities)
        self._mean += self.renewed * (velocities - self._mean)
        return self.share * (self._mean - velocities)


def swing_damper(case: Case, settings: Settings, inertia: Inertia, states: Sequence[Any]) -> SwingDamper:
    """Return the damper of a run with these settings, for the YADE states of the free blocks."""
    frequency = math.sqrt(float(np.linalg.norm(case.gravity)) / sag_of(case, settings.normal_stiffness))
    every = max(1, int(EVERY / (frequency * settings.settling_step)))
    elapsed = frequency * every * settings.settling_step  # rad
    share, renewed = (1.0 - math.exp(-rate * elapsed) for rate in (2.0 * settings.swing_damping, 1.0 / (2.0 * math.pi * MEAN_PERIODS)))
    return SwingDamper(states, not case.plane, inertia.tensor[case.free], share, renewed, every, inertia.mass[case.free])
