"""Settings that limit analysis and YADE share: how far a run goes, how many states it stores, and which settings a case may carry."""

POSES = 40  # states of a YADE run over its full travel
TRAVEL_PERIODS = 600.0  # the full travel in YADE takes this many periods of the structure sagging under its weights
PLATEAU_SHARE = 0.4  # of the travel is covered before a run in YADE may stop
RADIUS_OVER_INSET = 0.5  # of a contact sphere in YADE: it stays clear of the neighbour's face across a joint
# Settings of a YADE run that a case may carry in `scene/settings`; `yade_scripts.settings` says what each means.
SETTINGS = (
    "normal_stiffness", "shear_stiffness", "damping_ratio", "normal_damping", "shear_damping", "time_step_share", "time_step",
    "sphere_radius", "max_travel", "travel_periods", "speed", "ramp_time", "wedging", "gravity_damping", "gravity_time", "rest_unbalanced",
    "rest_energy", "fall_speed", "record_rows", "poses", "plateau_travel", "plateau_uncertainty", "plateau_drift",
    "stop_uncertainty", "reaction_floor", "settings_uncertainty", "time_limit",
)  # fmt: skip
