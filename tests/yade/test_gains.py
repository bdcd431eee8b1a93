"""Gains of the servo and of the damper, and the expected time steps of an attempt, by hand from plain settings."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from yade_scripts.driving import LARGEST_MULTIPLIER, servo_of, swing_damper
from yade_scripts.driving.servo import LAG, Servo
from yade_scripts.expected_steps import RESTING, SETTLING, expected_steps

PUSH = np.array([1.0, 0.0, 0.0])
GRAVITY, SAG = 9.81, 4.0e-5  # m/s2, m: at the stiffness of the case
FREQUENCY = 2.0 * math.sqrt(GRAVITY / SAG)  # rad/s, of joints four times as stiff, which sag a quarter as far
USUAL: dict[str, Any] = {
    "normal_stiffness": 4e6, "settling_step": 2e-6, "time_step": 1e-6, "speed": 0.01, "ramp_time": 0.02, "servo_frequency": 0.1,
    "servo_damping": 1.0, "swing_damping": 0.5, "gravity_ramp": 0.3, "wedging": 0.0, "max_travel": 1e-3, "plateau_travel": 2e-4,
}  # fmt: skip


def case_of(live: Any = None, floor: float = 0.0, sway: float = 0.0) -> Any:
    """A free block of 50 kg. floor: mass that it carries, kg; sway: period of its sway over that of its sag."""
    gravity, load = np.array([0.0, 0.0, -GRAVITY]), np.zeros((1, 6))
    load[0, 0] = GRAVITY * floor
    block = {"mass": np.array([50.0]), "live_load": load, "free": np.array([0])}
    return SimpleNamespace(gravity=gravity, sag=SAG, sway=SAG * sway**2, normal_stiffness=1e6, live=live, plane=True, **block)


def settings_of(**changes: float) -> Any:
    return SimpleNamespace(**(USUAL | changes))


def test_the_servo_is_a_spring_and_a_dashpot_of_a_share_of_the_frequency_of_the_sag() -> None:
    servo, frequency = servo_of(case_of(PUSH), settings_of()), 0.1 * FREQUENCY
    assert servo.spring == pytest.approx(frequency**2 / GRAVITY) and servo.dashpot == pytest.approx(2.0 * frequency / GRAVITY)
    assert servo.every == int(LAG / (2.0 * frequency * 2e-6)) and servo.window == pytest.approx(1.0 / frequency)


@pytest.mark.parametrize(("sway", "slower"), [(2.0, 1.0), (4.0, 1.0), (8.0, 2.0), (200.0, 5.0)])
def test_the_servo_is_slower_than_the_sway_of_blocks_that_stand(sway: float, slower: float) -> None:
    """The servo once swung with a tall block whose period was 8 times that of the sag: a block slid on it 23 % too fast."""
    servo, usual = servo_of(case_of(PUSH, sway=sway), settings_of()), servo_of(case_of(PUSH), settings_of())
    assert usual.spring / servo.spring == pytest.approx(slower**2) and usual.dashpot / servo.dashpot == pytest.approx(slower)


def test_the_servo_looks_oftener_where_a_floor_is_pushed_that_has_no_inertia() -> None:
    """Under a floor of 24 times its mass a block responds 25 times as fast. Its decay of 0.2 between two looks would be 5, unstable."""
    bare, under_floor = (servo_of(case_of(PUSH, floor), settings_of()) for floor in (0.0, 1200.0))
    assert under_floor.every == pytest.approx(bare.every / 25.0, abs=1.0)
    assert (under_floor.spring, under_floor.dashpot) == (bare.spring, bare.dashpot)


def test_blocks_that_stand_bear_a_multiplier_after_its_loading_time() -> None:
    servo = Servo(2.0, 0.0, 0.5, 0.0, 1, 1.0)
    assert servo.multiplier(servo.loading_time(0.7), 0.0) == pytest.approx(0.7)


def test_a_heavy_block_counts_by_its_mass_in_the_motion_that_the_servo_holds() -> None:
    servo, masses = Servo(1.0, 1.0, 1.0, 0.0, 1, 1.0), np.array([9.0, 1.0])
    for k in range(30):
        servo.renew(float(k), masses, np.array([1.0 * k, 3.0 * k]))
    assert servo.weighted(np.array([1.0, 3.0])) == pytest.approx((9.0 * 1.0 + 3.0 * 3.0) / (9.0 + 3.0), abs=1e-6)


def test_a_heavy_block_that_swings_where_it_stands_hardly_counts() -> None:
    """The heavy block swings back in the next window, while the light block moves on."""
    servo, masses = Servo(1.0, 1.0, 1.0, 0.0, 1, 1.0), np.array([20.0, 1.0])
    counted = []
    for k in range(20):
        servo.renew(float(k), masses, np.array([0.05 * (k % 2), 1.0 * k]))
        counted.append(servo.weighted(np.array([1.0, 0.0])))
    assert np.mean(counted[10:]) < 0.15


def test_a_heavy_wall_that_strains_as_the_multiplier_grows_does_not_count_beside_a_light_block_that_slides() -> None:
    """It sways by 2 m over the multiplier, the servo's largest for blocks that stand by 4; the block slides 1 m in a second."""
    servo, masses = Servo(0.01, 0.0, 1.0, 0.0, 1, 1.0, sway=4.0), np.array([600.0, 1.0])
    servo.renew(0.0, masses, np.zeros(2))
    for k in range(1, 30):
        multiplier = servo.multiplier(float(k), 0.0)
        servo.renew(float(k), masses, np.array([2.0 * multiplier, 1.0 * k]))
    assert servo.weighted(np.array([0.0, 1.0])) == pytest.approx(1.0)


def test_the_servo_takes_blocks_to_stand_that_sway_twice_as_far_as_with_glued_joints() -> None:
    assert servo_of(case_of(PUSH, sway=3.0), settings_of()).sway == pytest.approx(2.0 * 3.0**2 * SAG / 4.0)


class TwoBlocks:
    """A light block moves by 1 m within the first second, then stands; a heavy one moves by 1 m in every later second."""

    masses = np.array([9.0, 1.0])
    time = 0.0

    def along(self, name: str) -> np.ndarray:
        """Places of the blocks, or speeds that show the weight of the light block."""
        return np.array([max(self.time - 1.0, 0.0), min(self.time, 1.0)] if name == "pos" else [0.0, 1.0])


def test_the_weights_of_the_servo_follow_the_motion_of_whole_windows() -> None:
    """Both blocks count by mass in the first window, the light one alone in the second; then m v is 4.5 (heavy) and 0.25 (light)."""
    servo, blocks, counts = Servo(0.0, 1.0, 0.0, 0.0, 1, window=1.0), TwoBlocks(), []
    servo.start(blocks)
    for blocks.time in (0.3, 0.9, 1.0, 1.5, 1.9, 2.0):
        counts.append(-servo.measured(blocks.time, blocks))  # of the dashpot alone: speed 0 of a point at rest less the measured speed
    assert counts == pytest.approx([0.1, 0.1, 1.0, 1.0, 1.0, 0.25 / 4.75])


def test_the_damper_takes_its_share_of_a_swing_and_forgets_over_a_period_of_the_sag() -> None:
    """At a damping ratio of 0.5 a swing's velocity falls by exp(-w t). The mean follows within a period 2 pi / w."""
    inertia: Any = SimpleNamespace(tensor=np.eye(3)[None], mass=np.array([1.0]))
    damper = swing_damper(case_of(), settings_of(settling_step=1e-4), inertia, [None])
    elapsed = FREQUENCY * damper.every * 1e-4  # rad
    assert 0.9 < elapsed <= 1.0
    assert damper.share == pytest.approx(1.0 - math.exp(-2.0 * 0.5 * elapsed))
    assert damper.renewed == pytest.approx(1.0 - math.exp(-elapsed / (2.0 * math.pi)))


@pytest.mark.parametrize("plane", [True, False])
def test_the_damper_changes_angular_momenta_in_space_alone(plane: bool) -> None:
    inertia: Any = SimpleNamespace(tensor=np.eye(3)[None], mass=np.array([1.0]))
    case = case_of()
    case.plane = plane
    assert swing_damper(case, settings_of(), inertia, [None]).turns_by_momentum is not plane


def test_a_quick_attempt_is_followed_by_one_at_the_run_s_own_speed_which_takes_longer_over_the_settlement_alone() -> None:
    found = expected_steps(case_of(), settings_of(wedging=1e-4), 2.0)
    assert found.resting == pytest.approx((RESTING * 0.3 + 0.01) / 1e-6)
    assert found.settling == pytest.approx(SETTLING * (0.01 + 0.01 + 0.02) / 2e-6)  # half the ramp, the lift undone, the least travel
    assert found.longest == pytest.approx((0.01 + 0.01 + 0.1) / 2e-6)
    assert found.later == pytest.approx((RESTING * 0.3 + 2.0 * 0.01) / 1e-6 + 2.0 * found.settling)
    assert expected_steps(case_of(), settings_of(), 1.0).later == 0.0


def test_a_live_load_takes_the_time_to_its_multiplier_and_never_more_than_the_whole_travel() -> None:
    one, chosen = case_of(PUSH), settings_of()
    per_multiplier = servo_of(one, chosen).loading_time(1.0)
    found = expected_steps(one, chosen, 1.0)
    assert found.settling == pytest.approx(SETTLING * (0.01 + per_multiplier + 0.02) / 2e-6)
    assert found.longest == pytest.approx((0.01 + LARGEST_MULTIPLIER * per_multiplier + 0.1) / 2e-6)
    near = expected_steps(case_of(), settings_of(plateau_travel=0.9e-3), 1.0)
    assert near.settling == near.longest
