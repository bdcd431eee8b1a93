"""The drive of a run, by supports or by the servo of a live load, and the damper of the blocks' swing."""

from yade_scripts.driving.servo import LARGEST_MULTIPLIER, Servo, pushed_of, servo_of
from yade_scripts.driving.supports import drives_of, ramp, set_speed
from yade_scripts.driving.swing import SwingDamper, swing_damper

__all__ = ["LARGEST_MULTIPLIER", "Servo", "SwingDamper", "drives_of", "pushed_of", "ramp", "servo_of", "set_speed", "swing_damper"]
