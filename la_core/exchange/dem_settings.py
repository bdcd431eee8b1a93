"""Settings that limit analysis and YADE share: travel of a run, stored states, the settings in a case file and their rules."""

import math
from typing import Any

POSES = 40  # states of a YADE run over its full travel
TRAVEL_PERIODS = 1200.0  # duration of the full travel in YADE over the period of the structure's sag under its weights
LATEST_START = 0.6  # of a run's settlement: a plateau begins there at the latest
# Of the reaction: the weight that unbalanced forces are compared with, where it is more than that of a block. A jump, half of it, is then
# 2 % of the reaction, the largest uncertainty of a plateau.
AT_STAKE = 0.04
UNCERTAIN = 1e-2  # of the reaction: a judge does not decide by a method that states more
LEAST_REACTION = 1e-4  # of the weight, for a moment times the size of a block: a smaller reaction counts as zero
UNBALANCED = 0.02  # of the mean block weight: mean unbalanced force above which blocks rattle, and a run is not quasi-static
JUMP = 25.0  # times the mean unbalanced force of blocks that rattle: the unbalanced force of one jump
PLATEAU_SHARE = 0.06  # of the travel is covered before a run in YADE may stop; more where the path of limit analysis was long
RADIUS_OVER_INSET = 0.5  # radius of a contact sphere in YADE over the inset: it stays within the face it touches
# Settings of a YADE run that a case file may contain in `scene/settings`; `yade_scripts.settings` explains each.
SETTINGS = (
    "normal_stiffness", "shear_stiffness", "damping_ratio", "normal_damping", "shear_damping", "time_step_share", "time_step",
    "settling_step", "sphere_radius", "max_travel", "travel_periods", "speed", "ramp_time", "wedging", "gravity_damping", "gravity_ramp",
    "gravity_time", "rest_unbalanced", "rest_energy", "fall_speed", "record_rows", "poses", "plateau_travel", "plateau_uncertainty",
    "plateau_drift", "stop_uncertainty", "reaction_floor", "settings_uncertainty", "threads", "time_limit", "stiffening",
    "least_stiffening", "plateau_share", "rattling", "quick_speed", "servo_frequency", "servo_damping", "added_mass", "swing_damping",
)  # fmt: skip
# Their units, of those that have one; a support moves in m, or turns in rad.
SETTING_UNITS = {
    **dict.fromkeys(("normal_stiffness", "shear_stiffness"), "N/m"),
    **dict.fromkeys(("normal_damping", "shear_damping"), "N s/m"),
    **dict.fromkeys(("time_step", "settling_step", "ramp_time", "gravity_ramp", "gravity_time", "time_limit"), "s"),
    **dict.fromkeys(("max_travel", "wedging", "plateau_travel"), "m or rad"),
    "sphere_radius": "m", "speed": "m/s or rad/s", "fall_speed": "m/s", "rest_energy": "J",
}  # fmt: skip
# Runs of version 0.2.0 do not have these.
LATER_SETTINGS = (
    "stiffening", "least_stiffening", "rattling", "quick_speed", "servo_frequency", "servo_damping", "added_mass", "swing_damping",
    "gravity_ramp", "threads", "plateau_share", "settling_step",
)  # fmt: skip

_WHOLE = frozenset(("record_rows", "poses", "threads"))  # numbers that count something
_MAY_VANISH = frozenset(
    ("damping_ratio", "normal_damping", "shear_damping", "shear_stiffness", "gravity_damping", "ramp_time", "wedging", "quick_speed",
     "added_mass", "swing_damping", "gravity_ramp")
)  # fmt: skip
_BELOW_ONE = frozenset(("gravity_damping", "rest_unbalanced"))


def broken_rule(name: str, value: Any) -> str:
    """Return the rule that the value of a setting of YADE breaks whatever the structure, in words after "must be", or ""."""
    is_number = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    if not is_number or (name in _WHOLE and not isinstance(value, int)):
        return "a whole number" if name in _WHOLE else "a finite number"
    if value < 0.0 or (value == 0.0 and name not in _MAY_VANISH):
        return "at least 0" if name in _MAY_VANISH else "greater than 0"
    return "less than 1" if name in _BELOW_ONE and value >= 1.0 else ""


def json_rules(name: str) -> dict[str, Any]:
    """Return the rules of `broken_rule` for a setting of YADE, as JSON Schema has them."""
    rules: dict[str, Any] = {"type": "integer" if name in _WHOLE else "number"}
    rules |= {"minimum": 0} if name in _MAY_VANISH else {"exclusiveMinimum": 0}
    return rules | ({"exclusiveMaximum": 1} if name in _BELOW_ONE else {})


def setting_unit(name: str, turns: bool) -> str:
    """The SI unit of a setting of YADE, "" where it has none; `turns` says whether the support turns, in rad, or moves, in m."""
    return SETTING_UNITS.get(name, "").split(" or ")[-1 if turns else 0]
