"""Plain words and units for the parameters that a campaign sweeps and for the quantities that its cases give."""

import re
from collections.abc import Mapping
from typing import Any

from comparison.numbers import format_number

NAMES = {
    "joint.friction": "friction mu (-)",
    "joint.inset": "inset (m)",
    "stone.density": "density (kg/m³)",
    "settlement.direction": "direction of the settlement",
    "live.direction": "direction of the live load",
    "effects.plane": "plane model",
    "effects.friction": "friction law",
    "classic.relaxation": "classic relaxation b (-)",
    "classic.slope": "classic slope a (-)",
    "classic.cohesion": "classic cohesion (mean block weights)",
    "classic.tolerance": "classic tolerance (mean block weights)",
    "classic.iterations": "classic: most programmes",
    "accuracy": "accuracy asked for (share)",
    "inset": "inset (m)",
    "friction": "friction mu (-)",
    "density": "density (kg/m³)",
    "gravity": "gravity (m/s²)",
    "radius": "radius (m)",
    "thickness": "thickness (m)",
    "depth": "depth (m)",
    "length": "length (m)",
    "height": "height (m)",
    "embrace": "embrace (degrees)",
    "degrees": "turn (degrees)",
    "courses": "courses",
    "per_course": "blocks in a course",
    "voussoirs": "voussoirs",
    "origin": "origin (m)",
    "block": "block size (m)",
    "size": "size (m)",
}
UNITS = {  # by unit, of keys whose own words say what they are, after as much of their path as tells them apart
    "m": "from to centre point vertices profile y shift bearing yade.sphere_radius",
    "m or rad": "path.settlement yade.max_travel yade.wedging yade.plateau_travel",
    "m per unit": "scale",
    "degrees": "oculus sector",
    "kg": "mass",
    "N/m": "yade.normal_stiffness yade.shear_stiffness",
    "N s/m": "yade.normal_damping yade.shear_damping",
    "m/s or rad/s": "yade.speed",
    "m/s": "yade.fall_speed",
    "s": "yade.time_step yade.ramp_time yade.gravity_time yade.time_limit",
    "J": "yade.rest_energy",
    "periods": "yade.travel_periods",
    "-": "yade.damping_ratio yade.time_step_share yade.gravity_damping yade.rest_unbalanced yade.plateau_uncertainty yade.plateau_drift "
    "yade.stop_uncertainty yade.reaction_floor yade.settings_uncertainty",
}
UNIT_OF = {key: unit for unit, keys in UNITS.items() for key in keys.split()}
COMPONENTS = {  # of arrays, by the ends of their keys' paths
    "": ("x", "y", "z"),
    "profile": ("x", "z"),
    "opening.from": ("along the wall", "z"),
    "opening.to": ("along the wall", "z"),
    "prism.y": ("near end", "far end"),
    "dome.support": ("first lune", "last lune"),
}
UNIT = re.compile(r" \([^()]*\)")
CLASSIC = "classic."  # parameters that only the classic iteration knows
QUANTITY = {"N": "reaction over weight, R / W (-)", "N m": "reaction over weight, R / W (m)", "": "collapse multiplier (-)"}


def label(parameter: str, named: Mapping[str, str] | None = None) -> str:
    """Axis label of a parameter by its dotted path: what it is and its unit; the path's own words where it has no name here.

    named: short names that the campaign gives its parameters; they take the place of the words, not of the unit, unless they say one.
    """
    whole = _whole(parameter)
    own = (named or {}).get(parameter)
    if own is None:
        return whole
    unit = UNIT.search(whole)
    return own if unit is None or UNIT.search(own) else own + unit[0]


def short(parameter: str, named: Mapping[str, str] | None = None) -> str:
    """The label without its unit."""
    return UNIT.sub("", label(parameter, named))


def _whole(parameter: str) -> str:
    """Table, words, unit and component of a parameter."""
    if parameter in NAMES:
        return NAMES[parameter]
    *parents, last = steps = _parts(parameter)
    indices: list[int] = []
    while last.isdigit() and parents:
        indices.insert(0, int(last))
        *parents, last = parents
    ends = _ends([step for step in steps if not step.isdigit()])
    words = next((NAMES[end] for end in ends if end in NAMES), _plain(last))
    unit = next((UNIT_OF[end] for end in ends if end in UNIT_OF), None)
    if unit is not None and not UNIT.search(words):
        words += f" ({unit})"
    table = " ".join(_plain(part) if not part.isdigit() else str(int(part) + 1) for part in parents)
    return (f"{table}: {words}" if table else words) + _component(ends, indices)


def _ends(path: list[str]) -> list[str]:
    """Ends of a path without its indices, the longest first."""
    return [".".join(path[k:]) for k in range(len(path))]


def _component(ends: list[str], indices: list[int]) -> str:
    """Which entry of an array a parameter is, in words; "" for a whole value."""
    if not indices:
        return ""
    *points, index = indices
    components = next(found for end in (*ends, "") if (found := COMPONENTS.get(end)))
    words = components[index] if index < len(components) else str(index + 1)
    return "".join(f", point {point + 1}" for point in points) + f", {words}"


def words_of(held: Mapping[str, Any], named: Mapping[str, str] | None = None) -> str:
    """Parameters with their values, in words; "" for none."""
    return ", ".join(f"{short(name, named)} {shown(value)}" for name, value in held.items())


def shown(value: Any) -> str:
    """A parameter's value in a few signs; a dash for none."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list | tuple):
        return "(" + ", ".join(shown(part) for part in value) + ")"
    if isinstance(value, int | float):
        return f"{value:.6g}".replace("-", "−", 1) if value < 0 else f"{value:.6g}"
    return format_number(None) if value is None else str(value)


def quantity(unit: str | None) -> str:
    """Axis label of a reaction over the weight, or of a multiplier, by the unit of the reaction."""
    return QUANTITY.get(unit or "", QUANTITY["N"])


def _parts(parameter: str) -> list[str]:
    return [part for part in re.split(r"[.\[\]]+", parameter) if part]


def _plain(word: str) -> str:
    return word.replace("_", " ")
