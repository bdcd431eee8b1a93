"""Every setting of a run: set by the scene, or derived from the case so that blocks of any size and weight behave alike.

The stable time step follows from the highest frequency and the fastest decay of the assembly, see `yade_scripts.vibration`.
"""

import dataclasses
import difflib
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from la_core.exchange import AT_STAKE, FREE, RADIUS_OVER_INSET, SETTING_DEFAULTS, TRAVEL_PERIODS, broken_rule
from yade_scripts.case import Case, CaseError
from yade_scripts.vibration import MOST, MOST_PUSHED, Inertia, highest_eigenvalue, slowed, springs_of, stable_time_step

# Ratios for every case; README.md gives their reasons.
GRAVITY_PERIODS = 500.0  # longest gravity stage, in periods of the sag
WEIGHT_PERIODS = 10.0  # ramp of the weights: on a shorter one blocks overshoot, and friction keeps a trace; a longer one changes nothing
REST_UNBALANCED = 1e-3  # of the mean block weight: unbalanced force at rest
REST_SHARE = 1e-3  # kinetic energy at rest over the work of the weights on the elastic sag
# Least stiffness over that of limit analysis: the path of limit analysis goes on until it is flat, but a run must reach its plateau within
# one travel.
STIFFENING = 4.0
# Limits of the product of time steps and contact points over all attempts. SMALL_WORK takes a minute or two on one core for any structure.
# A large structure may take more, up to MOST_STEPS time steps, and at most MOST_WORK, some 40 minutes. The attempt at the run's own speed
# is made in any case.
SMALL_WORK, MOST_STEPS, MOST_WORK = 3e8, 1.5e6, 6e9
SWING_DAMPING = 0.5  # damping ratio of the blocks' swing after an attempt that rattles, or sticks and slips
# Settings of a plane run beyond SMALL_WORK. Some of its many blocks rattle in nearly every run, and a useless attempt takes minutes. So the
# run ends with an uncertainty that still allows a verdict. It moves twice as fast; its two attempts show the effect of the speed.
OF_LARGE = {"stop_uncertainty": 0.005, "travel_periods": 0.5 * TRAVEL_PERIODS}
# The swing of such a run is damped at once, unless its sway is slower than the damper's mean. A damped swing needs hardly any dashpots, and
# weaker dashpots allow longer steps. This is for the plane alone: in space, with light dashpots, one jump may lead to another plateau.
OF_LARGE_CALMED = {"swing_damping": SWING_DAMPING, "damping_ratio": 0.1}
CRITICAL = 1.0  # damping ratio after a run that rattled although its swing was damped; steps are then a third as long as with 0.3
SWAY_SHARE = 0.2  # least number of periods of the sideways swing during the travel, over `travel_periods`
ROWS = 1200  # rows of the record over the full travel; more for stiffer joints
RAMP_SHARE = 0.04  # share of the travel during which the support accelerates


@dataclass(frozen=True)
class Settings:
    """All settings of a run, as used and stored. Lengths of the support's motion are m, or rad for a rotation."""

    normal_stiffness: float  # N/m, of one contact point, along the joint's normal; also changes limit analysis
    shear_stiffness: float  # N/m, of one contact point, across the joint's normal; also changes limit analysis
    damping_ratio: float  # share of the critical damping of a block on four contacts
    normal_damping: float  # N s/m, viscosity of one contact point along the normal
    shear_damping: float  # N s/m, viscosity of one contact point across the normal
    time_step_share: float  # time step over the largest stable one
    time_step: float  # s, time step while the structure comes to rest
    settling_step: float  # s, time step after rest: there is no local damping, and a longer step is stable
    sphere_radius: float  # m, radius of the sphere at a contact point, less than the inset; also changes limit analysis
    max_travel: float  # m or rad, largest motion of the support; under a live load, of the fastest block; also changes limit analysis
    travel_periods: float  # duration of the full travel in periods of the sag, with joints of stiffening 4 at most, or of the slow sway
    speed: float  # m/s or rad/s, speed of the support
    ramp_time: float  # s, duration of the cosine ramp to full speed
    wedging: float  # m or rad, motion against the settlement before gravity acts; gives a flat arch its thrust; also changes limit analysis
    gravity_damping: float  # coefficient of YADE's local damping while the structure comes to rest
    gravity_ramp: float  # s, duration of the cosine ramp of weights and dead loads
    gravity_time: float  # s, longest time to come to rest
    rest_unbalanced: float  # largest unbalanced force at rest, over the mean block weight; for a light block, over 20 times its own weight
    rest_energy: float  # J, kinetic energy that counts as rest
    fall_speed: float  # m/s, speed beyond which a free block counts as falling
    record_rows: int  # rows of the record over the full travel
    poses: int  # states stored with displacements and contact forces
    plateau_travel: float  # m or rad, least travel before the run may stop on a plateau
    plateau_uncertainty: float  # largest uncertainty of a plateau, as a share of the reaction
    plateau_drift: float  # largest change of the fitted line over a plateau, as a share of the reaction
    stop_uncertainty: float  # uncertainty, as a share of the reaction, below which the run stops early
    reaction_floor: float  # share of the reaction at rest; a smaller reaction is judged as if it were this large
    settings_uncertainty: float  # share of the reaction by which stiffness, speed and time step may shift the reaction
    threads: int  # threads of YADE; with more than one, two runs differ in their last digits
    time_limit: float  # s, longest wall time of the run
    stiffening: float  # stiffness of the joints over that in the case: more travel over the sag
    least_stiffening: float  # least stiffening at which one travel has as many sags as the path needs to its plateau
    plateau_share: float  # least share of the travel before the run may stop on a plateau
    rattling: float  # mean unbalanced force over the mean block weight, above which blocks rattle
    quick_speed: float  # speed of the first, quick attempt over that of the run, to measure the effect of the speed; 0 for none
    servo_frequency: float  # of the servo of a live load, over the frequency of the structure as it sags under its weights
    servo_damping: float  # damping ratio of the servo of a live load
    added_mass: float  # share of the free blocks' mass that the inertia of the fastest blocks gains; 0 for their true inertia
    swing_damping: float  # damping ratio of the blocks' swing about their mean motion, at the frequency of the sag; 0 for none


def derive(case: Case, large: bool | None = None) -> Settings:
    """Return the settings of a case that comes from `affordable`; its overrides replace derived values.

    Raises CaseError for an unknown name or an invalid value.

    large: whether the case counts as large; None to derive this from the case.
    """
    overrides = _checked(case.overrides)
    if not (is_large(case) if large is None else large):
        return _derived(case, overrides)
    is_calmed = slowness(case) == 1.0 and overrides.get("swing_damping") != 0.0
    return _derived(case, OF_LARGE | (OF_LARGE_CALMED if is_calmed else {}) | overrides)


def affordable(case: Case) -> Case:
    """Return the case with the overrides for its run: `long_overrides` if a run with `overrides` would be long."""
    return replace(case, overrides=case.long_overrides) if is_long(case) else case


def is_large(case: Case) -> bool:
    """Whether a plane case takes so long that its run has the settings OF_LARGE."""
    return case.plane and is_long(case)


def is_long(case: Case) -> bool:
    """Whether the first two attempts of a run with the case's `overrides` would take more than SMALL_WORK."""
    return steps_to_plateau(_derived(case, _checked(case.overrides))) * len(case.host) > SMALL_WORK


class _Chosen(dict[str, Any]):
    """Settings by name, chosen one after another: the value of the overrides, or else a default."""

    def __init__(self, overrides: dict[str, float]) -> None:
        super().__init__()
        self.overrides = overrides

    def set_default(self, **values: float) -> None:
        """Choose settings; the values are their defaults."""
        self.update({name: self.overrides.get(name, value) for name, value in values.items()})


def _derived(case: Case, overrides: dict[str, float]) -> Settings:
    """Return the settings of a case with these overrides; raises CaseError for a value that does not suit the structure."""
    chosen = _Chosen(overrides)
    chosen.set_default(**SETTING_DEFAULTS)
    _choose_contacts(case, chosen)
    _choose_time_steps(case, chosen)
    _choose_motion(case, chosen)
    return Settings(**chosen)


def _choose_contacts(case: Case, chosen: _Chosen) -> None:
    """Choose radius, stiffness and viscosity of the contact points, and the travel."""
    chosen.set_default(sphere_radius=RADIUS_OVER_INSET * case.inset)
    if chosen["sphere_radius"] >= case.inset:
        raise CaseError(f"scene/settings: sphere_radius is {chosen['sphere_radius']} m; it must be less than the inset of {case.inset} m")
    # Stiffness and travel in the case follow the same overrides, because limit analysis with elastic joints uses them, too.
    # A wedged structure stands on a thrust in proportion to the stiffness. So its stiffness is that of limit analysis.
    keeps_stiffness = "normal_stiffness" in chosen.overrides or chosen["wedging"] > 0.0
    chosen.set_default(least_stiffening=1.0 if keeps_stiffness else STIFFENING)
    chosen.set_default(stiffening=chosen["least_stiffening"], max_travel=case.travel)
    chosen.set_default(**{name: chosen["stiffening"] * getattr(case, name) for name in ("normal_stiffness", "shear_stiffness")})
    chosen.set_default(**_damping(case, chosen))


def _choose_time_steps(case: Case, chosen: _Chosen) -> None:
    """Choose the time steps of both stages; raises CaseError for a step beyond the stable one."""
    stable = _stable_time_steps(case, chosen)
    chosen.set_default(time_step=chosen["time_step_share"] * stable["time_step"])
    # Critical dashpots take so much energy in a step near the stable limit that a tenth of it is missing in the energy balance.
    longer = chosen["damping_ratio"] < CRITICAL and "time_step" not in chosen.overrides
    chosen.set_default(settling_step=chosen["time_step_share"] * stable["settling_step"] if longer else chosen["time_step"])
    for name, longest in stable.items():
        if chosen[name] > longest:
            rule = f"it must be at most {longest:.3g} s, a time_step_share of 1: beyond that the integration is unstable"
            raise CaseError(f"scene/settings: {name} is {chosen[name]:.3g} s; {rule}")


def _choose_motion(case: Case, chosen: _Chosen) -> None:
    """Choose speed and duration of both stages, and the limits for rest and for a fall."""
    gravity, sag = float(np.linalg.norm(case.gravity)), sag_of(case, chosen["normal_stiffness"])
    # A structure that sags by u under its weights swings with a period of about 2 pi sqrt(u / g); the same formula holds for the sway.
    slow = slowness(case)
    period = slow * 2.0 * math.pi * math.sqrt(sag / gravity)
    chosen.set_default(rest_unbalanced=REST_UNBALANCED / slow)  # the slower the sway, the longer the lever from the swing to the reaction
    # Joints stiffer than STIFFENING shorten the period, but the support keeps its speed: a higher speed would affect the reaction more.
    unhurried = period * _root_of_stiffness(chosen, STIFFENING)
    chosen.set_default(speed=chosen["max_travel"] / (chosen["travel_periods"] * unhurried))
    chosen["travel_periods"] = chosen["max_travel"] / (chosen["speed"] * unhurried)  # the periods that follow from a speed in the overrides
    # The plateau of the undeformed geometry ends where turning blocks release a thrust, at a settlement in proportion to the root of the
    # sag. So a run with joints stiffer than the travel needs looks for this plateau earlier, and with rows closer to each other.
    root = _root_of_stiffness(chosen, chosen["least_stiffening"])
    chosen.set_default(record_rows=round(ROWS * root), plateau_travel=chosen["plateau_share"] * chosen["max_travel"] / root)
    chosen.set_default(ramp_time=2.0 * RAMP_SHARE * chosen["max_travel"] / chosen["speed"] / root)
    chosen.set_default(gravity_ramp=WEIGHT_PERIODS * period, gravity_time=GRAVITY_PERIODS * period)
    chosen.set_default(rest_energy=REST_SHARE * 0.5 * case.block_weight * len(case.free) * sag)
    chosen.set_default(fall_speed=math.sqrt(2.0 * gravity * chosen["max_travel"] * case.support_speed))


def _root_of_stiffness(chosen: dict[str, Any], enough: float) -> float:
    """Return the root of the joints' stiffening over `enough`, a stiffening that suffices; at least 1."""
    return math.sqrt(max(chosen["stiffening"] / enough, 1.0))


def most_steps(points: int) -> float:
    """Return the largest number of time steps of all attempts together, by the number of contact points; an attempt at the run's own
    speed may exceed it."""
    return max(SMALL_WORK, min(MOST_STEPS * points, MOST_WORK)) / points


def rattling_of(case: Case, settings: Settings, reaction: float) -> float:
    """Return the mean unbalanced force, over the mean block weight, above which blocks rattle. reaction: N, or N m.

    Among a thousand blocks one jumps in nearly every run. This matters only if its force is a noticeable share of the reaction.
    """
    if case.live is not None:
        return settings.rattling
    return settings.rattling * max(1.0, AT_STAKE * abs(reaction) / case.support_speed / case.block_weight)


def sag_of(case: Case, normal_stiffness: float) -> float:
    """Return the sag (m) of a case on joints of another stiffness (N/m)."""
    return case.sag * case.normal_stiffness / normal_stiffness


def sway_over_sag(case: Case) -> float:
    """Return the period of the sideways swing over that of the sag; it is large for slender structures."""
    return math.sqrt(case.sway / case.sag)


def slowness(case: Case) -> float:
    """Return the factor by which the sideways swing makes a run longer; more than 1 for slender structures."""
    return max(1.0, SWAY_SHARE * sway_over_sag(case))


def is_content(settings: Settings) -> bool:
    """Whether a run may end with a plateau that is as uncertain as for a large structure."""
    return settings.stop_uncertainty >= OF_LARGE["stop_uncertainty"]


def steps_to_plateau(settings: Settings) -> float:
    """Return the time steps of the quick attempt and the attempt at the run's own speed, if both end at the least travel of a plateau."""
    own = (0.5 * settings.ramp_time + settings.plateau_travel / settings.speed) / settings.settling_step
    return own * (1.0 + (1.0 / settings.quick_speed if settings.quick_speed > 0.0 else 0.0))


def _checked(overrides: dict[str, Any]) -> dict[str, float]:
    """Return the settings of a scene as numbers; raises CaseError for an unknown name or an invalid value."""
    kinds = {field.name: field.type for field in dataclasses.fields(Settings)}
    for name, value in overrides.items():
        if name not in kinds:
            near = difflib.get_close_matches(name, kinds, 1)
            hint = f"did you mean {near[0]!r}?" if near else f"settings are {', '.join(kinds)}"
            raise CaseError(f"scene/settings: unknown setting {name!r}; {hint}")
        rule = broken_rule(name, value)
        if rule:
            raise CaseError(f"scene/settings: {name} is {value!r}; it must be {rule}")
    return {name: value if kinds[name] is int else float(value) for name, value in overrides.items()}


def _damping(case: Case, chosen: dict[str, Any]) -> dict[str, float]:
    """Return the viscosity of a contact point along its normal and across it, N s/m, by the name of the setting."""
    mass = float(np.mean(case.mass[case.free]))
    return {
        f"{name}_damping": 2.0 * chosen["damping_ratio"] * math.sqrt(chosen[f"{name}_stiffness"] * mass / 4.0)
        for name in ("normal", "shear")
    }


def inertia_of(case: Case, normal: float, shear: float, added_mass: float) -> Inertia:
    """Return the inertia of the blocks in a run with this stiffness of the contact points (N/m) and this `added_mass`."""
    most = MOST if case.live is None else MOST_PUSHED
    return slowed(case, springs_of(case, normal, shear), added_mass, most)


def contact_damping(case: Case, inertia: Inertia, normal: float, shear: float) -> np.ndarray:
    """Return the viscosity (C, 2), N s/m, of every contact point along its normal and across it.

    `normal` and `shear` are the viscosities of a contact whose lighter block has the mean mass. Other viscosities are in proportion to
    the root of the lighter block's mass. Otherwise the dashpots of a heavy neighbour would overdamp a light block, and a high damping
    ratio shortens the time step. A held block counts as heavy. Masses are those of the inertia.
    """
    mass = np.where(case.role == FREE, inertia.mass, np.inf)
    lighter = np.minimum(mass[case.block_a], mass[case.block_b])
    factor = np.sqrt(np.where(np.isfinite(lighter), lighter, 0.0) / np.mean(case.mass[case.free]))
    return factor[:, None] * np.array([normal, shear])


def _stable_time_steps(case: Case, chosen: dict[str, Any]) -> dict[str, float]:
    """Return the longest stable `time_step`, with local damping, and the longest stable `settling_step`, without it, s."""
    stiffness = chosen["normal_stiffness"], chosen["shear_stiffness"]
    inertia = inertia_of(case, *stiffness, chosen["added_mass"])
    stiffest = highest_eigenvalue(springs_of(case, *stiffness), inertia)
    dashpots = springs_of(case, *contact_damping(case, inertia, chosen["normal_damping"], chosen["shear_damping"]).T)
    decay = highest_eigenvalue(dashpots, inertia)
    # Local damping increases a braking force by its share, which has the same effect as a mass that is smaller by this factor.
    more = {"time_step": 1.0 + chosen["gravity_damping"], "settling_step": 1.0}
    return {name: stable_time_step(math.sqrt(factor * stiffest), factor * decay) for name, factor in more.items()}
