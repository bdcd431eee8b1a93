"""Every setting of a run: derived from the case so that any size and weight of block runs alike, or asked for by name."""

import dataclasses
import difflib
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from yade_scripts import elasticity
from yade_scripts.case import Case, CaseError

# Ratios that hold for every case; README.md says where they come from.
TRAVEL_OVER_SIZE = 1.0 / 400.0  # largest support travel over block size: small displacements
TRAVEL_OVER_INSET = 0.8  # a contact sphere that slips by its inset leaves the face
RADIUS_OVER_INSET = 0.5  # a sphere stays clear of the neighbour's face across a joint
ELASTIC_SHARE = 1.0 / 300.0  # elastic settlement under the weights over the travel
PENETRATION_OVER_RADIUS = 0.05
GRAVITY_PERIODS = 500.0  # longest gravity stage
RAMP_SHARE = 0.1  # of the travel is covered while the support speeds up
TRAVEL_PERIODS = 500.0  # the full travel takes this many periods of the structure sagging under its weights


@dataclass(frozen=True)
class Settings:
    """All settings of a run, as used and stored. Lengths of the support's motion are m, or rad for a rotation."""

    normal_stiffness: float  # N/m, of one contact point
    shear_stiffness: float  # N/m
    damping_ratio: float  # of a block on four contacts
    normal_damping: float  # N s/m
    shear_damping: float  # N s/m
    time_step_share: float  # of the stable time step
    time_step: float  # s
    sphere_radius: float  # m
    max_travel: float  # m or rad
    speed: float  # m/s or rad/s
    ramp_time: float  # s, cosine ramp to full speed
    gravity_damping: float  # local damping of the gravity stage, -
    gravity_time: float  # s, longest gravity stage
    rest_unbalanced: float  # unbalanced force over the mean block weight that counts as rest
    fall_speed: float  # m/s of a free block, beyond which it falls
    record_rows: int  # of the settlement stage over the full travel
    poses: int  # states stored with displacements and contact forces
    plateau_travel: float  # m or rad, least travel before the run may stop on a plateau
    plateau_uncertainty: float  # of the reaction, over its own size or the floor below, that counts as a plateau
    plateau_drift: float  # change of the fitted line over its range, likewise
    stop_uncertainty: float  # likewise: below it the run stops early
    reaction_floor: float  # share of the reaction at rest below which a reaction is judged by this floor
    time_limit: float  # s of wall time


def derive(case: Case) -> Settings:
    """Settings for the case, its own overrides put first. Raises CaseError for an unknown name or an impossible value."""
    asked = _checked(case.overrides)
    chosen: dict[str, Any] = {}

    def settle(**values: float) -> None:
        chosen.update({name: asked.get(name, value) for name, value in values.items()})

    settle(damping_ratio=0.3, time_step_share=0.9, gravity_damping=0.3, rest_unbalanced=1e-3, record_rows=600, poses=40)
    settle(plateau_uncertainty=0.02, plateau_drift=0.05, stop_uncertainty=0.001, reaction_floor=0.01, time_limit=3600.0)
    settle(sphere_radius=RADIUS_OVER_INSET * case.inset)
    travel = min(TRAVEL_OVER_SIZE * case.block_size, TRAVEL_OVER_INSET * case.inset)
    settle(max_travel=travel / case.support_reach)
    travel = chosen["max_travel"] * case.support_reach
    sag, force = elasticity.elastic_settlement(elasticity.springs(case, 1.0, 1.0))  # m and N at 1 N/m
    settle(normal_stiffness=max(sag / (ELASTIC_SHARE * travel), force / (PENETRATION_OVER_RADIUS * chosen["sphere_radius"])))
    stiffness = chosen["normal_stiffness"]
    settle(shear_stiffness=stiffness)
    settle(**_damping(case, chosen))
    settle(time_step=chosen["time_step_share"] * _stable_time_step(case, chosen))
    gravity = float(np.linalg.norm(case.gravity))
    # A structure that sags by u under its weights swings with a period of about 2 pi sqrt(u / g).
    period = 2.0 * math.pi * math.sqrt(sag / stiffness / gravity)
    settle(speed=chosen["max_travel"] / (TRAVEL_PERIODS * period))
    settle(ramp_time=2.0 * RAMP_SHARE * chosen["max_travel"] / chosen["speed"])
    settle(gravity_time=GRAVITY_PERIODS * period)
    settle(fall_speed=math.sqrt(2.0 * gravity * travel))
    settle(plateau_travel=0.4 * chosen["max_travel"])
    return Settings(**chosen)


def _checked(overrides: dict[str, Any]) -> dict[str, Any]:
    fields = {field.name: field.type for field in dataclasses.fields(Settings)}
    for name, value in overrides.items():
        if name not in fields:
            near = difflib.get_close_matches(name, fields, 1)
            hint = f"; did you mean {near[0]!r}?" if near else f"; settings are {', '.join(fields)}"
            raise CaseError(f"scene/settings: unknown setting {name!r}{hint}")
        whole = isinstance(value, int) and not isinstance(value, bool)
        if not (whole or (fields[name] is float and isinstance(value, float) and math.isfinite(value))):
            raise CaseError(f"scene/settings: {name} is {value!r}; it must be a {'whole' if fields[name] is int else 'finite'} number")
        may_vanish = name.endswith("damping") or name in ("damping_ratio", "ramp_time", "shear_stiffness")
        if value < 0 or (value == 0 and not may_vanish):
            raise CaseError(f"scene/settings: {name} is {value!r}; it must be {'at least' if may_vanish else 'greater than'} 0")
    return {name: fields[name](value) for name, value in overrides.items()}


def _damping(case: Case, chosen: dict[str, Any]) -> dict[str, float]:
    mass = float(np.mean(case.mass[case.free]))
    return {
        f"{name}_damping": 2.0 * chosen["damping_ratio"] * math.sqrt(chosen[f"{name}_stiffness"] * mass / 4.0)
        for name in ("normal", "shear")
    }


def _stable_time_step(case: Case, chosen: dict[str, Any]) -> float:
    normal, shear = chosen["normal_stiffness"], chosen["shear_stiffness"]
    frequency = elasticity.highest_frequency(elasticity.springs(case, normal, shear))
    # Asked-for viscosities need not be proportional to the stiffnesses: the larger ratio is on the safe side.
    ratios = [chosen["normal_damping"] / normal] + ([chosen["shear_damping"] / shear] if shear > 0.0 else [])
    return elasticity.stable_time_step(frequency, max(ratios))
