"""The damping of the blocks' swing: a steady motion feels no drag, a swing about it decays, and means follow a motion that changes."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from yade_scripts.driving import SwingDamper

MASS = np.array([5.0])
INERTIA = np.diag([2.0, 3.0, 4.0])[None]


@dataclass
class State:
    """State of a block in YADE that the damper reads and sets."""

    vel: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    angVel: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])  # noqa: N815  YADE's name
    angMom: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])  # noqa: N815


def damper(state: State, by_momentum: bool = True) -> SwingDamper:
    return SwingDamper([state], by_momentum, INERTIA, share=0.5, renewed=0.2, every=1, mass=MASS)


def test_a_steady_motion_is_not_braked() -> None:
    state = State()
    one, impulses = damper(state), []
    for _ in range(200):  # the block is driven at this velocity, whatever the damper does
        state.vel, state.angVel, state.angMom = [1.0, 0.0, -2.0], [0.0, 3.0, 0.0], [0.0, 9.0, 0.0]
        one.damp()
        impulses.append([*np.subtract(state.vel, [1.0, 0.0, -2.0]), state.angVel[1] - 3.0, state.angMom[1] - 9.0])
    assert np.abs(impulses[-1]).max() < 1e-12
    assert np.abs(impulses[0]).max() > 0.1  # the damper acted until the mean had caught up


def test_a_swing_about_a_steady_motion_decays_and_the_motion_stays() -> None:
    """A spring draws a block along. The block's lag becomes constant, and its mean velocity is that of the spring's far end."""
    state, dt, stiffness, drawn = State(vel=[1.5, 0.0, 0.0]), 0.1, 4.0, 1.0
    one, place, lags = damper(state, by_momentum=False), 0.0, []
    for step in range(2000):
        state.vel = [state.vel[0] + dt * stiffness * (drawn * step * dt - place), 0.0, 0.0]
        if step % 5 == 0:
            one.damp()
        place += dt * state.vel[0]
        lags.append(drawn * (step + 1) * dt - place)
    assert np.ptp(lags[:50]) > 0.1
    assert np.ptp(lags[-200:]) < 1e-6
    assert state.vel[0] == pytest.approx(drawn, abs=1e-6)


def test_energy_about_the_mean_only_falls() -> None:
    random = np.random.default_rng(3)
    state = State()
    one = damper(state)
    for _ in range(50):
        state.vel, state.angVel = random.standard_normal(3).tolist(), random.standard_normal(3).tolist()
        before, taken = np.array([*state.vel, *state.angVel]), one.taken
        one.damp()
        mean = one._mean[0]
        after = np.array([*state.vel, *state.angVel])
        np.testing.assert_allclose(after - mean, 0.5 * (before - mean), atol=1e-15)
        assert one.taken - taken == pytest.approx(energy(before) - energy(after), abs=1e-12)


def energy(velocity: np.ndarray) -> float:
    return 0.5 * float(MASS[0] * velocity[:3] @ velocity[:3] + velocity[3:] @ INERTIA[0] @ velocity[3:])


def test_blocks_in_space_change_their_angular_momentum_as_their_spin() -> None:
    state = State(angVel=[1.0, 1.0, 1.0], angMom=[2.0, 3.0, 4.0])
    damper(state).damp()
    np.testing.assert_allclose(state.angMom, INERTIA[0] @ state.angVel)
    flat = State(angVel=[0.0, 1.0, 0.0], angMom=[0.0, 7.0, 0.0])
    damper(flat, by_momentum=False).damp()
    assert flat.angMom == [0.0, 7.0, 0.0]
