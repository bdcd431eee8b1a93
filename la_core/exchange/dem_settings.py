"""Settings that limit analysis and YADE share: travel of a run, stored states, the settings in a case file and their rules."""

import math
from typing import Any

POSES = 40  # states of a YADE run over its full travel
TRAVEL_PERIODS = 1200.0  # duration of the full travel in YADE over the period of the structure's sag under its weights
LATEST_START = 0.6  # of a run's settlement: a plateau begins there at the latest
# Of the reaction: unbalanced forces are compared with this share where it is more than the weight of a block. A jump, half of this share,
# is then 2 % of the reaction, the largest uncertainty of a plateau.
AT_STAKE = 0.04
UNCERTAIN = 1e-2  # of the reaction: the judge does not rely on a method with a larger uncertainty
LEAST_REACTION = 1e-4  # of the weight, for a moment times the size of a block: a smaller reaction counts as zero
UNBALANCED = 0.02  # of the mean block weight: mean unbalanced force above which blocks rattle, and a run is not quasi-static
JUMP = 25.0  # times the mean unbalanced force of blocks that rattle: the unbalanced force of one jump
PLATEAU_SHARE = 0.06  # of the travel is covered before a run in YADE may stop; more where the path of limit analysis was long
TRAVEL_OVER_INSET = 0.8  # largest travel of the support's fastest point over the inset: a sphere that slips by its inset leaves the face
RADIUS_OVER_INSET = 0.5  # radius of a contact sphere in YADE over the inset: it stays within the face it touches
# Settings of a YADE run that a case file may contain in `scene/settings`, and their meanings, which are in `yade_scripts.settings`, too.
SETTING_MEANINGS = {
    "normal_stiffness": "of one contact point, along the joint's normal; also changes limit analysis",
    "shear_stiffness": "of one contact point, across the joint's normal; also changes limit analysis",
    "damping_ratio": "share of the critical damping of a block on four contacts",
    "normal_damping": "viscosity of one contact point along the normal",
    "shear_damping": "viscosity of one contact point across the normal",
    "time_step_share": "time step over the largest stable one",
    "time_step": "time step while the structure comes to rest",
    "settling_step": "time step after rest: there is no local damping, and a longer step is stable",
    "sphere_radius": "radius of the sphere at a contact point, less than the inset; also changes limit analysis",
    "max_travel": "largest motion of the support; under a live load, of the fastest block; also changes limit analysis",
    "travel_periods": "duration of the full travel in periods of the sag, with joints of stiffening 4 at most, or of the slow sway",
    "speed": "speed of the support",
    "ramp_time": "duration of the cosine ramp to full speed",
    "wedging": "motion against the settlement before gravity acts; gives a flat arch its thrust; also changes limit analysis",
    "gravity_damping": "coefficient of YADE's local damping while the structure comes to rest",
    "gravity_ramp": "duration of the cosine ramp of weights and dead loads",
    "gravity_time": "longest time to come to rest",
    "rest_unbalanced": "largest unbalanced force at rest, over the mean block weight; for a light block, over 20 times its own weight",
    "rest_energy": "kinetic energy that counts as rest",
    "fall_speed": "speed beyond which a free block counts as falling",
    "record_rows": "rows of the record over the full travel",
    "poses": "states stored with displacements and contact forces",
    "plateau_travel": "least travel before the run may stop on a plateau",
    "plateau_uncertainty": "largest uncertainty of a plateau, as a share of the reaction",
    "plateau_drift": "largest change of the fitted line over a plateau, as a share of the reaction",
    "stop_uncertainty": "uncertainty, as a share of the reaction, below which the run stops early",
    "reaction_floor": "share of the reaction at rest; a smaller reaction is judged as if it were this large",
    "settings_uncertainty": "share of the reaction by which stiffness, speed and time step may shift the reaction",
    "threads": "threads of YADE; with more than one, two runs differ in their last digits",
    "time_limit": "longest wall time of the run",
    "stiffening": "stiffness of the joints over that in the case: more travel over the sag",
    "least_stiffening": "least stiffening at which one travel has as many sags as the path needs to its plateau",
    "plateau_share": "least share of the travel before the run may stop on a plateau",
    "rattling": "mean unbalanced force over the mean block weight, above which blocks rattle",
    "quick_speed": "speed of the first, quick attempt over that of the run, to measure the effect of the speed; 0 for none",
    "servo_frequency": "of the servo of a live load, over the frequency of the structure as it sags under its weights",
    "servo_damping": "damping ratio of the servo of a live load",
    "added_mass": "share of the free blocks' mass that the inertia of the fastest blocks gains; 0 for their true inertia",
    "swing_damping": "damping ratio of the blocks' swing about their mean motion, at the frequency of the sag; 0 for none",
}
SETTINGS = tuple(SETTING_MEANINGS)
# Defaults of the settings that are one number unless the structure is large or limit analysis asks for more; `yade_scripts.settings`
# derives the other settings from the case.
# On 163 random walls, run again with joints four times stiffer at half the speed, the reaction changed by 0.11 % at most in 90 of 100
# cases: hence `settings_uncertainty`.
SETTING_DEFAULTS = {
    "damping_ratio": 0.3, "time_step_share": 0.9, "travel_periods": TRAVEL_PERIODS, "wedging": 0.0, "gravity_damping": 0.3,
    "poses": POSES, "plateau_uncertainty": 0.02, "plateau_drift": 0.05, "stop_uncertainty": 0.002, "reaction_floor": 0.01,
    "settings_uncertainty": 1e-3, "threads": 1, "time_limit": 3600.0, "plateau_share": PLATEAU_SHARE, "rattling": UNBALANCED,
    "quick_speed": 2.0, "servo_frequency": 0.1, "servo_damping": 1.0, "added_mass": 0.05, "swing_damping": 0.0,
}  # fmt: skip
STIFFNESS_SETTINGS = ("normal_stiffness", "shear_stiffness", "max_travel", "sphere_radius")  # the stiffness of the joints depends on them
SHARED_SETTINGS = (*STIFFNESS_SETTINGS, "wedging")  # limit analysis reads these, too; all other settings change YADE alone
# Units of the settings that have one; a support moves in m, or turns in rad.
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
    """Return the rule that the value of a setting of YADE breaks in any structure, in words after "must be"; "" if it breaks none."""
    is_number = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    if not is_number or (name in _WHOLE and not isinstance(value, int)):
        return "a whole number" if name in _WHOLE else "a finite number"
    if value < 0.0 or (value == 0.0 and name not in _MAY_VANISH):
        return "at least 0" if name in _MAY_VANISH else "greater than 0"
    return "less than 1" if name in _BELOW_ONE and value >= 1.0 else ""


def json_rules(name: str) -> dict[str, Any]:
    """Return the meaning and the unit of a setting of YADE, and the rules of `broken_rule`, as JSON Schema has them."""
    rules: dict[str, Any] = {"type": "integer" if name in _WHOLE else "number", "description": SETTING_MEANINGS[name]}
    rules |= {"unit": SETTING_UNITS[name]} if name in SETTING_UNITS else {}
    rules |= {"minimum": 0} if name in _MAY_VANISH else {"exclusiveMinimum": 0}
    return rules | ({"exclusiveMaximum": 1} if name in _BELOW_ONE else {})


def setting_default(name: str) -> str:
    """The default of a setting of YADE in words: a number, or "derived" where it follows from the case."""
    return f"{SETTING_DEFAULTS[name]:g}" if name in SETTING_DEFAULTS else "derived"


def setting_unit(name: str, turns: bool) -> str:
    """The SI unit of a setting of YADE, "" where it has none; `turns` says whether the support turns, in rad, or moves, in m."""
    return SETTING_UNITS.get(name, "").split(" or ")[-1 if turns else 0]
